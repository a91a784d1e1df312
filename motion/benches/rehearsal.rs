//! What a second of rehearsal takes, ms: median and fastest of many, one line each.
//!
//! ```text
//! cargo bench --package takt-motion --bench rehearsal
//! ```
//!
//! One second of quintic set-points at 1 kHz control on the arms of `examples/rehearsal.rs`, friction half as large again as the model's. A
//! rehearsal is two runs, without adaptation and with it, and their feed-forward: all of that is one figure, and half of it is what one
//! run takes. Also what a step of the controller takes of six joints, ns.

#![allow(clippy::print_stdout, reason = "a program that prints a table")]

use std::hint::black_box;
use std::time::Instant;

use takt_motion::budget::Budget;
use takt_motion::drive::controller::{Adaptation, Command, Controller, Measured, default_gains};
use takt_motion::drive::feedforward::Desired;
use takt_motion::drive::rehearse::outcome::{Rehearsal, RehearsalOutcome};
use takt_motion::drive::rehearse::rehearse;
use takt_motion::drive::rehearse::request::{
    Encoder, FrictionTruth, Motion, RehearsalRequest, SetpointMotion, WrenchPulse,
};
use takt_motion::nalgebra::Vector3;
use takt_motion::plan::request::TrajectoryPoint;
use takt_motion::robot::Robot;

#[path = "../examples/rehearsal/arms.rs"]
mod arms;

const REPEATS: usize = 40;

fn main() {
    for arm in arms::all() {
        let start = arm.program.start;
        let count = arm.robot.joint_count();
        let mut request = RehearsalRequest::new(there_and_back(&start));
        request.friction = vec![
            FrictionTruth {
                coulomb_scale: 1.5,
                viscous_scale: 1.5,
                ..FrictionTruth::default()
            };
            count
        ];
        measure(&format!("{}/friction", arm.name), &arm.robot, &request);
        request.encoders = vec![
            Encoder {
                motor_step: 2e-6,
                motor_noise: 1e-6,
                output_step: 1e-5,
                output_noise: 5e-6,
                ..Encoder::default()
            };
            count
        ];
        request.wrenches = vec![WrenchPulse {
            begin: 0.3,
            end: 0.7,
            force: Vector3::new(10.0, 0.0, -20.0),
            moment: Vector3::zeros(),
        }];
        measure(&format!("{}/friction_encoders_wrench", arm.name), &arm.robot, &request);
        step(arm.name, &arm.robot, &start);
    }
}

/// A radian a joint and back within a second.
fn there_and_back(start: &[f64]) -> Motion {
    let point = |time: f64, way: f64, acceleration: f64| TrajectoryPoint {
        time,
        position: start.iter().map(|q| q + way).collect(),
        velocity: vec![0.0; start.len()],
        acceleration: vec![acceleration; start.len()],
    };
    Motion::Setpoints(SetpointMotion {
        points: vec![point(0.0, 0.0, 0.0), point(0.5, 0.3, -4.0), point(1.0, 0.0, 0.0)],
        interpolation: None,
        payload: None,
    })
}

fn measure(name: &str, robot: &Robot, request: &RehearsalRequest) {
    let mut times = Vec::new();
    let mut last: Option<Box<Rehearsal>> = None;
    for _ in 0..REPEATS {
        let begin = Instant::now();
        let outcome = rehearse(black_box(robot), black_box(request), &Budget::unlimited()).expect("it is sound");
        times.push(begin.elapsed().as_secs_f64() * 1e3);
        match outcome {
            RehearsalOutcome::Run(run) => last = Some(run),
            other => panic!("{other:?}"),
        }
    }
    times.sort_by(f64::total_cmp);
    let run = last.expect("it was repeated");
    println!(
        "{name:40} {:8.2} {:8.2} ms, {} and {} integrator steps, {:?}",
        times[REPEATS / 2],
        times[0],
        run.plain.integrator_steps,
        run.adapted.integrator_steps,
        run.adapted.end
    );
}

fn step(name: &str, robot: &Robot, start: &[f64]) {
    const STEPS: usize = 1000;
    let gains = default_gains(robot, &[start.to_vec()], 1e-3);
    let controller = Controller::new(robot, &gains, &[], Adaptation::default(), 1e-3).expect("it is sound");
    let desired = vec![
        Desired {
            velocity: 0.5,
            motor_velocity: 0.5,
            rigid_torque: 10.0,
            ..Desired::default()
        };
        start.len()
    ];
    let mut measured = vec![Measured::default(); start.len()];
    let mut commands = vec![Command::default(); start.len()];
    let mut times: Vec<f64> = (0..200)
        .map(|_| {
            let mut states = controller.start();
            let begin = Instant::now();
            for k in 0..STEPS {
                for measured in &mut measured {
                    measured.motor_position = 5e-4 * k as f64;
                    measured.output_position = Some(5e-4 * k as f64 - 1e-3);
                }
                controller.step(&mut states, black_box(&measured), &desired, &desired, &mut commands);
                black_box(&mut commands);
            }
            begin.elapsed().as_secs_f64() * 1e9 / STEPS as f64
        })
        .collect();
    times.sort_by(f64::total_cmp);
    println!(
        "{:40} {:8.0} {:8.0} ns",
        format!("{name}/controller_step"),
        times[100],
        times[0]
    );
}
