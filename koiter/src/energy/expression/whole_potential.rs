//! An energy of a shell as a whole, by an expression of its volume and its area.
//!
//! ```text
//! Φ(q) = f(V, A, parameters, t),    V = Σ_f x₀·(x₁ × x₂)/6,    A = Σ_f |(x₁ − x₀) × (x₂ − x₀)|/2
//! ∇²Φ = f_V ∇²V + f_A ∇²A + Σ_i λ_i g_i g_iᵀ,    g_i = u_i · (∇V, ∇A)
//! ```
//!
//! λ_i, u_i eigenvalues and eigenvectors of the second derivatives of f. The first two terms couple what shares a face. The
//! last couples everything with everything: it is handed to the solver as what it is, matrices of rank one
//! ([`Energy::low_rank`]), so a step is Newton's with the whole Hessian and its cost two more substitutions. Terms with λ < 0
//! are left out, as clamped curvature is: of such an f (one that is concave in the volume) convergence is linear.
//!
//! ∇²V depends, face by face, on the origin, which is the mean of the start positions here; only the sum does not. As with
//! [`crate::energy::loads::Pressure`], of a projected Hessian only the share of it that is kept is formed.

use nalgebra::{Matrix2, SMatrix, SVector};

use super::program::Program;
use super::settings::Settings;
use crate::Vec3;
use crate::assembly::{
    Dof, DofLayout, Energy, HessianBuilder, LowRank, NodeId, PatternBuilder, PsdProjection,
    WorstElement, ordered_sum, parallel_map, project_to_psd, variables,
};
use crate::geometry::over_numbers::{cross, dot, norm, point, sub};
use crate::geometry::{Dual, Jet, Real};

/// Quantities of a whole shell: volume [m³], area [m²], and both at rest.
pub(super) const WHOLE: [&str; 4] = ["volume", "rest_volume", "area", "rest_area"];

/// An energy of a whole shell.
#[derive(Clone, Debug)]
pub struct WholePotential {
    name: String,
    faces: Vec<[(Dof, NodeId); 3]>,
    /// From where volumes are measured [m].
    origin: Vec3,
    /// Volume and area at rest.
    rest: [f64; 2],
    program: Program,
    settings: Settings,
}

impl WholePotential {
    /// `faces` by the first unknowns of their corners, `rest` by their positions at rest; `program` is parsed with the names
    /// of [`super::ElementKind::Shell`].
    pub fn new(
        name: String,
        faces: &[[Dof; 3]],
        layout: &DofLayout,
        rest: &[[Vec3; 3]],
        program: Program,
        settings: Settings,
    ) -> Self {
        let corners = rest.iter().flatten();
        let origin = corners.sum::<Vec3>() / (3 * rest.len()).max(1) as f64;
        let measures = rest.iter().map(|corners| {
            let q = std::array::from_fn(|i| corners[i / 3][i % 3]);
            measures::<f64>(&q, &origin)
        });
        let rest = measures.fold([0.0; 2], |[v, a], [dv, da]| [v + dv, a + da]);
        Self {
            name,
            faces: (faces.iter())
                .map(|face| face.map(|dof| (dof, layout.node(dof))))
                .collect(),
            origin,
            rest,
            program,
            settings,
        }
    }

    /// Whether f has a value at `q`.
    pub fn is_defined(&self, q: &[f64]) -> bool {
        self.function(q).value().is_finite()
    }

    fn corners(&self, face: usize, q: &[f64]) -> SVector<f64, 9> {
        let starts = self.faces[face].map(|(dof, _)| dof.0 as usize);
        SVector::from_fn(|i, _| q[starts[i / 3] + i % 3])
    }

    /// V and A.
    fn measures(&self, q: &[f64]) -> [f64; 2] {
        [0, 1].map(|which| {
            ordered_sum(self.faces.len(), |face| {
                let q = self.corners(face, q);
                measures::<f64>(&std::array::from_fn(|i| q[i]), &self.origin)[which]
            })
        })
    }

    /// f with its derivatives by V and A.
    fn function(&self, q: &[f64]) -> Jet<2> {
        let [volume, area] = self.measures(q);
        let quantities = [
            Jet::variable(volume, 0),
            self.rest[0].into(),
            Jet::variable(area, 1),
            self.rest[1].into(),
        ];
        (self.program).evaluate(&quantities, self.settings.values())
    }

