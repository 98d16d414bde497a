//! Axes: values to pixels, ticks at round numbers.

use super::{Panel, Style};
use crate::legend::Scale;

/// An axis of a panel.
pub(super) struct Axis {
    low: f64,
    high: f64,
    is_log: bool,
    is_count: bool,
    /// Pixels of `low` and `high`.
    pixels: (f64, f64),
}

impl Axis {
    /// From `low` to `high`; a range of no width gets some.
    pub(super) fn linear(low: f64, high: f64, pixels: (f64, f64)) -> Self {
        let (low, high) = if low.is_finite()
            && high.is_finite()
            && high - low > 1e-12 * low.abs().max(high.abs())
        {
            (low, high)
        } else {
            let middle = if low.is_finite() { low } else { 0.0 };
            let half = if middle == 0.0 {
                1.0
            } else {
                0.5 * middle.abs()
            };
            (middle - half, middle + half)
        };
        Self {
            low,
            high,
            is_log: false,
            is_count: false,
            pixels,
        }
    }

    /// This, for numbers of things.
    fn of_counts(self, is_count: bool) -> Self {
        Self { is_count, ..self }
    }

    fn scale(&self) -> Scale {
        match self.is_count {
            true => Scale::of_counts(self.low, self.high),
            false => Scale::new(self.low, self.high),
        }
    }

    /// Over whole decades.
    pub(super) fn logarithmic(low: f64, high: f64, pixels: (f64, f64)) -> Self {
        let (bottom, top) = (low.log10().floor(), high.log10().ceil());
        // A single power of ten stands at the top: fractions end at 1.
        let bottom = bottom.min(top - 1.0);
        Self {
            low: bottom,
            high: top,
            is_log: true,
            is_count: false,
            pixels,
        }
    }

    /// Pixel where the axis begins.
    pub(super) fn start(&self) -> f64 {
        self.pixels.0
    }

    /// Pixel of a value; `None` where it has no place.
    pub(super) fn pixel(&self, value: f64) -> Option<f64> {
        let at = if self.is_log { value.log10() } else { value };
        let t = (at - self.low) / (self.high - self.low);
        t.is_finite()
            .then_some(self.pixels.0 + t * (self.pixels.1 - self.pixels.0))
    }

    /// Values to mark, with their labels.
    pub(super) fn ticks(&self) -> Vec<(f64, String)> {
        if !self.is_log {
            let scale = self.scale();
            return scale
                .ticks
                .iter()
                .map(|&tick| (tick, scale.label(tick)))
                .collect();
        }
        // At most five decades get a label; within a single one, 2 and 5 do too.
        let stride = (((self.high - self.low) / 5.0).ceil() as usize).max(1);
        let mut ticks = Vec::new();
        for decade in (self.low as i32..=self.high as i32).step_by(stride) {
            let power = format!("10{}", superscript(decade));
            if self.high - self.low < 1.5 && f64::from(decade) < self.high {
                let inner = [2.0, 5.0].map(|k| (k * 10f64.powi(decade), format!("{k}·{power}")));
                ticks.push((10f64.powi(decade), power));
                ticks.extend(inner);
            } else {
                ticks.push((10f64.powi(decade), power));
            }
        }
        ticks
    }

    /// The quantity with its unit, and the power of ten that is taken out of the labels.
    pub(super) fn title(&self, name: &str, unit: &str) -> String {
        if self.is_log {
            return if unit.is_empty() {
                name.to_owned()
            } else {
                format!("{name} [{unit}]")
            };
        }
        self.scale().title(name, unit)
    }
}

/// The axis over all values of a panel, from its lower to its upper pixel; `None` without any values.
pub(super) fn vertical_axis(panel: &Panel, pixels: (f64, f64)) -> Option<Axis> {
    let sums = match panel.style {
        Style::Stack => stack_heights(panel),
        _ => panel
            .series
            .iter()
            .flat_map(|series| &series.points)
            .map(|point| point[1])
            .collect(),
    };
    let has_points = panel.series.iter().any(|series| !series.points.is_empty());
    let included = panel.include.iter().filter(|_| has_points);
    let is_log = panel.style == Style::LogLines;
    let values = sums
        .into_iter()
        .chain(included.copied())
        .filter(|value| value.is_finite() && (!is_log || *value > 0.0));
    let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| {
        (low.min(value), high.max(value))
    });
    if low > high {
        return None;
    }
    Some(match panel.style {
        Style::LogLines => Axis::logarithmic(low, high, pixels),
        // Zero is the bottom, and the curve does not touch the frame.
        _ if low >= 0.0 => {
            let top = if high > 0.0 { 1.06 * high } else { 1.0 };
            Axis::linear(0.0, top, pixels).of_counts(panel.is_count)
        }
        _ => {
            let margin = 0.05 * (high.max(0.0) - low);
            Axis::linear(low - margin, high.max(0.0) + margin, pixels)
        }
    })
}

fn stack_heights(panel: &Panel) -> Vec<f64> {
    let count = panel
        .series
        .iter()
        .map(|series| series.points.len())
        .max()
        .unwrap_or(0);
    let height = |step: usize| -> f64 {
        let values = panel
            .series
            .iter()
            .filter_map(|series| series.points.get(step));
        values
            .map(|point| point[1])
            .filter(|value| value.is_finite())
            .sum()
    };
    (0..count).map(height).collect()
}

fn superscript(number: i32) -> String {
    let digits = number.to_string();
    digits
        .chars()
        .map(crate::legend::superscript_digit)
        .collect()
}
