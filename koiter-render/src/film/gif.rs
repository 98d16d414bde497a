//! Animated GIF: one palette for all frames, ordered dither, and only what changes from frame to frame.

use std::fs::File;
use std::io::{BufReader, BufWriter, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

use crate::error::FilmError;
use crate::image::Image;
use crate::palette::{COLORS, Histogram, Palette};

/// The entry that leaves a pixel as it was.
const UNCHANGED: u8 = COLORS as u8;
/// Players slow down films with shorter delays (1/100 s).
const LEAST_DELAY: u64 = 2;

/// Frames wait in the file itself, compressed, until all colours are known.
pub(super) struct Writer {
    path: PathBuf,
    file: File,
    lengths: Vec<u64>,
    histogram: Histogram,
    fps: f64,
    width: u16,
    height: u16,
}

impl Writer {
    pub(super) fn create(
        path: &Path,
        fps: f64,
        width: u32,
        height: u32,
    ) -> Result<Self, FilmError> {
        let file = File::options()
            .create(true)
            .truncate(true)
            .read(true)
            .write(true)
            .open(path);
        let file = file.map_err(|source| FilmError::Io {
            path: path.to_owned(),
            source,
        })?;
        // Sides are below 16384: see `Film::create`.
        let (width, height) = (width as u16, height as u16);
        Ok(Self {
            path: path.to_owned(),
            file,
            lengths: Vec::new(),
            histogram: Histogram::new(),
            fps,
            width,
            height,
        })
    }

    pub(super) fn push(&mut self, frame: &Image) -> Result<(), FilmError> {
        self.histogram.add(frame.bytes());
        let mut bytes = Vec::new();
        frame.encode_png(&mut bytes, png::Compression::Fast)?;
        self.lengths.push(bytes.len() as u64);
        self.file
            .write_all(&bytes)
            .map_err(|source| self.io(source))
    }

    pub(super) fn finish(mut self) -> Result<(), FilmError> {
        let palette = Palette::new(&self.histogram);
        let encoded = self.path.with_extension("encoded.gif");
        let result = self.encode(&palette, &encoded);
        drop(self.file);
        let io = |source| FilmError::Io {
            path: self.path.clone(),
            source,
        };
        if result.is_err() {
            let _ = std::fs::remove_file(&encoded);
            return result;
        }
        std::fs::rename(&encoded, &self.path).map_err(io)
    }

    fn encode(&mut self, palette: &Palette, path: &Path) -> Result<(), FilmError> {
        let sink = BufWriter::new(File::create(path).map_err(|source| self.io(source))?);
        let mut encoder = gif::Encoder::new(sink, self.width, self.height, &palette.bytes())?;
        encoder.set_repeat(gif::Repeat::Infinite)?;
        self.file
            .seek(SeekFrom::Start(0))
            .map_err(|source| self.io(source))?;
        let delays = delays(self.lengths.len(), self.fps);
        let mut before: Option<(Vec<u8>, Vec<u8>)> = None;
        for (index, delay) in delays.into_iter().enumerate() {
            let bytes = self.read_back(index)?;
            let Some(delay) = delay else { continue };
            let shown = before
                .as_ref()
                .map(|(bytes, entries)| (&bytes[..], &entries[..]));
            let entries = palette.entries(&bytes, usize::from(self.width), shown);
            let frame = changed(&entries, shown.map(|(_, entries)| entries), self.width);
            encoder.write_frame(&gif::Frame { delay, ..frame })?;
            before = Some((bytes, entries));
        }
        let mut sink = encoder.into_inner()?;
        sink.flush().map_err(|source| self.io(source))
    }

    fn read_back(&mut self, index: usize) -> Result<Vec<u8>, FilmError> {
        let mut encoded = vec![0; self.lengths[index] as usize];
        self.file
            .read_exact(&mut encoded)
            .map_err(|source| self.io(source))?;
        let broken = |error: png::DecodingError| std::io::Error::other(error);
        let decode = || {
            let mut reader =
                png::Decoder::new(BufReader::new(std::io::Cursor::new(&encoded))).read_info()?;
            let mut bytes = vec![0; 3 * usize::from(self.width) * usize::from(self.height)];
            reader.next_frame(&mut bytes)?;
            Ok(bytes)
        };
        decode().map_err(|error| self.io(broken(error)))
    }

    fn io(&self, source: std::io::Error) -> FilmError {
        FilmError::Io {
            path: self.path.clone(),
            source,
        }
    }
}

/// How long each frame is shown (1/100 s), so that the film keeps time; `None` for frames to leave out.
fn delays(count: usize, fps: f64) -> Vec<Option<u16>> {
    // The time up to which the frames so far fill the film.
    let mut filled = 0;
    (0..count)
        .map(|index| {
            let end = ((index + 1) as f64 * 100.0 / fps).round() as u64;
            if end < filled + LEAST_DELAY && index > 0 {
                return None;
            }
            let delay = end
                .saturating_sub(filled)
                .clamp(LEAST_DELAY, u64::from(u16::MAX));
            filled += delay;
            Some(delay as u16)
        })
        .collect()
}

/// The smallest rectangle that holds all changes; within it, what is the same is left as it was.
fn changed(entries: &[u8], before: Option<&[u8]>, width: u16) -> gif::Frame<'static> {
    let columns = usize::from(width);
    let Some(before) = before else {
        let height = (entries.len() / columns) as u16;
        return gif::Frame {
            width,
            height,
            buffer: entries.to_vec().into(),
            ..gif::Frame::default()
        };
    };
    let (mut left, mut right, mut top, mut bottom) = (columns, 0, usize::MAX, 0);
    for (row, (new, old)) in entries
        .chunks_exact(columns)
        .zip(before.chunks_exact(columns))
        .enumerate()
    {
        let Some(first) = new.iter().zip(old).position(|(a, b)| a != b) else {
            continue;
        };
        let last = new
            .iter()
            .zip(old)
            .rposition(|(a, b)| a != b)
            .unwrap_or(first);
        (left, right) = (left.min(first), right.max(last + 1));
        (top, bottom) = (top.min(row), row + 1);
    }
    if top == usize::MAX {
        // Nothing changed: one pixel keeps the time.
        (left, right, top, bottom) = (0, 1, 0, 1);
    }
    let mut buffer = Vec::with_capacity((right - left) * (bottom - top));
    for row in top..bottom {
        let range = row * columns + left..row * columns + right;
        let pairs = entries[range.clone()].iter().zip(&before[range]);
        buffer.extend(pairs.map(|(&new, &old)| if new == old { UNCHANGED } else { new }));
    }
    gif::Frame {
        left: left as u16,
        top: top as u16,
        width: (right - left) as u16,
        height: (bottom - top) as u16,
        transparent: Some(UNCHANGED),
        dispose: gif::DisposalMethod::Keep,
        buffer: buffer.into(),
        ..gif::Frame::default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Film, Rgb};

    #[test]
    fn a_film_decodes_again_with_the_right_colours_and_times() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("film.gif");
        let mut film = Film::create(&path, 30.0, 20, 10).unwrap();
        for step in 0..4 {
            let mut frame = Image::new(20, 10, Rgb::BLUE);
            (0..10).for_each(|row| frame.blend(step, row, [255, 0, 0], 1.0));
            film.push(&frame).unwrap();
        }
        film.finish().unwrap();
        let mut options = gif::DecodeOptions::new();
        options.set_color_output(gif::ColorOutput::RGBA);
        let mut decoder = options.read_info(File::open(&path).unwrap()).unwrap();
        assert_eq!((decoder.width(), decoder.height()), (20, 10));
        let mut canvas = vec![[0u8; 4]; 200];
        let mut time = 0;
        for step in 0..4 {
            let frame = decoder.read_next_frame().unwrap().unwrap();
            time += frame.delay;
            for (index, pixel) in frame
                .buffer
                .chunks_exact(4)
                .enumerate()
                .filter(|(_, pixel)| pixel[3] > 0)
            {
                let (x, y) = (
                    index % usize::from(frame.width),
                    index / usize::from(frame.width),
                );
                let at = (y + usize::from(frame.top)) * 20 + x + usize::from(frame.left);
                canvas[at].copy_from_slice(pixel);
            }
            let [r, g, b] = Rgb::BLUE.to_bytes();
            assert_eq!(
                (canvas[step], canvas[step + 1]),
                ([255, 0, 0, 255], [r, g, b, 255])
            );
        }
        assert_eq!(time, 13);
        assert!(decoder.read_next_frame().unwrap().is_none());
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
    }

    #[test]
    fn delays_keep_time_and_fast_films_lose_frames() {
        assert_eq!(delays(3, 30.0), [Some(3), Some(4), Some(3)]);
        assert_eq!(delays(2, 0.5), [Some(200), Some(200)]);
        let fast = delays(100, 100.0);
        let total: u64 = fast.iter().flatten().map(|&delay| u64::from(delay)).sum();
        assert!((100..=104).contains(&total), "{total}");
        assert!(
            fast.iter()
                .flatten()
                .all(|&delay| u64::from(delay) >= LEAST_DELAY)
        );
    }

    #[test]
    fn a_frame_without_change_is_one_pixel() {
        let frame = changed(&[1; 12], Some(&[1; 12]), 4);
        assert_eq!(
            (frame.width, frame.height, &frame.buffer[..]),
            (1, 1, &[UNCHANGED][..])
        );
    }
}
