//! Robot descriptions in, registered robots out.

mod findings;
mod fitted;

use std::collections::HashSet;

use takt_motion::{
    nalgebra::{Isometry3, Matrix3, Quaternion, Translation3, UnitQuaternion, Vector3},
    robot::{
        description::{Description, DhConvention, DhLink, DriveEntry, FrictionEntry, JointEntry, Kinematics},
        spec::{Drive, Friction, Inertial, JointKind, Limits, RobotSpec},
    },
};

pub use self::{
    findings::{finding_on_description, finding_on_spec},
    fitted::{kind_from_wire, kind_to_wire, link_inertia_to_wire, uncertainty_to_wire},
};
use super::{Findings, Path, quoted};
use crate::v1;

/// How far the norm of a quaternion may be from 1: four written digits are enough. It is normalized.
const QUATERNION_NORM_TOLERANCE: f64 = 1e-3;

/// Bounds of a payload and of distances: the same that a description has. Beyond, a unit is mistaken.
const MASS_MAX: f64 = 1e6;
pub(super) const LENGTH_MAX: f64 = 1e5;
const INERTIA_MAX: f64 = 1e9;

const CONVENTIONS: &str = "STANDARD, MODIFIED";
const DH_JOINT_TYPES: &str = "REVOLUTE, PRISMATIC";
const SIDES: &str = "MOTOR, JOINT";

/// The accelerations of the conventional pattern that are in force for a joint.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PresetInForce {
    /// Given or derived.
    pub acceleration: f64,
    /// Given or derived.
    pub deceleration: f64,
    /// Derived from the torque limits.
    pub derived: bool,
}

/// Reads a description.
///
/// # Errors
/// Everything in it that is wrong on the face of it; whether the arm makes sense is for
/// [`Description::resolve`] to say.
pub fn description(wire: &v1::RobotDescription, at: Path<'_>, findings: &mut Findings) -> Option<Description> {
    let kinematics = kinematics(wire, at, findings);
    let joints_at = at.field("joints");
    let joints = wire.joints.iter().enumerate();
    let joints = joints.map(|(index, joint)| joint_entry(joint, joints_at.index(index), findings));
    let joints = joints.collect();
    let gravity = findings.vector(at.field("gravity_m_per_s2"), &wire.gravity_m_per_s2);
    let payload = wire.payload.as_ref();
    let payload = payload.map(|payload| self::payload(payload, at.field("payload"), findings));
    let tcp = wire
        .tool
        .as_ref()
        .map(|tool| self::tool(tool, at.field("tool"), findings));
    let frames = frames(&wire.frames, at.field("frames"), findings);
    let link_inertia = fitted::link_inertia(&wire.link_inertia, at.field("link_inertia"), findings);
    let uncertainty = wire.uncertainty.as_ref();
    let uncertainty = uncertainty.and_then(|wire| fitted::uncertainty(wire, at.field("uncertainty"), findings));
    if let Some(origin) = &wire.origin {
        fitted::check_origin(origin, at.field("origin"), findings);
    }
    Some(Description {
        kinematics: kinematics?,
        joints,
        gravity,
        payload,
        tcp,
        frames,
        use_urdf_dynamics: wire.use_urdf_dynamics.unwrap_or(false),
        link_inertia,
        uncertainty,
    })
}

fn kinematics(wire: &v1::RobotDescription, at: Path<'_>, findings: &mut Findings) -> Option<Kinematics> {
    let Some(table) = &wire.dh else {
        if wire.urdf.is_empty() {
            findings.push(at, "needs `urdf` or `dh`");
            return None;
        }
        let given = |link: &String| (!link.is_empty()).then(|| link.clone());
        return Some(Kinematics::Urdf {
            text: wire.urdf.clone(),
            base_link: given(&wire.base_link),
            tip_link: given(&wire.tip_link),
        });
    };
    if !wire.urdf.is_empty() {
        findings.push(at.field("dh"), "cannot stand beside `urdf`: give one of them");
    }
    for (name, link) in [("base_link", &wire.base_link), ("tip_link", &wire.tip_link)] {
        if !link.is_empty() {
            findings.push(at.field(name), "goes with `urdf`, not with `dh`");
        }
    }
    let at = at.field("dh");
    let convention = findings.enumerated(at.field("convention"), table.convention, CONVENTIONS);
    let links_at = at.field("links");
    if table.links.is_empty() {
        findings.push(links_at, "must have at least one row");
    }
    let links = table.links.iter().enumerate();
    let links = links.map(|(index, link)| dh_link(link, links_at.index(index), findings));
    let links = links.collect();
    Some(Kinematics::Dh {
        convention: match convention? {
            v1::dh_table::Convention::Modified => DhConvention::Modified,
            v1::dh_table::Convention::Standard | v1::dh_table::Convention::Unspecified => DhConvention::Standard,
        },
        links,
    })
}

