//! What is wrong with an expression, and where.

/// A mistake in an expression.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{message}, in column {column} of the expression")]
pub struct ExpressionError {
    /// What is wrong.
    pub message: String,
    /// Where, in characters from 1.
    pub column: usize,
    /// What to do, if that is known.
    pub help: Option<String>,
    /// The mistyped name, if it is one that could have been another.
    pub unknown_name: Option<String>,
}

impl ExpressionError {
    pub(super) fn new(message: impl Into<String>, column: usize) -> Self {
        Self {
            message: message.into(),
            column,
            help: None,
            unknown_name: None,
        }
    }

    pub(super) fn with_help(mut self, help: impl Into<String>) -> Self {
        self.help = Some(help.into());
        self
    }
}
