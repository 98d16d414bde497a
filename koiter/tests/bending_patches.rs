//! Bending energies against an independent implementation: `benchmarks/bending-patches/SOURCE.md`.

use koiter::Vec3;
use koiter::assembly::{Assembled, Dof, DofLayout, Energy};
use koiter::energy::bending::{
    AngleProfile, CorotationalEdge, CorotationalFace, DiscreteShells, FaceBending, Identity,
    LaplacianMesh, MidEdgeAverage, MidEdgeBending, QuadraticHinge, QuadraticVertex, Sine, Tangent,
    bending_stencils,
};
use koiter::geometry::{Wing, hinge_angle};
use koiter::integrate::relax_directors;
use koiter::material::{Homogeneous, Section, StVenantKirchhoff};
use koiter::mesh::{EdgeId, Surface, TriMesh};
use koiter::rest::{RestFrame, rest_frames};
use nalgebra::{Matrix3, Vector3};
use serde_json::Value;

const PATCHES: &str = include_str!("../../benchmarks/bending-patches/patches.json");

/// Sums of a few hundred terms, each rounded: found are 3e-14.
const ROUND_OFF: f64 = 1e-12;
/// Both codes stop their minimisation over directors when angles are found to about 1e-9.
const DIRECTOR_TOLERANCE: f64 = 1e-7;

type Average = Assembled<FaceBending<MidEdgeAverage<Homogeneous<StVenantKirchhoff>>>, 18, 6>;
type Bending<P> = Assembled<MidEdgeBending<P, Homogeneous<StVenantKirchhoff>>, 21, 9>;

fn numbers(value: &Value) -> Vec<f64> {
    match value {
        Value::Array(items) => items.iter().flat_map(numbers).collect(),
        other => vec![other.as_f64().expect("a number")],
    }
}

fn points(value: &Value) -> Vec<Vec3> {
    numbers(value)
        .chunks_exact(3)
        .map(Vec3::from_column_slice)
        .collect()
}

/// The largest difference of entries, relative to the largest reference entry.
fn difference(found: &[f64], reference: &[f64]) -> f64 {
    assert_eq!(found.len(), reference.len());
    let scale = reference
        .iter()
        .fold(f64::MIN_POSITIVE, |m, x| m.max(x.abs()));
    found
        .iter()
        .zip(reference)
        .fold(0.0f64, |m, (a, b)| m.max((a - b).abs()))
        / scale
}

struct Patch {
    name: String,
    data: Value,
    surface: Surface,
    rest: Surface,
    layout: DofLayout,
    angles: Dof,
    frames: Vec<RestFrame>,
}

impl Patch {
    fn new(data: &Value) -> Self {
        let positions = points(&data["positions"]);
        let faces: Vec<[u32; 3]> = numbers(&data["faces"])
            .chunks_exact(3)
            .map(|f| [f[0], f[1], f[2]].map(|v| v as u32))
            .collect();
        let mesh = TriMesh::new(positions.len(), faces).unwrap();
        let rest = Surface {
            mesh: mesh.clone(),
            positions: points(&data["rest_positions"]),
        };
        let mut layout = DofLayout::new();
        layout.push_nodes(mesh.num_vertices(), 3, true);
        let angles = layout.push_nodes(mesh.num_edges(), 1, true);
        Self {
            name: format!("{} {}", data["mesh"], data["rest"]),
            data: data.clone(),
            frames: rest_frames(&rest).unwrap(),
            surface: Surface { mesh, positions },
            rest,
            layout,
            angles,
        }
    }

    /// Positions, then the given angles put in the order of our edges.
    fn q(&self, positions: &[Vec3], angles: &[f64]) -> Vec<f64> {
        let mut q: Vec<f64> = positions.iter().flat_map(|x| [x.x, x.y, x.z]).collect();
        q.resize(self.layout.num_dofs(), 0.0);
        for (ours, angle) in self.edge_order().into_iter().zip(angles) {
            q[self.angles.0 as usize + ours] = *angle;
        }
        q
    }

