//! Marks as pixels, with smooth edges.

use super::{Anchor, Mark};
use crate::font::{Align, Typeface};
use crate::image::Image;

/// Lines of samples a pixel, for areas.
const SAMPLES: usize = 4;

/// Draws the marks in their order.
pub(super) fn draw(image: &mut Image, marks: &[Mark]) {
    let typeface = Typeface::load();
    for mark in marks {
        match mark {
            Mark::Line {
                points,
                width,
                color,
            } => line(image, points, *width, *color),
            Mark::Area { points, color } => area(image, points, *color),
            Mark::Words {
                text,
                at,
                anchor,
                size,
                color,
            } => {
                let size = *size as f32;
                let shift = match anchor {
                    Anchor::Start => 0.0,
                    Anchor::Middle => 0.5 * typeface.width(text, size),
                    Anchor::End => typeface.width(text, size),
                };
                let at = (at[0] as f32 - shift, at[1] as f32);
                typeface.draw(image, text, size, *color, at, Align::Left);
            }
        }
    }
}

/// Every pixel is covered as far as its middle is inside the line; joints count once.
fn line(image: &mut Image, points: &[[f64; 2]], width: f64, color: [u8; 3]) {
    let (columns, rows) = (image.width() as usize, image.height() as usize);
    let mut cover = vec![0f32; columns * rows];
    let reach = 0.5 * width + 1.0;
    for pair in points.windows(2) {
        let [a, b] = [pair[0], pair[1]];
        let span = |axis: usize, count: usize| {
            let low = (a[axis].min(b[axis]) - reach)
                .floor()
                .clamp(0.0, count as f64) as usize;
            let high = (a[axis].max(b[axis]) + reach)
                .ceil()
                .clamp(0.0, count as f64) as usize;
            low..high
        };
        for row in span(1, rows) {
            for column in span(0, columns) {
                let distance = distance_to_segment([column as f64 + 0.5, row as f64 + 0.5], a, b);
                let inside = (0.5 * width + 0.5 - distance).clamp(0.0, 1.0) as f32;
                let cell = &mut cover[row * columns + column];
                *cell = cell.max(inside);
            }
        }
    }
    for (index, &cover) in cover.iter().enumerate().filter(|(_, cover)| **cover > 0.0) {
        image.blend(
            (index % columns) as i64,
            (index / columns) as i64,
            color,
            cover,
        );
    }
}

fn distance_to_segment(p: [f64; 2], a: [f64; 2], b: [f64; 2]) -> f64 {
    let along = [b[0] - a[0], b[1] - a[1]];
    let length_squared = along[0] * along[0] + along[1] * along[1];
    let t = if length_squared > 0.0 {
        (((p[0] - a[0]) * along[0] + (p[1] - a[1]) * along[1]) / length_squared).clamp(0.0, 1.0)
    } else {
        0.0
    };
    (p[0] - a[0] - t * along[0]).hypot(p[1] - a[1] - t * along[1])
}

/// Spans of sampling lines inside the polygon (even-odd), exact along x.
fn area(image: &mut Image, points: &[[f64; 2]], color: [u8; 3]) {
    let columns = image.width() as usize;
    for row in 0..image.height() {
        let mut cover = vec![0f64; columns];
        for sample in 0..SAMPLES {
            let y = f64::from(row) + (sample as f64 + 0.5) / SAMPLES as f64;
            for span in crossings(points, y).chunks_exact(2) {
                let (from, to) = (
                    span[0].clamp(0.0, columns as f64),
                    span[1].clamp(0.0, columns as f64),
                );
                for column in from.floor() as usize..to.ceil() as usize {
                    let left = from.max(column as f64);
                    let right = to.min(column as f64 + 1.0);
                    cover[column] += (right - left).max(0.0) / SAMPLES as f64;
                }
            }
        }
        for (column, &cover) in cover.iter().enumerate().filter(|(_, cover)| **cover > 0.0) {
            image.blend(column as i64, i64::from(row), color, cover as f32);
        }
    }
}

/// Where the outline crosses a horizontal line, from the left.
fn crossings(points: &[[f64; 2]], y: f64) -> Vec<f64> {
    let ends = points.iter().skip(1).chain(points.first());
    let mut found: Vec<f64> = points
        .iter()
        .zip(ends)
        .filter(|(a, b)| (a[1] <= y) != (b[1] <= y))
        .map(|(a, b)| a[0] + (y - a[1]) / (b[1] - a[1]) * (b[0] - a[0]))
        .collect();
    found.sort_by(f64::total_cmp);
    found
}
