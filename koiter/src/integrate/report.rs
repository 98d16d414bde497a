//! What a step tells.

use super::diagnostics::Diagnostics;

/// What one step did. Not converging is told here; it is not an error.
#[derive(Clone, Debug, Default)]
pub struct StepReport {
    /// Step number, from 1.
    pub step: usize,
    /// Time at the end of the step [s].
    pub time: f64,
    /// Step size [s].
    pub dt: f64,
    /// Newton iterations.
    pub newton_iterations: usize,
    /// Trials of the line searches.
    pub line_search_steps: usize,
    /// Whether the tolerance was met.
    pub converged: bool,
    /// The last Newton step, measured on the offset surfaces and divided by `dt` [m/s] (statics: [m]).
    pub residual: f64,
    /// Energies by name [J] at the end of the step; `friction` is what the step's sliding took and `damping` what its damping
    /// took, by the forces at its end, as do the entries of dissipation functions: none is stored energy.
    pub energies: Vec<(String, f64)>,
    /// Names of those energies that a step takes away beside friction: they add up over its parts.
    pub taken: Vec<String>,
    /// Other figures by name, of what has no energies.
    pub measures: Vec<(&'static str, f64)>,
    /// Seconds spent, by part; the names are snake_case, like all keys of results.
    pub seconds: Vec<(&'static str, f64)>,
    /// Active contact pairs.
    pub contacts: usize,
    /// Smallest gap between surfaces [m]; infinity when nothing is near.
    pub min_gap: f64,
    /// Barrier stiffness at the end of the step [J/m²].
    pub kappa: f64,
    /// Intersections found after the step (always 0, or the step is an error).
    pub intersections: usize,
    /// Arc length: the factor on the scheduled loads.
    pub load_factor: Option<f64>,
    /// Arc length: negative eigenvalues of the tangent; the equilibrium is stable if there are none.
    pub negative_eigenvalues: Option<usize>,
    /// Parts the step was taken in, one after the other: 1 unless it failed as a whole, or the last step had been cut.
    pub parts: usize,
    /// Why the step was cut the first time, if it was.
    pub cut: Option<String>,
    /// For a step that did not converge: which energy and elements resist, what limited the step, what to try.
    pub diagnosis: Option<String>,
    /// Why it took the work it took.
    pub diagnostics: Diagnostics,
}

impl StepReport {
    /// Adds the work of an attempt, whatever came of it.
    pub fn add_effort(&mut self, attempt: &Self) {
        self.newton_iterations += attempt.newton_iterations;
        self.line_search_steps += attempt.line_search_steps;
        self.diagnostics.add_effort(&attempt.diagnostics);
        for (part, seconds) in &attempt.seconds {
            match self.seconds.iter_mut().find(|(name, _)| name == part) {
                Some((_, total)) => *total += seconds,
                None => self.seconds.push((part, *seconds)),
            }
        }
    }

    /// Appends the next part of a step: efforts add up, the state is that at its end.
    pub fn add_part(&mut self, part: Self) {
        self.add_effort(&part);
        let mut energies = part.energies;
        for (name, value) in &mut energies {
            if name == "friction" || part.taken.contains(name) {
                let before = self.energies.iter().find(|(known, _)| known == name);
                *value += before.map_or(0.0, |(_, taken)| *taken);
            }
        }
        *self = Self {
            newton_iterations: self.newton_iterations,
            line_search_steps: self.line_search_steps,
            seconds: std::mem::take(&mut self.seconds),
            converged: self.converged && part.converged,
            energies,
            parts: self.parts + 1,
            cut: self.cut.take(),
            diagnosis: self.diagnosis.take().or(part.diagnosis),
            diagnostics: std::mem::take(&mut self.diagnostics).at_end_of(part.diagnostics),
            intersections: self.intersections + part.intersections,
            ..part
        };
    }
}

/// Why a step could not be taken.
#[derive(Clone, Debug, thiserror::Error)]
#[non_exhaustive]
pub enum StepError {
    /// The matrix of the linear system could not be factorised even after regularisation.
    #[error("the linear system of step {step} could not be solved: {reason}")]
    LinearSolve {
        /// Step number.
        step: usize,
        /// What failed, in the user's terms.
        reason: String,
    },
    /// A number became NaN or infinite.
    #[error("energy '{energy}' is not finite in step {step} ({element})")]
    NotFinite {
        /// Step number.
        step: usize,
        /// Name of the energy.
        energy: String,
        /// The element that is at fault.
        element: String,
    },
    /// No further equilibrium was found along the path, however short the arc.
    #[error("step {step}: the path is lost at a load factor of {load_factor:.6}: {reason}")]
    PathLost {
        /// Step number.
        step: usize,
        /// Load factor of the last equilibrium.
        load_factor: f64,
        /// What went wrong with the last arc, and what to try.
        reason: String,
    },
    /// An explicit step that is longer than the fastest vibration allows.
    #[error(
        "step {step}: an explicit step of {dt:.3e} s is not stable, the longest is about {stable_dt:.2e} s: make time.dt \
         smaller, or take implicit steps with solver.newmark.beta = 0.25"
    )]
    Unstable {
        /// Step number.
        step: usize,
        /// Its length [s].
        dt: f64,
        /// The longest stable step [s], estimated.
        stable_dt: f64,
    },
    /// A step that gained energy, where that is watched.
    #[error(
        "step {step} gained {gained:.2e} J from nowhere, with {kinetic:.2e} J of kinetic energy at most so far: take smaller \
         steps (time.dt), damp what moves fast with solver.newmark.gamma above 0.5 or the damping of a shell, or allow more \
         (solver.newmark.energy_growth)"
    )]
    EnergyGrew {
        /// Step number.
        step: usize,
        /// What it gained beyond the work at what is prescribed [J].
        gained: f64,
        /// The largest kinetic energy so far [J].
        kinetic: f64,
    },
    /// What was to be done to a shell cannot be done to it as it is.
    #[error("procedure '{procedure}' cannot be carried out in step {step}: {reason}")]
    Procedure {
        /// Step number.
        step: usize,
        /// Name of the procedure.
        procedure: String,
        /// Why.
        reason: String,
    },
    /// The accepted state has surfaces that intersect: a bug, never silent.
    #[error("surfaces intersect after step {step}: {details}")]
    Intersection {
        /// Step number.
        step: usize,
        /// Which elements.
        details: String,
    },
}
