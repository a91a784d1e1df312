//! What torque-limited planning is worth: the time of VERIFIED moves against PRESET ones, and against the time-optimal
//! motion along the same straight joint path.
//!
//! ```text
//! cargo run --release --package takt-checker --example worth_it -- [moves a row] [--dump PATH]
//! ```
//!
//! The optimum is found on a grid of 1000 intervals with the checker's dynamics (below, [`Optimum`]). `--dump` writes the first moves of
//! each row with their terms along the path, for `docs/performance/time_optimal_by_toppra.py`.

#![allow(clippy::print_stdout, reason = "a program that prints a table")]

#[path = "common/payloads.rs"]
mod payloads;
#[path = "common/robots.rs"]
mod robots;

use nalgebra::Vector3;
use robots::Example;
use serde_json::{Value, json};
use takt_checker::draw::{self, Draw};
use takt_checker::statistics::quantile;
use takt_checker::{Arm, Bounds, Workspace};
use takt_motion::budget::Budget;
use takt_motion::plan::outcome::{MoveOutcome, MovePlan};
use takt_motion::plan::plan_move;
use takt_motion::plan::request::{Method, MoveRequest};
use takt_motion::robot::spec::RobotSpec;

/// Intervals of the optimum's grid.
const INTERVALS: usize = 1000;

/// Halvings in the search for the fastest speed at a grid point.
const HALVINGS: usize = 46;

/// Moves a row that are dumped.
const DUMPED: usize = 20;

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let count = arguments.first().and_then(|count| count.parse().ok()).unwrap_or(1000);
    let dump = arguments.iter().position(|name| name == "--dump");
    let mut dumped = Vec::new();
    println!(
        "| arm | moves | time / preset's: median (5th to 95th percentile) | preset over the limit | time / optimal: median (5th to 95th) | largest |"
    );
    println!("|---|---|---|---|---|---|");
    for example in robots::all() {
        for (name, reach) in [("anywhere", f64::INFINITY), ("within 1 rad", 1.0)] {
            let mut row = Row::default();
            let draw = &mut Draw::seeded(1);
            while row.preset.len() < count {
                row.try_move(&example, &request(&example, reach, draw));
            }
            row.print(&example.name, name);
            dumped.extend(row.dumped);
        }
    }
    if let Some(path) = dump.and_then(|at| arguments.get(at + 1)) {
        std::fs::write(path, json!(dumped).to_string()).expect("the file can be written");
    }
}

/// Anywhere, or each joint within `reach` of its start; with any payload that the arm may carry, all of its torque and speed.
fn request(example: &Example, reach: f64, draw: &mut Draw) -> MoveRequest {
    let spec = example.robot.spec();
    let start = draw::pose_within(draw, spec);
    let target = spec
        .joints
        .iter()
        .zip(&start)
        .map(|(joint, start)| {
            let low = joint.limits.position_lower.unwrap_or(f64::NEG_INFINITY);
            let high = joint.limits.position_upper.unwrap_or(f64::INFINITY);
            draw.between(low.max(start - reach), high.min(start + reach))
        })
        .collect();
    let mass = draw.between(0.0, example.payload_max);
    MoveRequest {
        payload: Some(payloads::ball(mass, Vector3::new(0.0, 0.0, 0.05))),
        ..MoveRequest::new(start, target)
    }
}

#[derive(Default)]
struct Row {
    /// Durations over those of the preset method.
    preset: Vec<f64>,
    /// Durations over the optimal ones.
    optimal: Vec<f64>,
    /// Moves whose raw preset pattern breaks a limit and had to be slowed down.
    slowed: usize,
    /// Moves that one of the methods refuses.
    refused: usize,
    dumped: Vec<Value>,
}

impl Row {
    fn try_move(&mut self, example: &Example, request: &MoveRequest) {
        let plan = |method| {
            let request = MoveRequest {
                method,
                ..request.clone()
            };
            match plan_move(&example.robot, &request, &Budget::unlimited()) {
                Ok(MoveOutcome::Plan(plan)) => Some(plan),
                _ => None,
            }
        };
        let (Some(verified), Some(preset)) = (plan(Method::Verified), plan(Method::Preset)) else {
            self.refused += 1;
            return;
        };
        let path = StraightPath::of(example.robot.spec(), request, INTERVALS);
        let optimum = path.optimal_duration();
        if self.dumped.len() < DUMPED {
            self.dumped.push(path.dump(&example.name, &verified, optimum));
        }
        self.preset.push(verified.duration / preset.duration);
        self.optimal.push(verified.duration / optimum);
        self.slowed += usize::from(preset.raw_excess > 0.0);
    }

