//! Deadlines, sizes, overload, and the end of the service.

use takt_proto::v1::{self, dynamics_service_client::DynamicsServiceClient};
use takt_server::{Config, Limits};
use tokio::{
    io::{AsyncReadExt, AsyncWriteExt},
    net::TcpStream,
};
use tonic_health::pb::{HealthCheckRequest, health_client::HealthClient};

use crate::harness::Running;

const POSE: &str = r#"{"states": [{"position": [0, 0, 0, 0, 0, 0]}]}"#;

fn states(count: usize) -> v1::InverseDynamicsRequest {
    let state = v1::JointState {
        position: vec![0.1; 6],
        ..Default::default()
    };
    v1::InverseDynamicsRequest {
        robot_id: "ur5e".to_owned(),
        states: vec![state; count],
        ..Default::default()
    }
}

#[tokio::test]
async fn the_callers_deadline_over_http_is_kept() {
    let server = Running::start().await;
    let headers = [("content-type", "application/json"), ("request-timeout", "0")];
    let path = "/v1/robots/ur5e:forwardKinematics";
    let reply = server.http("POST", path, &headers, POSE.as_bytes()).await;
    assert_eq!(
        (reply.status, reply.json()["error"]["status"].as_str()),
        (504, Some("DEADLINE_EXCEEDED"))
    );
    let bad = [("content-type", "application/json"), ("request-timeout", "soon")];
    let reply = server.http("POST", path, &bad, POSE.as_bytes()).await;
    assert_eq!(reply.fields(), ["request-timeout"]);
}

#[tokio::test]
async fn the_configured_deadline_stops_a_calculation() {
    let limits = Limits {
        deadline_s: 0.002,
        ..Limits::default()
    };
    let server = Running::with(Config {
        limits,
        ..Config::default()
    })
    .await;
    // The generated client has a deadline of its own, with a status of its own; so the server's it is.
    let mut client = DynamicsServiceClient::new(server.channel().await);
    let status = client.inverse_dynamics(states(10_000)).await.unwrap_err();
    assert_eq!(status.code(), tonic::Code::DeadlineExceeded);
    let body = serde_json::to_string(&states(10_000)).unwrap();
    let reply = server.post("/v1/robots/ur5e:inverseDynamics", &body).await;
    assert_eq!(
        (reply.status, reply.json()["error"]["status"].as_str()),
        (504, Some("DEADLINE_EXCEEDED"))
    );
}

#[tokio::test]
async fn the_configured_deadline_ends_a_body_that_never_comes() {
    let limits = Limits {
        deadline_s: 0.05,
        ..Limits::default()
    };
    let server = Running::with(Config {
        limits,
        ..Config::default()
    })
    .await;
    let mut stream = TcpStream::connect(server.address).await.unwrap();
    let head = "POST /v1/robots/ur5e:planMove HTTP/1.1\r\nhost: takt\r\ncontent-length: 10\r\n\r\n{";
    stream.write_all(head.as_bytes()).await.unwrap();
    let mut reply = [0; 64];
    let count = stream.read(&mut reply).await.unwrap();
    assert!(
        reply[..count].starts_with(b"HTTP/1.1 504"),
        "{:?}",
        String::from_utf8_lossy(&reply)
    );
}

#[tokio::test]
async fn the_limit_on_bytes_holds_at_its_edge() {
    let limits = Limits {
        max_request_bytes: 1000,
        ..Limits::default()
    };
    let server = Running::with(Config {
        limits,
        ..Config::default()
    })
    .await;
    let padded = |bytes: usize| format!("{POSE}{}", " ".repeat(bytes - POSE.len()));
    let path = "/v1/robots/ur5e:forwardKinematics";
    assert_eq!(server.post(path, &padded(1000)).await.status, 200);
    let reply = server.post(path, &padded(1001)).await;
    assert_eq!(
        (reply.status, reply.json()["error"]["status"].as_str()),
        (413, Some("OUT_OF_RANGE"))
    );
    let mut client = DynamicsServiceClient::new(server.channel().await);
    assert!(client.inverse_dynamics(states(5)).await.is_ok());
    let status = client.inverse_dynamics(states(50)).await.unwrap_err();
    assert_eq!(status.code(), tonic::Code::OutOfRange);
}

#[tokio::test]
async fn the_limit_on_states_holds_at_its_edge() {
    let limits = Limits {
        max_states: 10,
        ..Limits::default()
    };
    let server = Running::with(Config {
        limits,
        ..Config::default()
    })
    .await;
    let mut client = DynamicsServiceClient::new(server.channel().await);
    assert_eq!(
        client
            .inverse_dynamics(states(10))
            .await
            .unwrap()
            .into_inner()
            .results
            .len(),
        10
    );
    let status = client.inverse_dynamics(states(11)).await.unwrap_err();
    assert!(status.message().contains("max_states"), "{status}");
}

