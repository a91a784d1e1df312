//! What of a program can be wrong before anything is computed: lengths, ranges, numbers that are none. All findings at
//! once, each with its path as the request spells it.

use nalgebra::{Isometry3, Vector3};

use super::request::{
    Arc, Blend, Circle, Extent, PathRequest, Segment, Shape, Spline, SplineKind, Target, Timing, Weight,
};
use crate::error::Invalid;
use crate::plan::request::Sampling;
use crate::robot::Robot;
use crate::robot::bounds::{LENGTH, MAX_FINDINGS};
use crate::robot::spec::JointKind;
use crate::tolerance::{
    BEZIER_POINTS_MAX, DURATION_MAX, POSITION_MAX, SEGMENTS_MAX, SIGMOID_STEEPNESS_MAX, SPLINE_POINTS_MAX, START_SLACK,
    TARGETS_MAX,
};

/// Every finding in the geometry of a request.
pub(super) fn check(robot: &Robot, request: &PathRequest) -> Vec<Invalid> {
    let mut check = Check {
        robot,
        wrong: Vec::new(),
    };
    check.positions("start.position", &request.start, START_SLACK);
    let on_cycle = request.timing == Timing::Optimal && matches!(request.sampling, Sampling::Period(_));
    if on_cycle && request.end_speed.is_some() {
        let message = "a motion that ends at speed does not last a whole number of sample periods: ask for trace_points, \
                       or let it end at rest";
        check.add("end_speed", message.to_owned());
    }
    let count = request.segments.len();
    if count == 0 {
        check.add("segments", "a program needs at least one segment".to_owned());
    }
    if count > SEGMENTS_MAX {
        check.add("segments", format!("{count} segments, the most is {SEGMENTS_MAX}"));
        return check.wrong;
    }
    let targets: usize = request.segments.iter().map(targets_of).sum();
    if targets > TARGETS_MAX {
        check.add(
            "segments",
            format!("{targets} taught points, the most is {TARGETS_MAX}"),
        );
        return check.wrong;
    }
    for (index, segment) in request.segments.iter().enumerate() {
        if check.wrong.len() >= MAX_FINDINGS {
            break;
        }
        check.segment(&format!("segments[{index}]"), segment, index + 1 == count);
    }
    check.wrong
}

fn targets_of(segment: &Segment) -> usize {
    match &segment.shape {
        Shape::Spline(spline) => spline.points.len(),
        Shape::Joint { .. } | Shape::Line { .. } | Shape::Arc(_) => 1,
    }
}

struct Check<'a> {
    robot: &'a Robot,
    wrong: Vec<Invalid>,
}

