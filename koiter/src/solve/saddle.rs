//! Leaving saddles: a stationary point is a minimum only if no direction has negative curvature.
//!
//! Newton's method is attracted by every stationary point. A plate that buckles, or a director on a sharp crease, is left
//! standing at the symmetric state, which is a saddle there. [`leave_saddle`] looks at the exact Hessian H: where it is
//! not positive definite, inverse iteration with `(H + S)⁻¹ S`, S the smallest multiple of the diagonal that makes
//! `H + S` definite, turns any vector towards the direction v of most negative curvature, and the point is moved along v
//! as long as the energy falls.

use nalgebra::DMatrix;

use super::newton::{NewtonReport, Problem, SolveError, not_finite};
use super::workspace::{LinearWorkspace, mean_size};
use crate::assembly::{HessianBuilder, NodeId, PsdProjection};

/// Inverse iterations before the curvature counts as zero up to round-off. Each turns the vector towards v by the ratio
/// of shifted eigenvalues, which is large, for the shift is hardly more than enough.
const MAX_TURNS: usize = 60;

/// Curvature of a node that counts as none, relative to the mean. Left one after the other, nodes of such a curvature
/// topple like dominoes, one an iteration.
const HARDLY_ANY: f64 = 0.1;

/// Doublings of the way along v: from 10 tolerances to far beyond any scene.
const MAX_DOUBLINGS: usize = 50;

/// Moves `q` off a saddle of the sum of energies; whether it was one. The first way along the direction of negative
/// curvature has the length `tolerance` [m] times 10.
///
/// # Errors
/// [`SolveError::NotFinite`].
pub fn leave_saddle(
    problem: &mut Problem<'_>,
    workspace: &mut LinearWorkspace,
    tolerance: f64,
    q: &mut [f64],
    report: &mut NewtonReport,
) -> Result<bool, SolveError> {
    let start = std::time::Instant::now();
    for energy in &mut problem.energies {
        energy.begin_iteration(q);
    }
    workspace.update_pattern(&mut problem.energies, problem.layout, q);
    let gradient = assemble_exact(problem, workspace, q)?;
    let direction = negative_direction(problem, workspace, &gradient);
    report.spend("stability", start);
    Ok(direction.is_some_and(|direction| descend(problem, tolerance, &direction, q)))
}

