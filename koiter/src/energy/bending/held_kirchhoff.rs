//! DKT bending over its directors alone, for solves that hold positions.
//!
//! ```text
//! y = Σ_c S_c d_c / |d_c|
//! ```
//!
//! The nine numbers y of [`super::kirchhoff_form`] are linear in the unit directors; S is taken once. Everything else is
//! [`DiscreteKirchhoff`]; its Hessian has 18 × 18 entries, of which such solves read 9 × 9.

use nalgebra::{Matrix3, SMatrix, SVector};

use super::kirchhoff::{Answer, DiscreteKirchhoff, SHORTEST_DIRECTOR, tangent_plane};
use crate::Vec3;
use crate::assembly::{Dof, LocalEnergy, LocalHessian, project_to_psd};
use crate::material::Section;

type Matrix9 = SMatrix<f64, 9, 9>;
type Vector9 = SVector<f64, 9>;

/// [`DiscreteKirchhoff`] at held positions.
pub(super) struct HeldKirchhoff<'a, S> {
    bending: &'a DiscreteKirchhoff<S>,
    /// S of every face.
    by_directors: Vec<Matrix9>,
}

/// Directions and lengths of the three directors.
struct Directors {
    units: [Vec3; 3],
    lengths: [f64; 3],
}

impl Directors {
    fn of(q: &Vector9) -> Self {
        let directors: [Vec3; 3] = std::array::from_fn(|c| q.fixed_rows::<3>(3 * c).into_owned());
        let lengths = directors.map(|d| d.norm());
        Self {
            units: std::array::from_fn(|c| directors[c] / lengths[c]),
            lengths,
        }
    }

    fn stacked(&self) -> Vector9 {
        Vector9::from_fn(|i, _| self.units[i / 3][i % 3])
    }
}

impl<'a, S: Section> HeldKirchhoff<'a, S> {
    pub(super) fn new(bending: &'a DiscreteKirchhoff<S>, by_directors: Vec<Matrix9>) -> Self {
        Self {
            bending,
            by_directors,
        }
    }

    fn answer(&self, face: usize, at: &Directors) -> Answer {
        let y = self.by_directors[face] * at.stacked();
        self.bending.answer(face, &y, &at.lengths)
    }

    fn gradient_from(&self, face: usize, at: &Directors, slope: &Vector9) -> Vector9 {
        let mut gradient = Vector9::zeros();
        for c in 0..3 {
            let w = slope.fixed_rows::<3>(3 * c).into_owned();
            let part = (self.bending).director_gradient(face, &at.units[c], at.lengths[c], &w);
            gradient.fixed_rows_mut::<3>(3 * c).copy_from(&part);
        }
        gradient
    }

    fn exact_hessian(
        &self,
        face: usize,
        at: &Directors,
        tangent: &Matrix9,
        slope: &Vector9,
    ) -> Matrix9 {
        let mut maps = Matrix9::zeros();
        for (c, unit) in at.units.iter().enumerate() {
            let map = (Matrix3::identity() - unit * unit.transpose()) / at.lengths[c];
            maps.fixed_view_mut::<3, 3>(3 * c, 3 * c).copy_from(&map);
        }
        let mut hessian: Matrix9 = maps * tangent * maps;
        for c in 0..3 {
            let w = slope.fixed_rows::<3>(3 * c).into_owned();
            let mut part = hessian.fixed_view_mut::<3, 3>(3 * c, 3 * c);
            part += (self.bending).director_curvature(face, &at.units[c], at.lengths[c], &w);
        }
        hessian
    }

    /// Positive semidefinite: directors turn within their tangent planes, in two dimensions each.
    fn clamped_hessian(
        &self,
        face: usize,
        at: &Directors,
        tangent: &Matrix9,
        slope: &Vector9,
    ) -> Matrix9 {
        let mut planes = SMatrix::<f64, 9, 6>::zeros();
        for (c, unit) in at.units.iter().enumerate() {
            let mut part = planes.fixed_view_mut::<3, 2>(3 * c, 2 * c);
            part.copy_from(&tangent_plane(unit));
        }
        let mut reduced: SMatrix<f64, 6, 6> = planes.tr_mul(&(tangent * planes));
        for i in 0..6 {
            let w = slope.fixed_rows::<3>(3 * (i / 2));
            reduced[(i, i)] -= at.units[i / 2].dot(&w);
        }
        project_to_psd(&mut reduced, 0.0);
        for c in 0..3 {
            let mut part = planes.fixed_view_mut::<3, 2>(3 * c, 2 * c);
            part /= at.lengths[c];
        }
        let mut hessian: Matrix9 = planes * reduced * planes.transpose();
        for c in 0..3 {
            let mut part = hessian.fixed_view_mut::<3, 3>(3 * c, 3 * c);
            part += (self.bending).clamped_holding(face, &at.units[c], at.lengths[c]);
        }
        hessian
    }
}

