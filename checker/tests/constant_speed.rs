//! Programs at constant tool speed, looked at by someone else: random ones of every example robot keep every limit, and the
//! tool has the speed that the plan says.

#[path = "../examples/common/robots.rs"]
mod robots;

use robots::Example;
use takt_checker::draw::Draw;
use takt_checker::draw_program::{Cell, at_constant_speed};
use takt_checker::path::report::{FaultKind, PathReport};
use takt_checker::{Density, recheck_path};
use takt_motion::budget::Budget;
use takt_motion::path::outcome::{PathOutcome, PathPlan};
use takt_motion::path::plan_path;
use takt_motion::path::request::PathRequest;
use takt_motion::plan::request::Sampling;

/// Programs of each robot.
const PROGRAMS: u64 = 10;

/// The program of a seed, and its plan where it has one.
fn planned(example: &Example, seed: u64) -> (PathRequest, Option<Box<PathPlan>>) {
    let cell = Cell {
        spec: example.robot.spec(),
        payload_max: example.payload_max,
        sampling: Sampling::Period([0.001, 0.002, 0.004, 0.008][(seed % 4) as usize]),
        limit_jerk: (seed / 4).is_multiple_of(2),
    };
    let request = at_constant_speed(&mut Draw::seeded(seed), &cell);
    let plan = match plan_path(&example.robot, &request, &Budget::unlimited()) {
        Ok(PathOutcome::Plan(plan)) => Some(plan),
        Ok(PathOutcome::Infeasible(_)) => None,
        Err(failure) => panic!("{}, seed {seed}: {failure:?}\n{request:#?}", example.name),
    };
    (request, plan)
}

fn recheck(example: &Example, request: &PathRequest, plan: &PathPlan) -> PathReport {
    recheck_path(example.robot.spec(), request, plan, Density::Coarse)
}

/// The programs of one robot: every plan holds, and a third of them have one.
fn check(robot: usize) {
    let example = &robots::all()[robot];
    let mut plans = 0;
    for seed in 0..PROGRAMS {
        let (request, Some(plan)) = planned(example, seed) else {
            continue;
        };
        plans += 1;
        let report = recheck(example, &request, &plan);
        let broken: Vec<_> = report.violations().collect();
        assert!(
            report.holds(),
            "{}, seed {seed}: {broken:#?} {:#?} {:#?}",
            example.name,
            report.faults,
            plan.constant_speed
        );
    }
    assert!(3 * plans > PROGRAMS, "{}: {plans} plans", example.name);
}

#[test]
fn fr3_keeps_its_speed() {
    check(0);
}

#[test]
fn puma_keeps_its_speed() {
    check(1);
}

#[test]
fn scara_keeps_its_speed() {
    check(2);
}

#[test]
fn ur5e_keeps_its_speed() {
    check(3);
}

#[test]
fn a_speed_that_is_not_kept_is_found() {
    let robots = robots::all();
    let example = &robots[0];
    let programs = (0..).map(|seed| planned(example, seed));
    let mut plans = programs.filter_map(|(request, plan)| Some((request, plan?)));
    let with_speed = |(_, plan): &(PathRequest, Box<PathPlan>)| {
        let told = plan.constant_speed.as_ref().map_or(0.0, |told| told.speed);
        let setpoints = plan.setpoints.as_ref().expect("set-points were asked for");
        setpoints
            .tool_speed
            .iter()
            .filter(|speed| (*speed - told).abs() < 1e-9 * told)
            .count()
            > 10
    };
    let (request, plan) = plans.find(with_speed).expect("there are many programs");
    let odd = |change: &dyn Fn(&mut PathPlan)| {
        let mut plan = plan.clone();
        change(&mut plan);
        let faults = recheck(example, &request, &plan).faults;
        faults.iter().any(|fault| fault.kind == FaultKind::ConstantSpeed)
    };
    let told = |plan: &mut PathPlan, change: fn(&mut takt_motion::path::outcome::ConstantSpeedReport)| {
        change(plan.constant_speed.as_mut().expect("it is at constant speed"));
    };
    assert!(!odd(&|_| ()));
    assert!(odd(&|plan| plan.constant_speed = None));
    assert!(odd(&|plan| told(plan, |told| told.speed *= 1.0 + 1e-6)));
    assert!(odd(&|plan| told(plan, |told| told.speed *= 1.0 - 1e-6)));
    assert!(odd(&|plan| told(plan, |told| told.lowest = 1.01 * told.speed)));
    assert!(odd(&|plan| told(plan, |told| told.asked = 0.5 * told.speed)));
    assert!(odd(&|plan| {
        let speed = plan.constant_speed.as_ref().map_or(0.0, |told| told.speed);
        let setpoints = plan.setpoints.as_mut().expect("set-points were asked for");
        let cruising = |found: &&mut f64| (**found - speed).abs() < 1e-9 * speed;
        *setpoints
            .tool_speed
            .iter_mut()
            .filter(cruising)
            .nth(5)
            .expect("there are ten") *= 1.0 + 1e-6;
    }));
}
