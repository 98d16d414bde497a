//! Materials: derivatives, invariance, common limits, and every pairing with a second fundamental form.

use koiter::Vec3;
use koiter::assembly::{Dof, DofLayout, LocalEnergy};
use koiter::energy::Membrane;
use koiter::energy::bending::{
    AngleProfile, DiscreteKirchhoff, Identity, MidEdgeBending, Sine, Tangent, bending_stencils,
};
use koiter::geometry::{Jet, Real};
use koiter::material::{
    ByFace, Density, Homogeneous, NeoHookean, Orthotropic, OrthotropicModuli, Section,
    StVenantKirchhoff, TensionField,
};
use koiter::mesh::{Surface, TriMesh};
use koiter::rest::{RestFrame, rest_frames};
use koiter::testing::{Claims, check};
use nalgebra::{Matrix2, Rotation2, Vector3};

const YOUNG: f64 = 2.0;
const POISSON: f64 = 0.3;

fn neo_hookean() -> NeoHookean {
    NeoHookean::new(YOUNG, POISSON).unwrap()
}

fn isotropic_moduli() -> OrthotropicModuli {
    OrthotropicModuli {
        along: YOUNG,
        across: YOUNG,
        poissons_ratio: POISSON,
        shear: YOUNG / (2.0 * (1.0 + POISSON)),
    }
}

fn woven(angle: f64) -> Orthotropic {
    let moduli = OrthotropicModuli {
        across: 0.4 * YOUNG,
        shear: 0.1 * YOUNG,
        ..isotropic_moduli()
    };
    Orthotropic::new(&moduli, [angle.cos(), angle.sin()]).unwrap()
}

/// Taut, wrinkled and slack ones among them, none at a switch.
const STRAINS: [[f64; 3]; 4] = [
    [0.2, 0.1, 0.05],
    [0.15, -0.25, 0.1],
    [-0.1, -0.2, 0.03],
    [0.6, -0.1, -0.2],
];

fn check_derivatives<M: Density>(material: M) {
    for strain in STRAINS {
        let strain = Vector3::from(strain);
        let found = material.response(0, &strain);
        let jets: [Jet<3>; 3] = std::array::from_fn(|i| Jet::variable(strain[i], i));
        let oracle = material.formula(0, jets);
        // A hundred roundings of numbers of the size of the modulus.
        let close = |a: f64, b: f64| (a - b).abs() < 1e-13 * YOUNG;
        assert!(close(found.density, oracle.value()), "{material:?}");
        for i in 0..3 {
            assert!(close(found.stress[i], oracle.gradient()[i]), "{material:?}");
            for j in 0..3 {
                let (tangent, expected) = (found.tangent[(i, j)], oracle.hessian(i, j));
                assert!(
                    (tangent - expected).abs() < 1e-12 * YOUNG,
                    "{material:?} {strain}"
                );
            }
        }
        let direction = Vector3::new(0.6, -0.3, 0.5);
        let errors = [2e-3, 1e-3, 5e-4].map(|h| {
            let [after, before] =
                [h, -h].map(|step| material.response(0, &(strain + direction * step)));
            let slope = (after.density - before.density) / (2.0 * h);
            let image = (after.stress - before.stress) / (2.0 * h);
            let by_value = (slope - found.stress.dot(&direction)).abs();
            [by_value, (image - found.tangent * direction).norm()]
        });
        for pair in errors.windows(2) {
            for k in 0..2 {
                // A quarter for half the step, or the round-off of the quotients.
                let noise = 1e-15 * YOUNG / 5e-4 * 10.0;
                assert!(
                    pair[1][k] < 0.3 * pair[0][k] + noise,
                    "{material:?}: {errors:?}"
                );
            }
        }
    }
}

#[test]
fn stress_and_tangent_are_derivatives_of_the_density() {
    check_derivatives(StVenantKirchhoff::new(YOUNG, POISSON));
    check_derivatives(neo_hookean());
    check_derivatives(NeoHookean::new(YOUNG, 0.0).unwrap());
    check_derivatives(NeoHookean::new(YOUNG, 0.5).unwrap());
    check_derivatives(woven(0.4));
    check_derivatives(TensionField::new(YOUNG, POISSON));
}

/// An isotropic density is the same for a strain seen in a turned frame.
fn check_isotropy<M: Density>(material: M) {
    for [e11, e22, e12] in STRAINS {
        let expected = material.response(0, &Vector3::new(e11, e22, e12)).density;
        let turn = *Rotation2::new(0.8).matrix();
        let turned = turn * Matrix2::new(e11, e12, e12, e22) * turn.transpose();
        let turned = Vector3::new(turned[(0, 0)], turned[(1, 1)], turned[(0, 1)]);
        let found = material.response(0, &turned).density;
        assert!((found - expected).abs() < 1e-14 * YOUNG, "{material:?}");
    }
}