    fn print(&mut self, arm: &str, moves: &str) {
        self.preset.sort_by(f64::total_cmp);
        self.optimal.sort_by(f64::total_cmp);
        let of = |sorted: &[f64]| [0.5, 0.05, 0.95, 1.0].map(|share| quantile(sorted, share));
        let ([median, low, high, _], [loss, loss_low, loss_high, largest]) = (of(&self.preset), of(&self.optimal));
        println!(
            "| {arm} | {} {moves} | {median:.2} ({low:.2} to {high:.2}) | {:.0} % | {loss:.4} ({loss_low:.4} to {loss_high:.4}) \
             | {largest:.3} |",
            self.preset.len(),
            100.0 * self.slowed as f64 / self.preset.len() as f64,
        );
    }
}

/// A straight joint path q(s) = q₀ + s·D at even samples, and everything that bounds a motion along it: with x = ṡ² and
/// a = s̈, every joint has torque m·a + k·x + f·√x + h.
struct StraightPath {
    intervals: usize,
    /// Sample by sample, joint by joint.
    samples: Vec<Vec<Terms>>,
    viscous: Vec<f64>,
    torque: Vec<f64>,
    square_speed_max: f64,
    acceleration_max: f64,
    deceleration_max: f64,
}

#[derive(Clone, Copy)]
struct Terms {
    mass: f64,
    velocity: f64,
    /// Gravity and Coulomb friction.
    still: f64,
}

impl StraightPath {
    fn of(spec: &RobotSpec, request: &MoveRequest, intervals: usize) -> Self {
        let arm = Arm::new(spec, request.payload.as_ref());
        let bounds = Bounds::of_request(spec, request);
        let workspace = &mut Workspace::default();
        let count = request.start.len();
        let along: Vec<f64> = request
            .target
            .iter()
            .zip(&request.start)
            .map(|(to, from)| to - from)
            .collect();
        let still = vec![0.0; count];
        let mut rotor = vec![0.0; count];
        arm.rotor_torque(&along, &mut rotor);
        let mut viscous = still.clone();
        let mut samples = Vec::with_capacity(intervals + 1);
        for sample in 0..=intervals {
            let s = sample as f64 / intervals as f64;
            let q: Vec<f64> = request
                .start
                .iter()
                .zip(&along)
                .map(|(from, by)| from + s * by)
                .collect();
            let mut friction = |times: f64| {
                let qd: Vec<f64> = along.iter().map(|by| times * by).collect();
                let mut torque = vec![0.0; count];
                arm.friction_torque(workspace, &q, &qd, &mut torque);
                torque
            };
            // a parabola of the speed: Coulomb's, viscous, quadratic
            let [once, twice, thrice] = [1.0, 2.0, 3.0].map(&mut friction);
            let quadratic: Vec<f64> = (0..count)
                .map(|joint| 0.5 * (once[joint] - 2.0 * twice[joint] + thrice[joint]))
                .collect();
            viscous = (0..count)
                .map(|joint| twice[joint] - once[joint] - 3.0 * quadratic[joint])
                .collect();
            let mut torque = |qd: &[f64], qdd: &[f64]| {
                let mut torque = vec![0.0; count];
                arm.rigid_torque(workspace, &q, qd, qdd, &mut torque);
                torque
            };
            let (gravity, accelerated, moved) =
                (torque(&still, &still), torque(&still, &along), torque(&along, &still));
            let terms = (0..count).map(|joint| Terms {
                mass: accelerated[joint] - gravity[joint] + rotor[joint],
                velocity: moved[joint] - gravity[joint] + quadratic[joint],
                still: gravity[joint] + once[joint] - viscous[joint] - quadratic[joint],
            });
            samples.push(terms.collect());
        }
        let least = |limit: &dyn Fn(&Bounds) -> Option<f64>| {
            let rates = bounds.iter().zip(&along).filter(|(_, by)| **by != 0.0);
            rates
                .filter_map(|(bounds, by)| limit(bounds).map(|limit| limit / by.abs()))
                .fold(f64::INFINITY, f64::min)
        };
        let speed = least(&|bounds| bounds.velocity);
        Self {
            intervals,
            samples,
            viscous,
            torque: bounds
                .iter()
                .map(|bounds| bounds.torque.unwrap_or(f64::INFINITY))
                .collect(),
            square_speed_max: speed * speed,
            acceleration_max: least(&|bounds| bounds.acceleration),
            deceleration_max: least(&|bounds| bounds.deceleration),
        }
    }

