//! What is done with the bytes of a caller: decoded as protobuf and as JSON, converted, and computed with as far as a
//! bounded time allows. None of it may panic. The mutation tests of the workspace run the same functions.

use std::{cell::Cell, hint::black_box, sync::LazyLock};

use prost::Message;
use serde::{Serialize, de::DeserializeOwned};
use takt_motion::{
    Invalid,
    budget::Budget,
    drive::{
        estimate::{FrictionEstimator, UpdateError},
        fit::{
            constant_speed::fit_constant_speed, damping::fit_damping, motion::fit_motion, report::MotionOutcome,
            stiffness::fit_stiffness,
        },
        rehearse,
    },
    dynamics::{self, Workspace},
    kinematics::{self, inverse::Inverse},
    path::{self, outcome::PathOutcome},
    plan::{self, outcome::MoveOutcome},
    robot::{Robot, urdf as reader},
};
use takt_proto::{
    convert::{self, Findings, Path},
    v1,
};

/// Looks at the budget before a calculation is stopped.
const LOOKS: u32 = 50;

/// Most states, points and samples of one input.
const ENTRIES: usize = 64;

/// The arm that requests are about.
static ARM: LazyLock<Robot> = LazyLock::new(|| {
    let text = include_str!("../../robots/scara.json");
    let description: v1::RobotDescription = serde_json::from_str(text).expect("the example is a description");
    registered(&description).expect("the example is sound")
});

/// The chain of a URDF.
pub fn urdf(bytes: &[u8]) {
    let Ok(text) = std::str::from_utf8(bytes) else {
        return;
    };
    for use_dynamics in [false, true] {
        let options = reader::Options {
            use_dynamics,
            ..reader::Options::default()
        };
        match reader::read(text, &options) {
            Ok((chain, _)) => assert!(!chain.joints.is_empty(), "a chain of nothing"),
            Err(errors) => assert_named(&errors),
        }
    }
}

/// A registration.
pub fn register_robot(bytes: &[u8]) {
    for request in decoded::<v1::RegisterRobotRequest>(bytes) {
        let Some(description) = request.description else {
            continue;
        };
        match registered(&description) {
            Ok(robot) => assert!(robot.joint_count() > 0, "a robot of nothing"),
            Err(errors) => assert_named(&errors),
        }
    }
}

/// A move.
pub fn plan_move(bytes: &[u8]) {
    for request in decoded::<v1::PlanMoveRequest>(bytes) {
        if request.trace_points.is_some_and(|count| count > 100) {
            continue;
        }
        let mut findings = Findings::default();
        let request = convert::plan::move_request(request, Some(ARM.spec()), &mut findings);
        let is_right = findings.is_empty();
        assert_named(&findings.into_list());
        match bounded(|budget| plan::plan_move(&ARM, &request, budget)) {
            Ok(outcome) if is_right => {
                if let MoveOutcome::Plan(plan) = &outcome {
                    assert!(plan.duration.is_finite() && plan.duration >= 0.0, "{plan:?}");
                }
                black_box(convert::plan::outcome_to_wire(outcome, ARM.spec()));
            }
            Ok(_) | Err(plan::Failure::Stopped) => {}
            Err(plan::Failure::Invalid(errors)) => assert_named(&errors),
        }
    }
}

/// A robot program.
pub fn plan_path(bytes: &[u8]) {
    for request in decoded::<v1::PlanPathRequest>(bytes) {
        if request.trace_points.is_some_and(|count| count > 100) || request.segments.len() > ENTRIES {
            continue;
        }
        let mut findings = Findings::default();
        let request = convert::path::path_request(request, Some(ARM.spec()), &mut findings);
        let is_right = findings.is_empty();
        assert_named(&findings.into_list());
        match bounded(|budget| path::plan_path(&ARM, &request, budget)) {
            Ok(outcome) if is_right => {
                if let PathOutcome::Plan(plan) = &outcome {
                    assert!(plan.duration.is_finite() && plan.duration >= 0.0, "{plan:?}");
                }
                black_box(convert::path::outcome_to_wire(outcome, ARM.spec()));
            }
            Ok(_) | Err(plan::Failure::Stopped) => {}
            Err(plan::Failure::Invalid(errors)) => assert_named(&errors),
        }
    }
}

