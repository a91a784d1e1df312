//! What the timing of a path takes, µs: median and fastest of many, one line each.
//!
//! ```text
//! cargo bench --package takt-motion --bench timing [-- --paths FOLDER]
//! ```
//!
//! Paths are polynomials of degree 5 of every joint, limits the arm's own of speed and torque. `interpolated` is what
//! toppra does with constraints at both ends of each interval: constraints, passes and duration, nothing looked at in
//! between; its value is the sum of the durations, s. `certified` is what a plan has: a coarse grid, a graded one, and the certificate. `jerk_limited` is that under
//! limits of acceleration and jerk too. With a folder, each arm's limits and paths are written there as
//! `docs/performance/toppra.cpp` reads them, and nothing is timed.

#![allow(clippy::print_stdout, reason = "a program that prints a table")]

#[path = "common/vectors.rs"]
mod vectors;

use std::hint::black_box;
use std::path::Path;
use std::time::Instant;

use takt_motion::measured::{Polynomials, certified, interpolated, jerk_limited};
use takt_motion::robot::Robot;

const PATHS: usize = 20;

/// What the server is built with: the timing asks for large pieces of memory.
#[global_allocator]
static ALLOCATOR: mimalloc::MiMalloc = mimalloc::MiMalloc;

/// Times that each path is timed; the fastest counts.
const REPEATS: usize = 12;

fn main() {
    let folder = std::env::args().skip_while(|argument| argument != "--paths").nth(1);
    for arm in ["ur5e", "fr3"] {
        let robot = read(arm);
        let coefficients = paths(&robot);
        if let Some(folder) = &folder {
            let file = Path::new(folder).join(format!("{arm}.paths"));
            std::fs::write(file, described(&robot, &coefficients)).expect("the folder can be written to");
            continue;
        }
        let paths: Vec<_> = coefficients.into_iter().map(polynomials).collect();
        for intervals in [200, 500] {
            measure(&format!("{arm}/jerk_limited_{intervals}"), &paths, |path| {
                jerk_limited(&robot, path, intervals)
            });
        }
        for intervals in [100, 500, 1000] {
            measure(&format!("{arm}/interpolated_{intervals}"), &paths, |path| {
                interpolated(&robot, path, intervals)
            });
            let durations = paths.iter().filter_map(|path| interpolated(&robot, path, intervals));
            println!("{arm}/interpolated_{intervals}/value {:.9} 0", durations.sum::<f64>());
            measure(&format!("{arm}/certified_{intervals}"), &paths, |path| {
                certified(&robot, path, intervals)
            });
        }
    }
}

/// Coefficients of one path by joint, lowest power first.
type Coefficients = Vec<Vec<f64>>;

fn polynomials(coefficients: Coefficients) -> Polynomials {
    Polynomials::new(coefficients, 1.0)
}

/// Number of joints, limits of speed, limits of torque, and the coefficients of each path.
fn described(robot: &Robot, paths: &[Coefficients]) -> String {
    let joints = &robot.spec().joints;
    let row = |numbers: Vec<f64>| {
        let numbers: Vec<String> = numbers.iter().map(|number| format!("{number:?}")).collect();
        numbers.join(" ") + "\n"
    };
    let limit = |limit: Option<f64>| limit.expect("the arm has the limit");
    let mut text = format!("{}\n", joints.len());
    text += &row(joints.iter().map(|joint| limit(joint.limits.velocity)).collect());
    text += &row(joints.iter().map(|joint| limit(joint.drive.peak_torque)).collect());
    for coefficients in paths.iter().flatten() {
        text += &row(coefficients.clone());
    }
    text
}

/// Paths around the middle of the joints' ranges that can be timed.
fn paths(robot: &Robot) -> Vec<Coefficients> {
    let mut draw = Draw(3);
    let middle = |joint: usize| {
        let limits = &robot.spec().joints[joint].limits;
        let lower = limits.position_lower.unwrap_or(-1.0).max(-3.0);
        let upper = limits.position_upper.unwrap_or(1.0).min(3.0);
        0.5 * (lower + upper)
    };
    let mut path = || {
        let joint = |joint| {
            let mut coefficients = vec![middle(joint) + draw.between(-0.5, 0.5)];
            coefficients.extend((0..5).map(|_| draw.between(-2.0, 2.0)));
            coefficients
        };
        (0..robot.joint_count()).map(joint).collect()
    };
    let timed = |path: &Coefficients| certified(robot, &polynomials(path.clone()), 100).is_some();
    std::iter::repeat_with(&mut path).filter(timed).take(PATHS).collect()
}

fn measure(name: &str, paths: &[Polynomials], work: impl Fn(&Polynomials) -> Option<f64>) {
    let times = paths
        .iter()
        .map(|path| {
            let once = || {
                let began = Instant::now();
                black_box(work(black_box(path)));
                began.elapsed().as_nanos() as f64 / 1e3
            };
            (0..REPEATS).map(|_| once()).fold(f64::INFINITY, f64::min)
        })
        .collect();
    print(name, times);
}

fn read(arm: &str) -> Robot {
    let resolved = vectors::resolved(arm);
    Robot::new(resolved.spec, resolved.warnings).expect("the arm is sound")
}

fn print(name: &str, mut times: Vec<f64>) {
    times.sort_by(f64::total_cmp);
    println!("{name} {:.2} {:.2}", times[times.len() / 2], times[0]);
}

/// SplitMix64, as in `takt_checker::draw`.
struct Draw(u64);

impl Draw {
    fn between(&mut self, low: f64, high: f64) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut mixed = self.0;
        mixed = (mixed ^ (mixed >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        mixed ^= mixed >> 31;
        low + (high - low) * ((mixed >> 11) as f64 / (1u64 << 53) as f64)
    }
}
