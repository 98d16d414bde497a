//! Pictures and films of a result folder.

mod frame_view;
mod pace;

use std::path::{Path, PathBuf};

use indicatif::ProgressBar;
use koiter::io::result::{Frame, ResultReader};
use koiter::scene::SceneFile;
use koiter::scene::spec::OutputSpec;
use koiter_render::{
    Bounds, Camera, CameraView, ColorBy, ColorMap, Film, FilmError, Image, Quality, RenderOptions,
    Rgb, contact_sheet, render,
};

use crate::failure::Failure;
use crate::output::quoted;
use frame_view::FrameView;
use pace::{decimals, pace};

/// Films of a run: small, so that they do not keep the user waiting.
const FILM_SIZE: (u32, u32) = (640, 360);
/// Pictures of a sweep.
const GRID_SIZE: (u32, u32) = (480, 300);
/// Most frames of the film after a run; of longer runs every second, third, … frame is shown.
const MAX_FILM_FRAMES: usize = 150;
/// Share of the values that the colours cover; the rest (tight folds) is drawn in the last colour.
const COVERED: f64 = 0.99;

/// How pictures look.
#[derive(Clone, Debug)]
pub(crate) struct Look {
    pub(crate) size: (u32, u32),
    pub(crate) camera: CameraView,
    pub(crate) color: Option<String>,
    pub(crate) wireframe: bool,
}

/// The picture and the film that end a run; which film, depends on whether there is ffmpeg.
const PICTURE: &str = "final.png";
const FILMS: [&str; 2] = ["film.mp4", "film.gif"];

/// Whether the pictures that end a run are there, and of its end.
pub(crate) fn are_made(folder: &Path) -> bool {
    let written = |name: &str| std::fs::metadata(folder.join(name))?.modified();
    let Ok(end) = written("summary.json") else {
        return false;
    };
    let is_made = |name: &str| written(name).is_ok_and(|time| time >= end);
    is_made(PICTURE) && FILMS.into_iter().any(is_made)
}

/// What to do where the run is finished and its film is not.
pub(crate) fn without_film(folder: &Path) -> String {
    let film = folder.join(FILMS[0]);
    let [folder, film] = [folder, &film].map(|path| quoted(&path.to_string_lossy()));
    format!(
        "the run has ended and is whole, its film is not made; make it with: koiter render {folder} -o {film}"
    )
}

/// Files that pictures of a run leave when the program is killed.
pub(crate) fn partial_files(folder: &Path) -> Vec<PathBuf> {
    let names = FILMS.into_iter().chain([PICTURE]);
    names
        .flat_map(|name| koiter_render::partial_files(&folder.join(name)))
        .collect()
}

/// Makes the pictures that end a run; returns their paths.
pub(crate) fn after_run(
    folder: &Path,
    output: &OutputSpec,
    quiet: bool,
) -> Result<Vec<PathBuf>, Failure> {
    for path in partial_files(folder) {
        // What cannot be removed is a leftover and no harm.
        let _ = std::fs::remove_file(path);
    }
    let reader = ResultReader::open(folder).map_err(Failure::run)?;
    let camera = output
        .camera
        .as_deref()
        .map_or(Ok(CameraView::default()), str::parse);
    let camera = camera.map_err(|error| Failure::input(format!("output.camera: {error}")))?;
    let look = Look {
        size: (1280, 720),
        camera,
        color: output.color.clone(),
        wireframe: false,
    };
    let mut album = Album::open(&reader, look)?;
    let picture = folder.join(PICTURE);
    album.picture(album.last(), &picture)?;
    album.look.size = FILM_SIZE;
    let film = album.film_in_any_format(folder, quiet)?;
    Ok(vec![picture, film])
}

/// Pictures of the ends of several results as one, row by row; white where there is none. Whether there was any.
pub(crate) fn grid(folders: &[PathBuf], columns: usize, path: &Path) -> Result<bool, Failure> {
    let ends: Vec<Option<Image>> = folders.iter().map(|folder| end_of(folder)).collect();
    if ends.iter().all(Option::is_none) {
        return Ok(false);
    }
    let (width, height) = GRID_SIZE;
    let white = || Image::new(width, height, Rgb(1.0, 1.0, 1.0));
    let images: Vec<Image> = (ends.into_iter())
        .map(|end| end.unwrap_or_else(white))
        .collect();
    let sheet = contact_sheet(&images, columns).map_err(Failure::run)?;
    sheet.write_png(path).map_err(Failure::run)?;
    Ok(true)
}

