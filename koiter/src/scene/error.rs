//! What can be wrong with a scene, and where it stands in the text.

use std::ops::Range;
use std::sync::Arc;

/// A text that was read: the scene file, or one `--set` argument.
#[derive(Debug, PartialEq, Eq)]
pub struct Source {
    /// What to call it in messages, such as the path of the file.
    pub name: String,
    /// The text itself.
    pub text: String,
}

/// A piece of a [`Source`].
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Location {
    /// The text.
    pub source: Arc<Source>,
    /// Bytes of the text.
    pub span: Range<usize>,
}

impl Location {
    /// Line, from 1.
    pub fn line(&self) -> usize {
        self.before().matches('\n').count() + 1
    }

    /// Column in characters, from 1.
    pub fn column(&self) -> usize {
        let before = self.before();
        let line_start = before.rfind('\n').map_or(0, |newline| newline + 1);
        before[line_start..].chars().count() + 1
    }

    /// The piece of text.
    pub fn text(&self) -> &str {
        self.source.text.get(self.span.clone()).unwrap_or("")
    }

    fn before(&self) -> &str {
        self.source.text.get(..self.span.start).unwrap_or("")
    }
}

/// What sort of mistake it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum SceneErrorKind {
    /// The text is not TOML.
    Syntax,
    /// A key that does not exist.
    UnknownKey,
    /// A key that must be given is missing.
    MissingKey,
    /// A value of the wrong type.
    WrongType,
    /// A number outside its range.
    OutOfRange,
    /// A name (material, model, shell, variant) that does not exist.
    UnknownName,
    /// Keys that are each right but not together.
    Conflict,
    /// A selection without vertices.
    EmptySelection,
    /// A mesh that cannot be read, made or used.
    Mesh,
    /// More than fits into memory.
    TooLarge,
}

impl SceneErrorKind {
    /// All there are.
    pub const ALL: [Self; 10] = [
        Self::Syntax,
        Self::UnknownKey,
        Self::MissingKey,
        Self::WrongType,
        Self::OutOfRange,
        Self::UnknownName,
        Self::Conflict,
        Self::EmptySelection,
        Self::Mesh,
        Self::TooLarge,
    ];

    /// Its stable name, by which `koiter explain` knows it.
    pub fn code(self) -> &'static str {
        match self {
            Self::Syntax => "scene-syntax",
            Self::UnknownKey => "scene-unknown-key",
            Self::MissingKey => "scene-missing-key",
            Self::WrongType => "scene-wrong-type",
            Self::OutOfRange => "scene-out-of-range",
            Self::UnknownName => "scene-unknown-name",
            Self::Conflict => "scene-conflict",
            Self::EmptySelection => "scene-empty-selection",
            Self::Mesh => "scene-mesh",
            Self::TooLarge => "scene-too-large",
        }
    }
}

/// A mistake in a scene: one sentence, its place, and what to do.
#[derive(Clone, Debug, thiserror::Error)]
#[error("{message}")]
pub struct SceneError {
    /// What sort of mistake.
    pub kind: SceneErrorKind,
    /// What is wrong.
    pub message: String,
    /// Dotted path of the key, such as `shell.cloth.material.young`; empty for a syntax error.
    pub path: String,
    /// Where it stands; `None` for a scene that was not read from text.
    pub location: Option<Location>,
    /// What to do about it.
    pub help: Option<String>,
}

impl SceneError {
    /// An error that does not yet know its place.
    pub fn new(kind: SceneErrorKind, message: impl Into<String>) -> Self {
        Self {
            kind,
            message: message.into(),
            path: String::new(),
            location: None,
            help: None,
        }
    }

    /// Adds what to do.
    #[must_use]
    pub fn with_help(mut self, help: impl Into<String>) -> Self {
        self.help = Some(help.into());
        self
    }

    /// Says where, unless a more exact place is known already.
    #[must_use]
    pub fn or_at(mut self, location: Option<&Location>) -> Self {
        self.location = self.location.or_else(|| location.cloned());
        self
    }

    /// Puts the path of an enclosing table in front of the path.
    #[must_use]
    pub fn inside(mut self, segment: &str) -> Self {
        self.path = if self.path.is_empty() {
            segment.to_owned()
        } else {
            format!("{segment}.{}", self.path)
        };
        self
    }
}

/// Something that can be simulated but is probably not what was meant.
#[derive(Clone, Debug)]
pub struct Warning {
    /// What is implausible.
    pub message: String,
    /// Dotted path of the key.
    pub path: String,
    /// Where it stands.
    pub location: Option<Location>,
    /// What was probably meant.
    pub help: Option<String>,
}

#[cfg(test)]
mod messages;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_and_columns_count_from_one_and_in_characters() {
        let text = "a = 1\nβ = 'γ' # here".to_owned();
        let start = text.find("# here").unwrap();
        let source = Arc::new(Source {
            name: "scene.toml".into(),
            text,
        });
        let location = Location {
            source,
            span: start..start + 6,
        };
        assert_eq!((location.line(), location.column()), (2, 9));
        assert_eq!(location.text(), "# here");
    }
}
