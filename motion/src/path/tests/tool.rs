use nalgebra::{Isometry3, UnitQuaternion, Vector3};

use super::support::*;
use crate::curve::{Curve, Side};
use crate::kinematics::pose;
use crate::path::outcome::PathInfeasibleReason;
use crate::path::request::*;
use crate::robot::Robot;
use crate::robot::spec::JointKind;
use crate::test_arms::{random, random_arm, values};

#[test]
fn a_line_is_straight_and_turns_about_one_axis() {
    let robot = ur5e();
    let state = &mut 6;
    for _ in 0..20 {
        let by = values(3, 0.12, state).try_into().unwrap();
        let turn: [f64; 3] = values(3, 0.5, state).try_into().unwrap();
        let end = shifted(&robot, &READY, by, turn);
        let start = pose(&robot, &READY, &tcp());
        let program = program(&robot, &request(&READY, vec![line(to_pose(end), None)]));
        let stroke = &program.strokes[0];
        for s in places(stroke.length()) {
            let part = s / stroke.length();
            let tool = tool_at(&robot, stroke, s);
            let expected = start.translation.vector + Vector3::from(by) * part;
            assert!((tool.translation.vector - expected).norm() < 1e-12);
            let expected = UnitQuaternion::from_scaled_axis(Vector3::from(turn) * part) * start.rotation;
            let turned = tool.rotation.to_rotation_matrix().into_inner();
            assert!((turned - expected.to_rotation_matrix().into_inner()).norm() < 1e-12);
        }
        assert!((program.tool_lengths[0] - Vector3::from(by).norm()).abs() < 1e-12);
        check_derivatives(stroke, 5);
    }
}

/// The pace is, on average, that of the joint nearest to its limit.
#[test]
fn the_parameter_is_normalised_time() {
    let robot = ur5e();
    let end = shifted(&robot, &READY, [0.1, 0.1, -0.1], [0.0, 0.4, 0.0]);
    let program = program(&robot, &request(&READY, vec![line(to_pose(end), None)]));
    let stroke = &program.strokes[0];
    let pace = |s: f64| {
        let point = at(stroke, s, Side::After);
        let joints = robot.spec().joints.iter().zip(&point.first);
        joints.fold(0.0f64, |most, (joint, rate)| {
            most.max(rate.abs() / joint.limits.velocity.unwrap())
        })
    };
    let mean = places(stroke.length()).map(pace).sum::<f64>() / 98.0;
    assert!((mean - 1.0).abs() < 0.01, "{mean}");
}

#[test]
fn a_taught_frame_carries_its_poses() {
    let mut spec = ur5e().spec().clone();
    let frame = Isometry3::new(Vector3::new(0.3, -0.2, 0.1), Vector3::new(0.0, 0.0, 0.7));
    spec.frames.push(("table".to_owned(), frame));
    let robot = Robot::new(spec, Vec::new()).unwrap();
    let end = shifted(&robot, &READY, [0.1, 0.05, 0.0], [0.0; 3]);
    let target = Target::Pose {
        pose: frame.inverse() * end,
        frame: Some("table".to_owned()),
    };
    let program = program(&robot, &request(&READY, vec![line(target, None)]));
    let stroke = &program.strokes[0];
    let got = tool_at(&robot, stroke, stroke.length()).translation.vector;
    assert!((got - end.translation.vector).norm() < 1e-12);
    let unknown = Target::Pose {
        pose: end,
        frame: Some("tabel".to_owned()),
    };
    let finding = &refused(&robot, &request(&READY, vec![line(unknown, None)]))[0];
    assert_eq!(
        finding,
        "segments[0].line.target.frame: no frame \"tabel\"; the frames are table"
    );
}

#[test]
fn a_point_in_millimetres_is_asked_about() {
    let robot = ur5e();
    let said = |by: f64| {
        let end = shifted(&robot, &READY, [by, 0.0, 0.0], [0.0; 3]);
        let request = request(&READY, vec![line(to_pose(end), None)]);
        outcome(&robot, &request).unwrap().unwrap_err().suggestion
    };
    assert!(said(600.0).contains("are these millimetres?"), "{}", said(600.0));
    assert!(!said(60.0).contains("millimetres"), "{}", said(60.0));
}

