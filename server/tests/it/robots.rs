//! Registering, reading, listing and deleting.

use serde_json::Value;
use takt_proto::v1::{self, robot_service_client::RobotServiceClient};
use takt_server::{Config, StoreConfig};

use crate::harness::{Running, registration, two_joints};

async fn register(server: &Running, mass: f64) -> String {
    let reply = server.put("/v1/robots/arm", &registration(mass)).await;
    assert_eq!(reply.status, 200, "{reply:?}");
    reply.json()["robot"]["revision"].as_str().unwrap().to_owned()
}

#[tokio::test]
async fn a_robot_comes_back_as_it_was_registered() {
    let server = Running::start().await;
    let revision = register(&server, 5.0).await;
    let reply = server.get("/v1/robots/arm").await;
    assert_eq!(reply.headers["etag"], format!("\"{revision}\""));
    let description = &reply.json()["description"];
    assert_eq!(
        description["dh"]["links"][0]["mass_kg"],
        two_joints(5.0)["dh"]["links"][0]["mass_kg"]
    );
    let mut client = RobotServiceClient::new(server.channel().await);
    let request = v1::GetRobotRequest {
        robot_id: "arm".into(),
        as_urdf: Some(true),
        ..Default::default()
    };
    let got = client.get_robot(request).await.unwrap().into_inner();
    assert_eq!(serde_json::to_value(got.description).unwrap(), *description);
    assert!(got.urdf.is_some_and(|urdf| urdf.contains("<robot")));
}

#[tokio::test]
async fn both_protocols_give_the_same_revision() {
    let server = Running::start().await;
    let revision = register(&server, 5.0).await;
    let mut client = RobotServiceClient::new(server.channel().await);
    let description: v1::RobotDescription = serde_json::from_value(two_joints(5.0)).unwrap();
    let request = v1::RegisterRobotRequest {
        robot_id: "arm".into(),
        description: Some(description),
        ..Default::default()
    };
    let again = client.register_robot(request).await.unwrap().into_inner();
    assert_eq!(again.robot.unwrap().revision, revision);
    let revisions = server.get("/v1/robots/arm:revisions").await.json();
    assert_eq!(revisions["revisions"].as_array().unwrap().len(), 1);
}

#[tokio::test]
async fn revisions_follow_each_other_and_can_be_asked_for() {
    let server = Running::start().await;
    let first = register(&server, 5.0).await;
    let second = register(&server, 6.0).await;
    assert_eq!(register(&server, 5.0).await, first);
    let listed = server.get("/v1/robots/arm:revisions").await.json();
    assert_eq!(listed["revisions"], serde_json::json!([first, second]));
    let old = server.get(&format!("/v1/robots/arm?revision={second}")).await.json();
    assert_eq!(old["description"]["dh"]["links"][0]["mass_kg"], 6.0);
    for _ in 0..2 {
        let body = format!(
            r#"{{"start": {{"position": [0, 0]}}, "target": {{"position": [0.1, 0.1]}}, "revision": "{second}"}}"#
        );
        let plan = server.post("/v1/robots/arm:planMove", &body).await.json();
        assert_eq!(plan["provenance"]["revision"], second.as_str());
    }
    let page = server.get("/v1/robots/arm:revisions?page_size=1").await.json();
    let token = page["next_page_token"].as_str().unwrap();
    let rest = server
        .get(&format!("/v1/robots/arm:revisions?page_token={token}"))
        .await
        .json();
    assert_eq!(rest["revisions"], serde_json::json!([second]));
}

#[tokio::test]
async fn an_expected_revision_is_checked() {
    let server = Running::start().await;
    let with = |expected: &str, mass: f64| {
        let mut body: Value = serde_json::from_str(&registration(mass)).unwrap();
        body["expected_revision"] = expected.into();
        body.to_string()
    };
    let created = server.put("/v1/robots/arm", &with("", 5.0)).await;
    let revision = created.json()["robot"]["revision"].as_str().unwrap().to_owned();
    let conflict = server.put("/v1/robots/arm", &with("", 6.0)).await;
    assert_eq!(conflict.status, 409);
    let error = conflict.json()["error"].clone();
    assert_eq!(error["status"], "ABORTED");
    assert_eq!(error["details"][0]["metadata"]["current_revision"], revision.as_str());
    let headers = [
        ("if-match", &*format!("\"{revision}\"")),
        ("content-type", "application/json"),
    ];
    let matched = server
        .http("PUT", "/v1/robots/arm", &headers, registration(6.0).as_bytes())
        .await;
    assert_eq!(matched.status, 200);
    let stale = server.http("DELETE", "/v1/robots/arm", &headers, b"").await;
    assert_eq!(stale.status, 409);
}

#[tokio::test]
async fn validating_stores_nothing() {
    let server = Running::start().await;
    let mut body: Value = serde_json::from_str(&registration(5.0)).unwrap();
    body["validate_only"] = true.into();
    assert_eq!(server.put("/v1/robots/arm", &body.to_string()).await.status, 200);
    assert_eq!(server.get("/v1/robots/arm").await.status, 404);
}

#[tokio::test]
async fn a_revision_that_the_caller_has_is_not_sent_again() {
    let server = Running::start().await;
    let revision = register(&server, 5.0).await;
    let tag = format!("\"other\", \"{revision}\"");
    let reply = server
        .http("GET", "/v1/robots/arm", &[("if-none-match", &tag)], b"")
        .await;
    assert_eq!((reply.status, reply.body.len()), (304, 0));
}

#[tokio::test]
async fn robots_are_listed_and_deleted() {
    let server = Running::start().await;
    register(&server, 5.0).await;
    let ids = |json: &Value| -> Vec<String> {
        let robots = json["robots"].as_array().unwrap().iter();
        robots
            .map(|robot| robot["robot_id"].as_str().unwrap().to_owned())
            .collect()
    };
    let page = server.get("/v1/robots?page_size=2").await.json();
    assert_eq!(ids(&page), ["arm", "fr3"]);
    let token = page["next_page_token"].as_str().unwrap();
    let rest = server.get(&format!("/v1/robots?pageToken={token}")).await.json();
    assert_eq!(ids(&rest), ["puma560", "scara", "ur5e"]);
    assert_eq!(server.http("DELETE", "/v1/robots/arm", &[], b"").await.status, 200);
    assert_eq!(server.http("DELETE", "/v1/robots/arm", &[], b"").await.status, 404);
    let plan = server
        .post(
            "/v1/robots/arm:planMove",
            r#"{"start": {"position": [0, 0]}, "target": {"position": [1, 1]}}"#,
        )
        .await;
    assert_eq!(plan.status, 404);
}

#[tokio::test]
async fn robots_in_a_file_are_there_after_a_restart() {
    let directory = tempfile::TempDir::new().unwrap();
    let config = || Config {
        store: StoreConfig::Sqlite(directory.path().join("takt.db")),
        ..Config::default()
    };
    let server = Running::with(config()).await;
    let revision = register(&server, 5.0).await;
    server.ended().await;
    let server = Running::with(config()).await;
    let json = server.get("/v1/robots/arm").await.json();
    assert_eq!(json["robot"]["revision"], revision.as_str());
    let plan = server
        .post(
            "/v1/robots/arm:planMove",
            r#"{"start": {"position": [0, 0]}, "target": {"position": [0.1, 0.1]}}"#,
        )
        .await;
    assert_eq!(plan.json()["provenance"]["revision"], revision.as_str());
}
