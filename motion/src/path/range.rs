//! Whether a path keeps every joint within its range, everywhere.
//!
//! Between two samples a joint is taken for the cubic Hermite polynomial of its positions and slopes; where that comes near
//! the end of the range, the true extreme is sought.

use super::fault::{Fault, infeasible};
use super::outcome::{PathInfeasible, PathInfeasibleReason};
use super::pace::golden;
use super::request::PathRequest;
use super::stroke::Stroke;
use crate::budget::Budget;
use crate::curve::{Curve, CurvePoint, Side};
use crate::plan::request::LimitOverride;
use crate::robot::Robot;
use crate::robot::spec::{JointKind, JointSpec};
use crate::tolerance::{BISECTIONS, GOLDEN_ROUNDS, RANGE_NEAR, RANGE_ROUNDING, RANGE_SAMPLES};

/// The ranges in force.
#[derive(Debug)]
pub(super) struct Ranges<'a> {
    robot: &'a Robot,
    request: &'a PathRequest,
    /// Of the whole path: lower and upper end of each joint.
    path: Vec<[f64; 2]>,
}

impl<'a> Ranges<'a> {
    /// Those of the robot, tightened by the request. A start outside of its range widens it up to there.
    pub(super) fn new(robot: &'a Robot, request: &'a PathRequest) -> Self {
        let mut path: Vec<[f64; 2]> = robot.spec().joints.iter().map(range_of).collect();
        tighten(robot, &mut path, &request.limits);
        for (range, start) in path.iter_mut().zip(&request.start) {
            *range = [range[0].min(*start), range[1].max(*start)];
        }
        Self { robot, request, path }
    }

    /// The ranges on one segment.
    fn on(&self, segment: usize) -> Vec<[f64; 2]> {
        let mut ranges = self.path.clone();
        if let Some(segment) = self.request.segments.get(segment) {
            tighten(self.robot, &mut ranges, &segment.limits);
        }
        ranges
    }

    /// Looks at a whole stroke.
    pub(super) fn check(&self, stroke: &Stroke, budget: &Budget<'_>) -> Result<(), Fault> {
        let mut points = [
            CurvePoint::new(stroke.joint_count()),
            CurvePoint::new(stroke.joint_count()),
        ];
        let mut on = None;
        for ends in stroke.knots().windows(2) {
            budget.check()?;
            let step = (ends[1] - ends[0]) / RANGE_SAMPLES as f64;
            stroke.evaluate(ends[0], Side::After, &mut points[0]);
            for i in 0..RANGE_SAMPLES {
                let (low, high) = (ends[0] + step * i as f64, ends[0] + step * (i + 1) as f64);
                stroke.evaluate(high, Side::Before, &mut points[1]);
                let segment = stroke.location(0.5 * (low + high)).segment;
                if on.as_ref().is_none_or(|(known, _)| *known != segment) {
                    on = Some((segment, self.on(segment)));
                }
                if let Some((_, ranges)) = &on {
                    for (joint, range) in ranges.iter().enumerate() {
                        if let Some(excess) = look(stroke, joint, *range, low, high, &points) {
                            return Err(excess.evidence(self.robot, stroke).into());
                        }
                    }
                }
                points.swap(0, 1);
            }
        }
        Ok(())
    }
}

fn range_of(joint: &JointSpec) -> [f64; 2] {
    let limited = joint.kind != JointKind::Continuous;
    [
        joint
            .limits
            .position_lower
            .filter(|_| limited)
            .unwrap_or(f64::NEG_INFINITY),
        joint.limits.position_upper.filter(|_| limited).unwrap_or(f64::INFINITY),
    ]
}

fn tighten(robot: &Robot, ranges: &mut [[f64; 2]], limits: &[LimitOverride]) {
    for (joint, range) in robot.spec().joints.iter().zip(ranges) {
        for limit in limits.iter().filter(|limit| limit.joint == joint.name) {
            range[0] = limit.position_lower.map_or(range[0], |lower| lower.max(range[0]));
            range[1] = limit.position_upper.map_or(range[1], |upper| upper.min(range[1]));
        }
    }
}

/// A joint outside its range.
struct Excess {
    joint: usize,
    /// The furthest that it goes, near there.
    needed: f64,
    available: f64,
    /// Inside still, and outside, in s.
    inside: f64,
    outside: f64,
}

/// Looks at one joint between two samples.
fn look(
    stroke: &Stroke,
    joint: usize,
    range: [f64; 2],
    low: f64,
    high: f64,
    points: &[CurvePoint; 2],
) -> Option<Excess> {
    let width = high - low;
    let [start, end] = [0, 1].map(|i: usize| (points[i].position[joint], points[i].first[joint] * width));
    for (bound, sign) in [(range[0], -1.0), (range[1], 1.0)] {
        if !bound.is_finite() {
            continue;
        }
        // an upper bound on what the cubic reaches: its control points
        let control = [start.0, start.0 + start.1 / 3.0, end.0 - end.1 / 3.0, end.0];
        let reach = control
            .iter()
            .map(|q| sign * (q - bound))
            .fold(f64::NEG_INFINITY, f64::max);
        if reach < -RANGE_NEAR {
            continue;
        }
        let mut point = CurvePoint::new(stroke.joint_count());
        let mut inward = |s: f64| {
            stroke.evaluate(s, Side::After, &mut point);
            sign * (bound - point.position[joint])
        };
        let (mut least, mut place) = golden(&mut inward, low, high, GOLDEN_ROUNDS);
        for (q, s) in [(start.0, low), (end.0, high)] {
            if sign * (bound - q) < least {
                (least, place) = (sign * (bound - q), s);
            }
        }
        if least < -RANGE_ROUNDING {
            return Some(Excess {
                joint,
                needed: bound - sign * least,
                available: bound,
                inside: low,
                outside: place,
            });
        }
    }
    None
}

impl Excess {
    /// With the place where the range is left.
    fn evidence(&self, robot: &Robot, stroke: &Stroke) -> PathInfeasible {
        let mut point = CurvePoint::new(stroke.joint_count());
        let (mut inside, mut outside) = (self.inside, self.outside);
        for _ in 0..BISECTIONS {
            let middle = 0.5 * (inside + outside);
            stroke.evaluate(middle, Side::After, &mut point);
            let beyond = (point.position[self.joint] - self.available) * (self.needed - self.available) > 0.0;
            if beyond {
                outside = middle;
            } else {
                inside = middle;
            }
        }
        let location = stroke.location(inside);
        let name = &robot.spec().joints[self.joint].name;
        let suggestion = format!(
            "joint \"{name}\" would have to go to {:.6}, its range ends at {:.6}; start in another arm configuration, or \
             turn the tool",
            self.needed, self.available
        );
        PathInfeasible {
            joint: Some(self.joint),
            needed: self.needed,
            available: self.available,
            reachable_fraction: Some(location.fraction),
            ..infeasible(PathInfeasibleReason::JointRange, location, suggestion)
        }
    }
}
