//! Rehearsals of small arms whose answers are known, and of hostile requests.

use nalgebra::Vector3;

use super::outcome::{Rehearsal, RehearsalOutcome, RunEnd};
use super::request::{Encoder, FrictionTruth, Motion, RehearsalRequest, SetpointMotion, WrenchPulse};
use super::*;
use crate::plan::request::TrajectoryPoint;
use crate::robot::spec::{Friction, RobotSpec};
use crate::test_arms;

/// Two links in a vertical plane on elastic drives: rotors of 1.5 and 0.5 kg m² at the joint, 10 and 4 kN m/rad.
fn elastic() -> RobotSpec {
    let mut spec = test_arms::planar();
    for (joint, (inertia, stiffness, coulomb)) in spec.joints.iter_mut().zip([(1.5, 1.0e4, 6.0), (0.5, 4.0e3, 3.0)]) {
        joint.drive.gear_ratio = 100.0;
        joint.drive.rotor_inertia = inertia / 1.0e4;
        joint.drive.torque_constant = Some(0.1);
        joint.drive.stiffness = vec![stiffness, 1.0e3 * stiffness];
        joint.drive.damping = Some(stiffness * 5.0e-4);
        joint.drive.motor_friction = Friction {
            viscous: 2.0e-4 * coulomb,
            coulomb_positive: 0.01 * coulomb,
            coulomb_negative: 0.01 * coulomb,
            ..Friction::default()
        };
    }
    spec
}

fn swing() -> Motion {
    let mut request = test_arms::request(&[0.3, -0.5], &[1.2, 0.7]);
    request.speed_scale = 0.4;
    Motion::Move(Box::new(request))
}

fn run(spec: RobotSpec, request: &RehearsalRequest) -> Rehearsal {
    let robot = test_arms::robot(spec);
    match rehearse(&robot, request, &Budget::unlimited()).unwrap() {
        RehearsalOutcome::Run(run) => *run,
        other => panic!("{other:?}"),
    }
}

#[test]
fn print() {
    for scale in [1.0, 1.5, 0.5] {
        let mut request = RehearsalRequest::new(swing());
        request.settle = 0.3;
        request.friction = vec![
            FrictionTruth {
                coulomb_scale: scale,
                viscous_scale: scale,
                ..FrictionTruth::default()
            };
            2
        ];
        let found = run(elastic(), &request);
        println!(
            "{scale} {:?} {:?} {:?}",
            found.smoothness, found.gains, found.planned_torque
        );
        for run in [&found.plain, &found.adapted] {
            println!(
                "{:?} steps {} integ {} tool {:e}",
                run.end, run.steps, run.integrator_steps, run.tool_error_peak
            );
            for joint in &run.joints {
                println!(
                    "  peak {:.3e} rms {:.3e} end {:.3e} torque {:.2} margin {:?} F {:.3} {:.3} {:.3}",
                    joint.error_peak,
                    joint.error_rms,
                    joint.error_end,
                    joint.torque_peak,
                    joint.margin,
                    joint.friction.truth_rms,
                    joint.friction.error_rms,
                    joint.friction.error_rms_last
                );
            }
        }
    }
}
