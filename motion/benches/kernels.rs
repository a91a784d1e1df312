//! What the kernels and a plan take, ns: median and fastest of many batches, one line each.
//!
//! ```text
//! cargo bench --package takt-motion --bench kernels
//! ```
//!
//! A batch is short (about 0.1 ms), so that on a busy machine most are not interrupted: medians are steady to a few
//! percent, single figures are not. Compare with something else only by running both in turn, many times, as
//! `docs/performance/kernels.sh` does.

#![allow(clippy::print_stdout, reason = "a program that prints a table")]

#[path = "common/vectors.rs"]
mod vectors;

use std::hint::black_box;
use std::time::Instant;

use takt_motion::budget::Budget;
use takt_motion::dynamics::{Workspace, mass_matrix, rigid_torque};
use takt_motion::kinematics::inverse::{self, Inverse, Solutions, Turns};
use takt_motion::kinematics::pose;
use takt_motion::nalgebra::Isometry3;
use takt_motion::plan::outcome::MoveOutcome;
use takt_motion::plan::plan_move;
use takt_motion::plan::request::MoveRequest;
use takt_motion::robot::Robot;

/// States of one batch, as in `docs/performance/pinocchio.cpp`.
const STATES: usize = 64;

const BATCHES: usize = 400;

/// Moves that plans are timed with, each by itself.
const MOVES: usize = 200;

/// Times that each move is planned; the fastest counts, since a plan takes about as long as a batch.
const REPEATS: usize = 8;

fn main() {
    for arm in ["ur5e", "fr3"] {
        let robot = read(arm);
        dynamics(arm, &robot);
        plans(arm, &robot);
    }
    for arm in ["ur5e", "puma560", "fr3"] {
        inverse_kinematics(arm, &read(arm));
    }
}

fn read(arm: &str) -> Robot {
    let resolved = vectors::resolved(arm);
    Robot::new(resolved.spec, resolved.warnings).expect("the arm is sound")
}

fn dynamics(arm: &str, robot: &Robot) {
    let count = robot.joint_count();
    let mut draw = Draw(1);
    let states: Vec<[Vec<f64>; 3]> = (0..STATES)
        .map(|_| [(); 3].map(|()| (0..count).map(|_| draw.between(-2.0, 2.0)).collect()))
        .collect();
    let workspace = &mut Workspace::new(robot);
    let mut torque = vec![0.0; count];
    let mut matrix = vec![0.0; count * count];
    let [q, qd, qdd] = &states[0];
    rigid_torque(robot, workspace, q, qd, qdd, &mut torque);
    let norm = torque.iter().map(|torque| torque * torque).sum::<f64>().sqrt();
    println!("{arm}/value {norm:.9}");
    measure(&format!("{arm}/inverse_dynamics"), |state| {
        let [q, qd, qdd] = &states[state];
        rigid_torque(robot, workspace, q, qd, qdd, &mut torque);
        black_box(torque[0]);
    });
    measure(&format!("{arm}/mass_matrix"), |state| {
        mass_matrix(robot, workspace, &states[state][0], &mut matrix);
        black_box(matrix[0]);
    });
}

fn measure(name: &str, mut work: impl FnMut(usize)) {
    let batches = (0..BATCHES)
        .map(|_| {
            let began = Instant::now();
            for state in 0..STATES {
                work(state);
            }
            began.elapsed().as_nanos() as f64 / STATES as f64
        })
        .collect();
    print(name, batches);
}

/// Joint positions of poses anywhere: all branches of arms with a closed form, over their number, and the one nearest to
/// a reference that is some hundredths of a radian away.
fn inverse_kinematics(arm: &str, robot: &Robot) {
    let mut draw = Draw(3);
    let tcp = robot.spec().tcp;
    let inverse = Inverse::new(robot, &tcp);
    let states: Vec<(Isometry3<f64>, Vec<f64>)> = (0..STATES)
        .map(|_| {
            let q = request(robot, 0.0, &mut draw).start;
            let reference = q.iter().map(|q| q + draw.between(-0.03, 0.03)).collect();
            (pose(robot, &q, &tcp), reference)
        })
        .collect();
    let all = |state: usize| inverse.solutions(&states[state].0, Some(&states[state].1), Turns::Nearest);
    if matches!(
        all(0),
        Ok(Solutions {
            method: inverse::Method::ClosedForm,
            ..
        })
    ) {
        let branches = |state| all(state).map_or(0, |found| found.solutions.len());
        let per_pose = (0..STATES).map(branches).sum::<usize>() as f64 / STATES as f64;
        measure(&format!("{arm}/inverse_kinematics_{per_pose:.2}_branches"), |state| {
            black_box(all(state)).ok();
        });
    }
    measure(&format!("{arm}/inverse_kinematics_nearest"), |state| {
        black_box(inverse.nearest(&states[state].0, &states[state].1)).ok();
    });
    measure(&format!("{arm}/inverse_kinematics_follow"), |state| {
        black_box(inverse.follow(&states[state].0, &states[state].1)).ok();
    });
    measure(&format!("{arm}/inverse_kinematics_ready"), |_| {
        black_box(Inverse::new(black_box(robot), &tcp));
    });
}

/// Plans of moves by ±1.5 rad a joint, and of moves anywhere within the position limits.
fn plans(arm: &str, robot: &Robot) {
    for (name, reach) in [("near", 1.5), ("anywhere", f64::INFINITY)] {
        let mut draw = Draw(2);
        let requests: Vec<MoveRequest> = (0..MOVES).map(|_| request(robot, reach, &mut draw)).collect();
        let is_plan = |outcome| matches!(outcome, Ok(MoveOutcome::Plan(_)));
        let times = requests
            .iter()
            .filter(|request| is_plan(plan_move(robot, request, &Budget::unlimited())))
            .map(|request| {
                let once = || {
                    let began = Instant::now();
                    black_box(plan_move(robot, black_box(request), &Budget::unlimited())).ok();
                    began.elapsed().as_nanos() as f64
                };
                (0..REPEATS).map(|_| once()).fold(f64::INFINITY, f64::min)
            })
            .collect();
        print(&format!("{arm}/plan_verified_{name}"), times);
    }
}

fn request(robot: &Robot, reach: f64, draw: &mut Draw) -> MoveRequest {
    let limits = |joint: usize| {
        let limits = &robot.spec().joints[joint].limits;
        (
            limits.position_lower.unwrap_or(-3.0),
            limits.position_upper.unwrap_or(3.0),
        )
    };
    let start: Vec<f64> = (0..robot.joint_count())
        .map(|joint| draw.between(limits(joint).0, limits(joint).1))
        .collect();
    let target = start
        .iter()
        .enumerate()
        .map(|(joint, start)| {
            let (low, high) = limits(joint);
            draw.between(low.max(start - reach), high.min(start + reach))
        })
        .collect();
    MoveRequest::new(start, target)
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
