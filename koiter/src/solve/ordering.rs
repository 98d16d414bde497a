//! The order in which unknowns are eliminated.
//!
//! Nested dissection works on the graph of nodes (a vertex with its three coordinates, an edge angle), which is smaller
//! than that of the unknowns and loses nothing. The elimination tree is then traversed in postorder, so that columns of
//! like structure become neighbours: without this the supernodes of the factor break up.

use feral_metis::{MetisOptions, metis_order_full};
use feral_ordering_core::CscPattern;

use crate::assembly::{NodeId, Pattern};

/// An elimination order of nodes: position → node.
#[derive(Clone, Debug)]
pub struct NodeOrdering(Vec<u32>);

/// Neighbours of every node, both ways, sorted.
struct Adjacency {
    start: Vec<i32>,
    neighbors: Vec<i32>,
}

impl Adjacency {
    fn new(pattern: &Pattern) -> Self {
        let n = pattern.num_nodes();
        let mut start = vec![0i32; n + 1];
        let below = |node: usize| {
            pattern.coupled(NodeId(node as u32))[1..]
                .iter()
                .map(|&row| row as usize)
        };
        for node in 0..n {
            for row in below(node) {
                start[node + 1] += 1;
                start[row + 1] += 1;
            }
        }
        for node in 0..n {
            start[node + 1] += start[node];
        }
        let mut next = start.clone();
        let mut neighbors = vec![0i32; start[n] as usize];
        let mut push = |of: usize, node: usize| {
            neighbors[next[of] as usize] = node as i32;
            next[of] += 1;
        };
        // Rows below a column are pushed to the row first, in order of columns: both lists come out sorted, because a
        // node's smaller neighbours are all pushed before its larger ones.
        for node in 0..n {
            for row in below(node) {
                push(row, node);
            }
        }
        for node in 0..n {
            for row in below(node) {
                push(node, row);
            }
        }
        Self { start, neighbors }
    }

    fn of(&self, node: usize) -> &[i32] {
        &self.neighbors[self.start[node] as usize..self.start[node + 1] as usize]
    }
}

/// Nested dissection of the graph of a pattern; deterministic.
pub fn nested_dissection(pattern: &Pattern) -> NodeOrdering {
    let graph = Adjacency::new(pattern);
    let n = pattern.num_nodes();
    let order = CscPattern::new(n, &graph.start, &graph.neighbors)
        .and_then(|csc| metis_order_full(&csc, &MetisOptions::default()).ok())
        .map(|(order, _, _)| {
            order
                .into_iter()
                .map(|node| node as u32)
                .collect::<Vec<_>>()
        })
        .filter(|order| order.len() == n);
    // Any order is correct; the natural one only fills more.
    NodeOrdering(order.unwrap_or_else(|| (0..n as u32).collect()))
}

/// An order of elimination with its tree, in which subtrees are contiguous.
#[derive(Clone, Debug)]
pub struct EliminationOrder {
    /// Node at each position.
    pub nodes: Vec<u32>,
    /// Parent position of each position in the elimination tree; `u32::MAX`: a root.
    pub parent: Vec<u32>,
    later_start: Vec<u32>,
    later: Vec<u32>,
}

impl EliminationOrder {
    /// Positions after `position` whose nodes are coupled to its node, in no order.
    pub fn later_neighbors(&self, position: usize) -> &[u32] {
        let range = self.later_start[position] as usize..self.later_start[position + 1] as usize;
        &self.later[range]
    }
}

impl NodeOrdering {
    /// Eliminates nodes in the order they are listed, each once.
    pub(super) fn of(nodes: Vec<u32>) -> Self {
        Self(nodes)
    }

    /// Position → node.
    pub(super) fn nodes(&self) -> &[u32] {
        &self.0
    }

