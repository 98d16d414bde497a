//! Triangulations that know edge lengths only, and their Delaunay flips.
//!
//! An edge is intrinsic Delaunay if its two opposite angles sum to at most π: `cot φ + cot φ' ≥ 0`. Flipping edges that are
//! not, each laid out flat with its two faces, ends in the intrinsic Delaunay triangulation of the polyhedral surface; its
//! cotangent Laplacian has no negative weights. The surface and its vertices stay, only the straight edges upon it change.
//! Two vertices may then share several edges, and an edge may end where it began, so faces are glued side to side and edges
//! have no names.
//!
//! Reference: Bobenko and Springborn, "A Discrete Laplace–Beltrami Operator for Simplicial Surfaces" (2007): every edge
//! that is not Delaunay can be flipped, and flips end.

use crate::mesh::Surface;

/// The side of a face opposite one of its corners.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Side {
    face: usize,
    corner: usize,
}

impl Side {
    /// The side opposite the corner `steps` further on.
    fn turned(self, steps: usize) -> Self {
        Self {
            face: self.face,
            corner: (self.corner + steps) % 3,
        }
    }
}

/// Cotangents that sum to more than minus this belong to an edge that stays. Right triangles of a regular grid sum to 0
/// and to some 1e-13 of round-off, and either diagonal is Delaunay then; flips that gain nothing could also go on
/// for ever.
const TOLERANCE: f64 = 1e-10;

/// Triangles given by edge lengths and glued along their sides.
#[derive(Clone, Debug)]
pub struct IntrinsicTriangulation {
    faces: Vec<[u32; 3]>,
    /// Length of the side opposite each corner [m].
    lengths: Vec<[f64; 3]>,
    /// The side it is glued to; none on the boundary.
    across: Vec<[Option<Side>; 3]>,
}

impl IntrinsicTriangulation {
    /// The faces of a surface as they are.
    pub fn of_surface(surface: &Surface) -> Self {
        let mesh = &surface.mesh;
        let side_across = |face: usize, corner: usize| {
            let edge = mesh.face_edges()[face][corner];
            let neighbor = mesh.edge_faces()[edge.0 as usize]
                .into_iter()
                .flatten()
                .find(|f| f.0 as usize != face)?;
            let face = neighbor.0 as usize;
            let corner = (0..3).find(|&c| mesh.face_edges()[face][c] == edge)?;
            Some(Side { face, corner })
        };
        let lengths = |face| {
            let x = surface.corners(face);
            std::array::from_fn(|c| (x[(c + 2) % 3] - x[(c + 1) % 3]).norm())
        };
        let num_faces = mesh.num_faces();
        Self {
            faces: mesh.faces().to_vec(),
            lengths: (0..num_faces).map(lengths).collect(),
            across: (0..num_faces)
                .map(|f| std::array::from_fn(|c| side_across(f, c)))
                .collect(),
        }
    }

    /// Vertices of every face, counter-clockwise; a vertex may occur twice in a face.
    pub fn faces(&self) -> &[[u32; 3]] {
        &self.faces
    }

    /// Whether the side of a face opposite the corner is on the boundary.
    pub fn is_boundary(&self, face: usize, corner: usize) -> bool {
        self.across[face][corner].is_none()
    }

    /// Area of a face [m²]: Heron's formula in Kahan's order, which loses nothing in needles.
    pub fn area(&self, face: usize) -> f64 {
        let mut l = self.lengths[face];
        l.sort_by(|a, b| b.total_cmp(a));
        let [a, b, c] = l;
        0.25 * ((a + (b + c)) * (c - (a - b)) * (c + (a - b)) * (a + (b - c))).sqrt()
    }

    /// Cotangents of the three angles of a face.
    pub fn cotangents(&self, face: usize) -> [f64; 3] {
        let four_areas = 4.0 * self.area(face);
        let [a, b, c] = self.lengths[face].map(|l| l * l);
        [b + c - a, c + a - b, a + b - c].map(|x| x / four_areas)
    }

