//! The margins of a trajectory that somebody else made.

mod roots;

use super::Failure;
use super::margin;
use super::outcome::{CheckReport, LimitKind, LimitUse, OverrideSafety, Phase};
use super::problem::{JointLimit, check_length, check_part, limits_in_force};
use super::request::{CheckRequest, Interpolation, TrajectoryPoint};
use crate::budget::Budget;
use crate::error::Invalid;
use crate::robot::Robot;
use crate::tolerance::{CHECK_EXCESS, POINT_SPACING_MIN, POSITION_MAX, TRAJECTORY_POINTS_MAX, TRAJECTORY_TRAVEL_MAX};
use crate::trajectory::{Polynomial, Trajectory, evaluate};
use crate::verify::{JointDemand, Verification, Verifier};
use roots::{derivative, roots};

/// Segments verified at once: it bounds the scratch memory.
const SEGMENTS_AT_ONCE: usize = 256;

/// Joints that turn round within this part of a segment turn round together.
const CUT_APART: f64 = 1.0e-9;

/// Largest velocity, acceleration or jerk of a trajectory that is worth computing with, in rad or m and s.
const RATE_MAX: f64 = 1.0e9;

/// Finds the margins of a trajectory against a robot's limits.
///
/// # Errors
/// A request that is wrong, or a budget that ended. A broken limit is not an error: the report says so.
pub fn check_trajectory(robot: &Robot, request: &CheckRequest, budget: &Budget<'_>) -> Result<CheckReport, Failure> {
    let mut wrong = Vec::new();
    check_part("torque_utilization", request.torque_utilization, &mut wrong);
    let limits = limits_in_force(robot, &request.limits, request.torque_utilization, &mut wrong);
    let interpolation = check_points(robot, &request.points, request.interpolation, &mut wrong);
    let (Some(interpolation), true) = (interpolation, wrong.is_empty()) else {
        return Err(Failure::Invalid(wrong));
    };
    let robot = &request
        .payload
        .as_ref()
        .map_or_else(|| robot.clone(), |payload| robot.with_payload(payload));
    let points = &request.points;
    let (first, last) = (&points[0], &points[points.len() - 1]);
    let duration = last.time - first.time;
    let cycle_time = request.cycle_time.unwrap_or(duration);
    if !(cycle_time.is_finite() && cycle_time >= duration) {
        let message = format!("{cycle_time} s is shorter than the trajectory, which takes {duration} s");
        return Err(Failure::invalid("cycle_time_s", message));
    }
    let motion = interpolate(points, interpolation);
    check_travel(points, &motion)?;
    let torque_limits: Vec<Option<f64>> = limits.iter().map(|limit| limit.torque).collect();
    let verification = verify(robot, &torque_limits, &motion, budget)?;
    let mut limit_uses = limit_uses(&limits, &motion, &verification, interpolation);
    limit_uses.sort_by(|a, b| b.closeness().total_cmp(&a.closeness()));
    Ok(CheckReport {
        holds: limit_uses.iter().all(|used| used.excess <= CHECK_EXCESS),
        duration,
        torque_margins: margin::of_demands(
            robot,
            &torque_limits,
            &verification,
            duration,
            cycle_time,
            &[(duration, &last.position)],
            |joint, demand| phase(&motion, joint, demand),
        ),
        limit_uses,
        override_safe: verification.override_safe,
        warnings: warnings(robot, points, interpolation, &limits),
        interpolation,
    })
}

/// The motion that a trajectory made elsewhere means.
pub(crate) fn read_trajectory(
    robot: &Robot,
    points: &[TrajectoryPoint],
    interpolation: Option<Interpolation>,
) -> Result<Trajectory, Failure> {
    let mut wrong = Vec::new();
    let interpolation = check_points(robot, points, interpolation, &mut wrong);
    let (Some(interpolation), true) = (interpolation, wrong.is_empty()) else {
        return Err(Failure::Invalid(wrong));
    };
    let motion = interpolate(points, interpolation);
    check_travel(points, &motion)?;
    Ok(motion)
}

