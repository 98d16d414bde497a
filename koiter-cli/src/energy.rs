//! `koiter energy`: the energies of a mesh under any model.

mod director_file;
mod report;

use std::path::Path;

use koiter::Vec3;
use koiter::energy::bending::ExtraUnknowns;
use koiter::io::read_mesh;
use koiter::mesh::{Surface, SurfaceOptions, UnreferencedPolicy};
use koiter::scene::measure::{Directors, MeasuredShape, Measurement};
use koiter::scene::model::BendingModel;

use crate::arguments::{DirectorSource, EnergyArguments, RestCurvature, bending_models};
use crate::failure::Failure;
use crate::output::{say, say_error};
use director_file::DirectorFile;
use report::Row;

/// Powers of lengths [m] up to the eighth are numbers up to this, and from one over it on.
const LARGEST_LENGTH: f64 = 1e30;

/// Points of edges are at a minimum where their gradient [N] is smaller than this share of that of the positions.
const AT_MINIMUM: f64 = 1e-3;

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
    // The membrane does not depend on the bending model. Without a membrane there is no rest shape either.
    let membrane = (task.measurement(BendingModel::None))
        .prepare(&Directors::Minimise)
        .map_err(Failure::input)?;
    let mut rows = Vec::new();
    for model in &models {
        rows.push(task.row(*model, models.len() == 1)?);
    }
    if arguments.json {
        let json = report::json(&deformed, &membrane, &rows, arguments.gradient);
        say!("{json}");
    } else {
        say!("{}", report::text(&membrane, &rows));
    }
    missing(&rows, &arguments.model)
}

/// Says which models have no energy here; a failure if one of them was asked for by name and not by `all`.
fn missing(rows: &[Row], asked: &[String]) -> Result<(), Failure> {
    let mut named = Vec::new();
    for row in rows {
        let (name, Err(reason)) = (row.model.info().name, &row.shape) else {
            continue;
        };
        if asked.iter().any(|asked| asked == name) {
            named.push(format!("{name}: {reason}"));
        } else {
            say_error!("warning: {name}: {reason}");
        }
    }
    match named.is_empty() {
        true => Ok(()),
        false => Err(Failure::run(named.join("\n"))),
    }
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

    /// Measures a model, and says what it does not do.
    fn row(&self, model: BendingModel, is_only: bool) -> Result<Row, Failure> {
        let (directors, directors_from) = self.directors(model, is_only)?;
        let measurement = self.measurement(model);
        if let Some((caveat, help)) = measurement.caveat() {
            say_error!("warning: {caveat}; {help}");
        }
        let unknowns = model.info().unknowns;
        let shape = match measurement.prepare(&directors) {
            Ok(shape) if !shape.is_admissible() => Err(not_defined(&directors, unknowns)),
            Ok(shape) if !shape.energies().bending.is_finite() => {
                Err("its energy is not a number: thickness or moduli are too large".into())
            }
            Ok(shape) => Ok(shape),
            Err(error) => Err(error.to_string()),
        };
        let is_short = |shape: &MeasuredShape| {
            let gradient = shape.gradient();
            let of_points = gradient.directors.iter().map(|g| g * g).sum::<f64>();
            let of_positions = gradient
                .bending
                .iter()
                .map(|g| g.norm_squared())
                .sum::<f64>();
            of_points > AT_MINIMUM.powi(2) * of_positions
        };
        let directors_from = match (&directors, &shape) {
            (Directors::Minimise, Ok(shape))
                if unknowns == ExtraUnknowns::EdgePoints && is_short(shape) =>
            {
                "short of a minimum"
            }
            _ => directors_from,
        };
        Ok(Row {
            model,
            directors_from,
            shape,
        })
    }

    fn measurement(&self, model: BendingModel) -> Measurement<'_> {
        Measurement {
            deformed: self.deformed,
            rest_positions: self.rest_positions,
            rest_curved: self.rest_curved,
            model,
            thickness: self.arguments.thickness,
            youngs_modulus: self.arguments.young,
            poissons_ratio: self.arguments.poisson,
        }
    }
}

/// Why an energy is not defined: tangents end at right angles.
fn not_defined(directors: &Directors, unknowns: ExtraUnknowns) -> String {
    match (directors, unknowns) {
        (Directors::Minimise, _) | (_, ExtraUnknowns::None) => {
            "the energy is not defined on this shape: a fold is closed, and its faces lie on each other; open it"
        }
        _ => {
            "the energy is not defined at these directors: one of them is turned by a right angle or more off the normal \
             of a face; give directors nearer to the normals, or write --directors minimise"
        }
    }
    .to_owned()
}

/// Vertices keep the numbers of the file, so none may be left out.
fn read_surface(path: &Path) -> Result<Surface, Failure> {
    let options = SurfaceOptions {
        unreferenced: UnreferencedPolicy::Refuse,
        ..SurfaceOptions::default()
    };
    let mesh = read_mesh(path).map_err(Failure::mesh)?;
    let surface = mesh.into_surface(options).map_err(Failure::mesh)?;
    let largest = (surface.positions.iter()).fold(0.0, |m: f64, x| m.max(x.amax()));
    let shortest = surface.shortest_edge_length();
    if largest > LARGEST_LENGTH || shortest < 1.0 / LARGEST_LENGTH {
        return Err(Failure::input(format!(
            "{}: coordinates up to {largest:e} m and edges from {shortest:e} m are beyond what numbers hold; lengths are in metres",
            path.display()
        )));
    }
    Ok(surface)
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
