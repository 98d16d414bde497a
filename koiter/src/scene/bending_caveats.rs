//! What bending models do not do.

use super::elastic::rest_surface;
use super::model::{BendingModel, Shell};

/// Hinges of a rest mesh below this angle [rad] are those of a plane whose points were rounded to single precision.
const FLAT: f64 = 1e-5;

/// What the bending model of a shell does not do, in words, and what helps.
pub(super) fn bending_caveat(shell: &Shell) -> Option<(String, &'static str)> {
    let name = shell.bending.info().name;
    match shell.bending {
        BendingModel::Ds2nd => Some((
            format!(
                "the energy of {name} is wrong, mostly far too small: it depends on the mesh and on a barrier; and every \
                 rest shape counts as a flat one"
            ),
            "it is here as it was studied; use bac for results",
        )),
        BendingModel::QbCr | BendingModel::QbPl | BendingModel::QbInt
            if has_rest_curvature(shell) =>
        {
            Some((
                format!(
                    "{name} ignores that the rest shape is curved: it bends towards a flat one"
                ),
                "quadratic bending is for flat rest shapes; bac, dcs, dso and ds-theta keep a curved one",
            ))
        }
        BendingModel::QbCr
        | BendingModel::QbPl
        | BendingModel::QbInt
        | BendingModel::Bac
        | BendingModel::Dcs
        | BendingModel::Dso
        | BendingModel::Dkt
        | BendingModel::MeAverage
        | BendingModel::DsTheta
        | BendingModel::DsTan
        | BendingModel::ChEs
        | BendingModel::ChFs
        | BendingModel::None => None,
    }
}

/// Whether the rest curvature is taken from the rest mesh, and that is not flat.
fn has_rest_curvature(shell: &Shell) -> bool {
    if !shell.rest_curved {
        return false;
    }
    let rest = rest_surface(shell);
    let mut edges = rest.mesh.edge_faces().iter();
    edges.any(|sides| {
        let [Some(first), Some(second)] = sides else {
            return false;
        };
        let [n0, n1] = [first, second].map(|face| {
            let [a, b, c] = rest.corners(face.0 as usize);
            (b - a).cross(&(c - a))
        });
        n0.cross(&n1).norm().atan2(n0.dot(&n1)) > FLAT
    })
}
