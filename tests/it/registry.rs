//! Registering, revisions, conflicts, paging and deleting, over both protocols.

use std::collections::BTreeSet;

use takt_client::{Client, Code, v1};
use takt_server::{Config, StoreConfig};
use takt_tests::{
    Protocol, TestServer,
    fixtures::{plan_move, registration, two_joints},
};

/// A server of each kind of store, and a client of each protocol.
async fn each(mut test: impl AsyncFnMut(&TestServer, Client)) {
    let directory = tempfile::TempDir::new().unwrap();
    for protocol in Protocol::BOTH {
        let file = directory.path().join(format!("{protocol:?}.db"));
        for store in [StoreConfig::Memory, StoreConfig::Sqlite(file)] {
            let server = TestServer::with(Config {
                store,
                ..Config::default()
            })
            .await;
            test(&server, server.client(protocol)).await;
            server.ended().await;
        }
    }
}

/// Registers the arm with a mass and returns its revision.
async fn register(client: &Client, robot_id: &str, mass_kg: f64) -> String {
    let reply = client.register_robot(registration(robot_id, mass_kg)).await.unwrap();
    let robot = reply.robot.unwrap();
    assert_eq!(robot.robot_id, robot_id);
    assert_eq!(robot.joints.len(), 2);
    robot.revision
}

async fn get(client: &Client, revision: Option<&str>) -> Result<v1::GetRobotResponse, takt_client::Error> {
    let request = v1::GetRobotRequest {
        robot_id: "arm".to_owned(),
        revision: revision.map(str::to_owned),
        as_urdf: None,
    };
    client.get_robot(request).await
}

async fn revisions(client: &Client) -> Vec<String> {
    let request = v1::ListRevisionsRequest {
        robot_id: "arm".to_owned(),
        ..Default::default()
    };
    client.list_revisions(request).await.unwrap().revisions
}

#[tokio::test]
async fn old_revisions_stay_readable_and_plannable() {
    each(async |_, client| {
        let mut known = Vec::new();
        let mut answers = Vec::new();
        for mass in [5.0, 6.0, 7.0] {
            let revision = register(&client, "arm", mass).await;
            let reply = client.plan_move(plan_move("arm", &[0.0; 2], &[1.0; 2])).await.unwrap();
            assert_eq!(reply.provenance.as_ref().unwrap().revision, revision);
            answers.push(reply);
            known.push(revision);
        }
        for ((revision, mass), answer) in known.iter().zip([5.0, 6.0, 7.0]).zip(answers) {
            let got = get(&client, Some(revision)).await.unwrap();
            assert_eq!(got.description, Some(two_joints(mass)));
            let request = v1::PlanMoveRequest {
                revision: Some(revision.clone()),
                ..plan_move("arm", &[0.0; 2], &[1.0; 2])
            };
            assert_eq!(client.plan_move(request).await.unwrap(), answer);
        }
        known.reverse();
        assert_eq!(revisions(&client).await, known);
        // The first becomes the current one again, and is no second one.
        assert_eq!(register(&client, "arm", 5.0).await, known[2]);
        let order = [&known[2], &known[0], &known[1]].map(Clone::clone);
        assert_eq!(revisions(&client).await, order);
        assert_eq!(get(&client, None).await.unwrap().robot.unwrap().revision, known[2]);
    })
    .await;
}

#[tokio::test]
async fn the_same_content_is_the_same_revision_everywhere() {
    let mut found = BTreeSet::new();
    each(async |server, client| {
        found.insert(register(&client, "arm", 5.0).await);
        found.insert(register(&client, "other", 5.0).await);
        for protocol in Protocol::BOTH {
            found.insert(register(&server.client(protocol), "arm", 5.0).await);
        }
        assert_eq!(revisions(&client).await.len(), 1);
    })
    .await;
    assert_eq!(found.len(), 1, "{found:?}");
}

