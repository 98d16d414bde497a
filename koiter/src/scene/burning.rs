//! Double layers in a scene: what they are made of, and their steps.
//!
//! A double layer is stepped by projections and has no energy, so [`Simulation`] steps it beside the elastic system, which is
//! then empty: a scene has shells or double layers. See `docs/decisions`.

use super::model::{Model, Motion, Obstacle, ObstacleShape};
use super::simulation::Simulation;
use crate::Vec3;
use crate::burning::{
    BurningMeasures, BurningReport, BurningSetup, BurningShell, BurningState, Collider,
    ColliderShape, HeatSource, Side, Surroundings,
};
use crate::integrate::{StepError, StepReport};

/// Velocities of bodies are differences over twice this time [s].
const DIFFERENCE: f64 = 1e-5;

/// A double layer of a model.
#[derive(Clone, Debug)]
pub struct DoubleLayerPart {
    /// Name, unique in the scene.
    pub name: String,
    /// What it is made of.
    pub setup: BurningSetup,
    /// Corner particles that are held.
    pub held: Vec<Held>,
}

/// Corner particles of a double layer whose motion is prescribed.
#[derive(Clone, Debug)]
pub struct Held {
    /// The particles.
    pub particles: Vec<u32>,
    /// Their motion from the start shape.
    pub motion: Motion,
    /// Until when [s].
    pub until: f64,
}

/// A source of heat of a model.
#[derive(Clone, Debug)]
pub struct HeatSourcePart {
    /// Name, unique in the scene.
    pub name: String,
    /// Centre [m] and radius [m] at time 0; `None`: everywhere.
    pub ball: Option<(Vec3, f64)>,
    /// Motion relative to time 0.
    pub motion: Motion,
    /// Temperature [K].
    pub temperature: f64,
    /// How fast particles take it on [1/s].
    pub rate: f64,
    /// Which layers it heats.
    pub side: Side,
    /// Factors on the rate, by particle of each double layer or by vertex of each burning shell; empty: 1.
    pub intensity: Vec<Vec<f64>>,
}

/// The double layers of a simulation.
#[derive(Default)]
pub(super) struct Burning {
    pub(super) shells: Vec<BurningShell>,
    surroundings: Surroundings,
}

impl Burning {
    pub(super) fn new(model: &Model) -> Result<Self, (String, crate::burning::BurningError)> {
        let make = |part: &DoubleLayerPart| {
            BurningShell::new(part.setup.clone()).map_err(|error| (part.name.clone(), error))
        };
        Ok(Self {
            shells: model
                .double_layers
                .iter()
                .map(make)
                .collect::<Result<_, _>>()?,
            surroundings: Surroundings::default(),
        })
    }

    pub(super) fn is_empty(&self) -> bool {
        self.shells.is_empty()
    }

    pub(super) fn states(&self) -> Vec<BurningState> {
        self.shells
            .iter()
            .map(|shell| shell.state().clone())
            .collect()
    }

    /// Takes up states, all or none.
    pub(super) fn restore(&mut self, states: &[BurningState]) -> Result<(), String> {
        if states.len() != self.shells.len() {
            let (given, needed) = (states.len(), self.shells.len());
            return Err(format!("it has {given} double layers for {needed}"));
        }
        let before = self.states();
        for (index, state) in states.iter().enumerate() {
            if let Err(reason) = self.shells[index].restore(state) {
                self.put_back(&before);
                return Err(reason);
            }
        }
        Ok(())
    }

    /// Takes up states of a moment ago.
    fn put_back(&mut self, states: &[BurningState]) {
        for (shell, state) in self.shells.iter_mut().zip(states) {
            shell.put_back(state);
        }
    }
}

impl Simulation {
    /// One step of all double layers.
    pub(super) fn step_double_layers(&mut self, dt: f64) -> Result<StepReport, StepError> {
        let (step, time) = (self.state.step + 1, self.state.time);
        let Self { model, burning, .. } = self;
        let before = burning.states();
        let mut total = BurningReport::default();
        for index in 0..burning.shells.len() {
            let mut surround = |time: f64, around: &mut Surroundings| {
                surround(model, index, time, around);
            };
            let shell = &mut burning.shells[index];
            match shell.step(time, dt, &mut surround, &mut burning.surroundings) {
                Ok(report) => total.add(&report),
                Err(error) => {
                    burning.put_back(&before);
                    return Err(StepError::NotFinite {
                        step,
                        energy: "double layer".to_owned(),
                        element: format!("{}: {error}", model.double_layers[index].name),
                    });
                }
            }
        }
        (self.state.step, self.state.time) = (step, time + dt);
        let [heat, mass_loss, motion] = total.seconds;
        Ok(StepReport {
            step,
            time: self.state.time,
            dt,
            newton_iterations: total.sweeps,
            converged: true,
            min_gap: f64::INFINITY,
            parts: 1,
            measures: {
                let mut measures = self.burning_measures();
                // A projection that stops at its number of sweeps is the method, not a failure of the step.
                measures.push(("burning_parts", total.parts as f64));
                measures.push(("unmet_parts", total.unmet as f64));
                measures.push(("held_back", total.held_back as f64));
                measures
            },
            seconds: vec![("heat", heat), ("mass_loss", mass_loss), ("motion", motion)],
            ..StepReport::default()
        })
    }

