use super::*;

const LIMIT: StretchLimit = StretchLimit {
    stretch: 1.1,
    begin: 1.05,
    stiffness: 3e3,
};

/// One face of a crooked rest shape.
fn one_face() -> (StrainLimit, [Vec3; 3]) {
    let rest = [
        Vec3::new(0.1, 0.0, 0.2),
        Vec3::new(0.9, 0.3, 0.0),
        Vec3::new(0.2, 1.1, -0.1),
    ];
    let mesh = TriMesh::new(3, vec![[0, 1, 2]]).unwrap();
    let frame = RestFrame::from_corners(&rest).unwrap();
    let limit = StrainLimit::new(&mesh, Dof(0), vec![frame], LIMIT, &[0.02]);
    (limit, rest)
}

/// The corners whose deformation gradient is `Q diag(σ₁, σ₂) Rᵀ` in the rest frame, with some rotations.
fn stretched(stretches: [f64; 2]) -> SVector<f64, 9> {
    let (limit, rest) = one_face();
    let turn = nalgebra::Rotation3::from_euler_angles(0.4, -1.1, 0.7);
    let (sin, cos) = 0.6f64.sin_cos();
    let [s1, s2] = stretches;
    // R diag(σ) Rᵀ: symmetric, in the plane.
    let (f11, f22) = (
        s1 * cos * cos + s2 * sin * sin,
        s1 * sin * sin + s2 * cos * cos,
    );
    let f12 = (s1 - s2) * cos * sin;
    let columns = [Vec3::new(f11, f12, 0.0), Vec3::new(f12, f22, 0.0)].map(|f| turn * f);
    let edges = [rest[1] - rest[0], rest[2] - rest[0]];
    let [m11, m12, m22] = limit.frames[0].inverse;
    let (d11, d12, d22) = (1.0 / m11, -m12 / (m11 * m22), 1.0 / m22);
    assert!((edges[0].norm() - d11).abs() < 1e-14);
    let mut q = SVector::<f64, 9>::zeros();
    q.fixed_rows_mut::<3>(3).copy_from(&(columns[0] * d11));
    let second = columns[0] * d12 + columns[1] * d22;
    q.fixed_rows_mut::<3>(6).copy_from(&second);
    q
}

/// Largest error of the Hessian against central differences of the gradient, over its largest entry.
fn hessian_error(limit: &StrainLimit, q: &SVector<f64, 9>, h: f64) -> f64 {
    let exact = limit.hessian(0, q).hessian;
    let column = |j: usize| {
        let mut step = SVector::<f64, 9>::zeros();
        step[j] = h;
        (limit.gradient(0, &(q + step)).1 - limit.gradient(0, &(q - step)).1) / (2.0 * h)
    };
    let error = |j: usize| (column(j) - exact.column(j)).amax();
    (0..9).map(error).fold(0.0, f64::max) / exact.amax()
}

#[test]
fn the_hessian_is_right_where_stretches_are_equal_or_one_of_them_is_free() {
    let (limit, _) = one_face();
    for stretches in [
        [1.08, 1.08],
        [1.08, 1.08 - 1e-9],
        [1.09, 1.07],
        [1.08, 1.05],
        [1.08, 1.0],
        [1.08, 0.3],
        [1.08, 0.0],
    ] {
        let q = stretched(stretches);
        let errors = [4e-5, 2e-5, 1e-5].map(|h| hessian_error(&limit, &q, h));
        // Central differences: the error falls with h², until the kink of the third derivative at ŝ, where with h.
        let rate = if stretches[1] == 1.05 { 0.6 } else { 0.3 };
        for pair in errors.windows(2) {
            assert!(pair[1] < rate * pair[0], "{stretches:?}: {errors:?}");
        }
        assert!(errors[2] < 1e-4, "{stretches:?}: {errors:?}");
    }
}

#[test]
fn the_hessian_has_no_negative_eigenvalue_and_is_its_own_projection() {
    let (limit, _) = one_face();
    for stretches in [[1.06, 1.06], [1.0999, 0.2], [1.09, 1.085], [1.051, 0.0]] {
        let q = stretched(stretches);
        let hessian = limit.hessian(0, &q).hessian;
        let eigenvalues =
            nalgebra::DMatrix::from_column_slice(9, 9, hessian.as_slice()).symmetric_eigenvalues();
        // Round-off of nine terms.
        assert!(eigenvalues.min() > -1e-14 * eigenvalues.max());
        assert!(eigenvalues.max() > 0.0);
        assert_eq!(hessian, limit.projected_hessian(0, &q, 0.0).hessian);
    }
}

#[test]
fn nothing_resists_below_the_barrier_and_everything_at_the_limit() {
    let (limit, _) = one_face();
    for stretches in [[1.0, 1.0], [1.0499, 0.1], [0.0, 0.0]] {
        let q = stretched(stretches);
        assert_eq!(limit.value(0, &q), 0.0);
        assert!(limit.is_admissible(0, &q));
    }
    let q = stretched([1.1001, 1.0]);
    assert_eq!(limit.value(0, &q), f64::INFINITY);
    assert!(!limit.is_admissible(0, &q));
}

#[test]
fn a_step_ends_near_the_limit_but_short_of_it() {
    let (limit, _) = one_face();
    let start = stretched([1.04, 0.9]);
    for end in [[1.2, 1.0], [3.0, 0.1], [1e6, 1e6], [1.0999, 1.0]] {
        let direction = stretched(end) - start;
        let t = limit.max_step(0, &start, &direction);
        let corners = start + direction * t;
        let stretch = Stretches::new(&limit.columns(0, &corners)).values[0];
        let share = (stretch - 1.04) / 0.06;
        // The root is found from beyond, up to round-off and a hundredth of what was left.
        assert!((0.9 - 1e-9..0.911).contains(&share), "{end:?}: {share}");
    }
    // What stays well below the limit, or goes through the rest shape to its mirror image, is free.
    for end in [[1.05, 1.0], [0.5, 0.5]] {
        assert_eq!(limit.max_step(0, &start, &(stretched(end) - start)), 1.0);
    }
    assert_eq!(limit.max_step(0, &start, &(-2.0 * start)), 1.0);
}

#[test]
fn where_next_to_nothing_is_left_a_step_is_short_and_never_backwards() {
    let (limit, _) = one_face();
    for ulps in 1..200u32 {
        let start = stretched([1.1 - f64::from(ulps) * f64::EPSILON, 0.9]);
        if !limit.is_admissible(0, &start) {
            continue;
        }
        for end in [[1.2, 1.0], [3.0, 0.1], [1e6, 1e6]] {
            let t = limit.max_step(0, &start, &(stretched(end) - start));
            assert!((0.0..1e-9).contains(&t), "{ulps} {end:?}: {t}");
        }
        // This way stretches fall at first: the step may be long, and ends where they have grown again.
        let through = stretched([-50.0, 40.0]) - start;
        let t = limit.max_step(0, &start, &through);
        let end = Stretches::new(&limit.columns(0, &(start + through * t))).values[0];
        assert!(t > 0.0 && end <= 1.1 + 1e-14, "{ulps}: {t} {end}");
    }
}
