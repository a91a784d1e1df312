//! Real arms, short ways to write programs, and what every path must be: smooth.

use nalgebra::{Isometry3, UnitQuaternion, Vector3};

use crate::budget::Budget;
use crate::curve::{Curve, CurvePoint, Side};
use crate::kinematics::pose;
use crate::path::outcome::PathInfeasible;
use crate::path::request::*;
use crate::path::{Program, Stroke, build};
use crate::plan::Failure;
use crate::robot::Robot;
use crate::robot::description::{Description, Kinematics};
use crate::test_arms::random;

pub(super) const UR5E: &str = include_str!("../../../../tests/vectors/robots/ur5e/ur5e.urdf");
pub(super) const PANDA: &str = include_str!("../../../../tests/vectors/robots/panda/fer.urdf");

pub(super) fn robot(urdf: &str, tip_link: &str) -> Robot {
    let description = Description {
        use_urdf_dynamics: true,
        ..Description::new(Kinematics::Urdf {
            text: urdf.to_owned(),
            base_link: None,
            tip_link: Some(tip_link.to_owned()),
        })
    };
    let resolved = description.resolve().unwrap();
    Robot::new(resolved.spec, resolved.warnings).unwrap()
}

pub(super) fn ur5e() -> Robot {
    robot(UR5E, "tool0")
}

pub(super) fn tcp() -> Isometry3<f64> {
    Isometry3::new(Vector3::new(0.02, -0.01, 0.15), Vector3::new(0.1, 0.3, -0.2))
}

pub(super) fn request(start: &[f64], segments: Vec<Segment>) -> PathRequest {
    PathRequest::new(start.to_vec(), segments)
}

pub(super) fn segment(shape: Shape, blend: Option<Blend>) -> Segment {
    Segment {
        blend,
        ..Segment::new(shape)
    }
}

pub(super) fn joint(target: &[f64], blend: Option<Blend>) -> Segment {
    let target = Target::Joints(target.to_vec());
    segment(Shape::Joint { target }, blend)
}

pub(super) fn blend(extent: Extent) -> Option<Blend> {
    Some(Blend {
        extent,
        space: Space::Joint,
        weight: Weight::Smoothstep,
    })
}

pub(super) fn outcome(robot: &Robot, request: &PathRequest) -> Result<Result<Program, PathInfeasible>, Failure> {
    build(robot, &tcp(), request, &Budget::unlimited())
}

pub(super) fn program(robot: &Robot, request: &PathRequest) -> Program {
    outcome(robot, request).unwrap().unwrap()
}

pub(super) fn refused(robot: &Robot, request: &PathRequest) -> Vec<String> {
    match outcome(robot, request) {
        Err(Failure::Invalid(findings)) => findings.iter().map(ToString::to_string).collect(),
        other => panic!("should be refused: {}", other.is_ok()),
    }
}

pub(super) fn at(stroke: &Stroke, s: f64, side: Side) -> CurvePoint {
    let mut point = CurvePoint::new(stroke.joint_count());
    stroke.evaluate(s, side, &mut point);
    point
}

fn orders(point: &CurvePoint) -> [&[f64]; 4] {
    [&point.position, &point.first, &point.second, &point.third]
}

/// The largest difference between two points, by order.
fn gap(one: &CurvePoint, other: &CurvePoint) -> [f64; 4] {
    std::array::from_fn(|k| {
        let pairs = orders(one)[k].iter().zip(orders(other)[k]);
        pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
    })
}

fn size(point: &CurvePoint, order: usize) -> f64 {
    orders(point)[order].iter().map(|v| v.abs()).fold(0.0, f64::max)
}

/// Every derivative is the slope of the one before, between knots; fourth-order differences.
pub(super) fn check_derivatives(stroke: &Stroke, seed: u64) {
    let state = &mut seed.clone();
    for ends in stroke.knots().windows(2) {
        let width = ends[1] - ends[0];
        let h = 5e-4 * width;
        for _ in 0..6 {
            let s = ends[0] + width * (0.5 + 0.49 * random(state));
            let points: Vec<CurvePoint> = [-2.0, -1.0, 1.0, 2.0]
                .map(|k| at(stroke, s + k * h, Side::After))
                .into();
            let point = at(stroke, s, Side::After);
            for k in 0..3 {
                // what the difference neglects goes with the scale of the derivatives of this stretch
                let scale = 1.0
                    + (0..4)
                        .map(|k| size(&point, k) * width.powi(k as i32))
                        .fold(0.0, f64::max);
                for joint in 0..stroke.joint_count() {
                    let v = |i: usize| orders(&points[i])[k][joint];
                    let slope = (v(0) - 8.0 * v(1) + 8.0 * v(2) - v(3)) / (12.0 * h);
                    let error = (slope - orders(&point)[k + 1][joint]).abs();
                    assert!(
                        error * width.powi(k as i32 + 1) < 2e-6 * scale,
                        "order {} at {s} of {:?}: {slope} {}",
                        k + 1,
                        ends,
                        orders(&point)[k + 1][joint]
                    );
                }
            }
        }
    }
}

/// Position to third derivative, or to the second, are the same on both sides of every knot.
pub(super) fn check_continuity(stroke: &Stroke, order: usize) {
    let mut scale = [1.0f64; 4];
    for i in 0..=200 {
        let point = at(stroke, stroke.length() * f64::from(i) / 200.0, Side::After);
        for (k, scale) in scale.iter_mut().enumerate() {
            *scale = scale.max(size(&point, k));
        }
    }
    for knot in &stroke.knots()[1..stroke.knots().len() - 1] {
        let gap = gap(&at(stroke, *knot, Side::Before), &at(stroke, *knot, Side::After));
        for k in 0..=order {
            assert!(
                gap[k] < [1e-12, 1e-10, 1e-8, 1e-6][k] * scale[k],
                "order {k} at {knot}: {gap:?} {scale:?}"
            );
        }
    }
}

pub(super) fn tool_at(robot: &Robot, stroke: &Stroke, s: f64) -> Isometry3<f64> {
    pose(robot, &at(stroke, s, Side::After).position, &tcp())
}

/// The pose that is an offset and a turn away from that of some joint positions, in base-link axes.
pub(super) fn shifted(robot: &Robot, q: &[f64], by: [f64; 3], turn: [f64; 3]) -> Isometry3<f64> {
    let mut moved = pose(robot, q, &tcp());
    moved.translation.vector += Vector3::from(by);
    moved.rotation = UnitQuaternion::from_scaled_axis(Vector3::from(turn)) * moved.rotation;
    moved
}

pub(super) fn to_pose(pose: Isometry3<f64>) -> Target {
    Target::Pose { pose, frame: None }
}

pub(super) fn line(target: Target, blend: Option<Blend>) -> Segment {
    segment(Shape::Line { target }, blend)
}

pub(super) fn arc(
    circle: Circle,
    target: Option<Target>,
    orientation: ArcOrientation,
    blend: Option<Blend>,
) -> Segment {
    let arc = Arc {
        circle,
        target,
        orientation,
    };
    segment(Shape::Arc(arc), blend)
}

pub(super) fn tool_blend(extent: Extent) -> Option<Blend> {
    Some(Blend {
        extent,
        space: Space::Tool,
        weight: Weight::Smoothstep,
    })
}

/// Joint positions in the middle of a UR's work.
pub(super) const READY: [f64; 6] = [0.1, -1.4, 1.6, -1.7, -1.5, 0.3];

/// Places on a stroke, its ends among them.
pub(super) fn places(length: f64) -> impl Iterator<Item = f64> {
    (0..=97).map(move |i| length * f64::from(i) / 97.0)
}
