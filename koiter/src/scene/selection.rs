//! Which vertices of a shell are meant: by box, number, boundary loop or nearness, in the start shape.

use super::spec::SelectSpec;
use crate::Vec3;
use crate::mesh::{Surface, VertexId};

/// Why a selection has no vertices.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SelectionError {
    /// A vertex number that does not exist.
    #[error("vertex {vertex} does not exist: the shell has {count} vertices, numbered from 0")]
    NoSuchVertex {
        /// The number.
        vertex: u32,
        /// Number of vertices.
        count: usize,
    },
    /// A boundary loop that does not exist.
    #[error("boundary loop {number} does not exist: the shell has {count} loops, numbered from 0")]
    NoSuchLoop {
        /// The number.
        number: usize,
        /// Number of loops.
        count: usize,
    },
    /// Conditions that no vertex meets.
    #[error(
        "the selection has no vertices; the shell's start shape lies between {} and {}",
        point(low),
        point(high)
    )]
    Empty {
        /// Smallest coordinates of the shell [m].
        low: Vec3,
        /// Largest coordinates of the shell [m].
        high: Vec3,
    },
}

fn point(x: &Vec3) -> String {
    format!("[{:.4}, {:.4}, {:.4}] m", x.x, x.y, x.z)
}

/// The vertices that meet all conditions, in increasing order; `nearest` is then the nearest of those.
///
/// A box has a tolerance of 1e-9 of the shell's size, so that an edge at x = 0.5 is in a box that begins there whatever
/// the rounding.
///
/// # Errors
/// A vertex or loop that does not exist; no vertex left.
pub fn select(spec: &SelectSpec, surface: &Surface) -> Result<Vec<VertexId>, SelectionError> {
    let count = surface.positions.len();
    let (low, high) = surface.bounding_box();
    let tolerance = 1e-9 * (high - low).norm();
    let mut chosen = vec![true; count];
    if let Some(vertices) = &spec.vertices {
        let mut listed = vec![false; count];
        for &vertex in vertices {
            *listed
                .get_mut(vertex as usize)
                .ok_or(SelectionError::NoSuchVertex { vertex, count })? = true;
        }
        keep(&mut chosen, &listed);
    }
    if let Some(number) = spec.boundary {
        let loops = surface.mesh.boundary_loops();
        let count_loops = loops.len();
        let vertices = loops.get(number).ok_or(SelectionError::NoSuchLoop {
            number,
            count: count_loops,
        })?;
        let mut listed = vec![false; count];
        for vertex in vertices {
            listed[vertex.0 as usize] = true;
        }
        keep(&mut chosen, &listed);
    }
    if let Some(bounds) = &spec.cuboid {
        let inside = |x: &Vec3| {
            (0..3).all(|axis| {
                x[axis] >= bounds.min[axis] - tolerance && x[axis] <= bounds.max[axis] + tolerance
            })
        };
        let listed: Vec<bool> = surface.positions.iter().map(inside).collect();
        keep(&mut chosen, &listed);
    }
    let mut vertices: Vec<usize> = (0..count).filter(|&vertex| chosen[vertex]).collect();
    if let Some(target) = spec.nearest {
        let distance = |v: &usize| (surface.positions[*v] - Vec3::from(target)).norm();
        let nearest = vertices
            .iter()
            .copied()
            .min_by(|a, b| distance(a).total_cmp(&distance(b)));
        vertices = nearest.into_iter().collect();
    }
    if vertices.is_empty() {
        return Err(SelectionError::Empty { low, high });
    }
    Ok(vertices.into_iter().map(|v| VertexId(v as u32)).collect())
}

fn keep(chosen: &mut [bool], listed: &[bool]) {
    for (chosen, listed) in chosen.iter_mut().zip(listed) {
        *chosen &= listed;
    }
}

#[cfg(test)]
mod tests {
    use super::super::spec::BoundsSpec;
    use super::*;
    use crate::mesh::generate::{GridDiagonals, grid};

    fn sheet() -> Surface {
        grid(1.0, 1.0, 4, 4, GridDiagonals::Uniform).unwrap()
    }

    fn numbers(spec: &SelectSpec) -> Vec<u32> {
        let vertices = select(spec, &sheet()).unwrap();
        vertices.into_iter().map(|vertex| vertex.0).collect()
    }

    #[test]
    fn a_box_takes_its_faces_and_conditions_combine() {
        let mut spec = SelectSpec {
            cuboid: Some(BoundsSpec {
                min: [0.5, -1.0, -1.0],
                max: [1.0, 1.0, 1.0],
            }),
            ..SelectSpec::default()
        };
        assert_eq!(numbers(&spec), [4, 9, 14, 19, 24]);
        spec.vertices = Some(vec![24, 3, 4]);
        assert_eq!(numbers(&spec), [4, 24]);
        spec.nearest = Some([0.4, 0.3, 0.0]);
        assert_eq!(numbers(&spec), [24]);
    }

    #[test]
    fn a_boundary_loop_is_the_rim() {
        let spec = SelectSpec {
            boundary: Some(0),
            ..SelectSpec::default()
        };
        assert_eq!(numbers(&spec).len(), 16);
    }

    #[test]
    fn what_selects_nothing_says_why() {
        let message = |spec: SelectSpec| select(&spec, &sheet()).unwrap_err().to_string();
        let none = SelectSpec::default();
        let text = message(SelectSpec {
            vertices: Some(vec![25]),
            ..none.clone()
        });
        assert!(
            text.contains("vertex 25") && text.contains("25 vertices"),
            "{text}"
        );
        let text = message(SelectSpec {
            boundary: Some(1),
            ..none.clone()
        });
        assert!(
            text.contains("loop 1") && text.contains("1 loops"),
            "{text}"
        );
        let text = message(SelectSpec {
            cuboid: Some(BoundsSpec {
                min: [2.0; 3],
                max: [3.0; 3],
            }),
            ..none
        });
        assert!(text.contains("[-0.5000, -0.5000, 0.0000]"), "{text}");
    }
}
