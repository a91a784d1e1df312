use super::*;
use crate::dynamics;
use crate::robot::description::{Description, Kinematics};
use crate::test_arms::{random_arm, robot, values as random_values};

fn published((text, tip): (&str, &str)) -> Robot {
    let description = Description::new(Kinematics::Urdf {
        text: text.to_owned(),
        base_link: None,
        tip_link: Some(tip.to_owned()),
    });
    Robot::new(description.resolve().unwrap().spec, Vec::new()).unwrap()
}

const PANDA: (&str, &str) = (
    include_str!("../../../../tests/vectors/robots/panda/fer.urdf"),
    "fer_link8",
);
const UR5E: (&str, &str) = (include_str!("../../../../tests/vectors/robots/ur5e/ur5e.urdf"), "tool0");
const DENSO: (&str, &str) = (
    include_str!("../../../../tests/vectors/robots/denso_hsr065/denso_hsr065.urdf"),
    "J4",
);

/// Drives and a payload on an arm that was published without, so that no column stands for nothing.
fn equipped(robot: &Robot, load: f64) -> Robot {
    let mut spec = robot.spec().clone();
    for (i, joint) in spec.joints.iter_mut().enumerate() {
        let step = i as f64 + 1.0;
        joint.drive.gear_ratio = if i % 2 == 0 { 80.0 } else { -50.0 };
        joint.drive.rotor_inertia = 2e-5 * step;
        joint.drive.motor_friction.viscous = 1e-4 * step;
        joint.drive.motor_friction.coulomb_positive = 0.01;
        joint.drive.motor_friction.coulomb_negative = 0.02;
        joint.drive.joint_friction.viscous = 0.3;
        joint.drive.joint_friction.coulomb_positive = 0.7;
        joint.drive.joint_friction.coulomb_negative = 0.4;
    }
    spec.payload = Inertial {
        mass: load,
        center_of_mass: Vector3::new(0.02, -0.05, 0.11),
        inertia: Matrix3::from_diagonal(&Vector3::new(0.01, 0.02, 0.015)) * load,
    };
    Robot::new(spec, Vec::new()).unwrap()
}

fn arms() -> Vec<Robot> {
    let mut arms: Vec<Robot> = [PANDA, UR5E, DENSO]
        .iter()
        .map(|arm| equipped(&published(*arm), 2.5))
        .collect();
    arms.extend((0..6).map(|seed| robot(random_arm(5 + seed as usize, seed))));
    arms
}

#[test]
fn times_the_parameters_it_is_the_drive_torque() {
    let state = &mut 1;
    for arm in arms() {
        let count = arm.joint_count();
        let (mut workspace, mut regressor) = (Workspace::new(&arm), Regressor::new(&arm));
        let (pi, load) = (values(arm.spec()), body_parameters(arm.payload()));
        for _ in 0..50 {
            let [q, qd, qdd] = std::array::from_fn(|_| random_values(count, 2.0, state));
            let mut torque = vec![0.0; count];
            dynamics::drive_torque(&arm, &mut workspace, &q, &qd, &qdd, &mut torque);
            regressor.compute(&arm, &q, &qd, &qdd);
            let scale = torque.iter().fold(1.0, |m: f64, t| m.max(t.abs()));
            for (i, torque) in torque.iter().enumerate() {
                let links: f64 = regressor.row(i).iter().zip(&pi).map(|(y, p)| y * p).sum();
                let payload: f64 = regressor.payload_row(i).iter().zip(&load).map(|(y, p)| y * p).sum();
                assert!(
                    (links + payload - torque).abs() < 1e-12 * scale,
                    "{i}: {links} + {payload} {torque}"
                );
            }
        }
    }
}

