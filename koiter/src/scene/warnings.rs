//! Numbers that can be simulated but are probably a slip of unit.

use super::bending_caveats::bending_caveat;
use super::error::Warning;
use super::free_parts::FreePart;
use super::model::{MembraneModel, Model, Motion, ObstacleShape, Shell};
use super::spec::{MeshSpec, SceneSpec, ShellSpec, Units};

/// Softer than any gel, harder than diamond.
const PLAUSIBLE_YOUNG: [f64; 2] = [1e3, 1e12];
/// Lighter than aerogel, heavier than osmium [kg/m³].
const PLAUSIBLE_DENSITY: [f64; 2] = [1.0, 2.3e4];
/// A shell larger than this [m] is probably in millimetres.
const LARGE: f64 = 100.0;
/// From a file without a unit, a shell larger than this [m] is so already …
const LARGE_FOR_A_FILE: f64 = 5.0;
/// … if it is this many times as large as thick: a roof is thicker, and cloth is smaller.
const LARGE_BY_THICKNESS: f64 = 5e3;
/// A shell smaller than this [m] is probably in a larger unit.
const SMALL: f64 = 1e-4;
/// A turn by more than this in a step [°] brings points 3 % nearer to the axis on the way.
const LARGE_TURN: f64 = 30.0;
/// More than on any planet [m/s²].
const LARGE_GRAVITY: f64 = 1e4;
/// The theory of thin shells and the contact stencils want triangles much larger than the thickness.
const THICKNESS_TO_EDGE: f64 = 0.1;

/// Everything implausible, in the order of the shells; locations are not yet known.
pub(super) fn find(model: &Model, spec: &SceneSpec) -> Vec<Warning> {
    let mut warnings = Vec::new();
    let bezier: Vec<ShellSpec> = spec.bezier_shell.iter().map(|s| s.as_shell()).collect();
    let of_bezier = model.bezier.iter().flat_map(|bezier| &bezier.parts);
    let of_bezier = of_bezier.map(|part| &part.shell).zip(&bezier);
    let all = (model
        .shells
        .iter()
        .zip(&spec.shell)
        .map(|pair| ("shell", pair)))
    .chain(of_bezier.map(|pair| ("bezier_shell", pair)));
    for (table, (shell, typed)) in all {
        let path = format!("{table}.{}", shell.name);
        let preset = typed.material.preset.is_some();
        if !preset || typed.material.young.is_some() {
            warnings.extend(check_young(shell, &path));
        }
        let [low, high] = PLAUSIBLE_DENSITY;
        if !(low..=high).contains(&shell.density) {
            let message = format!("a density of {} kg/m³ is unusual", shell.density);
            let help = "densities are in kg/m³: 1 g/cm³ is 1000; area densities are divided by the thickness";
            warnings.push(warning(message, format!("{path}.material.density"), help));
        }
        warnings.extend(check_size(shell, &path, &typed.mesh));
        warnings.extend(check_thickness(shell, &path));
        warnings.extend(check_bending(shell, &path));
        warnings.extend(check_springs(shell, &path));
    }
    for (obstacle, typed) in model.obstacles.iter().zip(&spec.obstacle) {
        let path = format!("obstacle.{}", typed.name);
        // A ball or the axis of a capsule keeps its shape.
        if matches!(obstacle.shape, ObstacleShape::Mesh(_)) {
            warnings.extend(check_turning(&obstacle.motion, &path, spec));
        }
    }
    for (index, constraint) in model.constraints.iter().enumerate() {
        let path = spec.constraint[index].path(index);
        warnings.extend(check_turning(&constraint.motion, &path, spec));
    }
    if model.gravity.norm() > LARGE_GRAVITY {
        let message = format!("a gravity of {:.2e} m/s² is unusual", model.gravity.norm());
        let help = "on Earth it is 9.81 m/s²";
        warnings.push(warning(message, "gravity".to_owned(), help));
    }
    if !model.has_supports() {
        warnings.extend(model.free_parts().iter().map(free_part));
    }
    warnings
}

