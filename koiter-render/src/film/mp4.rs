//! MP4 (H.264) by way of `ffmpeg`, which gets raw frames through a pipe.

use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};
use std::process::{Child, ChildStdin, Command, Stdio};

use crate::error::FilmError;
use crate::image::Image;

pub(super) struct Writer {
    path: PathBuf,
    /// `None` once waited for.
    child: Option<Child>,
    pipe: Option<ChildStdin>,
    /// H.264 with colour at half resolution needs even sides: the last column and row are repeated.
    width: u32,
    height: u32,
}

impl Writer {
    pub(super) fn create(
        program: &str,
        path: &Path,
        fps: f64,
        width: u32,
        height: u32,
    ) -> Result<Self, FilmError> {
        let (width, height) = (width.next_multiple_of(2), height.next_multiple_of(2));
        let mut command = Command::new(program);
        command.args([
            "-hide_banner",
            "-loglevel",
            "error",
            "-y",
            "-f",
            "rawvideo",
            "-pix_fmt",
            "rgb24",
        ]);
        command.args([
            "-s",
            &format!("{width}x{height}"),
            "-r",
            &fps.to_string(),
            "-i",
            "-",
            "-an",
        ]);
        command.args([
            "-vf",
            "scale=out_color_matrix=bt709:out_range=tv",
            "-c:v",
            "libx264",
            "-preset",
            "medium",
        ]);
        command.args([
            "-crf",
            "17",
            "-pix_fmt",
            "yuv420p",
            "-colorspace",
            "bt709",
            "-color_primaries",
            "bt709",
        ]);
        command.args([
            "-color_trc",
            "bt709",
            "-color_range",
            "tv",
            "-movflags",
            "+faststart",
            "-f",
            "mp4",
        ]);
        // A name that starts with a dash is still a file.
        let file = if path.is_absolute() {
            path.to_owned()
        } else {
            Path::new(".").join(path)
        };
        let child = command
            .arg(file)
            .stdin(Stdio::piped())
            .stdout(Stdio::null())
            .stderr(Stdio::piped())
            .spawn();
        let mut child = child.map_err(|source| match source.kind() {
            ErrorKind::NotFound => FilmError::FfmpegMissing,
            _ => FilmError::Io {
                path: path.to_owned(),
                source,
            },
        })?;
        let pipe = child.stdin.take();
        Ok(Self {
            path: path.to_owned(),
            child: Some(child),
            pipe,
            width,
            height,
        })
    }

    pub(super) fn push(&mut self, frame: &Image) -> Result<(), FilmError> {
        let Some(pipe) = self.pipe.as_mut() else {
            return Ok(());
        };
        let written = if (frame.width(), frame.height()) == (self.width, self.height) {
            pipe.write_all(frame.bytes())
        } else {
            pipe.write_all(&padded(frame, self.width, self.height))
        };
        match written {
            Ok(()) => Ok(()),
            // ffmpeg has ended: it says why.
            Err(source) if source.kind() == ErrorKind::BrokenPipe => self.wait(),
            Err(source) => Err(FilmError::Io {
                path: self.path.clone(),
                source,
            }),
        }
    }

    pub(super) fn finish(mut self) -> Result<(), FilmError> {
        self.wait()
    }

    fn wait(&mut self) -> Result<(), FilmError> {
        drop(self.pipe.take());
        let Some(child) = self.child.take() else {
            return Ok(());
        };
        let output = child.wait_with_output().map_err(|source| FilmError::Io {
            path: self.path.clone(),
            source,
        })?;
        if output.status.success() {
            return Ok(());
        }
        let text = String::from_utf8_lossy(&output.stderr);
        let lines: Vec<&str> = text.trim().lines().collect();
        let message = lines[lines.len().saturating_sub(3)..].join("; ");
        Err(FilmError::Ffmpeg {
            message: if message.is_empty() {
                output.status.to_string()
            } else {
                message
            },
        })
    }
}

impl Drop for Writer {
    fn drop(&mut self) {
        if let Some(mut child) = self.child.take() {
            // The film is given up: whether ffmpeg is still there makes no difference.
            let _ = child.kill();
            let _ = child.wait();
        }
    }
}

fn padded(frame: &Image, width: u32, height: u32) -> Vec<u8> {
    let last = |side: u32, index: u32| index.min(side - 1);
    (0..height)
        .flat_map(|row| (0..width).map(move |column| (column, row)))
        .flat_map(|(column, row)| {
            frame
                .pixel(last(frame.width(), column), last(frame.height(), row))
                .unwrap_or_default()
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Film, Rgb};

    #[test]
    fn without_ffmpeg_the_error_says_what_to_do() {
        let error = Writer::create("koiter-no-such-program", Path::new("a.mp4"), 10.0, 8, 6).err();
        let error = error.expect("there is no such program");
        assert_eq!(
            error.to_string(),
            "ffmpeg not found; write .gif instead or install ffmpeg"
        );
    }

    #[test]
    fn odd_sides_repeat_the_last_column_and_row() {
        let frame = Image::from_bytes(1, 1, vec![1, 2, 3]).unwrap();
        assert_eq!(padded(&frame, 2, 2), [1, 2, 3].repeat(4));
    }

    #[test]
    fn an_odd_sized_film_is_written_when_ffmpeg_is_there() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("film.mp4");
        let mut film = match Film::create(&path, 24.0, 33, 17) {
            Err(FilmError::FfmpegMissing) => return,
            film => film.unwrap(),
        };
        (0..5).for_each(|_| film.push(&Image::new(33, 17, Rgb::OCHRE)).unwrap());
        film.finish().unwrap();
        let bytes = std::fs::read(&path).unwrap();
        assert_eq!(&bytes[4..8], b"ftyp");
    }

    #[test]
    fn a_film_that_ffmpeg_cannot_write_says_why() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("missing/film.mp4");
        let mut film = match Film::create(&path, 24.0, 32, 16) {
            Err(FilmError::FfmpegMissing) => return,
            film => film.unwrap(),
        };
        let frame = Image::new(32, 16, Rgb::OCHRE);
        let result = (0..100)
            .try_for_each(|_| film.push(&frame))
            .and_then(|()| film.finish());
        assert!(matches!(result, Err(FilmError::Ffmpeg { .. })));
    }
}
