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
    let rests = [(0.0, problem.start.as_slice()), (duration, target.as_slice())];
    let motion = (duration > 0.0).then(|| Trajectory::of_patterns(&problem.start, patterns));
    let limits = problem.torque_limits();
    of_demands(
        &problem.robot,
        &limits,
        verification,
        duration,
        cycle_time,
        &rests,
        |joint, demand| {
            motion.as_ref().map_or(Phase::Hold, |motion| {
                patterns[joint].phase(motion.middle(demand.segment), duration)
            })
        },
    )
}

/// The margins of any motion that is at rest at given times and positions, the last of them at its end.
pub(crate) fn of_demands(
    robot: &Robot,
    limits: &[Option<f64>],
    verification: &Verification,
    duration: f64,
    cycle_time: f64,
    rests: &[(f64, &[f64])],
    phase: impl Fn(usize, &JointDemand) -> Phase,
) -> Vec<TorqueMargin> {
    let workspace = &mut Workspace::new(robot);
    let holding: Vec<(f64, Vec<f64>)> = rests
        .iter()
        .map(|(time, position)| {
            let mut torque = vec![0.0; position.len()];
            dynamics::gravity_torque(robot, workspace, position, &mut torque);
            (*time, torque)
        })
        .collect();
    let mut margins = Vec::with_capacity(limits.len());
    for (joint, (limit, demand)) in limits.iter().zip(&verification.joints).enumerate() {
        let Some(limit) = *limit else { continue };
        let (mut peak_torque, mut time, mut at_rest) = (demand.peak_torque, demand.time, false);
        for (rest, torque) in &holding {
            if torque[joint].abs() > peak_torque.abs() {
                (peak_torque, time, at_rest) = (torque[joint], *rest, true);
            }
        }
        let hold = holding.last().map_or(0.0, |(_, torque)| torque[joint]);
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
            time,
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
