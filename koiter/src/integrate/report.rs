//! What a step tells.

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
    /// Energies by name [J] at the end of the step; `friction` is what the step's sliding took, not stored energy.
    pub energies: Vec<(&'static str, f64)>,
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
    /// For a step that did not converge: which energy and elements resist, what limited the step, what to try.
    pub diagnosis: Option<String>,
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
    /// The accepted state has surfaces that intersect: a bug, never silent.
    #[error("surfaces intersect after step {step}: {details}")]
    Intersection {
        /// Step number.
        step: usize,
        /// Which elements.
        details: String,
    },
}