impl Check<'_> {
    fn add(&mut self, path: &str, message: String) {
        self.wrong.push(Invalid::new(path, message));
    }

    fn segment(&mut self, path: &str, segment: &Segment, last: bool) {
        match &segment.shape {
            Shape::Joint { target } => self.target(&format!("{path}.joint.target"), target),
            Shape::Line { target } => self.target(&format!("{path}.line.target"), target),
            Shape::Arc(arc) => self.arc(&format!("{path}.arc"), arc),
            Shape::Spline(spline) => self.spline(&format!("{path}.spline"), spline),
        }
        if let Some(blend) = &segment.blend {
            self.blend(&format!("{path}.blend"), blend);
        }
        let dwell = segment.dwell;
        let path = format!("{path}.dwell_s");
        if !(dwell.is_finite() && (0.0..=DURATION_MAX).contains(&dwell)) {
            self.add(&path, format!("{dwell} s must be from 0 to {DURATION_MAX}"));
        } else if dwell > 0.0 && segment.blend.is_some() && !last {
            self.add(
                &path,
                format!("{dwell} s at rest, but the segment is blended into the next"),
            );
        }
    }

    fn target(&mut self, path: &str, target: &Target) {
        match target {
            Target::Joints(positions) => self.positions(&format!("{path}.position"), positions, 0.0),
            Target::Pose { pose, frame } => {
                self.pose(&format!("{path}.pose"), pose);
                self.frame(path, frame.as_deref());
            }
        }
    }

    /// Joint positions, at most `slack` of its range outside of it each.
    fn positions(&mut self, path: &str, positions: &[f64], slack: f64) {
        let joints = &self.robot.spec().joints;
        if positions.len() != joints.len() {
            let message = format!("{} values, the robot has {} joints", positions.len(), joints.len());
            self.wrong.push(Invalid::new(path, message));
            return;
        }
        for (index, (joint, position)) in joints.iter().zip(positions).enumerate() {
            let path = format!("{path}[{index}]");
            if !(position.is_finite() && position.abs() <= POSITION_MAX) {
                let message = format!("position {position} must be finite and at most {POSITION_MAX} either way");
                self.wrong.push(Invalid::new(path, message));
                continue;
            }
            if joint.kind == JointKind::Continuous {
                continue;
            }
            let (lower, upper) = (joint.limits.position_lower, joint.limits.position_upper);
            let slack = match (lower, upper) {
                (Some(lower), Some(upper)) => slack * (upper - lower),
                _ => 0.0,
            };
            let name = &joint.name;
            if let Some(lower) = lower
                && *position < lower - slack
            {
                let message = format!("joint \"{name}\": position {position} is below the lower limit {lower}");
                self.wrong.push(Invalid::new(path, message));
            } else if let Some(upper) = upper
                && *position > upper + slack
            {
                let message = format!("joint \"{name}\": position {position} is above the upper limit {upper}");
                self.wrong.push(Invalid::new(path, message));
            }
        }
    }

    fn pose(&mut self, path: &str, pose: &Isometry3<f64>) {
        let q = pose.rotation.coords;
        if !q.iter().all(|value| value.is_finite()) {
            self.add(path, "the orientation must be finite".to_owned());
        }
        self.vector(path, &pose.translation.vector);
    }

    /// A point or an offset.
    fn vector(&mut self, path: &str, vector: &Vector3<f64>) {
        for (index, value) in vector.iter().enumerate() {
            if let Some(fault) = LENGTH.fault(*value) {
                self.add(path, format!("coordinate {index}: {fault}"));
            }
        }
    }

    fn direction(&mut self, path: &str, direction: &Vector3<f64>) {
        let norm = direction.norm();
        if !(norm.is_finite() && norm > 0.0) {
            self.add(path, "a direction must have a positive, finite length".to_owned());
        }
    }

    fn frame(&mut self, path: &str, frame: Option<&str>) {
        let Some(wanted) = frame else { return };
        let frames = &self.robot.spec().frames;
        if frames.iter().any(|(name, _)| name == wanted) {
            return;
        }
        let names: Vec<&str> = frames.iter().map(|(name, _)| name.as_str()).collect();
        let known = if names.is_empty() {
            "the robot names none".to_owned()
        } else {
            format!("the frames are {}", names.join(", "))
        };
        let wanted: String = wanted.chars().take(64).collect();
        self.add(&format!("{path}.frame"), format!("no frame \"{wanted}\"; {known}"));
    }

    fn arc(&mut self, path: &str, arc: &Arc) {
        match &arc.circle {
            Circle::Via { point, second } => {
                self.target(&format!("{path}.via"), point);
                match (second, &arc.target) {
                    (Some(second), None) => self.target(&format!("{path}.second_via"), second),
                    (Some(_), Some(_)) => {
                        let message = "a second point is for a full circle, which has no target".to_owned();
                        self.add(&format!("{path}.second_via"), message);
                    }
                    (None, None) => {
                        let message = "a full circle through points needs a second one".to_owned();
                        self.add(&format!("{path}.second_via"), message);
                    }
                    (None, Some(_)) => {}
                }
            }
            Circle::Center {
                center, normal, frame, ..
            } => {
                self.vector(&format!("{path}.center_m"), center);
                self.frame(path, frame.as_deref());
                if let Some(normal) = normal {
                    self.direction(&format!("{path}.normal"), normal);
                } else if arc.target.is_none() {
                    self.add(
                        &format!("{path}.normal"),
                        "a full circle about a centre needs a normal".to_owned(),
                    );
                }
            }
            Circle::Radius {
                radius, normal, frame, ..
            } => {
                if !(*radius > 0.0 && *radius <= LENGTH.max()) {
                    let message = format!("{radius} m must be above 0 and at most {} m", LENGTH.max());
                    self.add(&format!("{path}.radius_m"), message);
                }
                self.direction(&format!("{path}.normal"), normal);
                self.frame(path, frame.as_deref());
                if arc.target.is_none() {
                    self.add(
                        &format!("{path}.target"),
                        "an arc by its radius needs a target".to_owned(),
                    );
                }
            }
        }
        if let Some(target) = &arc.target {
            self.target(&format!("{path}.target"), target);
        }
    }

    fn spline(&mut self, path: &str, spline: &Spline) {
        let count = spline.points.len();
        let most = match spline.kind {
            SplineKind::Bezier => BEZIER_POINTS_MAX,
            SplineKind::Quintic | SplineKind::Cubic | SplineKind::BSpline => SPLINE_POINTS_MAX,
        };
        if !(1..=most).contains(&count) {
            self.add(
                &format!("{path}.points"),
                format!("{count} points, from 1 to {most} can be had"),
            );
            return;
        }
        for (index, point) in spline.points.iter().enumerate() {
            self.target(&format!("{path}.points[{index}]"), point);
        }
    }

    fn blend(&mut self, path: &str, blend: &Blend) {
        match blend.extent {
            Extent::Radius(radius) => self.positive(&format!("{path}.radius_m"), radius, LENGTH.max()),
            Extent::Fraction(part) => {
                if !(part > 0.0 && part < 1.0) {
                    self.add(
                        &format!("{path}.fraction"),
                        format!("{part} must be above 0 and below 1"),
                    );
                }
            }
            Extent::Lengths { before, after } => {
                self.positive(&format!("{path}.before"), before, LENGTH.max());
                self.positive(&format!("{path}.after"), after, LENGTH.max());
            }
        }
        if let Weight::TanSigmoid { a } = blend.weight {
            self.positive(&format!("{path}.steepness"), a, SIGMOID_STEEPNESS_MAX);
        }
    }

    fn positive(&mut self, path: &str, value: f64, most: f64) {
        if !(value > 0.0 && value <= most) {
            self.add(path, format!("{value} must be above 0 and at most {most}"));
        }
    }
}
