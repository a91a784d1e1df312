//! Rehearsals of small arms whose answers are known, and of hostile requests.

use nalgebra::Vector3;

use super::outcome::{Rehearsal, RehearsalOutcome, RunEnd};
use super::request::{Encoder, FrictionTruth, Motion, RehearsalRequest, SetpointMotion, WrenchPulse};
use super::*;
use crate::path::request::{PathRequest, Segment, Shape, Target};
use crate::plan::request::{LimitOverride, TrajectoryPoint};
use crate::robot::spec::{Friction, RobotSpec};
use crate::test_arms;

/// Two links in a vertical plane on elastic drives: rotors of 2 and 0.8 kg m² at the joint, 40 and 10 kN m/rad.
fn elastic() -> RobotSpec {
    let mut spec = test_arms::planar();
    let drives = [(2.0, 4.0e4, 6.0), (0.8, 1.0e4, 3.0)];
    for (joint, (inertia, stiffness, coulomb)) in spec.joints.iter_mut().zip(drives) {
        joint.drive.peak_torque = Some(3.0 * joint.drive.peak_torque.unwrap());
        joint.drive.gear_ratio = 100.0;
        joint.drive.rotor_inertia = inertia / 1.0e4;
        joint.drive.torque_constant = Some(0.1);
        joint.drive.stiffness = vec![stiffness, 1.0e3 * stiffness];
        joint.drive.damping = Some(stiffness * 5.0e-4);
        joint.drive.motor_friction = Friction {
            viscous: 5.0e-5 * coulomb,
            coulomb_positive: 0.01 * coulomb,
            coulomb_negative: 0.01 * coulomb,
            ..Friction::default()
        };
    }
    spec
}

/// There and back, with limited jerk.
fn program() -> PathRequest {
    let to = |position: [f64; 2]| {
        Segment::new(Shape::Joint {
            target: Target::Joints(position.to_vec()),
        })
    };
    let limit = |joint: &str| LimitOverride {
        joint: joint.to_owned(),
        velocity: Some(1.5),
        acceleration: Some(6.0),
        jerk: Some(60.0),
        ..LimitOverride::default()
    };
    PathRequest {
        limits: vec![limit("shoulder"), limit("elbow")],
        torque_utilization: 0.8,
        ..PathRequest::new(vec![0.3, -0.5], vec![to([0.9, 0.3]), to([0.4, -0.4])])
    }
}

fn path() -> RehearsalRequest {
    RehearsalRequest::new(Motion::Path(Box::new(program())))
}

/// At rest at a place for a time.
fn hold(position: &[f64], time: f64) -> Motion {
    let point = |time: f64| TrajectoryPoint {
        time,
        position: position.to_vec(),
        velocity: vec![0.0; position.len()],
        acceleration: vec![0.0; position.len()],
    };
    Motion::Setpoints(SetpointMotion {
        points: vec![point(0.0), point(time)],
        interpolation: None,
        payload: None,
    })
}

fn wrong(scale: f64) -> Vec<FrictionTruth> {
    let truth = FrictionTruth {
        coulomb_scale: scale,
        viscous_scale: scale,
        ..FrictionTruth::default()
    };
    vec![truth; 2]
}

fn outcome(spec: RobotSpec, request: &RehearsalRequest) -> RehearsalOutcome {
    rehearse(&test_arms::robot(spec), request, &Budget::unlimited()).unwrap()
}

fn run(spec: RobotSpec, request: &RehearsalRequest) -> Rehearsal {
    match outcome(spec, request) {
        RehearsalOutcome::Run(run) => *run,
        other => panic!("{other:?}"),
    }
}