fn dh_link(wire: &v1::DhLink, at: Path<'_>, findings: &mut Findings) -> DhLink {
    let kind = findings.enumerated(at.field("type"), wire.r#type, DH_JOINT_TYPES);
    if kind == Some(v1::JointType::Continuous) {
        findings.push(at.field("type"), format!("CONTINUOUS is not one of {DH_JOINT_TYPES}"));
    }
    if wire.name.is_empty() {
        findings.push(at.field("name"), "must be given");
    }
    let center = findings.vector(at.field("center_of_mass_m"), &wire.center_of_mass_m);
    DhLink {
        name: wire.name.clone(),
        prismatic: kind == Some(v1::JointType::Prismatic),
        a: findings.finite(at.field("a_m"), wire.a_m),
        alpha: findings.finite(at.field("alpha_rad"), wire.alpha_rad),
        d: findings.finite(at.field("d_m"), wire.d_m),
        theta: findings.finite(at.field("theta_rad"), wire.theta_rad),
        mass: findings.finite(at.field("mass_kg"), wire.mass_kg),
        center_of_mass: center.unwrap_or_else(Vector3::zeros),
        inertia: inertia(&wire.inertia_kg_m2, at.field("inertia_kg_m2"), findings),
    }
}

/// A tensor in the order xx yy zz xy xz yz; empty: zeros.
fn inertia(values: &[f64], at: Path<'_>, findings: &mut Findings) -> Matrix3<f64> {
    let Some([xx, yy, zz, xy, xz, yz]) = findings.array(at, values) else {
        return Matrix3::zeros();
    };
    Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz)
}

fn joint_entry(wire: &v1::JointDescription, at: Path<'_>, findings: &mut Findings) -> JointEntry {
    if wire.name.is_empty() {
        findings.push(at.field("name"), "must be given");
    }
    let limits = wire.limits.as_ref();
    let drive = wire.drive.as_ref();
    JointEntry {
        name: wire.name.clone(),
        limits: limits
            .map(|limits| self::limits(limits, at.field("limits"), findings))
            .unwrap_or_default(),
        drive: drive
            .map(|drive| drive_entry(drive, at.field("drive"), findings))
            .unwrap_or_default(),
    }
}

fn limits(wire: &v1::JointLimits, at: Path<'_>, findings: &mut Findings) -> Limits {
    let mut read = |name, value| findings.finite_option(at.field(name), value);
    Limits {
        position_lower: read("position_lower", wire.position_lower),
        position_upper: read("position_upper", wire.position_upper),
        velocity: read("velocity", wire.velocity),
        acceleration: read("acceleration", wire.acceleration),
        deceleration: read("deceleration", wire.deceleration),
        jerk: read("jerk", wire.jerk),
        preset_acceleration: read("preset_acceleration", wire.preset_acceleration),
        preset_deceleration: read("preset_deceleration", wire.preset_deceleration),
    }
}

