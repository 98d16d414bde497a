//! From a shell as it was typed, with its face file, to its composition.

use crate::Vec3;
use crate::material::{Layer, presets};
use crate::scene::composition_error::CompositionError;
use crate::scene::error::{SceneError, SceneErrorKind as Kind};
use crate::scene::face_file::FaceFile;
use crate::scene::material_models::MaterialModel;
use crate::scene::model::{Composition, FaceValues, MaterialLaw, RestPrescription, Shell};
use crate::scene::placement::MeshSource;
use crate::scene::spec::ShellSpec;

/// The numbers that hold for a shell as a whole; means, where they vary.
pub(super) struct Nominal {
    pub(super) thickness: f64,
    pub(super) density: f64,
    pub(super) youngs_modulus: f64,
    pub(super) poissons_ratio: f64,
}

/// What the shell is made of.
///
/// # Errors
/// A face file that cannot be read.
pub(super) fn compose(
    shell: &ShellSpec,
    source: &dyn MeshSource,
) -> Result<(Nominal, Composition), SceneError> {
    let file = match &shell.faces {
        None => FaceFile::default(),
        Some(name) => read(name, source)
            .map_err(|error| error.inside(&format!("shell.{}.faces", shell.name)))?,
    };
    let law = law(shell);
    let preset = shell.material.preset.as_deref().and_then(presets::find);
    // The checks let no shell through that has neither the number nor a preset.
    let value = |given: Option<f64>, of: fn(&presets::MaterialPreset) -> f64| {
        given.or(preset.map(of)).unwrap_or(f64::NAN)
    };
    let mean = |list: &Option<Vec<f64>>, of_shell: f64| match list {
        Some(list) if !list.is_empty() => list.iter().sum::<f64>() / list.len() as f64,
        _ => of_shell,
    };
    let material = &shell.material;
    let (thickness, youngs_modulus) = match &law {
        MaterialLaw::Layered(layers) => {
            let thickness: f64 = layers.iter().map(|layer| layer.thickness).sum();
            let stiffness = layers.iter().map(|l| l.thickness * l.youngs_modulus);
            (thickness, stiffness.sum::<f64>() / thickness)
        }
        _ => (
            value(shell.thickness, |preset| preset.thickness),
            value(material.young, |preset| preset.youngs_modulus),
        ),
    };
    let density = value(material.density, |preset| preset.density);
    let poissons_ratio = value(material.poisson, |preset| preset.poissons_ratio);
    let nominal = Nominal {
        thickness: mean(&file.thickness, thickness),
        density: mean(&file.density, density),
        youngs_modulus: mean(&file.young, youngs_modulus),
        poissons_ratio: mean(&file.poisson, poissons_ratio),
    };
    let axes = match file.axis {
        Some(axes) => axes.into_iter().map(Vec3::from).collect(),
        None => material.axis.map(Vec3::from).into_iter().collect(),
    };
    let composition = Composition {
        law,
        axes,
        by_face: FaceValues {
            thickness: file.thickness,
            youngs_modulus: file.young,
            poissons_ratio: file.poisson,
            density: file.density,
            across: file.young_across,
            shear: file.shear,
        },
        rest: RestPrescription {
            first: file.first_form,
            second: file.second_form,
            stretch: shell.rest_stretch,
            curvature: shell.rest_curvature,
        },
        stretch_limit: (shell.strain_limit.as_ref())
            .map(|limit| limit.resolve(nominal.youngs_modulus)),
        membrane: shell.membrane,
        damping: (shell.damping.as_ref())
            .map(|damping| damping.resolve())
            .unwrap_or_default(),
        springs: (shell.discrete_shells.as_ref())
            .map(|numbers| numbers.membrane())
            .unwrap_or_default(),
        hinges: (shell.discrete_shells.as_ref())
            .map(|numbers| numbers.hinges())
            .unwrap_or_default(),
    };
    Ok((nominal, composition))
}

/// Refuses a composition that the mesh or the bending model cannot have.
pub(super) fn check(shell: &Shell) -> Result<(), SceneError> {
    let Err(error) = shell.compose() else {
        return Ok(());
    };
    let (kind, key) = match &error {
        CompositionError::Count { .. } | CompositionError::Value { .. } => {
            (Kind::OutOfRange, "faces")
        }
        CompositionError::Layers { .. } => (Kind::Conflict, "faces"),
        CompositionError::Metric { .. } => (Kind::OutOfRange, "faces"),
        CompositionError::Moduli { .. } => (Kind::OutOfRange, "material"),
        CompositionError::Axis { .. } => (Kind::OutOfRange, "material.axis"),
        CompositionError::Rest(_) => (Kind::Mesh, "rest_mesh"),
        CompositionError::Hinges { .. } => (Kind::Conflict, "bending"),
        CompositionError::Springs { .. } => (Kind::Conflict, "membrane"),
    };
    let path = format!("shell.{}.{key}", shell.name);
    let placed = SceneError::new(kind, error.to_string()).inside(&path);
    Err(match error {
        CompositionError::Axis { .. } => {
            placed.with_help("give material.axis = [x, y, z] along the surface")
        }
        CompositionError::Count { .. } => placed.with_help(
            "each list of the file has one value a face, in the order of the mesh's faces; generated meshes change \
             theirs with their cells",
        ),
        _ => placed,
    })
}

fn read(name: &str, source: &dyn MeshSource) -> Result<FaceFile, SceneError> {
    let text = source.read_text(name).map_err(|unreadable| {
        let error = SceneError::new(Kind::Mesh, unreadable.message);
        match unreadable.help {
            Some(help) => error.with_help(help),
            None => error,
        }
    })?;
    FaceFile::parse(name, &text)
}

fn law(shell: &ShellSpec) -> MaterialLaw {
    let material = &shell.material;
    // The checks let no material through without the keys of its model.
    let given = |value: Option<f64>| value.unwrap_or(f64::NAN);
    match material.model {
        MaterialModel::StVenantKirchhoff => MaterialLaw::StVenantKirchhoff,
        MaterialModel::NeoHookean => MaterialLaw::NeoHookean,
        MaterialModel::TensionField => MaterialLaw::TensionField,
        MaterialModel::Orthotropic => MaterialLaw::Orthotropic {
            across: given(material.young_across),
            shear: given(material.shear),
        },
        MaterialModel::Layered => {
            let layers = material.layers.iter().map(|layer| Layer {
                thickness: layer.thickness,
                youngs_modulus: layer.young,
                growth: layer.growth,
            });
            MaterialLaw::Layered(layers.collect())
        }
    }
}
