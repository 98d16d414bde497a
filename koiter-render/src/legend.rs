//! The legend of a field and the caption, drawn over the finished picture.

use crate::color::ColorMap;
use crate::font::{Align, Typeface};
use crate::image::Image;
use crate::options::{ColorBy, RenderOptions};

/// Height of letters in the height of the picture, and the least (pixels).
const TEXT: f32 = 1.0 / 36.0;
const LEAST_TEXT: f32 = 11.0;
/// Length of the bar in the height of the picture.
const BAR: f32 = 0.42;

/// How much the plate behind the legend covers: dark letters keep a contrast above 4.5 to 1 over the darkest colours.
const PLATE_COVER: f32 = 0.72;

/// Draws what the options ask for.
pub(crate) fn draw(image: &mut Image, options: &RenderOptions, range: (f64, f64)) {
    let is_field = matches!(options.color, ColorBy::Field { .. });
    if !is_field && options.caption.is_none() {
        return;
    }
    let typeface = Typeface::load();
    let size = (TEXT * options.height as f32).max(LEAST_TEXT);
    let bottom = options.background.bottom.to_linear();
    let ink = if bottom.dot(crate::vector::vec3(0.2126, 0.7152, 0.0722)) > 0.2 {
        [55, 58, 64]
    } else {
        [235; 3]
    };
    let pen = Pen {
        typeface: &typeface,
        size,
        ink,
    };
    if let Some(caption) = &options.caption {
        let at = (1.3 * size, options.height as f32 - 1.2 * size);
        typeface.draw(image, caption, 1.1 * size, ink, at, Align::Left);
    }
    if let ColorBy::Field {
        name, unit, map, ..
    } = &options.color
    {
        pen.legend(image, (name, unit), *map, range);
    }
}

struct Pen<'a> {
    typeface: &'a Typeface,
    size: f32,
    ink: [u8; 3],
}

impl Pen<'_> {
    /// A vertical bar at the right edge, its title above, its ticks to the right.
    fn legend(
        &self,
        image: &mut Image,
        (name, unit): (&str, &str),
        map: ColorMap,
        (low, high): (f64, f64),
    ) {
        let size = self.size;
        let (picture_width, picture_height) = (image.width() as f32, image.height() as f32);
        let scale = Scale::new(low, high);
        let labels: Vec<String> = scale.ticks.iter().map(|&tick| scale.label(tick)).collect();
        let label_width = labels
            .iter()
            .map(|label| self.typeface.width(label, size))
            .fold(0.0, f32::max);
        let bar_width = (0.75 * size).round();
        let right = picture_width - 1.3 * size;
        let left = (right - label_width - 0.55 * size - bar_width).round() as i64;
        let height = (BAR * picture_height).round().max(1.0);
        let top = (0.5 * (picture_height - height) + 0.8 * size).round() as i64;

        let title = scale.title(name, unit);
        let title_left = right - self.typeface.width(&title, size);
        let plate_left = (left as f32).min(title_left) - 0.6 * size;
        let corners = (
            (plate_left as i64, top - (2.4 * size) as i64),
            (
                (right + 0.6 * size) as i64,
                top + (height + 0.9 * size) as i64,
            ),
        );
        self.plate(image, corners);
        for row in 0..height as i64 {
            let t = 1.0 - (row as f64 + 0.5) / f64::from(height);
            let color = map.at(if low <= high { t } else { 1.0 - t }).to_bytes();
            (0..bar_width as i64)
                .for_each(|column| image.blend(left + column, top + row, color, 1.0));
        }
        self.frame(image, (left, top), (bar_width as i64, height as i64));

        let (bottom, end) = (low.min(high), low.max(high));
        for (&tick, label) in scale.ticks.iter().zip(&labels) {
            let t = if end > bottom {
                (tick - bottom) / (end - bottom)
            } else {
                0.5
            };
            let y = top as f32 + ((1.0 - t) as f32 * (height - 1.0)).round();
            let start = left + bar_width as i64;
            (0..(0.3 * size) as i64).for_each(|i| image.blend(start + i, y as i64, self.ink, 0.7));
            // The middle of a figure stands 0.36 em above the baseline.
            let at = (start as f32 + 0.5 * size, y + 0.36 * size);
            self.typeface
                .draw(image, label, size, self.ink, at, Align::Left);
        }
        let at = (right, top as f32 - size);
        self.typeface
            .draw(image, &title, size, self.ink, at, Align::Right);
    }

    /// A plate behind the figures, so that they can be read over the surface.
    fn plate(&self, image: &mut Image, ((left, top), (right, bottom)): ((i64, i64), (i64, i64))) {
        let paper = if self.ink[0] < 128 { [244; 3] } else { [24; 3] };
        for row in top..bottom {
            for column in left..right {
                image.blend(column, row, paper, PLATE_COVER);
            }
        }
    }

    fn frame(&self, image: &mut Image, (left, top): (i64, i64), (width, height): (i64, i64)) {
        for column in left..left + width {
            image.blend(column, top, self.ink, 0.6);
            image.blend(column, top + height - 1, self.ink, 0.6);
        }
        for row in top + 1..top + height - 1 {
            image.blend(left, row, self.ink, 0.6);
            image.blend(left + width - 1, row, self.ink, 0.6);
        }
    }
}

/// A digit or minus sign as an exponent.
pub(crate) fn superscript_digit(c: char) -> char {
    match c {
        '-' => '⁻',
        '1' => '¹',
        '2' => '²',
        '3' => '³',
        digit => char::from_u32('⁰' as u32 + digit.to_digit(10).unwrap_or(0)).unwrap_or(digit),
    }
}

