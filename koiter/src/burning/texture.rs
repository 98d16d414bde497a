//! Grey values on a mesh: a texture scales the rate of mass loss, the diffusivity or a source of heat.

use super::error::TextureError;
use super::quad_mesh::QuadMesh;

/// A grey image, 0 black to 1 white.
#[derive(Clone, Debug, PartialEq)]
pub struct Texture {
    width: usize,
    height: usize,
    /// Row by row from the top.
    values: Vec<f64>,
}

impl Texture {
    /// From values row by row, the top row first.
    ///
    /// # Errors
    /// Another number of values than pixels, or no pixels.
    pub fn new(width: usize, height: usize, values: Vec<f64>) -> Result<Self, TextureError> {
        match width.checked_mul(height) {
            Some(pixels) if pixels == values.len() && pixels > 0 => Ok(Self {
                width,
                height,
                values,
            }),
            _ => Err(TextureError::Size {
                width,
                height,
                values: values.len(),
            }),
        }
    }

    /// The value at (u, v), linear between pixel centres; beyond 0 to 1 that of the nearest border.
    pub fn at(&self, [u, v]: [f64; 2]) -> f64 {
        // v points up, rows run down.
        let along = |share: f64, pixels: usize| {
            let place = (share * pixels as f64 - 0.5).clamp(0.0, (pixels - 1) as f64);
            let first = (place as usize).min(pixels - 1);
            (first, (first + 1).min(pixels - 1), place - first as f64)
        };
        let (x0, x1, s) = along(u, self.width);
        let (y0, y1, t) = along(1.0 - v, self.height);
        let row = |y: usize| {
            let value = |x: usize| self.values[y * self.width + x];
            (1.0 - s) * value(x0) + s * value(x1)
        };
        (1.0 - t) * row(y0) + t * row(y1)
    }

    /// The values at the vertices of a mesh.
    ///
    /// # Errors
    /// A mesh without texture coordinates.
    pub fn at_vertices(&self, mesh: &QuadMesh) -> Result<Vec<f64>, TextureError> {
        let coordinates = mesh
            .texture_coordinates()
            .ok_or(TextureError::NoCoordinates)?;
        Ok(coordinates.iter().map(|&uv| self.at(uv)).collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_are_linear_between_pixels_and_the_first_row_is_the_top() {
        let texture = Texture::new(2, 2, vec![0.0, 1.0, 0.5, 0.5]).unwrap();
        assert_eq!(texture.at([0.25, 0.75]), 0.0);
        assert_eq!(texture.at([0.75, 0.75]), 1.0);
        assert_eq!(texture.at([0.5, 0.75]), 0.5);
        assert_eq!(texture.at([0.5, 0.0]), 0.5);
        assert_eq!(texture.at([9.0, 9.0]), 1.0);
        let mesh = QuadMesh::grid([1.0, 1.0], [2, 2]).unwrap();
        assert_eq!(texture.at_vertices(&mesh).unwrap()[8], 1.0);
    }

    #[test]
    fn a_texture_of_another_size_than_it_says_is_refused() {
        assert!(Texture::new(2, 2, vec![0.0; 3]).is_err());
        assert!(Texture::new(0, 0, vec![]).is_err());
        assert!(Texture::new(usize::MAX, 2, vec![0.0; 3]).is_err());
    }
}
