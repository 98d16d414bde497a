//! Repairs of faces and positions before they are a mesh: orientation, unreferenced and doubled vertices.

use std::collections::{HashMap, VecDeque};

use super::MeshError;
use crate::Vec3;

/// Reverses faces so that neighbours agree; returns the faces and how many were reversed.
///
/// Each component keeps the orientation of its first face. Needs no vertex count: indices are only compared.
///
/// # Errors
/// A face that repeats a vertex, an edge of more than two faces, a one-sided surface (Möbius strip).
pub fn orient_consistently(faces: Vec<[u32; 3]>) -> Result<(Vec<[u32; 3]>, usize), MeshError> {
    let neighbours = neighbours_across_edges(&faces)?;
    // None: not reached; Some(reversed).
    let mut reversed: Vec<Option<bool>> = vec![None; faces.len()];
    let mut queue = VecDeque::new();
    for start in 0..faces.len() {
        if reversed[start].is_some() {
            continue;
        }
        reversed[start] = Some(false);
        queue.push_back((start, false));
        while let Some((face, face_reversed)) = queue.pop_front() {
            for neighbour in neighbours[face].iter().flatten() {
                let wanted = face_reversed != neighbour.same_direction;
                match reversed[neighbour.face] {
                    None => {
                        reversed[neighbour.face] = Some(wanted);
                        queue.push_back((neighbour.face, wanted));
                    }
                    Some(found) if found != wanted => {
                        let faces = [face.min(neighbour.face), face.max(neighbour.face)];
                        return Err(MeshError::NotOrientable {
                            edge: neighbour.edge,
                            faces,
                        });
                    }
                    Some(_) => {}
                }
            }
        }
    }
    let mut faces = faces;
    let mut flipped = 0;
    for (face, reversed) in faces.iter_mut().zip(reversed) {
        if reversed == Some(true) {
            face.swap(1, 2);
            flipped += 1;
        }
    }
    Ok((faces, flipped))
}

/// Removes vertices that belong to no face; the others keep their order.
///
/// The third value lists the old index of every vertex kept.
///
/// # Errors
/// A face that uses a vertex beyond the positions.
#[expect(
    clippy::type_complexity,
    reason = "three plain arrays, named in the documentation"
)]
pub fn drop_unreferenced(
    positions: Vec<Vec3>,
    faces: Vec<[u32; 3]>,
) -> Result<(Vec<Vec3>, Vec<[u32; 3]>, Vec<u32>), MeshError> {
    let mut used = vec![false; positions.len()];
    for (face, corners) in faces.iter().enumerate() {
        for &vertex in corners {
            let num_vertices = positions.len();
            *used
                .get_mut(vertex as usize)
                .ok_or(MeshError::IndexOutOfRange {
                    face,
                    vertex,
                    num_vertices,
                })? = true;
        }
    }
    let kept: Vec<u32> = (0..positions.len() as u32)
        .filter(|&v| used[v as usize])
        .collect();
    if kept.len() == positions.len() {
        return Ok((positions, faces, kept));
    }
    let mut new_index = vec![u32::MAX; positions.len()];
    for (new, &old) in kept.iter().enumerate() {
        new_index[old as usize] = new as u32;
    }
    let positions = kept.iter().map(|&old| positions[old as usize]).collect();
    let faces = faces
        .into_iter()
        .map(|face| face.map(|v| new_index[v as usize]))
        .collect();
    Ok((positions, faces, kept))
}

/// Merges vertices with exactly equal coordinates (0 and −0 are equal); the first of each group stays.
///
/// Formats without shared vertices (STL) need it. Equality is exact: a tolerance would be a guess about the model.
/// Faces whose corners fall together become degenerate and are refused by the mesh, not dropped silently.
pub fn weld(positions: &[Vec3], faces: &[[u32; 3]]) -> (Vec<Vec3>, Vec<[u32; 3]>) {
    let mut welded = Vec::new();
    let mut index_of: HashMap<[u64; 3], u32> = HashMap::with_capacity(positions.len() / 2);
    let mut new_index = Vec::with_capacity(positions.len());
    for x in positions {
        // Adding 0.0 turns −0.0 into 0.0.
        let key = [x.x, x.y, x.z].map(|value| (value + 0.0).to_bits());
        let index = *index_of.entry(key).or_insert_with(|| {
            welded.push(*x);
            welded.len() as u32 - 1
        });
        new_index.push(index);
    }
    // Indices out of range stay as they are, to be refused by the mesh with their number.
    let renumber = |v: u32| new_index.get(v as usize).copied().unwrap_or(v);
    (
        welded,
        faces.iter().map(|face| face.map(renumber)).collect(),
    )
}

