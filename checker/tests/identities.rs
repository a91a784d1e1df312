//! The checker's dynamics against mechanics that can be done by hand.

use std::f64::consts::PI;

use nalgebra::{Isometry3, Matrix3, Translation3, UnitQuaternion, Vector3};
use takt_checker::draw::{self, Draw};
use takt_checker::{Arm, Workspace};
use takt_motion::robot::spec::{Drive, Friction, Inertial, JointKind, JointSpec, Limits, RobotSpec};

const G: f64 = 9.81;

fn body(mass: f64, center: [f64; 3], principal: [f64; 3]) -> Inertial {
    Inertial {
        mass,
        center_of_mass: center.into(),
        inertia: Matrix3::from_diagonal(&principal.into()),
    }
}

fn joint(kind: JointKind, offset: [f64; 3], axis: [f64; 3], link: Inertial) -> JointSpec {
    JointSpec {
        name: "joint".to_owned(),
        kind,
        parent_from_joint: Isometry3::translation(offset[0], offset[1], offset[2]),
        axis: axis.into(),
        link,
        limits: Limits::default(),
        drive: Drive::default(),
    }
}

fn arm(joints: Vec<JointSpec>) -> RobotSpec {
    RobotSpec {
        joints,
        link_from_tip: Isometry3::identity(),
        gravity: Vector3::new(0.0, 0.0, -G),
        payload: Inertial::zero(),
        tcp: Isometry3::identity(),
        frames: Vec::new(),
        uncertainty: None,
    }
}

fn torque(spec: &RobotSpec, q: &[f64], qd: &[f64], qdd: &[f64]) -> Vec<f64> {
    let mut tau = vec![0.0; q.len()];
    Arm::new(spec, None).rigid_torque(&mut Workspace::default(), q, qd, qdd, &mut tau);
    tau
}

fn assert_close(found: &[f64], expected: &[f64], tolerance: f64) {
    let largest = expected.iter().fold(1e-6, |most: f64, value| most.max(value.abs()));
    for (found, expected) in found.iter().zip(expected) {
        assert!(
            (found - expected).abs() <= tolerance * largest,
            "{found} found, {expected} expected"
        );
    }
}

#[test]
fn pendulum_swings_as_in_the_textbook() {
    // About −y, so that a positive angle lifts; the centre at 0.4 m, level at 0.
    let (mass, length, inertia) = (2.5, 0.4, 0.07);
    let link = body(mass, [length, 0.0, 0.0], [0.5, inertia, 0.6]);
    let spec = arm(vec![joint(
        JointKind::Revolute,
        [0.3, -0.2, 1.1],
        [0.0, -1.0, 0.0],
        link,
    )]);
    for (q, qd, qdd) in [(0.0, 0.0, 0.0), (0.7, 2.0, 3.0), (-2.1, -4.0, 11.0)] {
        let expected = (inertia + mass * length * length) * qdd + mass * G * length * f64::cos(q);
        assert_close(&torque(&spec, &[q], &[qd], &[qdd]), &[expected], 1e-14);
    }
}

#[test]
fn two_link_planar_arm_has_its_closed_form() {
    // Craig, Introduction to Robotics, section 6.7: point masses at the link ends, gravity down the plane.
    let (l1, l2, m1, m2) = (0.5, 0.35, 3.0, 1.7);
    let up = [0.0, -1.0, 0.0];
    let spec = arm(vec![
        joint(JointKind::Revolute, [0.0; 3], up, body(m1, [l1, 0.0, 0.0], [0.0; 3])),
        joint(
            JointKind::Revolute,
            [l1, 0.0, 0.0],
            up,
            body(m2, [l2, 0.0, 0.0], [0.0; 3]),
        ),
    ]);
    let mut draw = Draw::seeded(2);
    for _ in 0..100 {
        let (q, qd, qdd) = (
            draw::values(&mut draw, 2, 3.0),
            draw::values(&mut draw, 2, 5.0),
            draw::values(&mut draw, 2, 20.0),
        );
        let (s2, c1, c2, c12) = (q[1].sin(), q[0].cos(), q[1].cos(), (q[0] + q[1]).cos());
        let second = m2 * l2 * l2 * (qdd[0] + qdd[1])
            + m2 * l1 * l2 * c2 * qdd[0]
            + m2 * l1 * l2 * s2 * qd[0] * qd[0]
            + m2 * l2 * G * c12;
        let first = m2 * l2 * l2 * (qdd[0] + qdd[1])
            + m2 * l1 * l2 * c2 * (2.0 * qdd[0] + qdd[1])
            + (m1 + m2) * l1 * l1 * qdd[0]
            - m2 * l1 * l2 * s2 * qd[1] * qd[1]
            - 2.0 * m2 * l1 * l2 * s2 * qd[0] * qd[1]
            + m2 * l2 * G * c12
            + (m1 + m2) * l1 * G * c1;
        assert_close(&torque(&spec, &q, &qd, &qdd), &[first, second], 1e-13);
    }
}