#[test]
fn isotropic_materials_know_no_direction() {
    check_isotropy(StVenantKirchhoff::new(YOUNG, POISSON));
    check_isotropy(neo_hookean());
    check_isotropy(TensionField::new(YOUNG, POISSON));
    check_isotropy(Orthotropic::new(&isotropic_moduli(), [0.6, 0.8]).unwrap());
}

#[test]
fn all_isotropic_materials_share_the_tangent_at_rest() {
    let zero = Vector3::zeros();
    let expected = StVenantKirchhoff::new(YOUNG, POISSON);
    let expected = Homogeneous::uniform(expected, 0.1, 1).stretch(0, &zero);
    let neo_hookean = Homogeneous::uniform(neo_hookean(), 0.1, 1);
    let tension_field = Homogeneous::uniform(TensionField::new(YOUNG, POISSON), 0.1, 1);
    let orthotropic = Orthotropic::new(&isotropic_moduli(), [0.6, 0.8]).unwrap();
    let orthotropic = Homogeneous::uniform(orthotropic, 0.1, 1);
    let sections: [&dyn Section; 3] = [&neo_hookean, &tension_field, &orthotropic];
    for section in sections {
        let found = section.stretch(0, &zero);
        assert_eq!((found.density, found.stress), (0.0, zero));
        assert!((found.tangent - expected.tangent).norm() < 1e-14 * expected.tangent.norm());
        let ratio = section.bend(0, &zero).tangent / (0.01 / 12.0);
        assert!((ratio - expected.tangent).norm() < 1e-14 * expected.tangent.norm());
    }
}

/// A patch with an inner vertex, in the state `at_rest`, and generically strained and bent in `q`.
struct Patch {
    rest: Surface,
    layout: DofLayout,
    edges: Dof,
    frames: Vec<RestFrame>,
    at_rest: Vec<f64>,
    q: Vec<f64>,
}

fn patch(height: f64) -> Patch {
    let points = [
        [0.0, 0.0, 0.1],
        [1.0, -0.1, 0.0],
        [0.45, 0.9, 0.05],
        [0.5, 0.3, 0.25],
        [-0.6, 0.8, -0.1],
        [1.4, 0.8, -0.2],
    ];
    let faces = vec![[0, 1, 3], [1, 2, 3], [2, 0, 3], [0, 2, 4], [2, 1, 5]];
    let positions: Vec<Vec3> = points.map(|[x, y, z]| Vec3::new(x, y, height * z)).to_vec();
    let rest =
        Surface::from_mesh(TriMesh::new(positions.len(), faces).unwrap(), positions).unwrap();
    let mut layout = DofLayout::new();
    layout.push_nodes(rest.mesh.num_vertices(), 3, true);
    let edges = layout.push_nodes(rest.mesh.num_edges(), 1, true);
    let mut at_rest: Vec<f64> = rest
        .positions
        .iter()
        .flat_map(|x| [x.x, x.y, x.z])
        .collect();
    let num_positions = at_rest.len();
    at_rest.resize(layout.num_dofs(), 0.0);
    let amplitude = |i: usize| if i < num_positions { 0.08 } else { 0.2 };
    let moved = |(i, x): (usize, &f64)| x + amplitude(i) * ((i * 7 + 1) as f64 * 1.3).sin();
    let q = at_rest.iter().enumerate().map(moved).collect();
    let frames = rest_frames(&rest).unwrap();
    Patch {
        rest,
        layout,
        edges,
        frames,
        at_rest,
        q,
    }
}

impl Patch {
    fn membrane<S: Section>(&self, section: S) -> Membrane<S> {
        Membrane::new(&self.rest.mesh, Dof(0), self.frames.clone(), section)
    }

    /// Rest forms that no surface has.
    fn bending<P: AngleProfile, S: Section>(&self, section: S) -> MidEdgeBending<P, S> {
        let stencils = bending_stencils(&self.rest.mesh, Dof(0), self.edges);
        let form = |f: usize| Vector3::new(0.3, -0.7, 0.2) * (f as f64 + 1.0);
        let forms = (0..self.frames.len()).map(form).collect();
        MidEdgeBending::new(stencils, self.frames.clone(), forms, section)
    }
}

const MOVES: Claims = Claims {
    rigid_motion_invariant: true,
    directions_from: None,
    rest: None,
};

