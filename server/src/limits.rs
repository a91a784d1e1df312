//! Time and size limits of a request.

use std::time::{Duration, Instant};

use http::HeaderMap;
use takt_motion::Invalid;

use crate::{config::Limits, error::ServiceError};

/// Header of an HTTP request: how many seconds the caller will wait for the answer. Over gRPC the protocol's own
/// `grpc-timeout` says it.
pub(crate) const REQUEST_TIMEOUT: &str = "request-timeout";

const GRPC_TIMEOUT: &str = "grpc-timeout";

/// When the answer must be there: the caller's deadline, or the service's where that comes first.
pub(crate) fn deadline(
    headers: &HeaderMap,
    is_grpc: bool,
    limits: &Limits,
    now: Instant,
) -> Result<Instant, ServiceError> {
    let longest = Duration::from_secs_f64(limits.deadline_s);
    let name = if is_grpc { GRPC_TIMEOUT } else { REQUEST_TIMEOUT };
    let Some(value) = headers.get(name) else {
        return Ok(now + longest);
    };
    let text = value.to_str().ok();
    let stated = text.and_then(if is_grpc { grpc_timeout } else { seconds });
    let Some(stated) = stated else {
        let message = match is_grpc {
            true => "is not a gRPC timeout, such as \"250m\"",
            false => "is not a number of seconds, such as \"0.25\"",
        };
        return Err(ServiceError::invalid(vec![Invalid::new(name, message)]));
    };
    Ok(now + stated.min(longest))
}

fn seconds(text: &str) -> Option<Duration> {
    let seconds: f64 = text.trim().parse().ok()?;
    if seconds.is_nan() || seconds < 0.0 {
        return None;
    }
    Some(Duration::try_from_secs_f64(seconds).unwrap_or(Duration::MAX))
}

/// At most eight digits and a unit.
fn grpc_timeout(text: &str) -> Option<Duration> {
    let unit = text.chars().last()?;
    let digits = text.strip_suffix(unit)?;
    if digits.is_empty() || digits.len() > 8 || !digits.bytes().all(|byte| byte.is_ascii_digit()) {
        return None;
    }
    let count: u64 = digits.parse().ok()?;
    match unit {
        'H' => Some(Duration::from_secs(count * 3600)),
        'M' => Some(Duration::from_secs(count * 60)),
        'S' => Some(Duration::from_secs(count)),
        'm' => Some(Duration::from_millis(count)),
        'u' => Some(Duration::from_micros(count)),
        'n' => Some(Duration::from_nanos(count)),
        _ => None,
    }
}

/// A violation where a list is longer than a limit.
pub(crate) fn at_most(field: &str, count: usize, limit: usize, name: &str) -> Option<Invalid> {
    (count > limit).then(|| {
        let message = format!("{count} is more than the {limit} that `limits.{name}` allows");
        Invalid::new(field, message)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn after(name: &'static str, value: &'static str, is_grpc: bool) -> Option<Duration> {
        let now = Instant::now();
        let headers = HeaderMap::from_iter([(
            http::HeaderName::from_static(name),
            http::HeaderValue::from_static(value),
        )]);
        let deadline = deadline(&headers, is_grpc, &Limits::default(), now).ok()?;
        Some(deadline - now)
    }

    #[test]
    fn the_earlier_deadline_counts() {
        assert_eq!(after(GRPC_TIMEOUT, "250m", true), Some(Duration::from_millis(250)));
        assert_eq!(after(GRPC_TIMEOUT, "99999999H", true), Some(Duration::from_secs(30)));
        assert_eq!(after(REQUEST_TIMEOUT, "0.25", false), Some(Duration::from_millis(250)));
        assert_eq!(after(REQUEST_TIMEOUT, "1e300", false), Some(Duration::from_secs(30)));
        assert_eq!(after("other", "1", false), Some(Duration::from_secs(30)));
    }

    #[test]
    fn a_malformed_timeout_is_refused() {
        for bad in ["", "1", "m", "123456789m", "-1m", "1x", "1.5S"] {
            assert_eq!(after(GRPC_TIMEOUT, bad, true), None, "{bad}");
        }
        for bad in ["", "soon", "-1", "NaN"] {
            assert_eq!(after(REQUEST_TIMEOUT, bad, false), None, "{bad}");
        }
    }

    #[test]
    fn the_limit_itself_is_allowed() {
        assert!(at_most("states", 10, 10, "max_states").is_none());
        assert!(at_most("states", 11, 10, "max_states").is_some());
    }
}
