//! Which triangle is seen where: projection, clipping at the near plane and filling of triangles on a grid of samples.

use std::ops::Range;

use rayon::prelude::*;

use crate::camera::Camera;
use crate::surface::Surface;
use crate::vector::{Vec3, vec3};

/// Sample that sees nothing.
pub(crate) const NOTHING: u32 = u32::MAX;
/// Sample that sees the ground.
pub(crate) const GROUND: u32 = u32::MAX - 1;

/// Nothing nearer to the eye is drawn, in units of the camera.
const NEAR: f32 = 1e-3;
/// The ground is drawn this much farther away, relatively, so that what lies on it is seen.
const GROUND_BIAS: f32 = 1e-4;
/// Corners are rounded to this fraction of a sample, so that edge functions are whole numbers and neighbours neither
/// overlap nor gape.
const SNAP: f64 = 256.0;

/// The camera in the unit frame of a surface.
pub(crate) struct View {
    pub(crate) eye: Vec3,
    pub(crate) right: Vec3,
    pub(crate) up: Vec3,
    pub(crate) forward: Vec3,
    half_width: f32,
    half_height: f32,
    /// Pixels per unit of tangent.
    pixels: f32,
}

/// A corner in the picture: pixels, and one over the depth.
#[derive(Clone, Copy)]
struct Corner {
    x: f32,
    y: f32,
    inverse_depth: f32,
}

/// A triangle in the picture, in front of the near plane.
pub(crate) struct ScreenTriangle {
    corners: [Corner; 3],
    face: u32,
}

/// What the samples of some rows see.
pub(crate) struct Samples {
    /// Face, or [`NOTHING`] or [`GROUND`].
    pub(crate) face: Vec<u32>,
    inverse_depth: Vec<f32>,
    pub(crate) width: usize,
    rows: Range<usize>,
    /// Samples per pixel along an axis.
    scale: f32,
    /// Period: the samples along the side of a pixel.
    offsets: Vec<f64>,
}

impl View {
    pub(crate) fn new(camera: &Camera, surface: &Surface, width: u32, height: u32) -> Self {
        Self {
            eye: surface.to_unit(camera.eye),
            right: Vec3::from_f64(camera.right),
            up: Vec3::from_f64(camera.up),
            forward: Vec3::from_f64(camera.forward),
            half_width: 0.5 * width as f32,
            half_height: 0.5 * height as f32,
            pixels: (0.5 * f64::from(height) / camera.tan_half) as f32,
        }
    }

    /// Direction from the eye through a point of the picture; its component along `forward` is one.
    pub(crate) fn direction(&self, x: f32, y: f32) -> Vec3 {
        self.forward
            + self.right * ((x - self.half_width) / self.pixels)
            + self.up * ((self.half_height - y) / self.pixels)
    }

    /// Size of a pixel at unit depth.
    pub(crate) fn pixel_size(&self) -> f32 {
        1.0 / self.pixels
    }

    /// Picture coordinates and depth of a point.
    fn to_camera(&self, point: Vec3) -> Vec3 {
        let offset = point - self.eye;
        vec3(
            offset.dot(self.right),
            offset.dot(self.up),
            offset.dot(self.forward),
        )
    }

    fn corner(&self, p: Vec3) -> Corner {
        let inverse_depth = 1.0 / p.z;
        let x = self.half_width + self.pixels * p.x * inverse_depth;
        let y = self.half_height - self.pixels * p.y * inverse_depth;
        Corner {
            x,
            y,
            inverse_depth,
        }
    }

    /// The triangles of a surface that are in front of the camera, in the order of its faces.
    pub(crate) fn project(&self, surface: &Surface) -> Vec<ScreenTriangle> {
        let points: Vec<Vec3> = surface
            .positions
            .par_iter()
            .map(|&p| self.to_camera(p))
            .collect();
        let faces = surface.faces.par_iter().enumerate();
        faces
            .flat_map_iter(|(face, corners)| {
                let polygon = clip(corners.map(|v| points[v as usize]));
                let corners: Vec<Corner> = polygon.iter().map(|&p| self.corner(p)).collect();
                (2..corners.len()).map(move |i| ScreenTriangle {
                    corners: [corners[0], corners[i - 1], corners[i]],
                    face: face as u32,
                })
            })
            .collect()
    }

    /// One over the depth of a horizontal plane seen at a point of the picture, negative above the horizon:
    /// an affine function, given as value at the origin and slopes in x and y.
    fn plane_inverse_depth(&self, height: f32) -> Option<[f32; 3]> {
        let above = self.eye.z - height;
        // Rounding may put the eye on the ground after all.
        if above <= 0.0 {
            return None;
        }
        let (origin, slope_x, slope_y) = (
            self.direction(0.0, 0.0).z,
            self.right.z / self.pixels,
            -self.up.z / self.pixels,
        );
        Some([origin, slope_x, slope_y].map(|c| -c / above))
    }
}

