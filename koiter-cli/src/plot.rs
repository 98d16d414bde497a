//! `koiter plot`: the figures of a run, from `stats.jsonl` and `probes.csv`.

mod page;
mod probes;

use std::path::Path;

use koiter::io::result::ResultReader;
use koiter::io::write_atomically;
use koiter_render::Chart;
use serde_json::json;

use crate::arguments::PlotArguments;
use crate::failure::Failure;
use crate::output::say;
use crate::output_path;

/// Draws the figures.
pub(crate) fn plot(arguments: &PlotArguments) -> Result<(), Failure> {
    let output = arguments
        .output
        .clone()
        .unwrap_or_else(|| arguments.result.join("plot.svg"));
    let extension = output.extension().unwrap_or_default().to_ascii_lowercase();
    if extension != "svg" && extension != "png" {
        let message = format!("{}: a figure ends in .svg or .png", output.display());
        return Err(Failure::input(message));
    }
    let reader = ResultReader::open(&arguments.result).map_err(Failure::result)?;
    output_path::check(&output)?;
    let lines = reader.stats().map_err(Failure::result)?;
    if lines.is_empty() {
        let message = format!(
            "{} has no steps yet: there is nothing to plot",
            arguments.result.display()
        );
        return Err(Failure::input(message));
    }
    let is_over = reader.summary().map_err(Failure::result)?.is_some();
    let chart = page::page(
        &reader.manifest().title,
        &lines,
        probes::panels(&arguments.result, &reader.manifest().scene_text),
        is_over,
        &arguments.figures,
    );
    write(&chart, arguments.size, &output)?;
    if arguments.json {
        let made = output.display().to_string();
        say!(
            "{}",
            json!({ "made": made, "steps": lines.len(), "finished": is_over })
        );
    } else {
        say!("made: {}", output.display());
    }
    Ok(())
}

/// Writes a chart as SVG or PNG, by the ending of the path.
pub(crate) fn write(
    chart: &Chart,
    (width, height): (u32, u32),
    path: &Path,
) -> Result<(), Failure> {
    if path
        .extension()
        .is_some_and(|extension| extension.eq_ignore_ascii_case("png"))
    {
        let image = chart.to_image(width, height).map_err(Failure::input)?;
        return image.write_png(path).map_err(Failure::run);
    }
    let text = chart.to_svg(width, height).map_err(Failure::input)?;
    write_atomically(path, text.as_bytes()).map_err(|error| Failure::writing(path, &error))
}
