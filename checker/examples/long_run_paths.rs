//! The long run of timed paths: random programs of every example robot, planned, and each rechecked from its set-points,
//! most of them ten times denser than the grid that the path was timed on.
//!
//! ```text
//! cargo run --release --package takt-checker --example long_run_paths -- FROM..TO [--threads N] [--file PATH]
//! cargo run --release --package takt-checker --example long_run_paths -- SEED
//! ```
//!
//! Every seed from FROM up to TO is one program: robot, segments, blends, payload, limits, jerk and sampling all follow
//! from it. With a file, each hundred seeds leave a line there; running again goes on where the file ends, and any range
//! can be added to it. At the end, and for a range that is done already, it prints what the file has. The exit code is 1
//! where any limit was exceeded or anything else was wrong, with the seed of every such program; a seed alone shows its
//! program and its report in full.

#![allow(clippy::print_stdout, reason = "a program that prints a table")]

#[path = "common/asked.rs"]
mod asked;
#[path = "common/findings.rs"]
mod findings;
#[path = "common/programs.rs"]
mod programs;
#[path = "common/rich.rs"]
mod rich;
#[path = "common/robots.rs"]
mod robots;
#[path = "common/runs.rs"]
mod runs;

use std::collections::BTreeMap;
use std::ops::Range;
use std::process::ExitCode;
use std::time::Instant;

use findings::Findings;
use programs::Trial;
use robots::Example;
use runs::{Arguments, Part};
use serde::{Deserialize, Serialize};
use takt_checker::path::report::PathReport;
use takt_checker::recheck_path;
use takt_checker::statistics::quantile;
use takt_motion::Invalid;
use takt_motion::budget::Budget;
use takt_motion::path::outcome::{PathOutcome, PathPlan};
use takt_motion::path::plan_path;
use takt_motion::path::request::{ArcOrientation, PathRequest, Shape};
use takt_motion::plan::Failure;

/// Seeds that are done, and written down, together.
const CHUNK: u64 = 100;

/// What a run found, or a part of it: one line of the file.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
struct Tally {
    from: u64,
    to: u64,
    programs: u64,
    set_points: u64,
    #[serde(flatten)]
    findings: Findings,
    /// Times of planning without sampling, s, by robot and jerk.
    planning: BTreeMap<String, Vec<f64>>,
}

fn main() -> ExitCode {
    let (robots, arguments) = asked::asked_for();
    if let Some(seed) = arguments.first().and_then(|seed| seed.parse().ok()) {
        return show(&robots, seed);
    }
    let Some(arguments) = Arguments::read(arguments.into_iter(), CHUNK) else {
        println!(
            "usage: long_run_paths FROM..TO [--threads N] [--file PATH] [--rich-friction], or long_run_paths SEED; FROM is \
             whole hundreds"
        );
        return ExitCode::from(2);
    };
    let sum = runs::run(&arguments, CHUNK, |seeds| run(&robots, seeds));
    sum.print();
    ExitCode::from(u8::from(!sum.findings.violations.is_empty()))
}

/// The program of one seed, and everything that is known of it.
fn show(robots: &[Example], seed: u64) -> ExitCode {
    let trial = programs::of_seed(robots, seed, programs::FINE);
    println!("{} {:#?}", trial.example.name, trial.request);
    match plan_path(&trial.example.robot, &trial.request, &Budget::unlimited()) {
        Ok(PathOutcome::Plan(mut plan)) => {
            let report = recheck(&trial, &plan);
            // Thousands of lines that nobody reads.
            plan.setpoints = None;
            println!("{plan:#?}");
            println!("{report:#?}");
            ExitCode::from(u8::from(!report.holds()))
        }
        other => {
            println!("{other:#?}");
            ExitCode::SUCCESS
        }
    }
}

fn recheck(trial: &Trial<'_>, plan: &PathPlan) -> PathReport {
    recheck_path(trial.example.robot.spec(), &trial.request, plan, trial.density)
}

