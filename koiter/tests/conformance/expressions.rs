//! Energies that a user writes: as one formula in Rust, and as texts.

use koiter::Vec3;
use koiter::assembly::{
    Assembled, Differentiated, Dof, ElementFunction, Energy, HessianBuilder, LocalEnergy, Pattern,
    PatternBuilder, PsdProjection, SymmetricMatrix,
};
use koiter::energy::bending::{DiscreteShells, HingeSprings, HingeWeight, Identity};
use koiter::energy::expression::{
    EdgeElement, Edges, ElementKind, Elements, FaceElement, Faces, HingeElement, Hinges, Names,
    Parameter, Potential, Program, RateEnergy, RatePotential, Settings, VertexElement, Vertices,
    WholePotential,
};
use koiter::energy::{DiscreteStiffness, EdgeLengths, FaceAreas, edge_rest_lengths};
use koiter::geometry::over_numbers::{norm, point, sub};
use koiter::geometry::{Jet, Real, Wing, hinge_angle};
use koiter::mesh::EdgeId;
use koiter::testing::{Claims, check};
use std::sync::Arc;

use super::setup::*;

fn parse(quantities: &[&str], text: &str) -> Program {
    let parameters = ["k".to_owned(), "c".to_owned()];
    let names = Names {
        quantities,
        parameters: &parameters,
    };
    names.parse(text).unwrap()
}

/// k = 2.3, c = 0.7 + 0.1 t.
fn settings() -> Settings {
    let parameters: [Parameter; 2] = [Arc::new(|_| 2.3), Arc::new(|time| 0.7 + 0.1 * time)];
    Settings::new(parameters.to_vec())
}

fn edge(s: &Setup, index: usize, length: f64) -> EdgeElement {
    let vertices = s.rest.mesh.edges()[index];
    let [a, b] = vertices.map(|v| s.rest.positions[v as usize]);
    EdgeElement {
        ends: vertices.map(|v| Dof(3 * v)),
        vertices,
        rest: (a + b) * 0.5,
        length,
    }
}

pub(super) fn edges(s: &Setup) -> Edges {
    let lengths = edge_rest_lengths(&s.rest.mesh, &s.frames);
    let all = lengths.iter().enumerate();
    Edges(all.map(|(index, length)| edge(s, index, *length)).collect())
}

pub(super) fn hinges(s: &Setup) -> Hinges {
    let lengths = edge_rest_lengths(&s.rest.mesh, &s.frames);
    let mut hinges = Vec::new();
    for (index, faces) in s.rest.mesh.edge_faces().iter().enumerate() {
        let [Some(first), Some(second)] = *faces else {
            continue;
        };
        let [u, v] = s.rest.mesh.edges()[index];
        let apexes = [0, 1].map(|side| {
            let apex = s.rest.mesh.opposite_vertex(EdgeId(index as u32), side);
            apex.unwrap().0
        });
        let [a, b, c, d] = [u, v, apexes[0], apexes[1]].map(|v| s.rest.positions[v as usize]);
        let areas = [first, second].map(|face| s.frames[face.0 as usize].area);
        hinges.push(HingeElement {
            edge: edge(s, index, lengths[index]),
            apexes: apexes.map(|v| Dof(3 * v)),
            angle: hinge_angle(&Wing::new(&a, &b, &c), &Wing::new(&b, &a, &d)),
            height: (areas[0] + areas[1]) / (3.0 * lengths[index]),
        });
    }
    Hinges(hinges)
}

pub(super) fn faces(s: &Setup) -> Faces {
    let faces = s.rest.mesh.faces().iter().enumerate();
    let element = |(face, corners): (usize, &[u32; 3])| FaceElement {
        corners: corners.map(|v| Dof(3 * v)),
        face: face as u32,
        rest: s.rest.corners(face).iter().sum::<Vec3>() / 3.0,
        frame: s.frames[face],
        axis: [0.6, 0.8],
        thickness: THICKNESS,
    };
    Faces(faces.map(element).collect())
}

