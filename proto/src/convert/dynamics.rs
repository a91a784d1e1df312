//! States in, torques and poses out.

use takt_motion::{POSITION_MAX, nalgebra::Isometry3};

use super::{Findings, Path, robot};
use crate::v1;

/// Largest velocity or acceleration of a state: its square is computed with.
const RATE_MAX: f64 = 1e9;

const QUANTITIES: &str = "MASS_MATRIX, JACOBIAN";

/// What to return beside the torques.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Wanted {
    /// The mass matrix.
    pub mass_matrix: bool,
    /// The Jacobian of the TCP.
    pub jacobian: bool,
}

/// Checks joint states. What a state leaves out stays empty.
pub fn joint_states(states: &[v1::JointState], joint_count: Option<usize>, findings: &mut Findings) {
    let list_at = Path::Root.field("states");
    if states.is_empty() {
        findings.push(list_at, "must have at least one entry");
    }
    for (index, state) in states.iter().enumerate() {
        let at = list_at.index(index);
        check_position(findings, at.field("position"), &state.position, joint_count);
        check(findings, at.field("velocity"), &state.velocity, joint_count);
        check(findings, at.field("acceleration"), &state.acceleration, joint_count);
    }
}

/// Checks joint positions.
pub fn joint_positions(states: &[v1::JointPosition], joint_count: Option<usize>, findings: &mut Findings) {
    let list_at = Path::Root.field("states");
    if states.is_empty() {
        findings.push(list_at, "must have at least one entry");
    }
    for (index, state) in states.iter().enumerate() {
        let at = list_at.index(index);
        check_position(findings, at.field("position"), &state.position, joint_count);
    }
}

/// What may be left out.
fn check(findings: &mut Findings, at: Path<'_>, values: &[f64], joint_count: Option<usize>) {
    if values.is_empty() {
        return;
    }
    findings.joint_values(at, values, joint_count);
    findings.at_most(at, values, RATE_MAX);
}

/// Positions as far out as the planner takes them: beyond, sines lose their accuracy.
fn check_position(findings: &mut Findings, at: Path<'_>, values: &[f64], joint_count: Option<usize>) {
    findings.joint_values(at, values, joint_count);
    findings.at_most(at, values, POSITION_MAX);
}

/// Reads what to return.
pub fn wanted(quantities: &[i32], findings: &mut Findings) -> Wanted {
    use v1::inverse_dynamics_request::Quantity;
    let mut wanted = Wanted::default();
    let list_at = Path::Root.field("return");
    for (index, &quantity) in quantities.iter().enumerate() {
        match findings.enumerated(list_at.index(index), quantity, QUANTITIES) {
            Some(Quantity::MassMatrix) => wanted.mass_matrix = true,
            Some(Quantity::Jacobian) => wanted.jacobian = true,
            Some(Quantity::Unspecified) | None => {}
        }
    }
    wanted
}

/// Writes the pose of the TCP.
#[must_use]
pub fn pose_result(pose: &Isometry3<f64>) -> v1::ForwardKinematicsResult {
    v1::ForwardKinematicsResult {
        pose: Some(robot::pose_to_wire(pose)),
    }
}
