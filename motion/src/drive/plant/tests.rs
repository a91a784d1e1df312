//! The simulated arm against an independent integrator, and against what must be conserved.
//!
//! The figures are those of SciPy 1.17.1's DOP853 at rtol 1e-12, atol 1e-14 (its Radau agrees to 5e-12), on eq 10 and 12 written in Python with
//! Pinocchio 4.1.0's `rnea`, `crba` and `getFrameJacobian` of `tests/vectors/robots/ur5e/ur5e.urdf`, and Dahl's dz/dt as a differential
//! equation of its own for each contact. Motor torques are held for 10 ms each: c + a·cos(0.3·k) in the k-th.

use super::*;
use crate::robot::description::{Description, Kinematics};
use crate::robot::spec::{Friction, RobotSpec};
use crate::test_arms;

const ROTOR: [f64; 6] = [1.5, 1.4, 1.2, 0.2, 0.25, 0.15];
const LINEAR: [f64; 6] = [2e4, 2.2e4, 1.8e4, 5e3, 5e3, 4e3];
const CUBIC: [f64; 6] = [3e7, -1e7, 2e7, 1e7, 5e6, 8e6];
const START: [f64; 6] = [0.3, -1.4, 1.2, -1.1, -1.3, 0.4];
const START_VELOCITY: [f64; 6] = [0.5, -0.4, 0.6, 1.0, -0.8, 1.2];

/// The UR5e with elastic drives; gears of 1:1, so that the motor's side is the joint's.
fn ur5e(dry: bool) -> RobotSpec {
    let description = Description {
        gravity: Some([0.0, 0.0, -9.81].into()),
        ..Description::new(Kinematics::Urdf {
            text: include_str!("../../../../tests/vectors/robots/ur5e/ur5e.urdf").to_owned(),
            base_link: Some("base_link".to_owned()),
            tip_link: Some("tool0".to_owned()),
        })
    };
    let mut spec = description.resolve().unwrap().spec;
    let viscous = [[2.0, 3.0, 1.5, 0.4, 0.3, 0.5], [1.0, 0.5, 0.8, 0.2, 0.1, 0.15]];
    let quadratic = [0.6, 0.5, 0.4, 0.1, 0.1, 0.1];
    let coulomb = [[8.0, 9.0, 5.0, 2.0, 1.5, 1.0], [2.0, 3.0, 1.0, 0.5, 0.5, 0.3]];
    let presliding = [[2e-3, 1e-3, 2e-3, 3e-3, 2e-3, 1e-3], [1.5e-3; 6]];
    for (index, joint) in spec.joints.iter_mut().enumerate() {
        let drive = &mut joint.drive;
        drive.rotor_inertia = ROTOR[index];
        drive.stiffness = vec![LINEAR[index], CUBIC[index]];
        drive.damping = Some(4e-4 * LINEAR[index]);
        let side = |side: usize| {
            let coulomb: f64 = coulomb[side][index];
            Friction {
                viscous: viscous[side][index],
                coulomb_positive: if dry { coulomb } else { 0.0 },
                coulomb_negative: if dry { coulomb } else { 0.0 },
                presliding_stiffness: dry.then_some(coulomb / presliding[side][index]),
                ..Friction::default()
            }
        };
        (drive.motor_friction, drive.joint_friction) = (side(0), side(1));
        drive.motor_friction.quadratic = quadratic[index];
        drive.motor_friction.load_coulomb = if dry { 0.05 } else { 0.0 };
    }
    spec
}

fn joints(spec: &RobotSpec) -> Vec<PlantJoint> {
    let as_is = Drift { scale: 1.0, rate: 0.0 };
    let joints = spec.joints.iter().map(|joint| PlantJoint {
        joint: Joint::new(&joint.drive),
        dry: as_is,
        wet: as_is,
    });
    joints.collect()
}