    /// Adds `by[0]` ∇V + `by[1]` ∇A.
    fn add_slopes(&self, q: &[f64], by: [f64; 2], gradient: &mut [f64]) {
        let slopes = parallel_map(self.faces.len(), |face| {
            let q = self.corners(face, q);
            let q: [Dual<9>; 9] = std::array::from_fn(|i| Dual::variable(q[i], i));
            let [volume, area] = measures(&q, &self.origin);
            *(volume * by[0] + area * by[1]).gradient()
        });
        for (face, slope) in self.faces.iter().zip(slopes) {
            for (k, (dof, _)) in face.iter().enumerate() {
                for axis in 0..3 {
                    gradient[dof.0 as usize + axis] += slope[3 * k + axis];
                }
            }
        }
    }

    /// f_V ∇²V + f_A ∇²A of one face.
    fn sparse_part(&self, face: usize, q: &[f64], by: &Jet<2>, kept: f64) -> SMatrix<f64, 9, 9> {
        let [volume, area] = measures(&variables(&self.corners(face, q)), &self.origin);
        let [by_volume, by_area] = *by.gradient();
        let mut hessian = SMatrix::from_fn(|i, j| by_area * area.hessian(i, j));
        if kept < 1.0 {
            project_to_psd(&mut hessian, kept);
        }
        hessian + SMatrix::from_fn(|i, j| kept * by_volume * volume.hessian(i, j))
    }
}

/// Volume and area of a face.
fn measures<R: Real>(q: &[R; 9], origin: &Vec3) -> [R; 2] {
    let corners: [[R; 3]; 3] = [0, 1, 2].map(|c| {
        let x = point(q, c);
        std::array::from_fn(|axis| x[axis] - origin[axis])
    });
    let [e1, e2] = [1, 2].map(|c| sub(&corners[c], &corners[0]));
    let volume = dot(&corners[0], &cross(&corners[1], &corners[2]));
    [volume * (1.0 / 6.0), norm(&cross(&e1, &e2)) * 0.5]
}

impl Energy for WholePotential {
    fn name(&self) -> &str {
        &self.name
    }

    fn set_time(&mut self, time: f64) {
        self.settings.set_time(time);
    }

    fn value(&self, q: &[f64]) -> f64 {
        self.function(q).value()
    }

    fn add_gradient(&self, q: &[f64], gradient: &mut [f64]) {
        self.add_slopes(q, *self.function(q).gradient(), gradient);
    }

    fn add_derivatives(
        &self,
        q: &[f64],
        projection: PsdProjection,
        gradient: &mut [f64],
        hessian: &mut HessianBuilder<'_>,
    ) {
        let by = self.function(q);
        self.add_slopes(q, *by.gradient(), gradient);
        let locals = parallel_map(self.faces.len(), |face| {
            self.sparse_part(face, q, &by, projection.kept())
        });
        for (face, local) in self.faces.iter().zip(&locals) {
            for (i, (_, a)) in face.iter().enumerate() {
                for (j, (_, b)) in face[..=i].iter().enumerate() {
                    let entry = |r, c| local[(3 * i + r, 3 * j + c)];
                    hessian.add(*a, *b, i == j, entry);
                }
            }
        }
    }

    fn low_rank(&self, q: &[f64]) -> Vec<LowRank> {
        let by = self.function(q);
        let second = Matrix2::from_fn(|i, j| by.hessian(i, j));
        if !second.iter().all(|entry| entry.is_finite()) {
            return Vec::new();
        }
        let eigen = second.symmetric_eigen();
        let positive = (0..2).filter(|&i| eigen.eigenvalues[i] > 0.0);
        positive
            .map(|i| {
                let mut vector = vec![0.0; q.len()];
                let u = eigen.eigenvectors.column(i);
                self.add_slopes(q, [u[0], u[1]], &mut vector);
                LowRank {
                    weight: eigen.eigenvalues[i],
                    vector,
                }
            })
            .collect()
    }

    fn add_to_pattern(&self, _q: &[f64], pattern: &mut PatternBuilder) {
        for face in &self.faces {
            pattern.couple(face.map(|(_, node)| node));
        }
    }

    fn worst_element(&self, q: &[f64]) -> Option<WorstElement> {
        let mut gradient = vec![0.0; q.len()];
        self.add_gradient(q, &mut gradient);
        let norm = gradient.iter().map(|g| g * g).sum::<f64>().sqrt();
        let is_finite = self.function(q).value().is_finite();
        Some(WorstElement {
            description: "the whole shell".into(),
            unknown: self.faces.first().map(|face| face[0].0),
            gradient_norm: if is_finite { norm } else { f64::NAN },
        })
    }
}
