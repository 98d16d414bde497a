//! 255 colours for a whole film, and an ordered dither that stands still where the picture does.

use rayon::prelude::*;

use crate::vector::{Vec3, vec3};

/// How many colours; GIF has one more, which stands for "as before".
pub(crate) const COLORS: usize = 255;
/// Refinements of the palette: more change colours by less than a level.
const REFINEMENTS: usize = 4;
/// Share of the error that the dither makes up for: 1 is exact on average, less is calmer.
const STRENGTH: f32 = 0.7;
/// Candidates for a pixel, as many as thresholds in the dither matrix.
const CANDIDATES: usize = 16;
const BAYER: [[usize; 4]; 4] = [[0, 8, 2, 10], [12, 4, 14, 6], [3, 11, 1, 9], [15, 7, 13, 5]];

/// Counts of the colours of all frames, in boxes of 4 levels.
pub(crate) struct Histogram {
    bins: Vec<(u64, [u64; 3])>,
}

impl Histogram {
    pub(crate) fn new() -> Self {
        Self {
            bins: vec![(0, [0; 3]); 1 << 18],
        }
    }

    pub(crate) fn add(&mut self, bytes: &[u8]) {
        for pixel in bytes.chunks_exact(3) {
            let index = pixel
                .iter()
                .fold(0, |index, &c| index << 6 | usize::from(c >> 2));
            let (count, sum) = &mut self.bins[index];
            *count += 1;
            (0..3).for_each(|k| sum[k] += u64::from(pixel[k]));
        }
    }

    /// Mean colour and weight of the boxes in use. A colour that covers a hundred times the area weighs ten times as
    /// much: the background should not take all entries.
    fn entries(&self) -> Vec<(Vec3, f32)> {
        let used = self.bins.iter().filter(|(count, _)| *count > 0);
        used.map(|&(count, sum)| {
            let [r, g, b] = sum.map(|s| (s as f64 / count as f64) as f32);
            (vec3(r, g, b), (count as f64).sqrt() as f32)
        })
        .collect()
    }
}

/// The colours, and the nearest for every colour in steps of 2 levels.
pub(crate) struct Palette {
    colors: Vec<Vec3>,
    nearest: Vec<u8>,
}

impl Palette {
    /// Cuts the box of largest scatter in two until there are enough (variance-based median cut, after Wan et al.
    /// 1990), then moves each colour to the mean of those nearest to it.
    pub(crate) fn new(histogram: &Histogram) -> Self {
        let mut entries = histogram.entries();
        let mut ranges = Vec::with_capacity(COLORS);
        ranges.push(0..entries.len());
        while ranges.len() < COLORS {
            let widest = (0..ranges.len())
                .map(|i| (i, scatter(&entries[ranges[i].clone()])))
                .max_by(|a, b| total(a.1).total_cmp(&total(b.1)).then(b.0.cmp(&a.0)));
            let Some((widest, spread)) = widest.filter(|(_, spread)| total(*spread) > 0.0) else {
                break;
            };
            let range = ranges[widest].clone();
            let cut = range.start + cut(&mut entries[range.clone()], spread);
            ranges[widest] = range.start..cut;
            ranges.push(cut..range.end);
        }
        let mut colors: Vec<Vec3> = ranges
            .iter()
            .map(|range| mean(&entries[range.clone()]).0)
            .collect();
        for _ in 0..REFINEMENTS {
            let owners: Vec<usize> = entries
                .par_iter()
                .map(|&(color, _)| nearest(&colors, color))
                .collect();
            let mut sums = vec![(Vec3::default(), 0.0f32); colors.len()];
            for (&(color, weight), owner) in entries.iter().zip(owners) {
                sums[owner].0 += color * weight;
                sums[owner].1 += weight;
            }
            for (color, (sum, weight)) in colors.iter_mut().zip(sums) {
                if weight > 0.0 {
                    *color = sum * (1.0 / weight);
                }
            }
        }
        let round = |c: f32| (c + 0.5).floor();
        colors
            .iter_mut()
            .for_each(|c| *c = vec3(round(c.x), round(c.y), round(c.z)));
        let center = |index: usize, shift: usize| (2 * (index >> shift & 127) + 1) as f32;
        let nearest = (0..1usize << 21)
            .into_par_iter()
            .map(|i| nearest(&colors, vec3(center(i, 14), center(i, 7), center(i, 0))) as u8)
            .collect();
        Self { colors, nearest }
    }

    /// Three bytes a colour.
    pub(crate) fn bytes(&self) -> Vec<u8> {
        self.colors
            .iter()
            .flat_map(|c| c.to_array().map(|c| c as u8))
            .collect()
    }

    /// The palette entry for each pixel of a frame. Where `previous` (its frame and entries) has the same colour, the
    /// entry is the same.
    ///
    /// Pattern dithering (Knoll 1999): each pixel makes its own list of colours whose mean is its colour, sorted from
    /// dark to light, and takes the one its place in the matrix says.
    pub(crate) fn entries(
        &self,
        bytes: &[u8],
        width: usize,
        previous: Option<(&[u8], &[u8])>,
    ) -> Vec<u8> {
        let mut entries = vec![0; bytes.len() / 3];
        entries
            .par_chunks_mut(width)
            .enumerate()
            .for_each(|(row, line)| {
                for (column, entry) in line.iter_mut().enumerate() {
                    let index = row * width + column;
                    let pixel = &bytes[3 * index..3 * index + 3];
                    *entry = match previous {
                        Some((before, entries)) if &before[3 * index..3 * index + 3] == pixel => {
                            entries[index]
                        }
                        _ => self.dithered(pixel, BAYER[row % 4][column % 4]),
                    };
                }
            });
        entries
    }