#[test]
fn a_line_out_of_reach_says_how_far_it_can_go() {
    let robot = ur5e();
    let end = shifted(&robot, &READY, [1.5, 0.0, 0.0], [0.0; 3]);
    let infeasible = outcome(&robot, &request(&READY, vec![line(to_pose(end), None)]))
        .unwrap()
        .unwrap_err();
    assert_eq!(infeasible.reason, PathInfeasibleReason::OutOfReach);
    let part = infeasible.reachable_fraction.unwrap();
    assert!(part > 0.1 && part < 0.9, "{part}");
    assert!(infeasible.needed > 0.3, "{infeasible:?}");
    // up to there it can be run
    let end = shifted(&robot, &READY, [1.5 * part * 0.99, 0.0, 0.0], [0.0; 3]);
    outcome(&robot, &request(&READY, vec![line(to_pose(end), None)]))
        .unwrap()
        .unwrap();
}

/// Through the wrist's straight position q5 = 0 with a direction that it cannot follow.
#[test]
fn a_line_through_a_singularity_names_it() {
    let robot = ur5e();
    let near = [0.1, -1.4, 1.6, -1.7, -0.1, 0.3];
    let mut infeasible = None;
    for turn in [
        [0.6, 0.0, 0.0],
        [0.0, 0.6, 0.0],
        [0.0, 0.0, 0.6],
        [-0.6, 0.0, 0.0],
        [0.0, -0.6, 0.0],
        [0.0, 0.0, -0.6],
    ] {
        let end = shifted(&robot, &near, [0.0; 3], turn);
        if let Err(found) = outcome(&robot, &request(&near, vec![line(to_pose(end), None)])).unwrap() {
            infeasible = Some(found);
        }
    }
    let start = [0.1, -1.4, 1.6, -1.7, 0.0, 0.3];
    let end = shifted(&robot, &start, [0.0, 0.1, 0.0], [0.0; 3]);
    let at_once = outcome(&robot, &request(&start, vec![line(to_pose(end), None)]))
        .unwrap()
        .unwrap_err();
    for found in infeasible.into_iter().chain([at_once]) {
        assert_eq!(found.reason, PathInfeasibleReason::Singularity);
        assert!(found.available < found.needed, "{found:?}");
    }
}

#[test]
fn a_line_that_would_change_the_configuration_says_so() {
    let robot = ur5e();
    let mut target = READY;
    target[0] += 0.1;
    target[5] -= std::f64::consts::TAU;
    let infeasible = outcome(
        &robot,
        &request(&READY, vec![line(Target::Joints(target.to_vec()), None)]),
    );
    let infeasible = infeasible.unwrap().unwrap_err();
    assert_eq!(
        (infeasible.reason, infeasible.joint),
        (PathInfeasibleReason::Singularity, Some(5))
    );
}

/// Seven joints: one is led, and what it does is the same every time.
#[test]
fn a_line_of_seven_joints() {
    let robot = robot(PANDA, "fer_link8");
    let start = [0.0, -0.6, 0.1, -2.2, 0.1, 1.7, 0.7];
    let end = shifted(&robot, &start, [0.1, 0.2, -0.1], [0.1, 0.2, 0.3]);
    let request = request(&start, vec![line(to_pose(end), None)]);
    let program = program(&robot, &request);
    let stroke = &program.strokes[0];
    let from = pose(&robot, &start, &tcp()).translation.vector;
    for s in places(stroke.length()) {
        let tool = tool_at(&robot, stroke, s).translation.vector;
        let expected = from + (end.translation.vector - from) * (s / stroke.length());
        assert!((tool - expected).norm() < 1e-12);
    }
    check_derivatives(stroke, 9);
    assert!(
        program.warnings[0].contains("the others follow the tool"),
        "{:?}",
        program.warnings
    );
    let again = super::support::program(&robot, &request);
    for s in places(stroke.length()) {
        assert_eq!(at(stroke, s, Side::After), at(&again.strokes[0], s, Side::After));
    }
}

