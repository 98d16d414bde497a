//! Mid-edge bending over its edge angles alone, for solves that hold positions.
//!
//! ```text
//! E = Ā W(κ),    q_c = s_c g(τ_c + ε_c α_c)
//! ```
//!
//! with s_c = 2 a_c and τ_c = θ_c / 2 taken once. Everything else is [`MidEdgeBending`]; its Hessian has 21 × 21 entries,
//! of which such solves read
//! 3 × 3.

use nalgebra::{Matrix3, SVector, Vector3};

use super::mid_edge::MidEdgeBending;
use super::profile::AngleProfile;
use crate::assembly::{Dof, LocalEnergy, LocalHessian};
use crate::material::Section;

/// What positions contribute to the curvature over an edge of a face.
#[derive(Clone, Copy, Debug)]
pub(super) struct HeldEdge {
    /// s_c [m].
    pub(super) twice_height: f64,
    /// τ_c [rad].
    pub(super) half_turn: f64,
    /// ε_c.
    pub(super) sign: f64,
}

/// [`MidEdgeBending`] at held positions.
pub(super) struct HeldMidEdge<'a, P, S> {
    bending: &'a MidEdgeBending<P, S>,
    edges: Vec<[HeldEdge; 3]>,
}

impl<'a, P: AngleProfile, S: Section> HeldMidEdge<'a, P, S> {
    pub(super) fn new(bending: &'a MidEdgeBending<P, S>, edges: Vec<[HeldEdge; 3]>) -> Self {
        Self { bending, edges }
    }

    /// q_c with its first and second derivative by α_c.
    fn curvatures(&self, stencil: usize, angles: &Vector3<f64>) -> [Vector3<f64>; 3] {
        let by_edge = self.tilts(stencil, angles).map(P::eval);
        std::array::from_fn(|order| {
            Vector3::from_fn(|c, _| {
                let edge = self.edges[stencil][c];
                let sign = if order == 1 { edge.sign } else { 1.0 };
                edge.twice_height * sign * by_edge[c][order]
            })
        })
    }

    fn tilts(&self, stencil: usize, angles: &Vector3<f64>) -> [f64; 3] {
        std::array::from_fn(|c| {
            let edge = self.edges[stencil][c];
            edge.half_turn + edge.sign * angles[c]
        })
    }
}

impl<P: AngleProfile, S: Section> LocalEnergy<3, 3> for HeldMidEdge<'_, P, S> {
    const NODE_SIZES: [usize; 3] = [1; 3];

    fn name(&self) -> &str {
        self.bending.name()
    }

    fn num_stencils(&self) -> usize {
        self.edges.len()
    }

    fn nodes(&self, stencil: usize) -> [Option<Dof>; 3] {
        self.bending.angles(stencil).map(Some)
    }

    fn value(&self, stencil: usize, angles: &SVector<f64, 3>) -> f64 {
        let [curvatures, ..] = self.curvatures(stencil, angles);
        self.bending.response(stencil, &curvatures).0
    }

    fn gradient(&self, stencil: usize, angles: &SVector<f64, 3>) -> (f64, SVector<f64, 3>) {
        let [curvatures, slopes, _] = self.curvatures(stencil, angles);
        let (value, moments, _) = self.bending.response(stencil, &curvatures);
        (value, moments.component_mul(&slopes))
    }

    fn hessian(&self, stencil: usize, angles: &SVector<f64, 3>) -> LocalHessian<3> {
        let [curvatures, slopes, seconds] = self.curvatures(stencil, angles);
        let (value, moments, tangent) = self.bending.response(stencil, &curvatures);
        let slope = Matrix3::from_diagonal(&slopes);
        LocalHessian {
            value,
            gradient: moments.component_mul(&slopes),
            hessian: slope * tangent * slope
                + Matrix3::from_diagonal(&moments.component_mul(&seconds)),
        }
    }

    fn is_admissible(&self, stencil: usize, angles: &SVector<f64, 3>) -> bool {
        P::MAX_TILT.is_infinite()
            || (self.tilts(stencil, angles).iter()).all(|tilt| tilt.abs() < P::MAX_TILT)
    }

    fn describe(&self, stencil: usize) -> String {
        self.bending.describe(stencil)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::energy::bending::{Sine, Tangent, bending_stencils};
    use crate::material::{Homogeneous, StVenantKirchhoff};
    use crate::mesh::generate::{GridDiagonals, grid};
    use crate::rest::rest_frames;

    fn compare<P: AngleProfile>() {
        let mut surface = grid(1.0, 1.0, 2, 2, GridDiagonals::Checkerboard).unwrap();
        let frames = rest_frames(&surface).unwrap();
        for x in &mut surface.positions {
            x.z = 0.2 * (3.0 * x.x + x.y).sin();
        }
        let num_faces = surface.mesh.num_faces();
        let first_angle = Dof(3 * surface.mesh.num_vertices() as u32);
        let bending = MidEdgeBending::<P, _>::new(
            bending_stencils(&surface.mesh, Dof(0), first_angle),
            frames,
            vec![Vector3::new(0.3, -0.2, 0.1); num_faces],
            Homogeneous::uniform(StVenantKirchhoff::new(1e6, 0.3), 0.01, num_faces),
        );
        let positions: Vec<f64> = surface.positions.iter().flatten().copied().collect();
        let unknowns = |face: usize| {
            let mut q = SVector::<f64, 21>::zeros();
            for (k, node) in bending.nodes(face).into_iter().enumerate().take(6) {
                if let Some(Dof(start)) = node {
                    let x = &positions[start as usize..start as usize + 3];
                    q.fixed_rows_mut::<3>(3 * k).copy_from_slice(x);
                }
            }
            for c in 0..3 {
                q[18 + c] = 0.3 * (f64::from(bending.angles(face)[c].0)).sin();
            }
            q
        };
        let edges = (0..num_faces).map(|face| bending.held_edges(face, unknowns(face)));
        let held = HeldMidEdge::new(&bending, edges.collect());
        for face in 0..num_faces {
            let q = unknowns(face);
            let angles: SVector<f64, 3> = q.fixed_rows::<3>(18).into_owned();
            let (whole, part) = (bending.hessian(face, &q), held.hessian(face, &angles));
            assert!((whole.value - part.value).abs() < 1e-12 * whole.value);
            let gradient = whole.gradient.fixed_rows::<3>(18) - part.gradient;
            assert!(gradient.norm() < 1e-12 * whole.gradient.norm());
            let hessian = whole.hessian.fixed_view::<3, 3>(18, 18) - part.hessian;
            assert!(hessian.norm() < 1e-12 * whole.hessian.norm());
            let clamped = held.projected_hessian(face, &angles, 0.0).hessian;
            assert!(clamped.symmetric_eigenvalues().min() > -1e-12 * clamped.norm());
        }
    }

    #[test]
    fn derivatives_are_those_with_free_positions() {
        compare::<Tangent>();
        compare::<Sine>();
    }
}
