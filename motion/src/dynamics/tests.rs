use nalgebra::{Isometry3, UnitQuaternion, Vector3};

use super::path::PathTerms;
use super::sweep::Sweep;
use super::*;
use crate::curve::CurvePoint;
use crate::robot::spec::{Friction, Inertial};
use crate::test_arms::{loaded, planar, random, random_arm, robot, values};

fn arm(count: usize, seed: u64) -> Robot {
    robot(random_arm(count, seed))
}

fn assert_close(a: &[f64], b: &[f64], tolerance: f64) {
    let scale = b.iter().fold(1e-6, |m: f64, x| m.max(x.abs()));
    for (x, y) in a.iter().zip(b) {
        assert!((x - y).abs() <= tolerance * scale, "{a:?} {b:?}");
    }
}

#[test]
fn inverse_dynamics_is_the_mass_matrix_times_acceleration_plus_the_bias() {
    for count in [1, 2, 3, 6, 9, 17, 32] {
        let robot = arm(count, count as u64);
        let ws = &mut Workspace::new(&robot);
        let state = &mut 7;
        let (q, qd, qdd) = (
            values(count, 2.0, state),
            values(count, 2.0, state),
            values(count, 2.0, state),
        );
        let (mut torque, mut bias) = (vec![0.0; count], vec![0.0; count]);
        rigid_torque(&robot, ws, &q, &qd, &qdd, &mut torque);
        rigid_torque(&robot, ws, &q, &qd, &vec![0.0; count], &mut bias);
        let mut matrix = vec![0.0; count * count];
        mass_matrix(&robot, ws, &q, &mut matrix);
        let rebuilt: Vec<f64> = (0..count)
            .map(|i| bias[i] + (0..count).map(|j| matrix[i * count + j] * qdd[j]).sum::<f64>())
            .collect();
        assert_close(&rebuilt, &torque, 1e-12);
    }
}

#[test]
fn forward_dynamics_inverts_the_drive_torque() {
    for (count, is_loaded) in [(1, false), (4, true), (6, false), (6, true), (32, true)] {
        let spec = random_arm(count, 11 + count as u64);
        let robot = robot(if is_loaded { loaded(spec) } else { spec });
        let ws = &mut Workspace::new(&robot);
        let state = &mut 3;
        let (q, qd, qdd) = (
            values(count, 2.0, state),
            values(count, 2.0, state),
            values(count, 2.0, state),
        );
        let (mut torque, mut back) = (vec![0.0; count], vec![0.0; count]);
        drive_torque(&robot, ws, &q, &qd, &qdd, &mut torque);
        assert!(forward_dynamics(&robot, ws, &q, &qd, &torque, &mut back));
        assert_close(&back, &qdd, 1e-8);
    }
}

#[test]
fn kinetic_energy_grows_by_the_power_of_the_torques() {
    let robot = arm(6, 5);
    let ws = &mut Workspace::new(&robot);
    let state = &mut 9;
    let (q, qd, qdd) = (values(6, 2.0, state), values(6, 2.0, state), values(6, 2.0, state));
    let mut energy = |time: f64| {
        let at = |i: usize| q[i] + qd[i] * time + 0.5 * qdd[i] * time * time;
        let rate = |i: usize| qd[i] + qdd[i] * time;
        let q: Vec<f64> = (0..6).map(at).collect();
        let mut matrix = vec![0.0; 36];
        mass_matrix(&robot, ws, &q, &mut matrix);
        let pairs = (0..36).map(|e| matrix[e] * rate(e / 6) * rate(e % 6));
        0.5 * pairs.sum::<f64>()
    };
    let step = 1e-4;
    let growth = (energy(step) - energy(-step)) / (2.0 * step);
    let (mut torque, mut gravity) = (vec![0.0; 6], vec![0.0; 6]);
    let ws = &mut Workspace::new(&robot);
    rigid_torque(&robot, ws, &q, &qd, &qdd, &mut torque);
    gravity_torque(&robot, ws, &q, &mut gravity);
    let power: f64 = (0..6).map(|i| qd[i] * (torque[i] - gravity[i])).sum();
    assert!((growth - power).abs() < 1e-5 * power.abs(), "{growth} {power}");
}

