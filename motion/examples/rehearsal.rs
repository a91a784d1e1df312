//! What adapted friction is worth: three arms run a program with friction that is half as large again as the model's, or half of it.
//!
//! ```text
//! cargo run --release --package takt-motion --example rehearsal
//! ```
//!
//! `docs/rehearsal.md` has the table and says what is assumed. One line a joint and friction: peak and RMS error of the joint, what
//! the plan leaves of the torque limit, and what is truly left, without adaptation and with it.

#![allow(clippy::print_stdout, reason = "a program that prints a table")]

use takt_motion::budget::Budget;
use takt_motion::drive::rehearse::outcome::{Rehearsal, RehearsalOutcome, Run};
use takt_motion::drive::rehearse::rehearse;
use takt_motion::drive::rehearse::request::{FrictionTruth, RehearsalRequest};

#[path = "rehearsal/arms.rs"]
mod arms;

fn main() {
    for arm in arms::all() {
        for scale in [1.0, 1.5, 0.5] {
            let mut request = RehearsalRequest::new(arm.motion.clone());
            request.settle = 0.25;
            let truth = FrictionTruth {
                coulomb_scale: scale,
                viscous_scale: scale,
                ..FrictionTruth::default()
            };
            request.friction = vec![truth; arm.robot.joint_count()];
            let outcome = rehearse(&arm.robot, &request, &Budget::unlimited()).expect("the request is sound");
            let RehearsalOutcome::Run(run) = outcome else {
                panic!("{}: {outcome:?}", arm.name);
            };
            print(arm.name, scale, &run);
        }
    }
}

fn print(arm: &str, scale: f64, run: &Rehearsal) {
    println!(
        "\n{arm}, friction {scale} of the model's, {:.3} s, {} of {} steps exact",
        run.duration, run.smoothness.exact_steps, run.smoothness.steps
    );
    println!("joint | planned margin % | plain: peak mrad, RMS mrad, true margin % | adapted: peak, RMS, true margin");
    for joint in 0..run.planned_torque.len() {
        let planned = run.plain.joints[joint]
            .torque_limit
            .map_or(f64::NAN, |limit| 1.0 - run.planned_torque[joint] / limit);
        let of = |run: &Run| {
            let joint = &run.joints[joint];
            let margin = joint.margin.map_or(f64::NAN, |margin| 100.0 * margin);
            format!(
                "{:8.3} {:8.3} {margin:7.1}",
                1e3 * joint.error_peak,
                1e3 * joint.error_rms
            )
        };
        println!(
            "{joint} | {:6.1} | {} | {}",
            100.0 * planned,
            of(&run.plain),
            of(&run.adapted)
        );
    }
    let tool = |run: &Run| {
        format!(
            "{:.3} mm peak, {:.3} mm RMS, {:?}",
            1e3 * run.tool_error_peak,
            1e3 * run.tool_error_rms,
            run.end
        )
    };
    println!("tool | {} | {}", tool(&run.plain), tool(&run.adapted));
}
