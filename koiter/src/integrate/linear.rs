//! Small motions about a state: linear statics, natural frequencies, buckling loads.
//!
//! ```text
//! K u = f                    response to forces
//! K φ = ω² M φ               free vibrations
//! (K + λ K_g) φ = 0          buckling under λ times the loads,    K_g = σ(u) : ∂²ε
//! ```
//!
//! K is the exact Hessian of elastic energies and clamps [N/m], f minus the gradient of everything at the state [N], M the
//! lumped masses [kg] and rotational inertias [kg·m²]; prescribed unknowns are eliminated. K_g is the stiffness that the
//! membrane stresses of the linear response u to the loads lend, and that of pressure, which turns with the surface; that
//! u changes the shape is left out, as linear buckling theory does (docs/decisions/0009). Contact is left out. Reference: T. Belytschko, W. K. Liu, B. Moran, "Nonlinear Finite Elements" (2000), section 6.5.

use super::system::{Prescribed, System};
use crate::assembly::{ConfigurationSpace, Energy, HessianBuilder, PsdProjection, SymmetricMatrix};
use crate::solve::{
    EigenNotConverged, LinearSolver, SparseCholesky, largest_eigenpairs, nested_dissection,
};

/// Why there is no linear response, or no modes.
#[derive(Clone, Debug, thiserror::Error)]
#[non_exhaustive]
pub enum LinearError {
    /// Something can move without resistance, or the state is not stable.
    #[error(
        "the stiffness is not positive definite at {unknown}: a part is free to move without resistance, or the state \
         is not stable; hold it by constraints"
    )]
    NotHeld {
        /// The unknown, in the user's terms.
        unknown: String,
    },
    /// A stiffness or force is not a number.
    #[error("the stiffness is not finite at {unknown}")]
    NotFinite {
        /// The unknown, in the user's terms.
        unknown: String,
    },
    /// A stiffness that couples everything with everything.
    #[error(
        "energy '{energy}' is of a whole shell: it couples all unknowns, which linear statics, vibrations and buckling cannot \
         solve for; use energies of vertices, edges, hinges or faces"
    )]
    Dense {
        /// Name of the energy.
        energy: String,
    },
    /// The eigenvalues were not found.
    #[error(transparent)]
    Modes(#[from] EigenNotConverged),
}

/// A vibration about a state.
#[derive(Clone, Debug)]
pub struct VibrationMode {
    /// ω² [1/s²]; negative where the state is not stable, 0 for motions without resistance.
    pub omega_squared: f64,
    /// φ over the solved unknowns, φᵀ M φ = 1.
    pub shape: Vec<f64>,
}

impl VibrationMode {
    /// ω / 2π [Hz]; 0 where the state is not stable.
    pub fn frequency(&self) -> f64 {
        self.omega_squared.max(0.0).sqrt() / std::f64::consts::TAU
    }
}

/// A way to buckle.
#[derive(Clone, Debug)]
pub struct BucklingMode {
    /// λ: the loads times this make the tangent singular.
    pub load_factor: f64,
    /// φ over the solved unknowns, φᵀ K φ = 1.
    pub shape: Vec<f64>,
}

/// Shift of the frequencies over the smallest ratio of stiffness to mass on the diagonal: about the lowest ω² of a plate
/// of 30 × 30 cells, so that motions without resistance neither spoil the factor nor slow the iteration.
const SHIFT: f64 = 1e-6;

/// Factor of the next shift where the matrix is still indefinite, and the number of shifts.
const SHIFT_GROWTH: f64 = 10.0;
const MAX_SHIFTS: usize = 12;

/// |ω²| over the largest ratio of stiffness to mass that counts as zero: round-off leaves motions without resistance 1e-16
/// of it, and what is slower than this cannot be told from them.
const ROUND_OFF: f64 = 1e-14;

/// Factors on loads beyond this are those of stresses that are round-off.
const LARGEST_FACTOR: f64 = 1e9;

/// Second derivatives with prescribed unknowns eliminated, and their factor.
struct Factorized {
    matrix: SymmetricMatrix,
    factor: Box<dyn SparseCholesky>,
}

impl System {
    /// u over all unknowns, prescribed ones at their targets: K u = f for the others.
    ///
    /// # Errors
    /// [`LinearError::NotHeld`], [`LinearError::NotFinite`].
    pub fn linear_response(
        &mut self,
        q: &[f64],
        prescribed: &Prescribed,
    ) -> Result<Vec<f64>, LinearError> {
        self.check_sparse(q)?;
        let (matrix, gradient) = self.second_derivatives(q, Part::Elastic);
        let force = gradient.iter().map(|g| -g).collect();
        self.response_to(force, matrix, q, prescribed)
    }

