//! An arm of two links whose telemetry is simulated: exact torques along smooth motions, with noise if asked.

use super::super::law;
use super::super::noise::Correlated;
use super::super::options::{EstimatorOptions, Memory};
use super::FrictionEstimator;
use crate::budget::Budget;
use crate::drive::telemetry::Telemetry;
use crate::dynamics::{self, Workspace};
use crate::robot::Robot;
use crate::robot::spec::Friction;
use crate::test_arms::{planar, robot};

/// Sample time, s.
const STEP: f64 = 0.001;

/// Time over which the noise stays alike, s.
const ALIKE: f64 = 0.1;

/// Gear ratios, one of them negative.
pub(super) const RATIOS: [f64; 2] = [100.0, -50.0];

pub(super) fn two_links() -> Robot {
    let mut spec = planar();
    for (joint, ratio) in spec.joints.iter_mut().zip(RATIOS) {
        joint.drive.gear_ratio = ratio;
        joint.drive.rotor_inertia = 1e-4;
        joint.drive.torque_constant = Some(0.1);
        joint.drive.stiffness = vec![8000.0, 2e6];
        joint.drive.damping = Some(10.0);
    }
    robot(spec)
}

pub(super) fn friction(coulomb: f64, viscous: f64) -> Friction {
    Friction {
        viscous,
        coulomb_positive: coulomb,
        coulomb_negative: coulomb,
        ..Friction::default()
    }
}

pub(super) fn options() -> EstimatorOptions {
    EstimatorOptions {
        memory: Memory::HalfLife(60.0),
        ..EstimatorOptions::default()
    }
}

/// A motion of both joints, and the friction in it.
pub(super) struct Recording<'a> {
    robot: &'a Robot,
    truth: Vec<Friction>,
    noise: f64,
}

/// Position, velocity and acceleration of a joint: two strokes, one over the other.
pub(super) fn motion(joint: usize, time: f64) -> [f64; 3] {
    let mut state = [0.0; 3];
    for (amplitude, rate) in [[(1.1, 0.9), (0.35, 2.3)], [(1.3, 1.1), (0.3, 2.9)]][joint] {
        let angle = rate * time + joint as f64;
        state[0] += amplitude * libm::sin(angle);
        state[1] += amplitude * rate * libm::cos(angle);
        state[2] -= amplitude * rate * rate * libm::sin(angle);
    }
    state
}

impl<'a> Recording<'a> {
    pub(super) fn of(robot: &'a Robot, truth: &[Friction]) -> Self {
        Self {
            robot,
            truth: truth.to_vec(),
            noise: 0.0,
        }
    }

    /// Adds noise of this standard deviation to the torques at the joints.
    pub(super) fn with_noise(self, noise: f64) -> Self {
        Self { noise, ..self }
    }

    /// Output positions and motor torques from one time to another.
    pub(super) fn telemetry(&self, from: f64, to: f64) -> Telemetry {
        let workspace = &mut Workspace::new(self.robot);
        let state = &mut 99;
        let mut noises: Vec<Correlated> = (0..2).map(|_| Correlated::new(STEP, ALIKE, None, state)).collect();
        let mut telemetry = Telemetry::default();
        let count = ((to - from) / STEP) as usize;
        for index in 0..count {
            let time = from + index as f64 * STEP;
            let states = [motion(0, time), motion(1, time)];
            let column = |order: usize| [states[0][order], states[1][order]];
            let (mut torque, mut gravity) = ([0.0; 2], [0.0; 2]);
            dynamics::rigid_torque(self.robot, workspace, &column(0), &column(1), &column(2), &mut torque);
            dynamics::gravity_torque(self.robot, workspace, &column(0), &mut gravity);
            telemetry.time.push(time);
            for joint in 0..2 {
                let [position, velocity, acceleration] = states[joint];
                let drive = &self.robot.spec().joints[joint].drive;
                let armature = drive.gear_ratio * drive.gear_ratio * drive.rotor_inertia;
                let whole = torque[joint]
                    + armature * acceleration
                    + law::torque(&self.truth[joint], velocity, gravity[joint])
                    + self.noise * noises[joint].next(state);
                telemetry.output_position.push(position);
                telemetry.motor_torque.push(whole / drive.gear_ratio);
            }
        }
        telemetry
    }
}

/// Samples of a recording, so many to a block.
pub(super) fn blocks(telemetry: &Telemetry, joints: usize, size: usize) -> Vec<Telemetry> {
    let count = telemetry.time.len();
    let part = |column: &[f64], from: usize, to: usize| {
        if column.is_empty() {
            Vec::new()
        } else {
            column[joints * from..joints * to].to_vec()
        }
    };
    (0..count.div_ceil(size))
        .map(|index| {
            let (from, to) = (index * size, ((index + 1) * size).min(count));
            Telemetry {
                time: telemetry.time[from..to].to_vec(),
                motor_position: part(&telemetry.motor_position, from, to),
                output_position: part(&telemetry.output_position, from, to),
                output_velocity: part(&telemetry.output_velocity, from, to),
                output_acceleration: part(&telemetry.output_acceleration, from, to),
                motor_torque: part(&telemetry.motor_torque, from, to),
                motor_current: part(&telemetry.motor_current, from, to),
                transmission_torque: part(&telemetry.transmission_torque, from, to),
                external_torque: part(&telemetry.external_torque, from, to),
            }
        })
        .collect()
}

/// Feeds a recording in blocks.
pub(super) fn feed(estimator: &mut FrictionEstimator, telemetry: &Telemetry, size: usize) {
    let joints = estimator.joints.len();
    for block in blocks(telemetry, joints, size) {
        estimator.update(&block, &Budget::unlimited()).unwrap();
    }
}
