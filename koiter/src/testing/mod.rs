//! The conformance suite every energy passes (feature `testing`).
//!
//! [`check`] takes an energy, a state in which nothing is special, its formula over jets, and what it claims; it returns
//! the first thing that does not hold. An energy of a user is checked by the same call.

use std::sync::Arc;

use nalgebra::{Rotation3, SVector, Vector3};

use crate::assembly::{
    Assembled, Dof, DofLayout, Energy, HessianBuilder, LocalEnergy, Pattern, PatternBuilder,
    PsdProjection, SymmetricMatrix,
};
use crate::geometry::{Jet, Real};

/// What an energy claims about itself.
#[derive(Clone, Debug, Default)]
pub struct Claims {
    /// The energy does not change under rigid motions of all points (nodes of size 3).
    pub rigid_motion_invariant: bool,
    /// Nodes of size 3 from this unknown on are directions: they turn with the points but are not shifted.
    pub directions_from: Option<Dof>,
    /// A state in which the gradient vanishes.
    pub rest: Option<Vec<f64>>,
}

/// What does not hold.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{energy}: {property} fails at element {stencil}: {found} instead of {expected}")]
pub struct Violation {
    /// Name of the energy.
    pub energy: String,
    /// The property.
    pub property: &'static str,
    /// The element, or the unknown for properties of the sum.
    pub stencil: usize,
    /// What was found.
    pub found: f64,
    /// What should have been.
    pub expected: f64,
}

/// Checks everything that holds for any energy, and what is claimed.
///
/// # Errors
/// The first violation.
///
/// # Panics
/// If `q` does not fit the layout.
pub fn check<const N: usize, const K: usize, L: LocalEnergy<N, K>>(
    local: L,
    layout: &DofLayout,
    q: &[f64],
    formula: impl Fn(&L, usize, &[Jet<N>; N]) -> Jet<N>,
    claims: &Claims,
) -> Result<(), Violation> {
    let name = local.name().to_owned();
    let fail = |property, stencil, found, expected| {
        Err(Violation {
            energy: name.clone(),
            property,
            stencil,
            found,
            expected,
        })
    };
    let mut energy = Assembled::new(local, layout);
    let mut total = 0.0;
    for stencil in 0..energy.local().num_stencils() {
        let x = energy.gather(stencil, q);
        let jets = std::array::from_fn(|i| Jet::variable(x[i], i));
        let oracle = formula(energy.local(), stencil, &jets);
        derivatives(energy.local(), stencil, &x, &oracle, &fail)?;
        projection(energy.local(), stencil, &x, hessian_scale(&oracle), &fail)?;
        let gradient = energy.local().gradient(stencil, &x).1;
        total += oracle.value().abs() + gradient.norm();
    }
    if !(total > 0.0) {
        return fail(
            "energy or gradient is not zero at the tested state",
            0,
            total,
            1.0,
        );
    }
    differences(&energy, q, &fail)?;
    assembly(&mut energy, layout, q, &fail)?;
    check_claims(&energy, layout, q, claims)
}

/// Checks what is claimed; [`check`] does so too, but [`check_global`] does not.
///
/// # Errors
/// The first claim that does not hold.
pub fn check_claims(
    energy: &dyn Energy,
    layout: &DofLayout,
    q: &[f64],
    claims: &Claims,
) -> Result<(), Violation> {
    let fail = |property, stencil, found, expected| {
        Err(Violation {
            energy: energy.name().into(),
            property,
            stencil,
            found,
            expected,
        })
    };
    if claims.rigid_motion_invariant {
        rigid_motion(energy, layout, q, claims.directions_from, &fail)?;
    }
    match &claims.rest {
        Some(rest) => no_force(energy, q, rest, &fail),
        None => Ok(()),
    }
}

type Fail<'a> = dyn Fn(&'static str, usize, f64, f64) -> Result<(), Violation> + 'a;

