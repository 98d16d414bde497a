//! How much light of the sky and of the lamp reaches each point, traced on a grid of texels over the picture.
//!
//! ```text
//! sky = (1/n) Σ L(ω_i) V(ω_i)      ω_i cosine-weighted about the normal
//! key = (1/m) Σ V(ω_j)             ω_j in a cone about the direction of the lamp
//! ```
//!
//! `L` radiance of the sky, 1 on average from above; `V` 1 if nothing is in the way. Each 4 × 4 tile of texels shares
//! one low-discrepancy sequence (Roberts' R2), and a filter of width 4 that stops at edges gathers it again: noise
//! without grain, and the same in every frame of a film.

use rayon::prelude::*;

use crate::bvh::Bvh;
use crate::hit::Hit;
use crate::options::{Quality, RenderOptions};
use crate::raster::{GROUND, NOTHING, Samples, ScreenTriangle, View, bin};
use crate::surface::Surface;
use crate::vector::{Vec3, vec3};

/// How far things darken each other in the light of the sky, in units of the camera.
const REACH: f32 = 1.2;
/// Rays start this far above the surface, in units of the camera: less than the gap of any contact that can be seen.
const LIFT: f32 = 2e-4;
/// Radiance of the sky at the horizon, and what is added towards the zenith: an open floor receives 1.
const HORIZON: f32 = 0.70;
const ZENITH: f32 = 0.45;
/// Radiance from below.
const BOUNCE: f32 = 0.50;
/// Height above the ground at which half of that light is left (units of the camera).
const BOUNCE_HEIGHT: f32 = 0.15;
/// The lamp is farther away than anything.
const LAMP_REACH: f32 = 1e12;
/// Rows of texels that one thread handles at a time.
const BAND: usize = 8;
/// Where each texel of a tile starts in the common sequence: neighbours far apart.
const TILE: [[usize; 4]; 4] = [[0, 8, 2, 10], [12, 4, 14, 6], [3, 11, 1, 9], [15, 7, 13, 5]];

/// Light on a grid of texels.
pub(crate) struct LightMap {
    texels: Vec<Texel>,
    width: usize,
    height: usize,
    /// Texels per pixel along an axis.
    scale: f32,
    /// Width of a texel at unit depth.
    footprint: f32,
}

#[derive(Clone, Copy)]
struct Texel {
    position: Vec3,
    normal: Vec3,
    /// [`NOTHING`] where nothing is seen.
    group: u32,
    light: Received,
}

/// Light of the sky and of the lamp that arrives, relative to the open.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Received {
    pub(crate) sky: f32,
    pub(crate) key: f32,
}

/// Unit vector towards the lamp.
pub(crate) fn lamp_direction(view: &View, options: &RenderOptions) -> Vec3 {
    let (sin_azimuth, cos_azimuth) = (options.light.azimuth as f32).to_radians().sin_cos();
    let (sin_elevation, cos_elevation) = (options.light.elevation as f32).to_radians().sin_cos();
    let to_camera = vec3(view.right.y, -view.right.x, 0.0);
    let level = to_camera * cos_azimuth + view.right * sin_azimuth;
    level * cos_elevation + vec3(0.0, 0.0, sin_elevation)
}

/// Ray directions about +z for every texel of a tile, and for each the share of [`REACH`] it goes.
struct Pattern {
    sky: Vec<[Vec3; 2]>,
    key: Vec<[f32; 2]>,
}

impl Pattern {
    fn new(quality: Quality) -> (Self, usize, usize) {
        let (num_sky, num_key) = match quality {
            Quality::Film => (12, 6),
            Quality::Still => (24, 12),
        };
        let fraction = |index: usize, step: f64| ((index as f64 + 0.5) * step).fract() as f32;
        // Steps of the sequences R2 and R3: powers of the inverse of the plastic number and of its cousin.
        let sky = (0..16 * num_sky).map(|index| {
            let (u, v) = (
                fraction(index, 0.819_172_513_4),
                fraction(index, 0.671_043_606_7),
            );
            let (sin, cos) = (std::f32::consts::TAU * v).sin_cos();
            let reach = 0.1 + 0.9 * fraction(index, 0.549_700_477_9);
            [
                vec3(u.sqrt() * cos, u.sqrt() * sin, (1.0 - u).sqrt()),
                vec3(reach, 0.0, 0.0),
            ]
        });
        let key = (0..16 * num_key).map(|index| {
            let (u, v) = (
                fraction(index, 0.754_877_666_2),
                fraction(index, 0.569_840_290_9),
            );
            let (sin, cos) = (std::f32::consts::TAU * v).sin_cos();
            [u.sqrt() * cos, u.sqrt() * sin]
        });
        (
            Self {
                sky: sky.collect(),
                key: key.collect(),
            },
            num_sky,
            num_key,
        )
    }
}

/// What tracing a texel needs.
struct Tracer<'a> {
    bvh: &'a Bvh,
    ground: Option<f32>,
    radius: f32,
    lamp: Vec3,
    /// Sine of the angular radius of the lamp.
    softness: f32,
    shadow: f32,
    occlusion: f32,
    pattern: Pattern,
    num_sky: usize,
    num_key: usize,
}

