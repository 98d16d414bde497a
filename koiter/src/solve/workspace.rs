//! Pattern, matrix and factor of the linear systems, kept from step to step.

use std::sync::Arc;

use super::cholesky::{Factorization, SparseCholesky};
use super::ordering::{NodeOrdering, nested_dissection};
use crate::assembly::{CoupledPairs, DofLayout, Energy, Pattern, PatternBuilder, SymmetricMatrix};

/// Pattern, matrix and factor, kept between steps.
#[derive(Default)]
pub struct LinearWorkspace {
    static_pairs: Option<CoupledPairs>,
    changing_pairs: CoupledPairs,
    ordering: Option<NodeOrdering>,
    entries_at_ordering: usize,
    pub(super) matrix: Option<SymmetricMatrix>,
    pub(super) factor: Factorization,
}

/// Shifts to try, relative to the diagonal, when a factorisation fails.
const SHIFTS: [f64; 6] = [1e-8, 1e-6, 1e-4, 1e-2, 1.0, 1e2];

/// Contacts make the factor fuller than the order was made for; beyond this ratio a new order pays.
const REORDER_GROWTH: f64 = 1.5;

impl LinearWorkspace {
    /// Stored entries of the lower triangle.
    pub fn entries(&self) -> usize {
        self.matrix.as_ref().map_or(0, |m| m.values.len())
    }

    /// The matrix of the last assembly.
    pub fn matrix(&self) -> Option<&SymmetricMatrix> {
        self.matrix.as_ref()
    }

    /// Makes the pattern hold all couplings of the energies at `q`; keeps it if it does already.
    pub fn update_pattern(
        &mut self,
        energies: &mut [&mut dyn Energy],
        layout: &DofLayout,
        q: &[f64],
    ) {
        let collect = |energies: &[&mut dyn Energy], changing: bool| {
            let mut builder = PatternBuilder::default();
            for energy in energies
                .iter()
                .filter(|e| e.has_changing_pattern() == changing)
            {
                energy.add_to_pattern(q, &mut builder);
            }
            builder.finish()
        };
        let new_topology = self.static_pairs.is_none();
        let static_pairs = self
            .static_pairs
            .get_or_insert_with(|| collect(energies, false));
        let needed = collect(energies, true);
        if !new_topology && self.changing_pairs.contains_all(&needed) {
            return;
        }
        // Couplings of earlier contacts are kept as explicit zeros while they are few: contacts flicker.
        let kept = if self.changing_pairs.len() <= 2 * needed.len() {
            &self.changing_pairs
        } else {
            &CoupledPairs::default()
        };
        self.changing_pairs = kept.union(&needed);
        let pattern = Arc::new(Pattern::new(
            layout,
            &static_pairs.union(&self.changing_pairs),
        ));
        for energy in energies.iter_mut() {
            energy.bind(&pattern);
        }
        let ordering = self
            .ordering
            .get_or_insert_with(|| nested_dissection(&pattern));
        self.factor.analyze(&pattern, ordering);
        if new_topology {
            self.entries_at_ordering = self.factor.factor_entries();
        } else if self.factor.factor_entries() as f64
            > REORDER_GROWTH * self.entries_at_ordering as f64
        {
            *ordering = nested_dissection(&pattern);
            self.factor.analyze(&pattern, ordering);
            self.entries_at_ordering = self.factor.factor_entries();
        }
        self.matrix = Some(SymmetricMatrix::zeros(pattern));
    }

    /// Factorises the assembled matrix, with a diagonal shift if it must be; returns the number of shifts tried.
    pub(super) fn factorize(&mut self) -> Result<usize, usize> {
        let matrix = self.matrix.as_mut().expect("the matrix was assembled");
        let Err(mut failure) = self.factor.factorize(matrix) else {
            return Ok(0);
        };
        let pattern = Arc::clone(&matrix.pattern);
        let mut applied = 0.0;
        for (attempt, shift) in SHIFTS.iter().enumerate() {
            for &position in pattern.diagonal_positions() {
                let value = &mut matrix.values[position as usize];
                *value = *value / (1.0 + applied) * (1.0 + shift);
            }
            applied = *shift;
            match self.factor.factorize(matrix) {
                Ok(()) => return Ok(attempt + 1),
                Err(error) => failure = error,
            }
        }
        Err(failure.dof)
    }
}
