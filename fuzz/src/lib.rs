//! Damaged files against every reader of Koiter: none may panic, hang or take memory on the word of a header.
//!
//! `fuzz/README.md` says how to run it.

mod coverage;
mod engine;
mod memory;
mod mutate;
mod random;
mod target;

pub use engine::{Options, Report, fuzz, read_corpus};
pub use target::Target;
