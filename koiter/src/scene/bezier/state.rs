//! What Bézier shells owe to their past.

use super::body::BezierBody;
use crate::bezier::{ContactState, MappedContact, NODE_UNKNOWNS, Pose};
use crate::scene::model::Model;

/// The Bézier shells of a simulation, as far as the model does not say it: taken up, they take the same steps, bit for bit.
#[derive(Clone, Debug, PartialEq)]
pub struct BezierState {
    /// The poses that the procedures which are done have found: from them their meshes follow.
    pub done: Vec<Pose>,
    /// Where the nodes are.
    pub pose: Pose,
    /// Velocities, six numbers a node [m/s, rad/s].
    pub velocities: Vec<f64>,
    /// Couplings of the solver's matrix.
    pub couplings: Vec<[u32; 2]>,
    /// What contact owes to its past, where it is on.
    pub contact: Option<ContactState>,
}

impl BezierBody {
    /// What it owes to its past.
    pub(in crate::scene) fn state(&self) -> BezierState {
        BezierState {
            done: self.done.clone(),
            pose: self.moving.pose.clone(),
            velocities: self.moving.velocities.clone(),
            couplings: self.moving.couplings(),
            contact: self.contact.as_ref().map(MappedContact::state),
        }
    }

    /// The shells of a model in a state.
    ///
    /// # Errors
    /// A state of other shells, or with numbers that are not finite.
    pub(in crate::scene) fn restored(model: &Model, state: &BezierState) -> Result<Self, String> {
        let bezier = model
            .bezier
            .as_ref()
            .ok_or("the scene has no Bézier shells")?;
        let mut body = Self::new(model)
            .map_err(|error| error.to_string())?
            .ok_or("the scene has no Bézier shells")?;
        if state.done.len() > bezier.procedures.len() {
            let (given, most) = (state.done.len(), bezier.procedures.len());
            return Err(format!("it has {given} procedures done of {most}"));
        }
        let fits = |pose: &Pose, nodes: usize| {
            pose.positions.len() == nodes && pose.rotations.len() == nodes && pose.is_finite()
        };
        for pose in &state.done {
            if !fits(pose, body.moving.pose.len()) {
                return Err("a procedure found another shell".to_owned());
            }
            body.moving.pose = pose.clone();
            (body.repeat_next(bezier)).map_err(|error| error.to_string())?;
        }
        let nodes = body.moving.pose.len();
        let finite = state.velocities.iter().all(|v| v.is_finite());
        if !fits(&state.pose, nodes) || state.velocities.len() != NODE_UNKNOWNS * nodes || !finite {
            return Err("its nodes are not those of the shells, or not finite".to_owned());
        }
        if state
            .couplings
            .iter()
            .flatten()
            .any(|&node| node as usize >= nodes)
        {
            return Err("it couples nodes that there are not".to_owned());
        }
        body.moving.pose = state.pose.clone();
        body.moving.velocities.clone_from(&state.velocities);
        body.moving.restore_couplings(&state.couplings);
        let fits = match (&mut body.contact, &state.contact) {
            (Some(contact), Some(state)) => contact.restore(state),
            (None, None) => true,
            _ => false,
        };
        match fits {
            true => Ok(body),
            false => Err("its contact is another".to_owned()),
        }
    }
}