/// Round numbers between two values, and how to write them.
#[derive(Debug, PartialEq)]
pub(crate) struct Scale {
    pub(crate) ticks: Vec<f64>,
    /// Labels are in units of ten to this power, a multiple of three.
    exponent: i32,
    decimals: usize,
}

impl Scale {
    /// Steps of 1, 2 or 5 times a power of ten: the largest that gives four or more.
    pub(crate) fn new(low: f64, high: f64) -> Self {
        Self::with_least_step(low, high, 0.0)
    }

    /// The same for numbers of things, of which there is no half.
    pub(crate) fn of_counts(low: f64, high: f64) -> Self {
        Self::with_least_step(low, high, 1.0)
    }

    fn with_least_step(low: f64, high: f64, least: f64) -> Self {
        let (low, high) = (low.min(high), low.max(high));
        let largest = low.abs().max(high.abs());
        let exponent = if largest == 0.0 || (1e-2..1e5).contains(&largest) {
            0
        } else {
            3 * (largest.log10() / 3.0).floor() as i32
        };
        let unit = 10f64.powi(exponent);
        let width = (high - low) / unit;
        // A range that is lost in the rounding of its ends is a single value.
        if width.is_nan() || width <= 1e-9 * largest / unit || !width.is_finite() {
            return Self {
                ticks: vec![low],
                exponent,
                decimals: 3,
            };
        }
        let power = 10f64.powi(width.log10().floor() as i32);
        let count = |step: f64| {
            ((high / unit / step + 1e-6).floor() - (low / unit / step - 1e-6).ceil()) as i64 + 1
        };
        let steps = [2.0, 1.0, 0.5, 0.2].map(|factor| factor * power);
        let step = steps
            .into_iter()
            .find(|&step| count(step) >= 4)
            .unwrap_or(steps[3])
            .max(least / unit);
        let (first, last) = (
            (low / unit / step - 1e-6).ceil() as i64,
            (high / unit / step + 1e-6).floor() as i64,
        );
        let decimals = (-(step * 1.001).log10().floor()).clamp(0.0, 12.0) as usize;
        Self {
            ticks: (first..=last).map(|k| k as f64 * step * unit).collect(),
            exponent,
            decimals,
        }
    }

    pub(crate) fn label(&self, tick: f64) -> String {
        let text = format!("{:.*}", self.decimals, tick / 10f64.powi(self.exponent));
        // A true minus sign, and no minus before zero.
        let is_zero = text.bytes().all(|b| matches!(b, b'-' | b'0' | b'.'));
        if is_zero {
            text.replace('-', "")
        } else {
            text.replace('-', "−")
        }
    }

    pub(crate) fn title(&self, name: &str, unit: &str) -> String {
        let factor = match self.exponent {
            0 => String::new(),
            exponent => format!(
                "10{}",
                exponent
                    .to_string()
                    .chars()
                    .map(superscript_digit)
                    .collect::<String>()
            ),
        };
        match (factor.is_empty(), unit.is_empty()) {
            (true, true) => name.to_owned(),
            (true, false) => format!("{name} [{unit}]"),
            (false, true) => format!("{name} [{factor}]"),
            (false, false) => format!("{name} [{factor} {unit}]"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn labels(low: f64, high: f64) -> Vec<String> {
        let scale = Scale::new(low, high);
        scale.ticks.iter().map(|&tick| scale.label(tick)).collect()
    }

    #[test]
    fn ticks_are_round_numbers_inside_the_range() {
        assert_eq!(labels(0.0, 1.0), ["0.0", "0.2", "0.4", "0.6", "0.8", "1.0"]);
        assert_eq!(
            labels(-0.13, 0.11),
            ["−0.10", "−0.05", "0.00", "0.05", "0.10"]
        );
        assert_eq!(labels(3.0, 47.0), ["10", "20", "30", "40"]);
    }

    #[test]
    fn there_is_no_half_of_a_thing() {
        let labels = |high: f64| -> Vec<String> {
            let scale = Scale::of_counts(0.0, high);
            scale.ticks.iter().map(|&tick| scale.label(tick)).collect()
        };
        assert_eq!(labels(1.06), ["0", "1"]);
        assert_eq!(labels(3.2), ["0", "1", "2", "3"]);
        assert_eq!(labels(41.0), ["0", "10", "20", "30", "40"]);
        assert_eq!(labels(2.5e5), ["0", "50", "100", "150", "200", "250"]);
    }

    #[test]
    fn large_and_small_values_move_a_power_of_ten_to_the_title() {
        let scale = Scale::new(0.0, 2.5e6);
        assert_eq!(scale.title("stress", "Pa"), "stress [10⁶ Pa]");
        assert_eq!(scale.label(scale.ticks[1]), "0.5");
        assert_eq!(Scale::new(0.0, 4e-4).title("strain", ""), "strain [10⁻⁶]");
        assert_eq!(Scale::new(0.0, 1.0).title("height", "m"), "height [m]");
    }

    #[test]
    fn degenerate_ranges_have_one_tick() {
        for (low, high) in [(2.0, 2.0), (0.0, 0.0), (1.0, 1.0 + 1e-15)] {
            assert_eq!(Scale::new(low, high).ticks.len(), 1, "{low} {high}");
        }
        assert!(Scale::new(-1e308, 1e308).ticks.len() < 20);
    }
}
