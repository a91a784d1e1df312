//! The client against small servers that misbehave in every way, over both transports.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on should stop")]

#[path = "faults/streams.rs"]
mod streams;

use std::{
    convert::Infallible,
    future::pending,
    sync::{
        Arc, Mutex,
        atomic::{AtomicUsize, Ordering},
    },
    time::Duration,
};

use futures::stream;
use http::{Method, Request as HttpRequest, Response as HttpResponse};
use http_body_util::{BodyExt, Full};
use hyper_util::{
    rt::{TokioExecutor, TokioIo},
    server::conn::auto,
    service::TowerToHyperService,
};
use takt_client::{Client, Code, ErrorKind, RetryPolicy, Transport, v1};
use takt_proto::v1::{
    plan_service_server::{PlanService, PlanServiceServer},
    robot_service_server::{RobotService, RobotServiceServer},
};
use tokio::net::TcpListener;
use tonic::body::Body;
use tonic::{Request, Status};
use tonic_types::{ErrorDetails, StatusExt};
use tower::{ServiceExt, service_fn};

const BOTH: [Transport; 2] = [Transport::Grpc, Transport::Http];

/// What the fake does with a request, by its number.
#[derive(Clone, Copy, Debug)]
enum Act {
    Answer,
    Unavailable,
    Overloaded,
    Invalid,
    Conflict,
    Hang,
}

#[derive(Clone)]
struct Fake {
    name: &'static str,
    script: &'static [Act],
    seen: Arc<AtomicUsize>,
    timeout: Arc<Mutex<String>>,
}

impl Fake {
    fn new(name: &'static str, script: &'static [Act]) -> Self {
        Self {
            name,
            script,
            seen: Arc::default(),
            timeout: Arc::default(),
        }
    }

    fn seen(&self) -> usize {
        self.seen.load(Ordering::SeqCst)
    }

    /// The last act of the script repeats.
    fn next(&self, timeout: Option<&str>) -> Act {
        *self.timeout.lock().unwrap() = timeout.unwrap_or_default().to_owned();
        let number = self.seen.fetch_add(1, Ordering::SeqCst);
        self.script[number.min(self.script.len() - 1)]
    }

    async fn act<T>(&self, metadata: &tonic::metadata::MetadataMap, answer: T) -> Result<tonic::Response<T>, Status> {
        let timeout = metadata.get("grpc-timeout").and_then(|value| value.to_str().ok());
        let details = |code, message: &str, details| Err(Status::with_error_details(code, message, details));
        match self.next(timeout) {
            Act::Answer => Ok(tonic::Response::new(answer)),
            Act::Unavailable => Err(Status::unavailable("starting")),
            Act::Overloaded => details(
                tonic::Code::ResourceExhausted,
                "full",
                ErrorDetails::with_retry_info(Some(Duration::from_millis(1))),
            ),
            Act::Invalid => details(
                tonic::Code::InvalidArgument,
                "wrong",
                ErrorDetails::with_bad_request_violation("target.position[1]", "too far"),
            ),
            Act::Conflict => details(
                tonic::Code::Aborted,
                "differs",
                ErrorDetails::with_error_info("CONFLICT", "takt", [("current_revision".to_owned(), "r2".to_owned())]),
            ),
            Act::Hang => pending().await,
        }
    }

    /// Serves gRPC and HTTP on one port, as the real server does.
    async fn serve(&self) -> String {
        let listener = TcpListener::bind("127.0.0.1:0").await.unwrap();
        let address = listener.local_addr().unwrap();
        let fake = self.clone();
        tokio::spawn(async move {
            while let Ok((stream, _)) = listener.accept().await {
                let fake = fake.clone();
                let service = service_fn(move |request| fake.clone().route(request));
                tokio::spawn(async move {
                    let builder = auto::Builder::new(TokioExecutor::new());
                    let _ = builder
                        .serve_connection(TokioIo::new(stream), TowerToHyperService::new(service))
                        .await;
                });
            }
        });
        format!("http://{address}")
    }

