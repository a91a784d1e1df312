use nalgebra::{UnitQuaternion, Vector3};

use super::support::*;
use crate::curve::{Curve, CurvePoint, Side};
use crate::kinematics::pose;
use crate::path::request::*;
use crate::robot::Robot;

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