/// Random lines of random arms with six joints: what is followed is the line, and what is not is a reason.
#[test]
fn random_arms_follow_or_say_why_not() {
    let state = &mut 77;
    let mut followed = 0;
    for seed in 0..60 {
        let robot = Robot::new(random_arm(6, seed), Vec::new()).unwrap();
        let q = values(6, 1.0, state);
        let by = values(3, 0.2, state).try_into().unwrap();
        let end = shifted(
            &robot,
            &q,
            by,
            values(3, 0.3 * random(state).abs(), state).try_into().unwrap(),
        );
        match outcome(&robot, &request(&q, vec![line(to_pose(end), None)])).unwrap() {
            Ok(program) => {
                followed += 1;
                let stroke = &program.strokes[0];
                for s in places(stroke.length()) {
                    let expected = end.translation.vector - Vector3::from(by) * (1.0 - s / stroke.length());
                    let error = (tool_at(&robot, stroke, s).translation.vector - expected).norm();
                    assert!(error < 1e-11, "{error}");
                }
                check_derivatives(stroke, seed);
            }
            Err(infeasible) => assert!(infeasible.reachable_fraction.is_some_and(|part| part < 1.0)),
        }
    }
    assert!(followed > 20, "{followed}");
}

/// The range of a joint, tightened until a line leaves it: the answer says where, and what the joint would need.
#[test]
fn a_line_that_leaves_a_joints_range_says_where() {
    let robot = ur5e();
    let end = shifted(&robot, &READY, [0.1, 0.15, 0.0], [0.0; 3]);
    let mut request = request(&READY, vec![line(to_pose(end), None)]);
    let free = program(&robot, &request);
    let stroke = &free.strokes[0];
    let target = at(stroke, stroke.length(), Side::Before).position[0];
    let limit = 0.5 * (READY[0] + target);
    request.segments[0].limits.push(crate::plan::request::LimitOverride {
        joint: robot.spec().joints[0].name.clone(),
        position_upper: Some(limit),
        ..Default::default()
    });
    let infeasible = outcome(&robot, &request).unwrap().unwrap_err();
    assert_eq!(
        (infeasible.reason, infeasible.joint),
        (PathInfeasibleReason::JointRange, Some(0))
    );
    assert_eq!(infeasible.available, limit);
    assert!(infeasible.needed > limit && infeasible.needed <= target + 1e-12);
    let s = infeasible.reachable_fraction.unwrap() * stroke.length();
    assert!((at(stroke, s, Side::After).position[0] - limit).abs() < 1e-9);
}

/// Four joints: turning, turning, sliding, turning, all about the vertical.
fn scara() -> Robot {
    let mut spec = random_arm(4, 1);
    spec.link_from_tip = Isometry3::identity();
    let offsets = [[0.0, 0.0, 0.4], [0.35, 0.0, 0.0], [0.25, 0.0, 0.0], [0.0, 0.0, 0.0]];
    for (index, (joint, offset)) in spec.joints.iter_mut().zip(offsets).enumerate() {
        joint.kind = if index == 2 {
            JointKind::Prismatic
        } else {
            JointKind::Revolute
        };
        joint.parent_from_joint = Isometry3::translation(offset[0], offset[1], offset[2]);
        joint.axis = Vector3::z();
    }
    Robot::new(spec, Vec::new()).unwrap()
}

#[test]
fn a_scara_follows_what_it_can_and_names_what_it_cannot() {
    let robot = scara();
    let start = [0.4, 0.9, -0.1, 0.2];
    let end = shifted(&robot, &start, [-0.15, 0.05, 0.05], [0.0, 0.0, 0.8]);
    let level = program(&robot, &request(&start, vec![line(to_pose(end), None)]));
    let stroke = &level.strokes[0];
    let from = pose(&robot, &start, &tcp()).translation.vector;
    for s in places(stroke.length()) {
        let tool = tool_at(&robot, stroke, s).translation.vector;
        let expected = from + (end.translation.vector - from) * (s / stroke.length());
        assert!((tool - expected).norm() < 1e-12);
    }
    check_derivatives(stroke, 4);
    let tilted = shifted(&robot, &start, [-0.15, 0.05, 0.05], [0.3, 0.0, 0.0]);
    let infeasible = outcome(&robot, &request(&start, vec![line(to_pose(tilted), None)]))
        .unwrap()
        .unwrap_err();
    assert_eq!(infeasible.reason, PathInfeasibleReason::OutOfReach);
    assert!(infeasible.needed > 0.2 && infeasible.needed < 0.31, "{infeasible:?}");
}