/// Without friction and with a motion that is smooth to the fourth derivative, an elastic arm follows to a part in a thousand of
/// what its transmissions wind up. Along t⁵(126 − 420t + 540t² − 315t³ + 70t⁴), four of whose derivatives are 0 at both ends.
#[test]
fn an_arm_as_its_model_follows_its_plan() {
    let mut spec = elastic();
    for joint in &mut spec.joints {
        joint.drive.motor_friction = Friction::default();
        joint.drive.damping = Some(0.0);
    }
    let robot = test_arms::robot(spec);
    let states = (0..=1000).flat_map(|k| {
        let mut p = [0.0, 0.0, 0.0, 0.0, 0.0, 126.0, -420.0, 540.0, -315.0, 70.0];
        let values: [f64; 5] = std::array::from_fn(|_| {
            let value = p.iter().rev().fold(0.0, |sum, c| sum * 1e-3 * f64::from(k) + c);
            for power in 0..10 {
                p[power] = p.get(power + 1).map_or(0.0, |next| next * (power + 1) as f64);
            }
            value
        });
        [(0.3, 0.6), (-0.5, 0.8)].map(|(start, way)| {
            let mut state = values.map(|value| way * value);
            state[0] += start;
            state
        })
    });
    let reference = Reference {
        joint_count: 2,
        period: 1e-3,
        duration: 1.0,
        states: states.collect(),
        smooth: vec![true; 1001],
        continuity: 4,
        payload: None,
        warnings: Vec::new(),
    };
    let planned = feed_forward(&robot, &reference, &Budget::unlimited()).unwrap().unwrap();
    let gains = default_gains(&robot, &poses(&reference), 1e-3);
    let request = RehearsalRequest::new(hold(&[0.0, 0.0], 1.0));
    let rehearsed = Rehearsed {
        request: &request,
        truth: &robot,
        planned: &planned,
        tcp: nalgebra::Isometry3::identity(),
    };
    let largest = largest_torques(&planned);
    for adaptation in [Adaptation::Off, Adaptation::default()] {
        let controller = Controller::new(&robot, &gains, &[], adaptation, 1e-3).unwrap();
        let run = rehearsed.run(&controller, &Budget::unlimited()).unwrap();
        for (joint, planned) in run.joints.iter().zip(&largest) {
            assert!(joint.error_peak < 2e-3 * joint.deformation_peak.abs());
            assert!((joint.torque_peak.abs() - planned).abs() < 2e-3 * planned);
        }
    }
}

#[test]
fn a_stiff_feed_forward_is_worse() {
    let mut spec = elastic();
    for joint in &mut spec.joints {
        joint.drive.motor_friction = Friction::default();
    }
    let exact = run(spec.clone(), &path());
    // jerk is not limited: accelerations jump all along
    let mut request = path();
    let Motion::Path(program) = &mut request.motion else {
        unreachable!()
    };
    program.limit_jerk = false;
    let stiff = run(spec, &request);
    assert_eq!((stiff.smoothness.exact_steps, stiff.smoothness.continuity), (0, 1));
    for (stiff, exact) in stiff.plain.joints.iter().zip(&exact.plain.joints) {
        assert!(stiff.error_rms > 3.0 * exact.error_rms);
    }
}

#[test]
fn adaptation_takes_back_what_wrong_friction_costs() {
    for scale in [0.5, 1.5] {
        let mut request = path();
        request.friction = wrong(scale);
        let found = run(elastic(), &request);
        for (plain, adapted) in found.plain.joints.iter().zip(&found.adapted.joints) {
            assert!(adapted.error_rms < 0.5 * plain.error_rms, "{scale}");
            assert!(
                adapted.friction.error_rms_last < 0.5 * plain.friction.error_rms_last,
                "{scale}"
            );
            assert_eq!(adapted.friction.points.len(), plain.friction.points.len());
        }
        assert!(found.adapted.tool_error_rms < 0.5 * found.plain.tool_error_rms);
        // more friction asks for more torque than was planned
        let (true_peak, planned) = (found.adapted.joints[0].torque_peak.abs(), found.planned_torque[0]);
        assert_eq!(true_peak > planned, scale > 1.0);
    }
}

#[test]
fn friction_that_drifts_is_followed() {
    let mut request = path();
    request.friction = wrong(1.0);
    for truth in &mut request.friction {
        (truth.coulomb_rate, truth.viscous_rate) = (0.5, 0.5);
    }
    let found = run(elastic(), &request);
    for (plain, adapted) in found.plain.joints.iter().zip(&found.adapted.joints) {
        assert!(adapted.friction.error_rms_last < 0.5 * plain.friction.error_rms_last);
    }
}

