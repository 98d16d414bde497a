//! Delaunay refinement of a plane domain whose boundary stays as it is.
//!
//! A triangle is bad that is larger than `max_area` or has an angle below the least one. Into each goes a point on the
//! bisector of its shortest edge (length d), at the height
//!
//! ```text
//! min(½ cot γ, c) d      γ: angle opposite that edge; ½ cot γ: the circumcentre
//! c = 0.475 √((1 + cos α) / (1 − cos α))      α: least angle; c: the off-centre, for γ below about α/2
//! ```
//!
//! unless the point encroaches on a boundary segment (lies in its diametral circle): then the triangle stays. Bad
//! triangles come in the order of their shortest edges, in classes a factor √2 of squared length wide, within a class in
//! the order in which they were found. The triangles around a new point are looked at counter-clockwise from the side
//! of the triangle it was made for. The order matters beyond the count of triangles: the angles, and with them energies
//! of models that do not converge on irregular meshes, differ by some percent with another one.
//!
//! References: Ruppert (1995); Shewchuk, "Delaunay refinement algorithms for triangular mesh generation" (2002);
//! Üngör, "Off-centers: a new type of Steiner points" (2004). Predicates are exact.

use std::collections::{BTreeMap, VecDeque};

use robust::{Coord, incircle, orient2d};
use spade::{ConstrainedDelaunayTriangulation, Point2, Triangulation};

/// In place of a neighbour: there is none, the edge is a boundary segment.
const OUTSIDE: u32 = u32::MAX;

/// With ½ the triangle of shortest edge and off-centre would have just the least angle; a little less keeps clear of
/// round-off.
const OFF_CENTRE_SHARE: f64 = 0.475;

/// Triangles, counter-clockwise, with edge i and neighbour i opposite corner i; those that are bad wait in classes.
pub(super) struct Refinement {
    pub(super) points: Vec<[f64; 2]>,
    pub(super) triangles: Vec<[u32; 3]>,
    neighbours: Vec<[u32; 3]>,
    max_area: f64,
    max_cos: f64,
    /// By class of shortest edge: a triangle's number and its corners, by which a replaced one is known.
    bad: BTreeMap<u64, VecDeque<(u32, [u32; 3])>>,
    /// Triangles whose circumcircle contains the new point, and the edges around them, counter-clockwise.
    cavity: Vec<u32>,
    rim: Vec<RimEdge>,
    crossings: Vec<(u32, usize)>,
}

struct RimEdge {
    ends: [u32; 2],
    beyond: u32,
}

impl Refinement {
    /// Of a triangulation whose hull is its boundary, with no triangle above `max_area` and none with an angle below
    /// `min_angle` [rad] where the boundary permits.
    pub(super) fn new(
        triangulation: &ConstrainedDelaunayTriangulation<Point2<f64>>,
        max_area: f64,
        min_angle: f64,
    ) -> Self {
        let points = triangulation.vertices().map(|v| v.position().into());
        let edges = triangulation.inner_faces().map(|f| f.adjacent_edges());
        let (triangles, neighbours) = edges
            .map(|edges| {
                // Spade's edge i leads from corner i to i + 1, and its face 0 is the outer one.
                let opposite = [1, 2, 0].map(|i| edges[i]);
                (
                    edges.map(|edge| edge.from().fix().index() as u32),
                    opposite.map(|edge| {
                        let other = edge.rev().face().as_inner();
                        other.map_or(OUTSIDE, |face| face.fix().index() as u32 - 1)
                    }),
                )
            })
            .unzip();
        Self {
            points: points.collect(),
            triangles,
            neighbours,
            max_area,
            max_cos: min_angle.cos(),
            bad: BTreeMap::new(),
            cavity: Vec::new(),
            rim: Vec::new(),
            crossings: Vec::new(),
        }
    }

