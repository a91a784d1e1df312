use nalgebra::{UnitQuaternion, Vector3};

use super::support::*;
use crate::curve::{Curve, CurvePoint, Side};
use crate::kinematics::pose;
use crate::path::outcome::PathInfeasibleReason;
use crate::path::request::*;
use crate::robot::Robot;
use crate::test_arms::{random, values};

/// Places on a stroke, its ends among them.
fn places(length: f64) -> impl Iterator<Item = f64> {
    (0..=97).map(move |i| length * f64::from(i) / 97.0)
}

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

/// p′, p″, p‴ of the tool agree with the curve that the joints were made to follow.
#[test]
fn forward_kinematics_gives_the_curve_back() {
    let robot = ur5e();
    let via = to_pose(shifted(&robot, &READY, [0.05, 0.1, 0.0], [0.0; 3]));
    let end = to_pose(shifted(&robot, &READY, [0.1, 0.0, 0.05], [0.3, 0.0, 0.2]));
    let circle = Circle::Via {
        point: via,
        second: None,
    };
    let segments = vec![arc(circle, Some(end), ArcOrientation::Interpolated, None)];
    let program = program(&robot, &request(&READY, segments));
    let stroke = &program.strokes[0];
    let way = program.tool_lengths[0];
    let pace = way / stroke.length();
    let mut point = CurvePoint::new(6);
    for s in places(stroke.length()) {
        stroke.evaluate(s, Side::After, &mut point);
        let tool = stroke.tool(&point);
        // at constant speed on a circle: |p′| = σ, p″ ⟂ p′, |p″| = σ²/r, p‴ = −σ²/r²·p′
        assert!((tool.first.norm() - pace).abs() < 1e-12);
        assert!(tool.first.dot(&tool.second).abs() < 1e-10);
        let radius = pace * pace / tool.second.norm();
        let square = (pace / radius).powi(2);
        assert!(
            (tool.third + tool.first * square).norm() < 1e-9 * (1.0 + tool.third.norm()),
            "{s}"
        );
    }
}

fn check_arc(robot: &Robot, segments: Segment, center: Vector3<f64>, normal: Vector3<f64>, sweep: f64) {
    let program = program(robot, &request(&READY, vec![segments]));
    let stroke = &program.strokes[0];
    let start = pose(robot, &READY, &tcp()).translation.vector;
    let radius = (start - center).norm();
    for s in places(stroke.length()) {
        let to = tool_at(robot, stroke, s).translation.vector - center;
        assert!((to.norm() - radius).abs() < 1e-12, "{}", to.norm() - radius);
        assert!(to.dot(&normal).abs() < 1e-12);
        let turn = UnitQuaternion::from_scaled_axis(normal * (sweep * s / stroke.length()));
        assert!((turn * (start - center) - to).norm() < 1e-12);
    }
    assert!((program.tool_lengths[0] - radius * sweep).abs() < 1e-12);
    check_derivatives(stroke, 2);
}

#[test]
fn arcs_are_round_however_they_are_given() {
    let robot = ur5e();
    let start = pose(&robot, &READY, &tcp()).translation.vector;
    let normal = Vector3::new(0.2, -0.1, 1.0).normalize();
    let radial = normal.cross(&Vector3::x()).normalize() * 0.08;
    let center = start - radial;
    let point = |angle: f64| center + UnitQuaternion::from_scaled_axis(normal * angle) * radial;
    let taught = |angle: f64| {
        let by = point(angle) - start;
        to_pose(shifted(&robot, &READY, by.into(), [0.0; 3]))
    };
    for sweep in [1.0, 2.5, 4.0, 5.5] {
        let via = Circle::Via {
            point: taught(0.4 * sweep),
            second: None,
        };
        let about = Circle::Center {
            center,
            normal: Some(normal * 3.0),
            long_way: false,
            frame: None,
        };
        let radius = Circle::Radius {
            radius: 0.08,
            normal,
            long_way: sweep > std::f64::consts::PI,
            frame: None,
        };
        for circle in [via, about, radius] {
            let segment = arc(circle, Some(taught(sweep)), ArcOrientation::Interpolated, None);
            check_arc(&robot, segment, center, normal, sweep);
        }
    }
    let full = Circle::Center {
        center,
        normal: Some(normal),
        long_way: false,
        frame: None,
    };
    let through = Circle::Via {
        point: taught(1.0),
        second: Some(taught(2.0)),
    };
    for circle in [full, through] {
        let segment = arc(circle, None, ArcOrientation::Interpolated, None);
        check_arc(&robot, segment, center, normal, std::f64::consts::TAU);
    }
}

#[test]
fn with_the_tangent_the_tool_keeps_its_angle_to_the_way() {
    let robot = ur5e();
    let start = pose(&robot, &READY, &tcp());
    let circle = Circle::Center {
        center: start.translation.vector + Vector3::new(0.0, 0.07, 0.0),
        normal: Some(Vector3::z()),
        long_way: false,
        frame: None,
    };
    let target = to_pose(shifted(&robot, &READY, [0.07, 0.07, 0.0], [0.0; 3]));
    let segment = arc(circle, Some(target), ArcOrientation::Tangent, None);
    let program = program(&robot, &request(&READY, vec![segment]));
    let stroke = &program.strokes[0];
    let mut point = CurvePoint::new(6);
    let mut first = None;
    for s in places(stroke.length()) {
        stroke.evaluate(s, Side::After, &mut point);
        let tangent = stroke.tool(&point).first.normalize();
        let seen = tool_at(&robot, stroke, s).rotation.inverse() * tangent;
        let first = *first.get_or_insert(seen);
        assert!((seen - first).norm() < 1e-11);
    }
}

#[test]
fn a_taught_frame_carries_its_poses() {
    let mut spec = ur5e().spec().clone();
    let frame = nalgebra::Isometry3::new(Vector3::new(0.3, -0.2, 0.1), Vector3::new(0.0, 0.0, 0.7));
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

#[test]
fn a_wrong_arc_is_named_where_it_is_wrong() {
    let robot = ur5e();
    let taught = |by: f64| to_pose(shifted(&robot, &READY, [by, 0.0, 0.0], [0.0; 3]));
    let circle = Circle::Via {
        point: taught(0.05),
        second: None,
    };
    let segment = arc(circle, Some(taught(0.1)), ArcOrientation::Interpolated, None);
    let finding = &refused(&robot, &request(&READY, vec![segment]))[0];
    assert_eq!(
        finding,
        "segments[0].arc.via: start, via point and end lie on one line, or two of them coincide"
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
        let robot = Robot::new(crate::test_arms::random_arm(6, seed), Vec::new()).unwrap();
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
