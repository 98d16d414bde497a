//! The page of figures of a run: a panel a question.

use koiter_render::{Chart, Panel, Series, Style};
use serde_json::Value;

use crate::arguments::Figure;

/// Parts of the time below this share of the whole are drawn as one: there are not that many colours.
const SMALL_SHARE: f64 = 0.02;

/// Energies that may be negative, or have no natural zero: not for a logarithmic axis.
const POTENTIALS: [&str; 2] = ["gravity", "loads"];

/// Energies below this share of the largest are round-off, which would take up most of a logarithmic axis.
const LEAST_ENERGY: f64 = 1e-9;

/// Panels of the figures `wanted`, or of all that have something to show, with those of the probes. Figures that a line
/// lacks, or that are null, are gaps.
pub(super) fn page(
    title: &str,
    lines: &[Value],
    probes: Vec<Panel>,
    is_over: bool,
    wanted: &[Figure],
) -> Chart {
    // A line without a time stands at its number.
    let times = (1..)
        .zip(lines)
        .map(|(step, line)| line["time"].as_f64().unwrap_or(f64::from(step)));
    let page = Page {
        lines,
        times: times.collect(),
        probes,
    };
    let all = [
        Figure::Probes,
        Figure::LoadFactor,
        Figure::Energies,
        Figure::SmallEnergies,
        Figure::Seconds,
        Figure::Iterations,
        Figure::Fraction,
        Figure::Contacts,
        Figure::Gap,
        Figure::Stiffness,
    ];
    let panels: Vec<Panel> = match wanted {
        [] => all
            .into_iter()
            .filter(|figure| page.has(*figure))
            .flat_map(|figure| page.panels(figure))
            .collect(),
        wanted => wanted
            .iter()
            .flat_map(|&figure| page.panels(figure))
            .collect(),
    };
    Chart {
        title: page.title(title, is_over),
        x_label: "time [s]".to_owned(),
        x_range: (0.0, page.times.iter().copied().fold(0.0, f64::max)),
        panels,
        ..Chart::default()
    }
}

struct Page<'a> {
    lines: &'a [Value],
    times: Vec<f64>,
    probes: Vec<Panel>,
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or(f64::NAN)
}

