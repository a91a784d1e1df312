//! Refusals: the one table of codes for both protocols, and the one form of an error on the wire, `google.rpc.Status`:
//! in the trailers over gRPC, as JSON in the body over HTTP.

use std::{collections::HashMap, fmt, time::Duration};

use serde_json::{Value, json};
use takt_motion::Invalid;
use tonic::{Code, Status};
use tonic_types::{ErrorDetails, StatusExt};

/// Why a request was refused.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum ErrorCode {
    /// The request is wrong: its violations say where.
    InvalidRequest,
    /// Nobody is known by these credentials.
    Unauthenticated,
    /// The caller may not do this.
    Forbidden,
    /// No such robot, revision, path or method.
    NotFound,
    /// The path is known, the HTTP method is not among those it has.
    MethodNotAllowed,
    /// The RPC is not known.
    Unimplemented,
    /// The current revision is not the expected one.
    Conflict,
    /// The request exceeds a size limit.
    TooLarge,
    /// A limit on concurrent work refused the request at once.
    Overloaded,
    /// The caller's or the service's deadline passed.
    DeadlineExceeded,
    /// The caller gave up.
    Cancelled,
    /// The service cannot do it now.
    Unavailable,
    /// The service failed.
    Internal,
}

/// When the same request may succeed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Retry {
    /// Never as it is.
    No,
    /// After reading the current revision again.
    AfterReading,
    /// After the delay that the error states.
    AfterDelay,
    /// With more time.
    WithMoreTime,
}

/// What a code is on either protocol.
#[derive(Debug, Clone, Copy)]
pub struct Row {
    /// The code.
    pub code: ErrorCode,
    /// Over gRPC.
    pub grpc: Code,
    /// The gRPC code's name.
    pub name: &'static str,
    /// Status over HTTP.
    pub http: u16,
    /// When to try again.
    pub retry: Retry,
}

/// The table of codes.
pub const TABLE: &[Row] = &[
    row(
        ErrorCode::InvalidRequest,
        Code::InvalidArgument,
        "INVALID_ARGUMENT",
        400,
        Retry::No,
    ),
    row(
        ErrorCode::Unauthenticated,
        Code::Unauthenticated,
        "UNAUTHENTICATED",
        401,
        Retry::No,
    ),
    row(
        ErrorCode::Forbidden,
        Code::PermissionDenied,
        "PERMISSION_DENIED",
        403,
        Retry::No,
    ),
    row(ErrorCode::NotFound, Code::NotFound, "NOT_FOUND", 404, Retry::No),
    row(
        ErrorCode::MethodNotAllowed,
        Code::Unimplemented,
        "UNIMPLEMENTED",
        405,
        Retry::No,
    ),
    row(
        ErrorCode::Unimplemented,
        Code::Unimplemented,
        "UNIMPLEMENTED",
        501,
        Retry::No,
    ),
    row(ErrorCode::Conflict, Code::Aborted, "ABORTED", 409, Retry::AfterReading),
    row(ErrorCode::TooLarge, Code::OutOfRange, "OUT_OF_RANGE", 413, Retry::No),
    row(
        ErrorCode::Overloaded,
        Code::ResourceExhausted,
        "RESOURCE_EXHAUSTED",
        429,
        Retry::AfterDelay,
    ),
    row(
        ErrorCode::DeadlineExceeded,
        Code::DeadlineExceeded,
        "DEADLINE_EXCEEDED",
        504,
        Retry::WithMoreTime,
    ),
    row(ErrorCode::Cancelled, Code::Cancelled, "CANCELLED", 499, Retry::No),
    row(
        ErrorCode::Unavailable,
        Code::Unavailable,
        "UNAVAILABLE",
        503,
        Retry::AfterDelay,
    ),
    row(ErrorCode::Internal, Code::Internal, "INTERNAL", 500, Retry::No),
];

const fn row(code: ErrorCode, grpc: Code, name: &'static str, http: u16, retry: Retry) -> Row {
    Row {
        code,
        grpc,
        name,
        http,
        retry,
    }
}

