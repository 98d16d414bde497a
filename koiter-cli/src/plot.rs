//! `koiter plot`: the figures of a run, from `stats.jsonl`.

use std::path::Path;

use koiter::io::result::ResultReader;
use koiter::io::write_atomically;
use koiter_render::{Chart, Panel, Series, Style};
use serde_json::{Value, json};

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
    let chart = chart(&reader.manifest().title, &lines, is_over);
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
    write_atomically(path, text.as_bytes())
        .map_err(|error| Failure::run(format!("cannot write {}: {error}", path.display())))
}

/// Figures that a line lacks, or that are null, are gaps.
fn chart(title: &str, lines: &[Value], is_over: bool) -> Chart {
    let number = |value: &Value| value.as_f64().unwrap_or(f64::NAN);
    // A line without a time stands at its number.
    let times: Vec<f64> = (1..)
        .zip(lines)
        .map(|(step, line)| line["time"].as_f64().unwrap_or(f64::from(step)))
        .collect();
    let over_time = |name: &str, value: &dyn Fn(&Value) -> f64| Series {
        name: name.replace('_', " "),
        points: times
            .iter()
            .zip(lines)
            .map(|(&time, line)| [time, value(line)])
            .collect(),
        ..Series::default()
    };
    let by_name = |key: &str| -> Vec<Series> {
        let all = names(lines, key);
        all.iter()
            .map(|name| over_time(name, &|line| number(&line[key][name])))
            .collect()
    };
    let single = |key: &str| vec![over_time(key, &|line| number(&line[key]))];
    let panel = |name: &str, unit: &str, style, weight, series| Panel {
        name: name.to_owned(),
        unit: unit.to_owned(),
        style,
        series,
        weight,
        if_empty: "no figures".to_owned(),
    };
    let mut gap = panel("smallest gap", "m", Style::LogLines, 1.0, single("min_gap"));
    gap.if_empty = "nothing came near anything".to_owned();
    let iterations: u64 = lines
        .iter()
        .filter_map(|line| line["newton_iterations"].as_u64())
        .sum();
    let steps = match lines.len() {
        1 => "1 step".to_owned(),
        count => format!("{count} steps"),
    };
    let progress = if is_over { "" } else { " so far" };
    let mut panels = vec![
        panel(
            "energy at the end of the step",
            "J",
            Style::Lines,
            2.2,
            by_name("energies"),
        ),
        panel("seconds a step", "s", Style::Stack, 2.0, by_name("seconds")),
        panel(
            "Newton iterations a step",
            "",
            Style::Stack,
            1.0,
            single("newton_iterations"),
        ),
        panel("contacts", "", Style::Stack, 1.0, single("contacts")),
        gap,
    ];
    if lines.iter().any(|line| line["load_factor"].is_number()) {
        let loads = single("load_factor");
        panels.insert(0, panel("load factor", "", Style::Lines, 2.0, loads));
    }
    Chart {
        title: format!("{title}: {steps}, {iterations} Newton iterations{progress}"),
        x_label: "time [s]".to_owned(),
        x_range: (0.0, times.iter().copied().fold(0.0, f64::max)),
        panels,
        ..Chart::default()
    }
}

/// The keys of a table of all lines, in the order in which they first appear.
fn names(lines: &[Value], key: &str) -> Vec<String> {
    let mut names: Vec<String> = Vec::new();
    for name in lines
        .iter()
        .filter_map(|line| line[key].as_object())
        .flat_map(|table| table.keys())
    {
        if !names.contains(name) {
            names.push(name.clone());
        }
    }
    names
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_that_lack_figures_are_gaps() {
        let lines = [
            json!({ "time": 0.1, "energies": { "gravity": 1.0 }, "min_gap": null, "contacts": 0 }),
            json!({ "time": 0.2, "energies": { "gravity": 2.0, "contact": 0.5 }, "min_gap": 1e-4 }),
            json!({}),
            json!("no table"),
        ];
        let chart = chart("Run", &lines, false);
        assert_eq!(chart.title, "Run: 4 steps, 0 Newton iterations so far");
        let energies = &chart.panels[0].series;
        assert_eq!(
            (energies[0].name.as_str(), energies[1].name.as_str()),
            ("gravity", "contact")
        );
        assert!(energies[1].points[0][1].is_nan() && energies[1].points[1] == [0.2, 0.5]);
        assert_eq!(energies[0].points[2][0], 3.0);
        let text = chart.to_svg(800, 600).unwrap();
        assert!(!text.contains("NaN") && text.contains("gravity"));
    }
}
