//! What keeps an element from collapsing: a barrier on its area.
//!
//! Strains are linear in the frame of an element, so pressing it to nothing would cost a finite energy, and beyond nothing its
//! normal points the other way. Below a fifth of its area at rest it resists by
//!
//! ```text
//! E t A b(5 a / A)
//! ```
//!
//! with a its area, A that at rest [m²], and the logarithmic barrier b ([`crate::geometry::log_barrier`]). A shell buckles long
//! before that: only what is pulled together with violence, such as a suture over a gap, meets it.

use nalgebra::Vector2;

use super::Section;
use super::element::ElementVector;
use super::stiffness::{FlatTriangle, Stiffness};
use crate::geometry::log_barrier;

/// The share of its area at which an element begins to resist: strains of the order of one, where they mean nothing.
pub const BEGIN: f64 = 0.2;

/// The barrier of an element.
#[derive(Clone, Copy, Debug)]
pub(super) struct Collapse {
    /// A [m²].
    area: f64,
    /// E t A [J].
    scale: f64,
}

impl Collapse {
    pub(super) fn new(triangle: &FlatTriangle, section: &Section) -> Self {
        let area = triangle.area;
        let scale = section.youngs_modulus * section.thickness * area;
        Self { area, scale }
    }

    fn ratio(&self, corners: &[Vector2<f64>; 3]) -> f64 {
        let twice_area = (corners[1] - corners[0]).perp(&(corners[2] - corners[0]));
        twice_area / (2.0 * BEGIN * self.area)
    }

    /// Its energy with the corners there in the plane [J].
    pub(super) fn value(&self, corners: &[Vector2<f64>; 3]) -> f64 {
        self.scale * log_barrier(self.ratio(corners))[0]
    }

    /// The derivative by the corners and the part of the second derivative that never is negative, `b″ ∇r ∇rᵀ`, in the frame of
    /// the element; `None` where it does not act.
    pub(super) fn derivatives(
        &self,
        corners: &[Vector2<f64>; 3],
    ) -> Option<(ElementVector, Stiffness)> {
        let ratio = self.ratio(corners);
        if ratio >= 1.0 {
            return None;
        }
        let mut slope = ElementVector::zeros();
        for i in 0..3 {
            let opposite = corners[(i + 2) % 3] - corners[(i + 1) % 3];
            let inwards = Vector2::new(-opposite.y, opposite.x) / (2.0 * BEGIN * self.area);
            slope.fixed_rows_mut::<2>(6 * i).copy_from(&inwards);
        }
        let [_, first, second] = log_barrier(ratio);
        let stiffness = slope * slope.transpose() * (self.scale * second);
        Some((slope * (self.scale * first), stiffness))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn its_forces_are_the_derivative_of_its_energy_and_nothing_collapses() {
        let rest = FlatTriangle::new([[0.0, 0.0], [2.0, 0.1], [0.5, 1.4]].map(Vector2::from));
        let section = Section {
            youngs_modulus: 10.0,
            poissons_ratio: 0.3,
            thickness: 0.1,
            density: 1.0,
        };
        let collapse = Collapse::new(&rest, &section);
        let pressed = |share: f64| rest.corners.map(|x| Vector2::new(x.x, share * x.y));
        assert_eq!(collapse.value(&pressed(0.201)), 0.0);
        assert!(collapse.derivatives(&pressed(0.201)).is_none());
        let corners = pressed(0.1);
        let (gradient, _) = collapse.derivatives(&corners).unwrap();
        let h = 1e-6;
        for i in 0..3 {
            for axis in 0..2 {
                let at = |step: f64| {
                    let mut moved = corners;
                    moved[i][axis] += step;
                    collapse.value(&moved)
                };
                let difference = (at(h) - at(-h)) / (2.0 * h);
                // Truncation h² and round-off 1e-16 / h.
                assert!((gradient[6 * i + axis] - difference).abs() < 1e-8);
            }
        }
        // −ln of the ratio: a thousand times flatter, seven more.
        let deep = [1e-3, 1e-6].map(|share| collapse.value(&pressed(share)));
        assert!(deep[1] - deep[0] > 6.0 * collapse.scale && deep[1].is_finite());
        assert_eq!(collapse.value(&pressed(0.0)), f64::INFINITY);
    }
}