impl ErrorCode {
    /// This code's row of the table.
    #[must_use]
    pub fn row(self) -> &'static Row {
        let found = TABLE.iter().find(|row| row.code == self);
        found.unwrap_or(&TABLE[TABLE.len() - 1])
    }

    /// The code for a gRPC status code, as far as it can be told.
    #[must_use]
    pub fn from_grpc(code: Code) -> Self {
        if code == Code::Unimplemented {
            return Self::Unimplemented;
        }
        let found = TABLE.iter().find(|row| row.grpc == code);
        found.map_or(Self::Internal, |row| row.code)
    }
}

/// The domain in every `google.rpc.ErrorInfo`.
pub const DOMAIN: &str = "takt";

/// Key of the metadata of a conflict: the revision that is current, empty where the robot does not exist.
pub const CURRENT_REVISION: &str = "current_revision";

/// Violations travel in HTTP/2 headers, which clients bound to 8 or 16 KiB; they are cut to this many bytes of text.
const VIOLATION_BYTES: usize = 3072;

/// Longest message, in bytes, for the same reason.
const MESSAGE_BYTES: usize = 512;

/// A refusal as it travels.
#[derive(Debug, Clone, PartialEq)]
pub struct Error {
    /// Why.
    pub code: ErrorCode,
    /// A sentence for the caller: lower case, no final full stop.
    pub message: String,
    /// What is wrong with the request, and where.
    pub violations: Vec<Invalid>,
    /// When to try again.
    pub retry_after: Option<Duration>,
    /// A constant for programs: `REVISION_MISMATCH`, or the limit that refused. Empty: none.
    pub reason: String,
    /// More for programs.
    pub metadata: Vec<(String, String)>,
}

impl Error {
    /// A refusal with nothing but a sentence.
    #[must_use]
    pub fn new(code: ErrorCode, message: impl Into<String>) -> Self {
        Self {
            code,
            message: cut(message.into(), MESSAGE_BYTES),
            violations: Vec::new(),
            retry_after: None,
            reason: String::new(),
            metadata: Vec::new(),
        }
    }

    /// The request is wrong in these places.
    #[must_use]
    pub fn invalid(violations: Vec<Invalid>) -> Self {
        let message = match violations.as_slice() {
            [] => "the request is invalid".to_owned(),
            [one] => one.to_string(),
            [first, rest @ ..] => format!("{first} (and {} more)", rest.len()),
        };
        let mut room = VIOLATION_BYTES;
        let kept = violations.into_iter().map_while(|mut violation| {
            violation.message = cut(violation.message, MESSAGE_BYTES);
            room = room.checked_sub(violation.path.len() + violation.message.len())?;
            Some(violation)
        });
        Self {
            violations: kept.collect(),
            ..Self::new(ErrorCode::InvalidRequest, message)
        }
    }

    /// One field is wrong.
    #[must_use]
    pub fn invalid_field(path: impl Into<String>, message: impl Into<String>) -> Self {
        Self::invalid(vec![Invalid::new(path, message)])
    }

    /// Another revision is current than the expected one; empty: the robot does not exist.
    #[must_use]
    pub fn conflict(current: &str, message: impl Into<String>) -> Self {
        Self {
            metadata: vec![(CURRENT_REVISION.to_owned(), current.to_owned())],
            ..Self::new(ErrorCode::Conflict, message).because("REVISION_MISMATCH")
        }
    }

    /// A limit refused the request for now.
    #[must_use]
    pub fn overloaded(limit: &str, message: impl Into<String>, retry_after: Duration) -> Self {
        Self {
            retry_after: Some(retry_after),
            metadata: vec![("limit".to_owned(), limit.to_owned())],
            ..Self::new(ErrorCode::Overloaded, message).because("OVERLOADED")
        }
    }

    /// The same with a reason for programs.
    #[must_use]
    pub fn because(mut self, reason: &str) -> Self {
        reason.clone_into(&mut self.reason);
        self
    }

    /// The revision that is current, where this is a conflict.
    #[must_use]
    pub fn current_revision(&self) -> Option<&str> {
        let found = self.metadata.iter().find(|(key, _)| key == CURRENT_REVISION);
        found.map(|(_, revision)| revision.as_str())
    }

    /// As a gRPC status with its details.
    #[must_use]
    pub fn to_status(&self) -> Status {
        let mut details = ErrorDetails::new();
        for violation in &self.violations {
            details.add_bad_request_violation(&violation.path, &violation.message);
        }
        if let Some(delay) = self.retry_after {
            details.set_retry_info(Some(delay));
        }
        if !self.reason.is_empty() {
            let metadata: HashMap<_, _> = self.metadata.iter().cloned().collect();
            details.set_error_info(&self.reason, DOMAIN, metadata);
        }
        Status::with_error_details(self.code.row().grpc, &self.message, details)
    }

