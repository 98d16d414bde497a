//! The Bézier shells of a simulation: one shell of all pieces, its fine surface, and what they touch.

use super::procedures::perform;
use super::shown::ShownPart;
use super::tracked::Tracked;
use super::{BezierModel, FineSurface};
use crate::Vec3;
use crate::bezier::{
    BezierError, BezierShell, ContactOptions, Drag, Dynamics, MappedContact, MappedSurface,
    NODE_UNKNOWNS, Pose, Supports,
};
use crate::scene::assemble::{BuildError, LARGEST_REACH_BY_EDGE, default_d_hat, default_kappa};
use crate::scene::model::{Model, Obstacle};

/// The Bézier shells as they are at a moment.
pub(in crate::scene) struct BezierBody {
    pub(in crate::scene) moving: Dynamics,
    pub(super) fine: MappedSurface,
    pub(super) contact: Option<MappedContact>,
    pub(super) tracked: Tracked,
    /// The poses that the procedures which are done have found.
    pub(super) done: Vec<Pose>,
    /// What hands pull at.
    pub(in crate::scene) drags: Vec<Drag>,
    /// The fine surface by parts.
    pub(super) shown: Vec<ShownPart>,
}

impl BezierBody {
    /// The shells of a model at the start; `None` for a model without.
    ///
    /// # Errors
    /// An inverted element, a fine surface that is too far away, a start that touches.
    pub(in crate::scene) fn new(model: &Model) -> Result<Option<Self>, BuildError> {
        let Some(bezier) = &model.bezier else {
            return Ok(None);
        };
        let (shell, fine) = join(bezier)?;
        let supports = Supports::none(shell.mesh().num_vertices());
        let tracked = Tracked::new(bezier, &shell);
        let mut moving = Dynamics::new(shell, supports);
        moving.damping = bezier.damping;
        let velocities = bezier.parts.iter().flat_map(|part| &part.shell.velocities);
        for (of_node, v) in moving
            .velocities
            .chunks_exact_mut(NODE_UNKNOWNS)
            .zip(velocities)
        {
            of_node[..3].copy_from_slice(v.as_slice());
        }
        let shown = ShownPart::of(&fine, &tracked.owners);
        let mut body = Self {
            contact: None,
            done: Vec::new(),
            drags: Vec::new(),
            moving,
            fine,
            tracked,
            shown,
        };
        body.contact = body.new_contact(model)?;
        Ok(Some(body))
    }

    /// Carries out the next procedure at the present pose, and what touches at it sleeps.
    ///
    /// # Errors
    /// A path that leaves the surface, a surface that touches afterwards, and whatever else cannot be done.
    pub(super) fn carry_out_next(&mut self, model: &BezierModel) -> Result<(), BezierError> {
        let near = self.perform_next(model)?;
        if let (Some(contact), Some(near)) = (&self.contact, near) {
            let after = contact.after(self.fine.clone(), &self.moving.pose, &near)?;
            self.contact = Some(after);
        }
        Ok(())
    }

    /// The same for what was carried out before: what sleeps is known.
    ///
    /// # Errors
    /// Whatever cannot be done.
    pub(super) fn repeat_next(&mut self, model: &BezierModel) -> Result<(), BezierError> {
        if self.perform_next(model)?.is_some()
            && let Some(contact) = &self.contact
        {
            self.contact = Some(contact.over(self.fine.clone(), &self.moving.pose));
        }
        Ok(())
    }

    /// Returns which nodes are near what was changed, if anything was.
    fn perform_next(&mut self, model: &BezierModel) -> Result<Option<Vec<bool>>, BezierError> {
        let pose = self.moving.pose.clone();
        let near = perform(self, model, self.done.len())?;
        self.done.push(pose);
        self.shown = ShownPart::of(&self.fine, &self.tracked.owners);
        Ok(near)
    }

    /// Positions of the vertices of a part's start shape, as the nodes they became are now [m].
    pub(in crate::scene) fn positions(&self, part: usize) -> Vec<Vec3> {
        let present = self.tracked.present[part].iter();
        present
            .map(|v| self.moving.pose.positions[*v as usize])
            .collect()
    }

    /// Numbers of nodes and elements.
    pub(in crate::scene) fn sizes(&self) -> [usize; 2] {
        [self.moving.pose.len(), self.moving.shell.elements().len()]
    }

