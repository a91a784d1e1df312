//! What adapted friction is worth: three arms run a program with friction that is half as large again as the model's, or half of it.
//!
//! ```text
//! cargo run --release --package takt-motion --example rehearsal
//! ```
//!
//! `docs/rehearsal.md` has the table and says what is assumed. One line a joint and friction: peak and RMS error of the joint, what
//! the plan leaves of the torque limit, and what is truly left: without adaptation, with the observer alone, and with the learned law.

#![allow(clippy::print_stdout, reason = "a program that prints a table")]

use takt_motion::budget::Budget;
use takt_motion::drive::controller::Adaptation;
use takt_motion::drive::rehearse::outcome::{Rehearsal, RehearsalOutcome, RunEnd};
use takt_motion::drive::rehearse::rehearse;
use takt_motion::drive::rehearse::request::{FrictionTruth, Motion, RehearsalRequest};

#[path = "rehearsal/arms.rs"]
mod arms;

fn main() {
    for arm in arms::all() {
        for scale in [1.0, 1.5, 0.5] {
            let observer = run(&arm, scale, Adaptation::Observer { rate: None });
            let law = run(&arm, scale, Adaptation::default());
            print(arm.name, scale, &observer, &law);
        }
    }
}

fn run(arm: &arms::Arm, scale: f64, adaptation: Adaptation) -> Rehearsal {
    let truth = FrictionTruth {
        coulomb_scale: scale,
        viscous_scale: scale,
        ..FrictionTruth::default()
    };
    let request = RehearsalRequest {
        settle: 0.25,
        friction: vec![truth; arm.robot.joint_count()],
        adaptation,
        ..RehearsalRequest::new(Motion::Path(Box::new(arm.program.clone())))
    };
    match rehearse(&arm.robot, &request, &Budget::unlimited()).expect("the request is sound") {
        RehearsalOutcome::Run(run) => *run,
        other => panic!("{}: {other:?}", arm.name),
    }
}

fn print(arm: &str, scale: f64, observer: &Rehearsal, law: &Rehearsal) {
    println!(
        "\n{arm}, friction {scale} of the model's, {:.3} s, motor acceleration exact at {} of {} steps",
        law.duration, law.smoothness.exact_steps, law.smoothness.steps
    );
    println!("      |  planned | no adaptation             | observer                  | learned law and observer");
    println!("joint | margin % | peak mrad RMS mrad marg % | peak mrad RMS mrad marg % | peak mrad RMS mrad marg %");
    let runs = [&law.plain, &observer.adapted, &law.adapted];
    for (joint, planned) in law.planned_torque.iter().enumerate() {
        let limit = law.plain.joints[joint].torque_limit;
        let margin = limit.map_or(f64::NAN, |limit| 100.0 * (1.0 - planned / limit));
        print!("{joint:5} | {margin:8.1}");
        for run in runs {
            let joint = &run.joints[joint];
            let margin = joint.margin.map_or(f64::NAN, |margin| 100.0 * margin);
            print!(
                " | {:9.3} {:8.3} {margin:6.1}",
                1e3 * joint.error_peak,
                1e3 * joint.error_rms
            );
        }
        println!();
    }
    print!(" tool |       mm");
    for run in runs {
        print!(
            " | {:9.3} {:8.3}       ",
            1e3 * run.tool_error_peak,
            1e3 * run.tool_error_rms
        );
    }
    println!();
    if runs.iter().any(|run| run.end != RunEnd::Completed) {
        println!("not completed: {:?}", runs.map(|run| run.end));
    }
}
