//! The compiled half of the Python package `koiter`; the other half, which people see, is in `python/koiter`.

mod arrays;
mod error;
mod memory_meshes;
mod picture;
mod report;
mod result;
mod shape;
mod simulation;

use pyo3::prelude::*;

/// Thin shells, compiled: use the package `koiter`.
#[pymodule]
mod _koiter {
    #[pymodule_export]
    use crate::error::{RunError, SceneError};
    #[pymodule_export]
    use crate::picture::picture;
    #[pymodule_export]
    use crate::report::Step;
    #[pymodule_export]
    use crate::result::{Frame, Result};
    #[pymodule_export]
    use crate::shape::{Shape, bending_models, materials};
    #[pymodule_export]
    use crate::simulation::{Simulation, generate_mesh, read_mesh};

    use pyo3::prelude::*;

    #[pymodule_init]
    fn init(module: &Bound<'_, PyModule>) -> PyResult<()> {
        module.add("__version__", koiter::VERSION)
    }
}
