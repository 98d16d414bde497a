//! The tree of fronts: which columns are eliminated together and where everything stands.
//!
//! All is done on nodes (a vertex, an edge angle) and widened to unknowns at the end. Columns of like structure form a
//! front; a front is merged into its parent if few explicit zeros come of it, because large dense kernels are faster than
//! the arithmetic they waste. Column counts follow Gilbert, Ng and Peyton (1994).

use std::ops::Range;

use super::super::ordering::EliminationOrder;
use crate::assembly::{NodeId, Pattern};

/// A dense block of columns of the factor with the rows below them.
#[derive(Clone, Debug)]
pub(super) struct Front {
    /// Eliminated unknowns, as positions in the elimination order.
    pub(super) columns: Range<usize>,
    /// Number of rows below the eliminated ones: the size of the update passed to the parent.
    pub(super) num_update: usize,
    /// Where the front's panel (rows × columns, by columns) starts among the values of the factor.
    pub(super) panel_start: usize,
    /// Children, in order; their subtrees and the front itself are consecutive fronts.
    pub(super) children: Vec<u32>,
    /// First front of the subtree.
    pub(super) first_descendant: usize,
    /// Runs of update rows in the parent's front.
    pub(super) runs: Vec<Run>,
    /// Blocks of the matrix that belong to the front.
    pub(super) blocks: Range<usize>,
    /// Multiplications of the subtree's elimination.
    pub(super) subtree_flops: f64,
    /// The front that takes this one's update; `None` for a root.
    pub(super) parent: Option<u32>,
}

impl Front {
    pub(super) fn num_columns(&self) -> usize {
        self.columns.len()
    }

    pub(super) fn num_rows(&self) -> usize {
        self.columns.len() + self.num_update
    }

    pub(super) fn panel(&self) -> Range<usize> {
        self.panel_start..self.panel_start + self.num_rows() * self.num_columns()
    }
}

/// Consecutive update rows of a child that are consecutive among the columns, or the update rows, of its parent's front.
#[derive(Clone, Copy, Debug)]
pub(super) struct Run {
    pub(super) child: u32,
    pub(super) parent: u32,
    pub(super) length: u32,
}

impl Run {
    /// Start in the child, start in the parent and length for rows of `width` entries.
    pub(super) fn scaled(&self, width: usize) -> (usize, usize, usize) {
        let scale = |rows: u32| rows as usize * width;
        (scale(self.child), scale(self.parent), scale(self.length))
    }
}

/// Where a block of the matrix goes in its front's panel.
#[derive(Clone, Copy, Debug)]
pub(super) struct BlockPlace {
    /// Position of the block's first entry among the matrix values.
    pub(super) slot: u32,
    /// Length of the first of the node's columns in the matrix.
    pub(super) stride: u32,
    /// Entry of the panel where the block's first entry goes.
    pub(super) place: u64,
    /// Rows of the stored block.
    pub(super) rows: u8,
    /// Columns of the stored block.
    pub(super) columns: u8,
    /// How the stored block lies in the panel.
    pub(super) lie: Lie,
}

/// How a stored block lies in the panel of its front.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Lie {
    /// As stored.
    Straight,
    /// Rows and columns exchanged.
    Transposed,
    /// On the diagonal: its lower triangle is stored and wanted.
    Diagonal,
}

/// The fronts of a pattern in an elimination order.
#[derive(Clone, Debug, Default)]
pub(super) struct FrontTree {
    /// Children before parents, subtrees consecutive.
    pub(super) fronts: Vec<Front>,
    /// Fronts without parent.
    pub(super) roots: Vec<u32>,
    /// Blocks of the matrix, by front.
    pub(super) blocks: Vec<BlockPlace>,
    /// Unknown at each position of the elimination order.
    pub(super) unknowns: Vec<u32>,
    /// Entries of the factor.
    pub(super) num_values: usize,
}

/// A child is merged into its parent if the merged front has at most so many columns and at most this share of explicit
/// zeros (the published defaults of supernodal codes, see `docs/decisions/0005`).
const AMALGAMATION: [(usize, f64); 4] = [(16, 0.8), (48, 0.3), (128, 0.1), (usize::MAX, 0.05)];

