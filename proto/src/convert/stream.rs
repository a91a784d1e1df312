//! Errors of single requests within a stream.

use crate::{error::Error, v1};

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

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use takt_motion::Invalid;

    use super::*;

    #[test]
    fn an_error_keeps_its_code_its_fields_and_its_delay() {
        let invalid = batch_error(&Error::invalid(vec![Invalid::new("move.start", "must be given")]));
        assert_eq!((invalid.code, invalid.status.as_str()), (3, "INVALID_ARGUMENT"));
        assert_eq!(invalid.violations[0].field, "move.start");
        let busy = batch_error(&Error::overloaded(
            "planner.queue_capacity",
            "full",
            Duration::from_millis(250),
        ));
        assert_eq!((busy.code, busy.retry_delay_s), (8, Some(0.25)));
    }
}