    /// u as above for a force over all unknowns.
    fn response_to(
        &self,
        mut force: Vec<f64>,
        mut matrix: SymmetricMatrix,
        q: &[f64],
        prescribed: &Prescribed,
    ) -> Result<Vec<f64>, LinearError> {
        let solved = self.layout.num_solved_dofs();
        let mut u: Vec<f64> = (0..q.len())
            .map(|i| match i >= solved || prescribed.is_fixed[i] {
                true => prescribed.target[i] - q[i],
                false => 0.0,
            })
            .collect();
        force.truncate(solved);
        matrix.fix(&prescribed.is_fixed, &u[..solved], &mut force);
        self.factorized(matrix)?.factor.solve(&mut force);
        u[..solved].copy_from_slice(&force);
        Ok(u)
    }

    /// The `count` lowest vibrations about `q`, increasing; motions without resistance come first.
    ///
    /// # Errors
    /// See [`LinearError`].
    pub fn vibration_modes(
        &mut self,
        q: &[f64],
        is_fixed: &[bool],
        count: usize,
    ) -> Result<Vec<VibrationMode>, LinearError> {
        self.check_sparse(q)?;
        let mut tangent = self.second_derivatives(q, Part::Elastic).0;
        let loads = self.second_derivatives(q, Part::Loads).0;
        add(&mut tangent, 1.0, &loads);
        eliminate(&mut tangent, is_fixed, 1.0);
        let masses: Vec<f64> = (self.masses.iter().zip(is_fixed))
            .map(|(mass, fixed)| if *fixed { 0.0 } else { *mass })
            .collect();
        let (_, stiffest) = ratios(&tangent, &masses);
        let (mut shifted, shift) = self.shifted(tangent, &masses)?;
        let multiply =
            |x: &[f64]| -> Vec<f64> { x.iter().zip(&masses).map(|(x, m)| x * m).collect() };
        let (matrix, factor) = (&shifted.matrix, shifted.factor.as_mut());
        let pairs = largest_eigenpairs(matrix, factor, &multiply, count)?;
        let positive = pairs.into_iter().filter(|pair| pair.value > 0.0);
        Ok(positive
            .map(|pair| VibrationMode {
                omega_squared: match 1.0 / pair.value - shift {
                    square if square.abs() <= ROUND_OFF * stiffest => 0.0,
                    square => square,
                },
                // φᵀ (K + σ M) φ = 1 and M φ = θ (K + σ M) φ: the mass of φ is θ.
                shape: (pair.vector.iter())
                    .map(|x| x / pair.value.sqrt())
                    .collect(),
            })
            .collect())
    }

    /// The `count` lowest positive factors by which the loads buckle the structure that rests at `q`, increasing; fewer if
    /// there are no more.
    ///
    /// # Errors
    /// See [`LinearError`].
    pub fn buckling_modes(
        &mut self,
        q: &[f64],
        is_fixed: &[bool],
        count: usize,
    ) -> Result<Vec<BucklingMode>, LinearError> {
        self.check_sparse(q)?;
        let still = Prescribed {
            is_fixed: is_fixed.to_vec(),
            target: q.to_vec(),
        };
        let mut force = vec![0.0; q.len()];
        self.gravity.add_gradient(q, &mut force);
        self.loads.add_gradient(q, &mut force);
        force.iter_mut().for_each(|f| *f = -*f);
        if (force.iter().zip(is_fixed)).all(|(f, fixed)| *fixed || *f == 0.0) {
            return Ok(Vec::new());
        }
        let elastic = self.second_derivatives(q, Part::Elastic).0;
        let u = self.response_to(force, elastic, q, &still)?;
        let mut geometric = self.second_derivatives(q, Part::Loads).0;
        let solved = self.layout.num_solved_dofs();
        let mut builder = HessianBuilder {
            matrix: &mut geometric,
            layout: &self.layout,
            prescribed_step: &vec![0.0; q.len() - solved],
            coupling: &mut vec![0.0; solved],
        };
        for energy in &self.elastic {
            energy.add_stress_stiffness(q, &u, &mut builder);
        }
        eliminate(&mut geometric, is_fixed, 0.0);
        let mut stiffness = self.second_derivatives(q, Part::Elastic).0;
        eliminate(&mut stiffness, is_fixed, 1.0);
        let Factorized { matrix, mut factor } = self.factorized(stiffness)?;
        let multiply =
            |x: &[f64]| -> Vec<f64> { geometric.multiply(x).iter().map(|y| -y).collect() };
        let pairs = largest_eigenpairs(&matrix, factor.as_mut(), &multiply, count)?;
        let real = (pairs.into_iter()).filter(|pair| pair.value > 1.0 / LARGEST_FACTOR);
        Ok(real
            .map(|pair| BucklingMode {
                load_factor: 1.0 / pair.value,
                shape: pair.vector,
            })
            .collect())
    }

    /// Refuses energies whose second derivatives are not all in the matrix.
    fn check_sparse(&self, q: &[f64]) -> Result<(), LinearError> {
        let mut elastic = self.elastic.iter();
        match elastic.find(|energy| !energy.low_rank(q).is_empty()) {
            None => Ok(()),
            Some(energy) => Err(LinearError::Dense {
                energy: energy.name().into(),
            }),
        }
    }

