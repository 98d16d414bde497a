//! Damping as a part of the incremental potential.
//!
//! ```text
//! D(q) = b/τ Φ(s(q) − ŝ − τ s̄˙) + a/(2τ) |q − q̂|²_M,    ṡ = (s − ŝ)/τ,  q̇ = (q − q̂)/τ  at the end of the step
//! ```
//!
//! s measures of strain of an energy Φ that compares them with rest values s̄ ([`crate::assembly::RestMeasures`]), b [s] and
//! a [1/s] the coefficients of Rayleigh, M masses. For Φ quadratic in s, with tangent C, the force is `−b ∂sᵀ C (ṡ − s̄˙)`:
//! that of a Kelvin–Voigt material, whose stress follows strain and its rate. It depends on the shape through s alone, so it
//! is orthogonal to rigid motions and changes neither momentum; its power is never positive while s̄ rests. The drag
//! `−a M q̇` slows all motions, rigid ones too, like a fluid at rest: it takes momenta away at the rate a.
//!
//! How rates follow from positions is the method's ([`RateRule`]): ŝ is a combination of s at configurations that are known,
//! and q̂ the same combination of them. Hinges with `Φ = k_D/2 Σ w θ²` and b = 1 give the damping of Discrete Shells,
//! `k_D w (θ̇ − θ̄˙) ∂θ`. Reference: Grinspun et al., "Discrete Shells" (2003), section 5.

use crate::assembly::{DofLayout, Energy};
use crate::energy::Inertia;
use crate::energy::expression::RateEnergy;

/// Φ, with what it is told every step.
pub struct Damper {
    /// An energy with rest measures, made for this purpose.
    pub energy: Box<dyn Energy>,
    /// b [s].
    pub time: f64,
    /// The elastic energy whose rest values move this one's, by its place in [`super::System::elastic`].
    pub follows: Option<usize>,
    /// Whether s depends on unknowns without mass. Their velocities are no part of the state, so a method cannot take their
    /// rates from it: they are the mean rates of the step, of first order.
    pub is_massless: bool,
    /// s̄˙; empty: zero.
    rest_rate: Vec<f64>,
}

impl Damper {
    /// Damps nothing until a step begins.
    ///
    /// # Panics
    /// If the energy has no rest measures.
    pub fn new(mut energy: Box<dyn Energy>, time: f64, follows: Option<usize>) -> Self {
        let measures = energy.rest_measures_mut();
        measures
            .expect("a damped energy has measures")
            .set_factor(0.0);
        Self {
            energy,
            time,
            follows,
            is_massless: false,
            rest_rate: Vec::new(),
        }
    }
}

/// All damping of a system.
#[derive(Default)]
pub struct Damping {
    /// Of strains.
    pub dampers: Vec<Damper>,
    /// a m of every solved unknown [kg/s, or kg·m²/s for directors]; empty: no drag.
    pub drag: Vec<f64>,
    /// Forces by dissipation functions, which may drive as well as damp.
    pub rates: Vec<Box<dyn RateEnergy>>,
    /// The drag of the step under way.
    drag_energy: Option<Inertia>,
}

/// Rates at the end of a step, `ṡ = (s − ŝ)/τ`.
pub(super) struct RateRule {
    /// τ [s].
    pub(super) reach: f64,
    /// ŝ is the sum of s at these configurations with these weights, which sum to 1; the first is that at the start of the step.
    pub(super) base: Vec<(f64, Vec<f64>)>,
    /// The step [s].
    pub(super) dt: f64,
}

impl RateRule {
    /// The mean rate since the start of the step.
    pub(super) fn backward(q: &[f64], dt: f64) -> Self {
        Self {
            reach: dt,
            base: vec![(1.0, q.to_vec())],
            dt,
        }
    }

    /// The rate whose mean with that at the start is the mean rate since then: ŝ = s + (dt/2) ṡ of the start. The rate along
    /// the velocities is a central difference, which vanishes for rigid motions as the rate does.
    pub(super) fn trapezoidal(q: &[f64], velocities: &[f64], dt: f64) -> Self {
        let [ahead, behind] = [0.5 * dt, -0.5 * dt].map(|time| moved(q, velocities, time));
        Self {
            reach: 0.5 * dt,
            base: vec![(1.0, q.to_vec()), (0.5, ahead), (-0.5, behind)],
            dt,
        }
    }

    /// The rate along the velocities, at `q` itself.
    pub(super) fn at_start(q: &[f64], velocities: &[f64], dt: f64) -> Self {
        let [ahead, behind] = [0.5 * dt, -0.5 * dt].map(|time| moved(q, velocities, time));
        Self {
            reach: 0.5 * dt,
            base: vec![(1.0, q.to_vec()), (-0.5, ahead), (0.5, behind)],
            dt,
        }
    }

    fn combined<'a>(&'a self, values: impl Fn(&'a [f64]) -> Vec<f64>) -> Vec<f64> {
        let mut sum = Vec::new();
        for (weight, q) in &self.base {
            let values = values(q);
            sum.resize(values.len(), 0.0);
            for (sum, value) in sum.iter_mut().zip(values) {
                *sum += weight * value;
            }
        }
        sum
    }
}

fn moved(q: &[f64], velocities: &[f64], time: f64) -> Vec<f64> {
    let moving = q.iter().zip(velocities);
    moving.map(|(x, v)| x + time * v).collect()
}

impl Damping {
    /// Whether there is any.
    pub fn is_none(&self) -> bool {
        self.is_conservative() && self.rates.is_empty()
    }

