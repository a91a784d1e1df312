//! Torque limits at a confidence, over both protocols.

use takt_client::v1::{
    self, fitted_parameter::Kind, plan_move_response::Outcome, plan_path_response::Outcome as OfPath,
};
use takt_tests::{
    Protocol, TestServer,
    fixtures::{plan_move, registration},
};

/// The arm of two joints, its masses and frictions known to some percent.
fn fitted() -> v1::RegisterRobotRequest {
    let mut request = registration("fitted", 5.0);
    let parameter = |joint: &str, kind: Kind| v1::FittedParameter {
        joint: joint.to_owned(),
        kind: kind.into(),
    };
    let residual = |joint: &str, deviation: f64| v1::JointResidual {
        joint: joint.to_owned(),
        deviation,
        correlation_time_s: 0.2,
        degrees_of_freedom: Some(5.0),
    };
    if let Some(description) = &mut request.description {
        // its axes lie level
        description.gravity_m_per_s2 = vec![0.0, -9.81, 0.0];
        description.uncertainty = Some(v1::ModelUncertainty {
            parameters: vec![
                parameter("b", Kind::Mass),
                parameter("a", Kind::Mass),
                parameter("a", Kind::CoulombPositive),
            ],
            covariance: vec![0.04, 0.01, 0.09, 0.0, 0.0, 1.0],
            residuals: vec![residual("a", 1.0), residual("b", 0.5)],
        });
    }
    request
}

fn confident(level: f64, over: v1::confidence::Over) -> Option<v1::Confidence> {
    Some(v1::Confidence {
        level,
        over: Some(over.into()),
    })
}

fn joint_segment(position: &[f64]) -> v1::PathSegment {
    v1::PathSegment {
        shape: Some(v1::path_segment::Shape::Joint(v1::JointSegment {
            target: Some(v1::Target {
                position: position.to_vec(),
                ..Default::default()
            }),
        })),
        ..Default::default()
    }
}

#[tokio::test]
async fn both_protocols_hold_the_same_limits_at_the_same_cost() {
    use v1::confidence::Over;
    let server = TestServer::start().await;
    server.client(Protocol::Grpc).register_robot(fitted()).await.unwrap();
    let plain = plan_move("fitted", &[0.0, 0.3], &[1.2, -0.6]);
    let mut replies = Vec::new();
    for protocol in Protocol::BOTH {
        let client = server.client(protocol);
        let mut durations = Vec::new();
        for confidence in [None, confident(0.95, Over::Sample), confident(0.95, Over::Move)] {
            let request = v1::PlanMoveRequest {
                confidence,
                ..plain.clone()
            };
            let reply = client.plan_move(request).await.unwrap();
            let Some(Outcome::Plan(plan)) = &reply.outcome else {
                panic!("{reply:?}")
            };
            assert_eq!(plan.confidence.is_some(), confidence.is_some());
            if let Some(report) = &plan.confidence {
                assert!(report.holds && report.joints.len() == 2);
                assert_eq!(report.confidence, confidence);
                assert_eq!(report.nominal_duration_s, Some(durations[0]));
                for joint in &report.joints {
                    let margin = (joint.limit - joint.torque.abs() - joint.band) / joint.limit;
                    assert!(
                        joint.margin >= 0.0 && (margin - joint.margin).abs() < 1e-12,
                        "{joint:?}"
                    );
                }
            }
            durations.push(plan.duration_s);
            replies.push(reply);
        }
        assert!(
            durations[0] < durations[1] && durations[1] < durations[2],
            "{durations:?}"
        );
    }
    let (first, second) = replies.split_at(3);
    assert_eq!(first, second);
}

