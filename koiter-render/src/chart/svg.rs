//! Marks as SVG.

use std::fmt::Write;

use super::{Anchor, Mark};

/// The document, on white.
pub(super) fn document(marks: &[Mark], (width, height): (u32, u32)) -> String {
    let mut text = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" viewBox=\"0 0 {width} {height}\" \
         font-family=\"DejaVu Sans, Verdana, sans-serif\">\n<rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n"
    );
    for mark in marks {
        let line = match mark {
            Mark::Line {
                points,
                width,
                color,
            } => format!(
                "<polyline points=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"{width:.2}\" stroke-linejoin=\"round\"/>",
                coordinates(points),
                hexadecimal(*color)
            ),
            Mark::Area { points, color } => format!(
                "<polygon points=\"{}\" fill=\"{}\"/>",
                coordinates(points),
                hexadecimal(*color)
            ),
            Mark::Words {
                text,
                at,
                anchor,
                size,
                color,
            } => format!(
                "<text x=\"{:.1}\" y=\"{:.1}\" font-size=\"{size:.1}\" text-anchor=\"{}\" fill=\"{}\">{}</text>",
                at[0],
                at[1],
                match anchor {
                    Anchor::Start => "start",
                    Anchor::Middle => "middle",
                    Anchor::End => "end",
                },
                hexadecimal(*color),
                escaped(text)
            ),
        };
        text.push_str(&line);
        text.push('\n');
    }
    text.push_str("</svg>\n");
    text
}

fn coordinates(points: &[[f64; 2]]) -> String {
    let mut text = String::new();
    for [x, y] in points {
        // Writing to a string cannot fail.
        let _ = write!(text, "{x:.2},{y:.2} ");
    }
    text.trim_end().to_owned()
}

fn hexadecimal([red, green, blue]: [u8; 3]) -> String {
    format!("#{red:02x}{green:02x}{blue:02x}")
}

fn escaped(text: &str) -> String {
    text.chars()
        .filter(|c| !c.is_control())
        .map(|c| match c {
            '&' => "&amp;".to_owned(),
            '<' => "&lt;".to_owned(),
            '>' => "&gt;".to_owned(),
            c => c.to_string(),
        })
        .collect()
}
