//! Published drives as truths to recover: friction as its authors identified it, on a pendulum, estimated with the two-term law
//! and with richer ones; and the torque that is left over where a law cannot say it.

mod drives;

use super::arm::feed;
use super::*;
use crate::dynamics::{self, Workspace};
use crate::test_arms::{planar, robot};
use drives::DRIVES;

/// One published drive. Friction opposes the motion with viscous·|ω| and
/// base + s·stribeck + (load + s·load_stribeck)·|e − m| or its directed forms, s = exp(−|ω/stribeck_speed|^alpha), m the motor's
/// torque and e the load's on the joint (bam/model.py, compute_frictions).
struct Drive {
    name: &'static str,
    /// Largest gravity torque of the pendulum that it is simulated on, N m: ours.
    torque: f64,
    armature: f64,
    base: f64,
    viscous: f64,
    stribeck: f64,
    stribeck_speed: f64,
    alpha: f64,
    load: f64,
    load_stribeck: f64,
    motor: f64,
    external: f64,
    motor_stribeck: f64,
    external_stribeck: f64,
    motor_square: f64,
    external_square: f64,
}

impl Drive {
    /// Friction torque at a speed, with the motor's and the load's torque on the joint.
    fn friction(&self, velocity: f64, motor: f64, external: f64) -> f64 {
        let s = libm::exp(-libm::pow((velocity / self.stribeck_speed).abs(), self.alpha));
        let gearbox = (external - motor).abs();
        let directed = (external * self.external - motor * self.motor).abs();
        let stribeck = (external * self.external_stribeck - motor * self.motor_stribeck).abs();
        let square = if external * motor >= 0.0 {
            0.0
        } else if external.abs() < motor.abs() {
            self.external_square * external * external
        } else {
            self.motor_square * motor * motor
        };
        let slide = self.base
            + self.load * gearbox
            + directed
            + s * (self.stribeck + self.load_stribeck * gearbox + stribeck + square);
        velocity.signum() * slide + self.viscous * velocity
    }

    fn pendulum(&self) -> Robot {
        let mut spec = planar();
        spec.joints.truncate(1);
        let joint = &mut spec.joints[0];
        joint.link.mass = self.torque / 3.0;
        joint.link.center_of_mass *= 0.3;
        joint.link.inertia *= 0.0;
        joint.drive.rotor_inertia = self.armature;
        joint.drive.peak_torque = Some(4.0 * self.torque);
        robot(spec)
    }
}

/// What a law leaves of a drive's friction, of its root mean square; and that, and the largest rest, N m.
struct Left {
    part: f64,
    rms: f64,
    peak: f64,
    coefficients: Vec<Coefficient>,
}

/// A minute of strokes of up to 2.5 rad/s, all over the circle; noise-free.
struct Bench {
    telemetry: Telemetry,
    /// Speed, gravity torque and friction of each sample outside the dead band.
    states: Vec<[f64; 3]>,
    robot: Robot,
}

impl Bench {
    fn of(drive: &Drive) -> Self {
        let robot = drive.pendulum();
        let workspace = &mut Workspace::new(&robot);
        let mut bench = Self {
            telemetry: Telemetry::default(),
            states: Vec::new(),
            robot: robot.clone(),
        };
        for index in 0..30_000 {
            let time = 0.002 * f64::from(index);
            let (mut q, mut qd, mut qdd) = (0.0, 0.0, 0.0);
            for (amplitude, rate) in [(1.2, 0.37), (0.9, 1.1), (0.35, 2.9)] {
                q += amplitude * libm::sin(rate * time);
                qd += amplitude * rate * libm::cos(rate * time);
                qdd -= amplitude * rate * rate * libm::sin(rate * time);
            }
            let (mut rigid, mut gravity) = ([0.0], [0.0]);
            dynamics::rigid_torque(&robot, workspace, &[q], &[qd], &[qdd], &mut rigid);
            dynamics::gravity_torque(&robot, workspace, &[q], &mut gravity);
            let needed = rigid[0] + drive.armature * qdd;
            // friction depends on the motor's torque, which friction is part of
            let mut motor = needed;
            for _ in 0..25 {
                let last = motor;
                motor = needed + drive.friction(qd, last, -gravity[0]);
                if (motor - last).abs() < 1e-12 {
                    break;
                }
            }
            bench.telemetry.time.push(time);
            bench.telemetry.output_position.push(q);
            bench.telemetry.output_velocity.push(qd);
            bench.telemetry.output_acceleration.push(qdd);
            bench.telemetry.motor_torque.push(motor);
            if qd.abs() > 0.05 {
                bench.states.push([qd, gravity[0], motor - needed]);
            }
        }
        bench
    }

