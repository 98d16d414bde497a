//! Pictures and a film of a cloth over a ball, to judge the look of the renderer. No simulation: the folds are a formula.
//!
//! ```text
//! cargo run --release -p koiter-render --example drape_look -- FOLDER [--film]
//! ```
//!
//! Writes `drape.png`, `height.png` (a field with its legend), `mesh.png` (wireframe), `large.png` (160 000 triangles),
//! `sheet.png` (six moments) and with `--film` also `drape.gif`, `drape.mp4`, and prints seconds a picture.
//! Try another colour map, `CameraView`, or a lower lamp.

use std::error::Error;
use std::f64::consts::TAU;
use std::path::{Path, PathBuf};
use std::time::Instant;

use koiter_render::{
    Bounds, Camera, CameraView, ColorBy, ColorMap, FieldView, Film, FilmError, Ground, Image,
    PartView, Quality, RenderOptions, Scene, contact_sheet, render,
};

const BALL: f64 = 0.45;
const CENTER: f64 = 0.78;
const SIZE: (u32, u32) = (1280, 720);

type Mesh = (Vec<[f64; 3]>, Vec<[u32; 3]>);

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let folder = PathBuf::from(arguments.first().ok_or("give a folder for the pictures")?);
    std::fs::create_dir_all(&folder)?;
    let ball = sphere(96, 48);
    let cloth = drape(101, 1.0);
    let mut bounds = Bounds::EMPTY;
    for t in [0.0, 1.0] {
        drape(41, t).0.iter().for_each(|&p| bounds.include(p));
    }
    let view = CameraView::Orbit {
        azimuth: 30.0,
        elevation: 20.0,
        zoom: 1.0,
    };
    let camera = Camera::fit(&bounds, view, f64::from(SIZE.0) / f64::from(SIZE.1));
    let still = RenderOptions::new(SIZE.0, SIZE.1, camera);
    let film = RenderOptions {
        quality: Quality::Film,
        ..still.clone()
    };

    draw(&cloth, &ball, None, &still, &folder.join("drape.png"))?;
    draw(&cloth, &ball, None, &film, &folder.join("drape_film.png"))?;
    draw(
        &drape(284, 1.0),
        &ball,
        None,
        &still,
        &folder.join("large.png"),
    )?;
    draw(
        &drape(284, 1.0),
        &ball,
        None,
        &film,
        &folder.join("large_film.png"),
    )?;
    let mesh = drape(41, 1.0);
    draw(
        &mesh,
        &ball,
        None,
        &RenderOptions {
            wireframe: true,
            ..still.clone()
        },
        &folder.join("mesh.png"),
    )?;
    let heights: Vec<f64> = cloth.0.iter().map(|p| p[2]).collect();
    let color = ColorBy::field("height", "m", ColorMap::Viridis);
    let with_field = RenderOptions {
        color,
        caption: Some("t = 1.20 s".into()),
        ..still.clone()
    };
    draw(
        &cloth,
        &ball,
        Some(FieldView::PerVertex(&heights)),
        &with_field,
        &folder.join("height.png"),
    )?;
    let moments = (0..6)
        .map(|i| moment(f64::from(i) / 5.0, &ball, &film))
        .collect::<Result<Vec<_>, _>>()?;
    contact_sheet(&moments, 3)?.write_png(folder.join("sheet.png"))?;
    if arguments.iter().any(|argument| argument == "--film") {
        write_film(&ball, &film, &folder.join("drape.gif"))?;
        match write_film(&ball, &film, &folder.join("drape.mp4")) {
            Err(error) if matches!(error.downcast_ref(), Some(FilmError::FfmpegMissing)) => {
                println!("{error}")
            }
            other => other?,
        }
    }
    Ok(())
}

/// Renders, writes and says how long it took.
fn draw(
    cloth: &Mesh,
    ball: &Mesh,
    field: Option<FieldView>,
    options: &RenderOptions,
    path: &Path,
) -> Result<(), Box<dyn Error>> {
    let parts = vec![
        PartView {
            field,
            ..PartView::shell(&cloth.0, &cloth.1)
        },
        PartView::obstacle(&ball.0, &ball.1),
    ];
    let scene = Scene {
        parts,
        ground: Ground::At(0.0),
    };
    let start = Instant::now();
    let image = render(&scene, options)?;
    println!(
        "{:>7} faces, {:?}: {:.2} s",
        cloth.1.len(),
        options.quality,
        start.elapsed().as_secs_f64()
    );
    Ok(image.write_png(path)?)
}

