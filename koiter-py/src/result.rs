//! Result folders.

use std::path::PathBuf;

use koiter::io::result::{PartKind, ResultReader};
use numpy::{IntoPyArray, PyArray2};
use pyo3::exceptions::PyIndexError;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::arrays::{from_faces, from_points};
use crate::error::of_input;

/// A result folder: `len(result)` frames, each read when it is asked for.
#[pyclass(subclass, frozen, module = "koiter")]
pub(crate) struct Result {
    reader: ResultReader,
    path: PathBuf,
}

/// A frame: `step`, `time` [s], `positions` [m] of all parts, fields by name.
#[pyclass(frozen, module = "koiter")]
pub(crate) struct Frame {
    /// Number of the step that led here; 0 at the start.
    #[pyo3(get)]
    step: u64,
    /// Time [s].
    #[pyo3(get)]
    time: f64,
    /// Positions of the vertices of all parts [m], of shape (n, 3).
    #[pyo3(get)]
    positions: Py<PyArray2<f64>>,
    /// Values on faces by name.
    #[pyo3(get)]
    face_fields: Py<PyDict>,
    /// Values on vertices by name.
    #[pyo3(get)]
    vertex_fields: Py<PyDict>,
}

#[pymethods]
impl Result {
    /// Opens a result folder.
    #[new]
    fn new(path: PathBuf) -> PyResult<Self> {
        let reader = ResultReader::open(&path).map_err(of_input)?;
        Ok(Self { reader, path })
    }

    fn __len__(&self) -> usize {
        self.reader.len()
    }

    /// A frame; from the end where the number is negative.
    fn __getitem__(&self, py: Python<'_>, frame: isize) -> PyResult<Frame> {
        let len = self.reader.len();
        let index = if frame < 0 {
            frame + len as isize
        } else {
            frame
        };
        let index = usize::try_from(index).ok().filter(|&index| index < len);
        let index = index.ok_or_else(|| {
            PyIndexError::new_err(format!("there is no frame {frame}: there are {len}"))
        })?;
        let read = py.detach(|| self.reader.frame(index)).map_err(of_input)?;
        let (face_fields, vertex_fields) = (PyDict::new(py), PyDict::new(py));
        for field in read.face_fields {
            face_fields.set_item(field.name, field.values.into_pyarray(py))?;
        }
        for field in read.vertex_fields {
            vertex_fields.set_item(field.name, field.values.into_pyarray(py))?;
        }
        Ok(Frame {
            step: read.step,
            time: read.time,
            positions: from_points(py, &read.positions).unbind(),
            face_fields: face_fields.unbind(),
            vertex_fields: vertex_fields.unbind(),
        })
    }

    /// Where the folder is.
    #[getter]
    fn path(&self) -> PathBuf {
        self.path.clone()
    }

    /// Title of the scene.
    #[getter]
    fn title(&self) -> &str {
        &self.reader.manifest().title
    }

    /// The scene as it was run.
    #[getter]
    fn scene_text(&self) -> &str {
        &self.reader.manifest().scene_text
    }

    /// Times of all frames [s].
    #[getter]
    fn times(&self) -> PyResult<Vec<f64>> {
        (0..self.reader.len())
            .map(|index| Ok(self.reader.frame_info(index).map_err(of_input)?.time))
            .collect()
    }

    /// Faces of all parts by the numbers of all vertices, of shape (m, 3).
    #[getter]
    fn faces<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray2<i64>> {
        from_faces(py, self.reader.faces())
    }

    /// Parts as (name, whether it is an obstacle, (first vertex, end), (first face, end)).
    #[expect(clippy::type_complexity, reason = "it is unpacked in Python at once")]
    fn part_ranges(&self) -> Vec<(&str, bool, (usize, usize), (usize, usize))> {
        (self.reader.manifest().parts.iter())
            .map(|part| {
                (
                    part.name.as_str(),
                    part.kind == PartKind::Obstacle,
                    (part.vertices.start, part.vertices.end),
                    (part.faces.start, part.faces.end),
                )
            })
            .collect()
    }

    /// The lines of stats.jsonl, each a JSON text.
    fn stats_lines(&self) -> PyResult<Vec<String>> {
        let stats = self.reader.stats().map_err(of_input)?;
        Ok(stats.iter().map(ToString::to_string).collect())
    }

    /// summary.json as text; `None` while the run goes on.
    fn summary_text(&self) -> PyResult<Option<String>> {
        let summary = self.reader.summary().map_err(of_input)?;
        Ok(summary.map(|summary| summary.to_string()))
    }
}