/// Checks the points of a trajectory, and settles how to read between them.
fn check_points(
    robot: &Robot,
    points: &[TrajectoryPoint],
    interpolation: Option<Interpolation>,
    wrong: &mut Vec<Invalid>,
) -> Option<Interpolation> {
    if !(2..=TRAJECTORY_POINTS_MAX).contains(&points.len()) {
        let message = format!(
            "{} points, a trajectory has from 2 to {TRAJECTORY_POINTS_MAX}",
            points.len()
        );
        wrong.push(Invalid::new("trajectory.points", message));
        return None;
    }
    let all = |given: &dyn Fn(&TrajectoryPoint) -> bool| points.iter().all(given);
    let with_velocity = all(&|point| !point.velocity.is_empty());
    let with_acceleration = with_velocity && all(&|point| !point.acceleration.is_empty());
    let interpolation = interpolation.or(match (with_velocity, with_acceleration) {
        (true, true) => Some(Interpolation::Quintic),
        (true, false) => Some(Interpolation::Cubic),
        (false, _) => None,
    });
    let Some(interpolation) = interpolation else {
        let message = "the points have no velocities, so what runs between them is not known: give velocities (and \
                       accelerations), or say LINEAR";
        wrong.push(Invalid::new("trajectory.interpolation", message));
        return None;
    };
    let mut before = None;
    for (index, point) in points.iter().enumerate() {
        check_point(robot, index, point, interpolation, before, wrong);
        before = Some(point.time).filter(|time| time.is_finite()).or(before);
        if wrong.len() >= FINDINGS_MAX {
            break;
        }
    }
    Some(interpolation)
}

/// Findings after which no more points are looked at.
const FINDINGS_MAX: usize = 32;

fn check_point(
    robot: &Robot,
    index: usize,
    point: &TrajectoryPoint,
    interpolation: Interpolation,
    before: Option<f64>,
    wrong: &mut Vec<Invalid>,
) {
    let path = format!("trajectory.points[{index}]");
    let time = point.time;
    if !(time.is_finite() && time >= 0.0) {
        wrong.push(Invalid::new(
            format!("{path}.time_s"),
            format!("{time} must be finite and at least 0"),
        ));
    } else if let Some(before) = before
        && time < before + POINT_SPACING_MIN
    {
        let message = format!("{time} must be at least {POINT_SPACING_MIN} s after the point before, at {before}");
        wrong.push(Invalid::new(format!("{path}.time_s"), message));
    }
    let columns = [
        ("position", &point.position, true, POSITION_MAX),
        (
            "velocity",
            &point.velocity,
            interpolation != Interpolation::Linear,
            RATE_MAX,
        ),
        (
            "acceleration",
            &point.acceleration,
            interpolation == Interpolation::Quintic,
            RATE_MAX,
        ),
    ];
    for (field, values, needed, most) in columns {
        let path = format!("{path}.{field}");
        if needed || !values.is_empty() {
            check_length(&path, values.len(), robot.joint_count(), wrong);
        }
        for (joint, value) in values.iter().enumerate() {
            if !(value.is_finite() && value.abs() <= most) {
                let message = format!("{value} must be finite and at most {most} either way");
                wrong.push(Invalid::new(format!("{path}[{joint}]"), message));
            }
        }
    }
}

/// The motion through points, with a segment's end wherever a joint turns round.
fn interpolate(points: &[TrajectoryPoint], interpolation: Interpolation) -> Trajectory {
    let joint_count = points[0].position.len();
    let begin = points[0].time;
    let mut times = vec![0.0];
    let mut polynomials: Vec<Polynomial> = Vec::new();
    for ends in points.windows(2) {
        let (from, to) = (ends[0].time - begin, ends[1].time - begin);
        let span = to - from;
        let whole: Vec<Polynomial> = (0..joint_count)
            .map(|joint| hermite(&ends[0], &ends[1], joint, span, interpolation))
            .collect();
        let mut cuts: Vec<f64> = whole.iter().flat_map(|p| roots(&derivative(p), 0.0, span)).collect();
        let apart = span * CUT_APART;
        cuts.retain(|cut| *cut > apart && *cut < span - apart);
        cuts.sort_by(f64::total_cmp);
        cuts.dedup_by(|later, earlier| *later - *earlier <= apart);
        let mut since = 0.0;
        for cut in cuts {
            polynomials.extend(whole.iter().map(|p| shifted(p, since)));
            times.push(from + cut);
            since = cut;
        }
        polynomials.extend(whole.iter().map(|p| shifted(p, since)));
        times.push(to);
    }
    Trajectory::new(joint_count, times, polynomials)
}

