//! What can go wrong, and where.

use std::path::PathBuf;

/// A scene or its options cannot be drawn.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum RenderError {
    /// No part has a face.
    #[error("the scene has no faces: nothing to draw")]
    EmptyScene,
    /// A coordinate is NaN or infinite.
    #[error("part {part}: vertex {vertex} is at {position:?}, which is not finite")]
    PositionNotFinite {
        /// Index of the part in the scene.
        part: usize,
        /// Index of the vertex in the part.
        vertex: usize,
        /// Its coordinates.
        position: [f64; 3],
    },
    /// A face names a vertex that does not exist.
    #[error(
        "part {part}: face {face} names vertex {vertex}, but there are only {num_vertices} vertices"
    )]
    VertexOutOfRange {
        /// Index of the part in the scene.
        part: usize,
        /// Index of the face in the part.
        face: usize,
        /// The vertex index found.
        vertex: u32,
        /// How many vertices the part has.
        num_vertices: usize,
    },
    /// A field does not have one value for each vertex or face.
    #[error("part {part}: the field has {found} values, but there are {expected} {elements}")]
    FieldLength {
        /// Index of the part in the scene.
        part: usize,
        /// `"vertices"` or `"faces"`.
        elements: &'static str,
        /// How many values there should be.
        expected: usize,
        /// How many there are.
        found: usize,
    },
    /// The picture would have no pixel or too many.
    #[error(
        "a picture of {width} x {height} pixels: both sides must be between 1 and {}",
        crate::options::MAX_SIDE
    )]
    Size {
        /// Width in pixels.
        width: u32,
        /// Height in pixels.
        height: u32,
    },
    /// A number in the options has no meaning.
    #[error("{name} is {value}, but must be {expected}")]
    Option {
        /// Which option.
        name: &'static str,
        /// Its value.
        value: f64,
        /// What it may be.
        expected: &'static str,
    },
}

/// A picture cannot be written or put together.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ImageError {
    /// The file cannot be written.
    #[error("cannot write {}: {source}", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// The reason.
        source: std::io::Error,
    },
    /// The PNG encoder refused the picture.
    #[error("cannot write {} as PNG: {source}", path.display())]
    Png {
        /// The file.
        path: PathBuf,
        /// The reason.
        source: png::EncodingError,
    },
    /// A contact sheet was asked of no pictures.
    #[error("a contact sheet needs at least one picture and one column")]
    EmptySheet,
    /// The pictures of a contact sheet differ in size.
    #[error("picture {index} of the contact sheet is {found:?} pixels, the first is {expected:?}")]
    SheetSize {
        /// Which picture.
        index: usize,
        /// Its width and height.
        found: (u32, u32),
        /// Those of the first picture.
        expected: (u32, u32),
    },
}

/// A film cannot be written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum FilmError {
    /// The extension says no known format.
    #[error("{}: the extension of a film must be .mp4, .gif or .png (animated)", path.display())]
    Extension {
        /// The file.
        path: PathBuf,
    },
    /// An mp4 was asked for, and there is no `ffmpeg` on the path.
    #[error("ffmpeg not found; write .gif instead or install ffmpeg")]
    FfmpegMissing,
    /// `ffmpeg` ran and failed.
    #[error("ffmpeg failed: {message}")]
    Ffmpeg {
        /// The end of what it wrote to standard error.
        message: String,
    },
    /// Frames per second outside what the formats can say.
    #[error("{fps} frames a second: must be between 0.1 and 1000")]
    FrameRate {
        /// What was asked.
        fps: f64,
    },
    /// The film would have no pixel or too many.
    #[error(
        "a film of {width} x {height} pixels: both sides must be between 1 and {}",
        crate::options::MAX_SIDE
    )]
    Size {
        /// Width in pixels.
        width: u32,
        /// Height in pixels.
        height: u32,
    },
    /// A frame is not of the film's size.
    #[error("frame {frame} is {found:?} pixels, the film is {expected:?}")]
    FrameSize {
        /// Index of the frame.
        frame: usize,
        /// Its width and height.
        found: (u32, u32),
        /// Those of the film.
        expected: (u32, u32),
    },
    /// The film was finished before a frame was pushed.
    #[error("a film needs at least one frame")]
    NoFrames,
    /// A file cannot be written or read back.
    #[error("cannot write {}: {source}", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// The reason.
        source: std::io::Error,
    },
    /// The PNG encoder failed.
    #[error("cannot encode a frame as PNG: {0}")]
    Png(#[from] png::EncodingError),
    /// The GIF encoder failed.
    #[error("cannot encode a frame as GIF: {0}")]
    Gif(#[from] gif::EncodingError),
}
