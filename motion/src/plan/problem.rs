//! A request checked against its robot: every limit in force, or every reason why not.

use super::Failure;
use super::request::{LimitOverride, MoveRequest, Sampling};
use crate::error::Invalid;
use crate::robot::spec::{Inertial, JointKind};
use crate::robot::{Preset, Robot};
use crate::tolerance::{POSITION_MAX, SETPOINTS_MAX, START_SLACK, TRAVEL_MAX, TRAVEL_MIN};

/// A move with everything that bounds it. Vectors have one entry a joint.
#[derive(Debug)]
pub(super) struct Problem {
    /// With the payload of this move.
    pub(super) robot: Robot,
    pub(super) start: Vec<f64>,
    pub(super) displacement: Vec<f64>,
    pub(super) limits: Vec<JointLimit>,
    pub(super) presets: Vec<Option<Preset>>,
    pub(super) warnings: Vec<String>,
}

/// The limits in force for one joint.
#[derive(Debug, Clone, Copy)]
pub(crate) struct JointLimit {
    /// `None`: unknown, not checked.
    pub(crate) torque: Option<f64>,
    /// Largest speed of this move; infinite only where the joint stands still.
    pub(crate) velocity: f64,
    pub(crate) acceleration: Option<f64>,
    pub(crate) deceleration: Option<f64>,
    pub(crate) jerk: Option<f64>,
    pub(crate) position_lower: Option<f64>,
    pub(crate) position_upper: Option<f64>,
}

impl Problem {
    /// Checks a request against its robot.
    pub(super) fn new(robot: &Robot, request: &MoveRequest) -> Result<Self, Failure> {
        let mut wrong = Vec::new();
        let count = robot.joint_count();
        check_positions(robot, "start.position", &request.start, &mut wrong);
        check_positions(robot, "target.position", &request.target, &mut wrong);
        if let Some(velocity) = &request.target_velocity {
            check_length("target_velocity", velocity.len(), count, &mut wrong);
        }
        check_part("torque_utilization", request.torque_utilization, &mut wrong);
        check_part("speed_scale", request.speed_scale, &mut wrong);
        check_sampling(request.sampling, &mut wrong);
        if let Some(cycle) = request.cycle_time {
            check_positive("cycle_time_s", cycle, &mut wrong);
        }
        let limits = limits_in_force(robot, &request.limits, request.torque_utilization, &mut wrong);
        if !wrong.is_empty() {
            return Err(Failure::Invalid(wrong));
        }
        let mut problem = Self {
            robot: request
                .payload
                .as_ref()
                .map_or_else(|| robot.clone(), |payload: &Inertial| robot.with_payload(payload)),
            start: request.start.clone(),
            displacement: request.target.iter().zip(&request.start).map(|(t, s)| t - s).collect(),
            presets: (0..count).map(|joint| robot.preset(joint)).collect(),
            limits,
            warnings: Vec::new(),
        };
        problem.check_ranges(&request.target, &mut wrong);
        problem.set_speeds(request, &mut wrong);
        problem.check_bounded(&mut wrong);
        if !wrong.is_empty() {
            return Err(Failure::Invalid(wrong));
        }
        problem.warn();
        Ok(problem)
    }

    /// Whether a joint moves.
    pub(super) fn moves(&self, joint: usize) -> bool {
        self.displacement[joint].abs() > TRAVEL_MIN
    }

    pub(super) fn name(&self, joint: usize) -> &str {
        &self.robot.spec().joints[joint].name
    }

    /// The torque limits.
    pub(super) fn torque_limits(&self) -> Vec<Option<f64>> {
        self.limits.iter().map(|limit| limit.torque).collect()
    }

