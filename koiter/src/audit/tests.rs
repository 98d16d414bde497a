use super::*;
use crate::mesh::generate;

fn v(x: f64, y: f64, z: f64) -> Vec3 {
    Vec3::new(x, y, z)
}

/// Joins parts, each with its positions and faces; those after the first `num_shells` are obstacles.
fn join(
    parts: &[(Vec<Vec3>, Vec<[u32; 3]>)],
    num_shells: usize,
) -> (Vec<Body>, Vec<[u32; 3]>, Vec<Vec3>) {
    let (mut bodies, mut faces, mut positions) = (Vec::new(), Vec::new(), Vec::new());
    for (index, (points, corners)) in parts.iter().enumerate() {
        let (first_vertex, first_face) = (positions.len(), faces.len());
        positions.extend_from_slice(points);
        faces.extend(corners.iter().map(|f| f.map(|v| v + first_vertex as u32)));
        bodies.push(Body {
            name: format!("part {index}"),
            is_obstacle: index >= num_shells,
            vertices: first_vertex..positions.len(),
            faces: first_face..faces.len(),
            solid: None,
        });
    }
    (bodies, faces, positions)
}

fn rest(faces: &[[u32; 3]], x: &[Vec3]) -> Vec<RestFace> {
    let corners = |face: &[u32; 3]| face.map(|v| x[v as usize]);
    faces
        .iter()
        .map(|face| RestFace::from_corners(&corners(face)))
        .collect()
}

fn audit(parts: &[(Vec<Vec3>, Vec<[u32; 3]>)], num_shells: usize) -> (Audit, Vec<Vec3>) {
    let (bodies, faces, positions) = join(parts, num_shells);
    let rest = rest(&faces, &positions);
    (Audit::new(bodies, &faces, &rest, &positions), positions)
}

/// A square of `n × n` cells in the plane z = `height`.
fn sheet(n: u32, height: f64) -> (Vec<Vec3>, Vec<[u32; 3]>) {
    let at = |i: u32| f64::from(i) / f64::from(n);
    let points = (0..=n).flat_map(|j| (0..=n).map(move |i| v(at(i), at(j), height)));
    let cell = |j: u32, i: u32| {
        let a = j * (n + 1) + i;
        [[a, a + 1, a + n + 2], [a, a + n + 2, a + n + 1]]
    };
    let faces = (0..n).flat_map(|j| (0..n).flat_map(move |i| cell(j, i)));
    (points.collect(), faces.collect())
}

fn ball(center: Vec3, radius: f64) -> (Vec<Vec3>, Vec<[u32; 3]>) {
    let surface = generate::icosphere(radius, 2).unwrap();
    let points = surface.positions.iter().map(|x| x + center).collect();
    (points, surface.mesh.faces().to_vec())
}

#[test]
fn a_flat_sheet_is_clean_and_as_it_is_at_rest() {
    let (audit, x) = audit(&[sheet(9, 0.0), sheet(9, 1e-12)], 2);
    let found = audit.frame(&x);
    assert!(found.is_clean(), "{found:?}");
    assert_eq!((found.area_ratio.value, found.edge_ratio.value), (1.0, 1.0));
    assert!((found.dihedral_angle.value - std::f64::consts::PI).abs() < 1e-15);
    // Turned so that no coordinate is exact any more: neighbours still do not meet.
    let turn = nalgebra::Rotation3::from_euler_angles(0.3, 1.1, -0.7);
    let turned: Vec<Vec3> = x.iter().map(|x| turn * x).collect();
    assert!(audit.frame(&turned).crossings.is_empty());
}

#[test]
fn the_tip_of_one_sheet_through_another_is_found_and_named() {
    let (audit, mut x) = audit(&[sheet(4, 0.0), sheet(4, 0.1)], 2);
    // The middle vertex of the upper sheet, just through the lower one.
    let middle = 25 + 12;
    x[middle] = v(0.51, 0.52, -1e-9);
    let found = audit.frame(&x);
    assert_eq!(
        found.crossings.len(),
        6,
        "its six edges, each through one face"
    );
    for crossing in &found.crossings {
        assert!(crossing.edge.contains(&(middle as u32)) && crossing.face < 32);
    }
    x[middle] = v(0.51, 0.52, 1e-9);
    assert!(audit.frame(&x).is_clean());
}

