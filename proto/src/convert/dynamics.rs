//! States in, torques and poses out.

use takt_motion::{
    POSITION_MAX,
    kinematics::inverse::{Method, Solution, Solutions, Turns, Unreachable},
    nalgebra::Isometry3,
    robot::spec::RobotSpec,
};

use super::{Findings, Path, robot, unknown};
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

/// Poses whose joint positions are asked for.
#[derive(Debug, Clone, PartialEq)]
pub struct Poses {
    /// In base-link axes.
    pub targets: Vec<Isometry3<f64>>,
    /// One value a joint.
    pub reference: Option<Vec<f64>>,
    /// Which of the solutions that differ by whole turns.
    pub turns: Turns,
}

/// Reads poses; those in a frame of the robot come out in base-link axes.
pub fn poses(wire: &v1::InverseKinematicsRequest, robot: Option<&RobotSpec>, findings: &mut Findings) -> Poses {
    let list_at = Path::Root.field("targets");
    if wire.targets.is_empty() {
        findings.push(list_at, "must have at least one entry");
    }
    let targets = wire.targets.iter().enumerate();
    let targets = targets.map(|(index, target)| {
        let at = list_at.index(index);
        let base_from_frame = frame(target.frame.as_deref(), at.field("frame"), robot, findings);
        let Some(pose) = &target.pose else {
            findings.push(at.field("pose"), "must be given");
            return base_from_frame;
        };
        base_from_frame * robot::pose(pose, at.field("pose"), findings)
    });
    let targets = targets.collect();
    let reference = wire.reference.as_ref().map(|reference| {
        let at = Path::Root.field("reference");
        let joint_count = robot.map(|robot| robot.joints.len());
        check_position(findings, at.field("position"), &reference.position, joint_count);
        reference.position.clone()
    });
    Poses {
        targets,
        reference,
        turns: match wire.all_turns.unwrap_or(false) {
            true => Turns::Every,
            false => Turns::Nearest,
        },
    }
}

/// A frame of the robot by its name; none, and the empty name, are base-link axes.
fn frame(wire: Option<&str>, at: Path<'_>, robot: Option<&RobotSpec>, findings: &mut Findings) -> Isometry3<f64> {
    let (Some(name), Some(robot)) = (wire.filter(|name| !name.is_empty()), robot) else {
        return Isometry3::identity();
    };
    let Some((_, pose)) = robot.frames.iter().find(|(known, _)| known == name) else {
        let known = robot.frames.iter().map(|(name, _)| name.as_str());
        findings.push(at, unknown("frame", name, known));
        return Isometry3::identity();
    };
    *pose
}

/// Writes the joint positions of one pose, or why there are none.
#[must_use]
pub fn solutions_result(found: Result<Solutions, Unreachable>) -> v1::InverseKinematicsResult {
    use v1::inverse_kinematics_result::Method as Wire;
    let (position, position_gap, orientation_gap) = match found {
        Ok(found) => {
            let method = match found.method {
                Method::ClosedForm => Wire::ClosedForm,
                Method::Numerical => Wire::Numerical,
            };
            return v1::InverseKinematicsResult {
                solutions: found.solutions.into_iter().map(solution).collect(),
                method: Some(method.into()),
                out_of_reach: None,
            };
        }
        Err(
            Unreachable::OutOfReach {
                closest,
                position_gap,
                orientation_gap,
            }
            | Unreachable::Singular {
                closest,
                position_gap,
                orientation_gap,
                ..
            },
        ) => (closest, position_gap, orientation_gap),
        // There it is reached, though with a joint outside its range.
        Err(Unreachable::JointRange { positions, .. }) => (positions, 0.0, 0.0),
    };
    v1::InverseKinematicsResult {
        out_of_reach: Some(v1::OutOfReach {
            nearest_position: position,
            missing_m: position_gap,
            missing_rad: orientation_gap,
        }),
        ..v1::InverseKinematicsResult::default()
    }
}

fn solution(solution: Solution) -> v1::InverseKinematicsSolution {
    v1::InverseKinematicsSolution {
        position: solution.position,
        position_error_m: solution.position_error,
        orientation_error_rad: solution.orientation_error,
        in_range: solution.in_range,
        smallest_singular_value: solution.smallest_singular_value,
    }
}
