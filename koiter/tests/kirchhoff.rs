//! The discrete Kirchhoff triangle against an independent implementation (`benchmarks/bending-patches/SOURCE.md`) and
//! against the exact energy of a cylinder.

use koiter::Vec3;
use koiter::assembly::{Assembled, Dof, DofLayout, Energy};
use koiter::energy::bending::{DiscreteKirchhoff, vertex_normals};
use koiter::integrate::relax_directors;
use koiter::material::{Homogeneous, StVenantKirchhoff};
use koiter::mesh::generate::{GridDiagonals, grid};
use koiter::mesh::{Surface, TriMesh};
use koiter::rest::{RestFrame, rest_frames};
use nalgebra::{Matrix2, Vector3};
use serde_json::Value;

const PATCHES: &str = include_str!("../../benchmarks/bending-patches/patches.json");
const REFERENCE: &str = include_str!("../../benchmarks/bending-patches/dkt.json");

/// Sums of a few hundred terms, each rounded.
const ROUND_OFF: f64 = 1e-12;
/// Both codes stop their minimisation when directors are found to about 1e-9.
const DIRECTOR_TOLERANCE: f64 = 1e-7;

type Bending = Assembled<DiscreteKirchhoff<Homogeneous<StVenantKirchhoff>>, 18, 6>;

/// A shell with a director at every vertex.
struct Setup {
    layout: DofLayout,
    directors: Dof,
    frames: Vec<RestFrame>,
    section: Homogeneous<StVenantKirchhoff>,
    mesh: TriMesh,
}

impl Setup {
    fn new(rest: &Surface, material: StVenantKirchhoff, thickness: f64) -> Self {
        let mut layout = DofLayout::new();
        layout.push_nodes(rest.mesh.num_vertices(), 3, true);
        let directors = layout.push_nodes(rest.mesh.num_vertices(), 3, true);
        Self {
            layout,
            directors,
            frames: rest_frames(rest).unwrap(),
            section: Homogeneous::uniform(material, thickness, rest.mesh.num_faces()),
            mesh: rest.mesh.clone(),
        }
    }

    fn bending(&self, rest_forms: Vec<[Vector3<f64>; 3]>) -> Bending {
        let energy = DiscreteKirchhoff::new(
            &self.mesh,
            Dof(0),
            self.directors,
            self.frames.clone(),
            rest_forms,
            self.section.clone(),
        );
        Assembled::new(energy, &self.layout)
    }

    fn flat(&self) -> Vec<[Vector3<f64>; 3]> {
        vec![[Vector3::zeros(); 3]; self.frames.len()]
    }

    fn relax(&self, bending: &mut Bending, q: &mut [f64]) {
        let range = self.directors.0 as usize..q.len();
        relax_directors(bending, &self.layout, range, &[], q).unwrap();
    }
}

fn unknowns(positions: &[Vec3], directors: &[Vec3]) -> Vec<f64> {
    let all = positions.iter().chain(directors);
    all.flat_map(|x| [x.x, x.y, x.z]).collect()
}

fn numbers(value: &Value) -> Vec<f64> {
    match value {
        Value::Array(items) => items.iter().flat_map(numbers).collect(),
        other => vec![other.as_f64().expect("a number")],
    }
}

fn points(value: &Value) -> Vec<Vec3> {
    let numbers = numbers(value);
    numbers
        .chunks_exact(3)
        .map(Vec3::from_column_slice)
        .collect()
}

/// The largest difference of entries, relative to the largest reference entry.
fn difference(found: &[f64], reference: &[f64]) -> f64 {
    assert_eq!(found.len(), reference.len());
    let largest =
        |values: &mut dyn Iterator<Item = f64>| values.fold(0.0f64, |m, x| m.max(x.abs()));
    largest(&mut found.iter().zip(reference).map(|(a, b)| a - b))
        / largest(&mut reference.iter().copied())
}