#[tokio::test]
async fn a_conflict_carries_the_current_revision_and_changes_nothing() {
    each(async |_, client| {
        let expecting = |expected: &str, mass_kg: f64| v1::RegisterRobotRequest {
            expected_revision: Some(expected.to_owned()),
            ..registration("arm", mass_kg)
        };
        let current = |error: takt_client::Error| {
            assert_eq!(error.code(), Code::Conflict, "{error}");
            assert_eq!(error.reason(), "REVISION_MISMATCH");
            error.details()["current_revision"].clone()
        };
        let absent = client.register_robot(expecting("r1", 5.0)).await.unwrap_err();
        assert_eq!(current(absent), "");
        let made = client.register_robot(expecting("", 5.0)).await.unwrap();
        let first = made.robot.unwrap().revision;
        let again = client.register_robot(expecting("", 6.0)).await.unwrap_err();
        assert_eq!(current(again), first);
        let second = client.register_robot(expecting(&first, 6.0)).await.unwrap();
        let second = second.robot.unwrap().revision;
        let late = client.register_robot(expecting(&first, 7.0)).await.unwrap_err();
        assert_eq!(current(late), second);
        let delete = |expected: &str| v1::DeleteRobotRequest {
            robot_id: "arm".to_owned(),
            expected_revision: Some(expected.to_owned()),
        };
        let kept = client.delete_robot(delete(&first)).await.unwrap_err();
        assert_eq!(current(kept), second);
        assert_eq!(revisions(&client).await, [second.as_str(), first.as_str()]);
        client.delete_robot(delete(&second)).await.unwrap();
        assert_eq!(get(&client, None).await.unwrap_err().code(), Code::NotFound);
    })
    .await;
}

/// Of many who expect the same revision, one wins.
#[tokio::test]
async fn one_of_many_registrations_at_once_wins() {
    each(async |_, client| {
        let first = register(&client, "arm", 5.0).await;
        let calls = (0..20).map(|index| {
            let request = v1::RegisterRobotRequest {
                expected_revision: Some(first.clone()),
                ..registration("arm", 6.0 + f64::from(index))
            };
            client.register_robot(request)
        });
        let answers = futures::future::join_all(calls).await;
        let (won, lost): (Vec<_>, Vec<_>) = answers.into_iter().partition(Result::is_ok);
        assert_eq!(won.len(), 1);
        let winner = won.into_iter().flatten().next().unwrap().robot.unwrap().revision;
        for error in lost.into_iter().filter_map(Result::err) {
            assert_eq!(error.code(), Code::Conflict, "{error}");
        }
        assert_eq!(revisions(&client).await, [winner.as_str(), first.as_str()]);
    })
    .await;
}

#[tokio::test]
async fn validating_says_what_registering_would_and_stores_nothing() {
    each(async |_, client| {
        let request = v1::RegisterRobotRequest {
            validate_only: Some(true),
            ..registration("arm", 5.0)
        };
        let validated = client.register_robot(request.clone()).await.unwrap().robot.unwrap();
        assert_eq!(get(&client, None).await.unwrap_err().code(), Code::NotFound);
        assert_eq!(register(&client, "arm", 5.0).await, validated.revision);
        let other = v1::RegisterRobotRequest {
            description: Some(two_joints(6.0)),
            ..request
        };
        client.register_robot(other).await.unwrap();
        assert_eq!(revisions(&client).await, [validated.revision]);
    })
    .await;
}

#[tokio::test]
async fn a_deleted_robot_is_gone_and_can_come_again() {
    each(async |_, client| {
        let revision = register(&client, "arm", 5.0).await;
        register(&client, "arm", 6.0).await;
        let delete = || v1::DeleteRobotRequest {
            robot_id: "arm".to_owned(),
            ..Default::default()
        };
        client.delete_robot(delete()).await.unwrap();
        for error in [
            client.delete_robot(delete()).await.unwrap_err(),
            get(&client, None).await.unwrap_err(),
            get(&client, Some(&revision)).await.unwrap_err(),
            client
                .plan_move(plan_move("arm", &[0.0; 2], &[1.0; 2]))
                .await
                .unwrap_err(),
        ] {
            assert_eq!(error.code(), Code::NotFound, "{error}");
        }
        assert_eq!(register(&client, "arm", 5.0).await, revision);
        assert_eq!(revisions(&client).await, [revision]);
    })
    .await;
}

#[tokio::test]
async fn many_robots_come_page_by_page_in_order_and_once_each() {
    const COUNT: usize = 123;
    each(async |_, client| {
        let mut expected: Vec<String> = (0..COUNT).map(|index| format!("arm-{index}")).collect();
        for id in &expected {
            register(&client, id, 5.0).await;
        }
        expected.sort();
        for page_size in [None, Some(1), Some(7), Some(123), Some(1000)] {
            let mut listed = Vec::new();
            let mut page_token = None;
            loop {
                let page = client.list_robots(v1::ListRobotsRequest { page_size, page_token });
                let page = page.await.unwrap();
                assert!(page.robots.len() <= page_size.unwrap_or(100) as usize);
                listed.extend(page.robots.into_iter().map(|robot| robot.robot_id));
                if page.next_page_token.is_empty() {
                    break;
                }
                page_token = Some(page.next_page_token);
            }
            assert_eq!(listed, expected, "{page_size:?}");
        }
    })
    .await;
}

