//! Plans, over both protocols and by byte.

use prost::Message;
use takt_client::v1::{self, plan_move_response::Outcome};
use takt_server::{Config, StoreConfig};
use takt_tests::{
    Protocol, TestServer,
    fixtures::{EXAMPLES, example, good_move, plan_move},
};

const PLAN_MOVE: &str = "/takt.v1.PlanService/PlanMove";

/// Moves of every example robot, with everything that a request can ask for.
fn moves() -> Vec<v1::PlanMoveRequest> {
    let pairs: [(&str, &[f64], &[f64]); 4] = [
        (
            "ur5e",
            &[0.0, -1.57, 1.57, -1.57, -1.57, 0.0],
            &[1.0, -1.0, 1.0, -1.0, -1.0, 0.5],
        ),
        (
            "fr3",
            &[0.0, -0.8, 0.0, -2.3, 0.0, 1.6, 0.8],
            &[0.5, 0.3, 0.1, -1.5, 0.2, 2.0, 0.0],
        ),
        (
            "puma560",
            &[0.0, 0.5, -0.5, 0.0, 0.3, 0.0],
            &[0.5, 0.8, -1.0, 0.2, 0.1, 0.4],
        ),
        ("scara", &[-1.0, 1.0, 0.1, 0.0], &[1.0, -1.0, 0.15, 2.0]),
    ];
    let methods = [
        None,
        Some(v1::Method::Preset),
        Some(v1::Method::Endpoint),
        Some(v1::Method::Verified),
    ];
    let mut moves = Vec::new();
    for (robot, start, target) in pairs {
        for method in methods {
            let plain = v1::PlanMoveRequest {
                method: method.map(Into::into),
                ..plan_move(robot, start, target)
            };
            moves.push(v1::PlanMoveRequest {
                trace_points: Some(20),
                torque_utilization: Some(0.9),
                speed_scale: Some(0.5),
                cycle_time_s: Some(10.0),
                ..plain.clone()
            });
            moves.push(v1::PlanMoveRequest {
                sample_period_s: Some(0.004),
                payload: Some(v1::Payload {
                    mass_kg: Some(0.5),
                    ..Default::default()
                }),
                ..plain.clone()
            });
            moves.push(plain);
        }
        // What cannot be is an answer too.
        moves.push(v1::PlanMoveRequest {
            payload: Some(v1::Payload {
                mass_kg: Some(500.0),
                ..Default::default()
            }),
            ..plan_move(robot, start, target)
        });
    }
    moves
}

#[tokio::test]
async fn both_protocols_give_equal_answers_and_the_same_bytes_again() {
    let server = TestServer::start().await;
    let (grpc, mut http) = (server.grpc(), server.http().await);
    let mut infeasible_count = 0;
    for request in moves() {
        let path = format!("/v1/robots/{}:planMove", request.robot_id);
        let json = serde_json::to_string(&request).expect("a request can be written");
        let over_grpc = grpc.unary(PLAN_MOVE, request.encode_to_vec()).await.unwrap();
        let over_http = http.post(&path, &json).await;
        assert_eq!(over_http.status, 200, "{}", over_http.text());
        let message = v1::PlanMoveResponse::decode(over_grpc.clone()).unwrap();
        let read: v1::PlanMoveResponse = serde_json::from_slice(&over_http.body).unwrap();
        assert_eq!(message, read, "{json}");
        infeasible_count += usize::from(matches!(message.outcome, Some(Outcome::Infeasible(_))));
        assert_eq!(over_grpc, grpc.unary(PLAN_MOVE, request.encode_to_vec()).await.unwrap());
        assert_eq!(over_http.body, http.post(&path, &json).await.body);
    }
    assert!(infeasible_count >= EXAMPLES.len(), "{infeasible_count}");
    assert_eq!(http.opened_count(), 1);
}

#[tokio::test]
async fn a_restarted_server_and_another_one_give_the_same_bytes() {
    let directory = tempfile::TempDir::new().unwrap();
    let config = || Config {
        store: StoreConfig::Sqlite(directory.path().join("takt.db")),
        examples: true,
        ..Config::default()
    };
    let mut answers = Vec::new();
    for config in [
        config(),
        config(),
        Config {
            examples: true,
            ..Config::default()
        },
    ] {
        let server = TestServer::with(config).await;
        let (grpc, mut http) = (server.grpc(), server.http().await);
        let mut found = Vec::new();
        for request in moves() {
            found.push(grpc.unary(PLAN_MOVE, request.encode_to_vec()).await.unwrap().to_vec());
            let path = format!("/v1/robots/{}:planMove", request.robot_id);
            found.push(http.post(&path, &serde_json::to_string(&request).unwrap()).await.body);
        }
        drop((grpc, http));
        answers.push(found);
        server.ended().await;
    }
    assert!(answers[0] == answers[1], "the restart changed an answer");
    assert!(answers[0] == answers[2], "another store changed an answer");
}

