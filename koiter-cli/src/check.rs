//! `koiter check`: reads everything, runs nothing.

mod bezier;
mod result;

use bezier::BezierReport;
pub(crate) use result::bodies;

use crate::output::say;
use koiter::scene::model::{
    DoubleLayerPart, ElementKind, IntegratorKind, Load, Model, Shell, TextEnergy,
};
use koiter::scene::{LoadTotal, Scene, readable_bytes};
use serde::Serialize;

use crate::arguments::{CheckArguments, SceneArguments};
use crate::failure::Failure;
use crate::run::start;
use crate::scene_source::load;

/// What a scene is.
#[derive(Serialize)]
struct Report {
    title: String,
    vertices: usize,
    faces: usize,
    dofs: usize,
    hessian_nonzeros: usize,
    estimated_memory_bytes: u64,
    energies: Vec<String>,
    steps: usize,
    /// Of the first step.
    dt: f64,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    phases: Vec<PhaseReport>,
    shells: Vec<ShellReport>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    double_layers: Vec<DoubleLayerReport>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    bezier_shells: Vec<BezierReport>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    procedures: Vec<String>,
    obstacles: Vec<String>,
    constraints: usize,
    loads: Vec<LoadReport>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    expressions: Vec<ExpressionReport>,
    processes: Vec<ProcessReport>,
    probes: Vec<String>,
    warnings: Vec<String>,
}

#[derive(Serialize)]
struct PhaseReport {
    name: String,
    integrator: IntegratorKind,
    start: f64,
    steps: usize,
    dt: f64,
}

#[derive(Serialize)]
struct ShellReport {
    name: String,
    vertices: usize,
    faces: usize,
    material: &'static str,
    area: f64,
    mass: f64,
    mean_edge: f64,
    shortest_edge: f64,
    min_angle_degrees: f64,
    boundary_loops: Vec<usize>,
}

#[derive(Serialize)]
struct DoubleLayerReport {
    name: String,
    quads: usize,
    particles: usize,
    springs: usize,
    thickness: f64,
    mass: f64,
    held: usize,
}

impl DoubleLayerReport {
    fn new(part: &DoubleLayerPart) -> Self {
        let shell = &part.setup.shell;
        Self {
            name: part.name.clone(),
            quads: shell.mesh.quads().len(),
            particles: shell.particles.len(),
            springs: shell.num_springs(),
            thickness: shell.thickness,
            mass: shell.masses(part.setup.area_density).iter().sum(),
            held: part.held.iter().map(|held| held.particles.len()).sum(),
        }
    }
}

/// What changes a rest shape.
#[derive(Serialize)]
struct ProcessReport {
    name: String,
    shell: String,
    what: String,
}

/// An energy that the scene writes.
#[derive(Serialize)]
struct ExpressionReport {
    name: String,
    shell: String,
    on: ElementKind,
    /// What its value is: an energy or a dissipation, of an element or by rest area or length.
    is_dissipation: bool,
    is_density: bool,
    text: String,
    #[serde(skip)]
    words: String,
}

impl ExpressionReport {
    fn new(model: &Model, energy: &TextEnergy) -> Self {
        let value = energy.value;
        let what = match value.is_dissipation {
            true => "a dissipation",
            false => "an energy",
        };
        let by = match value.is_density {
            true => format!(" by {}", energy.on.measure()),
            false => String::new(),
        };
        Self {
            name: energy.name.clone(),
            shell: model.shells[energy.shell].name.clone(),
            on: energy.on,
            is_dissipation: value.is_dissipation,
            is_density: value.is_density,
            text: energy.text.trim().to_owned(),
            words: match energy.on {
                ElementKind::Shell => format!("{what} of the whole shell"),
                on => format!("{what}{by} of its {}", on.plural()),
            },
        }
    }
}

/// A load at a factor of 1; of its totals the one that it has.
#[derive(Default, Serialize)]
struct LoadReport {
    name: String,
    shell: String,
    #[serde(skip_serializing_if = "Option::is_none")]
    total_force: Option<[f64; 3]>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pressure: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    total_moment: Option<f64>,
    #[serde(skip)]
    words: String,
}

