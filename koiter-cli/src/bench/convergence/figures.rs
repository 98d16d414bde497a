//! Errors over numbers of vertices: Figures 3 to 12 of "Better Bending", one a shape.

use std::path::Path;

use koiter::scene::measure::shapes::{KnownShape, SmoothEnergy};
use koiter::scene::model::BendingModel;
use koiter_render::{Arrangement, Chart, Line, Panel, Series, Style};

use super::{Cell, Study};
use crate::failure::Failure;
use crate::model_style::series;
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
    let cells = || study.cells.iter().filter(|cell| cell.shape == shape);
    let range = |value: fn(&Cell) -> f64| {
        let values = cells()
            .map(value)
            .filter(|value| value.is_finite() && *value > 0.0);
        values.fold([f64::INFINITY, 0.0], |[low, high]: [f64; 2], value| {
            [low.min(value), high.max(value)]
        })
    };
    let [fewest, most] = range(|cell| cell.vertices as f64);
    let [least, largest] = range(Cell::error);
    let panel = |name: &str, smooth: SmoothEnergy| {
        let models = BendingModel::ALL.into_iter();
        let curve = |model: BendingModel| {
            let cells = study.of(shape, model);
            let points: Vec<[f64; 2]> = cells
                .iter()
                .map(|cell| [cell.vertices as f64, cell.error()])
                .collect();
            (!points.is_empty()).then(|| series(model, points))
        };
        let curves = models.filter(|model| SmoothEnergy::of(*model) == Some(smooth));
        let mut series: Vec<Series> = curves.filter_map(curve).collect();
        if !series.is_empty() && fewest < most {
            series.push(first_order([fewest, most], [least, largest]));
        }
        Panel {
            name: format!("relative error, {name} energy"),
            style: Style::LogLines,
            series,
            weight: 1.0,
            include: vec![least, largest],
            if_empty: "no models of this energy".to_owned(),
            ..Panel::default()
        }
    };
    Chart {
        title: format!(
            "Bending energy under refinement: {}",
            shape.name().replace('-', " ")
        ),
        x_label: "vertices".to_owned(),
        x_range: match fewest <= most {
            true => (fewest, most),
            false => (1.0, 10.0),
        },
        x_is_log: true,
        arrangement: Arrangement::Beside,
        panels: vec![
            panel("Squared Curvature", SmoothEnergy::SquaredCurvature),
            panel("Koiter", SmoothEnergy::Koiter),
        ],
    }
}

/// The slope of errors of first order in the length of edges, through the middle of what is drawn.
fn first_order([fewest, most]: [f64; 2], [least, largest]: [f64; 2]) -> Series {
    let (vertices, error) = ((fewest * most).sqrt(), (least * largest).sqrt());
    let at = |v: f64| [v, error * (v / vertices).powf(-0.5)];
    Series {
        name: "slope −½".to_owned(),
        points: vec![at(fewest), at(most)],
        color: Some([60; 3]),
        line: Line::Guide,
        ..Series::default()
    }
}
