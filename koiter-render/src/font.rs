//! Text in pictures: DejaVu Sans, reduced to Latin, Greek, superscripts and a few signs (`assets/`).

use crate::image::Image;

/// The typeface, parsed.
pub(crate) struct Typeface(fontdue::Font);

/// Which point of a line of text is given.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Align {
    Left,
    Right,
}

impl Typeface {
    pub(crate) fn load() -> Self {
        let bytes: &[u8] = include_bytes!("../assets/DejaVuSans-subset.ttf");
        let font = fontdue::Font::from_bytes(bytes, fontdue::FontSettings::default());
        Self(font.expect("the embedded font is a valid TrueType file"))
    }

    /// Length of a line of text (pixels).
    pub(crate) fn width(&self, text: &str, size: f32) -> f32 {
        self.advances(text, size).map(|(_, advance)| advance).sum()
    }

    /// Draws a line of text at `(x, baseline)` (pixels).
    pub(crate) fn draw(
        &self,
        image: &mut Image,
        text: &str,
        size: f32,
        color: [u8; 3],
        (x, baseline): (f32, f32),
        align: Align,
    ) {
        let mut pen = match align {
            Align::Left => x,
            Align::Right => x - self.width(text, size),
        };
        for (character, advance) in self.advances(text, size) {
            let (metrics, cover) = self.0.rasterize(character, size);
            let left = pen.round() as i64 + i64::from(metrics.xmin);
            let top = baseline.round() as i64 - i64::from(metrics.ymin) - metrics.height as i64;
            for (index, &cover) in cover.iter().enumerate() {
                let (column, row) = (index % metrics.width, index / metrics.width);
                image.blend(
                    left + column as i64,
                    top + row as i64,
                    color,
                    f32::from(cover) / 255.0,
                );
            }
            pen += advance;
        }
    }

    /// The characters and how far each moves the pen. What the font lacks becomes a box.
    fn advances(&self, text: &str, size: f32) -> impl Iterator<Item = (char, f32)> {
        let following = text.chars().skip(1).map(Some).chain([None]);
        text.chars().zip(following).map(move |(character, next)| {
            let kern = next
                .and_then(|next| self.0.horizontal_kern(character, next, size))
                .unwrap_or(0.0);
            (
                character,
                self.0.metrics(character, size).advance_width + kern,
            )
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::color::Rgb;

    #[test]
    fn text_darkens_pixels_within_its_width_only() {
        let typeface = Typeface::load();
        let mut image = Image::new(200, 40, Rgb::WHITE);
        typeface.draw(
            &mut image,
            "t = 1.20 s",
            20.0,
            [0; 3],
            (10.0, 30.0),
            Align::Left,
        );
        let dark: Vec<u32> = (0..200)
            .filter(|&x| (0..40).any(|y| image.pixel(x, y) < Some([128; 3])))
            .collect();
        assert!(dark.len() > 40, "{} dark columns", dark.len());
        let end = 10.0 + typeface.width("t = 1.20 s", 20.0);
        assert!(dark[0] >= 9 && f64::from(dark[dark.len() - 1]) <= f64::from(end) + 1.0);
    }

    #[test]
    fn the_signs_of_units_are_in_the_font_and_others_do_no_harm() {
        let typeface = Typeface::load();
        for sign in "N/m²·°µσεθκ×10⁻³−".chars() {
            assert!(typeface.0.has_glyph(sign), "{sign}");
        }
        let mut image = Image::new(20, 20, Rgb::WHITE);
        typeface.draw(
            &mut image,
            "漢\n",
            18.0,
            [0; 3],
            (-5.0, 300.0),
            Align::Right,
        );
    }
}
