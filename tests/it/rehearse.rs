//! Rehearsals, over both protocols.

use takt_client::{
    Code,
    v1::{self, rehearse_request::Motion, rehearse_response::Outcome},
};
use takt_server::{Config, Limits};
use takt_tests::{
    Protocol, TestServer,
    fixtures::{good_program, plan_move},
};

/// A move of the example arm whose drives are described whole.
fn request() -> v1::RehearseRequest {
    v1::RehearseRequest {
        robot_id: "scara".to_owned(),
        motion: Some(Motion::Move(v1::PlanMoveRequest {
            robot_id: String::new(),
            ..plan_move("scara", &[-1.0, 1.0, 0.1, 0.0], &[-0.5, 0.6, 0.12, 0.4])
        })),
        friction: vec![v1::FrictionTruth {
            coulomb_scale: Some(1.5),
            viscous_scale: Some(1.5),
            ..Default::default()
        }],
        ..Default::default()
    }
}

fn rehearsal(reply: v1::RehearseResponse) -> v1::Rehearsal {
    match reply.outcome {
        Some(Outcome::Rehearsal(rehearsal)) => rehearsal,
        other => panic!("{other:?}"),
    }
}

#[tokio::test]
async fn friction_that_is_wrong_costs_less_where_it_is_adapted() {
    let server = TestServer::start().await;
    let mut both = Vec::new();
    for protocol in Protocol::BOTH {
        both.push(server.client(protocol).rehearse(request()).await.unwrap());
    }
    assert_eq!(both[0], both[1], "both protocols say the same");
    let found = rehearsal(both.remove(0));
    let (plain, adapted) = (found.plain.unwrap(), found.adapted.unwrap());
    for run in [&plain, &adapted] {
        assert_eq!(run.end(), v1::rehearsal_run::End::Completed);
        assert_eq!((run.steps, run.joints.len()), (found.steps, 4));
        assert!(run.trace.is_none());
    }
    assert!(adapted.tool_error_rms_m < plain.tool_error_rms_m, "{adapted:?}");
    let shoulder = (&plain.joints[0], &adapted.joints[0]);
    assert!(shoulder.1.friction_torque_error_rms_last < 0.5 * shoulder.0.friction_torque_error_rms_last);
    assert!(shoulder.0.margin.is_some() && !shoulder.0.friction.is_empty());
}

#[tokio::test]
async fn a_model_that_is_right_is_followed_closely() {
    let server = TestServer::start().await;
    let request = v1::RehearseRequest {
        friction: Vec::new(),
        ..request()
    };
    let found = rehearsal(server.client(Protocol::Grpc).rehearse(request).await.unwrap());
    let plain = found.plain.unwrap();
    assert!(plain.tool_error_peak_m < 1e-3, "{plain:?}");
}

#[tokio::test]
async fn traces_come_where_they_are_asked_for_and_are_bounded() {
    let server = TestServer::with(Config {
        examples: true,
        limits: Limits {
            max_trace_points: 60,
            ..Limits::default()
        },
        ..Config::default()
    })
    .await;
    for protocol in Protocol::BOTH {
        let client = server.client(protocol);
        let every = |trace_every| v1::RehearseRequest {
            trace_every: Some(trace_every),
            ..request()
        };
        let found = rehearsal(client.rehearse(every(20)).await.unwrap());
        for run in [found.plain, found.adapted] {
            let trace = run.unwrap().trace.unwrap();
            assert!((2..=60).contains(&trace.time_s.len()), "{}", trace.time_s.len());
            for columns in &trace.joints {
                assert_eq!(columns.position.len(), trace.time_s.len());
                assert_eq!(columns.true_friction_torque.len(), trace.time_s.len());
            }
        }
        let refused = client.rehearse(every(1)).await.unwrap_err();
        assert_eq!(
            (refused.code(), refused.violations()[0].field.as_str()),
            (Code::InvalidRequest, "trace_every")
        );
    }
}

#[tokio::test]
async fn programs_and_trajectories_are_rehearsed_too() {
    let server = TestServer::start().await;
    let client = server.client(Protocol::Http);
    let program = v1::RehearseRequest {
        robot_id: "ur5e".to_owned(),
        motion: Some(Motion::Path(good_program())),
        ..Default::default()
    };
    let found = rehearsal(client.rehearse(program).await.unwrap());
    assert!(
        found.joints.iter().all(|joint| !joint.flexible),
        "no stiffness is known"
    );
    let rest = |time_s| v1::TrajectoryPoint {
        time_s,
        position: vec![-1.0, 1.0, 0.1, 0.0],
        velocity: vec![0.0; 4],
        acceleration: vec![0.0; 4],
    };
    let still = v1::RehearseRequest {
        motion: Some(Motion::Setpoints(v1::SetpointMotion {
            trajectory: Some(v1::Trajectory {
                points: vec![rest(0.0), rest(0.2)],
                interpolation: None,
            }),
            payload: None,
        })),
        ..request()
    };
    let found = rehearsal(client.rehearse(still).await.unwrap());
    assert!(found.plain.unwrap().tool_error_peak_m < 1e-3);
}

#[tokio::test]
async fn what_cannot_be_planned_is_an_answer() {
    let server = TestServer::start().await;
    for protocol in Protocol::BOTH {
        let mut heavy = request();
        if let Some(Motion::Move(motion)) = &mut heavy.motion {
            motion.payload.get_or_insert_default().mass_kg = Some(500.0);
        }
        let reply = server.client(protocol).rehearse(heavy).await.unwrap();
        assert!(
            matches!(reply.outcome, Some(Outcome::MoveInfeasible(_))),
            "{:?}",
            reply.outcome
        );
        assert!(reply.provenance.is_some());
    }
}

/// Motors have their set-points beside the joints', in their own units.
#[tokio::test]
async fn set_points_of_motors_come_where_they_are_asked_for() {
    use v1::plan_move_response::Outcome;
    let server = TestServer::start().await;
    let robot = v1::GetRobotRequest {
        robot_id: "scara".to_owned(),
        ..Default::default()
    };
    let robot = server
        .client(Protocol::Grpc)
        .get_robot(robot)
        .await
        .unwrap()
        .robot
        .unwrap();
    for protocol in Protocol::BOTH {
        let request = v1::PlanMoveRequest {
            sample_period_s: Some(0.004),
            motor_setpoints: Some(true),
            ..plan_move("scara", &[-1.0, 1.0, 0.1, 0.0], &[-0.5, 0.6, 0.12, 0.4])
        };
        let reply = server.client(protocol).plan_move(request).await.unwrap();
        let Some(Outcome::Plan(plan)) = reply.outcome else {
            panic!("{:?}", reply.outcome);
        };
        let setpoints = plan.setpoints.unwrap();
        let count = setpoints.time_s.len();
        assert!(setpoints.exact_motor_points.unwrap() as usize <= count);
        for (columns, joint) in setpoints.joints.iter().zip(&robot.joints) {
            let ratio = joint.drive.as_ref().unwrap().gear_ratio.unwrap();
            assert_eq!(columns.motor_torque.len(), count);
            // No stiffness is known, so what the motor gives is what the joint takes.
            for (motor, torque) in columns.motor_torque.iter().zip(&columns.torque).skip(1).take(count - 2) {
                assert!(
                    (ratio * motor - torque).abs() < 1e-6 * torque.abs().max(1.0),
                    "{} {motor} {torque}",
                    joint.name
                );
            }
        }
    }
}
