//! Pattern, matrix and factor of the linear systems, kept from step to step.

use std::sync::Arc;

use super::cholesky::{LinearSolver, SparseCholesky};
use super::ordering::{NodeOrdering, nested_dissection};
use crate::assembly::{
    CoupledPairs, DofLayout, Energy, NodeId, Pattern, PatternBuilder, SymmetricMatrix,
};

/// What a [`LinearWorkspace`] owes to the past: which contacts came before decides the order of elimination and the
/// explicit zeros of the matrix, and with them the last bits of every solution.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct WorkspaceHistory {
    /// Couplings by contacts, column and row node with the column the smaller, sorted.
    pub changing_pairs: Vec<[u32; 2]>,
    /// The nodes in their order of elimination; empty before the first solve.
    pub node_order: Vec<u32>,
    /// Entries of the factor when the order was made.
    pub entries_at_ordering: u64,
}

/// Pattern, matrix and factor, kept between steps.
pub struct LinearWorkspace {
    static_pairs: Option<CoupledPairs>,
    changing_pairs: CoupledPairs,
    ordering: Option<NodeOrdering>,
    entries_at_ordering: usize,
    pub(super) matrix: Option<SymmetricMatrix>,
    pub(super) factor: Box<dyn SparseCholesky>,
}

/// Shifts to try, relative to the diagonal, when a factorisation fails.
const SHIFTS: [f64; 7] = [1e-8, 1e-6, 1e-4, 1e-2, 1.0, 4.0, 1e2];

/// Below this a multiple of the diagonal is lost in its round-off.
const LEAST_SHIFT: f64 = 1e-14;

/// Halvings, in logarithms, of the bracket of the least shift: from a factor of 100 to one of 1.02.
const SHIFT_BISECTIONS: usize = 8;

/// Contacts make the factor fuller than the order was made for; beyond this ratio a new order pays.
const REORDER_GROWTH: f64 = 1.5;

impl Default for LinearWorkspace {
    fn default() -> Self {
        Self::new(LinearSolver::default())
    }
}

impl LinearWorkspace {
    /// An empty workspace that will use the given factorisation.
    pub fn new(solver: LinearSolver) -> Self {
        Self {
            static_pairs: None,
            changing_pairs: CoupledPairs::default(),
            ordering: None,
            entries_at_ordering: 0,
            matrix: None,
            factor: solver.create(),
        }
    }

    /// Stored entries of the lower triangle.
    pub fn entries(&self) -> usize {
        self.matrix.as_ref().map_or(0, |m| m.values.len())
    }

    /// The matrix of the last assembly.
    pub fn matrix(&self) -> Option<&SymmetricMatrix> {
        self.matrix.as_ref()
    }

    /// What the coming solves owe to those so far.
    pub fn history(&self) -> WorkspaceHistory {
        let order = self.ordering.as_ref().map(NodeOrdering::nodes);
        WorkspaceHistory {
            changing_pairs: (self.changing_pairs.iter().map(|(a, b)| [a.0, b.0])).collect(),
            node_order: order.unwrap_or_default().to_vec(),
            entries_at_ordering: self.entries_at_ordering as u64,
        }
    }

