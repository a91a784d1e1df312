//! What a check of the two end poses alone lets through: random moves by the end-pose method of JP4358979B2, written
//! a second time in `takt_checker::endpoint`, each rechecked along the whole motion.
//!
//! ```text
//! cargo run --release --package takt-checker --example endpoint_only_excess -- [moves a row]
//! ```

#![allow(clippy::print_stdout, reason = "a program that prints a table")]

#[path = "../tests/oracle/arms.rs"]
#[allow(dead_code, reason = "shared with tests that need more of it")]
mod arms;

use std::time::Instant;

use nalgebra::{Matrix3, Vector3};
use takt_checker::draw::{self, Draw};
use takt_checker::endpoint::{self, Preset};
use takt_checker::motion::{self, JointState, Part};
use takt_checker::statistics::{ExcessStatistics, quantile};
use takt_checker::{Arm, Bounds, Checker, Grid, Move, Workspace};
use takt_motion::plan::outcome::{Fallback, LimitKind};
use takt_motion::robot::spec::{Inertial, RobotSpec};

/// Poses over which the presets are derived.
const PRESET_POSES: usize = 4096;

/// Torque that exceeds its limit by less than this part counts as kept: roundings, and what an end pose reaches exactly.
const KEPT: f64 = 1e-3;

/// How moves are drawn.
#[derive(Clone, Copy)]
enum Reach {
    /// Start and target anywhere within the position limits.
    Anywhere,
    /// Each joint within so much of its start, rad or m.
    Near(f64),
}

fn main() {
    let count = std::env::args()
        .nth(1)
        .and_then(|argument| argument.parse().ok())
        .unwrap_or(1000);
    for (name, spec) in arms() {
        for reach in [Reach::Anywhere, Reach::Near(1.0)] {
            measure(name, &spec, reach, count);
        }
    }
}

/// Acceleration limits as Franka publishes them for its joint interface, rad/s² (frankaemika/docs,
/// `control_parameters`).
const FR3_ACCELERATION: [f64; 7] = [10.0; 7];
const PANDA_ACCELERATION: [f64; 7] = [15.0, 7.5, 10.0, 12.5, 15.0, 20.0, 20.0];