    fn check_ranges(&mut self, target: &[f64], wrong: &mut Vec<Invalid>) {
        let travel: f64 = self.displacement.iter().map(|d| d.abs()).sum();
        if travel > TRAVEL_MAX {
            let message = format!("the joints travel {travel:.1} rad or m in all, the most is {TRAVEL_MAX}");
            wrong.push(Invalid::new("target.position", message));
        }
        for (joint, target) in target.iter().enumerate() {
            let limit = self.limits[joint];
            let (lower, upper) = (limit.position_lower, limit.position_upper);
            if let Some(message) = outside(*target, lower, upper) {
                let message = format!("joint \"{}\": {message}", self.name(joint));
                wrong.push(Invalid::new(format!("target.position[{joint}]"), message));
            }
            let Some(message) = outside(self.start[joint], lower, upper) else {
                continue;
            };
            let message = format!("joint \"{}\": {message}", self.name(joint));
            if self.starts_within_slack(joint) {
                self.warnings.push(format!(
                    "{message}; accepted because it is within {START_SLACK} of the range and the move goes inwards"
                ));
                continue;
            }
            wrong.push(Invalid::new(format!("start.position[{joint}]"), message));
        }
    }

    /// A start just outside its range, from which the move goes inwards.
    fn starts_within_slack(&self, joint: usize) -> bool {
        let JointLimit {
            position_lower: Some(lower),
            position_upper: Some(upper),
            ..
        } = self.limits[joint]
        else {
            return false;
        };
        let slack = START_SLACK * (upper - lower);
        let start = self.start[joint];
        let below = start < lower && start >= lower - slack && self.displacement[joint] > 0.0;
        let above = start > upper && start <= upper + slack && self.displacement[joint] < 0.0;
        below || above
    }

    /// The speed of each joint in this move: asked for or limit, times the speed scale.
    fn set_speeds(&mut self, request: &MoveRequest, wrong: &mut Vec<Invalid>) {
        for joint in 0..self.start.len() {
            let known = self.limits[joint].velocity;
            let asked = request.target_velocity.as_ref().map(|velocity| velocity[joint]);
            if let Some(asked) = asked {
                let path = format!("target_velocity[{joint}]");
                if !(asked.is_finite() && asked > 0.0) {
                    let message = format!(
                        "joint \"{}\": speed {asked} must be positive and finite",
                        self.name(joint)
                    );
                    wrong.push(Invalid::new(path, message));
                    continue;
                }
                if asked > known {
                    let message = format!(
                        "joint \"{}\": speed {asked} is above the limit {known}",
                        self.name(joint)
                    );
                    wrong.push(Invalid::new(path, message));
                    continue;
                }
            }
            let velocity = asked.unwrap_or(known);
            if velocity == f64::INFINITY && self.moves(joint) {
                let message = format!(
                    "joint \"{}\": the model has no speed limit; give target_velocity or limits[].velocity",
                    self.name(joint)
                );
                wrong.push(Invalid::new("limits", message));
                continue;
            }
            self.limits[joint].velocity = velocity * request.speed_scale;
        }
    }

    /// Every joint that moves needs something that bounds its acceleration.
    fn check_bounded(&self, wrong: &mut Vec<Invalid>) {
        for (joint, limit) in self.limits.iter().enumerate() {
            if self.moves(joint) && limit.torque.is_none() && limit.acceleration.is_none() {
                let message = format!(
                    "joint \"{}\": neither peak torque nor acceleration limit is known, so nothing bounds the move; give \
                     limits[].peak_torque or limits[].acceleration",
                    self.name(joint)
                );
                wrong.push(Invalid::new("limits", message));
            }
        }
    }

