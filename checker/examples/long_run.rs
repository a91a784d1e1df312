//! The long run: random moves of every example robot, planned, and each rechecked along the whole motion on a grid at
//! least ten times finer than the planner's own verification.
//!
//! ```text
//! cargo run --release --package takt-checker --example long_run -- FROM..TO [--threads N] [--file PATH]
//! cargo run --release --package takt-checker --example long_run -- SEED
//! ```
//!
//! Every seed from FROM up to TO is one move: robot, poses, payload, utilization, limits and method all follow from it. With a file,
//! each thousand seeds leave a line there; running again goes on where the file ends, and any range can be added to it.
//! At the end, and for a range that is done already, it prints what the file has. The exit code is 1 where any limit
//! was exceeded, with the seed of every such move; a seed alone shows its move in full.
//!
//! The digest is of every bit of every plan: two runs that planned the same have the same one.

#![allow(clippy::print_stdout, reason = "a program that prints a table")]

#[path = "common/asked.rs"]
mod asked;
#[path = "common/findings.rs"]
mod findings;
#[path = "common/payloads.rs"]
mod payloads;
#[path = "common/rich.rs"]
mod rich;
#[path = "common/robots.rs"]
mod robots;
#[path = "common/runs.rs"]
mod runs;

use std::ops::Range;
use std::process::ExitCode;
use std::time::Instant;

use findings::Findings;
use robots::Example;
use runs::{Arguments, Part};
use serde::{Deserialize, Serialize};
use takt_checker::draw::{self, Draw};
use takt_checker::{Arm, Bounds, Checker, Grid, Move, Report};
use takt_motion::budget::Budget;
use takt_motion::plan::outcome::{MoveOutcome, MovePlan};
use takt_motion::plan::plan_move;
use takt_motion::plan::request::{LimitOverride, Method, MoveRequest, Sampling};
use takt_motion::robot::spec::RobotSpec;

/// Relative excess from which on a limit counts as exceeded.
const EXCESS: f64 = 1e-9;

/// A peak torque that a plan states may be lower than the one found by so much of the limit: the error to which the
/// verifier finds extremes.
const UNDERSTATED: f64 = 1e-7;

/// The verifier's samples are at most so far apart, rad or m summed over the joints, and no interval between switching
/// times has fewer than so many: `motion/src/tolerance.rs`.
const VERIFIER_TRAVEL: f64 = 0.2;
const VERIFIER_INTERVALS: usize = 8;

/// How many times finer the recheck looks.
const FINER: usize = 10;

/// Seeds that are done, and written down, together.
const CHUNK: u64 = 1000;

/// What a run found, or a part of it: one line of the file.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
struct Tally {
    from: u64,
    to: u64,
    moves: u64,
    states: u64,
    /// Of planning and of rechecking, s.
    seconds: [f64; 2],
    #[serde(flatten)]
    findings: Findings,
    /// The largest part of a torque limit that may lie between two states of the recheck.
    resolution: f64,
    /// The most by which a plan states less than the peak torque found, as part of the limit.
    understated: (f64, u64),
    /// Of all plans, in no order.
    digest: u64,
}

fn main() -> ExitCode {
    let (robots, arguments) = asked::asked_for();
    if let Some(seed) = arguments.first().and_then(|seed| seed.parse().ok()) {
        return show(&robots, seed);
    }
    let Some(arguments) = Arguments::read(arguments.into_iter(), CHUNK) else {
        println!(
            "usage: long_run FROM..TO [--threads N] [--file PATH] [--rich-friction], or long_run SEED; FROM is whole thousands"
        );
        return ExitCode::from(2);
    };
    let sum = runs::run(&arguments, CHUNK, |seeds| run(&robots, seeds));
    sum.print();
    ExitCode::from(u8::from(!sum.findings.violations.is_empty()))
}

/// The move of one seed, and everything that is known of it. Fails where it exceeds a limit.
fn show(robots: &[Example], seed: u64) -> ExitCode {
    let example = &robots[(seed % robots.len() as u64) as usize];
    let request = draw_request(example, &mut Draw::seeded(seed));
    println!("{} {request:#?}", example.name);
    match plan_move(&example.robot, &request, &Budget::unlimited()) {
        Ok(MoveOutcome::Plan(plan)) => {
            let report = recheck(example, &request, &plan);
            println!("{plan:#?}");
            println!("{report:#?}");
            ExitCode::from(u8::from(!report.holds(EXCESS)))
        }
        other => {
            println!("{other:#?}");
            ExitCode::SUCCESS
        }
    }
}

