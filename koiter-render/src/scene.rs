//! What is drawn: views of triangle meshes, borrowed from whoever holds them.

use crate::color::Rgb;
use crate::error::RenderError;

/// Everything in one picture.
#[derive(Debug, Clone, Default)]
pub struct Scene<'a> {
    /// Shells and obstacles, in any order; it does not change the picture.
    pub parts: Vec<PartView<'a>>,
    /// The floor.
    pub ground: Ground,
}

/// A triangle mesh at one moment.
#[derive(Debug, Clone, Copy)]
pub struct PartView<'a> {
    /// Deformed positions of the vertices.
    pub positions: &'a [[f64; 3]],
    /// Corners of the faces; counter-clockwise seen from the front.
    pub faces: &'a [[u32; 3]],
    /// Decides how it is shaded.
    pub kind: PartKind,
    /// Colour of the front of a shell, of both sides of an obstacle.
    pub color: Rgb,
    /// What [`ColorBy::Field`](crate::ColorBy::Field) shows; a part without a field keeps its colour.
    pub field: Option<FieldView<'a>>,
}

/// How a part is shaded.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum PartKind {
    /// Cloth: matt, the back of a slightly different hue.
    #[default]
    Shell,
    /// A body the shells touch: plain, both sides alike, never in wireframe.
    Obstacle,
}

/// A scalar on a mesh. Values that are not finite are drawn grey.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum FieldView<'a> {
    /// Interpolated over the faces.
    PerVertex(&'a [f64]),
    /// Constant on each face.
    PerFace(&'a [f64]),
}

/// The floor: it shows only through the shadows on it, and fades into the background. Seen from below, it is left out.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum Ground {
    /// No floor.
    #[default]
    None,
    /// A horizontal plane at this height.
    At(f64),
}

/// Height of an obstacle that is a level rectangle: floors are shown as the [`Ground`] rather than as two triangles.
#[must_use]
pub fn level_floor(positions: &[[f64; 3]], faces: &[[u32; 3]]) -> Option<f64> {
    if faces.len() != 2 {
        return None;
    }
    let height = positions.first()?[2];
    (positions.iter())
        .all(|position| (position[2] - height).abs() < 1e-9)
        .then_some(height)
}

impl<'a> PartView<'a> {
    /// A shell in the default blue.
    #[must_use]
    pub fn shell(positions: &'a [[f64; 3]], faces: &'a [[u32; 3]]) -> Self {
        Self {
            positions,
            faces,
            kind: PartKind::Shell,
            color: Rgb::BLUE,
            field: None,
        }
    }

    /// An obstacle in the default light grey.
    #[must_use]
    pub fn obstacle(positions: &'a [[f64; 3]], faces: &'a [[u32; 3]]) -> Self {
        Self {
            positions,
            faces,
            kind: PartKind::Obstacle,
            color: Rgb::STONE,
            field: None,
        }
    }

    fn check(&self, part: usize) -> Result<(), RenderError> {
        for (vertex, &position) in self.positions.iter().enumerate() {
            if !position.iter().all(|x| x.is_finite()) {
                return Err(RenderError::PositionNotFinite {
                    part,
                    vertex,
                    position,
                });
            }
        }
        let num_vertices = self.positions.len();
        for (face, corners) in self.faces.iter().enumerate() {
            if let Some(&vertex) = corners.iter().find(|&&v| v as usize >= num_vertices) {
                return Err(RenderError::VertexOutOfRange {
                    part,
                    face,
                    vertex,
                    num_vertices,
                });
            }
        }
        let (elements, expected, found) = match self.field {
            None => return Ok(()),
            Some(FieldView::PerVertex(values)) => ("vertices", num_vertices, values.len()),
            Some(FieldView::PerFace(values)) => ("faces", self.faces.len(), values.len()),
        };
        if found == expected {
            Ok(())
        } else {
            Err(RenderError::FieldLength {
                part,
                elements,
                expected,
                found,
            })
        }
    }
}

impl<'a> FieldView<'a> {
    /// The values, in the order of vertices or faces.
    #[must_use]
    pub fn values(&self) -> &'a [f64] {
        match self {
            FieldView::PerVertex(values) | FieldView::PerFace(values) => values,
        }
    }
}

impl Scene<'_> {
    /// The smallest box around all positions.
    ///
    /// # Errors
    /// [`RenderError::EmptyScene`] without a face, [`RenderError::PositionNotFinite`] for NaN or infinity.
    pub fn bounds(&self) -> Result<Bounds, RenderError> {
        self.check()?;
        let mut bounds = Bounds::EMPTY;
        for part in self.parts.iter().filter(|part| !part.faces.is_empty()) {
            part.positions.iter().for_each(|&p| bounds.include(p));
        }
        Ok(bounds)
    }

    /// The smallest and largest finite value of all fields, `None` when there is none.
    #[must_use]
    pub fn field_range(&self) -> Option<(f64, f64)> {
        let values = self
            .parts
            .iter()
            .filter_map(|part| part.field)
            .flat_map(|field| field.values());
        values
            .filter(|value| value.is_finite())
            .fold(None, |range, &v| {
                Some(range.map_or((v, v), |(low, high): (f64, f64)| (low.min(v), high.max(v))))
            })
    }

    /// Refuses what cannot be drawn.
    pub(crate) fn check(&self) -> Result<(), RenderError> {
        if self.parts.iter().all(|part| part.faces.is_empty()) {
            return Err(RenderError::EmptyScene);
        }
        self.parts
            .iter()
            .enumerate()
            .try_for_each(|(index, part)| part.check(index))?;
        match self.ground {
            Ground::At(height) if !height.is_finite() => Err(RenderError::Option {
                name: "the height of the ground",
                value: height,
                expected: "finite",
            }),
            _ => Ok(()),
        }
    }
}

