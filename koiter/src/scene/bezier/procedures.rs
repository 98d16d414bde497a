//! What is done to Bézier shells: cuts, pulls, patches, sutures. Each depends on the model and on the pose it finds, on nothing
//! else; so a run is taken up again by doing it once more.

use super::body::BezierBody;
use super::{BezierModel, FineSurface, ProcedureKind};
use crate::Vec3;
use crate::bezier::{
    BezierError, BezierShell, Change, Dynamics, Lens, Lips, MappedSurface, Pose, SeamAngle,
    SurfacePath,
};
use crate::mesh::VertexId;

/// Does what the procedure with this index says; where that changed the mesh, returns which nodes are near the change.
pub(super) fn perform(
    body: &mut BezierBody,
    model: &BezierModel,
    index: usize,
) -> Result<Option<Vec<bool>>, BezierError> {
    let lips = |body: &BezierBody, cut: usize| -> Lips {
        body.tracked.lips[cut]
            .clone()
            .expect("cuts come before what is done with them")
    };
    let change = match &model.procedures[index].kind {
        ProcedureKind::Cut { shell, path } => {
            let path = path_on(body, *shell, path)?;
            let change = body.moving.shell.cut(&path)?;
            let lips = Lips::new(&change, &path);
            follow(body, model, &change, None);
            body.tracked.lips[index] = Some(lips);
            change
        }
        ProcedureKind::Open {
            cut, force, lift, ..
        } => {
            let (shell, pose) = (&body.moving.shell, &body.moving.pose);
            let pull = lips(body, *cut).opening(shell, pose, *force, *lift);
            body.tracked.pulls[index] = Some(pull);
            return Ok(None);
        }
        ProcedureKind::Patch {
            cut,
            width,
            across,
            section,
        } => {
            let lens = Lens {
                width: *width,
                across: *across,
                options: model.options(*section),
            };
            sew_in(body, model, *cut, &lips(body, *cut), &lens)?
        }
        ProcedureKind::Close { cut } => {
            let pairs = lips(body, *cut).pairs;
            sew(body, model, &pairs, SeamAngle::Rest)?
        }
        ProcedureKind::Sew {
            first,
            second,
            reach,
        } => {
            let row = |(part, vertices): &(usize, Vec<VertexId>)| -> Vec<u32> {
                let present = &body.tracked.present[*part];
                vertices.iter().map(|v| present[v.0 as usize]).collect()
            };
            let pairs = nearest_pairs(&row(first), &row(second), &body.moving.pose, *reach)?;
            sew(body, model, &pairs, SeamAngle::Current)?
        }
    };
    Ok(Some(change.near()))
}

/// The path from point to point over a part, on the shell as it is at rest in each of its elements.
fn path_on(body: &BezierBody, part: usize, path: &[Vec3]) -> Result<SurfacePath, BezierError> {
    let (shell, owners) = (&body.moving.shell, &body.tracked.owners);
    let point = |x: &Vec3| shell.nearest_within_an_edge(x, |element| owners[element] == part);
    let points = path.iter().map(point).collect::<Result<Vec<_>, _>>()?;
    SurfacePath::through(shell, &body.tracked.start, &points)
}

/// Pairs of vertices, each of the first row with the nearest of the second.
fn nearest_pairs(
    first: &[u32],
    second: &[u32],
    pose: &Pose,
    limit: f64,
) -> Result<Vec<[u32; 2]>, BezierError> {
    let at = |v: u32| pose.positions[v as usize];
    let pair = |&vertex: &u32| {
        let distances = second
            .iter()
            .map(|&other| ((at(other) - at(vertex)).norm(), other));
        let (distance, other) = distances
            .min_by(|a, b| a.0.total_cmp(&b.0))
            .unwrap_or((f64::INFINITY, vertex));
        match distance <= limit {
            true => Ok([vertex, other]),
            false => Err(BezierError::Unpaired {
                vertex,
                distance,
                limit,
            }),
        }
    };
    first.iter().map(pair).collect()
}

fn sew(
    body: &mut BezierBody,
    model: &BezierModel,
    pairs: &[[u32; 2]],
    angle: SeamAngle,
) -> Result<Change, BezierError> {
    let (change, pose) = body.moving.shell.sew(pairs, &body.moving.pose, angle)?;
    follow(body, model, &change, Some(pose));
    Ok(change)
}

/// Puts a patch between lips and sews it in.
fn sew_in(
    body: &mut BezierBody,
    model: &BezierModel,
    cut: usize,
    lips: &Lips,
    lens: &Lens,
) -> Result<Change, BezierError> {
    let ProcedureKind::Cut { shell: owner, .. } = model.procedures[cut].kind else {
        unreachable!("lips are those of a cut");
    };
    let (shell, pose) = (&body.moving.shell, &body.moving.pose);
    let made = lips.patch(shell, pose, lens)?;
    let (patch, pose) = (made.shell, pose.followed_by(&made.pose));
    let both = shell.beside(&patch)?;
    let (change, after) = both.sew(&made.pairs, &pose, SeamAngle::Current)?;
    let pieces = [
        (0, body.fine.clone()),
        (
            shell.elements().len(),
            MappedSurface::subdivided(&patch, model.subdivide),
        ),
    ];
    body.fine = MappedSurface::joined(&both, &pieces);
    body.tracked = body.tracked.with_patch(&patch, owner);
    body.moving = with_patch(&body.moving, both, pose, &patch);
    follow(body, model, &change, Some(after));
    Ok(change)
}

/// The motion with nodes of a patch that is at rest.
fn with_patch(moving: &Dynamics, both: BezierShell, pose: Pose, patch: &BezierShell) -> Dynamics {
    let supports = moving.supports.clone();
    let supports = supports.with_free(patch.mesh().num_vertices());
    let mut with = Dynamics::at(both, supports, pose);
    with.velocities[..moving.velocities.len()].copy_from_slice(&moving.velocities);
    with.damping = moving.damping;
    with
}

/// Takes everything along to the shell after a change.
fn follow(body: &mut BezierBody, model: &BezierModel, change: &Change, pose: Option<Pose>) {
    body.moving = body.moving.changed(change, pose);
    body.tracked = body.tracked.carried(change);
    let is_subdivided = |surface: &FineSurface| matches!(surface, FineSurface::Subdivided);
    body.fine = if model.parts.iter().all(|part| is_subdivided(&part.surface)) {
        MappedSurface::subdivided(&body.moving.shell, model.subdivide)
    } else {
        change.surface(&body.fine).0
    };
}
