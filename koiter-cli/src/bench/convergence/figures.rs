//! Errors over numbers of vertices: Figures 3 to 12 of "Better Bending", one a shape.

use std::path::Path;

use koiter::scene::measure::shapes::KnownShape;
use koiter::scene::model::BendingModel;
use koiter_render::{Arrangement, Chart, Panel, Style};

use super::super::model_style::{is_koiter, series};
use super::Study;
use crate::failure::Failure;
use crate::plot;

/// Draws every shape into `folder`.
pub(super) fn draw(study: &Study, shapes: &[KnownShape], folder: &Path) -> Result<(), Failure> {
    for &shape in shapes {
        let chart = chart(study, shape);
        for extension in ["svg", "png"] {
            let path = folder.join(format!("convergence-{}.{extension}", shape.name()));
            plot::write(&chart, (1400, 640), &path)?;
        }
    }
    Ok(())
}

fn chart(study: &Study, shape: KnownShape) -> Chart {
    let panel = |name: &str, koiter: bool| {
        let models = BendingModel::ALL.into_iter();
        let curves = models.filter(|model| is_koiter(model.info().name) == koiter);
        let curve = |model: BendingModel| {
            let cells = study.of(shape, model);
            let points: Vec<[f64; 2]> = cells
                .iter()
                .map(|cell| [cell.vertices as f64, cell.error()])
                .collect();
            (!points.is_empty()).then(|| series(model.info().name, points))
        };
        Panel {
            name: format!("relative error, {name} energy"),
            style: Style::LogLines,
            series: curves.filter_map(curve).collect(),
            weight: 1.0,
            if_empty: "no models of this energy".to_owned(),
            ..Panel::default()
        }
    };
    let vertices = || {
        study
            .cells
            .iter()
            .filter(|cell| cell.shape == shape)
            .map(|cell| cell.vertices)
    };
    Chart {
        title: format!(
            "Bending energy under refinement: {}",
            shape.name().replace('-', " ")
        ),
        x_label: "vertices".to_owned(),
        x_range: (
            vertices().min().unwrap_or(1) as f64,
            vertices().max().unwrap_or(10) as f64,
        ),
        x_is_log: true,
        arrangement: Arrangement::Beside,
        panels: vec![panel("Squared Curvature", false), panel("Koiter", true)],
    }
}
