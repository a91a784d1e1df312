//! The planner's timed paths, looked at by someone else: random programs of every example robot keep every limit, at
//! their set-points and between them, and say of themselves what is so.

#[path = "../examples/common/programs.rs"]
mod programs;
#[path = "../examples/common/rich.rs"]
mod rich;
#[path = "../examples/common/robots.rs"]
mod robots;

use std::collections::BTreeMap;

use programs::Trial;
use robots::Example;
use takt_checker::draw::Draw;
use takt_checker::path::report::{FaultKind, PathReport};
use takt_checker::recheck_path;
use takt_checker::{Density, draw_program};
use takt_motion::budget::Budget;
use takt_motion::path::outcome::{PathLimit, PathOutcome, PathPlan};
use takt_motion::path::plan_path;
use takt_motion::path::request::PathRequest;
use takt_motion::plan::request::Sampling;

/// Programs of each robot.
const PROGRAMS: u64 = 130;

/// Set-points between two stops; the long run takes ten times the timing's grid.
const FINE: usize = 1000;

/// The program of a seed with speeds at its ends. Such a motion is not stretched to whole cycles: it is sampled as a trace.
fn moving_of_seed(robots: &[Example], seed: u64, fine: usize) -> Trial<'_> {
    let mut trial = programs::of_seed(robots, seed, fine);
    let draw = &mut Draw::seeded(!seed);
    draw_program::with_boundary_speeds(draw, trial.example.robot.spec(), &mut trial.request);
    if matches!(trial.request.sampling, Sampling::Period(_)) {
        trial.request.sampling = Sampling::Trace(fine + 1);
        trial.density = Density::Coarse;
    }
    trial
}

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
    check_some(&robots::all(), robot, PROGRAMS, share);
}

