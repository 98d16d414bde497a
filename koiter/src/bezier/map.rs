//! A fine surface carried by the shell: for pictures, forces and contact.
//!
//! A point of the fine surface is bound to an element at barycentric coordinates ξ. It then is, moves and is pushed by
//!
//! ```text
//! T = Σ N_i x_i + R_i ℓ_i        Ṫ = Σ N_i v_i + ω_i × R_i ℓ_i        f_i = N_i f,   τ_i = R_i ℓ_i × f
//! ```
//!
//! with N_i and ℓ_i constants of the point ([`super::control_points`]). The last is the transpose of the second, so
//! `Ṫ · f = Σ v_i · f_i + ω_i · τ_i` to round-off.
//! Reference: Golembiovsky and Duriez (2012), section 4, with levers that turn with their nodes.

use nalgebra::Vector3;

use super::control_points::corner_polynomials;
use super::pose::NODE_UNKNOWNS;
use super::{BezierError, BezierShell, Pose};
use crate::Vec3;
use crate::assembly::parallel_map;
use crate::contact::{Aabb, BoxTree};
use crate::geometry::point_triangle;
use crate::mesh::Surface;

/// A point of the shell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfacePoint {
    /// Its element.
    pub element: usize,
    /// Barycentric coordinates there.
    pub barycentric: [f64; 3],
}

/// What carries a point: N_i, and ℓ_i [m] as it hangs on node i at rest.
#[derive(Clone, Copy, Debug)]
pub struct Carried {
    /// Nodes of its element.
    pub nodes: [u32; 3],
    weights: [f64; 3],
    levers: [Vec3; 3],
}

impl Carried {
    /// How the shell carries a point.
    pub fn new(shell: &BezierShell, point: &SurfacePoint) -> Self {
        let xi = Vector3::from(point.barycentric);
        let of_corners = shell.elements()[point.element].levers();
        let mut carried = Self {
            nodes: shell.mesh().faces()[point.element],
            weights: [0.0; 3],
            levers: [Vec3::zeros(); 3],
        };
        for corner in 0..3 {
            let (own, factors) = corner_polynomials(corner, &xi);
            carried.weights[corner] = own.value;
            for (factor, lever) in factors.iter().zip(&of_corners[corner]) {
                carried.levers[corner] += lever * factor.value;
            }
        }
        carried
    }

    /// Position [m].
    pub fn position(&self, pose: &Pose) -> Vec3 {
        (0..3)
            .map(|i| pose.positions[self.nodes[i] as usize] * self.weights[i] + self.lever(i, pose))
            .sum()
    }

    /// R_i ℓ_i.
    fn lever(&self, corner: usize, pose: &Pose) -> Vec3 {
        pose.rotations[self.nodes[corner] as usize] * self.levers[corner]
    }

    /// The derivatives of the position by displacement and rotation of each node: 3 × 6.
    pub fn jacobians(&self, pose: &Pose) -> [nalgebra::SMatrix<f64, 3, 6>; 3] {
        [0, 1, 2].map(|i| {
            let mut jacobian = nalgebra::SMatrix::<f64, 3, 6>::zeros();
            for axis in 0..3 {
                jacobian[(axis, axis)] = self.weights[i];
            }
            let turn = -self.lever(i, pose).cross_matrix();
            jacobian.fixed_view_mut::<3, 3>(0, 3).copy_from(&turn);
            jacobian
        })
    }

    /// The velocity under velocities of the nodes, six numbers each [m/s, rad/s].
    fn velocity(&self, pose: &Pose, velocities: &[f64]) -> Vec3 {
        (0..3)
            .map(|i| {
                let of_node =
                    &velocities[NODE_UNKNOWNS * self.nodes[i] as usize..][..NODE_UNKNOWNS];
                let (v, omega) = (&of_node[..3], &of_node[3..]);
                Vec3::from_column_slice(v) * self.weights[i]
                    + Vec3::from_column_slice(omega).cross(&self.lever(i, pose))
            })
            .sum()
    }

    /// Adds what a force on the point does to its nodes.
    pub fn add_force(&self, pose: &Pose, force: &Vec3, loads: &mut [f64]) {
        for i in 0..3 {
            let first = NODE_UNKNOWNS * self.nodes[i] as usize;
            let moment = self.lever(i, pose).cross(force);
            for axis in 0..3 {
                loads[first + axis] += self.weights[i] * force[axis];
                loads[first + 3 + axis] += moment[axis];
            }
        }
    }
}

/// A mesh bound to a shell.
#[derive(Clone, Debug)]
pub struct MappedSurface {
    faces: Vec<[u32; 3]>,
    /// The element of each face.
    elements: Vec<u32>,
    points: Vec<SurfacePoint>,
    carried: Vec<Carried>,
    farthest: f64,
}

