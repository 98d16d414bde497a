//! Where a run can be taken up again: `checkpoint.bin`.
//!
//! ```text
//! "KOITERCP"  u32 format  text version of Koiter  text scene
//! list of bodies: text name, u64 fingerprint of the mesh
//! u64 step  f64 time  list of f64: q, its rates, their rates
//! u8 1 with contact, else 0  f64 barrier stiffness
//! u8 1 on a path by arc length, else 0  f64 load factor  f64 arc length  list of f64: last increment
//! list of f64: what the directors under moments have turned  f64 share of a step
//! u8 0 nothing, 1 the state before the last step (BDF2): f64 its length  list of f64: q, its rates
//!    2 accelerations of the equation of motion (Newmark): f64 longest stable step  u64 steps since it was estimated
//!      f64 largest kinetic energy
//! list of anchors: list of u64 constraints, f64 time, list of f64: q when they began
//! list of rest states: list of f64 rest curvatures, list of f64 flows, list of f64 rest strains
//! list of lists of f64: angles of hinges
//! list of double layers: lists of f64: positions, velocities, temperatures, mass ratios
//! list of burning shells: lists of f64: temperatures, mass ratios; list of u32: torn faces
//! list of none or one, the Bézier shells: list of poses: what procedures found  pose  list of f64: velocities
//!   list of u32 × 2: couplings  f64 barrier stiffness  list of f64 × 3: points of obstacles
//!   a pose is a list of f64 × 3: positions, and a list of f64 × 4: rotations, as i, j, k, w
//! list of u32 × 2: couplings by contacts  list of u32: elimination order  u64 factor entries when it was made
//! u64 × 4 Newton iterations, steps not converged, steps in parts, intersections  f64 × 2 smallest gap, seconds
//! list of parts of the run: text name, f64 seconds  list of f64: last values of the probes
//! u32 CRC-32
//! ```
//!
//! Numbers are little-endian; a text is its length as u32 and its bytes, a list its length as u64 and its items.

mod bezier;

use std::path::Path;

use super::CHECKPOINT;
use super::error::{ResultError, read_if_there};
use super::topology_file::checked_body;
use crate::Vec3;
use crate::burning::{BurningState, HeatedState};
use crate::integrate::{Memory, PathPoint, StableStep, State};
use crate::io::bytes::{ByteReader, Endian};
use crate::io::checksum::crc32;
use crate::process::RestState;
use crate::scene::{Anchor, Snapshot};
use crate::solve::WorkspaceHistory;

const MAGIC: &[u8; 8] = b"KOITERCP";
const FORMAT: u32 = 11;

/// All that is needed to go on with a run to the same bits.
#[derive(Clone, Debug, PartialEq)]
pub struct Checkpoint {
    /// Version of Koiter that wrote it: another may round otherwise.
    pub version: String,
    /// The scene as it was run, overrides included.
    pub scene_text: String,
    /// Name and fingerprint of the mesh of each body.
    pub bodies: Vec<(String, u64)>,
    /// What the simulation owes to its past.
    pub snapshot: Snapshot,
    /// What the run has added up so far.
    pub totals: Totals,
}

/// Sums over the steps of a run, for its summary.
#[derive(Clone, Debug, PartialEq)]
pub struct Totals {
    /// Newton iterations.
    pub newton_iterations: u64,
    /// Steps that did not converge.
    pub unconverged: u64,
    /// Steps that were taken in parts.
    pub in_parts: u64,
    /// Intersections found.
    pub intersections: u64,
    /// Smallest gap between surfaces [m]; infinity when nothing was near.
    pub min_gap: f64,
    /// Wall time [s].
    pub seconds: f64,
    /// Wall time of steps by part [s].
    pub seconds_by_part: Vec<(String, f64)>,
    /// Last values of all probes, in the order of their columns.
    pub probes: Vec<f64>,
}

