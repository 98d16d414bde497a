//! `koiter modes`: how the structure of a scene vibrates and buckles.

use std::path::Path;

use koiter::Vec3;
use koiter::io::write::{MeshWithFields, write_ply};
use koiter::scene::model::IntegratorKind;
use koiter::scene::{Scene, Simulation};
use serde_json::json;

use crate::arguments::ModesArguments;
use crate::failure::Failure;
use crate::output::say;
use crate::output_path;
use crate::run::start;
use crate::scene_source::load;

/// Largest displacement of a written shape, over the extent of the structure.
const DRAWN: f64 = 0.1;

/// What is found, whichever kind of mode it is.
struct Found {
    /// Hz, or the factor of the loads.
    value: f64,
    /// ω² [1/s²] of a vibration.
    omega_squared: Option<f64>,
    /// Whether the state resists the motion: not where ω² < 0.
    is_stable: bool,
    shape: Vec<f64>,
}

/// Computes, prints and writes shapes.
pub(crate) fn modes(arguments: &ModesArguments) -> Result<(), Failure> {
    if let Some(folder) = &arguments.shapes {
        output_path::make_folder(folder)?;
    }
    let loaded = load(&arguments.scene)?;
    if loaded.scene.model.shells.is_empty() {
        let message = "the scene has no [[shell]], and modes are those of elastic shells";
        return Err(Failure::input(message)
            .with_help("Bézier shells and double layers are stepped, not linearised as a whole"));
    }
    let mut simulation = start(&loaded.scene.model, None)?;
    let count = arguments.count.min(simulation.masses().len());
    let found: Vec<Found> = if arguments.buckling {
        let time = arguments.at.unwrap_or_else(|| last_load(&loaded.scene));
        let modes = simulation.buckling_modes(time, count);
        let modes = modes.map_err(Failure::run)?.into_iter();
        modes
            .map(|mode| Found {
                value: mode.load_factor,
                omega_squared: None,
                is_stable: true,
                shape: mode.shape,
            })
            .collect()
    } else {
        let modes = simulation.vibration_modes(count).map_err(Failure::run)?;
        let modes = modes.into_iter().map(|mode| Found {
            value: mode.frequency(),
            omega_squared: Some(mode.omega_squared),
            is_stable: mode.omega_squared >= 0.0,
            shape: mode.shape,
        });
        modes.collect()
    };
    if let Some(folder) = &arguments.shapes {
        for (number, mode) in (1..).zip(&found) {
            write_shape(&simulation, &mode.shape, &folder.join(file_name(number)))?;
        }
    }
    print(arguments, &found);
    Ok(())
}

/// The time of the largest loads that a scene plans: its end, or the last load factor of a path.
fn last_load(scene: &Scene) -> f64 {
    match scene.model.integrator {
        IntegratorKind::ArcLength => scene.model.solver.last_load_factor,
        _ => scene.timeline.time(scene.timeline.num_steps()),
    }
}

fn file_name(number: usize) -> String {
    format!("mode-{number}.ply")
}

fn print(arguments: &ModesArguments, found: &[Found]) {
    let (key, heading) = match arguments.buckling {
        true => ("load_factor", "factor of the loads"),
        false => ("frequency", "frequency [Hz]"),
    };
    if arguments.json {
        let rows = (1..).zip(found).map(|(number, mode): (usize, _)| {
            let file = (arguments.shapes.as_ref()).map(|_| file_name(number));
            let mut row = json!({ key: mode.value, "stable": mode.is_stable, "shape": file });
            if let Some(square) = mode.omega_squared {
                row["omega_squared"] = json!(square);
            }
            row
        });
        say!("{}", json!({ "modes": rows.collect::<Vec<_>>() }));
        return;
    }
    say!("mode  {heading}");
    for (number, mode) in (1..).zip(found) {
        let number: usize = number;
        match mode.is_stable {
            true => say!("{number:>4}  {:.6}", mode.value),
            false => say!("{number:>4}  the state is not stable along it"),
        }
    }
    if found.is_empty() {
        say!("none: these loads do not buckle the structure");
    }
}

/// The shells moved along a mode, as far as shows.
fn write_shape(simulation: &Simulation, shape: &[f64], path: &Path) -> Result<(), Failure> {
    let (mut positions, mut motion, mut faces) = (Vec::new(), Vec::new(), Vec::new());
    for (index, shell) in simulation.model().shells.iter().enumerate() {
        let first = positions.len() as u32;
        positions.extend(simulation.shell_positions(index));
        motion.extend(simulation.shell_motion(index, shape));
        let shell_faces = shell.surface.mesh.faces().iter();
        faces.extend(shell_faces.map(|face| face.map(|vertex| vertex + first)));
    }
    let (low, high) = positions
        .iter()
        .fold((positions[0], positions[0]), |(low, high), x: &Vec3| {
            (low.inf(x), high.sup(x))
        });
    let largest = motion.iter().map(Vec3::norm).fold(0.0, f64::max);
    let scale = match largest > 0.0 {
        true => DRAWN * (high - low).norm() / largest,
        false => 0.0,
    };
    for (position, step) in positions.iter_mut().zip(&motion) {
        *position += scale * step;
    }
    let mesh = MeshWithFields {
        positions: &positions,
        faces: &faces,
        ..MeshWithFields::default()
    };
    write_ply(path, &mesh).map_err(Failure::export)
}
