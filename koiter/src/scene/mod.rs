//! From what was typed to a running simulation: `SceneSpec` → `Model` → `Simulation`.

pub mod model;