/// Bounds the samples that a trajectory needs: velocities between points may take it farther than the points are apart.
fn check_travel(points: &[TrajectoryPoint], motion: &Trajectory) -> Result<(), Failure> {
    let mut travel = 0.0;
    for (segment, ends) in motion.times().windows(2).enumerate() {
        // joints do not turn round within a segment
        travel += motion
            .segment(segment)
            .iter()
            .map(|p| (evaluate(p, ends[1] - ends[0]).position - p[0]).abs())
            .sum::<f64>();
        // not a number counts as too far
        if travel.is_nan() || travel > TRAJECTORY_TRAVEL_MAX {
            let time = points[0].time + ends[0];
            let next = points.partition_point(|point| point.time <= time).min(points.len() - 1);
            let message = format!("up to here the joints travel more than {TRAJECTORY_TRAVEL_MAX} rad or m in all");
            return Err(Failure::invalid(&format!("trajectory.points[{next}]"), message));
        }
    }
    Ok(())
}

/// The polynomial between two points.
fn hermite(
    from: &TrajectoryPoint,
    to: &TrajectoryPoint,
    joint: usize,
    h: f64,
    interpolation: Interpolation,
) -> Polynomial {
    let (p0, p1) = (from.position[joint], to.position[joint]);
    let rise = p1 - p0;
    match interpolation {
        Interpolation::Linear => [p0, rise / h, 0.0, 0.0, 0.0, 0.0],
        Interpolation::Cubic => {
            let (v0, v1) = (from.velocity[joint], to.velocity[joint]);
            let square = (3.0 * rise / h - 2.0 * v0 - v1) / h;
            let cube = (v0 + v1 - 2.0 * rise / h) / (h * h);
            [p0, v0, square, cube, 0.0, 0.0]
        }
        Interpolation::Quintic => {
            let (v0, v1) = (from.velocity[joint], to.velocity[joint]);
            let (a0, a1) = (from.acceleration[joint], to.acceleration[joint]);
            // what is left for the three highest powers at the end of the segment
            let d = (rise - v0 * h - 0.5 * a0 * h * h) / (h * h * h);
            let v = (v1 - v0 - a0 * h) / (h * h);
            let a = (a1 - a0) / h;
            [
                p0,
                v0,
                0.5 * a0,
                10.0 * d - 4.0 * v + 0.5 * a,
                (-15.0 * d + 7.0 * v - a) / h,
                (6.0 * d - 3.0 * v + 0.5 * a) / (h * h),
            ]
        }
    }
}

/// The same polynomial in the time since `by`.
fn shifted(p: &Polynomial, by: f64) -> Polynomial {
    let mut q = *p;
    for start in 0..q.len() {
        for k in (start..q.len() - 1).rev() {
            q[k] += by * q[k + 1];
        }
    }
    q
}

/// Verifies a long motion piece by piece.
fn verify(
    robot: &Robot,
    limits: &[Option<f64>],
    motion: &Trajectory,
    budget: &Budget<'_>,
) -> Result<Verification, Failure> {
    let mut verifier = Verifier::default();
    let mut whole = Verification::at_rest(motion.joint_count());
    for first in (0..motion.segment_count()).step_by(SEGMENTS_AT_ONCE) {
        budget.check()?;
        let piece = motion.piece(first, SEGMENTS_AT_ONCE);
        let begin = motion.times()[first];
        let found = verifier.verify(robot.chain(), robot.drives(), limits, &piece);
        for (whole, found) in whole.joints.iter_mut().zip(found.joints) {
            whole.join(&found, begin, first);
        }
        whole.override_safe = tighter(whole.override_safe, found.override_safe.map(|found| found.later(begin)));
    }
    Ok(whole)
}