#[test]
fn sheets_in_one_plane_meet() {
    let mut upper = sheet(2, 0.0);
    upper.0.iter_mut().for_each(|x| *x += v(0.3, 0.2, 0.0));
    let (audit, x) = audit(&[sheet(2, 0.0), upper], 2);
    assert!(!audit.frame(&x).crossings.is_empty());
}

#[test]
fn obstacles_are_tested_against_shells_only() {
    let standing: Vec<Vec3> = sheet(1, 0.0)
        .0
        .iter()
        .map(|x| v(0.4, x.x, x.y - 0.5))
        .collect();
    let wall = (standing, sheet(1, 0.0).1);
    let (of_obstacles, x) = audit(&[sheet(4, 9.0), sheet(3, 0.0), wall.clone()], 1);
    assert!(of_obstacles.frame(&x).is_clean());
    let (of_both, x) = audit(&[sheet(3, 0.0), wall], 1);
    assert!(!of_both.frame(&x).crossings.is_empty());
}

#[test]
fn collapsed_faces_and_folded_edges_are_found() {
    let (audit, flat) = audit(&[sheet(1, 0.0)], 1);
    let mut x = flat.clone();
    // Vertex 3 comes down on the diagonal: its face keeps no area.
    x[2] = v(0.5, 0.5 + 1e-3, 0.0);
    let found = audit.frame(&x);
    assert_eq!(found.collapsed, [1]);
    assert_eq!(found.area_ratio.face, 1);
    assert!((found.area_ratio.value - 1e-3).abs() < 1e-12);
    // The sheet folded along its diagonal: corner on corner.
    let mut x = flat;
    x[2] = x[1];
    let found = audit.frame(&x);
    assert_eq!(
        (found.folded.as_slice(), found.collapsed.len()),
        ([[0, 3]].as_slice(), 0)
    );
    x[2] += v(0.0, 0.0, 1e-3);
    let found = audit.frame(&x);
    assert!(found.folded.is_empty() && found.sharp == 1);
    // The corner is 1/√2 from the diagonal: upright, and at an angle with a tangent of 1.
    x[2] = v(0.5, 0.5, 0.5f64.sqrt());
    assert_eq!(audit.frame(&x).sharp, 0);
}

#[test]
fn a_shell_inside_a_closed_obstacle_is_found() {
    let inside: Vec<Vec3> = sheet(2, 0.0)
        .0
        .iter()
        .map(|x| (x - v(0.5, 0.5, 0.0)) * 0.3)
        .collect();
    let small = (inside, sheet(2, 0.0).1);
    let (of_closed, x) = audit(&[sheet(2, 3.0), small.clone(), ball(Vec3::zeros(), 1.0)], 2);
    let found = of_closed.frame(&x);
    assert_eq!(found.enclosed, [Enclosed { vertex: 9, body: 2 }]);
    assert!(found.crossings.is_empty());
    // Without one of its faces there is no inside.
    let mut open = ball(Vec3::zeros(), 1.0);
    open.1.pop();
    let (of_open, x) = audit(&[small, open], 1);
    assert!(of_open.frame(&x).is_clean());
}

#[test]
fn solids_are_tested_by_their_shape_and_not_by_their_faces() {
    let radius = 1.0;
    let (mut bodies, faces, start) = join(&[sheet(4, 0.9999), ball(v(0.5, 0.5, 0.0), radius)], 1);
    bodies[1].solid = Some(Solid::Ball {
        center: [0.5, 0.5, 0.0],
        radius,
    });
    let audit = Audit::new(bodies, &faces, &rest(&faces, &start), &start);
    let found = audit.frame(&start);
    assert!(found.crossings.is_empty() && !found.penetrations.is_empty());
    assert!(
        (found.penetrations[0].depth - 1e-4).abs() < 1e-12,
        "{found:?}"
    );
    // The ball goes down by its penetration, and everything is well.
    let mut x = start.clone();
    x[25..].iter_mut().for_each(|x| x.z -= 1.01e-4);
    assert!(audit.frame(&x).is_clean());
}