/// Half a second of the UR5e; the largest differences of positions and speeds.
fn differences(nodes: f64, dry: bool, wrench: Option<Wrench>, expected: [[f64; 6]; 4]) -> [f64; 2] {
    let spec = ur5e(dry);
    let robot = test_arms::robot(spec.clone());
    let mut plant = Plant::new(&robot, joints(&spec), &START, &START_VELOCITY);
    plant.nodes = nodes;
    let (constant, swing) = ([0.0, -26.7, -19.7, -1.6, 0.1, 0.0], [12.0, 20.0, 10.0, 3.0, 3.0, 2.0]);
    for k in 0..50 {
        let cos = libm::cos(0.3 * f64::from(k));
        let torque: Vec<f64> = (0..6).map(|joint| constant[joint] + swing[joint] * cos).collect();
        plant.advance(&torque, wrench, 0.01, &Budget::unlimited()).unwrap();
    }
    let off = |part: usize| {
        let found = &plant.state[part * 6..(part + 1) * 6];
        found
            .iter()
            .zip(expected[part])
            .map(|(a, b)| (a - b).abs())
            .fold(0.0, f64::max)
    };
    [off(0).max(off(2)), off(1).max(off(3))]
}

#[test]
fn an_independent_integrator_agrees_where_everything_is_smooth() {
    let wrench = Wrench {
        force: Vector3::new(15.0, -10.0, 20.0),
        moment: Vector3::new(1.0, 2.0, -1.5),
    };
    let expected = [
        [
            0.07843125296826,
            -1.650212646459,
            1.063839796322,
            -1.110826827856,
            -1.098422882299,
            1.193358645349,
        ],
        [
            -1.198057866116,
            -0.6058395587817,
            -0.8815645729476,
            -0.6020707196053,
            1.294645320296,
            2.351728731778,
        ],
        [
            0.07877200266237,
            -1.651677277782,
            1.062692295677,
            -1.111071578067,
            -1.098514283634,
            1.19286566258,
        ],
        [
            -1.199713149893,
            -0.6252655823451,
            -0.8939908013527,
            -0.6067008803013,
            1.295428249117,
            2.35067496616,
        ],
    ];
    for (nodes, allowed) in [(PLANT_NODES, 1e-7), (5e-5, 1e-9)] {
        let [position, velocity] = differences(nodes, false, Some(wrench), expected);
        assert!(
            position < allowed && velocity < 10.0 * allowed,
            "{position:e} {velocity:e}"
        );
    }
}

/// With dry friction every joint turns round at least once, and friction that grows with gravity's torque.
#[test]
fn an_independent_integrator_agrees_where_joints_stick_and_slide() {
    let expected = [
        [
            0.3559831642302,
            -1.406228114932,
            1.244436735147,
            -1.033355569137,
            -1.310829347321,
            0.4960356573739,
        ],
        [
            -0.01391585094144,
            -0.02302775153241,
            0.09528231338336,
            -0.1793915166387,
            -0.03660085136762,
            -0.1058727187289,
        ],
        [
            0.3557230954439,
            -1.408160908932,
            1.242861336679,
            -1.033859780898,
            -1.310750929113,
            0.4960666940848,
        ],
        [
            -0.01654433260411,
            -0.03372665140532,
            0.08897184462225,
            -0.1844853035974,
            -0.04013676054009,
            -0.1136666304221,
        ],
    ];
    for (nodes, allowed) in [(PLANT_NODES, 1e-8), (5e-5, 1e-10)] {
        let [position, velocity] = differences(nodes, true, None, expected);
        assert!(
            position < allowed && velocity < 50.0 * allowed,
            "{position:e} {velocity:e}"
        );
    }
}