/// At rest under a wrench, in closed form: e = Jᵀ·F passes the transmission besides gravity; K_t·e and K_p·ΔΘ hold it.
#[test]
fn a_wrench_deflects_a_held_arm_by_gains_and_stiffness() {
    let mut spec = elastic();
    for joint in &mut spec.joints {
        joint.drive.motor_friction = Friction::default();
        joint.drive.stiffness.truncate(1);
    }
    let q = [0.4, 0.7];
    let mut request = RehearsalRequest::new(hold(&q, 3.0));
    let force = 6.0;
    request.wrenches = vec![WrenchPulse {
        begin: 0.1,
        end: 10.0,
        force: Vector3::new(0.0, 0.0, -force),
        moment: Vector3::zeros(),
    }];
    let found = run(spec.clone(), &request);
    // the tip is at the elbow's origin: links are 1 m long, and the first one alone carries it
    let tip = crate::kinematics::pose(&test_arms::robot(spec.clone()), &q, &nalgebra::Isometry3::identity());
    let expected = [-force * tip.translation.x, 0.0];
    for (joint, expected) in expected.into_iter().enumerate() {
        let gains = found.gains[joint];
        let stiffness = spec.joints[joint].drive.stiffness[0];
        let deflection = expected * ((1.0 + gains.torque) / gains.position + 1.0 / stiffness);
        let end = found.plain.joints[joint].error_end;
        // gravity changes with the pose: some percent, and of the elbow what the shoulder's deflection makes it
        assert!((end - deflection).abs() < 0.05 * deflection.abs() + 1e-4);
        // both observers take the wrench for friction, and the output comes back
        assert!(found.adapted.joints[joint].error_end.abs() < 0.05 * deflection.abs() + 1e-5);
    }
}

/// From rest to rest without friction, the motors do the work of lifting, and no other.
#[test]
fn the_work_is_that_of_lifting() {
    let mut request = RehearsalRequest::new(Motion::Move(Box::new(test_arms::request(&[0.0], &[1.5]))));
    request.settle = 0.5;
    let found = run(test_arms::lift(2.0), &request);
    assert!(
        (found.plain.work - 2.0 * 10.0 * 1.5).abs() < 0.01,
        "{}",
        found.plain.work
    );
    assert!(found.plain.energy_given >= found.plain.work);
    assert_eq!(found.flexible, [false]);
    assert!(
        found
            .warnings
            .iter()
            .any(|warning| warning.contains("simulated as rigid"))
    );
    assert_eq!(found.plain.joints[0].current_peak, None);
}

#[test]
fn the_same_request_has_the_same_answer_and_noise_its_seed() {
    let mut request = path();
    request.friction = wrong(1.3);
    request.encoders = vec![
        Encoder {
            motor_step: 2e-6,
            motor_noise: 1e-6,
            output_step: 1e-5,
            output_noise: 5e-6,
            ..Encoder::default()
        };
        2
    ];
    request.trace_every = Some(10);
    let (first, second) = (run(elastic(), &request), run(elastic(), &request));
    assert_eq!(first, second);
    request.seed = 1;
    let other = run(elastic(), &request);
    assert_ne!(first.adapted, other.adapted);
    // it does no harm that adaptation could not live with
    for (plain, adapted) in first.plain.joints.iter().zip(&first.adapted.joints) {
        assert!(adapted.error_rms < 0.7 * plain.error_rms);
    }
    let trace = first.plain.trace.unwrap();
    assert_eq!(trace.time.len(), first.steps.div_ceil(10));
    assert!(
        trace
            .joints
            .iter()
            .all(|joint| joint.true_friction.len() == trace.time.len())
    );
}

