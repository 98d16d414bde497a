//! Colours, the sRGB curve and colour maps.

use std::str::FromStr;

use crate::vector::{Vec3, vec3};

/// A colour in sRGB, each component 0 to 1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rgb(pub f32, pub f32, pub f32);

impl Rgb {
    /// A calm blue for cloth.
    pub const BLUE: Self = Self(0.36, 0.54, 0.77);
    /// A calm red.
    pub const RED: Self = Self(0.80, 0.36, 0.33);
    /// A calm yellow.
    pub const OCHRE: Self = Self(0.89, 0.67, 0.32);
    /// A calm green.
    pub const SAGE: Self = Self(0.45, 0.66, 0.50);
    /// A calm violet.
    pub const MAUVE: Self = Self(0.60, 0.49, 0.74);
    /// The light warm grey of obstacles.
    pub const STONE: Self = Self(0.79, 0.78, 0.76);
    /// White.
    pub const WHITE: Self = Self(1.0, 1.0, 1.0);

    /// Distinct calm colours for the shells of a scene, repeating after five.
    #[must_use]
    pub fn of_part(index: usize) -> Self {
        [Self::BLUE, Self::OCHRE, Self::RED, Self::SAGE, Self::MAUVE][index % 5]
    }

    /// From `#rrggbb`; `None` for another text.
    #[must_use]
    pub fn from_hex(text: &str) -> Option<Self> {
        let digits = text.strip_prefix('#')?;
        if digits.len() != 6 || !digits.bytes().all(|b| b.is_ascii_hexdigit()) {
            return None;
        }
        let number = u32::from_str_radix(digits, 16).ok()?;
        let part = |shift: u32| (number >> shift & 0xff) as f32 / 255.0;
        Some(Self(part(16), part(8), part(0)))
    }

    /// Amounts of light: what other programs and formats calculate with.
    #[must_use]
    pub fn linear(self) -> [f32; 3] {
        [self.0, self.1, self.2].map(linear)
    }

    pub(crate) fn to_linear(self) -> Vec3 {
        let [r, g, b] = self.linear();
        vec3(r, g, b)
    }

    pub(crate) fn lerp(self, other: Self, t: f32) -> Self {
        let mix = |a: f32, b: f32| a + t * (b - a);
        Self(
            mix(self.0, other.0),
            mix(self.1, other.1),
            mix(self.2, other.2),
        )
    }

    pub(crate) fn to_bytes(self) -> [u8; 3] {
        [self.0, self.1, self.2].map(|c| (255.0 * c.clamp(0.0, 1.0) + 0.5) as u8)
    }
}

/// The light a component of sRGB stands for (IEC 61966-2-1).
fn linear(c: f32) -> f32 {
    if c <= 0.04045 {
        c / 12.92
    } else {
        ((c + 0.055) / 1.055).powf(2.4)
    }
}

/// The component of sRGB for an amount of light.
pub(crate) fn encode(light: f32) -> f32 {
    let light = light.clamp(0.0, 1.0);
    if light <= 0.003_130_8 {
        12.92 * light
    } else {
        1.055 * light.powf(1.0 / 2.4) - 0.055
    }
}

/// Colours for numbers. Each is a table of 17 colours, but for `Char` sampled from matplotlib's table (CC0), linear between: at most 4 %
/// off in one component.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[non_exhaustive]
pub enum ColorMap {
    /// Dark violet to yellow, even to the eye (Smith and van der Walt 2015).
    #[default]
    Viridis,
    /// Blue to yellow, the same to red-green blind eyes (Nuñez, Anderton and Renslow 2018).
    Cividis,
    /// Blue, grey, red: for values about zero (Moreland 2009).
    CoolWarm,
    /// Black, brown, the white of paper: for what is left of something that burns; half is charred.
    Char,
}

/// A text that names no colour map.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("unknown color map `{0}`: use viridis, cividis, coolwarm or char")]
pub struct ColorMapParseError(String);

impl FromStr for ColorMap {
    type Err = ColorMapParseError;

    fn from_str(text: &str) -> Result<Self, ColorMapParseError> {
        match text {
            "viridis" => Ok(Self::Viridis),
            "cividis" => Ok(Self::Cividis),
            "coolwarm" => Ok(Self::CoolWarm),
            "char" => Ok(Self::Char),
            other => Err(ColorMapParseError(other.to_owned())),
        }
    }
}

