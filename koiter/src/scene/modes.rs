//! How a simulated structure vibrates and buckles.

use super::simulation::Simulation;
use crate::Vec3;
use crate::integrate::{BucklingMode, LinearError, VibrationMode};

impl Simulation {
    /// The `count` lowest free vibrations about the present state, increasing; motions without resistance come first.
    ///
    /// About an equilibrium under load, a negative ω² means that it is not stable. Contact is left out.
    ///
    /// # Errors
    /// See [`LinearError`].
    pub fn vibration_modes(&mut self, count: usize) -> Result<Vec<VibrationMode>, LinearError> {
        let prescribed = self.prescribed_at(self.state.time);
        let fixed = &prescribed.is_fixed;
        self.system.vibration_modes(&self.state.q, fixed, count)
    }

    /// The `count` lowest factors by which the loads and gravity of a `time` [s] buckle the structure, increasing; fewer if
    /// there are no more. On a path by arc length, `time` is the load factor. The structure is as stiff as in the present
    /// state, which should be one at rest, and answers by stresses alone until it buckles: that it bends before, as a roof
    /// does, is not seen. Contact is left out.
    ///
    /// # Errors
    /// See [`LinearError`].
    pub fn buckling_modes(
        &mut self,
        time: f64,
        count: usize,
    ) -> Result<Vec<BucklingMode>, LinearError> {
        match &self.load_pattern {
            Some(pattern) => pattern.apply(time, &mut self.system),
            None => self.apply_schedules(time),
        }
        let prescribed = self.prescribed_at(self.state.time);
        let fixed = &prescribed.is_fixed;
        let modes = self.system.buckling_modes(&self.state.q, fixed, count);
        self.apply_schedules(self.state.time);
        modes
    }

    /// What the vertices of a shell do in a mode whose `shape` is one over the solved unknowns; held shells stand still.
    pub fn shell_motion(&self, shell: usize, shape: &[f64]) -> Vec<Vec3> {
        let mut motion = vec![0.0; self.state.q.len()];
        motion[..shape.len()].copy_from_slice(shape);
        self.shell_points(shell, &motion)
    }
}
