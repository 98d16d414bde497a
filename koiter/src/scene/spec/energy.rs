//! `[[energy]]`: an energy, or a force that depends on velocity, as a text; and what of it can be checked without a mesh.

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::fmt;

use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::Deserialize;
use serde::de::{Deserializer, Error, SeqAccess, Visitor};

use super::check::{Checked, all_finite, check_schedule, check_select, check_shell_name, error};
use super::{ENERGY_NAMES, SceneSpec, SelectSpec};
use crate::energy::expression::{ElementKind, ExpressionError, Names, is_of_shape};
use crate::scene::document::suggest;
use crate::scene::error::{SceneError, SceneErrorKind as Kind};
use crate::scene::expressions::{TextEnergy, TextValue};
use crate::scene::model::IntegratorKind;
use crate::scene::schedule::Schedule;

/// `[[energy]]`: exactly one of `energy`, `density`, `dissipation` and `dissipation_density`.
///
/// Each is an expression of quantities of an element, parameters, `time` and `pi`, with + - * / ^, functions such as `sqrt`,
/// `abs`, `min`, and definitions before it: `u = …; u^2`.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct EnergySpec {
    /// Name, unique among the energies: under it the energy is listed in the figures of a step.
    pub name: String,
    /// The shell.
    pub shell: String,
    /// Elements over which it is summed.
    pub on: ElementKind,
    /// Only elements with all their vertices (of hinges: both ends of the edge) among these; default: all.
    #[serde(default)]
    pub select: Option<SelectSpec>,
    /// Energy of an element [J].
    #[serde(default)]
    pub energy: Option<String>,
    /// Energy by rest area [J/m²] of a face, or of a vertex, which has a third of its faces; by rest length [J/m] of an edge
    /// or hinge.
    #[serde(default)]
    pub density: Option<String>,
    /// Dissipation function of an element [W]: the force is minus its derivative by the velocity `vx`, `vy`, `vz`; all other
    /// quantities are those at the start of the step. Acts in dynamics only.
    #[serde(default)]
    pub dissipation: Option<String>,
    /// Dissipation function by rest area [W/m²] or rest length [W/m].
    #[serde(default)]
    pub dissipation_density: Option<String>,
    /// Numbers by name, or schedules over time, that the expression may name.
    #[serde(default)]
    pub parameters: BTreeMap<String, ParameterSpec>,
}

/// A number, or a list of pairs `[time, value]`.
#[derive(Clone, Debug, PartialEq)]
pub struct ParameterSpec(pub Schedule<f64>);

impl ParameterSpec {
    /// Whether it never changes.
    fn is_constant(&self) -> bool {
        self.0.times.len() == 1
    }
}

impl<'de> Deserialize<'de> for ParameterSpec {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Given;
        impl<'de> Visitor<'de> for Given {
            type Value = ParameterSpec;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a number or a list of pairs [time, value]")
            }

            fn visit_f64<E: Error>(self, value: f64) -> Result<ParameterSpec, E> {
                Ok(ParameterSpec(Schedule {
                    times: vec![0.0],
                    values: vec![value],
                }))
            }

            fn visit_i64<E: Error>(self, value: i64) -> Result<ParameterSpec, E> {
                self.visit_f64(value as f64)
            }

            fn visit_u64<E: Error>(self, value: u64) -> Result<ParameterSpec, E> {
                self.visit_f64(value as f64)
            }

            fn visit_seq<A: SeqAccess<'de>>(self, mut list: A) -> Result<ParameterSpec, A::Error> {
                let (mut times, mut values) = (Vec::new(), Vec::new());
                while let Some((time, value)) = list.next_element::<(f64, f64)>()? {
                    times.push(time);
                    values.push(value);
                }
                Ok(ParameterSpec(Schedule { times, values }))
            }
        }
        deserializer.deserialize_any(Given)
    }
}

impl JsonSchema for ParameterSpec {
    fn inline_schema() -> bool {
        true
    }

    fn schema_name() -> Cow<'static, str> {
        "Parameter".into()
    }

    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        let schedule = generator.subschema_for::<Vec<(f64, f64)>>();
        json_schema!({ "anyOf": [{ "type": "number" }, schedule] })
    }
}

