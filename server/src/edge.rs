//! What is the same for every request of either protocol: its id, its log line, its deadline, and the limit on how many
//! are in work.

use std::{
    collections::hash_map::RandomState,
    error::Error as _,
    hash::BuildHasher,
    panic::AssertUnwindSafe,
    pin::pin,
    sync::{
        Arc,
        atomic::{AtomicU64, Ordering},
    },
    time::{Duration, Instant},
};

use axum::{
    Router,
    response::{IntoResponse, Response},
};
use futures::FutureExt;
use http::{HeaderMap, HeaderName, HeaderValue, Request, header};
use takt_proto::error::{Error, ErrorCode};
use tokio::sync::{OwnedSemaphorePermit, Semaphore};
use tower::Service as _;
use tracing::{Instrument, Span, field::Empty};

use crate::{
    body::{Budget, Held, Incoming},
    config::Limits,
    error::ServiceError,
    grpc::{self, Grpc},
    health::Health,
    http as http_edge, limits,
    planner::{Timing, panicked},
    service::{Call, Service},
};

/// Header and metadata: how long the request waited and was computed.
pub(crate) const SERVER_TIMING: &str = "server-timing";

const REQUEST_ID: HeaderName = HeaderName::from_static("x-request-id");

/// Longest request id that is taken over from a caller.
const LONGEST_ID: usize = 128;

/// What a caller is told to wait where too many requests are in work.
const RETRY_AFTER: Duration = Duration::from_millis(100);

/// Both protocols of the port.
#[derive(Debug)]
pub(crate) struct Edge {
    grpc: Grpc,
    http: Router,
    limits: Limits,
    in_work: Arc<Semaphore>,
    bytes: Arc<Budget>,
    ids: Ids,
}

impl Edge {
    pub(crate) fn new(
        service: Arc<Service>,
        health: Health,
        limits: Limits,
    ) -> Result<Self, tonic_reflection::server::Error> {
        Ok(Self {
            grpc: Grpc::new(Arc::clone(&service), &health, limits.max_request_bytes)?,
            http: http_edge::router(service, health, limits.max_request_bytes),
            in_work: Arc::new(Semaphore::new(limits.max_concurrent_requests)),
            bytes: Budget::new(limits.max_bytes_in_work),
            limits,
            ids: Ids::default(),
        })
    }

    /// Answers one request, whatever happens.
    pub(crate) async fn handle(&self, request: Request<hyper::body::Incoming>) -> Response {
        let started = Instant::now();
        let is_grpc = is_grpc(request.headers());
        let id = self.ids.of(request.headers());
        let span = span(&request, is_grpc, &id);
        // Here and below a future stays in its place: kilobytes would be moved with it.
        let handling = pin!(self.admit(request, is_grpc, started));
        let handling = AssertUnwindSafe(handling).catch_unwind();
        let answered = pin!(async {
            let mut response = handling
                .await
                .unwrap_or_else(|panic| refuse(panicked(panic.as_ref()), is_grpc));
            log(&response, &id, started.elapsed());
            response.headers_mut().insert(REQUEST_ID, id);
            response
        });
        if span.is_disabled() {
            answered.await
        } else {
            answered.instrument(span).await
        }
    }

    async fn admit(&self, request: Request<hyper::body::Incoming>, is_grpc: bool, now: Instant) -> Response {
        let (head, body) = request.into_parts();
        let (body, held) = self.bytes.counted(body);
        let mut request = Request::from_parts(head, body);
        if is_probe(request.uri().path()) {
            return self.dispatch(request, is_grpc).await;
        }
        let deadline = match limits::deadline(request.headers(), is_grpc, &self.limits, now) {
            Ok(deadline) => deadline,
            Err(error) => return refuse(error, is_grpc),
        };
        let Ok(place) = Arc::clone(&self.in_work).try_acquire_owned() else {
            let message = format!("{} requests are in work already", self.limits.max_concurrent_requests);
            let error = Error::overloaded("limits.max_concurrent_requests", message, RETRY_AFTER);
            return refuse(error.into(), is_grpc);
        };
        if deadline <= Instant::now() {
            return refuse(ServiceError::deadline(), is_grpc);
        }
        let admission = Admission(Arc::new((place, held)));
        let allowed = deadline.saturating_duration_since(now);
        request.extensions_mut().insert(Call::new(deadline, allowed));
        request.extensions_mut().insert(admission.clone());
        let dispatched = pin!(self.dispatch(request, is_grpc));
        match tokio::time::timeout_at(deadline.into(), dispatched).await {
            Ok(response) => response,
            Err(_) => refuse(ServiceError::deadline(), is_grpc),
        }
    }

