//! What a run writes while it goes on: frames, figures, probes, checkpoints, and its summary.

use std::io::ErrorKind;
use std::path::Path;
use std::time::Instant;

use koiter::integrate::{StepError, StepReport};
use koiter::io::result::{Checkpoint, Field, FolderLock, Frame, ResultError, ResultWriter, Totals};
use koiter::scene::{Scene, Simulation};

use super::beginning::BEGIN_AGAIN;
use super::record::{StatsLine, Summary};
use super::start;
use crate::failure::{Code, Failure};
use crate::probes::ProbeWriter;
use crate::scene_source::LoadedScene;

/// Writes what a run yields.
pub(super) struct Recorder<'a> {
    pub(super) scene: &'a Scene,
    writer: ResultWriter,
    probes: ProbeWriter<'a>,
    pub(super) summary: Summary,
    pub(super) unconverged: usize,
    started: Instant,
    /// Wall time of the run before it was interrupted [s].
    seconds_before: f64,
    checkpointed: Option<Instant>,
    scene_text: &'a str,
    bodies: Vec<(String, u64)>,
}

impl<'a> Recorder<'a> {
    pub(super) fn create(
        lock: FolderLock,
        loaded: &'a LoadedScene,
        simulation: &Simulation,
        num_steps: usize,
    ) -> Result<Self, Failure> {
        let (manifest, faces) = start::manifest(loaded, simulation);
        let writer = ResultWriter::create_locked(lock, &manifest, &faces).map_err(writing)?;
        writer
            .write_rest(&simulation.rest_faces())
            .map_err(writing)?;
        let folder = writer.folder();
        let probes = ProbeWriter::create(folder, &loaded.scene.probes)
            .map_err(|error| cannot_write(&folder.join("probes.csv"), error))?;
        let mut recorder = Self::new(loaded, simulation, num_steps, writer, probes);
        recorder.write_frame(simulation)?;
        recorder.write_probes(simulation)?;
        Ok(recorder)
    }

    /// Goes on where a checkpoint was made: what was written after it is cut off, to be written again.
    pub(super) fn resume(
        lock: FolderLock,
        loaded: &'a LoadedScene,
        simulation: &Simulation,
        num_steps: usize,
        totals: &Totals,
    ) -> Result<Self, Failure> {
        let (manifest, _) = start::manifest(loaded, simulation);
        let scene = &loaded.scene;
        let step = simulation.step_count();
        // The frame of an end that is no longer the end is not one of the regular ones: it goes too.
        let frames = scene.timeline.num_frames(step);
        let writer = ResultWriter::resume_locked(lock, &manifest, frames, step).map_err(damaged)?;
        let probes = ProbeWriter::resume(writer.folder(), &scene.probes, 1 + step, &totals.probes)
            .map_err(damaged)?;
        let mut recorder = Self::new(loaded, simulation, num_steps, writer, probes);
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
        loaded: &'a LoadedScene,
        simulation: &Simulation,
        num_steps: usize,
        writer: ResultWriter,
        probes: ProbeWriter<'a>,
    ) -> Self {
        let scene = &loaded.scene;
        Self {
            scene,
            writer,
            probes,
            summary: Summary::new(&simulation.stats(), num_steps, scene.model.contact.enabled),
            unconverged: 0,
            started: Instant::now(),
            seconds_before: 0.0,
            checkpointed: None,
            scene_text: &loaded.text,
            bodies: scene.model.fingerprints(),
        }
    }

