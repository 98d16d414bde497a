//! Numbers that carry first and second derivatives (forward mode, packed), and the trait they share with `f64`.
//!
//! A formula written once over [`Real`] gives its value with `f64` and its exact gradient and Hessian with [`Jet`]. Jets
//! are the oracle of the tests and the short way to a new energy; the hot energies have derivatives by hand.

use std::ops::{Add, Div, Mul, Neg, Sub};

/// What a formula may do with its numbers.
pub trait Real:
    Copy
    + From<f64>
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
    + Add<f64, Output = Self>
    + Sub<f64, Output = Self>
    + Mul<f64, Output = Self>
{
    /// The number without its derivatives.
    fn value(&self) -> f64;
    /// Whether it has none but zero.
    fn is_constant(&self) -> bool;
    /// Square root.
    fn sqrt(self) -> Self;
    /// Sine.
    fn sin(self) -> Self;
    /// Tangent.
    fn tan(self) -> Self;
    /// Natural logarithm.
    fn ln(self) -> Self;
    /// Angle of the point `(x, self)`, in (−π, π].
    fn atan2(self, x: Self) -> Self;
    /// `f(self)` for a function with this value and these first two derivatives here.
    fn function(self, value_and_derivatives: [f64; 3]) -> Self;

    /// Exponential.
    fn exp(self) -> Self {
        let exp = self.value().exp();
        self.function([exp; 3])
    }
    /// Cosine.
    fn cos(self) -> Self {
        let (sin, cos) = self.value().sin_cos();
        self.function([cos, -sin, -cos])
    }
    /// Angle in [−π/2, π/2] of this sine.
    fn asin(self) -> Self {
        let x = self.value();
        let slope = 1.0 / (1.0 - x * x).sqrt();
        self.function([x.asin(), slope, x * slope * slope * slope])
    }
    /// Angle in [0, π] of this cosine.
    fn acos(self) -> Self {
        let x = self.value();
        let slope = 1.0 / (1.0 - x * x).sqrt();
        self.function([x.acos(), -slope, -x * slope * slope * slope])
    }
    /// Angle in [−π/2, π/2] of this tangent.
    fn atan(self) -> Self {
        let x = self.value();
        let slope = 1.0 / (1.0 + x * x);
        self.function([x.atan(), slope, -2.0 * x * slope * slope])
    }
    /// Absolute value; its slope at 0 is taken to be 0.
    fn abs(self) -> Self {
        let x = self.value();
        let sign = if x == 0.0 { 0.0 } else { x.signum() };
        self.function([x.abs(), sign, 0.0])
    }
    /// Power with a constant exponent; of a negative number NaN unless the exponent is whole.
    fn powf(self, exponent: f64) -> Self {
        let x = self.value();
        // Not 0 · ∞ where the base is 0 and a derivative vanishes for any base.
        let scaled = |factor: f64, power: f64| match factor == 0.0 {
            true => 0.0,
            false => factor * x.powf(power),
        };
        self.function([
            x.powf(exponent),
            scaled(exponent, exponent - 1.0),
            scaled(exponent * (exponent - 1.0), exponent - 2.0),
        ])
    }
}

impl Real for f64 {
    fn value(&self) -> f64 {
        *self
    }
    fn is_constant(&self) -> bool {
        true
    }
    fn sqrt(self) -> Self {
        self.sqrt()
    }
    fn sin(self) -> Self {
        self.sin()
    }
    fn tan(self) -> Self {
        self.tan()
    }
    fn ln(self) -> Self {
        self.ln()
    }
    fn atan2(self, x: Self) -> Self {
        self.atan2(x)
    }
    fn function(self, [value, ..]: [f64; 3]) -> Self {
        value
    }
}

/// Value, gradient and Hessian with respect to `N` variables.
///
/// The Hessian is kept in full: half of it would need `N (N + 1) / 2` as an array length, which stable Rust cannot say.
#[derive(Clone, Copy, Debug)]
pub struct Jet<const N: usize> {
    value: f64,
    gradient: [f64; N],
    hessian: [[f64; N]; N],
}

impl<const N: usize> Jet<N> {
    /// The variable number `index`, at `value`.
    pub fn variable(value: f64, index: usize) -> Self {
        let mut jet = Self::from(value);
        jet.gradient[index] = 1.0;
        jet
    }

    /// First derivatives.
    pub fn gradient(&self) -> &[f64; N] {
        &self.gradient
    }

