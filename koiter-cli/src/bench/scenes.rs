//! Whole runs of the contact-rich scenes of "Better Bending" (2026), section 10: what they take beside Table 7, and
//! whether they run through, untouched, with other steps, gaps and axes.

use std::collections::BTreeMap;
use std::time::Instant;

use indicatif::ProgressBar;
use koiter::audit::Audit;
use koiter::mesh::Surface;
use koiter::scene::measure::Measurement;
use koiter::scene::model::BendingModel;
use koiter::scene::{Scene, Simulation, Timeline};
use nalgebra::{Rotation3, Unit, Vector3};
use serde_json::{Value, json};

use super::models::hessian_nonzeros;
use super::published::{number, rows};
use super::table::{Cell, Table};
use crate::arguments::{SceneArguments, ScenesArguments, Variation, bending_models};
use crate::check::bodies;
use crate::failure::Failure;
use crate::scene_source::load_silently;
use koiter::io::record::parts_and_faces;

/// Parts of a step that are contact.
const CONTACT_PARTS: [&str; 3] = ["contact", "collision_detection", "audit"];

/// Factor of the variations.
const FACTOR: f64 = 4.0;

pub(super) fn bench(options: &ScenesArguments) -> Result<Table, Failure> {
    let published: Vec<Published> = Published::all().collect();
    let names = chosen(&options.scenes, &published)?;
    let models = bending_models(&options.models).map_err(Failure::input)?;
    let mut table = Table::new("contact-rich scenes", COLUMNS);
    let mut details = Vec::new();
    for name in names {
        let of_scene = published.iter().filter(|row| row.scene == name);
        let of_scene: Vec<BendingModel> = of_scene.map(|row| row.bending).collect();
        for &bending in if models.is_empty() {
            &of_scene
        } else {
            &models
        } {
            for &variation in &options.variations {
                let task = Task {
                    name,
                    bending,
                    variation,
                    resolution: &options.resolution,
                };
                let run = task.run()?;
                let beside = (options.resolution == "paper" && variation == Variation::Plain)
                    .then(|| published.iter().find(|row| row.is_of(name, bending)))
                    .flatten();
                table.push(run.row(&task, beside));
                details.push(run.json(&task));
                table.failures.extend(run.fault(&task));
            }
        }
    }
    table.details = Some(Value::Array(details));
    Ok(table)
}

const COLUMNS: &[(&str, &str)] = &[
    ("scene", "scene"),
    ("bending", "bending"),
    ("variation", "variation"),
    ("triangles", "triangles"),
    ("steps", "steps"),
    ("iterations", "iterations"),
    ("seconds", "s"),
    ("seconds_per_iteration", "s an iteration"),
    ("contact_share", "contact share"),
    ("bending_nonzeros", "bending nonzeros"),
    ("smallest_gap", "smallest gap, mm"),
    ("unconverged", "unconverged"),
    ("frames", "frames"),
    ("frames_at_fault", "at fault"),
    ("published_iterations", "published iterations"),
    ("published_seconds_per_iteration", "s an iteration"),
    ("published_nonzeros", "nonzeros"),
];

/// A row of Table 7.
struct Published {
    scene: &'static str,
    bending: BendingModel,
    seconds: f64,
    iterations: f64,
    nonzeros: f64,
}

impl Published {
    fn all() -> impl Iterator<Item = Self> {
        rows(include_str!(
            "../../../benchmarks/contact-rich-scenes/table7.csv"
        ))
        .map(|row| Self {
            scene: row[0],
            bending: bending_models(&[row[1].to_owned()]).expect("shipped tables name models")[0],
            seconds: number(row[4]),
            iterations: number(row[5]),
            nonzeros: number(row[6]),
        })
    }

    fn is_of(&self, scene: &str, bending: BendingModel) -> bool {
        self.scene == scene && self.bending == bending
    }
}

/// The scenes that are asked for, each once.
fn chosen(asked: &[String], published: &[Published]) -> Result<Vec<&'static str>, Failure> {
    let mut all: Vec<&'static str> = published.iter().map(|row| row.scene).collect();
    all.dedup();
    for name in asked {
        if !all.contains(&name.as_str()) {
            let message = format!("no contact-rich scene is named '{name}'");
            return Err(Failure::input(message).with_help(format!("there are {}", all.join(", "))));
        }
    }
    all.retain(|name| asked.is_empty() || asked.iter().any(|asked| asked == name));
    Ok(all)
}