#[test]
fn an_output_that_is_not_measured_still_adapts() {
    let mut request = path();
    request.friction = wrong(1.5);
    let encoder = Encoder {
        has_output: false,
        ..Encoder::default()
    };
    request.encoders = vec![encoder; 2];
    let found = run(elastic(), &request);
    for (plain, adapted) in found.plain.joints.iter().zip(&found.adapted.joints) {
        assert!(adapted.error_rms < 0.6 * plain.error_rms);
    }
}

#[test]
fn a_current_limit_bounds_the_torque() {
    let mut request = path();
    // the shoulder holds 70 N m at the start: 7 A
    request.current_limits = vec![7.5, 5.0];
    let found = run(elastic(), &request);
    let shoulder = &found.plain.joints[0];
    assert!((shoulder.torque_limit.unwrap() - 75.0).abs() < 1e-9);
    assert!(shoulder.limited_time > 0.0 && shoulder.margin.unwrap() < 0.0);
    assert!((shoulder.current_peak.unwrap().abs() - 7.5).abs() < 1e-9);
}

#[test]
fn what_cannot_be_simulated_is_said() {
    let mut stiff = elastic();
    stiff.joints[1].drive.stiffness = vec![1.0e13];
    let request = RehearsalRequest::new(hold(&[0.4, 0.7], 0.01));
    let mut push = request.clone();
    push.wrenches = vec![WrenchPulse {
        begin: 0.0,
        end: 1.0,
        force: Vector3::new(1.0, 0.0, -50.0),
        moment: Vector3::zeros(),
    }];
    let found = run(stiff, &push);
    assert!(matches!(found.plain.end, RunEnd::TooStiff { .. }));
    let mut weak = elastic();
    weak.joints[0].drive.stiffness = vec![4.0e3, -1.0e8];
    match outcome(weak.clone(), &request) {
        RehearsalOutcome::TransmissionRange(range) => assert_eq!((range.joint, range.time), (0, 0.0)),
        other => panic!("{other:?}"),
    }
    // a plan that it holds, and a wrench that it does not
    weak.joints[0].drive.stiffness = vec![1.0e4, -1.0e7];
    push.motion = hold(&[0.4, 0.7], 1.0);
    push.wrenches[0].force *= 10.0;
    let found = run(weak, &push);
    assert!(
        matches!(found.plain.end, RunEnd::TransmissionRange(_) | RunEnd::Diverged { .. }),
        "{:?}",
        found.plain.end
    );
    assert!(found.plain.steps < found.steps);
}

#[test]
fn everything_that_is_wrong_is_named() {
    let mut request = path();
    request.period = 0.0;
    request.settle = f64::NAN;
    request.friction = wrong(-1.0);
    request.friction[1].coulomb_rate = f64::INFINITY;
    request.encoders = vec![Encoder::default(); 3];
    request.encoders[0].motor_step = f64::NAN;
    request.wrenches = vec![WrenchPulse {
        begin: 2.0,
        end: 1.0,
        force: Vector3::new(f64::NAN, 0.0, 0.0),
        moment: Vector3::zeros(),
    }];
    request.trace_every = Some(0);
    let robot = test_arms::robot(elastic());
    let Err(Failure::Invalid(wrong)) = rehearse(&robot, &request, &Budget::unlimited()) else {
        panic!("it is wrong");
    };
    let paths: Vec<&str> = wrong.iter().map(|finding| finding.path.as_str()).collect();
    assert_eq!(
        paths,
        [
            "period_s",
            "settle_s",
            "trace_every",
            "encoders",
            "friction[0].coulomb_scale",
            "friction[0].viscous_scale",
            "friction[1].coulomb_scale",
            "friction[1].viscous_scale",
            "friction[1].coulomb_rate",
            "encoders[0].motor_step",
            "wrenches[0]",
            "wrenches[0]",
        ]
    );
    let mut long = RehearsalRequest::new(hold(&[0.4, 0.7], 1.0));
    long.settle = 1.0e6;
    assert!(matches!(
        rehearse(&robot, &long, &Budget::unlimited()),
        Err(Failure::Invalid(_))
    ));
    long.settle = 1.0;
    let stop = || true;
    assert_eq!(rehearse(&robot, &long, &Budget::until(&stop)), Err(Failure::Stopped));
}
