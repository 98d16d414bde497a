//! Films: animated PNG, GIF, and MP4 through `ffmpeg`, chosen by the extension of the file.

mod apng;
mod gif;
mod mp4;

use std::path::{Path, PathBuf};

use crate::error::FilmError;
use crate::image::{Image, partial_name};
use crate::options::MAX_SIDE;

/// A film that is being written.
///
/// The file has a hidden temporary name until [`Film::finish`]; a film that is dropped before leaves nothing behind.
pub struct Film {
    path: PathBuf,
    partial: PathBuf,
    size: (u32, u32),
    frames: usize,
    /// `None` once finished.
    sink: Option<Sink>,
}

enum Sink {
    Png(apng::Writer),
    Gif(Box<gif::Writer>),
    Mp4(mp4::Writer),
}

impl Film {
    /// Starts a film. The extension says the format: `.mp4`, `.gif` or `.png` (animated).
    ///
    /// GIF can show at most 50 frames a second: beyond that, frames are left out.
    ///
    /// # Errors
    /// [`FilmError`] for an unknown extension, a size or rate out of range, a file that cannot be written, or an mp4
    /// without `ffmpeg`.
    pub fn create(
        path: impl AsRef<Path>,
        fps: f64,
        width: u32,
        height: u32,
    ) -> Result<Self, FilmError> {
        let path = path.as_ref().to_owned();
        if !(0.1..=1000.0).contains(&fps) {
            return Err(FilmError::FrameRate { fps });
        }
        if !(1..=MAX_SIDE).contains(&width) || !(1..=MAX_SIDE).contains(&height) {
            return Err(FilmError::Size { width, height });
        }
        let extension = path
            .extension()
            .unwrap_or_default()
            .to_string_lossy()
            .to_ascii_lowercase();
        let partial = partial_name(&path);
        let sink = match extension.as_str() {
            "png" | "apng" => apng::Writer::create(&partial, fps, width, height).map(Sink::Png),
            "gif" => gif::Writer::create(&partial, fps, width, height)
                .map(|writer| Sink::Gif(Box::new(writer))),
            "mp4" => mp4::Writer::create("ffmpeg", &partial, fps, width, height).map(Sink::Mp4),
            _ => return Err(FilmError::Extension { path }),
        };
        let sink = sink.map_err(|error| naming(&path, &partial, error))?;
        Ok(Self {
            path,
            partial,
            size: (width, height),
            frames: 0,
            sink: Some(sink),
        })
    }

    /// Adds a frame.
    ///
    /// # Errors
    /// [`FilmError::FrameSize`] for a picture of another size; others when it cannot be written.
    pub fn push(&mut self, frame: &Image) -> Result<(), FilmError> {
        let found = (frame.width(), frame.height());
        if found != self.size {
            return Err(FilmError::FrameSize {
                frame: self.frames,
                found,
                expected: self.size,
            });
        }
        let pushed = match self.sink.as_mut() {
            Some(Sink::Png(writer)) => writer.push(frame),
            Some(Sink::Gif(writer)) => writer.push(frame),
            Some(Sink::Mp4(writer)) => writer.push(frame),
            None => Ok(()),
        };
        pushed.map_err(|error| naming(&self.path, &self.partial, error))?;
        self.frames += 1;
        Ok(())
    }

    /// Completes the file and gives it its name. A GIF finds its colours and is encoded only now.
    ///
    /// # Errors
    /// [`FilmError::NoFrames`] without frames; others when it cannot be written.
    pub fn finish(mut self) -> Result<(), FilmError> {
        if self.frames == 0 {
            return Err(FilmError::NoFrames);
        }
        let finished = match self.sink.take() {
            Some(Sink::Png(writer)) => writer.finish(self.frames as u32),
            Some(Sink::Gif(writer)) => writer.finish(),
            Some(Sink::Mp4(writer)) => writer.finish(),
            None => Ok(()),
        };
        finished.map_err(|error| naming(&self.path, &self.partial, error))?;
        std::fs::rename(&self.partial, &self.path).map_err(|source| FilmError::Io {
            path: self.path.clone(),
            source,
        })
    }
}

/// The user knows the film by its own name, not by the one it has while it is written.
fn naming(path: &Path, partial: &Path, error: FilmError) -> FilmError {
    match error {
        FilmError::Io { source, .. } => FilmError::Io {
            path: path.to_owned(),
            source,
        },
        FilmError::Ffmpeg { message } => FilmError::Ffmpeg {
            message: message.replace(&*partial.to_string_lossy(), &path.to_string_lossy()),
        },
        error => error,
    }
}

impl Drop for Film {
    fn drop(&mut self) {
        // Ends a waiting ffmpeg, or closes the file, before the leftover is removed; after `finish` there is none.
        drop(self.sink.take());
        let _ = std::fs::remove_file(&self.partial);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::color::Rgb;

    fn names(folder: &Path) -> Vec<String> {
        let entries = std::fs::read_dir(folder).unwrap();
        entries
            .map(|entry| entry.unwrap().file_name().to_string_lossy().into_owned())
            .collect()
    }

    #[test]
    fn a_film_has_its_name_only_when_it_is_finished() {
        for name in ["a.png", "a.gif"] {
            let folder = tempfile::tempdir().unwrap();
            let path = folder.path().join(name);
            let mut film = Film::create(&path, 10.0, 8, 6).unwrap();
            film.push(&Image::new(8, 6, Rgb::RED)).unwrap();
            assert!(!path.exists());
            film.finish().unwrap();
            assert_eq!(names(folder.path()), [name]);
        }
    }

    #[test]
    fn a_dropped_film_leaves_nothing() {
        let folder = tempfile::tempdir().unwrap();
        for name in ["a.png", "a.gif"] {
            let mut film = Film::create(folder.path().join(name), 10.0, 8, 6).unwrap();
            film.push(&Image::new(8, 6, Rgb::RED)).unwrap();
        }
        assert!(names(folder.path()).is_empty());
    }

    #[test]
    fn what_cannot_become_a_film_is_refused() {
        let folder = tempfile::tempdir().unwrap();
        let create = |name: &str, fps, width| Film::create(folder.path().join(name), fps, width, 6);
        assert!(matches!(
            create("a.avi", 10.0, 8),
            Err(FilmError::Extension { .. })
        ));
        assert!(matches!(
            create("a.gif", f64::NAN, 8),
            Err(FilmError::FrameRate { .. })
        ));
        assert!(matches!(
            create("a.gif", 10.0, 0),
            Err(FilmError::Size { .. })
        ));
        assert!(matches!(
            create("no/such/folder.gif", 10.0, 8),
            Err(FilmError::Io { .. })
        ));
        assert!(matches!(
            create("a.gif", 10.0, 8).unwrap().finish(),
            Err(FilmError::NoFrames)
        ));
        let unlike = create("a.gif", 10.0, 8)
            .unwrap()
            .push(&Image::new(9, 6, Rgb::RED));
        assert!(matches!(unlike, Err(FilmError::FrameSize { frame: 0, .. })));
    }
}