/// What turns far in one step is smaller on the way: points move along chords.
fn check_turning(motion: &Motion, path: &str, spec: &SceneSpec) -> Option<Warning> {
    let angle = &motion.rotation.as_ref()?.angle;
    let mut largest = 0.0f64;
    for (times, angles) in angle.times.windows(2).zip(angle.values.windows(2)) {
        let rate = (angles[1] - angles[0]).abs() / (times[1] - times[0]);
        for [start, end, dt] in spec.windows() {
            let common = times[1].min(end) - times[0].max(start);
            largest = largest.max(rate * common.min(dt));
        }
    }
    if largest <= LARGE_TURN.to_radians() {
        return None;
    }
    let message = format!(
        "it turns by up to {:.0}° in a step: on the way, points move along chords, up to {:.0} % nearer to the axis",
        largest.to_degrees(),
        100.0 * (1.0 - (0.5 * largest).cos().max(0.0))
    );
    let help = "take smaller steps (dt), or a longer time for the turn";
    let path = format!("{path}.motion.rotate.degrees");
    Some(warning(message, path, help))
}

fn check_young(shell: &Shell, path: &str) -> Option<Warning> {
    let [low, high] = PLAUSIBLE_YOUNG;
    let young = shell.youngs_modulus;
    let help = if young < low {
        "moduli are in pascals: 1 MPa is 1e6, 1 GPa is 1e9"
    } else if young > high {
        "diamond has 1.2e12 Pa"
    } else {
        return None;
    };
    let message = format!("a Young's modulus of {young:e} Pa is unusual");
    Some(warning(message, format!("{path}.material.young"), help))
}

fn free_part(part: &FreePart) -> Warning {
    let message = format!("nothing holds {part}: there is no static equilibrium, or more than one");
    let help = "add a [[constraint]] that pins some vertices, or let inertia hold it: integrator = \"implicit-euler\"";
    warning(message, format!("shell.{}", part.shell), help)
}

fn check_size(shell: &Shell, path: &str, mesh: &MeshSpec) -> Option<Warning> {
    let (low, high) = shell.surface.bounding_box();
    let size = (high - low).amax();
    let is_in_metres = mesh.units == Units::Metre;
    let is_thin_file = mesh.file.is_some() && size > LARGE_BY_THICKNESS * shell.thickness;
    let large = match is_in_metres && is_thin_file {
        true => LARGE_FOR_A_FILE,
        false => LARGE,
    };
    if (SMALL..=large).contains(&size) {
        return None;
    }
    let help = if size < SMALL {
        "is the unit of the mesh right? Lengths are in metres".to_owned()
    } else if is_in_metres {
        format!(
            "if the file is in millimetres ({} m), write units = \"mm\"",
            match size < 1e6 {
                true => format!("{:.3}", size * 1e-3),
                false => format!("{:.3e}", size * 1e-3),
            }
        )
    } else {
        "is the unit of the mesh right?".to_owned()
    };
    let message = format!("the mesh of shell '{}' is {size:.3e} m large", shell.name);
    Some(warning(message, format!("{path}.mesh"), &help))
}

fn check_thickness(shell: &Shell, path: &str) -> Option<Warning> {
    let edge = shell.surface.mean_edge_length();
    if shell.thickness <= THICKNESS_TO_EDGE * edge {
        return None;
    }
    let message = format!(
        "the thickness of {:.3e} m is more than a tenth of the mean edge, {edge:.3e} m",
        shell.thickness
    );
    let help = "thicknesses are in metres: 1 mm is 1e-3; triangles should be much larger than the thickness";
    Some(warning(message, format!("{path}.thickness"), help))
}

/// A bending model that is not made for this rest shape.
fn check_bending(shell: &Shell, path: &str) -> Option<Warning> {
    let (caveat, help) = bending_caveat(shell)?;
    let message = format!("shell '{}': {caveat}", shell.name);
    Some(warning(message, format!("{path}.bending"), help))
}

/// Springs on edges alone have a Poisson's ratio of 1/3; those on areas can only raise it.
fn check_springs(shell: &Shell, path: &str) -> Option<Warning> {
    let is_of_material = shell.composition.springs.areas.is_none();
    let is_discrete = shell.composition.membrane == MembraneModel::DiscreteShells;
    if !(is_discrete && is_of_material && shell.poissons_ratio < 1.0 / 3.0) {
        return None;
    }
    let message = format!(
        "shell '{}': membrane 'discrete-shells' acts as with a Poisson's ratio of 1/3, not {}",
        shell.name, shell.poissons_ratio
    );
    let help = "shear is as stiff as the material's; membrane = \"koiter\" has any ratio";
    Some(warning(message, format!("{path}.membrane"), help))
}

fn warning(message: String, path: String, help: &str) -> Warning {
    Warning {
        message,
        path,
        location: None,
        help: Some(help.to_owned()),
    }
}