impl Tracer<'_> {
    fn received(&self, hit: &Hit, slot: usize) -> Received {
        let origin = hit.lifted + hit.face_normal * LIFT;
        Received {
            sky: self.sky(hit, origin, slot),
            key: self.key(hit, origin, slot),
        }
    }

    fn sky(&self, hit: &Hit, origin: Vec3, slot: usize) -> f32 {
        // Far from the scene nothing darkens the ground.
        let is_open = hit.position.length() > self.radius + REACH;
        let (s, t) = hit.normal.tangents();
        if is_open && hit.group == GROUND {
            return 1.0;
        }
        let (mut sum, mut open) = (0.0, 0.0);
        for [local, reach] in &self.pattern.sky[slot * self.num_sky..(slot + 1) * self.num_sky] {
            let direction = s * local.x + t * local.y + hit.normal * local.z;
            let mut reach = REACH * reach.x;
            let radiance = if direction.z >= 0.0 {
                HORIZON + ZENITH * direction.z
            } else if let Some(ground) = self.ground {
                let to_ground = ((origin.z - ground) / -direction.z).max(0.0);
                reach = reach.min(to_ground);
                BOUNCE * to_ground / (to_ground + BOUNCE_HEIGHT)
            } else {
                BOUNCE
            };
            open += radiance;
            let is_blocked = !is_open && self.bvh.is_blocked(origin, direction, reach);
            sum += if is_blocked {
                radiance * (1.0 - self.occlusion)
            } else {
                radiance
            };
        }
        // Relative to the open, the ground has no noise where nothing is near.
        sum / if hit.group == GROUND {
            open
        } else {
            self.num_sky as f32
        }
    }

    fn key(&self, hit: &Hit, origin: Vec3, slot: usize) -> f32 {
        // A lamp half a softness below the horizon of the surface still lights it a little.
        if hit.normal.dot(self.lamp) < -0.15 {
            return 1.0 - self.shadow;
        }
        let along = hit.position.dot(self.lamp);
        let miss = (hit.position - self.lamp * along).length();
        if along > self.radius
            || miss > self.radius + self.softness * (self.radius - along).max(0.0)
        {
            return 1.0;
        }
        let (s, t) = self.lamp.tangents();
        let offsets = &self.pattern.key[slot * self.num_key..(slot + 1) * self.num_key];
        let is_blocked = |&&[x, y]: &&[f32; 2]| {
            let direction = (self.lamp + (s * x + t * y) * self.softness).normalized_or(self.lamp);
            self.bvh.is_blocked(origin, direction, LAMP_REACH)
        };
        1.0 - self.shadow * offsets.iter().filter(is_blocked).count() as f32 / self.num_key as f32
    }
}

impl LightMap {
    /// Traces the light for what the camera sees.
    pub(crate) fn trace(
        view: &View,
        surface: &Surface,
        bvh: &Bvh,
        triangles: &[ScreenTriangle],
        options: &RenderOptions,
    ) -> Self {
        let step = if options.quality == Quality::Film {
            2
        } else {
            1
        };
        let scale = 1.0 / step as f32;
        let (width, height) = (
            options.width.div_ceil(step) as usize,
            options.height.div_ceil(step) as usize,
        );
        let (pattern, num_sky, num_key) = Pattern::new(options.quality);
        let tracer = Tracer {
            bvh,
            ground: surface.ground,
            radius: surface.radius,
            lamp: lamp_direction(view, options),
            softness: (options.light.softness as f32).to_radians().sin(),
            shadow: options.shadow as f32,
            occlusion: options.ambient_occlusion as f32,
            pattern,
            num_sky,
            num_key,
        };
        let bins = bin(triangles, options.height, BAND * step as usize);
        let unseen = Texel {
            position: Vec3::default(),
            normal: Vec3::default(),
            group: NOTHING,
            light: Received { sky: 1.0, key: 1.0 },
        };
        let mut texels = vec![unseen; width * height];
        texels
            .par_chunks_mut(width * BAND)
            .zip(&bins)
            .enumerate()
            .for_each(|(band, (texels, bin))| {
                let rows = band * BAND..((band + 1) * BAND).min(height);
                let samples = Samples::fill(
                    view,
                    surface.ground,
                    triangles,
                    bin,
                    (width, rows.clone(), scale),
                );
                for (index, texel) in texels.iter_mut().enumerate() {
                    let (column, row) = (index % width, rows.start + index / width);
                    let (x, y) = samples.pixel(column, row);
                    if let Some(hit) = Hit::find(surface, view, samples.face[index], x, y) {
                        let light = tracer.received(&hit, TILE[row % 4][column % 4]);
                        *texel = Texel {
                            position: hit.position,
                            normal: hit.normal,
                            group: hit.group,
                            light,
                        };
                    }
                }
            });
        let footprint = step as f32 * view.pixel_size();
        Self {
            texels,
            width,
            height,
            scale,
            footprint,
        }
        .smoothed(view)
    }