impl Default for Totals {
    fn default() -> Self {
        Self {
            newton_iterations: 0,
            unconverged: 0,
            in_parts: 0,
            intersections: 0,
            min_gap: f64::INFINITY,
            seconds: 0.0,
            seconds_by_part: Vec::new(),
            probes: Vec::new(),
        }
    }
}

/// Bytes that are no checkpoint, or a damaged one, or one of another format.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{reason}")]
pub struct CheckpointError {
    /// What is wrong.
    pub reason: String,
}

impl Checkpoint {
    /// The checkpoint of a result folder, if there is one.
    ///
    /// # Errors
    /// A file that is damaged or of another format, a refusal of the system.
    pub fn read(folder: &Path) -> Result<Option<Self>, ResultError> {
        let path = folder.join(CHECKPOINT);
        let Some(bytes) = read_if_there(&path)? else {
            return Ok(None);
        };
        Self::from_bytes(&bytes)
            .map(Some)
            .map_err(|CheckpointError { reason }| ResultError::Broken { path, reason })
    }

    /// Reads a checkpoint from the bytes of its file, whatever they are.
    ///
    /// # Errors
    /// Anything but a whole checkpoint of this format.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, CheckpointError> {
        let refuse = |reason| CheckpointError { reason };
        let body = checked_body(bytes, MAGIC, FORMAT).map_err(refuse)?;
        let mut reader = ByteReader::new(body, Endian::Little);
        let checkpoint = read_body(&mut reader)
            .ok_or_else(|| refuse("its lengths do not fit each other".to_string()))?;
        match reader.remaining() {
            0 => Ok(checkpoint),
            left => Err(refuse(format!("{left} bytes are left over at its end"))),
        }
    }

    /// The bytes of the file.
    pub fn to_bytes(&self) -> Vec<u8> {
        let Self {
            snapshot, totals, ..
        } = self;
        let mut out = Bytes(Vec::with_capacity(
            1000 + self.scene_text.len() + 8 * 3 * snapshot.state.q.len(),
        ));
        out.0.extend(MAGIC);
        out.0.extend(FORMAT.to_le_bytes());
        out.text(&self.version);
        out.text(&self.scene_text);
        out.list(&self.bodies, |out, (name, fingerprint)| {
            out.text(name);
            out.u64(*fingerprint);
        });
        out.u64(snapshot.state.step as u64);
        out.f64(snapshot.state.time);
        out.numbers(&snapshot.state.q);
        out.numbers(&snapshot.state.velocities);
        out.numbers(&snapshot.state.accelerations);
        out.0.push(snapshot.kappa.is_some().into());
        out.f64(snapshot.kappa.unwrap_or(0.0));
        out.path(snapshot.state.path.as_ref());
        out.numbers(&snapshot.turned);
        out.f64(snapshot.share);
        out.memory(&snapshot.state.memory);
        out.list(&snapshot.anchors, |out, anchor| {
            out.list(&anchor.constraints, |out, index| out.u64(*index as u64));
            out.f64(anchor.time);
            out.numbers(&anchor.q);
        });
        out.list(&snapshot.rests, |out, rest| {
            out.numbers(&rest.curvature);
            out.numbers(&rest.flow);
            out.numbers(&rest.strain);
        });
        out.list(&snapshot.angles, |out, angles| out.numbers(angles));
        out.list(&snapshot.double_layers, |out, layer| {
            out.vectors(&layer.positions);
            out.vectors(&layer.velocities);
            out.numbers(&layer.temperatures);
            out.numbers(&layer.mass_ratios);
        });
        out.list(&snapshot.heated_shells, |out, shell| {
            out.numbers(&shell.temperatures);
            out.numbers(&shell.mass_ratios);
            out.list(&shell.torn, |out, face| out.u32(*face));
        });
        out.list(snapshot.bezier.as_slice(), Bytes::bezier);
        let WorkspaceHistory {
            changing_pairs,
            node_order,
            entries_at_ordering,
        } = &snapshot.solver;
        out.list(changing_pairs, |out, [a, b]| {
            out.u32(*a);
            out.u32(*b);
        });
        out.list(node_order, |out, node| out.u32(*node));
        out.u64(*entries_at_ordering);
        out.u64(totals.newton_iterations);
        out.u64(totals.unconverged);
        out.u64(totals.in_parts);
        out.u64(totals.intersections);
        out.f64(totals.min_gap);
        out.f64(totals.seconds);
        out.list(&totals.seconds_by_part, |out, (name, seconds)| {
            out.text(name);
            out.f64(*seconds);
        });
        out.numbers(&totals.probes);
        let checksum = crc32(&out.0);
        out.u32(checksum);
        out.0
    }
}

