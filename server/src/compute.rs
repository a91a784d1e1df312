//! What runs on the planner's threads: from a request and a robot to the answer. Pure.

use std::{sync::Arc, time::Instant};

use prost::Message;
use takt_motion::{
    Invalid,
    budget::Budget,
    dynamics::{self, Workspace},
    kinematics,
    plan::{self, outcome::MoveOutcome},
    robot::{Robot, urdf_writer},
};
use takt_proto::{
    convert::{self, Findings, Path, robot::PresetInForce},
    id::{RobotId, content_hash},
    v1,
};
use tracing::Span;

use crate::{
    config::Limits,
    error::ServiceError,
    limits::at_most,
    planner::stopped,
    registry::{
        Compiled,
        store::{Record, Revision},
    },
};

/// The robot of a request.
pub(crate) enum Subject {
    /// Found.
    Robot(Arc<Compiled>),
    /// The request does not name one; what else is wrong with it is said together with this.
    Unnamed(Invalid),
}

impl Subject {
    fn look(self, findings: &mut Findings) -> Option<Arc<Compiled>> {
        match self {
            Self::Robot(robot) => Some(robot),
            Self::Unnamed(invalid) => {
                findings.push_invalid(invalid);
                None
            }
        }
    }
}

/// Everything that is left when nothing was found wrong.
fn checked<T>(findings: Findings, robot: Option<Arc<Compiled>>, value: T) -> Result<(Arc<Compiled>, T), ServiceError> {
    let value = findings.finish(value).map_err(ServiceError::invalid)?;
    let robot = robot.ok_or_else(|| ServiceError::internal("the request was let through without a robot"))?;
    Ok((robot, value))
}

/// What the answer was computed from. The hash is of the request with the revision that was used.
fn provenance(revision: &Revision, request_hash: String) -> v1::Provenance {
    v1::Provenance {
        revision: revision.to_string(),
        version: crate::VERSION.to_owned(),
        request_hash,
    }
}

/// A description checked and compiled, and the record to be kept of it.
pub(crate) fn register(
    id: Result<RobotId, Invalid>,
    description: Option<v1::RobotDescription>,
) -> Result<(RobotId, Compiled, Record, v1::Robot), ServiceError> {
    let mut findings = Findings::default();
    if let Err(invalid) = &id {
        findings.push_invalid(invalid.clone());
    }
    let at = Path::Root.field("description");
    let Some(description) = description else {
        findings.push(at, "must be given");
        return Err(ServiceError::invalid(findings.into_list()));
    };
    let robot = match compile(&description, findings) {
        Ok(robot) => robot,
        Err(invalid) => return Err(ServiceError::invalid(invalid)),
    };
    let id = id.map_err(|invalid| ServiceError::invalid(vec![invalid]))?;
    let revision: Revision = content_hash("RobotDescription", &description).into();
    let summary = convert::robot::robot_to_wire(id.as_str(), &revision, robot.spec(), robot.warnings(), |joint| {
        robot.preset(joint).map(|preset| PresetInForce {
            acceleration: preset.acceleration,
            deceleration: preset.deceleration,
            derived: preset.derived,
        })
    });
    let record = Record {
        revision: Arc::clone(&revision),
        description: description.encode_to_vec(),
        summary: summary.encode_to_vec(),
    };
    Ok((id, Compiled { revision, robot }, record, summary))
}

/// A stored description compiled again.
pub(crate) fn compile_stored(record: &Record) -> Result<Robot, ServiceError> {
    let description = decode::<v1::RobotDescription>(&record.description)?;
    compile(&description, Findings::default()).map_err(|invalid| {
        let first = invalid.first().map(ToString::to_string).unwrap_or_default();
        let message = format!("this version cannot use revision {} any more: {first}", record.revision);
        ServiceError::internal(message)
    })
}

/// A stored message.
pub(crate) fn decode<M: Message + Default>(bytes: &[u8]) -> Result<M, ServiceError> {
    M::decode(bytes).map_err(|error| ServiceError::internal("a stored message cannot be read").caused_by(error))
}

