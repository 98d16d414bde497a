//! From a chart to marks: where everything stands.

use super::axis::{Axis, vertical_axis};
use super::reduce::{columns, pieces};
use super::{Anchor, Arrangement, Chart, Line, Mark, Marker, Panel, Series, Style};
use crate::font::Typeface;

/// Colours that colour-blind people can tell apart (Okabe and Ito, 2008), without the yellow, which is lost on white.
const COLORS: [[u8; 3]; 8] = [
    [0, 114, 178],
    [213, 94, 0],
    [0, 158, 115],
    [204, 121, 167],
    [230, 159, 0],
    [86, 180, 233],
    [90, 90, 90],
    [170, 170, 170],
];
const INK: [u8; 3] = [40, 42, 46];
const GRID: [u8; 3] = [226, 228, 232];
const FRAME: [u8; 3] = [140, 144, 150];

/// Height of letters in the shorter side, and the least [pixels].
const TEXT: f64 = 1.0 / 62.0;
const LEAST_TEXT: f64 = 9.0;

/// Radius of signs at points, in heights of letters.
const MARKER: f64 = 0.36;

/// All marks, those behind first.
pub(super) fn marks(chart: &Chart, (width, height): (u32, u32)) -> Vec<Mark> {
    let (width, height) = (f64::from(width), f64::from(height));
    let size = (TEXT * width.min(height)).max(LEAST_TEXT);
    let typeface = Typeface::load();
    let words_width = |text: &str| f64::from(typeface.width(text, size as f32));
    let longest = chart
        .panels
        .iter()
        .flat_map(|panel| &panel.series)
        .map(|series| words_width(&series.name))
        .fold(0.0, f64::max);
    let (left, right) = (5.5 * size, width - longest - 4.5 * size);
    let (top, bottom) = (2.6 * size, height - 3.4 * size);
    let mut sheet = Sheet {
        marks: Vec::new(),
        size,
    };
    sheet.words(&chart.title, [left, 1.6 * size], Anchor::Start, 1.15 * size);

    let horizontal = |left: f64, right: f64| {
        let (low, high) = chart.x_range;
        match chart.x_is_log {
            true => Axis::logarithmic(low, high, (left, right)),
            false => Axis::linear(low, high, (left, right)),
        }
    };
    // Above each panel stands its name.
    let heading = 2.2 * size;
    let weights: f64 = chart.panels.iter().map(|panel| panel.weight).sum();
    match chart.arrangement {
        Arrangement::Below => {
            let x = horizontal(left, right);
            let unit = (bottom - top - heading * chart.panels.len() as f64) / weights;
            let mut next = top;
            for panel in &chart.panels {
                let frame = Frame {
                    left,
                    right,
                    top: next + heading,
                    bottom: next + heading + (unit * panel.weight).max(1.0),
                };
                sheet.panel(panel, &x, &frame);
                next = frame.bottom;
            }
            sheet.x_labels(&x, &chart.x_label, (left, right, next));
        }
        Arrangement::Beside => {
            let margins = left + (width - right);
            let unit = (width - margins * chart.panels.len() as f64) / weights;
            let mut next = 0.0;
            for panel in &chart.panels {
                let frame = Frame {
                    left: next + left,
                    right: next + left + (unit * panel.weight).max(1.0),
                    top: top + heading,
                    bottom,
                };
                let x = horizontal(frame.left, frame.right);
                sheet.panel(panel, &x, &frame);
                sheet.x_labels(&x, &chart.x_label, (frame.left, frame.right, bottom));
                next = frame.right + (width - right);
            }
        }
    }
    sheet.marks
}

fn color(number: usize, series: &Series) -> [u8; 3] {
    series.color.unwrap_or(COLORS[number % COLORS.len()])
}

/// Size of signs and lines of the `k`-th of `count` curves: from 1.8 to 0.7, so that each is seen around the next.
fn nested_scale(k: usize, count: usize) -> f64 {
    match count {
        0 | 1 => 1.0,
        _ => 1.8 - 1.1 * k as f64 / (count - 1) as f64,
    }
}

struct Frame {
    left: f64,
    right: f64,
    top: f64,
    bottom: f64,
}

struct Sheet {
    marks: Vec<Mark>,
    size: f64,
}