/// One move a seed.
fn run(robots: &[Example], seeds: Range<u64>) -> Tally {
    let mut tally = Tally {
        from: seeds.start,
        to: seeds.end,
        ..Tally::default()
    };
    for seed in seeds {
        let example = &robots[(seed % robots.len() as u64) as usize];
        let request = draw_request(example, &mut Draw::seeded(seed));
        tally.try_move(seed, example, &request);
    }
    tally
}

/// A move anywhere or near, with any payload that the arm may carry, anywhere between 0.3 and all of its torque.
fn draw_request(example: &Example, draw: &mut Draw) -> MoveRequest {
    let spec = example.robot.spec();
    let (start, target) = draw_poses(spec, draw);
    let mass = draw.between(0.0, example.payload_max);
    let payload = payloads::ball(mass, draw::vector(draw, 0.1));
    let joint = &spec.joints[(draw.bits() % start.len() as u64) as usize];
    let mut part = |limit: Option<f64>, lowest| limit.map(|limit| limit * draw.between(lowest, 1.0));
    let tightened = LimitOverride {
        joint: joint.name.clone(),
        velocity: part(joint.limits.velocity, 0.2),
        acceleration: part(joint.limits.acceleration, 0.2),
        peak_torque: part(joint.drive.peak_torque, 0.5),
        ..LimitOverride::default()
    };
    MoveRequest {
        start,
        target,
        target_velocity: None,
        payload: (!draw.bits().is_multiple_of(8)).then_some(payload),
        limits: draw.bits().is_multiple_of(4).then_some(tightened).into_iter().collect(),
        torque_utilization: [1.0, draw.between(0.3, 1.0)][usize::from(!draw.bits().is_multiple_of(4))],
        speed_scale: [1.0, draw.between(0.1, 1.0)][(draw.bits() % 2) as usize],
        method: match draw.bits() % 20 {
            0..3 => Method::Preset,
            3..6 => Method::Endpoint,
            _ => Method::Verified,
        },
        sampling: match draw.bits() % 32 {
            0 => Sampling::Period(0.004),
            _ => Sampling::None,
        },
        cycle_time: None,
    }
}

/// Anywhere; within 1 rad or m of the start; within 0.1; within 0.001; now and then a joint stands still.
fn draw_poses(spec: &RobotSpec, draw: &mut Draw) -> (Vec<f64>, Vec<f64>) {
    let start = draw::pose_within(draw, spec);
    let reach = [
        f64::INFINITY,
        f64::INFINITY,
        f64::INFINITY,
        f64::INFINITY,
        1.0,
        1.0,
        0.1,
        1e-3,
    ];
    let reach = reach[(draw.bits() % 8) as usize];
    let target = spec
        .joints
        .iter()
        .zip(&start)
        .map(|(joint, start)| {
            let low = joint.limits.position_lower.unwrap_or(f64::NEG_INFINITY);
            let high = joint.limits.position_upper.unwrap_or(f64::INFINITY);
            let target = draw.between(low.max(start - reach), high.min(start + reach));
            match draw.bits() % 16 {
                0 => *start,
                _ => target,
            }
        })
        .collect();
    (start, target)
}

impl Tally {
    fn try_move(&mut self, seed: u64, example: &Example, request: &MoveRequest) {
        self.moves += 1;
        let began = Instant::now();
        let outcome = plan_move(&example.robot, request, &Budget::unlimited());
        self.seconds[0] += began.elapsed().as_secs_f64();
        let refused = match outcome {
            Ok(MoveOutcome::Plan(plan)) => {
                self.findings.count_plan(format!("{} {:?}", example.name, plan.method));
                let began = Instant::now();
                let report = recheck(example, request, &plan);
                self.seconds[1] += began.elapsed().as_secs_f64();
                self.states += report.sample_count as u64;
                self.digest = self.digest.wrapping_add(digest(seed, &plan));
                self.judge(seed, &example.name, &report, &plan);
                return;
            }
            Ok(MoveOutcome::Infeasible(infeasible)) => format!("{:?}", infeasible.reason),
            Err(failure) => {
                self.findings
                    .violations
                    .push(format!("seed {seed}, {}: {failure:?}", example.name));
                "Failure".to_owned()
            }
        };
        self.findings.count_refusal(format!("{} {refused}", example.name));
    }