struct Bytes(Vec<u8>);

impl Bytes {
    fn u32(&mut self, value: u32) {
        self.0.extend(value.to_le_bytes());
    }

    fn u64(&mut self, value: u64) {
        self.0.extend(value.to_le_bytes());
    }

    fn f64(&mut self, value: f64) {
        self.0.extend(value.to_le_bytes());
    }

    fn text(&mut self, text: &str) {
        self.u32(text.len() as u32);
        self.0.extend(text.as_bytes());
    }

    fn list<T>(&mut self, items: &[T], write: impl Fn(&mut Self, &T)) {
        self.u64(items.len() as u64);
        items.iter().for_each(|item| write(self, item));
    }

    fn numbers(&mut self, values: &[f64]) {
        self.list(values, |out, value| out.f64(*value));
    }

    fn vectors(&mut self, values: &[Vec3]) {
        self.list(values, |out, value| value.iter().for_each(|x| out.f64(*x)));
    }

    fn memory(&mut self, memory: &Memory) {
        match memory {
            Memory::None => self.0.push(0),
            Memory::Before { dt, q, velocities } => {
                self.0.push(1);
                self.f64(*dt);
                self.numbers(q);
                self.numbers(velocities);
            }
            Memory::Accelerated {
                stable,
                largest_kinetic,
            } => {
                self.0.push(2);
                self.0.push(stable.is_some().into());
                if let Some(stable) = stable {
                    self.f64(stable.dt);
                    self.f64(stable.found_for);
                    self.u64(stable.age);
                    self.f64(stable.speed);
                    self.numbers(&stable.settings);
                }
                self.f64(*largest_kinetic);
            }
        }
    }

    fn path(&mut self, point: Option<&PathPoint>) {
        self.0.push(point.is_some().into());
        self.f64(point.map_or(0.0, |point| point.load_factor));
        self.f64(point.map_or(0.0, |point| point.arc_length));
        self.numbers(point.map_or(&[], |point| &point.increment));
    }
}