impl LoadReport {
    fn new(model: &Model, load: &Load) -> Self {
        let total = model.load_total(load);
        let mut report = Self {
            name: load.name.clone(),
            shell: model.observed_shell(load.shell).name.clone(),
            words: total.to_string(),
            ..Self::default()
        };
        match total {
            LoadTotal::Force(force) => report.total_force = Some(force.into()),
            LoadTotal::Pressure(pressure) => report.pressure = Some(pressure),
            LoadTotal::Moment(moment) => report.total_moment = Some(moment),
            _ => {}
        }
        report
    }
}

/// Checks a scene or a result.
pub(crate) fn check(arguments: &CheckArguments) -> Result<(), Failure> {
    match (&arguments.scene, &arguments.result) {
        (Some(scene), _) => check_scene(scene, arguments),
        (None, Some(result)) => result::check(result, arguments.json),
        (None, None) => Err(Failure::input(
            "name a scene, or a result with --result DIR",
        )),
    }
}

fn check_scene(scene: &SceneArguments, arguments: &CheckArguments) -> Result<(), Failure> {
    let loaded = load(scene)?;
    let scene = loaded.scene;
    let shells = scene.model.shells.iter().map(|shell| {
        let surface = &shell.surface;
        ShellReport {
            name: shell.name.clone(),
            vertices: surface.mesh.num_vertices(),
            faces: surface.mesh.num_faces(),
            material: shell.composition.law.model().info().name,
            area: surface.area(),
            mass: mass(shell),
            mean_edge: surface.mean_edge_length(),
            shortest_edge: surface.shortest_edge_length(),
            min_angle_degrees: surface.min_angle().to_degrees(),
            boundary_loops: surface.mesh.boundary_loops().iter().map(Vec::len).collect(),
        }
    });
    let shells: Vec<ShellReport> = shells.collect();
    let double_layers = scene.model.double_layers.iter();
    let double_layers = double_layers.map(DoubleLayerReport::new).collect();
    let obstacles = scene
        .model
        .obstacles
        .iter()
        .map(|obstacle| obstacle.name.clone())
        .collect();
    let held = scene
        .model
        .double_layers
        .iter()
        .map(|layer| layer.held.len());
    let bezier = scene.model.bezier.as_ref();
    let of_bezier = bezier.map_or(0, |bezier| bezier.constraints.len());
    let constraints = scene.model.constraints.len() + held.sum::<usize>() + of_bezier;
    let bezier_shells = bezier.iter().flat_map(|model| {
        let parts = model.parts.iter();
        parts.map(|part| BezierReport::new(model, part))
    });
    let bezier_shells = bezier_shells.collect();
    let procedures = bezier.iter().flat_map(|bezier| &bezier.procedures);
    let procedures = procedures.map(|p| format!("{} at {} s", p.name, p.at));
    let procedures = procedures.collect();
    let loads = bezier.map_or(&scene.model.loads, |bezier| &bezier.loads);
    let loads = loads.iter();
    let loads = loads.map(|load| LoadReport::new(&scene.model, load));
    let loads = loads.collect();
    let expressions = scene.model.energies.iter();
    let expressions = expressions.map(|energy| ExpressionReport::new(&scene.model, energy));
    let expressions = expressions.collect();
    let processes = scene.model.processes.iter();
    let processes = processes.map(|process| ProcessReport {
        name: process.name.clone(),
        shell: scene.model.shells[process.shell].name.clone(),
        what: process.kind.to_string(),
    });
    let processes = processes.collect();
    let stats = start(&scene.model, arguments.debug_mesh.as_deref())?.stats();
    let phases = phases(&scene);
    let report = Report {
        title: scene.title,
        vertices: stats.vertices,
        faces: stats.faces,
        dofs: stats.dofs,
        hessian_nonzeros: stats.hessian_nonzeros,
        estimated_memory_bytes: stats.estimated_memory_bytes as u64,
        energies: stats.energies,
        steps: scene.timeline.num_steps(),
        dt: scene.timeline.dt(1),
        phases,
        shells,
        double_layers,
        bezier_shells,
        procedures,
        obstacles,
        constraints,
        loads,
        expressions,
        processes,
        probes: scene.probes.into_iter().map(|probe| probe.name).collect(),
        warnings: scene
            .warnings
            .into_iter()
            .map(|warning| warning.message)
            .collect(),
    };
    if arguments.json {
        say!("{}", serde_json::to_string(&report).map_err(Failure::run)?);
    } else {
        report.print();
    }
    Ok(())
}

