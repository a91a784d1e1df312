//! Torque margins: what the verification found, per drive.

use super::outcome::{Pattern, Phase, TorqueMargin};
use super::problem::Problem;
use crate::dynamics::{self, Workspace};
use crate::robot::Robot;
use crate::trajectory::{self, Trajectory};
use crate::verify::{JointDemand, Verification};

/// The margins of a move; its cycle is filled up by holding the target.
pub(super) fn of_move(
    problem: &Problem,
    patterns: &[Pattern],
    verification: &Verification,
    cycle_time: f64,
) -> Vec<TorqueMargin> {
    let duration = trajectory::duration(patterns);
    let target: Vec<f64> = problem
        .start
        .iter()
        .zip(&problem.displacement)
        .map(|(start, by)| start + by)
        .collect();
    let motion = (duration > 0.0).then(|| Trajectory::of_patterns(&problem.start, patterns));
    let limits = problem.torque_limits();
    of_demands(
        &problem.robot,
        &limits,
        verification,
        duration,
        cycle_time,
        &target,
        |joint, demand| {
            motion.as_ref().map_or(Phase::Hold, |motion| {
                patterns[joint].phase(motion.middle(demand.segment), duration)
            })
        },
    )
}

/// The margins of any motion that ends at rest in `last`.
pub(super) fn of_demands(
    robot: &Robot,
    limits: &[Option<f64>],
    verification: &Verification,
    duration: f64,
    cycle_time: f64,
    last: &[f64],
    phase: impl Fn(usize, &JointDemand) -> Phase,
) -> Vec<TorqueMargin> {
    let mut holding = vec![0.0; last.len()];
    dynamics::gravity_torque(robot, &mut Workspace::new(robot), last, &mut holding);
    let mut margins = Vec::with_capacity(last.len());
    for (joint, (limit, demand)) in limits.iter().zip(&verification.joints).enumerate() {
        let Some(limit) = *limit else { continue };
        let hold = holding[joint];
        let at_rest = hold.abs() > demand.peak_torque.abs();
        let peak_torque = if at_rest { hold } else { demand.peak_torque };
        let rms_torque = if cycle_time > 0.0 {
            ((demand.torque_squared + hold * hold * (cycle_time - duration)) / cycle_time).sqrt()
        } else {
            hold.abs()
        };
        let drive = &robot.spec().joints[joint].drive;
        margins.push(TorqueMargin {
            joint,
            limit,
            peak_torque,
            time: if at_rest { duration } else { demand.time },
            phase: if at_rest { Phase::Hold } else { phase(joint, demand) },
            margin: (limit - peak_torque.abs()) / limit,
            rms_torque,
            rated_torque: drive.rated_torque,
            peak_motor_speed: demand.peak_velocity * drive.gear_ratio.abs(),
            peak_power: demand.peak_power,
        });
    }
    margins
}
