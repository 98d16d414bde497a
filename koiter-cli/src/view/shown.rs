//! What the page shows: a result folder or a mesh, read piece by piece as the page asks.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, OnceLock, PoisonError, RwLock, RwLockReadGuard, RwLockWriteGuard};
use std::time::SystemTime;

use koiter::io::result::{
    Element, Field, FolderLock, Frame, Hand, Manifest, PartKind, ResultReader, RunRequest,
};
use serde_json::{Value, json};

use super::columns::Columns;
use super::history::{evenly, history};
use super::mesh::Mesh;
use crate::failure::Failure;
use crate::pictures::{color_map, color_range};

/// Frames that are looked at for the range of a field's colours.
const FRAMES_FOR_RANGE: usize = 12;

/// One result or mesh.
#[derive(Debug)]
pub(super) struct Shown {
    pub(super) path: PathBuf,
    content: Content,
}

#[derive(Debug)]
enum Content {
    Mesh(Box<Mesh>),
    Folder(Box<Folder>),
}

#[derive(Debug)]
struct Folder {
    opened: RwLock<Opened>,
    /// What is known of a run that may go on.
    known: Mutex<Known>,
}

#[derive(Debug)]
struct Opened {
    reader: ResultReader,
    /// Looked up once there is a frame.
    fields: OnceLock<Vec<FieldName>>,
}

#[derive(Debug, Default)]
struct Known {
    /// Counts the times that another run replaced the result.
    generation: usize,
    /// When the manifest was written.
    written: Option<SystemTime>,
    /// Of the frames [s]; those that cannot be read are NaN.
    times: Vec<f64>,
    stats: Columns,
    probes: Columns,
}

/// A field that the frames hold.
#[derive(Clone, Debug)]
struct FieldName {
    name: String,
    is_of_vertices: bool,
}

type Answered<T> = Result<T, String>;

impl Shown {
    /// Opens a result folder or reads a mesh.
    pub(super) fn open(path: &Path) -> Result<Self, Failure> {
        let content = if path.is_file() {
            Content::Mesh(Box::new(Mesh::read(path)?))
        } else {
            let reader = ResultReader::open_with_gaps(path).map_err(Failure::result)?;
            refuse_changing_faces(&reader)?;
            let known = Known {
                written: written(path),
                ..Known::default()
            };
            Content::Folder(Box::new(Folder {
                opened: RwLock::new(Opened::new(reader)),
                known: Mutex::new(known),
            }))
        };
        Ok(Self {
            path: path.to_path_buf(),
            content,
        })
    }

    fn with_manifest<T>(&self, look: impl FnOnce(&Manifest) -> T) -> T {
        match &self.content {
            Content::Mesh(mesh) => look(&mesh.manifest),
            Content::Folder(folder) => look(folder.opened().reader.manifest()),
        }
    }

