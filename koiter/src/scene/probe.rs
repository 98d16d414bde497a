//! What a scene measures, a row a step.

use super::simulation::Simulation;
use super::spec::{Axis, ProbeQuantity};
use crate::Vec3;
use crate::geometry::rigid_misfit;

/// A checked probe.
#[derive(Clone, Debug)]
pub struct Probe {
    /// Name.
    pub name: String,
    /// Where its values come from.
    pub target: ProbeTarget,
    /// Only this component of a vector.
    pub axis: Option<Axis>,
}

/// Where the values of a probe come from.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub enum ProbeTarget {
    /// Positions or velocities of vertices.
    Vertices {
        /// What of them.
        quantity: ProbeQuantity,
        /// Index of the shell.
        shell: usize,
        /// Vertices.
        vertices: Vec<usize>,
        /// Their start positions [m].
        start: Vec<Vec3>,
    },
    /// An energy by name, or the sum [J].
    Energy(Option<String>),
    /// Total force of a constraint on its vertices [N], by its index.
    Reaction(usize),
    /// The factor on scheduled loads.
    LoadFactor,
}

/// The state a probe looks at.
pub trait Observable {
    /// Positions of a shell's vertices [m].
    fn positions(&self, shell: usize) -> Vec<Vec3>;
    /// Velocities of a shell's vertices [m/s].
    fn velocities(&self, shell: usize) -> Vec<Vec3>;
    /// Energies by name [J].
    fn energies(&self) -> Vec<(String, f64)>;
    /// Total force that a constraint exerts on its vertices [N].
    fn reaction(&self, constraint: usize) -> Vec3;
    /// The factor on scheduled loads; 0 without arc length.
    fn load_factor(&self) -> f64;
}

impl Observable for Simulation {
    fn positions(&self, shell: usize) -> Vec<Vec3> {
        self.shell_positions(shell)
    }

    fn velocities(&self, shell: usize) -> Vec<Vec3> {
        self.shell_velocities(shell)
    }

    fn energies(&self) -> Vec<(String, f64)> {
        self.energies()
    }

    fn reaction(&self, constraint: usize) -> Vec3 {
        self.reaction(constraint)
    }

    fn load_factor(&self) -> f64 {
        self.load_factor().unwrap_or(0.0)
    }
}

impl Probe {
    /// Headings of the probe's columns: its name, with `.x`, `.y`, `.z` for a vector.
    pub fn columns(&self) -> Vec<String> {
        if self.is_vector() && self.axis.is_none() {
            return ["x", "y", "z"]
                .map(|axis| format!("{}.{axis}", self.name))
                .to_vec();
        }
        vec![self.name.clone()]
    }

    /// Values of the probe's columns; an energy that the scene has not is 0.
    pub fn measure(&self, state: &dyn Observable) -> Vec<f64> {
        match &self.target {
            ProbeTarget::Vertices {
                quantity,
                shell,
                vertices,
                start,
            } => self.measure_vertices(*quantity, state, *shell, vertices, start),
            ProbeTarget::Energy(name) => vec![total_energy(&state.energies(), name.as_deref())],
            ProbeTarget::Reaction(constraint) => self.components(state.reaction(*constraint)),
            ProbeTarget::LoadFactor => vec![state.load_factor()],
        }
    }

    fn measure_vertices(
        &self,
        quantity: ProbeQuantity,
        state: &dyn Observable,
        shell: usize,
        vertices: &[usize],
        start: &[Vec3],
    ) -> Vec<f64> {
        let values = match quantity {
            ProbeQuantity::Velocity => state.velocities(shell),
            _ => state.positions(shell),
        };
        let heights = vertices.iter().map(|&vertex| values[vertex].z);
        match quantity {
            ProbeQuantity::Lowest => vec![heights.fold(f64::INFINITY, f64::min)],
            ProbeQuantity::Highest => vec![heights.fold(f64::NEG_INFINITY, f64::max)],
            ProbeQuantity::Distortion => {
                let now: Vec<Vec3> = vertices.iter().map(|&vertex| values[vertex]).collect();
                vec![rigid_misfit(start, &now)]
            }
            ProbeQuantity::Displacement => {
                let moved = vertices.iter().zip(start).map(|(&v, x)| values[v] - x);
                self.components(moved.sum::<Vec3>() / start.len() as f64)
            }
            _ => self.components(mean(&values, vertices)),
        }
    }