/// A few hundred roundings of sums of N² terms.
const TOLERANCE: f64 = 1e-11;

/// Largest entry of the Hessian.
fn hessian_scale<const N: usize>(oracle: &Jet<N>) -> f64 {
    1e-300 + (0..N * N).fold(0.0f64, |m, k| m.max(oracle.hessian(k / N, k % N).abs()))
}

/// Value, gradient and Hessian of one element are those of the formula over jets.
fn derivatives<const N: usize, const K: usize, L: LocalEnergy<N, K>>(
    local: &L,
    stencil: usize,
    x: &SVector<f64, N>,
    oracle: &Jet<N>,
    fail: &Fail<'_>,
) -> Result<(), Violation> {
    let exact = local.hessian(stencil, x);
    // Absent nodes take part in no formula, so the jets' derivatives by them are zero as well.
    let scale = 1.0 + oracle.value().abs();
    let (gradient_value, gradient) = local.gradient(stencil, x);
    let gradient_scale = 1e-300 + oracle.gradient().iter().fold(0.0f64, |m, g| m.max(g.abs()));
    let hessian_scale = hessian_scale(oracle);
    for value in [exact.value, gradient_value, local.value(stencil, x)] {
        if (value - oracle.value()).abs() > TOLERANCE * scale {
            return fail(
                "value equals that of the formula",
                stencil,
                value,
                oracle.value(),
            );
        }
    }
    for i in 0..N {
        for found in [gradient[i], exact.gradient[i]] {
            if (found - oracle.gradient()[i]).abs() > TOLERANCE * gradient_scale {
                return fail(
                    "gradient equals that of dual numbers",
                    stencil,
                    found,
                    oracle.gradient()[i],
                );
            }
        }
        for j in 0..N {
            if (exact.hessian[(i, j)] - oracle.hessian(i, j)).abs() > TOLERANCE * hessian_scale {
                return fail(
                    "Hessian equals that of dual numbers",
                    stencil,
                    exact.hessian[(i, j)],
                    oracle.hessian(i, j),
                );
            }
            if (exact.hessian[(i, j)] - exact.hessian[(j, i)]).abs() > TOLERANCE * hessian_scale {
                return fail(
                    "Hessian is symmetric",
                    stencil,
                    exact.hessian[(i, j)],
                    exact.hessian[(j, i)],
                );
            }
        }
    }
    Ok(())
}

/// The projected Hessian of one element is positive semidefinite, and a share of the negative curvature is that share.
fn projection<const N: usize, const K: usize, L: LocalEnergy<N, K>>(
    local: &L,
    stencil: usize,
    x: &SVector<f64, N>,
    hessian_scale: f64,
    fail: &Fail<'_>,
) -> Result<(), Violation> {
    let exact = local.hessian(stencil, x);
    let projected = local.projected_hessian(stencil, x, 0.0).hessian;
    let partial = local.projected_hessian(stencil, x, 0.3).hessian;
    let blend = projected + (exact.hessian - projected) * 0.3;
    if !((partial - blend).amax() <= TOLERANCE * hessian_scale) {
        return fail(
            "the share of negative curvature that is kept is the one asked for",
            stencil,
            partial.amax(),
            blend.amax(),
        );
    }
    let lowest = nalgebra::DMatrix::from_column_slice(N, N, projected.as_slice())
        .symmetric_eigenvalues()
        .min();
    if lowest < -1e-10 * projected.amax() {
        return fail(
            "projected Hessian is positive semidefinite",
            stencil,
            lowest,
            0.0,
        );
    }
    Ok(())
}

/// The gradient vanishes at rest, measured by that at `q`.
fn no_force(
    energy: &dyn Energy,
    q: &[f64],
    rest: &[f64],
    fail: &Fail<'_>,
) -> Result<(), Violation> {
    let mut moved = vec![0.0; q.len()];
    energy.add_gradient(q, &mut moved);
    let mut gradient = vec![0.0; q.len()];
    energy.add_gradient(rest, &mut gradient);
    let scale = moved.iter().fold(0.0f64, |m, g| m.max(g.abs()));
    for (i, g) in gradient.iter().enumerate() {
        if g.abs() > 1e-9 * scale {
            return fail("no force at rest", i, *g, 0.0);
        }
    }
    Ok(())
}

