//! Do surfaces intersect? Decided with exact predicates, independently of distances, barriers and candidates.
//!
//! Two triangle meshes in general position intersect if and only if an edge of one crosses a face of the other, so all
//! edges are tested against all faces with which they share no vertex. The test is exact for every input; an edge that
//! only touches a face counts as crossing.

use super::boxes::Aabb;
use super::broad_phase::BoxTree;
use crate::Vec3;
use crate::geometry::segment_meets_triangle;

/// An edge that crosses a face.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Intersection {
    /// Index of the edge.
    pub edge: u32,
    /// Index of the face.
    pub face: u32,
}

/// All edges that cross faces, by edge and then by face; pairs that share a vertex or for which `ignore` holds (by one
/// vertex of each) are left out.
pub fn intersections(
    positions: &[Vec3],
    edges: &[[u32; 2]],
    faces: &[[u32; 3]],
    ignore: impl Fn(u32, u32) -> bool + Sync + Send,
) -> Vec<Intersection> {
    let at = |v: u32| &positions[v as usize];
    let face_boxes: Vec<Aabb> = faces
        .iter()
        .map(|f| Aabb::around(f.map(|v| *at(v)), 0.0))
        .collect();
    let edge_boxes: Vec<Aabb> = edges
        .iter()
        .map(|e| Aabb::around(e.map(|v| *at(v)), 0.0))
        .collect();
    let mut tree = BoxTree::default();
    tree.rebuild(&face_boxes);
    let check = |edge: u32, face: u32| {
        let (e, f) = (edges[edge as usize], faces[face as usize]);
        let crossing = !f.contains(&e[0])
            && !f.contains(&e[1])
            && !ignore(e[0], f[0])
            && segment_meets_triangle(at(e[0]), at(e[1]), [at(f[0]), at(f[1]), at(f[2])]);
        crossing.then_some(Intersection { edge, face })
    };
    let mut found = (tree.pairs(&edge_boxes, usize::MAX, |_, _| false, check)).unwrap_or_default();
    found.sort_unstable_by_key(|hit| (hit.edge, hit.face));
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    fn v(x: f64, y: f64, z: f64) -> Vec3 {
        Vec3::new(x, y, z)
    }

    #[test]
    fn an_edge_through_a_face_is_found() {
        let positions = [
            v(0.0, 0.0, 0.0),
            v(1.0, 0.0, 0.0),
            v(0.0, 1.0, 0.0),
            v(0.2, 0.2, -1.0),
            v(0.2, 0.2, 1.0),
        ];
        let found = intersections(&positions, &[[3, 4]], &[[0, 1, 2]], |_, _| false);
        assert_eq!(found, [Intersection { edge: 0, face: 0 }]);
        assert!(intersections(&positions, &[[3, 4]], &[[0, 1, 2]], |_, _| true).is_empty());
    }

    #[test]
    fn an_edge_beside_a_face_is_not() {
        let mut positions = [
            v(0.0, 0.0, 0.0),
            v(1.0, 0.0, 0.0),
            v(0.0, 1.0, 0.0),
            v(0.8, 0.8, -1.0),
            v(0.8, 0.8, 1.0),
        ];
        assert!(intersections(&positions, &[[3, 4]], &[[0, 1, 2]], |_, _| false).is_empty());
        positions[3] = v(0.2, 0.2, 1e-300);
        assert!(intersections(&positions, &[[3, 4]], &[[0, 1, 2]], |_, _| false).is_empty());
    }
}
