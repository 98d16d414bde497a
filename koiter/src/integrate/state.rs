//! Where a system stands, and what the next step has to know of those before.

use super::arc_length::PathPoint;

/// Positions, edge angles, their rates, and what an integrator remembers, at one time.
#[derive(Clone, Debug, PartialEq)]
pub struct State {
    /// All unknowns, and the positions of obstacles after them.
    pub q: Vec<f64>,
    /// Their rates.
    pub velocities: Vec<f64>,
    /// Rates of the velocities over the last step, as its integrator has them; zero in statics.
    pub accelerations: Vec<f64>,
    /// Time [s].
    pub time: f64,
    /// Steps taken.
    pub step: usize,
    /// Where the state stands on a path that is followed by arc length.
    pub path: Option<PathPoint>,
    /// What the integrator keeps of the last step.
    pub memory: Memory,
}

/// What an integrator keeps between steps. Each finds its own, or begins anew.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum Memory {
    /// Nothing.
    #[default]
    None,
    /// BDF2: the state before the last step.
    Before {
        /// Length of the last step [s].
        dt: f64,
        /// Unknowns.
        q: Vec<f64>,
        /// Their rates.
        velocities: Vec<f64>,
    },
    /// Newmark: the accelerations of the state are those of the equation of motion.
    Accelerated {
        /// Explicit steps: the longest that was found stable.
        stable: Option<StableStep>,
        /// The largest kinetic energy so far [J], where gains of energy are watched; else 0.
        largest_kinetic: f64,
    },
}

/// The longest explicit step that was found stable, and under what.
#[derive(Clone, Debug, PartialEq)]
pub struct StableStep {
    /// The step [s].
    pub dt: f64,
    /// The step for which it was looked for [s].
    pub found_for: f64,
    /// Steps since it was found.
    pub age: u64,
    /// The largest speed at the time [m/s], on which dissipations depend.
    pub speed: f64,
    /// What energies were told from outside ([`crate::assembly::Energy::settings`]), of all in order.
    pub settings: Vec<f64>,
}

impl State {
    /// A configuration at rest.
    pub(crate) fn at_rest(q: Vec<f64>, time: f64, step: usize) -> Self {
        Self {
            velocities: vec![0.0; q.len()],
            accelerations: vec![0.0; q.len()],
            q,
            time,
            step,
            path: None,
            memory: Memory::None,
        }
    }
}
