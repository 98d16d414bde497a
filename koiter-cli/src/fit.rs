//! `koiter fit`: values of a scene's keys for which it does what was measured.

mod curve;
mod least_squares;

use std::io::IsTerminal;

use koiter::scene::nearest;
use nalgebra::DVector;
use serde_json::{Value, json};

use crate::arguments::{FitArguments, SceneArguments};
use crate::failure::{Code, Failure};
use crate::output::{say, say_error};
use crate::probes::values_by_column;
use crate::run::start;
use crate::scene_source::{LoadedScene, load, load_silently};
use curve::{Curve, CurveKind};
use least_squares::{Fit, FitError, minimise, student_95};

/// Fits, and prints what was found.
pub(crate) fn fit(arguments: &FitArguments) -> Result<(), Failure> {
    let curve = Curve::read(&arguments.measured)?;
    let keys = keys(&arguments.vary)?;
    let task = Task {
        scene: &arguments.scene,
        curve: &curve,
        scales: curve.scales(),
        keys: &keys,
    };
    let starts: Vec<f64> = keys.iter().map(|(_, start)| start.ln()).collect();
    let first = load(&task.scene_with(&DVector::from_vec(starts.clone())))?;
    task.check(&first)?;
    let mut runs = 0;
    let residuals = |parameters: &DVector<f64>| {
        runs += 1;
        task.residuals(&load_silently(&task.scene_with(parameters))?)
    };
    let is_told = std::io::stderr().is_terminal() && !arguments.json;
    let told = |iteration: usize, at: &DVector<f64>, sum: f64| {
        if is_told {
            let values = task.overrides(at).join("  ");
            say_error!(
                "iteration {iteration}: {values}  deviation {:.3e}",
                task.deviation(sum)
            );
        }
    };
    let fit = minimise(
        DVector::from_vec(starts),
        arguments.iterations,
        residuals,
        told,
    );
    let fit = fit.map_err(|error| match error {
        FitError::Start(failure) | FitError::Difference(failure) => failure,
        FitError::Undetermined(parameter) => undetermined(&keys, parameter),
    })?;
    report(arguments, &task, &fit, runs);
    match fit.converged {
        true => Ok(()),
        false => Err(Failure::run(format!(
            "after {} iterations the parameters still change",
            fit.iterations
        ))
        .with_code(Code::Fit)
        .with_help("start nearer to what is expected, or allow more with --iterations")),
    }
}

/// Keys and where they start.
fn keys(vary: &[String]) -> Result<Vec<(String, f64)>, Failure> {
    let mut keys: Vec<(String, f64)> = Vec::new();
    for text in vary {
        let wrong = |reason: &str| {
            Failure::input(format!("--vary {text}: {reason}")).with_help(
                "give a key and a start above 0, such as --vary shell.strip.material.young=1e7",
            )
        };
        let (key, start) = text
            .split_once('=')
            .ok_or_else(|| wrong("there is no '='"))?;
        let start = start
            .trim()
            .parse()
            .ok()
            .filter(|x: &f64| *x > 0.0 && x.is_finite());
        let start = start.ok_or_else(|| wrong("its start is not a number above 0"))?;
        if keys.iter().any(|(other, _)| other == key) {
            return Err(wrong("the key is given twice"));
        }
        keys.push((key.trim().to_owned(), start));
    }
    Ok(keys)
}

fn undetermined(keys: &[(String, f64)], parameter: usize) -> Failure {
    let key = &keys[parameter].0;
    let message = format!(
        "the curve does not determine '{key}': it changes nothing that was measured, or nothing that another key does not change too"
    );
    let help = match keys.len() {
        1 => "vary another key, or measure something that depends on this one",
        _ => "vary fewer keys, or measure something that depends on this one alone",
    };
    Failure::input(message).with_code(Code::Fit).with_help(help)
}

/// A scene, and what it is to do. Parameters are logarithms of the keys' values.
struct Task<'a> {
    scene: &'a SceneArguments,
    curve: &'a Curve,
    scales: Vec<f64>,
    keys: &'a [(String, f64)],
}

