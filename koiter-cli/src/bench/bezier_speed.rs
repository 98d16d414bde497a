//! `koiter bench bezier --speed`: frames a second of an interactive Bézier shell, on one thread.
//!
//! A clamped roof under its weight is dragged about. A frame is one implicit step of one iteration, as in the paper (Figure
//! 9): A without frame fixing, B with it, C and D with a fine surface carried too.

use std::time::{Duration, Instant};

use koiter::Vec3;
use koiter::bezier::problems::{RoofEdges, roof};
use koiter::bezier::{
    BezierShell, Carried, Drag, Dynamics, ElementKind, FrameRule, Interaction, MappedSurface,
    ShellOptions, SurfacePoint,
};
use koiter::mesh::generate::{GridDiagonals, cylinder_panel};

use super::on_threads;
use super::table::Table;
use crate::arguments::BezierArguments;
use crate::failure::Failure;

/// Cells of the roof: 98 to 9800 elements.
const CELLS: [usize; 9] = [7, 10, 16, 22, 27, 32, 39, 55, 70];

/// Cells of the fine surface: 3200 and 10,082 triangles, as in the paper.
const FINE_CELLS: [usize; 3] = [0, 40, 71];

/// Frames that are measured, at most this long [s].
const FRAMES: usize = 60;
const SECONDS: f64 = 4.0;

/// Opening of the quarter roof [rad], and its length [m].
const ANGLE: f64 = 40.0 * std::f64::consts::PI / 180.0;
const LENGTH: f64 = 25.0;

pub(super) fn bench(_options: &BezierArguments) -> Result<Table, Failure> {
    let mut table = Table::new(
        "bezier-speed",
        &[
            ("elements", "elements"),
            ("frame", "frame"),
            ("mapped_triangles", "mapped triangles"),
            ("frames_per_second", "frames a second"),
            ("milliseconds", "ms a frame"),
            ("map_milliseconds", "of which the map"),
        ],
    );
    on_threads(1, || {
        for cells in CELLS {
            measure(cells, FrameRule::Edge, 0, &mut table)?;
            for fine in FINE_CELLS {
                measure(cells, FrameRule::Polar, fine, &mut table)?;
            }
        }
        let start = Instant::now();
        let problem = roof(ElementKind::Bezier, 64, RoofEdges::Clamped);
        problem
            .and_then(|mut roof| roof.solve_linear())
            .map_err(Failure::run)?;
        let seconds = start.elapsed().as_secs_f64();
        table.details = Some(serde_json::json!({ "static_roof_64_seconds": seconds }));
        table.push([
            8192.into(),
            "static".into(),
            0.into(),
            (1.0 / seconds).into(),
            (1e3 * seconds).into(),
            0.0.into(),
        ]);
        Ok::<(), Failure>(())
    })??;
    Ok(table)
}

fn measure(cells: usize, rule: FrameRule, fine: usize, table: &mut Table) -> Result<(), Failure> {
    let mut played = interaction(cells, rule)?;
    let mapped = match fine {
        0 => None,
        fine => Some(fine_surface(&played.dynamics.shell, fine)?),
    };
    let point = SurfacePoint {
        element: cells * cells,
        barycentric: [1.0 / 3.0; 3],
    };
    let at = Carried::new(&played.dynamics.shell, &point).position(&played.dynamics.pose);
    let (mut frames, mut map_seconds) = (0, 0.0);
    let mut start = Instant::now();
    // The first frames make the order of elimination.
    const WARM: usize = 3;
    for frame in 0..FRAMES + WARM {
        if frame == WARM {
            (start, frames, map_seconds) = (Instant::now(), 0, 0.0);
        }
        let phase = 0.2 * frame as f64;
        played.drags = vec![Drag {
            point,
            target: at + Vec3::new(phase.sin(), 0.0, phase.cos() - 1.0) * 4.0,
            stiffness: 1e5,
        }];
        played.frame(Duration::from_secs(60));
        if let Some(mapped) = &mapped {
            let clock = Instant::now();
            std::hint::black_box(mapped.positions(&played.dynamics.pose));
            map_seconds += clock.elapsed().as_secs_f64();
        }
        frames += 1;
        if frame > WARM && start.elapsed().as_secs_f64() > SECONDS {
            break;
        }
    }
    let seconds = start.elapsed().as_secs_f64() / frames as f64;
    table.push([
        (2 * cells * cells).into(),
        if rule == FrameRule::Edge {
            "edge"
        } else {
            "polar"
        }
        .into(),
        mapped.map_or(0, |m| m.faces().len()).into(),
        (1.0 / seconds).into(),
        (1e3 * seconds).into(),
        (1e3 * map_seconds / frames as f64).into(),
    ]);
    Ok(())
}

fn interaction(cells: usize, rule: FrameRule) -> Result<Interaction, Failure> {
    let problem = roof(ElementKind::Bezier, cells, RoofEdges::Clamped).map_err(Failure::run)?;
    let surface = cylinder_panel(
        25.0,
        LENGTH,
        [0.0, ANGLE],
        [cells; 2],
        GridDiagonals::Uniform,
    );
    let surface = surface.map_err(Failure::run)?;
    let normals: Vec<Vec3> = (surface.positions.iter())
        .map(|x| Vec3::new(x.x, 0.0, x.z))
        .collect();
    let options = ShellOptions {
        frame: Some(rule),
        ..*problem.shell.options()
    };
    let shell = BezierShell::new(&surface, &normals, options).map_err(Failure::run)?;
    let mut played = Interaction::new(Dynamics::new(shell, problem.supports), 0.04);
    played.load = problem.load;
    played.iterations = 1;
    Ok(played)
}

fn fine_surface(shell: &BezierShell, cells: usize) -> Result<MappedSurface, Failure> {
    let fine = cylinder_panel(
        25.0,
        LENGTH,
        [0.0, ANGLE],
        [cells; 2],
        GridDiagonals::Uniform,
    );
    let fine = fine.map_err(Failure::run)?;
    MappedSurface::new(shell, &fine, 1.0).map_err(Failure::run)
}