/// A run that is asked for.
struct Task<'a> {
    name: &'static str,
    bending: BendingModel,
    variation: Variation,
    resolution: &'a str,
}

impl Task<'_> {
    fn load(&self, more: &[String]) -> Result<Scene, Failure> {
        let mut overrides = vec![format!("resolution={}", self.resolution)];
        overrides.extend_from_slice(more);
        let scene = SceneArguments {
            scene: self.name.into(),
            overrides,
            memory: None,
        };
        Ok(load_silently(&scene)?.scene)
    }

    /// The scene with the bending model and the variation.
    fn scene(&self) -> Result<Scene, Failure> {
        let plain = self.load(&[])?;
        let steps = |factor: f64| -> Vec<String> {
            let phases = plain.timeline.phases().iter();
            phases
                .map(|phase| match phase.name.is_empty() {
                    true => format!("time.dt={:e}", factor * phase.dt),
                    false => format!("phase.{}.dt={:e}", phase.name, factor * phase.dt),
                })
                .collect()
        };
        let mut scene = match self.variation {
            Variation::Plain => plain,
            Variation::LongSteps => self.load(&steps(FACTOR))?,
            Variation::ShortSteps => self.load(&steps(1.0 / FACTOR))?,
            Variation::ThinBarrier => match plain.model.contact.d_hat {
                Some(d_hat) => self.load(&[format!("contact.d_hat={:e}", d_hat / FACTOR)])?,
                None => return Err(self.cannot("has no contact.d_hat of its own")),
            },
            Variation::Turned => {
                let axis = Unit::new_normalize(Vector3::new(0.36, -0.48, 0.8));
                let turned = plain.model.turned(&Rotation3::from_axis_angle(&axis, 1.1));
                let model = turned.ok_or_else(|| self.cannot("is tied to the axes"))?;
                Scene { model, ..plain }
            }
        };
        for shell in &mut scene.model.shells {
            if shell.bending != BendingModel::None {
                shell.bending = self.bending;
            }
        }
        Ok(scene)
    }

    fn cannot(&self, why: &str) -> Failure {
        Failure::input(format!("{}: the scene {why}", self.words()))
    }

    fn words(&self) -> String {
        format!(
            "{} with {}, {}",
            self.name,
            self.bending.info().name,
            variation_name(self.variation)
        )
    }

    fn run(&self) -> Result<Run, Failure> {
        let scene = self.scene()?;
        let mut simulation = Simulation::new(scene.model).map_err(Failure::start)?;
        let mut run = Run {
            triangles: simulation.stats().faces,
            smallest_gap: f64::INFINITY,
            ..Run::default()
        };
        let (audit, faces) = audit(&simulation);
        run.triangles_shown = faces;
        let bar = ProgressBar::new(scene.timeline.num_steps() as u64);
        let start = Instant::now();
        for step in 1..=scene.timeline.num_steps() {
            if !run.step(&mut simulation, &scene.timeline, step) {
                break;
            }
            if scene.timeline.has_frame(step) {
                run.look(&audit, &simulation);
            }
            bar.inc(1);
        }
        bar.finish_and_clear();
        run.seconds = start.elapsed().as_secs_f64();
        run.nonzeros = bending_nonzeros(&simulation)?;
        Ok(run)
    }
}

fn variation_name(variation: Variation) -> &'static str {
    match variation {
        Variation::Plain => "plain",
        Variation::LongSteps => "long-steps",
        Variation::ShortSteps => "short-steps",
        Variation::ThinBarrier => "thin-barrier",
        Variation::Turned => "turned",
    }
}

/// What tests the frames of a simulation, and the triangles of all that is shown.
fn audit(simulation: &Simulation) -> (Audit, usize) {
    let (parts, faces) = parts_and_faces(simulation);
    let positions = simulation.display_positions();
    let audit = Audit::new(bodies(&parts), &faces, &simulation.rest_faces(), &positions);
    (audit, faces.len())
}