/// Rotors and friction are the PUMA's alone: for the others none are published that may be used here, and so a light
/// wrist takes accelerations in theory that no drive gives. The published acceleration limits, where there are any,
/// bound that.
fn arms() -> [(&'static str, RobotSpec); 6] {
    let urdf = |folder, urdf| arms::from_urdf(folder, urdf, "oracle.json").spec;
    let fr3 = urdf("fr3", "fr3.urdf");
    let panda = urdf("panda", "fer.urdf");
    [
        ("UR5e", urdf("ur5e", "ur5e.urdf")),
        ("FR3", fr3.clone()),
        ("FR3 with acceleration limits", with_limits(fr3, &FR3_ACCELERATION)),
        ("Panda", panda.clone()),
        (
            "Panda with acceleration limits",
            with_limits(panda, &PANDA_ACCELERATION),
        ),
        ("PUMA 560", arms::puma_from_table().spec),
    ]
}

fn with_limits(mut spec: RobotSpec, acceleration: &[f64]) -> RobotSpec {
    for (joint, limit) in spec.joints.iter_mut().zip(acceleration) {
        joint.limits.acceleration = Some(*limit);
    }
    spec
}

/// 2 kg, 0.1 m out along the tip's axis.
fn payload() -> Inertial {
    Inertial {
        mass: 2.0,
        center_of_mass: Vector3::new(0.0, 0.0, 0.1),
        inertia: Matrix3::zeros(),
    }
}

fn measure(name: &str, spec: &RobotSpec, reach: Reach, count: usize) {
    let arm = Arm::new(spec, Some(&payload()));
    let bounds = Bounds::of_robot(spec);
    let preset = endpoint::derive_preset(spec, &arm, &bounds, PRESET_POSES).expect("the arm has limits");
    let mut checker = Checker::new(arm.clone());
    let mut draw = Draw::seeded(4_358_979);
    let mut found = Found::default();
    let began = Instant::now();
    while found.excesses.len() < count && found.refused < 100 * count {
        let (start, target) = draw_move(&mut draw, spec, reach);
        found.try_move(&arm, &mut checker, &bounds, &preset, &start, &target);
    }
    found.print(name, reach, began.elapsed().as_secs_f64());
}

fn draw_move(draw: &mut Draw, spec: &RobotSpec, reach: Reach) -> (Vec<f64>, Vec<f64>) {
    let start = draw::pose_within(draw, spec);
    let Reach::Near(way) = reach else {
        return (start, draw::pose_within(draw, spec));
    };
    let target = spec
        .joints
        .iter()
        .zip(&start)
        .map(|(joint, start)| {
            let low = joint.limits.position_lower.unwrap_or(f64::NEG_INFINITY);
            let high = joint.limits.position_upper.unwrap_or(f64::INFINITY);
            draw.between(low.max(start - way), high.min(start + way))
        })
        .collect();
    (start, target)
}

/// When in a move the worst torque falls.
#[derive(Clone, Copy, PartialEq)]
enum Moment {
    /// All joints that move speed up, or all slow down.
    Together,
    /// Some speed up or slow down, others do not, or do the opposite.
    Apart,
    /// All cruise.
    Cruise,
}

/// The moment of the torque of largest magnitude of `joint`, on the side of `time` where it is larger.
fn moment_of(arm: &Arm, emitted: &Move<'_>, joint: usize, time: f64, duration: f64) -> Moment {
    let aside = 1e-9 * duration;
    let side = |time: f64| {
        let states: Vec<JointState> = emitted
            .patterns
            .iter()
            .map(|pattern| motion::state_in(pattern, motion::part_at(pattern, time), time))
            .collect();
        let q: Vec<f64> = states
            .iter()
            .zip(emitted.start)
            .map(|(state, start)| start + state.travelled)
            .collect();
        let qd: Vec<f64> = states.iter().map(|state| state.velocity).collect();
        let qdd: Vec<f64> = states.iter().map(|state| state.acceleration).collect();
        let mut tau = vec![0.0; q.len()];
        arm.drive_torque(&mut Workspace::default(), &q, &qd, &qdd, &qd, &mut tau);
        (tau[joint].abs(), time)
    };
    let (before, after) = (side(time - aside), side(time + aside));
    let (_, time) = if before.0 > after.0 { before } else { after };
    let moving = emitted.patterns.iter().filter(|pattern| pattern.displacement != 0.0);
    let mut parts: Vec<Part> = moving.map(|pattern| motion::part_at(pattern, time)).collect();
    parts.dedup();
    match parts[..] {
        [Part::Cruise] => Moment::Cruise,
        [_] => Moment::Together,
        _ => Moment::Apart,
    }
}

#[derive(Default)]
struct Found {
    /// Signed, of torque alone.
    excesses: Vec<f64>,
    /// Of duration over that of the preset pattern.
    gains: Vec<f64>,
    /// Of the worst torque of each move that is over.
    moments: Vec<Moment>,
    refused: usize,
    fallbacks: usize,
    samples: usize,
    resolution: f64,
}

impl Found {
    fn try_move(
        &mut self,
        arm: &Arm,
        checker: &mut Checker,
        bounds: &[Bounds],
        preset: &Preset,
        start: &[f64],
        target: &[f64],
    ) {
        let Ok(planned) = endpoint::plan(arm, bounds, preset, start, target, Fallback::Rebased) else {
            self.refused += 1;
            return;
        };
        let patterns = &planned.patterns;
        let emitted = Move {
            start,
            target,
            patterns,
        };
        let report = checker
            .check(bounds, &emitted, Grid::default())
            .expect("one entry a joint");
        assert_eq!(report.inconsistencies, [], "the method's patterns are sound");
        let worst = report.worst_of(LimitKind::Torque).expect("torque is limited");
        self.excesses.push(worst.excess);
        if worst.excess > KEPT {
            let time = worst.extreme.time;
            self.moments
                .push(moment_of(arm, &emitted, worst.joint, time, report.duration));
        }
        self.gains.push(planned.duration / planned.preset_duration);
        self.fallbacks += usize::from(planned.fallback != Fallback::None);
        self.samples += report.sample_count;
        for (joint, bounds) in report.joints.iter().zip(bounds) {
            let resolution = joint.torque_resolution / bounds.torque.unwrap_or(f64::INFINITY);
            self.resolution = self.resolution.max(resolution);
        }
    }

    fn print(&mut self, name: &str, reach: Reach, seconds: f64) {
        let reach = match reach {
            Reach::Anywhere => "anywhere".to_owned(),
            Reach::Near(way) => format!("within {way} rad"),
        };
        self.gains.sort_by(f64::total_cmp);
        let far_over = ExcessStatistics::of(&self.excesses, 0.1).share_over;
        println!("{name}, {reach}: {}", ExcessStatistics::of(&self.excesses, KEPT));
        let share = |moment| {
            let count = self.moments.iter().filter(|one| **one == moment).count();
            100.0 * count as f64 / self.moments.len().max(1) as f64
        };
        println!(
            "  worst while all joints speed up or slow down {:.0} %, while only some do {:.0} %, while all cruise {:.0} %",
            share(Moment::Together),
            share(Moment::Apart),
            share(Moment::Cruise),
        );
        println!(
            "  {:.1} % by more than a tenth; {} without a plan; {:.1} % by a fallback; duration over preset's {:.2} \
             (median); {:.1} million states in {seconds:.1} s; resolution {:.1e}",
            100.0 * far_over,
            self.refused,
            100.0 * self.fallbacks as f64 / self.excesses.len().max(1) as f64,
            quantile(&self.gains, 0.5),
            self.samples as f64 / 1e6,
            self.resolution,
        );
    }
}
