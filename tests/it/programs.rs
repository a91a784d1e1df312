//! Robot programs over both protocols: the answer is whole, the same again, and its set-points are those of its stream.

use takt_client::v1::{self, plan_path_response::Outcome};
use takt_tests::{Protocol, TestServer, fixtures::good_program};

fn plan_of(reply: v1::PlanPathResponse) -> v1::PathPlan {
    match reply.outcome {
        Some(Outcome::Plan(plan)) => plan,
        other => panic!("{other:?}"),
    }
}

#[tokio::test]
async fn both_protocols_plan_the_same_program() {
    let server = TestServer::start().await;
    let mut replies = Vec::new();
    for protocol in Protocol::BOTH {
        let client = server.client(protocol);
        for _ in 0..2 {
            replies.push(client.plan_path(good_program()).await.unwrap());
        }
    }
    assert!(replies.windows(2).all(|pair| pair[0] == pair[1]));
    let plan = plan_of(replies.remove(0));
    assert_eq!(plan.segments.len(), 4);
    assert_eq!(plan.torque_margins.len(), 6);
    assert!(
        plan.torque_margins
            .iter()
            .all(|margin| margin.margin >= 0.0 && margin.location.is_some())
    );
    assert!(
        plan.limit_uses.iter().all(|limit| limit.margin >= 0.0),
        "{:?}",
        plan.limit_uses
    );
    let stretches = &plan.limiting;
    assert_eq!(stretches[0].begin_s, 0.0);
    assert!((stretches[stretches.len() - 1].end_s - plan.duration_s).abs() < 1e-9);
    assert!(
        stretches
            .windows(2)
            .all(|pair| (pair[0].end_s - pair[1].begin_s).abs() < 1e-12)
    );
    let spent: f64 = plan.limit_costs.iter().map(|cost| cost.time_s).sum();
    assert!((spent - plan.duration_s).abs() < 1e-6, "{spent} of {}", plan.duration_s);
}

#[tokio::test]
async fn set_points_of_a_program_end_where_it_ends_and_stream_the_same() {
    let server = TestServer::start().await;
    for protocol in Protocol::BOTH {
        let client = server.client(protocol);
        let program = v1::PlanPathRequest {
            sample_period_s: Some(0.008),
            ..good_program()
        };
        let mut expected = client.plan_path(program.clone()).await.unwrap();
        let setpoints = match &mut expected.outcome {
            Some(Outcome::Plan(plan)) => plan.setpoints.take().unwrap(),
            other => panic!("{other:?}"),
        };
        let count = setpoints.time_s.len();
        let home = &program.start.as_ref().unwrap().position;
        for (joint, columns) in setpoints.joints.iter().enumerate() {
            assert_eq!(columns.position.len(), count);
            assert!(
                (columns.position[count - 1] - home[joint]).abs() < 1e-9,
                "{}",
                columns.joint
            );
            assert!(columns.velocity[count - 1].abs() < 1e-9);
        }
        for column in [&setpoints.fraction, &setpoints.tool_speed_m_per_s] {
            assert_eq!(column.len(), count);
        }
        assert!(setpoints.segment.windows(2).all(|pair| pair[0] <= pair[1]));
        assert_eq!((setpoints.segment[0], setpoints.segment[count - 1]), (0, 3));
        let request = v1::StreamSetpointsRequest {
            robot_id: "ur5e".to_owned(),
            motion: Some(v1::stream_setpoints_request::Motion::Path(program)),
            ..Default::default()
        };
        let mut stream = client.stream_setpoints(request).await.unwrap();
        assert_eq!(
            stream.header().answer,
            Some(v1::setpoints_header::Answer::Path(expected)),
            "{protocol:?}"
        );
        let (mut times, mut segments, mut speeds) = (Vec::new(), Vec::new(), Vec::new());
        while let Some(chunk) = stream.next().await.unwrap() {
            let piece = chunk.setpoints.unwrap();
            times.extend(piece.time_s);
            segments.extend(piece.segment);
            speeds.extend(piece.tool_speed_m_per_s);
        }
        assert_eq!(times, setpoints.time_s);
        assert_eq!(segments, setpoints.segment);
        assert_eq!(speeds, setpoints.tool_speed_m_per_s);
    }
}

#[tokio::test]
async fn a_program_out_of_reach_says_where() {
    let server = TestServer::start().await;
    for protocol in Protocol::BOTH {
        let mut program = good_program();
        if let Some(v1::path_segment::Shape::Line(line)) = &mut program.segments[1].shape {
            let target = line.target.get_or_insert_default();
            target.pose.get_or_insert_default().position_m = vec![3.0, 0.0, 0.1];
        }
        let reply = server.client(protocol).plan_path(program).await.unwrap();
        let Some(Outcome::Infeasible(no)) = reply.outcome else {
            panic!("{reply:?}");
        };
        assert_eq!(no.location.unwrap().segment, 1);
        assert!(!no.suggestion.is_empty());
    }
}

