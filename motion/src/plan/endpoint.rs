//! The patent's method: accelerations that use the torque left at both end poses (JP4358979B2, fig. 4, S2 to S10).
//!
//! It tests torque at the end poses only, so its plan may exceed a limit in mid-move; what leaves the service is slowed
//! until it does not.

use super::outcome::{Fallback, Infeasible, InfeasibleReason, Pattern};
use super::preset::{first_calculation, preset, second_calculation, speed, still, synchronize};
use super::problem::Problem;
use crate::dynamics::{self, Workspace};
use crate::tolerance::RATE_RESERVE;

/// Which end of the move.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum End {
    Start,
    Target,
}

/// The raw plans of the patent's method: one, or one for each fallback.
pub(super) fn plans(problem: &Problem, preset_plan: &[Pattern]) -> Result<Vec<(Fallback, Vec<Pattern>)>, Infeasible> {
    let acceleration = optimal_rates(problem, preset_plan, End::Start)?;
    let deceleration = optimal_rates(problem, preset_plan, End::Target)?;
    let own: Vec<Pattern> = (0..problem.start.len())
        .map(|joint| {
            if !problem.moves(joint) {
                return still();
            }
            first_calculation(
                problem.displacement[joint],
                speed(problem, joint),
                acceleration[joint],
                deceleration[joint],
            )
        })
        .collect();
    // S6: the joint with the longest preset time sets the pace
    let pace = slowest((0..own.len()).filter(|joint| problem.moves(*joint)), |joint| {
        preset_time(problem, joint)
    });
    let Some(pace) = pace else {
        return Ok(vec![(Fallback::None, own)]);
    };
    let keep_pace = |pace: usize| -> (Vec<Pattern>, Vec<usize>) {
        let time = own[pace].duration();
        let mut failing = Vec::new();
        let patterns = own
            .iter()
            .enumerate()
            .map(|(joint, pattern)| {
                if joint == pace || !pattern.moves() {
                    return *pattern;
                }
                // S7, S8
                let kept = second_calculation(
                    pattern.displacement,
                    speed(problem, joint),
                    acceleration[joint],
                    deceleration[joint],
                    time,
                );
                kept.unwrap_or_else(|| {
                    failing.push(joint);
                    *pattern
                })
            })
            .collect();
        (patterns, failing)
    };
    let (patterns, failing) = keep_pace(pace);
    let Some(slowest_failing) = slowest(failing.iter().copied(), |joint| own[joint].duration()) else {
        return Ok(vec![(Fallback::None, patterns)]);
    };
    let mut plans = vec![(Fallback::Resynchronized, synchronize(&patterns))];
    let (rebased, failing) = keep_pace(slowest_failing);
    if failing.is_empty() {
        plans.push((Fallback::Rebased, rebased));
    }
    Ok(plans)
}

/// Duration of a joint's preset pattern before synchronization.
fn preset_time(problem: &Problem, joint: usize) -> f64 {
    let Some((acceleration, deceleration)) = preset(problem, joint) else {
        return 0.0;
    };
    first_calculation(
        problem.displacement[joint],
        speed(problem, joint),
        acceleration,
        deceleration,
    )
    .duration()
}

fn slowest(joints: impl Iterator<Item = usize>, time: impl Fn(usize) -> f64) -> Option<usize> {
    joints.max_by(|a, b| time(*a).total_cmp(&time(*b)).then(b.cmp(a)))
}

/// S4 and S5: the largest multiple of the synchronized preset accelerations that every joint's torque allows at one end.
///
/// Every joint's torque is rate·α + bias; the intervals of α that keep them within their limits are intersected, since the
/// sign of a rate need not be that of the joint's own acceleration.
fn optimal_rates(problem: &Problem, preset_plan: &[Pattern], end: End) -> Result<Vec<f64>, Infeasible> {
    let count = problem.start.len();
    let robot = &problem.robot;
    let q: Vec<f64> = match end {
        End::Start => problem.start.clone(),
        End::Target => problem
            .start
            .iter()
            .zip(&problem.displacement)
            .map(|(start, by)| start + by)
            .collect(),
    };
    let qd: Vec<f64> = preset_plan.iter().map(|p| p.peak_velocity).collect();
    let direction: Vec<f64> = preset_plan
        .iter()
        .map(|p| match end {
            End::Start => p.acceleration,
            End::Target => -p.deceleration,
        })
        .collect();
    let zeros = vec![0.0; count];
    let workspace = &mut Workspace::new(robot);
    let (mut bias, mut whole) = (vec![0.0; count], vec![0.0; count]);
    dynamics::drive_torque(robot, workspace, &q, &qd, &zeros, &mut bias);
    dynamics::drive_torque(robot, workspace, &q, &qd, &direction, &mut whole);

    let mut most = f64::INFINITY;
    for (joint, limit) in problem.limits.iter().enumerate() {
        let rate = direction[joint].abs();
        let cap = match end {
            End::Start => limit.acceleration,
            End::Target => limit.deceleration,
        };
        if let Some(cap) = cap
            && rate > 0.0
        {
            most = most.min(cap * (1.0 - RATE_RESERVE) / rate);
        }
        let Some(torque) = limit.torque else { continue };
        let rate = whole[joint] - bias[joint];
        if bias[joint].abs() >= torque {
            return Err(no_acceleration(problem, joint, end, bias[joint], torque, &q));
        }
        if rate != 0.0 {
            most = most.min((torque - bias[joint] * rate.signum()) / rate.abs());
        }
    }
    Ok(direction.iter().map(|rate| rate.abs() * most).collect())
}

fn no_acceleration(problem: &Problem, joint: usize, end: End, needed: f64, available: f64, q: &[f64]) -> Infeasible {
    let robot = &problem.robot;
    let mut gravity = vec![0.0; q.len()];
    dynamics::gravity_torque(robot, &mut Workspace::new(robot), q, &mut gravity);
    let (location, end) = match end {
        End::Start => (0.0, "start"),
        End::Target => (1.0, "target"),
    };
    Infeasible {
        reason: InfeasibleReason::NoFeasibleAcceleration,
        joint,
        time: 0.0,
        location,
        needed,
        available,
        gravity_torque: gravity[joint],
        suggestion: format!(
            "at preset speed, velocity products and friction leave joint \"{}\" no torque for acceleration at the {end}: \
             plan with the method VERIFIED, which is free to go slower, or lower speed_scale",
            problem.name(joint)
        ),
        feasible_payload: None,
    }
}