#[test]
fn lift_carries_everything_beyond_it() {
    let up = [0.0, 0.0, 1.0];
    let mut spec = arm(vec![
        joint(
            JointKind::Prismatic,
            [0.1, 0.0, 0.2],
            up,
            body(4.0, [0.3, 0.1, 0.0], [0.1; 3]),
        ),
        joint(JointKind::Prismatic, [0.0, 0.2, 0.1], up, body(1.5, [0.0; 3], [0.2; 3])),
    ]);
    spec.payload = body(0.5, [0.0, 0.0, 0.2], [0.01; 3]);
    let tau = torque(&spec, &[0.4, 0.1], &[1.0, -2.0], &[0.5, 0.25]);
    assert_close(&tau, &[4.0 * (G + 0.5) + 2.0 * (G + 0.75), 2.0 * (G + 0.75)], 1e-14);
}

#[test]
fn mass_that_slides_outward_on_a_turntable_feels_centrifugal_and_coriolis_force() {
    let spec = arm(vec![
        joint(JointKind::Revolute, [0.0; 3], [0.0, 0.0, 1.0], Inertial::zero()),
        joint(
            JointKind::Prismatic,
            [0.0; 3],
            [1.0, 0.0, 0.0],
            body(2.0, [0.0; 3], [0.0; 3]),
        ),
    ]);
    let (r, spin, speed) = (0.6, 3.0, 1.2);
    let tau = torque(&spec, &[0.9, r], &[spin, speed], &[0.0, 0.0]);
    assert_close(&tau, &[2.0 * 2.0 * r * speed * spin, -2.0 * r * spin * spin], 1e-14);
}

#[test]
fn power_becomes_energy() {
    let mut draw = Draw::seeded(3);
    for count in [1, 2, 3, 6, 7, 9] {
        let spec = draw::arm(&mut draw, count);
        let arm = Arm::new(&spec, None);
        let mut workspace = Workspace::default();
        let q = draw::values(&mut draw, count, 2.0);
        let qd = draw::values(&mut draw, count, 2.0);
        let qdd = draw::values(&mut draw, count, 5.0);
        let mut energy_after = |time: f64| {
            let at: Vec<f64> = (0..count)
                .map(|i| q[i] + qd[i] * time + 0.5 * qdd[i] * time * time)
                .collect();
            let rate: Vec<f64> = (0..count).map(|i| qd[i] + qdd[i] * time).collect();
            arm.kinetic_energy(&mut workspace, &at, &rate) + arm.potential_energy(&mut workspace, &at)
        };
        // A difference of fourth order over ±h, ±2h.
        let h = 1e-3;
        let near = energy_after(h) - energy_after(-h);
        let far = energy_after(2.0 * h) - energy_after(-2.0 * h);
        let gain = (8.0 * near - far) / (12.0 * h);
        let power: f64 = torque(&spec, &q, &qd, &qdd).iter().zip(&qd).map(|(t, v)| t * v).sum();
        assert_close(&[power], &[gain], 1e-7);
    }
}

