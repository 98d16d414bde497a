//! Contact without intersection: incremental potential contact between shells, and with obstacles.
//!
//! All surfaces form one [`CollisionMesh`] whose vertices, edges and faces carry an offset (half a thickness; the radius
//! of a ball or capsule). A pair of primitives touches when their distance is the sum of their offsets; its gap is what
//! is left. Pairs are found once a line search (`broad_phase`), bound the step (`ccd`), and push (`barrier`).
//! Reference: Li et al., "Incremental Potential Contact" (2020); Li, Kaufman, Jiang, "Codimensional IPC" (2021).

mod active;
mod asleep;
mod audit;
mod barrier;
mod boxes;
mod broad_phase;
mod candidates;
mod ccd;
mod collision_mesh;
mod energy;
mod friction;
mod friction_table;
mod neighbours;
mod obstacle;
mod pair;
mod plane;
mod search;
mod start;
mod statistics;

pub use active::Contact;
pub use audit::{Intersection, intersections};
pub use barrier::LogBarrier;
pub use boxes::Aabb;
pub use broad_phase::BoxTree;
pub use ccd::{Approach, additive_ccd};
pub use collision_mesh::{CollisionBody, CollisionMesh};

pub use friction::Friction;
pub use friction_table::UnknownBody;
pub use obstacle::{CollisionObstacle, ObstacleBody};
pub use pair::{Pair, PairKind};
pub use plane::CollisionPlane;
pub use start::{StartError, TouchingPair};
pub use statistics::ContactStatistics;