/// An axis-aligned box. Joined over all frames of a film, it frames the camera once for all.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bounds {
    /// The smallest coordinates.
    pub min: [f64; 3],
    /// The largest coordinates.
    pub max: [f64; 3],
}

impl Bounds {
    /// The box around nothing: joining it to another changes nothing.
    pub const EMPTY: Self = Self {
        min: [f64::INFINITY; 3],
        max: [f64::NEG_INFINITY; 3],
    };

    /// Grows the box to hold a point; a point that is not finite is left out.
    pub fn include(&mut self, point: [f64; 3]) {
        if point.iter().all(|x| x.is_finite()) {
            for axis in 0..3 {
                self.min[axis] = self.min[axis].min(point[axis]);
                self.max[axis] = self.max[axis].max(point[axis]);
            }
        }
    }

    /// The smallest box around both.
    #[must_use]
    pub fn join(mut self, other: &Self) -> Self {
        self.include(other.min);
        self.include(other.max);
        self
    }

    /// Whether no point was included.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.min[0] > self.max[0]
    }

    /// The middle; the origin for an empty box.
    #[must_use]
    pub fn center(&self) -> [f64; 3] {
        if self.is_empty() {
            [0.0; 3]
        } else {
            [0, 1, 2].map(|axis| 0.5 * (self.min[axis] + self.max[axis]))
        }
    }

    /// Half the diagonal; zero for an empty box or a single point.
    #[must_use]
    pub fn radius(&self) -> f64 {
        if self.is_empty() {
            return 0.0;
        }
        0.5 * (0..3)
            .map(|axis| (self.max[axis] - self.min[axis]).powi(2))
            .sum::<f64>()
            .sqrt()
    }

    pub(crate) fn corners(&self) -> [[f64; 3]; 8] {
        std::array::from_fn(|i| {
            std::array::from_fn(|axis| {
                if i >> axis & 1 == 0 {
                    self.min[axis]
                } else {
                    self.max[axis]
                }
            })
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TRIANGLE: [[f64; 3]; 3] = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 2.0, 0.0]];

    fn scene<'a>(positions: &'a [[f64; 3]], faces: &'a [[u32; 3]]) -> Scene<'a> {
        Scene {
            parts: vec![PartView::shell(positions, faces)],
            ground: Ground::None,
        }
    }

    #[test]
    fn an_empty_scene_is_an_error() {
        assert_eq!(Scene::default().bounds(), Err(RenderError::EmptyScene));
        assert_eq!(scene(&TRIANGLE, &[]).bounds(), Err(RenderError::EmptyScene));
    }

    #[test]
    fn a_nan_position_is_named() {
        let positions = [TRIANGLE[0], [1.0, f64::NAN, 0.0], TRIANGLE[2]];
        let error = scene(&positions, &[[0, 1, 2]]).check().unwrap_err();
        assert!(
            matches!(
                error,
                RenderError::PositionNotFinite {
                    part: 0,
                    vertex: 1,
                    ..
                }
            ),
            "{error}"
        );
    }

    #[test]
    fn a_missing_vertex_and_a_short_field_are_named() {
        let error = scene(&TRIANGLE, &[[0, 1, 3]]).check().unwrap_err();
        assert_eq!(
            error,
            RenderError::VertexOutOfRange {
                part: 0,
                face: 0,
                vertex: 3,
                num_vertices: 3
            }
        );
        let mut short = scene(&TRIANGLE, &[[0, 1, 2]]);
        short.parts[0].field = Some(FieldView::PerVertex(&[1.0]));
        assert!(matches!(
            short.check(),
            Err(RenderError::FieldLength {
                expected: 3,
                found: 1,
                ..
            })
        ));
    }

    #[test]
    fn bounds_join_over_frames_and_leave_out_nan() {
        let first = scene(&TRIANGLE, &[[0, 1, 2]]).bounds().unwrap();
        let mut second = Bounds::EMPTY;
        second.include([0.5, 0.5, -1.0]);
        second.include([f64::NAN, 9.0, 9.0]);
        let both = Bounds::EMPTY.join(&first).join(&second);
        assert_eq!((both.min, both.max), ([0.0, 0.0, -1.0], [1.0, 2.0, 0.0]));
    }

    #[test]
    fn the_field_range_skips_values_that_are_not_finite() {
        let mut scene = scene(&TRIANGLE, &[[0, 1, 2]]);
        assert_eq!(scene.field_range(), None);
        scene.parts[0].field = Some(FieldView::PerVertex(&[f64::NAN, 3.0, -1.0]));
        assert_eq!(scene.field_range(), Some((-1.0, 3.0)));
    }
}