fn check_bending<P: AngleProfile, M: Density + Clone>(s: &Patch, section: &Homogeneous<M>) {
    let formula = |e: &MidEdgeBending<P, _>, f: usize, q: &_| {
        e.formula(f, q, |change| section.bend_formula(f, change))
    };
    let bending = s.bending::<P, _>(section.clone());
    check(bending, &s.layout, &s.q, formula, &MOVES).unwrap();
}

/// Directors at the vertices, anything but unit normals.
fn check_dkt<M: Density + Clone>(s: &Patch, section: &Homogeneous<M>) {
    let num_vertices = s.rest.mesh.num_vertices();
    let mut layout = DofLayout::new();
    layout.push_nodes(num_vertices, 3, true);
    let directors = layout.push_nodes(num_vertices, 3, true);
    let mut q = s.q[..3 * num_vertices].to_vec();
    for v in 0..num_vertices {
        let x = v as f64;
        let director = Vec3::new(0.3 * (1.7 * x).sin(), 0.3 * (2.3 * x).cos(), 1.0).normalize();
        q.extend(director.iter());
    }
    let form = |f: usize, n: usize| Vector3::new(0.3, -0.7, 0.2) * (f + n) as f64;
    let forms = (0..s.frames.len()).map(|f| [0, 1, 2].map(|n| form(f, n)));
    let (mesh, frames) = (&s.rest.mesh, s.frames.clone());
    let (forms, own) = (forms.collect(), section.clone());
    let bending = DiscreteKirchhoff::new(mesh, Dof(0), directors, frames, forms, own);
    let formula = |e: &DiscreteKirchhoff<_>, f: usize, q: &_| {
        e.formula(f, q, |change| section.bend_formula(f, change))
    };
    let claims = Claims {
        directions_from: Some(directors),
        ..MOVES
    };
    check(bending, &layout, &q, formula, &claims).unwrap();
}

/// The membrane of the material and its bending with every form, thickness and moduli different on every face.
fn check_pairs<M: Density + Clone>(material: impl Fn(usize) -> M) {
    let s = patch(1.0);
    let faces = 0..s.frames.len();
    let section = Homogeneous {
        material: ByFace(faces.clone().map(material).collect()),
        thickness: faces.map(|f| 0.1 + 0.05 * f as f64).collect(),
    };
    let formula = |e: &Membrane<_>, f: usize, q: &_| {
        e.formula(f, q, |strain| section.stretch_formula(f, strain))
    };
    let claims = Claims {
        rest: Some(s.at_rest.clone()),
        ..MOVES
    };
    let membrane = s.membrane(section.clone());
    check(membrane, &s.layout, &s.q, formula, &claims).unwrap();
    check_bending::<Tangent, _>(&s, &section);
    check_bending::<Sine, _>(&s, &section);
    check_bending::<Identity, _>(&s, &section);
    check_dkt(&s, &section);
}

#[test]
fn every_material_conforms_with_every_second_form() {
    let young = |face: usize| YOUNG * (1.0 + 0.3 * face as f64);
    check_pairs(|f| StVenantKirchhoff::new(young(f), POISSON));
    check_pairs(|f| NeoHookean::new(young(f), POISSON).unwrap());
    check_pairs(|f| TensionField::new(young(f), POISSON));
    check_pairs(|f| woven(f as f64));
}

#[test]
fn hessians_agree_at_a_flat_rest_state() {
    let s = patch(0.0);
    let orthotropic = Orthotropic::new(&isotropic_moduli(), [0.6, 0.8]).unwrap();
    let expected = Homogeneous::uniform(StVenantKirchhoff::new(YOUNG, POISSON), 0.1, 5);
    let expected = s.membrane(expected);
    let others: [Box<dyn Section>; 3] = [
        Box::new(Homogeneous::uniform(neo_hookean(), 0.1, 5)),
        Box::new(Homogeneous::uniform(orthotropic, 0.1, 5)),
        Box::new(Homogeneous::uniform(
            TensionField::new(YOUNG, POISSON),
            0.1,
            5,
        )),
    ];
    for other in others {
        let other = s.membrane(std::sync::Arc::<dyn Section>::from(other));
        for face in 0..5 {
            let corners = s.rest.mesh.faces()[face].map(|v| s.rest.positions[v as usize]);
            let q = nalgebra::SVector::<f64, 9>::from_fn(|i, _| corners[i / 3][i % 3]);
            let (a, b) = (
                expected.hessian(face, &q).hessian,
                other.hessian(face, &q).hessian,
            );
            // The strain at rest is round-off, 1e-16, times a few.
            assert!(a.norm() > 0.0 && (a - b).norm() < 1e-14 * a.norm());
        }
    }
}