    fn dithered(&self, pixel: &[u8], threshold: usize) -> u8 {
        let goal = vec3(
            f32::from(pixel[0]),
            f32::from(pixel[1]),
            f32::from(pixel[2]),
        );
        let mut error = Vec3::default();
        let mut candidates = [0u8; CANDIDATES];
        for candidate in &mut candidates {
            *candidate = self.look_up(goal + error * STRENGTH);
            error += goal - self.colors[usize::from(*candidate)];
        }
        candidates.sort_unstable_by(|&a, &b| {
            let brightness = |i: u8| self.colors[usize::from(i)].dot(vec3(0.299, 0.587, 0.114));
            brightness(a).total_cmp(&brightness(b)).then(a.cmp(&b))
        });
        candidates[threshold]
    }

    fn look_up(&self, color: Vec3) -> u8 {
        let step = |c: f32| c.clamp(0.0, 255.0) as usize >> 1;
        self.nearest[step(color.x) << 14 | step(color.y) << 7 | step(color.z)]
    }
}

/// Green counts most to the eye, blue least.
const EYE: Vec3 = vec3(0.30, 0.59, 0.20);

fn nearest(colors: &[Vec3], color: Vec3) -> usize {
    let mut best = (f32::INFINITY, 0);
    for (index, &candidate) in colors.iter().enumerate() {
        let offset = candidate - color;
        let distance_squared = offset.scale(offset).dot(EYE);
        if distance_squared < best.0 {
            best = (distance_squared, index);
        }
    }
    best.1
}

fn mean(entries: &[(Vec3, f32)]) -> (Vec3, f32) {
    let (sum, weight) = entries
        .iter()
        .fold((Vec3::default(), 0.0), |(sum, total), &(c, weight)| {
            (sum + c * weight, total + weight)
        });
    (sum * (1.0 / weight.max(1e-20)), weight)
}

/// Weighted sum of squared distances to the mean, by component.
fn scatter(entries: &[(Vec3, f32)]) -> Vec3 {
    if entries.len() < 2 {
        return Vec3::default();
    }
    let (mean, _) = mean(entries);
    entries.iter().fold(Vec3::default(), |sum, &(c, weight)| {
        sum + (c - mean).scale(c - mean).scale(EYE) * weight
    })
}

fn total(scatter: Vec3) -> f32 {
    scatter.x + scatter.y + scatter.z
}

/// Sorts along the component of largest scatter and returns where the mean falls; neither part is empty.
fn cut(entries: &mut [(Vec3, f32)], scatter: Vec3) -> usize {
    let [x, y, z] = scatter.to_array();
    let axis = if y >= x && y >= z {
        1
    } else if x >= z {
        0
    } else {
        2
    };
    let component = |c: Vec3| c.to_array()[axis];
    let middle = component(mean(entries).0);
    entries.sort_by(|a, b| component(a.0).total_cmp(&component(b.0)));
    entries
        .partition_point(|&(c, _)| component(c) < middle)
        .clamp(1, entries.len() - 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn palette_of(bytes: &[u8]) -> Palette {
        let mut histogram = Histogram::new();
        histogram.add(bytes);
        Palette::new(&histogram)
    }

    #[test]
    fn a_few_colours_are_kept_exactly() {
        let bytes = [[255, 0, 0], [0, 255, 0], [16, 32, 64], [255, 255, 255]].concat();
        let palette = palette_of(&bytes);
        let entries = palette.entries(&bytes, 4, None);
        let back: Vec<u8> = entries
            .iter()
            .flat_map(|&e| palette.bytes()[3 * usize::from(e)..][..3].to_vec())
            .collect();
        assert_eq!(back, bytes);
    }

    #[test]
    fn a_gradient_is_right_on_average_over_a_tile() {
        let bytes: Vec<u8> = (0..256 * 256)
            .flat_map(|i: usize| {
                [
                    (i % 256) as u8,
                    (i / 256) as u8,
                    ((i % 256 + i / 256) / 2) as u8,
                ]
            })
            .collect();
        let palette = palette_of(&bytes);
        assert_eq!(palette.colors.len(), COLORS);
        let entries = palette.entries(&bytes, 256, None);
        let mut worst: f32 = 0.0;
        // Colours at the rim of the square lie outside all entries.
        for tile in
            (0..64 * 64).filter(|tile| [tile / 64, tile % 64].iter().all(|i| (6..58).contains(i)))
        {
            let mut error = Vec3::default();
            for k in 0..16 {
                let index = (tile / 64 * 4 + k / 4) * 256 + tile % 64 * 4 + k % 4;
                let goal = vec3(
                    bytes[3 * index].into(),
                    bytes[3 * index + 1].into(),
                    bytes[3 * index + 2].into(),
                );
                error += (goal - palette.colors[usize::from(entries[index])]) * (1.0 / 16.0);
            }
            worst = worst.max(error.length());
        }
        // Neighbouring entries are about 20 levels apart here: without dithering tiles are off by up to 13.
        assert!(worst < 6.0, "{worst}");
    }

    #[test]
    fn equal_pixels_keep_their_entry() {
        let bytes: Vec<u8> = (0..3 * 64).map(|i| (i * 5 % 256) as u8).collect();
        let palette = palette_of(&bytes);
        let first = palette.entries(&bytes, 8, None);
        assert_eq!(palette.entries(&bytes, 8, Some((&bytes, &first))), first);
    }
}
