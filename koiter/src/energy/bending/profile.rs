//! How the tilt of a mid-edge director enters the second fundamental form: the only difference of DCS, DSO and BAC.

use crate::geometry::Real;

/// A function g of the tilt ζ with `II_e = (4 A / ℓ) g(ζ)`.
pub trait AngleProfile: Send + Sync {
    /// Name of the model in scenes.
    const NAME: &'static str;
    /// The tilt must stay below this in absolute value [rad].
    const MAX_TILT: f64;
    /// g, g′, g″.
    fn eval(tilt: f64) -> [f64; 3];
    /// g over any numbers: the oracle of the tests.
    fn formula<R: Real>(tilt: R) -> R;
    /// |∂d/∂ζ|² of the director at this tilt: the factor of its inertia ("Better Bending", Eqs. 51, 52).
    fn director_stretch_squared(_tilt: f64) -> f64 {
        1.0
    }
}

/// Discrete Cosserat shell (DCS): g = sin ζ, a unit director. Its penalty on sharp folds is bounded, so folds lock.
pub struct Sine;

/// Second-order director (DSO): g = ζ. Quadratic in the edge angles; no barrier against closed folds.
pub struct Identity;

/// Bending-Active Cosserat (BAC): g = tan ζ. Diverges as |ζ| → π/2, so an under-resolved fold cannot close on itself.
pub struct Tangent;

impl AngleProfile for Sine {
    const NAME: &'static str = "dcs";
    const MAX_TILT: f64 = f64::INFINITY;
    fn eval(tilt: f64) -> [f64; 3] {
        let (sin, cos) = tilt.sin_cos();
        [sin, cos, -sin]
    }
    fn formula<R: Real>(tilt: R) -> R {
        tilt.sin()
    }
}

impl AngleProfile for Identity {
    const NAME: &'static str = "dso";
    const MAX_TILT: f64 = f64::INFINITY;
    fn eval(tilt: f64) -> [f64; 3] {
        [tilt, 1.0, 0.0]
    }
    fn formula<R: Real>(tilt: R) -> R {
        tilt
    }
}

impl AngleProfile for Tangent {
    const NAME: &'static str = "bac";
    const MAX_TILT: f64 = std::f64::consts::FRAC_PI_2;
    fn eval(tilt: f64) -> [f64; 3] {
        let tan = tilt.tan();
        let slope = 1.0 + tan * tan;
        [tan, slope, 2.0 * tan * slope]
    }
    fn formula<R: Real>(tilt: R) -> R {
        tilt.tan()
    }
    fn director_stretch_squared(tilt: f64) -> f64 {
        tilt.cos().powi(-4)
    }
}