fn check_some(robots: &[Example], robot: usize, programs: u64, share: u64) {
    let mut refused: BTreeMap<String, u64> = BTreeMap::new();
    for program in 0..programs {
        let seed = program * robots.len() as u64 + robot as u64;
        let trial = programs::of_seed(robots, seed, FINE);
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
    let plans = programs - refused.values().sum::<u64>();
    assert!(
        100 * plans >= share * programs,
        "{plans} of {programs} have a plan, refused {refused:?}"
    );
}

/// Speeds at the ends of the path, with jerk limits and without: every plan holds and has them, and what has no plan says
/// that its ends are to blame.
#[test]
fn speeds_at_the_ends_are_had_within_every_limit() {
    let robots = robots::all();
    let mut refused: BTreeMap<String, u64> = BTreeMap::new();
    let mut plans = [0; 2];
    for seed in 0..48 {
        let trial = moving_of_seed(&robots, seed, FINE);
        match plan(trial.example, &trial.request) {
            Ok(plan) => {
                let report = recheck(&trial, &plan);
                let broken: Vec<_> = report.violations().collect();
                assert!(report.holds(), "seed {seed}: {broken:#?} {:#?}", report.faults);
                plans[usize::from(trial.request.limit_jerk)] += 1;
            }
            Err(reason) => *refused.entry(reason).or_default() += 1,
        }
    }
    assert!(plans.iter().all(|plans| *plans >= 8), "{plans:?} {refused:?}");
}

#[test]
fn drives_that_rub_with_their_load_and_with_the_speed_squared_keep_every_limit() {
    let robots = rich::with_rich_friction(robots::all());
    for robot in 0..robots.len() {
        check_some(&robots, robot, 20, 50);
    }
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

/// The first plans of the programs whose jerk is not limited, all robots in turn.
fn plans(robots: &[Example], count: usize, fine: usize) -> Vec<(Trial<'_>, Box<PathPlan>)> {
    let trials = (0..).map(|seed| programs::of_seed(robots, seed, fine));
    let planned = trials.filter(|trial| !trial.request.limit_jerk).filter_map(|trial| {
        let plan = plan(trial.example, &trial.request).ok()?;
        Some((trial, plan))
    });
    planned.take(count).collect()
}

#[test]
fn plans_sped_up_by_one_per_cent_are_found() {
    let robots = robots::all();
    for (trial, mut plan) in plans(&robots, 12, FINE) {
        let setpoints = &mut plan.setpoints.as_mut().expect("set-points were asked for").samples;
        for time in &mut setpoints.time {
            *time /= 1.01;
        }
        for joint in &mut setpoints.joints {
            joint.velocity.iter_mut().for_each(|rate| *rate *= 1.01);
            joint.acceleration.iter_mut().for_each(|rate| *rate *= 1.01 * 1.01);
        }
        let report = recheck(&trial, &plan);
        assert!(report.violations().next().is_some(), "{:#?}", trial.request);
    }
}

#[test]
fn a_set_point_nudged_is_found() {
    let robots = robots::all();
    for (trial, mut plan) in plans(&robots, 12, FINE) {
        let joints = &mut plan
            .setpoints
            .as_mut()
            .expect("set-points were asked for")
            .samples
            .joints;
        let middle = joints[0].position.len() / 2;
        // A tenth of a millimetre at a metre's reach.
        joints[0].position[middle] += 1e-4;
        assert!(!recheck(&trial, &plan).holds(), "{:#?}", trial.request);
    }
}

#[test]
fn limits_lowered_by_a_thousandth_are_found_broken() {
    let robots = robots::all();
    let mut seen = 0;
    for (mut trial, plan) in plans(&robots, 12, programs::FINE) {
        // A plan that is stretched to whole cycles may keep every limit with more than that to spare.
        if matches!(trial.request.sampling, Sampling::Period(_)) {
            continue;
        }
        let request = &mut trial.request;
        for scale in [
            &mut request.torque_utilization,
            &mut request.speed_scale,
            &mut request.acceleration_scale,
        ] {
            *scale *= 0.999;
        }
        let own = request.segments.iter_mut().flat_map(|segment| &mut segment.limits);
        for limit in request.limits.iter_mut().chain(own) {
            limit.peak_torque = limit.peak_torque.map(|peak| 0.999 * peak);
        }
        let report = recheck(&trial, &plan);
        assert!(report.violations().next().is_some(), "{:#?}", trial.request);
        seen += 1;
    }
    assert!(seen >= 6, "{seen} plans");
}

#[test]
fn claims_that_are_too_good_are_found() {
    let robots = robots::all();
    for (trial, mut plan) in plans(&robots, 12, FINE) {
        // The tightest limit is seen at the set-points to a thousandth, or a trace of a thousand shows nothing.
        let told = plan.limit_uses.iter_mut().find(|told| told.kind == PathLimit::Torque);
        let told = told.expect("torque is limited");
        told.value *= 0.9;
        told.margin = (told.limit - told.value.abs()) / told.limit;
        let report = recheck(&trial, &plan);
        assert!(
            report.faults.iter().any(|fault| fault.kind == FaultKind::Use),
            "{:#?}",
            trial.request
        );
    }
}

/// Set-points less than a microsecond before a stop without dwell, where one joint is slower than can be told, or all of
/// them are (3682, 7489, 7626); a stop braked without acceleration limits, at a drive's period (6853).
#[test]
fn set_points_next_to_a_stop_say_which_way_every_joint_moves() {
    let robots = robots::all();
    for seed in [3682, 6853, 7489, 7626] {
        let trial = programs::of_seed(&robots, seed, programs::FINE);
        let plan = plan(trial.example, &trial.request).expect("it can be run");
        let report = recheck(&trial, &plan);
        assert!(report.holds(), "seed {seed}: {:#?}", report.faults);
    }
}

/// A blend of a joint move over 0.9 m into a line of 1.6 mm: accelerations of a millisecond within an interval of the
/// timing that takes ten, once seen by nobody.
#[test]
fn spikes_within_an_interval_of_the_timing_are_kept_within_limits() {
    let robots = robots::all();
    let trial = programs::of_seed(&robots, 58, programs::FINE);
    assert_eq!(trial.example.name, "scara");
    let plan = plan(trial.example, &trial.request).expect("it can be run");
    let report = recheck(&trial, &plan);
    assert!(report.holds(), "{report:#?}");
}