impl MappedSurface {
    /// Binds every vertex of `fine` to the closest point of the flat rest triangles: it is moved onto the smooth surface.
    ///
    /// # Errors
    /// A vertex farther than `limit` [m] from them.
    pub fn new(shell: &BezierShell, fine: &Surface, limit: f64) -> Result<Self, BezierError> {
        let search = ClosestElement::new(shell);
        let found = parallel_map(fine.positions.len(), |v| search.closest(&fine.positions[v]));
        let mut farthest = 0.0;
        for (vertex, (distance, _)) in found.iter().enumerate() {
            let distance = *distance;
            if distance.is_nan() || distance > limit {
                return Err(BezierError::FarFromShell {
                    vertex,
                    distance,
                    limit,
                });
            }
            farthest = f64::max(farthest, distance);
        }
        let points = found.into_iter().map(|(_, point)| point).collect();
        let mut mapped = Self::bound(shell, fine.mesh.faces().to_vec(), points);
        mapped.farthest = farthest;
        Ok(mapped)
    }

    /// A mesh of which every vertex is a known point of the shell.
    pub fn bound(shell: &BezierShell, faces: Vec<[u32; 3]>, points: Vec<SurfacePoint>) -> Self {
        let carried = points.iter().map(|p| Carried::new(shell, p)).collect();
        let of_corner = |face: &[u32; 3]| points[face[0] as usize].element as u32;
        Self {
            elements: faces.iter().map(of_corner).collect(),
            faces,
            points,
            carried,
            farthest: 0.0,
        }
    }

    /// Surfaces of pieces of a shell, each with the number of the first element of its piece, as one; common edges stay two.
    pub fn joined(shell: &BezierShell, pieces: &[(usize, Self)]) -> Self {
        let (mut faces, mut points, mut elements) = (Vec::new(), Vec::new(), Vec::new());
        for (first, piece) in pieces {
            let vertex = points.len() as u32;
            faces.extend(piece.faces.iter().map(|face| face.map(|v| vertex + v)));
            elements.extend(piece.elements.iter().map(|e| *first as u32 + e));
            points.extend(piece.points.iter().map(|point| SurfacePoint {
                element: first + point.element,
                ..*point
            }));
        }
        let mut joined = Self::bound(shell, faces, points);
        joined.elements = elements;
        joined.farthest = (pieces.iter().map(|(_, piece)| piece.farthest)).fold(0.0, f64::max);
        joined
    }

    /// Every element divided into `parts`² triangles, with common vertices on common edges.
    ///
    /// # Panics
    /// If there are no parts.
    pub fn subdivided(shell: &BezierShell, parts: usize) -> Self {
        assert!(parts > 0, "an element has at least one part");
        let mesh = shell.mesh();
        let inner_edge = parts - 1;
        let first_inner = mesh.num_vertices() + mesh.num_edges() * inner_edge;
        let inner_face = inner_edge * inner_edge.saturating_sub(1) / 2;
        let count = first_inner + mesh.num_faces() * inner_face;
        let mut points = vec![None; count];
        let mut faces = Vec::with_capacity(mesh.num_faces() * parts * parts);
        for (element, corners) in mesh.faces().iter().enumerate() {
            let mut inner = first_inner + element * inner_face;
            let mut rows: Vec<Vec<u32>> = Vec::with_capacity(parts + 1);
            for i in 0..=parts {
                let mut row = Vec::with_capacity(parts + 1 - i);
                for j in 0..=parts - i {
                    // Steps from the corners: of corner 0 what is left.
                    let steps = [parts - i - j, i, j];
                    let index = if let Some(c) = (0..3).find(|&c| steps[c] == parts) {
                        corners[c] as usize
                    } else if let Some(c) = (0..3).find(|&c| steps[c] == 0) {
                        let edge = mesh.face_edges()[element][c].0 as usize;
                        let (a, b) = ((c + 1) % 3, (c + 2) % 3);
                        let larger = if corners[a] < corners[b] { b } else { a };
                        mesh.num_vertices() + edge * inner_edge + steps[larger] - 1
                    } else {
                        inner += 1;
                        inner - 1
                    };
                    let barycentric = steps.map(|s| s as f64 / parts as f64);
                    points[index].get_or_insert(SurfacePoint {
                        element,
                        barycentric,
                    });
                    row.push(index as u32);
                }
                rows.push(row);
            }
            for i in 0..parts {
                for j in 0..parts - i {
                    faces.push([rows[i][j], rows[i + 1][j], rows[i][j + 1]]);
                    if i + j + 1 < parts {
                        faces.push([rows[i + 1][j], rows[i + 1][j + 1], rows[i][j + 1]]);
                    }
                }
            }
        }
        let points = points.into_iter();
        let points = points
            .map(|p| p.expect("every index was given to a point"))
            .collect();
        let per_element = (parts * parts) as u32;
        let mut mapped = Self::bound(shell, faces, points);
        mapped.elements = (0..mapped.faces.len() as u32)
            .map(|face| face / per_element)
            .collect();
        mapped
    }

