//! What a run writes while it goes on: frames, figures, probes, checkpoints, and its summary.

mod parts;
mod probe_file;
mod stats_line;
mod summary;

use std::time::Instant;

use serde::ser::SerializeMap;
use serde::{Serialize, Serializer};

use crate::integrate::{StepError, StepReport};
use crate::io::result::{Checkpoint, Field, FolderLock, Frame, ResultError, ResultWriter, Totals};
use crate::scene::spec::OutputSpec;
use crate::scene::{Scene, Simulation, Timeline};

pub use parts::parts_and_faces;
use probe_file::ProbeWriter;
use stats_line::StatsLine;
pub use summary::Summary;

/// Writes what a run yields into a result folder.
#[derive(Debug)]
pub struct Recorder {
    timeline: Timeline,
    output: OutputSpec,
    writer: ResultWriter,
    probes: ProbeWriter,
    /// The sums so far.
    pub summary: Summary,
    unconverged: usize,
    started: Instant,
    /// Wall time of the run before it was interrupted [s].
    seconds_before: f64,
    checkpointed: Option<Instant>,
    scene_text: String,
    bodies: Vec<(String, u64)>,
}

impl Recorder {
    /// Begins a result in the folder that is locked: what it is of, the rest shape, the first frame. `scene_text` is the scene as
    /// it is run, `num_steps` how many steps are planned.
    ///
    /// # Errors
    /// A folder with other content, a refusal of the system.
    pub fn create(
        lock: FolderLock,
        scene: &Scene,
        scene_text: &str,
        simulation: &Simulation,
        num_steps: usize,
    ) -> Result<Self, ResultError> {
        let (manifest, faces) = parts::manifest(scene, scene_text, simulation);
        let writer = ResultWriter::create_locked(lock, &manifest, &faces)?;
        writer.write_rest(&simulation.rest_faces())?;
        let probes = ProbeWriter::create(writer.folder(), scene.probes.clone())?;
        let mut recorder = Self::new(scene, scene_text, simulation, num_steps, writer, probes);
        recorder.write_frame(simulation)?;
        recorder.write_probes(simulation)?;
        Ok(recorder)
    }

    /// Goes on where a checkpoint was made: what was written after it is cut off, to be written again.
    ///
    /// # Errors
    /// A result that does not reach up to the checkpoint or is damaged, a refusal of the system.
    pub fn resume(
        lock: FolderLock,
        scene: &Scene,
        scene_text: &str,
        simulation: &Simulation,
        num_steps: usize,
        totals: &Totals,
    ) -> Result<Self, ResultError> {
        let (manifest, _) = parts::manifest(scene, scene_text, simulation);
        let step = simulation.step_count();
        // The frame of an end that is no longer the end is not one of the regular ones: it goes too.
        let frames = scene.timeline.num_frames(step);
        let writer = ResultWriter::resume_locked(lock, &manifest, frames, step)?;
        let (folder, probes) = (writer.folder(), scene.probes.clone());
        let probes = ProbeWriter::resume(folder, probes, 1 + step, &totals.probes)?;
        let mut recorder = Self::new(scene, scene_text, simulation, num_steps, writer, probes);
        recorder.seconds_before = totals.seconds;
        recorder.unconverged = totals.unconverged as usize;
        recorder
            .summary
            .take_up(step, scene.timeline.time(step), totals);
        if step == num_steps && !scene.timeline.has_frame(step) {
            recorder.write_frame(simulation)?;
        }
        Ok(recorder)
    }

    fn new(
        scene: &Scene,
        scene_text: &str,
        simulation: &Simulation,
        num_steps: usize,
        writer: ResultWriter,
        probes: ProbeWriter,
    ) -> Self {
        Self {
            timeline: scene.timeline.clone(),
            output: scene.output.clone(),
            writer,
            probes,
            summary: Summary::new(&simulation.stats(), num_steps, scene.model.contact.enabled),
            unconverged: 0,
            started: Instant::now(),
            seconds_before: 0.0,
            checkpointed: None,
            scene_text: scene_text.to_owned(),
            bodies: scene.model.fingerprints(),
        }
    }

    /// Steps that did not converge.
    pub fn num_unconverged(&self) -> usize {
        self.unconverged
    }