/// Node columns `first..end` (positions) with sizes in unknowns.
#[derive(Clone, Copy)]
struct Group {
    first: usize,
    end: usize,
    columns: usize,
    rows: usize,
    zeros: f64,
}

impl FrontTree {
    pub(super) fn new(pattern: &Pattern, order: &EliminationOrder) -> Self {
        let sizes: Vec<usize> = order
            .nodes
            .iter()
            .map(|&n| pattern.size(NodeId(n)))
            .collect();
        let counts = column_counts(order, &sizes);
        let groups = amalgamate(&fundamental_groups(order, &sizes, &counts), order);
        Builder::new(pattern, order, &sizes).build(&groups)
    }

    pub(super) fn front(&self, index: u32) -> &Front {
        &self.fronts[index as usize]
    }

    /// The fronts of a subtree, children first.
    pub(super) fn subtree(&self, root: u32) -> &[Front] {
        &self.fronts[self.front(root).first_descendant..=root as usize]
    }

    /// The first front of a subtree.
    pub(super) fn first_front(&self, root: u32) -> &Front {
        &self.fronts[self.front(root).first_descendant]
    }

    /// Multiplications to eliminate the given subtrees.
    pub(super) fn flops(&self, roots: &[u32]) -> f64 {
        let flops = |&root: &u32| self.front(root).subtree_flops;
        roots.iter().map(flops).sum()
    }

    /// Cuts a list of two or more subtrees into two of like work.
    pub(super) fn halve<'a>(&self, roots: &'a [u32]) -> (&'a [u32], &'a [u32]) {
        let half = self.flops(roots) / 2.0;
        let mut cut = 1;
        let mut sum = self.flops(&roots[..2]);
        while cut + 1 < roots.len() && sum <= half {
            cut += 1;
            sum += self.flops(&roots[cut..=cut]);
        }
        roots.split_at(cut)
    }
}

/// Rows of the factor at and below the first unknown of each node.
pub(super) fn column_counts(order: &EliminationOrder, sizes: &[usize]) -> Vec<usize> {
    const NONE: u32 = u32::MAX;
    let n = order.nodes.len();
    let parent = &order.parent;
    let mut first = vec![NONE; n];
    let mut count = vec![0i64; n];
    for k in 0..n {
        if first[k] == NONE {
            count[k] = sizes[k] as i64;
        }
        let mut j = k;
        while first[j] == NONE {
            first[j] = k as u32;
            match parent[j] {
                NONE => break,
                p => j = p as usize,
            }
        }
    }
    // Whether j is a leaf of row i's subtree is known by comparing first descendants with the last leaf seen.
    let mut max_first = vec![NONE; n];
    let mut previous_leaf = vec![NONE; n];
    let mut ancestor: Vec<u32> = (0..n as u32).collect();
    for j in 0..n {
        if parent[j] != NONE {
            count[parent[j] as usize] -= sizes[j] as i64;
        }
        for &i in order.later_neighbors(j) {
            let i = i as usize;
            if max_first[i] != NONE && first[j] <= max_first[i] {
                continue;
            }
            max_first[i] = first[j];
            count[j] += sizes[i] as i64;
            let before = std::mem::replace(&mut previous_leaf[i], j as u32);
            if before != NONE {
                let common = find_root(&mut ancestor, before);
                count[common as usize] -= sizes[i] as i64;
            }
        }
        if parent[j] != NONE {
            ancestor[j] = parent[j];
        }
    }
    for j in 0..n {
        if parent[j] != NONE {
            count[parent[j] as usize] += count[j];
        }
    }
    count.into_iter().map(|c| c as usize).collect()
}

fn find_root(ancestor: &mut [u32], start: u32) -> u32 {
    let mut root = start;
    while ancestor[root as usize] != root {
        root = ancestor[root as usize];
    }
    let mut j = start;
    while j != root {
        j = std::mem::replace(&mut ancestor[j as usize], root);
    }
    root
}