    fn warn(&mut self) {
        let spec = self.robot.spec();
        let names = |wanted: &dyn Fn(usize) -> bool| {
            let names: Vec<&str> = (0..self.start.len())
                .filter(|joint| wanted(*joint))
                .map(|joint| spec.joints[joint].name.as_str())
                .collect();
            names.join(", ")
        };
        let unchecked = names(&|joint| self.limits[joint].torque.is_none());
        let jerky = names(&|joint| self.moves(joint) && self.limits[joint].jerk.is_some());
        if !unchecked.is_empty() {
            self.warnings
                .push(format!("peak torque unknown, torque not checked: {unchecked}"));
        }
        if !jerky.is_empty() {
            self.warnings.push(format!(
                "jerk limits do not apply to a move with trapezoidal patterns: {jerky}; a program of one joint segment (`PlanPath`, `takt plan path`) keeps them"
            ));
        }
    }
}

/// What of a robot's limits is in force once a request has tightened them.
pub(crate) fn limits_in_force(
    robot: &Robot,
    overrides: &[LimitOverride],
    torque_utilization: f64,
    wrong: &mut Vec<Invalid>,
) -> Vec<JointLimit> {
    let joints = &robot.spec().joints;
    let mut limits: Vec<JointLimit> = joints
        .iter()
        .map(|joint| {
            let limited = joint.kind != JointKind::Continuous;
            let known = &joint.limits;
            JointLimit {
                torque: joint.drive.peak_torque.map(|peak| peak * torque_utilization),
                velocity: known.velocity.unwrap_or(f64::INFINITY),
                acceleration: known.acceleration,
                deceleration: known.deceleration,
                jerk: known.jerk,
                position_lower: known.position_lower.filter(|_| limited),
                position_upper: known.position_upper.filter(|_| limited),
            }
        })
        .collect();
    let mut seen = vec![false; joints.len()];
    for (index, change) in overrides.iter().enumerate() {
        let path = format!("limits[{index}]");
        let Some(joint) = joints.iter().position(|joint| joint.name == change.joint) else {
            let names: Vec<&str> = joints.iter().map(|joint| joint.name.as_str()).collect();
            let message = format!(
                "no joint \"{}\"; the joints are {}",
                clip(&change.joint),
                names.join(", ")
            );
            wrong.push(Invalid::new(format!("{path}.joint"), message));
            continue;
        };
        if std::mem::replace(&mut seen[joint], true) {
            let message = format!("joint \"{}\" stands here a second time", change.joint);
            wrong.push(Invalid::new(format!("{path}.joint"), message));
            continue;
        }
        let peak = joints[joint].drive.peak_torque;
        tighten(&mut limits[joint], change, peak, &path, wrong);
    }
    // by default it is the acceleration limit's, and so follows it
    for limit in &mut limits {
        limit.deceleration = limit.deceleration.or(limit.acceleration);
    }
    limits
}

/// Applies one override, or says why it is none.
fn tighten(limit: &mut JointLimit, change: &LimitOverride, peak: Option<f64>, path: &str, wrong: &mut Vec<Invalid>) {
    let mut upper = |field: &str, value: Option<f64>, known: Option<f64>| -> Option<f64> {
        let value = value?;
        let path = format!("{path}.{field}");
        let joint = &change.joint;
        if !(value.is_finite() && value > 0.0) {
            wrong.push(Invalid::new(
                path,
                format!("joint \"{joint}\": {value} must be positive and finite"),
            ));
            return None;
        }
        if let Some(known) = known
            && value > known
        {
            let message = format!("joint \"{joint}\": {value} is looser than the model's {known}");
            wrong.push(Invalid::new(path, message));
            return None;
        }
        Some(value)
    };
    let finite = |known: f64| known.is_finite().then_some(known);
    if let Some(torque) = upper("peak_torque", change.peak_torque, peak) {
        limit.torque = Some(torque);
    }
    if let Some(velocity) = upper("velocity", change.velocity, finite(limit.velocity)) {
        limit.velocity = velocity;
    }
    let acceleration = upper("acceleration", change.acceleration, limit.acceleration);
    let known = limit.deceleration.or(limit.acceleration);
    let deceleration = upper("deceleration", change.deceleration, known);
    if acceleration.is_some() {
        limit.acceleration = acceleration;
    }
    if deceleration.is_some() {
        limit.deceleration = deceleration;
    }
    if let Some(jerk) = upper("jerk", change.jerk, limit.jerk) {
        limit.jerk = Some(jerk);
    }
    let (lower, upper) = (limit.position_lower, limit.position_upper);
    for (field, value, slot, outward) in [
        ("position_lower", change.position_lower, &mut limit.position_lower, -1.0),
        ("position_upper", change.position_upper, &mut limit.position_upper, 1.0),
    ] {
        let Some(value) = value else { continue };
        let path = format!("{path}.{field}");
        if !value.is_finite() {
            wrong.push(Invalid::new(
                path,
                format!("joint \"{}\": {value} must be finite", change.joint),
            ));
            continue;
        }
        let known = if outward < 0.0 { lower } else { upper };
        if let Some(known) = known
            && outward * (value - known) > 0.0
        {
            let message = format!("joint \"{}\": {value} is looser than the model's {known}", change.joint);
            wrong.push(Invalid::new(path, message));
            continue;
        }
        *slot = Some(value);
    }
    if let (Some(lower), Some(upper)) = (limit.position_lower, limit.position_upper)
        && lower > upper
    {
        let message = format!("joint \"{}\": position range {lower} to {upper} is empty", change.joint);
        wrong.push(Invalid::new(format!("{path}.position_lower"), message));
    }
}