    fn left(&self, law: FrictionLaw) -> Left {
        let options = EstimatorOptions {
            law,
            memory: Memory::Forever,
            bandwidth: None,
            outlier_threshold: None,
            ..EstimatorOptions::default()
        };
        let mut estimator = FrictionEstimator::new(self.robot.clone(), options).unwrap();
        feed(&mut estimator, &self.telemetry, 1000);
        let joint = estimator.report().joints.remove(0);
        let (mut square, mut whole, mut peak) = (0.0, 0.0, 0.0_f64);
        for &[velocity, gravity, friction] in &self.states {
            let rest = friction - joint.torque_at(velocity, gravity).0;
            square += rest * rest;
            whole += friction * friction;
            peak = peak.max(rest.abs());
        }
        Left {
            part: libm::sqrt(square / whole),
            rms: libm::sqrt(square / self.states.len() as f64),
            peak,
            coefficients: joint.coefficients,
        }
    }
}

const TWO_TERMS: FrictionLaw = FrictionLaw {
    by_direction: false,
    load: false,
    quadratic: false,
};

const LOAD: FrictionLaw = FrictionLaw {
    load: true,
    ..TWO_TERMS
};

const ALL: FrictionLaw = FrictionLaw {
    by_direction: true,
    load: true,
    quadratic: true,
};

/// Friction as the authors' own program gives it (compute_frictions of bam/model.py, on the same files): speed, motor torque,
/// load, friction.
#[test]
fn the_published_law_is_its_authors() {
    for (name, velocity, motor, external, expected) in [
        ("erob80_100 m2", 0.7, 9.0, -4.0, 11.950_564_263_063_935),
        ("erob80_100 m2", -1.9, 3.0, -5.0, -20.729_169_859_396_848),
        ("erob80_50 m4", 0.7, 9.0, -4.0, 5.125_475_856_489_159),
        ("erob80_50 m4", -1.9, 3.0, -5.0, -6.270_001_336_450_171),
        ("mx106 m4", 0.7, 9.0, -4.0, 2.311_459_073_593_802),
        ("mx106 m4", -1.9, 3.0, -5.0, -0.719_765_924_607_695_4),
        ("erob80_100 m6", 0.7, 9.0, -4.0, 12.490_187_063_056_95),
        ("erob80_100 m6", -1.9, 3.0, -5.0, -21.029_244_397_244_625),
        ("mx106 m6", 0.7, 9.0, -4.0, 3.495_444_153_009_834),
        ("mx106 m6", -1.9, 3.0, -5.0, -1.214_822_677_655_271_5),
    ] {
        let drive = DRIVES.iter().find(|drive| drive.name == name).unwrap();
        let actual = drive.friction(velocity, motor, external);
        assert!(
            (actual - expected).abs() < 1e-12 * expected.abs(),
            "{name}: {actual} {expected}"
        );
    }
}

/// Where the published law is ours, its coefficients come back.
#[test]
fn a_drive_of_two_terms_is_recovered() {
    for drive in DRIVES.iter().filter(|drive| drive.name.ends_with("m1")) {
        let left = Bench::of(drive).left(TWO_TERMS);
        for (found, expected) in left.coefficients.iter().zip([drive.base, drive.viscous]) {
            let off = (found.value - expected).abs();
            assert!(off < 0.002 * expected, "{}: {found:?}", drive.name);
        }
        assert!(left.part < 0.002, "{}: {}", drive.name, left.part);
    }
}

/// Where it is not, the torque that is left is what the table in docs/friction.md says: more with two terms than with more.
#[test]
fn what_a_law_cannot_say_is_left_over() {
    for drive in &DRIVES {
        let bench = Bench::of(drive);
        let laws = [TWO_TERMS, LOAD, ALL].map(|law| bench.left(law));
        let cells: Vec<String> = laws
            .iter()
            .map(|left| format!("{:.1} % {:.3} {:.3}", 100.0 * left.part, left.rms, left.peak))
            .collect();
        println!("| {} | {} |", drive.name, cells.join(" | "));
        let [two, load, all] = &laws;
        assert!(
            load.part < two.part + 2e-3 && all.part < load.part + 2e-3,
            "{}",
            drive.name
        );
        let most = if drive.name.ends_with("m1") { 0.002 } else { 0.6 };
        assert!(
            two.part < most && two.peak < drive.torque,
            "{}: {}",
            drive.name,
            two.part
        );
    }
}
