//! What a program's plan takes, ms: median and fastest over programs, one line each.
//!
//! ```text
//! cargo bench --package takt-motion --bench paths
//! ```
//!
//! Five joint segments of the UR5e from `tests/vectors/robots`, blended, with torque and speed limits; then with
//! accelerations, tool speed and jerk limited too. A plan is all of it: the path, its timing certified between samples,
//! and the verification by other means. Last, how long a plan that nobody waits for any more can go on: the longest time
//! between two looks at the budget.

#![allow(clippy::print_stdout, reason = "a program that prints a table")]

#[path = "common/vectors.rs"]
mod vectors;

use std::cell::Cell;
use std::hint::black_box;
use std::time::Instant;

use takt_motion::budget::Budget;
use takt_motion::path::outcome::PathOutcome;
use takt_motion::path::plan_path;
use takt_motion::path::request::{Blend, Extent, PathRequest, Segment, Shape, Space, Target, ToolLimits, Weight};
use takt_motion::plan::request::LimitOverride;
use takt_motion::robot::Robot;

const PROGRAMS: usize = 30;

/// Times that each program is planned; the fastest counts.
const REPEATS: usize = 3;

fn main() {
    let robot = ur5e();
    for (name, limit) in [("torque_speed", false), ("all_with_jerk", true)] {
        let mut times: Vec<f64> = (0..PROGRAMS as u64)
            .filter_map(|seed| time(&robot, &program(&robot, seed, limit)))
            .collect();
        times.sort_by(f64::total_cmp);
        let median = times.get(times.len() / 2).copied().unwrap_or(f64::NAN);
        let fastest = times.first().copied().unwrap_or(f64::NAN);
        println!(
            "plan_path/{name} {median:.2} ms, fastest {fastest:.2} ms, {} plans",
            times.len()
        );
        let longest = (0..PROGRAMS as u64)
            .map(|seed| longest_wait(&robot, &program(&robot, seed, limit)))
            .fold(0.0, f64::max);
        println!("stop/{name} at most {longest:.2} ms");
    }
}

/// The longest time between two looks at the budget, ms.
fn longest_wait(robot: &Robot, request: &PathRequest) -> f64 {
    let (last, longest) = (Cell::new(Instant::now()), Cell::new(0.0_f64));
    let look = || {
        longest.set(longest.get().max(last.get().elapsed().as_secs_f64()));
        last.set(Instant::now());
        false
    };
    plan_path(robot, request, &Budget::until(&look)).ok();
    look();
    longest.get() * 1e3
}

/// The fastest of a few tries, ms; `None` where there is no plan.
fn time(robot: &Robot, request: &PathRequest) -> Option<f64> {
    let mut fastest = f64::INFINITY;
    for _ in 0..REPEATS {
        let began = Instant::now();
        let outcome = black_box(plan_path(robot, request, &Budget::unlimited())).ok()?;
        let PathOutcome::Plan(_) = outcome else { return None };
        fastest = fastest.min(began.elapsed().as_secs_f64() * 1e3);
    }
    Some(fastest)
}

fn ur5e() -> Robot {
    let resolved = vectors::resolved("ur5e");
    Robot::new(resolved.spec, resolved.warnings).expect("the arm is sound")
}

/// Five segments of up to 1.2 rad a joint.
fn program(robot: &Robot, seed: u64, limit: bool) -> PathRequest {
    let mut state = seed;
    let mut draw = |reach: f64| {
        // SplitMix64 (Steele, Lea and Flood 2014)
        state = state.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = state;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        reach * (((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 52) as f64 - 1.0)
    };
    let start: Vec<f64> = (0..robot.joint_count()).map(|_| draw(1.5)).collect();
    let mut at = start.clone();
    let segments = (0..5).map(|_| {
        at = at.iter().map(|q| (q + draw(1.2)).clamp(-2.8, 2.8)).collect();
        Segment {
            blend: Some(Blend {
                extent: Extent::Fraction(0.4),
                space: Space::Joint,
                weight: Weight::Smoothstep,
            }),
            ..Segment::new(Shape::Joint {
                target: Target::Joints(at.clone()),
            })
        }
    });
    let mut segments: Vec<Segment> = segments.collect();
    if let Some(last) = segments.last_mut() {
        last.blend = None;
    }
    let joints = robot.spec().joints.iter().filter(|_| limit);
    let limits = joints.map(|joint| LimitOverride {
        joint: joint.name.clone(),
        acceleration: Some(15.0),
        jerk: Some(150.0),
        ..LimitOverride::default()
    });
    PathRequest {
        limits: limits.collect(),
        tool_limits: ToolLimits {
            velocity: limit.then_some(1.5),
            acceleration: limit.then_some(12.0),
        },
        ..PathRequest::new(start, segments)
    }
}
