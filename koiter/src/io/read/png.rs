//! PNG images as textures of grey values.

use std::io::Cursor;

use super::ParseError;
use crate::burning::Texture;

/// Most pixels of a texture: more than meshes have vertices.
const MAX_PIXELS: u64 = 1 << 26;
/// Brightness of red, green and blue (ITU-R BT.709), on the values as they are stored.
const BRIGHTNESS: [f64; 3] = [0.2126, 0.7152, 0.0722];

/// The brightness of a PNG image, 0 black to 1 white; transparency is passed over.
///
/// # Errors
/// What is not a whole PNG image, or one of more pixels than are taken.
pub fn parse_png(bytes: &[u8]) -> Result<Texture, ParseError> {
    let fault = |error: &dyn std::fmt::Display| {
        ParseError::in_file(format!("it is not a PNG image that can be used: {error}"))
    };
    let mut decoder = png::Decoder::new(Cursor::new(bytes));
    decoder.set_transformations(png::Transformations::normalize_to_color8());
    let mut reader = decoder.read_info().map_err(|error| fault(&error))?;
    let (width, height) = (reader.info().width, reader.info().height);
    // Before memory is taken on the word of the header.
    if u64::from(width) * u64::from(height) > MAX_PIXELS {
        let words = format!(
            "{width} x {height} pixels are more than the {MAX_PIXELS} that are taken; make it smaller"
        );
        return Err(ParseError::in_file(words));
    }
    let size = reader
        .output_buffer_size()
        .ok_or_else(|| fault(&"it is too large"))?;
    let mut pixels = vec![0; size];
    let frame = reader
        .next_frame(&mut pixels)
        .map_err(|error| fault(&error))?;
    let samples = frame.color_type.samples();
    let brightness = |pixel: &[u8]| -> f64 {
        let value = |k: usize| f64::from(pixel[k]) / 255.0;
        match samples {
            1 | 2 => value(0),
            _ => (0..3)
                .map(|k| BRIGHTNESS[k] * value(k))
                .sum::<f64>()
                .min(1.0),
        }
    };
    let values = pixels[..frame.buffer_size()]
        .chunks_exact(samples)
        .map(brightness);
    Texture::new(width as usize, height as usize, values.collect()).map_err(|error| fault(&error))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn encode(width: u32, height: u32, color: png::ColorType, data: &[u8]) -> Vec<u8> {
        let mut bytes = Vec::new();
        let mut encoder = png::Encoder::new(&mut bytes, width, height);
        encoder.set_color(color);
        encoder
            .write_header()
            .unwrap()
            .write_image_data(data)
            .unwrap();
        bytes
    }

    #[test]
    fn grey_and_colour_become_brightness() {
        let grey = parse_png(&encode(2, 1, png::ColorType::Grayscale, &[0, 255])).unwrap();
        assert_eq!((grey.at([0.25, 0.5]), grey.at([0.75, 0.5])), (0.0, 1.0));
        let color = parse_png(&encode(1, 1, png::ColorType::Rgba, &[255, 0, 0, 9])).unwrap();
        assert!((color.at([0.5, 0.5]) - 0.2126).abs() < 1e-12);
    }

    #[test]
    fn what_is_no_image_is_refused() {
        let whole = encode(4, 4, png::ColorType::Grayscale, &[7; 16]);
        for bytes in [&b"P5 4 4 255"[..], &[], &whole[..whole.len() / 2]] {
            assert!(parse_png(bytes).is_err());
        }
        // A header that promises more pixels than are taken, with a right checksum.
        let mut large = whole.clone();
        large[16..20].copy_from_slice(&100_000_u32.to_be_bytes());
        large[20..24].copy_from_slice(&100_000_u32.to_be_bytes());
        let checksum = crate::io::crc32(&large[12..29]);
        large[29..33].copy_from_slice(&checksum.to_be_bytes());
        assert!(parse_png(&large).unwrap_err().problem.contains("smaller"));
    }
}