    /// Sum of the cotangents opposite an edge; none on the boundary.
    fn weight(&self, side: Side) -> Option<f64> {
        let other = self.across[side.face][side.corner]?;
        Some(self.cotangents(side.face)[side.corner] + self.cotangents(other.face)[other.corner])
    }

    /// Flips edges until all are Delaunay; boundary edges stay. Returns the number of flips.
    ///
    /// Every flip lowers the energy of interpolated functions, so no triangulation comes twice, and there are finitely
    /// many below a given longest edge.
    pub fn make_delaunay(&mut self) -> usize {
        let num_sides = 3 * self.faces.len();
        let mut to_check: Vec<Side> = (0..num_sides)
            .rev()
            .map(|s| Side {
                face: s / 3,
                corner: s % 3,
            })
            .collect();
        let mut flips = 0;
        while let Some(side) = to_check.pop() {
            if self.weight(side).is_some_and(|w| w < -TOLERANCE) {
                to_check.extend(self.flip(side));
                flips += 1;
            }
        }
        flips
    }

    /// Replaces the edge a b of the faces (p, a, b), (q, b, a) by p q: the faces become (p, a, q), (q, b, p). Returns the
    /// four sides around.
    fn flip(&mut self, side: Side) -> [Side; 4] {
        let other = self.across[side.face][side.corner].expect("the edge is not on the boundary");
        assert_ne!(
            side.face, other.face,
            "an edge of one face twice is Delaunay"
        );
        let vertex = |s: Side| self.faces[s.face][s.corner];
        let ([p, a, b], q) = ([0, 1, 2].map(|i| vertex(side.turned(i))), vertex(other));
        let diagonal = self.diagonal(side, other);
        let new = |face, corner| Side { face, corner };
        let (f, g) = (side.face, other.face);
        // The sides around, where they were and where they will be.
        let old = [
            other.turned(1),
            side.turned(2),
            side.turned(1),
            other.turned(2),
        ];
        let moved = [new(f, 0), new(f, 2), new(g, 0), new(g, 2)];
        let glued = old.map(|s| {
            let across = self.across[s.face][s.corner];
            across.map(|n| old.iter().position(|&o| o == n).map_or(n, |i| moved[i]))
        });
        let [aq, pa, bp, qb] = old.map(|s| self.lengths[s.face][s.corner]);
        self.faces[f] = [p, a, q];
        self.faces[g] = [q, b, p];
        self.lengths[f] = [aq, diagonal, pa];
        self.lengths[g] = [bp, diagonal, qb];
        self.across[f][1] = Some(new(g, 1));
        self.across[g][1] = Some(new(f, 1));
        for (side, neighbor) in moved.into_iter().zip(glued) {
            self.across[side.face][side.corner] = neighbor;
            if let Some(n) = neighbor {
                self.across[n.face][n.corner] = Some(side);
            }
        }
        moved
    }

