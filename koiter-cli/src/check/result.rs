//! `koiter check --result`: every frame of a result tested anew, independently of the code that made it.

use std::path::Path;

use indicatif::ProgressBar;
use koiter::audit::{Audit, Body, Crossing, Enclosed, FrameAudit, Penetration, RestFace};
use koiter::io::result::{Frame, Part, PartKind, ResultReader};
use serde::Serialize;

use crate::failure::{Code, Failure};
use crate::output::say;

/// Findings of a frame that are told one by one.
const NAMED: usize = 5;

/// Of results with more frames only those at fault get a row.
const MANY_FRAMES: usize = 60;

/// What the frames of a result are.
#[derive(Serialize)]
struct Report {
    result: String,
    vertices: usize,
    faces: usize,
    /// What areas and lengths are compared with.
    compared_with: &'static str,
    clean: bool,
    /// Files beside the frames that cannot be read.
    damaged: Vec<String>,
    frames: Vec<Row>,
}

#[derive(Default, Serialize)]
struct Row {
    frame: usize,
    time: Option<f64>,
    crossings: usize,
    penetrations: usize,
    enclosed: usize,
    collapsed_faces: usize,
    folded_edges: usize,
    /// With dihedral angles below 30°: no fault.
    sharp_edges: usize,
    smallest_area_ratio: f64,
    smallest_edge_ratio: f64,
    /// [rad]
    smallest_dihedral_angle: f64,
    /// The first of each kind, in words.
    findings: Vec<String>,
    /// Why the frame could not be read.
    #[serde(skip_serializing_if = "Option::is_none")]
    error: Option<String>,
}

/// Checks a result.
pub(super) fn check(folder: &Path, json: bool) -> Result<(), Failure> {
    let reader = ResultReader::open_with_gaps(folder).map_err(Failure::result)?;
    let report = Report::new(&reader, folder)?;
    if json {
        say!("{}", serde_json::to_string(&report).map_err(Failure::run)?);
    } else {
        report.print();
    }
    report.judge()
}

impl Report {
    fn new(reader: &ResultReader, folder: &Path) -> Result<Self, Failure> {
        if reader.is_empty() {
            return Err(Failure::input(format!(
                "{} has no frames",
                folder.display()
            )));
        }
        let mut report = Self {
            result: folder.display().to_string(),
            vertices: reader.manifest().num_vertices(),
            faces: reader.manifest().num_faces(),
            compared_with: "rest shape",
            clean: true,
            damaged: Vec::new(),
            frames: Vec::new(),
        };
        let rest = reader.rest().unwrap_or_else(|error| {
            report.damaged.push(error.to_string());
            None
        });
        if rest.is_none() {
            report.compared_with = "first readable frame";
        }
        let (mut audit, mut last_step) = (None, None);
        let bar = ProgressBar::new(reader.len() as u64);
        for index in 0..reader.len() {
            let frame = reader.frame(index);
            if let Ok(Frame { step, .. }) = &frame {
                if last_step.is_some_and(|last| *step <= last) {
                    let message = format!("frame {index} is of step {step}, as an earlier frame");
                    report.damaged.push(message);
                }
                last_step = Some(*step);
            }
            let row = match frame {
                // What burns away has other faces in every frame: each is compared with itself.
                Ok(frame) if frame.topology.is_some() => {
                    report.compared_with = "each frame itself";
                    Row::new(index, &frame, &prepare(reader, None, &frame))
                }
                Ok(frame) => {
                    let audit =
                        audit.get_or_insert_with(|| prepare(reader, rest.as_deref(), &frame));
                    Row::new(index, &frame, audit)
                }
                Err(error) => Row::unreadable(index, error.to_string()),
            };
            report.clean &= row.is_clean();
            report.frames.push(row);
            bar.inc(1);
        }
        bar.finish_and_clear();
        report.damaged.extend(frames_lost(reader, last_step));
        report.clean &= report.damaged.is_empty();
        Ok(report)
    }

    fn judge(&self) -> Result<(), Failure> {
        let faults: Vec<&Row> = self.frames.iter().filter(|row| !row.is_clean()).collect();
        let Some(first) = faults.first() else {
            return match self.damaged.first() {
                Some(message) => Err(Failure::run(message).with_code(Code::Audit)),
                None => Ok(()),
            };
        };
        let what = match &first.error {
            Some(error) => error.clone(),
            None => first.findings.first().cloned().unwrap_or_default(),
        };
        Err(Failure::run(format!(
            "{} of {} frames are at fault, the first is frame {}: {what}",
            faults.len(),
            self.frames.len(),
            first.frame
        ))
        .with_code(Code::Audit))
    }

    fn print(&self) {
        say!(
            "{:>6} {:>10} {:>9} {:>9} {:>8} {:>9} {:>7} {:>10} {:>10} {:>9} {:>6}",
            "frame",
            "time [s]",
            "crossings",
            "in solids",
            "enclosed",
            "collapsed",
            "folded",
            "least area",
            "edge",
            "fold [°]",
            "<30°"
        );
        let shown = |row: &&Row| self.frames.len() <= MANY_FRAMES || !row.is_clean();
        for row in self.frames.iter().filter(shown) {
            row.print();
        }
        for message in &self.damaged {
            say!("{message}");
        }
        let least =
            |value: fn(&Row) -> f64| self.frames.iter().map(value).fold(f64::INFINITY, f64::min);
        say!(
            "{} frames of {} triangles; over the {}, least area {:.4}, least edge {:.4}; sharpest fold {:.2}°, at most {} \
             edges below 30°",
            self.frames.len(),
            self.faces,
            self.compared_with,
            least(|row| row.smallest_area_ratio),
            least(|row| row.smallest_edge_ratio),
            least(|row| row.smallest_dihedral_angle).to_degrees(),
            self.frames
                .iter()
                .map(|row| row.sharp_edges)
                .max()
                .unwrap_or(0)
        );
        if self.clean {
            say!("nothing intersects, nothing is collapsed");
        }
    }
}