pub(super) fn vertices(s: &Setup) -> Vertices {
    let positions = s.rest.positions.iter().enumerate();
    let element = |(vertex, rest): (usize, &Vec3)| VertexElement {
        dof: Dof(3 * vertex as u32),
        vertex: vertex as u32,
        rest: *rest,
        area: 0.2 + 0.05 * vertex as f64,
        mass: 0.3,
    };
    Vertices(positions.map(element).collect())
}

pub(super) fn potential<const N: usize, const K: usize, E: Elements<N, K>>(
    elements: E,
    text: &str,
) -> Differentiated<Potential<E>> {
    let program = parse(E::NAMES, text);
    let local = Potential::new("written".into(), elements, program, settings(), true);
    Differentiated(local)
}

fn check_potential<const N: usize, const K: usize, E: Elements<N, K>>(
    s: &Setup,
    elements: E,
    text: &str,
    claims: &Claims,
) {
    let formula = |e: &Differentiated<Potential<E>>, i: usize, q: &[Jet<N>; N]| e.0.energy(i, q);
    check(potential(elements, text), &s.layout, &s.q, formula, claims).unwrap();
}

#[test]
fn energies_as_texts_conform() {
    let s = patch(1.0);
    let free = Claims::default();
    let rigid = Claims {
        rigid_motion_invariant: true,
        ..Claims::default()
    };
    let resting = super::claims(&s, true);
    let of_vertices = "k * ((x - rest_x)^2 + c * (y - rest_y)^2 + sin(z) / (2 + mass)) / rest_area";
    check_potential(&s, vertices(&s), of_vertices, &free);
    check_potential(&s, edges(&s), "k * (length / rest_length - 1)^2", &resting);
    check_potential(
        &s,
        edges(&s),
        "exp(-tz) * length^1.5 + x * atan2(y, 2 + z)",
        &free,
    );
    check_potential(
        &s,
        hinges(&s),
        "u = angle - rest_angle; k * u^2 / rest_height + c * u^4 * length",
        &resting,
    );
    check_potential(
        &s,
        faces(&s),
        "k * (c * strain_trace^2 + strain_11^2 + 2 * strain_12^2 + strain_22^2)",
        &resting,
    );
    check_potential(
        &s,
        faces(&s),
        "log(area / rest_area)^2 + abs(strain_det) + min(k * area, max(strain_11, strain_22) + 9)",
        &rigid,
    );
    check_potential(
        &s,
        faces(&s),
        "nx * x + ny^3 + acos(nz / 2) * smoothstep(-9, 9, y)",
        &free,
    );
}

#[test]
fn forces_by_dissipation_functions_conform() {
    let s = patch(1.0);
    let base: Vec<f64> =
        s.q.iter()
            .enumerate()
            .map(|(i, x)| x - 0.03 * (i as f64).cos())
            .collect();
    let wind = "u = (c - vx) * nx - vy * ny + (2 - vz) * nz; k / 6 * abs(u)^3 + 0.1 * vx * area";
    let names = ElementKind::Face.rate_names();
    let local = RatePotential::new(
        "wind".into(),
        faces(&s),
        parse(&names, wind),
        settings(),
        true,
    );
    let mut energy = Assembled::new(local, &s.layout);
    // Nothing moves before a step begins.
    assert_eq!(energy.value(&s.q), 0.0);
    energy.begin(&s.at_rest, &base, 0.3);
    let formula = |e: &RatePotential<Faces>, i: usize, q: &[Jet<9>; 9]| e.formula(i, q);
    let local = energy.local().clone();
    check(local, &s.layout, &s.q, formula, &Claims::default()).unwrap();
    let names = ElementKind::Hinge.rate_names();
    let drag = parse(&names, "k * (vx^2 + vy^2 + vz^2) * (1 + angle^2)");
    let local = RatePotential::new("drag".into(), hinges(&s), drag, settings(), false);
    let mut energy = Assembled::new(local, &s.layout);
    energy.begin(&s.at_rest, &base, 0.3);
    let formula = |e: &RatePotential<Hinges>, i: usize, q: &[Jet<12>; 12]| e.formula(i, q);
    let local = energy.local().clone();
    check(local, &s.layout, &s.q, formula, &Claims::default()).unwrap();
}