/// Central differences of value and gradient along a fixed direction: the error must fall with h².
fn differences(energy: &dyn Energy, q: &[f64], fail: &Fail<'_>) -> Result<(), Violation> {
    let direction: Vec<f64> = (0..q.len())
        .map(|i| ((i * i + 3) as f64 * 0.7).sin())
        .collect();
    let at = |h: f64| -> Vec<f64> { q.iter().zip(&direction).map(|(x, d)| x + h * d).collect() };
    let gradient_at = |h: f64| {
        let mut g = vec![0.0; q.len()];
        energy.add_gradient(&at(h), &mut g);
        g
    };
    let exact: f64 = gradient_at(0.0)
        .iter()
        .zip(&direction)
        .map(|(g, d)| g * d)
        .sum();
    let extent = q.iter().fold(0.0f64, |m, x| m.max(x.abs()));
    let steps = [4e-4, 2e-4, 1e-4].map(|h| h * extent);
    let errors =
        steps.map(|h| ((energy.value(&at(h)) - energy.value(&at(-h))) / (2.0 * h) - exact).abs());
    let noise = energy.value(q).abs() * 1e-15 / steps[2] * 100.0 + 1e-10 * exact.abs();
    for pair in errors.windows(2) {
        if pair[1] > 0.35 * pair[0] && pair[1] > noise {
            return fail(
                "differences of the value approach the gradient with h²",
                0,
                pair[1],
                0.25 * pair[0],
            );
        }
    }
    Ok(())
}

/// The assembled Hessian times a vector is the derivative of the gradient, with any number of threads the same bits.
fn assembly<const N: usize, const K: usize, L: LocalEnergy<N, K>>(
    energy: &mut Assembled<L, N, K>,
    layout: &DofLayout,
    q: &[f64],
    fail: &Fail<'_>,
) -> Result<(), Violation> {
    let pattern = bound_pattern(energy, layout, q);
    let run = |projection| derivatives_at(energy, layout, &pattern, q, &[], projection);
    let (gradient, matrix) = run(PsdProjection::Exact);
    let mut alone = vec![0.0; q.len()];
    energy.add_gradient(q, &mut alone);
    let direction: Vec<f64> = (0..q.len()).map(|i| ((i * 5 + 2) as f64).cos()).collect();
    let mut expected = vec![0.0; q.len()];
    for stencil in 0..energy.local().num_stencils() {
        let d = energy.gather(stencil, &direction);
        let local = energy
            .local()
            .hessian(stencil, &energy.gather(stencil, q))
            .hessian
            * d;
        let mut row = 0;
        for (node, size) in energy.local().nodes(stencil).iter().zip(L::NODE_SIZES) {
            for k in 0..size {
                if let Some(dof) = node {
                    expected[dof.0 as usize + k] += local[row + k];
                }
            }
            row += size;
        }
    }
    let product = matrix.multiply(&direction);
    let scale = expected.iter().fold(1e-300f64, |m, e| m.max(e.abs()));
    for i in 0..q.len() {
        if (product[i] - expected[i]).abs() > 1e-11 * scale {
            return fail(
                "assembled Hessian is the sum over elements",
                i,
                product[i],
                expected[i],
            );
        }
        if gradient[i] != alone[i] && (gradient[i] - alone[i]).abs() > 1e-12 * scale {
            return fail(
                "gradient with and without Hessian agree",
                i,
                gradient[i],
                alone[i],
            );
        }
    }
    #[cfg(feature = "parallel")]
    same_bits(&gradient, &matrix, || run(PsdProjection::Exact), fail)?;
    Ok(())
}

