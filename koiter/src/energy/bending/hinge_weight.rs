//! How much the hinges of Discrete Shells count, and how stiff they are.
//!
//! ```text
//! E = Σ_edges k_B w (θ − θ̄)²
//! barycentric:    w = ℓ̄/h̄ = 3 ℓ̄² / (Ā + Ā')       h̄ a third of the mean height of the two faces over the edge
//! circumcentric:  w = ℓ̄/h̄ = 4 / (cot a + cot b)     a, b the angles opposite the edge; h̄ half of the dual edge
//! simplified:     w = ℓ̄ [m]
//! ```
//!
//! k_B is given, or that of the material: C/2, C the flexural rigidity [N·m], which is right if the mean curvature of edges
//! were sampled in all directions alike; a cylinder costs three times too much ([`super::DiscreteShells`]). The simplified
//! weight measures folds of flat pieces whatever their triangles, and k_B in newtons; of a material it is C/2 over the mean
//! of h̄, `Σ ℓ̄ h̄ / Σ ℓ̄` barycentric, which makes it depend on the mesh. It does not converge under refinement. Reference:
//! Grinspun et al., "Discrete Shells" (2003), section 4 and its appendix.
//!
//! The circumcentric h̄ is zero on the diagonals of right triangles and negative where a mesh is not Delaunay: there the
//! barycentric one stands in for it.

use super::hinge::Hinge;
use crate::geometry::Wing;

/// The weight of a hinge.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Deserialize, serde::Serialize, schemars::JsonSchema),
    serde(rename_all = "kebab-case")
)]
#[non_exhaustive]
pub enum HingeWeight {
    /// Length over a third of the mean height of both triangles: 3 ℓ²/(A + A').
    #[default]
    Barycentric,
    /// Length over half of the dual edge; barycentric where that is short or negative.
    Circumcentric,
    /// Length alone: independent of the triangles of flat pieces; stiffnesses are in newtons then.
    Simplified,
}

/// The springs of hinges.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct HingeSprings {
    /// w.
    pub weight: HingeWeight,
    /// k_B [J], with [`HingeWeight::Simplified`] [N]; `None`: that of the material.
    pub stiffness: Option<f64>,
}

/// A circumcentric h̄ below this share of the barycentric one is not used: it is a matter of the mesh, not of the shell, and
/// no hinge shall be more than ten times as stiff as others around it.
const SHORTEST_DUAL: f64 = 0.1;

impl HingeSprings {
    /// k_B w of every hinge.
    pub(super) fn stiffnesses(&self, hinges: &[Hinge]) -> Vec<f64> {
        let tiles: f64 = hinges.iter().map(Hinge::area).sum::<f64>() / 3.0;
        let lengths: f64 = hinges.iter().map(|h| h.length_squared().sqrt()).sum();
        let of_hinge = |hinge: &Hinge| {
            let of_material = match self.weight {
                HingeWeight::Simplified => 0.5 * hinge.rigidity * lengths / tiles,
                _ => 0.5 * hinge.rigidity,
            };
            self.stiffness.unwrap_or(of_material) * self.weight.of(hinge)
        };
        hinges.iter().map(of_hinge).collect()
    }
}

impl HingeWeight {
    /// w.
    pub(super) fn of(self, hinge: &Hinge) -> f64 {
        let barycentric = 3.0 * hinge.length_squared() / hinge.area();
        match self {
            Self::Barycentric => barycentric,
            Self::Simplified => hinge.length_squared().sqrt(),
            Self::Circumcentric => {
                let cotangents: f64 = hinge.rest_wings().iter().map(apex_cotangent).sum();
                match 0.25 * cotangents * barycentric > SHORTEST_DUAL {
                    true => 4.0 / cotangents,
                    false => barycentric,
                }
            }
        }
    }
}

/// Cotangent of the angle at the apex.
fn apex_cotangent(wing: &Wing) -> f64 {
    let Wing {
        length,
        height,
        foot,
        ..
    } = wing;
    height / length - foot * (1.0 - foot) * length / height
}

#[cfg(test)]
mod tests {
    use super::super::hinge::hinges;
    use super::*;
    use crate::Vec3;
    use crate::assembly::Dof;
    use crate::mesh::{Surface, TriMesh};
    use crate::rest::rest_frames;

    /// One hinge of length 2 with apexes at these heights over its middle.
    fn hinge(heights: [f64; 2]) -> Hinge {
        let positions = vec![
            Vec3::new(-1.0, 0.0, 0.0),
            Vec3::new(1.0, 0.0, 0.0),
            Vec3::new(0.0, heights[0], 0.0),
            Vec3::new(0.0, -heights[1], 0.0),
        ];
        let mesh = TriMesh::new(4, vec![[0, 1, 2], [1, 0, 3]]).unwrap();
        let rest = Surface::from_mesh(mesh, positions).unwrap();
        let frames = rest_frames(&rest).unwrap();
        hinges(&rest, Dof(0), &frames, &[2.0, 2.0]).remove(0)
    }

    #[test]
    fn weights_are_length_over_a_third_of_the_mean_height_or_half_of_the_dual_edge() {
        let hinge = hinge([1.5, 2.5]);
        // A third of a mean height of 2.
        assert!((HingeWeight::Barycentric.of(&hinge) - 2.0 / (2.0 / 3.0)).abs() < 1e-14);
        assert!((HingeWeight::Simplified.of(&hinge) - 2.0).abs() < 1e-14);
        // Circumcentres of isosceles triangles lie (h² − 1)/(2 h) over the base.
        let dual: f64 = [1.5f64, 2.5]
            .iter()
            .map(|h| (h * h - 1.0) / (2.0 * h))
            .sum();
        let circumcentric = HingeWeight::Circumcentric.of(&hinge);
        assert!((circumcentric - 2.0 / (0.5 * dual)).abs() < 1e-13);
    }

    #[test]
    fn equilateral_triangles_have_one_weight() {
        let hinge = hinge([3f64.sqrt(); 2]);
        let [barycentric, circumcentric] =
            [HingeWeight::Barycentric, HingeWeight::Circumcentric].map(|w| w.of(&hinge));
        assert!((barycentric - circumcentric).abs() < 1e-14 * barycentric);
    }

    #[test]
    fn right_and_obtuse_triangles_fall_back_to_the_barycentric_weight() {
        for heights in [[1.0, 1.0], [0.5, 0.6], [1.04, 1.0]] {
            let hinge = hinge(heights);
            let [barycentric, circumcentric] =
                [HingeWeight::Barycentric, HingeWeight::Circumcentric].map(|w| w.of(&hinge));
            assert_eq!(barycentric, circumcentric, "{heights:?}");
        }
    }

    #[test]
    fn a_stiffness_is_that_of_the_material_unless_it_is_given() {
        let hinges = [hinge([1.5, 2.5])];
        let stiffness =
            |weight, stiffness| HingeSprings { weight, stiffness }.stiffnesses(&hinges)[0];
        let material = stiffness(HingeWeight::Barycentric, None);
        // C/2 ℓ/h.
        assert!((material - 1.0 * 3.0).abs() < 1e-14);
        assert!((stiffness(HingeWeight::Barycentric, Some(5.0)) - 15.0).abs() < 1e-14);
        assert!((stiffness(HingeWeight::Simplified, Some(5.0)) - 10.0).abs() < 1e-14);
        // All hinges being one, its height is the mean.
        assert!((stiffness(HingeWeight::Simplified, None) - material).abs() < 1e-14);
    }
}
