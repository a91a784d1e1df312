//! The one error of the client.

use std::{collections::BTreeMap, fmt, sync::Arc, time::Duration};

/// What went wrong, finely: the service's own table, the same on both transports.
pub use takt_proto::error::ErrorCode as Code;
use takt_proto::error::{self as wire, Retry};

/// What went wrong, coarsely: whom to turn to.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum ErrorKind {
    /// The request is wrong, or not allowed, or about something that is not there. Sending it again is useless.
    Refused,
    /// The service understood and could not.
    Service,
    /// The service was not reached, or its answer was lost or unreadable.
    Transport,
    /// The time was up.
    Deadline,
}

/// The kind that an answer with this code has.
fn kind_of(code: Code) -> ErrorKind {
    match code {
        Code::InvalidRequest
        | Code::Unauthenticated
        | Code::Forbidden
        | Code::NotFound
        | Code::MethodNotAllowed
        | Code::Unimplemented
        | Code::Conflict
        | Code::TooLarge => ErrorKind::Refused,
        Code::Overloaded | Code::Cancelled | Code::Unavailable | Code::Internal => ErrorKind::Service,
        Code::DeadlineExceeded => ErrorKind::Deadline,
    }
}

/// One field of a request that breaks a rule.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct FieldViolation {
    /// Path of the field, as in `joints[2].drive.gear_ratio`.
    pub field: String,
    /// What is wrong with it.
    pub description: String,
}

/// Why a call has no answer.
///
/// Its text is one sentence for a person; the accessors say the rest to a program.
#[derive(Debug, Clone)]
pub struct Error(Box<Inner>);

#[derive(Debug, Clone)]
struct Inner {
    kind: ErrorKind,
    code: Code,
    message: String,
    violations: Vec<FieldViolation>,
    details: BTreeMap<String, String>,
    reason: String,
    retry_after: Option<Duration>,
    endpoint: String,
    tries: u32,
    sent: bool,
    source: Option<Arc<dyn std::error::Error + Send + Sync>>,
}

impl Error {
    /// Which of the four kinds this is.
    #[must_use]
    pub fn kind(&self) -> ErrorKind {
        self.0.kind
    }

    /// The code; for [`ErrorKind::Transport`] it is [`Code::Unavailable`].
    #[must_use]
    pub fn code(&self) -> Code {
        self.0.code
    }

    /// One sentence, in the server's words where it answered.
    #[must_use]
    pub fn message(&self) -> &str {
        &self.0.message
    }

    /// The fields that are wrong, where the request was.
    #[must_use]
    pub fn violations(&self) -> &[FieldViolation] {
        &self.0.violations
    }

    /// What else the server said in a form for programs, such as the current revision of a conflict.
    #[must_use]
    pub fn details(&self) -> &BTreeMap<String, String> {
        &self.0.details
    }

    /// A constant for programs, such as `REVISION_MISMATCH`; empty where the server gave none.
    #[must_use]
    pub fn reason(&self) -> &str {
        &self.0.reason
    }

    /// Whether the same call may succeed a little later. The client's own tries are used up by then.
    #[must_use]
    pub fn retryable(&self) -> bool {
        self.0.kind == ErrorKind::Transport || self.0.code.row().retry == Retry::AfterDelay
    }

    /// How long the server asks to wait before the next try.
    #[must_use]
    pub fn retry_after(&self) -> Option<Duration> {
        self.0.retry_after
    }

    /// The endpoint that failed last; empty where none was asked.
    #[must_use]
    pub fn endpoint(&self) -> &str {
        &self.0.endpoint
    }

    /// How often the request was tried.
    #[must_use]
    pub fn tries(&self) -> u32 {
        self.0.tries
    }

    fn new(kind: ErrorKind, code: Code, message: impl Into<String>) -> Self {
        Self(Box::new(Inner {
            kind,
            code,
            message: message.into(),
            violations: Vec::new(),
            details: BTreeMap::new(),
            reason: String::new(),
            retry_after: None,
            endpoint: String::new(),
            tries: 0,
            sent: true,
            source: None,
        }))
    }

    /// The service answered with an error.
    pub(crate) fn answered(code: Code, message: impl Into<String>) -> Self {
        Self::new(kind_of(code), code, message)
    }

    /// The service answered with an error in its own form.
    pub(crate) fn from_wire(error: wire::Error) -> Self {
        let mut read = Self::answered(error.code, error.message);
        read.0.violations = error
            .violations
            .into_iter()
            .map(|violation| FieldViolation {
                field: violation.path,
                description: violation.message,
            })
            .collect();
        read.0.details = error.metadata.into_iter().collect();
        read.0.reason = error.reason;
        read.0.retry_after = error.retry_after;
        read
    }

    /// The caller's own mistake, found before anything was sent.
    pub(crate) fn refused(field: &str, description: impl Into<String>) -> Self {
        let description = description.into();
        let mut error = Self::new(
            ErrorKind::Refused,
            Code::InvalidRequest,
            format!("{field}: {description}"),
        )
        .with_violations(vec![FieldViolation {
            field: field.to_owned(),
            description,
        }]);
        error.0.sent = false;
        error
    }

    /// No answer, or none that could be read.
    pub(crate) fn transport(
        message: impl Into<String>,
        source: impl Into<Box<dyn std::error::Error + Send + Sync>>,
    ) -> Self {
        let mut error = Self::new(ErrorKind::Transport, Code::Unavailable, message);
        error.0.source = Some(Arc::from(source.into()));
        error
    }

    /// The time was up on this side.
    pub(crate) fn deadline(deadline: Duration, last: Option<&Self>) -> Self {
        let mut message = format!("no answer within {} s", deadline.as_secs_f64());
        if let Some(last) = last {
            message.push_str("; before that: ");
            message.push_str(last.message());
        }
        Self::new(ErrorKind::Deadline, Code::DeadlineExceeded, message)
    }

    pub(crate) fn with_violations(mut self, violations: Vec<FieldViolation>) -> Self {
        self.0.violations = violations;
        self
    }

    pub(crate) fn with_retry_after(mut self, delay: Option<Duration>) -> Self {
        self.0.retry_after = delay;
        self
    }

    /// The request certainly did not leave.
    pub(crate) fn unsent(mut self) -> Self {
        self.0.sent = false;
        self
    }

    pub(crate) fn at(mut self, endpoint: &str) -> Self {
        endpoint.clone_into(&mut self.0.endpoint);
        self
    }

    pub(crate) fn with_tries(mut self, tries: u32) -> Self {
        self.0.tries = tries;
        self
    }

    /// Whether the request may have reached the service.
    pub(crate) fn may_have_been_sent(&self) -> bool {
        self.0.sent
    }
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.0.kind != ErrorKind::Refused && !self.0.endpoint.is_empty() {
            write!(f, "{}: ", self.0.endpoint)?;
        }
        f.write_str(&self.0.message)?;
        if self.0.tries > 1 {
            write!(f, " (tried {} times)", self.0.tries)?;
        }
        Ok(())
    }
}

impl std::error::Error for Error {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        self.0.source.as_deref().map(|source| source as _)
    }
}
