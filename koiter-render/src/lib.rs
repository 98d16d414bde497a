//! Pictures and films of thin-shell simulations, and charts of their figures, on the CPU, without a display.
//!
//! Triangles are rasterised with exact coverage; sky light and the soft shadow of one lamp are traced
//! through a bounding volume hierarchy. The same input gives the same bytes whatever the number of threads.
//! z is up, lengths are in any one unit: the picture depends only on their ratios.
//!
//! ```
//! use koiter_render::*;
//!
//! let positions = [[0.0, 0.0, 0.5], [1.0, 0.0, 0.6], [1.0, 1.0, 0.5], [0.0, 1.0, 0.6]];
//! let faces = [[0, 1, 2], [0, 2, 3]];
//! let heights = [0.5, 0.6, 0.5, 0.6];
//! let scene = Scene {
//!     parts: vec![PartView {
//!         field: Some(FieldView::PerVertex(&heights)),
//!         ..PartView::shell(&positions, &faces)
//!     }],
//!     ground: Ground::At(0.0),
//! };
//! let (width, height) = (320, 180);
//! let view: CameraView = "azimuth=30,elevation=25,zoom=1.1".parse()?;
//! let camera = Camera::fit(&scene.bounds()?, view, width as f64 / height as f64);
//! let options = RenderOptions {
//!     color: ColorBy::field("height", "m", ColorMap::Viridis),
//!     caption: Some("t = 1.20 s".into()),
//!     ..RenderOptions::new(width, height, camera)
//! };
//! let image = render(&scene, &options)?;
//! # let folder = tempfile::tempdir()?;
//! # let path = folder.path().join("sheet.png");
//! image.write_png(&path)?;
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! Not shown: transparency, textures, motion blur, light scattered between surfaces (a formula stands in for it).
#![forbid(unsafe_code)]

mod bvh;
mod camera;
mod chart;
mod color;
mod error;
mod film;
mod font;
mod hit;
mod image;
mod legend;
mod light;
mod options;
mod palette;
mod raster;
mod render;
mod scene;
mod shade;
mod surface;
mod vector;

pub use camera::{Camera, CameraParseError, CameraView};
pub use chart::{Arrangement, Chart, Line, Marker, Panel, Series, Style};
pub use color::{ColorMap, ColorMapParseError, Rgb};
pub use error::{FilmError, ImageError, RenderError};
pub use film::Film;
pub use image::{Image, contact_sheet, partial_files};
pub use options::{Background, ColorBy, Light, Quality, RenderOptions};
pub use render::render;
pub use scene::{Bounds, FieldView, Ground, PartKind, PartView, Scene, level_floor};
