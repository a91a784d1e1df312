//! What comes in malformed, and what goes out.

use takt_proto::{
    error::{Error, ErrorCode},
    v1::{self, plan_service_client::PlanServiceClient},
};

use crate::harness::Running;

const MOVE: &str =
    r#"{"start": {"position": [0, -1.57, 1.57, -1.57, -1.57, 0]}, "target": {"position": [1, -1, 1, -1, -1, 0.5]}}"#;

fn move_of(json: &str) -> v1::PlanMoveRequest {
    let request: v1::PlanMoveRequest = serde_json::from_str(json).unwrap();
    v1::PlanMoveRequest {
        robot_id: "ur5e".to_owned(),
        ..request
    }
}

#[tokio::test]
async fn a_plan_is_the_same_over_both_protocols() {
    let server = Running::start().await;
    let reply = server.post("/v1/robots/ur5e:planMove", MOVE).await;
    assert_eq!(reply.status, 200, "{reply:?}");
    assert!(reply.headers["server-timing"].contains("compute;dur="));
    let over_http: v1::PlanMoveResponse = serde_json::from_slice(&reply.body).unwrap();
    let mut client = PlanServiceClient::new(server.channel().await);
    let over_grpc = client.plan_move(move_of(MOVE)).await.unwrap();
    assert!(over_grpc.metadata().contains_key("server-timing"));
    assert_eq!(over_grpc.into_inner(), over_http);
    assert_eq!(reply.json()["plan"]["raw_excess"], 0.0);
}

#[tokio::test]
async fn every_violation_is_named_on_both_protocols() {
    let server = Running::start().await;
    let body = r#"{"start": {"position": [0, -1.57, "NaN", -1.57, -1.57, 0]}, "target": {"position": [1]}, "method": 0,
        "torque_utilization": 2, "payload": {"mass_kg": -1}, "limits": [{"joint": "nope", "velocity": "Infinity"}]}"#;
    let reply = server.post("/v1/robots/ur5e:planMove", body).await;
    assert_eq!(reply.status, 400);
    let fields = reply.fields();
    for field in [
        "start.position[2]",
        "target.position",
        "method",
        "torque_utilization",
        "payload.mass_kg",
        "limits[0].joint",
        "limits[0].velocity",
    ] {
        assert!(fields.iter().any(|found| found == field), "{field} in {fields:?}");
    }
    let mut client = PlanServiceClient::new(server.channel().await);
    let status = client.plan_move(move_of(body)).await.unwrap_err();
    assert_eq!(Some(Error::from_status(&status)), Error::from_json(&reply.body));
}

