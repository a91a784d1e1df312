//! Timings against closed forms, against other engines, and against a check that shares nothing with them.

use crate::timing::test_curves::square_at;
use nalgebra::Isometry3;

use super::measured::Polynomials;
use super::test_curves::{puma560, random_walk, ur5e};
use super::*;
use crate::curve::{CurvePoint, Side};
use crate::dynamics::{self, Workspace};
use crate::robot::spec::{Drive, Friction};
use crate::test_arms::{lift, planar, random, robot};
use limits::{JointLimits, Stretch};

mod certified;
mod oracle;
mod refusals;

/// Torque and speed limits of the robot itself.
pub(crate) fn own_limits(robot: &Robot) -> Stretch {
    let joints = robot.spec().joints.iter();
    Stretch {
        joints: joints
            .map(|joint| JointLimits {
                velocity: joint.limits.velocity,
                torque: joint.drive.peak_torque,
                ..JointLimits::default()
            })
            .collect(),
        ..Stretch::default()
    }
}

fn timed(
    robot: &Robot,
    curve: &dyn Curve,
    limits: &Limits,
    end_speeds: [f64; 2],
    intervals: usize,
) -> Result<Timing, Obstacle> {
    let tcp = Isometry3::translation(0.05, 0.0, 0.1);
    let task = Task {
        robot,
        tcp: &tcp,
        curve,
        limits,
        end_speeds,
        intervals,
    };
    optimal(&task, &Budget::unlimited()).unwrap()
}

/// The largest part of any limit that a motion takes, at places drawn at random: positions, velocities and accelerations in
/// time, inverse dynamics, and poses of the tool at neighbouring times. It knows neither grids nor coefficients.
fn worst_use(robot: &Robot, curve: &dyn Curve, limits: &Limits, law: &TimeLaw, draws: usize, seed: u64) -> f64 {
    let count = curve.joint_count();
    let ws = &mut Workspace::new(robot);
    let mut point = CurvePoint::new(count);
    let mut torque = vec![0.0; count];
    let state = &mut seed.clone();
    let mut worst: f64 = 0.0;
    for _ in 0..draws {
        // half of them evenly along the path, half evenly in time
        let part = 0.5 + 0.5 * random(state);
        let s = if random(state) > 0.0 {
            part * curve.length()
        } else {
            law.at(part * law.duration()).position
        };
        let [a, sdd] = square_at(law, s);
        let sd = a.sqrt();
        curve.evaluate(s, Side::Before, &mut point);
        let qd: Vec<f64> = point.first.iter().map(|d| d * sd).collect();
        let bends = point.first.iter().zip(&point.second);
        let qdd: Vec<f64> = bends.map(|(d, dd)| d * sdd + dd * a).collect();
        dynamics::drive_torque(robot, ws, &point.position, &qd, &qdd, &mut torque);
        let stretch = &limits.stretches[limits.stretch_at(s, Side::Before)];
        for (joint, limit) in stretch.joints.iter().enumerate() {
            let values = [
                (qd[joint], limit.velocity),
                (qdd[joint], limit.acceleration),
                (torque[joint], limit.torque),
            ];
            for (value, limit) in values {
                worst = worst.max(limit.map_or(0.0, |limit| value.abs() / limit));
            }
        }
        worst = worst.max(tool_use(robot, stretch, &point, [sd, sdd]));
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
        let q: Vec<f64> = joints.map(|((q, d), dd)| q + s * d + 0.5 * s * s * dd).collect();
        crate::kinematics::pose(robot, &q, &tcp).translation.vector
    };
    let (before, here, after) = (at(-step), at(0.0), at(step));
    let velocity = (after - before).norm() / (2.0 * step);
    let acceleration = (after - here * 2.0 + before).norm() / (step * step);
    let part = |value: f64, limit: Option<f64>| limit.map_or(0.0, |limit| value / limit);
    part(velocity, stretch.tool_velocity).max(part(acceleration, stretch.tool_acceleration))
}

/// One joint, straight: up at A, along at V, down at A.
#[test]
fn one_joint_moves_by_a_trapezoid() {
    let lift = robot(lift(5.0));
    let curve = Polynomials::new(vec![vec![-1.0, 1.5]], 1.0);
    let joint = JointLimits {
        velocity: Some(0.8),
        acceleration: Some(2.0),
        ..JointLimits::default()
    };
    let limits = Limits::uniform(Stretch {
        joints: vec![joint],
        ..Stretch::default()
    });
    let timing = timed(&lift, &curve, &limits, [0.0; 2], 200).unwrap();
    let expected = 0.8 / 2.0 + 1.5 / 0.8;
    let duration = timing.law.duration();
    assert!(
        duration > expected && duration < 1.002 * expected,
        "{duration} {expected}"
    );
}

/// 5 kg lifted against 10 m/s² by 100 N: up at 10 m/s², down at 30 m/s².
#[test]
fn a_lift_brakes_harder_than_it_accelerates() {
    let lift = robot(lift(5.0));
    let curve = Polynomials::new(vec![vec![-1.0, 0.1]], 1.0);
    let limits = Limits::uniform(own_limits(&lift));
    let duration = timed(&lift, &curve, &limits, [0.0; 2], 400).unwrap().law.duration();
    // v²/20 + v²/60 = 0.1
    let v = (0.1f64 / (1.0 / 20.0 + 1.0 / 60.0)).sqrt();
    let expected = v / 10.0 + v / 30.0;
    assert!(
        duration > expected && duration < 1.003 * expected,
        "{duration} {expected}"
    );
}

/// Without gravity and friction, limits x (λ, λ², λ²) are those of the same motion λ times as fast.
#[test]
fn without_gravity_limits_scale_with_time() {
    let mut spec = planar();
    spec.gravity = nalgebra::Vector3::zeros();
    let arm = robot(spec);
    let curve = random_walk(2, 3, &[4.0, 5.0], 3);
    let limits = |factor: f64| {
        let mut stretch = own_limits(&arm);
        for joint in &mut stretch.joints {
            joint.acceleration = Some(30.0 * factor * factor);
            joint.velocity = joint.velocity.map(|v| v * factor);
            joint.torque = joint.torque.map(|torque| torque * factor * factor);
        }
        Limits::uniform(stretch)
    };
    let first = timed(&arm, &curve, &limits(1.0), [0.0; 2], 150).unwrap().law.duration();
    let faster = timed(&arm, &curve, &limits(1.7), [0.0; 2], 150).unwrap().law.duration();
    assert!((first / faster - 1.7).abs() < 1e-9, "{first} {faster}");
}