/// A trajectory to be checked.
pub fn check_trajectory(bytes: &[u8]) {
    for request in decoded::<v1::CheckTrajectoryRequest>(bytes) {
        let points = request
            .trajectory
            .as_ref()
            .map_or(0, |trajectory| trajectory.points.len());
        if points > ENTRIES {
            continue;
        }
        let mut findings = Findings::default();
        let request = convert::plan::check_request(request, Some(ARM.spec()), &mut findings);
        let is_right = findings.is_empty();
        assert_named(&findings.into_list());
        if !is_right {
            continue;
        }
        match bounded(|budget| plan::check_trajectory(&ARM, &request, budget)) {
            Ok(report) => {
                black_box(convert::plan::report_to_wire(report, ARM.spec()));
            }
            Err(plan::Failure::Stopped) => {}
            Err(plan::Failure::Invalid(errors)) => assert_named(&errors),
        }
    }
}

/// States whose torques are asked for.
pub fn inverse_dynamics(bytes: &[u8]) {
    for request in decoded::<v1::InverseDynamicsRequest>(bytes) {
        let mut findings = Findings::default();
        let count = ARM.joint_count();
        convert::dynamics::joint_states(&request.states, Some(count), &mut findings);
        convert::dynamics::wanted(&request.r#return, &mut findings);
        let payload = request.payload.as_ref();
        let payload =
            payload.map(|payload| convert::robot::payload(payload, Path::Root.field("payload"), &mut findings));
        if findings.finish(()).map_err(|errors| assert_named(&errors)).is_err() {
            continue;
        }
        let loaded = payload.map(|payload| ARM.with_payload(&payload));
        let robot = loaded.as_ref().unwrap_or(&ARM);
        let mut workspace = Workspace::new(robot);
        let zeros = vec![0.0; count];
        let or_zeros = |values: &Vec<f64>| {
            if values.is_empty() {
                zeros.clone()
            } else {
                values.clone()
            }
        };
        for state in request.states.iter().take(ENTRIES) {
            let (qd, qdd) = (or_zeros(&state.velocity), or_zeros(&state.acceleration));
            let mut torque = zeros.clone();
            dynamics::rigid_torque(robot, &mut workspace, &state.position, &qd, &qdd, &mut torque);
            let mut matrix = vec![0.0; count * count];
            dynamics::mass_matrix(robot, &mut workspace, &state.position, &mut matrix);
        }
    }
}

/// States whose poses are asked for.
pub fn forward_kinematics(bytes: &[u8]) {
    for request in decoded::<v1::ForwardKinematicsRequest>(bytes) {
        let mut findings = Findings::default();
        convert::dynamics::joint_positions(&request.states, Some(ARM.joint_count()), &mut findings);
        let tool = request.tool.as_ref();
        let tcp = tool.map(|tool| convert::robot::tool(tool, Path::Root.field("tool"), &mut findings));
        if findings.finish(()).map_err(|errors| assert_named(&errors)).is_err() {
            continue;
        }
        let tcp = tcp.unwrap_or(ARM.spec().tcp);
        for state in request.states.iter().take(ENTRIES) {
            black_box(convert::dynamics::pose_result(&kinematics::pose(
                &ARM,
                &state.position,
                &tcp,
            )));
        }
    }
}

/// Poses whose joint positions are asked for.
pub fn inverse_kinematics(bytes: &[u8]) {
    for request in decoded::<v1::InverseKinematicsRequest>(bytes) {
        let mut findings = Findings::default();
        let poses = convert::dynamics::poses(&request, Some(ARM.spec()), &mut findings);
        let tool = request.tool.as_ref();
        let tcp = tool.map(|tool| convert::robot::tool(tool, Path::Root.field("tool"), &mut findings));
        if findings.finish(()).map_err(|errors| assert_named(&errors)).is_err() {
            continue;
        }
        let inverse = Inverse::new(&ARM, &tcp.unwrap_or(ARM.spec().tcp));
        for pose in poses.targets.iter().take(1) {
            let found = inverse.solutions(pose, poses.reference.as_deref(), poses.turns);
            black_box(convert::dynamics::solutions_result(found));
        }
    }
}

/// A message of a stream of telemetry: what is asked for, or what drives report.
pub fn estimate_friction(bytes: &[u8]) {
    use v1::estimate_friction_request::Part;
    for request in decoded::<v1::EstimateFrictionRequest>(bytes) {
        match request.part {
            Some(Part::Header(header)) => {
                if let Some(mut estimator) = estimator(&header) {
                    estimate(&mut estimator, &REPORTED);
                }
            }
            Some(Part::Telemetry(block)) if block.time_s.len() <= ENTRIES => {
                for method in [1, 3] {
                    let header = v1::EstimateHeader {
                        method: Some(method),
                        ..Default::default()
                    };
                    if let Some(mut estimator) = estimator(&header) {
                        estimate(&mut estimator, &block);
                        estimate(&mut estimator, &REPORTED);
                    }
                }
            }
            Some(Part::Telemetry(_)) | None => {}
        }
    }
}

/// What the drives of the arm report for a while.
static REPORTED: LazyLock<v1::Telemetry> = LazyLock::new(|| {
    let times = (0..ENTRIES as u32).map(|index| f64::from(index) * 0.01);
    let joints = (0..ARM.joint_count()).map(|_| v1::TelemetryColumns {
        position: times.clone().map(|time| 0.1 * (3.0 * time).sin()).collect(),
        torque: times.clone().map(|time| (3.0 * time).cos()).collect(),
        ..Default::default()
    });
    v1::Telemetry {
        joints: joints.collect(),
        time_s: times.clone().collect(),
    }
});

/// The estimator that a header asks for.
fn estimator(header: &v1::EstimateHeader) -> Option<FrictionEstimator> {
    let mut findings = Findings::default();
    let options = convert::drive::options(header, Path::Root, Some(ARM.spec()), &mut findings);
    findings.finish(()).map_err(|errors| assert_named(&errors)).ok()?;
    let made = match &header.state {
        Some(state) => FrictionEstimator::resume(ARM.clone(), options, &convert::drive::state(state)),
        None => FrictionEstimator::new(ARM.clone(), options),
    };
    let named = |errors: Vec<Invalid>| {
        let errors = errors.into_iter();
        let errors = errors.map(|error| convert::drive::finding_on_header(error, header, ARM.spec()));
        assert_named(&errors.collect::<Vec<_>>());
    };
    made.map_err(named).ok()
}

/// Takes in a block, and says what is known then.
fn estimate(estimator: &mut FrictionEstimator, block: &v1::Telemetry) {
    let mut findings = Findings::default();
    let read = convert::drive::telemetry(block, Path::Root.field("telemetry"), ARM.spec(), &mut findings);
    if findings.finish(()).map_err(|errors| assert_named(&errors)).is_err() {
        return;
    }
    match bounded(|budget| estimator.update(&read, budget)) {
        Ok(()) | Err(UpdateError::Stopped) => {}
        Err(UpdateError::Invalid(errors)) => {
            let errors = errors.into_iter().map(convert::drive::finding_on_telemetry);
            assert_named(&errors.collect::<Vec<_>>());
        }
    }
    black_box(convert::drive::estimate_to_wire(&estimator.report(), ARM.spec()));
    black_box(convert::drive::state_to_wire(estimator.state()));
}

/// A recording that a drive or an arm is fitted to.
pub fn fit_drive(bytes: &[u8]) {
    use v1::fit_drive_request::Fit;
    for request in decoded::<v1::FitDriveRequest>(bytes) {
        match request.fit {
            Some(Fit::Motion(wire)) => fit_recording(&wire),
            Some(Fit::Stiffness(wire)) if wire.torque.len() <= ENTRIES => {
                let terms = usize::try_from(wire.terms.unwrap_or(1)).unwrap_or(usize::MAX);
                told(fit_stiffness(&wire.torque, &wire.deformation, terms), "stiffness");
            }
            Some(Fit::Damping(wire)) if wire.time_s.len() <= ENTRIES => {
                told(fit_damping(&wire.time_s, &wire.amplitude, 0.5), "damping");
            }
            Some(Fit::ConstantSpeed(wire)) if wire.runs.len() <= ENTRIES => {
                let runs = convert::fit::runs(&wire.runs);
                told(fit_constant_speed(&runs, &[2e4, 1e7]), "constant_speed");
            }
            Some(_) | None => {}
        }
    }
}

/// What a bench fit says, or what it finds wrong.
fn told<T>(found: Result<T, Vec<Invalid>>, field: &str) {
    match found {
        Ok(found) => drop(black_box(found)),
        Err(errors) => {
            let errors = errors.into_iter();
            let errors = errors.map(|error| convert::fit::finding_on_bench(error, field));
            assert_named(&errors.collect::<Vec<_>>());
        }
    }
}

fn fit_recording(wire: &v1::MotionFitRequest) {
    let mut findings = Findings::default();
    let read = convert::fit::motion_fit_request(wire, Some(ARM.spec()), &mut findings);
    let is_right = findings.is_empty();
    assert_named(&findings.into_list());
    let Some(read) = read.filter(|_| is_right) else {
        return;
    };
    match bounded(|budget| fit_motion(&ARM, &read.recording, &read.options, budget)) {
        Ok(MotionOutcome::Fitted(fit)) => {
            let robot = Robot::new(fit.spec.clone(), Vec::new());
            assert!(robot.is_ok(), "a fit makes a robot that cannot be: {robot:?}");
            black_box(convert::fit::fit_to_wire(&fit, ARM.spec()));
        }
        Ok(MotionOutcome::NotExcited(missing)) => {
            black_box(convert::fit::missing_to_wire(&missing, ARM.spec()));
        }
        Err(plan::Failure::Stopped) => {}
        Err(plan::Failure::Invalid(errors)) => {
            let errors = errors.into_iter();
            let errors = errors
                .map(|error| convert::fit::finding_on_recording(error, wire, ARM.spec(), convert::fit::Part::Identify));
            assert_named(&errors.collect::<Vec<_>>());
        }
    }
}

/// A rehearsal.
pub fn rehearse(bytes: &[u8]) {
    for request in decoded::<v1::RehearseRequest>(bytes) {
        let mut findings = Findings::default();
        let wire = request.clone();
        let read = convert::rehearse::rehearsal_request(request, Some(ARM.spec()), &mut findings);
        let is_right = findings.is_empty();
        assert_named(&findings.into_list());
        let Some(read) = read.filter(|_| is_right) else {
            continue;
        };
        match bounded(|budget| rehearse::rehearse(&ARM, &read, budget)) {
            Ok(outcome) => {
                black_box(convert::rehearse::outcome_to_wire(outcome, ARM.spec()));
            }
            Err(plan::Failure::Stopped) => {}
            Err(plan::Failure::Invalid(errors)) => {
                let errors = errors.into_iter();
                let errors = errors.map(|error| convert::rehearse::finding_on_request(error, &wire, ARM.spec()));
                assert_named(&errors.collect::<Vec<_>>());
            }
        }
    }
}

/// The messages that the bytes are: as protobuf, as JSON. What was read is written and read again.
fn decoded<M: Message + Default + DeserializeOwned + Serialize>(bytes: &[u8]) -> Vec<M> {
    let mut messages = Vec::new();
    if let Ok(message) = M::decode(bytes) {
        assert!(
            M::decode(&*message.encode_to_vec()).is_ok(),
            "what was written cannot be read"
        );
        // Unknown enum values have no JSON.
        let _ = serde_json::to_vec(&message);
        messages.push(message);
    }
    if let Ok(message) = serde_json::from_slice::<M>(bytes) {
        messages.push(message);
    }
    messages
}

/// A description, resolved and compiled.
fn registered(wire: &v1::RobotDescription) -> Result<Robot, Vec<Invalid>> {
    let mut findings = Findings::default();
    let description = convert::robot::description(wire, Path::Root, &mut findings);
    findings.finish(())?;
    let description = description.expect("where nothing is found, there is a description");
    let resolved = description.resolve().map_err(|errors| {
        let errors = errors.into_iter();
        errors
            .map(|error| convert::robot::finding_on_description(error, wire))
            .collect::<Vec<_>>()
    })?;
    let spec = resolved.spec.clone();
    Robot::new(resolved.spec, resolved.warnings).map_err(|errors| {
        let errors = errors.into_iter();
        errors
            .map(|error| convert::robot::finding_on_spec(error, &spec, wire))
            .collect()
    })
}

/// Computes until the budget has been looked at so many times.
fn bounded<T>(compute: impl FnOnce(&Budget<'_>) -> T) -> T {
    let left = Cell::new(LOOKS);
    let should_stop = || {
        left.set(left.get().saturating_sub(1));
        left.get() == 0
    };
    compute(&Budget::until(&should_stop))
}

/// Every finding has a sentence that is short enough to travel.
fn assert_named(errors: &[Invalid]) {
    for error in errors {
        assert!(!error.message.is_empty(), "{error:?}");
        assert!(error.path.len() < 4096, "{} bytes of path", error.path.len());
    }
}
