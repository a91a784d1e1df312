//! Inverse dynamics of a serial arm, in the base frame.
//!
//! Every body k (a link, or the payload) has its centre `c_k`, angular velocity `ω_k`, angular acceleration `α_k`, and
//! acceleration of the centre `a_k`, all as plain vectors in base axes. Newton and Euler give the force and the moment
//! that it takes to move it so against gravity `g`:
//!
//! ```text
//! f_k = m_k (a_k − g)
//! n_k = I_k α_k + ω_k × I_k ω_k            (I_k about the centre, in base axes)
//! ```
//!
//! and joint i, whose axis `z_i` passes through `p_i`, carries all bodies beyond it:
//!
//! ```text
//! turning:  τ_i = z_i · Σ_{k ≥ i} [(c_k − p_i) × f_k + n_k]
//! sliding:  τ_i = z_i · Σ_{k ≥ i} f_k
//! ```
//!
//! The sums run over moments about the base origin, `Σ (c_k × f_k + n_k) − p_i × Σ f_k`: nothing is passed from link
//! frame to link frame. The drive adds, at the joint and for gear ratio ξ (JP4358979B2, eq 52 to 56):
//!
//! ```text
//! rotor:     ξ² I_m q̈
//! friction:  ξ² (viscous, motor side) q̇ + |ξ|³ (quadratic, motor side) q̇ |q̇| + |ξ| (Coulomb, motor side) sgn q̇
//!            + the joint side's, as it stands
//!            + (of the load, both sides) |z_i · weight| sgn q̇
//! ```
//!
//! with the sign, and the choice between a Coulomb torque's two directions, by the joint's own motion. The weight is that of
//! all bodies beyond the joint: its moment about the axis where the joint turns, its force along it where it slides.

mod tool;

use nalgebra::{Matrix3, Vector3};
use takt_motion::robot::spec::{Drive, Friction, Inertial, JointKind, RobotSpec};

pub use tool::{Tool, ToolMotion};

/// An arm with its payload, ready for inverse dynamics.
#[derive(Debug, Clone)]
pub struct Arm {
    joints: Vec<Joint>,
    payload: Option<Body>,
    gravity: Vector3<f64>,
}

/// Room for the motion of every link of one arm.
#[derive(Debug, Clone, Default)]
pub struct Workspace {
    links: Vec<LinkMotion>,
}

#[derive(Debug, Clone)]
struct Joint {
    slides: bool,
    /// Origin of the joint frame at position 0, in the frame of the link before.
    offset: Vector3<f64>,
    /// Axes of the joint frame at position 0, in the frame of the link before.
    axes: Matrix3<f64>,
    /// Unit vector in the joint frame.
    axis: Vector3<f64>,
    link: Body,
    drive: DriveLaw,
}

/// A rigid body in the frame of the link that carries it.
#[derive(Debug, Clone, Copy)]
struct Body {
    mass: f64,
    center: Vector3<f64>,
    inertia: Matrix3<f64>,
}

/// What the drive adds to the rigid-body torque, all at the joint.
#[derive(Debug, Clone, Copy)]
struct DriveLaw {
    rotor_inertia: f64,
    viscous: f64,
    quadratic: f64,
    coulomb_positive: f64,
    coulomb_negative: f64,
    /// Coulomb torque over what holding the weight takes.
    of_load: f64,
}

/// A link's motion in base axes.
#[derive(Debug, Clone, Copy)]
struct LinkMotion {
    axes: Matrix3<f64>,
    /// Of the joint frame, which moves with the link.
    origin: Vector3<f64>,
    /// Of the joint.
    axis: Vector3<f64>,
    angular_velocity: Vector3<f64>,
    angular_acceleration: Vector3<f64>,
    /// Of the origin.
    velocity: Vector3<f64>,
    /// Of the origin.
    acceleration: Vector3<f64>,
}

impl Arm {
    /// The arm of a description, with `payload` in the tip link's frame; `None`: the description's own payload.
    #[must_use]
    pub fn new(spec: &RobotSpec, payload: Option<&Inertial>) -> Self {
        let joints = spec
            .joints
            .iter()
            .map(|joint| Joint {
                slides: joint.kind == JointKind::Prismatic,
                offset: joint.parent_from_joint.translation.vector,
                axes: joint.parent_from_joint.rotation.to_rotation_matrix().into_inner(),
                axis: joint.axis,
                link: Body {
                    mass: joint.link.mass,
                    center: joint.link.center_of_mass,
                    inertia: joint.link.inertia,
                },
                drive: DriveLaw::of(&joint.drive),
            })
            .collect();
        Self {
            joints,
            payload: Body::at_tip(payload.unwrap_or(&spec.payload), spec),
            gravity: spec.gravity,
        }
    }

    /// How many joints move.
    #[must_use]
    pub fn joint_count(&self) -> usize {
        self.joints.len()
    }

