//! What a run says at its end.

use std::path::{Path, PathBuf};

use koiter::io::record::Summary;
use koiter::scene::readable_bytes;
use serde_json::Value;

use crate::output::say;

/// Prints the summary for people.
pub(super) fn print(summary: &Summary) {
    let gap = match summary.min_gap.is_finite() {
        true => format!("smallest gap {:.3e} m", summary.min_gap),
        false => "nothing came near anything".to_owned(),
    };
    say!(
        "{} steps to t = {:.3} s in {:.1} s, {} Newton iterations",
        summary.steps,
        summary.time,
        summary.seconds,
        summary.newton_iterations
    );
    if summary.steps_in_parts > 0 {
        say!(
            "{} steps were taken in parts, for they failed as a whole: 'cut' in stats.jsonl says why",
            summary.steps_in_parts
        );
    }
    match summary.intersections {
        Some(count) => say!("{count} intersections; {gap}"),
        None => say!("contact is off: intersections were not looked for"),
    }
    if let Some(bytes) = summary.peak_memory_bytes {
        say!(
            "{} vertices, {} triangles, {} at most",
            summary.vertices,
            summary.faces,
            readable_bytes(bytes as f64)
        );
    }
    for (name, value) in &summary.measures {
        say!("{}: {value:.4}", name.replace('_', " "));
    }
    if let Value::Object(probes) = &summary.probes {
        for (name, value) in probes {
            say!("probe {name}: {value}");
        }
    }
}

/// Prints where the result is, and the files made.
pub(super) fn print_files(folder: &Path, made: &[PathBuf]) {
    say!("result: {}", folder.display());
    for path in made {
        say!("made: {}", path.display());
    }
}