/// Columns of the Panda's links by `computeJointTorqueRegressor` of Pinocchio 4.1.0 (BSD-2-Clause), for gravity 9.80665 m/s²
/// downwards; its order of the inertia is xx xy yy xz yz zz.
#[test]
fn has_the_columns_of_another_engine() {
    let q = [0.3, -0.5, 0.7, -1.9, 0.4, 1.6, -0.8];
    let qd = [0.9, -0.4, 1.1, 0.6, -1.3, 0.5, 1.7];
    let qdd = [1.5, -2.5, 0.5, 3.0, -1.0, 2.0, -4.0];
    let expected = [
        (
            (0, 6),
            [
                1.2515454664645924,
                6.322336672369052,
                1.6616460547490355,
                -0.7350293483903858,
                0.1886077647877542,
                -1.2030927155980602,
                7.913225375149584,
                -2.058359035666387,
                7.726105995822919,
                -10.15600396065646,
            ],
        ),
        (
            (1, 3),
            [
                0.6144831792375524,
                0.08612939084782623,
                -9.006846760826257,
                -6.104763582171581,
                -0.2624584070666287,
                -1.389738614457721,
                -2.886485877444585,
                -3.8101154134768613,
                -1.94357918471724,
                5.354081015618005,
            ],
        ),
        (
            (2, 5),
            [
                -0.9946399734001695,
                -0.5895993013742088,
                -0.02125271652248907,
                3.9582288921542386,
                -2.6254383217415285,
                5.478252822605444,
                -2.663878001104666,
                0.07695151081859053,
                -2.800488032273106,
                9.669420305086181,
            ],
        ),
        (
            (3, 3),
            [
                0.0,
                -0.47814531189144643,
                9.059256022858277,
                0.0,
                -0.9828880071008284,
                0.9828880071008284,
                5.658476847177496,
                2.988021855892723,
                -0.766348686040706,
                -2.972005373526579,
            ],
        ),
    ];
    let arm = published(PANDA);
    let mut regressor = Regressor::new(&arm);
    regressor.compute(&arm, &q, &qd, &qdd);
    for ((i, j), columns) in expected {
        for (k, expected) in columns.iter().enumerate() {
            let found = regressor.row(i)[j * PER_JOINT + k];
            assert!(
                (found - expected).abs() < 1e-11,
                "joint {i}, link {j}, {k}: {found} {expected}"
            );
        }
    }
}

#[test]
fn what_is_behind_a_joint_does_not_reach_it() {
    let arm = robot(random_arm(4, 3));
    let mut regressor = Regressor::new(&arm);
    regressor.compute(&arm, &[0.3; 4], &[0.5; 4], &[1.0; 4]);
    for joint in 0..4 {
        assert!(regressor.row(joint)[..joint * PER_JOINT].iter().all(|y| *y == 0.0));
    }
}

#[test]
fn the_load_term_has_the_sign_of_the_speed_and_none_at_rest() {
    let arm = equipped(&published(UR5E), 3.0);
    let q = [0.2, -1.1, 0.9, 0.4, 0.8, -0.3];
    let mut gravity = vec![0.0; 6];
    dynamics::gravity_torque(&arm, &mut Workspace::new(&arm), &q, &mut gravity);
    let mut regressor = Regressor::new(&arm);
    for speed in [0.7, 0.0, -0.7] {
        regressor.compute(&arm, &q, &[speed; 6], &[0.0; 6]);
        for (joint, gravity) in gravity.iter().enumerate() {
            let at = |kind| regressor.row(joint)[column(Parameter { joint, kind })];
            let expected = if speed == 0.0 {
                0.0
            } else {
                gravity.abs() * speed.signum()
            };
            assert_eq!(at(ParameterKind::LoadCoulomb), expected);
            assert_eq!(at(ParameterKind::Quadratic), speed * speed.abs());
            assert_eq!(at(ParameterKind::CoulombNegative), if speed < 0.0 { -1.0 } else { 0.0 });
        }
    }
}

#[test]
fn bodies_come_back_from_their_parameters() {
    for joint in published(PANDA).spec().joints.iter() {
        let back = body_of(&body_parameters(&joint.link));
        assert!((back.center_of_mass - joint.link.center_of_mass).norm() < 1e-14);
        assert!((back.inertia - joint.link.inertia).norm() < 1e-14);
    }
    for (i, parameter) in parameters(3).into_iter().enumerate() {
        assert_eq!(column(parameter), i);
    }
}
