//! A symmetric sparse matrix of fixed pattern, lower triangle by columns, made of blocks of nodes.
//!
//! All columns of a node share one list of rows, so a block needs one stored position: with `L` the length of the first
//! of the node's columns, the entry `(r, c)` of a block whose first entry stands at `p` stands at
//! `p + c L − c (c + 1) / 2 + r` (each further column is one entry shorter, at its top).

use std::sync::Arc;

use super::{DofLayout, NodeId};

/// Collects the pairs of nodes that are coupled.
#[derive(Clone, Debug, Default)]
pub struct PatternBuilder {
    pairs: Vec<u64>,
}

fn key(column: NodeId, row: NodeId) -> u64 {
    (u64::from(column.0) << 32) | u64::from(row.0)
}

impl PatternBuilder {
    /// Couples all pairs of the given nodes.
    pub fn couple(&mut self, nodes: impl IntoIterator<Item = NodeId> + Clone) {
        for (i, a) in nodes.clone().into_iter().enumerate() {
            for b in nodes.clone().into_iter().take(i) {
                if a != b {
                    self.pairs.push(key(a.min(b), a.max(b)));
                }
            }
        }
    }

    /// The pairs, sorted and without repetition.
    pub fn finish(mut self) -> CoupledPairs {
        self.pairs.sort_unstable();
        self.pairs.dedup();
        CoupledPairs(self.pairs)
    }
}

/// Pairs of coupled nodes, sorted by column and row.
#[derive(Clone, Debug, Default)]
pub struct CoupledPairs(Vec<u64>);

impl CoupledPairs {
    /// Whether every pair of `other` is among these.
    pub fn contains_all(&self, other: &Self) -> bool {
        other
            .0
            .iter()
            .all(|pair| self.0.binary_search(pair).is_ok())
    }

    /// Number of pairs.
    pub fn len(&self) -> usize {
        self.0.len()
    }

    /// Whether there is no pair.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// The union of two sets of pairs.
    pub fn union(&self, other: &Self) -> Self {
        let (mut a, mut b) = (self.0.iter().peekable(), other.0.iter().peekable());
        let mut merged = Vec::with_capacity(self.0.len() + other.0.len());
        loop {
            let next = match (a.peek(), b.peek()) {
                (Some(&&x), Some(&&y)) => x.min(y),
                (Some(&&x), None) | (None, Some(&&x)) => x,
                (None, None) => break,
            };
            a.next_if(|&&x| x == next);
            b.next_if(|&&y| y == next);
            merged.push(next);
        }
        Self(merged)
    }

    /// Column and row node of each pair; the column is the smaller.
    pub fn iter(&self) -> impl Iterator<Item = (NodeId, NodeId)> + '_ {
        self.0
            .iter()
            .map(|&pair| (NodeId((pair >> 32) as u32), NodeId(pair as u32)))
    }
}

/// Where the entries of a symmetric matrix are.
#[derive(Debug)]
pub struct Pattern {
    node_start: Vec<u32>,
    block_start: Vec<u32>,
    block_row: Vec<u32>,
    block_offset: Vec<u32>,
    first_column_length: Vec<u32>,
    column_start: Vec<u32>,
    row_index: Vec<u32>,
}