impl ColorMap {
    /// The colour at `t` between 0 and 1; outside, that of the nearer end; grey for NaN.
    #[must_use]
    pub fn at(self, t: f64) -> Rgb {
        if t.is_nan() {
            return Rgb(0.6, 0.6, 0.6);
        }
        let table = match self {
            Self::Viridis => &VIRIDIS,
            Self::Cividis => &CIVIDIS,
            Self::CoolWarm => &COOLWARM,
            Self::Char => &CHAR,
        };
        let position = t.clamp(0.0, 1.0) * 16.0;
        let index = (position as usize).min(15);
        let color = |[r, g, b]: [u8; 3]| Rgb(f32::from(r), f32::from(g), f32::from(b));
        let Rgb(r, g, b) =
            color(table[index]).lerp(color(table[index + 1]), (position - index as f64) as f32);
        Rgb(r / 255.0, g / 255.0, b / 255.0)
    }
}

const CHAR: [[u8; 3]; 17] = [
    [15, 12, 10],
    [17, 13, 11],
    [19, 14, 12],
    [21, 16, 13],
    [22, 17, 14],
    [24, 18, 15],
    [26, 20, 16],
    [28, 21, 17],
    [30, 22, 18],
    [48, 31, 21],
    [67, 40, 25],
    [90, 55, 32],
    [118, 75, 42],
    [147, 98, 57],
    [182, 139, 91],
    [214, 186, 148],
    [245, 238, 220],
];

#[rustfmt::skip]
const VIRIDIS: [[u8; 3]; 17] = [
    [68, 1, 84], [72, 24, 106], [71, 45, 123], [66, 64, 134], [59, 82, 139], [51, 99, 141], [44, 114, 142],
    [38, 130, 142], [33, 145, 140], [31, 160, 136], [40, 174, 128], [63, 188, 115], [94, 201, 98], [132, 212, 75],
    [173, 220, 48], [216, 226, 25], [253, 231, 37],
];

#[rustfmt::skip]
const CIVIDIS: [[u8; 3]; 17] = [
    [0, 34, 78], [0, 46, 106], [26, 56, 111], [50, 67, 109], [67, 78, 108], [83, 90, 109], [97, 101, 111],
    [111, 112, 115], [125, 124, 120], [140, 136, 120], [155, 148, 118], [171, 160, 114], [188, 174, 108],
    [205, 187, 99], [222, 201, 88], [240, 216, 70], [254, 232, 56],
];

#[rustfmt::skip]
const COOLWARM: [[u8; 3]; 17] = [
    [59, 76, 192], [78, 104, 216], [98, 130, 234], [119, 154, 247], [141, 176, 254], [163, 194, 254],
    [185, 208, 249], [204, 217, 237], [221, 220, 220], [236, 211, 197], [245, 196, 172], [247, 176, 147],
    [244, 152, 122], [235, 125, 98], [221, 95, 75], [202, 59, 55], [180, 4, 38],
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_srgb_curve_and_its_inverse_agree() {
        for i in 0..=255 {
            let c = i as f32 / 255.0;
            assert!((encode(linear(c)) - c).abs() < 1e-5, "{c}");
        }
    }

    #[test]
    fn sequential_maps_grow_lighter_all_the_way() {
        for map in [ColorMap::Viridis, ColorMap::Cividis] {
            let mut previous = -1.0;
            for i in 0..=100 {
                let light = map
                    .at(f64::from(i) / 100.0)
                    .to_linear()
                    .dot(vec3(0.2126, 0.7152, 0.0722));
                assert!(light > previous, "{map:?} at {i}");
                previous = light;
            }
        }
    }

    #[test]
    fn values_outside_take_the_end_colours_and_nan_is_grey() {
        assert_eq!(ColorMap::CoolWarm.at(-3.0), ColorMap::CoolWarm.at(0.0));
        assert_eq!(
            ColorMap::CoolWarm.at(f64::INFINITY),
            ColorMap::CoolWarm.at(1.0)
        );
        let Rgb(r, g, b) = ColorMap::Viridis.at(f64::NAN);
        assert!(r == g && g == b);
    }

    #[test]
    fn colours_and_maps_are_parsed_from_text() {
        assert_eq!(
            Rgb::from_hex("#ff0000").map(Rgb::to_bytes),
            Some([255, 0, 0])
        );
        assert_eq!(Rgb::from_hex("#ff00"), None);
        assert_eq!("cividis".parse(), Ok(ColorMap::Cividis));
        assert!("jet".parse::<ColorMap>().is_err());
    }
}
