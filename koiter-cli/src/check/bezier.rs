//! Bézier shells in the report on a scene.

use koiter::scene::model::{BezierModel, BezierPart, FineSurface};
use serde::Serialize;

use super::{decimal, mass};
use crate::output::say;

#[derive(Serialize)]
pub(super) struct BezierReport {
    name: String,
    element: &'static str,
    nodes: usize,
    elements: usize,
    thickness: f64,
    area: f64,
    mass: f64,
    mean_edge: f64,
    surface: &'static str,
}

impl BezierReport {
    pub(super) fn new(model: &BezierModel, part: &BezierPart) -> Self {
        let surface = &part.shell.surface;
        Self {
            name: part.shell.name.clone(),
            element: model.element.name(),
            nodes: surface.mesh.num_vertices(),
            elements: surface.mesh.num_faces(),
            thickness: part.shell.thickness,
            area: surface.area(),
            mass: mass(&part.shell),
            mean_edge: surface.mean_edge_length(),
            surface: match part.surface {
                FineSurface::Bound { .. } => "a mesh of its own",
                _ => "its elements divided",
            },
        }
    }

    pub(super) fn print(&self) {
        say!(
            "Bézier shell {}: {}, {} nodes, {} elements, {:.2e} m thick, {} m², {} kg, edges {:.2e} m, shows {}",
            self.name,
            self.element,
            self.nodes,
            self.elements,
            self.thickness,
            decimal(self.area),
            decimal(self.mass),
            self.mean_edge,
            self.surface
        );
    }
}