impl JointDemand {
    /// Takes in what a later piece of the same motion asks.
    fn join(&mut self, piece: &Self, begin: f64, first_segment: usize) {
        if piece.peak_torque.abs() > self.peak_torque.abs() {
            self.peak_torque = piece.peak_torque;
            self.time = begin + piece.time;
            self.segment = first_segment + piece.segment;
        }
        self.torque_squared += piece.torque_squared;
        self.peak_velocity = self.peak_velocity.max(piece.peak_velocity);
        self.peak_power = self.peak_power.max(piece.peak_power);
    }
}

impl OverrideSafety {
    fn later(mut self, by: f64) -> Self {
        self.time += by;
        self
    }
}

fn tighter(a: Option<OverrideSafety>, b: Option<OverrideSafety>) -> Option<OverrideSafety> {
    let use_of = |safety: &OverrideSafety| safety.torque.abs() / safety.limit;
    match (a, b) {
        (Some(a), Some(b)) => Some(if use_of(&b) > use_of(&a) { b } else { a }),
        (a, b) => a.or(b),
    }
}

/// Whether a joint speeds up or slows down where its torque is largest.
fn phase(motion: &Trajectory, joint: usize, demand: &JointDemand) -> Phase {
    let at = evaluate(
        &motion.segment(demand.segment)[joint],
        demand.time - motion.times()[demand.segment],
    );
    let growth = at.velocity * at.acceleration;
    if growth > 0.0 {
        return Phase::Acceleration;
    }
    if growth < 0.0 {
        return Phase::Deceleration;
    }
    if at.velocity != 0.0 {
        return Phase::Cruise;
    }
    if at.acceleration != 0.0 {
        return Phase::Acceleration;
    }
    Phase::Hold
}

/// The tightest moment of every known limit.
fn limit_uses(
    limits: &[JointLimit],
    motion: &Trajectory,
    verification: &Verification,
    interpolation: Interpolation,
) -> Vec<LimitUse> {
    let mut uses = Vec::new();
    for (joint, limit) in limits.iter().enumerate() {
        let demand = &verification.joints[joint];
        let bounded = |kind, value: f64, time, limit: Option<f64>| {
            limit.map(|limit| LimitUse {
                kind,
                joint,
                value,
                limit,
                time,
                excess: (value.abs() / limit - 1.0).max(0.0),
            })
        };
        uses.extend(bounded(
            LimitKind::Torque,
            demand.peak_torque,
            demand.time,
            limit.torque,
        ));
        let rates = RateExtremes::of(motion, joint);
        let velocity = limit.velocity.is_finite().then_some(limit.velocity);
        uses.extend(bounded(
            LimitKind::Velocity,
            rates.velocity.0,
            rates.velocity.1,
            velocity,
        ));
        if interpolation != Interpolation::Linear {
            let (up, down, jerk) = (rates.acceleration, rates.deceleration, rates.jerk);
            uses.extend(bounded(LimitKind::Acceleration, up.0, up.1, limit.acceleration));
            uses.extend(bounded(LimitKind::Deceleration, down.0, down.1, limit.deceleration));
            uses.extend(bounded(LimitKind::Jerk, jerk.0, jerk.1, limit.jerk));
        }
        let range = match (limit.position_lower, limit.position_upper) {
            (Some(lower), Some(upper)) if upper > lower => upper - lower,
            _ => 1.0,
        };
        let ranged = |kind, (value, time): (f64, f64), limit: Option<f64>, outward: f64| {
            limit.map(|limit| LimitUse {
                kind,
                joint,
                value,
                limit,
                time,
                excess: (outward * (value - limit) / range).max(0.0),
            })
        };
        uses.extend(ranged(
            LimitKind::PositionLower,
            rates.lowest,
            limit.position_lower,
            -1.0,
        ));
        uses.extend(ranged(
            LimitKind::PositionUpper,
            rates.highest,
            limit.position_upper,
            1.0,
        ));
    }
    uses
}