    /// Our index of every edge of the data.
    fn edge_order(&self) -> Vec<usize> {
        let edges = numbers(&self.data["edges"]);
        let ours = |e: &[f64]| {
            self.surface
                .mesh
                .edges()
                .iter()
                .position(|uv| *uv == [e[0] as u32, e[1] as u32])
                .unwrap()
        };
        edges.chunks_exact(2).map(ours).collect()
    }

    /// Derivatives or values by angles in the order of the data.
    fn by_angles(&self, q: &[f64]) -> Vec<f64> {
        self.edge_order()
            .into_iter()
            .map(|e| q[self.angles.0 as usize + e])
            .collect()
    }

    fn gradient(&self, energy: &dyn Energy, q: &[f64]) -> Vec<f64> {
        let mut gradient = vec![0.0; q.len()];
        energy.add_gradient(q, &mut gradient);
        gradient
    }

    fn section(&self) -> Homogeneous<StVenantKirchhoff> {
        let [h, e, nu] = ["thickness", "youngs_modulus", "poissons_ratio"]
            .map(|k| self.data[k].as_f64().unwrap());
        Homogeneous::uniform(StVenantKirchhoff::new(e, nu), h, self.frames.len())
    }

    fn rigidity(&self) -> Vec<f64> {
        let section = self.section();
        (0..self.frames.len())
            .map(|f| section.flexural_rigidity(f))
            .collect()
    }

    fn is_curved(&self) -> bool {
        self.data["rest"] == "curved"
    }

    fn director_bending<P: AngleProfile>(&self, rest_forms: Vec<Vector3<f64>>) -> Bending<P> {
        let stencils = bending_stencils(&self.surface.mesh, Dof(0), self.angles);
        Assembled::new(
            MidEdgeBending::new(stencils, self.frames.clone(), rest_forms, self.section()),
            &self.layout,
        )
    }

    fn average(&self, rest_forms: Vec<Vector3<f64>>) -> Average {
        let stencils = bending_stencils(&self.surface.mesh, Dof(0), self.angles);
        let faces = FaceBending::<MidEdgeAverage<_>>::new(
            stencils,
            self.frames.clone(),
            rest_forms,
            self.section(),
        );
        Assembled::new(faces, &self.layout)
    }

    fn flat_forms(&self) -> Vec<Vector3<f64>> {
        vec![Vector3::zeros(); self.rest.mesh.num_faces()]
    }