impl Page<'_> {
    fn title(&self, title: &str, is_over: bool) -> String {
        let iterations: u64 = self
            .lines
            .iter()
            .filter_map(|line| line["newton_iterations"].as_u64())
            .sum();
        let steps = match self.lines.len() {
            1 => "1 step".to_owned(),
            count => format!("{count} steps"),
        };
        let failed = self
            .lines
            .iter()
            .filter(|line| line["converged"] == false)
            .count();
        let failed = match failed {
            0 => String::new(),
            count => format!(", {count} not converged"),
        };
        let progress = if is_over { "" } else { " so far" };
        format!("{title}: {steps}, {iterations} Newton iterations{failed}{progress}")
    }

    /// Whether a figure belongs on the page of this run.
    fn has(&self, figure: Figure) -> bool {
        let has_number = |key: &str| self.lines.iter().any(|line| line[key].is_number());
        match figure {
            Figure::LoadFactor => has_number("load_factor"),
            Figure::Fraction => has_number("smallest_fraction"),
            Figure::SmallEnergies => !self.small_energies().is_empty(),
            Figure::Stiffness => self.lines.iter().any(|line| number(&line["kappa"]) > 0.0),
            _ => true,
        }
    }

    fn panels(&self, figure: Figure) -> Vec<Panel> {
        let panel = |name: &str, unit: &str, style, weight, series| Panel {
            name: name.to_owned(),
            unit: unit.to_owned(),
            style,
            series,
            weight,
            if_empty: "no figures".to_owned(),
            ..Panel::default()
        };
        let single = |key: &str| vec![self.over_time(key, &|line| number(&line[key]))];
        let count = |name: &str, series| Panel {
            is_count: true,
            ..panel(name, "", Style::Stack, 1.2, series)
        };
        let panel = match figure {
            Figure::Probes => return self.probes.clone(),
            Figure::LoadFactor => {
                panel("load factor", "", Style::Lines, 2.0, single("load_factor"))
            }
            Figure::Energies => panel(
                "energy at the end of the step",
                "J",
                Style::Lines,
                1.8,
                self.energies(),
            ),
            Figure::SmallEnergies => panel(
                "energy that is stored or in motion, logarithmic",
                "J",
                Style::LogLines,
                1.4,
                self.small_energies(),
            ),
            Figure::Seconds => panel("seconds a step", "s", Style::Stack, 1.6, self.seconds()),
            Figure::Iterations => count(
                "Newton iterations a step, by how far they went",
                self.iterations(),
            ),
            Figure::Fraction => panel(
                "shortest part of a Newton step",
                "",
                Style::LogLines,
                0.8,
                single("smallest_fraction"),
            ),
            Figure::Contacts => count("contacts", self.contacts()),
            Figure::Gap => Panel {
                if_empty: "nothing came near anything".to_owned(),
                ..panel("smallest gap", "m", Style::LogLines, 0.9, single("min_gap"))
            },
            Figure::Stiffness => panel(
                "barrier stiffness",
                "J/m²",
                Style::LogLines,
                0.8,
                single("kappa"),
            ),
        };
        vec![panel]
    }

    fn over_time(&self, name: &str, value: &dyn Fn(&Value) -> f64) -> Series {
        let values = self.times.iter().zip(self.lines);
        Series {
            name: name.replace('_', " "),
            points: values.map(|(&time, line)| [time, value(line)]).collect(),
            ..Series::default()
        }
    }

    /// Series of a table of all lines, those with the largest values first.
    fn table(&self, key: &str) -> Vec<Series> {
        let names = names(self.lines, key);
        let mut series: Vec<Series> = (names.iter())
            .map(|name| self.over_time(name, &|line| number(&line[key][name])))
            .collect();
        series.sort_by(|a, b| size(b).total_cmp(&size(a)));
        series
    }

    /// Those of outer forces last, so that the others have the same colours with them and without.
    fn energies(&self) -> Vec<Series> {
        let mut energies = self.table("energies");
        energies.sort_by_key(is_potential);
        energies
    }

    /// Those whose zero means something, that are ever above it; what is next to nothing is a gap.
    fn small_energies(&self) -> Vec<Series> {
        let mut energies = self.energies();
        energies.retain(|series| !is_potential(series) && size(series) > 0.0);
        let values = energies.iter().flat_map(|series| &series.points);
        let largest = values.map(|point| point[1]).fold(0.0, f64::max);
        for point in energies.iter_mut().flat_map(|series| &mut series.points) {
            if point[1] < LEAST_ENERGY * largest {
                point[1] = f64::NAN;
            }
        }
        energies
    }

    /// The largest parts from below, the small ones as one.
    fn seconds(&self) -> Vec<Series> {
        let all = self.table("seconds");
        let whole: f64 = all.iter().map(size).sum();
        let (small, mut large): (Vec<Series>, Vec<Series>) = all
            .into_iter()
            .partition(|series| size(series) < SMALL_SHARE * whole);
        match small.len() {
            0 => {}
            1 => large.extend(small),
            _ => large.push(sum("other", &small)),
        }
        large
    }

    /// Whole steps from below, then those that something cut short.
    fn iterations(&self) -> Vec<Series> {
        let limits = |line: &Value| line["limits"].as_array().cloned().unwrap_or_default();
        let mut causes: Vec<String> = Vec::new();
        for limit in self.lines.iter().flat_map(limits) {
            let cause = limit["by"].as_str().unwrap_or_default().to_owned();
            if !causes.contains(&cause) {
                causes.push(cause);
            }
        }
        causes.sort();
        let cut_by = |line: &Value, cause: &str| -> f64 {
            let limits = limits(line)
                .into_iter()
                .filter(|limit| limit["by"] == cause);
            limits.filter_map(|limit| limit["count"].as_f64()).sum()
        };
        let whole = |line: &Value| {
            let cut: f64 = causes.iter().map(|cause| cut_by(line, cause)).sum();
            number(&line["newton_iterations"]) - cut
        };
        let mut series = vec![self.over_time("whole", &whole)];
        series.extend(causes.iter().map(|cause| {
            let name = match cause.as_str() {
                "decrease" => "cut: energy rises".to_owned(),
                cause => format!("cut by {cause}"),
            };
            self.over_time(&name, &|line| cut_by(line, cause))
        }));
        series
    }

    /// By bodies, where the lines say so.
    fn contacts(&self) -> Vec<Series> {
        let by_bodies = self.table("contacts_by_bodies");
        match by_bodies.is_empty() {
            true => vec![self.over_time("contacts", &|line| number(&line["contacts"]))],
            false => by_bodies.into_iter().map(without_gaps).collect(),
        }
    }
}

