//! Pictures of surfaces, as the bytes of PNG files.

use koiter_render::{
    Camera, CameraView, ColorBy, ColorMap, FieldView, Ground, PartView, RenderOptions, Rgb, Scene,
    level_floor, render,
};
use numpy::PyReadonlyArray2;
use pyo3::prelude::*;
use pyo3::types::PyBytes;

use crate::arrays::{to_faces, to_points};
use crate::error::of_input;

/// A surface as the renderer wants it.
struct Part {
    is_obstacle: bool,
    positions: Vec<[f64; 3]>,
    faces: Vec<[u32; 3]>,
    field: Option<Vec<f64>>,
}

/// What Python hands over: whether it is an obstacle, vertices, faces, values of the faces.
type PartArrays<'py> = (
    bool,
    PyReadonlyArray2<'py, f64>,
    PyReadonlyArray2<'py, i64>,
    Option<Vec<f64>>,
);

/// A PNG picture of parts, each (is an obstacle, vertices, faces, values of the faces or None).
#[pyfunction]
#[pyo3(signature = (parts, *, camera="iso", size=(800, 500), caption=None, field=None))]
pub(crate) fn picture<'py>(
    py: Python<'py>,
    parts: Vec<PartArrays<'py>>,
    camera: &str,
    size: (u32, u32),
    caption: Option<String>,
    field: Option<String>,
) -> PyResult<Bound<'py, PyBytes>> {
    let view: CameraView = camera.parse().map_err(of_input)?;
    let parts = parts.into_iter().map(part).collect::<PyResult<Vec<_>>>()?;
    let bytes = py.detach(|| draw(&parts, view, size, caption, field))?;
    Ok(PyBytes::new(py, &bytes))
}

fn part((is_obstacle, vertices, faces, field): PartArrays<'_>) -> PyResult<Part> {
    Ok(Part {
        is_obstacle,
        positions: (to_points(&vertices, "vertices")?.into_iter())
            .map(Into::into)
            .collect(),
        faces: to_faces(&faces)?,
        field,
    })
}

fn draw(
    parts: &[Part],
    view: CameraView,
    (width, height): (u32, u32),
    caption: Option<String>,
    field: Option<String>,
) -> PyResult<Vec<u8>> {
    let floor = |part: &Part| match part.is_obstacle {
        true => level_floor(&part.positions, &part.faces),
        false => None,
    };
    let ground = (parts.iter().filter_map(floor))
        .reduce(f64::max)
        .map_or(Ground::None, Ground::At);
    let mut shells = 0;
    let shown = parts.iter().filter(|part| floor(part).is_none());
    let views = shown.map(|part| {
        if part.is_obstacle {
            return PartView::obstacle(&part.positions, &part.faces);
        }
        shells += 1;
        PartView {
            color: Rgb::of_part(shells - 1),
            field: part.field.as_deref().map(FieldView::PerFace),
            ..PartView::shell(&part.positions, &part.faces)
        }
    });
    let scene = Scene {
        parts: views.collect(),
        ground,
    };
    let bounds = scene.bounds().map_err(of_input)?;
    let camera = Camera::fit(&bounds, view, f64::from(width) / f64::from(height));
    let color = match field {
        Some(name) => ColorBy::field(name, "", ColorMap::Viridis),
        None => ColorBy::Part,
    };
    let options = RenderOptions {
        color,
        caption,
        ..RenderOptions::new(width, height, camera)
    };
    Ok(render(&scene, &options).map_err(of_input)?.png_bytes())
}