    async fn route(self, request: HttpRequest<hyper::body::Incoming>) -> Result<HttpResponse<Body>, Infallible> {
        match request.uri().path() {
            path if path.starts_with("/takt.v1.PlanService/") => PlanServiceServer::new(self).oneshot(request).await,
            path if path.starts_with("/takt.v1.RobotService/") => RobotServiceServer::new(self).oneshot(request).await,
            _ => Ok(http(self, request).await),
        }
    }
}

fn plan(name: &str) -> v1::PlanMoveResponse {
    v1::PlanMoveResponse {
        provenance: Some(v1::Provenance {
            version: name.to_owned(),
            ..Default::default()
        }),
        ..Default::default()
    }
}

#[tonic::async_trait]
impl PlanService for Fake {
    async fn plan_move(
        &self,
        request: Request<v1::PlanMoveRequest>,
    ) -> Result<tonic::Response<v1::PlanMoveResponse>, Status> {
        self.act(request.metadata(), plan(self.name)).await
    }

    async fn plan_path(
        &self,
        request: Request<v1::PlanPathRequest>,
    ) -> Result<tonic::Response<v1::PlanPathResponse>, Status> {
        self.act(request.metadata(), v1::PlanPathResponse::default()).await
    }

    type PlanBatchStream = stream::Empty<Result<v1::PlanBatchResponse, Status>>;

    async fn plan_batch(
        &self,
        request: Request<tonic::Streaming<v1::PlanBatchRequest>>,
    ) -> Result<tonic::Response<Self::PlanBatchStream>, Status> {
        self.act(request.metadata(), stream::empty()).await
    }

    type StreamSetpointsStream = stream::Iter<std::vec::IntoIter<Result<v1::StreamSetpointsResponse, Status>>>;

    async fn stream_setpoints(
        &self,
        request: Request<v1::StreamSetpointsRequest>,
    ) -> Result<tonic::Response<Self::StreamSetpointsStream>, Status> {
        let pieces: Vec<_> = streams::pieces(self.name).into_iter().map(Ok).collect();
        self.act(request.metadata(), stream::iter(pieces)).await
    }

    async fn check_trajectory(
        &self,
        request: Request<v1::CheckTrajectoryRequest>,
    ) -> Result<tonic::Response<v1::CheckTrajectoryResponse>, Status> {
        self.act(request.metadata(), v1::CheckTrajectoryResponse::default())
            .await
    }
}

#[tonic::async_trait]
impl RobotService for Fake {
    async fn register_robot(
        &self,
        request: Request<v1::RegisterRobotRequest>,
    ) -> Result<tonic::Response<v1::RegisterRobotResponse>, Status> {
        self.act(request.metadata(), v1::RegisterRobotResponse::default()).await
    }

    async fn get_robot(
        &self,
        request: Request<v1::GetRobotRequest>,
    ) -> Result<tonic::Response<v1::GetRobotResponse>, Status> {
        self.act(request.metadata(), v1::GetRobotResponse::default()).await
    }

    async fn list_robots(
        &self,
        request: Request<v1::ListRobotsRequest>,
    ) -> Result<tonic::Response<v1::ListRobotsResponse>, Status> {
        self.act(request.metadata(), v1::ListRobotsResponse::default()).await
    }

    async fn list_revisions(
        &self,
        request: Request<v1::ListRevisionsRequest>,
    ) -> Result<tonic::Response<v1::ListRevisionsResponse>, Status> {
        self.act(request.metadata(), v1::ListRevisionsResponse::default()).await
    }

    async fn delete_robot(
        &self,
        request: Request<v1::DeleteRobotRequest>,
    ) -> Result<tonic::Response<v1::DeleteRobotResponse>, Status> {
        self.act(request.metadata(), v1::DeleteRobotResponse::default()).await
    }
}

