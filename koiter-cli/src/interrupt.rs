//! What Ctrl-C and SIGTERM do.

use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

use crate::output::say_error;

/// Hears the signals that ask the program to end.
#[derive(Default)]
pub(crate) struct Interrupt {
    is_asked: AtomicBool,
    last_act: Mutex<Option<LastAct>>,
}

/// What is said and which files go when the program ends at once.
struct LastAct {
    words: String,
    partial_files: Vec<PathBuf>,
}

impl Interrupt {
    /// From now on the first signal asks for an end, and the second ends the program.
    pub(crate) fn watch() -> Arc<Self> {
        let interrupt = Arc::new(Self::default());
        let heard = interrupt.clone();
        // Without a handler a signal ends the program at once, which leaves whole frames too.
        let _ = ctrlc::set_handler(move || heard.hear());
        interrupt
    }

    /// Whether an end was asked for.
    pub(crate) fn is_asked(&self) -> bool {
        self.is_asked.load(Ordering::Relaxed)
    }

    /// From now on a signal ends the program at once: it says these words and removes the files that are not whole.
    pub(crate) fn end_at_once(&self, words: String, partial_files: Vec<PathBuf>) {
        let act = LastAct {
            words,
            partial_files,
        };
        *self.last_act.lock().unwrap_or_else(PoisonError::into_inner) = Some(act);
    }

    fn hear(&self) {
        let last_act = self.last_act.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(act) = &*last_act {
            for path in &act.partial_files {
                let _ = std::fs::remove_file(path);
            }
            say_error!("{}", act.words);
            std::process::exit(1);
        }
        if self.is_asked.swap(true, Ordering::Relaxed) {
            std::process::exit(1);
        }
        say_error!("ending after this step, which saves the run; Ctrl-C again ends at once");
    }
}
