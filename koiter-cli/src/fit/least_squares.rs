//! Least squares after Levenberg and Marquardt, and what is known of the parameters.
//!
//! ```text
//! minimise |r(θ)|²,   (JᵀJ + λ diag JᵀJ) δ = −Jᵀr,   cov θ ≈ s² (JᵀJ)⁻¹,   s² = |r|² / (n − p)
//! ```
//!
//! The derivatives J are central differences: r comes out of runs, which know none. Reference: Nocedal and Wright, "Numerical
//! Optimization", ch. 10.

use nalgebra::{DMatrix, DVector};

/// Half the step of differences: in logarithms a per cent of the parameter. Its square is the relative error of J; what a solver's
/// tolerance adds is divided by it.
const DIFFERENCE: f64 = 1e-2;
/// Longest step of an iteration: parameters change by a factor of e at most.
const LONGEST_STEP: f64 = 1.0;
/// Steps below this change parameters by less than a thousandth of a per cent.
const SMALLEST_STEP: f64 = 1e-5;
const LARGEST_DAMPING: f64 = 1e8;

/// What was found.
#[derive(Debug)]
pub(super) struct Fit {
    /// Parameters θ of the least sum.
    pub(super) parameters: DVector<f64>,
    /// Residuals there.
    pub(super) residuals: DVector<f64>,
    /// Covariance of the parameters; `None` where there are no more values than parameters.
    pub(super) covariance: Option<DMatrix<f64>>,
    /// Iterations taken.
    pub(super) iterations: usize,
    /// Whether the steps became small.
    pub(super) converged: bool,
}

/// Why there is no fit.
#[derive(Debug, PartialEq)]
pub(super) enum FitError<E> {
    /// The residuals at the start could not be computed.
    Start(E),
    /// The residuals near the best parameters could not be computed.
    Difference(E),
    /// The residuals do not depend on this parameter, or only as on others.
    Undetermined(usize),
}

/// Minimises the sum of squares. `residuals` may fail away from the start: the step is then shortened. `told` is called with every
/// iteration's number, parameters and sum.
pub(super) fn minimise<E>(
    start: DVector<f64>,
    most_iterations: usize,
    mut residuals: impl FnMut(&DVector<f64>) -> Result<DVector<f64>, E>,
    mut told: impl FnMut(usize, &DVector<f64>, f64),
) -> Result<Fit, FitError<E>> {
    let mut at = start;
    let mut found = residuals(&at).map_err(FitError::Start)?;
    let (mut damping, mut iterations, mut converged) = (1e-3, 0, false);
    let mut jacobian = differences(&at, &mut residuals)?;
    while iterations < most_iterations && !converged {
        iterations += 1;
        told(iterations, &at, found.norm_squared());
        let mut is_better = false;
        while !is_better && !converged {
            let step = damped_step(&jacobian, &found, damping);
            converged = step.amax() < SMALLEST_STEP;
            let there = &at + step;
            // A place where nothing can be computed is no better than here.
            match residuals(&there) {
                Ok(new) if new.norm_squared() < found.norm_squared() => {
                    (at, found, is_better) = (there, new, true);
                    damping = (damping / 10.0).max(1e-12);
                }
                _ => damping *= 10.0,
            }
            converged |= damping > LARGEST_DAMPING;
        }
        if is_better {
            jacobian = differences(&at, &mut residuals)?;
        }
    }
    let covariance = covariance(&jacobian, &found)?;
    Ok(Fit {
        parameters: at,
        residuals: found,
        covariance,
        iterations,
        converged,
    })
}

fn differences<E>(
    at: &DVector<f64>,
    residuals: &mut impl FnMut(&DVector<f64>) -> Result<DVector<f64>, E>,
) -> Result<DMatrix<f64>, FitError<E>> {
    let mut columns = Vec::with_capacity(at.len());
    for parameter in 0..at.len() {
        let mut moved = |by: f64| {
            let mut there = at.clone();
            there[parameter] += by;
            residuals(&there).map_err(FitError::Difference)
        };
        columns.push((moved(DIFFERENCE)? - moved(-DIFFERENCE)?) / (2.0 * DIFFERENCE));
    }
    let jacobian = DMatrix::from_columns(&columns);
    match jacobian
        .column_iter()
        .position(|column| column.amax() == 0.0)
    {
        Some(parameter) => Err(FitError::Undetermined(parameter)),
        None => Ok(jacobian),
    }
}

fn damped_step(jacobian: &DMatrix<f64>, residuals: &DVector<f64>, damping: f64) -> DVector<f64> {
    let mut matrix = jacobian.tr_mul(jacobian);
    for parameter in 0..matrix.ncols() {
        matrix[(parameter, parameter)] *= 1.0 + damping;
    }
    let gradient = jacobian.tr_mul(residuals);
    // Damped, the matrix is positive definite; without digits left, down the gradient is as good.
    let step = match matrix.cholesky() {
        Some(factor) => -factor.solve(&gradient),
        None => -gradient,
    };
    let length = step.amax();
    if length > LONGEST_STEP {
        step * (LONGEST_STEP / length)
    } else {
        step
    }
}

