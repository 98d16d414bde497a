//! Explicit steps of Newmark's method: a rippled sheet with the hinges and the membrane of Discrete Shells.
//!
//! A step evaluates every hinge's gradient once. So hinges times steps over the seconds of a run, everything in it included,
//! is how many gradients of hinges a second are had where they are used; beside it stands what they take alone.

use std::time::Instant;

use koiter::Vec3;
use koiter::integrate::StepReport;
use koiter::mesh::Surface;
use koiter::scene::Simulation;
use koiter::scene::measure::Measurement;
use koiter::scene::model::*;

use super::sheet::{POISSONS_RATIO, THICKNESS, YOUNGS_MODULUS, flat_sheet, posed_positions};
use super::table::{Cell, Table};
use super::{fastest, on_threads, thread_counts};
use crate::arguments::ExplicitArguments;
use crate::failure::Failure;

/// Of cotton [kg/m³].
const DENSITY: f64 = 500.0;

/// Of the time that a wave of stretching takes along the shortest edge: slivers make the longest stable step shorter.
const SHARE_OF_PASSAGE: f64 = 0.1;

/// Hinge gradients a second on one thread, in whole steps: a machine's figure, so no test depends on it.
const AIM: f64 = 3e6;

pub(super) fn bench(options: &ExplicitArguments) -> Result<Table, Failure> {
    let mut table = Table::new(
        "explicit steps with hinges and membrane of Discrete Shells",
        &[
            ("faces", "triangles"),
            ("hinges", "hinges"),
            ("threads", "threads"),
            ("steps", "steps"),
            ("seconds", "s"),
            ("steps_per_second", "steps a second"),
            ("hinge_gradients_per_second", "hinge gradients a second"),
            ("hinges_microseconds", "a step: hinges, µs"),
            ("membrane_microseconds", "membrane and other forces, µs"),
            ("estimate_microseconds", "stable step, µs"),
            ("update_microseconds", "update, energies, angles, µs"),
            (
                "hinge_gradients_alone_per_second",
                "gradients alone, a second",
            ),
            ("verdict", "3 million a second on one thread"),
        ],
    );
    let threads = match &options.threads[..] {
        [] => thread_counts(),
        given => given.to_vec(),
    };
    for &faces in &options.faces {
        let sheet = flat_sheet(faces)?;
        for &count in &threads {
            let run = on_threads(count, || Run::fastest(&sheet, options))??;
            table.push(run.row(&sheet, count, options.steps));
        }
    }
    Ok(table)
}

/// Seconds of all steps.
struct Run {
    hinges: usize,
    total: f64,
    forces: f64,
    estimates: f64,
    /// Of one evaluation of all hinges.
    hinges_alone: f64,
}

impl Run {
    fn fastest(sheet: &Surface, options: &ExplicitArguments) -> Result<Self, Failure> {
        let (hinges, hinges_alone) = hinge_gradients(sheet, options.repeats)?;
        let mut best: Option<Self> = None;
        for _ in 0..options.repeats {
            let mut simulation = Simulation::new(model(sheet)).map_err(Failure::run)?;
            let dt = step(sheet);
            let mut run = Self {
                hinges,
                total: 0.0,
                forces: 0.0,
                estimates: 0.0,
                hinges_alone,
            };
            let clock = Instant::now();
            for _ in 0..options.steps {
                let report = simulation.step(dt).map_err(Failure::step)?;
                run.forces += seconds(&report, "forces");
                run.estimates += seconds(&report, "stable_step");
            }
            run.total = clock.elapsed().as_secs_f64();
            if best.as_ref().is_none_or(|best| run.total < best.total) {
                best = Some(run);
            }
        }
        best.ok_or_else(|| Failure::input("a run needs at least one repetition"))
    }

    fn row(&self, sheet: &Surface, threads: usize, steps: usize) -> Vec<Cell> {
        let a_step = |seconds: f64| Cell::Figure(1e6 * seconds / steps as f64);
        let hinges = self.hinges_alone * steps as f64;
        let update = self.total - self.forces - self.estimates;
        let rate = (self.hinges * steps) as f64 / self.total;
        vec![
            sheet.mesh.num_faces().into(),
            self.hinges.into(),
            threads.into(),
            steps.into(),
            self.total.into(),
            (steps as f64 / self.total).into(),
            rate.into(),
            a_step(hinges),
            a_step(self.forces - hinges),
            a_step(self.estimates),
            a_step(update),
            (self.hinges as f64 / self.hinges_alone).into(),
            match threads {
                1 if rate >= AIM => "reached".into(),
                1 => "missed".into(),
                _ => "–".into(),
            },
        ]
    }
}

fn seconds(report: &StepReport, part: &str) -> f64 {
    let mut parts = report.seconds.iter();
    parts
        .find(|(name, _)| *name == part)
        .map_or(0.0, |(_, s)| *s)
}

/// The number of hinges, and the seconds that all their gradients take.
fn hinge_gradients(sheet: &Surface, repeats: usize) -> Result<(usize, f64), Failure> {
    let deformed = Surface {
        mesh: sheet.mesh.clone(),
        positions: posed_positions(sheet),
    };
    let measurement = Measurement {
        deformed: &deformed,
        rest_positions: &sheet.positions,
        rest_curved: false,
        model: BendingModel::DsTheta,
        thickness: THICKNESS,
        youngs_modulus: YOUNGS_MODULUS,
        poissons_ratio: POISSONS_RATIO,
    };
    let bending = measurement.free_bending().map_err(Failure::run)?;
    let mut gradient = vec![0.0; bending.q.len()];
    let seconds = fastest(10 * repeats, || {
        for energy in &bending.energies {
            std::hint::black_box(energy.add_value_and_gradient(&bending.q, &mut gradient));
        }
    });
    let edge_faces = sheet.mesh.edge_faces().iter();
    Ok((
        edge_faces
            .filter(|faces| faces.iter().all(Option::is_some))
            .count(),
        seconds,
    ))
}

fn step(sheet: &Surface) -> f64 {
    let modulus = YOUNGS_MODULUS / (1.0 - POISSONS_RATIO * POISSONS_RATIO);
    SHARE_OF_PASSAGE * sheet.shortest_edge_length() / (modulus / DENSITY).sqrt()
}

fn model(sheet: &Surface) -> Model {
    let surface = Surface {
        mesh: sheet.mesh.clone(),
        positions: posed_positions(sheet),
    };
    let shell = Shell {
        name: "sheet".into(),
        velocities: vec![Vec3::zeros(); surface.positions.len()],
        rest_positions: sheet.positions.clone(),
        surface,
        rest_curved: false,
        thickness: THICKNESS,
        density: DENSITY,
        youngs_modulus: YOUNGS_MODULUS,
        poissons_ratio: POISSONS_RATIO,
        composition: Composition {
            membrane: MembraneModel::DiscreteShells,
            ..Composition::default()
        },
        bending: BendingModel::DsTheta,
        friction: 0.0,
        contact_offset: 0.0,
    };
    Model {
        shells: vec![shell],
        gravity: Vec3::new(0.0, 0.0, -9.81),
        contact: ContactOptions {
            enabled: false,
            ..ContactOptions::default()
        },
        solver: SolverOptions {
            newmark: NewmarkOptions {
                beta: 0.0,
                ..NewmarkOptions::default()
            },
            ..SolverOptions::default()
        },
        integrator: IntegratorKind::Newmark,
        ..Model::default()
    }
}
