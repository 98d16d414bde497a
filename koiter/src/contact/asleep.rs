//! Pairs of a shell that a cut or a suture leaves nearer than surfaces may be.
//!
//! The lips of a fresh cut lie on each other, where a barrier is infinite, and so do the two sides of a seam. Such a pair sleeps: it
//! does not collide until its gap has once been as wide as the barrier reaches. From then on it pushes like any other, beginning with
//! no force. While they sleep, its two primitives may pass through each other.

use super::active::Contact;
use super::pair::Pair;

/// A gap below this fraction of d̂ is none: an awake pair does not come that near, since the barrier is stiffened before.
const NO_GAP: f64 = 0.01;

impl Contact {
    /// Lets sleep every pair of shells that touches at `q`, and every one within reach of the barrier of which both primitives have
    /// a fresh vertex: at a cut or a seam, neighbours are that near. Others stay awake.
    pub fn put_to_sleep(&mut self, q: &[f64], is_fresh: impl Fn(u32) -> bool + Sync + Send) {
        let x = self.positions(q);
        let mut candidates = std::mem::take(&mut self.candidates);
        let found = candidates.find(&self.mesh, self.d_hat, &x, None, |pair| {
            let [first, second] = pair.primitives();
            if self.mesh.is_obstacle(first[0]) || self.mesh.is_obstacle(second[0]) {
                return None;
            }
            let fresh = |primitive: &[u32]| primitive.iter().any(|v| is_fresh(*v));
            let reach = match fresh(first) && fresh(second) {
                true => self.d_hat,
                false => NO_GAP * self.d_hat,
            };
            (self.gap(&pair, &x) < reach).then_some(pair)
        });
        self.candidates = candidates;
        self.set_asleep(found.unwrap_or_default());
    }

    /// Wakes what is as far apart as the barrier reaches.
    pub fn wake(&mut self, q: &[f64]) {
        if self.asleep.is_empty() {
            return;
        }
        let x = self.positions(q);
        let mut asleep = std::mem::take(&mut self.asleep);
        asleep.retain(|pair| self.gap(pair, &x) < self.d_hat);
        self.asleep = asleep;
    }

    /// The pairs that sleep, in order.
    pub fn asleep(&self) -> &[Pair] {
        &self.asleep
    }

    /// Lets exactly these pairs sleep.
    pub fn set_asleep(&mut self, mut pairs: Vec<Pair>) {
        pairs.sort_unstable();
        self.asleep = pairs;
    }

    pub(super) fn is_asleep(&self, pair: &Pair) -> bool {
        !self.asleep.is_empty() && self.asleep.binary_search(pair).is_ok()
    }

    /// Whether an edge and a face lie on each other because a pair of theirs sleeps.
    pub(super) fn is_crossing_asleep(&self, edge: &[u32; 2], face: &[u32; 3]) -> bool {
        let belongs = |v: &u32| edge.contains(v) || face.contains(v);
        (self.asleep.iter()).any(|pair| pair.vertices.iter().all(belongs))
    }
}

#[cfg(test)]
mod tests {
    use crate::Vec3;
    use crate::assembly::{DofLayout, Energy};
    use crate::contact::{CollisionBody, CollisionMesh, Contact};

    /// Two triangles side by side along the y axis, with corners of their own there.
    fn lips() -> (Contact, Vec<Vec3>) {
        let x = [
            [0.0, 0.0, 0.0],
            [0.0, 1.0, 0.0],
            [-1.0, 0.5, 0.0],
            [0.0, 0.0, 0.0],
            [1.0, 0.5, 0.0],
            [0.0, 1.0, 0.0],
        ];
        let x: Vec<Vec3> = x.into_iter().map(Vec3::from).collect();
        let mut layout = DofLayout::new();
        let body = CollisionBody {
            name: "skin".to_owned(),
            first_dof: layout.push_nodes(6, 3, true),
            num_vertices: 6,
            edges: vec![[0, 1], [1, 2], [0, 2], [3, 4], [4, 5], [3, 5]],
            faces: vec![[0, 1, 2], [3, 4, 5]],
            rest_positions: x.clone(),
            offset: 0.0,
            is_obstacle: false,
            friction: 0.0,
        };
        let mesh = CollisionMesh::new(vec![body]);
        (Contact::new(mesh, Vec::new(), layout, 0.1, 1.0), x)
    }

    fn apart(x: &[Vec3], by: f64) -> Vec<f64> {
        let moved = x.iter().enumerate().map(|(v, x)| match v < 3 {
            true => *x,
            false => x + Vec3::new(by, 0.0, 0.0),
        });
        moved.flat_map(|x| [x.x, x.y, x.z]).collect()
    }

    #[test]
    fn lips_sleep_until_they_are_apart_and_then_stay_apart() {
        let (mut contact, x) = lips();
        let q = apart(&x, 0.0);
        assert!(contact.check_start(&q).is_err());
        contact.put_to_sleep(&q, |_| true);
        let all = contact.asleep().len();
        assert!(all > 0);
        assert!(contact.check_start(&q).is_ok());
        contact.prepare(&q);
        assert_eq!(contact.value(&q), 0.0);
        // Asleep they may go where they like.
        let through = apart(&x, -0.05);
        let motion: Vec<f64> = through.iter().zip(&q).map(|(b, a)| b - a).collect();
        assert_eq!(contact.max_step(&q, &motion), 1.0);
        // Half as far as the barrier reaches is not enough …
        contact.wake(&apart(&x, 0.05));
        assert_eq!(contact.asleep().len(), all);
        // … and once they are farther, they do not close again.
        let open = apart(&x, 0.11);
        contact.wake(&open);
        assert!(contact.asleep().is_empty());
        contact.prepare(&open);
        assert_eq!(contact.value(&open), 0.0);
        let back: Vec<f64> = q.iter().zip(&open).map(|(b, a)| b - a).collect();
        let allowed = contact.max_step(&open, &back);
        assert!(allowed < 1.0);
        let near = apart(&x, 0.02);
        contact.prepare(&near);
        assert!(contact.value(&near) > 0.0);
    }

    #[test]
    fn what_is_near_elsewhere_stays_awake() {
        let (mut contact, x) = lips();
        contact.put_to_sleep(&apart(&x, 0.05), |_| false);
        assert!(contact.asleep().is_empty());
        contact.put_to_sleep(&apart(&x, 0.05), |v| v == 0 || v == 3);
        let first = contact.asleep().to_vec();
        assert!(!first.is_empty());
        let has_fresh = |vertices: &[u32]| vertices.iter().any(|v| *v == 0 || *v == 3);
        assert!(first.iter().all(|pair| has_fresh(&pair.vertices)));
        // Taken up, it is in order whatever order it was given in.
        contact.set_asleep(first.iter().rev().copied().collect());
        assert_eq!(contact.asleep(), first);
    }
}