/// Value, gradient and Hessian of two energies agree element by element, up to the rounding of some hundred operations.
fn check_same<const N: usize, const K: usize>(
    s: &Setup,
    written: impl LocalEnergy<N, K>,
    built_in: impl LocalEnergy<N, K>,
) {
    let (written, built_in) = (
        Assembled::new(written, &s.layout),
        Assembled::new(built_in, &s.layout),
    );
    assert_eq!(
        written.local().num_stencils(),
        built_in.local().num_stencils()
    );
    for stencil in 0..built_in.local().num_stencils() {
        let a = written
            .local()
            .hessian(stencil, &written.gather(stencil, &s.q));
        let b = built_in
            .local()
            .hessian(stencil, &built_in.gather(stencil, &s.q));
        assert!(
            (a.value - b.value).abs() < 1e-13 * (1.0 + b.value),
            "{stencil}"
        );
        assert!(
            (a.gradient - b.gradient).amax() < 1e-12 * b.gradient.amax(),
            "{stencil}"
        );
        assert!(
            (a.hessian - b.hessian).amax() < 1e-12 * b.hessian.amax(),
            "{stencil}"
        );
    }
}

#[test]
fn texts_of_discrete_shells_are_the_built_in_energies() {
    let s = patch(1.0);
    let (mesh, section) = (&s.rest.mesh, section(&s));
    let given = DiscreteStiffness {
        edges: Some(2.3),
        areas: Some(2.3),
    };
    let lengths = EdgeLengths::new(mesh, Dof(0), &s.frames, &section, given);
    check_same(
        &s,
        potential(edges(&s), "k * (1 - length / rest_length)^2"),
        lengths,
    );
    let areas = FaceAreas::new(mesh, Dof(0), &s.frames, &section, given);
    check_same(
        &s,
        potential(faces(&s), "k * (1 - area / rest_area)^2"),
        areas,
    );
    let springs = HingeSprings {
        weight: HingeWeight::Barycentric,
        stiffness: Some(2.3),
    };
    let (rest, frames, unused) = (&s.rest, &s.frames, rigidity(&s));
    let built_in =
        DiscreteShells::<Identity>::with_springs(rest, Dof(0), frames, true, &unused, springs);
    let text = "k * (angle - rest_angle)^2 / rest_height";
    check_same(&s, potential(hinges(&s), text), built_in);
}

