//! Animated PNG: lossless, and shown by browsers.

use std::fs::File;
use std::io::{BufWriter, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

use crate::error::FilmError;
use crate::image::Image;

/// The chunk that says the number of frames follows the signature (8 bytes) and the header (25).
const CONTROL: u64 = 8 + 25;

pub(super) struct Writer {
    path: PathBuf,
    file: File,
    writer: png::Writer<BufWriter<File>>,
}

impl Writer {
    pub(super) fn create(
        path: &Path,
        fps: f64,
        width: u32,
        height: u32,
    ) -> Result<Self, FilmError> {
        let io = |source| FilmError::Io {
            path: path.to_owned(),
            source,
        };
        let file = File::create(path).map_err(io)?;
        let mut encoder =
            png::Encoder::new(BufWriter::new(file.try_clone().map_err(io)?), width, height);
        encoder.set_color(png::ColorType::Rgb);
        encoder.set_depth(png::BitDepth::Eight);
        encoder.set_compression(png::Compression::Balanced);
        // The number of frames is not known yet: `finish` puts it in.
        encoder.set_animated(u32::MAX >> 1, 0)?;
        let (numerator, denominator) = delay(fps);
        encoder.set_frame_delay(numerator, denominator)?;
        Ok(Self {
            path: path.to_owned(),
            file,
            writer: encoder.write_header()?,
        })
    }

    pub(super) fn push(&mut self, frame: &Image) -> Result<(), FilmError> {
        Ok(self.writer.write_image_data(frame.bytes())?)
    }

    pub(super) fn finish(mut self, frames: u32) -> Result<(), FilmError> {
        self.writer.finish()?;
        let mut chunk = b"acTL".to_vec();
        chunk.extend(frames.to_be_bytes());
        chunk.extend(0u32.to_be_bytes());
        chunk.extend(crc(&chunk).to_be_bytes());
        // After the length of the chunk.
        let seek = self.file.seek(SeekFrom::Start(CONTROL + 4));
        seek.and_then(|_| self.file.write_all(&chunk))
            .map_err(|source| FilmError::Io {
                path: self.path,
                source,
            })
    }
}

/// Seconds a frame as a fraction of two 16-bit numbers.
fn delay(fps: f64) -> (u16, u16) {
    if fps >= 1.0 && fps.fract() == 0.0 {
        (1, fps as u16)
    } else {
        ((1000.0 / fps).round() as u16, 1000)
    }
}

/// The checksum of PNG chunks (ISO 15948, annex D).
fn crc(bytes: &[u8]) -> u32 {
    !bytes.iter().fold(u32::MAX, |crc, &byte| {
        (0..8).fold(crc ^ u32::from(byte), |c, _| {
            if c & 1 == 1 {
                c >> 1 ^ 0xedb8_8320
            } else {
                c >> 1
            }
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Film, Rgb};

    #[test]
    fn every_frame_decodes_to_its_bytes() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("film.png");
        let frames = [Rgb::RED, Rgb::BLUE, Rgb::SAGE].map(|color| Image::new(7, 5, color));
        let mut film = Film::create(&path, 12.5, 7, 5).unwrap();
        frames.iter().for_each(|frame| film.push(frame).unwrap());
        film.finish().unwrap();
        let file = std::io::BufReader::new(File::open(&path).unwrap());
        let mut reader = png::Decoder::new(file).read_info().unwrap();
        assert_eq!(
            reader
                .info()
                .animation_control
                .map(|control| control.num_frames),
            Some(3)
        );
        let mut bytes = vec![0; reader.output_buffer_size().unwrap()];
        for frame in &frames {
            reader.next_frame(&mut bytes).unwrap();
            assert_eq!(bytes, frame.bytes());
            let control = reader.info().frame_control.unwrap();
            assert_eq!((control.delay_num, control.delay_den), (80, 1000));
        }
    }

    #[test]
    fn the_checksum_is_that_of_the_standard() {
        // The checksum of the empty end chunk stands at the end of every PNG file.
        assert_eq!(crc(b"IEND"), 0xae42_6082);
    }
}
