//! A sheet of paper that is curled, creased and pinned: Figure 3, as a chain of equilibria.

use koiter::Vec3;
use koiter::mesh::EdgeId;
use koiter::scene::Scene;
use koiter::scene::model::ProcessKind;
use nalgebra::{Matrix3, Vector3};

use super::run::{Trace, energy, shipped};
use crate::bench::gates::{Gate, Gates};
use crate::bench::published::{number, rows};
use crate::failure::Failure;

/// Half a digit of the reference, which fits a circle too.
const RADIUS_TOLERANCE: f64 = 2e-4;
/// Of the energy of a half crease, and of its growth with the square of the angle.
const CREASE_TOLERANCE: f64 = 0.02;
/// A tenth of a degree of the largest angle.
const ANGLE_TOLERANCE: f64 = 2e-3;
/// Up to this angle [°] the energy goes with its square.
const SMALL: f64 = 45.0;
/// The crease of the sheet whose corners are pulled [°].
const PULLED: f64 = 60.0;
/// 1e-6 dyn [N]: of what Newton's method leaves at a free vertex.
const FORCE_TOLERANCE: f64 = 1e-11;
/// 1 erg [J].
const ERG: f64 = 1e-7;

macro_rules! reference {
    ($file:literal) => {
        rows(include_str!(concat!(
            "../../../../benchmarks/discrete-shells/",
            $file
        )))
        .map(|row| row.into_iter().map(number).collect::<Vec<f64>>())
    };
}

pub(super) fn check(gates: &mut Gates) -> Result<(), Failure> {
    let creases: Vec<Vec<f64>> = reference!("half-crease.csv").collect();
    let mut of_curl = None;
    let mut first = None;
    for row in &creases {
        let [degrees, expected, mean] = [row[0], ERG * row[1], row[2]];
        let scene = shipped(
            "paper-sheet",
            &[&format!("process.crease.crease.degrees={degrees}")],
        )?;
        let mut sheet = Sheet::new(scene)?;
        let curl = sheet.curl(of_curl.is_none().then_some(&mut *gates))?;
        let curl = *of_curl.get_or_insert(curl);
        sheet.run_to(1.0)?;
        let stored = sheet.stored();
        let case = format!("paper, half crease, {degrees}°");
        gates.check(
            &case,
            "energy",
            "J",
            stored,
            Gate::Near(expected, CREASE_TOLERANCE),
        );
        let angle = sheet.mean_crease();
        gates.check(
            &case,
            "mean angle",
            "°",
            angle,
            Gate::Near(mean, ANGLE_TOLERANCE),
        );
        let (smallest, least) = *first.get_or_insert((degrees, stored));
        if degrees > smallest && degrees <= SMALL {
            let growth = stored / least / (degrees / smallest).powi(2);
            let gate = Gate::Near(1.0, CREASE_TOLERANCE);
            gates.check(&case, "energy by the square of the angle", "", growth, gate);
        }
        if degrees == smallest {
            gates.check(
                "paper, curl",
                "energy by that of the crease",
                "",
                curl / stored,
                Gate::Below(1e-10),
            );
        }
        if degrees == PULLED {
            sheet.pull(gates)?;
        }
    }
    Ok(())
}

/// The scene, between its parts.
struct Sheet {
    trace: Trace,
    scene: Scene,
    /// Vertices of the middle line along x.
    row: Vec<usize>,
    /// The last step of Newton's method in the last equilibrium [m].
    residual: f64,
    /// The largest force that is left at a vertex that is free, in all equilibria so far [N].
    left_over: f64,
}

impl Sheet {
    fn new(scene: Scene) -> Result<Self, Failure> {
        let trace = Trace::new(scene.model.clone())?;
        let positions = trace.simulation.shell_positions(0);
        let row = (0..positions.len()).filter(|&v| positions[v].y.abs() < 1e-9);
        Ok(Self {
            row: row.collect(),
            trace,
            scene,
            residual: f64::INFINITY,
            left_over: 0.0,
        })
    }

    /// Equilibria up to a time of the schedules; the most iterations of one.
    fn run_to(&mut self, time: f64) -> Result<usize, Failure> {
        let mut most = 0;
        while self.trace.simulation.time() < time - 1e-9 {
            let step = self.trace.simulation.step_count() + 1;
            let report = self.trace.step(self.scene.timeline.dt(step))?;
            most = most.max(report.newton_iterations);
            self.residual = report.residual;
            self.left_over = self.left_over.max(self.largest_force());
        }
        Ok(most)
    }

    /// The largest force at a vertex that nothing holds [N].
    fn largest_force(&self) -> f64 {
        let simulation = &self.trace.simulation;
        let mut gradient = simulation.elastic_gradient();
        let constraints = self.scene.model.constraints.iter();
        for constraint in constraints.filter(|held| held.is_due(simulation.time())) {
            for vertex in &constraint.vertices {
                for axis in (0..3).filter(|&axis| constraint.axes[axis]) {
                    gradient[3 * vertex.0 as usize + axis] = 0.0;
                }
            }
        }
        let forces = gradient
            .chunks_exact(3)
            .map(|g| Vec3::from_column_slice(g).norm());
        forces.fold(0.0, f64::max)
    }

    /// Energy of membrane and bending [J].
    fn stored(&self) -> f64 {
        let simulation = &self.trace.simulation;
        energy(simulation, "membrane") + energy(simulation, "bending")
    }

