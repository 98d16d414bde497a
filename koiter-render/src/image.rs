//! Pictures, PNG files and contact sheets.

use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};

use crate::color::Rgb;
use crate::error::ImageError;

/// A picture: rows from the top, three sRGB bytes a pixel.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Image {
    width: u32,
    height: u32,
    bytes: Vec<u8>,
}

impl Image {
    /// A picture of one colour.
    #[must_use]
    pub fn new(width: u32, height: u32, color: Rgb) -> Self {
        let bytes = color.to_bytes().repeat(width as usize * height as usize);
        Self {
            width,
            height,
            bytes,
        }
    }

    /// A picture from its bytes, `None` unless there are three for each pixel.
    #[must_use]
    pub fn from_bytes(width: u32, height: u32, bytes: Vec<u8>) -> Option<Self> {
        (bytes.len() == 3 * width as usize * height as usize).then_some(Self {
            width,
            height,
            bytes,
        })
    }

    /// Width (pixels).
    #[must_use]
    pub fn width(&self) -> u32 {
        self.width
    }

    /// Height (pixels).
    #[must_use]
    pub fn height(&self) -> u32 {
        self.height
    }

    /// Rows from the top, three sRGB bytes a pixel.
    #[must_use]
    pub fn bytes(&self) -> &[u8] {
        &self.bytes
    }

    /// The pixel in a column and row, `None` outside.
    #[must_use]
    pub fn pixel(&self, column: u32, row: u32) -> Option<[u8; 3]> {
        let start = self.start_of(column, row)?;
        Some([
            self.bytes[start],
            self.bytes[start + 1],
            self.bytes[start + 2],
        ])
    }

    /// Writes a PNG file, under a temporary name until it is complete.
    ///
    /// # Errors
    /// [`ImageError`] when the file cannot be written.
    pub fn write_png(&self, path: impl AsRef<Path>) -> Result<(), ImageError> {
        let path = path.as_ref();
        let io = |source| ImageError::Io {
            path: path.to_owned(),
            source,
        };
        let partial = partial_name(path);
        let mut file = BufWriter::new(File::create(&partial).map_err(io)?);
        let encoded = self.encode_png(&mut file, png::Compression::Balanced);
        let written = encoded
            .map_err(|source| ImageError::Png {
                path: path.to_owned(),
                source,
            })
            .and_then(|()| file.flush().map_err(io))
            .and_then(|()| std::fs::rename(&partial, path).map_err(io));
        if written.is_err() {
            // The file is of no use; that it cannot be removed either is not worth more words.
            let _ = std::fs::remove_file(&partial);
        }
        written
    }

    /// The bytes of a PNG file.
    pub fn png_bytes(&self) -> Vec<u8> {
        let mut bytes = Vec::new();
        self.encode_png(&mut bytes, png::Compression::Balanced)
            .expect("a picture has as many bytes as its size says, and memory takes them");
        bytes
    }

    pub(crate) fn encode_png(
        &self,
        sink: impl Write,
        effort: png::Compression,
    ) -> Result<(), png::EncodingError> {
        let mut encoder = png::Encoder::new(sink, self.width, self.height);
        encoder.set_color(png::ColorType::Rgb);
        encoder.set_depth(png::BitDepth::Eight);
        encoder.set_source_srgb(png::SrgbRenderingIntent::Perceptual);
        encoder.set_compression(effort);
        let mut writer = encoder.write_header()?;
        writer.write_image_data(&self.bytes)?;
        writer.finish()
    }

    /// Covers a pixel with a colour, wholly (1), partly or not at all (0). Nothing happens outside.
    pub(crate) fn blend(&mut self, column: i64, row: i64, color: [u8; 3], cover: f32) {
        let (Ok(column), Ok(row)) = (u32::try_from(column), u32::try_from(row)) else {
            return;
        };
        let Some(start) = self.start_of(column, row) else {
            return;
        };
        for (byte, target) in self.bytes[start..start + 3].iter_mut().zip(color) {
            let mixed =
                f32::from(*byte) + cover.clamp(0.0, 1.0) * (f32::from(target) - f32::from(*byte));
            *byte = (mixed + 0.5) as u8;
        }
    }

    fn start_of(&self, column: u32, row: u32) -> Option<usize> {
        let is_inside = column < self.width && row < self.height;
        is_inside.then(|| 3 * (row as usize * self.width as usize + column as usize))
    }
}

