//! Loads: the potentials of what pushes and turns shells from outside.
//!
//! A dead load keeps its direction; pressure and moments follow the surface. Each has a potential, so a static state
//! under load is a minimum like any other. Magnitudes are given at a factor of 1, which schedules change over time.

mod dead_load;
mod director_moment;
mod edge_moment;
mod pressure;
mod pull;

pub use dead_load::{DeadLoad, VertexForce};
pub use director_moment::{DirectorMoment, TurnedDirectors};
pub use edge_moment::{EdgeMoment, TurnedEdge};
pub use pressure::Pressure;
pub use pull::Pull;

use crate::assembly::{
    Assembled, Energy, HessianBuilder, Pattern, PatternBuilder, PsdProjection, WorstElement,
};

/// One load.
pub enum Load {
    /// Forces that keep their direction.
    Dead(DeadLoad),
    /// Pressure along the normals.
    Pressure(Assembled<Pressure, 9, 3>),
    /// Moments on the directors of edges.
    Moment(Assembled<EdgeMoment, 13, 5>),
    /// Moments on the directors at the ends of edges.
    DirectorMoment(Assembled<DirectorMoment, 12, 4>),
    /// What a hand pulls at, with no factor.
    Pull(Pull),
}

impl Load {
    /// Sets the factor on the magnitude.
    pub fn set_factor(&mut self, factor: f64) {
        match self {
            Self::Dead(load) => load.factor = factor,
            Self::Pressure(load) => load.local_mut().factor = factor,
            Self::Moment(load) => load.local_mut().factor = factor,
            Self::DirectorMoment(load) => load.local_mut().factor = factor,
            Self::Pull(_) => {}
        }
    }

    fn energy(&self) -> &dyn Energy {
        match self {
            Self::Dead(load) => load,
            Self::Pressure(load) => load,
            Self::Moment(load) => load,
            Self::DirectorMoment(load) => load,
            Self::Pull(load) => load,
        }
    }
}

impl Load {
    fn turned(&self) -> Vec<f64> {
        match self {
            Self::Moment(load) => load.local().edges.iter().map(|edge| edge.turned).collect(),
            Self::DirectorMoment(load) => {
                load.local().edges.iter().map(|edge| edge.turned).collect()
            }
            Self::Dead(_) | Self::Pressure(_) | Self::Pull(_) => Vec::new(),
        }
    }

    fn turned_mut(&mut self) -> Vec<&mut f64> {
        match self {
            Self::Moment(load) => {
                let edges = load.local_mut().edges.iter_mut();
                edges.map(|edge| &mut edge.turned).collect()
            }
            Self::DirectorMoment(load) => {
                let edges = load.local_mut().edges.iter_mut();
                edges.map(|edge| &mut edge.turned).collect()
            }
            Self::Dead(_) | Self::Pressure(_) | Self::Pull(_) => Vec::new(),
        }
    }
}

/// All loads of a scene as one energy.
#[derive(Default)]
pub struct Loads {
    /// The loads.
    pub loads: Vec<Load>,
}

impl Loads {
    /// Measures the turning of directors from `q` on: the angles of one step stay small, their sum may pass any number
    /// of turns.
    pub fn rebase(&mut self, q: &[f64]) {
        for load in &mut self.loads {
            match load {
                Load::Moment(load) => load.local_mut().rebase(q),
                Load::DirectorMoment(load) => load.local_mut().rebase(q),
                Load::Dead(_) | Load::Pressure(_) | Load::Pull(_) => {}
            }
        }
    }

    /// How far the directors of the edges under moments had turned [rad] at the last [`Self::rebase`].
    pub fn turned(&self) -> Vec<f64> {
        self.loads.iter().flat_map(Load::turned).collect()
    }

    /// Goes on from angles that [`Self::turned`] gave after a [`Self::rebase`] at `q`.
    ///
    /// # Panics
    /// If there are fewer than edges.
    pub fn restore_turned(&mut self, turned: &[f64], q: &[f64]) {
        self.rebase(q);
        let angles = self.loads.iter_mut().flat_map(Load::turned_mut);
        for (index, angle) in angles.enumerate() {
            *angle = turned[index];
        }
    }
}

impl Energy for Loads {
    fn name(&self) -> &'static str {
        "loads"
    }

    fn value(&self, q: &[f64]) -> f64 {
        self.loads.iter().map(|load| load.energy().value(q)).sum()
    }

    fn add_gradient(&self, q: &[f64], gradient: &mut [f64]) {
        for load in &self.loads {
            load.energy().add_gradient(q, gradient);
        }
    }

    fn add_derivatives(
        &self,
        q: &[f64],
        projection: PsdProjection,
        gradient: &mut [f64],
        hessian: &mut HessianBuilder<'_>,
    ) {
        for load in &self.loads {
            (load.energy()).add_derivatives(q, projection, gradient, hessian);
        }
    }

    fn add_to_pattern(&self, q: &[f64], pattern: &mut PatternBuilder) {
        for load in &self.loads {
            load.energy().add_to_pattern(q, pattern);
        }
    }

    fn bind(&mut self, pattern: &Pattern) {
        for load in &mut self.loads {
            match load {
                Load::Dead(_) | Load::Pull(_) => {}
                Load::Pressure(load) => load.bind(pattern),
                Load::Moment(load) => load.bind(pattern),
                Load::DirectorMoment(load) => load.bind(pattern),
            }
        }
    }

    fn worst_element(&self, q: &[f64]) -> Option<WorstElement> {
        let worst = self
            .loads
            .iter()
            .filter_map(|load| load.energy().worst_element(q));
        worst.reduce(|a, b| match b.gradient_norm <= a.gradient_norm {
            true => a,
            false => b,
        })
    }
}