/// Reference rest forms, from the basis of the edges to the frames of the faces.
fn rest_forms(model: &Value, frames: &[RestFrame]) -> Vec<[Vector3<f64>; 3]> {
    let forms = points(&model["rest_forms"]);
    let in_frame = |(forms, frame): (&[Vec3], &RestFrame)| {
        let [m11, m12, m22] = frame.inverse;
        let inverse = Matrix2::new(m11, m12, 0.0, m22);
        std::array::from_fn(|n| {
            let form = forms[n];
            let turned =
                inverse.transpose() * Matrix2::new(form.x, form.y, form.y, form.z) * inverse;
            Vector3::new(turned.m11, turned.m22, turned.m12)
        })
    };
    forms.chunks_exact(3).zip(frames).map(in_frame).collect()
}

/// Shell, start positions and rest shape of every patch, with the reference.
fn patches() -> Vec<(Setup, Surface, Surface, Value)> {
    let [data, reference]: [Value; 2] =
        [PATCHES, REFERENCE].map(|text| serde_json::from_str(text).unwrap());
    let pairs = data
        .as_array()
        .unwrap()
        .iter()
        .zip(reference.as_array().unwrap());
    let patches: Vec<_> = pairs
        .map(|(data, model)| {
            assert_eq!(data["mesh"], model["mesh"]);
            let faces = numbers(&data["faces"]);
            let faces = faces
                .chunks_exact(3)
                .map(|f| [f[0], f[1], f[2]].map(|v| v as u32))
                .collect();
            let positions = points(&data["positions"]);
            let mesh = TriMesh::new(positions.len(), faces).unwrap();
            let [rest_positions] = ["rest_positions"].map(|key| points(&data[key]));
            let rest = Surface {
                mesh: mesh.clone(),
                positions: rest_positions,
            };
            let [h, e, nu] = ["thickness", "youngs_modulus", "poissons_ratio"]
                .map(|k| data[k].as_f64().unwrap());
            let setup = Setup::new(&rest, StVenantKirchhoff::new(e, nu), h);
            (setup, Surface { mesh, positions }, rest, model.clone())
        })
        .collect();
    assert_eq!(patches.len(), 6);
    patches
}

#[test]
fn energies_and_gradients_are_those_of_the_reference() {
    for (setup, surface, _, model) in patches() {
        let bending = setup.bending(rest_forms(&model, &setup.frames));
        let q = unknowns(&surface.positions, &points(&model["directors"]));
        let energy = model["energy"].as_f64().unwrap();
        let error = (bending.value(&q) - energy).abs() / energy;
        assert!(error < ROUND_OFF, "{}: {error:.1e}", model["mesh"]);
        let mut gradient = vec![0.0; q.len()];
        bending.add_gradient(&q, &mut gradient);
        let expected = numbers(&model["gradient_by_positions"]);
        let error = difference(&gradient[..expected.len()], &expected);
        assert!(error < ROUND_OFF, "{}: gradient {error:.1e}", model["mesh"]);
    }
}

#[test]
fn minima_over_the_directors_are_those_of_the_reference() {
    let mut compared = 0;
    for (setup, surface, _, model) in patches() {
        if model["same_from_five_starts"] != true {
            continue;
        }
        compared += 1;
        let mut bending = setup.bending(rest_forms(&model, &setup.frames));
        let mut q = unknowns(&surface.positions, &vertex_normals(&surface));
        setup.relax(&mut bending, &mut q);
        let minimum = model["minimum"].as_f64().unwrap();
        let error = (bending.value(&q) - minimum).abs() / minimum;
        assert!(
            error < DIRECTOR_TOLERANCE,
            "{}: minimum {error:.1e}",
            model["mesh"]
        );
        let found = &q[setup.directors.0 as usize..];
        let error = difference(found, &numbers(&model["minimum_directors"]));
        assert!(
            error < DIRECTOR_TOLERANCE,
            "{}: directors {error:.1e}",
            model["mesh"]
        );
        let mut gradient = vec![0.0; q.len()];
        bending.add_gradient(&q, &mut gradient);
        let expected = numbers(&model["gradient_of_minimum"]);
        let error = difference(&gradient[..expected.len()], &expected);
        assert!(
            error < DIRECTOR_TOLERANCE,
            "{}: gradient {error:.1e}",
            model["mesh"]
        );
    }
    assert!(compared >= 3, "{compared}");
}

