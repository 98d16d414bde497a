//! A shell of triangles that burns: temperatures and masses of its two layers, what is left of it, and how far it shrinks.
//!
//! Each vertex has a temperature and a mass ratio υ in each of two layers, the lower and the upper half of the thickness. They
//! are heated, conduct and lose mass as the particles of a double layer do; what they do to the shape is left to the elastic
//! shell: length factors of the layers, `L = υᵖ`, mean over the corners of a face, move its rest forms
//! ([`crate::process::Shrinkage`]).
//!
//! A vertex has burnt where the mean mass ratio of its layers is below the loss level. A face leaves once all its corners have
//! burnt, or once it is torn; what is shown is cut where the mass ratio passes through the level ([`RenderSurface`]).
//!
//! **Tearing.** A face tears where its largest principal stress exceeds the strength times its mean mass ratio, by a larger
//! factor than that of the neighbours across its edges: so a crack grows by a face a step at each of its tips and is as wide as
//! the faces are. No vertex is split.

use super::error::BurningError;
use super::heat::{HeatSource, cool, heat};
use super::mass::BurningOptions;
use super::numbers::{not_negative, positive};
use super::surface::RenderSurface;
use super::triangle_conduction::TriangleConduction;
use crate::Vec3;
use crate::mesh::{FaceId, Surface};

/// Most parts in which heat and mass loss of a step are taken; what would burn faster burns later.
const MAX_PARTS: usize = 50;

/// What a heated shell is made of.
#[derive(Clone, Debug)]
pub struct HeatedSetup {
    /// Rest shape.
    pub rest: Surface,
    /// Thickness [m].
    pub thickness: f64,
    /// Temperature at the start [K].
    pub temperature: f64,
    /// Temperature around [K].
    pub ambient_temperature: f64,
    /// Rate of cooling towards it [1/s].
    pub cooling_rate: f64,
    /// Thermal diffusivity [m²/s].
    pub diffusivity: f64,
    /// Factors on the diffusivity by vertex; empty: 1.
    pub diffusivity_factors: Vec<f64>,
    /// Rate at which the layers take on each other's temperature [1/s]; `None`: `π² α / (2 h²)`, at which a difference of the
    /// two faces of a slab dies down.
    pub exchange_rate: Option<f64>,
    /// How it burns.
    pub burning: BurningOptions,
    /// Factors on the rate of mass loss by vertex; empty: 1.
    pub loss_factors: Vec<f64>,
    /// Tensile strength [Pa]; infinite: it does not tear.
    pub strength: f64,
}

impl HeatedSetup {
    /// Checks the numbers.
    ///
    /// # Errors
    /// A number out of its range, by the name that scenes give it.
    pub fn check(&self) -> Result<(), BurningError> {
        positive("thickness", self.thickness)?;
        not_negative("temperature", self.temperature)?;
        not_negative("ambient_temperature", self.ambient_temperature)?;
        not_negative("cooling_rate", self.cooling_rate)?;
        not_negative("diffusivity", self.diffusivity)?;
        not_negative("exchange_rate", self.exchange_rate.unwrap_or(0.0))?;
        if self.strength != f64::INFINITY {
            positive("strength", self.strength)?;
        }
        self.burning.check()
    }

    fn exchange(&self) -> f64 {
        let of_slab = 0.5 * std::f64::consts::PI.powi(2) * self.diffusivity;
        (self.exchange_rate).unwrap_or(of_slab / (self.thickness * self.thickness))
    }
}

/// What a heated shell owes to its past.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct HeatedState {
    /// Temperatures by vertex, of the bottom layer, then of the top layer, where normals point [K].
    pub temperatures: Vec<f64>,
    /// Masses over initial masses, in the same order.
    pub mass_ratios: Vec<f64>,
    /// Faces that have torn, in ascending order.
    pub torn: Vec<u32>,
}

/// Figures of a heated shell.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct HeatedMeasures {
    /// Mean of the mass ratios over the area.
    pub mean_mass: f64,
    /// Area that is left, at rest, as a share of the initial one.
    pub kept_area: f64,
    /// Area that is left, as it is, as a share of the initial one.
    pub present_area: f64,
    /// Pieces of faces that share vertices.
    pub pieces: usize,
    /// Highest temperature of what has not burnt [K].
    pub highest_temperature: f64,
    /// Faces that have torn.
    pub torn: usize,
}

/// A shell of triangles that burns.
pub struct HeatedShell {
    setup: HeatedSetup,
    state: HeatedState,
    diffusivity: Vec<f64>,
    loss_factors: Vec<f64>,
    conduction: TriangleConduction,
    surface: RenderSurface,
    is_face_there: Vec<bool>,
    is_vertex_there: Vec<bool>,
    initial_area: f64,
}

