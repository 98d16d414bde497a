//! Minimising a sum of energies: sparse factorisation, Newton's method, line search. Knows no shells and no contact.

mod cholesky;
mod newton;
mod ordering;

pub use cholesky::{Factorization, NotPositiveDefinite, SparseCholesky};
pub use newton::{HessianChoice, LinearWorkspace, NewtonOptions, NewtonReport, Problem, SolveError, minimize};
pub use ordering::{NodeOrdering, nested_dissection};