    /// Refines until no bad triangle can be improved; `false` if that takes more than `most_points`.
    pub(super) fn run(&mut self, most_points: usize) -> bool {
        (0..self.triangles.len() as u32).for_each(|t| self.judge(t));
        while let Some(mut class) = self.bad.first_entry() {
            let Some((triangle, corners)) = class.get_mut().pop_front() else {
                class.remove();
                continue;
            };
            if self.triangles[triangle as usize] == corners {
                self.improve(triangle);
            }
            if self.points.len() > most_points {
                return false;
            }
        }
        true
    }

    /// Puts a triangle among the bad if it is.
    fn judge(&mut self, triangle: u32) {
        let (edges, squares, s) = self.edges(triangle);
        let (next, last) = ((s + 1) % 3, (s + 2) % 3);
        let area = 0.5 * cross(edges[0], edges[1]);
        // The least angle is opposite the shortest edge, between the other two, and acute.
        let cos_squared_scaled = dot(edges[next], edges[last]).powi(2);
        if area > self.max_area
            || cos_squared_scaled > self.max_cos * self.max_cos * squares[next] * squares[last]
        {
            // The binary exponent of length⁴ is that of √2 in length².
            let class = (squares[s] / self.max_area).powi(2).to_bits() >> 52;
            let waiting = self.bad.entry(class).or_default();
            waiting.push_back((triangle, self.triangles[triangle as usize]));
        }
    }

    /// Puts a point in or near a bad triangle unless it would encroach on the boundary or coincide with another.
    fn improve(&mut self, triangle: u32) {
        let point = self.better_point(triangle);
        let Some((start, entry)) = self.locate(triangle, point) else {
            return;
        };
        let coincides = |&v: &u32| self.points[v as usize] == point;
        if self.triangles[start as usize].iter().any(coincides) {
            return;
        }
        self.find_cavity(start, entry, point);
        let encroaches = |edge: &RimEdge| {
            let [a, b] = edge.ends.map(|v| minus(self.points[v as usize], point));
            edge.beyond == OUTSIDE && dot(a, b) < 0.0
        };
        if !self.rim.iter().any(encroaches) {
            self.fill_cavity(point);
        }
    }

    /// The circumcentre, or the off-centre where that is nearer to the shortest edge.
    fn better_point(&self, triangle: u32) -> [f64; 2] {
        let (edges, _, s) = self.edges(triangle);
        let origin = self.points[self.triangles[triangle as usize][(s + 1) % 3] as usize];
        let (d, to_next, to_last) = (edges[s], edges[(s + 1) % 3], edges[(s + 2) % 3]);
        let circumcentre = -0.5 * dot(to_next, to_last) / cross(to_next, to_last);
        let off_centre = OFF_CENTRE_SHARE * ((1.0 + self.max_cos) / (1.0 - self.max_cos)).sqrt();
        let height = circumcentre.min(off_centre);
        [
            origin[0] + 0.5 * d[0] - height * d[1],
            origin[1] + 0.5 * d[1] + height * d[0],
        ]
    }

    /// Walks to the triangle that holds a point; with the edge it came through (the longest, had it not to walk).
    /// None if the boundary is in the way.
    fn locate(&self, mut triangle: u32, point: [f64; 2]) -> Option<(u32, usize)> {
        let (_, squares, _) = self.edges(triangle);
        let mut entry = (0..3).fold(0, |l, i| if squares[i] > squares[l] { i } else { l });
        loop {
            let corners = self.triangles[triangle as usize];
            let is_beyond = |&i: &usize| {
                let [a, b] = [1, 2].map(|k| self.coord(corners[(i + k) % 3]));
                orient2d(a, b, coord(point)) < 0.0
            };
            let Some(exit) = (0..3).find(is_beyond) else {
                return Some((triangle, entry));
            };
            let next = self.neighbours[triangle as usize][exit];
            if next == OUTSIDE {
                return None;
            }
            entry = self.edge_to(next, triangle);
            triangle = next;
        }
    }

