//! Nothing is allocated in a control loop: every function of the dynamics works in what its caller holds.

use takt_motion::budget::Budget;
use takt_motion::drive::controller::{Adaptation, Command, Controller, Measured, default_gains};
use takt_motion::drive::estimate::{EstimatorMethod, EstimatorOptions, FrictionEstimator, FrictionLaw};
use takt_motion::drive::feedforward::Desired;
use takt_motion::drive::telemetry::Telemetry;
use takt_motion::dynamics::{self, Workspace};
use takt_motion::kinematics;
use takt_motion::nalgebra::{Isometry3, Vector3};
use takt_motion::process::generator::{CircleGenerator, TransitionGenerator};
use takt_motion::robot::Robot;

use super::example;

#[test]
fn dynamics_and_kinematics_allocate_nothing() {
    for name in ["ur5e", "fr3", "puma560", "scara"] {
        let resolved = example::description(name).resolve().expect("an arm");
        let robot = Robot::new(resolved.spec, resolved.warnings).expect("a robot");
        let count = robot.joint_count();
        let workspace = &mut Workspace::new(&robot);
        let (q, qd, qdd) = (vec![0.1; count], vec![0.5; count], vec![-1.0; count]);
        let (mut torque, mut acceleration) = (vec![0.0; count], vec![0.0; count]);
        let (mut matrix, mut jacobian) = (vec![0.0; count * count], vec![0.0; 6 * count]);
        let tcp = Isometry3::translation(0.0, 0.0, 0.1);
        let counted = allocation_counter::measure(|| {
            dynamics::rigid_torque(&robot, workspace, &q, &qd, &qdd, &mut torque);
            dynamics::gravity_torque(&robot, workspace, &q, &mut torque);
            dynamics::friction_torque(&robot, workspace, &q, &qd, &mut torque);
            dynamics::rotor_torque(&robot, &qdd, &mut torque);
            dynamics::drive_torque(&robot, workspace, &q, &qd, &qdd, &mut torque);
            dynamics::mass_matrix(&robot, workspace, &q, &mut matrix);
            assert!(dynamics::forward_dynamics(
                &robot,
                workspace,
                &q,
                &qd,
                &torque,
                &mut acceleration
            ));
            kinematics::jacobian(&robot, &q, &tcp, &mut jacobian);
            std::hint::black_box(kinematics::pose(&robot, &q, &tcp));
        });
        assert_eq!(counted.count_total, 0, "{name}");
        // and it was all computed
        for (back, asked) in acceleration.iter().zip(&qdd) {
            assert!((back - asked).abs() < 1e-9, "{name}: {acceleration:?}");
        }
    }
}

#[test]
fn set_points_at_constant_speed_allocate_nothing() {
    let (center, start) = (Vector3::zeros(), Vector3::new(0.1, 0.0, 0.0));
    let ahead = Vector3::new(0.0, 0.1, 0.0);
    let mut points = 0;
    let counted = allocation_counter::measure(|| {
        let circle = CircleGenerator::new(center, Vector3::z(), start, 0.001).expect("a circle");
        let transition = TransitionGenerator::source(&start, &center, &ahead, 50);
        points = circle.take(1000).chain(transition).map(std::hint::black_box).count();
    });
    assert_eq!((counted.count_total, points), (0, 1050));
}

#[test]
fn estimating_friction_allocates_nothing_after_the_first_block() {
    let resolved = example::description("ur5e").resolve().expect("an arm");
    let robot = Robot::new(resolved.spec, resolved.warnings).expect("a robot");
    let block = |from: f64| {
        let times: Vec<f64> = (0..500).map(|index| from + 0.001 * f64::from(index)).collect();
        let joints = times
            .iter()
            .flat_map(|time| (0..6).map(move |joint| (f64::from(joint), time)));
        Telemetry {
            output_position: joints.clone().map(|(joint, time)| (joint + 2.0 * time).sin()).collect(),
            motor_torque: joints.map(|(joint, time)| (joint + time).cos()).collect(),
            time: times,
            ..Telemetry::default()
        }
    };
    for method in [
        EstimatorMethod::LeastSquares,
        EstimatorMethod::Observer,
        EstimatorMethod::Kalman,
    ] {
        let options = EstimatorOptions {
            method,
            law: FrictionLaw {
                by_direction: true,
                load: true,
                quadratic: true,
            },
            ..EstimatorOptions::default()
        };
        let mut estimator = FrictionEstimator::new(robot.clone(), options).expect("options");
        estimator.update(&block(0.0), &Budget::unlimited()).expect("a block");
        let next = block(0.5);
        let counted = allocation_counter::measure(|| {
            estimator.update(&next, &Budget::unlimited()).expect("a block");
        });
        assert_eq!(counted.count_total, 0, "{method:?}");
        assert!(estimator.report().joints.iter().all(|joint| joint.used_count > 100));
    }
}

#[test]
fn a_step_of_the_controller_allocates_nothing() {
    let resolved = example::description("puma560").resolve().expect("an arm");
    let mut spec = resolved.spec;
    for joint in &mut spec.joints {
        joint.drive.stiffness = vec![1.0e4, 1.0e6];
    }
    let robot = Robot::new(spec, resolved.warnings).expect("a robot");
    let count = robot.joint_count();
    let gains = default_gains(&robot, &[vec![0.1; count]], 1.0e-3);
    let controller = Controller::new(&robot, &gains, &[], Adaptation::default(), 1.0e-3).expect("a controller");
    let mut states = controller.start();
    let mut commands = vec![Command::default(); count];
    let measured = vec![
        Measured {
            motor_position: 0.02,
            output_position: Some(0.01),
        };
        count
    ];
    let desired = vec![
        Desired {
            velocity: 0.5,
            motor_velocity: 0.5,
            rigid_torque: 5.0,
            ..Desired::default()
        };
        count
    ];
    let counted = allocation_counter::measure(|| {
        for _ in 0..100 {
            controller.step(&mut states, &measured, &desired, &desired, &mut commands);
        }
    });
    assert_eq!(counted.count_total, 0);
    // and it was all computed
    assert!(
        commands
            .iter()
            .all(|command| command.torque != 0.0 && command.friction != 0.0)
    );
    assert!(states.iter().all(|state| state.motor_learned.coulomb != 0.0));
}
