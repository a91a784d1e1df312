//! The ends, the exact stops and the dwells: the arm is where it was sent, and rests while it should.
//!
//! Set-points at a period meet every exact stop, which is on a whole cycle; a trace meets the ends alone for certain.

use nalgebra::{Isometry3, Rotation3};
use takt_motion::path::request::{ArcOrientation, Segment, Shape, Target};
use takt_motion::plan::request::Sampling;
use takt_motion::robot::spec::RobotSpec;

use super::Case;
use super::report::{FaultKind, PathReport};
use super::samples::State;
use crate::arm::Workspace;
use crate::tolerance;

pub(super) fn check(case: &Case<'_>, spec: &RobotSpec, workspace: &mut Workspace, report: &mut PathReport) {
    durations(case, report);
    let mut state = State::default();
    case.samples.state(0, &mut state);
    for (joint, (q, start)) in state.q.iter().zip(&case.request.start).enumerate() {
        if (q - start).abs() > tolerance::ARRIVAL * start.abs().max(1.0) {
            report.fault(FaultKind::Start, joint, 0.0, *q, *start);
        }
    }
    let last = case.samples.len() - 1;
    boundary(case, 0, case.request.start_speed, report);
    boundary(case, last, case.request.end_speed, report);
    for (set_point, segment, asked) in [
        (0, case.request.segments.first(), case.request.start_speed),
        (last, case.request.segments.last(), case.request.end_speed),
    ] {
        if let (Some(segment), Some(_)) = (segment, asked) {
            steady(case, set_point, segment, workspace, report);
        }
    }
    for (index, segment) in case.request.segments.iter().enumerate() {
        let final_segment = index + 1 == case.request.segments.len();
        if segment.blend.is_some() && !final_segment {
            continue;
        }
        let end = case.plan.segments.get(index).map_or(f64::NAN, |report| report.end);
        let until = match case.plan.segments.get(index + 1) {
            Some(next) => next.begin,
            None => case.plan.duration,
        };
        if until - end < segment.dwell - tolerance::STOP_TIME {
            report.fault(FaultKind::Dwell, index, end, until - end, segment.dwell);
        }
        let Some(stop) = set_point_at(case, end) else { continue };
        case.samples.state(stop, &mut state);
        arrival(case, spec, index, segment, (end, &state), workspace, report);
        let moves_on = final_segment && case.request.end_speed.is_some();
        if !moves_on {
            rest(case, index, stop, end + segment.dwell, report);
        }
    }
}

/// The last set-point is at the end, and the end on a whole cycle where there are cycles.
fn durations(case: &Case<'_>, report: &mut PathReport) {
    let duration = case.plan.duration;
    let count = case.samples.len();
    let end = case.samples.times()[count - 1];
    if (end - duration).abs() > tolerance::EVEN_TIMES * duration {
        report.fault(FaultKind::Times, count - 1, end, end, duration);
    }
    match case.request.sampling {
        Sampling::Period(period) => {
            let whole = period * (count - 1) as f64;
            if (duration - whole).abs() > tolerance::EVEN_TIMES * duration {
                report.fault(FaultKind::WholeCycles, count - 1, duration, duration, whole);
            }
        }
        Sampling::Trace(points) if count != points => {
            report.fault(FaultKind::Lists, 0, 0.0, count as f64, points as f64);
        }
        Sampling::Trace(_) | Sampling::None => {}
    }
}

/// At rest at the ends of the path, or at the tool speed asked for; of a path that turns the tool about its centre
/// point alone, the speed of the fastest joint.
fn boundary(case: &Case<'_>, index: usize, asked: Option<f64>, report: &mut PathReport) {
    let time = case.samples.times()[index];
    let fastest = |index: usize| {
        let joints = case.samples.joints().iter();
        joints.map(|joint| joint.velocity[index].abs()).fold(0.0, f64::max)
    };
    let tool = case.samples.tool_speed()[index];
    match asked {
        None if fastest(index) == 0.0 => {}
        None => report.fault(FaultKind::Rest, index, time, fastest(index), 0.0),
        Some(speed) => {
            let misses = |found: f64| (found - speed).abs() > tolerance::BOUNDARY_SPEED * speed;
            if misses(tool) && misses(fastest(index)) {
                report.fault(FaultKind::BoundarySpeed, index, time, tool, speed);
            }
        }
    }
}

