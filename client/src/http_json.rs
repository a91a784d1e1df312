//! The HTTP/JSON transport.

use std::{io, time::Duration};

use bytes::Bytes;
use http::{HeaderMap, Request, StatusCode, Uri, header};
use http_body_util::{BodyExt, Full, LengthLimitError, Limited};
use serde::Serialize;
use serde_json::ser::Formatter;
use takt_proto::error as wire;
use tonic::body::Body;

use crate::{
    connection::{self, Pool},
    error::{Code, Error},
    lenient,
    rpc::{self, Rpc},
};

/// Header with the seconds that the caller will wait.
const REQUEST_TIMEOUT: &str = "request-timeout";

/// Sends one request to one endpoint.
pub(crate) async fn send<R: Rpc>(
    pool: &Pool,
    endpoint: &Uri,
    request: &R::Request,
    left: Duration,
    max_reply_bytes: usize,
) -> Result<R::Response, Error> {
    let route = rpc::http_route::<R>(request);
    let body = match &route.body {
        None => Bytes::new(),
        Some(message) => to_json(message)
            .map_err(|error| Error::refused("request", format!("cannot be written as JSON: {error}")))?
            .into(),
    };
    let base = endpoint.to_string();
    let mut builder = Request::builder()
        .method(route.method.as_str())
        .uri(format!("{}{}", base.trim_end_matches('/'), route.path))
        .header(header::ACCEPT, "application/json")
        .header(REQUEST_TIMEOUT, connection::request_timeout(left));
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
                Error::answered(Code::TooLarge, format!("the reply is over {max_reply_bytes} bytes"))
            } else {
                Error::transport(format!("the connection broke: {error}"), error)
            }
        })?
        .to_bytes();
    if parts.status.is_success() {
        lenient::from_slice(&bytes)
            .map_err(|error| Error::answered(Code::Internal, format!("the reply is not understood: {error}")))
    } else {
        Err(from_reply(parts.status, &parts.headers, &bytes))
    }
}

/// A message as JSON.
fn to_json(message: &impl Serialize) -> serde_json::Result<Vec<u8>> {
    let mut json = Vec::new();
    message.serialize(&mut serde_json::Serializer::with_formatter(&mut json, Honest))?;
    Ok(json)
}

/// Writes JSON as usual, but for numbers that are not finite: JSON has none, and `null` in their place would be read as
/// "not given". Messages have no other nulls, so that the service refuses the field by its name.
struct Honest;

impl Formatter for Honest {
    fn write_null<W: ?Sized + io::Write>(&mut self, writer: &mut W) -> io::Result<()> {
        writer.write_all(b"\"NaN\"")
    }
}

/// What is no error of Takt's came from something between us and the server.
fn from_reply(status: StatusCode, headers: &HeaderMap, body: &[u8]) -> Error {
    if let Some(error) = wire::Error::from_json(body) {
        return Error::from_wire(error);
    }
    // A 404 from a proxy does not say that the robot is unknown.
    let code = match status.as_u16() {
        429 => Code::Overloaded,
        502 | 503 => Code::Unavailable,
        504 => Code::DeadlineExceeded,
        _ => Code::Internal,
    };
    let retry_after = headers
        .get(header::RETRY_AFTER)
        .and_then(|value| value.to_str().ok()?.trim().parse().ok())
        .map(Duration::from_secs);
    Error::answered(code, format!("answered {status}, but not as a Takt server does")).with_retry_after(retry_after)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_takt_error_is_read_whole() {
        let body = br#"{"error": {"code": 8, "message": "queue is full", "details": [
            {"@type": "type.googleapis.com/google.rpc.RetryInfo", "retry_delay": "0.25s"},
            {"@type": "type.googleapis.com/google.rpc.BadRequest",
             "field_violations": [{"field": "target.position[1]", "description": "too far"}]},
            {"@type": "type.googleapis.com/google.rpc.ErrorInfo", "reason": "OVERLOADED", "metadata": {"current_revision": "r2"}}]}}"#;
        let error = from_reply(StatusCode::TOO_MANY_REQUESTS, &HeaderMap::new(), body);
        assert_eq!(error.code(), Code::Overloaded);
        assert_eq!(error.message(), "queue is full");
        assert_eq!(error.retry_after(), Some(Duration::from_millis(250)));
        assert_eq!(error.violations()[0].field, "target.position[1]");
        assert_eq!(error.details()["current_revision"], "r2");
    }

    #[test]
    fn a_proxys_not_found_is_not_an_unknown_robot() {
        let error = from_reply(StatusCode::NOT_FOUND, &HeaderMap::new(), b"<html>nginx</html>");
        assert_eq!(error.code(), Code::Internal);
        let mut headers = HeaderMap::new();
        headers.insert(header::RETRY_AFTER, header::HeaderValue::from_static("3"));
        let error = from_reply(StatusCode::SERVICE_UNAVAILABLE, &headers, b"");
        assert!(error.retryable());
        assert_eq!(error.retry_after(), Some(Duration::from_secs(3)));
    }
}
