//! Charts over a common horizontal axis: panels below or beside each other, as SVG or as a picture.
//!
//! A chart is data ([`Chart`]); `layout` makes marks of it (lines, areas, words at pixels), and `svg` and `raster` write
//! the same marks. Numbers that are not finite are gaps.

mod axis;
mod layout;
mod marker;
mod raster;
mod reduce;
mod svg;

use crate::image::Image;
use crate::options::MAX_SIDE;
use crate::{RenderError, Rgb};

/// Panels over one horizontal axis.
#[derive(Clone, Debug, Default)]
pub struct Chart {
    /// Above everything.
    pub title: String,
    /// Name and unit of the horizontal axis, such as `time [s]`.
    pub x_label: String,
    /// Where the horizontal axis begins and ends.
    pub x_range: (f64, f64),
    /// Whether the horizontal axis is logarithmic.
    pub x_is_log: bool,
    /// How the panels stand.
    pub arrangement: Arrangement,
    /// From above, or from the left.
    pub panels: Vec<Panel>,
}

/// How the panels of a chart stand.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Arrangement {
    /// Below each other, over one horizontal axis.
    #[default]
    Below,
    /// Beside each other, each with the horizontal axis of its own, all alike.
    Beside,
}

/// One panel.
#[derive(Clone, Debug, Default)]
pub struct Panel {
    /// Quantity of the vertical axis.
    pub name: String,
    /// Its unit; empty for numbers.
    pub unit: String,
    /// How values are drawn.
    pub style: Style,
    /// Curves, or layers from below.
    pub series: Vec<Series>,
    /// Height relative to that of the other panels.
    pub weight: f64,
    /// Values that the vertical axis includes beside those drawn, so that panels can be alike.
    pub include: Vec<f64>,
    /// Whether the values are numbers of things, which have no decimals.
    pub is_count: bool,
    /// Said instead when there is nothing to draw.
    pub if_empty: String,
}

/// How the values of a panel are drawn.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Style {
    /// Curves on a linear axis that includes 0.
    #[default]
    Lines,
    /// Curves on a logarithmic axis; values that are not positive are gaps.
    LogLines,
    /// Layers on top of each other, each value holding from the x before to its own.
    Stack,
}

/// Values over x.
#[derive(Clone, Debug, Default)]
pub struct Series {
    /// Name in the legend.
    pub name: String,
    /// Values of x, increasing, and of y; in a stack all series have the same x.
    pub points: Vec<[f64; 2]>,
    /// Red, green and blue; else the colours are taken in their order.
    pub color: Option<[u8; 3]>,
    /// Drawn at every point of a curve. Where curves with signs lie on each other, later ones are thinner and have
    /// smaller signs, so that all are seen.
    pub marker: Option<Marker>,
    /// Between the points of a curve.
    pub line: Line,
}

/// What joins the points of a curve.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Line {
    /// A line.
    #[default]
    Solid,
    /// A hairline behind everything else, to compare curves with.
    Guide,
    /// Nothing.
    None,
}

pub use marker::Marker;

impl Chart {
    /// The chart as an SVG document.
    ///
    /// # Errors
    /// [`RenderError::Size`] for a size without pixels or beyond 16384.
    pub fn to_svg(&self, width: u32, height: u32) -> Result<String, RenderError> {
        check_size(width, height)?;
        Ok(svg::document(
            &layout::marks(self, (width, height)),
            (width, height),
        ))
    }

    /// The chart as a picture.
    ///
    /// # Errors
    /// As [`Chart::to_svg`].
    pub fn to_image(&self, width: u32, height: u32) -> Result<Image, RenderError> {
        check_size(width, height)?;
        let mut image = Image::new(width, height, Rgb::WHITE);
        raster::draw(&mut image, &layout::marks(self, (width, height)));
        Ok(image)
    }
}

fn check_size(width: u32, height: u32) -> Result<(), RenderError> {
    let is_sound = |side: u32| (1..=MAX_SIDE).contains(&side);
    if is_sound(width) && is_sound(height) {
        return Ok(());
    }
    Err(RenderError::Size { width, height })
}

/// What is drawn, in pixels from the upper left corner.
#[derive(Clone, Debug, PartialEq)]
enum Mark {
    Line {
        points: Vec<[f64; 2]>,
        width: f64,
        color: [u8; 3],
    },
    Area {
        points: Vec<[f64; 2]>,
        color: [u8; 3],
    },
    Words {
        text: String,
        /// Where the line of text begins, has its middle or ends, on its baseline.
        at: [f64; 2],
        anchor: Anchor,
        size: f64,
        color: [u8; 3],
    },
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Anchor {
    Start,
    Middle,
    End,
}

#[cfg(test)]
mod tests;