    fn is_vector(&self) -> bool {
        !matches!(
            self.target,
            ProbeTarget::Energy(_)
                | ProbeTarget::LoadFactor
                | ProbeTarget::Vertices {
                    quantity: ProbeQuantity::Lowest
                        | ProbeQuantity::Highest
                        | ProbeQuantity::Distortion,
                    ..
                }
        )
    }

    fn components(&self, vector: Vec3) -> Vec<f64> {
        match self.axis {
            Some(axis) => vec![vector[axis as usize]],
            None => vector.iter().copied().collect(),
        }
    }
}

/// Mean over some vertices.
fn mean(values: &[Vec3], vertices: &[usize]) -> Vec3 {
    let sum: Vec3 = vertices.iter().map(|&vertex| values[vertex]).sum();
    sum / vertices.len() as f64
}

fn total_energy(energies: &[(String, f64)], name: Option<&str>) -> f64 {
    match name {
        Some(name) => energies
            .iter()
            .find(|(energy, _)| *energy == name)
            .map_or(0.0, |(_, value)| *value),
        None => energies.iter().map(|(_, value)| value).sum(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    struct Pair;

    impl Observable for Pair {
        fn positions(&self, _: usize) -> Vec<Vec3> {
            vec![Vec3::new(0.0, 0.0, 1.0), Vec3::new(2.0, 0.0, 3.0)]
        }
        fn velocities(&self, _: usize) -> Vec<Vec3> {
            vec![Vec3::z(), Vec3::z()]
        }
        fn energies(&self) -> Vec<(String, f64)> {
            vec![("membrane".into(), 1.0), ("bending".into(), 0.5)]
        }
        fn reaction(&self, _: usize) -> Vec3 {
            2.0 * Vec3::x()
        }
        fn load_factor(&self) -> f64 {
            0.5
        }
    }

    fn vertices(quantity: ProbeQuantity, axis: Option<Axis>) -> Probe {
        // A unit apart; now 2√2.
        let start = vec![Vec3::new(1.0, -0.5, 0.0), Vec3::new(1.0, 0.5, 0.0)];
        let target = ProbeTarget::Vertices {
            quantity,
            shell: 0,
            vertices: vec![0, 1],
            start,
        };
        Probe {
            name: "p".into(),
            target,
            axis,
        }
    }

    #[test]
    fn values_belong_to_columns() {
        let cases = [
            (
                vertices(ProbeQuantity::Position, None),
                vec!["p.x", "p.y", "p.z"],
                vec![1.0, 0.0, 2.0],
            ),
            (
                vertices(ProbeQuantity::Displacement, Some(Axis::Z)),
                vec!["p"],
                vec![2.0],
            ),
            (
                vertices(ProbeQuantity::Velocity, Some(Axis::Z)),
                vec!["p"],
                vec![1.0],
            ),
            (vertices(ProbeQuantity::Lowest, None), vec!["p"], vec![1.0]),
            (vertices(ProbeQuantity::Highest, None), vec!["p"], vec![3.0]),
        ];
        let distortion = vertices(ProbeQuantity::Distortion, None).measure(&Pair);
        assert!((distortion[0] - (2f64.sqrt() - 0.5)).abs() < 1e-14);
        for (probe, columns, values) in cases {
            assert_eq!(probe.columns(), columns);
            assert_eq!(probe.measure(&Pair), values);
        }
        let energy = |name: Option<&str>| Probe {
            name: "e".into(),
            target: ProbeTarget::Energy(name.map(Into::into)),
            axis: None,
        };
        assert_eq!(energy(None).measure(&Pair), [1.5]);
        assert_eq!(energy(Some("bending")).measure(&Pair), [0.5]);
        assert_eq!(energy(Some("kinetic")).measure(&Pair), [0.0]);
        let reaction = Probe {
            name: "r".into(),
            target: ProbeTarget::Reaction(0),
            axis: None,
        };
        assert_eq!(reaction.measure(&Pair), [2.0, 0.0, 0.0]);
    }
}