/// The part of a triangle beyond the near plane: a polygon of up to four corners.
fn clip(corners: [Vec3; 3]) -> Polygon {
    let mut polygon = Polygon {
        corners: [Vec3::default(); 4],
        count: 0,
    };
    for i in 0..3 {
        let (a, b) = (corners[i], corners[(i + 1) % 3]);
        if a.z >= NEAR {
            polygon.push(a);
        }
        if (a.z >= NEAR) != (b.z >= NEAR) {
            polygon.push(a.lerp(b, (NEAR - a.z) / (b.z - a.z)));
        }
    }
    polygon
}

struct Polygon {
    corners: [Vec3; 4],
    count: usize,
}

impl Polygon {
    fn push(&mut self, corner: Vec3) {
        self.corners[self.count] = corner;
        self.count += 1;
    }

    fn iter(&self) -> std::slice::Iter<'_, Vec3> {
        self.corners[..self.count].iter()
    }
}

/// Offsets of the samples from a regular grid: within a pixel all n² samples differ in x and in y, so that steep and flat
/// edges have n² shades (the canonical arrangement of Kensler 2013, "Correlated Multi-Jittered Sampling").
fn offsets(scale: f32) -> Vec<f64> {
    let period = (scale as usize).max(1);
    (0..period)
        .map(|k| (SNAP * ((k as f64 + 0.5) / period as f64 - 0.5)).round())
        .collect()
}

/// For each band of `band` rows of pixels, the triangles that may be seen there, in order.
pub(crate) fn bin(triangles: &[ScreenTriangle], height: u32, band: usize) -> Vec<Vec<u32>> {
    let num_bands = (height as usize).div_ceil(band);
    let mut bins = vec![Vec::new(); num_bands];
    for (index, triangle) in triangles.iter().enumerate() {
        let ys = triangle.corners.map(|corner| corner.y);
        let low = ys[0].min(ys[1]).min(ys[2]) - 1.0;
        let high = ys[0].max(ys[1]).max(ys[2]) + 1.0;
        if high < 0.0 || low >= height as f32 {
            continue;
        }
        let first = low.max(0.0) as usize / band;
        let last = (high as usize / band).min(num_bands - 1);
        bins[first..=last]
            .iter_mut()
            .for_each(|bin| bin.push(index as u32));
    }
    bins
}

impl Samples {
    /// Fills rows of samples. `scale` samples stand along the side of a pixel; less than one is a coarse grid.
    pub(crate) fn fill(
        view: &View,
        ground: Option<f32>,
        triangles: &[ScreenTriangle],
        bin: &[u32],
        (width, rows, scale): (usize, Range<usize>, f32),
    ) -> Self {
        let count = width * rows.len();
        let mut samples = Self {
            face: vec![NOTHING; count],
            inverse_depth: vec![0.0; count],
            width,
            rows: rows.clone(),
            scale,
            offsets: offsets(scale),
        };
        if let Some([origin, slope_x, slope_y]) =
            ground.and_then(|height| view.plane_inverse_depth(height))
        {
            for row in rows.clone() {
                for column in 0..width {
                    let (x, y) = samples.pixel(column, row);
                    let inverse_depth = (origin + slope_x * x + slope_y * y) * (1.0 - GROUND_BIAS);
                    if inverse_depth > 0.0 {
                        let index = (row - rows.start) * width + column;
                        samples.face[index] = GROUND;
                        samples.inverse_depth[index] = inverse_depth;
                    }
                }
            }
        }
        bin.iter()
            .for_each(|&index| samples.draw(&triangles[index as usize]));
        samples
    }

    /// Where a sample is in the picture (pixels).
    pub(crate) fn pixel(&self, column: usize, row: usize) -> (f32, f32) {
        let [dx, dy] = [row, column].map(|index| (self.offset(index) / SNAP) as f32);
        (
            (column as f32 + 0.5 + dx) / self.scale,
            (row as f32 + 0.5 + dy) / self.scale,
        )
    }

    /// How far the samples of a row stand to the right of a regular grid, and those of a column below it (1/SNAP).
    fn offset(&self, index: usize) -> f64 {
        self.offsets[index % self.offsets.len()]
    }