fn compile(wire: &v1::RobotDescription, mut findings: Findings) -> Result<Robot, Vec<Invalid>> {
    let at = Path::Root.field("description");
    let below = |invalid: Invalid| invalid.below("description");
    let Some(description) = convert::robot::description(wire, at, &mut findings) else {
        return Err(findings.into_list());
    };
    // Also where something is wrong already: the caller sees everything at once.
    let resolved = match description.resolve() {
        Ok(resolved) => findings.finish(resolved)?,
        Err(list) => {
            let list = list.into_iter();
            let list = list.map(|invalid| below(convert::robot::finding_on_description(invalid, wire)));
            findings.extend(list.collect());
            return Err(findings.into_list());
        }
    };
    let spec = resolved.spec.clone();
    Robot::new(resolved.spec, resolved.warnings).map_err(|list| {
        let list = list.into_iter();
        let list = list.map(|invalid| below(convert::robot::finding_on_spec(invalid, &spec, wire)));
        list.collect()
    })
}

/// The chain as a URDF.
pub(crate) fn urdf(robot: &Robot, id: &RobotId) -> String {
    urdf_writer::write(robot.spec(), id.as_str())
}

/// Plans a move.
pub(crate) fn plan_move(
    mut request: v1::PlanMoveRequest,
    subject: Subject,
    limits: &Limits,
    deadline: Instant,
    budget: &Budget<'_>,
) -> Result<v1::PlanMoveResponse, ServiceError> {
    let mut findings = Findings::default();
    let robot = subject.look(&mut findings);
    let trace_points = request.trace_points.unwrap_or(0);
    let trace_points = usize::try_from(trace_points).unwrap_or(usize::MAX);
    if let Some(invalid) = at_most("trace_points", trace_points, limits.max_setpoints, "max_setpoints") {
        findings.push_invalid(invalid);
    }
    let mut hash = String::new();
    if let Some(robot) = &robot {
        request.revision = Some(robot.revision.to_string());
        hash = content_hash("PlanMoveRequest", &request);
    }
    let spec = robot.as_ref().map(|robot| robot.robot.spec());
    let request = convert::plan::move_request(request, spec, &mut findings);
    if let Some(robot) = robot.as_deref().filter(|_| !findings.is_empty()) {
        add_domain_findings(&mut findings, plan::plan_move(&robot.robot, &request, &no_time()).err());
    }
    let (robot, request) = checked(findings, robot, request)?;
    let outcome = plan::plan_move(&robot.robot, &request, budget).map_err(|failure| failed(failure, deadline))?;
    check_setpoints(&outcome, limits)?;
    Span::current().record("outcome", outcome_name(&outcome));
    Ok(v1::PlanMoveResponse {
        outcome: Some(convert::plan::outcome_to_wire(outcome, robot.robot.spec())),
        provenance: Some(provenance(&robot.revision, hash)),
    })
}

/// A budget that has ended: enough for a request to be looked at, and for nothing to be computed.
fn no_time() -> Budget<'static> {
    Budget::until(&|| true)
}

/// Where the request is wrong already, what else the planner finds wrong with it: the caller sees everything at once.
fn add_domain_findings(findings: &mut Findings, failure: Option<plan::Failure>) {
    if let Some(plan::Failure::Invalid(list)) = failure {
        findings.extend(list);
    }
}

fn outcome_name(outcome: &MoveOutcome) -> &'static str {
    match outcome {
        MoveOutcome::Plan(_) => "plan",
        MoveOutcome::Infeasible(_) => "infeasible",
    }
}

/// How many set-points a period makes is known when the plan is.
fn check_setpoints(outcome: &MoveOutcome, limits: &Limits) -> Result<(), ServiceError> {
    let MoveOutcome::Plan(plan) = outcome else {
        return Ok(());
    };
    let count = plan.setpoints.as_ref().map_or(0, |setpoints| setpoints.time.len());
    match at_most("sample_period_s", count, limits.max_setpoints, "max_setpoints") {
        Some(invalid) => Err(ServiceError::invalid(vec![invalid])),
        None => Ok(()),
    }
}

fn failed(failure: plan::Failure, deadline: Instant) -> ServiceError {
    match failure {
        plan::Failure::Invalid(violations) => ServiceError::invalid(violations),
        plan::Failure::Stopped => stopped(deadline),
    }
}

