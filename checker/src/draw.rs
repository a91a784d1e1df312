//! Random numbers, poses and arms for tests and measurements: SplitMix64 (Steele, Lea and Flood, OOPSLA 2014). Same
//! seed, same numbers, on every machine.

use std::f64::consts::{PI, TAU};

use nalgebra::{Isometry3, Matrix3, Rotation3, Translation3, UnitQuaternion, Vector3};
use takt_motion::robot::spec::{Drive, Friction, Inertial, JointKind, JointSpec, Limits, RobotSpec};

/// A stream of random numbers.
#[derive(Debug, Clone)]
pub struct Draw {
    state: u64,
}

impl Draw {
    /// The stream that belongs to `seed`.
    #[must_use]
    pub fn seeded(seed: u64) -> Self {
        Self { state: seed }
    }

    /// The next 64 bits.
    pub fn bits(&mut self) -> u64 {
        self.state = self.state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut mixed = self.state;
        mixed = (mixed ^ (mixed >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        mixed ^ (mixed >> 31)
    }

    /// A number in `[low, high)`, from 53 random bits.
    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        let unit = (self.bits() >> 11) as f64 / (1u64 << 53) as f64;
        low + (high - low) * unit
    }
}

/// A vector with each entry within `reach` either way.
pub fn vector(draw: &mut Draw, reach: f64) -> Vector3<f64> {
    Vector3::from_fn(|_, _| draw.between(-reach, reach))
}

/// One value a joint, each within `reach` either way.
pub fn values(draw: &mut Draw, count: usize, reach: f64) -> Vec<f64> {
    (0..count).map(|_| draw.between(-reach, reach)).collect()
}

/// A pose within the position limits; where there are none, within one turn (or 2π m) either way.
pub fn pose_within(draw: &mut Draw, spec: &RobotSpec) -> Vec<f64> {
    spec.joints
        .iter()
        .map(|joint| {
            let low = joint.limits.position_lower.unwrap_or(-TAU);
            let high = joint.limits.position_upper.unwrap_or(TAU);
            draw.between(low, high)
        })
        .collect()
}

/// A possible rigid body: its principal moments obey the triangle inequality, its axes are any.
pub fn body(draw: &mut Draw) -> Inertial {
    let axes = rotation(draw);
    let spread = Vector3::from_fn(|_, _| draw.between(0.01, 0.2));
    let principal = Vector3::new(spread.y + spread.z, spread.z + spread.x, spread.x + spread.y);
    Inertial {
        mass: draw.between(0.5, 5.0),
        center_of_mass: vector(draw, 0.3),
        inertia: axes * Matrix3::from_diagonal(&principal) * axes.transpose(),
    }
}

/// An arm of `count` joints, two in three turning, with axes, bodies, drives, payload and gravity of any direction; no
/// limits.
pub fn arm(draw: &mut Draw, count: usize) -> RobotSpec {
    let joints = (0..count)
        .map(|index| JointSpec {
            name: format!("joint_{index}"),
            kind: match draw.bits().is_multiple_of(3) {
                true => JointKind::Prismatic,
                false => JointKind::Revolute,
            },
            parent_from_joint: placement(draw),
            axis: vector(draw, 1.0).normalize(),
            link: body(draw),
            limits: Limits::default(),
            drive: Drive {
                gear_ratio: draw.between(-120.0, 120.0),
                rotor_inertia: draw.between(0.0, 3e-4),
                motor_friction: friction(draw, 1e-3, 1e-6),
                joint_friction: friction(draw, 5.0, 1.0),
                ..Drive::default()
            },
        })
        .collect();
    RobotSpec {
        joints,
        link_from_tip: placement(draw),
        gravity: vector(draw, 9.81),
        payload: body(draw),
        tcp: Isometry3::identity(),
        frames: Vec::new(),
        uncertainty: None,
    }
}

/// The same arm with drives that rub in proportion to their load, up to 12 %, and to the speed squared, up to 6 % of the
/// peak torque at full speed, stated on either side of the gear. Of every second joint whose friction has a viscous part that part
/// grows less and less instead, down to hardly at full speed.
#[must_use]
pub fn with_rich_friction(draw: &mut Draw, mut spec: RobotSpec) -> RobotSpec {
    for (index, joint) in spec.joints.iter_mut().enumerate() {
        let drive = &mut joint.drive;
        let speed = joint.limits.velocity.unwrap_or(1.0);
        let most = 0.03 * drive.peak_torque.unwrap_or(1.0) / (speed * speed);
        let ratio = drive.gear_ratio.abs();
        for (side, ratio) in [(&mut drive.motor_friction, ratio), (&mut drive.joint_friction, 1.0)] {
            side.load_coulomb = draw.between(0.0, 0.06);
            let part = draw.between(0.0, 1.0);
            side.quadratic = part * most / ratio.powi(3);
            if index % 2 == 0 && side.viscous > 0.0 {
                side.quadratic = -part * side.viscous / (2.0 * ratio * speed);
            }
        }
    }
    spec
}

fn rotation(draw: &mut Draw) -> Rotation3<f64> {
    Rotation3::from_scaled_axis(vector(draw, PI))
}

fn placement(draw: &mut Draw) -> Isometry3<f64> {
    Isometry3::from_parts(
        Translation3::from(vector(draw, 0.5)),
        UnitQuaternion::from_rotation_matrix(&rotation(draw)),
    )
}

fn friction(draw: &mut Draw, size: f64, quadratic: f64) -> Friction {
    Friction {
        viscous: draw.between(0.0, size),
        coulomb_positive: draw.between(0.0, size),
        coulomb_negative: draw.between(0.0, size),
        load_coulomb: draw.between(0.0, 0.1),
        quadratic: draw.between(0.0, quadratic),
        presliding_stiffness: None,
    }
}