    /// The second derivative with respect to variables `i` and `j`.
    pub fn hessian(&self, i: usize, j: usize) -> f64 {
        if i >= j {
            self.hessian[i][j]
        } else {
            self.hessian[j][i]
        }
    }

    /// `f(self)` for a function with value `f0` and derivatives `f1`, `f2` here.
    fn chain(&self, f0: f64, f1: f64, f2: f64) -> Self {
        let mut out = Self::from(f0);
        // Of a power between 1 and 2 at 0, where its base has a minimum, as that of |v|³ = (v·v)^1.5 has at rest: what grows
        // without bound is multiplied by what vanishes faster.
        let bend = |squared: f64| match squared == 0.0 {
            true => 0.0,
            false => f2 * squared,
        };
        for i in 0..N {
            out.gradient[i] = f1 * self.gradient[i];
            for j in 0..=i {
                out.hessian[i][j] =
                    f1 * self.hessian[i][j] + bend(self.gradient[i] * self.gradient[j]);
            }
        }
        out
    }

    fn combine(&self, other: &Self, value: f64, a: f64, b: f64, aa: f64, ab: f64, bb: f64) -> Self {
        let mut out = Self::from(value);
        for i in 0..N {
            let (ui, vi) = (self.gradient[i], other.gradient[i]);
            out.gradient[i] = a * ui + b * vi;
            for j in 0..=i {
                let (uj, vj) = (self.gradient[j], other.gradient[j]);
                out.hessian[i][j] = a * self.hessian[i][j]
                    + b * other.hessian[i][j]
                    + aa * ui * uj
                    + ab * (ui * vj + uj * vi)
                    + bb * vi * vj;
            }
        }
        out
    }
}

impl<const N: usize> From<f64> for Jet<N> {
    fn from(value: f64) -> Self {
        Self {
            value,
            gradient: [0.0; N],
            hessian: [[0.0; N]; N],
        }
    }
}

impl<const N: usize> Add for Jet<N> {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        self.combine(&other, self.value + other.value, 1.0, 1.0, 0.0, 0.0, 0.0)
    }
}

impl<const N: usize> Sub for Jet<N> {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        self.combine(&other, self.value - other.value, 1.0, -1.0, 0.0, 0.0, 0.0)
    }
}

impl<const N: usize> Mul for Jet<N> {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        self.combine(
            &other,
            self.value * other.value,
            other.value,
            self.value,
            0.0,
            1.0,
            0.0,
        )
    }
}

impl<const N: usize> Div for Jet<N> {
    type Output = Self;
    fn div(self, other: Self) -> Self {
        let inverse = 1.0 / other.value;
        let ratio = self.value * inverse;
        let square = inverse * inverse;
        self.combine(
            &other,
            ratio,
            inverse,
            -ratio * inverse,
            0.0,
            -square,
            2.0 * ratio * square,
        )
    }
}

impl<const N: usize> Neg for Jet<N> {
    type Output = Self;
    fn neg(self) -> Self {
        self.chain(-self.value, -1.0, 0.0)
    }
}

impl<const N: usize> Add<f64> for Jet<N> {
    type Output = Self;
    fn add(mut self, other: f64) -> Self {
        self.value += other;
        self
    }
}

impl<const N: usize> Sub<f64> for Jet<N> {
    type Output = Self;
    fn sub(mut self, other: f64) -> Self {
        self.value -= other;
        self
    }
}

impl<const N: usize> Mul<f64> for Jet<N> {
    type Output = Self;
    fn mul(self, other: f64) -> Self {
        self.chain(self.value * other, other, 0.0)
    }
}

impl<const N: usize> Real for Jet<N> {
    fn value(&self) -> f64 {
        self.value
    }
    fn is_constant(&self) -> bool {
        let rows = self.hessian.iter().flatten();
        self.gradient.iter().chain(rows).all(|entry| *entry == 0.0)
    }
    fn sqrt(self) -> Self {
        let root = self.value.sqrt();
        self.chain(root, 0.5 / root, -0.25 / (root * self.value))
    }
    fn sin(self) -> Self {
        let (sin, cos) = self.value.sin_cos();
        self.chain(sin, cos, -sin)
    }
    fn tan(self) -> Self {
        let tan = self.value.tan();
        let slope = 1.0 + tan * tan;
        self.chain(tan, slope, 2.0 * tan * slope)
    }
    fn ln(self) -> Self {
        let inverse = 1.0 / self.value;
        self.chain(self.value.ln(), inverse, -inverse * inverse)
    }
    fn atan2(self, x: Self) -> Self {
        let (y, x0) = (self.value, x.value);
        let r2 = x0 * x0 + y * y;
        let r4 = r2 * r2;
        let mixed = (y * y - x0 * x0) / r4;
        let pure = 2.0 * x0 * y / r4;
        self.combine(&x, y.atan2(x0), x0 / r2, -y / r2, -pure, mixed, pure)
    }
    fn function(self, [value, slope, curvature]: [f64; 3]) -> Self {
        self.chain(value, slope, curvature)
    }
}

