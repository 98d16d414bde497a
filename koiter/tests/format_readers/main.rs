//! What we write is read by the reader of the format itself, not only by us.
//!
//! Needs a Python with the packages `vtk`, `usd-core`, `h5py` and `numpy`: `KOITER_PYTHON` names the interpreter (default
//! `python3`). Without them the tests pass and say so, unless `KOITER_REQUIRE_READERS=1`.
#![cfg(feature = "io")]

mod burnt;
mod films;
mod python;
mod sample;
mod vtk;
