//! The energies of a mesh under any model.

use koiter::energy::bending::ExtraUnknowns;
use koiter::material::presets;
use koiter::mesh::{Surface, SurfaceOptions};
use koiter::scene::measure::{Directors, MeasuredShape, Measurement};
use koiter::scene::model::BendingModel;
use koiter::scene::nearest;
use numpy::{IntoPyArray, PyArray1, PyArray2, PyReadonlyArray2};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::arrays::{from_points, to_faces, to_points};
use crate::error::of_input;

/// A mesh with its rest shape, thickness and moduli: its energies and their gradients under a bending model.
#[pyclass(frozen, module = "koiter")]
pub(crate) struct Shape {
    membrane: f64,
    bending: f64,
    membrane_gradient: Py<PyArray2<f64>>,
    bending_gradient: Py<PyArray2<f64>>,
    director_gradient: Py<PyArray1<f64>>,
    directors: Py<PyArray1<f64>>,
}

fn model(name: &str) -> PyResult<BendingModel> {
    let names = || BendingModel::ALL.map(|model| model.info().name);
    (BendingModel::ALL.into_iter())
        .find(|model| model.info().name == name)
        .ok_or_else(|| {
            let near = nearest(name, names())
                .map_or(String::new(), |near| format!("did you mean '{near}'? "));
            of_input(format!(
                "there is no bending model '{name}'; {near}there are: {}",
                names().join(", ")
            ))
        })
}

#[pymethods]
impl Shape {
    /// `vertices` [m] and `faces` are the deformed mesh; `rest` has rest positions [m], else the shape is its own; with
    /// `rest_curvature` the shell wants the curvature of its rest shape, else to be flat. `directors` is "minimise" or "zero".
    #[new]
    #[pyo3(signature = (vertices, faces, *, thickness, young, poisson, bending="bac", rest=None, rest_curvature=false, directors="minimise"))]
    #[expect(clippy::too_many_arguments, reason = "all but two by their names")]
    fn new(
        py: Python<'_>,
        vertices: PyReadonlyArray2<'_, f64>,
        faces: PyReadonlyArray2<'_, i64>,
        thickness: f64,
        young: f64,
        poisson: f64,
        bending: &str,
        rest: Option<PyReadonlyArray2<'_, f64>>,
        rest_curvature: bool,
        directors: &str,
    ) -> PyResult<Self> {
        let positions = to_points(&vertices, "vertices")?;
        let deformed = Surface::new(positions, to_faces(&faces)?, SurfaceOptions::default())
            .map_err(of_input)?;
        let rest = rest.map(|rest| to_points(&rest, "rest")).transpose()?;
        let rest_positions = rest.as_deref().unwrap_or(&deformed.positions);
        if rest_positions.len() != deformed.positions.len() {
            let (given, needed) = (rest_positions.len(), deformed.positions.len());
            return Err(of_input(format!(
                "rest has {given} positions for {needed} vertices"
            )));
        }
        check_moduli(thickness, young, poisson)?;
        let directors = match directors {
            "minimise" => Directors::Minimise,
            "zero" => Directors::Zero,
            other => {
                return Err(of_input(format!(
                    "directors are \"minimise\" or \"zero\", not \"{other}\""
                )));
            }
        };
        let measurement = Measurement {
            deformed: &deformed,
            rest_positions,
            rest_curved: rest_curvature,
            model: model(bending)?,
            thickness,
            youngs_modulus: young,
            poissons_ratio: poisson,
        };
        let shape = py
            .detach(|| measurement.prepare(&directors))
            .map_err(of_input)?;
        Ok(Self::of(py, &shape))
    }

    /// Membrane energy [J].
    #[getter]
    fn membrane(&self) -> f64 {
        self.membrane
    }

    /// Bending energy [J].
    #[getter]
    fn bending(&self) -> f64 {
        self.bending
    }

    /// Gradient of the membrane energy [N], of shape (n, 3).
    #[getter]
    fn membrane_gradient(&self, py: Python<'_>) -> Py<PyArray2<f64>> {
        self.membrane_gradient.clone_ref(py)
    }

    /// Gradient of the bending energy [N], of shape (n, 3), directors held.
    #[getter]
    fn bending_gradient(&self, py: Python<'_>) -> Py<PyArray2<f64>> {
        self.bending_gradient.clone_ref(py)
    }

    /// Gradient of the bending energy by the directors.
    #[getter]
    fn director_gradient(&self, py: Python<'_>) -> Py<PyArray1<f64>> {
        self.director_gradient.clone_ref(py)
    }

    /// What the model has as unknowns beside positions: angles of edges [rad], points of edges [m], or unit directors.
    #[getter]
    fn directors(&self, py: Python<'_>) -> Py<PyArray1<f64>> {
        self.directors.clone_ref(py)
    }

    fn __repr__(&self) -> String {
        format!(
            "Shape(membrane={:.6e}, bending={:.6e})",
            self.membrane, self.bending
        )
    }
}

impl Shape {
    fn of(py: Python<'_>, shape: &MeasuredShape) -> Self {
        let (energies, gradient) = (shape.energies(), shape.gradient());
        Self {
            membrane: energies.membrane,
            bending: energies.bending,
            membrane_gradient: from_points(py, &gradient.membrane).unbind(),
            bending_gradient: from_points(py, &gradient.bending).unbind(),
            director_gradient: gradient.directors.into_pyarray(py).unbind(),
            directors: energies.directors.into_pyarray(py).unbind(),
        }
    }
}

fn check_moduli(thickness: f64, young: f64, poisson: f64) -> PyResult<()> {
    for (name, value, unit) in [("thickness", thickness, "m"), ("young", young, "Pa")] {
        if !(value.is_finite() && value > 0.0) {
            return Err(of_input(format!(
                "{name} must be larger than 0 {unit}, but it is {value}"
            )));
        }
    }
    match poisson > -1.0 && poisson < 1.0 {
        true => Ok(()),
        false => Err(of_input(format!(
            "poisson must be between -1 and 1, but it is {poisson}"
        ))),
    }
}

/// The bending models: dicts with `name`, `what`, `unknowns`, `source`.
#[pyfunction]
pub(crate) fn bending_models(py: Python<'_>) -> PyResult<Vec<Bound<'_, PyDict>>> {
    (BendingModel::ALL.iter())
        .map(|model| {
            let info = model.info();
            let unknowns = match info.unknowns {
                ExtraUnknowns::None => "none",
                ExtraUnknowns::EdgeAngles => "edge angles",
                ExtraUnknowns::EdgePoints => "edge points",
                ExtraUnknowns::VertexDirectors => "vertex directors",
            };
            let entry = PyDict::new(py);
            entry.set_item("name", info.name)?;
            entry.set_item("what", info.what)?;
            entry.set_item("unknowns", unknowns)?;
            entry.set_item("source", info.source)?;
            Ok(entry)
        })
        .collect()
}

/// The materials by name: dicts with `young` [Pa], `poisson`, `density` [kg/m³], `thickness` [m], `remark`, `source`.
#[pyfunction]
pub(crate) fn materials(py: Python<'_>) -> PyResult<Bound<'_, PyDict>> {
    let all = PyDict::new(py);
    for preset in &presets::ALL {
        let entry = PyDict::new(py);
        entry.set_item("young", preset.youngs_modulus)?;
        entry.set_item("poisson", preset.poissons_ratio)?;
        entry.set_item("density", preset.density)?;
        entry.set_item("thickness", preset.thickness)?;
        entry.set_item("remark", preset.remark)?;
        entry.set_item("source", preset.source)?;
        all.set_item(preset.name, entry)?;
    }
    Ok(all)
}