/// The face across an edge.
struct Neighbour {
    face: usize,
    edge: [u32; 2],
    /// Whether both faces, as given, traverse the edge in the same direction: one of them must be reversed.
    same_direction: bool,
}

fn neighbours_across_edges(faces: &[[u32; 3]]) -> Result<Vec<[Option<Neighbour>; 3]>, MeshError> {
    let mut half_edges = Vec::with_capacity(3 * faces.len());
    for (face, &corners) in faces.iter().enumerate() {
        for c in 0..3 {
            let (u, v) = (corners[(c + 1) % 3], corners[(c + 2) % 3]);
            if u == v {
                return Err(MeshError::RepeatedIndex {
                    face,
                    vertex: u,
                    corners,
                });
            }
            half_edges.push(([u.min(v), u.max(v)], face, c, u < v));
        }
    }
    half_edges.sort_unstable();
    let mut neighbours: Vec<[Option<Neighbour>; 3]> =
        faces.iter().map(|_| [const { None }; 3]).collect();
    for group in half_edges.chunk_by(|a, b| a.0 == b.0) {
        match *group {
            [_] => {}
            [(edge, a, corner_a, forward_a), (_, b, corner_b, forward_b)] => {
                let same_direction = forward_a == forward_b;
                neighbours[a][corner_a] = Some(Neighbour {
                    face: b,
                    edge,
                    same_direction,
                });
                neighbours[b][corner_b] = Some(Neighbour {
                    face: a,
                    edge,
                    same_direction,
                });
            }
            _ => {
                let (edge, faces) = (group[0].0, group.iter().map(|h| h.1).collect());
                return Err(MeshError::NonManifoldEdge { edge, faces });
            }
        }
    }
    Ok(neighbours)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::TriMesh;

    #[test]
    fn consistent_faces_are_left_alone() {
        let faces = vec![[0, 1, 2], [0, 2, 3]];
        assert_eq!(orient_consistently(faces.clone()), Ok((faces, 0)));
    }

    #[test]
    fn reversed_faces_are_turned_to_the_first_of_their_component() {
        let faces = vec![[0, 1, 2], [0, 3, 2], [7, 5, 6], [5, 6, 8]];
        let (repaired, flipped) = orient_consistently(faces).unwrap();
        assert_eq!(flipped, 2);
        assert_eq!(repaired[0], [0, 1, 2]);
        assert_eq!(repaired[2], [7, 5, 6]);
        assert!(TriMesh::new(4, repaired[..2].to_vec()).is_ok());
    }

    #[test]
    fn moebius_strip_is_refused() {
        let n = 6;
        let mut faces = Vec::new();
        for i in 0..n {
            let (a, b) = (2 * i, 2 * i + 1);
            let (c, d) = if i + 1 < n {
                (2 * i + 2, 2 * i + 3)
            } else {
                (1, 0)
            };
            faces.push([a, c, b]);
            faces.push([b, c, d]);
        }
        let error = orient_consistently(faces).unwrap_err();
        assert!(matches!(error, MeshError::NotOrientable { .. }));
        assert!(error.to_string().contains("one-sided"), "{error}");
    }

    #[test]
    fn three_faces_at_an_edge_cannot_be_oriented() {
        let error = orient_consistently(vec![[0, 1, 2], [0, 1, 3], [0, 1, 4]]).unwrap_err();
        assert_eq!(
            error,
            MeshError::NonManifoldEdge {
                edge: [0, 1],
                faces: vec![0, 1, 2]
            }
        );
    }

    #[test]
    fn dropping_keeps_order_and_tells_the_old_indices() {
        let positions: Vec<Vec3> = (0..5).map(|i| Vec3::new(f64::from(i), 0.0, 0.0)).collect();
        let (kept_positions, faces, kept) = drop_unreferenced(positions, vec![[4, 1, 3]]).unwrap();
        assert_eq!(kept, [1, 3, 4]);
        assert_eq!(faces, [[2, 0, 1]]);
        assert_eq!(kept_positions[2].x, 4.0);
        assert!(drop_unreferenced(vec![Vec3::zeros()], vec![[0, 0, 1]]).is_err());
    }

    #[test]
    fn welding_merges_equal_points_only() {
        let p = |x: f64, y: f64| Vec3::new(x, y, 0.0);
        let soup = [
            p(0.0, 0.0),
            p(1.0, 0.0),
            p(0.0, 1.0),
            p(1.0, 0.0),
            p(1.0, 1.0),
            p(-0.0, 1.0),
        ];
        let (positions, faces) = weld(&soup, &[[0, 1, 2], [3, 4, 5]]);
        assert_eq!(positions.len(), 4);
        assert_eq!(faces, [[0, 1, 2], [1, 3, 2]]);
        assert_eq!(weld(&[p(0.0, 0.0), p(1e-300, 0.0)], &[]).0.len(), 2);
    }
}
