//! From seen triangles and light to colours.
//!
//! ```text
//! c = ρ (K key max(0, n·l) + S m(sky, ρ)) + sheen
//! ```
//!
//! `ρ` albedo, `n` normal, `l` direction of the lamp, `m` light of the sky with what surfaces of the same colour throw
//! at each other in folds (fit of Jimenez et al. 2016, "Practical Realtime Strategies for Accurate Indirect
//! Occlusion", Eq. 10).

use rayon::prelude::*;

use crate::color::encode;
use crate::hit::Hit;
use crate::light::{LightMap, Received, lamp_direction};
use crate::options::RenderOptions;
use crate::raster::{GROUND, Samples, ScreenTriangle, View, bin};
use crate::scene::PartKind;
use crate::surface::Surface;
use crate::vector::{Vec3, smoothstep, vec3};

/// Strength of the lamp, the sky and a faint light at the eye; a surface that faces the lamp keeps about its colour.
const KEY: f32 = 0.74;
const SKY: f32 = 0.50;
const EYE: f32 = 0.08;
/// Share of the sky's light that reaches even the deepest fold, by way of surfaces that are not traced.
const LEAST_SKY: f32 = 0.05;
/// The lamp is a little warm, the sky a little cool; not for fields, whose colours are read off a legend.
const KEY_TINT: Vec3 = vec3(1.03, 1.0, 0.95);
const SKY_TINT: Vec3 = vec3(0.96, 1.0, 1.06);
/// Rows of pixels that one thread handles at a time.
const BAND: usize = 8;
/// Width of wireframe lines (pixels).
const LINE: f32 = 0.9;

/// What shading needs.
pub(crate) struct Shader<'a> {
    pub(crate) view: &'a View,
    pub(crate) surface: &'a Surface,
    pub(crate) light: &'a LightMap,
    pub(crate) options: &'a RenderOptions,
    pub(crate) lamp: Vec3,
}

impl<'a> Shader<'a> {
    pub(crate) fn new(
        view: &'a View,
        surface: &'a Surface,
        light: &'a LightMap,
        options: &'a RenderOptions,
    ) -> Self {
        Self {
            view,
            surface,
            light,
            options,
            lamp: lamp_direction(view, options),
        }
    }

    /// The whole picture as sRGB bytes.
    pub(crate) fn picture(&self, triangles: &[ScreenTriangle]) -> Vec<u8> {
        let (width, height) = (self.options.width as usize, self.options.height as usize);
        let bins = bin(triangles, self.options.height, BAND);
        let mut bytes = vec![0; 3 * width * height];
        bytes
            .par_chunks_mut(3 * width * BAND)
            .zip(&bins)
            .enumerate()
            .for_each(|(band, (bytes, bin))| {
                let rows = band * BAND..((band + 1) * BAND).min(height);
                let per_side = self.options.samples as usize;
                let grid = (
                    width * per_side,
                    rows.start * per_side..rows.end * per_side,
                    per_side as f32,
                );
                let samples = Samples::fill(self.view, self.surface.ground, triangles, bin, grid);
                let mut seen = Vec::new();
                for (row, line) in rows.clone().zip(bytes.chunks_exact_mut(3 * width)) {
                    let background = self.background(row);
                    for (column, pixel) in line.chunks_exact_mut(3).enumerate() {
                        gather(&samples, (column, row), rows.start, per_side, &mut seen);
                        let color = self.pixel(&seen, per_side * per_side, background);
                        // One level of 256 is wide enough to see as a band in a smooth background.
                        let dither = (INTERLEAVE[row % 4][column % 4] + 0.5) / 16.0;
                        for (byte, light) in pixel.iter_mut().zip(color.to_array()) {
                            *byte = (255.0 * encode(light) + dither) as u8;
                        }
                    }
                }
            });
        bytes
    }

    /// Linear colour behind everything in a row of pixels.
    fn background(&self, row: usize) -> Vec3 {
        let t = (row as f32 + 0.5) / self.options.height as f32;
        self.options
            .background
            .top
            .lerp(self.options.background.bottom, t)
            .to_linear()
    }

    fn pixel(&self, seen: &[Seen], total: usize, background: Vec3) -> Vec3 {
        let mut sum = Vec3::default();
        for seen in seen {
            let (x, y) = (seen.x / seen.count as f32, seen.y / seen.count as f32);
            let color = match Hit::find(self.surface, self.view, seen.face, x, y) {
                None => background,
                Some(hit) => {
                    let received = self.light.at(self.view, &hit, x, y);
                    if seen.face == GROUND {
                        background.scale(self.ground(received))
                    } else {
                        self.surface_color(seen.face, &hit, received)
                    }
                }
            };
            // Averaging square roots of light is near to averaging what the eye sees: edges against the light background
            // look even.
            let root = vec3(
                color.x.max(0.0).sqrt(),
                color.y.max(0.0).sqrt(),
                color.z.max(0.0).sqrt(),
            );
            sum += root * (seen.count as f32 / total as f32);
        }
        sum.scale(sum)
    }

    /// How much the ground darkens the background: nothing in the open, so that it has no border.
    fn ground(&self, received: Received) -> Vec3 {
        let lamp = KEY * self.lamp.z;
        let share = (lamp * received.key + SKY * received.sky) / (lamp + SKY);
        // Shadows lose a little of the lamp's warmth. The factor keeps them lighter than those on the shells.
        let shade = 1.0 - 0.82 * (1.0 - share.min(1.0));
        vec3(shade.powf(1.05), shade, shade.powf(0.93))
    }

