//! NumPy arrays from and to what the library keeps.

use koiter::Vec3;
use numpy::ndarray::Array2;
use numpy::{IntoPyArray, PyArray2, PyReadonlyArray2};
use pyo3::prelude::*;

use crate::error::of_input;

/// Points as an array of shape (n, 3).
pub(crate) fn from_points<'py>(py: Python<'py>, points: &[Vec3]) -> Bound<'py, PyArray2<f64>> {
    let values: Vec<f64> = points.iter().flat_map(|p| [p.x, p.y, p.z]).collect();
    rows_of_three(py, values)
}

/// Faces as an array of shape (m, 3).
pub(crate) fn from_faces<'py>(py: Python<'py>, faces: &[[u32; 3]]) -> Bound<'py, PyArray2<i64>> {
    let values: Vec<i64> = faces.iter().flatten().map(|&v| i64::from(v)).collect();
    rows_of_three(py, values)
}

fn rows_of_three<T: numpy::Element>(py: Python<'_>, values: Vec<T>) -> Bound<'_, PyArray2<T>> {
    let rows = values.len() / 3;
    let array = Array2::from_shape_vec((rows, 3), values).expect("three values a row");
    array.into_pyarray(py)
}

/// Points of an array of shape (n, 3).
pub(crate) fn to_points(array: &PyReadonlyArray2<'_, f64>, what: &str) -> PyResult<Vec<Vec3>> {
    let view = array.as_array();
    if view.ncols() != 3 {
        let (rows, columns) = view.dim();
        return Err(of_input(format!(
            "{what} must have shape (n, 3), but the array has ({rows}, {columns})"
        )));
    }
    Ok((view.rows().into_iter())
        .map(|row| Vec3::new(row[0], row[1], row[2]))
        .collect())
}

/// Faces of an array of shape (m, 3); negative indices do not count from the end.
pub(crate) fn to_faces(array: &PyReadonlyArray2<'_, i64>) -> PyResult<Vec<[u32; 3]>> {
    let view = array.as_array();
    if view.ncols() != 3 {
        let (rows, columns) = view.dim();
        return Err(of_input(format!(
            "faces must have shape (m, 3), but the array has ({rows}, {columns})"
        )));
    }
    let corner = |value: i64| {
        u32::try_from(value).map_err(|_| of_input(format!("a face uses vertex {value}")))
    };
    (view.rows().into_iter())
        .map(|row| Ok([corner(row[0])?, corner(row[1])?, corner(row[2])?]))
        .collect()
}
