//! `koiter energy`: the energies of a mesh under any model.

mod director_file;

use std::path::Path;

use koiter::Vec3;
use koiter::energy::bending::ExtraUnknowns;
use koiter::io::read_mesh;
use koiter::mesh::{Surface, SurfaceOptions, UnreferencedPolicy};
use koiter::scene::measure::{Directors, MeasuredShape, Measurement};
use koiter::scene::model::BendingModel;
use serde_json::{Map, Value, json};

use crate::arguments::{DirectorSource, EnergyArguments, RestCurvature, bending_models};
use crate::failure::Failure;
use crate::output::say;
use director_file::DirectorFile;

/// Measures and prints.
pub(crate) fn energy(arguments: &EnergyArguments) -> Result<(), Failure> {
    let models = bending_models(&arguments.model).map_err(Failure::input)?;
    let deformed = read_surface(&arguments.deformed)?;
    let rest = arguments.rest.as_deref().map(read_surface).transpose()?;
    if let (Some(path), Some(rest)) = (&arguments.rest, &rest) {
        check_same_faces((&arguments.deformed, &deformed), (path, rest))?;
    }
    let curvature = arguments.rest_curvature.unwrap_or(match rest {
        Some(_) => RestCurvature::Mesh,
        None => RestCurvature::Zero,
    });
    let given = match &arguments.directors {
        DirectorSource::File(path) => Some(DirectorFile::read(path)?),
        _ => None,
    };
    let task = Task {
        arguments,
        deformed: &deformed,
        rest_positions: rest
            .as_ref()
            .map_or(&deformed.positions, |rest| &rest.positions),
        rest_curved: curvature == RestCurvature::Mesh,
        given,
    };
    // The membrane does not depend on the bending model.
    let membrane = task.measure(BendingModel::None, &Directors::Minimise)?;
    let mut results = Vec::new();
    for model in &models {
        let (directors, from) = task.directors(*model, models.len() == 1)?;
        results.push((model.info().name, from, task.measure(*model, &directors)?));
    }
    if arguments.json {
        say!("{}", task.json(&membrane, &results));
        return Ok(());
    }
    say!("model       energy [J]    directors");
    say!("membrane    {:<12.6e}", membrane.energies().membrane);
    for (name, from, shape) in &results {
        let energy = match shape.is_admissible() {
            true => format!("{:.6e}", shape.energies().bending),
            false => "not defined at these directors".to_owned(),
        };
        say!("{name:10}  {energy:<12}  {from}");
    }
    Ok(())
}

struct Task<'a> {
    arguments: &'a EnergyArguments,
    deformed: &'a Surface,
    rest_positions: &'a [Vec3],
    rest_curved: bool,
    given: Option<DirectorFile>,
}

impl Task<'_> {
    /// How the directors of a model are found, and in a word for people.
    fn directors(
        &self,
        model: BendingModel,
        is_only: bool,
    ) -> Result<(Directors, &'static str), Failure> {
        let unknowns = model.info().unknowns;
        if unknowns == ExtraUnknowns::None {
            return Ok((Directors::Minimise, ""));
        }
        match (&self.arguments.directors, &self.given) {
            (DirectorSource::Zero, _) => Ok((Directors::Zero, "zero")),
            (DirectorSource::File(_), Some(file)) => match file.values(unknowns, self.deformed)? {
                Some(values) => Ok((Directors::Given(values), "given")),
                None if is_only => Err(file.lacks(unknowns)),
                None => Ok((Directors::Minimise, "minimised")),
            },
            _ => Ok((Directors::Minimise, "minimised")),
        }
    }

    fn measure(
        &self,
        model: BendingModel,
        directors: &Directors,
    ) -> Result<MeasuredShape, Failure> {
        let measurement = Measurement {
            deformed: self.deformed,
            rest_positions: self.rest_positions,
            rest_curved: self.rest_curved,
            model,
            thickness: self.arguments.thickness,
            youngs_modulus: self.arguments.young,
            poissons_ratio: self.arguments.poisson,
        };
        let name = model.info().name;
        (measurement.prepare(directors)).map_err(|error| Failure::run(format!("{name}: {error}")))
    }

    fn json(
        &self,
        membrane: &MeasuredShape,
        results: &[(&'static str, &'static str, MeasuredShape)],
    ) -> Value {
        let mut stvk = json!({ "energy": membrane.energies().membrane });
        if self.arguments.gradient {
            stvk["gradient"] = points(&membrane.gradient().membrane);
        }
        let mut bending = Map::new();
        for (name, from, shape) in results {
            let measured = shape.energies();
            // Not finite, so null, where BAC is not defined.
            let energy = if shape.is_admissible() {
                measured.bending
            } else {
                f64::INFINITY
            };
            let mut entry = json!({ "energy": energy });
            let unknowns = (BendingModel::ALL.into_iter())
                .find(|model| model.info().name == *name)
                .map_or(ExtraUnknowns::None, |model| model.info().unknowns);
            if self.arguments.gradient {
                let gradient = shape.gradient();
                entry["gradient"] = points(&gradient.bending);
                if unknowns != ExtraUnknowns::None {
                    entry["director_gradient"] = nodes(unknowns, &gradient.directors);
                }
            }
            if unknowns != ExtraUnknowns::None {
                entry["directors"] =
                    director_file::json(unknowns, self.deformed, &measured.directors);
                entry["directors_from"] = json!(from);
            }
            bending.insert((*name).to_owned(), entry);
        }
        json!({ "membrane": { "stvk": stvk }, "bending": bending })
    }
}

fn points(points: &[Vec3]) -> Value {
    points.iter().map(|x| json!([x.x, x.y, x.z])).collect()
}

/// Values of nodes of one or three unknowns.
fn nodes(unknowns: ExtraUnknowns, values: &[f64]) -> Value {
    match unknowns.node_size() {
        1 => json!(values),
        _ => values.chunks_exact(3).map(|x| json!(x)).collect(),
    }
}

/// Vertices keep the numbers of the file, so none may be left out.
fn read_surface(path: &Path) -> Result<Surface, Failure> {
    let options = SurfaceOptions {
        unreferenced: UnreferencedPolicy::Refuse,
        ..SurfaceOptions::default()
    };
    let mesh = read_mesh(path).map_err(Failure::input)?;
    mesh.into_surface(options).map_err(Failure::input)
}

fn check_same_faces(
    (deformed_path, deformed): (&Path, &Surface),
    (rest_path, rest): (&Path, &Surface),
) -> Result<(), Failure> {
    let (a, b) = (deformed_path.display(), rest_path.display());
    let advice = "the rest shape must be the same mesh with other positions: same faces, same corners, same order";
    let refuse = |what: String| Err(Failure::input(what).with_help(advice));
    if deformed.mesh.num_vertices() != rest.mesh.num_vertices() {
        let counts = [deformed, rest].map(|surface| surface.mesh.num_vertices());
        return refuse(format!(
            "{a} has {} vertices, but {b} has {}",
            counts[0], counts[1]
        ));
    }
    let (faces, rest_faces) = (deformed.mesh.faces(), rest.mesh.faces());
    if faces.len() != rest_faces.len() {
        return refuse(format!(
            "{a} has {} faces, but {b} has {}",
            faces.len(),
            rest_faces.len()
        ));
    }
    match faces
        .iter()
        .zip(rest_faces)
        .position(|(face, other)| face != other)
    {
        Some(k) => refuse(format!(
            "face {k} (counted from 0) has the vertices {:?} in {a}, but {:?} in {b}",
            faces[k], rest_faces[k]
        )),
        None => Ok(()),
    }
}
