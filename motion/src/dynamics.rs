//! The equation of motion of a robot at its joints:
//!
//! ```text
//! τ = M(q)·q̈ + C(q, q̇)·q̇ + g(q)    rigid bodies, payload included
//!   + ξ²·I_m·q̈                      rotors, seen through the gears
//!   + F(q, q̇)                       friction: viscous, quadratic, Coulomb, and of the load that gravity is
//! ```
//!
//! τ is the torque (force, for a prismatic joint) that the drives must give, N m (N); q is in rad (m). Every function
//! takes one value a joint in model order, allocates nothing, and panics where a slice has another length: callers check
//! lengths where values enter.

pub(crate) mod chain;
pub(crate) mod composite;
pub(crate) mod drive;
pub(crate) mod path;
pub mod regressor;
pub(crate) mod rnea;
pub(crate) mod sweep;

use crate::robot::Robot;
use composite::Composite;
use rnea::LinkWrench;

/// Scratch of one robot, reused from call to call.
pub struct Workspace {
    links: Vec<LinkWrench<f64>>,
    composites: Vec<Composite>,
    zeros: Vec<f64>,
    gravity: Vec<f64>,
    matrix: Vec<f64>,
}

impl Workspace {
    /// Scratch for a robot, or for any with as many joints.
    #[must_use]
    pub fn new(robot: &Robot) -> Self {
        let count = robot.joint_count();
        Self {
            links: vec![LinkWrench::zero(0.0); count],
            composites: vec![Composite::zero(); count],
            zeros: vec![0.0; count],
            gravity: vec![0.0; count],
            matrix: vec![0.0; count * count],
        }
    }
}

impl std::fmt::Debug for Workspace {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Workspace")
            .field("joint_count", &self.zeros.len())
            .finish_non_exhaustive()
    }
}

/// Torque of the rigid bodies alone: M·q̈ + C·q̇ + g.
pub fn rigid_torque(robot: &Robot, workspace: &mut Workspace, q: &[f64], qd: &[f64], qdd: &[f64], torque: &mut [f64]) {
    check_lengths(robot, &[q, qd, qdd, torque]);
    rnea::rnea::<f64, false>(
        robot.chain(),
        q,
        qd,
        qdd,
        &mut workspace.links,
        torque,
        &mut workspace.gravity,
    );
}

/// Torque of gravity alone.
pub fn gravity_torque(robot: &Robot, workspace: &mut Workspace, q: &[f64], torque: &mut [f64]) {
    check_lengths(robot, &[q, torque]);
    let Workspace {
        links, zeros, gravity, ..
    } = workspace;
    rnea::rnea::<f64, false>(robot.chain(), q, zeros, zeros, links, torque, gravity);
}

/// Torque that the rotors take: ξ²·I_m·q̈.
pub fn rotor_torque(robot: &Robot, qdd: &[f64], torque: &mut [f64]) {
    check_lengths(robot, &[qdd, torque]);
    for ((torque, drive), &qdd) in torque.iter_mut().zip(robot.drives()).zip(qdd) {
        *torque = drive.armature * qdd;
    }
}

/// Torque that friction takes; none at standstill.
pub fn friction_torque(robot: &Robot, workspace: &mut Workspace, q: &[f64], qd: &[f64], torque: &mut [f64]) {
    check_lengths(robot, &[q, qd, torque]);
    // what gravity asks is in the place of the result, until that replaces it
    torque.fill(0.0);
    if robot.is_loaded() {
        gravity_torque(robot, workspace, q, torque);
    }
    for ((torque, drive), &qd) in torque.iter_mut().zip(robot.drives()).zip(qd) {
        *torque = drive.friction(qd, *torque);
    }
}

/// The whole torque that the drives must give: rigid bodies, rotors and friction.
pub fn drive_torque(robot: &Robot, workspace: &mut Workspace, q: &[f64], qd: &[f64], qdd: &[f64], torque: &mut [f64]) {
    check_lengths(robot, &[q, qd, qdd, torque]);
    let Workspace { links, gravity, .. } = workspace;
    rigid_torque_and_load(robot, links, q, qd, qdd, torque, gravity);
    let rates = qd.iter().zip(qdd).zip(gravity.iter());
    for ((torque, drive), ((&qd, &qdd), &gravity)) in torque.iter_mut().zip(robot.drives()).zip(rates) {
        *torque += drive.armature * qdd + drive.friction(qd, gravity);
    }
}