/// The pattern of the energy's Hessian, which is bound to it.
fn bound_pattern(energy: &mut dyn Energy, layout: &DofLayout, q: &[f64]) -> Arc<Pattern> {
    let mut builder = PatternBuilder::default();
    energy.add_to_pattern(q, &mut builder);
    let pattern = Arc::new(Pattern::new(layout, &builder.finish()));
    energy.bind(&pattern);
    pattern
}

/// Gradient and assembled Hessian.
fn derivatives_at(
    energy: &dyn Energy,
    layout: &DofLayout,
    pattern: &Arc<Pattern>,
    q: &[f64],
    prescribed_step: &[f64],
    projection: PsdProjection,
) -> (Vec<f64>, SymmetricMatrix) {
    let mut matrix = SymmetricMatrix::zeros(pattern.clone());
    let mut gradient = vec![0.0; q.len()];
    let mut coupling = vec![0.0; layout.num_solved_dofs()];
    let mut hessian = HessianBuilder {
        matrix: &mut matrix,
        layout,
        prescribed_step,
        coupling: &mut coupling,
    };
    energy.add_derivatives(q, projection, &mut gradient, &mut hessian);
    (gradient, matrix)
}

/// Derivatives from `run` have the same bits with any number of threads.
#[cfg(feature = "parallel")]
fn same_bits(
    gradient: &[f64],
    matrix: &SymmetricMatrix,
    run: impl Fn() -> (Vec<f64>, SymmetricMatrix) + Sync,
    fail: &Fail<'_>,
) -> Result<(), Violation> {
    for threads in [1, 3] {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .expect("a thread pool starts");
        let (g, m) = pool.install(&run);
        if g != *gradient || m.values != matrix.values {
            return fail(
                "serial and parallel assembly give the same bits",
                threads,
                1.0,
                0.0,
            );
        }
    }
    Ok(())
}

/// Invariance of the value and covariance of the gradient under a rotation and translation.
fn rigid_motion(
    energy: &dyn Energy,
    layout: &DofLayout,
    q: &[f64],
    directions_from: Option<Dof>,
    fail: &Fail<'_>,
) -> Result<(), Violation> {
    let rotation = Rotation3::from_euler_angles(0.7, -1.1, 2.3);
    let shift = Vector3::new(3.0, -2.0, 0.7);
    let points: Vec<usize> = (0..layout.num_nodes())
        .map(|n| crate::assembly::NodeId(n as u32))
        .filter(|&n| layout.size(n) == 3)
        .map(|n| layout.start(n))
        .collect();
    let mut moved = q.to_vec();
    for &start in &points {
        let mut x = rotation * Vector3::from_column_slice(&q[start..start + 3]);
        if directions_from.is_none_or(|first| start < first.0 as usize) {
            x += shift;
        }
        moved[start..start + 3].copy_from_slice(x.as_slice());
    }
    let (before, after) = (energy.value(q), energy.value(&moved));
    if (before - after).abs() > 1e-10 * before.abs() {
        return fail("value is invariant under rigid motion", 0, after, before);
    }
    let (mut g0, mut g1) = (vec![0.0; q.len()], vec![0.0; q.len()]);
    energy.add_gradient(q, &mut g0);
    energy.add_gradient(&moved, &mut g1);
    let scale = g0.iter().fold(0.0f64, |m, g| m.max(g.abs()));
    for &start in &points {
        let expected = rotation * Vector3::from_column_slice(&g0[start..start + 3]);
        let difference = (Vector3::from_column_slice(&g1[start..start + 3]) - expected).norm();
        if difference > 1e-9 * scale {
            return fail("gradient turns with the shell", start, difference, 0.0);
        }
    }
    Ok(())
}

