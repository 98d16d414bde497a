//! The camera: a perspective view that frames a box, described by a short text.

use std::str::FromStr;

use crate::scene::Bounds;

/// Vertical field of view at zoom 1 (degrees): a long lens, so parallel edges stay nearly parallel.
const FIELD_OF_VIEW: f64 = 26.0;
/// Share of the half picture that is left free around the framed box.
const MARGIN: f64 = 0.07;

/// From where to look. Parsed from `front`, `side`, `top`, `iso` or `azimuth=30,elevation=20,zoom=1.2`.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[non_exhaustive]
pub enum CameraView {
    /// Along +y, level.
    Front,
    /// Along −x, level.
    Side,
    /// Straight down, with +y up in the picture.
    Top,
    /// A three-quarter view from above: azimuth 35°, elevation 28°.
    #[default]
    Iso,
    /// From any direction.
    Orbit {
        /// Angle about z (degrees): 0 looks along +y, 90 along −x.
        azimuth: f64,
        /// Angle above the horizon (degrees), −90 to 90.
        elevation: f64,
        /// 1 frames everything, 2 shows half as much.
        zoom: f64,
    },
}

/// A text that names no view.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum CameraParseError {
    /// Neither a name nor a `key=value` list.
    #[error("unknown camera `{0}`: use front, side, top, iso or azimuth=30,elevation=20,zoom=1.2")]
    UnknownView(String),
    /// A key that is none of the three.
    #[error("unknown camera setting `{0}`: use azimuth, elevation or zoom")]
    UnknownKey(String),
    /// A key that stands twice.
    #[error("camera setting `{0}` is given twice")]
    Repeated(String),
    /// A value that is no number, or outside its range.
    #[error("camera setting `{key}={value}`: must be {expected}")]
    Value {
        /// Which setting.
        key: String,
        /// What was given.
        value: String,
        /// What it may be.
        expected: &'static str,
    },
}

impl CameraView {
    /// Azimuth, elevation (degrees) and zoom.
    fn angles(self) -> (f64, f64, f64) {
        match self {
            Self::Front => (0.0, 0.0, 1.0),
            Self::Side => (90.0, 0.0, 1.0),
            Self::Top => (0.0, 90.0, 1.0),
            Self::Iso => (35.0, 28.0, 1.0),
            Self::Orbit {
                azimuth,
                elevation,
                zoom,
            } => (azimuth, elevation, zoom),
        }
    }
}

impl FromStr for CameraView {
    type Err = CameraParseError;

    /// Settings that are not given keep the values of `iso`.
    fn from_str(text: &str) -> Result<Self, CameraParseError> {
        match text.trim() {
            "front" => return Ok(Self::Front),
            "side" => return Ok(Self::Side),
            "top" => return Ok(Self::Top),
            "iso" => return Ok(Self::Iso),
            list if list.contains('=') => {}
            other => return Err(CameraParseError::UnknownView(other.to_owned())),
        }
        let (mut azimuth, mut elevation, mut zoom) = (None, None, None);
        for item in text.split(',') {
            let (key, value) = item.split_once('=').unwrap_or((item, ""));
            let (key, value) = (key.trim(), value.trim());
            let (slot, range, expected) = match key {
                "azimuth" => (&mut azimuth, -3600.0..=3600.0, "a number of degrees"),
                "elevation" => (
                    &mut elevation,
                    -90.0..=90.0,
                    "a number of degrees between -90 and 90",
                ),
                "zoom" => (&mut zoom, 0.1..=100.0, "a number between 0.1 and 100"),
                _ => return Err(CameraParseError::UnknownKey(key.to_owned())),
            };
            let number = value
                .parse()
                .ok()
                .filter(|number: &f64| range.contains(number));
            let number = number.ok_or(CameraParseError::Value {
                key: key.into(),
                value: value.into(),
                expected,
            })?;
            if slot.replace(number).is_some() {
                return Err(CameraParseError::Repeated(key.to_owned()));
            }
        }
        let (iso_azimuth, iso_elevation, iso_zoom) = Self::Iso.angles();
        Ok(Self::Orbit {
            azimuth: azimuth.unwrap_or(iso_azimuth),
            elevation: elevation.unwrap_or(iso_elevation),
            zoom: zoom.unwrap_or(iso_zoom),
        })
    }
}