    /// A workspace that goes on as the one did whose history it is.
    ///
    /// # Errors
    /// A history that is not of a system with these unknowns, in words.
    pub fn with_history(history: &WorkspaceHistory, layout: &DofLayout) -> Result<Self, String> {
        let num_nodes = layout.num_solved_nodes() as u32;
        let mut pairs = PatternBuilder::default();
        for &[column, row] in &history.changing_pairs {
            if column >= row || row >= layout.num_nodes() as u32 {
                return Err(format!("it couples nodes {column} and {row}"));
            }
            pairs.couple([NodeId(column), NodeId(row)]);
        }
        let mut sorted = history.node_order.clone();
        sorted.sort_unstable();
        if !sorted.is_empty() && !sorted.iter().copied().eq(0..num_nodes) {
            return Err(format!("its order is not one of {num_nodes} nodes"));
        }
        Ok(Self {
            changing_pairs: pairs.finish(),
            ordering: (!sorted.is_empty()).then(|| NodeOrdering::of(history.node_order.clone())),
            entries_at_ordering: history.entries_at_ordering as usize,
            ..Self::default()
        })
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
        let static_pairs = self
            .static_pairs
            .get_or_insert_with(|| collect(energies, false));
        let needed = collect(energies, true);
        if self.changing_pairs.contains_all(&needed) {
            // After `with_history` the couplings are there before the matrix is.
            if self.matrix.is_some() {
                return;
            }
        } else {
            // Couplings of earlier contacts are kept as explicit zeros while they are few: contacts flicker.
            let kept = if self.changing_pairs.len() <= 2 * needed.len() {
                &self.changing_pairs
            } else {
                &CoupledPairs::default()
            };
            self.changing_pairs = kept.union(&needed);
        }
        let pattern = Arc::new(Pattern::new(
            layout,
            &static_pairs.union(&self.changing_pairs),
        ));
        for energy in energies.iter_mut() {
            energy.bind(&pattern);
        }
        let is_first = self.ordering.is_none();
        let ordering = self
            .ordering
            .get_or_insert_with(|| nested_dissection(&pattern));
        self.factor.analyze(&pattern, ordering);
        if is_first {
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

    /// Factorises the assembled matrix.
    ///
    /// # Errors
    /// The unknown whose pivot is not positive.
    pub(super) fn factorize(&mut self) -> Result<(), usize> {
        let matrix = self.matrix.as_ref().expect("the matrix was assembled");
        self.factor.factorize(matrix).map_err(|failure| failure.dof)
    }

    /// Factorises the assembled matrix, with a shift of the diagonal of free unknowns if it must be; returns the number of
    /// shifts tried.
    ///
    /// # Errors
    /// The unknown whose pivot is not positive after the largest shift.
    pub(super) fn factorize_shifted(&mut self, is_fixed: &[bool]) -> Result<usize, usize> {
        let Err(mut failure) = self.factorize() else {
            return Ok(0);
        };
        let diagonal = self.diagonal();
        let sizes = sizes(&diagonal);
        for (attempt, shift) in SHIFTS.iter().enumerate() {
            match self.factorize_with(&diagonal, &sizes, *shift, is_fixed) {
                Ok(()) => return Ok(attempt + 1),
                Err(dof) => failure = dof,
            }
        }
        Err(failure)
    }

    /// Factorises an indefinite matrix with nearly the least multiple of the diagonal that makes it definite, and returns
    /// what was added to the diagonal; `None` if no multiple is enough.
    pub(super) fn factorize_barely(&mut self, is_fixed: &[bool]) -> Option<Vec<f64>> {
        let diagonal = self.diagonal();
        let sizes = sizes(&diagonal);
        let mut try_shift = |shift| self.factorize_with(&diagonal, &sizes, shift, is_fixed);
        let enough = SHIFTS.iter().position(|shift| try_shift(*shift).is_ok())?;
        let mut large = SHIFTS[enough];
        let mut small = match enough {
            0 => LEAST_SHIFT,
            _ => SHIFTS[enough - 1],
        };
        for _ in 0..SHIFT_BISECTIONS {
            let middle = (small * large).sqrt();
            match try_shift(middle) {
                Ok(()) => large = middle,
                Err(_) => small = middle,
            }
        }
        try_shift(large).ok()?;
        let shifted = self.diagonal().into_iter().zip(&diagonal);
        Some(shifted.map(|(after, before)| after - before).collect())
    }

    /// The diagonal of the assembled matrix.
    pub(super) fn diagonal(&self) -> Vec<f64> {
        let matrix = self.matrix.as_ref().expect("the matrix was assembled");
        let positions = matrix.pattern.diagonal_positions().iter();
        positions.map(|&p| matrix.values[p as usize]).collect()
    }

    /// Factorises with `diagonal + shift · scale` for the diagonal of free unknowns.
    ///
    /// # Errors
    /// The unknown whose pivot is not positive.
    pub(super) fn factorize_with(
        &mut self,
        diagonal: &[f64],
        scale: &[f64],
        shift: f64,
        is_fixed: &[bool],
    ) -> Result<(), usize> {
        let matrix = self.matrix.as_mut().expect("the matrix was assembled");
        let pattern = Arc::clone(&matrix.pattern);
        let positions = pattern.diagonal_positions().iter().enumerate();
        for (dof, &position) in positions.filter(|(dof, _)| !is_fixed[*dof]) {
            matrix.values[position as usize] = diagonal[dof] + shift * scale[dof];
        }
        self.factor.factorize(matrix).map_err(|error| error.dof)
    }
}

/// Absolute values: an exact Hessian may have negative entries on its diagonal.
fn sizes(diagonal: &[f64]) -> Vec<f64> {
    diagonal.iter().map(|d| d.abs()).collect()
}

/// The mean of the sizes of the entries that are not fixed.
pub(super) fn mean_size(diagonal: &[f64], is_fixed: &[bool]) -> f64 {
    let free = diagonal.iter().zip(is_fixed).filter(|(_, fixed)| !**fixed);
    let (sum, count) = free.fold((0.0, 0), |(sum, count), (d, _)| (sum + d.abs(), count + 1));
    sum / f64::from(count.max(1))
}