impl EnergySpec {
    /// The keys that say what sort of energy it is, with their texts: exactly one in a sound scene.
    fn given(&self) -> Vec<(&'static str, &str, TextValue)> {
        let kind = |is_dissipation, is_density| TextValue {
            is_dissipation,
            is_density,
        };
        let all = [
            ("energy", &self.energy, kind(false, false)),
            ("density", &self.density, kind(false, true)),
            ("dissipation", &self.dissipation, kind(true, false)),
            (
                "dissipation_density",
                &self.dissipation_density,
                kind(true, true),
            ),
        ];
        let given = all
            .into_iter()
            .filter_map(|(key, text, value)| text.as_deref().map(|text| (key, text, value)));
        given.collect()
    }

    /// As the model has it, all elements of the shell with this index.
    pub(in crate::scene) fn to_text_energy(&self, shell: usize) -> Option<TextEnergy> {
        let (_, text, value) = *self.given().first()?;
        let parameters = self.parameters.iter();
        Some(TextEnergy {
            name: self.name.clone(),
            shell,
            on: self.on,
            value,
            text: text.to_owned(),
            parameters: parameters
                .map(|(name, parameter)| (name.clone(), parameter.0.clone()))
                .collect(),
            vertices: None,
        })
    }

    /// Whether probes can measure it: dissipation functions store nothing.
    pub(super) fn is_stored(&self) -> bool {
        self.energy.is_some() || self.density.is_some()
    }
}

/// Names of velocities.
const VELOCITIES: [&str; 3] = ["vx", "vy", "vz"];

/// Names that a step lists beside those of energies.
const OTHER_NAMES: [&str; 2] = ["friction", "damping"];

/// Checks one energy.
pub(super) fn check_energy(energy: &EnergySpec, spec: &SceneSpec) -> Checked {
    let path = format!("energy.{}", energy.name);
    let at = |key: &str| format!("{path}.{key}");
    if ENERGY_NAMES.contains(&&*energy.name) || OTHER_NAMES.contains(&&*energy.name) {
        let message = format!("'{}' is the name of a built-in energy", energy.name);
        return Err(error(Kind::Conflict, &at("name"), message).with_help("choose another name"));
    }
    check_shell_name(&at("shell"), &energy.shell, spec)?;
    let (key, value) = match energy.given()[..] {
        [(key, _, value)] => (key, value),
        [] => {
            return Err(error(
                Kind::MissingKey,
                &path,
                "the energy has no expression".into(),
            )
            .with_help("give exactly one of energy, density, dissipation, dissipation_density"));
        }
        [(first, ..), (second, ..), ..] => {
            let message = format!("'{first}' and '{second}' are two energies");
            return Err(error(Kind::Conflict, &at(second), message)
                .with_help("write an [[energy]] for each"));
        }
    };
    if let Some(select) = &energy.select {
        check_select(&at("select"), select)?;
    }
    check_whole(&path, energy, key)?;
    check_parameters(&path, energy)?;
    let text_energy = energy.to_text_energy(0);
    let program = match text_energy.map(|energy| energy.parse()) {
        Some(Ok(program)) => program,
        Some(Err(mistake)) => return Err(in_text(mistake, &at(key), energy, value)),
        None => return Ok(()),
    };
    check_effect(&at(key), energy, value, program.used())?;
    check_integrators(&at(key), energy, value, program.uses_time(), spec)
}

/// Refuses what depends on nothing that moves, and so is no force.
fn check_effect(path: &str, energy: &EnergySpec, value: TextValue, used: &[bool]) -> Checked {
    let names = energy.on.rate_names();
    let counts = |name: &str| match value.is_dissipation {
        true => VELOCITIES.contains(&name),
        false => is_of_shape(name),
    };
    let mut named = names.iter().zip(used).filter(|(_, used)| **used);
    if named.any(|(name, _)| counts(name)) {
        return Ok(());
    }
    let (message, help) = match value.is_dissipation {
        true => (
            "the dissipation names no velocity, so it is no force",
            "name vx, vy or vz; what depends on the shape alone is an 'energy' or a 'density'",
        ),
        false => (
            "the energy names nothing that changes with the shape, so it is no force",
            "name a quantity that does, such as z, length, angle or area",
        ),
    };
    Err(error(Kind::Conflict, path, message.to_owned()).with_help(help))
}

