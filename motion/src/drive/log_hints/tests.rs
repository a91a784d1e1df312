//! Logs of an arm of two links in other units and directions.

use super::*;
use crate::drive::fit::recording::Effort;
use crate::robot::spec::Friction;
use crate::test_arms::{planar, robot};

/// The arm has a range and a friction that are not those of the recording.
fn arm() -> Robot {
    let mut spec = planar();
    for joint in &mut spec.joints {
        joint.limits.position_lower = Some(-3.0);
        joint.limits.position_upper = Some(3.0);
        joint.limits.velocity = Some(4.0);
        joint.drive.motor_friction = Friction::default();
        joint.drive.joint_friction = Friction {
            viscous: 1.0,
            coulomb_positive: 1.0,
            coulomb_negative: 1.0,
            ..Friction::default()
        };
    }
    robot(spec)
}

/// Eight seconds at 250 Hz, with twice the model's friction.
fn recording(robot: &Robot) -> Recording {
    let mut workspace = Workspace::new(robot);
    let [mut position, mut velocity, mut torque] = std::array::from_fn(|_| vec![Vec::new(); 2]);
    let time: Vec<f64> = (0..2000).map(|index| f64::from(index) * 0.004).collect();
    for &time in &time {
        let (mut q, mut qd, mut qdd, mut tau) = ([0.0; 2], [0.0; 2], [0.0; 2], [0.0; 2]);
        for (joint, rate) in [1.3, 2.1].into_iter().enumerate() {
            let (sin, cos) = (libm::sin(rate * time), libm::cos(rate * time));
            (q[joint], qd[joint], qdd[joint]) = (0.9 * sin, 0.9 * rate * cos, -0.9 * rate * rate * sin);
        }
        dynamics::drive_torque(robot, &mut workspace, &q, &qd, &qdd, &mut tau);
        for joint in 0..2 {
            position[joint].push(q[joint]);
            velocity[joint].push(qd[joint]);
            torque[joint].push(tau[joint] + qd[joint] + qd[joint].signum());
        }
    }
    Recording {
        time,
        position,
        velocity: Some(velocity),
        effort: Effort::Torque(torque),
    }
}

fn scale(series: &mut [f64], factor: f64) {
    for value in series {
        *value *= factor;
    }
}

fn said(change: impl Fn(&mut Recording)) -> Vec<String> {
    let robot = arm();
    let mut recording = recording(&robot);
    change(&mut recording);
    LogHints::of_recording(&robot, &recording, &Budget::unlimited()).unwrap()
}

#[test]
fn a_log_as_it_should_be_is_nothing_to_speak_of() {
    assert_eq!(said(|_| {}), [""; 0]);
    assert_eq!(said(|log| log.velocity = None), [""; 0]);
    // too short to tell, however wrong
    assert_eq!(
        said(|log| {
            log.time.truncate(100);
            for joint in 0..2 {
                log.position[joint].truncate(100);
                scale(&mut log.velocity.as_mut().unwrap()[joint], -1.0);
            }
        }),
        [""; 0]
    );
}

/// One broken sample ruins a fit, and milli newton metres do too.
#[test]
fn torques_that_no_drive_gives_are_named_with_the_time() {
    let with_torque = |change: &dyn Fn(&mut Vec<f64>)| {
        said(|log| {
            let Effort::Torque(torque) = &mut log.effort else {
                return;
            };
            change(&mut torque[1]);
        })
    };
    let peak = arm().spec().joints[1].drive.peak_torque.unwrap();
    assert_eq!(with_torque(&|torque| torque[700] = 4.0 * peak), [""; 0]);
    for (change, parts) in [
        (
            &(|torque: &mut Vec<f64>| torque[700] = -1.0e5) as &dyn Fn(&mut Vec<f64>),
            ["`torque`", "1.0000e5", "at 2.800 s", ": 1):"],
        ),
        (
            &|torque| scale(torque, 1000.0),
            ["`torque`", "at the joint", "peak torque", "another unit"],
        ),
    ] {
        let said = with_torque(change);
        assert_eq!(said.len(), 1, "{said:?}");
        assert!(parts.iter().all(|part| said[0].contains(part)), "{said:?}");
    }
}