    /// Writes the rigid-body torque of every joint, N m or N: links and payload, no rotors, no friction.
    ///
    /// All slices are in model order, one entry a joint.
    pub fn rigid_torque(&self, workspace: &mut Workspace, q: &[f64], qd: &[f64], qdd: &[f64], tau: &mut [f64]) {
        self.move_links(workspace, q, qd, qdd);
        let mut force = Vector3::zeros();
        let mut moment = Vector3::zeros();
        let mut carried = self.payload;
        for ((joint, motion), tau) in self.joints.iter().zip(&workspace.links).zip(tau).rev() {
            for body in [Some(joint.link), carried.take()].into_iter().flatten() {
                let load = body.load(motion, &self.gravity);
                force += load.force;
                moment += load.moment;
            }
            let along = if joint.slides {
                force
            } else {
                moment - motion.origin.cross(&force)
            };
            *tau = motion.axis.dot(&along);
        }
    }

    /// Writes the torque that every drive must give at its joint, N m or N: rigid bodies, rotor, friction.
    ///
    /// `direction` is the direction of motion that Coulomb friction opposes: positive, negative, or 0 at rest. It is
    /// apart from `qd` because a joint that starts or stops has no velocity and yet a direction.
    pub fn drive_torque(
        &self,
        workspace: &mut Workspace,
        q: &[f64],
        qd: &[f64],
        qdd: &[f64],
        direction: &[f64],
        tau: &mut [f64],
    ) {
        self.rigid_torque(workspace, q, qd, qdd, tau);
        for (index, tau) in tau.iter_mut().enumerate() {
            let drive = &self.joints[index].drive;
            let weight = self.weight_on(workspace, index);
            *tau += drive.rotor_inertia * qdd[index] + drive.friction(qd[index], direction[index], weight);
        }
    }

    /// What it takes to hold the weight of everything beyond a joint, where the links were moved to last; 0 where no friction
    /// depends on it.
    fn weight_on(&self, workspace: &Workspace, index: usize) -> f64 {
        let joint = &self.joints[index];
        if joint.drive.of_load == 0.0 {
            return 0.0;
        }
        let own = &workspace.links[index];
        self.bodies(workspace)
            .skip(index)
            .map(|(body, motion)| {
                let force = self.gravity * -body.mass;
                let arm = motion.origin + motion.axes * body.center - own.origin;
                own.axis.dot(&if joint.slides { force } else { arm.cross(&force) })
            })
            .sum()
    }

    /// Writes the torque of every rotor alone, at its joint.
    pub fn rotor_torque(&self, qdd: &[f64], tau: &mut [f64]) {
        for ((joint, qdd), tau) in self.joints.iter().zip(qdd).zip(tau) {
            *tau = joint.drive.rotor_inertia * qdd;
        }
    }

    /// Writes the friction torque of every drive alone, at its joint, with the direction of the velocity itself.
    pub fn friction_torque(&self, workspace: &mut Workspace, q: &[f64], qd: &[f64], tau: &mut [f64]) {
        // Of the links' motion only where they are counts here: any rates will do.
        self.move_links(workspace, q, qd, qd);
        for (index, tau) in tau.iter_mut().enumerate() {
            let weight = self.weight_on(workspace, index);
            *tau = self.joints[index].drive.friction(qd[index], qd[index], weight);
        }
    }

    /// Kinetic energy of links and payload, J: no rotors.
    pub fn kinetic_energy(&self, workspace: &mut Workspace, q: &[f64], qd: &[f64]) -> f64 {
        // Accelerations do not count here: any will do.
        self.move_links(workspace, q, qd, qd);
        self.bodies(workspace)
            .map(|(body, motion)| {
                let spin = motion.axes.tr_mul(&motion.angular_velocity);
                let velocity = motion.velocity + motion.angular_velocity.cross(&(motion.axes * body.center));
                0.5 * (body.mass * velocity.norm_squared() + spin.dot(&(body.inertia * spin)))
            })
            .sum()
    }

    /// Potential energy of links and payload, J: 0 with all mass at the base origin.
    pub fn potential_energy(&self, workspace: &mut Workspace, q: &[f64]) -> f64 {
        // Of the links' motion only where they are counts here: any rates will do.
        self.move_links(workspace, q, q, q);
        self.bodies(workspace)
            .map(|(body, motion)| -body.mass * self.gravity.dot(&(motion.origin + motion.axes * body.center)))
            .sum()
    }

    /// Every body with the motion of the link that carries it.
    fn bodies<'a>(&'a self, workspace: &'a Workspace) -> impl Iterator<Item = (Body, &'a LinkMotion)> {
        let links = self.joints.iter().map(|joint| joint.link);
        let tip = self.payload.into_iter().zip(workspace.links.last());
        links.zip(&workspace.links).chain(tip)
    }

    fn move_links(&self, workspace: &mut Workspace, q: &[f64], qd: &[f64], qdd: &[f64]) {
        debug_assert_eq!(
            [q.len(), qd.len(), qdd.len()],
            [self.joints.len(); 3],
            "one entry a joint"
        );
        workspace.links.clear();
        let mut before = LinkMotion::still();
        for (((joint, q), qd), qdd) in self.joints.iter().zip(q).zip(qd).zip(qdd) {
            before = joint.moved(&before, *q, *qd, *qdd);
            workspace.links.push(before);
        }
    }
}