    /// From a gRPC status.
    #[must_use]
    pub fn from_status(status: &Status) -> Self {
        let details = status.get_error_details();
        let violations = details.bad_request().map(|bad| {
            let list = bad.field_violations.iter();
            list.map(|violation| Invalid::new(&violation.field, &violation.description))
                .collect()
        });
        let info = details.error_info();
        let mut metadata: Vec<_> = info
            .map(|info| info.metadata.clone().into_iter().collect())
            .unwrap_or_default();
        metadata.sort();
        Self {
            code: ErrorCode::from_grpc(status.code()),
            message: status.message().to_owned(),
            violations: violations.unwrap_or_default(),
            retry_after: details.retry_info().and_then(|info| info.retry_delay),
            reason: info.map(|info| info.reason.clone()).unwrap_or_default(),
            metadata,
        }
    }

    /// As the JSON body of an HTTP answer.
    #[must_use]
    pub fn to_json(&self) -> Value {
        let row = self.code.row();
        let mut details = Vec::new();
        if !self.violations.is_empty() {
            let violations: Vec<_> = self
                .violations
                .iter()
                .map(|violation| json!({"field": violation.path, "description": violation.message}))
                .collect();
            details.push(json!({"@type": type_url("BadRequest"), "field_violations": violations}));
        }
        if let Some(delay) = self.retry_after {
            let seconds = format!("{:.3}s", delay.as_secs_f64());
            details.push(json!({"@type": type_url("RetryInfo"), "retry_delay": seconds}));
        }
        if !self.reason.is_empty() {
            let metadata: serde_json::Map<_, _> = self
                .metadata
                .iter()
                .map(|(key, value)| (key.clone(), Value::from(value.as_str())))
                .collect();
            details.push(json!({
                "@type": type_url("ErrorInfo"), "reason": self.reason, "domain": DOMAIN, "metadata": metadata,
            }));
        }
        json!({"error": {
            "code": i32::from(row.grpc),
            "status": row.name,
            "message": self.message,
            "details": details,
        }})
    }

    /// From the JSON body of an HTTP answer; `None` where it is something else.
    #[must_use]
    pub fn from_json(body: &[u8]) -> Option<Self> {
        let body: Value = serde_json::from_slice(body).ok()?;
        let error = body.get("error")?;
        let code = i32::try_from(error.get("code")?.as_i64()?).ok()?;
        let text = |value: &Value, key: &str| value.get(key).and_then(Value::as_str).unwrap_or("").to_owned();
        let mut read = Self::new(ErrorCode::from_grpc(Code::from_i32(code)), text(error, "message"));
        for detail in error.get("details").and_then(Value::as_array).into_iter().flatten() {
            let kind = text(detail, "@type");
            if kind == type_url("BadRequest") {
                let list = detail.get("field_violations").and_then(Value::as_array);
                let violations = list.into_iter().flatten();
                read.violations = violations
                    .map(|violation| Invalid::new(text(violation, "field"), text(violation, "description")))
                    .collect();
            } else if kind == type_url("RetryInfo") {
                let seconds = text(detail, "retry_delay");
                let seconds: Option<f64> = seconds.strip_suffix('s').and_then(|text| text.parse().ok());
                read.retry_after = seconds.and_then(|seconds| Duration::try_from_secs_f64(seconds).ok());
            } else if kind == type_url("ErrorInfo") {
                read.reason = text(detail, "reason");
                let metadata = detail.get("metadata").and_then(Value::as_object);
                let pairs = metadata.into_iter().flatten();
                read.metadata = pairs
                    .map(|(key, value)| (key.clone(), value.as_str().unwrap_or("").to_owned()))
                    .collect();
            }
        }
        Some(read)
    }
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.message)
    }
}

impl std::error::Error for Error {}

fn type_url(name: &str) -> String {
    format!("type.googleapis.com/google.rpc.{name}")
}

fn cut(mut text: String, bytes: usize) -> String {
    if text.len() > bytes {
        text.truncate(text.floor_char_boundary(bytes));
        text.push('…');
    }
    text
}

#[cfg(test)]
mod tests;