/// Torque of the rigid bodies, and gravity's part of it where some drive's friction depends on that; else zeros.
fn rigid_torque_and_load(
    robot: &Robot,
    links: &mut [LinkWrench<f64>],
    q: &[f64],
    qd: &[f64],
    qdd: &[f64],
    torque: &mut [f64],
    gravity: &mut [f64],
) {
    if robot.is_loaded() {
        return rnea::rnea::<f64, true>(robot.chain(), q, qd, qdd, links, torque, gravity);
    }
    gravity.fill(0.0);
    rnea::rnea::<f64, false>(robot.chain(), q, qd, qdd, links, torque, gravity);
}

/// Mass matrix of the rigid bodies, n × n, row by row; the rotors are not in it.
pub fn mass_matrix(robot: &Robot, workspace: &mut Workspace, q: &[f64], matrix: &mut [f64]) {
    check_lengths(robot, &[q]);
    assert_eq!(matrix.len(), q.len() * q.len(), "matrix: n x n entries");
    composite::mass_matrix(robot.chain(), q, &mut workspace.composites, matrix);
}

/// Acceleration that torques at the joints bring about: the inverse of [`drive_torque`].
///
/// Returns false, and leaves `acceleration` without meaning, where the mass matrix is singular.
pub fn forward_dynamics(
    robot: &Robot,
    workspace: &mut Workspace,
    q: &[f64],
    qd: &[f64],
    torque: &[f64],
    acceleration: &mut [f64],
) -> bool {
    check_lengths(robot, &[q, qd, torque, acceleration]);
    let Workspace {
        links,
        composites,
        zeros,
        gravity,
        matrix,
    } = workspace;
    let count = q.len();
    rigid_torque_and_load(robot, links, q, qd, zeros, acceleration, gravity);
    for (i, drive) in robot.drives().iter().enumerate() {
        acceleration[i] = torque[i] - acceleration[i] - drive.friction(qd[i], gravity[i]);
    }
    composite::mass_matrix(robot.chain(), q, composites, matrix);
    for (i, drive) in robot.drives().iter().enumerate() {
        matrix[i * count + i] += drive.armature;
    }
    solve_symmetric(matrix, acceleration)
}

/// Smallest part of a diagonal entry that its pivot may be: below it, what is left of the entry is rounding.
const PIVOT_MIN: f64 = 1.0e-12;

/// Solves A·x = b in place for a symmetric positive definite A, row by row, by Cholesky's method; b becomes x.
/// Returns false where A is not positive definite to within [`PIVOT_MIN`].
pub(crate) fn solve_symmetric(a: &mut [f64], b: &mut [f64]) -> bool {
    let n = b.len();
    for j in 0..n {
        let diagonal = a[j * n + j];
        for k in 0..j {
            let factor = a[j * n + k];
            for i in j..n {
                a[i * n + j] -= a[i * n + k] * factor;
            }
        }
        let pivot = a[j * n + j];
        if pivot.is_nan() || pivot <= PIVOT_MIN * diagonal {
            return false;
        }
        let root = pivot.sqrt();
        for i in j..n {
            a[i * n + j] /= root;
        }
    }
    for i in 0..n {
        for k in 0..i {
            b[i] -= a[i * n + k] * b[k];
        }
        b[i] /= a[i * n + i];
    }
    for i in (0..n).rev() {
        for k in i + 1..n {
            b[i] -= a[k * n + i] * b[k];
        }
        b[i] /= a[i * n + i];
    }
    true
}

fn check_lengths(robot: &Robot, slices: &[&[f64]]) {
    for slice in slices {
        assert_eq!(slice.len(), robot.joint_count(), "one value a joint");
    }
}

#[cfg(test)]
mod tests;