/// The last frame as the scene of a result wants it shown; `None` if there is no frame.
fn end_of(folder: &Path) -> Option<Image> {
    let reader = ResultReader::open(folder).ok()?;
    let scene = SceneFile::parse("manifest.json", &reader.manifest().scene_text, &[]).ok()?;
    let output = scene.spec.output;
    let look = Look {
        size: GRID_SIZE,
        camera: output
            .camera
            .and_then(|view| view.parse().ok())
            .unwrap_or_default(),
        color: output.color,
        wireframe: false,
    };
    let last = reader.len().checked_sub(1)?;
    let album = Album::open(&reader, look).ok()?;
    album.draw(last, Quality::Still).ok()
}

/// A result folder as pictures of one look.
pub(crate) struct Album<'a> {
    reader: &'a ResultReader,
    look: Look,
    /// Of all frames [s].
    times: Vec<f64>,
    /// Frames that show something: all, unless everything burns away.
    drawn: Vec<usize>,
    bounds: Bounds,
    /// Colours of the field, the same for all frames.
    range: Option<(f64, f64)>,
}

impl<'a> Album<'a> {
    /// Looks through all frames for the camera and the range of colours.
    pub(crate) fn open(reader: &'a ResultReader, look: Look) -> Result<Self, Failure> {
        let (mut bounds, mut values, mut times) = (Bounds::EMPTY, Vec::new(), Vec::new());
        let mut drawn = Vec::new();
        for index in 0..reader.len() {
            let frame = reader.frame(index).map_err(Failure::result)?;
            if index == 0
                && let Some(name) = &look.color
                && frame.field(name).is_none()
            {
                return Err(missing_field(&frame, name));
            }
            times.push(frame.time);
            if !reader.faces_in(&frame).is_empty() {
                drawn.push(index);
            }
            let view = FrameView::new(reader, frame, look.color.as_deref());
            bounds = bounds.join(&view.bounds());
            values.extend(view.values());
        }
        Ok(Self {
            reader,
            look,
            times,
            drawn,
            bounds,
            range: color_range(values),
        })
    }

    /// The last frame that shows something.
    pub(crate) fn last(&self) -> usize {
        self.drawn.last().copied().unwrap_or(0)
    }

    /// Writes a picture of a frame; the camera frames it alone.
    pub(crate) fn picture(&self, frame: usize, path: &Path) -> Result<(), Failure> {
        self.draw(frame, Quality::Still)?
            .write_png(path)
            .map_err(Failure::run)
    }

    /// Writes a film of all frames, in real time where they are even in time, unless `fps` is given.
    pub(crate) fn film(&self, path: &Path, fps: Option<f64>, quiet: bool) -> Result<(), Failure> {
        let (stride, natural) = pace(&self.times, usize::MAX);
        self.write_film(path, stride, fps.unwrap_or(natural), quiet)
            .map_err(|error| match error {
                FilmFailure::Film(error @ FilmError::FrameRate { .. }) => Failure::input(error),
                FilmFailure::Film(error) => Failure::run(error),
                FilmFailure::Other(failure) => failure,
            })
    }

    /// `film.mp4`, or `film.gif` where there is no ffmpeg.
    fn film_in_any_format(&self, folder: &Path, quiet: bool) -> Result<PathBuf, Failure> {
        let (stride, fps) = pace(&self.times, MAX_FILM_FRAMES);
        let mut path = folder.join(FILMS[0]);
        let mut result = self.write_film(&path, stride, fps, quiet);
        if let Err(FilmFailure::Film(FilmError::FfmpegMissing | FilmError::Ffmpeg { .. })) = result
        {
            path = folder.join(FILMS[1]);
            result = self.write_film(&path, stride, fps, quiet);
        }
        match result {
            Ok(()) => Ok(path),
            Err(FilmFailure::Film(error)) => Err(Failure::run(error)),
            Err(FilmFailure::Other(failure)) => Err(failure),
        }
    }

