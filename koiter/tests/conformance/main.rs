//! Every energy passes the conformance suite; a planted error does not.

mod damping;
mod expressions;
mod loads;
mod setup;

use koiter::assembly::{Assembled, Dof, DofLayout, Energy, LocalEnergy, LocalHessian};
use koiter::energy::bending::{
    AngleProfile, DiscreteKirchhoff, DiscreteShells, HingeSprings, HingeWeight, Identity,
    LaplacianMesh, MidEdgeBending, SecondOrderEdges, SecondOrderFaces, Sine, Tangent,
    vertex_normals,
};
use koiter::energy::{DiscreteStiffness, EdgeLengths, FaceAreas, Membrane, StrainLimit};
use koiter::testing::{Claims, check, check_claims, check_global};
use nalgebra::{SVector, Vector3};
use setup::*;

fn claims(s: &Setup, at_rest: bool) -> Claims {
    Claims {
        rigid_motion_invariant: true,
        rest: at_rest.then(|| s.at_rest.clone()),
        ..Claims::default()
    }
}

fn check_mid_edge<P: AngleProfile>() {
    let s = patch(1.0);
    let section = section(&s);
    for curved in [false, true] {
        let formula = |e: &MidEdgeBending<P, _>, f: usize, q: &_| {
            e.formula(f, q, |change| section.bend_formula(f, change))
        };
        check(
            mid_edge::<P>(&s, curved),
            &s.layout,
            &s.q,
            formula,
            &claims(&s, curved),
        )
        .unwrap();
    }
}

#[test]
fn bac_conforms() {
    check_mid_edge::<Tangent>();
}

#[test]
fn dcs_conforms() {
    check_mid_edge::<Sine>();
}

#[test]
fn dso_conforms() {
    check_mid_edge::<Identity>();
}

#[test]
fn dkt_conforms() {
    let s = patch(1.0);
    let section = section(&s);
    let num_vertices = s.rest.mesh.num_vertices();
    let mut layout = DofLayout::new();
    layout.push_nodes(num_vertices, 3, true);
    let directors = layout.push_nodes(num_vertices, 3, true);
    let mut at_rest = s.at_rest[..3 * num_vertices].to_vec();
    at_rest.extend(vertex_normals(&s.rest).iter().flat_map(|d| [d.x, d.y, d.z]));
    // Directors that are not of unit length, as between the iterations of a solver.
    let moved = |(i, x): (usize, &f64)| x + 0.2 * ((i * 7 + 1) as f64 * 1.3).sin();
    let q: Vec<f64> = at_rest.iter().enumerate().map(moved).collect();
    let flat = vec![[Vector3::zeros(); 3]; s.frames.len()];
    let model = |forms| {
        let (frames, section) = (s.frames.clone(), section.clone());
        DiscreteKirchhoff::new(&s.rest.mesh, Dof(0), directors, frames, forms, section)
    };
    let gathered = Assembled::new(model(flat.clone()), &layout);
    let form = |f| {
        gathered
            .local()
            .second_forms(f, &gathered.gather(f, &at_rest))
    };
    let curved: Vec<_> = (0..s.frames.len()).map(form).collect();
    for (forms, rest) in [(flat, None), (curved, Some(at_rest.clone()))] {
        let claims = Claims {
            rigid_motion_invariant: true,
            directions_from: Some(directors),
            rest,
        };
        let formula = |e: &DiscreteKirchhoff<_>, f: usize, q: &_| {
            e.formula(f, q, |change| section.bend_formula(f, change))
        };
        check(model(forms), &layout, &q, formula, &claims).unwrap();
    }
}