#[test]
fn a_sweep_has_the_bits_of_single_states() {
    for count in [1, 6, 7, 12, 32] {
        let robot = arm(count, 20 + count as u64);
        let ws = &mut Workspace::new(&robot);
        let state = &mut 1;
        let mut sweep = Sweep::default();
        sweep.reset(count, 13);
        for entry in 0..sweep.position.len() {
            sweep.position[entry] = 3.0 * random(state);
            sweep.velocity[entry] = random(state);
            sweep.acceleration[entry] = random(state);
        }
        sweep.compute(robot.chain());
        for k in 0..13 {
            let of = |column: &[f64]| -> Vec<f64> { (0..count).map(|j| column[sweep.column(j) + k]).collect() };
            let (q, qd, qdd) = (of(&sweep.position), of(&sweep.velocity), of(&sweep.acceleration));
            let mut torque = vec![0.0; count];
            rigid_torque(&robot, ws, &q, &qd, &qdd, &mut torque);
            assert_eq!(torque, of(&sweep.torque));
            gravity_torque(&robot, ws, &q, &mut torque);
            assert_close(&torque, &of(&sweep.gravity), 1e-13);
        }
    }
}

#[test]
fn path_terms_agree_with_inverse_dynamics_along_a_curved_path() {
    for count in [1, 3, 6, 10, 32] {
        let robot = arm(count, 30 + count as u64);
        let ws = &mut Workspace::new(&robot);
        let state = &mut 2;
        let mut terms = PathTerms::default();
        let points: Vec<CurvePoint> = (0..5)
            .map(|_| CurvePoint {
                position: values(count, 2.0, state),
                first: values(count, 2.0, state),
                second: values(count, 2.0, state),
                third: vec![0.0; count],
            })
            .collect();
        terms.reset(count, points.len());
        for (k, point) in points.iter().enumerate() {
            terms.set(k, point);
        }
        terms.compute(robot.chain(), None);
        let (sd, sdd) = (1.3, -0.7);
        for (k, point) in points.iter().enumerate() {
            let qd: Vec<f64> = point.first.iter().map(|d| d * sd).collect();
            let bends = point.first.iter().zip(&point.second);
            let qdd: Vec<f64> = bends.map(|(d, dd)| d * sdd + dd * sd * sd).collect();
            let mut torque = vec![0.0; count];
            rigid_torque(&robot, ws, &point.position, &qd, &qdd, &mut torque);
            let along: Vec<f64> = (0..count)
                .map(|j| {
                    let e = j * terms.stride + k;
                    terms.mass[e] * sdd + terms.velocity[e] * sd * sd + terms.gravity[e]
                })
                .collect();
            assert_close(&along, &torque, 1e-12);
        }
    }
}

/// p′ and p″ against differences of poses along a parabola of the joints.
#[test]
fn path_terms_have_the_derivatives_of_the_tool() {
    for (count, seed) in [(2, 41), (6, 42), (7, 43)] {
        let robot = arm(count, seed);
        let state = &mut 5;
        let tcp = Isometry3::new(Vector3::new(0.1, 0.2, -0.1), Vector3::new(0.3, 0.1, 0.2));
        let point = CurvePoint {
            position: values(count, 2.0, state),
            first: values(count, 1.0, state),
            second: values(count, 1.0, state),
            third: vec![0.0; count],
        };
        let mut terms = PathTerms::default();
        terms.reset(count, 1);
        terms.set(0, &point);
        let on_last = (robot.spec().link_from_tip * tcp).translation.vector;
        terms.compute(robot.chain(), Some(robot.chain().point_on_last(on_last)));
        let tool = |s: f64| {
            let q: Vec<f64> = (0..count)
                .map(|j| point.position[j] + s * point.first[j] + 0.5 * s * s * point.second[j])
                .collect();
            crate::kinematics::pose(&robot, &q, &tcp).translation.vector
        };
        let step = 1e-4;
        let (ahead, here, behind) = (tool(step), tool(0.0), tool(-step));
        let first = (ahead - behind) / (2.0 * step);
        let second = (ahead - here * 2.0 + behind) / (step * step);
        let of = |column: &[f64]| Vector3::from_fn(|axis, _| column[axis * terms.stride]);
        let (p1, p2) = (of(&terms.tool_first), of(&terms.tool_second));
        // the axes turn with the link, so lengths and angles are compared
        for (got, expected) in [
            (p1.norm(), first.norm()),
            (p2.norm(), second.norm()),
            (p1.dot(&p2), first.dot(&second)),
        ] {
            assert!(
                (got - expected).abs() < 1e-6 * (1.0 + expected.abs()),
                "{got} {expected}"
            );
        }
    }
}

