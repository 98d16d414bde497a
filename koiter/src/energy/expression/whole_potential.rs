//! An energy of a shell as a whole, by an expression of its volume and its area, and its damping.
//!
//! ```text
//! Φ(q) = f(V, A, parameters, t)
//! D(q) = b/τ · ½ dᵀ F d,    d = (V, A) − (V, A) as they would be without motion,    F the positive part of ∇²f there
//! ```
//!
//! Second derivatives of f couple everything with everything ([`WholeShell`]); as matrices of rank one a Newton step has them all
//! and costs two more substitutions. Those with negative weight are left out there, as clamped curvature is: of such an f (one that is
//! concave in the volume) convergence is linear.

use nalgebra::{DMatrix, Matrix2};

use super::program::Program;
use super::settings::Settings;
use super::tangent::damped_part;
use super::whole_shell::WholeShell;
use crate::Vec3;
use crate::assembly::{
    Dof, DofLayout, Energy, HessianBuilder, LowRank, PatternBuilder, PsdProjection, RestMeasures,
    WorstElement,
};
use crate::geometry::{Jet, Real};

/// Quantities of a whole shell: volume [m³], area [m²], and both at rest.
pub(super) const WHOLE: [&str; 4] = ["volume", "rest_volume", "area", "rest_area"];

/// An energy of a whole shell.
#[derive(Clone, Debug)]
pub struct WholePotential {
    name: String,
    shell: WholeShell,
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
        let (shell, rest) = WholeShell::new(faces, layout, rest);
        Self {
            name,
            shell,
            rest,
            program,
            settings,
        }
    }

    /// Whether f has a value and derivatives at `q`.
    pub fn is_defined(&self, q: &[f64]) -> bool {
        let f = self.function(self.shell.measures(q));
        let second = [(0, 0), (0, 1), (1, 1)].map(|(i, j)| f.hessian(i, j));
        let all = f.gradient().iter().chain(&second);
        f.value().is_finite() && all.into_iter().all(|entry| entry.is_finite())
    }

    /// f with its derivatives by V and A.
    fn function(&self, [volume, area]: [f64; 2]) -> Jet<2> {
        let quantities = [
            Jet::variable(volume, 0),
            self.rest[0].into(),
            Jet::variable(area, 1),
            self.rest[1].into(),
        ];
        (self.program).evaluate(&quantities, self.settings.values())
    }

    fn at(&self, q: &[f64]) -> Jet<2> {
        self.function(self.shell.measures(q))
    }
}

impl Energy for WholePotential {
    fn name(&self) -> &str {
        &self.name
    }

    fn set_time(&mut self, time: f64) {
        self.settings.set_time(time);
    }

    fn settings(&self) -> &[f64] {
        self.settings.told(&self.program)
    }

    fn value(&self, q: &[f64]) -> f64 {
        self.at(q).value()
    }

    fn add_gradient(&self, q: &[f64], gradient: &mut [f64]) {
        self.shell.add_slopes(q, *self.at(q).gradient(), gradient);
    }

    fn add_derivatives(
        &self,
        q: &[f64],
        projection: PsdProjection,
        gradient: &mut [f64],
        hessian: &mut HessianBuilder<'_>,
    ) {
        (self.shell).add_derivatives(q, &self.at(q), projection, gradient, hessian);
    }

    fn low_rank(&self, q: &[f64]) -> Vec<LowRank> {
        self.shell.low_rank(q, &self.at(q))
    }

    fn add_to_pattern(&self, _q: &[f64], pattern: &mut PatternBuilder) {
        self.shell.add_to_pattern(pattern);
    }

    fn worst_element(&self, q: &[f64]) -> Option<WorstElement> {
        let mut gradient = vec![0.0; q.len()];
        self.add_gradient(q, &mut gradient);
        let norm = gradient.iter().map(|g| g * g).sum::<f64>().sqrt();
        Some(WorstElement {
            description: "the whole shell".into(),
            unknown: self.shell.first_unknown(),
            gradient_norm: if self.value(q).is_finite() {
                norm
            } else {
                f64::NAN
            },
        })
    }
}

/// The rates of volume and area, damped as an energy of both is stiff.
#[derive(Clone, Debug)]
pub struct WholeDamping {
    of: WholePotential,
    /// (V, A) without motion.
    rest: [f64; 2],
    /// F.
    tangent: Matrix2<f64>,
    factor: f64,
}

impl WholeDamping {
    /// Of this energy.
    pub fn new(of: WholePotential) -> Self {
        Self {
            rest: of.rest,
            of,
            tangent: Matrix2::zeros(),
            factor: 1.0,
        }
    }

    /// ½ dᵀ F d with its derivatives by V and A.
    fn at(&self, q: &[f64]) -> Jet<2> {
        let measures = self.of.shell.measures(q);
        let d: [Jet<2>; 2] = std::array::from_fn(|i| Jet::variable(measures[i], i) - self.rest[i]);
        let f = self.factor * self.tangent;
        d[0] * d[0] * (0.5 * f[(0, 0)]) + d[0] * d[1] * f[(0, 1)] + d[1] * d[1] * (0.5 * f[(1, 1)])
    }
}

impl Energy for WholeDamping {
    fn name(&self) -> &str {
        self.of.name()
    }

    fn set_time(&mut self, time: f64) {
        self.of.set_time(time);
    }

    fn value(&self, q: &[f64]) -> f64 {
        self.at(q).value()
    }

    fn add_gradient(&self, q: &[f64], gradient: &mut [f64]) {
        (self.of.shell).add_slopes(q, *self.at(q).gradient(), gradient);
    }

    fn add_derivatives(
        &self,
        q: &[f64],
        projection: PsdProjection,
        gradient: &mut [f64],
        hessian: &mut HessianBuilder<'_>,
    ) {
        (self.of.shell).add_derivatives(q, &self.at(q), projection, gradient, hessian);
    }

    fn low_rank(&self, q: &[f64]) -> Vec<LowRank> {
        self.of.shell.low_rank(q, &self.at(q))
    }

    fn add_to_pattern(&self, _q: &[f64], pattern: &mut PatternBuilder) {
        self.of.shell.add_to_pattern(pattern);
    }

    fn rest_measures(&self) -> Option<&dyn RestMeasures> {
        Some(self)
    }

    fn rest_measures_mut(&mut self) -> Option<&mut dyn RestMeasures> {
        Some(self)
    }
}

impl RestMeasures for WholeDamping {
    fn measure(&self, q: &[f64]) -> Vec<f64> {
        self.of.shell.measures(q).to_vec()
    }

    fn rest(&self) -> Vec<f64> {
        self.rest.to_vec()
    }

    fn set_rest(&mut self, rest: &[f64]) {
        self.rest = [rest[0], rest[1]];
        let f = self.of.function(self.rest);
        let kept = damped_part(&DMatrix::from_fn(2, 2, |i, j| f.hessian(i, j)));
        self.tangent = Matrix2::from_fn(|i, j| kept[(i, j)]);
    }

    fn has_branches(&self) -> bool {
        false
    }

    fn follow(&mut self, _measures: &[f64]) {}

    fn set_factor(&mut self, factor: f64) {
        self.factor = factor;
    }
}
