//! Unknowns and how they are grouped.

/// Index of a scalar unknown in `q`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Dof(pub u32);

/// Index of a node: the three coordinates of a point, or the angle of one edge.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct NodeId(pub u32);

/// The grouping of `q` into nodes of one or three unknowns.
///
/// Nodes at or after `num_solved` hold prescribed motions only (obstacles): they take part in energies but have no row
/// in the linear system.
#[derive(Clone, Debug, Default)]
pub struct DofLayout {
    starts: Vec<u32>,
    node_of_dof: Vec<u32>,
    num_solved: usize,
}

impl DofLayout {
    /// An empty layout.
    pub fn new() -> Self {
        Self {
            starts: vec![0],
            node_of_dof: Vec::new(),
            num_solved: 0,
        }
    }

    /// Appends `count` nodes of `size` unknowns each and returns the first unknown of the first one.
    pub fn push_nodes(&mut self, count: usize, size: usize, solved: bool) -> Dof {
        assert!(
            !solved || self.num_solved == self.num_nodes(),
            "solved nodes come before prescribed ones"
        );
        let first = self.num_dofs() as u32;
        for _ in 0..count {
            let node = self.num_nodes() as u32;
            self.node_of_dof.extend(std::iter::repeat_n(node, size));
            self.starts.push(self.node_of_dof.len() as u32);
        }
        if solved {
            self.num_solved = self.num_nodes();
        }
        Dof(first)
    }

    /// Number of scalar unknowns.
    pub fn num_dofs(&self) -> usize {
        self.node_of_dof.len()
    }

    /// Number of nodes.
    pub fn num_nodes(&self) -> usize {
        self.starts.len() - 1
    }

    /// Number of nodes with rows in the linear system.
    pub fn num_solved_nodes(&self) -> usize {
        self.num_solved
    }

    /// Number of scalar unknowns with rows in the linear system; they come first in `q`.
    pub fn num_solved_dofs(&self) -> usize {
        self.starts[self.num_solved] as usize
    }

    /// The node of an unknown.
    pub fn node(&self, dof: Dof) -> NodeId {
        NodeId(self.node_of_dof[dof.0 as usize])
    }

    /// First unknown of a node.
    pub fn start(&self, node: NodeId) -> usize {
        self.starts[node.0 as usize] as usize
    }

    /// Number of unknowns of a node.
    pub fn size(&self, node: NodeId) -> usize {
        (self.starts[node.0 as usize + 1] - self.starts[node.0 as usize]) as usize
    }
}
