//! The command line of Koiter.
#![forbid(unsafe_code)]
fn main() {}