fn drive_entry(wire: &v1::Drive, at: Path<'_>, findings: &mut Findings) -> DriveEntry {
    let mut sides = [None, None];
    let list_at = at.field("friction");
    for (index, friction) in wire.friction.iter().enumerate() {
        let at = list_at.index(index);
        let side = findings.enumerated::<v1::friction::Side>(at.field("side"), friction.side, SIDES);
        let Some(side) = side else {
            continue;
        };
        let mut read = |name, value| findings.finite_option(at.field(name), value);
        let entry = FrictionEntry {
            viscous: read("viscous", friction.viscous),
            coulomb_positive: read("coulomb_positive", friction.coulomb_positive),
            coulomb_negative: read("coulomb_negative", friction.coulomb_negative),
            load_coulomb: read("load_coulomb", friction.load_coulomb),
            quadratic: read("quadratic", friction.quadratic),
            presliding_stiffness: read("presliding_stiffness", friction.presliding_stiffness),
        };
        let slot = &mut sides[usize::from(side == v1::friction::Side::Joint)];
        if slot.replace(entry).is_some() {
            let name = side.as_str_name();
            findings.push(at.field("side"), format!("{name} is there twice"));
        }
    }
    let [motor_friction, joint_friction] = sides;
    let stiffness_at = at.field("stiffness");
    findings.finite_list(stiffness_at, &wire.stiffness);
    let mut read = |name, value| findings.finite_option(at.field(name), value);
    DriveEntry {
        peak_torque: read("peak_torque", wire.peak_torque),
        rated_torque: read("rated_torque", wire.rated_torque),
        gear_ratio: read("gear_ratio", wire.gear_ratio),
        rotor_inertia: read("rotor_inertia_kg_m2", wire.rotor_inertia_kg_m2),
        motor_friction,
        joint_friction,
        torque_constant: read("torque_constant_nm_per_a", wire.torque_constant_nm_per_a),
        stiffness: wire.stiffness.clone(),
        damping: read("damping", wire.damping),
    }
}

fn frames(wire: &[v1::Frame], at: Path<'_>, findings: &mut Findings) -> Vec<(String, Isometry3<f64>)> {
    let mut frames = Vec::with_capacity(wire.len());
    let mut names = HashSet::new();
    for (index, frame) in wire.iter().enumerate() {
        let at = at.index(index);
        if frame.name.is_empty() {
            findings.push(at.field("name"), "must be given");
        } else if !names.insert(frame.name.as_str()) {
            findings.push(at.field("name"), format!("{} is there twice", quoted(&frame.name)));
        }
        let pose = match &frame.pose {
            Some(pose) => self::pose(pose, at.field("pose"), findings),
            None => {
                findings.push(at.field("pose"), "must be given");
                Isometry3::identity()
            }
        };
        frames.push((frame.name.clone(), pose));
    }
    frames
}

/// Reads a payload, in the bounds of a description's.
pub fn payload(wire: &v1::Payload, at: Path<'_>, findings: &mut Findings) -> Inertial {
    let mass_at = at.field("mass_kg");
    let mass = match wire.mass_kg {
        Some(mass) => findings.within(mass_at, mass, 0.0..=MASS_MAX, " kg"),
        None => {
            findings.push(mass_at, "must be given");
            0.0
        }
    };
    let center_at = at.field("center_of_mass_m");
    let center = findings.vector(center_at, &wire.center_of_mass_m);
    findings.at_most(center_at, &wire.center_of_mass_m, LENGTH_MAX);
    let inertia_at = at.field("inertia_kg_m2");
    findings.at_most(inertia_at, &wire.inertia_kg_m2, INERTIA_MAX);
    let inertia = inertia(&wire.inertia_kg_m2, inertia_at, findings);
    if wire.mass_kg == Some(0.0) && inertia != Matrix3::zeros() {
        findings.push(inertia_at, "must be zero where mass_kg is 0");
    }
    Inertial {
        mass,
        center_of_mass: center.unwrap_or_else(Vector3::zeros),
        inertia,
    }
}

/// Reads a tool: its centre point.
pub fn tool(wire: &v1::Tool, at: Path<'_>, findings: &mut Findings) -> Isometry3<f64> {
    match &wire.tcp {
        Some(tcp) => pose(tcp, at.field("tcp"), findings),
        None => Isometry3::identity(),
    }
}

/// Reads a pose.
pub(super) fn pose(wire: &v1::Pose, at: Path<'_>, findings: &mut Findings) -> Isometry3<f64> {
    let position = findings.vector(at.field("position_m"), &wire.position_m);
    findings.at_most(at.field("position_m"), &wire.position_m, LENGTH_MAX);
    let at = at.field("orientation");
    let rotation = match findings.array(at, &wire.orientation) {
        None => UnitQuaternion::identity(),
        Some([x, y, z, w]) => {
            let quaternion = Quaternion::new(w, x, y, z);
            let norm = quaternion.norm();
            if (norm - 1.0).abs() > QUATERNION_NORM_TOLERANCE {
                findings.push(at, format!("has the norm {norm}, a unit quaternion has 1"));
                UnitQuaternion::identity()
            } else {
                UnitQuaternion::from_quaternion(quaternion)
            }
        }
    };
    Isometry3::from_parts(Translation3::from(position.unwrap_or_else(Vector3::zeros)), rotation)
}