    /// Each texel averaged with those around it that lie on the same smooth surface; every tile of the pattern then
    /// counts once.
    fn smoothed(mut self, view: &View) -> Self {
        const TENT: [f32; 5] = [0.5, 1.0, 1.0, 1.0, 0.5];
        let light: Vec<Received> = (0..self.texels.len())
            .into_par_iter()
            .map(|index| {
                let (column, row) = (index % self.width, index / self.width);
                let center = &self.texels[index];
                if center.group == NOTHING {
                    return center.light;
                }
                let tolerance = self.tolerance(view, center.position);
                let mut sum = Sum::default();
                for (j, y) in (row.max(2) - 2..(row + 3).min(self.height)).map(|y| (y + 2 - row, y))
                {
                    for (i, x) in (column.max(2) - 2..(column + 3).min(self.width))
                        .map(|x| (x + 2 - column, x))
                    {
                        let texel = &self.texels[y * self.width + x];
                        let alike =
                            texel.likeness(center.group, center.position, center.normal, tolerance);
                        sum.add(texel.light, TENT[i] * TENT[j] * alike);
                    }
                }
                sum.mean().unwrap_or(center.light)
            })
            .collect();
        self.texels
            .iter_mut()
            .zip(light)
            .for_each(|(texel, light)| texel.light = light);
        self
    }

    /// How far a texel may lie off the tangent plane.
    fn tolerance(&self, view: &View, position: Vec3) -> f32 {
        3.0 * self.footprint * (position - view.eye).dot(view.forward)
    }

    /// The light at a point seen at `(x, y)` in the picture (pixels).
    pub(crate) fn at(&self, view: &View, hit: &Hit, x: f32, y: f32) -> Received {
        let tolerance = self.tolerance(view, hit.position);
        let (u, v) = (x * self.scale - 0.5, y * self.scale - 0.5);
        let (column, row) = (u.floor(), v.floor());
        let (right, down) = (u - column, v - row);
        let (mut alike, mut any) = (Sum::default(), Sum::default());
        for (j, weight_y) in [(0, 1.0 - down), (1, down)] {
            for (i, weight_x) in [(0, 1.0 - right), (1, right)] {
                let column = (column as isize + i).clamp(0, self.width as isize - 1) as usize;
                let row = (row as isize + j).clamp(0, self.height as isize - 1) as usize;
                let texel = &self.texels[row * self.width + column];
                let weight = weight_x * weight_y + 1e-3;
                alike.add(
                    texel.light,
                    weight * texel.likeness(hit.group, hit.position, hit.normal, tolerance),
                );
                any.add(
                    texel.light,
                    weight * if texel.group == hit.group { 1.0 } else { 1e-3 },
                );
            }
        }
        // A sliver between texels has no like: take what is nearest.
        if alike.weight > 1e-4 {
            alike.mean()
        } else {
            any.mean()
        }
        .unwrap_or_default()
    }
}

impl Texel {
    /// 1 on the same plane, 0 across an edge.
    fn likeness(&self, group: u32, position: Vec3, normal: Vec3, tolerance: f32) -> f32 {
        if self.group != group {
            return 0.0;
        }
        let off_plane = (self.position - position).dot(normal).abs() / tolerance;
        let aligned = (2.0 * self.normal.dot(normal) - 1.0).max(0.0);
        aligned * (1.0 - off_plane).max(0.0)
    }
}

#[derive(Default)]
struct Sum {
    sky: f32,
    key: f32,
    weight: f32,
}

impl Sum {
    fn add(&mut self, light: Received, weight: f32) {
        self.sky += weight * light.sky;
        self.key += weight * light.key;
        self.weight += weight;
    }

    fn mean(&self) -> Option<Received> {
        (self.weight > 0.0).then(|| Received {
            sky: self.sky / self.weight,
            key: self.key / self.weight,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_pattern_of_a_tile_integrates_the_cosine_and_the_disc() {
        for quality in [Quality::Film, Quality::Still] {
            let (pattern, num_sky, num_key) = Pattern::new(quality);
            assert_eq!(
                (pattern.sky.len(), pattern.key.len()),
                (16 * num_sky, 16 * num_key)
            );
            // Mean height of cosine-weighted directions is 2/3; 128 points of the sequence are within 2 %.
            let mean = pattern.sky.iter().map(|[d, _]| d.z).sum::<f32>() / pattern.sky.len() as f32;
            assert!((mean - 2.0 / 3.0).abs() < 0.02, "{mean}");
            let [x, y] = pattern
                .key
                .iter()
                .fold([0.0; 2], |[x, y], d| [x + d[0], y + d[1]]);
            assert!(x.hypot(y) / (pattern.key.len() as f32) < 0.05);
        }
    }

    #[test]
    fn every_slot_of_the_tile_is_used_once() {
        let mut slots: Vec<usize> = TILE.concat();
        slots.sort_unstable();
        assert_eq!(slots, (0..16).collect::<Vec<_>>());
    }
}