    /// Velocities of the same [m/s].
    pub(in crate::scene) fn velocities(&self, part: usize) -> Vec<Vec3> {
        let of_node = |v: &u32| {
            let first = NODE_UNKNOWNS * *v as usize;
            Vec3::from_column_slice(&self.moving.velocities[first..first + 3])
        };
        self.tracked.present[part].iter().map(of_node).collect()
    }

    /// Contact of the fine surface, where it is on.
    fn new_contact(&self, model: &Model) -> Result<Option<MappedContact>, BuildError> {
        let parts = &model
            .bezier
            .as_ref()
            .expect("the shells are of the model")
            .parts;
        if !model.contact.enabled {
            return Ok(None);
        }
        let pose = &self.moving.pose;
        let (edge, extent) = size(&self.fine, &self.fine.positions(pose));
        let shell = &parts[0].shell;
        let d_hat =
            (model.contact.d_hat).unwrap_or_else(|| default_d_hat([(edge, extent)].into_iter()));
        let reach = d_hat + 2.0 * shell.contact_offset;
        if reach > LARGEST_REACH_BY_EDGE * edge {
            return Err(BuildError::ContactReach {
                shell: shell.name.clone(),
                reach,
                mean_edge: edge,
            });
        }
        let shells = parts.iter().map(|part| &part.shell);
        let options = ContactOptions {
            d_hat,
            kappa: (model.contact.kappa)
                .unwrap_or_else(|| default_kappa(shells, &model.gravity, d_hat)),
            offset: shell.contact_offset,
            friction: shell.friction,
            friction_speed: model.contact.friction_speed,
        };
        let at_start = |obstacle: &Obstacle| {
            let points = obstacle.points_at(&obstacle.start_points(), 0.0);
            obstacle.collision(points)
        };
        let obstacles = model.obstacles.iter().map(at_start).collect();
        let mut contact =
            MappedContact::new(&shell.name, self.fine.clone(), obstacles, pose, options);
        for pair in &model.contact.pairs {
            contact.set_friction(&pair.bodies, pair.friction)?;
        }
        contact.check_start(pose)?;
        Ok(Some(contact))
    }
}

/// All parts beside each other, and the surface that they carry.
fn join(model: &BezierModel) -> Result<(BezierShell, MappedSurface), BuildError> {
    let (mut whole, mut pieces) = (None::<BezierShell>, Vec::new());
    let mut is_subdivided = true;
    for part in &model.parts {
        let refuse = |error| BuildError::Bezier {
            shell: part.shell.name.clone(),
            error,
        };
        let options = model.options(part.section());
        let shell =
            BezierShell::new(&part.shell.surface, &part.normals, options).map_err(refuse)?;
        let fine = match &part.surface {
            FineSurface::Subdivided => MappedSurface::subdivided(&shell, model.subdivide),
            FineSurface::Bound { surface, reach } => {
                is_subdivided = false;
                let fine = MappedSurface::new(&shell, surface, *reach).map_err(refuse)?;
                let edge = part.shell.surface.mean_edge_length();
                if fine.farthest() > edge {
                    log::warn!(
                        "the fine surface of '{}' was moved onto the elements by up to {:.3e} m, more than their mean edge of \
                         {edge:.3e} m",
                        part.shell.name,
                        fine.farthest()
                    );
                }
                fine
            }
        };
        let first = whole.as_ref().map_or(0, |whole| whole.elements().len());
        pieces.push((first, fine));
        whole = Some(match whole {
            None => shell,
            Some(whole) => whole.beside(&shell).map_err(refuse)?,
        });
    }
    let whole = whole.expect("a model with Bézier shells has one");
    let fine = match is_subdivided {
        true => MappedSurface::subdivided(&whole, model.subdivide),
        false => MappedSurface::joined(&whole, &pieces),
    };
    Ok((whole, fine))
}

/// Mean edge and extent of a fine surface [m].
fn size(fine: &MappedSurface, x: &[Vec3]) -> (f64, f64) {
    let edges = fine.edges();
    let length = |[a, b]: &[u32; 2]| (x[*b as usize] - x[*a as usize]).norm();
    let low = x.iter().fold(Vec3::repeat(f64::MAX), |low, x| low.inf(x));
    let high = x.iter().fold(Vec3::repeat(f64::MIN), |high, x| high.sup(x));
    let mean = edges.iter().map(length).sum::<f64>() / edges.len() as f64;
    (mean, (high - low).norm())
}
