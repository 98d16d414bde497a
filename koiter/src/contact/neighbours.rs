//! Pairs found once with a margin, which answer later searches as long as motions have not used it up.
//!
//! Every pair that is not on the list was at least `reach + margin` apart where the list was made. Two primitives approach
//! by no more than the largest motions of their points, so while no vertex has moved by more than half the margin, and
//! does not in the coming motion, no other pair can come within `reach`.
//! Reference: Verlet, "Computer 'Experiments' on Classical Fluids" (1967).

use super::active::Contact;
use super::candidates::Candidates;
use super::collision_mesh::CollisionMesh;
use super::pair::Pair;
use crate::Vec3;
use crate::assembly::parallel_map;

/// The list, and where it was made.
#[derive(Default)]
pub(super) struct Neighbours {
    /// Vertex–face pairs, then edge–edge pairs.
    pub(super) pairs: Vec<Pair>,
    /// Positions of all vertices when it was made [m]; none if there is no list.
    made_at: Vec<Vec3>,
    /// How much further than the reach of a search it looks [m].
    margin: f64,
}

/// The mean of motions: seen by whoever moves along with it, what flies as a whole sweeps little.
pub(super) fn mean(motions: impl ExactSizeIterator<Item = Vec3>) -> Vec3 {
    let count = motions.len().max(1) as f64;
    motions.sum::<Vec3>() / count
}

impl Neighbours {
    /// What `check` makes of the pairs on the list, in its order.
    pub(super) fn checked<T: Send>(
        &self,
        check: impl Fn(Pair) -> Option<T> + Sync + Send,
    ) -> Vec<T> {
        const CHUNK: usize = 1024;
        let chunks = parallel_map(self.pairs.len().div_ceil(CHUNK), |chunk| {
            let pairs = self.pairs[chunk * CHUNK..].iter().take(CHUNK);
            pairs.filter_map(|pair| check(*pair)).collect::<Vec<T>>()
        });
        chunks.into_iter().flatten().collect()
    }

    /// Whether the list was made at exactly these positions.
    pub(super) fn were_listed_at(&self, x: &[Vec3]) -> bool {
        self.made_at == x
    }

    /// Whether the list holds every pair that can come within reach between `x` and `x + dx`.
    fn cover(&self, mesh: &CollisionMesh, x: &[Vec3], dx: &[Vec3]) -> bool {
        if self.made_at.len() != x.len() {
            return false;
        }
        let shift = mean(x.iter().zip(&self.made_at).map(|(now, then)| now - then));
        let shared = mean(dx.iter().copied());
        let stays = |v: usize| {
            let moved = (x[v] - self.made_at[v] - shift).norm() + (dx[v] - shared).norm();
            2.0 * moved <= self.margin || mesh.is_gone(v as u32)
        };
        (0..x.len()).all(stays)
    }
}

/// Whether a list made at the start of a motion would have half its margin left at the end.
fn worth_making(mesh: &CollisionMesh, dx: &[Vec3], margin: f64) -> bool {
    let shared = mean(dx.iter().copied());
    let is_short = |v: usize| 4.0 * (dx[v] - shared).norm() <= margin || mesh.is_gone(v as u32);
    (0..dx.len()).all(is_short)
}

impl Contact {
    /// Whether the listed neighbours are all that can come within reach between `x` and `x + dx`. A list is made at `x` if
    /// there is none that serves, unless the motion is too long for one.
    pub(super) fn neighbours_cover(
        &self,
        candidates: &mut Candidates,
        x: &[Vec3],
        dx: &[Vec3],
    ) -> bool {
        let mesh = &self.mesh;
        if candidates.neighbours.cover(mesh, x, dx) {
            return true;
        }
        if !worth_making(mesh, dx, self.margin) {
            return false;
        }
        let reach = self.d_hat + self.margin;
        // Written so that what is not a number is on the list.
        let near = |pair: Pair| (!(self.gap(&pair, x) >= reach)).then_some(pair);
        let Some(pairs) = candidates.find(mesh, reach, x, None, near) else {
            return false;
        };
        candidates.neighbours = Neighbours {
            pairs,
            made_at: x.to_vec(),
            margin: self.margin,
        };
        true
    }
}

/// How much further than the barrier a list of neighbours looks: half a mean edge, so that it holds few pairs of surfaces that
/// are smooth, or the barrier's range if that is longer [m].
pub(super) fn list_margin(mesh: &CollisionMesh, d_hat: f64) -> f64 {
    let of_shells = || mesh.edges.iter().filter(|e| !mesh.is_obstacle(e[0]));
    let length: f64 = of_shells()
        .map(|&[a, b]| mesh.rest_length_squared(a, b).sqrt())
        .sum();
    d_hat.max(0.5 * length / of_shells().count().max(1) as f64)
}