    /// Writes a step's figures, and its frame and a checkpoint if they are due; of the last step both.
    ///
    /// # Errors
    /// A refusal of the system.
    pub fn record(
        &mut self,
        simulation: &Simulation,
        report: &StepReport,
        is_last: bool,
    ) -> Result<(), ResultError> {
        self.writer.append_stats(&StatsLine::new(report))?;
        self.write_probes(simulation)?;
        if is_last || self.timeline.has_frame(report.step) {
            self.write_frame(simulation)?;
        }
        self.summary.add(report);
        if let Some(reason) = &report.cut
            && self.summary.steps_in_parts == 1
        {
            // Once a run, as below.
            let (step, parts) = (report.step, report.parts);
            log::warn!(target: "koiter", "step {step} failed as a whole and was taken in {parts} parts: {reason}");
        }
        if !report.converged {
            self.unconverged += 1;
            // Once a run: the others are counted at its end, and told one by one in stats.jsonl.
            if self.unconverged == 1 {
                let diagnosis = report.diagnosis.as_deref().unwrap_or("no diagnosis");
                log::warn!(target: "koiter", "step {} did not converge: {diagnosis}", report.step);
            }
        }
        let since = self.checkpointed.unwrap_or(self.started).elapsed();
        if is_last || since.as_secs_f64() >= self.output.checkpoint_seconds {
            self.write_checkpoint(simulation)?;
        }
        Ok(())
    }

    /// Ends a run early, after the step that was recorded last: its frame and a checkpoint are written.
    ///
    /// # Errors
    /// A refusal of the system.
    pub fn stop(&mut self, simulation: &Simulation) -> Result<(), ResultError> {
        self.summary.interrupted = true;
        if !self.timeline.has_frame(simulation.step_count()) {
            self.write_frame(simulation)?;
        }
        self.write_checkpoint(simulation)
    }

    /// Whether the run can go on from a checkpoint of its own.
    pub fn has_checkpoint(&self) -> bool {
        self.checkpointed.is_some() || self.seconds_before > 0.0
    }

    fn write_checkpoint(&mut self, simulation: &Simulation) -> Result<(), ResultError> {
        self.probes.sync()?;
        let seconds = self.seconds();
        let checkpoint = Checkpoint {
            version: crate::VERSION.to_owned(),
            scene_text: self.scene_text.clone(),
            bodies: self.bodies.clone(),
            snapshot: simulation.snapshot(),
            totals: Totals {
                unconverged: self.unconverged as u64,
                seconds,
                probes: self.probes.last_row(),
                ..self.summary.totals()
            },
        };
        self.writer.write_checkpoint(&checkpoint)?;
        self.checkpointed = Some(Instant::now());
        Ok(())
    }

    /// Wall time of the run, interruptions left out [s].
    fn seconds(&self) -> f64 {
        self.seconds_before + self.started.elapsed().as_secs_f64()
    }

    fn write_frame(&mut self, simulation: &Simulation) -> Result<(), ResultError> {
        let wanted = |name: &str| self.output.fields.iter().any(|field| field == name);
        let fields = simulation
            .face_fields()
            .into_iter()
            .filter(|(name, _)| wanted(name));
        let frame = Frame {
            step: simulation.step_count() as u64,
            time: self.timeline.time(simulation.step_count()),
            positions: simulation.display_positions(),
            vertex_fields: Vec::new(),
            face_fields: fields
                .map(|(name, values)| Field {
                    name: name.to_owned(),
                    values,
                })
                .collect(),
            topology: parts::present_parts(simulation),
        };
        self.writer.write_frame(&frame)
    }

    fn write_probes(&mut self, simulation: &Simulation) -> Result<(), ResultError> {
        let time = self.timeline.time(simulation.step_count());
        self.probes.write(simulation, time)
    }

    /// Remembers a step that failed, for the summary.
    pub fn note_error(&mut self, error: &StepError) {
        self.summary.converged = false;
        if matches!(error, StepError::Intersection { .. }) {
            self.summary.intersections = self.summary.intersections.map(|count| count + 1);
        }
    }

    /// Writes the summary; `peak_memory_bytes` is the most memory that the program had at a time, where that is known.
    ///
    /// # Errors
    /// A refusal of the system.
    pub fn write_summary(&mut self, peak_memory_bytes: Option<u64>) -> Result<(), ResultError> {
        self.summary
            .finish(self.seconds(), self.probes.last_values(), peak_memory_bytes);
        self.writer.write_summary(&self.summary)
    }
}

fn as_map<S: Serializer, N: Serialize, V: Serialize>(
    pairs: &impl AsRef<[(N, V)]>,
    serializer: S,
) -> Result<S::Ok, S::Error> {
    let pairs = pairs.as_ref();
    let mut map = serializer.serialize_map(Some(pairs.len()))?;
    for (name, value) in pairs {
        map.serialize_entry(name, value)?;
    }
    map.end()
}
