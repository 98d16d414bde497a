//! Figures of a burning shell.

use super::double_layer::Color;
use super::springs::vector;
use super::stepper::BurningShell;
use crate::Vec3;

/// What is told of a burning shell after a step.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct BurningMeasures {
    /// Mean of the mass ratios.
    pub mean_mass: f64,
    /// Area that is left, at rest, as a share of the initial one.
    pub kept_area: f64,
    /// Area that is left, as it is, as a share of the initial one.
    pub present_area: f64,
    /// Pieces that hang together.
    pub pieces: usize,
    /// Highest temperature of particles that are there [K].
    pub highest_temperature: f64,
    /// Mean of |strain| over the springs of the colour where it is largest.
    pub mean_strain: f64,
    /// The same of the blue springs, the layer that is seen.
    pub mean_blue_strain: f64,
    /// Root mean square angle between the normals of quads that are whole and share an edge [rad].
    pub fold_angle: f64,
}

impl BurningShell {
    /// Figures of the present state.
    pub fn measures(&self) -> BurningMeasures {
        let (shell, state) = (&self.setup.shell, &self.state);
        let there = state.temperatures.iter().zip(&self.remaining.particles);
        let temperatures = there.filter(|(_, is_there)| **is_there).map(|(t, _)| *t);
        BurningMeasures {
            mean_mass: state.mass_ratios.iter().sum::<f64>() / state.mass_ratios.len() as f64,
            kept_area: self.surface.area(shell, &shell.particles) / self.initial_area,
            present_area: self.surface.area(shell, &state.positions) / self.initial_area,
            pieces: self.remaining.num_pieces(shell),
            highest_temperature: temperatures.fold(0.0, f64::max),
            mean_strain: (0..4)
                .map(|color| self.mean_strain(color))
                .fold(0.0, f64::max),
            mean_blue_strain: self.mean_strain(Color::Blue as usize),
            fold_angle: self.fold_angle(),
        }
    }

    /// Mean of |strain| over the springs of a colour that are there.
    pub fn mean_strain(&self, color: usize) -> f64 {
        let springs = self.setup.shell.springs[color].ends.iter();
        let springs = springs
            .zip(&self.targets[color])
            .zip(&self.remaining.springs[color]);
        let (mut sum, mut count) = (0.0, 0);
        for ((&ends, target), _) in springs.filter(|(_, is_there)| **is_there) {
            sum += (vector(ends, &self.state.positions).norm() / target - 1.0).abs();
            count += 1;
        }
        sum / f64::from(count.max(1))
    }

    fn fold_angle(&self) -> f64 {
        let (shell, x) = (&self.setup.shell, &self.state.positions);
        let mut is_whole = vec![true; shell.mesh.quads().len()];
        let level = |particle: usize| self.setup.burning.level(self.state.mass_ratios[particle]);
        for (quad, corners) in shell.mesh.quads().iter().enumerate() {
            let corners = corners.map(|corner| corner as usize);
            let mut particles = corners.into_iter().chain([shell.lattice(quad)]);
            is_whole[quad] = particles.all(|particle| level(particle) >= 0.0);
        }
        let normal = |quad: u32| -> Vec3 {
            let [a, b, c, d] = shell.mesh.quads()[quad as usize].map(|v| x[v as usize]);
            (c - a).cross(&(d - b))
        };
        let (mut sum, mut count) = (0.0, 0);
        for edge in shell.mesh.edges() {
            if let [Some(a), Some(b)] = edge.sides
                && is_whole[a.quad as usize]
                && is_whole[b.quad as usize]
            {
                let (m, n) = (normal(a.quad), normal(b.quad));
                let angle = m.cross(&n).norm().atan2(m.dot(&n));
                sum += angle * angle;
                count += 1;
            }
        }
        (sum / f64::from(count.max(1))).sqrt()
    }
}
