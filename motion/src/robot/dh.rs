//! Denavit-Hartenberg tables.
//!
//! Standard (J. Denavit, R. S. Hartenberg, 1955): the pose of link i in link i−1 is Rz(θ) Tz(d) Tx(a) Rx(α), and link
//! i's frame stands at its far end. Its joint moves about or along z of frame i−1, which commutes with Rz(θ) Tz(d), so
//! the joint's frame is frame i−1, carried along by the joint, and Rz(θ) Tz(d) Tx(a) Rx(α) is fixed in the link.
//!
//! Modified (J. J. Craig, 1986): Rx(α) Tx(a) Rz(θ) Tz(d), and link i's frame stands on its own joint's axis: it is the
//! joint's frame.
//!
//! A revolute joint's position adds to θ, a prismatic one's to d.

use nalgebra::{Isometry3, Vector3};

use super::bounds::{ANGLE, INERTIA, LENGTH, MASS, MAX_JOINTS};
use super::chain::Chain;
use super::description::{DhConvention, DhLink};
use super::findings::{Findings, quoted};
use super::inertial;
use super::rotation;
use super::spec::{Drive, Inertial, JointKind, JointSpec, Limits};

#[cfg(test)]
mod tests;

/// The chain that a table describes; `None` where something is wrong with it.
pub(crate) fn read(convention: DhConvention, links: &[DhLink], findings: &mut Findings) -> Option<Chain> {
    if links.is_empty() {
        findings.error("dh.links", "must have at least one link");
        return None;
    }
    if links.len() > MAX_JOINTS {
        findings.error(
            "dh.links",
            format!("{} links must be at most {MAX_JOINTS}", links.len()),
        );
        return None;
    }
    check(links, findings);
    if findings.has_errors() {
        return None;
    }
    let mut joints = Vec::with_capacity(links.len());
    let mut link_from_next = Isometry3::identity();
    for link in links {
        let about_z = screw(&Vector3::z(), link.theta, link.d);
        let about_x = screw(&Vector3::x(), link.alpha, link.a);
        let (parent_from_joint, joint_from_link) = match convention {
            DhConvention::Standard => (link_from_next, about_z * about_x),
            DhConvention::Modified => (about_x * about_z, Isometry3::identity()),
        };
        joints.push(joint(link, parent_from_joint, &joint_from_link, findings));
        link_from_next = joint_from_link;
    }
    Some(Chain {
        joints,
        link_from_tip: link_from_next,
    })
}

fn joint(
    link: &DhLink,
    parent_from_joint: Isometry3<f64>,
    joint_from_link: &Isometry3<f64>,
    findings: &mut Findings,
) -> JointSpec {
    let body = Inertial {
        mass: link.mass,
        center_of_mass: link.center_of_mass,
        inertia: link.inertia,
    };
    if let Some(oddity) = inertial::oddity(format_args!("link of joint {}", quoted(&link.name)), &body) {
        findings.warn(oddity);
    } else if body.mass == 0.0 {
        findings.warn(format!(
            "joint {}: the link that it moves has no mass",
            quoted(&link.name)
        ));
    }
    JointSpec {
        name: link.name.clone(),
        kind: if link.prismatic {
            JointKind::Prismatic
        } else {
            JointKind::Revolute
        },
        parent_from_joint,
        axis: Vector3::z(),
        link: body.seen_from(joint_from_link),
        limits: Limits::default(),
        drive: Drive::default(),
    }
}

/// Turns about an axis and slides along it.
fn screw(axis: &Vector3<f64>, angle: f64, distance: f64) -> Isometry3<f64> {
    rotation::pose(axis * distance, rotation::about(axis, angle))
}

fn check(links: &[DhLink], findings: &mut Findings) {
    for (index, link) in links.iter().enumerate() {
        let path = |field: &str| format!("dh.links[{index}].{field}");
        findings.check_name(path("name"), &link.name);
        if let Some(first) = links[..index].iter().position(|other| other.name == link.name) {
            let name = quoted(&link.name);
            findings.error(path("name"), format!("{name} is the name of dh.links[{first}] too"));
        }
        findings.check(path("a_m"), link.a, &LENGTH);
        findings.check(path("alpha_rad"), link.alpha, &ANGLE);
        findings.check(path("d_m"), link.d, &LENGTH);
        findings.check(path("theta_rad"), link.theta, &ANGLE);
        findings.check(path("mass_kg"), link.mass, &MASS);
        findings.check_vector(&path("center_of_mass_m"), &link.center_of_mass, &LENGTH);
        findings.check_tensor(&path("inertia_kg_m2"), &link.inertia, &INERTIA);
    }
}