    fn minimise<P: AngleProfile + 'static>(&self, bending: &mut Bending<P>, q: &mut [f64]) {
        let angles = self.angles.0 as usize..q.len();
        relax_directors(bending, &self.layout, angles, &[], q)
            .unwrap_or_else(|e| panic!("{}: {e}", self.name));
    }

    /// The rest second forms that the data's `rest_q` stand for.
    fn rest_forms(&self, model: &Value) -> Vec<Vector3<f64>> {
        if !self.is_curved() {
            return self.flat_forms();
        }
        let q = points(&model["rest_q"]);
        let form = |(frame, q): (&RestFrame, &Vec3)| {
            let rows = frame.second_form_matrix();
            Matrix3::from_fn(|i, j| rows[i][j]) * q
        };
        self.frames.iter().zip(&q).map(form).collect()
    }

    fn check_model<P: AngleProfile + 'static>(&self, key: &str) {
        let model = &self.data["models"][key];
        let name = format!("{} {key}", self.name);
        let mut bending = self.director_bending::<P>(self.rest_forms(model));
        let mut q = self.q(&self.surface.positions, &numbers(&self.data["edge_angles"]));
        let energy = model["energy"].as_f64().unwrap();
        assert!(
            (bending.value(&q) - energy).abs() < ROUND_OFF * energy,
            "{name}: {} {energy}",
            bending.value(&q)
        );
        let gradient = self.gradient(&bending, &q);
        let by_positions = numbers(&model["gradient_by_positions"]);
        let error = difference(&gradient[..by_positions.len()], &by_positions);
        assert!(
            error < ROUND_OFF,
            "{name}: gradient by positions {error:.1e}"
        );
        let error = difference(
            &self.by_angles(&gradient),
            &numbers(&model["gradient_by_angles"]),
        );
        assert!(error < ROUND_OFF, "{name}: gradient by angles {error:.1e}");
        if let Some(minimum) = model["minimum"].as_f64() {
            q[self.angles.0 as usize..].fill(0.0);
            self.minimise(&mut bending, &mut q);
            let error = (bending.value(&q) - minimum).abs() / minimum;
            assert!(error < DIRECTOR_TOLERANCE, "{name}: minimum {error:.1e}");
            let error = difference(&self.by_angles(&q), &numbers(&model["minimum_angles"]));
            assert!(
                error < DIRECTOR_TOLERANCE,
                "{name}: directors at the minimum {error:.1e}"
            );
        }
    }

    fn check_rest<P: AngleProfile + 'static>(&self, key: &str) {
        let model = &self.data["models"][key];
        let mut at_rest = self.director_bending::<P>(self.flat_forms());
        let mut q = self.q(&self.rest.positions, &[]);
        self.minimise(&mut at_rest, &mut q);
        let error = difference(&self.by_angles(&q), &numbers(&model["rest_angles"]));
        assert!(
            error < DIRECTOR_TOLERANCE,
            "{} {key}: rest directors {error:.1e}",
            self.name
        );
        let found = (0..self.rest.mesh.num_faces()).flat_map(|f| {
            let form = at_rest.local().second_form(f, &at_rest.gather(f, &q));
            [form.x, form.y, form.z]
        });
        let expected: Vec<f64> = self
            .rest_forms(model)
            .iter()
            .flat_map(|f| [f.x, f.y, f.z])
            .collect();
        let error = difference(&found.collect::<Vec<_>>(), &expected);
        assert!(
            error < DIRECTOR_TOLERANCE,
            "{} {key}: rest second forms {error:.1e}",
            self.name
        );
    }
}

fn patches() -> Vec<Patch> {
    let data: Value = serde_json::from_str(PATCHES).unwrap();
    let patches: Vec<Patch> = data.as_array().unwrap().iter().map(Patch::new).collect();
    assert_eq!(patches.len(), 6);
    patches
}

#[test]
fn hinge_angles_are_those_of_the_reference() {
    for patch in patches() {
        let mesh = &patch.surface.mesh;
        let angles = patch.edge_order().into_iter().map(|e| {
            let edge = EdgeId(e as u32);
            let [u, v] = mesh.edges()[e].map(|v| patch.surface.positions[v as usize]);
            let [Some(c), Some(d)] = [0, 1].map(|side| mesh.opposite_vertex(edge, side)) else {
                return 0.0;
            };
            let [c, d] = [c, d].map(|v| patch.surface.positions[v.0 as usize]);
            hinge_angle(&Wing::new(&u, &v, &c), &Wing::new(&v, &u, &d))
        });
        let error = difference(
            &angles.collect::<Vec<_>>(),
            &numbers(&patch.data["hinge_angles"]),
        );
        assert!(error < ROUND_OFF, "{}: {error:.1e}", patch.name);
    }
}

/// Checks energy and gradient of a model of positions only against `key` of every patch.
fn check_positions(key: &str, energy: impl Fn(&Patch) -> Box<dyn Energy>) {
    for patch in patches() {
        let bending = energy(&patch);
        let q = patch.q(&patch.surface.positions, &[]);
        let model = &patch.data["models"][key];
        let expected = model["energy"].as_f64().unwrap();
        let found = bending.value(&q);
        assert!(
            (found - expected).abs() < ROUND_OFF * expected,
            "{} {key}: {found} {expected}",
            patch.name
        );
        let expected = numbers(&model["gradient_by_positions"]);
        let gradient = patch.gradient(bending.as_ref(), &q);
        let error = difference(&gradient[..expected.len()], &expected);
        assert!(
            error < ROUND_OFF,
            "{} {key}: gradient {error:.1e}",
            patch.name
        );
        assert!(
            gradient[expected.len()..]
                .iter()
                .all(|moment| *moment == 0.0)
        );
    }
}

