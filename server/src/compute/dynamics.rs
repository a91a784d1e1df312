//! Torques and poses of many states.

use std::time::Instant;

use takt_motion::{
    Invalid,
    budget::Budget,
    dynamics::{self, Workspace},
    kinematics::{self, inverse::Inverse},
    robot::Robot,
};
use takt_proto::{
    convert::{self, Path},
    v1,
};

use super::{Reading, Subject, finite};
use crate::{config::Limits, error::ServiceError, limits::at_most, planner::stopped};

/// States between two looks at whether anybody still waits.
const STATES_BETWEEN_CHECKS: usize = 64;

fn check_count(field: &str, count: usize, limits: &Limits) -> Result<(), ServiceError> {
    match at_most(field, count, limits.max_states, "max_states") {
        Some(invalid) => Err(ServiceError::invalid(vec![invalid])),
        None => Ok(()),
    }
}

/// Torques of many states.
pub(crate) fn inverse_dynamics(
    mut request: v1::InverseDynamicsRequest,
    subject: Subject,
    limits: &Limits,
    deadline: Instant,
    budget: &Budget<'_>,
) -> Result<v1::InverseDynamicsResponse, ServiceError> {
    let mut reading = Reading::of(&mut request, subject);
    check_count("states", request.states.len(), limits)?;
    let (wanted, payload) = reading.convert(|spec, findings| {
        let joint_count = spec.map(|spec| spec.joints.len());
        convert::dynamics::joint_states(&request.states, joint_count, findings);
        let wanted = convert::dynamics::wanted(&request.r#return, findings);
        let payload = request.payload.as_ref();
        let payload = payload.map(|payload| convert::robot::payload(payload, Path::Root.field("payload"), findings));
        (wanted, payload)
    });
    let (compiled, provenance) = reading.checked()?;
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
        provenance: Some(provenance),
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
        dynamics::friction_torque(robot, workspace, q, qd, &mut friction_torque);
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
    let mut reading = Reading::of(&mut request, subject);
    check_count("states", request.states.len(), limits)?;
    let tcp = reading.convert(|spec, findings| {
        let joint_count = spec.map(|spec| spec.joints.len());
        convert::dynamics::joint_positions(&request.states, joint_count, findings);
        let tool = request.tool.as_ref();
        tool.map(|tool| convert::robot::tool(tool, Path::Root.field("tool"), findings))
    });
    let (compiled, provenance) = reading.checked()?;
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
        provenance: Some(provenance),
    })
}

/// Joint positions of many poses.
pub(crate) fn inverse_kinematics(
    mut request: v1::InverseKinematicsRequest,
    subject: Subject,
    limits: &Limits,
    deadline: Instant,
    budget: &Budget<'_>,
) -> Result<v1::InverseKinematicsResponse, ServiceError> {
    let mut reading = Reading::of(&mut request, subject);
    check_count("targets", request.targets.len(), limits)?;
    let (poses, tcp) = reading.convert(|spec, findings| {
        let poses = convert::dynamics::poses(&request, spec, findings);
        let tool = request.tool.as_ref();
        let tcp = tool.map(|tool| convert::robot::tool(tool, Path::Root.field("tool"), findings));
        (poses, tcp)
    });
    let (compiled, provenance) = reading.checked()?;
    let tcp = tcp.unwrap_or(compiled.robot.spec().tcp);
    let inverse = Inverse::new(&compiled.robot, &tcp);
    let mut results = Vec::with_capacity(poses.targets.len());
    let mut solution_count = 0;
    for (index, pose) in poses.targets.iter().enumerate() {
        budget.check().map_err(|_| stopped(deadline))?;
        let found = inverse.solutions(pose, poses.reference.as_deref(), poses.turns);
        let result = convert::dynamics::solutions_result(found);
        if !finite::inverse(&result) {
            let invalid = Invalid::new(format!("targets[{index}]"), "is too large to compute with");
            return Err(ServiceError::invalid(vec![invalid]));
        }
        solution_count += result.solutions.len();
        if solution_count > limits.max_setpoints {
            let most = limits.max_setpoints;
            let message = format!(
                "the targets up to this one have more than the {most} solutions that `limits.max_setpoints` allows"
            );
            return Err(ServiceError::invalid(vec![Invalid::new(
                format!("targets[{index}]"),
                message,
            )]));
        }
        results.push(result);
    }
    Ok(v1::InverseKinematicsResponse {
        results,
        provenance: Some(provenance),
    })
}