#[tokio::test]
async fn programs_and_checks_take_a_confidence_too() {
    let server = TestServer::start().await;
    for protocol in Protocol::BOTH {
        let client = server.client(protocol);
        client.register_robot(fitted()).await.unwrap();
        let program = v1::PlanPathRequest {
            robot_id: "fitted".to_owned(),
            start: Some(v1::JointPosition {
                position: vec![0.0, 0.3],
            }),
            segments: vec![joint_segment(&[0.8, -0.4])],
            confidence: confident(0.9, v1::confidence::Over::Sample),
            ..Default::default()
        };
        let reply = client.plan_path(program).await.unwrap();
        let Some(OfPath::Plan(plan)) = &reply.outcome else {
            panic!("{reply:?}")
        };
        let report = plan.confidence.as_ref().unwrap();
        assert!(report.holds && plan.duration_s >= report.nominal_duration_s.unwrap());
        let point = |time_s: f64| v1::TrajectoryPoint {
            time_s,
            position: vec![0.0, 0.3],
            velocity: vec![0.0; 2],
            acceleration: vec![0.0; 2],
        };
        let check = v1::CheckTrajectoryRequest {
            robot_id: "fitted".to_owned(),
            trajectory: Some(v1::Trajectory {
                points: vec![point(0.0), point(0.5)],
                interpolation: None,
            }),
            confidence: confident(0.9, v1::confidence::Over::Move),
            ..Default::default()
        };
        let reply = client.check_trajectory(check).await.unwrap();
        let report = reply.confidence.unwrap();
        assert!(reply.holds && report.holds && report.nominal_duration_s.is_none());
        assert!(report.joints.iter().all(|joint| joint.band > 0.0));
    }
}

#[tokio::test]
async fn what_no_speed_lets_hold_is_refused_with_its_band() {
    let server = TestServer::start().await;
    let client = server.client(Protocol::Http);
    client.register_robot(fitted()).await.unwrap();
    let request = v1::PlanMoveRequest {
        confidence: confident(0.95, v1::confidence::Over::Sample),
        // 28.4 N m of 30 hold the arm out level
        torque_utilization: Some(0.15),
        ..plan_move("fitted", &[0.0, 0.0], &[0.2, 0.1])
    };
    let reply = client.plan_move(request).await.unwrap();
    match reply.outcome {
        Some(Outcome::Infeasible(no)) => {
            let band = no.band.unwrap();
            assert!(
                band > 0.0 && no.needed.abs() > no.available && no.needed.abs() - band < no.available,
                "{no:?}"
            );
        }
        other => panic!("{other:?}"),
    }
}

/// Motors follow the plan that holds at the confidence, not the faster one without.
#[tokio::test]
async fn motors_have_set_points_of_plans_at_a_confidence() {
    use v1::confidence::Over;
    let server = TestServer::start().await;
    server.client(Protocol::Grpc).register_robot(fitted()).await.unwrap();
    for protocol in Protocol::BOTH {
        let client = server.client(protocol);
        let move_of = |motors| v1::PlanMoveRequest {
            sample_period_s: Some(0.002),
            motor_setpoints: motors,
            confidence: confident(0.95, Over::Move),
            ..plan_move("fitted", &[0.0, 0.3], &[1.2, -0.6])
        };
        let mut found = Vec::new();
        for motors in [None, Some(true)] {
            let reply = client.plan_move(move_of(motors)).await.unwrap();
            let Some(Outcome::Plan(plan)) = reply.outcome else {
                panic!("{:?}", reply.outcome)
            };
            assert!(plan.confidence.is_some());
            found.push(plan.setpoints.unwrap());
        }
        let (joints, motors) = (&found[0], &found[1]);
        assert_eq!(joints.time_s, motors.time_s);
        follows(motors);

        let path = v1::PlanPathRequest {
            robot_id: "fitted".to_owned(),
            start: Some(v1::JointPosition {
                position: vec![0.0, 0.3],
            }),
            segments: vec![joint_segment(&[1.2, -0.6])],
            sample_period_s: Some(0.002),
            motor_setpoints: Some(true),
            confidence: confident(0.95, Over::Move),
            ..Default::default()
        };
        let reply = client.plan_path(path).await.unwrap();
        let Some(OfPath::Plan(plan)) = reply.outcome else {
            panic!("{:?}", reply.outcome)
        };
        follows(&plan.setpoints.unwrap());
    }
}

/// The arm's joints are rigid and their motors have a ratio of one: each gives what its joint takes, but at the ends, where
/// friction depends on which way the next moment goes.
fn follows(setpoints: &v1::Setpoints) {
    let count = setpoints.time_s.len();
    for joint in &setpoints.joints {
        assert_eq!(joint.motor_torque.len(), count);
        let inner = joint.motor_torque.iter().zip(&joint.torque).skip(1).take(count - 2);
        for (motor, torque) in inner {
            assert!(
                (motor - torque).abs() < 1e-6 * torque.abs().max(1.0),
                "{} {motor} {torque}",
                joint.joint
            );
        }
    }
}