#[tokio::test]
async fn bodies_that_are_no_requests_are_refused() {
    let server = Running::start().await;
    let nested = "[".repeat(100_000);
    for body in [
        "",
        "{",
        "nonsense",
        "[]",
        "{} {}",
        r#"{"start": {}, "start": {}}"#,
        r#"{"unknown": 1}"#,
        &nested,
    ] {
        let reply = server.post("/v1/robots/ur5e:planMove", body).await;
        assert_eq!(reply.status, 400, "{body:.40}: {reply:?}");
        assert_eq!(reply.json()["error"]["status"], "INVALID_ARGUMENT");
    }
    let json = [("content-type", "application/json")];
    let reply = server
        .http("POST", "/v1/robots/ur5e:planMove", &json, b"{\"revision\": \"\xff\"}")
        .await;
    assert_eq!(reply.status, 400);
    let text = [("content-type", "text/plain")];
    let reply = server
        .http("POST", "/v1/robots/ur5e:planMove", &text, MOVE.as_bytes())
        .await;
    assert_eq!((reply.status, reply.fields()), (400, vec!["content-type".to_owned()]));
    let other = server.post("/v1/robots/ur5e:planMove", r#"{"robot_id": "fr3"}"#).await;
    assert_eq!(other.fields(), ["robot_id"]);
}

#[tokio::test]
async fn paths_and_methods_are_told_apart() {
    let server = Running::start().await;
    for (method, path, status) in [
        ("GET", "/nope", 404),
        ("GET", "/v1/robots/ur5e:planMove", 405),
        ("PATCH", "/v1/robots/ur5e", 405),
        ("GET", "/v1/robots/nope", 404),
        ("GET", "/v1/robots/UPPER", 400),
        ("GET", "/v1/robots?page_size=0", 400),
        ("GET", "/v1/robots?other=1", 400),
        ("GET", "/v1/robots/ur5e?revision=nope", 404),
        ("POST", "/healthz", 404),
    ] {
        let reply = server.http(method, path, &[], b"").await;
        assert_eq!(reply.status, status, "{method} {path}: {reply:?}");
        assert!(Error::from_json(&reply.body).is_some(), "{method} {path}");
    }
    for path in ["/", "/docs", "/healthz", "/readyz", "/openapi.json"] {
        assert_eq!(server.get(path).await.status, 200, "{path}");
    }
}

#[tokio::test]
async fn an_unknown_rpc_is_unimplemented() {
    let server = Running::start().await;
    let mut grpc = tonic::client::Grpc::new(server.channel().await);
    for path in ["/takt.v1.PlanService/Nope", "/takt.v1.Nope/Nope", "/nope"] {
        grpc.ready().await.unwrap();
        let codec = takt_proto::codec::Codec::<v1::PlanMoveRequest, v1::PlanMoveResponse>::default();
        let request = tonic::Request::new(v1::PlanMoveRequest::default());
        let status = grpc.unary(request, path.parse().unwrap(), codec).await.unwrap_err();
        assert_eq!(status.code(), tonic::Code::Unimplemented, "{path}");
    }
}

#[tokio::test]
async fn request_ids_come_back() {
    let server = Running::start().await;
    let reply = server
        .http("GET", "/v1/robots", &[("x-request-id", "cell-7")], b"")
        .await;
    assert_eq!(reply.headers["x-request-id"], "cell-7");
    assert!(!server.get("/v1/robots").await.headers["x-request-id"].is_empty());
}

#[tokio::test]
async fn dynamics_of_many_states_come_back_in_order() {
    let server = Running::start().await;
    let states = r#"{"states": [{"position": [0, 0, 0, 0, 0, 0]}, {"position": [0, 1, 0, 0, 0, 0]}], "return": ["MASS_MATRIX", "JACOBIAN"]}"#;
    let json = server.post("/v1/robots/ur5e:inverseDynamics", states).await.json();
    let result = &json["results"][1];
    assert_eq!(result["mass_matrix"].as_array().unwrap().len(), 36);
    assert_eq!(result["jacobian"].as_array().unwrap().len(), 36);
    assert_eq!(result["torque"], result["gravity_torque"]);
    let poses = r#"{"states": [{"position": [0, 0, 0, 0, 0, 0]}]}"#;
    let json = server.post("/v1/robots/ur5e:forwardKinematics", poses).await.json();
    assert_eq!(json["results"][0]["pose"]["position_m"].as_array().unwrap().len(), 3);
    let huge = r#"{"states": [{"position": [0, 0, 0, 0, 0, 0], "velocity": [1e300, 1e300, 0, 0, 0, 0]}]}"#;
    let reply = server.post("/v1/robots/ur5e:inverseDynamics", huge).await;
    assert_eq!(reply.fields(), ["states[0].velocity[0]", "states[0].velocity[1]"]);
}

#[tokio::test]
async fn an_error_keeps_its_code_over_both_protocols() {
    let server = Running::start().await;
    let mut client = PlanServiceClient::new(server.channel().await);
    let request = v1::PlanMoveRequest {
        robot_id: "nope".to_owned(),
        ..move_of(MOVE)
    };
    let status = client.plan_move(request).await.unwrap_err();
    let reply = server.post("/v1/robots/nope:planMove", MOVE).await;
    let error = Error::from_json(&reply.body).unwrap();
    assert_eq!(error.code, ErrorCode::NotFound);
    assert_eq!(Error::from_status(&status), error);
}