/// With jerk limits the speed at an end of the path does not change there: a joint segment is straight, so that no joint
/// accelerates; nor does the tool on a line.
fn steady(case: &Case<'_>, index: usize, segment: &Segment, workspace: &mut Workspace, report: &mut PathReport) {
    let mut joints = case.bounds.iter().flat_map(|bounds| &bounds.joints);
    if !joints.all(|joint| joint.jerk.is_some()) {
        return;
    }
    let mut state = State::default();
    case.samples.state(index, &mut state);
    let joints = case.samples.joints().iter();
    let largest = joints
        .flat_map(|joint| &joint.acceleration)
        .fold(0.0, |most: f64, rate| most.max(rate.abs()));
    let found = match &segment.shape {
        Shape::Joint { .. } => state.qdd.iter().fold(0.0, |most: f64, rate| most.max(rate.abs())),
        Shape::Line { .. } => {
            let tool = case
                .arm
                .tool_motion(workspace, &case.tool, &state.q, &state.qd, &state.qdd);
            tool.acceleration.norm()
        }
        Shape::Arc(_) | Shape::Spline(_) => return,
    };
    if found > tolerance::BOUNDARY_ACCELERATION * largest {
        let time = case.samples.times()[index];
        report.fault(FaultKind::BoundaryAcceleration, index, time, found, 0.0);
    }
}

/// The set-point at a time; `None` where there is none.
fn set_point_at(case: &Case<'_>, time: f64) -> Option<usize> {
    let times = case.samples.times();
    let place = if case.samples.step() > 0.0 {
        time / case.samples.step()
    } else {
        0.0
    };
    let index = place.round() as usize;
    // A trace meets a stop by chance, and then not to the last bit; its end it meets.
    let allowed = match case.request.sampling {
        Sampling::Period(_) => tolerance::STOP_TIME,
        Sampling::Trace(_) | Sampling::None => tolerance::EVEN_TIMES * case.plan.duration,
    };
    let near = (times.get(index)? - time).abs() <= allowed;
    near.then_some(index)
}

/// A segment that ends with a stop ends at its target.
fn arrival(
    case: &Case<'_>,
    spec: &RobotSpec,
    index: usize,
    segment: &Segment,
    (time, state): (f64, &State),
    workspace: &mut Workspace,
    report: &mut PathReport,
) {
    let (target, in_joints) = match &segment.shape {
        Shape::Joint { target } => (Some(target), true),
        Shape::Line { target } => (Some(target), false),
        Shape::Arc(arc) => (arc.target.as_ref(), false),
        Shape::Spline(spline) => (spline.points.last(), false),
    };
    let Some(target) = target else { return };
    if let (Target::Joints(joints), true) = (target, in_joints) {
        for (q, joint) in state.q.iter().zip(joints) {
            if (q - joint).abs() > tolerance::ARRIVAL * joint.abs().max(1.0) {
                report.fault(FaultKind::Target, index, time, *q, *joint);
            }
        }
        return;
    }
    let rest = vec![0.0; state.q.len()];
    let mut tool_at = |q: &[f64]| case.arm.tool_motion(workspace, &case.tool, q, &rest, &rest);
    let found = tool_at(&state.q);
    let (position, axes) = match target {
        Target::Joints(joints) => {
            let wanted = tool_at(joints);
            (wanted.position, wanted.axes)
        }
        Target::Pose { pose, frame } => {
            let pose = frame_of(spec, frame.as_deref()) * pose;
            (pose.translation.vector, pose.rotation.to_rotation_matrix().into_inner())
        }
    };
    let missed = (found.position - position).norm();
    if missed > tolerance::POSE {
        report.fault(FaultKind::Target, index, time, missed, 0.0);
    }
    // A tool that turns with an arc's tangent arrives as that has turned it.
    if matches!(&segment.shape, Shape::Arc(arc) if arc.orientation == ArcOrientation::Tangent) {
        return;
    }
    let turned = Rotation3::from_matrix_unchecked(axes.transpose() * found.axes).angle();
    // The arc cosine of the trace sees angles below the root of a rounding as none or as that; the sine sees them.
    let sine = 0.5 * (axes.transpose() * found.axes - found.axes.transpose() * axes).norm() / f64::sqrt(2.0);
    if turned > 0.1 || sine > tolerance::POSE {
        report.fault(FaultKind::Target, index, time, turned.max(sine), 0.0);
    }
}

fn frame_of(spec: &RobotSpec, name: Option<&str>) -> Isometry3<f64> {
    let named = spec.frames.iter().find(|(known, _)| Some(known.as_str()) == name);
    named.map_or_else(Isometry3::identity, |(_, pose)| *pose)
}

/// Nothing moves at a stop, nor until its dwell is over.
fn rest(case: &Case<'_>, index: usize, stop: usize, until: f64, report: &mut PathReport) {
    let times = case.samples.times();
    let slack = -tolerance::STOP_TIME;
    for (joint, columns) in case.samples.joints().iter().enumerate() {
        let fastest = columns
            .velocity
            .iter()
            .fold(0.0, |most: f64, rate| most.max(rate.abs()));
        let held = columns.position[stop];
        for (at, time) in times.iter().enumerate().skip(stop) {
            if at > stop && *time > until + slack {
                break;
            }
            let rate = columns.velocity[at].abs();
            if rate > tolerance::REST * fastest {
                report.fault(FaultKind::Rest, index, *time, rate, 0.0);
            }
            let q = columns.position[at];
            if (q - held).abs() > tolerance::ARRIVAL * held.abs().max(1.0) {
                report.fault(FaultKind::Rest, joint, *time, q, held);
            }
        }
    }
}