/// Checks a trajectory.
pub(crate) fn check_trajectory(
    mut request: v1::CheckTrajectoryRequest,
    subject: Subject,
    limits: &Limits,
    deadline: Instant,
    budget: &Budget<'_>,
) -> Result<v1::CheckTrajectoryResponse, ServiceError> {
    let mut findings = Findings::default();
    let robot = subject.look(&mut findings);
    let count = request
        .trajectory
        .as_ref()
        .map_or(0, |trajectory| trajectory.points.len());
    const POINTS: &str = "trajectory.points";
    if let Some(invalid) = at_most(POINTS, count, limits.max_trajectory_points, "max_trajectory_points") {
        return Err(ServiceError::invalid(vec![invalid]));
    }
    let mut hash = String::new();
    if let Some(robot) = &robot {
        request.revision = Some(robot.revision.to_string());
        hash = content_hash("CheckTrajectoryRequest", &request);
    }
    let spec = robot.as_ref().map(|robot| robot.robot.spec());
    let request = convert::plan::check_request(request, spec, &mut findings);
    if let Some(robot) = robot.as_deref().filter(|_| !findings.is_empty()) {
        add_domain_findings(
            &mut findings,
            plan::check_trajectory(&robot.robot, &request, &no_time()).err(),
        );
    }
    let (robot, request) = checked(findings, robot, request)?;
    let report = plan::check_trajectory(&robot.robot, &request, budget).map_err(|failure| failed(failure, deadline))?;
    Ok(v1::CheckTrajectoryResponse {
        provenance: Some(provenance(&robot.revision, hash)),
        ..convert::plan::report_to_wire(report, robot.robot.spec())
    })
}

/// States between two looks at whether anybody still waits.
const STATES_BETWEEN_CHECKS: usize = 64;

/// Torques of many states.
pub(crate) fn inverse_dynamics(
    mut request: v1::InverseDynamicsRequest,
    subject: Subject,
    limits: &Limits,
    deadline: Instant,
    budget: &Budget<'_>,
) -> Result<v1::InverseDynamicsResponse, ServiceError> {
    let mut findings = Findings::default();
    let robot = subject.look(&mut findings);
    if let Some(invalid) = at_most("states", request.states.len(), limits.max_states, "max_states") {
        return Err(ServiceError::invalid(vec![invalid]));
    }
    let mut hash = String::new();
    if let Some(robot) = &robot {
        request.revision = Some(robot.revision.to_string());
        hash = content_hash("InverseDynamicsRequest", &request);
    }
    let joint_count = robot.as_ref().map(|robot| robot.robot.joint_count());
    convert::dynamics::joint_states(&request.states, joint_count, &mut findings);
    let wanted = convert::dynamics::wanted(&request.r#return, &mut findings);
    let payload = request.payload.as_ref();
    let payload = payload.map(|payload| convert::robot::payload(payload, Path::Root.field("payload"), &mut findings));
    let (compiled, ()) = checked(findings, robot, ())?;
    let loaded = payload.map(|payload| compiled.robot.with_payload(&payload));
    let mut states = States::new(loaded.as_ref().unwrap_or(&compiled.robot), wanted);
    let mut results = Vec::with_capacity(request.states.len());
    for (index, state) in request.states.iter().enumerate() {
        if index % STATES_BETWEEN_CHECKS == 0 {
            budget.check().map_err(|_| stopped(deadline))?;
        }
        let result = states.result(state);
        if !result
            .torque
            .iter()
            .chain(&result.mass_matrix)
            .all(|value| value.is_finite())
        {
            let invalid = Invalid::new(format!("states[{index}]"), "is too large to compute with");
            return Err(ServiceError::invalid(vec![invalid]));
        }
        results.push(result);
    }
    Ok(v1::InverseDynamicsResponse {
        results,
        provenance: Some(provenance(&compiled.revision, hash)),
    })
}

/// Inverse dynamics of one robot, state by state.
struct States<'a> {
    robot: &'a Robot,
    workspace: Workspace,
    zeros: Vec<f64>,
    wanted: convert::dynamics::Wanted,
}

impl<'a> States<'a> {
    fn new(robot: &'a Robot, wanted: convert::dynamics::Wanted) -> Self {
        Self {
            workspace: Workspace::new(robot),
            zeros: vec![0.0; robot.joint_count()],
            robot,
            wanted,
        }
    }