#[tokio::test]
async fn too_many_requests_are_refused_at_once() {
    let limits = Limits {
        max_concurrent_requests: 1,
        ..Limits::default()
    };
    let server = Running::with(Config {
        limits,
        ..Config::default()
    })
    .await;
    // One request is in work as long as its body is not complete.
    let mut slow = TcpStream::connect(server.address).await.unwrap();
    let head = "POST /v1/robots/ur5e:forwardKinematics HTTP/1.1\r\nhost: takt\r\nexpect: 100-continue\r\ncontent-length: 51\r\n\r\n";
    slow.write_all(head.as_bytes()).await.unwrap();
    let mut go_on = [0; 25];
    slow.read_exact(&mut go_on).await.unwrap();
    let reply = server.get("/v1/robots").await;
    assert_eq!((reply.status, reply.headers["retry-after"].as_str()), (429, "1"));
    let details = &reply.json()["error"]["details"];
    assert_eq!(details[0]["retry_delay"], "0.100s");
    assert_eq!(details[1]["metadata"]["limit"], "limits.max_concurrent_requests");
    let mut client = DynamicsServiceClient::new(server.channel().await);
    let status = client.inverse_dynamics(states(1)).await.unwrap_err();
    assert_eq!(status.code(), tonic::Code::ResourceExhausted);
    assert_eq!(server.get("/healthz").await.status, 200);
    drop(slow);
}

#[tokio::test]
async fn the_bytes_of_all_requests_together_are_limited() {
    let limits = Limits {
        max_bytes_in_work: 200,
        ..Limits::default()
    };
    let server = Running::with(Config {
        limits,
        ..Config::default()
    })
    .await;
    let path = "/v1/robots/ur5e:forwardKinematics";
    assert_eq!(server.post(path, POSE).await.status, 200);
    let long = format!("{POSE}{}", " ".repeat(200));
    let reply = server.post(path, &long).await;
    assert_eq!(reply.status, 429, "{reply:?}");
    let mut client = DynamicsServiceClient::new(server.channel().await);
    let status = client.inverse_dynamics(states(20)).await.unwrap_err();
    assert_eq!(status.code(), tonic::Code::ResourceExhausted);
    assert_eq!(server.post(path, POSE).await.status, 200);
}

#[tokio::test]
async fn a_trajectory_that_swings_too_far_is_refused() {
    let server = Running::start().await;
    let body = r#"{"trajectory": {"points": [
        {"time_s": 0, "position": [0, 0, 0, 0, 0, 0], "velocity": [0, 0, 0, 0, 0, 0]},
        {"time_s": 0.5, "position": [0, 0, 0, 0, 0, 0], "velocity": [1e9, 0, 0, 0, 0, 0]}]}}"#;
    let reply = server.post("/v1/robots/ur5e:checkTrajectory", body).await;
    assert_eq!(reply.fields(), ["trajectory.points[1]"]);
}

#[tokio::test]
async fn a_burst_from_idle_is_served() {
    let server = Running::start().await;
    let channel = server.channel().await;
    let calls = (0..200).map(|_| {
        let mut client = DynamicsServiceClient::new(channel.clone());
        async move { client.inverse_dynamics(states(3)).await }
    });
    for answer in futures::future::join_all(calls).await {
        assert!(answer.is_ok(), "{answer:?}");
    }
}

#[tokio::test]
async fn a_request_in_work_finishes_while_the_service_stops() {
    let mut server = Running::start().await;
    let mut health = HealthClient::new(server.channel().await);
    let serving = health.check(HealthCheckRequest::default()).await.unwrap().into_inner();
    assert_eq!(serving.status, 1);
    let mut slow = TcpStream::connect(server.address).await.unwrap();
    let head = format!(
        "POST /v1/robots/ur5e:forwardKinematics HTTP/1.1\r\nhost: takt\r\nexpect: 100-continue\r\ncontent-length: {}\r\n\r\n",
        POSE.len()
    );
    slow.write_all(head.as_bytes()).await.unwrap();
    let mut go_on = [0; 25];
    slow.read_exact(&mut go_on).await.unwrap();
    server.stop();
    // The port closes first.
    while TcpStream::connect(server.address).await.is_ok() {
        tokio::task::yield_now().await;
    }
    slow.write_all(POSE.as_bytes()).await.unwrap();
    let mut reply = Vec::new();
    slow.read_to_end(&mut reply).await.unwrap();
    assert!(
        reply.starts_with(b"HTTP/1.1 200"),
        "{}",
        String::from_utf8_lossy(&reply)
    );
    drop(health);
    server.ended().await;
}

#[tokio::test]
async fn a_silent_connection_is_closed() {
    let mut config = Config::default();
    config.connections.detect_timeout_s = 0.05;
    let server = Running::with(config).await;
    for first in ["", "PRI * HT"] {
        let mut stream = TcpStream::connect(server.address).await.unwrap();
        stream.write_all(first.as_bytes()).await.unwrap();
        let mut rest = Vec::new();
        // Closed, or reset because of what was not read.
        let _ = stream.read_to_end(&mut rest).await;
        assert_eq!(rest, b"");
    }
}
