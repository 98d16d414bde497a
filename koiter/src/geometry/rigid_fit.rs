//! The rigid motion that takes points nearest to others.
//!
//! ```text
//! min Σ |R (p − p̄) − (q − q̄)|²:    Σ (q − q̄)(p − p̄)ᵀ = U S Vᵀ,    R = U diag(1, 1, det U Vᵀ) Vᵀ
//! ```
//!
//! Reference: W. Kabsch, "A solution for the best rotation to relate two sets of vectors" (1976).

use nalgebra::Matrix3;

use crate::Vec3;

/// Root mean square distance of points `to` from points `from` after the rigid motion of these that makes it least [m]; NaN where points
/// are not finite, 0 where there are none. Both lists are of the same length.
pub fn rigid_misfit(from: &[Vec3], to: &[Vec3]) -> f64 {
    let count = from.len().max(1) as f64;
    let mean = |points: &[Vec3]| points.iter().sum::<Vec3>() / count;
    let (center, target) = (mean(from), mean(to));
    let offsets = || {
        let pairs = from.iter().zip(to);
        pairs.map(|(p, q)| (p - center, q - target))
    };
    let products: Matrix3<f64> = offsets().map(|(p, q)| q * p.transpose()).sum();
    if !products.iter().all(|entry| entry.is_finite()) {
        return f64::NAN;
    }
    let svd = products.svd(true, true);
    let (Some(u), Some(v_t)) = (svd.u, svd.v_t) else {
        return f64::NAN;
    };
    let sign = (u * v_t).determinant().signum();
    let rotation = u * Matrix3::from_diagonal(&Vec3::new(1.0, 1.0, sign)) * v_t;
    let squares = offsets().map(|(p, q)| (rotation * p - q).norm_squared());
    (squares.sum::<f64>() / count).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Rotation3;

    fn points() -> Vec<Vec3> {
        let point = |k: usize| Vec3::new((3.0 * k as f64).sin(), (k as f64).cos(), 0.1 * k as f64);
        (0..7).map(point).collect()
    }

    #[test]
    fn rigid_motions_are_no_misfit_and_a_mirror_image_is() {
        let from = points();
        let rotation = Rotation3::new(Vec3::new(0.4, -2.0, 0.9));
        let moved = |x: &Vec3| rotation * x + Vec3::new(5.0, -1.0, 2.0);
        let to: Vec<Vec3> = from.iter().map(moved).collect();
        assert!(rigid_misfit(&from, &to) < 1e-13);
        let mirrored: Vec<Vec3> = from.iter().map(|x| Vec3::new(-x.x, x.y, x.z)).collect();
        assert!(rigid_misfit(&from, &mirrored) > 0.1);
        assert_eq!(rigid_misfit(&[], &[]), 0.0);
        assert!(rigid_misfit(&from, &[Vec3::repeat(f64::NAN); 7]).is_nan());
    }

    #[test]
    fn a_stretch_along_an_axis_is_what_is_left() {
        let from = [-1.0, 0.0, 1.0].map(|x| Vec3::new(x, 0.0, 0.0));
        let to = [-1.3, 0.0, 1.3].map(|y| Vec3::new(2.0, y, 0.0));
        assert!((rigid_misfit(&from, &to) - 0.3 * (2.0f64 / 3.0).sqrt()).abs() < 1e-14);
    }
}
