//! Numbers that carry first derivatives only: [`super::Jet`] where no Hessian is wanted, at a fraction of its cost.

use std::ops::{Add, Div, Mul, Neg, Sub};

use super::Real;

/// Value and gradient with respect to `N` variables.
#[derive(Clone, Copy, Debug)]
pub struct Dual<const N: usize> {
    value: f64,
    gradient: [f64; N],
}

impl<const N: usize> Dual<N> {
    /// The variable number `index`, at `value`.
    pub fn variable(value: f64, index: usize) -> Self {
        let mut dual = Self::from(value);
        dual.gradient[index] = 1.0;
        dual
    }

    /// First derivatives.
    pub fn gradient(&self) -> &[f64; N] {
        &self.gradient
    }

    /// A function of two numbers with this value and these derivatives by them.
    fn combine(&self, other: &Self, value: f64, a: f64, b: f64) -> Self {
        let gradient = std::array::from_fn(|i| a * self.gradient[i] + b * other.gradient[i]);
        Self { value, gradient }
    }

    fn chain(&self, value: f64, slope: f64) -> Self {
        let gradient = self.gradient.map(|g| slope * g);
        Self { value, gradient }
    }
}

impl<const N: usize> From<f64> for Dual<N> {
    fn from(value: f64) -> Self {
        let gradient = [0.0; N];
        Self { value, gradient }
    }
}

impl<const N: usize> Add for Dual<N> {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        self.combine(&other, self.value + other.value, 1.0, 1.0)
    }
}

impl<const N: usize> Sub for Dual<N> {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        self.combine(&other, self.value - other.value, 1.0, -1.0)
    }
}

impl<const N: usize> Mul for Dual<N> {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        self.combine(&other, self.value * other.value, other.value, self.value)
    }
}

impl<const N: usize> Div for Dual<N> {
    type Output = Self;
    fn div(self, other: Self) -> Self {
        let inverse = 1.0 / other.value;
        let ratio = self.value * inverse;
        self.combine(&other, ratio, inverse, -ratio * inverse)
    }
}

impl<const N: usize> Neg for Dual<N> {
    type Output = Self;
    fn neg(self) -> Self {
        self.chain(-self.value, -1.0)
    }
}

impl<const N: usize> Add<f64> for Dual<N> {
    type Output = Self;
    fn add(mut self, other: f64) -> Self {
        self.value += other;
        self
    }
}

impl<const N: usize> Sub<f64> for Dual<N> {
    type Output = Self;
    fn sub(mut self, other: f64) -> Self {
        self.value -= other;
        self
    }
}

impl<const N: usize> Mul<f64> for Dual<N> {
    type Output = Self;
    fn mul(self, other: f64) -> Self {
        self.chain(self.value * other, other)
    }
}

impl<const N: usize> Real for Dual<N> {
    fn value(&self) -> f64 {
        self.value
    }
    fn is_constant(&self) -> bool {
        self.gradient == [0.0; N]
    }
    fn sqrt(self) -> Self {
        let root = self.value.sqrt();
        self.chain(root, 0.5 / root)
    }
    fn sin(self) -> Self {
        let (sin, cos) = self.value.sin_cos();
        self.chain(sin, cos)
    }
    fn tan(self) -> Self {
        let tan = self.value.tan();
        self.chain(tan, 1.0 + tan * tan)
    }
    fn ln(self) -> Self {
        self.chain(self.value.ln(), 1.0 / self.value)
    }
    fn atan2(self, x: Self) -> Self {
        let (y, x0) = (self.value, x.value);
        let r2 = x0 * x0 + y * y;
        self.combine(&x, y.atan2(x0), x0 / r2, -y / r2)
    }
    fn function(self, [value, slope, _]: [f64; 3]) -> Self {
        self.chain(value, slope)
    }
}
