//! How a scene is drawn.

use crate::camera::Camera;
use crate::color::{ColorMap, Rgb};
use crate::error::RenderError;

/// Largest width or height of a picture (pixels): a slip of the keyboard should not ask for a terabyte.
pub(crate) const MAX_SIDE: u32 = 16384;

/// Everything but the scene itself.
#[derive(Debug, Clone)]
pub struct RenderOptions {
    /// Width (pixels).
    pub width: u32,
    /// Height (pixels).
    pub height: u32,
    /// Samples per pixel along each axis, 1 to 8: 3 means 3 × 3.
    pub samples: u32,
    /// From where.
    pub camera: Camera,
    /// How finely light is traced.
    pub quality: Quality,
    /// What the colours mean.
    pub color: ColorBy,
    /// What is behind everything.
    pub background: Background,
    /// Whether the edges of the shells' faces are drawn.
    pub wireframe: bool,
    /// The lamp.
    pub light: Light,
    /// How dark the lamp's shadows are, 0 (none) to 1.
    pub shadow: f64,
    /// How much folds and contacts darken in the light of the sky, 0 (none) to 1.
    pub ambient_occlusion: f64,
    /// A line in the lower left corner, such as `t = 1.20 s`.
    pub caption: Option<String>,
}

/// How finely light is traced; edges are equally smooth in both.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Quality {
    /// For films: light is traced for every fourth pixel.
    Film,
    /// For single pictures: light is traced for every pixel, with twice the rays.
    #[default]
    Still,
}

/// What the colours of the shells mean.
#[derive(Debug, Clone, PartialEq, Default)]
#[non_exhaustive]
pub enum ColorBy {
    /// Each part has its own colour.
    #[default]
    Part,
    /// The parts' fields, with a legend.
    Field {
        /// Title of the legend.
        name: String,
        /// Unit, may be empty.
        unit: String,
        /// Colours for the values.
        map: ColorMap,
        /// Values at the ends of the legend; `None` takes those of this scene. Give it for films.
        range: Option<(f64, f64)>,
    },
}

/// The picture behind the scene: a vertical gradient.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Background {
    /// Colour at the upper edge.
    pub top: Rgb,
    /// Colour at the lower edge.
    pub bottom: Rgb,
}

/// A distant lamp that goes with the camera.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Light {
    /// Angle about z from the camera (degrees); negative: from the left.
    pub azimuth: f64,
    /// Angle above the horizon (degrees), 5 to 90.
    pub elevation: f64,
    /// Angular radius of the lamp (degrees), 0 (hard shadows) to 45.
    pub softness: f64,
}

impl Default for Light {
    fn default() -> Self {
        Self {
            azimuth: -62.0,
            elevation: 52.0,
            softness: 5.0,
        }
    }
}

impl Default for Background {
    fn default() -> Self {
        Self {
            top: Rgb(0.885, 0.895, 0.91),
            bottom: Rgb(0.955, 0.957, 0.96),
        }
    }
}

impl Background {
    /// One colour all over.
    #[must_use]
    pub fn plain(color: Rgb) -> Self {
        Self {
            top: color,
            bottom: color,
        }
    }
}

impl ColorBy {
    /// Colours by the parts' fields over their own range.
    #[must_use]
    pub fn field(name: impl Into<String>, unit: impl Into<String>, map: ColorMap) -> Self {
        Self::Field {
            name: name.into(),
            unit: unit.into(),
            map,
            range: None,
        }
    }
}

impl RenderOptions {
    /// The defaults for a picture of this size.
    #[must_use]
    pub fn new(width: u32, height: u32, camera: Camera) -> Self {
        Self {
            width,
            height,
            samples: 3,
            camera,
            quality: Quality::default(),
            color: ColorBy::default(),
            background: Background::default(),
            wireframe: false,
            light: Light::default(),
            shadow: 1.0,
            ambient_occlusion: 1.0,
            caption: None,
        }
    }

    /// Refuses what has no meaning.
    pub(crate) fn check(&self) -> Result<(), RenderError> {
        let (width, height) = (self.width, self.height);
        if !(1..=MAX_SIDE).contains(&width) || !(1..=MAX_SIDE).contains(&height) {
            return Err(RenderError::Size { width, height });
        }
        let numbers = [
            (
                "samples",
                f64::from(self.samples),
                1.0..=8.0,
                "between 1 and 8",
            ),
            ("shadow", self.shadow, 0.0..=1.0, "between 0 and 1"),
            (
                "ambient_occlusion",
                self.ambient_occlusion,
                0.0..=1.0,
                "between 0 and 1",
            ),
            (
                "light.azimuth",
                self.light.azimuth,
                -3600.0..=3600.0,
                "a number of degrees",
            ),
            (
                "light.elevation",
                self.light.elevation,
                5.0..=90.0,
                "between 5 and 90 degrees",
            ),
            (
                "light.softness",
                self.light.softness,
                0.0..=45.0,
                "between 0 and 45 degrees",
            ),
        ];
        for (name, value, range, expected) in numbers {
            if !range.contains(&value) {
                return Err(RenderError::Option {
                    name,
                    value,
                    expected,
                });
            }
        }
        if let ColorBy::Field {
            range: Some((low, high)),
            ..
        } = self.color
        {
            for value in [low, high] {
                if !value.is_finite() {
                    return Err(RenderError::Option {
                        name: "an end of the color range",
                        value,
                        expected: "finite",
                    });
                }
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Bounds, CameraView};

    #[test]
    fn options_without_meaning_are_named() {
        let camera = Camera::fit(&Bounds::EMPTY, CameraView::Iso, 1.0);
        let good = RenderOptions::new(8, 8, camera);
        assert_eq!(good.check(), Ok(()));
        let bad = RenderOptions {
            samples: 0,
            ..good.clone()
        };
        assert!(matches!(
            bad.check(),
            Err(RenderError::Option {
                name: "samples",
                ..
            })
        ));
        let bad = RenderOptions {
            width: 0,
            ..good.clone()
        };
        assert_eq!(
            bad.check(),
            Err(RenderError::Size {
                width: 0,
                height: 8
            })
        );
        let range = Some((0.0, f64::NAN));
        let color = ColorBy::Field {
            name: "a".into(),
            unit: String::new(),
            map: ColorMap::Viridis,
            range,
        };
        assert!(RenderOptions { color, ..good }.check().is_err());
    }
}
