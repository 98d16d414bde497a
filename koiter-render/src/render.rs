//! The way from a scene to a picture.

use crate::bvh::Bvh;
use crate::error::RenderError;
use crate::image::Image;
use crate::legend;
use crate::light::LightMap;
use crate::options::{ColorBy, RenderOptions};
use crate::raster::View;
use crate::scene::Scene;
use crate::shade::Shader;
use crate::surface::Surface;

/// Draws a scene.
///
/// # Errors
/// [`RenderError`] when the scene has no faces, a position that is not finite, or anything else that cannot be drawn.
pub fn render(scene: &Scene, options: &RenderOptions) -> Result<Image, RenderError> {
    options.check()?;
    let bounds = scene.bounds()?;
    let range = match options.color {
        ColorBy::Field {
            range: Some(range), ..
        } => range,
        _ => scene.field_range().unwrap_or((0.0, 1.0)),
    };
    let surface = Surface::gather(scene, &bounds, options, range);
    let view = View::new(&options.camera, &surface, options.width, options.height);
    let (bvh, triangles) = rayon::join(|| Bvh::build(&surface), || view.project(&surface));
    let light = LightMap::trace(&view, &surface, &bvh, &triangles, options);
    let bytes = Shader::new(&view, &surface, &light, options).picture(&triangles);
    let mut image =
        Image::from_bytes(options.width, options.height, bytes).expect("three bytes a pixel");
    legend::draw(&mut image, options, range);
    Ok(image)
}