/// Whether a drawn program is none, for the one reason that there may be: behind an arc that turns the tool with it, a
/// spline is drawn as if the arc had not, and its first point may be farther away in orientation than it may.
fn is_none(request: &PathRequest, found: &[Invalid]) -> bool {
    let turned = |index: usize| {
        let before = index.checked_sub(1).map(|before| &request.segments[before].shape);
        matches!(before, Some(Shape::Arc(arc)) if arc.orientation == ArcOrientation::Tangent)
    };
    let [only] = found else { return false };
    let segments = 0..request.segments.len();
    only.message.starts_with("the orientation is")
        && segments
            .into_iter()
            .any(|index| turned(index) && only.path == format!("segments[{index}].spline.points[0]"))
}

/// One program a seed.
fn run(robots: &[Example], seeds: Range<u64>) -> Tally {
    let mut tally = Tally {
        from: seeds.start,
        to: seeds.end,
        ..Tally::default()
    };
    for seed in seeds {
        tally.try_program(seed, &programs::of_seed(robots, seed, programs::FINE));
    }
    tally
}

impl Tally {
    fn try_program(&mut self, seed: u64, trial: &Trial<'_>) {
        self.programs += 1;
        let name = &trial.example.name;
        let jerk = if trial.request.limit_jerk { "jerk" } else { "no jerk" };
        let outcome = plan_path(&trial.example.robot, &trial.request, &Budget::unlimited());
        let refused = match outcome {
            Ok(PathOutcome::Plan(plan)) => {
                self.findings.count_plan(format!("{name} {jerk}"));
                self.time(trial, format!("{name} {jerk}"));
                let report = recheck(trial, &plan);
                self.set_points += report.sample_count as u64;
                self.judge(seed, name, &report);
                return;
            }
            Ok(PathOutcome::Infeasible(infeasible)) => format!("{:?}", infeasible.reason),
            Err(Failure::Invalid(found)) if is_none(&trial.request, &found) => "NoProgram".to_owned(),
            Err(failure) => {
                self.findings
                    .violations
                    .push(format!("seed {seed}, {name}: {failure:?}"));
                "Failure".to_owned()
            }
        };
        self.findings.count_refusal(format!("{name} {refused}"));
    }

    /// Plans once more as a caller would who wants set-points at 4 ms, and keeps the time it took.
    fn time(&mut self, trial: &Trial<'_>, key: String) {
        let mut request = trial.request.clone();
        request.sampling = takt_motion::plan::request::Sampling::Period(0.004);
        let began = Instant::now();
        let planned = plan_path(&trial.example.robot, &request, &Budget::unlimited());
        let took = began.elapsed().as_secs_f64();
        if planned.is_ok() {
            self.planning.entry(key).or_default().push(took);
        }
    }

    fn judge(&mut self, seed: u64, name: &str, report: &PathReport) {
        for extreme in &report.extremes {
            let key = format!("{name} {:?} {:?}", extreme.kind, extreme.source);
            self.findings.keep_excess(key, extreme.excess, seed);
        }
        for extreme in report.violations() {
            self.findings
                .violations
                .push(format!("seed {seed}, {name}: {extreme:?}"));
        }
        for fault in &report.faults {
            self.findings.violations.push(format!("seed {seed}, {name}: {fault:?}"));
        }
    }

    fn print(&self) {
        println!(
            "\n{} programs, {:.1} million set-points rechecked",
            self.programs,
            self.set_points as f64 / 1e6
        );
        self.findings.print_counts();
        println!("\nplanning with set-points every 4 ms, ms: median, 95th percentile, longest");
        for (key, times) in &self.planning {
            let mut sorted = times.clone();
            sorted.sort_by(f64::total_cmp);
            let [median, late, longest] = [0.5, 0.95, 1.0].map(|share| 1e3 * quantile(&sorted, share));
            println!("  {key:<40} {median:>9.1} {late:>9.1} {longest:>9.1}");
        }
        self.findings.print_worst();
        self.findings.print_violations();
    }
}

impl Part for Tally {
    fn begin(&self) -> u64 {
        self.from
    }

    fn progress(&self) -> (u64, usize) {
        (self.programs, self.findings.violations.len())
    }

    fn add(&mut self, part: &Self) {
        self.programs += part.programs;
        self.set_points += part.set_points;
        self.findings.add(&part.findings);
        for (key, times) in &part.planning {
            self.planning.entry(key.clone()).or_default().extend(times);
        }
    }
}