    /// The least and the largest path acceleration that all limits allow at the squared speed x, on both ends of the
    /// interval after a sample; it changes x by 2·a·Δ over the interval. (Pham and Pham 2018, "interpolation".)
    fn accelerations(&self, sample: usize, x: f64) -> (f64, f64) {
        let step = 2.0 / self.intervals as f64;
        let (mut low, mut high) = (-self.deceleration_max, self.acceleration_max);
        let root = x.sqrt();
        let ends = [(sample, 0.0), ((sample + 1).min(self.intervals), step)];
        for (end, ahead) in ends {
            for (joint, terms) in self.samples[end].iter().enumerate() {
                let rate = terms.mass + ahead * terms.velocity;
                let rest = terms.velocity * x + self.viscous[joint] * root + terms.still;
                let room = [-self.torque[joint] - rest, self.torque[joint] - rest];
                if rate.abs() < 1e-12 * self.torque[joint] {
                    if room[0] > 0.0 || room[1] < 0.0 {
                        return (f64::INFINITY, f64::NEG_INFINITY);
                    }
                    continue;
                }
                let [one, other] = room.map(|room| room / rate);
                low = low.max(one.min(other));
                high = high.min(one.max(other));
            }
        }
        (low, high)
    }

    /// Duration of the fastest motion at rest at both ends: from the end backwards, the fastest speeds from which the rest
    /// of the way can be done; from the start forwards, the largest acceleration that keeps to them.
    fn optimal_duration(&self) -> f64 {
        let step = 2.0 / self.intervals as f64;
        let mut controllable = vec![0.0; self.intervals + 1];
        for sample in (0..self.intervals).rev() {
            let ahead = controllable[sample + 1];
            let can = |x: f64| {
                let (low, high) = self.accelerations(sample, x);
                low.max(-x / step) <= high.min((ahead - x) / step)
            };
            let (mut from, mut to) = (
                0.0,
                self.square_speed_max.min(ahead + step * self.deceleration_max.min(1e9)),
            );
            if can(to) {
                controllable[sample] = to;
                continue;
            }
            for _ in 0..HALVINGS {
                let middle = 0.5 * (from + to);
                if can(middle) {
                    from = middle;
                } else {
                    to = middle;
                }
            }
            controllable[sample] = from;
        }
        let mut x = 0.0;
        let mut duration = 0.0;
        for sample in 0..self.intervals {
            let (_, high) = self.accelerations(sample, x);
            let next = (x + step * high).min(controllable[sample + 1]).max(0.0);
            duration += step / (x.sqrt() + next.sqrt());
            x = next;
        }
        duration
    }

    fn dump(&self, arm: &str, plan: &MovePlan, optimum: f64) -> Value {
        let column = |of: &dyn Fn(&Terms) -> f64| -> Vec<Vec<f64>> {
            let samples = self.samples.iter();
            samples.map(|sample| sample.iter().map(of).collect()).collect()
        };
        let finite = |limit: f64| limit.is_finite().then_some(limit);
        json!({
            "arm": arm,
            "mass": column(&|terms| terms.mass),
            "velocity": column(&|terms| terms.velocity),
            "still": column(&|terms| terms.still),
            "viscous": self.viscous,
            "torque_limit": self.torque,
            "square_speed_max": self.square_speed_max,
            "acceleration_max": finite(self.acceleration_max),
            "deceleration_max": finite(self.deceleration_max),
            "verified_duration_s": plan.duration,
            "optimal_duration_s": optimum,
        })
    }
}
