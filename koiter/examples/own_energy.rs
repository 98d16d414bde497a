//! `cargo run --release -p koiter --example own_energy`
//!
//! An energy of one's own, from scratch: rubber tethers that pull every vertex of a sheet towards the surface of a ball that
//! is not there. Gradient and Hessian come from dual numbers; nobody writes them. Prints step, energy of the tethers, and how
//! far the vertices still are from the ball.
//!
//! Expect: the sheet bends onto the ball, to a mean distance of 2.4 mm after a tenth of a second; a flat sheet that hardly stretches
//! cannot lie on it whole.
//! Try next: another surface in `energy`; `koiter::testing::check`, which compares with differences.

use koiter::Vec3;
use koiter::assembly::{Assembled, Differentiated, Dof, ElementFunction};
use koiter::geometry::Real;
use koiter::geometry::over_numbers::{norm, point};
use koiter::mesh::VertexId;
use koiter::mesh::generate::{GridDiagonals, grid};
use koiter::scene::Simulation;
use koiter::scene::model::*;

/// E = Σ k/2 (|x| − r)²: a tether of every vertex.
struct Tethers {
    vertices: Vec<Dof>,
    stiffness: f64,
    radius: f64,
}

impl ElementFunction<3, 1> for Tethers {
    fn name(&self) -> &str {
        "tethers"
    }

    fn num_elements(&self) -> usize {
        self.vertices.len()
    }

    fn nodes(&self, element: usize) -> [Option<Dof>; 1] {
        [Some(self.vertices[element])]
    }

    fn energy<R: Real>(&self, _: usize, q: &[R; 3]) -> R {
        let away = norm(&point(q, 0)) - self.radius;
        away * away * (0.5 * self.stiffness)
    }
}

/// Radius of the ball [m].
const RADIUS: f64 = 0.3;

fn main() {
    let mut simulation = Simulation::new(sheet()).expect("a valid start");
    let vertices = 0..simulation.model().shells[0].surface.positions.len() as u32;
    let tethers = Tethers {
        vertices: vertices
            .map(|v| simulation.vertex(0, VertexId(v)))
            .collect(),
        stiffness: 20.0,
        radius: RADIUS,
    };
    let energy = Assembled::new(Differentiated(tethers), simulation.layout());
    simulation.add_energy(Box::new(energy));
    for _ in 0..20 {
        let report = simulation.step(0.02).expect("a step");
        let energies = &report.energies;
        let tethers = energies.iter().find(|(name, _)| name == "tethers");
        let positions = simulation.shell_positions(0);
        let away: f64 = positions.iter().map(|x| (x.norm() - RADIUS).abs()).sum();
        println!(
            "{:2}  {:.3e} J  {:.4} m",
            report.step,
            tethers.map_or(0.0, |(_, energy)| *energy),
            away / positions.len() as f64
        );
    }
}

/// A sheet of cotton that touches the ball with its middle.
fn sheet() -> Model {
    let mut surface = grid(0.5, 0.5, 16, 16, GridDiagonals::Checkerboard).expect("a grid");
    surface.positions.iter_mut().for_each(|x| x.z += RADIUS);
    let shell = Shell {
        name: "sheet".into(),
        velocities: vec![Vec3::zeros(); surface.positions.len()],
        rest_positions: surface.positions.clone(),
        surface,
        rest_curved: false,
        thickness: 1e-3,
        density: 500.0,
        youngs_modulus: 1e6,
        poissons_ratio: 0.3,
        composition: Composition::default(),
        bending: BendingModel::DsTheta,
        friction: 0.3,
        contact_offset: 0.0,
    };
    Model {
        shells: vec![shell],
        ..Model::default()
    }
}
