//! From the damping of a shell to its dampers: energies like those damped, whose rest values a step sets.

use nalgebra::Vector3;

use super::elastic::{membrane, mid_edge_bending, rest_surface};
use super::model::{BendingModel, Shell};
use super::position_bending::PositionBending;
use crate::assembly::{Assembled, DofLayout, Energy};
use crate::energy::bending::{
    DiscreteKirchhoff, DiscreteShells, HingeSprings, Identity, LaplacianMesh, Sine, Tangent,
};
use crate::integrate::{Damper, ShellPart};

/// How a shell damps motion; by default not at all.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct DampingOptions {
    /// a: drag by mass [1/s].
    pub mass: f64,
    /// b: damping by stiffness, of membrane and bending [s].
    pub stiffness: f64,
    /// k_D: damping of the angles of hinges, whatever the bending model [J·s], with simplified weights [N·s].
    pub hinges: f64,
}

impl BendingModel {
    /// Whether bending compares measures of curvature with rest values, which can be moved.
    pub(crate) fn measures_curvature(self) -> bool {
        match self {
            Self::Bac
            | Self::Dcs
            | Self::Dso
            | Self::Dkt
            | Self::MeAverage
            | Self::DsTheta
            | Self::DsTan
            | Self::ChEs
            | Self::ChFs => true,
            Self::Ds2nd | Self::QbCr | Self::QbPl | Self::QbInt | Self::None => false,
        }
    }
}

/// The dampers of a shell.
pub(super) fn dampers(shell: &Shell, part: &ShellPart, layout: &DofLayout) -> Vec<Damper> {
    let damping = shell.composition.damping;
    let mut dampers = Vec::new();
    if damping.stiffness > 0.0 {
        let time = damping.stiffness;
        let membranes = membrane(shell, part, layout).into_iter();
        dampers.extend(membranes.map(|energy| Damper::new(energy, time, None)));
        let bending = bending(shell, part, layout);
        for energy in bending {
            let mut damper = Damper::new(energy, time, part.bending);
            // The points of patches.
            damper.is_massless = shell.bending == BendingModel::Ds2nd;
            dampers.push(damper);
        }
    }
    if damping.hinges > 0.0 {
        let hinges = hinges(shell, part, damping.hinges);
        let is_hinged = matches!(shell.bending, BendingModel::DsTheta | BendingModel::DsTan);
        let follows = part.bending.filter(|_| is_hinged);
        let hinges = Box::new(Assembled::new(hinges, layout));
        dampers.push(Damper::new(hinges, 1.0, follows));
    }
    dampers
}

/// k_D/2 Σ w θ².
fn hinges(shell: &Shell, part: &ShellPart, damping: f64) -> DiscreteShells<Identity> {
    let rest = rest_surface(shell);
    let springs = HingeSprings {
        weight: shell.composition.hinges.weight,
        stiffness: Some(0.5 * damping),
    };
    let unused = vec![0.0; part.mesh.num_faces()];
    let (first, frames) = (part.first_vertex, &part.frames);
    DiscreteShells::with_springs(&rest, first, frames, false, &unused, springs)
}

/// Bending of the shell's model, or the squares of its strains, flat at rest.
fn bending(shell: &Shell, part: &ShellPart, layout: &DofLayout) -> Vec<Box<dyn Energy>> {
    let num_faces = part.mesh.num_faces();
    let flat = vec![Vector3::zeros(); num_faces];
    let positions = PositionBending::new(shell, part, layout);
    vec![match shell.bending {
        BendingModel::Bac => Box::new(mid_edge_bending::<Tangent>(part, flat, layout)),
        BendingModel::Dcs => Box::new(mid_edge_bending::<Sine>(part, flat, layout)),
        BendingModel::Dso => Box::new(mid_edge_bending::<Identity>(part, flat, layout)),
        BendingModel::Dkt => {
            let (mesh, frames) = (&part.mesh, part.frames.clone());
            let (vertices, directors) = (part.first_vertex, part.first_extra);
            let flat = vec![[Vector3::zeros(); 3]; num_faces];
            let section = part.section.clone();
            let energy = DiscreteKirchhoff::new(mesh, vertices, directors, frames, flat, section);
            Box::new(Assembled::new(energy, layout))
        }
        BendingModel::MeAverage => positions.mid_edge_average(),
        BendingModel::DsTheta => positions.discrete_shells::<Identity>(),
        BendingModel::DsTan => positions.discrete_shells::<Tangent>(),
        BendingModel::ChEs => positions.corotational_edge(),
        BendingModel::ChFs => positions.corotational_face(),
        BendingModel::QbCr => positions.quadratic_hinge_strains(),
        BendingModel::QbPl => positions.quadratic_vertex_strains(LaplacianMesh::Extrinsic),
        BendingModel::QbInt => positions.quadratic_vertex_strains(LaplacianMesh::IntrinsicDelaunay),
        BendingModel::Ds2nd => return positions.second_order_strains(),
        BendingModel::None => return Vec::new(),
    }]
}
