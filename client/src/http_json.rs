//! The HTTP/JSON transport.

use std::{collections::BTreeMap, time::Duration};

use bytes::Bytes;
use http::{HeaderMap, Request, StatusCode, Uri, header};
use http_body_util::{BodyExt, Full, LengthLimitError, Limited};
use serde_json::Value;
use tonic::body::Body;

use crate::{
    connection::{self, Pool},
    error::{Code, Error, FieldViolation},
    lenient,
    rpc::Rpc,
};

/// Sends one request to one endpoint.
pub(crate) async fn send<R: Rpc>(
    pool: &Pool,
    endpoint: &Uri,
    request: &R::Request,
    left: Duration,
    max_reply_bytes: usize,
) -> Result<R::Response, Error> {
    let route = R::route(request);
    let body = match &route.body {
        None => Bytes::new(),
        Some(message) => serde_json::to_vec(message)
            .map_err(|error| {
                Error::refused("request", format!("cannot be written as JSON: {error}"))
            })?
            .into(),
    };
    let base = endpoint.to_string();
    let mut builder = Request::builder()
        .method(route.method)
        .uri(format!("{}{}", base.trim_end_matches('/'), route.path))
        .header(header::ACCEPT, "application/json")
        .header("grpc-timeout", connection::timeout_header(left));
    if route.body.is_some() {
        builder = builder.header(header::CONTENT_TYPE, "application/json");
    }
    let request = builder
        .body(Body::new(Full::new(body)))
        .map_err(|error| Error::refused("request", error.to_string()))?;

    let reply = pool.request(request).await.map_err(|error| {
        let (message, unsent) = connection::describe(&error);
        let error = Error::transport(message, error);
        if unsent { error.unsent() } else { error }
    })?;
    let (parts, body) = reply.into_parts();
    let bytes = Limited::new(body, max_reply_bytes)
        .collect()
        .await
        .map_err(|error| {
            if error.is::<LengthLimitError>() {
                Error::answered(
                    Code::TooLarge,
                    format!("the reply is over {max_reply_bytes} bytes"),
                )
            } else {
                Error::transport(format!("the connection broke: {error}"), error)
            }
        })?
        .to_bytes();
    if parts.status.is_success() {
        lenient::from_slice(&bytes).map_err(|error| {
            Error::answered(
                Code::Internal,
                format!("the reply is not understood: {error}"),
            )
        })
    } else {
        Err(from_reply(parts.status, &parts.headers, &bytes))
    }
}

/// Reads the JSON of a `google.rpc.Status`; what is no such thing came from something between us and the server.
fn from_reply(status: StatusCode, headers: &HeaderMap, body: &[u8]) -> Error {
    let retry_header = headers
        .get(header::RETRY_AFTER)
        .and_then(|value| value.to_str().ok()?.trim().parse().ok())
        .map(Duration::from_secs);
    let body: Value = serde_json::from_slice(body).unwrap_or(Value::Null);
    let (Some(code), Some(message)) = (body["code"].as_i64(), body["message"].as_str()) else {
        // A 404 from a proxy does not say that the robot is unknown.
        let code = match Code::from_http(status.as_u16()) {
            code @ (Code::Unavailable | Code::Overloaded | Code::DeadlineExceeded) => code,
            _ => Code::Internal,
        };
        return Error::answered(
            code,
            format!("answered {status}, but not as a Takt server does"),
        )
        .with_retry_after(retry_header);
    };
    let mut violations = Vec::new();
    let mut more = BTreeMap::new();
    let mut retry_after = retry_header;
    for detail in body["details"].as_array().into_iter().flatten() {
        let type_name = detail["@type"].as_str().unwrap_or_default();
        match type_name.rsplit(['.', '/']).next() {
            Some("BadRequest") => violations.extend(field_violations(detail)),
            Some("RetryInfo") => {
                retry_after = either(detail, "retry_delay", "retryDelay")
                    .as_str()
                    .and_then(duration)
                    .or(retry_after);
            }
            Some("ErrorInfo") => {
                for (key, value) in detail["metadata"].as_object().into_iter().flatten() {
                    more.insert(key.clone(), text(value));
                }
            }
            _ => {}
        }
    }
    Error::answered(
        Code::from_grpc(i32::try_from(code).unwrap_or_default()),
        message,
    )
    .with_violations(violations)
    .with_retry_after(retry_after)
    .with_details(more)
}

fn field_violations(detail: &Value) -> impl Iterator<Item = FieldViolation> {
    either(detail, "field_violations", "fieldViolations")
        .as_array()
        .into_iter()
        .flatten()
        .map(|violation| FieldViolation {
            field: text(&violation["field"]),
            description: text(&violation["description"]),
        })
}

fn either<'v>(value: &'v Value, name: &str, other: &str) -> &'v Value {
    match &value[name] {
        Value::Null => &value[other],
        found => found,
    }
}

fn text(value: &Value) -> String {
    value.as_str().unwrap_or_default().to_owned()
}

/// The JSON form of a protobuf duration: seconds and an `s`.
fn duration(text: &str) -> Option<Duration> {
    let seconds: f64 = text.strip_suffix('s')?.parse().ok()?;
    Duration::try_from_secs_f64(seconds).ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_takt_error_is_read_whole() {
        let body = br#"{"code": 8, "message": "queue is full", "details": [
            {"@type": "type.googleapis.com/google.rpc.RetryInfo", "retry_delay": "0.25s"},
            {"@type": "type.googleapis.com/google.rpc.BadRequest",
             "fieldViolations": [{"field": "target.position[1]", "description": "too far"}]},
            {"@type": "type.googleapis.com/google.rpc.ErrorInfo", "metadata": {"current_revision": "r2"}}]}"#;
        let error = from_reply(StatusCode::TOO_MANY_REQUESTS, &HeaderMap::new(), body);
        assert_eq!(error.code(), Code::Overloaded);
        assert_eq!(error.message(), "queue is full");
        assert_eq!(error.retry_after(), Some(Duration::from_millis(250)));
        assert_eq!(error.violations()[0].field, "target.position[1]");
        assert_eq!(error.details()["current_revision"], "r2");
    }

    #[test]
    fn a_proxys_not_found_is_not_an_unknown_robot() {
        let error = from_reply(
            StatusCode::NOT_FOUND,
            &HeaderMap::new(),
            b"<html>nginx</html>",
        );
        assert_eq!(error.code(), Code::Internal);
        let mut headers = HeaderMap::new();
        headers.insert(header::RETRY_AFTER, header::HeaderValue::from_static("3"));
        let error = from_reply(StatusCode::SERVICE_UNAVAILABLE, &headers, b"");
        assert!(error.retryable());
        assert_eq!(error.retry_after(), Some(Duration::from_secs(3)));
    }

    #[test]
    fn nonsense_delays_are_ignored() {
        for text in ["-1s", "NaNs", "1e300s", "1", ""] {
            assert_eq!(duration(text), None, "{text}");
        }
    }
}