impl Sheet {
    fn panel(&mut self, panel: &Panel, x: &Axis, frame: &Frame) {
        let y = vertical_axis(panel, (frame.bottom, frame.top));
        for (tick, _) in x.ticks() {
            let Some(at) = x.pixel(tick) else { continue };
            self.line(vec![[at, frame.top], [at, frame.bottom]], 1.0, GRID);
        }
        let heading = [frame.left, frame.top - 0.5 * self.size];
        let Some(y) = y else {
            self.words(&panel.name, heading, Anchor::Start, self.size);
            let middle = [
                0.5 * (frame.left + frame.right),
                0.5 * (frame.top + frame.bottom) + 0.36 * self.size,
            ];
            self.words(&panel.if_empty, middle, Anchor::Middle, self.size);
            self.frame(frame);
            return;
        };
        self.words(
            &y.title(&panel.name, &panel.unit),
            heading,
            Anchor::Start,
            self.size,
        );
        let mut last_label = f64::INFINITY;
        for (tick, label) in y.ticks() {
            let Some(at) = y.pixel(tick) else { continue };
            self.line(vec![[frame.left, at], [frame.right, at]], 1.0, GRID);
            // In a low panel only every second or third tick has room for its label.
            if last_label - at >= 1.2 * self.size {
                let place = [frame.left - 0.5 * self.size, at + 0.36 * self.size];
                self.words(&label, place, Anchor::End, self.size);
                last_label = at;
            }
        }
        match panel.style {
            Style::Stack => self.stack(panel, x, &y),
            Style::Lines | Style::LogLines => self.curves(panel, x, &y),
        }
        self.frame(frame);
        self.legend(panel, frame);
    }

    /// Lines first, signs on top of them, both from large to small: where curves lie on each other all are seen.
    fn curves(&mut self, panel: &Panel, x: &Axis, y: &Axis) {
        let place = |&[a, b]: &[f64; 2]| Some([x.pixel(a)?, y.pixel(b)?]);
        let signed = |series: &&Series| series.marker.is_some() && series.line == Line::Solid;
        let num_signed = panel.series.iter().filter(signed).count();
        let mut rank = 0;
        let scale = |series: &Series| {
            if !signed(&series) {
                return 1.0;
            }
            rank += 1;
            nested_scale(rank - 1, num_signed)
        };
        let scales: Vec<f64> = panel.series.iter().map(scale).collect();
        let numbered = || panel.series.iter().enumerate();
        let guides = numbered().filter(|(_, series)| series.line == Line::Guide);
        for (number, series) in guides.chain(numbered().filter(|(_, s)| s.line == Line::Solid)) {
            let width = match series.line {
                Line::Guide => 0.06 * self.size,
                _ => 0.15 * self.size * scales[number],
            };
            for piece in pieces(series.points.iter().map(place)) {
                match piece[..] {
                    // A single point has no line: it becomes a square.
                    [at] => {
                        let points = Marker::Square.outline(at, 1.8 * width);
                        let color = color(number, series);
                        self.marks.push(Mark::Area { points, color });
                    }
                    _ => self.line(piece, width, color(number, series)),
                }
            }
        }
        for (number, series) in numbered() {
            let Some(marker) = series.marker else {
                continue;
            };
            for at in series.points.iter().filter_map(place) {
                let r = MARKER * self.size * scales[number];
                self.sign(marker, at, r, color(number, series));
            }
        }
    }

    fn sign(&mut self, marker: Marker, at: [f64; 2], r: f64, color: [u8; 3]) {
        let mut points = marker.outline(at, r);
        if marker.is_hollow() {
            points.push(points[0]);
            self.line(points, 0.25 * r, color);
        } else {
            self.marks.push(Mark::Area { points, color });
        }
    }