impl Joint {
    /// The motion of this joint's link, from the motion of the link before.
    fn moved(&self, before: &LinkMotion, q: f64, qd: f64, qdd: f64) -> LinkMotion {
        let base_from_joint = before.axes * self.axes;
        let axis = base_from_joint * self.axis;
        let spin = before.angular_velocity;
        let slide = if self.slides { q } else { 0.0 };
        let arm = before.axes * self.offset + axis * slide;
        let mut moved = LinkMotion {
            axes: base_from_joint,
            origin: before.origin + arm,
            axis,
            angular_velocity: spin,
            angular_acceleration: before.angular_acceleration,
            velocity: before.velocity + spin.cross(&arm),
            acceleration: before.acceleration + before.angular_acceleration.cross(&arm) + spin.cross(&spin.cross(&arm)),
        };
        if self.slides {
            moved.velocity += axis * qd;
            moved.acceleration += axis * qdd + 2.0 * spin.cross(&axis) * qd;
        } else {
            moved.axes = base_from_joint * turn(&self.axis, q);
            moved.angular_velocity += axis * qd;
            moved.angular_acceleration += axis * qdd + spin.cross(&axis) * qd;
        }
        moved
    }
}

/// The rotation by `angle` about the unit vector `axis` (Rodrigues).
fn turn(axis: &Vector3<f64>, angle: f64) -> Matrix3<f64> {
    let (sin, cos) = angle.sin_cos();
    Matrix3::from_diagonal_element(cos) + axis.cross_matrix() * sin + axis * axis.transpose() * (1.0 - cos)
}

struct Load {
    force: Vector3<f64>,
    /// About the base origin.
    moment: Vector3<f64>,
}

impl Body {
    /// A payload given in the tip link's frame, seen from the frame of the last moving link; `None`: there is none.
    fn at_tip(payload: &Inertial, spec: &RobotSpec) -> Option<Self> {
        if payload.mass == 0.0 && payload.inertia == Matrix3::zeros() {
            return None;
        }
        let axes = spec.link_from_tip.rotation.to_rotation_matrix().into_inner();
        Some(Self {
            mass: payload.mass,
            center: spec.link_from_tip.translation.vector + axes * payload.center_of_mass,
            inertia: axes * payload.inertia * axes.transpose(),
        })
    }

    /// What it takes to move the body as its link moves.
    fn load(&self, motion: &LinkMotion, gravity: &Vector3<f64>) -> Load {
        let spin = motion.angular_velocity;
        let turning = motion.angular_acceleration;
        let arm = motion.axes * self.center;
        let acceleration = motion.acceleration + turning.cross(&arm) + spin.cross(&spin.cross(&arm));
        let force = (acceleration - gravity) * self.mass;
        // The inertia in base axes, applied from the left without forming the product of three matrices.
        let inertia_times = |vector: &Vector3<f64>| motion.axes * (self.inertia * motion.axes.tr_mul(vector));
        let moment = inertia_times(&turning) + spin.cross(&inertia_times(&spin));
        Load {
            force,
            moment: (motion.origin + arm).cross(&force) + moment,
        }
    }
}

impl LinkMotion {
    /// The base: it does not move.
    fn still() -> Self {
        Self {
            axes: Matrix3::identity(),
            origin: Vector3::zeros(),
            axis: Vector3::zeros(),
            angular_velocity: Vector3::zeros(),
            angular_acceleration: Vector3::zeros(),
            velocity: Vector3::zeros(),
            acceleration: Vector3::zeros(),
        }
    }
}

impl DriveLaw {
    fn of(drive: &Drive) -> Self {
        let ratio = drive.gear_ratio;
        let sum = |of: fn(&Friction) -> f64, gain: f64| of(&drive.motor_friction) * gain + of(&drive.joint_friction);
        Self {
            rotor_inertia: drive.rotor_inertia * ratio * ratio,
            viscous: sum(|side| side.viscous, ratio * ratio),
            coulomb_positive: sum(|side| side.coulomb_positive, ratio.abs()),
            coulomb_negative: sum(|side| side.coulomb_negative, ratio.abs()),
            quadratic: sum(|side| side.quadratic, ratio.abs().powi(3)),
            of_load: sum(|side| side.load_coulomb, 1.0),
        }
    }

    fn friction(&self, qd: f64, direction: f64, weight: f64) -> f64 {
        let rubbing = self.of_load * weight.abs();
        let dry = if direction > 0.0 {
            self.coulomb_positive + rubbing
        } else if direction < 0.0 {
            -self.coulomb_negative - rubbing
        } else {
            0.0
        };
        (self.viscous + self.quadratic * qd.abs()) * qd + dry
    }
}