/// What a whole shell does not have.
fn check_whole(path: &str, energy: &EnergySpec, key: &str) -> Checked {
    if energy.on != ElementKind::Shell {
        return Ok(());
    }
    let at = |key: &str| format!("{path}.{key}");
    if key != "energy" {
        let message = format!("an energy of a whole shell is given by 'energy', not by '{key}'");
        return Err(error(Kind::Conflict, &at(key), message)
            .with_help("on = \"face\" sums a density, or a dissipation, over faces"));
    }
    match energy.select {
        Some(_) => {
            let message = "an energy of a whole shell takes no 'select'".to_owned();
            Err(error(Kind::Conflict, &at("select"), message))
        }
        None => Ok(()),
    }
}

fn check_parameters(path: &str, energy: &EnergySpec) -> Checked {
    let quantities = energy.on.rate_names();
    let names = Names {
        quantities: &quantities,
        parameters: &[],
    };
    for (name, ParameterSpec(schedule)) in &energy.parameters {
        let path = format!("{path}.parameters.{name}");
        if let Err(message) = names.check_new(name) {
            return Err(error(
                Kind::Conflict,
                &path,
                format!("the parameter {message}"),
            ));
        }
        check_schedule(&path, schedule)?;
        all_finite(&path, &schedule.times)?;
        all_finite(&path, &schedule.values)?;
    }
    Ok(())
}

/// A mistake in an expression, at its key.
fn in_text(
    mistake: ExpressionError,
    path: &str,
    energy: &EnergySpec,
    value: TextValue,
) -> SceneError {
    let kind = match mistake.unknown_name {
        Some(_) => Kind::UnknownName,
        None => Kind::Syntax,
    };
    let refused = error(kind, path, mistake.to_string());
    let help = match mistake.unknown_name.as_deref() {
        Some(name) if VELOCITIES.contains(&name) && !value.is_dissipation => {
            Some("velocities are for 'dissipation' and 'dissipation_density'".to_owned())
        }
        Some(name) if !mistake.message.contains("function") => {
            let mut known = match value.is_dissipation {
                true => energy.on.rate_names(),
                false => energy.on.names().to_vec(),
            };
            known.extend(energy.parameters.keys().map(String::as_str));
            known.extend(["time", "pi"]);
            Some(suggest(name, &known))
        }
        Some(name) => {
            let known = crate::energy::expression::FUNCTIONS.map(|known| known.name);
            Some(suggest(name, &known))
        }
        None => mistake.help,
    };
    match help {
        Some(help) => refused.with_help(help),
        None => refused,
    }
}

/// What depends on velocity needs motion, what depends on time a time.
fn check_integrators(
    path: &str,
    energy: &EnergySpec,
    value: TextValue,
    uses_time: bool,
    spec: &SceneSpec,
) -> Checked {
    let mut integrators: Vec<IntegratorKind> = (spec.phase.iter())
        .map(|phase| phase.integrator.unwrap_or(spec.integrator))
        .collect();
    if integrators.is_empty() {
        integrators.push(spec.integrator);
    }
    if value.is_dissipation && integrators.iter().all(|kind| !kind.is_dynamic()) {
        let message =
            "a dissipation function acts on velocities, of which there are none in statics";
        return Err(error(Kind::Conflict, path, message.into())
            .with_help("use an integrator of dynamics, or an 'energy' or 'density'"));
    }
    let is_path = integrators.contains(&IntegratorKind::ArcLength);
    let is_linear = integrators.contains(&IntegratorKind::LinearStatic);
    let is_varying = uses_time || !energy.parameters.values().all(ParameterSpec::is_constant);
    if is_path && is_varying {
        let message = "along a path by arc length no time passes for an expression";
        return Err(error(Kind::Conflict, path, message.into())
            .with_help("use constant parameters, or integrator = \"quasi-static\""));
    }
    if (is_path || is_linear) && energy.on == ElementKind::Shell {
        let message = "an energy of a whole shell couples all unknowns, which linear statics and arc length cannot solve for";
        return Err(error(Kind::Conflict, path, message.into())
            .with_help("use integrator = \"quasi-static\""));
    }
    Ok(())
}