fn moment(t: f64, ball: &Mesh, options: &RenderOptions) -> Result<Image, Box<dyn Error>> {
    let cloth = drape(101, t);
    let parts = vec![
        PartView::shell(&cloth.0, &cloth.1),
        PartView::obstacle(&ball.0, &ball.1),
    ];
    let caption = Some(format!("t = {t:.2} s"));
    Ok(render(
        &Scene {
            parts,
            ground: Ground::At(0.0),
        },
        &RenderOptions {
            caption,
            ..options.clone()
        },
    )?)
}

fn write_film(ball: &Mesh, options: &RenderOptions, path: &Path) -> Result<(), Box<dyn Error>> {
    let start = Instant::now();
    let mut film = Film::create(path, 25.0, options.width, options.height)?;
    for frame in 0..50 {
        film.push(&moment(f64::from(frame) / 49.0, ball, options)?)?;
    }
    film.finish()?;
    println!("{}: {:.1} s", path.display(), start.elapsed().as_secs_f64());
    Ok(())
}

/// A square of 2 m with `n` vertices a side, from flat (t = 0) to hanging over the ball (t = 1).
fn drape(n: u32, t: f64) -> Mesh {
    // Past this angle from the pole the cloth leaves the ball.
    let leave = 1.15;
    let blend = t * t * (3.0 - 2.0 * t);
    let mut positions = Vec::new();
    for j in 0..n {
        for i in 0..n {
            let at = |k: u32| 2.0 * f64::from(k) / f64::from(n - 1) - 1.0;
            let (x, y) = (at(i), at(j));
            let (arc, angle) = (x.hypot(y), y.atan2(x));
            let (mut radius, mut height) = (
                BALL * (arc / BALL).sin(),
                CENTER + BALL * (arc / BALL).cos(),
            );
            let mut shift = 0.0;
            if arc > leave * BALL {
                let free = arc - leave * BALL;
                // The profile turns from the tangent to nearly straight down.
                let turn = 1.0 - (-free / 0.16).exp();
                let slope = leave + (1.50 - leave) * turn;
                radius = BALL * leave.sin() + free * (0.5 * (leave.cos() + slope.cos()));
                height = CENTER + BALL * leave.cos() - free * (0.5 * (leave.sin() + slope.sin()));
                // Folds take up the rest of the circumference.
                let waves = 9.0;
                let excess = ((arc / radius).powi(2) - 1.0).max(0.0);
                let depth = radius / waves * (1.6 * excess).sqrt() * (1.0 - (-free / 0.10).exp());
                let phase = waves * angle
                    + 0.9 * (2.0 * angle + 0.4).sin()
                    + 0.5 * (3.0 * angle).cos()
                    + 0.8 * free;
                let wave = phase.cos()
                    + 0.22 * (2.0 * phase + 0.6).cos()
                    + 0.18 * (angle * 4.0 + 6.0 * free).sin();
                // A smooth maximum keeps the folds out of the ball.
                let wall = (BALL.powi(2) - (height - CENTER).powi(2)).max(0.0).sqrt();
                let over = radius + depth * wave - wall;
                shift =
                    wall + 0.5 * (over + over.hypot(0.03)) - radius - 0.015 * (-free / 0.05).exp();
            }
            let draped = [
                (radius + shift) * angle.cos(),
                (radius + shift) * angle.sin(),
                height,
            ];
            let flat = [
                x,
                y,
                CENTER + BALL + 0.12 + 0.01 * (5.0 * x + 3.0 * y).sin(),
            ];
            // The rim lags behind the middle.
            let s = (blend * (1.0 + 0.25 * (1.0 - arc).min(0.0) * (1.0 - t))).clamp(0.0, 1.0);
            positions.push(std::array::from_fn(|axis| {
                flat[axis] + s * (draped[axis] - flat[axis])
            }));
        }
    }
    (positions, grid_faces(n, n))
}

fn sphere(around: u32, down: u32) -> Mesh {
    let radius = BALL - 0.012;
    let mut positions = Vec::new();
    for j in 0..=down {
        for i in 0..=around {
            let (a, b) = (
                TAU * f64::from(i) / f64::from(around),
                0.5 * TAU * f64::from(j) / f64::from(down),
            );
            positions.push([
                radius * b.sin() * a.cos(),
                radius * b.sin() * a.sin(),
                CENTER - radius * b.cos(),
            ]);
        }
    }
    (positions, grid_faces(around + 1, down + 1))
}

fn grid_faces(columns: u32, rows: u32) -> Vec<[u32; 3]> {
    let mut faces = Vec::new();
    for j in 0..rows - 1 {
        for i in 0..columns - 1 {
            let [a, b] = [j * columns + i, (j + 1) * columns + i];
            faces.extend(if (i + j) % 2 == 0 {
                [[a, a + 1, b + 1], [a, b + 1, b]]
            } else {
                [[a, a + 1, b], [a + 1, b + 1, b]]
            });
        }
    }
    faces
}