impl LimitUse {
    /// How close a value is to its limit: 0 on it, negative inside, positive beyond, relative.
    fn closeness(&self) -> f64 {
        match self.kind {
            LimitKind::PositionLower => self.limit - self.value,
            LimitKind::PositionUpper => self.value - self.limit,
            _ => self.value.abs() / self.limit - 1.0,
        }
    }
}

/// Extremes of one joint's rates and positions: value and time. They are found exactly, at roots of derivatives.
#[derive(Debug, Clone, Copy)]
struct RateExtremes {
    velocity: (f64, f64),
    acceleration: (f64, f64),
    deceleration: (f64, f64),
    jerk: (f64, f64),
    lowest: (f64, f64),
    highest: (f64, f64),
}

impl RateExtremes {
    fn of(motion: &Trajectory, joint: usize) -> Self {
        let mut found = Self {
            velocity: (0.0, 0.0),
            acceleration: (0.0, 0.0),
            deceleration: (0.0, 0.0),
            jerk: (0.0, 0.0),
            lowest: (f64::INFINITY, 0.0),
            highest: (f64::NEG_INFINITY, 0.0),
        };
        for (segment, ends) in motion.times().windows(2).enumerate() {
            let span = ends[1] - ends[0];
            let position = motion.segment(segment)[joint];
            let velocity = derivative(&position);
            let acceleration = derivative(&velocity);
            let jerk = derivative(&acceleration);
            let snap = derivative(&jerk);
            let direction = evaluate(&position, 0.5 * span).velocity;
            let moments = [0.0, span]
                .into_iter()
                .chain(roots(&acceleration, 0.0, span))
                .chain(roots(&jerk, 0.0, span))
                .chain(roots(&snap, 0.0, span));
            for moment in moments {
                let at = evaluate(&position, moment);
                let time = ends[0] + moment;
                let larger = |slot: &mut (f64, f64), value: f64| {
                    if value.abs() > slot.0.abs() {
                        *slot = (value, time);
                    }
                };
                larger(&mut found.velocity, at.velocity);
                larger(&mut found.jerk, evaluate(&acceleration, moment).velocity);
                let slows_down = at.acceleration * direction < 0.0;
                let slot = if slows_down {
                    &mut found.deceleration
                } else {
                    &mut found.acceleration
                };
                larger(slot, at.acceleration);
                if at.position < found.lowest.0 {
                    found.lowest = (at.position, time);
                }
                if at.position > found.highest.0 {
                    found.highest = (at.position, time);
                }
            }
        }
        found
    }
}

fn warnings(
    robot: &Robot,
    points: &[TrajectoryPoint],
    interpolation: Interpolation,
    limits: &[JointLimit],
) -> Vec<String> {
    let mut warnings = Vec::new();
    let joints = &robot.spec().joints;
    let unchecked: Vec<&str> = joints
        .iter()
        .zip(limits)
        .filter(|(_, limit)| limit.torque.is_none())
        .map(|(joint, _)| joint.name.as_str())
        .collect();
    if !unchecked.is_empty() {
        warnings.push(format!(
            "peak torque unknown, torque not checked: {}",
            unchecked.join(", ")
        ));
    }
    if interpolation == Interpolation::Linear {
        warnings.push(
            "linear interpolation jumps in velocity at every point: torques are those between the points, accelerations \
             and jerks are not checked"
                .to_owned(),
        );
        return warnings;
    }
    for (point, end) in [(&points[0], "starts"), (&points[points.len() - 1], "ends")] {
        if point.velocity.iter().any(|velocity| *velocity != 0.0) {
            warnings.push(format!("the trajectory {end} while it moves"));
        }
    }
    warnings
}

#[cfg(test)]
mod tests;
