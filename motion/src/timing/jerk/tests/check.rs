//! What a motion takes of its limits, found in time: positions, velocities, accelerations and jerks of the joints,
//! inverse dynamics, and poses of the tool. It knows neither grids nor coefficients.

use nalgebra::Isometry3;

use crate::curve::{Curve, CurvePoint, Side};
use crate::dynamics::{self, Workspace};
use crate::robot::Robot;
use crate::test_arms::random;
use crate::timing::law::TimeLaw;
use crate::timing::limits::{Limits, Stretch};

/// The largest part that a motion takes of any jerk limit, and of any other, at times and places drawn at random.
pub(super) fn worst_uses(
    robot: &Robot,
    curve: &dyn Curve,
    limits: &Limits,
    law: &TimeLaw,
    draws: usize,
    seed: u64,
) -> [f64; 2] {
    let count = curve.joint_count();
    let ws = &mut Workspace::new(robot);
    let mut point = CurvePoint::new(count);
    let mut torque = vec![0.0; count];
    let state = &mut seed.clone();
    let mut worst = [0.0_f64; 2];
    for _ in 0..draws {
        let part = 0.5 + 0.5 * random(state);
        let time = if random(state) > 0.0 {
            part * law.duration()
        } else {
            law.time_at(part * curve.length())
        };
        let motion = law.at(time);
        let (sd, sdd, sddd) = (motion.velocity, motion.acceleration, motion.jerk);
        curve.evaluate(motion.position, Side::Before, &mut point);
        let qd: Vec<f64> = point.first.iter().map(|q1| q1 * sd).collect();
        let bends = point.first.iter().zip(&point.second);
        let qdd: Vec<f64> = bends.map(|(q1, q2)| q1 * sdd + q2 * sd * sd).collect();
        dynamics::drive_torque(robot, ws, &point.position, &qd, &qdd, &mut torque);
        let stretch = &limits.stretches[limits.stretch_at(motion.position, Side::Before)];
        for (joint, limit) in stretch.joints.iter().enumerate() {
            let [q1, q2, q3] = [&point.first, &point.second, &point.third].map(|values| values[joint]);
            let jerk = q1 * sddd + 3.0 * q2 * sd * sdd + q3 * sd * sd * sd;
            let used = |value: f64, limit: Option<f64>| limit.map_or(0.0, |limit| value.abs() / limit);
            worst[0] = worst[0].max(used(jerk, limit.jerk));
            let others = [
                used(qd[joint], limit.velocity),
                used(qdd[joint], limit.acceleration),
                used(torque[joint], limit.torque),
            ];
            worst[1] = others.into_iter().fold(worst[1], f64::max);
        }
        worst[1] = worst[1].max(tool_use(robot, stretch, &point, [sd, sdd]));
    }
    worst
}

/// The tool's part, by differences of its poses.
fn tool_use(robot: &Robot, stretch: &Stretch, point: &CurvePoint, [sd, sdd]: [f64; 2]) -> f64 {
    let tcp = Isometry3::translation(0.05, 0.0, 0.1);
    let step = 1e-4;
    let at = |time: f64| {
        let s = sd * time + 0.5 * sdd * time * time;
        let joints = point.position.iter().zip(&point.first).zip(&point.second);
        let q: Vec<f64> = joints.map(|((q, q1), q2)| q + s * q1 + 0.5 * s * s * q2).collect();
        crate::kinematics::pose(robot, &q, &tcp).translation.vector
    };
    let (before, here, after) = (at(-step), at(0.0), at(step));
    let velocity = (after - before).norm() / (2.0 * step);
    let acceleration = (after - here * 2.0 + before).norm() / (step * step);
    let part = |value: f64, limit: Option<f64>| limit.map_or(0.0, |limit| value / limit);
    part(velocity, stretch.tool_velocity).max(part(acceleration, stretch.tool_acceleration))
}
