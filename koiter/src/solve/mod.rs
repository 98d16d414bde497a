//! Minimising a sum of energies: sparse factorisation, Newton's method, line search. Knows no shells and no contact.

mod cholesky;
mod line_search;
mod newton;
mod ordering;
mod workspace;

pub use cholesky::{Factorization, NotPositiveDefinite, SparseCholesky};
pub use newton::{HessianChoice, NewtonOptions, NewtonReport, Problem, SolveError, minimize};
pub use ordering::{NodeOrdering, nested_dissection};
pub use workspace::{LinearWorkspace, WorkspaceHistory};
