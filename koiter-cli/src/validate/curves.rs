//! Load over displacement, ours and the published ones.

use std::path::Path;

use koiter_render::{Chart, Panel, Series, Style};

use super::case::{Case, Question};
use super::study::{Finding, Study};
use crate::failure::Failure;
use crate::{model_style, plot};

/// Draws a case that has paths, a panel a quantity; other cases have nothing to draw.
pub(super) fn draw(case: &Case, studies: &[Study], folder: &Path) -> Result<(), Failure> {
    let Some(first) = studies.first() else {
        return Ok(());
    };
    let Question::Path { load, unit, .. } = case.question else {
        return Ok(());
    };
    let mut last = 0.0f64;
    let panel = |(k, finding): (usize, &Finding)| {
        let of_model =
            |study: &Study| model_style::series(study.model, study.findings[k].curve.clone());
        let mut series: Vec<Series> = studies.iter().map(of_model).collect();
        series.push(model_style::published(finding.quantity.curve.clone()));
        last = (finding.quantity.curve.iter()).fold(last, |last, point| last.max(point[0]));
        Panel {
            name: finding.quantity.name.replace('_', " "),
            unit: unit.into(),
            style: Style::Lines,
            series,
            weight: 1.0,
            if_empty: "no steps".into(),
            ..Panel::default()
        }
    };
    let panels = first.findings.iter().enumerate().map(panel).collect();
    let chart = Chart {
        title: format!("{} (finest mesh)", case.title),
        x_label: load.into(),
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