async fn http(fake: Fake, request: HttpRequest<hyper::body::Incoming>) -> HttpResponse<Body> {
    if request.uri().path() == "/readyz" {
        let ready = matches!(fake.next(None), Act::Answer);
        let reply = HttpResponse::builder().status(if ready { 200 } else { 503 });
        return reply.body(Body::empty()).unwrap();
    }
    let timeout = request
        .headers()
        .get("request-timeout")
        .and_then(|value| value.to_str().ok());
    let act = fake.next(timeout);
    let reply = |status: u16, body: String| {
        HttpResponse::builder()
            .status(status)
            .body(Body::new(Full::from(body)))
            .unwrap()
    };
    let error = |status: u16, code: i32, message: &str, detail: &str| {
        let body = format!(r#"{{"error": {{"code": {code}, "message": "{message}", "details": [{detail}]}}}}"#);
        reply(status, body)
    };
    match act {
        Act::Answer if request.uri().path() == "/v1/robots/arm:streamSetpoints" => {
            let lines = streams::pieces(fake.name).into_iter();
            let lines = lines.map(|piece| serde_json::to_string(&piece).unwrap() + "\n");
            reply(200, lines.collect())
        }
        Act::Answer if request.method() == Method::POST => {
            assert_eq!(request.uri().path(), "/v1/robots/arm:planMove");
            let body = request.into_body().collect().await.unwrap().to_bytes();
            let request: v1::PlanMoveRequest = serde_json::from_slice(&body).unwrap();
            assert_eq!(request.robot_id, "");
            reply(200, serde_json::to_string(&plan(fake.name)).unwrap())
        }
        Act::Answer => reply(200, "{}".to_owned()),
        Act::Unavailable => error(503, 14, "starting", ""),
        Act::Overloaded => error(
            429,
            8,
            "full",
            r#"{"@type": "type.googleapis.com/google.rpc.RetryInfo", "retry_delay": "0.001s"}"#,
        ),
        Act::Invalid => error(
            400,
            3,
            "wrong",
            r#"{"@type": "type.googleapis.com/google.rpc.BadRequest",
                "field_violations": [{"field": "target.position[1]", "description": "too far"}]}"#,
        ),
        Act::Conflict => error(
            409,
            10,
            "differs",
            r#"{"@type": "type.googleapis.com/google.rpc.ErrorInfo", "reason": "REVISION_MISMATCH",
                "metadata": {"current_revision": "r2"}}"#,
        ),
        Act::Hang => pending().await,
    }
}

/// A client that is as patient as the real one and a thousand times as fast.
fn client(transport: Transport, endpoints: &[&str]) -> Client {
    let quick = RetryPolicy {
        first_backoff: Duration::from_micros(50),
        longest_backoff: Duration::from_micros(200),
        ..RetryPolicy::default()
    };
    let builder = Client::builder()
        .transport(transport)
        .retry(quick)
        .connect_timeout(Duration::from_secs(20));
    endpoints
        .iter()
        .fold(builder, |builder, url| builder.endpoint(*url))
        .build()
        .unwrap()
}

fn request() -> v1::PlanMoveRequest {
    v1::PlanMoveRequest {
        robot_id: "arm".to_owned(),
        ..Default::default()
    }
}

fn delete() -> v1::DeleteRobotRequest {
    v1::DeleteRobotRequest {
        robot_id: "arm".to_owned(),
        ..Default::default()
    }
}

/// An address where nothing listens.
async fn nowhere() -> String {
    let listener = TcpListener::bind("127.0.0.1:0").await.unwrap();
    format!("http://{}", listener.local_addr().unwrap())
}

#[tokio::test]
async fn a_plan_is_tried_until_the_service_has_room() {
    for transport in BOTH {
        let fake = Fake::new("a", &[Act::Unavailable, Act::Overloaded, Act::Answer]);
        let reply = client(transport, &[&fake.serve().await])
            .plan_move(request())
            .await
            .unwrap();
        assert_eq!(reply.provenance.unwrap().version, "a");
        assert_eq!(fake.seen(), 3, "{transport:?}");
    }
}

#[tokio::test]
async fn violations_arrive_the_same_over_both_transports() {
    for transport in BOTH {
        let fake = Fake::new("a", &[Act::Invalid]);
        let error = client(transport, &[&fake.serve().await])
            .plan_move(request())
            .await
            .unwrap_err();
        assert_eq!((error.kind(), error.code()), (ErrorKind::Refused, Code::InvalidRequest));
        assert_eq!(error.message(), "wrong");
        assert_eq!(error.violations()[0].field, "target.position[1]");
        assert_eq!(error.violations()[0].description, "too far");
        assert!(!error.retryable());
        assert_eq!(fake.seen(), 1);
    }
}

