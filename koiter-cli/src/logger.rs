//! The library's warnings on standard error.

use crate::output::say_error;
use log::{Level, LevelFilter, Log, Metadata, Record};

struct Warnings;

impl Log for Warnings {
    fn enabled(&self, metadata: &Metadata<'_>) -> bool {
        metadata.level() <= Level::Warn && metadata.target().starts_with("koiter")
    }

    fn log(&self, record: &Record<'_>) {
        if self.enabled(record.metadata()) {
            say_error!(
                "{}: {}",
                record.level().as_str().to_lowercase(),
                record.args()
            );
        }
    }

    fn flush(&self) {}
}

/// From now on the library is heard.
pub(crate) fn install() {
    // It fails only when a logger is installed already, which then does the same.
    if log::set_logger(&Warnings).is_ok() {
        log::set_max_level(LevelFilter::Warn);
    }
}