    /// Exact second derivatives of the elastic energies, clamps and symmetry included.
    ///
    /// # Errors
    /// [`LinearError::Dense`].
    pub fn elastic_hessian(&mut self, q: &[f64]) -> Result<SymmetricMatrix, LinearError> {
        self.check_sparse(q)?;
        Ok(self.second_derivatives(q, Part::Elastic).0)
    }

    /// Exact second derivatives of a part of the energies, and the gradient of all.
    pub(super) fn second_derivatives(
        &mut self,
        q: &[f64],
        part: Part,
    ) -> (SymmetricMatrix, Vec<f64>) {
        let mut energies: Vec<&mut dyn Energy> = Vec::new();
        for energy in &mut self.elastic {
            energies.push(energy.as_mut());
        }
        energies.push(&mut self.clamps);
        energies.push(&mut self.symmetry);
        let elastic = energies.len();
        energies.extend(self.damping.energies());
        let damped = energies.len();
        energies.push(&mut self.gravity);
        energies.push(&mut self.loads);
        (self.workspace).update_pattern(&mut energies, &self.layout, q);
        let pattern = self.workspace.matrix().map(|matrix| matrix.pattern.clone());
        let mut matrix = SymmetricMatrix::zeros(pattern.expect("the pattern was updated"));
        let mut gradient = vec![0.0; q.len()];
        let solved = self.layout.num_solved_dofs();
        let (still, mut coupling) = (vec![0.0; q.len() - solved], vec![0.0; solved]);
        for (index, energy) in energies.iter().enumerate() {
            let is_wanted = match part {
                Part::Elastic => index < elastic,
                Part::Loads => index >= damped,
                Part::All => index < elastic || index >= damped,
                Part::Motion => true,
            };
            if is_wanted {
                let mut hessian = HessianBuilder {
                    matrix: &mut matrix,
                    layout: &self.layout,
                    prescribed_step: &still,
                    coupling: &mut coupling,
                };
                energy.add_derivatives(q, PsdProjection::Exact, &mut gradient, &mut hessian);
            } else if !(elastic..damped).contains(&index) {
                energy.add_gradient(q, &mut gradient);
            }
        }
        (matrix, gradient)
    }

    fn factorized(&self, matrix: SymmetricMatrix) -> Result<Factorized, LinearError> {
        let mut factor = LinearSolver::default().create();
        factor.analyze(&matrix.pattern, &nested_dissection(&matrix.pattern));
        match factor.factorize(&matrix) {
            Ok(()) => Ok(Factorized { matrix, factor }),
            Err(failure) => {
                let unknown = self.space.describe(failure.dof);
                Err(match matrix.values.iter().all(|value| value.is_finite()) {
                    true => LinearError::NotHeld { unknown },
                    false => LinearError::NotFinite { unknown },
                })
            }
        }
    }

    /// K + σ M with the smallest σ tried that makes it definite.
    fn shifted(
        &self,
        tangent: SymmetricMatrix,
        masses: &[f64],
    ) -> Result<(Factorized, f64), LinearError> {
        let pattern = tangent.pattern.clone();
        let (softest, _) = ratios(&tangent, masses);
        let mut shift = SHIFT * softest;
        let mut result = None;
        for _ in 0..MAX_SHIFTS {
            let mut matrix = tangent.clone();
            for (mass, &position) in masses.iter().zip(pattern.diagonal_positions()) {
                matrix.values[position as usize] += shift * mass;
            }
            match self.factorized(matrix) {
                Ok(factorized) => return Ok((factorized, shift)),
                Err(error) => result = Some(error),
            }
            shift *= SHIFT_GROWTH;
        }
        Err(result.expect("at least one shift is tried"))
    }
}

/// Which energies give second derivatives.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Part {
    /// Membranes, bending, clamps.
    Elastic,
    /// What pushes from outside.
    Loads,
    /// Both.
    All,
    /// Both, and damping as it acts.
    Motion,
}

fn add(sum: &mut SymmetricMatrix, factor: f64, matrix: &SymmetricMatrix) {
    for (value, entry) in sum.values.iter_mut().zip(&matrix.values) {
        *value += factor * entry;
    }
}

/// The smallest and the largest ratio of stiffness to mass on the diagonal [1/s²]; unknowns without mass are left out.
fn ratios(stiffness: &SymmetricMatrix, masses: &[f64]) -> (f64, f64) {
    (masses.iter().zip(stiffness.pattern.diagonal_positions()))
        .filter(|(mass, _)| **mass > 0.0)
        .map(|(mass, &position)| stiffness.values[position as usize].abs() / mass)
        .fold((f64::INFINITY, 0.0), |(low, high), ratio| {
            (low.min(ratio), high.max(ratio))
        })
}

/// Takes the rows and columns of prescribed unknowns out and leaves `diagonal` there.
fn eliminate(matrix: &mut SymmetricMatrix, is_fixed: &[bool], diagonal: f64) {
    let still = vec![0.0; is_fixed.len()];
    matrix.fix(is_fixed, &still, &mut still.clone());
    let pattern = matrix.pattern.clone();
    for (&position, fixed) in pattern.diagonal_positions().iter().zip(is_fixed) {
        if *fixed {
            matrix.values[position as usize] = diagonal;
        }
    }
}