impl HeatedShell {
    /// A shell at one temperature, whole.
    ///
    /// # Errors
    /// A number out of its range.
    pub fn new(setup: HeatedSetup) -> Result<Self, BurningError> {
        setup.check()?;
        let (n, num_faces) = (setup.rest.positions.len(), setup.rest.mesh.num_faces());
        let factor = |list: &[f64], v: usize| list.get(v % n).copied().unwrap_or(1.0);
        let diffusivity = |v| setup.diffusivity * factor(&setup.diffusivity_factors, v);
        let loss_factors = (0..2 * n).map(|i| factor(&setup.loss_factors, i)).collect();
        let mut made = Self {
            state: HeatedState {
                temperatures: vec![setup.temperature; 2 * n],
                mass_ratios: vec![1.0; 2 * n],
                torn: Vec::new(),
            },
            diffusivity: (0..n).map(diffusivity).collect(),
            loss_factors,
            conduction: TriangleConduction::new(&setup.rest),
            surface: RenderSurface::of_mesh(&setup.rest.mesh),
            is_face_there: vec![true; num_faces],
            is_vertex_there: vec![true; n],
            initial_area: setup.rest.area(),
            setup,
        };
        made.cut();
        Ok(made)
    }

    /// Heats and burns for `dt` [s] from `time` [s] at held `positions` [m]; `surround` writes the sources that act on the bottom
    /// and on the top at a time. Returns the parts it took.
    ///
    /// # Errors
    /// A temperature that is not finite; the state is then not to be used.
    pub fn burn(
        &mut self,
        positions: &[Vec3],
        [time, dt]: [f64; 2],
        surround: &mut dyn FnMut(f64, &mut [Vec<HeatSource>; 2]),
    ) -> Result<usize, BurningError> {
        let n = positions.len();
        let (setup, state) = (&self.setup, &mut self.state);
        let burning = &setup.burning;
        let fastest = burning.fastest(&state.temperatures, &self.loss_factors, &state.mass_ratios);
        let parts = (fastest * dt / burning.largest_change).ceil();
        let parts = (parts as usize).clamp(1, MAX_PARTS);
        let part_dt = dt / parts as f64;
        let mut sources = [Vec::new(), Vec::new()];
        for part in 1..=parts {
            surround(time + dt * part as f64 / parts as f64, &mut sources);
            for (layer, sources) in state.temperatures.chunks_exact_mut(n).zip(&sources) {
                heat(sources, positions, part_dt, layer);
                cool(
                    setup.ambient_temperature,
                    setup.cooling_rate,
                    part_dt,
                    layer,
                );
            }
            self.conduction.conduct(
                &self.is_vertex_there,
                &self.diffusivity,
                setup.exchange(),
                part_dt,
                &mut state.temperatures,
            );
            burning.burn(
                part_dt,
                &self.loss_factors,
                &mut state.temperatures,
                &mut state.mass_ratios,
            );
        }
        if let Some(place) = state.temperatures.iter().position(|t| !t.is_finite()) {
            return Err(BurningError::NotFinite {
                particle: place % n,
                time: time + dt,
            });
        }
        self.cut();
        Ok(parts)
    }

    /// Tears faces by their largest principal stresses [Pa]; returns how many.
    pub fn tear(&mut self, stresses: &[f64]) -> usize {
        let excess = |face: usize| match self.is_face_there[face] {
            true => stresses[face] / (self.setup.strength * self.face_mass_ratio(face)),
            false => 0.0,
        };
        let mesh = &self.setup.rest.mesh;
        let across = |face: usize| {
            let edges = mesh.face_edges()[face].iter();
            let sides = edges.flat_map(|edge| mesh.edge_faces()[edge.0 as usize]);
            sides.flatten().map(|FaceId(face)| face as usize)
        };
        let tears = |&face: &usize| {
            let own = excess(face);
            own > 1.0 && across(face).all(|other| excess(other) <= own)
        };
        let torn: Vec<usize> = (0..self.is_face_there.len()).filter(tears).collect();
        self.state.torn.extend(torn.iter().map(|&face| face as u32));
        self.state.torn.sort_unstable();
        if !torn.is_empty() {
            self.cut();
        }
        torn.len()
    }

    /// What is there by the state.
    fn cut(&mut self) {
        let n = self.is_vertex_there.len();
        let ratios = &self.state.mass_ratios;
        let level = |v: usize| self.setup.burning.level(0.5 * (ratios[v] + ratios[n + v]));
        for (v, is_there) in self.is_vertex_there.iter_mut().enumerate() {
            *is_there = level(v) >= 0.0;
        }
        let faces = self.setup.rest.mesh.faces().iter();
        for (is_there, corners) in self.is_face_there.iter_mut().zip(faces) {
            *is_there = corners.iter().any(|&v| self.is_vertex_there[v as usize]);
        }
        for &face in &self.state.torn {
            self.is_face_there[face as usize] = false;
        }
        let is_there = |face: usize| self.is_face_there[face];
        self.surface.rebuild_of(is_there, level);
    }

    fn face_mass_ratio(&self, face: usize) -> f64 {
        let corners = self.setup.rest.mesh.faces()[face];
        corners
            .iter()
            .map(|&v| self.mass_ratio(v as usize))
            .sum::<f64>()
            / 3.0
    }

