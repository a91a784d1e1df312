//! "No" with its evidence: which joint, where, needed against available, and what would make it feasible.

use super::outcome::{Infeasible, InfeasibleReason};
use super::problem::Problem;
use crate::dynamics::{self, Workspace};
use crate::robot::Robot;
use crate::robot::spec::Inertial;
use crate::tolerance::PLAN_RESERVE;
use crate::verify::Peak;

/// Checks that both end poses can be held at rest. Returns the worst joint where one cannot.
pub(super) fn check_holding(problem: &Problem) -> Option<Infeasible> {
    [0.0, 1.0]
        .into_iter()
        .flat_map(|location| {
            let gravity = gravity_at(problem, location);
            problem
                .limits
                .iter()
                .enumerate()
                .filter_map(move |(joint, limit)| {
                    let limit = limit.torque?;
                    let needed = gravity[joint];
                    (needed.abs() > limit).then_some((location, joint, needed, limit))
                })
                .collect::<Vec<_>>()
        })
        .max_by(|a, b| (a.2.abs() / a.3).total_cmp(&(b.2.abs() / b.3)))
        .map(|(location, joint, needed, limit)| {
            let pose = if location == 0.0 { "start" } else { "target" };
            let what = format!("hold the {pose} pose");
            let rest = Rest::of(problem, joint, 0.0, needed, needed);
            refuse(
                problem,
                InfeasibleReason::HoldingTorque,
                &what,
                joint,
                location,
                needed,
                limit,
                &rest,
            )
        })
}

/// Gravity and friction alone exceed a limit on the way.
pub(super) fn moving(
    problem: &Problem,
    joint: usize,
    location: f64,
    needed: f64,
    available: f64,
    gravity: f64,
) -> Infeasible {
    // what only the planner's reserve forbids needs a limit with room for the reserve
    let needed = if needed.abs() < available {
        needed / (1.0 - PLAN_RESERVE)
    } else {
        needed
    };
    let reason = InfeasibleReason::MovingTorque;
    let rest = Rest::of(problem, joint, problem.displacement[joint], needed, gravity);
    refuse(
        problem,
        reason,
        "move through there",
        joint,
        location,
        needed,
        available,
        &rest,
    )
}

/// No part of the speed of a method's plan keeps every limit.
pub(super) fn never_slow_enough(problem: &Problem, peak: &Peak, duration: f64) -> Infeasible {
    let location = peak.time / duration;
    let available = problem.limits[peak.joint].torque.unwrap_or(f64::INFINITY);
    let gravity = gravity_at(problem, location)[peak.joint];
    let reason = InfeasibleReason::NoFeasibleSpeed;
    let direction = problem.displacement[peak.joint];
    let rest = Rest::of(problem, peak.joint, direction, peak.torque, gravity);
    let mut refusal = refuse(
        problem,
        reason,
        "follow this pattern",
        peak.joint,
        location,
        peak.torque,
        available,
        &rest,
    );
    refusal.time = peak.time;
    refusal
}

/// Planning found no speed above 0.
pub(super) fn no_speed(problem: &Problem) -> Infeasible {
    let gravity = gravity_at(problem, 0.5);
    let use_of = |joint: usize| {
        problem.limits[joint]
            .torque
            .map_or(0.0, |limit| gravity[joint].abs() / limit)
    };
    let joint = (0..gravity.len())
        .max_by(|a, b| use_of(*a).total_cmp(&use_of(*b)))
        .unwrap_or(0);
    let available = problem.limits[joint].torque.unwrap_or(f64::INFINITY);
    let reason = InfeasibleReason::NoFeasibleSpeed;
    let rest = Rest::of(problem, joint, 0.0, gravity[joint], gravity[joint]);
    refuse(
        problem,
        reason,
        "move at all",
        joint,
        0.5,
        gravity[joint],
        available,
        &rest,
    )
}