fn covariance<E>(
    jacobian: &DMatrix<f64>,
    residuals: &DVector<f64>,
) -> Result<Option<DMatrix<f64>>, FitError<E>> {
    let (n, p) = jacobian.shape();
    // Columns of length 1: what is left is how parallel they are.
    let lengths = DVector::from_iterator(p, jacobian.column_iter().map(|column| column.norm()));
    let scaled = DMatrix::from_fn(n, p, |i, j| jacobian[(i, j)] / lengths[j]);
    let eigen = scaled.tr_mul(&scaled).symmetric_eigen();
    if eigen.eigenvalues.min() < 1e-10 {
        let vector = eigen.eigenvectors.column(eigen.eigenvalues.imin());
        return Err(FitError::Undetermined(vector.iamax()));
    }
    if n <= p {
        return Ok(None);
    }
    let variance = residuals.norm_squared() / (n - p) as f64;
    let inverse = scaled.tr_mul(&scaled).try_inverse();
    Ok(inverse.map(|inverse| {
        DMatrix::from_fn(p, p, |i, j| {
            variance * inverse[(i, j)] / (lengths[i] * lengths[j])
        })
    }))
}

/// How many standard deviations from the mean 95 % of Student's distribution lie, for `freedom` degrees of freedom.
///
/// With t = √ν tan φ the density is cos^(ν−1) φ, so φ is found where its integral is 95 % of that up to π/2.
pub(super) fn student_95(freedom: usize) -> f64 {
    const PANELS: usize = 20_000;
    let width = std::f64::consts::FRAC_PI_2 / PANELS as f64;
    let density = |k: usize| ((k as f64 + 0.5) * width).cos().powf(freedom as f64 - 1.0);
    let whole: f64 = (0..PANELS).map(density).sum();
    let mut sum = 0.0;
    for panel in 0..PANELS {
        let next = sum + density(panel);
        if next >= 0.95 * whole {
            let share = (0.95 * whole - sum) / (next - sum);
            return (freedom as f64).sqrt() * ((panel as f64 + share) * width).tan();
        }
        sum = next;
    }
    f64::INFINITY
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_are_those_of_tables() {
        for (freedom, expected) in [(1, 12.7062), (2, 4.3027), (10, 2.2281), (1000, 1.9623)] {
            let found = student_95(freedom);
            assert!((found / expected - 1.0).abs() < 1e-4, "{freedom}: {found}");
        }
    }

    /// y = a e^(−b t) with known noise: the covariance is that of the linear problem in ln a, b near the answer.
    #[test]
    fn a_decay_is_found_with_its_covariance() {
        let times: Vec<f64> = (0..20).map(|k| 0.1 * f64::from(k)).collect();
        let noise = |k: usize| 1e-3 * [1.0, -1.0, 0.5, -0.5][k % 4];
        let model =
            |theta: &DVector<f64>, k: usize| theta[0].exp() * (-theta[1].exp() * times[k]).exp();
        let truth = DVector::from_vec(vec![2.0_f64.ln(), 1.5_f64.ln()]);
        let measured: Vec<f64> = (0..20).map(|k| model(&truth, k) + noise(k)).collect();
        let start = DVector::from_vec(vec![0.0, 1.0]);
        let residuals = |theta: &DVector<f64>| {
            Ok::<_, ()>(DVector::from_fn(20, |k, _| model(theta, k) - measured[k]))
        };
        let fit = minimise(start, 50, residuals, |_, _, _| {}).unwrap();
        assert!(fit.converged);
        let covariance = fit.covariance.unwrap();
        for parameter in 0..2 {
            let error = (fit.parameters[parameter] - truth[parameter]).abs();
            let deviation = covariance[(parameter, parameter)].sqrt();
            assert!(
                error < 3.0 * deviation && deviation < 1e-2,
                "{error} {deviation}"
            );
        }
    }

    #[test]
    fn what_cannot_be_told_apart_is_named() {
        let sum = |theta: &DVector<f64>| {
            Ok::<_, ()>(DVector::from_fn(5, |k, _| {
                (theta[0] + theta[1]) * k as f64 - 1.0
            }))
        };
        let start = DVector::from_vec(vec![0.3, 0.3]);
        let error = minimise(start.clone(), 20, sum, |_, _, _| {}).unwrap_err();
        assert!(matches!(error, FitError::Undetermined(_)));
        let only_first =
            |theta: &DVector<f64>| Ok::<_, ()>(DVector::from_fn(5, |k, _| theta[0] - k as f64));
        let error = minimise(start.clone(), 20, only_first, |_, _, _| {}).unwrap_err();
        assert_eq!(error, FitError::Undetermined(1));
        let error = minimise(start, 20, |_| Err("no"), |_, _, _| {}).unwrap_err();
        assert_eq!(error, FitError::Start("no"));
    }
}