/// The phases of a scene that names some.
fn phases(scene: &Scene) -> Vec<PhaseReport> {
    let phases = scene.model.phases.iter().zip(scene.timeline.phases());
    phases
        .map(|(phase, steps)| PhaseReport {
            name: phase.name.clone(),
            integrator: phase.integrator,
            start: steps.start,
            steps: steps.steps,
            dt: steps.dt,
        })
        .collect()
}

/// Of a shell at its start shape [kg].
fn mass(shell: &Shell) -> f64 {
    let face_mass = |face: usize| {
        let [a, b, c] = shell.surface.corners(face);
        let area = 0.5 * (b - a).cross(&(c - a)).norm();
        area * shell.face_thickness(face) * shell.face_density(face)
    };
    (0..shell.surface.mesh.num_faces()).map(face_mass).sum()
}

impl Report {
    fn print(&self) {
        if !self.title.is_empty() {
            say!("{}", self.title);
        }
        for shell in &self.shells {
            say!(
                "shell {}: {}, {} vertices, {} triangles, {} m², {} kg, edges {:.2e} m (shortest {:.2e} m), \
                 smallest angle {:.1}°, boundary loops of {:?} vertices",
                shell.name,
                shell.material,
                shell.vertices,
                shell.faces,
                decimal(shell.area),
                decimal(shell.mass),
                shell.mean_edge,
                shell.shortest_edge,
                shell.min_angle_degrees,
                shell.boundary_loops
            );
        }
        for layer in &self.double_layers {
            say!(
                "double layer {}: {} quads, {} particles, {} springs, layers {:.2e} m apart, {} kg, {} corners held",
                layer.name,
                layer.quads,
                layer.particles,
                layer.springs,
                layer.thickness,
                decimal(layer.mass),
                layer.held
            );
        }
        self.bezier_shells.iter().for_each(BezierReport::print);
        if !self.procedures.is_empty() {
            say!("procedures: {}", self.procedures.join(", "));
        }
        if !self.obstacles.is_empty() {
            say!("obstacles: {}", self.obstacles.join(", "));
        }
        say!("constraints: {}", self.constraints);
        for load in &self.loads {
            say!(
                "load {}: on shell {}, {}",
                load.name,
                load.shell,
                load.words
            );
        }
        for energy in &self.expressions {
            say!(
                "energy {}: {}, shell {}",
                energy.name,
                energy.words,
                energy.shell
            );
        }
        for process in &self.processes {
            say!(
                "process {}: shell {} {}",
                process.name,
                process.shell,
                process.what
            );
        }
        if !self.energies.is_empty() {
            say!("energies: {}", self.energies.join(", "));
        }
        say!(
            "in all {} vertices, {} triangles, {} degrees of freedom, {} Hessian entries, about {}",
            self.vertices,
            self.faces,
            self.dofs,
            self.hessian_nonzeros,
            readable_bytes(self.estimated_memory_bytes as f64)
        );
        for phase in &self.phases {
            let PhaseReport {
                name,
                start,
                steps,
                dt,
                ..
            } = phase;
            say!("phase {name}: from {start} s, {steps} steps of {dt} s");
        }
        match self.phases.is_empty() {
            true => say!("{} steps of {} s", self.steps, self.dt),
            false => say!("{} steps", self.steps),
        }
        say!("the scene is sound");
    }
}

/// With four decimals, unless that would be digits that nobody reads.
fn decimal(number: f64) -> String {
    match number < 1e6 {
        true => format!("{number:.4}"),
        false => format!("{number:.3e}"),
    }
}