/// Writes a pose, with w ≥ 0.
#[must_use]
pub fn pose_to_wire(pose: &Isometry3<f64>) -> v1::Pose {
    let [x, y, z, w]: [f64; 4] = pose.rotation.coords.into();
    let sign = if w < 0.0 { -1.0 } else { 1.0 };
    let position = pose.translation.vector;
    v1::Pose {
        position_m: position.as_slice().to_vec(),
        orientation: vec![sign * x, sign * y, sign * z, sign * w],
    }
}

/// Writes a payload.
#[must_use]
pub fn payload_to_wire(body: &Inertial) -> v1::Payload {
    v1::Payload {
        mass_kg: Some(body.mass),
        center_of_mass_m: body.center_of_mass.as_slice().to_vec(),
        inertia_kg_m2: fitted::tensor_to_wire(&body.inertia),
    }
}

/// Writes a registered robot, with the values in force.
#[must_use]
pub fn robot_to_wire(
    robot_id: &str,
    revision: &str,
    spec: &RobotSpec,
    warnings: &[String],
    preset: impl Fn(usize) -> Option<PresetInForce>,
) -> v1::Robot {
    let joints = spec.joints.iter().enumerate().map(|(index, joint)| {
        let preset = preset(index);
        v1::JointSummary {
            name: joint.name.clone(),
            r#type: joint_type(joint.kind).into(),
            limits: Some(limits_to_wire(&joint.limits, preset)),
            drive: Some(drive_to_wire(&joint.drive)),
            preset_derived: preset.is_some_and(|preset| preset.derived),
        }
    });
    v1::Robot {
        robot_id: robot_id.to_owned(),
        revision: revision.to_owned(),
        joints: joints.collect(),
        warnings: warnings.to_vec(),
    }
}

fn joint_type(kind: JointKind) -> v1::JointType {
    match kind {
        JointKind::Revolute => v1::JointType::Revolute,
        JointKind::Continuous => v1::JointType::Continuous,
        JointKind::Prismatic => v1::JointType::Prismatic,
    }
}

fn limits_to_wire(limits: &Limits, preset: Option<PresetInForce>) -> v1::JointLimits {
    v1::JointLimits {
        position_lower: limits.position_lower,
        position_upper: limits.position_upper,
        velocity: limits.velocity,
        acceleration: limits.acceleration,
        deceleration: limits.deceleration.or(limits.acceleration),
        jerk: limits.jerk,
        preset_acceleration: preset.map(|preset| preset.acceleration),
        preset_deceleration: preset.map(|preset| preset.deceleration),
    }
}

fn drive_to_wire(drive: &Drive) -> v1::Drive {
    let sides = [
        (v1::friction::Side::Motor, &drive.motor_friction),
        (v1::friction::Side::Joint, &drive.joint_friction),
    ];
    let present = sides.into_iter().filter(|(_, friction)| !friction.is_zero());
    v1::Drive {
        peak_torque: drive.peak_torque,
        rated_torque: drive.rated_torque,
        gear_ratio: Some(drive.gear_ratio),
        rotor_inertia_kg_m2: Some(drive.rotor_inertia),
        friction: present
            .map(|(side, friction)| friction_to_wire(side, friction))
            .collect(),
        torque_constant_nm_per_a: drive.torque_constant,
        stiffness: drive.stiffness.clone(),
        damping: drive.damping,
    }
}

/// Writes friction of one side; terms that came late and are not there are not said.
#[must_use]
pub fn friction_to_wire(side: v1::friction::Side, friction: &Friction) -> v1::Friction {
    let given = |value: f64| (value != 0.0).then_some(value);
    v1::Friction {
        side: side.into(),
        viscous: Some(friction.viscous),
        coulomb_positive: Some(friction.coulomb_positive),
        coulomb_negative: Some(friction.coulomb_negative),
        load_coulomb: given(friction.load_coulomb),
        quadratic: given(friction.quadratic),
        presliding_stiffness: friction.presliding_stiffness,
    }
}