impl Pattern {
    /// The pattern of the solved nodes of `layout` with the given couplings and full diagonal blocks.
    ///
    /// # Panics
    /// If the matrix would have more than 2³² entries.
    pub fn new(layout: &DofLayout, pairs: &CoupledPairs) -> Self {
        let num_nodes = layout.num_solved_nodes();
        let num_dofs = layout.num_solved_dofs();
        let node_start: Vec<u32> = (0..=num_nodes)
            .map(|n| if n == num_nodes { num_dofs } else { layout.start(NodeId(n as u32)) } as u32)
            .collect();
        let mut pattern = Self {
            node_start,
            block_start: Vec::with_capacity(num_nodes + 1),
            block_row: Vec::with_capacity(pairs.len() + num_nodes),
            block_offset: Vec::with_capacity(pairs.len() + num_nodes),
            first_column_length: Vec::with_capacity(num_nodes),
            column_start: Vec::with_capacity(num_dofs + 1),
            row_index: Vec::new(),
        };
        let mut remaining = pairs.0.iter().peekable();
        let mut rows: Vec<u32> = Vec::new();
        pattern.column_start.push(0);
        for node in 0..num_nodes as u32 {
            pattern.block_start.push(pattern.block_row.len() as u32);
            rows.clear();
            let add_block = |row: u32, pattern: &mut Self, rows: &mut Vec<u32>| {
                pattern.block_row.push(row);
                pattern.block_offset.push(rows.len() as u32);
                rows.extend(pattern.node_start[row as usize]..pattern.node_start[row as usize + 1]);
            };
            add_block(node, &mut pattern, &mut rows);
            while let Some(&pair) = remaining.next_if(|&&pair| (pair >> 32) as u32 == node) {
                if (pair as u32 as usize) < num_nodes {
                    add_block(pair as u32, &mut pattern, &mut rows);
                }
            }
            pattern.first_column_length.push(rows.len() as u32);
            for column in 0..pattern.size(NodeId(node)) {
                pattern.row_index.extend_from_slice(&rows[column..]);
                let end = u32::try_from(pattern.row_index.len())
                    .expect("the matrix has fewer than 2^32 entries");
                pattern.column_start.push(end);
            }
        }
        pattern.block_start.push(pattern.block_row.len() as u32);
        pattern
    }

    /// Number of unknowns of a node.
    pub fn size(&self, node: NodeId) -> usize {
        let n = node.0 as usize;
        (self.node_start[n + 1] - self.node_start[n]) as usize
    }

    /// Entries of the first column of a node.
    pub fn first_column_length(&self, node: NodeId) -> u32 {
        self.first_column_length[node.0 as usize]
    }

    /// Number of rows.
    pub fn num_rows(&self) -> usize {
        self.column_start.len() - 1
    }

    /// Number of nodes.
    pub fn num_nodes(&self) -> usize {
        self.first_column_length.len()
    }

    /// Stored entries (lower triangle with diagonal).
    pub fn num_entries(&self) -> usize {
        self.row_index.len()
    }

    /// Start of each column among the entries.
    pub fn column_starts(&self) -> &[u32] {
        &self.column_start
    }

    /// Row of each entry.
    pub fn row_indices(&self) -> &[u32] {
        &self.row_index
    }

    /// Positions of the diagonal entries.
    pub fn diagonal_positions(&self) -> &[u32] {
        &self.column_start[..self.num_rows()]
    }

    /// First unknown of each node, with one past the last.
    pub fn node_starts(&self) -> &[u32] {
        &self.node_start
    }

    /// Nodes coupled to `node` that are not before it, itself first.
    pub fn coupled(&self, node: NodeId) -> &[u32] {
        let n = node.0 as usize;
        &self.block_row[self.block_start[n] as usize..self.block_start[n + 1] as usize]
    }

    /// Position of the first entry of the block `(row, column)`, `row ≥ column`; `None` if the nodes are not coupled or
    /// not solved for.
    pub fn slot(&self, row: NodeId, column: NodeId) -> Option<u32> {
        debug_assert!(row >= column);
        if row.0 as usize >= self.num_nodes() {
            return None;
        }
        let index = self.coupled(column).binary_search(&row.0).ok()?;
        let block = self.block_start[column.0 as usize] as usize + index;
        Some(
            self.column_start[self.node_start[column.0 as usize] as usize]
                + self.block_offset[block],
        )
    }
}

/// Values over a [`Pattern`].
#[derive(Clone, Debug)]
pub struct SymmetricMatrix {
    /// Where the entries are.
    pub pattern: Arc<Pattern>,
    /// The entries.
    pub values: Vec<f64>,
}

impl SymmetricMatrix {
    /// The zero matrix.
    pub fn zeros(pattern: Arc<Pattern>) -> Self {
        let values = vec![0.0; pattern.num_entries()];
        Self { pattern, values }
    }

    /// Adds a block of local entries `(r, c) ↦ entry(r, c)`; of a diagonal block only `r ≥ c` is read.
    #[inline]
    pub fn add_block(
        &mut self,
        slot: u32,
        column: NodeId,
        [rows, columns]: [usize; 2],
        diagonal: bool,
        entry: impl Fn(usize, usize) -> f64,
    ) {
        let length = self.pattern.first_column_length[column.0 as usize] as usize;
        for c in 0..columns {
            let start = slot as usize + c * length - c * (c + 1) / 2;
            let first = if diagonal { c } else { 0 };
            for (r, value) in self.values[start + first..start + rows]
                .iter_mut()
                .enumerate()
            {
                *value += entry(r + first, c);
            }
        }
    }