/// Of all shells that bend, at the end of the run.
fn bending_nonzeros(simulation: &Simulation) -> Result<usize, Failure> {
    let mut sum = 0;
    for (index, shell) in simulation.model().shells.iter().enumerate() {
        if shell.bending == BendingModel::None {
            continue;
        }
        let deformed = Surface {
            mesh: shell.surface.mesh.clone(),
            positions: simulation.shell_positions(index),
        };
        sum += hessian_nonzeros(&Measurement {
            deformed: &deformed,
            rest_positions: &shell.rest_positions,
            rest_curved: shell.rest_curved,
            model: shell.bending,
            thickness: shell.thickness,
            youngs_modulus: shell.youngs_modulus,
            poissons_ratio: shell.poissons_ratio,
        })?;
    }
    Ok(sum)
}

/// What happened.
#[derive(Default)]
struct Run {
    triangles: usize,
    triangles_shown: usize,
    steps: usize,
    iterations: usize,
    seconds: f64,
    parts: BTreeMap<&'static str, f64>,
    nonzeros: usize,
    smallest_gap: f64,
    unconverged: usize,
    frames: usize,
    at_fault: usize,
    /// Why it broke off.
    error: Option<String>,
}

impl Run {
    /// Takes a step; whether it could be taken.
    fn step(&mut self, simulation: &mut Simulation, timeline: &Timeline, step: usize) -> bool {
        let report = match simulation.step(timeline.dt(step)) {
            Ok(report) => report,
            Err(error) => {
                self.error = Some(error.to_string());
                return false;
            }
        };
        self.steps += 1;
        self.iterations += report.newton_iterations;
        self.unconverged += usize::from(!report.converged);
        self.smallest_gap = self.smallest_gap.min(report.min_gap);
        for (part, seconds) in report.seconds {
            *self.parts.entry(part).or_default() += seconds;
        }
        true
    }

    /// Tests what would be a frame.
    fn look(&mut self, audit: &Audit, simulation: &Simulation) {
        self.frames += 1;
        let found = audit.frame(&simulation.display_positions());
        self.at_fault += usize::from(!found.is_clean());
    }

    fn contact_share(&self) -> f64 {
        let spent = |part: &&str| self.parts.get(*part).copied().unwrap_or(0.0);
        let all: f64 = self.parts.values().sum();
        CONTACT_PARTS.iter().map(spent).sum::<f64>() / all
    }

    /// What is wrong with it.
    fn fault(&self, task: &Task<'_>) -> Option<String> {
        let what = match (&self.error, self.unconverged, self.at_fault) {
            (Some(error), ..) => format!("broke off in step {}: {error}", self.steps + 1),
            (None, 0, 0) => return None,
            (None, 0, frames) => format!("{frames} of {} frames are at fault", self.frames),
            (None, steps, _) => format!("{steps} of {} steps did not converge", self.steps),
        };
        Some(format!("{}: {what}", task.words()))
    }

    fn row(&self, task: &Task<'_>, published: Option<&Published>) -> Vec<Cell> {
        let none = || Cell::Text("–".into());
        let of_published =
            |figure: fn(&Published) -> f64| published.map_or_else(none, |row| figure(row).into());
        vec![
            task.name.into(),
            task.bending.info().name.into(),
            variation_name(task.variation).into(),
            self.triangles.into(),
            self.steps.into(),
            self.iterations.into(),
            self.seconds.into(),
            (self.seconds / self.iterations.max(1) as f64).into(),
            self.contact_share().into(),
            self.nonzeros.into(),
            (1e3 * self.smallest_gap).into(),
            self.unconverged.into(),
            self.frames.into(),
            self.at_fault.into(),
            of_published(|row| row.iterations),
            of_published(|row| row.seconds / row.iterations),
            of_published(|row| row.nonzeros),
        ]
    }

    fn json(&self, task: &Task<'_>) -> Value {
        json!({
            "scene": task.name,
            "bending": task.bending.info().name,
            "variation": variation_name(task.variation),
            "triangles_shown": self.triangles_shown,
            "seconds_by_part": self.parts,
            "error": self.error,
        })
    }
}
