//! Loads, clamps and planes of symmetry.

use koiter::Vec3;
use koiter::assembly::Dof;
use koiter::energy::bending::{
    ClampedEdge, DirectorClamp, SymmetryEdge, SymmetryEdges, bending_stencils,
};
use koiter::energy::loads::{DirectorMoment, EdgeMoment, Pressure, TurnedDirectors, TurnedEdge};
use koiter::testing::{Claims, check};

use super::setup::*;

#[test]
fn the_director_clamp_conforms() {
    let s = patch(1.0);
    let stencils = bending_stencils(&s.rest.mesh, Dof(0), s.edges);
    let mut edges = Vec::new();
    for (face, stencil) in stencils.iter().enumerate() {
        for c in 0..3 {
            let corners = s.rest.mesh.faces()[face];
            let vertices = [corners[(c + 1) % 3], corners[(c + 2) % 3]];
            let ends = vertices.map(|v| s.rest.positions[v as usize]);
            let across_edge = (ends[1] - ends[0]).cross(&Vec3::new(0.3, 0.5, 1.0));
            edges.push(ClampedEdge {
                apex: stencil.corners[c],
                across: stencil.across[c],
                // Models without directors have none.
                angle: (face > 0).then_some(stencil.angles[c]),
                sign: stencil.signs[c],
                ends,
                director: across_edge.cross(&(ends[1] - ends[0])).normalize(),
                stiffness: 0.8,
                vertices,
            });
        }
    }
    let clamp = DirectorClamp { edges };
    check(
        clamp,
        &s.layout,
        &s.q,
        |e, i, q| e.formula(i, q),
        &Claims::default(),
    )
    .unwrap();
}

#[test]
fn pressure_conforms() {
    let s = patch(1.0);
    let pressure = Pressure {
        faces: (s.rest.mesh.faces().iter())
            .map(|face| face.map(|v| Dof(3 * v)))
            .collect(),
        pressure: 1.7,
        origin: Vec3::new(0.2, -0.4, 0.9),
        factor: 0.6,
    };
    check(
        pressure,
        &s.layout,
        &s.q,
        |e, _, q| e.formula(q),
        &Claims::default(),
    )
    .unwrap();
}

#[test]
fn the_edge_moment_conforms() {
    let s = patch(1.0);
    let stencils = bending_stencils(&s.rest.mesh, Dof(0), s.edges);
    let mut edges = Vec::new();
    for (face, stencil) in stencils.iter().enumerate() {
        for c in 0..3 {
            let ends = [(c + 1) % 3, (c + 2) % 3];
            let corners = s.rest.mesh.faces()[face];
            edges.push(TurnedEdge {
                corners: [ends[0], ends[1], c].map(|i| stencil.corners[i]),
                across: stencil.across[c],
                angle: stencil.angles[c],
                sign: stencil.signs[c],
                moment: 0.8 + 0.1 * c as f64,
                // Not quite across the edges: only the part that is counts.
                reference: Vec3::new(0.3, 0.5, 1.0),
                turned: 0.3,
                vertices: ends.map(|i| corners[i]),
            });
        }
    }
    let moment = EdgeMoment { edges, factor: 1.3 };
    check(
        moment,
        &s.layout,
        &s.q,
        |e, i, q| e.formula(i, q),
        &Claims::default(),
    )
    .unwrap();
}

#[test]
fn the_director_moment_conforms() {
    let mut s = patch(1.0);
    let directors = s.layout.push_nodes(s.rest.mesh.num_vertices(), 3, true);
    for i in 0..3 * s.rest.mesh.num_vertices() {
        let tilt = 0.4 * ((i * 5 + 2) as f64).sin();
        s.q.push(if i % 3 == 2 { 1.2 + tilt } else { tilt });
    }
    let edges = s.rest.mesh.edges().iter().enumerate();
    let edges = edges.map(|(i, vertices)| TurnedDirectors {
        ends: vertices.map(|v| Dof(3 * v)),
        directors: vertices.map(|v| Dof(directors.0 + 3 * v)),
        moment: 0.8 + 0.1 * i as f64,
        references: [Vec3::new(0.3, 0.5, 1.0), Vec3::new(-0.2, 0.1, 1.0)],
        turned: 0.3,
        vertices: *vertices,
    });
    let moment = DirectorMoment {
        edges: edges.collect(),
        factor: 1.3,
    };
    let formula = |e: &DirectorMoment, i: usize, q: &_| e.formula(i, q);
    check(moment, &s.layout, &s.q, formula, &Claims::default()).unwrap();
}

#[test]
fn edges_on_planes_of_symmetry_conform() {
    let s = patch(1.0);
    let mut edges = Vec::new();
    for (face, stencil) in bending_stencils(&s.rest.mesh, Dof(0), s.edges)
        .iter()
        .enumerate()
    {
        for c in (0..3).filter(|c| stencil.across[*c].is_none()) {
            let ends = [(c + 1) % 3, (c + 2) % 3];
            let corners = s.rest.mesh.faces()[face];
            edges.push(SymmetryEdge {
                corners: [ends[0], ends[1], c].map(|i| stencil.corners[i]),
                angle: stencil.angles[c],
                sign: stencil.signs[c],
                normal: Vec3::new(0.6, -0.8, 0.0),
                stiffness: 0.8,
                vertices: ends.map(|i| corners[i]),
            });
        }
    }
    let formula = |e: &SymmetryEdges, i: usize, q: &_| e.formula(i, q);
    let symmetry = SymmetryEdges { edges };
    check(symmetry, &s.layout, &s.q, formula, &Claims::default()).unwrap();
}