    /// Curls, with the figures where they are asked for; the largest energy on the way [J].
    fn curl(&mut self, gates: Option<&mut Gates>) -> Result<f64, Failure> {
        let (mut radii, mut largest, mut strain, mut most) = (Vec::new(), 0.0f64, 0.0f64, 0);
        let references: Vec<Vec<f64>> = reference!("curl.csv").collect();
        for step in 1..=references.len() {
            most = most.max(self.run_to(self.scene.timeline.time(step))?);
            let positions = self.trace.simulation.shell_positions(0);
            radii.push(radius(self.row.iter().map(|&v| positions[v])));
            largest = largest.max(self.stored());
            strain = strain.max(self.largest_strain(&positions));
        }
        let Some(gates) = gates else {
            return Ok(largest);
        };
        for (row, radius) in references.iter().zip(radii) {
            let figure = format!("radius at {}", row[0]);
            let gate = Gate::Near(1e-2 * row[1], RADIUS_TOLERANCE);
            gates.check("paper, curl", &figure, "m", radius, gate);
        }
        gates.check(
            "paper, curl",
            "largest energy",
            "J",
            largest,
            Gate::Below(2e-16 * ERG),
        );
        gates.check(
            "paper, curl",
            "largest strain of an edge",
            "",
            strain,
            Gate::Below(1e-12),
        );
        gates.check(
            "paper, curl",
            "most iterations",
            "",
            most as f64,
            Gate::Beside(14.0),
        );
        Ok(largest)
    }

    fn largest_strain(&self, positions: &[Vec3]) -> f64 {
        let shell = &self.scene.model.shells[0];
        let length = |x: &[Vec3], [u, v]: [u32; 2]| (x[u as usize] - x[v as usize]).norm();
        let edges = shell.surface.mesh.edges().iter();
        let strains =
            edges.map(|&ends| length(positions, ends) / length(&shell.rest_positions, ends) - 1.0);
        strains.fold(0.0, |largest, strain| strain.abs().max(largest))
    }

    /// Mean angle of the creased edges [°].
    fn mean_crease(&self) -> f64 {
        let model = &self.scene.model;
        let mesh = &model.shells[0].surface.mesh;
        let creased = model
            .processes
            .iter()
            .find_map(|process| match &process.kind {
                ProcessKind::Crease { edges, .. } => Some(edges),
                _ => None,
            });
        let creased = creased.expect("the scene has a crease");
        let all = (0..mesh.num_edges() as u32).map(EdgeId);
        let inner = all.filter(|&edge| !mesh.is_boundary_edge(edge));
        let snapshot = self.trace.simulation.snapshot();
        let angles = inner.zip(&snapshot.angles[0]);
        let creased: Vec<f64> = (angles.filter(|(edge, _)| creased.contains(edge)))
            .map(|(_, angle)| angle.to_degrees())
            .collect();
        creased.iter().sum::<f64>() / creased.len() as f64
    }

    /// Pulls the corners: what is left over of the forces at the pins is what Newton's method left at the other vertices.
    fn pull(&mut self, gates: &mut Gates) -> Result<(), Failure> {
        let end = self.scene.timeline.num_steps();
        self.run_to(self.scene.timeline.time(end))?;
        let constraints = self.scene.model.constraints.len();
        let forces: Vec<Vec3> = (0..constraints)
            .map(|constraint| self.trace.simulation.reaction(constraint))
            .collect();
        let largest = forces.iter().map(|force| force.norm()).fold(0.0, f64::max);
        let sum: Vec3 = forces.iter().sum();
        let case = "paper, pulled by 35 %";
        gates.check(
            case,
            "energy",
            "J",
            self.stored(),
            Gate::Beside(1.09e5 * ERG),
        );
        gates.check(
            case,
            "largest force at a pin",
            "N",
            largest,
            Gate::Above(0.0),
        );
        let balance = sum.norm() / largest;
        gates.check(
            case,
            "sum of the forces by the largest",
            "",
            balance,
            Gate::Below(1e-6),
        );
        gates.check(
            case,
            "Newton's last step",
            "m",
            self.residual,
            Gate::Below(1e-9),
        );
        let force = self.left_over;
        let figure = "force left at a free vertex, at most";
        gates.check(case, figure, "N", force, Gate::Below(FORCE_TOLERANCE));
        Ok(())
    }
}

/// Radius of the circle in the plane of x and z that fits points best: x² + z² + a x + b z + c ≈ 0 in least squares.
fn radius(points: impl Iterator<Item = Vec3>) -> f64 {
    let (mut matrix, mut right) = (Matrix3::zeros(), Vector3::zeros());
    for x in points {
        let row = Vector3::new(x.x, x.z, 1.0);
        matrix += row * row.transpose();
        right -= row * (x.x * x.x + x.z * x.z);
    }
    let Some(abc) = matrix.lu().solve(&right) else {
        return f64::INFINITY;
    };
    (0.25 * (abc.x * abc.x + abc.y * abc.y) - abc.z).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_sheet_curls_and_creases_as_in_the_reference() {
        let mut gates = Gates::new("Discrete Shells");
        check(&mut gates).unwrap();
        let failures = &gates.table.failures;
        assert!(failures.is_empty(), "{failures:?}");
        let rows = gates.table.json()["rows"].as_array().map_or(0, Vec::len);
        // Six radii, three figures of the curl and its comparison, two of each crease, two squares, five of the pull.
        assert_eq!(rows, 6 + 4 + 2 * 5 + 2 + 5);
    }

    #[test]
    fn the_circle_through_points_is_found() {
        let points = (0..9).map(|k| {
            let (sin, cos) = (0.1 * f64::from(k) - 0.3).sin_cos();
            Vec3::new(0.3 * sin + 0.02, 1.0, 0.3 * cos - 0.3)
        });
        assert!((radius(points) - 0.3).abs() < 1e-12);
    }
}
