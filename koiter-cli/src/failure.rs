//! What goes wrong: printed with its place, and turned into an exit status.

mod code;

use std::fmt::Display;
use std::io;
use std::path::Path;
use std::process::ExitCode;

use koiter::integrate::StepError;
use koiter::io::read::ReadError;
use koiter::io::result::ResultError;
use koiter::io::write::WriteError;
use koiter::scene::{BuildError, Location, SceneError, Warning};
use miette::{LabeledSpan, MietteDiagnostic, MietteHandlerOpts, NamedSource, Report, Severity};

pub(crate) use code::Code;

use crate::output::say_error;

/// Why the program ends without having done what it was asked.
#[derive(Debug)]
pub(crate) enum Failure {
    /// The scene is wrong, at a known place.
    Scene(Box<SceneError>),
    /// Some other input is wrong.
    Input {
        code: Code,
        message: String,
        help: Option<String>,
    },
    /// The run failed.
    Run {
        code: Code,
        message: String,
        help: Option<String>,
    },
}

impl Failure {
    pub(crate) fn input(message: impl Display) -> Self {
        Self::Input {
            code: Code::Argument,
            message: message.to_string(),
            help: None,
        }
    }

    pub(crate) fn run(message: impl Display) -> Self {
        Self::Run {
            code: Code::Failed,
            message: message.to_string(),
            help: None,
        }
    }

    /// A mesh that cannot be read or used.
    pub(crate) fn mesh(error: ReadError) -> Self {
        Self::input(error).with_code(Code::MeshFile)
    }

    /// A scene that cannot start.
    pub(crate) fn start(error: BuildError) -> Self {
        let code = match error {
            BuildError::Start(_) => Code::StartTouching,
            _ => Code::Start,
        };
        Self::input(error).with_code(code)
    }

    /// A step that cannot be taken.
    pub(crate) fn step(error: StepError) -> Self {
        Self::run(error).with_code(Code::Step)
    }

    /// A file that the system would not let us write.
    pub(crate) fn writing(path: &Path, error: &io::Error) -> Self {
        Self::run(format!("cannot write {}: {error}", path.display())).with_code(Code::Write)
    }

    /// An export that was not made: a refusal of the system fails the run, what a format cannot hold is wrong input.
    pub(crate) fn export(error: WriteError) -> Self {
        match error {
            WriteError::Io { .. } => Self::run(error).with_code(Code::Write),
            WriteError::Result(error) => Self::result(error),
            _ => Self::input(error).with_code(Code::Export),
        }
    }

    /// A result that cannot be read.
    pub(crate) fn result(error: ResultError) -> Self {
        let failure = Self::input(&error).with_code(Code::of_result(&error));
        match error {
            ResultError::Broken { .. } => {
                failure.with_help("koiter run with --restart makes this result anew")
            }
            _ => failure,
        }
    }

    pub(crate) fn with_help(mut self, text: impl Into<String>) -> Self {
        if let Self::Input { help, .. } | Self::Run { help, .. } = &mut self {
            *help = Some(text.into());
        }
        self
    }

    pub(crate) fn with_code(mut self, new: Code) -> Self {
        if let Self::Input { code, .. } | Self::Run { code, .. } = &mut self {
            *code = new;
        }
        self
    }

    /// The stable name of its sort.
    pub(crate) fn code(&self) -> &'static str {
        match self {
            Self::Scene(error) => error.kind.code(),
            Self::Input { code, .. } | Self::Run { code, .. } => code.name(),
        }
    }

    /// What went wrong, in a line.
    pub(crate) fn message(&self) -> &str {
        match self {
            Self::Scene(error) => &error.message,
            Self::Input { message, .. } | Self::Run { message, .. } => message,
        }
    }

    /// Prints the failure to standard error.
    pub(crate) fn print(&self) {
        match self {
            Self::Scene(error) => print_diagnostic(
                Severity::Error,
                Some(self.code()),
                &error.message,
                &error.path,
                error.location.as_ref(),
                error.help.as_deref(),
            ),
            Self::Input { message, help, .. } | Self::Run { message, help, .. } => {
                let code = Some(self.code());
                print_diagnostic(Severity::Error, code, message, "", None, help.as_deref());
            }
        }
    }

    pub(crate) fn exit_code(&self) -> ExitCode {
        match self {
            Self::Run { .. } => ExitCode::from(1),
            Self::Scene(_) | Self::Input { .. } => ExitCode::from(2),
        }
    }
}

impl From<SceneError> for Failure {
    fn from(error: SceneError) -> Self {
        Self::Scene(Box::new(error))
    }
}

/// Prints what is implausible in a scene.
pub(crate) fn print_warning(warning: &Warning) {
    print_diagnostic(
        Severity::Warning,
        None,
        &warning.message,
        &warning.path,
        warning.location.as_ref(),
        warning.help.as_deref(),
    );
}

/// Long lines are left to the terminal: wrapped ones break paths and numbers, and cannot be searched.
pub(crate) fn set_style() {
    let hook = miette::set_hook(Box::new(|_| {
        Box::new(
            MietteHandlerOpts::new()
                .terminal_links(false)
                .context_lines(1)
                .wrap_lines(false)
                .build(),
        )
    }));
    // It fails only when set twice; the default style would then do.
    drop(hook);
}

fn print_diagnostic(
    severity: Severity,
    code: Option<&str>,
    message: &str,
    path: &str,
    location: Option<&Location>,
    help: Option<&str>,
) {
    let mut diagnostic = MietteDiagnostic::new(message).with_severity(severity);
    if let Some(code) = code {
        diagnostic = diagnostic.with_code(code);
    }
    if let Some(help) = help {
        diagnostic = diagnostic.with_help(help);
    }
    let report = match location {
        None => Report::new(diagnostic),
        Some(location) => {
            let label = (!path.is_empty()).then(|| path.to_owned());
            let span = LabeledSpan::new_primary_with_span(label, location.span.clone());
            let source = &location.source;
            Report::new(diagnostic.with_label(span))
                .with_source_code(NamedSource::new(&source.name, source.text.clone()))
        }
    };
    say_error!("{report:?}");
}