#[cfg(test)]
mod tests {
    use super::super::Dual;
    use super::*;
    use num_dual::{DualNum, hessian};

    fn formula<R: Real>(x: R, y: R) -> R {
        (x * y + 2.0).sqrt() * (x / y).sin() - y.atan2(x) + (x * 0.3).tan() * y.ln() - (-x)
    }

    fn derived<R: Real>(x: R, y: R) -> R {
        (x * -0.5).exp() * y.cos() + (x * 0.5).asin() * (y * 0.4).acos()
            - (y * x).atan() * x.powf(2.5)
            + (x - y).abs() * y.powf(-2.0)
    }

    #[test]
    fn derived_functions_agree_with_an_independent_dual_number_library() {
        let (x, y) = (0.7, 1.3);
        let (value, gradient, second) = hessian(
            |v| {
                let (x, y) = (v[0], v[1]);
                (x * -0.5).exp() * y.cos() + (x * 0.5).asin() * (y * 0.4).acos()
                    - (y * x).atan() * x.powf(2.5)
                    + (y - x) * y.powi(-2)
            },
            &nalgebra::SVector::<f64, 2>::new(x, y),
        );
        let jet = derived(Jet::<2>::variable(x, 0), Jet::variable(y, 1));
        let dual = derived(Dual::<2>::variable(x, 0), Dual::variable(y, 1));
        assert!((jet.value() - value).abs() < 1e-14 && (derived(x, y) - value).abs() < 1e-14);
        assert!((dual.value() - value).abs() < 1e-14);
        for i in 0..2 {
            assert!((jet.gradient()[i] - gradient[i]).abs() < 1e-14);
            assert!((dual.gradient()[i] - gradient[i]).abs() < 1e-14);
            for j in 0..2 {
                assert!((jet.hessian(i, j) - second[(i, j)]).abs() < 1e-13);
            }
        }
    }

    #[test]
    fn powers_and_absolute_values_have_derivatives_at_zero() {
        let zero = Jet::<1>::variable(0.0, 0);
        let square = zero.powf(2.0);
        assert_eq!((square.gradient()[0], square.hessian(0, 0)), (0.0, 2.0));
        let cube = zero.abs().powf(3.0);
        assert_eq!((cube.gradient()[0], cube.hessian(0, 0)), (0.0, 0.0));
        assert_eq!(zero.powf(1.0).gradient()[0], 1.0);
    }

    #[test]
    fn first_derivatives_alone_are_those_of_jets() {
        let (x, y) = (0.7, 1.3);
        let jet = formula(Jet::<2>::variable(x, 0), Jet::variable(y, 1));
        let dual = formula(Dual::<2>::variable(x, 0), Dual::variable(y, 1));
        assert!((jet.value() - dual.value()).abs() < 1e-15);
        for i in 0..2 {
            assert!((jet.gradient()[i] - dual.gradient()[i]).abs() < 1e-14);
        }
    }

    #[test]
    fn jets_agree_with_an_independent_dual_number_library() {
        let (x, y) = (0.7, 1.3);
        let (value, gradient, second) = hessian(
            |v| {
                let (x, y) = (v[0], v[1]);
                (x * y + 2.0).sqrt() * (x / y).sin() - y.atan2(x) + (x * 0.3).tan() * y.ln() + x
            },
            &nalgebra::SVector::<f64, 2>::new(x, y),
        );
        let jet = formula(Jet::<2>::variable(x, 0), Jet::variable(y, 1));
        assert!((jet.value() - value).abs() < 1e-14);
        assert!((formula(x, y) - value).abs() < 1e-14);
        for i in 0..2 {
            assert!((jet.gradient()[i] - gradient[i]).abs() < 1e-14);
            for j in 0..2 {
                assert!((jet.hessian(i, j) - second[(i, j)]).abs() < 1e-13);
            }
        }
    }
}