#[test]
fn every_torque_is_lagranges() {
    // τ = d/dt ∂T/∂q̇ − ∂T/∂q + ∂U/∂q, each derivative as a difference: coarse, but it sees every joint by itself.
    let mut draw = Draw::seeded(4);
    for count in [2, 4, 7] {
        let spec = draw::arm(&mut draw, count);
        let arm = Arm::new(&spec, None);
        let mut workspace = Workspace::default();
        let q = draw::values(&mut draw, count, 2.0);
        let qd = draw::values(&mut draw, count, 1.0);
        let qdd = draw::values(&mut draw, count, 3.0);
        let shifted = |of: &[f64], joint: usize, by: f64| {
            let mut moved = of.to_vec();
            moved[joint] += by;
            moved
        };
        let h = 1e-4;
        let expected: Vec<f64> = (0..count)
            .map(|joint| {
                // T is quadratic in the velocities: the central difference in them is exact.
                let mut momentum = |time: f64| {
                    let at: Vec<f64> = (0..count)
                        .map(|i| q[i] + qd[i] * time + 0.5 * qdd[i] * time * time)
                        .collect();
                    let rate: Vec<f64> = (0..count).map(|i| qd[i] + qdd[i] * time).collect();
                    let mut energy = |by| arm.kinetic_energy(&mut workspace, &at, &shifted(&rate, joint, by));
                    0.5 * (energy(1.0) - energy(-1.0))
                };
                let change = (momentum(h) - momentum(-h)) / (2.0 * h);
                let mut lagrangian = |by: f64| {
                    let at = shifted(&q, joint, by);
                    arm.kinetic_energy(&mut workspace, &at, &qd) - arm.potential_energy(&mut workspace, &at)
                };
                change - (lagrangian(h) - lagrangian(-h)) / (2.0 * h)
            })
            .collect();
        assert_close(&torque(&spec, &q, &qd, &qdd), &expected, 1e-6);
    }
}

#[test]
fn mass_matrix_is_symmetric_and_positive() {
    let mut draw = Draw::seeded(5);
    for count in [2, 5, 7] {
        let mut spec = draw::arm(&mut draw, count);
        spec.gravity = Vector3::zeros();
        let q = draw::values(&mut draw, count, 3.0);
        let still = vec![0.0; count];
        let columns: Vec<Vec<f64>> = (0..count)
            .map(|column| {
                let mut unit = still.clone();
                unit[column] = 1.0;
                torque(&spec, &q, &still, &unit)
            })
            .collect();
        let largest = columns
            .iter()
            .flatten()
            .fold(0.0, |most: f64, value| most.max(value.abs()));
        for (row, entries) in columns.iter().enumerate() {
            assert!(entries[row] > 0.0);
            for (column, entry) in entries.iter().enumerate() {
                assert!((entry - columns[column][row]).abs() < 1e-13 * largest);
            }
        }
        let direction = draw::values(&mut draw, count, 1.0);
        let energy = 0.5
            * torque(&spec, &q, &still, &direction)
                .iter()
                .zip(&direction)
                .map(|(t, v)| t * v)
                .sum::<f64>();
        let kinetic = Arm::new(&spec, None).kinetic_energy(&mut Workspace::default(), &q, &direction);
        assert_close(&[energy], &[kinetic], 1e-13);
    }
}

#[test]
fn turning_the_whole_arm_with_gravity_changes_nothing() {
    let mut draw = Draw::seeded(6);
    let spec = draw::arm(&mut draw, 6);
    let (q, qd, qdd) = (
        draw::values(&mut draw, 6, 3.0),
        draw::values(&mut draw, 6, 2.0),
        draw::values(&mut draw, 6, 5.0),
    );
    let turned_by = UnitQuaternion::from_scaled_axis(Vector3::new(0.4, -1.1, 2.0));
    let mut turned = spec.clone();
    turned.gravity = turned_by * spec.gravity;
    turned.joints[0].parent_from_joint =
        Isometry3::from_parts(Translation3::new(3.0, -2.0, 1.0), turned_by) * spec.joints[0].parent_from_joint;
    assert_close(&torque(&turned, &q, &qd, &qdd), &torque(&spec, &q, &qd, &qdd), 1e-12);
}