/// The Hessian of an energy of a whole shell, sparse and of low rank together, is the derivative of its gradient.
#[test]
fn an_energy_of_a_whole_shell_has_its_whole_hessian() {
    let s = patch(1.0);
    let mut energy = whole(
        &s,
        "k * (volume / rest_volume - 1)^2 + c * (area / rest_area)^4 + volume * area",
    );
    let mut builder = PatternBuilder::default();
    energy.add_to_pattern(&s.q, &mut builder);
    let pattern = Arc::new(Pattern::new(&s.layout, &builder.finish()));
    energy.bind(&pattern);
    let mut matrix = SymmetricMatrix::zeros(pattern);
    let (mut gradient, mut coupling) = (vec![0.0; s.q.len()], vec![0.0; s.q.len()]);
    let mut hessian = HessianBuilder {
        matrix: &mut matrix,
        layout: &s.layout,
        prescribed_step: &[],
        coupling: &mut coupling,
    };
    energy.add_derivatives(&s.q, PsdProjection::Exact, &mut gradient, &mut hessian);
    let direction: Vec<f64> = (0..s.q.len()).map(|i| ((i * 5 + 2) as f64).cos()).collect();
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(x, y)| x * y).sum::<f64>();
    let mut image = matrix.multiply(&direction);
    let dense = energy.low_rank(&s.q);
    assert_eq!(dense.len(), 2, "f is convex in volume and area here");
    for term in &dense {
        let share = term.weight * dot(&term.vector, &direction);
        let sums = image.iter_mut().zip(&term.vector);
        sums.for_each(|(y, g)| *y += share * g);
    }
    let at = |h: f64| {
        let x: Vec<f64> = (s.q.iter().zip(&direction))
            .map(|(x, d)| x + h * d)
            .collect();
        let mut gradient = vec![0.0; x.len()];
        energy.add_gradient(&x, &mut gradient);
        (energy.value(&x), gradient)
    };
    let slope = dot(&gradient, &direction);
    let errors = [4e-4, 2e-4, 1e-4].map(|h| {
        let ((v1, g1), (v0, g0)) = (at(h), at(-h));
        let by_gradient = (0..image.len()).map(|i| ((g1[i] - g0[i]) / (2.0 * h) - image[i]).abs());
        [
            ((v1 - v0) / (2.0 * h) - slope).abs(),
            by_gradient.fold(0.0, f64::max),
        ]
    });
    for pair in errors.windows(2) {
        for which in 0..2 {
            let ratio = pair[0][which] / pair[1][which];
            assert!((3.5..4.5).contains(&ratio), "with h²: {errors:?}");
        }
    }
}

#[test]
fn concave_functions_of_a_whole_shell_say_so() {
    let s = patch(1.0);
    let weights = |text: &str| -> Vec<f64> {
        let terms = whole(&s, text).low_rank(&s.q);
        terms.iter().map(|term| term.weight).collect()
    };
    assert!(weights("volume - 2 * area").is_empty());
    assert!(matches!(weights("-area^2")[..], [weight] if weight < 0.0));
    let mut both = weights("volume^2 - area^2");
    both.sort_by(f64::total_cmp);
    assert!(matches!(both[..], [a, b] if a < 0.0 && b > 0.0), "{both:?}");
}

pub(super) fn whole(s: &Setup, text: &str) -> WholePotential {
    let faces = s.rest.mesh.faces().iter();
    let corners: Vec<[Dof; 3]> = faces.map(|face| face.map(|v| Dof(3 * v))).collect();
    let rest: Vec<[Vec3; 3]> = (0..corners.len())
        .map(|face| s.rest.corners(face))
        .collect();
    let program = parse(ElementKind::Shell.names(), text);
    WholePotential::new(
        "whole".into(),
        &corners,
        &s.layout,
        &rest,
        program,
        settings(),
    )
}

/// Twenty lines of a user: a rubber band from every vertex to where it was, whose force does not grow without bound.
struct Tethers {
    anchors: Vec<Vec3>,
    stiffness: f64,
    slack: f64,
}

impl ElementFunction<3, 1> for Tethers {
    fn name(&self) -> &str {
        "tethers"
    }
    fn num_elements(&self) -> usize {
        self.anchors.len()
    }
    fn nodes(&self, element: usize) -> [Option<Dof>; 1] {
        [Some(Dof(3 * element as u32))]
    }
    fn energy<R: Real>(&self, element: usize, q: &[R; 3]) -> R {
        let anchor = self.anchors[element];
        let away = norm(&sub(
            &point(q, 0),
            &[anchor.x, anchor.y, anchor.z].map(R::from),
        ));
        ((away * away + self.slack * self.slack).sqrt() - self.slack) * self.stiffness
    }
}

#[test]
fn an_energy_of_one_formula_conforms() {
    let s = patch(1.0);
    let tethers = Tethers {
        anchors: s.rest.positions.clone(),
        stiffness: 3.0,
        slack: 0.05,
    };
    let formula = |e: &Differentiated<Tethers>, i: usize, q: &[Jet<3>; 3]| e.0.energy(i, q);
    let claims = Claims::default();
    check(Differentiated(tethers), &s.layout, &s.q, formula, &claims).unwrap();
}
