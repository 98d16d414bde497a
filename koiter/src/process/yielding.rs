//! Plastic flow: rest values go after what is measured, where that is too far away.
//!
//! ```text
//! f = |s − s̄| − y − H p > 0:    s̄˙ = r f (s − s̄)/|s − s̄|,    ṗ = |s̄˙|
//! ```
//!
//! s measures of bending, s̄ their rest values, y threshold, H hardening (by how much the threshold grows with the flow p), r
//! rate [1/s]. Over a step the shape is held, and f falls with `exp(−r (1 + H) Δt)`: the exact flow, never beyond the
//! threshold, also of an infinite rate, which is plasticity without viscosity. It lowers the energy of bending by itself, so a
//! step can only lose energy to it. The flow of a step is that of the shape at its start: of first order in the step.
//!
//! |·| of a hinge angle is its size, of a second fundamental form `√(κ₁₁² + κ₂₂² + 2 κ₁₂²)`, which does not depend on axes.

use super::{Process, RestState, Window};

/// What yields as one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Measure {
    /// A number: an angle, or the curvature of an edge.
    Number,
    /// A form of components `11, 22, 12`.
    Form,
}

impl Measure {
    /// Numbers of one measure.
    pub fn size(self) -> usize {
        match self {
            Self::Number => 1,
            Self::Form => 3,
        }
    }

    fn norm(self, values: &[f64]) -> f64 {
        match (self, values) {
            (Self::Form, [a, b, c]) => (a * a + b * b + 2.0 * c * c).sqrt(),
            _ => values[0].abs(),
        }
    }
}

/// Plastic flow of all measures of a shell.
#[derive(Clone, Debug, PartialEq)]
pub struct Yielding {
    /// What yields as one.
    pub measure: Measure,
    /// y [rad or 1/m].
    pub threshold: f64,
    /// r [1/s]; infinite: at once.
    pub rate: f64,
    /// H.
    pub hardening: f64,
}

impl Process for Yielding {
    fn advance(&self, rest: &mut RestState, window: &Window<'_>) {
        let size = self.measure.size();
        rest.flow.resize(rest.curvature.len() / size, 0.0);
        // 1 − exp(−r (1 + H) Δt), without cancellation.
        let share = -(-self.rate * (1.0 + self.hardening) * window.dt).exp_m1();
        let measured = window.measured.chunks_exact(size);
        let values = rest.curvature.chunks_exact_mut(size).zip(measured);
        for ((rest, measured), flow) in values.zip(&mut rest.flow) {
            let mut offset = [0.0; 3];
            for (offset, (s, rest)) in offset.iter_mut().zip(measured.iter().zip(&*rest)) {
                *offset = s - rest;
            }
            let distance = self.measure.norm(&offset[..size]);
            let excess = distance - self.threshold - self.hardening * *flow;
            if excess > 0.0 {
                let flowed = share * excess / (1.0 + self.hardening);
                *flow += flowed;
                for (rest, offset) in rest.iter_mut().zip(&offset) {
                    *rest += flowed * offset / distance;
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn yielding(measure: Measure) -> Yielding {
        Yielding {
            measure,
            threshold: 0.1,
            rate: f64::INFINITY,
            hardening: 0.5,
        }
    }

    fn advance(process: &Yielding, rest: &mut RestState, measured: &[f64], dt: f64) {
        let factors = [1.0; 2];
        process.advance(
            rest,
            &Window {
                measured,
                factors,
                dt,
            },
        );
    }

    #[test]
    fn below_the_threshold_nothing_flows() {
        let mut rest = RestState {
            curvature: vec![0.2, -0.3],
            ..RestState::default()
        };
        advance(&yielding(Measure::Number), &mut rest, &[0.29, -0.39], 1.0);
        assert_eq!((rest.curvature, rest.flow), (vec![0.2, -0.3], vec![0.0; 2]));
    }

    #[test]
    fn without_viscosity_the_state_returns_to_a_threshold_that_has_hardened() {
        let process = yielding(Measure::Number);
        let mut rest = RestState {
            curvature: vec![0.0],
            ..RestState::default()
        };
        for measured in [1.0, 1.5, -2.0] {
            advance(&process, &mut rest, &[measured], 0.01);
            let threshold = 0.1 + 0.5 * rest.flow[0];
            let distance = (measured - rest.curvature[0]).abs();
            assert!(
                (distance - threshold).abs() < 1e-15,
                "{distance} {threshold}"
            );
        }
        // There and back adds up.
        assert!(rest.flow[0] > rest.curvature[0].abs());
    }

    #[test]
    fn with_a_rate_the_excess_falls_exponentially_in_any_steps() {
        let process = Yielding {
            rate: 3.0,
            ..yielding(Measure::Number)
        };
        let run = |steps: usize| {
            let mut rest = RestState {
                curvature: vec![0.0],
                ..RestState::default()
            };
            (0..steps).for_each(|_| advance(&process, &mut rest, &[1.0], 0.2 / steps as f64));
            rest.curvature[0]
        };
        let expected = 0.9 / 1.5 * (1.0 - (-3.0f64 * 1.5 * 0.2).exp());
        assert!((run(1) - expected).abs() < 1e-15);
        // Sums of exponentials, rounded.
        assert!((run(7) - expected).abs() < 1e-14);
    }

    #[test]
    fn forms_flow_along_their_difference_whatever_the_axes() {
        let process = yielding(Measure::Form);
        let flow = |measured: [f64; 3]| {
            let mut rest = RestState {
                curvature: vec![0.0; 3],
                ..RestState::default()
            };
            advance(&process, &mut rest, &measured, 1.0);
            (rest.curvature, rest.flow[0])
        };
        let (along, flowed) = flow([1.0, 0.0, 0.0]);
        assert_eq!(along, [flowed, 0.0, 0.0]);
        // The same bend seen from axes at 45°.
        let (turned, same) = flow([0.5, 0.5, 0.5]);
        assert!((same - flowed).abs() < 1e-15);
        assert!(turned.iter().all(|x| (x - 0.5 * flowed).abs() < 1e-15));
    }
}