/// A weld's way in at speed, with every joint's jerk limited: the last set-point has the speed asked for and its acceleration
/// is 0; a speed that cannot be had is refused with the largest.
#[tokio::test]
async fn a_speed_at_the_end_is_kept_together_with_jerk_limits() {
    let server = TestServer::start().await;
    let mut program = good_program();
    program.segments.truncate(2);
    program.segments[1].dwell_s = None;
    program.trace_points = Some(200);
    let start = program.start.clone().unwrap().position;
    program.limits = Some(v1::PathLimits {
        joints: [
            "shoulder_pan",
            "shoulder_lift",
            "elbow",
            "wrist_1",
            "wrist_2",
            "wrist_3",
        ]
        .map(|joint| v1::LimitOverride {
            joint: format!("{joint}_joint"),
            jerk: Some(200.0),
            ..Default::default()
        })
        .to_vec(),
        ..Default::default()
    });
    let mut replies = Vec::new();
    for protocol in Protocol::BOTH {
        let client = server.client(protocol);
        let moving = v1::PlanPathRequest {
            end_speed: Some(0.1),
            ..program.clone()
        };
        let mut plan = plan_of(client.plan_path(moving).await.unwrap());
        let setpoints = plan.setpoints.take().unwrap();
        let last = setpoints.time_s.len() - 1;
        assert!((setpoints.tool_speed_m_per_s[last] - 0.1).abs() < 1e-9);
        assert!(setpoints.tool_speed_m_per_s[0] < 1e-9);
        for (joint, position) in setpoints.joints.iter().zip(&start) {
            assert!((joint.position[0] - position).abs() < 1e-9, "{}", joint.joint);
        }
        // the tool's speed changes no more: its change over a step is of second order in it
        let speeds = &setpoints.tool_speed_m_per_s[last - 2..];
        let steps = [speeds[1] - speeds[0], speeds[2] - speeds[1]];
        assert!(steps[1].abs() < 0.5 * steps[0].abs(), "{speeds:?}");
        assert!(plan.limit_uses.iter().all(|limit| limit.margin >= 0.0));

        let too_fast = v1::PlanPathRequest {
            end_speed: Some(30.0),
            ..program.clone()
        };
        let reply = client.plan_path(too_fast).await.unwrap();
        let Some(Outcome::Infeasible(no)) = reply.outcome else {
            panic!("{reply:?}");
        };
        assert_eq!(no.reason(), v1::path_infeasible::Reason::BoundarySpeed);
        assert_eq!(no.location.as_ref().unwrap().segment, 1);
        assert!(
            (no.needed - 30.0).abs() < 1e-9 && no.available > 0.1 && no.available < 10.0,
            "{no:?}"
        );
        replies.push((plan, no));
    }
    assert!(replies[0] == replies[1]);
}

/// What only the planner can find wrong has its place in the message too.
#[tokio::test]
async fn a_looser_limit_of_a_segment_is_named() {
    let server = TestServer::start().await;
    for protocol in Protocol::BOTH {
        let mut program = good_program();
        program.segments[1].limits = Some(v1::PathLimits {
            joints: vec![v1::LimitOverride {
                joint: "elbow_joint".to_owned(),
                velocity: Some(1000.0),
                ..Default::default()
            }],
            ..Default::default()
        });
        let error = server.client(protocol).plan_path(program).await.unwrap_err();
        assert_eq!(error.violations()[0].field, "segments[1].limits.joints[0].velocity");
    }
}

/// A payload that is too heavy for a pose comes with the one that would do.
#[tokio::test]
async fn a_payload_that_cannot_be_held_is_told_the_one_that_can() {
    let server = TestServer::start().await;
    for protocol in Protocol::BOTH {
        let client = server.client(protocol);
        let lift = |mass_kg: f64| v1::PlanPathRequest {
            robot_id: "ur5e".to_owned(),
            start: Some(v1::JointPosition {
                position: vec![0.0, -1.57, 0.0, -1.57, 0.0, 0.0],
            }),
            payload: Some(v1::Payload {
                mass_kg: Some(mass_kg),
                ..Default::default()
            }),
            segments: vec![v1::PathSegment {
                shape: Some(v1::path_segment::Shape::Joint(v1::JointSegment {
                    target: Some(v1::Target {
                        position: vec![0.0, 0.0, 0.0, -1.57, 0.0, 0.0],
                        ..Default::default()
                    }),
                })),
                ..Default::default()
            }],
            ..Default::default()
        };
        let Some(Outcome::Infeasible(no)) = client.plan_path(lift(40.0)).await.unwrap().outcome else {
            panic!("40 kg at arm's length")
        };
        let most = no.feasible_payload_kg.unwrap();
        assert!(0.0 < most && most < 40.0, "{no:?}");
        assert!(no.suggestion.starts_with("carry at most"), "{no:?}");
        let outcome = |reply: v1::PlanPathResponse| reply.outcome.unwrap();
        let less = outcome(client.plan_path(lift(0.98 * most)).await.unwrap());
        assert!(matches!(less, Outcome::Plan(_)), "{most} {less:?}");
        let more = outcome(client.plan_path(lift(1.02 * most)).await.unwrap());
        assert!(matches!(more, Outcome::Infeasible(_)), "{most}");
    }
}