/// A placed perspective camera.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Camera {
    pub(crate) eye: [f64; 3],
    pub(crate) right: [f64; 3],
    pub(crate) up: [f64; 3],
    pub(crate) forward: [f64; 3],
    /// Tangent of half the vertical field of view.
    pub(crate) tan_half: f64,
    /// Half the diagonal of the framed box: the length that counts as one for the reach of light, the same in all frames
    /// of a film.
    pub(crate) unit: f64,
}

impl Camera {
    /// The camera that frames a box in a picture of the given aspect (width over height).
    ///
    /// Give the box of all frames of a film, so that the camera stands still. An empty box is framed like a unit cube
    /// about the origin; a view or an aspect that is not finite like the default one.
    #[must_use]
    pub fn fit(bounds: &Bounds, view: CameraView, aspect: f64) -> Self {
        let unit = Bounds {
            min: [-0.5; 3],
            max: [0.5; 3],
        };
        Self::fit_points(
            if bounds.is_empty() { unit } else { *bounds }.corners(),
            view,
            aspect,
        )
    }

    /// The camera that frames some points: tighter than their box.
    #[must_use]
    pub fn fit_points(
        points: impl IntoIterator<Item = [f64; 3]>,
        view: CameraView,
        aspect: f64,
    ) -> Self {
        let (azimuth, elevation, zoom) = match view.angles() {
            (a, e, z) if a.is_finite() && e.is_finite() && z.is_finite() && z > 0.0 => (a, e, z),
            _ => CameraView::Iso.angles(),
        };
        let aspect = if aspect.is_finite() && aspect > 0.0 {
            aspect
        } else {
            16.0 / 9.0
        };
        let (sin_azimuth, cos_azimuth) = azimuth.to_radians().sin_cos();
        let (sin_elevation, cos_elevation) = elevation.to_radians().sin_cos();
        let forward = [
            -sin_azimuth * cos_elevation,
            cos_azimuth * cos_elevation,
            -sin_elevation,
        ];
        let right = [cos_azimuth, sin_azimuth, 0.0];
        let up = cross(right, forward);
        let tan_half = (0.5 * FIELD_OF_VIEW).to_radians().tan();
        // A point with picture coordinates (x, y) and depth z is inside when |x - cx| ≤ t (z + D): the four planes that
        // touch the points give the centre and the distance D of the eye.
        let (tan_x, tan_y) = (
            tan_half * aspect * (1.0 - MARGIN),
            tan_half * (1.0 - MARGIN),
        );
        let mut planes = [f64::NEG_INFINITY; 4];
        let mut nearest = f64::INFINITY;
        let mut bounds = Bounds::EMPTY;
        for point in points
            .into_iter()
            .filter(|point| point.iter().all(|x| x.is_finite()))
        {
            let (x, y, z) = (dot(right, point), dot(up, point), dot(forward, point));
            let reach = [x / tan_x - z, -x / tan_x - z, y / tan_y - z, -y / tan_y - z];
            planes = std::array::from_fn(|i| planes[i].max(reach[i]));
            nearest = nearest.min(z);
            bounds.include(point);
        }
        if nearest == f64::INFINITY {
            return Self::fit(&Bounds::EMPTY, view, aspect);
        }
        let distance = (0.5 * (planes[0] + planes[1])).max(0.5 * (planes[2] + planes[3]));
        let (x, y) = (
            0.5 * tan_x * (planes[0] - planes[1]),
            0.5 * tan_y * (planes[2] - planes[3]),
        );
        // A single point, or a line along the view, leaves no distance: stand off a unit.
        let degenerate = distance + nearest <= 1e-9 * nearest.abs();
        let distance = if degenerate { 1.0 - nearest } else { distance };
        let eye =
            std::array::from_fn(|axis| x * right[axis] + y * up[axis] - distance * forward[axis]);
        Self {
            eye,
            right,
            up,
            forward,
            tan_half: tan_half / zoom,
            unit: if bounds.radius() > 0.0 {
                bounds.radius()
            } else {
                1.0
            },
        }
    }

