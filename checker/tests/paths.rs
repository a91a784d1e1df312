//! The planner's timed paths, looked at by someone else: random programs of every example robot keep every limit, at
//! their set-points and between them, and say of themselves what is so.

#[path = "../examples/common/programs.rs"]
#[allow(dead_code, reason = "shared with programs that need more of it")]
mod programs;
#[path = "../examples/common/robots.rs"]
#[allow(dead_code, reason = "shared with programs that need more of it")]
mod robots;

use std::collections::BTreeMap;

use programs::Trial;
use robots::Example;
use takt_checker::path::report::{FaultKind, PathReport};
use takt_checker::recheck_path;
use takt_motion::budget::Budget;
use takt_motion::path::outcome::{PathLimit, PathOutcome, PathPlan};
use takt_motion::path::plan_path;
use takt_motion::path::request::PathRequest;

/// Programs of each robot.
const PROGRAMS: u64 = 130;

/// Set-points between two stops; the long run takes ten times the timing's grid.
const FINE: usize = 1000;

fn plan(example: &Example, request: &PathRequest) -> Result<Box<PathPlan>, String> {
    match plan_path(&example.robot, request, &Budget::unlimited()) {
        Ok(PathOutcome::Plan(plan)) => Ok(plan),
        Ok(PathOutcome::Infeasible(infeasible)) => Err(format!("{:?}", infeasible.reason)),
        Err(failure) => panic!("{}: {failure:?}\n{request:#?}", example.name),
    }
}

fn recheck(trial: &Trial<'_>, plan: &PathPlan) -> PathReport {
    recheck_path(trial.example.robot.spec(), &trial.request, plan, trial.density)
}

/// The programs of one robot: every plan holds, and at least `share` of them, in per cent, have one.
fn check(robot: usize, share: u64) {
    let robots = robots::all();
    let mut refused: BTreeMap<String, u64> = BTreeMap::new();
    for program in 0..PROGRAMS {
        let seed = program * robots.len() as u64 + robot as u64;
        let trial = programs::of_seed(&robots, seed, FINE);
        let plan = match plan(trial.example, &trial.request) {
            Ok(plan) => plan,
            Err(reason) => {
                *refused.entry(reason).or_default() += 1;
                continue;
            }
        };
        let report = recheck(&trial, &plan);
        let broken: Vec<_> = report.violations().collect();
        assert!(
            report.holds(),
            "seed {seed}, {}: {broken:#?} {:#?}",
            trial.example.name,
            report.faults
        );
    }
    let plans = PROGRAMS - refused.values().sum::<u64>();
    assert!(
        100 * plans >= share * PROGRAMS,
        "{plans} of {PROGRAMS} have a plan, refused {refused:?}"
    );
}

#[test]
fn fr3_keeps_every_limit() {
    check(0, 50);
}

#[test]
fn puma_keeps_every_limit() {
    check(1, 50);
}

#[test]
fn scara_keeps_every_limit() {
    check(2, 50);
}

#[test]
fn ur5e_keeps_every_limit() {
    check(3, 50);
}
