//! Why the service could not: a sentence for the caller, and the cause for the log.

use std::{error::Error as StdError, fmt};

use takt_motion::Invalid;
use takt_proto::error::{Error, ErrorCode};

/// A refusal. The caller sees [`ServiceError::wire`]; the source stays in the log.
#[derive(Debug, Clone)]
pub(crate) struct ServiceError(Box<Parts>);

#[derive(Debug, Clone)]
struct Parts {
    wire: Error,
    source: Option<std::sync::Arc<dyn StdError + Send + Sync>>,
}

impl ServiceError {
    pub(crate) fn new(code: ErrorCode, message: impl Into<String>) -> Self {
        Error::new(code, message).into()
    }

    pub(crate) fn not_found(message: impl Into<String>) -> Self {
        Self::new(ErrorCode::NotFound, message)
    }

    pub(crate) fn internal(message: impl Into<String>) -> Self {
        Self::new(ErrorCode::Internal, message)
    }

    pub(crate) fn invalid(violations: Vec<Invalid>) -> Self {
        Error::invalid(violations).into()
    }

    pub(crate) fn deadline() -> Self {
        Self::new(
            ErrorCode::DeadlineExceeded,
            "the deadline passed before the answer was ready",
        )
    }

    /// The same said of a request that stands in a field of another.
    pub(crate) fn below(self, field: &str) -> Self {
        if self.0.wire.violations.is_empty() {
            return self;
        }
        let violations = self.0.wire.violations.into_iter();
        Self::invalid(violations.map(|violation| violation.below(field)).collect())
    }

    /// The same with its cause, for the log.
    pub(crate) fn caused_by(mut self, source: impl StdError + Send + Sync + 'static) -> Self {
        self.0.source = Some(std::sync::Arc::new(source));
        self
    }

    /// What the caller sees.
    pub(crate) fn wire(&self) -> &Error {
        &self.0.wire
    }

    /// The cause, for the log.
    pub(crate) fn cause(&self) -> Option<&(dyn StdError + 'static)> {
        let source = self.0.source.as_deref()?;
        Some(source)
    }
}

impl fmt::Display for ServiceError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.wire().fmt(f)
    }
}

impl StdError for ServiceError {}

impl From<Error> for ServiceError {
    fn from(wire: Error) -> Self {
        Self(Box::new(Parts { wire, source: None }))
    }
}