fn read_body(reader: &mut ByteReader) -> Option<Checkpoint> {
    let version = text(reader)?;
    let scene_text = text(reader)?;
    let bodies = list(reader, 12, |reader| Some((text(reader)?, reader.u64()?)))?;
    let step = usize::try_from(reader.u64()?).ok()?;
    let time = reader.f64()?;
    let mut state = State {
        q: numbers(reader)?,
        velocities: numbers(reader)?,
        accelerations: numbers(reader)?,
        time,
        step,
        path: None,
        memory: Memory::None,
    };
    let has_contact = reader.u8()?;
    let kappa = reader.f64()?;
    state.path = path(reader)?;
    let turned = numbers(reader)?;
    let share = reader.f64()?;
    state.memory = memory(reader)?;
    let anchors = list(reader, 24, anchor)?;
    let rests = list(reader, 24, |reader| {
        Some(RestState {
            curvature: numbers(reader)?,
            flow: numbers(reader)?,
            strain: numbers(reader)?,
        })
    })?;
    let angles = list(reader, 8, numbers)?;
    let double_layers = list(reader, 32, |reader| {
        Some(BurningState {
            positions: vectors(reader)?,
            velocities: vectors(reader)?,
            temperatures: numbers(reader)?,
            mass_ratios: numbers(reader)?,
        })
    })?;
    let heated_shells = list(reader, 24, |reader| {
        Some(HeatedState {
            temperatures: numbers(reader)?,
            mass_ratios: numbers(reader)?,
            torn: list(reader, 4, ByteReader::u32)?,
        })
    })?;
    let bezier = list(reader, 48, bezier::bezier)?.pop();
    let solver = WorkspaceHistory {
        changing_pairs: list(reader, 8, |reader| Some([reader.u32()?, reader.u32()?]))?,
        node_order: list(reader, 4, ByteReader::u32)?,
        entries_at_ordering: reader.u64()?,
    };
    let totals = Totals {
        newton_iterations: reader.u64()?,
        unconverged: reader.u64()?,
        in_parts: reader.u64()?,
        intersections: reader.u64()?,
        min_gap: reader.f64()?,
        seconds: reader.f64()?,
        seconds_by_part: list(reader, 12, |reader| Some((text(reader)?, reader.f64()?)))?,
        probes: numbers(reader)?,
    };
    let snapshot = Snapshot {
        state,
        kappa: (has_contact == 1).then_some(kappa),
        turned,
        share,
        anchors,
        rests,
        angles,
        double_layers,
        heated_shells,
        bezier,
        solver,
    };
    Some(Checkpoint {
        version,
        scene_text,
        bodies,
        snapshot,
        totals,
    })
}

fn text(reader: &mut ByteReader) -> Option<String> {
    let length = reader.u32()? as usize;
    Some(str::from_utf8(reader.take(length)?).ok()?.to_owned())
}

/// A list of items of at least `width` bytes each; its length is not trusted with memory that the file does not have.
fn list<'a, T>(
    reader: &mut ByteReader<'a>,
    width: usize,
    read: impl Fn(&mut ByteReader<'a>) -> Option<T>,
) -> Option<Vec<T>> {
    let count = usize::try_from(reader.u64()?).ok()?;
    if count.checked_mul(width)? > reader.remaining() {
        return None;
    }
    (0..count).map(|_| read(reader)).collect()
}

fn numbers(reader: &mut ByteReader) -> Option<Vec<f64>> {
    list(reader, 8, ByteReader::f64)
}

fn vectors(reader: &mut ByteReader) -> Option<Vec<Vec3>> {
    list(reader, 24, |reader| {
        Some(Vec3::new(reader.f64()?, reader.f64()?, reader.f64()?))
    })
}

fn memory(reader: &mut ByteReader) -> Option<Memory> {
    match reader.u8()? {
        0 => Some(Memory::None),
        1 => Some(Memory::Before {
            dt: reader.f64()?,
            q: numbers(reader)?,
            velocities: numbers(reader)?,
        }),
        2 => Some(Memory::Accelerated {
            stable: match reader.u8()? {
                0 => None,
                _ => Some(StableStep {
                    dt: reader.f64()?,
                    found_for: reader.f64()?,
                    age: reader.u64()?,
                    speed: reader.f64()?,
                    settings: numbers(reader)?,
                }),
            },
            largest_kinetic: reader.f64()?,
        }),
        _ => None,
    }
}

fn anchor(reader: &mut ByteReader) -> Option<Anchor> {
    Some(Anchor {
        constraints: list(reader, 8, |reader| usize::try_from(reader.u64()?).ok())?,
        time: reader.f64()?,
        q: numbers(reader)?,
    })
}

/// `None` where the bytes end, `Some(None)` where there is no path.
fn path(reader: &mut ByteReader) -> Option<Option<PathPoint>> {
    let is_there = reader.u8()?;
    let point = PathPoint {
        load_factor: reader.f64()?,
        arc_length: reader.f64()?,
        increment: numbers(reader)?,
    };
    Some((is_there == 1).then_some(point))
}

#[cfg(test)]
mod tests;