#[test]
fn each_mistake_is_named_with_its_joints_and_column() {
    const DEGREES: f64 = 57.295_779_513_082_32;
    let velocity = |log: &mut Recording, joint: usize, factor: f64| {
        scale(&mut log.velocity.as_mut().unwrap()[joint], factor);
    };
    let torque = |log: &mut Recording, joint: usize, factor: f64| {
        let Effort::Torque(torque) = &mut log.effort else {
            return;
        };
        scale(&mut torque[joint], factor);
    };
    let one = |said: Vec<String>, parts: &[&str]| {
        assert_eq!(said.len(), 1, "{said:?}");
        for part in parts {
            assert!(said[0].contains(part), "{part}: {said:?}");
        }
    };
    let names: Vec<String> = arm()
        .spec()
        .joints
        .iter()
        .map(|joint| format!("\"{}\"", joint.name))
        .collect();
    let (first, second) = (names[0].as_str(), names[1].as_str());
    // all in degrees, with and without speeds
    for with_speeds in [true, false] {
        let all = said(|log| {
            for joint in 0..2 {
                scale(&mut log.position[joint], DEGREES);
                velocity(log, joint, DEGREES);
            }
            log.velocity = log.velocity.take().filter(|_| with_speeds);
        });
        one(all, &[first, second, "`position`", "degrees", "-3.0000 to 3.0000 rad"]);
    }
    one(
        said(|log| velocity(log, 1, DEGREES)),
        &[second, "`velocity`", "57.3 times", "degrees/s"],
    );
    one(
        said(|log| scale(&mut log.position[0], DEGREES)),
        &[first, "`position`", "57.3 times", "degrees"],
    );
    one(
        said(|log| velocity(log, 0, -1.0)),
        &[first, "`velocity` runs against `position`"],
    );
    one(
        said(|log| torque(log, 1, -1.0)),
        &[second, "`torque` runs against", "sign"],
    );
    one(
        said(|log| (0..2).for_each(|joint| torque(log, joint, -1.0))),
        &["joints", first, second],
    );
    one(
        said(|log| scale(&mut log.time, 1e3)),
        &["milliseconds", "1e3", "called t_ms"],
    );
    one(said(|log| scale(&mut log.time, 1e6)), &["microseconds", "called t_us"]);
    one(
        said(|log| {
            scale(&mut log.time, 1e3);
            log.velocity = None;
        }),
        &["4.000 s apart", "milliseconds", "called t_ms"],
    );
}

/// A motor that is geared backwards, with its current: what counts is what arrives at the joint.
#[test]
fn telemetry_is_seen_from_the_joint() {
    let mut spec = arm().spec().clone();
    for joint in &mut spec.joints {
        joint.drive.gear_ratio = -50.0;
        joint.drive.torque_constant = Some(0.1);
    }
    let geared = robot(spec);
    let log = recording(&geared);
    let Effort::Torque(torque) = &log.effort else { return };
    let by_sample = |series: &[Vec<f64>], factor: f64| {
        let samples = 0..log.time.len();
        samples
            .flat_map(|index| {
                series
                    .iter()
                    .map(move |values| factor * values[index])
                    .collect::<Vec<_>>()
            })
            .collect()
    };
    let hints = |sign: f64| {
        let block = Telemetry {
            time: log.time.clone(),
            motor_position: by_sample(&log.position, -50.0),
            motor_current: by_sample(torque, sign / -5.0),
            ..Telemetry::default()
        };
        let mut hints = LogHints::new(geared.clone());
        hints.add_telemetry(&block);
        hints.messages()
    };
    assert_eq!(hints(1.0), [""; 0]);
    let turned = hints(-1.0);
    assert!(
        turned.len() == 1 && turned[0].contains("`motor_current` runs against"),
        "{turned:?}"
    );
    assert!(turned[0].contains("joints"), "{turned:?}");
}

/// Whatever comes: nothing breaks, and nothing is made up.
#[test]
fn hostile_values_are_passed_over() {
    for value in [f64::NAN, f64::INFINITY, -1e300, 0.0] {
        for column in 0..4 {
            let found = said(|log| {
                let series = match column {
                    0 => &mut log.time,
                    1 => &mut log.position[0],
                    2 => &mut log.velocity.as_mut().unwrap()[0],
                    _ => match &mut log.effort {
                        Effort::Torque(torque) | Effort::Current(torque) => &mut torque[0],
                    },
                };
                series[700] = value;
            });
            assert!(
                found.iter().all(|text| text.is_ascii() && !text.contains("NaN")),
                "{value} {column}: {found:?}"
            );
        }
    }
}