    /// Figures of the double layers: means over them, sums of pieces, the highest temperature.
    pub fn burning_measures(&self) -> Vec<(&'static str, f64)> {
        let all: Vec<BurningMeasures> = self
            .burning
            .shells
            .iter()
            .map(BurningShell::measures)
            .collect();
        let mean = |value: fn(&BurningMeasures) -> f64| {
            all.iter().map(value).sum::<f64>() / all.len().max(1) as f64
        };
        let largest =
            |value: fn(&BurningMeasures) -> f64| all.iter().map(value).fold(0.0, f64::max);
        vec![
            ("mean_mass_ratio", mean(|m| m.mean_mass)),
            ("kept_area", mean(|m| m.kept_area)),
            ("present_area", mean(|m| m.present_area)),
            ("pieces", all.iter().map(|m| m.pieces as f64).sum()),
            ("highest_temperature", largest(|m| m.highest_temperature)),
            ("mean_strain", largest(|m| m.mean_strain)),
            ("mean_blue_strain", largest(|m| m.mean_blue_strain)),
            ("fold_angle", largest(|m| m.fold_angle)),
        ]
    }

    /// The double layers.
    pub fn double_layers(&self) -> &[BurningShell] {
        &self.burning.shells
    }

    /// Temperature [K] and mass ratio at the faces of the double layers.
    pub(super) fn burning_fields(&self) -> [(&'static str, Vec<f32>); 2] {
        let of_faces = |value: fn(&BurningState) -> &[f64]| -> Vec<f32> {
            let shells = self.burning.shells.iter();
            shells
                .flat_map(|shell| at_faces(shell, value(shell.state())))
                .collect()
        };
        [
            ("temperature", of_faces(|state| &state.temperatures)),
            ("mass_ratio", of_faces(|state| &state.mass_ratios)),
        ]
    }
}

/// Mean of a value of particles over the corners of each face that is left.
fn at_faces(shell: &BurningShell, values: &[f64]) -> Vec<f32> {
    let surface = shell.surface();
    let at_vertices: Vec<f64> = surface
        .vertices
        .iter()
        .map(|vertex| vertex.mix(|node| values[node]))
        .collect();
    let mean = |face: &[u32; 3]| face.map(|v| at_vertices[v as usize]).iter().sum::<f64>() / 3.0;
    surface.faces.iter().map(|face| mean(face) as f32).collect()
}

/// What acts on a double layer at a time [s].
fn surround(model: &Model, index: usize, time: f64, around: &mut Surroundings) {
    let scale = model
        .gravity_scale
        .as_ref()
        .map_or(1.0, |scale| scale.at(time));
    around.gravity = model.gravity * scale;
    around.colliders.clear();
    around.colliders.extend(
        model
            .obstacles
            .iter()
            .filter_map(|obstacle| collider(obstacle, time)),
    );
    around.held.clear();
    let part = &model.double_layers[index];
    for held in part.held.iter().filter(|held| time <= held.until) {
        let places = held.particles.iter().map(|&particle| {
            let start = part.setup.shell.particles[particle as usize];
            (particle, held.motion.apply(start, time))
        });
        around.held.extend(places);
    }
    around.sources.clear();
    let sources = model.heat_sources.iter();
    (around.sources).extend(sources.map(|part| heat_source(part, index, time)));
}

/// A source at a time [s], as it acts on the double layer or the burning shell with this number.
pub(super) fn heat_source(part: &HeatSourcePart, index: usize, time: f64) -> HeatSource {
    HeatSource {
        ball: (part.ball).map(|(center, radius)| (part.motion.apply(center, time), radius)),
        temperature: part.temperature,
        rate: part.rate,
        intensity: part.intensity.get(index).cloned().unwrap_or_default(),
    }
}

/// An obstacle as what pushes particles out; `None` for shapes that a scene with double layers does not have.
fn collider(obstacle: &Obstacle, time: f64) -> Option<Collider> {
    let at = |x: Vec3, time: f64| obstacle.motion.apply(x, time);
    let (shape, anchor) = match &obstacle.shape {
        ObstacleShape::Plane { point, normal } => {
            let (foot, head) = (at(*point, time), at(point + normal, time));
            let normal = (head - foot).normalize();
            (
                ColliderShape::HalfSpace {
                    point: foot,
                    normal,
                },
                *point,
            )
        }
        ObstacleShape::Sphere { center, radius } => {
            let ball = ColliderShape::Ball {
                center: at(*center, time),
                radius: *radius,
            };
            (ball, *center)
        }
        _ => return None,
    };
    let velocity = at(anchor, time + DIFFERENCE) - at(anchor, time - DIFFERENCE);
    Some(Collider {
        shape,
        velocity: velocity / (2.0 * DIFFERENCE),
        friction: obstacle.friction.min(1.0),
    })
}