#[test]
fn rest_directors_of_curved_shapes_are_those_of_the_reference() {
    let mut compared = 0;
    for (setup, _, rest, model) in patches() {
        if model["rest_directors"].is_null() {
            continue;
        }
        compared += 1;
        let mut bending = setup.bending(setup.flat());
        let mut q = unknowns(&rest.positions, &vertex_normals(&rest));
        setup.relax(&mut bending, &mut q);
        if model["mesh"] == "octahedron" {
            // Closed, with edges that turn by more than 60°: there are several minima, and ours is the lower one.
            let of_reference = unknowns(&rest.positions, &points(&model["rest_directors"]));
            assert!(bending.value(&q) < bending.value(&of_reference));
            continue;
        }
        let found = &q[setup.directors.0 as usize..];
        let error = difference(found, &numbers(&model["rest_directors"]));
        assert!(error < DIRECTOR_TOLERANCE, "{}: {error:.1e}", model["mesh"]);
        let forms = |f| bending.local().second_forms(f, &bending.gather(f, &q));
        let flatten = |forms: Vec<[Vector3<f64>; 3]>| -> Vec<f64> {
            forms
                .iter()
                .flatten()
                .flat_map(|f| [f.x, f.y, f.z])
                .collect()
        };
        let found = flatten((0..setup.frames.len()).map(forms).collect());
        let error = difference(&found, &flatten(rest_forms(&model, &setup.frames)));
        assert!(
            error < DIRECTOR_TOLERANCE,
            "{}: forms {error:.1e}",
            model["mesh"]
        );
    }
    assert_eq!(compared, 3);
}

/// "Better Bending" (2026), Section 8.2: a plate rolled to half a cylinder, at three of its refinements.
#[test]
fn the_energy_of_a_cylinder_converges() {
    let (radius, height, thickness) = (0.0325, 0.122, 1e-4f64);
    let material = StVenantKirchhoff::new(1e11, 0.3);
    let (a, b) = (material.lame_alpha, material.lame_beta);
    let width = std::f64::consts::PI * radius;
    let exact = (0.5 * a + b) * width * thickness.powi(3) * height / (12.0 * radius * radius);
    let errors = [5, 4, 3].map(|k| {
        let length = (2e-8 * 4f64.powi(k)).sqrt();
        let [n, m] = [width, height].map(|side| (side / length).floor() as usize);
        let plate = grid(width, height, n, m, GridDiagonals::Uniform).unwrap();
        let rolled = |x: &Vec3| {
            let angle = x.x / radius;
            Vec3::new(radius * angle.cos(), radius * angle.sin(), x.y)
        };
        let surface = Surface {
            mesh: plate.mesh.clone(),
            positions: plate.positions.iter().map(rolled).collect(),
        };
        let setup = Setup::new(&plate, material, thickness);
        let mut bending = setup.bending(setup.flat());
        let mut q = unknowns(&surface.positions, &vertex_normals(&surface));
        setup.relax(&mut bending, &mut q);
        1.0 - bending.value(&q) / exact
    });
    // As the square root of the number of vertices: half for each refinement, as printed there.
    for pair in errors.windows(2) {
        assert!((1.8..2.3).contains(&(pair[0] / pair[1])), "{errors:?}");
    }
    // The table, three refinements on, has 5.39e-2 J, printed to three digits.
    let at_table = exact * (1.0 - errors[2] / 8.0);
    assert!((at_table - 5.39e-2).abs() < 0.01e-2, "{at_table}");
}
