//! What the study of second-order discrete shells found of the rolled plate, "Better Bending" (2026), Section 8.3.

use std::f64::consts::PI;

use koiter::Vec3;
use koiter::assembly::{Assembled, Dof, DofLayout, Energy};
use koiter::energy::bending::{SecondOrderEdges, SecondOrderFaces};
use koiter::integrate::relax_edge_points;
use koiter::material::StVenantKirchhoff;
use koiter::mesh::generate::{GridDiagonals, grid};
use koiter::rest::rest_frames;

const RADIUS: f64 = 0.0325;
const HEIGHT: f64 = 0.122;
const THICKNESS: f64 = 1e-4;

/// Exact energy, the energy with the points of the edges at the middles of the edges moved to the cylinder, and the one
/// that is left when they are free, on the mesh of triangles of 4^k 10⁻⁸ m².
fn energies(k: i32) -> [f64; 3] {
    let material = StVenantKirchhoff::new(1e11, 0.3);
    let rigidity = (material.lame_alpha + 2.0 * material.lame_beta) * THICKNESS.powi(3) / 12.0;
    let width = PI * RADIUS;
    let exact = 0.5 * rigidity * width * HEIGHT / (RADIUS * RADIUS);
    let length = (2e-8 * 4f64.powi(k)).sqrt();
    let [n, m] = [width, HEIGHT].map(|side| (side / length).floor() as usize);
    let plate = grid(width, HEIGHT, n, m, GridDiagonals::Uniform).unwrap();
    let rolled = |x: Vec3| {
        let angle = x.x / RADIUS;
        Vec3::new(RADIUS * angle.cos(), RADIUS * angle.sin(), x.y)
    };
    let mut layout = DofLayout::new();
    layout.push_nodes(plate.mesh.num_vertices(), 3, true);
    let first = layout.push_nodes(plate.mesh.num_edges(), 3, true);
    let mut points: Vec<Vec3> = plate.positions.iter().map(|x| rolled(*x)).collect();
    let middle =
        |[u, v]: &[u32; 2]| (plate.positions[*u as usize] + plate.positions[*v as usize]) * 0.5;
    points.extend(plate.mesh.edges().iter().map(middle).map(rolled));
    let mut q: Vec<f64> = points.iter().flat_map(|x| [x.x, x.y, x.z]).collect();
    let frames = rest_frames(&plate).unwrap();
    let rigidities = vec![rigidity; frames.len()];
    let edges = SecondOrderEdges::new(&plate, Dof(0), first, &frames, &rigidities);
    let faces = SecondOrderFaces::new(&plate.mesh, Dof(0), first, frames, rigidities);
    let mut energies = [
        Box::new(Assembled::new(faces, &layout)) as Box<dyn Energy>,
        Box::new(Assembled::new(edges, &layout)),
    ];
    let sum = |energies: &[Box<dyn Energy>; 2], q: &[f64]| {
        energies.iter().map(|e| e.value(q)).sum::<f64>()
    };
    let smooth = sum(&energies, &q);
    // From the smooth surface, which is symmetric, a small push decides which way the patches bend.
    for (i, x) in q.iter_mut().enumerate().skip(first.0 as usize) {
        *x += 1e-3 * length * ((i * i) as f64 * 0.37).sin();
    }
    // Not to the bottom: patches contort through hundreds of iterations. What is reached is above the minimum.
    let range = first.0 as usize..q.len();
    let relaxed = relax_edge_points(&mut energies, &layout, range, length, &mut q);
    assert!(
        relaxed.is_ok() || q.iter().all(|x| x.is_finite()),
        "{relaxed:?}"
    );
    [exact, smooth, sum(&energies, &q)]
}

#[test]
fn free_points_leave_a_fraction_of_the_energy_of_a_cylinder() {
    let [exact, smooth, free] = energies(6);
    // Patches that interpolate the cylinder have its energy, up to 1 % on this coarse mesh …
    assert!((smooth / exact - 1.0).abs() < 0.02, "{smooth} {exact}");
    // … and those of least energy have next to none; the study stopped at 1.22e-3 J.
    assert!(free > 0.0 && free < 1.3e-3, "{free}");
}