/// Neighbouring columns whose rows are the same.
fn fundamental_groups(order: &EliminationOrder, sizes: &[usize], counts: &[usize]) -> Vec<Group> {
    let mut groups: Vec<Group> = Vec::new();
    for k in 0..sizes.len() {
        let joins =
            k > 0 && order.parent[k - 1] as usize == k && counts[k - 1] == counts[k] + sizes[k - 1];
        match groups.last_mut().filter(|_| joins) {
            Some(group) => {
                group.end = k + 1;
                group.columns += sizes[k];
            }
            None => groups.push(Group {
                first: k,
                end: k + 1,
                columns: sizes[k],
                rows: counts[k],
                zeros: 0.0,
            }),
        }
    }
    groups
}

/// Merges groups with the parent that follows them where that adds few zeros.
fn amalgamate(groups: &[Group], order: &EliminationOrder) -> Vec<Group> {
    let mut merged: Vec<Group> = Vec::with_capacity(groups.len());
    for &group in groups {
        let mut current = group;
        // Only the last child stands next to its parent.
        while let Some(&child) = merged.last() {
            let parent = order.parent[child.end - 1];
            if (parent as usize) < current.first || parent as usize >= current.end {
                break;
            }
            let joined = join(&child, &current);
            let entries = trapezoid(joined.columns, joined.rows);
            let share = joined.zeros / entries;
            if !AMALGAMATION
                .iter()
                .any(|&(columns, zeros)| joined.columns <= columns && share <= zeros)
            {
                break;
            }
            merged.pop();
            current = joined;
        }
        merged.push(current);
    }
    merged
}

fn trapezoid(columns: usize, rows: usize) -> f64 {
    let (c, r) = (columns as f64, rows as f64);
    c * r - c * (c - 1.0) / 2.0
}

fn join(child: &Group, parent: &Group) -> Group {
    let columns = child.columns + parent.columns;
    let rows = child.columns + parent.rows;
    let filled = trapezoid(child.columns, child.rows) - child.zeros
        + trapezoid(parent.columns, parent.rows)
        - parent.zeros;
    Group {
        first: child.first,
        end: parent.end,
        columns,
        rows,
        zeros: trapezoid(columns, rows) - filled,
    }
}

/// Builds fronts from groups of columns.
struct Builder<'a> {
    pattern: &'a Pattern,
    order: &'a EliminationOrder,
    /// First unknown (in elimination order) of each position, with one past the last.
    start: Vec<usize>,
    /// Row of each position in the front at work, valid where `stamp` is that front.
    local: Vec<u32>,
    stamp: Vec<u32>,
    /// Update rows of each front, as positions; freed when the parent is done.
    rows: Vec<Vec<u32>>,
    tree: FrontTree,
}

impl<'a> Builder<'a> {
    fn new(pattern: &'a Pattern, order: &'a EliminationOrder, sizes: &[usize]) -> Self {
        let n = sizes.len();
        let mut start = Vec::with_capacity(n + 1);
        let mut total = 0;
        for &size in sizes {
            start.push(total);
            total += size;
        }
        start.push(total);
        Self {
            pattern,
            order,
            start,
            local: vec![0; n],
            stamp: vec![u32::MAX; n],
            rows: Vec::new(),
            tree: FrontTree::default(),
        }
    }

    fn size(&self, position: usize) -> usize {
        self.start[position + 1] - self.start[position]
    }

    fn build(mut self, groups: &[Group]) -> FrontTree {
        let starts = self.pattern.node_starts();
        self.tree.unknowns = (self.order.nodes.iter())
            .flat_map(|&node| starts[node as usize]..starts[node as usize + 1])
            .collect();
        let mut waiting: Vec<u32> = Vec::new();
        for (index, group) in groups.iter().enumerate() {
            let mut children = Vec::new();
            // Roots of finished subtrees whose parent stands in this group are its children.
            while let Some(&child) = waiting.last() {
                let last = groups[child as usize].end - 1;
                let parent = self.order.parent[last];
                if parent == u32::MAX || parent as usize >= group.end {
                    break;
                }
                children.push(child);
                waiting.pop();
            }
            children.reverse();
            self.add_front(index as u32, group, children);
            if self.order.parent[group.end - 1] == u32::MAX {
                self.tree.roots.push(index as u32);
            } else {
                waiting.push(index as u32);
            }
        }
        self.tree
    }

