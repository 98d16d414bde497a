//! Load over displacement, ours and the published ones.

use std::path::Path;

use koiter_render::{Chart, Marker, Panel, Series, Style};

use super::case::Case;
use super::study::Study;
use crate::failure::Failure;
use crate::plot;

/// Draws a case that has paths, a panel a quantity; other cases have nothing to draw.
pub(super) fn draw(case: &Case, studies: &[Study], folder: &Path) -> Result<(), Failure> {
    let Some(first) = studies.first() else {
        return Ok(());
    };
    let mut panels = Vec::new();
    let mut last = 0.0f64;
    for (k, finding) in first.findings.iter().enumerate() {
        if finding.curve.is_empty() {
            return Ok(());
        }
        let of_model = |study: &Study| Series {
            name: study.model.clone(),
            points: study.findings[k].curve.clone(),
            ..Series::default()
        };
        let mut series: Vec<Series> = studies.iter().map(of_model).collect();
        // Signs on top of the curves, which lie on each other where all is well.
        series.push(Series {
            name: "published".into(),
            points: finding.quantity.curve.clone(),
            color: Some([0; 3]),
            marker: Some(Marker::Circle),
        });
        last = (finding.quantity.curve.iter()).fold(last, |last, point| last.max(point[0]));
        panels.push(Panel {
            name: finding.quantity.name.replace('_', " "),
            unit: "".into(),
            style: Style::Lines,
            series,
            weight: 1.0,
            if_empty: "no steps".into(),
            ..Panel::default()
        });
    }
    let chart = Chart {
        title: case.title.into(),
        x_label: "load".into(),
        x_range: (0.0, last),
        panels,
        ..Chart::default()
    };
    for extension in ["svg", "png"] {
        let path = folder.join(format!("{}.{extension}", case.name));
        plot::write(&chart, (900, 800), &path)?;
    }
    Ok(())
}
