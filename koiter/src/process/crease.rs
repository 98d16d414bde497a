//! A crease: rest angles of the edges on a line, or the rest forms of the faces on both sides of it.
//!
//! ```text
//! s̄_k += w_k (g(f(t) γ/2) − g(f(0) γ/2))
//! ```
//!
//! γ the angle by which the normals turn across the crease, f(t) its factor, g the profile of directors. Of a hinge angle w is
//! 2 and g the identity. The second fundamental form of a face is that of flat faces that meet at γ, with the director in the
//! middle between their normals: w are the entries for that edge in [`crate::rest::RestFrame::second_form_matrix`] times
//! twice the altitude over it. So flat pieces that meet at γ cost nothing. Values of a rest shape that is curved are added to.

use super::{Process, RestState, Window};

/// What a crease does to one rest value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fold {
    /// Place of the value.
    pub place: usize,
    /// w.
    pub weight: f64,
}

/// Rest values across a line.
#[derive(Clone, Debug)]
pub struct Crease {
    /// The values and their weights.
    pub folds: Vec<Fold>,
    /// γ [rad]: positive where normals fan out.
    pub angle: f64,
    /// g.
    pub profile: fn(f64) -> f64,
}

impl Process for Crease {
    fn advance(&self, rest: &mut RestState, window: &Window<'_>) {
        let [before, after] = window.factors.map(|f| (self.profile)(0.5 * self.angle * f));
        for Fold { place, weight } in &self.folds {
            rest.curvature[*place] += weight * (after - before);
        }
    }
}