#[tokio::test]
async fn many_revisions_come_page_by_page_newest_first() {
    each(async |_, client| {
        let mut expected = Vec::new();
        for index in 0..25 {
            expected.push(register(&client, "arm", 5.0 + f64::from(index)).await);
        }
        expected.reverse();
        let mut listed = Vec::new();
        let mut page_token = None;
        loop {
            let request = v1::ListRevisionsRequest {
                robot_id: "arm".to_owned(),
                page_size: Some(4),
                page_token,
            };
            let page = client.list_revisions(request).await.unwrap();
            listed.extend(page.revisions);
            if page.next_page_token.is_empty() {
                break;
            }
            page_token = Some(page.next_page_token);
        }
        assert_eq!(listed, expected);
    })
    .await;
}

/// A model that came as a table goes out as a URDF, and that URDF is the same arm.
#[tokio::test]
async fn the_urdf_of_a_model_is_the_same_arm() {
    let server = TestServer::start().await;
    for protocol in Protocol::BOTH {
        let client = server.client(protocol);
        let request = v1::GetRobotRequest {
            robot_id: "scara".to_owned(),
            as_urdf: Some(true),
            ..Default::default()
        };
        let got = client.get_robot(request).await.unwrap();
        let description = v1::RobotDescription {
            urdf: got.urdf.unwrap(),
            joints: got.description.unwrap().joints,
            ..Default::default()
        };
        let registration = v1::RegisterRobotRequest {
            robot_id: "from-urdf".to_owned(),
            description: Some(description),
            ..Default::default()
        };
        client.register_robot(registration).await.unwrap();
        let mut poses = Vec::new();
        for id in ["scara", "from-urdf"] {
            let request = v1::ForwardKinematicsRequest {
                robot_id: id.to_owned(),
                states: vec![v1::JointPosition {
                    position: vec![0.4, -0.7, 0.1, 1.5],
                }],
                ..Default::default()
            };
            let reply = client.forward_kinematics(request).await.unwrap();
            poses.push(reply.results[0].pose.clone().unwrap());
        }
        takt_tests::compare::assert_close("position", &poses[1].position_m, &poses[0].position_m, 1e-12);
        takt_tests::compare::assert_close("orientation", &poses[1].orientation, &poses[0].orientation, 1e-12);
    }
}

#[tokio::test]
async fn entity_tags_are_revisions() {
    let server = TestServer::start().await;
    let mut http = server.http().await;
    let json = serde_json::to_string(&registration("arm", 5.0)).unwrap();
    let put = http.put("/v1/robots/arm", &json).await;
    let tag = put.header("etag").unwrap().to_owned();
    let got = http.get("/v1/robots/arm").await;
    assert_eq!((got.status, got.header("etag")), (200, Some(tag.as_str())));
    for (tags, status) in [
        (tag.clone(), 304),
        (format!("\"other\", {tag}"), 304),
        (format!("W/{tag}"), 304),
        ("*".to_owned(), 304),
        ("\"other\"".to_owned(), 200),
    ] {
        let reply = http
            .request("GET", "/v1/robots/arm", &[("if-none-match", &tags)], b"")
            .await;
        assert_eq!(reply.status, status, "{tags}");
        assert_eq!(reply.header("etag"), Some(tag.as_str()));
        assert_eq!(reply.body.is_empty(), status == 304);
    }
    let changed = serde_json::to_string(&registration("arm", 6.0)).unwrap();
    let kind = ("content-type", "application/json");
    let headers = [kind, ("if-match", tag.as_str())];
    let put = http
        .request("PUT", "/v1/robots/arm", &headers, changed.as_bytes())
        .await;
    assert_eq!(put.status, 200, "{}", put.text());
    let stale = http.request("PUT", "/v1/robots/arm", &headers, json.as_bytes()).await;
    assert_eq!(stale.status, 409);
    assert_eq!(
        format!("{:?}", stale.error().current_revision().unwrap()),
        put.header("etag").unwrap()
    );
    let headers = [kind, ("if-none-match", "*")];
    let taken = http.request("PUT", "/v1/robots/arm", &headers, json.as_bytes()).await;
    assert_eq!(taken.status, 409);
    let fresh = http
        .request(
            "PUT",
            "/v1/robots/new",
            &headers,
            json.replace("\"arm\"", "\"new\"").as_bytes(),
        )
        .await;
    assert_eq!(fresh.status, 200, "{}", fresh.text());
    let old = http
        .request("GET", "/v1/robots/arm", &[("if-none-match", &tag)], b"")
        .await;
    assert_eq!(old.status, 200);
    assert_eq!(http.opened_count(), 1);
}
