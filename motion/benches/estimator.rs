//! What a sample of a stream takes, ns a joint: median and fastest of many batches, one line each.
//!
//! ```text
//! cargo bench --package takt-motion --bench estimator
//! cargo bench --package takt-motion --bench estimator -- --only kalman/4_terms
//! ```
//!
//! `--only`: those whose names have it in them, so that the instructions of one can be counted.
//!
//! A UR5e at 1 kHz in blocks of 25 samples, all joints moving all the time. `torque_sensor` needs no dynamics on the
//! motor's side, so that it is the estimator alone: filters, least squares or Kalman filter, evidence; `dynamics` is the same
//! with positions and motor torques, from which the rigid body's torque has to be taken. As in `kernels.rs`, ratios are what
//! to read.

#![allow(clippy::print_stdout, reason = "a program that prints a table")]

#[path = "common/vectors.rs"]
mod vectors;

use std::hint::black_box;
use std::time::Instant;

use takt_motion::budget::Budget;
use takt_motion::drive::estimate::{EstimatorMethod, EstimatorOptions, FrictionEstimator, FrictionLaw, FrictionSide};
use takt_motion::drive::telemetry::Telemetry;
use takt_motion::robot::Robot;

const JOINTS: usize = 6;

/// Samples of a block: short, so that on a busy machine most are not interrupted.
const SAMPLES: usize = 25;

/// Blocks that are made at a time.
const BLOCKS: usize = 40;

const BATCHES: usize = 2000;

/// Blocks before the first that counts: filters settle for 0.16 s, in which samples are skipped.
const WARM_UP: usize = 80;

fn main() {
    let robot = ur5e();
    let rich = FrictionLaw {
        by_direction: true,
        load: true,
        quadratic: true,
    };
    for (method_name, method) in [
        ("least_squares", EstimatorMethod::LeastSquares),
        ("observer", EstimatorMethod::Observer),
        ("kalman", EstimatorMethod::Kalman),
    ] {
        for (law_name, law) in [("2_terms", FrictionLaw::default()), ("5_terms", rich)] {
            for (source, side) in [
                ("torque_sensor", FrictionSide::Motor),
                ("dynamics", FrictionSide::Total),
            ] {
                // the load's friction needs the gravity torque, and so the dynamics, whatever the source
                if law.load && side == FrictionSide::Motor {
                    continue;
                }
                let options = EstimatorOptions {
                    method,
                    side,
                    law,
                    ..EstimatorOptions::default()
                };
                measure(&format!("{method_name}/{law_name}/{source}"), &robot, options);
            }
        }
        let options = EstimatorOptions {
            method,
            side: FrictionSide::Motor,
            law: FrictionLaw { load: false, ..rich },
            ..EstimatorOptions::default()
        };
        measure(&format!("{method_name}/4_terms/torque_sensor"), &robot, options);
    }
}

/// The arm of `tests/vectors/robots`.
fn ur5e() -> Robot {
    let mut resolved = vectors::resolved("ur5e");
    for joint in &mut resolved.spec.joints {
        // the observer needs a rotor
        joint.drive.gear_ratio = 101.0;
        joint.drive.rotor_inertia = 1e-4;
    }
    Robot::new(resolved.spec, resolved.warnings).expect("the arm is sound")
}

/// One direction without end, at a speed that changes: nothing is skipped.
fn block(from: usize, sensor: bool) -> Telemetry {
    let times: Vec<f64> = (0..SAMPLES).map(|index| 0.001 * (from + index) as f64).collect();
    let joints = times
        .iter()
        .flat_map(|&time| (0..JOINTS).map(move |joint| (joint as f64, time)));
    let torques: Vec<f64> = joints.clone().map(|(joint, time)| (joint + 5.0 * time).cos()).collect();
    Telemetry {
        output_position: joints
            .map(|(joint, time)| joint + time + 0.1 * (3.0 * time).sin())
            .collect(),
        transmission_torque: if sensor { torques.clone() } else { Vec::new() },
        motor_torque: torques,
        time: times,
        ..Telemetry::default()
    }
}

fn measure(name: &str, robot: &Robot, options: EstimatorOptions) {
    let only = std::env::args().skip_while(|argument| argument != "--only").nth(1);
    if only.is_some_and(|part| !name.contains(&part)) {
        return;
    }
    let sensor = options.side == FrictionSide::Motor;
    let mut estimator = FrictionEstimator::new(robot.clone(), options).expect("the options are sound");
    let mut times = Vec::with_capacity(BATCHES);
    for round in 0..(WARM_UP + BATCHES) / BLOCKS {
        let blocks: Vec<Telemetry> = (0..BLOCKS)
            .map(|index| block((round * BLOCKS + index) * SAMPLES, sensor))
            .collect();
        for block in &blocks {
            let began = Instant::now();
            estimator
                .update(black_box(block), &Budget::unlimited())
                .expect("the block is sound");
            times.push(began.elapsed().as_nanos() as f64 / (SAMPLES * JOINTS) as f64);
        }
    }
    let used = estimator.report().joints[0].used_count;
    let wanted = (BATCHES + WARM_UP / 2) * SAMPLES;
    assert!(used as usize > wanted, "only {used} samples were used");
    times.drain(..WARM_UP);
    times.sort_by(f64::total_cmp);
    println!("{name} {:.1} {:.1}", times[times.len() / 2], times[0]);
}
