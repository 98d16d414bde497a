//! What goes wrong: printed with its place, and turned into an exit status.

use crate::output::say_error;
use std::fmt::Display;
use std::process::ExitCode;

use koiter::io::result::ResultError;
use koiter::scene::{Location, SceneError, Warning};
use miette::{LabeledSpan, MietteDiagnostic, MietteHandlerOpts, NamedSource, Report, Severity};

/// Why the program ends without having done what it was asked.
#[derive(Debug)]
pub(crate) enum Failure {
    /// The scene is wrong, at a known place.
    Scene(Box<SceneError>),
    /// Some other input is wrong.
    Input {
        message: String,
        help: Option<String>,
    },
    /// The run failed.
    Run {
        message: String,
        help: Option<String>,
    },
}

impl Failure {
    pub(crate) fn input(message: impl Display) -> Self {
        Self::Input {
            message: message.to_string(),
            help: None,
        }
    }

    pub(crate) fn run(message: impl Display) -> Self {
        Self::Run {
            message: message.to_string(),
            help: None,
        }
    }

    /// A result that cannot be read.
    pub(crate) fn result(error: ResultError) -> Self {
        let failure = Self::input(&error);
        match error {
            ResultError::Broken { .. } => {
                failure.with_help("koiter run with --restart makes this result anew")
            }
            _ => failure,
        }
    }

    pub(crate) fn with_help(self, text: impl Into<String>) -> Self {
        let help = Some(text.into());
        match self {
            Self::Input { message, .. } => Self::Input { message, help },
            Self::Run { message, .. } => Self::Run { message, help },
            scene @ Self::Scene(_) => scene,
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
                &error.message,
                &error.path,
                error.location.as_ref(),
                error.help.as_deref(),
            ),
            Self::Input { message, help } | Self::Run { message, help } => {
                print_diagnostic(Severity::Error, message, "", None, help.as_deref());
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
    message: &str,
    path: &str,
    location: Option<&Location>,
    help: Option<&str>,
) {
    let mut diagnostic = MietteDiagnostic::new(message).with_severity(severity);
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
