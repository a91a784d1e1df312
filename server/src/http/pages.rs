//! Pages: health, the OpenAPI document, the documentation, the front page.

use axum::{Router, response::Html, routing::any};
use http::{StatusCode, Uri};

use super::{json_response, unknown};
use crate::{health::Health, openapi};

/// The pages; every other path and method is unknown.
pub(super) fn router(health: Health) -> Router {
    let unknown = |uri: Uri| async move { unknown(&uri) };
    let document = || async { json_response(StatusCode::OK, openapi::document()) };
    let readiness = move || async move {
        if health.is_ready() {
            (StatusCode::OK, "ready\n")
        } else {
            (StatusCode::SERVICE_UNAVAILABLE, "not ready\n")
        }
    };
    Router::new()
        .route("/", any(unknown).get(Html(include_str!("pages/index.html"))))
        .route("/docs", any(unknown).get(Html(include_str!("pages/docs.html"))))
        .route("/openapi.json", any(unknown).get(document))
        .route("/healthz", any(unknown).get("ok\n"))
        .route("/readyz", any(unknown).get(readiness))
        .fallback(unknown)
}
