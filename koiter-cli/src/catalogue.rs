//! `koiter materials`, `koiter models`, `koiter schema`: what there is.

use koiter::material::presets;
use koiter::scene::json_schema;
use koiter::scene::model::{BendingModel, MaterialModel, MembraneModel};
use serde_json::{Value, json};

use crate::arguments::CatalogueArguments;
use crate::failure::Failure;
use crate::output::say;

/// Lists the materials.
pub(crate) fn materials(arguments: &CatalogueArguments) -> Result<(), Failure> {
    if arguments.json {
        say!("{}", materials_json());
        return Ok(());
    }
    say!("material         young [Pa]  poisson  density [kg/m³]  thickness [m]  source");
    for preset in presets::ALL {
        say!(
            "{:16} {:<10.2e}  {:<7}  {:<15}  {:<13.1e}  {}",
            preset.name,
            preset.youngs_modulus,
            preset.poissons_ratio,
            preset.density,
            preset.thickness,
            preset.source
        );
        if !preset.remark.is_empty() {
            say!("{:16} {}", "", preset.remark);
        }
    }
    say!(
        "none is the default: each shell names its own, as material = \"cotton\"; numbers replace single values,"
    );
    say!("as material = {{ preset = \"cotton\", young = 2e6 }}.");
    say!("");
    say!("model                what it is; source");
    for model in MaterialModel::ALL {
        let info = model.info();
        let remark = match model == MaterialModel::default() {
            true => " (the default)",
            false => "",
        };
        say!("{:20} {}{remark}", info.name, info.what);
        say!("{:20} {}", "", info.source);
    }
    say!(
        "a shell names its model, as material = {{ preset = \"latex-rubber\", model = \"neo-hookean\" }}. Sources: docs/references.bib"
    );
    Ok(())
}

fn materials_json() -> Value {
    let all = presets::ALL.map(|preset| {
        json!({
            "name": preset.name,
            "young": preset.youngs_modulus,
            "poisson": preset.poissons_ratio,
            "density": preset.density,
            "thickness": preset.thickness,
            "remark": preset.remark,
            "source": preset.source,
        })
    });
    let models = MaterialModel::ALL.map(|model| {
        let info = model.info();
        json!({
            "name": info.name,
            "what": info.what,
            "keys": info.keys,
            "source": info.source,
        })
    });
    json!({
        "materials": all,
        "default": Value::Null,
        "models": models,
        "default_model": MaterialModel::default().info().name,
    })
}

/// Lists the bending models and the membranes.
pub(crate) fn models(arguments: &CatalogueArguments) -> Result<(), Failure> {
    if arguments.json {
        say!("{}", models_json());
        return Ok(());
    }
    let default = BendingModel::default();
    say!("model     unknowns          what it is; source");
    for model in BendingModel::ALL {
        let info = model.info();
        let unknowns = info.unknowns.name();
        let remark = if model == default {
            " (the default)"
        } else {
            ""
        };
        say!("{:9} {unknowns:16}  {}{remark}", info.name, info.what);
        if !info.source.is_empty() {
            say!("{:27} {}", "", info.source);
        }
    }
    say!(
        "a shell names its model, as bending = \"dcs\". Unknowns are those beside the positions of the vertices."
    );
    say!("");
    say!("membrane         what it is; source");
    for model in MembraneModel::ALL {
        let info = model.info();
        let remark = match model == MembraneModel::default() {
            true => " (the default)",
            false => "",
        };
        say!("{:16} {}{remark}", info.name, info.what);
        say!("{:16} {}", "", info.source);
    }
    say!(
        "a shell names its membrane, as membrane = \"discrete-shells\"; stiffnesses other than the material's, and weights of \
         hinges, stand in its table discrete_shells. Sources: docs/references.bib"
    );
    Ok(())
}

fn models_json() -> Value {
    let all = BendingModel::ALL.map(|model| {
        let info = model.info();
        json!({
            "name": info.name,
            "what": info.what,
            "unknowns": info.unknowns.name(),
            "source": (!info.source.is_empty()).then_some(info.source),
        })
    });
    let membranes = MembraneModel::ALL.map(|model| {
        let info = model.info();
        json!({
            "name": info.name,
            "what": info.what,
            "keys": info.keys,
            "source": info.source,
        })
    });
    json!({
        "models": all,
        "default": BendingModel::default().info().name,
        "membranes": membranes,
        "default_membrane": MembraneModel::default().info().name,
    })
}

/// Prints the JSON Schema of scene files.
pub(crate) fn schema() -> Result<(), Failure> {
    let text = serde_json::to_string_pretty(&json_schema()).map_err(Failure::run)?;
    say!("{text}");
    Ok(())
}