/// The unknowns of second-order shells: layout, first point of an edge, a bent shape and the flat one.
fn second_order(s: &Setup) -> (DofLayout, Dof, Vec<f64>, Vec<f64>) {
    let mut layout = DofLayout::new();
    layout.push_nodes(s.rest.mesh.num_vertices(), 3, true);
    let points = layout.push_nodes(s.rest.mesh.num_edges(), 3, true);
    let mut at_rest = s.at_rest[..points.0 as usize].to_vec();
    for [u, v] in s.rest.mesh.edges() {
        let [u, v] = [u, v].map(|v| s.rest.positions[*v as usize]);
        at_rest.extend(((u + v) * 0.5).iter());
    }
    let moved = |(i, x): (usize, &f64)| x + 0.06 * ((i * 7 + 1) as f64 * 1.3).sin();
    let q: Vec<f64> = at_rest.iter().enumerate().map(moved).collect();
    (layout, points, q, at_rest)
}

#[test]
fn ds_2nd_conforms() {
    let s = patch(0.0);
    let (layout, points, q, at_rest) = second_order(&s);
    let rigidities = vec![0.7; s.frames.len()];
    let claims = Claims {
        rigid_motion_invariant: true,
        rest: Some(at_rest),
        ..Claims::default()
    };
    let (frames, r) = (s.frames.clone(), rigidities.clone());
    let faces = SecondOrderFaces::new(&s.rest.mesh, Dof(0), points, frames, r);
    check(faces, &layout, &q, |e, f, q| e.formula(f, q), &claims).unwrap();
    let edges = SecondOrderEdges::new(&s.rest, Dof(0), points, &s.frames, &rigidities);
    check(edges, &layout, &q, |e, i, q| e.formula(i, q), &claims).unwrap();
}

fn check_hinge<P: AngleProfile>() {
    let s = patch(1.0);
    for curved in [false, true] {
        let energy = hinge::<P>(&s, curved);
        let claims = claims(&s, curved);
        check(energy, &s.layout, &s.q, |e, h, q| e.formula(h, q), &claims).unwrap();
    }
}

#[test]
fn ds_theta_conforms() {
    check_hinge::<Identity>();
}

#[test]
fn ds_tan_conforms() {
    check_hinge::<Tangent>();
}

/// Of any weight and stiffness, with rest angles and branches beyond half a turn.
#[test]
fn hinges_of_discrete_shells_conform() {
    let s = patch(1.0);
    for weight in [HingeWeight::Circumcentric, HingeWeight::Simplified] {
        let springs = HingeSprings {
            weight,
            stiffness: Some(1.7),
        };
        let (frames, rigidity) = (&s.frames, rigidity(&s));
        let mut energy = DiscreteShells::<Identity>::with_springs(
            &s.rest,
            Dof(0),
            frames,
            true,
            &rigidity,
            springs,
        );
        for hinge in 0..energy.num_stencils() {
            energy.set_rest(hinge, &[3.5 + 0.1 * hinge as f64]);
            energy.follow(hinge, &[3.0 + 0.8 * hinge as f64]);
        }
        let claims = claims(&s, false);
        check(energy, &s.layout, &s.q, |e, h, q| e.formula(h, q), &claims).unwrap();
    }
}

#[test]
fn the_membrane_of_discrete_shells_conforms() {
    let s = patch(1.0);
    let (mesh, section) = (&s.rest.mesh, section(&s));
    let given = DiscreteStiffness {
        edges: Some(1.3),
        areas: Some(0.4),
    };
    // The material of the patch has no stiffness of areas: it is given.
    for rest in [0.0, 0.2] {
        let mut lengths = EdgeLengths::new(mesh, Dof(0), &s.frames, &section, Default::default());
        let mut areas = FaceAreas::new(mesh, Dof(0), &s.frames, &section, given);
        (0..lengths.num_stencils()).for_each(|edge| lengths.set_rest(edge, &[rest]));
        (0..areas.num_stencils()).for_each(|face| areas.set_rest(face, &[rest]));
        let claims = claims(&s, rest == 0.0);
        check(lengths, &s.layout, &s.q, |e, i, q| e.formula(i, q), &claims).unwrap();
        check(areas, &s.layout, &s.q, |e, i, q| e.formula(i, q), &claims).unwrap();
    }
}