#[tokio::test]
async fn a_conflict_carries_the_current_revision() {
    for transport in BOTH {
        let fake = Fake::new("a", &[Act::Conflict]);
        let error = client(transport, &[&fake.serve().await])
            .delete_robot(delete())
            .await
            .unwrap_err();
        assert_eq!(error.code(), Code::Conflict);
        assert_eq!(error.details()["current_revision"], "r2");
    }
}

#[tokio::test]
async fn a_deletion_that_may_have_been_sent_is_not_repeated() {
    for transport in BOTH {
        let (fake, other) = (Fake::new("a", &[Act::Unavailable]), Fake::new("b", &[Act::Unavailable]));
        let client = client(transport, &[&fake.serve().await, &other.serve().await]);
        let error = client.delete_robot(delete()).await.unwrap_err();
        assert_eq!(error.kind(), ErrorKind::Service);
        assert_eq!(fake.seen() + other.seen(), 1, "{transport:?}");
    }
}

#[tokio::test]
async fn registrations_are_repeated_only_without_an_expected_revision() {
    for transport in BOTH {
        for (expected_revision, tries) in [(None, 2), (Some(String::new()), 1)] {
            let fake = Fake::new("a", &[Act::Unavailable, Act::Answer]);
            let client = client(transport, &[&fake.serve().await]);
            let request = v1::RegisterRobotRequest {
                robot_id: "arm".to_owned(),
                expected_revision,
                ..Default::default()
            };
            let result = client.register_robot(request).await;
            assert_eq!(fake.seen(), tries);
            assert_eq!(result.is_ok(), tries == 2);
        }
    }
}

#[tokio::test]
async fn calls_start_at_each_endpoint_in_turn() {
    for transport in BOTH {
        let (a, b) = (Fake::new("a", &[Act::Answer]), Fake::new("b", &[Act::Answer]));
        let client = client(transport, &[&a.serve().await, &b.serve().await]);
        for _ in 0..6 {
            client.plan_move(request()).await.unwrap();
        }
        assert_eq!((a.seen(), b.seen()), (3, 3));
    }
}

#[tokio::test]
async fn a_dead_endpoint_is_passed_over_even_by_a_deletion() {
    for transport in BOTH {
        let fake = Fake::new("a", &[Act::Answer]);
        let client = client(transport, &[&nowhere().await, &fake.serve().await]);
        for _ in 0..4 {
            client.delete_robot(delete()).await.unwrap();
        }
        assert_eq!(fake.seen(), 4);
    }
}

#[tokio::test]
async fn an_unavailable_endpoint_is_passed_over() {
    for transport in BOTH {
        let (a, b) = (Fake::new("a", &[Act::Unavailable]), Fake::new("b", &[Act::Answer]));
        let client = client(transport, &[&a.serve().await, &b.serve().await]);
        for _ in 0..4 {
            client.plan_move(request()).await.unwrap();
        }
        assert_eq!((a.seen(), b.seen()), (1, 4), "asked once, then last for a while");
    }
}

#[tokio::test]
async fn nobody_there_is_said_with_the_endpoint() {
    for transport in BOTH {
        let url = nowhere().await;
        let error = client(transport, &[&url]).plan_move(request()).await.unwrap_err();
        assert_eq!((error.kind(), error.code()), (ErrorKind::Transport, Code::Unavailable));
        assert_eq!(error.endpoint(), url);
        assert_eq!(error.tries(), 5);
        assert!(error.to_string().contains("cannot connect"), "{error}");
    }
}

#[tokio::test]
async fn a_peer_that_never_answers_meets_the_deadline_and_was_told_it() {
    for transport in BOTH {
        let fake = Fake::new("a", &[Act::Hang]);
        let url = fake.serve().await;
        let client = client(transport, &[&url]).with_deadline(Duration::from_millis(300));
        let error = client.plan_move(request()).await.unwrap_err();
        assert_eq!(
            (error.kind(), error.code()),
            (ErrorKind::Deadline, Code::DeadlineExceeded)
        );
        assert_eq!(error.endpoint(), url);
        let told = fake.timeout.lock().unwrap().clone();
        let micros: f64 = match transport {
            Transport::Grpc => told.strip_suffix('u').unwrap().parse().unwrap(),
            Transport::Http => 1e6 * told.parse::<f64>().unwrap(),
        };
        assert!(micros > 0.0 && micros <= 300_000.0, "{told}");
    }
}