    fn result(&mut self, state: &v1::JointState) -> v1::InverseDynamicsResult {
        let count = self.zeros.len();
        let (robot, workspace) = (self.robot, &mut self.workspace);
        let q = &state.position;
        let qd = if state.velocity.is_empty() {
            &self.zeros
        } else {
            &state.velocity
        };
        let qdd = if state.acceleration.is_empty() {
            &self.zeros
        } else {
            &state.acceleration
        };
        let mut rigid_torque = vec![0.0; count];
        let mut gravity_torque = vec![0.0; count];
        let mut rotor_torque = vec![0.0; count];
        let mut friction_torque = vec![0.0; count];
        dynamics::rigid_torque(robot, workspace, q, qd, qdd, &mut rigid_torque);
        dynamics::gravity_torque(robot, workspace, q, &mut gravity_torque);
        dynamics::rotor_torque(robot, qdd, &mut rotor_torque);
        dynamics::friction_torque(robot, qd, &mut friction_torque);
        let parts = rigid_torque.iter().zip(&rotor_torque).zip(&friction_torque);
        let torque = parts
            .map(|((rigid, rotor), friction)| rigid + rotor + friction)
            .collect();
        let (mass_matrix, rigid_mass_matrix) = self.mass_matrices(q);
        let mut jacobian = Vec::new();
        if self.wanted.jacobian {
            jacobian = vec![0.0; 6 * count];
            kinematics::jacobian(robot, q, &robot.spec().tcp, &mut jacobian);
        }
        v1::InverseDynamicsResult {
            torque,
            rigid_torque,
            gravity_torque,
            rotor_torque,
            friction_torque,
            mass_matrix,
            jacobian,
            rigid_mass_matrix,
        }
    }

    /// With and without the rotors; empty where not wanted.
    fn mass_matrices(&mut self, q: &[f64]) -> (Vec<f64>, Vec<f64>) {
        if !self.wanted.mass_matrix {
            return (Vec::new(), Vec::new());
        }
        let count = self.zeros.len();
        let mut rigid = vec![0.0; count * count];
        dynamics::mass_matrix(self.robot, &mut self.workspace, q, &mut rigid);
        let mut full = rigid.clone();
        for (index, joint) in self.robot.spec().joints.iter().enumerate() {
            let drive = &joint.drive;
            full[index * (count + 1)] += drive.rotor_inertia * drive.gear_ratio * drive.gear_ratio;
        }
        (full, rigid)
    }
}

/// Poses of many states.
pub(crate) fn forward_kinematics(
    mut request: v1::ForwardKinematicsRequest,
    subject: Subject,
    limits: &Limits,
    deadline: Instant,
    budget: &Budget<'_>,
) -> Result<v1::ForwardKinematicsResponse, ServiceError> {
    let mut findings = Findings::default();
    let robot = subject.look(&mut findings);
    if let Some(invalid) = at_most("states", request.states.len(), limits.max_states, "max_states") {
        return Err(ServiceError::invalid(vec![invalid]));
    }
    let mut hash = String::new();
    if let Some(robot) = &robot {
        request.revision = Some(robot.revision.to_string());
        hash = content_hash("ForwardKinematicsRequest", &request);
    }
    let joint_count = robot.as_ref().map(|robot| robot.robot.joint_count());
    convert::dynamics::joint_positions(&request.states, joint_count, &mut findings);
    let tool = request.tool.as_ref();
    let tcp = tool.map(|tool| convert::robot::tool(tool, Path::Root.field("tool"), &mut findings));
    let (compiled, ()) = checked(findings, robot, ())?;
    let tcp = tcp.unwrap_or(compiled.robot.spec().tcp);
    let mut results = Vec::with_capacity(request.states.len());
    for (index, state) in request.states.iter().enumerate() {
        if index % STATES_BETWEEN_CHECKS == 0 {
            budget.check().map_err(|_| stopped(deadline))?;
        }
        let pose = kinematics::pose(&compiled.robot, &state.position, &tcp);
        if !pose.to_homogeneous().iter().all(|value| value.is_finite()) {
            let invalid = Invalid::new(format!("states[{index}]"), "is too large to compute with");
            return Err(ServiceError::invalid(vec![invalid]));
        }
        results.push(convert::dynamics::pose_result(&pose));
    }
    Ok(v1::ForwardKinematicsResponse {
        results,
        provenance: Some(provenance(&compiled.revision, hash)),
    })
}