    fn stack(&mut self, panel: &Panel, x: &Axis, y: &Axis) {
        let Some(first) = panel.series.first() else {
            return;
        };
        let steps: Vec<f64> = first
            .points
            .iter()
            .filter_map(|&[at, _]| x.pixel(at))
            .collect();
        let layers: Vec<Vec<f64>> = panel
            .series
            .iter()
            .map(|series| series.points.iter().map(|&[_, value]| value).collect())
            .collect();
        let (ends, layers) = columns(&steps, &layers);
        // A step begins where the one before ends, the first as far back as the second is long.
        let first_width = match ends[..] {
            [a, b, ..] => b - a,
            _ => f64::INFINITY,
        };
        let starts: Vec<f64> = std::iter::once(f64::NAN)
            .chain(ends.iter().copied())
            .collect();
        let left_end = x.start();
        let start_of = |step: usize| match step {
            0 => (ends[0] - first_width).max(left_end),
            step => starts[step],
        };
        let mut base = vec![0.0; ends.len()];
        for (number, layer) in layers.iter().enumerate() {
            let tops: Vec<f64> = base
                .iter()
                .zip(layer)
                .map(|(base, value)| base + value)
                .collect();
            let stairs = |heights: &[f64]| -> Vec<[f64; 2]> {
                let corner = |(step, &height): (usize, &f64)| {
                    let level = y.pixel(height).unwrap_or(0.0);
                    [[start_of(step), level], [ends[step], level]]
                };
                heights.iter().enumerate().flat_map(corner).collect()
            };
            let mut points = stairs(&tops);
            points.extend(stairs(&base).into_iter().rev());
            self.marks.push(Mark::Area {
                points,
                color: color(number, &panel.series[number]),
            });
            base = tops;
        }
    }

    /// Beside the panel; of a stack from its top.
    fn legend(&mut self, panel: &Panel, frame: &Frame) {
        let mut entries: Vec<(usize, &str)> = panel
            .series
            .iter()
            .map(|series| series.name.as_str())
            .enumerate()
            .collect();
        if panel.series.len() < 2 {
            return;
        }
        if panel.style == Style::Stack {
            entries.reverse();
        }
        let room = (frame.bottom - frame.top) / entries.len() as f64;
        let pitch = (1.45 * self.size).min(room);
        // Where there is little room the letters shrink too.
        let size = self.size.min(0.95 * pitch);
        for (row, (number, name)) in entries.into_iter().enumerate() {
            let middle = frame.top + (row as f64 + 0.5) * pitch;
            let left = frame.right + 0.9 * self.size;
            let series = &panel.series[number];
            let (color, half) = (color(number, series), 0.32 * size);
            let square = [
                [0.0, -half],
                [1.2 * size, -half],
                [1.2 * size, half],
                [0.0, half],
            ];
            let at = |[a, b]: [f64; 2]| [left + a, middle + b];
            match (series.marker, series.line) {
                (Some(marker), _) => {
                    self.sign(marker, at([0.6 * size, 0.0]), MARKER * size, color);
                }
                (None, Line::Guide) => {
                    let ends = [[0.0, 0.0], [1.2 * size, 0.0]].map(at);
                    self.line(ends.to_vec(), 0.06 * size, color);
                }
                (None, _) => {
                    let points = square.map(at).to_vec();
                    self.marks.push(Mark::Area { points, color });
                }
            }
            self.words(
                name,
                [left + 1.7 * size, middle + 0.36 * size],
                Anchor::Start,
                size,
            );
        }
    }

    fn x_labels(&mut self, x: &Axis, label: &str, (left, right, bottom): (f64, f64, f64)) {
        for (tick, text) in x.ticks() {
            let Some(at) = x.pixel(tick) else { continue };
            self.line(
                vec![[at, bottom], [at, bottom + 0.35 * self.size]],
                1.0,
                FRAME,
            );
            self.words(
                &text,
                [at, bottom + 1.45 * self.size],
                Anchor::Middle,
                self.size,
            );
        }
        let title = x.title(label, "");
        self.words(
            &title,
            [0.5 * (left + right), bottom + 2.8 * self.size],
            Anchor::Middle,
            self.size,
        );
    }

    fn frame(&mut self, frame: &Frame) {
        let corners = [
            [frame.left, frame.top],
            [frame.left, frame.bottom],
            [frame.right, frame.bottom],
        ];
        self.line(corners.to_vec(), 1.0, FRAME);
    }

    fn line(&mut self, points: Vec<[f64; 2]>, width: f64, color: [u8; 3]) {
        self.marks.push(Mark::Line {
            points,
            width,
            color,
        });
    }

    fn words(&mut self, text: &str, at: [f64; 2], anchor: Anchor, size: f64) {
        let text = text.to_owned();
        self.marks.push(Mark::Words {
            text,
            at,
            anchor,
            size,
            color: INK,
        });
    }
}
