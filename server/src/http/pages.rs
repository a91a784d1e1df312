//! Pages: health, the OpenAPI document, the documentation, the front page.

use bytes::Bytes;
use http::{Method, Request, Response, StatusCode};
use tonic::body::Body;

use super::body_response;
use crate::{body::Incoming, health::Health, openapi};

const HTML: &str = "text/html; charset=utf-8";
const TEXT: &str = "text/plain; charset=utf-8";

/// The page of a URL; `None` where it has none.
pub(super) fn find(request: &Request<Incoming>, health: &Health) -> Option<Response<Body>> {
    if !matches!(request.method(), &Method::GET | &Method::HEAD) {
        return None;
    }
    let page = |kind, body: &'static [u8]| body_response(StatusCode::OK, kind, Bytes::from_static(body));
    match request.uri().path() {
        "/" => Some(page(HTML, include_bytes!("pages/index.html"))),
        "/docs" => Some(page(HTML, include_bytes!("pages/docs.html"))),
        "/openapi.json" => {
            let document = Bytes::from_static(openapi::document().as_bytes());
            Some(body_response(StatusCode::OK, "application/json", document))
        }
        "/healthz" => Some(page(TEXT, b"ok\n")),
        "/readyz" if health.is_ready() => Some(page(TEXT, b"ready\n")),
        "/readyz" => {
            let body = Bytes::from_static(b"not ready\n");
            Some(body_response(StatusCode::SERVICE_UNAVAILABLE, TEXT, body))
        }
        _ => None,
    }
}
