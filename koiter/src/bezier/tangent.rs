//! Which second derivatives Newton's method works with.

/// Which derivative of the forces.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Tangent {
    /// `E K Eᵀ`: never indefinite.
    Corotated,
    /// So much of the consistent tangent, the rest the corotated one.
    Share(f64),
    /// With the stiffness of the forces as they turn: Newton's method converges quadratically, nearly.
    Consistent,
}

impl Tangent {
    /// How much of it is the consistent tangent.
    pub(super) fn share(self) -> f64 {
        match self {
            Self::Corotated => 0.0,
            Self::Share(share) => share,
            Self::Consistent => 1.0,
        }
    }

    pub(super) fn of_share(share: f64) -> Self {
        match share {
            0.0 => Self::Corotated,
            1.0 => Self::Consistent,
            share => Self::Share(share),
        }
    }
}