    fn opened(&self) -> Option<RwLockReadGuard<'_, Opened>> {
        match &self.content {
            Content::Mesh(_) => None,
            Content::Folder(folder) => Some(folder.opened()),
        }
    }

    /// What it consists of.
    pub(super) fn info(&self) -> Value {
        let fields: Vec<Value> = (self.fields().iter())
            .map(|field| {
                let (unit, map) = color_map(&field.name);
                let map = format!("{map:?}").to_lowercase();
                let of = if field.is_of_vertices {
                    "vertices"
                } else {
                    "faces"
                };
                json!({ "name": field.name, "unit": unit, "map": map, "of": of })
            })
            .collect();
        self.with_manifest(|manifest| {
            json!({
                "path": self.path.display().to_string(),
                "kind": match self.content { Content::Mesh(_) => "mesh", Content::Folder(_) => "run" },
                "title": manifest.title,
                "version": manifest.version,
                "up_axis": manifest.up_axis,
                "parts": manifest.parts,
                "vertices": manifest.num_vertices(),
                "faces": manifest.num_faces(),
                "fields": fields,
            })
        })
    }

    fn fields(&self) -> Vec<FieldName> {
        self.opened()
            .map_or_else(Vec::new, |opened| opened.fields())
    }

    /// How far it is, and what was asked of its run.
    pub(super) fn state(&self) -> Answered<Value> {
        let Content::Folder(folder) = &self.content else {
            return Ok(json!({ "generation": 0, "times": [0.0], "ended": true, "running": false }));
        };
        let mut known = folder.known.lock().unwrap_or_else(PoisonError::into_inner);
        self.follow(folder, &mut known)?;
        let opened = folder.opened();
        let reader = &opened.reader;
        known.times.truncate(reader.len());
        for index in known.times.len()..reader.len() {
            let time = reader.frame_info(index).map_or(f64::NAN, |info| info.time);
            known.times.push(time);
        }
        let summary = reader.summary().unwrap_or_default();
        let running = FolderLock::is_held(&self.path);
        Ok(json!({
            "generation": known.generation,
            "times": known.times,
            "ended": summary.is_some(),
            "running": running,
            "request": RunRequest::read(&self.path).map(RunRequest::word),
            "playable": running != Some(false) && Hand::read(&self.path).is_some(),
            "summary": summary,
        }))
    }

    /// Counts the frames again, and reads everything again if another run began in the folder.
    fn follow(&self, folder: &Folder, known: &mut Known) -> Answered<()> {
        let now = written(&self.path);
        let mut opened = folder.opened_to_change();
        // A run that goes on writes its manifest anew too; its parts and frames are then the same.
        if now != known.written {
            let anew = ResultReader::open_with_gaps(&self.path).map_err(|e| e.to_string())?;
            let is_other = anew.len() < known.times.len()
                || anew.manifest() != opened.reader.manifest()
                || anew.faces() != opened.reader.faces();
            *opened = Opened::new(anew);
            *known = Known {
                generation: known.generation + usize::from(is_other),
                written: now,
                ..Known::default()
            };
        }
        opened.reader.refresh().map_err(|error| error.to_string())
    }

    /// Corners of the faces.
    pub(super) fn topology(&self) -> Vec<u8> {
        let bytes = |faces: &[[u32; 3]]| {
            faces
                .iter()
                .flatten()
                .flat_map(|v| v.to_le_bytes())
                .collect()
        };
        match &self.content {
            Content::Mesh(mesh) => bytes(&mesh.faces),
            Content::Folder(_) => self
                .opened()
                .map_or_else(Vec::new, |opened| bytes(opened.reader.faces())),
        }
    }

    /// Positions of a frame in single precision, then the values of a field.
    pub(super) fn frame(&self, index: usize, field: Option<usize>) -> Answered<Vec<u8>> {
        let frame = self.read_frame(index)?;
        let coordinates = frame.positions.iter().flat_map(|x| x.iter());
        let mut bytes: Vec<u8> = coordinates
            .flat_map(|&value| (value as f32).to_le_bytes())
            .collect();
        let Some(field) = field else {
            return Ok(bytes);
        };
        let fields = self.fields();
        let field = fields.get(field).ok_or("there is no such field")?;
        match frame.field(&field.name) {
            Some(found) => bytes.extend(found.values.iter().flat_map(|value| value.to_le_bytes())),
            None => {
                let count = self.with_manifest(|manifest| match field.is_of_vertices {
                    true => manifest.num_vertices(),
                    false => manifest.num_faces(),
                });
                bytes.extend((0..count).flat_map(|_| f32::NAN.to_le_bytes()));
            }
        }
        Ok(bytes)
    }

    fn read_frame(&self, index: usize) -> Answered<Frame> {
        match &self.content {
            Content::Mesh(mesh) if index == 0 => Ok(Frame {
                positions: mesh.positions.clone(),
                ..Frame::default()
            }),
            Content::Mesh(_) => Err("a mesh has one frame".to_owned()),
            Content::Folder(_) => {
                let opened = self.opened().ok_or("the result is gone")?;
                opened
                    .reader
                    .frame(index)
                    .map_err(|error| error.to_string())
            }
        }
    }

    /// The range of colours of a field: of some frames, evenly chosen, with the last.
    pub(super) fn range(&self, field: usize) -> Answered<Value> {
        let fields = self.fields();
        let field = fields.get(field).ok_or("there is no such field")?;
        let opened = self.opened().ok_or("a mesh has no fields")?;
        let reader = &opened.reader;
        let parts = &reader.manifest().parts;
        let shells = parts.iter().filter(|part| part.kind == PartKind::Shell);
        let ranges: Vec<_> = shells
            .map(|part| match field.is_of_vertices {
                true => part.vertices.clone(),
                false => part.faces.clone(),
            })
            .collect();
        let mut values = Vec::new();
        for index in evenly(reader.len(), FRAMES_FOR_RANGE) {
            // What cannot be read is told where it is shown.
            let Ok(frame) = reader.frame(index) else {
                continue;
            };
            let Some(found) = frame.field(&field.name) else {
                continue;
            };
            for range in &ranges {
                values.extend(
                    found.values[range.clone()]
                        .iter()
                        .map(|&value| f64::from(value)),
                );
            }
        }
        let (low, high) = color_range(values).unwrap_or((0.0, 1.0));
        Ok(json!({ "low": low, "high": high }))
    }

    /// A vertex or face over time.
    pub(super) fn history(&self, element: Element) -> Answered<Value> {
        let opened = self.opened().ok_or("a mesh has no history")?;
        history(&opened.reader, element)
    }

    /// The figures of the steps, a list a column.
    pub(super) fn stats(&self) -> Answered<Value> {
        self.columns(|known, path| {
            known.stats.read_json_lines(&path.join("stats.jsonl"))?;
            Ok(known.stats.to_json())
        })
    }

    /// The probes, a list a column.
    pub(super) fn probes(&self) -> Answered<Value> {
        self.columns(|known, path| {
            known.probes.read_csv(&path.join("probes.csv"))?;
            Ok(known.probes.to_json())
        })
    }

    fn columns(&self, read: impl FnOnce(&mut Known, &Path) -> Answered<Value>) -> Answered<Value> {
        match &self.content {
            Content::Mesh(_) => Ok(json!({})),
            Content::Folder(folder) => {
                let mut known = folder.known.lock().unwrap_or_else(PoisonError::into_inner);
                read(&mut known, &self.path)
            }
        }
    }

    /// The scene as it was run.
    pub(super) fn scene(&self) -> String {
        self.with_manifest(|manifest| manifest.scene_text.clone())
    }

    /// Asks something of the run.
    pub(super) fn request(&self, word: &[u8]) -> Answered<()> {
        let Content::Folder(_) = &self.content else {
            return Err("a mesh is not run".to_owned());
        };
        // In a folder that no run writes to, the word would lie in wait for the next.
        if FolderLock::is_held(&self.path) == Some(false) {
            return Err("no run writes to this folder now".to_owned());
        }
        let asked = match word {
            b"pause" => RunRequest::Pause.write(&self.path),
            b"stop" => RunRequest::Stop.write(&self.path),
            b"continue" => RunRequest::withdraw(&self.path),
            _ => return Err("a run can be asked to pause, continue or stop".to_owned()),
        };
        asked.map_err(|error| error.to_string())
    }

    /// Pulls at a run that is played with.
    pub(super) fn pull(&self, line: &[u8]) -> Answered<()> {
        let hand = (std::str::from_utf8(line).ok().and_then(Hand::parse))
            .ok_or("a hand says \"VERTEX X Y Z\" or \"released\"")?;
        let is_folder = matches!(self.content, Content::Folder(_));
        if !is_folder || Hand::read(&self.path).is_none() {
            return Err("no run is played with here: koiter run SCENE --interactive".to_owned());
        }
        hand.write(&self.path).map_err(|error| error.to_string())
    }
}