/// Checks an energy that is not a sum over fixed elements (contact, friction, inertia, gravity): gradient and Hessian
/// against differences whose error falls with h², a positive semidefinite projection, and the same bits for any number
/// of threads. `prepare` and `begin_iteration` are called wherever the energy is evaluated.
///
/// # Errors
/// The first violation.
pub fn check_global(
    energy: &mut dyn Energy,
    layout: &DofLayout,
    q: &[f64],
) -> Result<(), Violation> {
    let name = energy.name().to_owned();
    let fail = |property, stencil, found, expected| {
        Err(Violation {
            energy: name.clone(),
            property,
            stencil,
            found,
            expected,
        })
    };
    energy.prepare(q);
    energy.begin_iteration(q);
    let pattern = bound_pattern(energy, layout, q);
    let solved = layout.num_solved_dofs();
    let direction: Vec<f64> = (0..q.len())
        .map(|i| {
            if i < solved {
                ((i * i + 3) as f64 * 0.7).sin()
            } else {
                0.0
            }
        })
        .collect();
    let run = |projection| {
        derivatives_at(
            energy,
            layout,
            &pattern,
            q,
            &direction[solved..],
            projection,
        )
    };
    let (gradient, matrix) = run(PsdProjection::Exact);
    let (same, projected) = run(PsdProjection::Clamp);
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(x, y)| x * y).sum::<f64>();
    let (slope, image) = (
        dot(&gradient, &direction),
        matrix.multiply(&direction[..solved]),
    );
    if !(slope.abs() > 0.0) {
        return fail(
            "the gradient is not zero at the tested state",
            0,
            slope,
            1.0,
        );
    }
    if same != gradient {
        return fail(
            "the gradient does not depend on the projection",
            0,
            0.0,
            0.0,
        );
    }
    #[cfg(feature = "parallel")]
    same_bits(&gradient, &matrix, || run(PsdProjection::Exact), &fail)?;
    if dot(&projected.multiply(&direction[..solved]), &direction) < 0.0 {
        return fail("projected Hessian is positive semidefinite", 0, -1.0, 0.0);
    }
    global_differences(energy, q, &direction, slope, &image, &fail)
}

/// Central differences along `direction`: those of the value approach `slope`, those of the gradient `image`, with h².
fn global_differences(
    energy: &mut dyn Energy,
    q: &[f64],
    direction: &[f64],
    slope: f64,
    image: &[f64],
    fail: &Fail<'_>,
) -> Result<(), Violation> {
    let at = |h: f64| -> Vec<f64> { q.iter().zip(direction).map(|(x, d)| x + h * d).collect() };
    let extent = q.iter().fold(0.0f64, |m, x| m.max(x.abs()));
    let mut errors = Vec::new();
    for h in [4e-6, 2e-6, 1e-6].map(|h| h * extent) {
        let mut value_and_gradient = |h: f64| {
            let x = at(h);
            energy.begin_iteration(&x);
            let mut g = vec![0.0; q.len()];
            energy.add_gradient(&x, &mut g);
            (energy.value(&x), g)
        };
        let ((v1, g1), (v0, g0)) = (value_and_gradient(h), value_and_gradient(-h));
        let by_value = ((v1 - v0) / (2.0 * h) - slope).abs() / slope.abs();
        let scale = image.iter().fold(1e-300f64, |m, x| m.max(x.abs()));
        let by_gradient = (0..image.len())
            .map(|i| ((g1[i] - g0[i]) / (2.0 * h) - image[i]).abs() / scale)
            .fold(0.0, f64::max);
        errors.push([by_value, by_gradient]);
    }
    energy.begin_iteration(q);
    for (k, property) in [
        "differences of the value approach the gradient with h²",
        "differences of the gradient approach the Hessian with h²",
    ]
    .into_iter()
    .enumerate()
    {
        for pair in errors.windows(2) {
            // Round-off of the difference quotients at these steps is below 1e-7 of the result.
            if pair[1][k] > 0.35 * pair[0][k] && pair[1][k] > 1e-7 {
                return fail(property, 0, pair[1][k], 0.25 * pair[0][k]);
            }
        }
    }
    Ok(())
}