    /// The order after a postorder of the elimination tree of `pattern` (which may couple more nodes than the pattern the
    /// order was made for).
    pub fn elimination_order(&self, pattern: &Pattern) -> EliminationOrder {
        let graph = Adjacency::new(pattern);
        let position = inverse(&self.0);
        let parent = self.elimination_tree(&graph, &position);
        let order = postorder(&parent);
        let place = inverse(&order);
        let nodes: Vec<u32> = order.iter().map(|&k| self.0[k as usize]).collect();
        let position = inverse(&nodes);
        let mut later_start = vec![0];
        let mut later = Vec::with_capacity(graph.neighbors.len() / 2);
        for (k, &node) in nodes.iter().enumerate() {
            let neighbors = graph
                .of(node as usize)
                .iter()
                .map(|&n| position[n as usize]);
            later.extend(neighbors.filter(|&p| p as usize > k));
            later_start.push(later.len() as u32);
        }
        let parent = (order.iter())
            .map(|&k| match parent[k as usize] {
                u32::MAX => u32::MAX,
                p => place[p as usize],
            })
            .collect();
        EliminationOrder {
            nodes,
            parent,
            later_start,
            later,
        }
    }

    /// The order of scalar unknowns, position → unknown, after the same postorder.
    pub fn scalar_order(&self, pattern: &Pattern) -> Vec<u32> {
        let starts = pattern.node_starts();
        (self.elimination_order(pattern).nodes.into_iter())
            .flat_map(|node| starts[node as usize]..starts[node as usize + 1])
            .collect()
    }

    /// Parent of every position in the elimination tree (Liu's algorithm with path compression); `u32::MAX`: a root.
    fn elimination_tree(&self, graph: &Adjacency, position: &[u32]) -> Vec<u32> {
        let n = self.0.len();
        let mut parent = vec![u32::MAX; n];
        let mut ancestor = vec![u32::MAX; n];
        for k in 0..n as u32 {
            for &neighbor in graph.of(self.0[k as usize] as usize) {
                let mut i = position[neighbor as usize];
                while i < k {
                    let next = std::mem::replace(&mut ancestor[i as usize], k);
                    if next == u32::MAX {
                        parent[i as usize] = k;
                        break;
                    }
                    i = next;
                }
            }
        }
        parent
    }
}

fn inverse(order: &[u32]) -> Vec<u32> {
    let mut position = vec![0; order.len()];
    for (k, &item) in order.iter().enumerate() {
        position[item as usize] = k as u32;
    }
    position
}

/// Children before parents, subtrees contiguous.
fn postorder(parent: &[u32]) -> Vec<u32> {
    let n = parent.len();
    let mut first_child = vec![u32::MAX; n];
    let mut sibling = vec![u32::MAX; n];
    let mut roots = Vec::new();
    for k in (0..n).rev() {
        match parent[k] {
            u32::MAX => roots.push(k as u32),
            p => sibling[k] = std::mem::replace(&mut first_child[p as usize], k as u32),
        }
    }
    let mut order = Vec::with_capacity(n);
    let mut stack = roots;
    while let Some(&top) = stack.last() {
        match first_child[top as usize] {
            u32::MAX => {
                order.push(top);
                stack.pop();
            }
            child => {
                // A child leaves its parent's list when it is entered.
                first_child[top as usize] = sibling[child as usize];
                stack.push(child);
            }
        }
    }
    order
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::assembly::{DofLayout, PatternBuilder};

    #[test]
    fn the_scalar_order_is_a_permutation_that_keeps_nodes_together() {
        let mut layout = DofLayout::new();
        layout.push_nodes(40, 3, true);
        layout.push_nodes(20, 1, true);
        let mut builder = PatternBuilder::default();
        for i in 0..39 {
            builder.couple([NodeId(i), NodeId(i + 1), NodeId(40 + i / 2)]);
        }
        let pattern = Pattern::new(&layout, &builder.finish());
        let order = nested_dissection(&pattern).scalar_order(&pattern);
        let mut seen = vec![false; layout.num_dofs()];
        for &dof in &order {
            assert!(!std::mem::replace(&mut seen[dof as usize], true));
        }
        assert!(seen.iter().all(|s| *s));
        for triple in order.windows(2).filter(|w| w[0] < 120 && w[0] % 3 == 0) {
            assert_eq!(triple[1], triple[0] + 1);
        }
    }

    #[test]
    fn postorder_puts_children_first() {
        let parent = [3, 3, 4, 4, u32::MAX];
        let order = postorder(&parent);
        let place = |k: u32| order.iter().position(|&x| x == k).unwrap();
        assert_eq!(order.len(), 5);
        for (child, &p) in parent.iter().enumerate() {
            assert!(p == u32::MAX || place(child as u32) < place(p));
        }
    }
}