    fn write_film(
        &self,
        path: &Path,
        stride: usize,
        fps: f64,
        quiet: bool,
    ) -> Result<(), FilmFailure> {
        let (width, height) = self.look.size;
        let mut film = Film::create(path, fps, width, height)?;
        let frames: Vec<usize> = self.drawn.iter().copied().step_by(stride).collect();
        let bar = if quiet {
            ProgressBar::hidden()
        } else {
            ProgressBar::new(frames.len() as u64)
        };
        for frame in frames {
            film.push(
                &self
                    .draw(frame, Quality::Film)
                    .map_err(FilmFailure::Other)?,
            )?;
            bar.inc(1);
        }
        bar.finish_and_clear();
        film.finish()?;
        Ok(())
    }

    fn draw(&self, index: usize, quality: Quality) -> Result<Image, Failure> {
        let frame = self.reader.frame(index).map_err(Failure::result)?;
        let caption = format!("t = {:.*} s", decimals(&self.times), frame.time);
        let view = FrameView::new(self.reader, frame, self.look.color.as_deref());
        let (width, height) = self.look.size;
        // A film keeps its camera; a picture is framed for itself.
        let bounds = match quality {
            Quality::Still => view.bounds(),
            Quality::Film => self.bounds,
        };
        let camera = Camera::fit(
            &bounds,
            self.look.camera,
            f64::from(width) / f64::from(height),
        );
        let options = RenderOptions {
            color: self.color_by(),
            quality,
            wireframe: self.look.wireframe,
            caption: Some(caption),
            ..RenderOptions::new(width, height, camera)
        };
        render(&view.scene(), &options).map_err(Failure::input)
    }

    fn color_by(&self) -> ColorBy {
        let Some(name) = &self.look.color else {
            return ColorBy::Part;
        };
        let (unit, map) = color_map(name);
        ColorBy::Field {
            name: name.replace('_', " "),
            unit: unit.to_owned(),
            map,
            range: self.range,
        }
    }
}

/// A field that was asked for and is not there.
pub(crate) fn missing_field(frame: &Frame, name: &str) -> Failure {
    let fields = frame.face_fields.iter();
    let names: Vec<&str> = fields.map(|field| field.name.as_str()).collect();
    Failure::input(format!("the result has no field '{name}'"))
        .with_help(format!("it has: {}", names.join(", ")))
}

/// Unit and colours of a field.
pub(crate) fn color_map(name: &str) -> (&'static str, ColorMap) {
    match name {
        "bending_energy_density" => ("J/m²", ColorMap::Viridis),
        "mean_curvature" => ("1/m", ColorMap::CoolWarm),
        "temperature" => ("K", ColorMap::Viridis),
        "mass_ratio" => ("", ColorMap::Char),
        _ => ("", ColorMap::Viridis),
    }
}

/// The range that covers most values: about zero if there are negative ones, else from zero.
pub(crate) fn color_range(values: Vec<f64>) -> Option<(f64, f64)> {
    let mut sizes: Vec<f64> = values
        .iter()
        .filter(|value| value.is_finite())
        .map(|value| value.abs())
        .collect();
    if sizes.is_empty() {
        return None;
    }
    sizes.sort_by(f64::total_cmp);
    let top = sizes[((sizes.len() - 1) as f64 * COVERED) as usize];
    // A field that is zero everywhere still needs an interval.
    let top = if top > 0.0 { top } else { 1.0 };
    let is_signed = values.iter().any(|&value| value < 0.0);
    Some((if is_signed { -top } else { 0.0 }, top))
}

enum FilmFailure {
    Film(FilmError),
    Other(Failure),
}

impl From<FilmError> for FilmFailure {
    fn from(error: FilmError) -> Self {
        Self::Film(error)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colours_cover_most_values_and_are_symmetric_when_signed() {
        assert_eq!(color_range(vec![]), None);
        assert_eq!(color_range(vec![0.0, f64::NAN]), Some((0.0, 1.0)));
        let mut values: Vec<f64> = (0..=200).map(f64::from).collect();
        assert_eq!(color_range(values.clone()), Some((0.0, 198.0)));
        values[3] = -3.0;
        assert_eq!(color_range(values), Some((-198.0, 198.0)));
    }
}
