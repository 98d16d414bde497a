//! A run that is played with: at the pace of the clock, with a hand that pulls at its shells.

use std::path::{Path, PathBuf};
use std::thread;
use std::time::{Duration, Instant};

use koiter::io::result::Hand;
use koiter::scene::{Simulation, Timeline, VertexPull};

use super::refusals;
use crate::failure::Failure;

/// Without --until a run that is played with goes on for so long, or for as long as its scene says [s].
const PLAYED: f64 = 120.0;
/// A wait is no longer than this, so that a request to end is soon seen.
const LONGEST_WAIT: Duration = Duration::from_millis(100);

/// The hand of a run.
pub(super) struct Playing {
    folder: PathBuf,
    hand: Hand,
    /// When the run was at which time [s].
    begun: (Instant, f64),
}

/// How far a run that is played with goes where nothing else is said [s].
pub(super) fn played_until(timeline: &Timeline) -> f64 {
    timeline.time(timeline.num_steps()).max(PLAYED)
}

impl Playing {
    /// Lets hands pull from now on.
    pub(super) fn begin(folder: &Path, simulation: &Simulation) -> Result<Self, Failure> {
        Hand::Released.write(folder).map_err(refusals::writing)?;
        Ok(Self {
            folder: folder.to_owned(),
            hand: Hand::Released,
            begun: (Instant::now(), simulation.time()),
        })
    }

    /// Waits until the clock has come to where the simulation is, and has it pulled as the hand says.
    pub(super) fn before_step(&mut self, simulation: &mut Simulation) {
        let (began, start) = self.begun;
        let ahead = simulation.time() - start - began.elapsed().as_secs_f64();
        if ahead > 0.0 {
            thread::sleep(Duration::from_secs_f64(ahead).min(LONGEST_WAIT));
        } else {
            // What took longer is not made up for.
            self.begun = (Instant::now(), simulation.time());
        }
        let hand = Hand::read(&self.folder).unwrap_or(Hand::Released);
        if hand == self.hand {
            return;
        }
        self.hand = hand;
        let pulls = match hand {
            Hand::Released => vec![],
            Hand::Pulls { vertex, target } => vec![VertexPull { vertex, target }],
        };
        if let Err(error) = simulation.set_pulls(&pulls) {
            log::warn!(target: "koiter", "{error}");
        }
    }
}

impl Drop for Playing {
    fn drop(&mut self) {
        Hand::withdraw(&self.folder);
    }
}