/// Several pictures of one size as one, row by row, with white between them.
///
/// # Errors
/// [`ImageError::EmptySheet`] without pictures or columns, [`ImageError::SheetSize`] when sizes differ.
pub fn contact_sheet(images: &[Image], columns: usize) -> Result<Image, ImageError> {
    let [first, ..] = images else {
        return Err(ImageError::EmptySheet);
    };
    if columns == 0 {
        return Err(ImageError::EmptySheet);
    }
    let expected = (first.width, first.height);
    if let Some(index) = images
        .iter()
        .position(|image| (image.width, image.height) != expected)
    {
        return Err(ImageError::SheetSize {
            index,
            found: (images[index].width, images[index].height),
            expected,
        });
    }
    let gap = (first.width.min(first.height) / 60).max(1);
    let columns = columns.min(images.len()) as u32;
    let rows = (images.len() as u32).div_ceil(columns);
    let side = |count: u32, size: u32| count * size + (count - 1) * gap;
    let mut sheet = Image::new(
        side(columns, first.width),
        side(rows, first.height),
        Rgb::WHITE,
    );
    for (index, image) in images.iter().enumerate() {
        let left = (index as u32 % columns) * (first.width + gap);
        let top = (index as u32 / columns) * (first.height + gap);
        for row in 0..image.height {
            let (Some(from), Some(to)) = (image.start_of(0, row), sheet.start_of(left, top + row))
            else {
                continue;
            };
            let length = 3 * image.width as usize;
            sheet.bytes[to..to + length].copy_from_slice(&image.bytes[from..from + length]);
        }
    }
    Ok(sheet)
}

/// What is left of a picture or film that was being written when the program was killed, if anything: a GIF has two files.
pub fn partial_files(path: &Path) -> [PathBuf; 2] {
    let partial = partial_name(path);
    [partial.with_extension("encoded.gif"), partial]
}

/// The name of a file while it is being written: hidden, in the same folder, with the same extension.
pub(crate) fn partial_name(path: &Path) -> PathBuf {
    let stem = path.file_stem().unwrap_or_default().to_string_lossy();
    let extension = path.extension().unwrap_or_default().to_string_lossy();
    path.with_file_name(format!(".{stem}.partial.{extension}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A picture in which every pixel differs.
    fn ramp(width: u32, height: u32) -> Image {
        let bytes = (0..3 * width * height)
            .map(|i| (i * 7 % 251) as u8)
            .collect();
        Image::from_bytes(width, height, bytes).unwrap()
    }

    #[test]
    fn a_png_decodes_to_the_same_bytes_and_leaves_nothing_else() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("ramp.png");
        let image = ramp(13, 9);
        image.write_png(&path).unwrap();
        let mut reader = png::Decoder::new(std::io::BufReader::new(File::open(&path).unwrap()))
            .read_info()
            .unwrap();
        let mut bytes = vec![0; reader.output_buffer_size().unwrap()];
        let info = reader.next_frame(&mut bytes).unwrap();
        assert_eq!(
            (info.width, info.height, &bytes[..]),
            (13, 9, image.bytes())
        );
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
    }

    #[test]
    fn a_png_in_a_missing_folder_is_an_error_that_names_it() {
        let error = ramp(2, 2).write_png("/no/such/folder/a.png").unwrap_err();
        assert!(error.to_string().contains("/no/such/folder/a.png"));
    }

    #[test]
    fn a_contact_sheet_holds_every_picture() {
        let sheet = contact_sheet(
            &[ramp(60, 60), Image::new(60, 60, Rgb::RED), ramp(60, 60)],
            2,
        )
        .unwrap();
        assert_eq!((sheet.width(), sheet.height()), (121, 121));
        assert_eq!(sheet.pixel(0, 61), ramp(60, 60).pixel(0, 0));
        assert_eq!(sheet.pixel(61, 0), Some(Rgb::RED.to_bytes()));
        assert_eq!(sheet.pixel(120, 120), Some([255; 3]));
    }

    #[test]
    fn a_contact_sheet_of_nothing_or_of_unlike_pictures_is_an_error() {
        assert!(matches!(contact_sheet(&[], 2), Err(ImageError::EmptySheet)));
        assert!(matches!(
            contact_sheet(&[ramp(2, 2)], 0),
            Err(ImageError::EmptySheet)
        ));
        let unlike = contact_sheet(&[ramp(2, 2), ramp(3, 2)], 2);
        assert!(matches!(
            unlike,
            Err(ImageError::SheetSize { index: 1, .. })
        ));
    }
}