impl Task<'_> {
    fn overrides(&self, parameters: &DVector<f64>) -> Vec<String> {
        let keys = self.keys.iter().zip(parameters);
        keys.map(|((key, _), parameter)| format!("{key}={:e}", parameter.exp()))
            .collect()
    }

    fn scene_with(&self, parameters: &DVector<f64>) -> SceneArguments {
        let given = self.scene.overrides.iter().cloned();
        SceneArguments {
            scene: self.scene.scene.clone(),
            overrides: given.chain(self.overrides(parameters)).collect(),
            memory: self.scene.memory,
        }
    }

    /// Whether the scene says at all what was measured.
    fn check(&self, loaded: &LoadedScene) -> Result<(), Failure> {
        if self.curve.kind == CurveKind::Frequencies {
            return Ok(());
        }
        let scene = &loaded.scene;
        let columns: Vec<String> = scene.probes.iter().flat_map(|p| p.columns()).collect();
        let names = || columns.iter().map(String::as_str);
        for (name, _) in &self.curve.columns {
            if !columns.contains(name) {
                let near = nearest(name, names())
                    .map_or(String::new(), |near| format!("did you mean '{near}'? "));
                let message = format!("the scene has no probe column '{name}'");
                return Err(Failure::input(message).with_help(format!(
                    "{near}there are: {}",
                    names().collect::<Vec<_>>().join(", ")
                )));
            }
        }
        let end = scene.timeline.time(scene.timeline.num_steps());
        match self
            .curve
            .places
            .iter()
            .find(|time| !(0.0..=end * (1.0 + 1e-9)).contains(*time))
        {
            None => Ok(()),
            Some(time) => Err(Failure::input(format!(
                "the curve has a value at {time} s, the scene goes from 0 to {end} s"
            ))),
        }
    }

    /// Computed less measured, column after column, each over its scale.
    fn residuals(&self, loaded: &LoadedScene) -> Result<DVector<f64>, Failure> {
        let computed = match self.curve.kind {
            CurveKind::OverTime => self.over_time(loaded)?,
            CurveKind::Frequencies => vec![self.frequencies(loaded)?],
        };
        let columns = computed.iter().zip(&self.curve.columns).zip(&self.scales);
        let residuals = columns.flat_map(|((computed, (_, measured)), scale)| {
            let pairs = computed.iter().zip(measured);
            pairs.map(move |(computed, measured)| (computed - measured) / scale)
        });
        Ok(DVector::from_iterator(self.curve.len(), residuals))
    }

    fn frequencies(&self, loaded: &LoadedScene) -> Result<Vec<f64>, Failure> {
        let highest = self
            .curve
            .places
            .iter()
            .fold(1.0_f64, |m, mode| m.max(*mode)) as usize;
        let mut simulation = start(&loaded.scene.model, None)?;
        let modes = simulation.vibration_modes(highest).map_err(Failure::run)?;
        let modes = self
            .curve
            .places
            .iter()
            .map(|mode| modes.get(*mode as usize - 1));
        modes
            .map(|mode| mode.map(|mode| mode.frequency()))
            .collect::<Option<_>>()
            .ok_or_else(|| Failure::input(format!("the scene has fewer than {highest} modes")))
    }

    /// The probes' columns at the measured times, linear between steps.
    fn over_time(&self, loaded: &LoadedScene) -> Result<Vec<Vec<f64>>, Failure> {
        let scene = &loaded.scene;
        let mut simulation = start(&scene.model, None)?;
        let mut times = vec![0.0];
        let mut rows = vec![values_by_column(&scene.probes, &simulation)];
        for step in 1..=scene.timeline.num_steps() {
            let report = simulation
                .step(scene.timeline.dt(step))
                .map_err(Failure::step)?;
            if !report.converged {
                let reason = report.diagnosis.unwrap_or_default();
                let message = format!("step {step} did not converge: {reason}");
                return Err(Failure::run(message).with_code(Code::NotConverged));
            }
            times.push(scene.timeline.time(step));
            rows.push(values_by_column(&scene.probes, &simulation));
        }
        let value = |row: usize, name: &str| {
            let found = rows[row].iter().find(|(column, _)| column == name);
            found.map_or(f64::NAN, |(_, value)| *value)
        };
        let at = |time: f64, name: &str| {
            let next = times
                .partition_point(|&t| t < time)
                .clamp(1, times.len() - 1);
            let share = ((time - times[next - 1]) / (times[next] - times[next - 1])).min(1.0);
            value(next - 1, name) * (1.0 - share) + value(next, name) * share
        };
        let columns = self.curve.columns.iter();
        Ok(columns
            .map(|(name, _)| {
                self.curve
                    .places
                    .iter()
                    .map(|&time| at(time, name))
                    .collect()
            })
            .collect())
    }

    /// Root mean square of the residuals, over the largest measured value.
    fn deviation(&self, sum: f64) -> f64 {
        (sum / self.curve.len() as f64).sqrt()
    }
}

fn report(arguments: &FitArguments, task: &Task, fit: &Fit, runs: usize) {
    let freedom = task.curve.len().saturating_sub(task.keys.len());
    let mut parameters: Vec<Value> = Vec::new();
    for (index, (key, _)) in task.keys.iter().enumerate() {
        let value = fit.parameters[index].exp();
        let interval = fit.covariance.as_ref().map(|covariance| {
            let factor = (student_95(freedom) * covariance[(index, index)].sqrt()).exp();
            [value / factor, value * factor]
        });
        if !arguments.json {
            match interval {
                Some([low, high]) => say!("{key} = {value:.6e}  (95 %: {low:.6e} to {high:.6e})"),
                None => say!("{key} = {value:.6e}  (as many values as keys: no interval)"),
            }
        }
        parameters.push(json!({ "key": key, "value": value, "interval_95": interval }));
    }
    let deviation = task.deviation(fit.residuals.norm_squared());
    if arguments.json {
        let covariance = fit.covariance.as_ref();
        let rows = covariance.map(|c| {
            c.row_iter()
                .map(|row| row.iter().copied().collect())
                .collect()
        });
        let rows: Option<Vec<Vec<f64>>> = rows;
        say!(
            "{}",
            json!({
                "parameters": parameters,
                "relative_deviation": deviation,
                "covariance_of_logarithms": rows,
                "measured_values": task.curve.len(),
                "iterations": fit.iterations,
                "runs": runs,
                "converged": fit.converged,
            })
        );
        return;
    }
    say!(
        "deviation {:.3} % of the largest value, root mean square of {} values; {} iterations, {runs} runs",
        100.0 * deviation,
        task.curve.len(),
        fit.iterations
    );
}
