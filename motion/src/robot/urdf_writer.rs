//! A chain as a URDF, so that a model given as a DH table can be shown by anything that reads one.
//!
//! Links are `base`, one a joint with the joint's name, and `tip`, moved out of the way of joints of the same name.
//! Numbers have the fewest digits that read back to the same bits; rotations go through roll, pitch and yaw and come
//! back to rounding. A URDF cannot say: gravity, payload, tool, and most of a drive.

use std::collections::HashSet;
use std::fmt::{self, Write as _};

use nalgebra::{Isometry3, Vector3};

use super::rotation;
use super::spec::{Inertial, JointKind, JointSpec, RobotSpec};

#[cfg(test)]
mod tests;

/// The chain of `spec` as a URDF of a robot called `name`, from link `base` to link `tip`.
#[must_use]
pub fn write(spec: &RobotSpec, name: &str) -> String {
    let mut text = String::new();
    // Writing to a string cannot fail.
    let _ = write_robot(&mut text, spec, name);
    text
}

fn write_robot(out: &mut String, spec: &RobotSpec, name: &str) -> fmt::Result {
    let taken: HashSet<&str> = spec.joints.iter().map(|joint| joint.name.as_str()).collect();
    let base = free_name("base", &taken);
    let tip = free_name("tip", &taken);
    writeln!(out, "<?xml version=\"1.0\" encoding=\"UTF-8\"?>")?;
    writeln!(out, "<robot name=\"{}\">", escaped(name))?;
    writeln!(out, "  <link name=\"{}\"/>", escaped(&base))?;
    let mut parent = base.as_str();
    for joint in &spec.joints {
        write_joint(out, joint, parent)?;
        write_link(out, &joint.name, &joint.link)?;
        parent = &joint.name;
    }
    writeln!(out, "  <joint name=\"{}\" type=\"fixed\">", escaped(&tip))?;
    write_ends(out, &spec.link_from_tip, parent, &tip)?;
    writeln!(out, "  </joint>")?;
    writeln!(out, "  <link name=\"{}\"/>", escaped(&tip))?;
    writeln!(out, "</robot>")
}

fn write_joint(out: &mut String, joint: &JointSpec, parent: &str) -> fmt::Result {
    let kind = match joint.kind {
        // A URDF's revolute joint must state its range; one without turns for ever.
        JointKind::Revolute if is_unlimited(joint) => "continuous",
        JointKind::Revolute => "revolute",
        JointKind::Continuous => "continuous",
        JointKind::Prismatic => "prismatic",
    };
    writeln!(out, "  <joint name=\"{}\" type=\"{kind}\">", escaped(&joint.name))?;
    write_ends(out, &joint.parent_from_joint, parent, &joint.name)?;
    writeln!(out, "    <axis xyz=\"{}\"/>", triple(&joint.axis))?;
    write_limit(out, joint)?;
    write_dynamics(out, joint)?;
    writeln!(out, "  </joint>")
}

fn is_unlimited(joint: &JointSpec) -> bool {
    joint.limits.position_lower.is_none() && joint.limits.position_upper.is_none()
}

fn write_ends(out: &mut String, parent_from_child: &Isometry3<f64>, parent: &str, child: &str) -> fmt::Result {
    write_origin(out, "    ", parent_from_child)?;
    writeln!(out, "    <parent link=\"{}\"/>", escaped(parent))?;
    writeln!(out, "    <child link=\"{}\"/>", escaped(child))
}

fn write_origin(out: &mut String, indent: &str, pose: &Isometry3<f64>) -> fmt::Result {
    let xyz = triple(&pose.translation.vector);
    let rpy = triple(&rotation::to_roll_pitch_yaw(&pose.rotation));
    writeln!(out, "{indent}<origin xyz=\"{xyz}\" rpy=\"{rpy}\"/>")
}

/// What is unknown is left out, but for a range that is open to one side: there URDF's default would be 0.
fn write_limit(out: &mut String, joint: &JointSpec) -> fmt::Result {
    let limits = &joint.limits;
    let (mut lower, mut upper) = (limits.position_lower, limits.position_upper);
    if joint.kind != JointKind::Continuous && !is_unlimited(joint) {
        lower = lower.or(Some(-OPEN));
        upper = upper.or(Some(OPEN));
    }
    write!(out, "    <limit")?;
    for (attribute, value) in [
        ("lower", lower),
        ("upper", upper),
        // Required by the specification; 0 is its spelling of unknown.
        ("effort", Some(joint.drive.peak_torque.unwrap_or(0.0))),
        ("velocity", Some(limits.velocity.unwrap_or(0.0))),
        ("acceleration", limits.acceleration),
        ("deceleration", limits.deceleration),
        ("jerk", limits.jerk),
    ] {
        if let Some(value) = value {
            write!(out, " {attribute}=\"{value:?}\"")?;
        }
    }
    writeln!(out, "/>")
}

/// A position that the reader takes for no limit.
const OPEN: f64 = 1e16;

/// Friction at the joint as far as `<dynamics>` can say it: viscous, and one Coulomb torque, the mean of both ways.
fn write_dynamics(out: &mut String, joint: &JointSpec) -> fmt::Result {
    let friction = &joint.drive.joint_friction;
    if friction.is_zero() {
        return Ok(());
    }
    let coulomb = 0.5 * (friction.coulomb_positive + friction.coulomb_negative);
    writeln!(
        out,
        "    <dynamics damping=\"{:?}\" friction=\"{coulomb:?}\"/>",
        friction.viscous
    )
}

fn write_link(out: &mut String, name: &str, body: &Inertial) -> fmt::Result {
    let center = rotation::pose(body.center_of_mass, nalgebra::UnitQuaternion::identity());
    let m = &body.inertia;
    writeln!(out, "  <link name=\"{}\">", escaped(name))?;
    writeln!(out, "    <inertial>")?;
    write_origin(out, "      ", &center)?;
    writeln!(out, "      <mass value=\"{:?}\"/>", body.mass)?;
    writeln!(
        out,
        "      <inertia ixx=\"{:?}\" ixy=\"{:?}\" ixz=\"{:?}\" iyy=\"{:?}\" iyz=\"{:?}\" izz=\"{:?}\"/>",
        m.m11, m.m12, m.m13, m.m22, m.m23, m.m33
    )?;
    writeln!(out, "    </inertial>")?;
    writeln!(out, "  </link>")
}

/// `wish`, with underscores appended until nothing else has that name.
fn free_name(wish: &str, taken: &HashSet<&str>) -> String {
    let mut name = wish.to_owned();
    while taken.contains(name.as_str()) {
        name.push('_');
    }
    name
}

/// Three numbers, without the sign of a zero.
fn triple(vector: &Vector3<f64>) -> String {
    let [x, y, z] = [vector.x + 0.0, vector.y + 0.0, vector.z + 0.0];
    format!("{x:?} {y:?} {z:?}")
}

/// Text as an XML attribute value. Characters that XML 1.0 cannot hold become U+FFFD.
fn escaped(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => escaped.push_str("&amp;"),
            '<' => escaped.push_str("&lt;"),
            '>' => escaped.push_str("&gt;"),
            '"' => escaped.push_str("&quot;"),
            '\t' => escaped.push_str("&#9;"),
            '\n' => escaped.push_str("&#10;"),
            '\r' => escaped.push_str("&#13;"),
            '\u{0}'..='\u{1f}' | '\u{fffe}' | '\u{ffff}' => escaped.push('\u{fffd}'),
            other => escaped.push(other),
        }
    }
    escaped
}