    async fn dispatch(&self, request: Request<Incoming>, is_grpc: bool) -> Response {
        if is_grpc {
            return self.grpc.answer(request).await;
        }
        let Ok(response) = self.http.clone().call(request).await;
        response
    }
}

/// A request's place among those in work, and its hold on bytes; given back when the last holder is gone.
#[derive(Debug, Clone)]
pub(crate) struct Admission(Arc<(OwnedSemaphorePermit, Arc<Held>)>);

impl Admission {
    /// The hold on the request's bytes.
    pub(crate) fn held(&self) -> &Held {
        &self.0.1
    }
}

fn is_grpc(headers: &HeaderMap) -> bool {
    let kind = headers.get(header::CONTENT_TYPE);
    kind.is_some_and(|kind| kind.as_bytes().starts_with(b"application/grpc"))
}

/// Questions after the service's health are answered under any load.
fn is_probe(path: &str) -> bool {
    matches!(path, "/healthz" | "/readyz") || path.starts_with("/grpc.health.v1.Health/")
}

fn refuse(error: ServiceError, is_grpc: bool) -> Response {
    if is_grpc {
        grpc::refuse(error)
    } else {
        error.into_response()
    }
}

/// The error behind an answer, on either protocol.
fn error_of(response: &Response) -> Option<&ServiceError> {
    let extensions = response.extensions();
    let in_status = || extensions.get::<tonic::Status>()?.source()?.downcast_ref();
    extensions.get().or_else(in_status)
}

/// One line a request: what failed in the service at `warn`, everything else at `debug`.
fn log(response: &Response, request_id: &HeaderValue, elapsed: Duration) {
    let elapsed_us = u64::try_from(elapsed.as_micros()).unwrap_or(u64::MAX);
    let id = request_id.to_str().unwrap_or("");
    let Some(error) = error_of(response) else {
        tracing::debug!(id, elapsed_us, "request");
        return;
    };
    let row = error.wire().code.row();
    Span::current().record("outcome", row.name);
    let message = error.wire().message.as_str();
    match (error.cause(), row.code) {
        (Some(cause), _) => {
            tracing::warn!(id, elapsed_us, code = row.name, refusal = message, cause = %cause, "request failed");
        }
        (None, ErrorCode::Internal | ErrorCode::Unavailable) => {
            tracing::warn!(id, elapsed_us, code = row.name, refusal = message, "request failed");
        }
        _ => tracing::debug!(id, elapsed_us, code = row.name, refusal = message, "request refused"),
    }
}

fn span(request: &Request<hyper::body::Incoming>, is_grpc: bool, id: &HeaderValue) -> Span {
    tracing::debug_span!(
        "request",
        id = id.to_str().unwrap_or(""),
        protocol = if is_grpc { "grpc" } else { "http" },
        method = request.method().as_str(),
        path = request.uri().path(),
        robot = Empty,
        revision = Empty,
        outcome = Empty,
        queue_us = Empty,
        compute_us = Empty,
    )
}

/// The header's value: milliseconds, as browsers read it.
pub(crate) fn server_timing(timing: Timing) -> String {
    let parts = |duration: Duration| (duration.as_micros() / 1000, duration.as_micros() % 1000);
    let ((queue, queue_us), (compute, compute_us)) = (parts(timing.queue), parts(timing.compute));
    format!("queue;dur={queue}.{queue_us:03}, compute;dur={compute}.{compute_us:03}")
}

/// Makes request ids: different in every process, and counted.
#[derive(Debug, Default)]
struct Ids {
    state: RandomState,
    count: AtomicU64,
}

impl Ids {
    /// The caller's id, or a new one.
    fn of(&self, headers: &HeaderMap) -> HeaderValue {
        let given = headers.get(&REQUEST_ID);
        let usable = |id: &&HeaderValue| {
            let bytes = id.as_bytes();
            !bytes.is_empty() && bytes.len() <= LONGEST_ID && bytes.iter().all(u8::is_ascii_graphic)
        };
        if let Some(id) = given.filter(usable) {
            return id.clone();
        }
        let number = self.state.hash_one(self.count.fetch_add(1, Ordering::Relaxed));
        let id = HeaderValue::try_from(format!("{number:016x}"));
        id.unwrap_or_else(|_| HeaderValue::from_static("0"))
    }
}
