//! A fine surface that was bound before a cut: triangles that the cut goes through are divided.
//!
//! A triangle with corners at both lips is divided where the cut crosses its edges; every crossing becomes two vertices, one on
//! either lip. They are found by halving the edge: the closest element of a point of it is at one lip or at the other. Where that is at
//! the end of an edge the vertex there is one of the two, and gets a twin.

use std::collections::HashMap;

use super::change::Change;
use super::map::{ClosestElement, MappedSurface, SurfacePoint};
use crate::Vec3;

/// Halvings of an edge: a crossing is found to a billionth of it.
const HALVINGS: usize = 30;

/// A crossing nearer to an end of its edge than this fraction of it is there: what would be cut off is narrower than anything that
/// touches or is seen.
const AT_END: f64 = 1e-3;

/// The fine surface as it is divided.
struct Torn<'a> {
    change: &'a Change,
    search: ClosestElement,
    /// For every element, at which lip it is.
    sides: Vec<Option<bool>>,
    points: Vec<SurfacePoint>,
    /// The vertices at the crossing of an edge, by its ends in order: on the side of the first, on that of the second.
    crossings: HashMap<[u32; 2], [u32; 2]>,
    /// Of vertices that the cut goes through, the vertex on the other lip.
    twins: HashMap<u32, u32>,
}

impl Change {
    /// A fine surface on the new shell, and how many of its triangles were divided because the cut goes through them.
    pub fn surface(&self, old: &MappedSurface) -> (MappedSurface, usize) {
        let mut torn = Torn {
            change: self,
            search: ClosestElement::new(&self.shell),
            sides: self.sides(),
            points: self.points(old.points()),
            crossings: HashMap::new(),
            twins: HashMap::new(),
        };
        let mut faces = Vec::with_capacity(old.faces().len());
        let mut divided = 0;
        for face in old.faces() {
            match torn.lone_corner(face) {
                None => faces.push(*face),
                Some(corner) => {
                    faces.extend(torn.divide(face, corner));
                    divided += 1;
                }
            }
        }
        let Torn { points, .. } = torn;
        (MappedSurface::bound(&self.shell, faces, points), divided)
    }
}

impl Torn<'_> {
    fn side(&self, vertex: u32) -> Option<bool> {
        self.sides[self.points[vertex as usize].element]
    }

    /// The corner that is alone at its lip, if the corners of a face are at both.
    fn lone_corner(&self, face: &[u32; 3]) -> Option<usize> {
        let sides = face.map(|v| self.side(v));
        let known = sides.iter().flatten().next()?;
        // What touches no lip, beyond the end of the cut, goes with either.
        let sides = sides.map(|side| side.unwrap_or(*known));
        (0..3).find(|&c| sides[c] != sides[(c + 1) % 3] && sides[c] != sides[(c + 2) % 3])
    }

    /// The triangle at the lone corner, and the two of what is left; without those that are an edge or a vertex.
    fn divide(&mut self, face: &[u32; 3], corner: usize) -> Vec<[u32; 3]> {
        let [a, b, c] = [0, 1, 2].map(|k| face[(corner + k) % 3]);
        let [near_b, far_b] = self.crossing(a, b);
        let [near_c, far_c] = self.crossing(a, c);
        let parts = [[a, near_b, near_c], [far_b, b, c], [far_b, c, far_c]];
        let is_triangle = |[a, b, c]: &[u32; 3]| a != b && b != c && c != a;
        parts.into_iter().filter(is_triangle).collect()
    }

    /// The vertices where the cut crosses an edge: at the lip of `a`, at that of `b`.
    fn crossing(&mut self, a: u32, b: u32) -> [u32; 2] {
        let key = [a.min(b), a.max(b)];
        let made = match self.crossings.get(&key) {
            Some(made) => *made,
            None => {
                let made = self.cross(key);
                self.crossings.insert(key, made);
                made
            }
        };
        if a < b { made } else { [made[1], made[0]] }
    }

    fn cross(&mut self, edge: [u32; 2]) -> [u32; 2] {
        let place = |v: u32| self.change.shell.rest_position(&self.points[v as usize]);
        let [start, end]: [Vec3; 2] = edge.map(place);
        let end_side = self.side(edge[1]);
        let mut points = edge.map(|v| self.points[v as usize]);
        let mut ends = [0.0, 1.0];
        for _ in 0..HALVINGS {
            let middle = 0.5 * (ends[0] + ends[1]);
            let (_, point) = self.search.closest(&(start + (end - start) * middle));
            let which = usize::from(self.sides[point.element] == end_side);
            (ends[which], points[which]) = (middle, point);
        }
        match ends[0] {
            t if t < AT_END => [edge[0], self.twin(edge[0], points[1])],
            t if t > 1.0 - AT_END => [self.twin(edge[1], points[0]), edge[1]],
            _ => points.map(|point| self.add(point)),
        }
    }

    fn twin(&mut self, vertex: u32, point: SurfacePoint) -> u32 {
        if let Some(twin) = self.twins.get(&vertex) {
            return *twin;
        }
        let twin = self.add(point);
        self.twins.insert(vertex, twin);
        twin
    }

    fn add(&mut self, point: SurfacePoint) -> u32 {
        self.points.push(point);
        self.points.len() as u32 - 1
    }
}
