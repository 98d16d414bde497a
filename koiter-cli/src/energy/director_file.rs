//! Directors in JSON: edges by their vertices, so that a file does not depend on how Koiter numbers edges.

use std::path::{Path, PathBuf};

use koiter::energy::bending::ExtraUnknowns;
use koiter::io::{MAX_DATA_BYTES, read_bounded};
use koiter::mesh::{Surface, VertexId};
use serde::Deserialize;
use serde_json::{Value, json};

use crate::failure::Failure;

/// What a file holds; each kind of director may be absent.
#[derive(Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
struct Content {
    edges: Option<Vec<[u32; 2]>>,
    edge_angles: Option<Vec<f64>>,
    edge_points: Option<Vec<[f64; 3]>>,
    vertex_directors: Option<Vec<[f64; 3]>>,
}

/// A file of directors.
#[derive(Debug)]
pub(super) struct DirectorFile {
    path: PathBuf,
    content: Content,
}

impl DirectorFile {
    pub(super) fn read(path: &Path) -> Result<Self, Failure> {
        let wrong = |what: String| Failure::input(format!("{}: {what}", path.display()));
        let bytes = read_bounded(path, MAX_DATA_BYTES)
            .map_err(|error| wrong(format!("cannot read the directors: {error}")))?;
        let help = "koiter energy --help shows the form; --json prints directors in it";
        if !bytes.trim_ascii_start().starts_with(b"{") {
            let form = "{\"edges\": [[u, v], …], \"edge_angles\": […]} or {\"vertex_directors\": [[x, y, z], …]}";
            let what = format!("this is no file of directors: it must hold an object, as {form}");
            return Err(wrong(what).with_help(help));
        }
        let content = serde_json::from_slice(&bytes).map_err(|error| {
            wrong(format!("this is no file of directors: {error}")).with_help(help)
        })?;
        let path = path.to_path_buf();
        Ok(Self { path, content })
    }

    /// The directors as the unknowns of the mesh; `None` if the file has none of this kind.
    pub(super) fn values(
        &self,
        unknowns: ExtraUnknowns,
        surface: &Surface,
    ) -> Result<Option<Vec<f64>>, Failure> {
        let content = &self.content;
        let flat = |points: &[[f64; 3]]| points.as_flattened().to_vec();
        let values = match unknowns {
            ExtraUnknowns::None => None,
            ExtraUnknowns::EdgeAngles => match &content.edge_angles {
                Some(angles) => Some(self.by_edge(surface, angles, 1)?),
                None => None,
            },
            ExtraUnknowns::EdgePoints => match &content.edge_points {
                Some(points) => Some(self.by_edge(surface, &flat(points), 3)?),
                None => None,
            },
            ExtraUnknowns::VertexDirectors => match &content.vertex_directors {
                Some(directors) => Some(self.by_vertex(surface, directors)?),
                None => None,
            },
        };
        if let Some(value) = values.iter().flatten().find(|value| !value.is_finite()) {
            return Err(self.wrong(format!("a director is {value}, which is no number")));
        }
        Ok(values)
    }

    /// That the model asked for has directors of another kind.
    pub(super) fn lacks(&self, unknowns: ExtraUnknowns) -> Failure {
        let key = match unknowns {
            ExtraUnknowns::VertexDirectors => "vertex_directors",
            ExtraUnknowns::EdgePoints => "edge_points",
            _ => "edge_angles",
        };
        self.wrong(format!("there are no {key}, which this model has"))
            .with_help("name a file that holds them, or --directors minimise")
    }

    fn by_edge(&self, surface: &Surface, values: &[f64], size: usize) -> Result<Vec<f64>, Failure> {
        let Some(edges) = &self.content.edges else {
            return Err(self.wrong("there are no edges, [[u, v], …] with u < v".to_owned()));
        };
        let (listed, valued) = (edges.len(), values.len() / size);
        if listed != valued {
            return Err(self.wrong(format!(
                "there are {listed} edges, but directors for {valued}"
            )));
        }
        let mesh = &surface.mesh;
        let mut found = vec![f64::NAN; mesh.num_edges() * size];
        for (k, (&[u, v], value)) in edges.iter().zip(values.chunks_exact(size)).enumerate() {
            let is_pair = u < v && (v as usize) < mesh.num_vertices();
            let edge = is_pair
                .then(|| mesh.find_edge(VertexId(u), VertexId(v)))
                .flatten();
            let Some(edge) = edge else {
                let reason = if u < v {
                    "is no edge of the mesh"
                } else {
                    "must be written as u < v"
                };
                return Err(self.wrong(format!("entry {k}: [{u}, {v}] {reason}")));
            };
            let place = edge.0 as usize * size;
            if !found[place].is_nan() {
                return Err(self.wrong(format!("entry {k}: edge [{u}, {v}] occurs twice")));
            }
            found[place..place + size].copy_from_slice(value);
        }
        match found.iter().position(|value| value.is_nan()) {
            Some(place) if listed < mesh.num_edges() => {
                let [u, v] = mesh.edges()[place / size];
                Err(self.wrong(format!(
                    "edge [{u}, {v}] of the mesh is missing: it has {} edges, the file {listed}",
                    mesh.num_edges()
                )))
            }
            _ => Ok(found),
        }
    }

    /// Unit vectors; lengths are made 1, as all models have them.
    fn by_vertex(&self, surface: &Surface, directors: &[[f64; 3]]) -> Result<Vec<f64>, Failure> {
        let (listed, vertices) = (directors.len(), surface.mesh.num_vertices());
        if listed != vertices {
            let what = format!(
                "there are {listed} vertex directors, but the mesh has {vertices} vertices"
            );
            return Err(self.wrong(what));
        }
        for (v, d) in directors.iter().enumerate() {
            let length = d.iter().map(|x| x * x).sum::<f64>().sqrt();
            // Rounded to six digits it would still pass.
            if !((length - 1.0).abs() < 1e-5) {
                let what =
                    format!("the director of vertex {v} has the length {length}: it must be 1");
                return Err(self.wrong(what));
            }
        }
        Ok(directors.as_flattened().to_vec())
    }

    fn wrong(&self, what: String) -> Failure {
        Failure::input(format!("{}: {what}", self.path.display()))
    }
}

/// Directors in the form of the file.
pub(super) fn json(unknowns: ExtraUnknowns, surface: &Surface, values: &[f64]) -> Value {
    let points = || values.chunks_exact(3).map(|x| json!(x)).collect::<Value>();
    match unknowns {
        ExtraUnknowns::None => Value::Null,
        ExtraUnknowns::EdgeAngles => {
            json!({ "edges": surface.mesh.edges(), "edge_angles": values })
        }
        ExtraUnknowns::EdgePoints => {
            json!({ "edges": surface.mesh.edges(), "edge_points": points() })
        }
        ExtraUnknowns::VertexDirectors => json!({ "vertex_directors": points() }),
    }
}
