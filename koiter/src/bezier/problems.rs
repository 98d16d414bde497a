//! Published problems: a quarter of the Scordelis–Lo roof and of the pinched hemisphere, a clamped plate.
//!
//! Grids of `cells` × `cells` pairs of triangles whose diagonals all run the same way, but where it says otherwise; normals are those of the smooth
//! surface. `benchmarks/` says where the numbers are from.

use std::f64::consts::{FRAC_PI_2, PI};

use super::{
    BezierError, BezierShell, DeadLoad, ElementKind, FrameRule, Pose, Section, ShellOptions,
    Solver, Supports, linear_static,
};
use super::{NewtonLimits, NewtonOutcome};
use crate::Vec3;
use crate::mesh::Surface;
use crate::mesh::generate::{GridDiagonals, cylinder_panel, grid, sphere_zone};

/// A shell with supports and loads, and the displacement that is looked at.
#[derive(Clone, Debug)]
pub struct Problem {
    /// The shell.
    pub shell: BezierShell,
    /// What is held.
    pub supports: Supports,
    /// The full load.
    pub load: DeadLoad,
    /// Nodes whose displacements are looked at, each with a direction.
    pub probes: Vec<(usize, Vec3)>,
    /// A length of the mesh [m].
    pub edge: f64,
}

/// What holds the curved edges of the roof.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RoofEdges {
    /// Diaphragms: free to move along the roof and to turn. The original problem.
    Diaphragms,
    /// Clamped. Golembiovsky and Duriez (2012), section 5.1.
    Clamped,
}

fn shell(
    surface: &Surface,
    normals: impl Fn(&Vec3) -> Vec3,
    kind: ElementKind,
    frame: Option<FrameRule>,
    section: Section,
) -> Result<BezierShell, BezierError> {
    let normals: Vec<Vec3> = surface.positions.iter().map(normals).collect();
    let options = ShellOptions {
        section,
        kind,
        frame,
    };
    BezierShell::new(surface, &normals, options)
}

/// A quarter of the roof; the probe is how far the middle of the free edge sinks.
///
/// # Errors
/// As [`BezierShell::new`].
///
/// # Panics
/// If there are no cells.
pub fn roof(kind: ElementKind, cells: usize, edges: RoofEdges) -> Result<Problem, BezierError> {
    let (length, angle) = (25.0, 40.0 * PI / 180.0);
    let surface = cylinder_panel(
        25.0,
        length,
        [0.0, angle],
        [cells; 2],
        GridDiagonals::Uniform,
    )
    .expect("the roof is a proper panel");
    let section = Section {
        youngs_modulus: 4.32e8,
        poissons_ratio: 0.0,
        thickness: 0.25,
        density: 360.0,
    };
    let shell = shell(&surface, |x| Vec3::new(x.x, 0.0, x.z), kind, None, section)?;
    let mut supports = Supports::none(surface.positions.len());
    // Coordinates on the planes are exact to round-off of the radius.
    let near = 1e-9;
    for (node, x) in surface.positions.iter().enumerate() {
        if x.y < near {
            match edges {
                RoofEdges::Clamped => supports.clamp(node),
                RoofEdges::Diaphragms => {
                    supports.hold_displacement(node, 0);
                    supports.hold_displacement(node, 2);
                }
            }
        }
        if x.x < near {
            supports.mirror(node, 0);
        }
        if x.y > length - near {
            supports.mirror(node, 1);
        }
    }
    let mut load = DeadLoad::none(surface.positions.len());
    // 90 a unit of area: a density of 360 times a thickness of 0.25 under an acceleration of 1.
    load.add_gravity(&shell, -Vec3::z());
    Ok(Problem {
        shell,
        supports,
        load,
        probes: vec![((cells + 1) * (cells + 1) - 1, -Vec3::z())],
        edge: length / cells as f64,
    })
}

/// A quarter of the hemisphere with a hole of 18°, pulled by `force` [N] at each of the four points of the whole shell. The
/// probes are how far the points pulled outwards and inwards follow.
///
/// # Errors
/// As [`BezierShell::new`].
///
/// # Panics
/// If there are no cells.
pub fn hemisphere(kind: ElementKind, cells: usize, force: f64) -> Result<Problem, BezierError> {
    let latitudes = [0.0, 72.0 * PI / 180.0];
    let surface = sphere_zone(
        10.0,
        [0.0, FRAC_PI_2],
        latitudes,
        [cells; 2],
        GridDiagonals::Uniform,
    )
    .expect("the hemisphere is a proper zone");
    let section = Section {
        youngs_modulus: 6.825e7,
        poissons_ratio: 0.3,
        thickness: 0.04,
        density: 1.0,
    };
    let shell = shell(&surface, |x| *x, kind, None, section)?;
    let mut supports = Supports::none(surface.positions.len());
    let near = 1e-9;
    for (node, x) in surface.positions.iter().enumerate() {
        for axis in 0..2 {
            if x[axis] < near {
                supports.mirror(node, axis);
            }
        }
    }
    // The loads balance: whichever node is held, nothing pulls on it.
    supports.hold_displacement(0, 2);
    let mut load = DeadLoad::none(surface.positions.len());
    // A force on a plane of symmetry belongs half to either side.
    load.add_force(0, Vec3::x() * (0.5 * force));
    load.add_force(cells, Vec3::y() * (-0.5 * force));
    Ok(Problem {
        shell,
        supports,
        load,
        probes: vec![(0, Vec3::x()), (cells, -Vec3::y())],
        edge: 10.0 * FRAC_PI_2 / cells as f64,
    })
}