#[test]
fn the_jacobian_is_the_derivative_of_the_pose() {
    let robot = arm(7, 8);
    let tcp = Isometry3::new(Vector3::new(0.1, 0.2, -0.1), Vector3::new(0.3, 0.1, 0.2));
    let q = values(7, 2.0, &mut 4);
    let mut jacobian = vec![0.0; 42];
    crate::kinematics::jacobian(&robot, &q, &tcp, &mut jacobian);
    let step = 1e-6;
    for j in 0..7 {
        let moved = |by: f64| {
            let mut q = q.clone();
            q[j] += by;
            crate::kinematics::pose(&robot, &q, &tcp)
        };
        let (ahead, behind) = (moved(step), moved(-step));
        let linear = (ahead.translation.vector - behind.translation.vector) / (2.0 * step);
        let turn: UnitQuaternion<f64> = ahead.rotation * behind.rotation.inverse();
        let angular = turn.scaled_axis() / (2.0 * step);
        let column: Vec<f64> = (0..6).map(|row| jacobian[row * 7 + j]).collect();
        let differences: Vec<f64> = linear.iter().chain(angular.iter()).copied().collect();
        assert_close(&column, &differences, 1e-8);
    }
}

#[test]
fn a_singular_mass_matrix_is_refused() {
    let mut spec = arm(2, 1).spec().clone();
    spec.payload = Inertial::zero();
    spec.joints[1].link = Inertial::zero();
    spec.joints[1].drive.rotor_inertia = 0.0;
    let refusal = Robot::new(spec, Vec::new()).unwrap_err();
    assert!(refusal[0].message.contains("singular"), "{}", refusal[0]);
}

/// One link of 3 kg at 1 m in a world of 10 m/s²: gravity takes 30·cos q.
#[test]
fn friction_is_viscous_quadratic_and_of_coulomb_on_either_side_and_grows_with_the_load() {
    let mut spec = planar();
    spec.joints.truncate(1);
    let drive = &mut spec.joints[0].drive;
    drive.gear_ratio = -50.0;
    let side = |size: f64| Friction {
        viscous: 1e-3 * size,
        coulomb_positive: 0.02 * size,
        coulomb_negative: 0.03 * size,
        load_coulomb: 0.04 * size,
        quadratic: 1e-6 * size,
        presliding_stiffness: Some(1e4),
    };
    (drive.motor_friction, drive.joint_friction) = (side(1.0), side(0.5));
    let robot = robot(spec);
    let ws = &mut Workspace::new(&robot);
    for (q, qd) in [
        (0.3, 1.7),
        (0.3, -1.7),
        (2.0, 0.6),
        (2.0, -0.6),
        (0.5 * std::f64::consts::PI, 1.0),
        (0.1, 0.0),
    ] {
        let (sign, coulomb) = if qd > 0.0 {
            (1.0, 50.0 * 0.02 + 0.01)
        } else {
            (-1.0, 50.0 * 0.03 + 0.015)
        };
        let load = 0.06 * (30.0 * libm::cos(q)).abs();
        let moving = (2500.0 * 1e-3 + 5e-4) * qd + sign * ((125_000.0 * 1e-6 + 5e-7) * qd * qd + coulomb + load);
        let expected = if qd == 0.0 { 0.0 } else { moving };
        let mut friction = [0.0];
        friction_torque(&robot, ws, &[q], &[qd], &mut friction);
        assert!((friction[0] - expected).abs() < 1e-12, "{friction:?} {expected}");
        // and it is what the drive gives beyond body and rotor
        let (mut whole, mut rigid, mut rotor) = ([0.0], [0.0], [0.0]);
        drive_torque(&robot, ws, &[q], &[qd], &[2.0], &mut whole);
        rigid_torque(&robot, ws, &[q], &[qd], &[2.0], &mut rigid);
        rotor_torque(&robot, &[2.0], &mut rotor);
        assert!((whole[0] - rigid[0] - rotor[0] - expected).abs() < 1e-12, "{whole:?}");
    }
}

/// A payload loads the gears as the links do.
#[test]
fn the_load_is_that_of_the_payload_too() {
    let mut spec = planar();
    spec.joints.truncate(1);
    spec.joints[0].drive.joint_friction.load_coulomb = 0.1;
    spec.link_from_tip = Isometry3::translation(1.0, 0.0, 0.0);
    let bare = robot(spec);
    let heavy = bare.with_payload(&Inertial {
        mass: 2.0,
        ..Inertial::zero()
    });
    for (robot, expected) in [(bare, 3.0), (heavy, 5.0)] {
        let mut friction = [0.0];
        friction_torque(&robot, &mut Workspace::new(&robot), &[0.0], &[0.2], &mut friction);
        assert!((friction[0] - expected).abs() < 1e-12, "{friction:?}");
    }
}