    /// Fixes unknowns: their rows and columns become those of the identity and `rhs` is moved accordingly, so that the
    /// solution takes the value `step[i]` there.
    pub fn fix(&mut self, is_fixed: &[bool], step: &[f64], rhs: &mut [f64]) {
        let pattern = Arc::clone(&self.pattern);
        for column in 0..pattern.num_rows() {
            let range =
                pattern.column_start[column] as usize..pattern.column_start[column + 1] as usize;
            let mut moved = 0.0;
            for (value, &row) in self.values[range.clone()]
                .iter_mut()
                .zip(&pattern.row_index[range])
            {
                let row = row as usize;
                if row == column {
                    if is_fixed[column] {
                        *value = 1.0;
                    }
                    continue;
                }
                match (is_fixed[row], is_fixed[column]) {
                    (false, false) => continue,
                    (true, false) => moved += *value * step[row],
                    (false, true) => rhs[row] -= *value * step[column],
                    (true, true) => {}
                }
                *value = 0.0;
            }
            rhs[column] -= moved;
        }
        for (i, fixed) in is_fixed.iter().enumerate() {
            if *fixed {
                rhs[i] = step[i];
            }
        }
    }

    /// `self · x`.
    pub fn multiply(&self, x: &[f64]) -> Vec<f64> {
        let mut y = vec![0.0; x.len()];
        for column in 0..self.pattern.num_rows() {
            let range = self.pattern.column_start[column] as usize
                ..self.pattern.column_start[column + 1] as usize;
            for (value, &row) in self.values[range.clone()]
                .iter()
                .zip(&self.pattern.row_index[range])
            {
                let row = row as usize;
                y[row] += value * x[column];
                if row != column {
                    y[column] += value * x[row];
                }
            }
        }
        y
    }
}

/// Where energies add their second derivatives: the matrix, and the force that prescribed motions exert through it.
pub struct HessianBuilder<'a> {
    /// The matrix over the solved unknowns.
    pub matrix: &'a mut SymmetricMatrix,
    /// The grouping of the unknowns.
    pub layout: &'a DofLayout,
    /// Steps of the unknowns that are not solved for; entry `i` is for unknown `num_solved_dofs + i`.
    pub prescribed_step: &'a [f64],
    /// H_solved,prescribed · `prescribed_step`, accumulated.
    pub coupling: &'a mut [f64],
}

