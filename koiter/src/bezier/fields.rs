//! What a shell bears at a point: strain and bending.

use nalgebra::{Matrix2, Vector3};

use super::discrete_kirchhoff;
use super::map::SurfacePoint;
use super::stiffness::bending_strains;
use super::{BezierShell, ElementKind, Pose};

/// Strain and bending at a point of a shell.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PointFields {
    /// Largest principal strain of the triangle of the corners.
    pub strain: f64,
    /// Energy of bending, an area [J/m²].
    pub bending_energy_density: f64,
}

impl BezierShell {
    /// Strain and bending at a point; zero in an element that has collapsed.
    pub fn fields(&self, point: &SurfacePoint, pose: &Pose) -> PointFields {
        let (x, turns) = self.corners(point.element, pose);
        let element = &self.elements()[point.element];
        let Some(deformation) = element.deformation(&x, &turns) else {
            return PointFields::default();
        };
        let triangle = element.triangle();
        let gradient: Matrix2<f64> = (0..3)
            .map(|i| deformation.fixed_rows::<2>(6 * i) * triangle.gradients.column(i).transpose())
            .sum();
        let (mean, half_difference) = (
            0.5 * gradient.trace(),
            0.5 * (gradient[(0, 0)] - gradient[(1, 1)]),
        );
        let shear = 0.5 * (gradient[(0, 1)] + gradient[(1, 0)]);
        let xi = Vector3::from(point.barycentric);
        let curvature = match self.options().kind {
            ElementKind::DktAndes => discrete_kirchhoff::strains(triangle, &xi) * deformation,
            _ => bending_strains(triangle, &element.local_levers(), &xi) * deformation,
        };
        let rigidity = self.rest()[point.element].section.bending();
        PointFields {
            strain: mean + half_difference.hypot(shear),
            bending_energy_density: 0.5 * curvature.dot(&(rigidity * curvature)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Vec3;
    use crate::bezier::problems::{RoofEdges, roof};
    use nalgebra::UnitQuaternion;

    #[test]
    fn a_roof_that_is_rolled_up_further_and_stretched_has_that_strain_and_bending() {
        let problem = roof(ElementKind::DktAndes, 12, RoofEdges::Clamped).unwrap();
        let shell = &problem.shell;
        // Rolled from a radius of 25 m to one of 20 m, and stretched along its axis y by 1 %.
        let mut pose = shell.rest_pose();
        for (x, turn) in pose.positions.iter_mut().zip(&mut pose.rotations) {
            let arc = 25.0 * x.x.atan2(x.z);
            let (sin, cos) = (arc / 20.0).sin_cos();
            *turn = UnitQuaternion::from_scaled_axis(Vec3::y() * (arc / 20.0 - arc / 25.0));
            *x = Vec3::new(20.0 * sin, 1.01 * x.y, 20.0 * cos);
        }
        let energy: f64 = (0..shell.elements().len())
            .map(|element| {
                let barycentric = [1.0 / 3.0; 3];
                let fields = shell.fields(
                    &SurfacePoint {
                        element,
                        barycentric,
                    },
                    &pose,
                );
                // Chords of cells of 3.3° are shorter than arcs by 1e-4.
                assert!((fields.strain - 0.01).abs() < 5e-4, "{fields:?}");
                fields.bending_energy_density * shell.elements()[element].area()
            })
            .sum();
        // ν = 0: ½ E t³/12 (1/20 − 1/25)² an area.
        let expected = 0.5 * 4.32e8 * 0.25f64.powi(3) / 12.0 * 0.01f64.powi(2) * shell.area();
        // Chords, and facets of a tenth of the radius.
        assert!(
            (energy / expected - 1.0).abs() < 0.02,
            "{energy} {expected}"
        );
    }
}