    fn add_front(&mut self, index: u32, group: &Group, children: Vec<u32>) {
        let rows = self.update_rows(index, group, &children);
        let columns = self.start[group.first]..self.start[group.end];
        let mut local = columns.len();
        for position in group.first..group.end {
            self.local[position] = (self.start[position] - columns.start) as u32;
        }
        for &row in &rows {
            self.local[row as usize] = local as u32;
            local += self.size(row as usize);
        }
        let blocks = self.place_blocks(group, local);
        for &child in &children {
            let runs = self.runs(child, columns.len() as u32);
            self.tree.fronts[child as usize].runs = runs;
            self.tree.fronts[child as usize].parent = Some(index);
            self.rows[child as usize] = Vec::new();
        }
        let num_update = local - columns.len();
        let first_descendant = children.first().map_or(index as usize, |&c| {
            self.tree.fronts[c as usize].first_descendant
        });
        let mut front = Front {
            columns,
            num_update,
            panel_start: self.tree.num_values,
            children,
            first_descendant,
            runs: Vec::new(),
            blocks,
            subtree_flops: 0.0,
            parent: None,
        };
        front.subtree_flops = self.flops(&front);
        self.tree.num_values = front.panel().end;
        self.rows.push(rows);
        self.tree.fronts.push(front);
    }

    /// Rows below the group: those of the matrix and those of the children.
    fn update_rows(&mut self, index: u32, group: &Group, children: &[u32]) -> Vec<u32> {
        let mut rows = Vec::new();
        let stamp = &mut self.stamp;
        let mut add = |row: u32| {
            if row as usize >= group.end
                && std::mem::replace(&mut stamp[row as usize], index) != index
            {
                rows.push(row);
            }
        };
        for position in group.first..group.end {
            for &row in self.order.later_neighbors(position) {
                add(row);
            }
        }
        for &child in children {
            for &row in &self.rows[child as usize] {
                add(row);
            }
        }
        rows.sort_unstable();
        rows
    }

    fn place_blocks(&mut self, group: &Group, num_rows: usize) -> Range<usize> {
        let first = self.tree.blocks.len();
        for position in group.first..group.end {
            let node = self.order.nodes[position];
            let column = self.local[position] as usize;
            let own = self.block(node, node, Lie::Diagonal, column * num_rows + column);
            self.tree.blocks.push(own);
            for &row in self.order.later_neighbors(position) {
                let other = self.order.nodes[row as usize];
                let place = column * num_rows + self.local[row as usize] as usize;
                let block = if other > node {
                    self.block(other, node, Lie::Straight, place)
                } else {
                    self.block(node, other, Lie::Transposed, place)
                };
                self.tree.blocks.push(block);
            }
        }
        first..self.tree.blocks.len()
    }

    fn block(&self, row: u32, column: u32, lie: Lie, place: usize) -> BlockPlace {
        let (row, column) = (NodeId(row), NodeId(column));
        debug_assert!(
            self.pattern.size(row).max(self.pattern.size(column)) <= usize::from(u8::MAX)
        );
        BlockPlace {
            slot: (self.pattern.slot(row, column)).expect("neighbours are coupled"),
            stride: self.pattern.first_column_length(column),
            place: place as u64,
            rows: self.pattern.size(row) as u8,
            columns: self.pattern.size(column) as u8,
            lie,
        }
    }

    /// Runs of a child's rows in the front at work, which has `columns` columns.
    fn runs(&self, child: u32, columns: u32) -> Vec<Run> {
        let mut runs: Vec<Run> = Vec::new();
        let mut at = 0;
        for &row in &self.rows[child as usize] {
            let (parent, length) = (self.local[row as usize], self.size(row as usize) as u32);
            match runs.last_mut() {
                Some(run) if run.parent + run.length == parent && parent != columns => {
                    run.length += length;
                }
                _ => runs.push(Run {
                    child: at,
                    parent,
                    length,
                }),
            }
            at += length;
        }
        runs
    }

    fn flops(&self, front: &Front) -> f64 {
        let (c, u) = (front.num_columns() as f64, front.num_update as f64);
        let children = (front.children.iter()).map(|&k| self.tree.fronts[k as usize].subtree_flops);
        c * c * c / 3.0 + c * c * u + c * u * u + children.sum::<f64>()
    }
}
