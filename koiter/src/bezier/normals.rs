//! Normals at the vertices of a mesh.

use nalgebra::{DMatrix, DVector};

use super::{BezierShell, Pose};
use crate::Vec3;
use crate::mesh::{Surface, TriMesh, VertexId};

/// Normals at the vertices: of their faces, weighted by the angles there.
pub fn vertex_normals(surface: &Surface) -> Vec<Vec3> {
    mean_normals(surface.mesh.faces(), &surface.positions)
}

/// Normals at the vertices of a shell at a pose.
pub fn vertex_normals_at(shell: &BezierShell, pose: &Pose) -> Vec<Vec3> {
    mean_normals(shell.mesh().faces(), &pose.positions)
}

fn mean_normals(faces: &[[u32; 3]], positions: &[Vec3]) -> Vec<Vec3> {
    let mut normals = vec![Vec3::zeros(); positions.len()];
    for face in faces {
        let x = face.map(|v| positions[v as usize]);
        for c in 0..3 {
            let (a, b) = (x[(c + 1) % 3] - x[c], x[(c + 2) % 3] - x[c]);
            let cross = a.cross(&b);
            let angle = cross.norm().atan2(a.dot(&b));
            normals[face[c] as usize] += cross.normalize() * angle;
        }
    }
    normals.iter().map(|n| n.normalize()).collect()
}

/// Normals of a smooth surface through the vertices: at each that of the quadric which fits the vertices around it best,
///
/// ```text
/// z = a x + b y + c x² + d x y + e y²,   normal ∝ (−a, −b, 1)
/// ```
///
/// over the plane of the mean normal of its faces, from two edges around. At a boundary, where faces lie on one side, it is of
/// second order in the edges; a mean of faces is of first.
pub fn smooth_normals(surface: &Surface) -> Vec<Vec3> {
    let means = vertex_normals(surface);
    let fit = |v: usize| quadric_normal(surface, v as u32, &means[v]).unwrap_or(means[v]);
    (0..means.len()).map(fit).collect()
}

/// Directions in which the vertices around say less than this share of what they say in others are left out.
const LEAST_SHARE: f64 = 1e-3;

fn quadric_normal(surface: &Surface, vertex: u32, mean: &Vec3) -> Option<Vec3> {
    let around = two_rings(&surface.mesh, vertex);
    let centre = surface.positions[vertex as usize];
    let offsets = around
        .iter()
        .map(|v| surface.positions[*v as usize] - centre);
    let offsets: Vec<Vec3> = offsets.collect();
    let size = offsets.iter().map(Vec3::norm).fold(0.0, f64::max);
    let least = (0..3).min_by(|a, b| mean[*a].abs().total_cmp(&mean[*b].abs()))?;
    let first = mean.cross(&Vec3::ith(least, 1.0)).normalize();
    let second = mean.cross(&first);
    let mut rows = DMatrix::zeros(offsets.len(), 5);
    let mut heights = DVector::zeros(offsets.len());
    for (row, offset) in offsets.iter().enumerate() {
        let [x, y, z] = [first, second, *mean].map(|axis| axis.dot(offset) / size);
        for (column, value) in [x, y, x * x, x * y, y * y].into_iter().enumerate() {
            rows[(row, column)] = value;
        }
        heights[row] = z;
    }
    let decomposed = rows.svd(true, true);
    let cut = LEAST_SHARE * decomposed.singular_values.max();
    let fitted = decomposed.solve(&heights, cut).ok()?;
    let normal = mean - first * fitted[0] - second * fitted[1];
    (normal.norm() > 0.0 && normal.iter().all(|c| c.is_finite())).then(|| normal.normalize())
}

/// The vertices that are one or two edges away, sorted.
fn two_rings(mesh: &TriMesh, vertex: u32) -> Vec<u32> {
    let ring = |v: u32| {
        let faces = mesh.vertex_faces(VertexId(v)).iter();
        faces.flat_map(|face| mesh.faces()[face.0 as usize])
    };
    let mut found: Vec<u32> = ring(vertex)
        .flat_map(ring)
        .filter(|v| *v != vertex)
        .collect();
    found.sort_unstable();
    found.dedup();
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::generate::{GridDiagonals, sphere_zone};

    #[test]
    fn fitted_normals_of_a_sphere_are_radial_at_its_rim_too() {
        let quarter = [0.0, std::f64::consts::FRAC_PI_2];
        let zone =
            |cells| sphere_zone(2.0, quarter, [0.0, 1.2], [cells; 2], GridDiagonals::Uniform);
        let worst = [8, 16].map(|cells| {
            let surface = zone(cells).unwrap();
            let angle = |normals: Vec<Vec3>| -> f64 {
                (normals.iter().zip(&surface.positions))
                    .map(|(n, x)| n.angle(x))
                    .fold(0.0, f64::max)
            };
            [
                angle(smooth_normals(&surface)),
                angle(vertex_normals(&surface)),
            ]
        });
        // Of third order here, for the terms that a quadric lacks; means of faces are off by a third of the angle of a cell.
        assert!(
            worst[0][0] < 0.01 && worst[1][0] < worst[0][0] / 5.0,
            "{worst:?}"
        );
        assert!(worst[1][1] > 10.0 * worst[1][0], "{worst:?}");
    }
}
