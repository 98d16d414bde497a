//! `koiter render`: a picture or a film of a result.

use crate::output::say;
use koiter::io::result::ResultReader;
use serde_json::json;

use crate::arguments::RenderArguments;
use crate::failure::Failure;
use crate::interrupt::Interrupt;
use crate::output_path;
use crate::pictures::{Album, Look};

/// Makes a picture or a film.
pub(crate) fn render(arguments: &RenderArguments) -> Result<(), Failure> {
    let extension = arguments
        .output
        .extension()
        .unwrap_or_default()
        .to_string_lossy()
        .to_ascii_lowercase();
    if !["png", "mp4", "gif"].contains(&extension.as_str()) {
        let message = format!(
            "{}: a picture ends in .png, a film in .mp4 or .gif",
            arguments.output.display()
        );
        return Err(Failure::input(message));
    }
    output_path::check(&arguments.output)?;
    let reader = ResultReader::open(&arguments.result).map_err(Failure::result)?;
    let look = Look {
        size: arguments.size,
        camera: arguments.camera.unwrap_or_default(),
        color: arguments.color.clone(),
        wireframe: arguments.wireframe,
    };
    let album = Album::open(&reader, look)?;
    let words = format!("{} is not made", arguments.output.display());
    Interrupt::watch().end_at_once(
        words,
        koiter_render::partial_files(&arguments.output).into(),
    );
    if extension == "png" {
        album.picture(arguments.frame.unwrap_or(album.last()), &arguments.output)?;
    } else if arguments.frame.is_some() {
        return Err(Failure::input(
            "--frame is for pictures; a film has all frames",
        ));
    } else {
        album.film(&arguments.output, arguments.fps, true)?;
    }
    if arguments.json {
        let (width, height) = arguments.size;
        let made = arguments.output.display().to_string();
        say!(
            "{}",
            json!({ "made": made, "width": width, "height": height, "frames": reader.len() })
        );
    } else {
        say!("made: {}", arguments.output.display());
    }
    Ok(())
}