#[tokio::test]
async fn a_peer_that_accepts_and_stays_silent_meets_the_deadline() {
    for transport in BOTH {
        let listener = TcpListener::bind("127.0.0.1:0").await.unwrap();
        let url = format!("http://{}", listener.local_addr().unwrap());
        let client = client(transport, &[&url]).with_deadline(Duration::from_millis(100));
        let error = client.plan_move(request()).await.unwrap_err();
        assert_eq!(error.kind(), ErrorKind::Deadline, "{transport:?} {error}");
    }
}

#[tokio::test]
async fn a_peer_that_hangs_up_is_a_broken_connection() {
    for transport in BOTH {
        let listener = TcpListener::bind("127.0.0.1:0").await.unwrap();
        let url = format!("http://{}", listener.local_addr().unwrap());
        tokio::spawn(async move {
            while let Ok((stream, _)) = listener.accept().await {
                drop(stream)
            }
        });
        let error = client(transport, &[&url]).plan_move(request()).await.unwrap_err();
        assert_eq!(error.kind(), ErrorKind::Transport, "{transport:?} {error}");
        assert_eq!(error.tries(), 5);
    }
}

#[tokio::test]
async fn one_connection_serves_many_calls() {
    for transport in BOTH {
        let fake = Fake::new("a", &[Act::Answer]);
        let server = fake.serve().await;
        // Counts the connections on their way through.
        let listener = TcpListener::bind("127.0.0.1:0").await.unwrap();
        let url = format!("http://{}", listener.local_addr().unwrap());
        let accepted = Arc::new(AtomicUsize::new(0));
        let counter = Arc::clone(&accepted);
        tokio::spawn(async move {
            while let Ok((mut near, _)) = listener.accept().await {
                counter.fetch_add(1, Ordering::SeqCst);
                let mut far = tokio::net::TcpStream::connect(server.trim_start_matches("http://"))
                    .await
                    .unwrap();
                tokio::spawn(async move { tokio::io::copy_bidirectional(&mut near, &mut far).await });
            }
        });
        let client = client(transport, &[&url]);
        for _ in 0..5 {
            client.clone().plan_move(request()).await.unwrap();
        }
        assert_eq!(accepted.load(Ordering::SeqCst), 1, "{transport:?}");
    }
}

#[tokio::test]
async fn a_reply_over_the_limit_is_refused() {
    for transport in BOTH {
        let fake = Fake::new("a rather long version", &[Act::Answer]);
        let url = fake.serve().await;
        let client = Client::builder()
            .transport(transport)
            .endpoint(url)
            .max_reply_bytes(8)
            .build()
            .unwrap();
        let error = client.plan_move(request()).await.unwrap_err();
        assert_eq!(error.code(), Code::TooLarge, "{error}");
    }
}

#[tokio::test]
async fn what_is_no_robot_id_is_refused_before_anything_is_sent() {
    let fake = Fake::new("a", &[Act::Answer]);
    let client = client(Transport::Http, &[&fake.serve().await]);
    for id in ["", "a/b", "a?b", "..", "a:planMove"] {
        let error = client
            .plan_move(v1::PlanMoveRequest {
                robot_id: id.to_owned(),
                ..request()
            })
            .await
            .unwrap_err();
        assert_eq!(error.violations()[0].field, "robot_id");
    }
    assert_eq!(fake.seen(), 0);
}

#[tokio::test]
async fn readiness_is_asked_of_every_endpoint_once() {
    for transport in BOTH {
        let (ready, draining) = (Fake::new("a", &[Act::Answer]), Fake::new("b", &[Act::Unavailable]));
        let (first, second) = (ready.serve().await, draining.serve().await);
        client(transport, &[&first]).ready().await.unwrap();
        let error = client(transport, &[&first, &second]).ready().await.unwrap_err();
        assert_eq!((error.code(), error.endpoint()), (Code::Unavailable, second.as_str()));
        assert_eq!((ready.seen(), draining.seen()), (2, 1), "{transport:?}");
        let error = client(transport, &[&nowhere().await]).ready().await.unwrap_err();
        assert_eq!(error.kind(), ErrorKind::Transport);
    }
}