#[expect(clippy::too_many_arguments, reason = "the evidence, one piece each")]
fn refuse(
    problem: &Problem,
    reason: InfeasibleReason,
    what: &str,
    joint: usize,
    location: f64,
    needed: f64,
    available: f64,
    rest: &Rest,
) -> Infeasible {
    let spec = &problem.robot.spec().joints[joint];
    let unit = match spec.kind {
        crate::robot::spec::JointKind::Prismatic => "N",
        _ => "N m",
    };
    let feasible_payload = feasible_payload(&problem.robot, &pose_at(problem, location), joint, rest, available);
    let mut ways = vec![format!(
        "allow joint \"{}\" at least {:.4} {unit} to {what}",
        spec.name,
        needed.abs()
    )];
    if let Some(peak) = spec.drive.peak_torque {
        let utilization = needed.abs() / peak;
        if utilization <= 1.0 {
            ways.push(format!("raise its torque utilization to at least {utilization:.4}"));
        }
    }
    match feasible_payload {
        Some(mass) => ways.push(format!("carry at most {mass:.4} kg")),
        None if problem.robot.payload().mass > 0.0 => {
            ways.push("choose another pose: no lighter payload is enough".to_owned())
        }
        None => ways.push("choose another pose".to_owned()),
    }
    Infeasible {
        reason,
        joint,
        time: 0.0,
        location,
        needed,
        available,
        gravity_torque: rest.gravity,
        suggestion: ways.join(", or "),
        feasible_payload,
    }
}

/// A torque by what of it goes with gravity: g + κ·|g| + rest.
pub(crate) struct Rest {
    gravity: f64,
    /// κ: what friction takes of the load, with the sign of the motion.
    load: f64,
    rest: f64,
}

impl Rest {
    /// Of a torque of a joint that moves in a direction; 0 where it is held still.
    fn of(problem: &Problem, joint: usize, direction: f64, torque: f64, gravity: f64) -> Self {
        Self::of_joint(&problem.robot, joint, direction, torque, gravity)
    }

    /// As [`Rest::of`], of any robot.
    pub(crate) fn of_joint(robot: &Robot, joint: usize, direction: f64, torque: f64, gravity: f64) -> Self {
        let drive = &robot.drives()[joint];
        let load = if direction == 0.0 {
            0.0
        } else {
            drive.load_coulomb * direction.signum()
        };
        Self {
            gravity,
            load,
            rest: torque - gravity - load * gravity.abs(),
        }
    }

    /// The torque under another gravity torque.
    fn under(&self, gravity: f64) -> f64 {
        gravity + self.load * gravity.abs() + self.rest
    }
}

/// The largest mass of the payload, its centre where it is, with which gravity, friction of its load and the given rest stay
/// within a limit; `None` where not even none would do, or where it is not the payload's fault.
pub(crate) fn feasible_payload(
    robot: &Robot,
    position: &[f64],
    joint: usize,
    rest: &Rest,
    available: f64,
) -> Option<f64> {
    let payload = *robot.payload();
    if payload.mass <= 0.0 {
        return None;
    }
    let gravity = |robot: &Robot| {
        let mut torque = vec![0.0; position.len()];
        dynamics::gravity_torque(robot, &mut Workspace::new(robot), position, &mut torque);
        torque[joint]
    };
    let (empty, loaded) = (gravity(&robot.with_payload(&Inertial::zero())), gravity(robot));
    let (without, with) = (rest.under(empty), rest.under(loaded));
    if without.abs() >= available || with.abs() <= available {
        return None;
    }
    // gravity is linear in the mass, and the torque in gravity on either side of zero
    let bound = available.copysign(with);
    let part = [1.0, -1.0]
        .into_iter()
        .map(|side| (side, (bound - rest.rest) / (1.0 + side * rest.load)))
        .filter(|(side, gravity)| side * gravity >= 0.0)
        .map(|(_, gravity)| (gravity - empty) / (loaded - empty))
        .filter(|part| (0.0..=1.0).contains(part))
        .fold(f64::NEG_INFINITY, f64::max);
    (part >= 0.0).then_some(payload.mass * part)
}

fn gravity_at(problem: &Problem, location: f64) -> Vec<f64> {
    let mut torque = vec![0.0; problem.start.len()];
    let robot = &problem.robot;
    dynamics::gravity_torque(
        robot,
        &mut Workspace::new(robot),
        &pose_at(problem, location),
        &mut torque,
    );
    torque
}

fn pose_at(problem: &Problem, location: f64) -> Vec<f64> {
    problem
        .start
        .iter()
        .zip(&problem.displacement)
        .map(|(start, by)| start + by * location)
        .collect()
}