/// What to say of a position outside its range; `None` for one inside.
fn outside(position: f64, lower: Option<f64>, upper: Option<f64>) -> Option<String> {
    if let Some(lower) = lower
        && position < lower
    {
        return Some(format!("position {position} is below the lower limit {lower}"));
    }
    if let Some(upper) = upper
        && position > upper
    {
        return Some(format!("position {position} is above the upper limit {upper}"));
    }
    None
}

pub(crate) fn check_positions(robot: &Robot, path: &str, positions: &[f64], wrong: &mut Vec<Invalid>) {
    check_length(path, positions.len(), robot.joint_count(), wrong);
    for (joint, position) in positions.iter().enumerate() {
        if !(position.is_finite() && position.abs() <= POSITION_MAX) {
            let message = format!("position {position} must be finite and at most {POSITION_MAX} either way");
            wrong.push(Invalid::new(format!("{path}[{joint}]"), message));
        }
    }
}

pub(crate) fn check_length(path: &str, length: usize, joint_count: usize, wrong: &mut Vec<Invalid>) {
    if length != joint_count {
        let message = format!("{length} values, the robot has {joint_count} joints");
        wrong.push(Invalid::new(path, message));
    }
}

/// A part of a limit lies in (0, 1].
pub(crate) fn check_part(path: &str, part: f64, wrong: &mut Vec<Invalid>) {
    if !(part > 0.0 && part <= 1.0) {
        wrong.push(Invalid::new(path, format!("{part} must be above 0 and at most 1")));
    }
}

pub(crate) fn check_positive(path: &str, value: f64, wrong: &mut Vec<Invalid>) {
    if !(value.is_finite() && value > 0.0) {
        wrong.push(Invalid::new(path, format!("{value} must be positive and finite")));
    }
}

pub(crate) fn check_sampling(sampling: Sampling, wrong: &mut Vec<Invalid>) {
    match sampling {
        Sampling::None => {}
        Sampling::Period(period) => check_positive("sample_period_s", period, wrong),
        Sampling::Trace(points) if (2..=SETPOINTS_MAX).contains(&points) => {}
        Sampling::Trace(points) => {
            let message = format!("{points} points, from 2 to {SETPOINTS_MAX} can be had");
            wrong.push(Invalid::new("trace_points", message));
        }
    }
}

/// The beginning of a caller's text: enough to recognise it.
fn clip(text: &str) -> &str {
    let end = text.char_indices().nth(64).map_or(text.len(), |(at, _)| at);
    &text[..end]
}