    /// Mean mass ratio of the layers at a vertex.
    pub fn mass_ratio(&self, vertex: usize) -> f64 {
        let ratios = &self.state.mass_ratios;
        0.5 * (ratios[vertex] + ratios[self.is_vertex_there.len() + vertex])
    }

    /// Mean temperature of the layers at a vertex [K].
    pub fn temperature(&self, vertex: usize) -> f64 {
        let temperatures = &self.state.temperatures;
        0.5 * (temperatures[vertex] + temperatures[self.is_vertex_there.len() + vertex])
    }

    /// Length factors of the bottom and the top layer of every face.
    pub fn length_factors(&self) -> Vec<[f64; 2]> {
        let n = self.is_vertex_there.len();
        let ratios = &self.state.mass_ratios;
        let of_layer = |corners: &[u32; 3], first: usize| {
            let sum: f64 = corners.iter().map(|&v| ratios[first + v as usize]).sum();
            self.setup.burning.length_factor(sum / 3.0)
        };
        let faces = self.setup.rest.mesh.faces().iter();
        faces
            .map(|corners| [0, n].map(|first| of_layer(corners, first)))
            .collect()
    }

    /// Whether each face is there.
    pub fn faces_there(&self) -> &[bool] {
        &self.is_face_there
    }

    /// The surface that is left.
    pub fn surface(&self) -> &RenderSurface {
        &self.surface
    }

    /// What the shell is made of.
    pub fn setup(&self) -> &HeatedSetup {
        &self.setup
    }

    /// The state.
    pub fn state(&self) -> &HeatedState {
        &self.state
    }

    /// Figures at positions [m].
    pub fn measures(&self, positions: &[Vec3]) -> HeatedMeasures {
        let n = self.is_vertex_there.len();
        let areas = &self.conduction.areas()[..n];
        let masses = areas
            .iter()
            .enumerate()
            .map(|(v, area)| area * self.mass_ratio(v));
        let there = (0..2 * n).filter(|i| self.is_vertex_there[i % n]);
        let temperatures = there.map(|i| self.state.temperatures[i]);
        let rest = &self.setup.rest.positions;
        HeatedMeasures {
            mean_mass: masses.sum::<f64>() / areas.iter().sum::<f64>(),
            kept_area: self.surface.area_by(|v| rest[v]) / self.initial_area,
            present_area: self.surface.area_by(|v| positions[v]) / self.initial_area,
            pieces: self.num_pieces(),
            highest_temperature: temperatures.fold(0.0, f64::max),
            torn: self.state.torn.len(),
        }
    }

    fn num_pieces(&self) -> usize {
        let mut root: Vec<usize> = (0..self.is_vertex_there.len()).collect();
        fn find(root: &mut [usize], mut v: usize) -> usize {
            while root[v] != v {
                root[v] = root[root[v]];
                v = root[v];
            }
            v
        }
        let mut is_used = vec![false; root.len()];
        let faces = self.setup.rest.mesh.faces().iter().zip(&self.is_face_there);
        for (face, _) in faces.filter(|(_, is_there)| **is_there) {
            let [a, b, c] = face.map(|v| find(&mut root, v as usize));
            is_used[face[0] as usize] = true;
            let first = a.min(b).min(c);
            for v in [a, b, c] {
                root[v] = first;
            }
        }
        let used = (0..root.len()).filter(|&v| is_used[v]);
        let mut roots: Vec<usize> = used.collect();
        roots.iter_mut().for_each(|v| *v = find(&mut root, *v));
        roots.sort_unstable();
        roots.dedup();
        roots.len()
    }

    /// Takes up a state that a shell of the same setup had.
    ///
    /// # Errors
    /// Lists of other lengths, or values that no shell has; the shell is then as it was.
    pub fn restore(&mut self, state: &HeatedState) -> Result<(), String> {
        let n = self.is_vertex_there.len();
        let lengths = [state.temperatures.len(), state.mass_ratios.len()];
        let is_ratio = |ratio: &f64| *ratio > 0.0 && *ratio <= 1.0;
        let num_faces = self.is_face_there.len() as u32;
        match () {
            () if lengths != [2 * n; 2] => Err(format!(
                "a burning shell of {n} vertices has values of {lengths:?}"
            )),
            () if !state.temperatures.iter().all(|t| t.is_finite()) => {
                Err("a temperature of a burning shell is not finite".to_owned())
            }
            () if !state.mass_ratios.iter().all(is_ratio) => {
                Err("a mass of a burning shell is not between 0 and its initial mass".to_owned())
            }
            () if !state.torn.is_sorted() || state.torn.iter().any(|&face| face >= num_faces) => {
                Err("a burning shell has torn at faces that it does not have".to_owned())
            }
            () => {
                self.put_back(state);
                Ok(())
            }
        }
    }

    /// Takes up a state that this shell had.
    pub(crate) fn put_back(&mut self, state: &HeatedState) {
        self.state.clone_from(state);
        self.cut();
    }
}

#[cfg(test)]
mod tests;