#[test]
fn ch_es_conforms() {
    let s = patch(1.0);
    for curved in [false, true] {
        let energy = corotational_edge(&s, curved);
        let claims = claims(&s, curved);
        check(energy, &s.layout, &s.q, |e, h, q| e.formula(h, q), &claims).unwrap();
    }
}

#[test]
fn ch_fs_conforms() {
    let s = patch(1.0);
    for curved in [false, true] {
        let energy = corotational_face(&s, curved);
        let claims = claims(&s, curved);
        check(energy, &s.layout, &s.q, |e, f, q| e.formula(f, q), &claims).unwrap();
    }
}

#[test]
fn me_average_conforms() {
    let s = patch(1.0);
    let section = section(&s);
    for curved in [false, true] {
        let formula = |e: &Average, f: usize, q: &_| {
            e.formula(f, q, |change| section.bend_formula(f, change))
        };
        let energy = mid_edge_average(&s, curved);
        check(energy, &s.layout, &s.q, formula, &claims(&s, curved)).unwrap();
    }
}

#[test]
fn qb_cr_conforms() {
    for height in [0.0, 1.0] {
        let s = patch(height);
        let claims = claims(&s, height == 0.0);
        let energy = quadratic_hinge(&s);
        check(energy, &s.layout, &s.q, |e, h, q| e.formula(h, q), &claims).unwrap();
    }
}

#[test]
fn qb_pl_and_qb_int_conform() {
    for laplacian in [LaplacianMesh::Extrinsic, LaplacianMesh::IntrinsicDelaunay] {
        for height in [0.0, 1.0] {
            let s = patch(height);
            let mut energy = quadratic_vertex(&s, laplacian);
            check_global(&mut energy, &s.layout, &s.q).unwrap();
            check_claims(&energy, &s.layout, &s.q, &claims(&s, height == 0.0)).unwrap();
        }
    }
}

#[test]
fn the_membrane_conforms() {
    let s = patch(1.0);
    let section = section(&s);
    let formula = |e: &Membrane<_>, f: usize, q: &_| {
        e.formula(f, q, |strain| section.stretch_formula(f, strain))
    };
    check(membrane(&s), &s.layout, &s.q, formula, &claims(&s, true)).unwrap();
}

#[test]
fn the_strain_limit_conforms() {
    let s = patch(1.0);
    let formula = |e: &StrainLimit, f: usize, q: &_| e.formula(f, q);
    let energy = strain_limit(&s);
    check(energy, &s.layout, &s.q, formula, &claims(&s, true)).unwrap();
    let planted = Planted {
        honest: strain_limit(&s),
        in_gradient: false,
    };
    let formula = |e: &Planted<StrainLimit>, f: usize, q: &_| e.honest.formula(f, q);
    let violation = check(planted, &s.layout, &s.q, formula, &Claims::default()).unwrap_err();
    assert_eq!(violation.property, "Hessian equals that of dual numbers");
}

/// An energy of faces with one wrong entry in its gradient or in its Hessian.
struct Planted<L> {
    honest: L,
    in_gradient: bool,
}

impl<L: LocalEnergy<9, 3>> LocalEnergy<9, 3> for Planted<L> {
    const NODE_SIZES: [usize; 3] = [3; 3];
    fn name(&self) -> &'static str {
        "planted"
    }
    fn num_stencils(&self) -> usize {
        self.honest.num_stencils()
    }
    fn nodes(&self, stencil: usize) -> [Option<Dof>; 3] {
        self.honest.nodes(stencil)
    }
    fn value(&self, stencil: usize, q: &SVector<f64, 9>) -> f64 {
        self.honest.value(stencil, q)
    }
    fn gradient(&self, stencil: usize, q: &SVector<f64, 9>) -> (f64, SVector<f64, 9>) {
        let (value, mut gradient) = self.honest.gradient(stencil, q);
        if self.in_gradient {
            gradient[4] *= 1.0 + 1e-6;
        }
        (value, gradient)
    }
    fn hessian(&self, stencil: usize, q: &SVector<f64, 9>) -> LocalHessian<9> {
        let mut local = self.honest.hessian(stencil, q);
        if !self.in_gradient {
            local.hessian[(2, 7)] += 1e-6;
        }
        local
    }
    fn describe(&self, stencil: usize) -> String {
        self.honest.describe(stencil)
    }
}