/// Motion, gravity and springs of two links in a vertical plane, written out; each mass is at its link's end.
#[test]
fn energy_is_conserved_where_nothing_dissipates() {
    let mut spec = test_arms::planar();
    for (joint, linear) in spec.joints.iter_mut().zip([9.0e3, 4.0e3]) {
        joint.drive.rotor_inertia = 0.8;
        joint.drive.stiffness = vec![linear, 1.0e3 * linear];
    }
    let robot = test_arms::robot(spec.clone());
    let energy = |plant: &Plant<'_>| {
        let (q, qd) = (plant.position(), plant.velocity());
        let (a, b) = (q[0], q[0] + q[1]);
        let (wa, wb) = (qd[0], qd[0] + qd[1]);
        let speed = wa * wa + wb * wb + 2.0 * wa * wb * (a - b).cos();
        let kinetic = 0.5 * (3.0 * wa * wa + 2.0 * speed + 0.01 * (wa * wa + wb * wb));
        let potential = 10.0 * (3.0 * a.sin() + 2.0 * (a.sin() + b.sin()));
        let drives = (0..2).map(|joint| {
            let elastic = plant.arm.joints[joint].joint.transmission.unwrap();
            let rate = plant.state[6 + joint];
            0.5 * 0.8 * rate * rate + elastic.energy(plant.motor_position()[joint] - q[joint])
        });
        kinetic + potential + drives.sum::<f64>()
    };
    for (nodes, allowed) in [(PLANT_NODES, 2e-5), (5e-5, 1e-7)] {
        let mut plant = Plant::new(&robot, joints(&spec), &[0.4, -0.9], &[2.0, -3.0]);
        plant.nodes = nodes;
        let begin = energy(&plant);
        let mut worst = 0.0_f64;
        for _ in 0..1000 {
            plant.advance(&[0.0, 0.0], None, 1e-3, &Budget::unlimited()).unwrap();
            worst = worst.max((energy(&plant) - begin).abs());
        }
        let travelled = (plant.position()[0] - 0.4).abs();
        // of 24 J
        assert!(worst < allowed && travelled > 0.5, "{worst:e} {travelled}");
    }
}

/// Without stiffness the accelerations are those of the forward dynamics, friction at speed included.
#[test]
fn a_rigid_arm_accelerates_as_forward_dynamics_says() {
    for seed in 0..20 {
        let spec = test_arms::random_arm(7, seed);
        let robot = test_arms::robot(spec.clone());
        let state = &mut (seed + 30);
        let [q, qd, torque] = [1.0, 1.0, 50.0].map(|reach| test_arms::values(7, reach, state));
        let mut plant = Plant::new(&robot, joints(&spec), &q, &qd);
        plant.arm.torque.copy_from_slice(&torque);
        for (contacts, qd) in plant.arm.contacts.iter_mut().zip(&qd) {
            contacts[0].part = qd.signum();
        }
        let (mut rates, mut expected) = (vec![0.0; 28], vec![0.0; 7]);
        let begin = plant.state.clone();
        plant.arm.first_node(0.0, &begin).unwrap();
        plant.arm.rates(0.0, &begin, &mut rates);
        let workspace = &mut crate::dynamics::Workspace::new(&robot);
        assert!(crate::dynamics::forward_dynamics(
            &robot,
            workspace,
            &q,
            &qd,
            &torque,
            &mut expected
        ));
        for joint in 0..7 {
            let slack = 1e-9 * (1.0 + expected[joint].abs());
            assert!((rates[7 + joint] - expected[joint]).abs() < slack);
            assert_eq!(rates[7 + joint], rates[21 + joint]);
        }
    }
}

/// A joint on a slope of torque below its Coulomb friction stays; above it, it slides.
#[test]
fn dry_friction_holds_what_it_can() {
    let mut spec = test_arms::lift(2.0);
    spec.gravity = Vector3::zeros();
    spec.joints[0].drive.joint_friction.coulomb_positive = 5.0;
    spec.joints[0].drive.joint_friction.coulomb_negative = 5.0;
    let robot = test_arms::robot(spec.clone());
    for (force, held) in [(4.5, true), (5.5, false)] {
        let mut plant = Plant::new(&robot, joints(&spec), &[0.0], &[0.0]);
        for _ in 0..500 {
            plant.advance(&[force], None, 1e-3, &Budget::unlimited()).unwrap();
        }
        let way = plant.position()[0];
        if held {
            // 4.5·x = ∫F dx at x = 10 δ: that far it overshoots, and creeps a little more while it swings
            assert!(way < 20.0 * crate::tolerance::PRESLIDING_DEFAULT, "{way}");
        } else {
            // ½·(0.5 N/2 kg)·t² = 31 mm, and what was gained while friction built up
            assert!(way > 0.03 && way < 0.05, "{way}");
        }
    }
}
