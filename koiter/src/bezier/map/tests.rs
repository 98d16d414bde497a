use super::*;
use crate::bezier::problems::{RoofEdges, roof};
use crate::bezier::{ElementKind, Pose};
use crate::mesh::generate::{GridDiagonals, cylinder_panel};

fn shell(kind: ElementKind) -> BezierShell {
    roof(kind, 3, RoofEdges::Clamped).unwrap().shell
}

fn bent(shell: &BezierShell) -> (Pose, Vec<f64>) {
    let rest = shell.rest_pose();
    let motion: Vec<f64> = (0..6 * rest.len())
        .map(|k| (1.7 * k as f64).sin())
        .collect();
    (rest.moved(&motion, 0.6), motion)
}

#[test]
fn the_power_of_forces_is_that_of_what_they_do_to_the_nodes() {
    for kind in ElementKind::ALL {
        let shell = shell(kind);
        let mapped = MappedSurface::subdivided(&shell, 4);
        let (pose, velocities) = bent(&shell);
        let forces: Vec<Vec3> = (0..mapped.points().len())
            .map(|v| Vec3::new((v as f64).sin(), (2.0 * v as f64).cos(), 1.0))
            .collect();
        let of_points = mapped.velocities(&pose, &velocities);
        let power: f64 = forces.iter().zip(&of_points).map(|(f, v)| f.dot(v)).sum();
        let loads = mapped.pull_back(&pose, &forces);
        let of_nodes: f64 = loads.iter().zip(&velocities).map(|(f, v)| f * v).sum();
        let scale: f64 = forces
            .iter()
            .zip(&of_points)
            .map(|(f, v)| f.norm() * v.norm())
            .sum();
        assert!(power.abs() > 1e-3 * scale);
        // Round-off of a few hundred terms.
        assert!(
            (power - of_nodes).abs() < 1e-13 * scale,
            "{power} {of_nodes}"
        );
    }
}

#[test]
fn velocities_are_the_differences_of_positions() {
    let shell = shell(ElementKind::Bezier);
    let mapped = MappedSurface::subdivided(&shell, 3);
    let (pose, motion) = bent(&shell);
    let h = 1e-6;
    let [plus, minus] = [h, -h].map(|by| mapped.positions(&pose.moved(&motion, by)));
    for (v, velocity) in mapped.velocities(&pose, &motion).iter().enumerate() {
        let difference = (plus[v] - minus[v]) / (2.0 * h);
        // Truncation h² and round-off 1e-15 · 25 m / h.
        assert!(
            (difference - velocity).norm() < 1e-7,
            "{difference} {velocity}"
        );
    }
}

#[test]
fn the_smooth_surface_is_on_the_cylinder() {
    let shell = shell(ElementKind::Bezier);
    let mapped = MappedSurface::subdivided(&shell, 5);
    let positions = mapped.positions(&shell.rest_pose());
    assert_eq!(mapped.faces().len(), 25 * shell.elements().len());
    assert_eq!(positions.len(), 16 * 16);
    for x in positions {
        // Cells of 13°: flat triangles would be 0.16 off.
        assert!((x.x.hypot(x.z) - 25.0).abs() < 0.005, "{x}");
    }
}

#[test]
fn another_mesh_is_bound_where_it_is_closest_and_a_far_one_is_refused() {
    let shell = shell(ElementKind::Bezier);
    let angle = 40f64.to_radians();
    let fine = cylinder_panel(25.0, 25.0, [0.0, angle], [20; 2], GridDiagonals::Uniform).unwrap();
    let mapped = MappedSurface::new(&shell, &fine, 1.0).unwrap();
    assert!(
        mapped.farthest() > 0.1 && mapped.farthest() < 0.2,
        "{}",
        mapped.farthest()
    );
    for (x, to) in fine
        .positions
        .iter()
        .zip(mapped.positions(&shell.rest_pose()))
    {
        // Bound where the flat elements are closest: a little off along the surface too.
        assert!((x - to).norm() < 0.02, "{x} {to}");
    }
    let mut far = fine.clone();
    far.positions[7] += Vec3::new(0.0, 0.0, 30.0);
    let refused = MappedSurface::new(&shell, &far, 1.0).unwrap_err();
    assert!(
        matches!(refused, BezierError::FarFromShell { vertex: 7, .. }),
        "{refused}"
    );
}