    /// Distance of the apexes of two glued sides in the plane.
    fn diagonal(&self, side: Side, other: Side) -> f64 {
        let base = self.lengths[side.face][side.corner];
        // Along the edge from a to b and across it; the second face traverses it from b to a.
        let [p, q] = [(side, [2, 1]), (other, [1, 2])].map(|(s, turns)| {
            let [from_a, from_b] = turns.map(|t| {
                let s = s.turned(t);
                self.lengths[s.face][s.corner]
            });
            let along = 0.5 * (base + (from_a - from_b) * (from_a + from_b) / base);
            [along, 2.0 * self.area(s.face) / base]
        });
        (p[0] - q[0]).hypot(p[1] + q[1])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Vec3;
    use crate::mesh::TriMesh;

    fn surface(points: &[[f64; 3]], faces: &[[u32; 3]]) -> Surface {
        Surface {
            mesh: TriMesh::new(points.len(), faces.to_vec()).unwrap(),
            positions: points.iter().map(|p| Vec3::from(*p)).collect(),
        }
    }

    /// Sides are glued both ways, with one length and opposite vertices; no interior edge has a negative weight.
    fn check(t: &IntrinsicTriangulation) {
        for face in 0..t.faces.len() {
            for corner in 0..3 {
                let side = Side { face, corner };
                let Some(other) = t.across[face][corner] else {
                    continue;
                };
                assert_eq!(t.across[other.face][other.corner], Some(side));
                let end = |s: Side, i: usize| t.faces[s.face][(s.corner + i) % 3];
                assert_eq!(end(side, 1), end(other, 2));
                assert_eq!(end(side, 2), end(other, 1));
                assert_eq!(t.lengths[face][corner], t.lengths[other.face][other.corner]);
                assert!(t.weight(side).unwrap() >= -TOLERANCE);
            }
        }
    }

    fn total_area(t: &IntrinsicTriangulation) -> f64 {
        (0..t.faces.len()).map(|f| t.area(f)).sum()
    }

    #[test]
    fn a_needle_pair_is_flipped_and_laid_out_flat() {
        // Folded about the long diagonal; flat, the short diagonal is √(0.6² + 0) long after unfolding.
        let s = surface(
            &[
                [0.0, 0.0, 0.0],
                [1.0, 0.0, 0.0],
                [0.5, 0.2, 0.1],
                [0.5, -0.2, 0.1],
            ],
            &[[0, 1, 2], [1, 0, 3]],
        );
        let mut t = IntrinsicTriangulation::of_surface(&s);
        let area = total_area(&t);
        assert_eq!(t.make_delaunay(), 1);
        check(&t);
        let height = 0.2f64.hypot(0.1);
        assert!((t.lengths[0][1] - 2.0 * height).abs() < 1e-15);
        assert!((total_area(&t) - area).abs() < 1e-15);
    }

    #[test]
    fn a_square_keeps_its_diagonal() {
        let s = surface(
            &[
                [0.1, 0.2, 0.3],
                [1.1, 0.2, 0.3],
                [1.1, 1.2, 0.3],
                [0.1, 1.2, 0.3],
            ],
            &[[0, 1, 2], [0, 2, 3]],
        );
        assert_eq!(IntrinsicTriangulation::of_surface(&s).make_delaunay(), 0);
    }

    #[test]
    fn a_sheared_grid_becomes_delaunay() {
        let n = 12u32;
        let mut points = Vec::new();
        let mut faces = Vec::new();
        for j in 0..=n {
            for i in 0..=n {
                let (x, y) = (f64::from(i), f64::from(j));
                let z = 0.4 * (1.3 * x).sin() * (0.9 * y).cos();
                points.push([x + 3.7 * y, y, z]);
                if i < n && j < n {
                    let v = j * (n + 1) + i;
                    faces.push([v, v + 1, v + n + 2]);
                    faces.push([v, v + n + 2, v + n + 1]);
                }
            }
        }
        let mut t = IntrinsicTriangulation::of_surface(&surface(&points, &faces));
        let area = total_area(&t);
        assert!(t.make_delaunay() > 500);
        check(&t);
        // A few hundred triangles of round-off.
        assert!((total_area(&t) - area).abs() < 1e-11 * area);
    }

    #[test]
    fn an_edge_may_end_where_it_began() {
        // A tall pyramid over a triangle, without its base: around the apex, going about it is shorter than over it.
        let s = surface(
            &[
                [0.0, 0.0, 20.0],
                [1.0, 0.0, 0.0],
                [-0.5, 0.9, 0.0],
                [-0.5, -0.8, 0.0],
                [8.0, 0.0, -30.0],
                [-4.0, 7.0, -30.0],
                [-4.0, -7.0, -30.0],
            ],
            &[
                [0, 1, 2],
                [0, 2, 3],
                [0, 3, 1],
                [1, 4, 2],
                [4, 5, 2],
                [2, 5, 3],
                [5, 6, 3],
                [3, 6, 1],
                [6, 4, 1],
            ],
        );
        let mut t = IntrinsicTriangulation::of_surface(&s);
        t.make_delaunay();
        check(&t);
    }
}
