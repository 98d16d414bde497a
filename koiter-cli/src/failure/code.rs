//! Stable names of what goes wrong: errors begin with them, `koiter explain` tells what they mean.

use koiter::io::result::ResultError;

/// The sort of a failure, where it is not a mistake in a scene: those have [`koiter::scene::SceneErrorKind::code`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Code {
    /// An argument that cannot be used.
    Argument,
    /// A mesh file that cannot be read or used.
    MeshFile,
    /// A folder that is no result.
    NotAResult,
    /// A result with a damaged file.
    ResultBroken,
    /// A result of a newer version.
    ResultVersion,
    /// A folder for a result that is taken.
    ResultTaken,
    /// A frame that there is not.
    NoFrame,
    /// An interrupted run that cannot be gone on with, or would be overwritten.
    Resume,
    /// What an export's format cannot hold.
    Export,
    /// A file that cannot be written.
    Write,
    /// A scene that cannot be simulated.
    Start,
    /// Surfaces that touch or cross at the start.
    StartTouching,
    /// A step that cannot be taken.
    Step,
    /// A run with steps that did not converge.
    NotConverged,
    /// A run that was stopped.
    Interrupted,
    /// A result with intersections or collapsed faces.
    Audit,
    /// A sweep with runs that failed.
    Sweep,
    /// A curve that does not determine what is fitted.
    Fit,
    /// A program without the viewer's page.
    Viewer,
    /// Anything else that was tried and did not work.
    Failed,
}

impl Code {
    /// All there are.
    pub(crate) const ALL: [Self; 20] = [
        Self::Argument,
        Self::MeshFile,
        Self::NotAResult,
        Self::ResultBroken,
        Self::ResultVersion,
        Self::ResultTaken,
        Self::NoFrame,
        Self::Resume,
        Self::Export,
        Self::Write,
        Self::Start,
        Self::StartTouching,
        Self::Step,
        Self::NotConverged,
        Self::Interrupted,
        Self::Audit,
        Self::Sweep,
        Self::Fit,
        Self::Viewer,
        Self::Failed,
    ];

    /// What it is called, for good.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Argument => "argument",
            Self::MeshFile => "mesh-file",
            Self::NotAResult => "not-a-result",
            Self::ResultBroken => "result-broken",
            Self::ResultVersion => "result-version",
            Self::ResultTaken => "result-taken",
            Self::NoFrame => "no-frame",
            Self::Resume => "resume",
            Self::Export => "export",
            Self::Write => "write",
            Self::Start => "start",
            Self::StartTouching => "start-touching",
            Self::Step => "step",
            Self::NotConverged => "not-converged",
            Self::Interrupted => "interrupted",
            Self::Audit => "audit",
            Self::Sweep => "sweep",
            Self::Fit => "fit",
            Self::Viewer => "viewer",
            Self::Failed => "failed",
        }
    }

    /// The code of a result that cannot be read or written.
    pub(crate) fn of_result(error: &ResultError) -> Self {
        match error {
            ResultError::NotAResult { .. } => Self::NotAResult,
            ResultError::NotEmpty { .. } | ResultError::InUse { .. } => Self::ResultTaken,
            ResultError::Version { .. } => Self::ResultVersion,
            ResultError::NoFrame { .. } => Self::NoFrame,
            ResultError::Io {
                action: "write", ..
            } => Self::Write,
            _ => Self::ResultBroken,
        }
    }
}