    /// The element of each triangle; of a triangle that reaches over several that of its first corner.
    pub fn elements(&self) -> &[u32] {
        &self.elements
    }

    /// Triangles.
    pub fn faces(&self) -> &[[u32; 3]] {
        &self.faces
    }

    /// Edges of the triangles, each once, by smaller and larger vertex.
    pub fn edges(&self) -> Vec<[u32; 2]> {
        edges_of(&self.faces)
    }

    /// Where each vertex is bound.
    pub fn points(&self) -> &[SurfacePoint] {
        &self.points
    }

    /// What carries each vertex.
    pub fn carried(&self) -> &[Carried] {
        &self.carried
    }

    /// How far the farthest vertex was from the flat elements it was bound to [m].
    pub fn farthest(&self) -> f64 {
        self.farthest
    }

    /// Positions of the vertices [m].
    pub fn positions(&self, pose: &Pose) -> Vec<Vec3> {
        parallel_map(self.carried.len(), |v| self.carried[v].position(pose))
    }

    /// Velocities of the vertices [m/s] under those of the nodes, six numbers each.
    pub fn velocities(&self, pose: &Pose, of_nodes: &[f64]) -> Vec<Vec3> {
        parallel_map(self.carried.len(), |v| {
            self.carried[v].velocity(pose, of_nodes)
        })
    }

    /// Forces and moments on the nodes, six numbers each, of forces on the vertices [N].
    pub fn pull_back(&self, pose: &Pose, forces: &[Vec3]) -> Vec<f64> {
        let mut loads = vec![0.0; NODE_UNKNOWNS * pose.len()];
        for (carried, force) in self.carried.iter().zip(forces) {
            carried.add_force(pose, force, &mut loads);
        }
        loads
    }
}

/// Edges of triangles, each once, by smaller and larger vertex.
pub(super) fn edges_of(faces: &[[u32; 3]]) -> Vec<[u32; 2]> {
    let mut edges: Vec<[u32; 2]> = (faces.iter())
        .flat_map(|f| [[f[0], f[1]], [f[1], f[2]], [f[2], f[0]]])
        .map(|[a, b]| [a.min(b), a.max(b)])
        .collect();
    edges.sort_unstable();
    edges.dedup();
    edges
}

/// Finds closest points of the flat rest triangles.
pub(super) struct ClosestElement {
    corners: Vec<[Vec3; 3]>,
    tree: BoxTree,
    reach: f64,
}

impl ClosestElement {
    pub(super) fn new(shell: &BezierShell) -> Self {
        let corners: Vec<[Vec3; 3]> = shell.rest().iter().map(|rest| rest.corners).collect();
        let boxes: Vec<Aabb> = corners.iter().map(|x| Aabb::around(*x, 0.0)).collect();
        let mut tree = BoxTree::default();
        tree.rebuild(&boxes);
        let reach = (shell.area() / shell.elements().len() as f64).sqrt();
        Self {
            corners,
            tree,
            reach,
        }
    }

    /// Distance [m] and point; an infinite distance for a position that is not finite.
    pub(super) fn closest(&self, x: &Vec3) -> (f64, SurfacePoint) {
        let mut best = SurfacePoint {
            element: 0,
            barycentric: [1.0, 0.0, 0.0],
        };
        let mut least = f64::INFINITY;
        let mut margin = self.reach;
        // A box of the least distance found so far holds the closest element; a hundred doublings are all there are.
        for _ in 0..100 {
            let mut found = f64::INFINITY;
            (self.tree).overlapping(&Aabb::around([*x], margin), |element| {
                let [a, b, c] = &self.corners[element as usize];
                let closest = point_triangle(x, a, b, c);
                let distance = closest.distance_squared.sqrt();
                let first = element < best.element as u32;
                if distance < found || (distance == found && first) {
                    found = distance;
                    best = SurfacePoint {
                        element: element as usize,
                        barycentric: [1, 2, 3].map(|k| -closest.weights[k]),
                    };
                }
            });
            least = found;
            if found <= margin || !x.iter().all(|c| c.is_finite()) {
                break;
            }
            margin = if found.is_finite() {
                found
            } else {
                2.0 * margin
            };
        }
        (least, best)
    }
}

#[cfg(test)]
mod tests;