fn is_potential(series: &Series) -> bool {
    POTENTIALS.contains(&series.name.as_str())
}

/// Sum of all values, gaps and signs left out.
fn size(series: &Series) -> f64 {
    let values = series.points.iter().map(|point| point[1].abs());
    values.filter(|value| value.is_finite()).sum()
}

/// Where nothing is told there is none.
fn without_gaps(mut series: Series) -> Series {
    let gaps = series.points.iter_mut().filter(|point| point[1].is_nan());
    gaps.for_each(|point| point[1] = 0.0);
    series
}

fn sum(name: &str, all: &[Series]) -> Series {
    let mut total = without_gaps(all[0].clone());
    for series in &all[1..] {
        for (point, other) in total.points.iter_mut().zip(&series.points) {
            point[1] += if other[1].is_nan() { 0.0 } else { other[1] };
        }
    }
    total.name = name.to_owned();
    total
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
    use serde_json::json;

    #[test]
    fn lines_that_lack_figures_are_gaps() {
        let lines = [
            json!({ "time": 0.1, "energies": { "gravity": 1.0 }, "min_gap": null, "contacts": 0 }),
            json!({ "time": 0.2, "energies": { "gravity": 2.0, "contact": 0.5 }, "min_gap": 1e-4 }),
            json!({}),
            json!("no table"),
        ];
        let chart = page("Run", &lines, Vec::new(), false, &[]);
        assert_eq!(chart.title, "Run: 4 steps, 0 Newton iterations so far");
        let energies = &chart.panels[0].series;
        assert_eq!(
            (energies[0].name.as_str(), energies[1].name.as_str()),
            ("contact", "gravity")
        );
        assert!(energies[0].points[0][1].is_nan() && energies[0].points[1] == [0.2, 0.5]);
        assert_eq!(energies[1].points[2][0], 3.0);
        let text = chart.to_svg(800, 600).unwrap();
        assert!(!text.contains("NaN") && text.contains("gravity"));
    }

    #[test]
    fn iterations_are_told_apart_by_what_cut_them_and_small_parts_are_one() {
        let lines = [json!({
            "time": 1.0, "newton_iterations": 9, "converged": false, "kappa": 2.0, "smallest_fraction": 0.1,
            "limits": [{ "by": "contact", "count": 4 }, { "by": "decrease", "count": 2 }],
            "contacts_by_bodies": { "a with b": 3 },
            "seconds": { "assembly": 9.0, "audit": 0.01, "contact": 0.02, "linear_solve": 12.0 },
        })];
        let chart = page("Run", &lines, Vec::new(), true, &[]);
        assert_eq!(
            chart.title,
            "Run: 1 step, 9 Newton iterations, 1 not converged"
        );
        let find = |name: &str| {
            chart
                .panels
                .iter()
                .find(|panel| panel.name.starts_with(name))
                .unwrap()
        };
        let of = |name: &str| -> Vec<(String, f64)> {
            let series = find(name).series.iter();
            series
                .map(|series| (series.name.clone(), series.points[0][1]))
                .collect()
        };
        let expected = [
            ("whole", 3.0),
            ("cut by contact", 4.0),
            ("cut: energy rises", 2.0),
        ];
        assert_eq!(
            of("Newton"),
            expected.map(|(name, value)| (name.to_owned(), value))
        );
        let names: Vec<String> = of("seconds").into_iter().map(|(name, _)| name).collect();
        assert_eq!(names, ["linear solve", "assembly", "other"]);
        assert!((of("seconds")[2].1 - 0.03).abs() < 1e-15);
        assert_eq!(of("contacts"), [("a with b".to_owned(), 3.0)]);
        assert!(find("contacts").is_count && find("barrier").series[0].points[0][1] == 2.0);
        let chosen = page(
            "Run",
            &lines,
            Vec::new(),
            true,
            &[Figure::Gap, Figure::LoadFactor],
        );
        assert_eq!(
            (chosen.panels.len(), chosen.panels[0].name.as_str()),
            (2, "smallest gap")
        );
    }
}