    /// Whether neither strains nor masses are damped.
    fn is_conservative(&self) -> bool {
        self.dampers.is_empty() && self.drag.is_empty()
    }

    /// Damping of a step with these rates.
    pub(super) fn begin(&mut self, rule: &RateRule) {
        for damper in &mut self.dampers {
            let rate = &damper.rest_rate;
            let measures =
                (damper.energy.rest_measures_mut()).expect("a damped energy has measures");
            let (mut rest, reach) = match damper.is_massless {
                true => (measures.measure(&rule.base[0].1), rule.dt),
                false => (rule.combined(|q| measures.measure(q)), rule.reach),
            };
            for (rest, rate) in rest.iter_mut().zip(rate) {
                *rest += reach * rate;
            }
            measures.set_rest(&rest);
            measures.set_factor(damper.time / reach);
        }
        let start = &rule.base[0].1;
        if !self.rates.is_empty() {
            let base = rule.combined(<[f64]>::to_vec);
            for rate in &mut self.rates {
                rate.begin(start, &base, rule.reach);
            }
        }
        self.drag_energy = (!self.drag.is_empty()).then(|| Inertia {
            masses: self.drag.clone(),
            prediction: rule.combined(<[f64]>::to_vec),
            // a m |q − q̂|² / 2τ.
            dt: rule.reach.sqrt(),
        });
    }

    /// No damping, as in statics.
    pub(super) fn rest(&mut self) {
        for damper in &mut self.dampers {
            let measures = damper.energy.rest_measures_mut();
            measures
                .expect("a damped energy has measures")
                .set_factor(0.0);
        }
        for rate in &mut self.rates {
            rate.rest();
        }
        self.drag_energy = None;
    }

    /// Parameters are those of this time [s].
    pub(crate) fn set_time(&mut self, time: f64) {
        for damper in &mut self.dampers {
            damper.energy.set_time(time);
        }
        for rate in &mut self.rates {
            rate.set_time(time);
        }
    }

    /// The rest values of an elastic energy change by this much in a step of `dt` [s].
    pub(crate) fn set_rest_change(&mut self, of: usize, change: &[f64], dt: f64) {
        for damper in &mut self.dampers {
            if damper.follows == Some(of) {
                damper.rest_rate = change.iter().map(|change| change / dt).collect();
            }
        }
    }

    /// Angles go on from those at `q`.
    pub(super) fn follow(&mut self, q: &[f64]) {
        for damper in &mut self.dampers {
            let measures =
                (damper.energy.rest_measures_mut()).expect("a damped energy has measures");
            if measures.has_branches() {
                let now = measures.measure(q);
                measures.follow(&now);
            }
        }
    }

    /// What damps strains, whether or not it acts, for the pattern of the matrix shall not depend on that; and the drag of
    /// the step under way.
    pub(super) fn energies(&mut self) -> impl Iterator<Item = &mut dyn Energy> {
        let strains =
            (self.dampers.iter_mut()).map(|damper| damper.energy.as_mut() as &mut dyn Energy);
        let rates = (self.rates.iter_mut()).map(|rate| rate.as_mut() as &mut dyn Energy);
        let drag = (self.drag_energy.iter_mut()).map(|drag| drag as &mut dyn Energy);
        strains.chain(rates).chain(drag)
    }

    /// Adds ∇D, minus the forces of damping and of dissipation functions at the end of the last step.
    pub fn add_gradient(&self, q: &[f64], gradient: &mut [f64]) {
        for rate in &self.rates {
            rate.add_gradient(q, gradient);
        }
        self.add_damping(q, gradient);
    }

    fn add_damping(&self, q: &[f64], gradient: &mut [f64]) {
        for damper in &self.dampers {
            damper.energy.add_gradient(q, gradient);
        }
        if let Some(drag) = &self.drag_energy {
            drag.add_gradient(q, gradient);
        }
    }

    /// The work that a step to `q` took by its forces at the end [J], of damping where there is some and of each dissipation
    /// function; negative where it drove.
    pub(super) fn taken(
        &self,
        layout: &DofLayout,
        before: &[f64],
        q: &[f64],
    ) -> Vec<(String, f64)> {
        let mut taken = Vec::new();
        if !self.is_conservative() {
            let damping = |gradient: &mut [f64]| self.add_damping(q, gradient);
            taken.push(("damping".into(), work(layout, [before, q], &damping)));
        }
        let by_rates = self.taken_by_rates(layout, before, q);
        taken.extend(by_rates.map(|(name, work)| (name.to_owned(), work)));
        taken
    }

    /// What each dissipation function took.
    pub(super) fn taken_by_rates(
        &self,
        layout: &DofLayout,
        before: &[f64],
        q: &[f64],
    ) -> impl Iterator<Item = (&str, f64)> {
        self.rates.iter().map(move |rate| {
            let force = |gradient: &mut [f64]| rate.add_gradient(q, gradient);
            (rate.name(), work(layout, [before, q], &force))
        })
    }
}

/// The work of a gradient at the end of a way over the solved unknowns [J].
fn work(layout: &DofLayout, [before, q]: [&[f64]; 2], add: &dyn Fn(&mut [f64])) -> f64 {
    let mut gradient = vec![0.0; q.len()];
    add(&mut gradient);
    let solved = 0..layout.num_solved_dofs();
    solved.map(|i| gradient[i] * (q[i] - before[i])).sum()
}