impl Folder {
    fn opened(&self) -> RwLockReadGuard<'_, Opened> {
        self.opened.read().unwrap_or_else(PoisonError::into_inner)
    }

    fn opened_to_change(&self) -> RwLockWriteGuard<'_, Opened> {
        self.opened.write().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Opened {
    fn new(reader: ResultReader) -> Self {
        Self {
            reader,
            fields: OnceLock::new(),
        }
    }

    /// The fields of the first frame that can be read.
    fn fields(&self) -> Vec<FieldName> {
        if let Some(fields) = self.fields.get() {
            return fields.clone();
        }
        let first = (0..self.reader.len().min(FRAMES_FOR_RANGE))
            .find_map(|index| self.reader.frame(index).ok());
        let Some(frame) = first else {
            return Vec::new();
        };
        let named = |fields: &[Field], is_of_vertices| {
            let name = |field: &Field| FieldName {
                name: field.name.clone(),
                is_of_vertices,
            };
            fields.iter().map(name).collect::<Vec<_>>()
        };
        let mut fields = named(&frame.face_fields, false);
        fields.extend(named(&frame.vertex_fields, true));
        self.fields.get_or_init(|| fields).clone()
    }
}

/// When the manifest of a result was written.
fn written(folder: &Path) -> Option<SystemTime> {
    fs::metadata(folder.join("manifest.json"))
        .ok()?
        .modified()
        .ok()
}

/// The page moves the vertices of one topology.
fn refuse_changing_faces(reader: &ResultReader) -> Result<(), Failure> {
    match reader.frame(0) {
        Ok(frame) if frame.topology.is_some() => {
            let message = "faces change from frame to frame (burnt, cut or sewn), which the viewer cannot show";
            Err(Failure::input(message).with_help(
                "koiter render makes pictures and films of it, koiter export --to vtu a series for ParaView",
            ))
        }
        _ => Ok(()),
    }
}
