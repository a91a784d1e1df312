//! The HTTP/JSON transport.

use std::{io, time::Duration};

use futures::{StreamExt, stream::BoxStream};
use http::{HeaderMap, StatusCode, Uri, header};
use reqwest::{Client, Response};
use serde::Serialize;
use serde_json::ser::Formatter;
use takt_proto::{error as wire, route::JSON_LINES};

use crate::{
    connection,
    error::{Code, Error},
    lenient,
    rpc::{self, Rpc},
    stream::{Lines, Outgoing, Pieces},
};

/// Header with the seconds that the caller will wait.
const REQUEST_TIMEOUT: &str = "request-timeout";

/// Sends one request to one endpoint.
pub(crate) async fn send<R: Rpc>(
    client: &Client,
    endpoint: &Uri,
    request: &R::Request,
    left: Duration,
    max_reply_bytes: usize,
) -> Result<R::Response, Error> {
    let route = rpc::http_route::<R>(request);
    let base = endpoint.to_string();
    let method = reqwest::Method::from_bytes(route.method.as_str().as_bytes())
        .map_err(|error| Error::refused("request", error.to_string()))?;
    let mut request = client
        .request(method, format!("{}{}", base.trim_end_matches('/'), route.path))
        .header(header::ACCEPT, "application/json")
        .header(REQUEST_TIMEOUT, connection::request_timeout(left));
    if let Some(message) = &route.body {
        let body = to_json(message)
            .map_err(|error| Error::refused("request", format!("cannot be written as JSON: {error}")))?;
        request = request.header(header::CONTENT_TYPE, "application/json").body(body);
    }
    let mut reply = request.send().await.map_err(broken)?;
    let bytes = read(&mut reply, max_reply_bytes).await?;
    if reply.status().is_success() {
        lenient::from_slice(&bytes)
            .map_err(|error| Error::answered(Code::Internal, format!("the reply is not understood: {error}")))
    } else {
        Err(from_reply(reply.status(), reply.headers(), &bytes))
    }
}

/// Begins a stream: `head` says which robot it is about, and is all there is to say where no requests follow.
pub(crate) async fn open<R: Rpc>(
    client: &Client,
    endpoint: &Uri,
    head: &R::Request,
    requests: Option<BoxStream<'static, R::Request>>,
    max_reply_bytes: usize,
) -> Result<Pieces<R::Response>, Error> {
    let route = rpc::http_route::<R>(head);
    let base = endpoint.to_string();
    let request = client
        .post(format!("{}{}", base.trim_end_matches('/'), route.path))
        .header(header::ACCEPT, JSON_LINES);
    let unwritable = |error| Error::refused("request", format!("cannot be written as JSON: {error}"));
    let request = match (requests, &route.body) {
        (Some(requests), _) => {
            let lines = requests.map(|request| {
                let mut line = to_json(&request)?;
                line.push(b'\n');
                Ok(line.into())
            });
            request
                .header(header::CONTENT_TYPE, JSON_LINES)
                .body(reqwest::Body::wrap(Outgoing::of(lines)))
        }
        (None, body) => {
            let body = body.as_ref().map(to_json).transpose().map_err(unwritable)?;
            request
                .header(header::CONTENT_TYPE, "application/json")
                .body(body.unwrap_or_default())
        }
    };
    let mut reply = request.send().await.map_err(broken)?;
    if reply.status().is_success() {
        return Ok(Pieces::Http(Lines::of(reply, max_reply_bytes)));
    }
    let bytes = read(&mut reply, max_reply_bytes).await?;
    Err(from_reply(reply.status(), reply.headers(), &bytes))
}

pub(crate) fn broken(error: reqwest::Error) -> Error {
    let (message, unsent) = connection::describe(&error);
    let error = Error::transport(message, error);
    if unsent { error.unsent() } else { error }
}

/// The body of a reply, as far as it is not too long.
async fn read(reply: &mut Response, max_reply_bytes: usize) -> Result<Vec<u8>, Error> {
    let mut bytes = Vec::new();
    loop {
        let chunk = reply.chunk().await.map_err(broken)?;
        let Some(chunk) = chunk else { return Ok(bytes) };
        if bytes.len() + chunk.len() > max_reply_bytes {
            let message = format!("the reply is over {max_reply_bytes} bytes");
            return Err(Error::answered(Code::TooLarge, message));
        }
        bytes.extend_from_slice(&chunk);
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
