//! Conduction of springs and of triangles beside what heat does: it is kept, stays in its range, and spreads as its kernel.

use koiter::burning::{Conduction, DoubleLayer, QuadMesh, TriangleConduction};
use koiter::mesh::Surface;
use koiter::mesh::generate::{GridDiagonals, grid};

use crate::bench::gates::{Gate, Gates};

/// Side of a sheet [m], cells along it, diffusivity [m²/s], width of a spot [m], step [s] and number of steps.
const SIDE: f64 = 1.0;
const CELLS: usize = 80;
const DIFFUSIVITY: f64 = 1e-3;
const WIDTH: f64 = 0.05;
const DT: f64 = 2e-3;
const STEPS: usize = 400;

pub(super) fn check(gates: &mut Gates) {
    springs_keep_heat(gates);
    triangles_keep_heat(gates);
    let shell = sheet(CELLS, 0.05 * SIDE / CELLS as f64);
    let there = shell.springs.each_ref().map(|s| vec![true; s.len()]);
    let mut conduction = Conduction::new(&shell);
    let diffusivity = vec![DIFFUSIVITY; shell.particles.len()];
    spreads(
        gates,
        "heat along springs",
        &shell.particles,
        |temperatures| {
            conduction.conduct(&shell.particles, &there, &diffusivity, DT, temperatures);
        },
    );
    let surface = triangles(CELLS);
    let n = surface.positions.len();
    let mut conduction = TriangleConduction::new(&surface);
    let (there, diffusivity) = (vec![true; n], vec![DIFFUSIVITY; n]);
    // Both layers, which are alike.
    let layers = [&surface.positions[..]; 2].concat();
    spreads(gates, "heat on triangles", &layers, |temperatures| {
        conduction.conduct(&there, &diffusivity, 0.0, DT, temperatures);
    });
}

fn sheet(cells: usize, thickness: f64) -> DoubleLayer {
    let mesh = QuadMesh::grid([SIDE; 2], [cells; 2]).expect("a grid is sound");
    DoubleLayer::new(mesh, thickness)
}

fn triangles(cells: usize) -> Surface {
    grid(SIDE, SIDE, cells, cells, GridDiagonals::Alternating).expect("a grid is sound")
}

/// Hot here and there.
fn spotted(count: usize) -> Vec<f64> {
    let hot = |p: usize| {
        293.0 + 700.0 * f64::from(u8::from(p.is_multiple_of(17))) + 50.0 * (0.9 * p as f64).sin()
    };
    (0..count).map(hot).collect()
}

/// Uneven, as by a texture [m²/s].
fn uneven(count: usize) -> Vec<f64> {
    let factor = |p: usize| DIFFUSIVITY * (1.2 + (p as f64).cos());
    (0..count).map(factor).collect()
}

fn springs_keep_heat(gates: &mut Gates) {
    let shell = sheet(14, 0.03);
    // Stretched unevenly.
    let x: Vec<_> = (shell.particles.iter())
        .map(|x| koiter::Vec3::new(x.x + 0.8 * x.x * x.x, x.y * (1.0 + 0.3 * x.x), x.z))
        .collect();
    let there = shell.springs.each_ref().map(|s| vec![true; s.len()]);
    let diffusivity = uneven(x.len());
    let mut conduction = Conduction::new(&shell);
    let mut kept = Kept::new(spotted(x.len()));
    for _ in 0..5 {
        let mut temperatures = kept.temperatures.clone();
        conduction.conduct(&x, &there, &diffusivity, 0.5, &mut temperatures);
        kept.step(temperatures, conduction.extents());
    }
    kept.tell(gates, "heat along springs");
}

fn triangles_keep_heat(gates: &mut Gates) {
    let mut surface = triangles(14);
    // Sheared, so that the mesh is none of Delaunay's.
    for x in &mut surface.positions {
        x.x += 2.5 * x.y;
    }
    let n = surface.positions.len();
    let (there, diffusivity) = (vec![true; n], uneven(n));
    let mut conduction = TriangleConduction::new(&surface);
    let mut kept = Kept::new(spotted(2 * n));
    for _ in 0..5 {
        let mut temperatures = kept.temperatures.clone();
        conduction.conduct(&there, &diffusivity, 3.0, 0.5, &mut temperatures);
        kept.step(temperatures, conduction.areas());
    }
    kept.tell(gates, "heat on triangles");
}

/// What conduction changes that it should not, relative and at worst.
struct Kept {
    temperatures: Vec<f64>,
    change_of_heat: f64,
    beyond_range: f64,
}

impl Kept {
    fn new(temperatures: Vec<f64>) -> Self {
        Self {
            temperatures,
            change_of_heat: 0.0,
            beyond_range: 0.0,
        }
    }

    fn step(&mut self, after: Vec<f64>, weights: &[f64]) {
        let heat = |t: &[f64]| -> f64 { weights.iter().zip(t).map(|(w, t)| w * t).sum() };
        let change = heat(&after) / heat(&self.temperatures) - 1.0;
        self.change_of_heat = self.change_of_heat.max(change.abs());
        let least = |t: &[f64]| t.iter().copied().fold(f64::INFINITY, f64::min);
        let most = |t: &[f64]| t.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let beyond = (most(&after) / most(&self.temperatures) - 1.0)
            .max(1.0 - least(&after) / least(&self.temperatures));
        self.beyond_range = self.beyond_range.max(beyond);
        self.temperatures = after;
    }

    fn tell(&self, gates: &mut Gates, case: &str) {
        let gate = Gate::Below(1e-10);
        gates.check(
            case,
            "change of the heat in a step, relative",
            "",
            self.change_of_heat,
            gate,
        );
        let figure = "temperatures beyond those before, relative";
        gates.check(case, figure, "", self.beyond_range, gate);
    }
}

/// A Gaussian spot: its variance grows by 2 α t along each axis, its peak falls as the inverse of the variance.
fn spreads(gates: &mut Gates, case: &str, x: &[koiter::Vec3], mut conduct: impl FnMut(&mut [f64])) {
    let spot = |x: &koiter::Vec3| (-(x.x * x.x + x.y * x.y) / (2.0 * WIDTH * WIDTH)).exp();
    let mut temperatures: Vec<f64> = x.iter().map(spot).collect();
    let variance = |t: &[f64]| -> f64 {
        let moments = x.iter().zip(t).map(|(x, t)| x.x * x.x * t);
        moments.sum::<f64>() / t.iter().sum::<f64>()
    };
    let before = variance(&temperatures);
    (0..STEPS).for_each(|_| conduct(&mut temperatures));
    let spread = variance(&temperatures) - before;
    let expected = 2.0 * DIFFUSIVITY * DT * STEPS as f64;
    gates.check(
        case,
        "spread of a spot, beside 2 α t",
        "",
        spread / expected,
        Gate::Near(1.0, 0.02),
    );
    let peak = temperatures.iter().copied().fold(0.0, f64::max);
    let kernel = WIDTH * WIDTH / (WIDTH * WIDTH + expected);
    gates.check(
        case,
        "its peak, beside the heat kernel",
        "",
        peak / kernel,
        Gate::Near(1.0, 0.02),
    );
}