/// What is missing if the last frame is not of the last step of a run that came to its end.
fn frames_lost(reader: &ResultReader, last_step: Option<u64>) -> Option<String> {
    let summary = reader.summary().ok().flatten()?;
    let steps = |key: &str| summary[key].as_u64();
    let (taken, last) = (steps("steps")?, last_step?);
    let is_finished = steps("planned_steps") == Some(taken);
    (is_finished && last < taken).then(|| {
        format!("the last frame is of step {last}, but the run took {taken}: frames are missing")
    })
}

/// Bodies, solids and rest shape of a result; `first` is the first frame that can be read.
fn prepare(reader: &ResultReader, rest: Option<&[RestFace]>, first: &Frame) -> Audit {
    let corners = |face: &[u32; 3]| face.map(|v| first.positions[v as usize]);
    let as_it_is = |face: &[u32; 3]| RestFace::from_corners(&corners(face));
    let rest = match rest {
        Some(rest) => rest.to_vec(),
        None => reader.faces_in(first).iter().map(as_it_is).collect(),
    };
    let bodies = bodies(reader.parts_in(first));
    Audit::new(bodies, reader.faces_in(first), &rest, &first.positions)
}

/// What an audit knows of the parts of a result.
pub(crate) fn bodies(parts: &[Part]) -> Vec<Body> {
    let body = |part: &Part| Body {
        name: part.name.clone(),
        is_obstacle: part.kind == PartKind::Obstacle,
        vertices: part.vertices.clone(),
        faces: part.faces.clone(),
        solid: part.solid.clone(),
    };
    parts.iter().map(body).collect()
}

impl Row {
    fn new(index: usize, frame: &Frame, audit: &Audit) -> Self {
        let found = audit.frame(&frame.positions);
        Self {
            frame: index,
            time: Some(frame.time),
            crossings: found.crossings.len(),
            penetrations: found.penetrations.len(),
            enclosed: found.enclosed.len(),
            collapsed_faces: found.collapsed.len(),
            folded_edges: found.folded.len(),
            sharp_edges: found.sharp,
            smallest_area_ratio: found.area_ratio.value,
            smallest_edge_ratio: found.edge_ratio.value,
            smallest_dihedral_angle: found.dihedral_angle.value,
            findings: findings(audit, &found),
            error: None,
        }
    }

    fn unreadable(index: usize, error: String) -> Self {
        Self {
            frame: index,
            smallest_area_ratio: f64::INFINITY,
            smallest_edge_ratio: f64::INFINITY,
            smallest_dihedral_angle: f64::INFINITY,
            error: Some(error),
            ..Self::default()
        }
    }

    fn is_clean(&self) -> bool {
        self.findings.is_empty() && self.error.is_none()
    }

    fn print(&self) {
        let Some(time) = self.time else {
            say!(
                "{:>6} {}",
                self.frame,
                self.error.as_deref().unwrap_or_default()
            );
            return;
        };
        say!(
            "{:>6} {time:>10.4} {:>9} {:>9} {:>8} {:>9} {:>7} {:>10.4} {:>10.4} {:>9.2} {:>6}",
            self.frame,
            self.crossings,
            self.penetrations,
            self.enclosed,
            self.collapsed_faces,
            self.folded_edges,
            self.smallest_area_ratio,
            self.smallest_edge_ratio,
            self.smallest_dihedral_angle.to_degrees(),
            self.sharp_edges
        );
        for finding in &self.findings {
            say!("       {finding}");
        }
    }
}

/// The first findings of each kind, and how many more there are.
fn findings(audit: &Audit, found: &FrameAudit) -> Vec<String> {
    let name = |body: usize| &audit.bodies()[body].name;
    let crossing = |hit: &Crossing| {
        let (edge, face) = (audit.describe_edge(hit.edge), audit.describe_face(hit.face));
        format!("{edge} crosses {face}")
    };
    let penetration = |hit: &Penetration| {
        let face = audit.describe_face(hit.face);
        format!(
            "{face} reaches {:.2e} m into '{}'",
            hit.depth,
            name(hit.body)
        )
    };
    let enclosed = |hit: &Enclosed| {
        let vertex = audit.describe_vertex(hit.vertex);
        format!("{vertex} lies inside '{}'", name(hit.body))
    };
    let collapsed = |&face: &u32| format!("{} is collapsed", audit.describe_face(face));
    let folded = |&edge: &[u32; 2]| format!("{} is folded onto itself", audit.describe_edge(edge));
    let mut all = Vec::new();
    all.extend(first_few(&found.crossings, crossing));
    all.extend(first_few(&found.penetrations, penetration));
    all.extend(first_few(&found.enclosed, enclosed));
    all.extend(first_few(&found.collapsed, collapsed));
    all.extend(first_few(&found.folded, folded));
    all
}

fn first_few<T>(all: &[T], words: impl Fn(&T) -> String) -> Vec<String> {
    let mut told: Vec<String> = all.iter().take(NAMED).map(words).collect();
    if let Some(last) = told.last_mut().filter(|_| all.len() > NAMED) {
        *last += &format!(", and {} more", all.len() - NAMED);
    }
    told
}