    /// Where a point falls in a picture (pixels, y down), `None` behind the camera.
    #[must_use]
    pub fn project(&self, point: [f64; 3], width: u32, height: u32) -> Option<[f64; 2]> {
        let offset = std::array::from_fn(|axis| point[axis] - self.eye[axis]);
        let depth = dot(self.forward, offset);
        if depth <= 0.0 || !depth.is_finite() {
            return None;
        }
        let pixels = 0.5 * f64::from(height) / (self.tan_half * depth);
        Some([
            0.5 * f64::from(width) + pixels * dot(self.right, offset),
            0.5 * f64::from(height) - pixels * dot(self.up, offset),
        ])
    }
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    const BOX: Bounds = Bounds {
        min: [2.0, -1.0, 0.0],
        max: [5.0, 1.0, 0.5],
    };

    #[test]
    fn every_view_frames_the_box_and_touches_the_margin() {
        let orbit = CameraView::Orbit {
            azimuth: -130.0,
            elevation: -20.0,
            zoom: 1.0,
        };
        for view in [
            CameraView::Front,
            CameraView::Side,
            CameraView::Top,
            CameraView::Iso,
            orbit,
        ] {
            for (width, height) in [(1280, 720), (400, 900)] {
                let camera = Camera::fit(&BOX, view, f64::from(width) / f64::from(height));
                let mut reach: f64 = 0.0;
                for corner in BOX.corners() {
                    let [x, y] = camera.project(corner, width, height).unwrap();
                    let half = [0.5 * f64::from(width), 0.5 * f64::from(height)];
                    reach = reach
                        .max(((x - half[0]) / half[0]).abs())
                        .max(((y - half[1]) / half[1]).abs());
                }
                assert!((reach - (1.0 - MARGIN)).abs() < 1e-9, "{view:?}: {reach}");
            }
        }
    }

    #[test]
    fn the_front_view_has_x_to_the_right_and_z_up() {
        let camera = Camera::fit(&BOX, CameraView::Front, 1.0);
        let low = camera.project(BOX.min, 100, 100).unwrap();
        let high = camera.project(BOX.max, 100, 100).unwrap();
        assert!(high[0] > low[0] && high[1] < low[1]);
    }

    #[test]
    fn degenerate_boxes_still_give_a_finite_camera() {
        for bounds in [
            Bounds::EMPTY,
            Bounds {
                min: [3.0; 3],
                max: [3.0; 3],
            },
        ] {
            let camera = Camera::fit(&bounds, CameraView::Iso, 1.5);
            assert!(camera.eye.iter().all(|x| x.is_finite()));
            assert!(camera.project(bounds.center(), 10, 10).is_some());
        }
    }

    #[test]
    fn views_are_parsed_from_text() {
        assert_eq!("top".parse(), Ok(CameraView::Top));
        assert_eq!(
            "elevation=20, zoom=1.2 ,azimuth=-30".parse(),
            Ok(CameraView::Orbit {
                azimuth: -30.0,
                elevation: 20.0,
                zoom: 1.2
            })
        );
        assert_eq!(
            "zoom=2".parse(),
            Ok(CameraView::Orbit {
                azimuth: 35.0,
                elevation: 28.0,
                zoom: 2.0
            })
        );
    }

    #[test]
    fn a_bad_view_says_what_is_wrong() {
        let message = |text: &str| text.parse::<CameraView>().unwrap_err().to_string();
        assert!(message("fornt").contains("`fornt`"));
        assert!(message("azimut=3").contains("unknown camera setting `azimut`"));
        assert!(message("azimuth=1,azimuth=2").contains("twice"));
        assert!(message("elevation=91").contains("between -90 and 90"));
        assert!(message("zoom=NaN").contains("zoom=NaN"));
        assert!(message("zoom=").contains("must be"));
    }
}
