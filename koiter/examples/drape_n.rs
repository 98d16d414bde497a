//! `cargo run --release -p koiter --example drape_n -- 35 ds-theta 40`
//!
//! A cloth of 2 N² triangles falls on a ball that is a mesh: the scene `drape-n`, built in Rust instead of TOML. Prints mean
//! height, lowest point, iterations and contacts step by step, and at the end seconds by part.
//!
//! Expect: for N = 35 a mean height of 0.2636 m after step 5 and about 0.081 m after step 40.
//! Try next: `bac` or `dcs` instead of `ds-theta`; N = 70; `RAYON_NUM_THREADS=1`.

use koiter::Vec3;
use koiter::mesh::generate::{GridDiagonals, grid, icosphere};
use koiter::scene::Simulation;
use koiter::scene::model::*;

fn main() {
    let mut args = std::env::args().skip(1);
    let n: usize = args.next().map_or(35, |a| a.parse().expect("N"));
    let bending = match args.next().as_deref() {
        Some("bac") => BendingModel::Bac,
        Some("dcs") => BendingModel::Dcs,
        _ => BendingModel::DsTheta,
    };
    let steps: usize = args.next().map_or(40, |a| a.parse().expect("steps"));
    let mut cloth = grid(1.0, 1.0, n, n, GridDiagonals::Checkerboard).expect("a grid");
    for x in &mut cloth.positions {
        x.z += 0.32;
    }
    let shell = Shell {
        name: "cloth".into(),
        velocities: vec![Vec3::zeros(); cloth.positions.len()],
        rest_positions: cloth.positions.clone(),
        surface: cloth,
        rest_curved: false,
        thickness: 1e-3,
        density: 500.0,
        youngs_modulus: 1e6,
        poissons_ratio: 0.3,
        composition: Composition::default(),
        bending,
        friction: 0.4,
        contact_offset: 0.0,
    };
    let ball = Obstacle {
        name: "ball".into(),
        shape: ObstacleShape::Mesh(icosphere(0.3, 3).expect("a ball")),
        friction: 0.4,
        deformation: None,
        motion: Motion::default(),
    };
    let model = Model {
        shells: vec![shell],
        obstacles: vec![ball],
        gravity: Vec3::new(0.0, 0.0, -9.81),
        contact: ContactOptions {
            d_hat: Some(1e-3),
            ..Default::default()
        },
        ..Model::default()
    };
    let mut simulation = Simulation::new(model).expect("a valid start");
    let start = std::time::Instant::now();
    let (mut iterations, mut totals) = (0, std::collections::BTreeMap::<&str, f64>::new());
    for _ in 0..steps {
        let report = simulation.step(0.02).expect("a step");
        let x = simulation.shell_positions(0);
        let mean = x.iter().map(|p| p.z).sum::<f64>() / x.len() as f64;
        let low = x.iter().map(|p| p.z).fold(f64::INFINITY, f64::min);
        iterations += report.newton_iterations;
        for (part, seconds) in &report.seconds {
            *totals.entry(part).or_default() += seconds;
        }
        println!(
            "{:3} mean {mean:.5} low {low:.5} its {:3} ls {:3} contacts {:6} gap {:.1e} kappa {:.1e} {} {}",
            report.step,
            report.newton_iterations,
            report.line_search_steps,
            report.contacts,
            report.min_gap,
            report.kappa,
            if report.converged {
                ""
            } else {
                "NOT CONVERGED"
            },
            report.diagnosis.as_deref().unwrap_or("")
        );
    }
    println!(
        "{iterations} iterations, {:.1} s: {totals:.2?}",
        start.elapsed().as_secs_f64()
    );
}