impl<S: Section> LocalEnergy<9, 3> for HeldKirchhoff<'_, S> {
    const NODE_SIZES: [usize; 3] = [3; 3];

    fn name(&self) -> &str {
        self.bending.name()
    }

    fn num_stencils(&self) -> usize {
        self.by_directors.len()
    }

    fn nodes(&self, stencil: usize) -> [Option<Dof>; 3] {
        self.bending.directors(stencil).map(Some)
    }

    fn value(&self, stencil: usize, q: &Vector9) -> f64 {
        self.answer(stencil, &Directors::of(q)).value
    }

    fn gradient(&self, stencil: usize, q: &Vector9) -> (f64, Vector9) {
        let at = Directors::of(q);
        let answer = self.answer(stencil, &at);
        let slope = self.by_directors[stencil].tr_mul(&answer.moments);
        (answer.value, self.gradient_from(stencil, &at, &slope))
    }

    fn hessian(&self, stencil: usize, q: &Vector9) -> LocalHessian<9> {
        self.projected_hessian(stencil, q, 1.0)
    }

    fn projected_hessian(&self, stencil: usize, q: &Vector9, kept: f64) -> LocalHessian<9> {
        let at = Directors::of(q);
        let answer = self.answer(stencil, &at);
        let by_directors = &self.by_directors[stencil];
        let slope = by_directors.tr_mul(&answer.moments);
        let tangent = by_directors.tr_mul(&(answer.tangent * by_directors));
        let exact = self.exact_hessian(stencil, &at, &tangent, &slope);
        let hessian = if kept == 1.0 {
            exact
        } else {
            let clamped = self.clamped_hessian(stencil, &at, &tangent, &slope);
            clamped + (exact - clamped) * kept
        };
        LocalHessian {
            value: answer.value,
            gradient: self.gradient_from(stencil, &at, &slope),
            hessian,
        }
    }

    fn is_admissible(&self, _stencil: usize, q: &Vector9) -> bool {
        (0..3).all(|c| q.fixed_rows::<3>(3 * c).norm() > SHORTEST_DIRECTOR)
    }

    fn describe(&self, stencil: usize) -> String {
        self.bending.describe(stencil)
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::Vector3;

    use super::*;
    use crate::energy::bending::vertex_normals;
    use crate::material::{Homogeneous, StVenantKirchhoff};
    use crate::mesh::Surface;
    use crate::mesh::generate::{GridDiagonals, grid};
    use crate::rest::rest_frames;

    /// Unknowns of a face of a wavy sheet, whose directors are neither its normals nor of unit length.
    fn unknowns(surface: &Surface, face: usize) -> SVector<f64, 18> {
        let normals = vertex_normals(surface);
        let corners = surface.mesh.faces()[face].map(|v| v as usize);
        SVector::from_fn(|i, _| {
            let (v, axis) = (corners[(i / 3) % 3], i % 3);
            if i < 9 {
                surface.positions[v][axis]
            } else {
                1.1 * normals[v][axis] + 0.3 * ((7 * v + axis) as f64).sin()
            }
        })
    }

    #[test]
    fn derivatives_are_those_with_free_positions() {
        let flat = grid(1.0, 1.0, 2, 2, GridDiagonals::Checkerboard).unwrap();
        let frames = rest_frames(&flat).unwrap();
        let mut surface = flat;
        for x in &mut surface.positions {
            x.z = 0.2 * (3.0 * x.x + x.y).sin();
        }
        let num_faces = surface.mesh.num_faces();
        let material = StVenantKirchhoff::new(1e6, 0.3);
        let bending = DiscreteKirchhoff::new(
            &surface.mesh,
            Dof(0),
            Dof(0),
            frames,
            vec![[Vector3::new(0.3, -0.2, 0.1); 3]; num_faces],
            Homogeneous::uniform(material, 0.01, num_faces),
        );
        let by_directors = (0..num_faces).map(|face| {
            let slopes = super::super::kirchhoff::kinematics(&unknowns(&surface, face)).slopes();
            Matrix9::from_fn(|k, column| slopes[k][2 + column / 3][column % 3])
        });
        let held = HeldKirchhoff::new(&bending, by_directors.collect());
        for face in 0..num_faces {
            let q = unknowns(&surface, face);
            let directors: Vector9 = q.fixed_rows::<9>(9).into_owned();
            for kept in [1.0, 0.4] {
                let whole = bending.projected_hessian(face, &q, kept);
                let part = held.projected_hessian(face, &directors, kept);
                let scale = whole.hessian.norm();
                assert!((whole.value - part.value).abs() < 1e-12 * whole.value);
                let gradient = whole.gradient.fixed_rows::<9>(9) - part.gradient;
                assert!(gradient.norm() < 1e-12 * whole.gradient.norm());
                // What is clamped depends on the space.
                let difference = whole.hessian.fixed_view::<9, 9>(9, 9) - part.hessian;
                assert!(kept < 1.0 || difference.norm() < 1e-12 * scale);
            }
            let clamped = held.projected_hessian(face, &directors, 0.0).hessian;
            let least = clamped.symmetric_eigenvalues().min();
            assert!(least > -1e-12 * clamped.norm(), "{least}");
        }
    }
}