/// The mesh of a plate.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PlateMesh {
    /// All diagonals run the same way: edges have three directions.
    Uniform,
    /// Diagonals alternate from cell to cell.
    Alternating,
    /// Diagonals run the same way, and vertices inside are moved by up to a quarter of a cell, always the same.
    Jittered,
}

/// A square plate whose edges are clamped, of unit size and rigidity, under a uniform load of 1 an area. The probe is the
/// deflection of the middle, 0.00126532 by Kirchhoff's theory.
///
/// # Errors
/// As [`BezierShell::new`].
///
/// # Panics
/// If there are no cells.
pub fn clamped_plate(
    kind: ElementKind,
    cells: usize,
    mesh: PlateMesh,
) -> Result<Problem, BezierError> {
    let diagonals = match mesh {
        PlateMesh::Alternating => GridDiagonals::Checkerboard,
        _ => GridDiagonals::Uniform,
    };
    let mut surface = grid(1.0, 1.0, cells, cells, diagonals).expect("the plate is a proper grid");
    let is_rim = |x: &Vec3| x.x.abs().max(x.y.abs()) > 0.5 - 1e-9;
    if mesh == PlateMesh::Jittered {
        let size = 0.25 / cells as f64;
        for (node, x) in surface.positions.iter_mut().enumerate() {
            let middle = x.norm() < 1e-9;
            if !is_rim(x) && !middle {
                // Two irrational rotations: spread evenly, and the same everywhere.
                let [a, b] = [0.754_877_666, 0.569_840_291].map(|r| (r * node as f64).fract());
                *x += Vec3::new(2.0 * a - 1.0, 2.0 * b - 1.0, 0.0) * size;
            }
        }
    }
    let thickness = 1e-3;
    let nu: f64 = 0.3;
    let section = Section {
        youngs_modulus: 12.0 * (1.0 - nu * nu) / f64::powi(thickness, 3),
        poissons_ratio: nu,
        thickness,
        density: 1.0 / thickness,
    };
    let shell = shell(&surface, |_| Vec3::z(), kind, None, section)?;
    let mut supports = Supports::none(surface.positions.len());
    let mut middle = 0;
    for (node, x) in surface.positions.iter().enumerate() {
        if is_rim(x) {
            supports.clamp(node);
        }
        if x.norm() < surface.positions[middle].norm() {
            middle = node;
        }
    }
    let mut load = DeadLoad::none(surface.positions.len());
    load.add_gravity(&shell, Vec3::z());
    Ok(Problem {
        shell,
        supports,
        load,
        probes: vec![(middle, Vec3::z())],
        edge: 1.0 / cells as f64,
    })
}

impl Problem {
    /// The displacements of the probes by the linear theory [m].
    ///
    /// # Errors
    /// As [`linear_static`].
    pub fn solve_linear(&mut self) -> Result<Vec<f64>, BezierError> {
        let motion = linear_static(&mut self.shell, &self.load, &self.supports)?;
        let at = |node: usize| Vec3::from_column_slice(&motion[6 * node..6 * node + 3]);
        Ok((self.probes.iter())
            .map(|(node, direction)| at(*node).dot(direction))
            .collect())
    }

    /// Follows the load in equal steps and hands on the fraction of the load, the displacements of the probes [m] and what
    /// Newton's method did. The last pose is returned.
    ///
    /// # Errors
    /// As [`Solver::minimize`].
    pub fn follow(
        &mut self,
        steps: usize,
        mut after_step: impl FnMut(f64, &[f64], &NewtonOutcome),
    ) -> Result<Pose, BezierError> {
        let rest = self.shell.rest_pose();
        let mut pose = rest.clone();
        let mut solver = Solver::new(self.shell.layout());
        let limits = NewtonLimits::for_edges(self.edge);
        for step in 1..=steps {
            let fraction = step as f64 / steps as f64;
            let mut load = self.load.scaled(fraction);
            let potentials: &mut [&mut dyn super::Potential] = &mut [&mut self.shell, &mut load];
            let outcome = solver.minimize(potentials, &self.supports, &mut pose, &limits)?;
            let displacements: Vec<f64> = (self.probes.iter())
                .map(|(node, along)| (pose.positions[*node] - rest.positions[*node]).dot(along))
                .collect();
            after_step(fraction, &displacements, &outcome);
        }
        Ok(pose)
    }
}
