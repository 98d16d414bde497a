//! What contact tells after a step.

use std::collections::BTreeMap;

use super::active::Contact;
use super::search::Limiter;

/// What a contact energy tells after a step.
#[derive(Clone, Debug, Default)]
pub struct ContactStatistics {
    /// Active pairs.
    pub contacts: usize,
    /// Smallest gap between surfaces [m]; infinity when nothing is within reach.
    pub min_gap: f64,
    /// Barrier stiffness [J/m²].
    pub kappa: f64,
    /// The pair with the smallest gap, in the user's terms.
    pub closest: Option<String>,
    /// Active pairs by bodies, most first.
    pub by_bodies: Vec<(String, usize)>,
}

impl Contact {
    /// Statistics at the state of the last [`Energy::begin_iteration`](crate::assembly::Energy::begin_iteration) or
    /// [`Contact::refresh`].
    pub fn statistics(&self) -> ContactStatistics {
        ContactStatistics {
            contacts: self.active.len() + self.active_planes.len(),
            min_gap: self.smallest_gap,
            kappa: self.kappa,
            closest: self.closest.as_ref().map(|closest| match closest {
                Limiter::Plane(vertex, plane) => self.describe_on_plane(*vertex, *plane),
                Limiter::Pair(pair) => self.describe_pair(pair),
                Limiter::Reach | Limiter::Length => String::new(),
            }),
            by_bodies: self.contacts_by_bodies(),
        }
    }

    fn contacts_by_bodies(&self) -> Vec<(String, usize)> {
        let mesh = &self.mesh;
        let body = |vertex: u32| mesh.body[vertex as usize] as usize;
        let mut counts: BTreeMap<[usize; 2], usize> = BTreeMap::new();
        for pair in &self.active {
            let mut bodies = [body(pair.vertices[0]), body(pair.vertices[3])];
            bodies.sort_unstable();
            *counts.entry(bodies).or_default() += 1;
        }
        // Planes are numbered after the bodies.
        for near in &self.active_planes {
            let plane = mesh.bodies.len() + near.plane;
            *counts.entry([body(near.vertex), plane]).or_default() += 1;
        }
        let name = |body: usize| match mesh.bodies.get(body) {
            Some(body) => body.name.as_str(),
            None => self.planes[body - mesh.bodies.len()].name.as_str(),
        };
        let named = counts
            .into_iter()
            .map(|([a, b], count)| (format!("{} with {}", name(a), name(b)), count));
        let mut named: Vec<(String, usize)> = named.collect();
        named.sort_by_key(|(_, count)| std::cmp::Reverse(*count));
        named
    }
}