#[cfg(test)]
mod tests {
    use super::super::collision_mesh::CollisionBody;
    use super::*;
    use crate::assembly::DofLayout;

    /// Vertices of a side of each sheet.
    const SIDE: u32 = 7;

    /// Two wavy sheets of unit cells, one 0.15 above the other.
    fn two_sheets() -> (Contact, Vec<f64>) {
        let mut layout = DofLayout::new();
        let (mut bodies, mut q) = (Vec::new(), Vec::new());
        let at = |i: u32, j: u32| i * SIDE + j;
        let cells = (0..SIDE - 1).flat_map(|i| (0..SIDE - 1).map(move |j| (i, j)));
        let faces: Vec<[u32; 3]> = cells
            .flat_map(|(i, j)| {
                let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
                [[a, b, c], [a, c, d]]
            })
            .collect();
        let mut edges: Vec<[u32; 2]> = faces
            .iter()
            .flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]])
            .map(|[a, b]| [a.min(b), a.max(b)])
            .collect();
        edges.sort_unstable();
        edges.dedup();
        for height in [0.0, 0.15] {
            let nodes = (0..SIDE * SIDE).map(|v| (f64::from(v / SIDE), f64::from(v % SIDE)));
            let rest_positions: Vec<Vec3> = nodes
                .map(|(x, y)| Vec3::new(x, y, height + 0.1 * (x + 2.0 * y).sin()))
                .collect();
            q.extend(rest_positions.iter().flat_map(|p| [p.x, p.y, p.z]));
            bodies.push(CollisionBody {
                name: format!("sheet at {height}"),
                first_dof: layout.push_nodes(rest_positions.len(), 3, true),
                num_vertices: rest_positions.len(),
                edges: edges.clone(),
                faces: faces.clone(),
                rest_positions,
                offset: 0.01,
                is_obstacle: false,
                friction: 0.0,
            });
        }
        let mesh = CollisionMesh::new(bodies);
        (Contact::new(mesh, vec![], layout, 0.1, 1.0), q)
    }

    /// Of the pairs found, those that come within reach at one of nine moments, by their vertices: boxes and bounds let more
    /// through, not the same in both searches.
    fn in_reach(
        contact: &Contact,
        found: Option<Vec<(Pair, f64)>>,
        x: &[Vec3],
        dx: &[Vec3],
    ) -> Vec<([u32; 4], f64)> {
        let moments = (0..=8).map(|k| f64::from(k) / 8.0);
        let moved = |t: f64| x.iter().zip(dx).map(|(x, dx)| x + dx * t).collect();
        let moments: Vec<Vec<Vec3>> = moments.map(moved).collect();
        let comes_near = |(pair, _): &(Pair, f64)| {
            let near = |x: &Vec<Vec3>| contact.gap(pair, x) < contact.d_hat;
            moments.iter().any(near)
        };
        let pairs = found.unwrap().into_iter().filter(comes_near);
        let mut plain: Vec<_> = pairs.map(|(p, t)| (p.vertices, t)).collect();
        plain.sort_by_key(|(vertices, _)| *vertices);
        plain
    }

    #[test]
    fn a_list_answers_as_a_new_search_does_until_its_margin_is_used_up() {
        let ((mut contact, q), (mut without_lists, _)) = (two_sheets(), two_sheets());
        without_lists.margin = -1.0;
        let mut x = contact.positions(&q);
        let mut state = 1u64;
        let mut random = || {
            state = (state.wrapping_mul(6364136223846793005)).wrapping_add(1442695040888963407);
            (state >> 11) as f64 / (1u64 << 52) as f64 - 1.0
        };
        let (mut from_lists, mut compared) = (0, 0);
        for step in 0..60 {
            // Short motions, some long ones, and a drift of everything, which uses up no margin.
            let length = if step % 10 == 9 { 0.4 } else { 0.02 };
            let dx: Vec<Vec3> = (0..x.len())
                .map(|_| Vec3::new(random(), random(), random()) * length + Vec3::repeat(0.5))
                .collect();
            let searches = contact.candidates.searches;
            let found = contact.search(&x, &dx);
            from_lists += usize::from(contact.candidates.searches == searches);
            let found = in_reach(&contact, found, &x, &dx);
            let anew = without_lists.search(&x, &dx);
            let anew = in_reach(&contact, anew, &x, &dx);
            assert!(found == anew, "step {step}");
            compared += found.len();
            x.iter_mut().zip(&dx).for_each(|(x, dx)| *x += 0.3 * dx);
        }
        assert!(
            from_lists > 20 && compared > 1000,
            "{from_lists} {compared}"
        );
    }
}