/// With the measures of a state for rest values nothing pulls there, and the energy is what it was with the old ones again.
fn check_rest_measures<const N: usize, const K: usize>(
    s: &Setup,
    layout: &DofLayout,
    q: &[f64],
    local: impl LocalEnergy<N, K>,
) {
    let mut energy = Assembled::new(local, layout);
    let (before, name) = (energy.value(q), energy.name().to_owned());
    let at_rest = energy.rest_measures().expect("it has measures").rest();
    let measures = energy.rest_measures_mut().unwrap();
    let now = measures.measure(q);
    measures.set_rest(&now);
    assert_eq!(measures.rest(), now);
    let (mut gradient, mut scale) = (vec![0.0; q.len()], vec![0.0; q.len()]);
    energy.add_gradient(q, &mut gradient);
    energy.add_gradient(&s.at_rest, &mut scale[..s.at_rest.len()]);
    let largest = |values: &[f64]| values.iter().fold(0.0f64, |m, g| m.max(g.abs()));
    assert!(largest(&gradient) < 1e-12 * largest(&scale), "{name}");
    let measures = energy.rest_measures_mut().unwrap();
    measures.set_rest(&at_rest);
    measures.set_factor(2.5);
    assert!((energy.value(q) - 2.5 * before).abs() < 1e-14 * before);
}

#[test]
fn energies_with_rest_values_take_those_that_are_measured() {
    let s = patch(1.0);
    check_rest_measures(&s, &s.layout, &s.q, mid_edge::<Tangent>(&s, true));
    check_rest_measures(&s, &s.layout, &s.q, mid_edge::<Sine>(&s, true));
    check_rest_measures(&s, &s.layout, &s.q, membrane(&s));
    check_rest_measures(&s, &s.layout, &s.q, hinge::<Identity>(&s, true));
    check_rest_measures(&s, &s.layout, &s.q, hinge::<Tangent>(&s, true));
    check_rest_measures(&s, &s.layout, &s.q, corotational_edge(&s, true));
    check_rest_measures(&s, &s.layout, &s.q, corotational_face(&s, true));
    check_rest_measures(&s, &s.layout, &s.q, mid_edge_average(&s, true));
    let (mesh, section) = (&s.rest.mesh, section(&s));
    let lengths = EdgeLengths::new(mesh, Dof(0), &s.frames, &section, Default::default());
    check_rest_measures(&s, &s.layout, &s.q, lengths);
    let given = DiscreteStiffness {
        edges: None,
        areas: Some(0.4),
    };
    let areas = FaceAreas::new(mesh, Dof(0), &s.frames, &section, given);
    check_rest_measures(&s, &s.layout, &s.q, areas);
}

#[test]
fn a_planted_error_is_caught() {
    let s = patch(1.0);
    let section = section(&s);
    let formula = |e: &Planted<Membrane<_>>, f: usize, q: &_| {
        (e.honest).formula(f, q, |strain| section.stretch_formula(f, strain))
    };
    for (in_gradient, property) in [
        (true, "gradient equals that of dual numbers"),
        (false, "Hessian equals that of dual numbers"),
    ] {
        let planted = Planted {
            honest: membrane(&s),
            in_gradient,
        };
        let violation = check(planted, &s.layout, &s.q, formula, &Claims::default()).unwrap_err();
        assert_eq!(violation.property, property);
    }
}

