//! Errors of single requests within a stream.

use std::time::Duration;

use takt_motion::Invalid;
use tonic::Code;

use crate::{
    error::{Error, ErrorCode},
    v1,
};

/// Writes what a call of its own would have ended with.
#[must_use]
pub fn batch_error(error: &Error) -> v1::BatchError {
    let row = error.code.row();
    let violations = error.violations.iter().map(|violation| v1::BatchViolation {
        field: violation.path.clone(),
        description: violation.message.clone(),
    });
    v1::BatchError {
        code: row.grpc.into(),
        status: row.name.to_owned(),
        message: error.message.clone(),
        violations: violations.collect(),
        retry_delay_s: error.retry_after.map(|delay| delay.as_secs_f64()),
    }
}

/// Reads it back.
#[must_use]
pub fn error_of_batch(wire: v1::BatchError) -> Error {
    let violations = wire.violations.into_iter();
    Error {
        violations: violations
            .map(|violation| Invalid::new(violation.field, violation.description))
            .collect(),
        retry_after: wire
            .retry_delay_s
            .and_then(|seconds| Duration::try_from_secs_f64(seconds).ok()),
        ..Error::new(ErrorCode::from_grpc(Code::from_i32(wire.code)), wire.message)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_error_comes_back() {
        let invalid = Error::invalid(vec![Invalid::new("move.start", "must be given")]);
        let back = error_of_batch(batch_error(&invalid));
        assert_eq!(
            (back.code, &back.message, &back.violations),
            (invalid.code, &invalid.message, &invalid.violations)
        );
        let busy = Error::overloaded("planner.queue_capacity", "full", Duration::from_millis(250));
        let back = error_of_batch(batch_error(&busy));
        assert_eq!((back.code, back.retry_after), (busy.code, busy.retry_after));
    }
}
