//! How many faces a surface will have, before it is made. Floats, so that products of large resolutions do not overflow.

use std::f64::consts::TAU;

/// Of [`grid`](super::grid()), [`cylinder`](super::cylinder),
/// [`corrugated_tube`](super::corrugated_tube), [`cone`](super::cone) (at most),
/// [`torus`](super::torus), [`cylinder_panel`](super::cylinder_panel) and [`sphere_zone`](super::sphere_zone): two a cell.
pub fn cells(nx: usize, ny: usize) -> f64 {
    2.0 * nx as f64 * ny as f64
}

/// Of [`irregular`](super::irregular()), at most.
pub fn irregular(width: f64, depth: f64, max_area: f64) -> f64 {
    let spacing = (2.0 * max_area).sqrt();
    2.0 * width * depth / max_area + 16.0 * (width + depth) / spacing
}

/// Of [`delaunay`](super::delaunay()), at most.
pub fn delaunay(width: f64, depth: f64, [nx, ny]: [usize; 2], max_area: f64) -> f64 {
    2.0 * width * depth / max_area + 8.0 * (nx as f64 + ny as f64) + 16.0
}

/// Of [`hat`](super::hat()).
pub fn hat(around: usize, rings: usize) -> f64 {
    cells(around, rings) - around as f64
}

/// Of [`disc`](super::disc).
pub fn disc(rings: usize) -> f64 {
    6.0 * (rings as f64).powi(2)
}

/// Of [`icosphere`](super::icosphere).
pub fn icosphere(subdivisions: usize) -> f64 {
    20.0 * 4f64.powi(subdivisions.try_into().unwrap_or(i32::MAX))
}

/// Of [`spherical_cap`](super::spherical_cap), about: its area over that of two triangles between rings.
pub fn spherical_cap(angle: f64, hole_angle: f64, rings: usize) -> f64 {
    let step = (angle - hole_angle) / rings as f64;
    // cos hole − cos angle without cancellation: a narrow band has as many triangles around as its width is small.
    let [mean, half] = [angle + hole_angle, angle - hole_angle].map(|x| (0.5 * x).sin());
    4.0 * TAU * mean * half / (step * step) + 12.0 * rings as f64
}

/// Rings of triangles in the band of [`inset_cap`](super::inset_cap).
pub(super) fn inset_bands(
    radius: f64,
    angle: f64,
    hole_angle: f64,
    inset: f64,
    rings: usize,
) -> f64 {
    let spacing = radius * (angle - hole_angle) / rings as f64;
    (inset / spacing).round().max(1.0)
}

/// Of [`inset_cap`](super::inset_cap), about.
pub fn inset_cap(radius: f64, angle: f64, hole_angle: f64, inset: f64, rings: usize) -> f64 {
    let around = TAU * angle.sin() * rings as f64 / (angle - hole_angle);
    let band = 2.0 * around.max(6.0) * inset_bands(radius, angle, hole_angle, inset, rings);
    spherical_cap(angle, hole_angle, rings) + band
}