    /// Fills `cavity` and `rim`, from an edge of the triangle that holds the point. A cavity holds no vertex, so that its
    /// triangles form a tree, and going around that is going around the rim.
    fn find_cavity(&mut self, start: u32, entry: usize, point: [f64; 2]) {
        self.cavity.clear();
        self.rim.clear();
        self.cavity.push(start);
        self.crossings
            .extend([2, 1, 0].map(|k| (start, (entry + k) % 3)));
        while let Some((triangle, edge)) = self.crossings.pop() {
            let beyond = self.neighbours[triangle as usize][edge];
            if beyond != OUTSIDE {
                let [a, b, c] = self.triangles[beyond as usize].map(|v| self.coord(v));
                if incircle(a, b, c, coord(point)) > 0.0 {
                    let back = self.edge_to(beyond, triangle);
                    self.cavity.push(beyond);
                    self.crossings
                        .extend([2, 1].map(|k| (beyond, (back + k) % 3)));
                    continue;
                }
            }
            let corners = self.triangles[triangle as usize];
            let ends = [1, 2].map(|k| corners[(edge + k) % 3]);
            self.rim.push(RimEdge { ends, beyond });
        }
    }

    /// Replaces the triangles of the cavity by those of the point and each edge of the rim.
    fn fill_cavity(&mut self, point: [f64; 2]) {
        let new = self.points.len() as u32;
        self.points.push(point);
        let count = self.rim.len();
        let old_count = self.triangles.len() as u32;
        let missing = (count - self.cavity.len()) as u32;
        self.cavity.extend(old_count..old_count + missing);
        let grown = (old_count + missing) as usize;
        self.triangles.resize(grown, [new; 3]);
        self.neighbours.resize(grown, [OUTSIDE; 3]);
        for (k, edge) in self.rim.iter().enumerate() {
            let ([a, b], triangle) = (edge.ends, self.cavity[k]);
            let (next, last) = ((k + 1) % count, (k + count - 1) % count);
            self.triangles[triangle as usize] = [a, b, new];
            self.neighbours[triangle as usize] =
                [self.cavity[next], self.cavity[last], edge.beyond];
            if edge.beyond != OUTSIDE {
                let outer = edge.beyond as usize;
                let shared = (0..3).find(|&i| self.triangles[outer][(i + 1) % 3] == b);
                let shared = shared.expect("the triangle beyond an edge has its ends");
                self.neighbours[outer][shared] = triangle;
            }
        }
        for k in 0..count {
            self.judge(self.cavity[k]);
        }
    }

    /// Edges (edge i opposite corner i), their squared lengths and which is the shortest.
    fn edges(&self, triangle: u32) -> ([[f64; 2]; 3], [f64; 3], usize) {
        let [a, b, c] = self.triangles[triangle as usize].map(|v| self.points[v as usize]);
        let edges = [minus(c, b), minus(a, c), minus(b, a)];
        let squares = edges.map(|edge| dot(edge, edge));
        let shortest = (0..3).fold(0, |s, i| if squares[i] < squares[s] { i } else { s });
        (edges, squares, shortest)
    }

    /// Which edge of a triangle leads to a neighbour.
    fn edge_to(&self, triangle: u32, neighbour: u32) -> usize {
        let around = self.neighbours[triangle as usize];
        let edge = around.iter().position(|&other| other == neighbour);
        edge.expect("neighbours know each other")
    }

    fn coord(&self, vertex: u32) -> Coord<f64> {
        coord(self.points[vertex as usize])
    }
}

fn coord([x, y]: [f64; 2]) -> Coord<f64> {
    Coord { x, y }
}

fn minus(a: [f64; 2], b: [f64; 2]) -> [f64; 2] {
    [a[0] - b[0], a[1] - b[1]]
}

fn dot(a: [f64; 2], b: [f64; 2]) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}

fn cross(a: [f64; 2], b: [f64; 2]) -> f64 {
    a[0] * b[1] - a[1] * b[0]
}
