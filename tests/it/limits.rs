//! Deadlines, overload, callers who leave, and the end of the service: nothing here waits for a time to pass.

use prost::Message;
use serde::Serialize;
use takt_proto::{error::Error, v1};
use takt_server::{Config, Limits, PlannerConfig};
use takt_tests::{
    TestServer,
    fixtures::{good_check, good_dynamics, good_move, good_pose},
};
use tonic::Code;

const PLAN_MOVE: &str = "/takt.v1.PlanService/PlanMove";
const CHECK: &str = "/takt.v1.PlanService/CheckTrajectory";
const DYNAMICS: &str = "/takt.v1.DynamicsService/InverseDynamics";

/// Takes many times as long as any deadline here.
fn heavy() -> v1::CheckTrajectoryRequest {
    good_check(20_000)
}

fn json(message: &impl Serialize) -> String {
    serde_json::to_string(message).unwrap()
}

/// A server that computes one thing at a time and lets nothing wait.
async fn narrow() -> TestServer {
    TestServer::with(Config {
        examples: true,
        planner: PlannerConfig {
            threads: Some(1),
            queue_capacity: Some(1),
            ..PlannerConfig::default()
        },
        ..Config::default()
    })
    .await
}

#[tokio::test]
async fn a_deadline_that_has_passed_is_exceeded() {
    let server = TestServer::start().await;
    let grpc = server.grpc();
    let status = grpc
        .within("1n", PLAN_MOVE, good_move().encode_to_vec())
        .await
        .unwrap_err();
    assert_eq!(status.code(), Code::DeadlineExceeded, "{status}");
    let headers = [("content-type", "application/json"), ("request-timeout", "0")];
    let mut http = server.http().await;
    let path = "/v1/robots/ur5e:planMove";
    let reply = http
        .request("POST", path, &headers, json(&good_move()).as_bytes())
        .await;
    assert_eq!(
        (reply.status, &reply.json()["error"]["status"]),
        (504, &"DEADLINE_EXCEEDED".into())
    );
    assert_eq!(Error::from_status(&status), reply.error());
    // Both connections go on.
    assert!(grpc.unary(PLAN_MOVE, good_move().encode_to_vec()).await.is_ok());
    assert_eq!(http.post(path, &json(&good_move())).await.status, 200);
}

#[tokio::test]
async fn a_deadline_stops_what_is_being_computed() {
    let server = narrow().await;
    let grpc = server.grpc();
    let status = grpc.within("5m", CHECK, heavy().encode_to_vec()).await.unwrap_err();
    assert_eq!(status.code(), Code::DeadlineExceeded, "{status}");
    let headers = [("content-type", "application/json"), ("request-timeout", "0.005")];
    let mut http = server.http().await;
    let path = "/v1/robots/ur5e:checkTrajectory";
    let reply = http.request("POST", path, &headers, json(&heavy()).as_bytes()).await;
    assert_eq!(reply.status, 504, "{}", reply.text());
}

#[tokio::test]
async fn the_services_deadline_counts_where_the_caller_states_a_longer_one() {
    let server = TestServer::with(Config {
        examples: true,
        limits: Limits {
            deadline_s: 0.005,
            ..Limits::default()
        },
        ..Config::default()
    })
    .await;
    let status = server
        .grpc()
        .within("1H", CHECK, heavy().encode_to_vec())
        .await
        .unwrap_err();
    assert_eq!(status.code(), Code::DeadlineExceeded, "{status}");
}

/// While one calculation runs there is no room for another, and that is said at once with a time to wait.
#[tokio::test]
async fn overload_is_refused_with_a_time_to_wait() {
    let server = narrow().await;
    let (grpc, busy) = (server.grpc(), server.grpc());
    let mut http = server.http().await;
    let occupied = async {
        loop {
            // Refused itself where one of the others was there first.
            let _ = busy.unary(CHECK, heavy().encode_to_vec()).await;
        }
    };
    let refused = async {
        let status = loop {
            if let Err(status) = grpc.unary(PLAN_MOVE, good_move().encode_to_vec()).await {
                break status;
            }
        };
        let reply = loop {
            let reply = http.post("/v1/robots/ur5e:planMove", &json(&good_move())).await;
            if reply.status != 200 {
                break reply;
            }
        };
        (status, reply)
    };
    let (status, reply) = tokio::select! {
        both = refused => both,
        () = occupied => unreachable!("it goes on for ever"),
    };
    assert_eq!(status.code(), Code::ResourceExhausted, "{status}");
    let error = Error::from_status(&status);
    assert!(error.retry_after.is_some_and(|delay| !delay.is_zero()), "{error:?}");
    assert_eq!(reply.status, 429, "{}", reply.text());
    assert_eq!(reply.error(), error);
    assert!(reply.header("retry-after").is_some_and(|seconds| seconds != "0"));
}

