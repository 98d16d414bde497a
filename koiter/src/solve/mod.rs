//! Minimising a sum of energies: sparse factorisation, Newton's method, line search. Knows no shells and no contact.

mod cholesky;
mod conjugate_gradients;
mod eigen;
mod ldlt;
mod limits;
mod line_search;
mod low_rank;
mod multifrontal;
mod newton;
mod ordering;
mod pace;
mod saddle;
mod supernodal;
mod trust_region;
mod workspace;

pub use cholesky::{LinearSolver, NotPositiveDefinite, SparseCholesky};
pub use conjugate_gradients::{ConjugateGradients, NodeBlocks, conjugate_gradients};
pub use eigen::{EigenNotConverged, EigenPair, largest_eigenpairs};
pub use ldlt::SignedCholesky;
pub use limits::{DECREASE, Limit, Limiter};
pub use multifrontal::Multifrontal;
pub use newton::{
    HessianChoice, NewtonOptions, NewtonReport, Problem, SolveError, minimize, minimize_stably,
};
pub use ordering::{EliminationOrder, NodeOrdering, nested_dissection};
pub use saddle::{leave_saddle, leave_saddles_by_node};
pub use supernodal::Supernodal;
pub use trust_region::{TrustRegionOptions, TrustRegionReport, minimize_in_trust_region};
pub use workspace::{LinearWorkspace, WorkspaceHistory};