    /// Writes a step's figures, and its frame if it is due.
    pub(super) fn record(
        &mut self,
        simulation: &Simulation,
        report: &StepReport,
        is_last: bool,
    ) -> Result<(), Failure> {
        self.writer
            .append_stats(&StatsLine::new(report))
            .map_err(writing)?;
        self.write_probes(simulation)?;
        if is_last || self.scene.timeline.has_frame(report.step) {
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
        if is_last || since.as_secs_f64() >= self.scene.output.checkpoint_seconds {
            self.write_checkpoint(simulation)?;
        }
        Ok(())
    }

    /// Whether the run can go on from a checkpoint of its own.
    pub(super) fn has_checkpoint(&self) -> bool {
        self.checkpointed.is_some() || self.seconds_before > 0.0
    }

    fn write_checkpoint(&mut self, simulation: &Simulation) -> Result<(), Failure> {
        self.probes
            .sync()
            .map_err(|error| cannot_write(&self.writer.folder().join("probes.csv"), error))?;
        let seconds = self.seconds();
        let checkpoint = Checkpoint {
            version: koiter::VERSION.to_owned(),
            scene_text: self.scene_text.to_owned(),
            bodies: self.bodies.clone(),
            snapshot: simulation.snapshot(),
            totals: Totals {
                unconverged: self.unconverged as u64,
                seconds,
                probes: self.probes.last_row(),
                ..self.summary.totals()
            },
        };
        self.writer.write_checkpoint(&checkpoint).map_err(writing)?;
        self.checkpointed = Some(Instant::now());
        Ok(())
    }

    /// Wall time of the run, interruptions left out [s].
    fn seconds(&self) -> f64 {
        self.seconds_before + self.started.elapsed().as_secs_f64()
    }

    fn write_frame(&mut self, simulation: &Simulation) -> Result<(), Failure> {
        let wanted = |name: &str| self.scene.output.fields.iter().any(|field| field == name);
        let fields = simulation
            .face_fields()
            .into_iter()
            .filter(|(name, _)| wanted(name));
        let frame = Frame {
            step: simulation.step_count() as u64,
            time: self.scene.timeline.time(simulation.step_count()),
            positions: simulation.display_positions(),
            vertex_fields: Vec::new(),
            face_fields: fields
                .map(|(name, values)| Field {
                    name: name.to_owned(),
                    values,
                })
                .collect(),
            topology: start::present_parts(simulation),
        };
        self.writer.write_frame(&frame).map_err(writing)
    }

    fn write_probes(&mut self, simulation: &Simulation) -> Result<(), Failure> {
        let time = self.scene.timeline.time(simulation.step_count());
        self.probes
            .write(simulation, time)
            .map_err(|error| cannot_write(&self.writer.folder().join("probes.csv"), error))
    }

    pub(super) fn note_error(&mut self, error: &StepError) {
        self.summary.converged = false;
        if matches!(error, StepError::Intersection { .. }) {
            self.summary.intersections = self.summary.intersections.map(|count| count + 1);
        }
    }

    pub(super) fn write_summary(&mut self) -> Result<(), Failure> {
        self.summary
            .finish(self.seconds(), self.probes.last_values());
        self.writer.write_summary(&self.summary).map_err(writing)
    }
}

/// A folder that may not be written to is an input that is wrong, unless the system refused.
pub(super) fn writing(error: ResultError) -> Failure {
    match error {
        ResultError::NotEmpty { .. } | ResultError::InUse { .. } => {
            Failure::result(error).with_help("choose another folder with --out")
        }
        error => Failure::run(&error).with_code(Code::of_result(&error)),
    }
}

/// A result that cannot be taken up again is an input that is wrong, unless the system refused.
fn damaged(error: ResultError) -> Failure {
    match error {
        // A file that is missing, or a folder in its place.
        ResultError::Io { ref source, .. }
            if matches!(source.kind(), ErrorKind::NotFound | ErrorKind::IsADirectory) =>
        {
            Failure::result(error).with_help(BEGIN_AGAIN)
        }
        ResultError::Io { .. } | ResultError::InUse { .. } => writing(error),
        error => Failure::result(error).with_help(BEGIN_AGAIN),
    }
}

fn cannot_write(path: &Path, error: std::io::Error) -> Failure {
    Failure::writing(path, &error)
}