fn hinges<P: AngleProfile + 'static>(p: &Patch) -> Box<dyn Energy> {
    let (frames, rigidity) = (&p.frames, p.rigidity());
    let hinges = DiscreteShells::<P>::new(&p.rest, Dof(0), frames, p.is_curved(), &rigidity);
    Box::new(Assembled::new(hinges, &p.layout))
}

fn vertices(p: &Patch, laplacian: LaplacianMesh) -> Box<dyn Energy> {
    let (frames, rigidity) = (&p.frames, p.rigidity());
    Box::new(QuadraticVertex::new(
        &p.rest,
        Dof(0),
        &p.layout,
        frames,
        &rigidity,
        laplacian,
    ))
}

#[test]
fn hinge_energies_and_gradients_are_those_of_the_reference() {
    check_positions("DS(theta)", hinges::<Identity>);
    check_positions("DS(tan)", hinges::<Tangent>);
}

#[test]
fn corotational_energies_and_gradients_are_those_of_the_reference() {
    check_positions("CH(ES)", |p| {
        let (frames, rigidity) = (&p.frames, p.rigidity());
        let edges = CorotationalEdge::new(&p.rest, Dof(0), frames, p.is_curved(), &rigidity);
        Box::new(Assembled::new(edges, &p.layout))
    });
    check_positions("CH(FS)", |p| {
        let stencils = bending_stencils(&p.surface.mesh, Dof(0), p.angles);
        let (curved, rigidity) = (p.is_curved(), p.rigidity());
        let faces =
            FaceBending::<CorotationalFace>::new(&p.rest, stencils, &p.frames, curved, &rigidity);
        Box::new(Assembled::new(faces, &p.layout))
    });
}

#[test]
fn quadratic_energies_and_gradients_are_those_of_the_reference() {
    check_positions("QB(CR)", |p| {
        let hinges = QuadraticHinge::new(&p.rest, Dof(0), &p.frames, &p.rigidity());
        Box::new(Assembled::new(hinges, &p.layout))
    });
    check_positions("QB(PL)", |p| vertices(p, LaplacianMesh::Extrinsic));
    check_positions("QB(int)", |p| vertices(p, LaplacianMesh::IntrinsicDelaunay));
}

#[test]
fn averaged_normals_have_the_energies_and_gradients_of_the_reference() {
    check_positions("M-e.Av.", |p| {
        let mut faces = p.average(p.flat_forms());
        if p.is_curved() {
            let at_rest = p.q(&p.rest.positions, &[]);
            let form = |f| faces.local().second_form(f, &faces.gather(f, &at_rest));
            let forms = (0..p.rest.mesh.num_faces()).map(form).collect();
            faces.local_mut().set_rest_forms(forms);
        }
        Box::new(faces)
    });
}

#[test]
fn dcs_energies_and_gradients_are_those_of_the_reference() {
    patches().iter().for_each(|p| p.check_model::<Sine>("DCS"));
}

#[test]
fn dso_energies_gradients_and_minima_are_those_of_the_reference() {
    patches()
        .iter()
        .for_each(|p| p.check_model::<Identity>("DSO"));
}

#[test]
fn bac_energies_gradients_and_minima_are_those_of_the_reference() {
    patches()
        .iter()
        .for_each(|p| p.check_model::<Tangent>("BAC"));
}

#[test]
fn rest_directors_of_curved_shapes_are_those_of_the_reference() {
    let curved: Vec<Patch> = patches()
        .into_iter()
        .filter(|p| p.data["rest"] == "curved")
        .collect();
    assert_eq!(curved.len(), 3);
    for patch in &curved {
        // The energy of DCS is not convex in the angles: on a closed octahedron, whose edges turn by more than 60°, it has
        // several local minima, and the reference is in another one.
        if patch.data["mesh"] != "octahedron" {
            patch.check_rest::<Sine>("DCS");
        }
        patch.check_rest::<Identity>("DSO");
        patch.check_rest::<Tangent>("BAC");
    }
}