/// Moves every node whose own block of the exact Hessian has negative curvature, or nearly none, off along it, by `way`
/// and to either side at random (always the same way); whether there was one.
///
/// Where many nodes stand on saddles of their own, as the directors along a crease do, [`leave_saddle`] would leave them
/// one after the other.
///
/// # Errors
/// [`SolveError::NotFinite`].
pub fn leave_saddles_by_node(
    problem: &mut Problem<'_>,
    workspace: &mut LinearWorkspace,
    way: f64,
    q: &mut [f64],
) -> Result<bool, SolveError> {
    for energy in &mut problem.energies {
        energy.begin_iteration(q);
    }
    workspace.update_pattern(&mut problem.energies, problem.layout, q);
    assemble_exact(problem, workspace, q)?;
    let matrix = workspace.matrix.as_ref().expect("the matrix was assembled");
    let hardly_any = HARDLY_ANY * mean_size(&workspace.diagonal(), problem.is_fixed);
    let mut direction = vec![0.0; q.len()];
    let mut count = 0;
    for node in (0..problem.layout.num_solved_nodes() as u32).map(NodeId) {
        let (start, size) = (problem.layout.start(node), problem.layout.size(node));
        let slot = matrix
            .pattern
            .slot(node, node)
            .expect("diagonal blocks are stored") as usize;
        let length = matrix.pattern.first_column_length(node) as usize;
        let block = DMatrix::from_fn(size, size, |i, j| {
            let (row, column) = (i.max(j), i.min(j));
            matrix.values[slot + column * length - column * (column + 1) / 2 + row]
        });
        let eigen = block.symmetric_eigen();
        let least = eigen.eigenvalues.imin();
        if !problem.is_fixed[start] && eigen.eigenvalues[least] < hardly_any {
            count += 1;
            // Steele, Lea and Flood (2014), one bit of it.
            let mixed = (count as u64).wrapping_mul(0x9e37_79b9_7f4a_7c15);
            let mixed = (mixed ^ (mixed >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
            let side = if mixed >> 63 == 0 { way } else { -way };
            for (k, v) in eigen.eigenvectors.column(least).iter().enumerate() {
                direction[start + k] = side * v;
            }
        }
    }
    let mut trial = vec![0.0; q.len()];
    problem.space.retract(q, &direction, &mut trial);
    let is_admissible = problem.energies.iter().all(|e| e.is_admissible(&trial));
    if count > 0 && is_admissible {
        q.copy_from_slice(&trial);
    }
    Ok(count > 0 && is_admissible)
}

/// The exact Hessian into the workspace, with the rows of held unknowns taken out; returns the gradient.
pub(super) fn assemble_exact(
    problem: &Problem<'_>,
    workspace: &mut LinearWorkspace,
    q: &[f64],
) -> Result<Vec<f64>, SolveError> {
    let solved = problem.layout.num_solved_dofs();
    let mut gradient = vec![0.0; q.len()];
    let (still, mut coupling) = (vec![0.0; q.len()], vec![0.0; solved]);
    let matrix = workspace.matrix.as_mut().expect("the pattern was updated");
    matrix.values.fill(0.0);
    for energy in &problem.energies {
        let mut hessian = HessianBuilder {
            matrix: &mut *matrix,
            layout: problem.layout,
            prescribed_step: &still[solved..],
            coupling: &mut coupling,
        };
        energy.add_derivatives(q, PsdProjection::Exact, &mut gradient, &mut hessian);
    }
    if gradient.iter().any(|g| !g.is_finite()) {
        return Err(not_finite(&problem.energies, q));
    }
    matrix.fix(problem.is_fixed, &still[..solved], &mut coupling);
    Ok(gradient)
}

/// A direction of negative curvature of the assembled Hessian along which the energy does not grow at first.
fn negative_direction(
    problem: &Problem<'_>,
    workspace: &mut LinearWorkspace,
    gradient: &[f64],
) -> Option<Vec<f64>> {
    workspace.factorize().err()?;
    // Barely definite, so that inverse iteration turns to v at once: with a hundred times the least shift, a slender plate
    // of 1104 triangles had not shown its negative curvature after 60 turns, and stayed plane at twice its critical load.
    let shift = workspace.factorize_barely(problem.is_fixed)?;
    let matrix = workspace.matrix.as_ref().expect("the matrix was assembled");
    // Any start with a share of every direction: the same one each time, so that runs can be repeated.
    let mut v: Vec<f64> = (0..shift.len())
        .map(|i| (((i as f64 + 1.0) * 0.618_033_988_749_895).fract() - 0.5) * free(problem, i))
        .collect();
    for _ in 0..MAX_TURNS {
        v.iter_mut().zip(&shift).for_each(|(v, s)| *v *= s);
        workspace.factor.solve(&mut v);
        let norm = v.iter().map(|x| x * x).sum::<f64>().sqrt();
        if !(norm > 0.0 && norm.is_finite()) {
            return None;
        }
        v.iter_mut().for_each(|x| *x /= norm);
        let curvature = |v: &[f64]| -> f64 {
            let image = matrix.multiply(v);
            (0..v.len())
                .map(|i| v[i] * (image[i] - shift[i] * v[i]))
                .sum()
        };
        if curvature(&v) < 0.0 {
            let slope: f64 = gradient.iter().zip(&v).map(|(g, d)| g * d).sum();
            let sign = if slope > 0.0 { -1.0 } else { 1.0 };
            let mut direction = vec![0.0; gradient.len()];
            (direction.iter_mut().zip(&v)).for_each(|(d, x)| *d = sign * x);
            return Some(direction);
        }
    }
    None
}

/// 0 for a held unknown.
fn free(problem: &Problem<'_>, dof: usize) -> f64 {
    if problem.is_fixed[dof] { 0.0 } else { 1.0 }
}

/// Goes along `direction` as long as doubling the way lowers the energy; whether it went anywhere.
fn descend(problem: &mut Problem<'_>, tolerance: f64, direction: &[f64], q: &mut [f64]) -> bool {
    let unit = problem.space.displacement(q, direction);
    let mut way = 10.0 * tolerance / unit;
    let value = |problem: &Problem<'_>, trial: &[f64]| -> f64 {
        if problem.energies.iter().all(|e| e.is_admissible(trial)) {
            problem.energies.iter().map(|e| e.value(trial)).sum()
        } else {
            f64::INFINITY
        }
    };
    let mut best = (value(problem, q), None);
    for _ in 0..MAX_DOUBLINGS {
        let scaled: Vec<f64> = direction.iter().map(|d| d * way).collect();
        let allowed = (problem.energies.iter_mut())
            .map(|e| e.max_step(q, &scaled))
            .fold(1.0, f64::min);
        if allowed < 1.0 {
            break;
        }
        let mut trial = vec![0.0; q.len()];
        problem.space.retract(q, &scaled, &mut trial);
        let energy = value(problem, &trial);
        if energy < best.0 {
            best = (energy, Some(trial));
        } else if best.1.is_some() {
            break;
        }
        way *= 2.0;
    }
    let Some(point) = best.1 else { return false };
    q.copy_from_slice(&point);
    true
}

#[cfg(test)]
mod tests {
    use nalgebra::{SMatrix, SVector};

    use super::*;
    use crate::assembly::{
        Assembled, ConfigurationSpace, Dof, DofLayout, LocalEnergy, LocalHessian,
    };
    use crate::solve::{
        HessianChoice, NewtonOptions, TrustRegionOptions, minimize, minimize_in_trust_region,
        minimize_stably,
    };

    /// (x² − w)² + y² + c x y. With w = 1 and c = 0 a saddle at the origin, minima at x = ±1.
    struct DoubleWell {
        w: f64,
        c: f64,
    }

    const PLAIN_WELL: DoubleWell = DoubleWell { w: 1.0, c: 0.0 };

    impl LocalEnergy<2, 2> for DoubleWell {
        const NODE_SIZES: [usize; 2] = [1; 2];
        fn name(&self) -> &'static str {
            "double well"
        }
        fn num_stencils(&self) -> usize {
            1
        }
        fn nodes(&self, _: usize) -> [Option<Dof>; 2] {
            [Some(Dof(0)), Some(Dof(1))]
        }
        fn value(&self, s: usize, q: &SVector<f64, 2>) -> f64 {
            self.hessian(s, q).value
        }
        fn gradient(&self, s: usize, q: &SVector<f64, 2>) -> (f64, SVector<f64, 2>) {
            let local = self.hessian(s, q);
            (local.value, local.gradient)
        }
        fn hessian(&self, _: usize, q: &SVector<f64, 2>) -> LocalHessian<2> {
            let (x, y, w, c) = (q[0], q[1], self.w, self.c);
            LocalHessian {
                value: (x * x - w).powi(2) + y * y + c * x * y,
                gradient: SVector::from([4.0 * x * (x * x - w) + c * y, 2.0 * y + c * x]),
                hessian: SMatrix::from([[12.0 * x * x - 4.0 * w, c], [c, 2.0]]),
            }
        }
        fn projected_hessian(
            &self,
            stencil: usize,
            q: &SVector<f64, 2>,
            _kept: f64,
        ) -> LocalHessian<2> {
            let mut local = self.hessian(stencil, q);
            local.hessian[(0, 0)] = local.hessian[(0, 0)].max(1.0);
            local
        }
        fn describe(&self, _: usize) -> String {
            String::new()
        }
    }

    struct Plain;

    impl ConfigurationSpace for Plain {
        fn displacement(&self, _: &[f64], dq: &[f64]) -> f64 {
            dq.iter().fold(0.0, |m, d| d.abs().max(m))
        }
        fn describe(&self, dof: usize) -> String {
            format!("unknown {dof}")
        }
    }

    /// Where both minimisations end from the same start, and the saddles that were left.
    fn ends(start: [f64; 2], is_fixed: [bool; 2]) -> ([f64; 2], [f64; 2], usize) {
        let mut layout = DofLayout::new();
        layout.push_nodes(2, 1, true);
        let mut energy = Assembled::new(PLAIN_WELL, &layout);
        let mut problem = Problem {
            energies: vec![&mut energy],
            layout: &layout,
            space: &Plain,
            is_fixed: &is_fixed,
            target: &start,
        };
        let options = NewtonOptions {
            tolerance: 1e-9,
            max_iterations: 100,
            hessian: HessianChoice::Projected,
        };
        let mut run = |stably: bool| {
            let (mut q, mut workspace) = (start, LinearWorkspace::default());
            let solve = if stably { minimize_stably } else { minimize };
            let report = solve(&mut problem, &options, &mut workspace, &mut q).unwrap();
            assert!(report.converged);
            (q, report.saddles)
        };
        let (plain, _) = run(false);
        let (stable, saddles) = run(true);
        (plain, stable, saddles)
    }

    #[test]
    fn a_saddle_is_left_for_a_minimum() {
        let (plain, stable, saddles) = ends([0.0, 0.3], [false; 2]);
        assert!(plain[0] == 0.0 && plain[1].abs() < 1e-9);
        assert!((stable[0].abs() - 1.0).abs() < 1e-9 && stable[1].abs() < 1e-9);
        assert_eq!(saddles, 1);
    }

    #[test]
    fn a_minimum_and_a_held_saddle_are_kept() {
        let (plain, stable, saddles) = ends([0.8, 0.3], [false; 2]);
        assert_eq!((plain, saddles), (stable, 0));
        let (_, held, saddles) = ends([0.0, 0.3], [true, false]);
        assert_eq!((held[0], saddles), (0.0, 0));
    }

    /// Runs `solve` on a double well.
    fn on_well<T>(
        well: DoubleWell,
        is_fixed: [bool; 2],
        solve: impl FnOnce(&mut Problem<'_>, &mut LinearWorkspace) -> T,
    ) -> T {
        let mut layout = DofLayout::new();
        layout.push_nodes(2, 1, true);
        let mut energy = Assembled::new(well, &layout);
        let mut problem = Problem {
            energies: vec![&mut energy],
            layout: &layout,
            space: &Plain,
            is_fixed: &is_fixed,
            target: &[0.0; 2],
        };
        solve(&mut problem, &mut LinearWorkspace::default())
    }

    #[test]
    fn nodes_on_saddles_of_their_own_are_moved_off_and_others_stay() {
        let way = 0.5;
        let leave = |start: [f64; 2], is_fixed: [bool; 2]| {
            on_well(PLAIN_WELL, is_fixed, |problem, workspace| {
                let mut q = start;
                let left = leave_saddles_by_node(problem, workspace, way, &mut q).unwrap();
                (left, q)
            })
        };
        let (left, q) = leave([0.0, 0.3], [false; 2]);
        assert!(left && q[0].abs() == way && q[1] == 0.3, "{q:?}");
        // The same side each time: runs can be repeated.
        assert_eq!(leave([0.0, 0.3], [false; 2]).1, q);
        assert_eq!(leave([0.8, 0.3], [false; 2]), (false, [0.8, 0.3]));
        assert_eq!(leave([0.0, 0.3], [true, false]), (false, [0.0, 0.3]));
    }

    #[test]
    fn a_trust_region_goes_down_where_the_exact_matrix_is_indefinite() {
        let options = TrustRegionOptions {
            tolerance: 1e-9,
            decrement: 0.0,
            longest_step: 1.0,
            max_factorizations: 100,
        };
        // The second has an unknown without stiffness of its own at the start, so no multiple of its diagonal will do;
        // its minima are at y = −x / 2, 4 x³ = x / 2.
        let flat = DoubleWell { w: 0.0, c: 1.0 };
        let x = 0.125f64.sqrt();
        for (well, start, end) in [
            (PLAIN_WELL, [0.1, 0.3], [1.0, 0.0]),
            (flat, [0.0, -0.3], [x, -0.5 * x]),
        ] {
            on_well(well, [false; 2], |problem, workspace| {
                let mut q = start;
                let report =
                    minimize_in_trust_region(problem, &options, workspace, &mut q).unwrap();
                assert!(report.converged && report.ends_definite, "{report:?}");
                // Steps below 1e-9 and quadratic convergence.
                assert!(
                    (q[0] - end[0]).abs() < 1e-9 && (q[1] - end[1]).abs() < 1e-9,
                    "{q:?}"
                );
            });
        }
    }

    #[test]
    fn a_trust_region_ends_on_a_saddle_it_starts_from_and_says_that_it_is_one() {
        let options = TrustRegionOptions {
            tolerance: 1e-9,
            decrement: 0.0,
            longest_step: 1.0,
            max_factorizations: 100,
        };
        on_well(PLAIN_WELL, [false; 2], |problem, workspace| {
            let mut q = [0.0, 0.0];
            let report = minimize_in_trust_region(problem, &options, workspace, &mut q).unwrap();
            assert!(report.converged && !report.ends_definite && q == [0.0; 2]);
        });
    }
}
