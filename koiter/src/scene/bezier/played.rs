//! From a scene to shells that are played with.

use super::body::BezierBody;
use crate::bezier::{Dynamics, Interaction};
use crate::scene::model::Model;
use crate::scene::simulation::Simulation;

impl Simulation {
    /// The Bézier shells of the scene, as they are now, for a loop with frames of `dt` [s]: what holds them at this moment, weight,
    /// loads but pressure, and obstacles where they are. `None` for a scene without Bézier shells.
    pub fn interaction(&self, dt: f64) -> Option<Interaction> {
        let body = self.bezier.as_ref()?;
        Some(body.interaction(self.model(), self.time(), dt))
    }
}

impl BezierBody {
    fn interaction(&self, model: &Model, time: f64, dt: f64) -> Interaction {
        let bezier = model.bezier.as_ref().expect("the shells are of the model");
        // Constraints begin with the first step, after time 0.
        let supports = self.supports(bezier, time.max(f64::MIN_POSITIVE));
        let moving = &self.moving;
        let mut dynamics = Dynamics::at(moving.shell.clone(), supports, moving.pose.clone());
        dynamics.velocities.clone_from(&moving.velocities);
        dynamics.damping = moving.damping;
        let mut played = Interaction::new(dynamics, dt);
        played.load = self.load(model, time);
        played.contact = self.contact.as_ref().map(|own| {
            let mut contact = own.over(self.fine.clone(), &moving.pose);
            contact.restore(&own.state());
            contact
        });
        played
    }
}