#[test]
fn drive_adds_rotor_and_friction_at_the_joint() {
    let mut spec = arm(vec![joint(
        JointKind::Revolute,
        [0.0; 3],
        [0.0, 0.0, 1.0],
        body(1.0, [0.0; 3], [0.1, 0.1, 0.3]),
    )]);
    spec.joints[0].drive = Drive {
        gear_ratio: -50.0,
        rotor_inertia: 2e-4,
        motor_friction: Friction {
            viscous: 1e-3,
            coulomb_positive: 0.4,
            coulomb_negative: 0.3,
            ..Friction::default()
        },
        joint_friction: Friction {
            viscous: 0.7,
            coulomb_positive: 1.1,
            coulomb_negative: 1.3,
            ..Friction::default()
        },
        ..Drive::default()
    };
    let arm = Arm::new(&spec, None);
    let mut workspace = Workspace::default();
    let mut drive = |qd: f64, qdd: f64, direction: f64| {
        let mut tau = [0.0];
        arm.drive_torque(&mut workspace, &[0.2], &[qd], &[qdd], &[direction], &mut tau);
        tau[0]
    };
    let inertia = 0.3 + 2500.0 * 2e-4;
    let viscous = 2500.0 * 1e-3 + 0.7;
    let (forwards, backwards) = (50.0 * 0.4 + 1.1, 50.0 * 0.3 + 1.3);
    assert_close(
        &[drive(2.0, 3.0, 2.0)],
        &[inertia * 3.0 + viscous * 2.0 + forwards],
        1e-14,
    );
    assert_close(
        &[drive(-2.0, 3.0, -1.0)],
        &[inertia * 3.0 - viscous * 2.0 - backwards],
        1e-14,
    );
    assert_close(&[drive(0.0, 3.0, 1.0)], &[inertia * 3.0 + forwards], 1e-14);
    assert_eq!(drive(0.0, 0.0, 0.0), 0.0);
}

#[test]
fn friction_of_the_load_goes_with_the_slope_of_the_potential_energy() {
    let mut draw = Draw::seeded(8);
    for count in 1..=7 {
        let spec = draw::arm(&mut draw, count);
        let arm = Arm::new(&spec, None);
        let workspace = &mut Workspace::default();
        let (q, qd) = (draw::values(&mut draw, count, 3.0), draw::values(&mut draw, count, 2.0));
        let mut found = vec![0.0; count];
        arm.friction_torque(workspace, &q, &qd, &mut found);
        for (index, joint) in spec.joints.iter().enumerate() {
            let mut energy = |by: f64| {
                let mut q = q.clone();
                q[index] += by;
                arm.potential_energy(workspace, &q)
            };
            let slope = (energy(1e-4) - energy(-1e-4)) / 2e-4;
            let (motor, own, ratio) = (
                &joint.drive.motor_friction,
                &joint.drive.joint_friction,
                joint.drive.gear_ratio,
            );
            let (speed, ratio) = (qd[index], ratio.abs());
            let coulomb = match speed > 0.0 {
                true => ratio * motor.coulomb_positive + own.coulomb_positive,
                false => ratio * motor.coulomb_negative + own.coulomb_negative,
            };
            let load = (motor.load_coulomb + own.load_coulomb) * slope.abs();
            let viscous = (ratio * ratio * motor.viscous + own.viscous) * speed.abs();
            let quadratic = (ratio * ratio * ratio * motor.quadratic + own.quadratic) * speed * speed;
            let expected = speed.signum() * (coulomb + load + viscous + quadratic);
            assert!(
                (found[index] - expected).abs() <= 1e-6 * (1.0 + expected.abs()),
                "{found:?} {expected}"
            );
        }
    }
}

#[test]
fn payload_hangs_on_the_tip_link() {
    // A level link along x; the tip frame at its end, turned a quarter about y: its z points along base x.
    let mut spec = arm(vec![joint(
        JointKind::Revolute,
        [0.0; 3],
        [0.0, -1.0, 0.0],
        Inertial::zero(),
    )]);
    spec.link_from_tip = Isometry3::from_parts(
        Translation3::new(0.5, 0.0, 0.0),
        UnitQuaternion::from_axis_angle(&Vector3::y_axis(), PI / 2.0),
    );
    spec.payload = body(9.0, [0.0; 3], [0.0; 3]);
    let own = body(2.0, [0.0, 0.0, 0.1], [0.01, 0.02, 0.03]);
    let arm = Arm::new(&spec, Some(&own));
    let mut tau = [0.0];
    arm.rigid_torque(&mut Workspace::default(), &[0.0], &[0.0], &[1.0], &mut tau);
    let expected = 2.0 * G * 0.6 + 2.0 * 0.6 * 0.6 + 0.02;
    assert_close(&tau, &[expected], 1e-14);
}
