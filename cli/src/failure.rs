//! Why a command failed, and what to do about it.

use std::fmt::Write;

use takt_client::{Code, Error, ErrorKind, FieldViolation};

use crate::exit;

/// A command that could not be done.
#[derive(Debug)]
pub(crate) struct Failure {
    /// Exit code.
    pub(crate) code: u8,
    message: String,
    /// Further lines, one a violation.
    lines: Vec<String>,
    /// What to do next.
    hints: Vec<String>,
}

impl Failure {
    /// The command line, a file or the request is wrong.
    pub(crate) fn usage(message: impl Into<String>) -> Self {
        Self {
            code: exit::USAGE,
            message: message.into(),
            lines: Vec::new(),
            hints: Vec::new(),
        }
    }

    /// Something outside the request went wrong.
    pub(crate) fn service(message: impl Into<String>) -> Self {
        Self {
            code: exit::SERVICE,
            ..Self::usage(message)
        }
    }

    pub(crate) fn hint(mut self, hint: impl Into<String>) -> Self {
        self.hints.push(hint.into());
        self
    }

    /// The text for a person, several lines.
    pub(crate) fn render(&self, colour: bool) -> String {
        let (red, bold, end) = if colour {
            ("\x1b[1;31m", "\x1b[1m", "\x1b[0m")
        } else {
            ("", "", "")
        };
        let mut text = format!("{red}error:{end} {}\n", self.message);
        for line in &self.lines {
            let _ = writeln!(text, "  {line}");
        }
        for hint in &self.hints {
            let _ = writeln!(text, "{bold}hint:{end} {hint}");
        }
        text
    }
}

/// Whether a hint is for a finding.
type IsMeant = fn(&FieldViolation) -> bool;

/// What is said of the command line where a field is wrong for want of something else.
const HINTS: [(IsMeant, &str); 2] = [
    (
        |one| one.field == "confidence",
        "fit the model with `takt drive fit ROBOT LOG --json > fit.json`, and store it with `takt drive commit ROBOT fit.json`",
    ),
    (
        |one| one.description.contains("drive.torque_constant_nm_per_a"),
        "write the description with `takt robot show ROBOT --description > arm.json`, add it there, and register that: \
         `takt robot register ROBOT --description arm.json`",
    ),
];

impl From<Error> for Failure {
    fn from(error: Error) -> Self {
        let mut failure = match error.kind() {
            ErrorKind::Refused => Self::usage(error.to_string()),
            ErrorKind::Service | ErrorKind::Transport | ErrorKind::Deadline => Self::service(error.to_string()),
        };
        let violations = error.violations();
        // One violation is the message already.
        if violations.len() > 1
            || violations
                .first()
                .is_some_and(|one| !error.message().contains(&one.description))
        {
            if violations.len() > 1 {
                failure.message = format!("the request is wrong in {} places", violations.len());
            }
            failure.lines = violations
                .iter()
                .map(|violation| format!("{}: {}", violation.field, violation.description))
                .collect();
        }
        for (is_meant, hint) in HINTS {
            if violations.iter().any(is_meant) {
                failure = failure.hint(hint);
            }
        }
        match (error.kind(), error.code()) {
            (ErrorKind::Transport, _) => failure
                .hint("start a server with: takt serve --examples")
                .hint("or name a running one with --server URL or TAKT_SERVER"),
            (_, Code::NotFound) => failure.hint("see what is registered with: takt robot list"),
            (_, Code::Conflict) => match error.details().get("current_revision").map(String::as_str) {
                Some("") => failure.hint("there is no such robot yet; register it with --expected-revision ''"),
                // The message names it.
                Some(_) => failure,
                None => failure.hint("see the current revision with: takt robot show ROBOT_ID"),
            },
            (ErrorKind::Deadline, _) => failure.hint("give it more time with --timeout, as in --timeout 60s; the service has a limit of its own, `takt serve --deadline`"),
            (_, Code::Overloaded) => failure.hint("the service is busy; try again in a moment"),
            (_, Code::TooLarge) => failure.hint("ask for fewer samples, or send less at once"),
            _ => failure,
        }
    }
}