#[tokio::test]
async fn a_plan_has_its_figures_from_one_source() {
    let server = TestServer::start().await;
    for protocol in Protocol::BOTH {
        let client = server.client(protocol);
        for request in moves() {
            let reply = client.plan_move(request.clone()).await.unwrap();
            let provenance = reply.provenance.unwrap();
            assert!(!provenance.revision.is_empty() && !provenance.request_hash.is_empty());
            assert_eq!(provenance.version, takt_server::VERSION);
            let Some(Outcome::Plan(plan)) = reply.outcome else {
                continue;
            };
            for pattern in &plan.patterns {
                let time = pattern.acceleration_time_s + pattern.cruise_time_s + pattern.deceleration_time_s;
                assert!(time <= plan.duration_s * (1.0 + 1e-9), "{pattern:?}");
            }
            for margin in &plan.torque_margins {
                let expected = (margin.limit - margin.peak_torque.abs()) / margin.limit;
                assert!((margin.margin - expected).abs() <= 1e-9, "{margin:?}");
                assert!(margin.margin >= 0.0, "{margin:?}");
            }
            if let Some(setpoints) = &plan.setpoints {
                check_setpoints(&request, &plan, setpoints);
            }
            assert_eq!(plan.torque_utilization, request.torque_utilization.unwrap_or(1.0));
            assert_eq!(plan.speed_scale, request.speed_scale.unwrap_or(1.0));
        }
    }
}

/// Set-points run from the start to exactly the target, at the period or evenly.
fn check_setpoints(request: &v1::PlanMoveRequest, plan: &v1::MovePlan, setpoints: &v1::Setpoints) {
    let [start, target] = [&request.start, &request.target].map(|at| &at.as_ref().unwrap().position);
    let times = &setpoints.time_s;
    assert_eq!(times[0], 0.0);
    assert!(times.windows(2).all(|pair| pair[0] <= pair[1]), "{times:?}");
    assert!((times[times.len() - 1] - plan.duration_s).abs() <= 1e-9 * plan.duration_s);
    if let Some(period) = request.sample_period_s {
        for (index, time) in times.iter().enumerate() {
            assert!((time - period * index as f64).abs() <= 1e-9, "{index}: {time}");
        }
    }
    for (joint, columns) in setpoints.joints.iter().enumerate() {
        for column in [
            &columns.position,
            &columns.velocity,
            &columns.acceleration,
            &columns.torque,
        ] {
            assert_eq!(column.len(), times.len(), "{}", columns.joint);
        }
        assert!((columns.position[0] - start[joint]).abs() <= 1e-12);
        assert_eq!(columns.position.last(), Some(&target[joint]));
        assert_eq!(columns.velocity.last(), Some(&0.0));
    }
}

/// What a plan promises, another call of the service finds in its set-points. A cubic across a switching time has up to
/// 4/3 of the acceleration on either side of it: half of the torque leaves room for that.
#[tokio::test]
async fn a_planned_motion_passes_the_check_of_its_set_points() {
    let server = TestServer::start().await;
    for protocol in Protocol::BOTH {
        let client = server.client(protocol);
        let request = v1::PlanMoveRequest {
            sample_period_s: Some(0.001),
            torque_utilization: Some(0.5),
            ..good_move()
        };
        let reply = client.plan_move(request).await.unwrap();
        let Some(Outcome::Plan(plan)) = reply.outcome else {
            panic!("the move can be planned");
        };
        let setpoints = plan.setpoints.unwrap();
        let column = |index: usize, of: fn(&v1::JointColumns) -> &Vec<f64>| {
            let joints = setpoints.joints.iter();
            joints.map(|joint| of(joint)[index]).collect::<Vec<_>>()
        };
        let points = setpoints
            .time_s
            .iter()
            .enumerate()
            .map(|(index, time)| v1::TrajectoryPoint {
                time_s: *time,
                position: column(index, |joint| &joint.position),
                velocity: column(index, |joint| &joint.velocity),
                acceleration: Vec::new(),
            });
        let check = v1::CheckTrajectoryRequest {
            robot_id: "ur5e".to_owned(),
            trajectory: Some(v1::Trajectory {
                points: points.collect(),
                interpolation: None,
            }),
            ..Default::default()
        };
        let report = client.check_trajectory(check).await.unwrap();
        assert!(report.holds, "{:?}", report.limit_uses.first());
        assert!((report.duration_s - plan.duration_s).abs() <= 1e-9);
        assert_eq!(report.interpolation(), v1::Interpolation::Cubic);
    }
}

#[tokio::test]
async fn an_example_is_registered_as_it_is_written() {
    let server = TestServer::start().await;
    for protocol in Protocol::BOTH {
        let client = server.client(protocol);
        for id in EXAMPLES {
            let request = v1::GetRobotRequest {
                robot_id: id.to_owned(),
                ..Default::default()
            };
            let got = client.get_robot(request).await.unwrap();
            assert_eq!(got.description, Some(example(id)), "{id}");
        }
    }
}