/// Calls that were given up leave their places: were they computed to the end, this test would take minutes.
#[tokio::test]
async fn callers_who_leave_make_room() {
    let server = narrow().await;
    let grpc = server.grpc();
    grpc.unary(PLAN_MOVE, good_move().encode_to_vec()).await.unwrap();
    for _ in 0..50 {
        let abandoned = grpc.unary(CHECK, heavy().encode_to_vec());
        // Another call is answered, if only by a refusal: the first has been sent by then.
        let other = grpc.unary("/takt.v1.RobotService/ListRobots", Vec::new());
        tokio::select! {
            biased;
            answer = abandoned => panic!("faster than a list: {:?}", answer.map(|bytes| bytes.len())),
            answer = other => assert!(answer.is_ok()),
        }
    }
    while let Err(status) = grpc.unary(PLAN_MOVE, good_move().encode_to_vec()).await {
        assert_eq!(status.code(), Code::ResourceExhausted, "{status}");
    }
}

#[tokio::test]
async fn two_hundred_requests_at_once_from_idle_are_all_answered() {
    let server = TestServer::start().await;
    let grpc = server.grpc();
    let over_grpc = (0..100).map(|_| grpc.unary(PLAN_MOVE, good_move().encode_to_vec()));
    let over_http = (0..100).map(|_| async {
        let mut http = server.http().await;
        http.post("/v1/robots/ur5e:planMove", &json(&good_move())).await
    });
    let both = futures::future::join(
        futures::future::join_all(over_grpc),
        futures::future::join_all(over_http),
    );
    let (over_grpc, over_http) = both.await;
    let first = over_grpc[0].as_ref().unwrap();
    for answer in &over_grpc {
        assert_eq!(answer.as_ref().unwrap(), first);
    }
    for reply in &over_http {
        assert_eq!(
            (reply.status, &reply.body),
            (200, &over_http[0].body),
            "{}",
            reply.text()
        );
    }
}

#[tokio::test]
async fn two_hundred_connections_of_grpc_at_once_are_all_answered() {
    let server = TestServer::start().await;
    let calls = (0..200).map(|_| async {
        let grpc = server.grpc();
        grpc.unary(DYNAMICS, good_dynamics(3).encode_to_vec()).await
    });
    for answer in futures::future::join_all(calls).await {
        assert!(answer.is_ok(), "{answer:?}");
    }
}

/// A request in work when the service is asked to stop is finished; idle connections are closed, and the port with them.
#[tokio::test]
async fn a_request_in_work_is_finished_before_the_end() {
    let mut server = TestServer::start().await;
    let body = json(&good_pose());
    let mut slow = server.http().await;
    let head = format!(
        "POST /v1/robots/ur5e:forwardKinematics HTTP/1.1\r\nhost: takt\r\nexpect: 100-continue\r\ncontent-length: {}\r\n\r\n",
        body.len()
    );
    slow.send(head.as_bytes()).await;
    assert_eq!(slow.receive("POST").await.status, 100);
    let mut idle = server.http().await;
    assert_eq!(idle.get("/readyz").await.status, 200);
    server.stop();
    assert_eq!(idle.rest().await, b"", "an idle connection is closed without a word");
    assert!(
        tokio::net::TcpStream::connect(server.address()).await.is_err(),
        "the port is closed"
    );
    slow.send(body.as_bytes()).await;
    let reply = slow.receive("POST").await;
    assert_eq!(reply.status, 200, "{}", reply.text());
    server.ended().await;
}

/// The same over gRPC: the call was sent before the end, its answer comes after.
#[tokio::test]
async fn a_call_in_work_is_finished_before_the_end() {
    let mut server = narrow().await;
    let grpc = server.grpc();
    grpc.unary(PLAN_MOVE, good_move().encode_to_vec()).await.unwrap();
    let call = tokio::spawn({
        let grpc = grpc.clone();
        async move { grpc.unary(CHECK, heavy().encode_to_vec()).await }
    });
    // Refused: the call is being computed.
    while grpc.unary(PLAN_MOVE, good_move().encode_to_vec()).await.is_ok() {}
    server.stop();
    let answer = call.await.unwrap().unwrap();
    assert!(v1::CheckTrajectoryResponse::decode(answer).unwrap().holds);
    drop(grpc);
    server.ended().await;
}