#[test]
fn energies_do_not_depend_on_the_numbering() {
    let s = patch(1.0);
    let n = s.rest.mesh.num_vertices() as u32;
    let renamed = |v: u32| (v * 3 + 2) % n;
    let faces: Vec<_> = s
        .rest
        .mesh
        .faces()
        .iter()
        .map(|f| [f[1], f[2], f[0]].map(renamed))
        .collect();
    let mut positions = s.rest.positions.clone();
    let mut q = s.q.clone();
    for v in 0..n {
        positions[renamed(v) as usize] = s.rest.positions[v as usize];
        for axis in 0..3 {
            q[(3 * renamed(v)) as usize + axis] = s.q[(3 * v) as usize + axis];
        }
    }
    let mut other = setup_with(positions, faces);
    // The sign of an edge angle belongs to the order of its vertices.
    for (edge, [u, v]) in s.rest.mesh.edges().iter().enumerate() {
        let (a, b) = (renamed(*u), renamed(*v));
        let target = other
            .rest
            .mesh
            .edges()
            .iter()
            .position(|&e| e == [a.min(b), a.max(b)])
            .unwrap();
        let angles = 3 * n as usize;
        q[angles + target] = if a < b {
            s.q[angles + edge]
        } else {
            -s.q[angles + edge]
        };
    }
    other.q = q;
    let energies = |s: &Setup| -> [Box<dyn Energy>; 9] {
        [
            Box::new(Assembled::new(mid_edge::<Tangent>(s, false), &s.layout)),
            Box::new(Assembled::new(mid_edge_average(s, true), &s.layout)),
            Box::new(Assembled::new(hinge::<Tangent>(s, true), &s.layout)),
            Box::new(Assembled::new(corotational_edge(s, true), &s.layout)),
            Box::new(Assembled::new(corotational_face(s, true), &s.layout)),
            Box::new(Assembled::new(quadratic_hinge(s), &s.layout)),
            Box::new(quadratic_vertex(s, LaplacianMesh::Extrinsic)),
            Box::new(quadratic_vertex(s, LaplacianMesh::IntrinsicDelaunay)),
            Box::new(Assembled::new(membrane(s), &s.layout)),
        ]
    };
    for (first, second) in energies(&s).iter().zip(&energies(&other)) {
        let (a, b) = (first.value(&s.q), second.value(&other.q));
        assert!((a - b).abs() < 1e-12 * a.abs(), "{}: {a} {b}", first.name());
    }
}

#[test]
fn director_models_share_their_hessian_at_a_flat_rest_state() {
    let s = patch(0.0);
    for f in 0..s.rest.mesh.num_faces() {
        let gathered =
            Assembled::new(mid_edge::<Tangent>(&s, false), &s.layout).gather(f, &s.at_rest);
        let bac = mid_edge::<Tangent>(&s, false).hessian(f, &gathered).hessian;
        let dcs = mid_edge::<Sine>(&s, false).hessian(f, &gathered).hessian;
        let dso = mid_edge::<Identity>(&s, false)
            .hessian(f, &gathered)
            .hessian;
        assert!(bac.norm() > 0.0);
        assert!((bac - dcs).norm() < 1e-14 * bac.norm() && (bac - dso).norm() < 1e-14 * bac.norm());
    }
}

#[test]
fn discrete_shells_and_quadratic_bending_share_their_hessian_at_a_flat_rest_state() {
    let s = patch(0.0);
    let quadratic = quadratic_hinge(&s);
    for h in 0..quadratic.num_stencils() {
        let at_rest = Assembled::new(quadratic_hinge(&s), &s.layout).gather(h, &s.at_rest);
        let theta = hinge::<Identity>(&s, false).hessian(h, &at_rest).hessian;
        let tan = hinge::<Tangent>(&s, false).hessian(h, &at_rest).hessian;
        // An angle resists in the direction of the normal, here z; a vector bends alike in all three.
        let bent = quadratic.hessian(h, &at_rest).hessian;
        assert!(theta.norm() > 0.0);
        assert!((theta - tan).norm() < 1e-14 * theta.norm());
        for (i, j) in (0..12).flat_map(|i| (0..12).map(move |j| (i, j))) {
            let expected = if i % 3 == 2 { bent[(i, j)] } else { 0.0 };
            assert!(
                (theta[(i, j)] - expected).abs() < 1e-13 * bent.amax(),
                "{h}: {i} {j}"
            );
        }
    }
}