impl HessianBuilder<'_> {
    /// Adds the block of nodes `a` and `b` with local entries `(i in a, j in b)`; called once for each unordered pair of
    /// different local nodes and once for each node with itself. Two local nodes may be the same node.
    #[inline]
    pub fn add(
        &mut self,
        a: NodeId,
        b: NodeId,
        same_local_node: bool,
        entry: impl Fn(usize, usize) -> f64,
    ) {
        let (size_a, size_b) = (self.layout.size(a), self.layout.size(b));
        let solved = self.layout.num_solved_nodes() as u32;
        match (a.0 < solved, b.0 < solved) {
            (true, true) => {
                let (row, column) = (a.max(b), a.min(b));
                let slot = self
                    .matrix
                    .pattern
                    .slot(row, column)
                    .expect("coupled nodes were registered");
                self.add_at(slot, a, b, same_local_node, entry);
            }
            (true, false) => self.add_coupling(a, b, size_a, size_b, &entry),
            (false, true) => self.add_coupling(b, a, size_b, size_a, &|j, i| entry(i, j)),
            (false, false) => {}
        }
    }

    /// The same at a known slot, for two solved nodes.
    #[inline]
    pub fn add_at(
        &mut self,
        slot: u32,
        a: NodeId,
        b: NodeId,
        same_local_node: bool,
        entry: impl Fn(usize, usize) -> f64,
    ) {
        let (size_a, size_b) = (self.layout.size(a), self.layout.size(b));
        if a > b {
            self.matrix
                .add_block(slot, b, [size_a, size_b], false, entry);
        } else if a < b {
            self.matrix
                .add_block(slot, a, [size_b, size_a], false, |r, c| entry(c, r));
        } else if same_local_node {
            self.matrix
                .add_block(slot, a, [size_a, size_a], true, entry);
        } else {
            // The node occurs twice in the element: both symmetric blocks fall on the diagonal block.
            self.matrix
                .add_block(slot, a, [size_a, size_a], true, |r, c| {
                    entry(r, c) + entry(c, r)
                });
        }
    }

    fn add_coupling(
        &mut self,
        solved: NodeId,
        prescribed: NodeId,
        rows: usize,
        columns: usize,
        entry: &impl Fn(usize, usize) -> f64,
    ) {
        let row = self.layout.start(solved);
        let column = self.layout.start(prescribed) - self.layout.num_solved_dofs();
        for i in 0..rows {
            for j in 0..columns {
                self.coupling[row + i] += entry(i, j) * self.prescribed_step[column + j];
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn layout() -> DofLayout {
        let mut layout = DofLayout::new();
        layout.push_nodes(3, 3, true);
        layout.push_nodes(2, 1, true);
        layout.push_nodes(1, 3, false);
        layout
    }

    #[test]
    fn blocks_of_every_kind_land_where_a_dense_matrix_has_them() {
        let layout = layout();
        let mut builder = PatternBuilder::default();
        builder.couple([0, 2, 3].map(NodeId));
        builder.couple([4, 1, 5].map(NodeId));
        let pattern = Arc::new(Pattern::new(&layout, &builder.finish()));
        let mut matrix = SymmetricMatrix::zeros(pattern);
        let mut dense = nalgebra::DMatrix::<f64>::zeros(11, 11);
        let mut coupling = vec![0.0; 11];
        let mut builder = HessianBuilder {
            matrix: &mut matrix,
            layout: &layout,
            prescribed_step: &[1.0, 0.0, 2.0],
            coupling: &mut coupling,
        };
        let entry = |i: usize, j: usize| 1.0 + i as f64 + 10.0 * j as f64;
        for (a, b) in [(2, 0), (0, 3), (3, 2), (4, 1)] {
            builder.add(NodeId(a), NodeId(b), false, entry);
            let (ra, rb) = (layout.start(NodeId(a)), layout.start(NodeId(b)));
            for i in 0..layout.size(NodeId(a)) {
                for j in 0..layout.size(NodeId(b)) {
                    dense[(ra + i, rb + j)] += entry(i, j);
                    dense[(rb + j, ra + i)] += entry(i, j);
                }
            }
        }
        // A node twice in one element: both triangles of the off-diagonal block count.
        builder.add(NodeId(1), NodeId(1), false, entry);
        for i in 0..3 {
            for j in 0..3 {
                dense[(3 + i, 3 + j)] += entry(i, j) + entry(j, i);
            }
        }
        builder.add(NodeId(1), NodeId(5), false, entry);
        for i in 0..3 {
            assert_eq!(coupling[3 + i], entry(i, 0) + 2.0 * entry(i, 2));
        }
        let x: Vec<f64> = (0..11).map(|i| (i as f64 * 0.7).sin()).collect();
        let expected = &dense * nalgebra::DVector::from_column_slice(&x);
        for (y, e) in matrix.multiply(&x).iter().zip(expected.iter()) {
            assert!((y - e).abs() < 1e-12);
        }
    }

    #[test]
    fn a_fixed_unknown_moves_to_the_right_hand_side() {
        let layout = layout();
        let mut builder = PatternBuilder::default();
        builder.couple([0, 1].map(NodeId));
        let mut matrix = SymmetricMatrix::zeros(Arc::new(Pattern::new(&layout, &builder.finish())));
        for (i, v) in matrix.values.iter_mut().enumerate() {
            *v = 1.0 + i as f64;
        }
        let original = matrix.clone();
        let mut fixed = vec![false; 11];
        fixed[1] = true;
        let mut step = vec![0.0; 11];
        step[1] = 0.5;
        let mut rhs = vec![0.0; 11];
        matrix.fix(&fixed, &step, &mut rhs);
        let moved = original.multiply(&step);
        for i in 0..11 {
            let expected = if i == 1 { 0.5 } else { -moved[i] };
            assert_eq!(rhs[i], expected);
        }
        assert_eq!(matrix.multiply(&step)[1], 0.5);
        assert_eq!(matrix.multiply(&step)[0], 0.0);
    }
}
