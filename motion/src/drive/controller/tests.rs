//! The controller's step against what it must be.

use super::*;
use crate::test_arms;

fn controller(adaptation: Adaptation) -> Controller {
    let mut spec = test_arms::planar();
    for joint in &mut spec.joints {
        joint.drive.gear_ratio = -50.0;
        joint.drive.rotor_inertia = 4e-4;
        joint.drive.torque_constant = Some(0.1);
        joint.drive.stiffness = vec![1e4];
    }
    let robot = test_arms::robot(spec);
    let gains = default_gains(&robot, &[vec![0.0, 0.0]], 1e-3);
    Controller::new(&robot, &gains, &[], adaptation, 1e-3).unwrap()
}

/// Where everything is as planned, the motor is told what the feed-forward says, of this step and the next.
#[test]
fn without_errors_the_feed_forward_is_commanded() {
    let controller = controller(Adaptation::default());
    let desired = Desired {
        position: 0.3,
        rigid_torque: 20.0,
        transmission_torque: 20.0,
        motor_torque: 20.0,
        ..Desired::default()
    };
    let next = Desired {
        rigid_torque: 22.0,
        ..desired
    };
    let measured = Measured {
        motor_position: 0.3 + 20.0 / 1e4,
        output_position: Some(0.3),
    };
    let (_, command) = controller.joints()[0].step(JointState::default(), measured, &desired, &next);
    assert!((command.torque - 21.0).abs() < 1e-9, "{command:?}");
    // τ = ξ·k_t·i
    assert!((command.current.unwrap() + 21.0 / 5.0).abs() < 1e-9);
}

#[test]
fn torque_is_limited_and_what_was_demanded_is_told() {
    let controller = controller(Adaptation::Off);
    let measured = Measured {
        motor_position: -1.0,
        output_position: Some(-1.0),
    };
    let desired = Desired::default();
    let (state, command) = controller.joints()[1].step(JointState::default(), measured, &desired, &desired);
    assert_eq!((command.torque, state.motor_torque), (40.0, 40.0));
    assert!(command.demanded > 40.0);
}

/// Fig. 11: what the model's friction leaves over is followed by a lag of rate L, whatever the period.
#[test]
fn the_observer_is_a_first_order_lag() {
    for period in [1e-4, 1e-3, 1e-2, 1.0] {
        let robot = test_arms::robot(test_arms::lift(2.0));
        let gains = [JointGains {
            position: 0.0,
            velocity: 0.0,
            torque: 0.0,
            velocity_filter: 0.0,
        }];
        let rate = 3.0;
        let controller =
            Controller::new(&robot, &gains, &[], Adaptation::Observer { rate: Some(rate) }, period).unwrap();
        // held still by 7 N more than the model's 20
        let desired = Desired {
            transmission_torque: 20.0,
            rigid_torque: 20.0,
            motor_torque: 27.0,
            ..Desired::default()
        };
        let mut state = JointState::default();
        for k in 0..200 {
            let (next, _) = controller.joints()[0].step(state, Measured::default(), &desired, &desired);
            state = next;
            (state.motor_torque, state.motor_torque_before) = (27.0, 27.0);
            let expected = 7.0 * (1.0 - (-rate * period * f64::from(k)).exp());
            assert!((state.motor_friction - expected).abs() < 1e-9, "{period} {k}");
        }
    }
}

#[test]
fn what_cannot_be_is_named() {
    let robot = test_arms::robot(test_arms::planar());
    let gain = JointGains {
        position: f64::NAN,
        velocity: -1.0,
        torque: 0.0,
        velocity_filter: 1.0,
    };
    let adaptation = Adaptation::Observer { rate: Some(-1.0) };
    let wrong = Controller::new(&robot, &[gain], &[1.0, 0.0, 3.0], adaptation, 0.0).unwrap_err();
    let paths: Vec<&str> = wrong.iter().map(|finding| finding.path.as_str()).collect();
    assert_eq!(
        paths,
        [
            "gains",
            "current_limits",
            "period_s",
            "gains[0].position",
            "gains[0].velocity",
            "adaptation.rate",
            "current_limits[0]",
            "current_limits[1]",
        ]
    );
}