    /// Samples whose edge functions all have one sign are inside; the nearest triangle, then the first, wins.
    fn draw(&mut self, triangle: &ScreenTriangle) {
        let scale = f64::from(self.scale);
        let snapped = |value: f32| (f64::from(value) * scale * SNAP).round();
        let mut x = triangle.corners.map(|corner| snapped(corner.x));
        let mut y = triangle.corners.map(|corner| snapped(corner.y));
        let mut depth = triangle
            .corners
            .map(|corner| f64::from(corner.inverse_depth));
        let mut area = (x[1] - x[0]) * (y[2] - y[0]) - (x[2] - x[0]) * (y[1] - y[0]);
        if area == 0.0 || !area.is_finite() {
            return;
        }
        if area < 0.0 {
            x.swap(1, 2);
            y.swap(1, 2);
            depth.swap(1, 2);
            area = -area;
        }
        // Samples stand within half a unit of the regular grid.
        let span = |v: [f64; 3], limit: Range<usize>| {
            let low = (v[0].min(v[1]).min(v[2]) / SNAP - 1.0)
                .ceil()
                .max(limit.start as f64);
            let high = (v[0].max(v[1]).max(v[2]) / SNAP)
                .floor()
                .min(limit.end as f64 - 1.0);
            (low <= high).then(|| low as usize..high as usize + 1)
        };
        let (Some(columns), Some(rows)) = (span(x, 0..self.width), span(y, self.rows.clone()))
        else {
            return;
        };
        // Edge i runs from corner i + 1 to corner i + 2; its function is proportional to the weight of corner i.
        let edges = [0, 1, 2].map(|i| {
            let (a, b) = ((i + 1) % 3, (i + 2) % 3);
            [x[a], y[a], x[b] - x[a], y[b] - y[a]]
        });
        let slope = |k: usize| (0..3).map(|i| edges[i][k] * depth[i]).sum::<f64>() / area;
        let (slope_x, slope_y) = (-slope(3), slope(2));
        let period = self.offsets.len();
        for row in rows {
            let base = (row - self.rows.start) * self.width;
            // Columns of one phase share their offset, and one step takes each edge function from one to the next.
            for first in columns.clone().take(period) {
                let sample_x = (first as f64 + 0.5) * SNAP + self.offset(row);
                let sample_y = (row as f64 + 0.5) * SNAP + self.offset(first);
                let mut e = edges.map(|[x, y, dx, dy]| dx * (sample_y - y) - dy * (sample_x - x));
                let mut inverse_depth =
                    depth[0] + slope_x * (sample_x - x[0]) + slope_y * (sample_y - y[0]);
                let step = period as f64 * SNAP;
                for index in (base + first..base + columns.end).step_by(period) {
                    if e[0] >= 0.0
                        && e[1] >= 0.0
                        && e[2] >= 0.0
                        && inverse_depth as f32 > self.inverse_depth[index]
                    {
                        self.inverse_depth[index] = inverse_depth as f32;
                        self.face[index] = triangle.face;
                    }
                    e = [0, 1, 2].map(|i| e[i] - step * edges[i][3]);
                    inverse_depth += step * slope_x;
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn triangle(points: [[f32; 2]; 3], inverse_depth: f32, face: u32) -> ScreenTriangle {
        ScreenTriangle {
            corners: points.map(|[x, y]| Corner {
                x,
                y,
                inverse_depth,
            }),
            face,
        }
    }

    fn fill(triangles: &[ScreenTriangle], scale: f32) -> Samples {
        let view = View {
            eye: Vec3::default(),
            right: vec3(1.0, 0.0, 0.0),
            up: vec3(0.0, 0.0, 1.0),
            forward: vec3(0.0, 1.0, 0.0),
            half_width: 8.0,
            half_height: 8.0,
            pixels: 16.0,
        };
        let bin: Vec<u32> = (0..triangles.len() as u32).collect();
        let side = (16.0 * scale) as usize;
        Samples::fill(&view, None, triangles, &bin, (side, 0..side, scale))
    }

    #[test]
    fn a_fan_covers_its_square_without_gaps() {
        let center = [7.37, 8.11];
        let rim = [[2.0, 2.0], [14.0, 2.0], [14.0, 14.0], [2.0, 14.0]];
        let fan: Vec<_> = (0..4)
            .map(|i| triangle([center, rim[i], rim[(i + 1) % 4]], 1.0, i as u32))
            .collect();
        for scale in [0.5, 1.0, 3.0] {
            let samples = fill(&fan, scale);
            let covered = samples.face.iter().filter(|&&face| face != NOTHING).count();
            assert_eq!(covered, ((12.0 * scale) as usize).pow(2), "scale {scale}");
        }
    }

    #[test]
    fn the_nearer_triangle_hides_the_farther_in_any_order_and_winding() {
        let far = || triangle([[0.0, 0.0], [16.0, 0.0], [0.0, 16.0]], 0.5, 0);
        let near = || triangle([[0.0, 0.0], [0.0, 16.0], [16.0, 0.0]], 0.6, 1);
        for pair in [[far(), near()], [near(), far()]] {
            let samples = fill(&pair, 1.0);
            assert!(
                samples
                    .face
                    .iter()
                    .all(|&face| face == 1 || face == NOTHING)
            );
        }
    }

    #[test]
    fn a_triangle_through_the_near_plane_becomes_a_polygon_beyond_it() {
        let polygon = clip([
            vec3(0.0, 0.0, 1.0),
            vec3(1.0, 0.0, 1.0),
            vec3(0.0, 1.0, -1.0),
        ]);
        assert_eq!(polygon.count, 4);
        assert!(polygon.iter().all(|p| p.z >= 0.999 * NEAR));
        assert_eq!(clip([vec3(0.0, 0.0, -1.0); 3]).count, 0);
    }

    #[test]
    fn triangles_without_area_or_far_outside_are_left_out() {
        let flat = triangle([[1.0, 1.0], [2.0, 2.0], [3.0, 3.0]], 1.0, 0);
        let outside = triangle([[100.0, 1.0], [200.0, 1.0], [100.0, 9.0]], 1.0, 1);
        assert!(
            fill(&[flat, outside], 1.0)
                .face
                .iter()
                .all(|&face| face == NOTHING)
        );
    }
}