    fn surface_color(&self, face: u32, hit: &Hit, received: Received) -> Vec3 {
        let (mut albedo, is_field) = self.surface.color(face, hit.weights, hit.is_front);
        let part = &self.surface.parts[hit.group as usize];
        if self.options.wireframe && part.kind == PartKind::Shell {
            albedo = albedo * (1.0 - 0.72 * self.line(face, hit));
        }
        let to_eye = (self.view.eye - hit.position).normalized_or(hit.normal);
        let facing = hit.normal.dot(to_eye).clamp(0.0, 1.0);
        let lamp = KEY * received.key * hit.normal.dot(self.lamp).max(0.0);
        let sky = bounced(LEAST_SKY + (1.0 - LEAST_SKY) * received.sky, albedo) * SKY;
        let (key_tint, sky_tint) = if is_field {
            (vec3(1.0, 1.0, 1.0), vec3(1.0, 1.0, 1.0))
        } else {
            (KEY_TINT, SKY_TINT)
        };
        let light = key_tint * lamp + sky_tint.scale(sky) + vec3(EYE, EYE, EYE) * facing;
        // Colours of a field are compared with the legend: shade them less.
        let light = if is_field {
            light.lerp(vec3(1.0, 1.0, 1.0), 0.3)
        } else {
            light
        };
        let sheen = match (is_field, part.kind) {
            (true, _) => Vec3::default(),
            // Fibres that stand up at the rim.
            (_, PartKind::Shell) => {
                albedo.lerp(vec3(1.0, 1.0, 1.0), 0.35)
                    * (0.15 * (1.0 - facing).powi(4) * (0.3 * received.sky + lamp))
            }
            // A faint gloss.
            (_, PartKind::Obstacle) => {
                let half = (to_eye + self.lamp).normalized_or(hit.normal);
                vec3(1.0, 1.0, 1.0) * (0.07 * received.key * hit.normal.dot(half).max(0.0).powi(24))
            }
        };
        tone(albedo.scale(light) + sheen)
    }

    /// 1 on the edges of a face, 0 inside; fades where faces are as small as pixels.
    fn line(&self, face: u32, hit: &Hit) -> f32 {
        let corners = self.surface.corners(face);
        let double_area = (corners[1] - corners[0])
            .cross(corners[2] - corners[0])
            .length();
        let pixel = self.view.pixel_size() * (hit.position - self.view.eye).dot(self.view.forward);
        let mut line: f32 = 0.0;
        for i in 0..3 {
            let edge = (corners[(i + 2) % 3] - corners[(i + 1) % 3])
                .length()
                .max(1e-12);
            let altitude = double_area / edge / pixel;
            let distance = hit.weights[i] * altitude;
            line = line.max(
                (1.0 - smoothstep(0.5 * LINE - 0.3, 0.5 * LINE + 0.5, distance))
                    * (altitude / 9.0).min(1.0),
            );
        }
        line
    }
}

/// A 4 × 4 ordered dither, in sixteenths.
const INTERLEAVE: [[f32; 4]; 4] = [
    [0.0, 8.0, 2.0, 10.0],
    [12.0, 4.0, 14.0, 6.0],
    [3.0, 11.0, 1.0, 9.0],
    [15.0, 7.0, 13.0, 5.0],
];

/// Samples of a pixel that see the same face: shaded once, at their mean.
struct Seen {
    face: u32,
    count: u32,
    x: f32,
    y: f32,
}

fn gather(
    samples: &Samples,
    (column, row): (usize, usize),
    first_row: usize,
    per_side: usize,
    seen: &mut Vec<Seen>,
) {
    seen.clear();
    for j in 0..per_side {
        let start = ((row - first_row) * per_side + j) * samples.width + column * per_side;
        for i in 0..per_side {
            let face = samples.face[start + i];
            let index = seen
                .iter()
                .position(|seen| seen.face == face)
                .unwrap_or_else(|| {
                    seen.push(Seen {
                        face,
                        count: 0,
                        x: 0.0,
                        y: 0.0,
                    });
                    seen.len() - 1
                });
            let entry = &mut seen[index];
            entry.count += 1;
            let (x, y) = samples.pixel(column * per_side + i, row * per_side + j);
            entry.x += x;
            entry.y += y;
        }
    }
}

/// Light of the sky including what neighbours of the same albedo reflect.
fn bounced(sky: f32, albedo: Vec3) -> Vec3 {
    let channel = |rho: f32| {
        let (a, b, c) = (
            2.0404 * rho - 0.3324,
            -4.7951 * rho + 0.6417,
            2.7552 * rho + 0.6903,
        );
        sky.max(((sky * a + b) * sky + c) * sky)
    };
    vec3(channel(albedo.x), channel(albedo.y), channel(albedo.z))
}

/// Linear up to the knee, then bent so that nothing clips.
fn tone(light: Vec3) -> Vec3 {
    const KNEE: f32 = 0.65;
    let bend = |c: f32| {
        if c <= KNEE {
            c
        } else {
            KNEE + (1.0 - KNEE) * ((c - KNEE) / (1.0 - KNEE)).tanh()
        }
    };
    vec3(bend(light.x), bend(light.y), bend(light.z))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tones_rise_and_never_clip() {
        let mut previous = -1.0;
        for i in 0..200 {
            let value = tone(vec3(0.01 * i as f32, 0.0, 0.0)).x;
            assert!(value > previous && value < 1.0, "{i}");
            previous = value;
        }
    }

    #[test]
    fn bounced_light_only_adds_and_adds_more_to_light_colours() {
        for i in 0..=10 {
            let sky = 0.1 * i as f32;
            let light = bounced(sky, vec3(0.1, 0.5, 0.9));
            assert!(
                light.x >= sky && light.y >= light.x && light.z >= light.y,
                "{sky}: {light:?}"
            );
        }
    }
}
