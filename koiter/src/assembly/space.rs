//! How unknowns of different kinds move and how far.

/// The space the unknowns live in. `q` holds positions, edge angles, later directors and rotations.
pub trait ConfigurationSpace: Send + Sync {
    /// `out` = the configuration reached from `q` by the step `dq`.
    fn retract(&self, q: &[f64], dq: &[f64], out: &mut [f64]) {
        for ((o, x), d) in out.iter_mut().zip(q).zip(dq) {
            *o = x + d;
        }
    }
    /// The size of the step in metres: the largest displacement of a point of the surfaces. Infinite if not finite.
    fn displacement(&self, q: &[f64], dq: &[f64]) -> f64;
    /// Where a step is largest, in the user's terms.
    fn describe_largest(&self, dq: &[f64]) -> String {
        let largest = (0..dq.len()).max_by(|&a, &b| dq[a].abs().total_cmp(&dq[b].abs()));
        largest.map_or_else(String::new, |dof| self.describe(dof))
    }
    /// The unknown in the user's terms.
    fn describe(&self, dof: usize) -> String;
}