    fn judge(&mut self, seed: u64, name: &str, report: &Report, plan: &MovePlan) {
        let method = plan.method;
        for (joint, found) in report.joints.iter().enumerate() {
            for (kind, extreme) in found.extremes() {
                let Some(excess) = extreme.excess else { continue };
                let key = format!("{name} {kind:?}");
                self.findings.keep_excess(key, excess, seed);
            }
            let Some(limit) = found.torque.limit else { continue };
            self.resolution = self.resolution.max(found.torque_resolution / limit);
            let stated = plan.torque_margins.iter().find(|margin| margin.joint == joint);
            let stated = stated.map_or(0.0, |margin| margin.peak_torque.abs());
            let less = (found.torque.value.abs() - stated) / limit;
            if less > self.understated.0 {
                self.understated = (less, seed);
            }
            if less > UNDERSTATED {
                self.findings.violations.push(format!(
                    "seed {seed}, {name}: joint {joint} states a peak torque {less:.1e} too low"
                ));
            }
        }
        if !report.holds(EXCESS) {
            let (worst, odd) = (report.worst(), &report.inconsistencies);
            self.findings
                .violations
                .push(format!("seed {seed}, {name}, {method:?}: {worst:?} {odd:?}"));
        }
    }

    fn print(&self) {
        println!(
            "\n{} moves, {:.0} million states rechecked",
            self.moves,
            self.states as f64 / 1e6
        );
        println!(
            "{:.0} s of planning, {:.0} s of rechecking",
            self.seconds[0], self.seconds[1]
        );
        self.findings.print_counts();
        self.findings.print_worst();
        println!(
            "\ntorque between two states: at most {:.1e} of a limit",
            self.resolution
        );
        let (less, seed) = self.understated;
        println!("peak torque stated too low by at most {less:.1e} of a limit (seed {seed})");
        println!("digest of all plans {:016x}", self.digest);
        self.findings.print_violations();
    }
}

impl Part for Tally {
    fn begin(&self) -> u64 {
        self.from
    }

    fn progress(&self) -> (u64, usize) {
        (self.moves, self.findings.violations.len())
    }

    fn add(&mut self, part: &Self) {
        self.moves += part.moves;
        self.states += part.states;
        for (sum, seconds) in self.seconds.iter_mut().zip(part.seconds) {
            *sum += seconds;
        }
        self.findings.add(&part.findings);
        self.resolution = self.resolution.max(part.resolution);
        if part.understated.0 > self.understated.0 {
            self.understated = part.understated;
        }
        self.digest = self.digest.wrapping_add(part.digest);
    }
}

fn recheck(example: &Example, request: &MoveRequest, plan: &MovePlan) -> Report {
    let spec = example.robot.spec();
    let emitted = Move {
        start: &request.start,
        target: &request.target,
        patterns: &plan.patterns,
    };
    Checker::new(Arm::new(spec, request.payload.as_ref()))
        .check(&Bounds::of_request(spec, request), &emitted, grid(plan))
        .expect("one entry a joint")
}

/// Of every number of a plan, by the hash of Fowler, Noll and Vo over their bits.
fn digest(seed: u64, plan: &MovePlan) -> u64 {
    let patterns = plan.patterns.iter().flat_map(|pattern| {
        [
            pattern.displacement,
            pattern.peak_velocity,
            pattern.acceleration,
            pattern.deceleration,
            pattern.acceleration_time,
            pattern.cruise_time,
            pattern.deceleration_time,
        ]
    });
    let margins = plan.torque_margins.iter().flat_map(|margin| {
        [
            margin.peak_torque,
            margin.time,
            margin.rms_torque,
            margin.peak_motor_speed,
            margin.peak_power,
        ]
    });
    let safety = plan
        .override_safe
        .iter()
        .flat_map(|safety| [safety.torque, safety.worst_override]);
    patterns
        .chain(margins)
        .chain(safety)
        .flat_map(|number| number.to_bits().to_le_bytes())
        .fold(seed ^ 0xcbf2_9ce4_8422_2325, |hash, byte| {
            (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3)
        })
}

/// At least [`FINER`] steps for every one of the verifier's, which samples each interval by how far the joints travel in it: at most
/// their peak velocities times its duration.
fn grid(plan: &MovePlan) -> Grid {
    let fastest: f64 = plan.patterns.iter().map(|pattern| pattern.peak_velocity.abs()).sum();
    let intervals = fastest * plan.duration / VERIFIER_TRAVEL;
    Grid {
        per_interval: FINER * VERIFIER_INTERVALS,
        per_move: FINER * intervals.ceil() as usize,
    }
}
