//! What a run is asked while it goes on: by signals, or by a word in its folder.

use std::path::Path;
use std::thread;
use std::time::Duration;

use koiter::io::result::RunRequest;

use crate::interrupt::Interrupt;
use crate::output::say_error;

/// How often a run that waits looks whether it may go on.
const PATIENCE: Duration = Duration::from_millis(100);

/// Who may end a run or have it wait.
pub(super) struct Control<'a> {
    folder: &'a Path,
    interrupt: &'a Interrupt,
    is_quiet: bool,
}

impl<'a> Control<'a> {
    pub(super) fn new(folder: &'a Path, interrupt: &'a Interrupt, is_quiet: bool) -> Self {
        Self {
            folder,
            interrupt,
            is_quiet,
        }
    }

    /// Waits as long as `request.txt` says pause and no signal comes.
    pub(super) fn wait_while_paused(&self) {
        let is_paused = || RunRequest::read(self.folder) == Some(RunRequest::Pause);
        if !is_paused() {
            return;
        }
        if !self.is_quiet {
            say_error!(
                "paused by request.txt in the result folder; it goes on when that file is gone"
            );
        }
        while is_paused() && !self.interrupt.is_asked() {
            thread::sleep(PATIENCE);
        }
    }

    /// Whether this step is to be the last.
    pub(super) fn is_to_end(&self) -> bool {
        self.interrupt.is_asked() || RunRequest::read(self.folder) == Some(RunRequest::Stop)
    }

    /// A request to end is done: the next run in this folder is not meant.
    pub(super) fn obeyed(&self) {
        if let Err(error) = RunRequest::withdraw(self.folder) {
            log::warn!(target: "koiter", "{error}");
        }
    }
}
