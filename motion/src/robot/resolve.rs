//! A caller's description to a [`RobotSpec`].
//!
//! The chain comes from the URDF or the DH table; what an entry of `joints` states takes the place of what the chain
//! states. Everything is checked, and everything wrong is named: a caller who mends one thing at a time and registers
//! again learns slowly.

mod entries;
mod fitted;
mod merge;

#[cfg(test)]
mod tests;

use nalgebra::{Isometry3, Matrix3, Vector3};

use super::bounds::{GRAVITY, INERTIA, LENGTH, MASS, MAX_FRAMES, ODD_TOTAL_MASS, QUATERNION_ROUNDING};
use super::chain::Chain;
use super::description::{Description, Kinematics};
use super::findings::{Findings, quoted};
use super::spec::{Inertial, JointSpec, RobotSpec, STANDARD_GRAVITY};
use super::{dh, inertial, urdf};
use crate::error::Invalid;

/// An arm as it is computed with, and what was odd about its description.
#[derive(Debug, Clone, PartialEq)]
pub struct Resolved {
    /// The arm.
    pub spec: RobotSpec,
    /// In the order of their discovery, a sentence each.
    pub warnings: Vec<String>,
}

impl Description {
    /// Reads the chain, lays the entries over it, and checks every number.
    ///
    /// # Errors
    ///
    /// All that is wrong. Paths are those of the wire's `RobotDescription`, but for friction, which is at
    /// `joints[i].drive.motor_friction` and `joints[i].drive.joint_friction`.
    pub fn resolve(&self) -> Result<Resolved, Vec<Invalid>> {
        let mut findings = Findings::default();
        let chain = self.chain(&mut findings);
        let mut joints = self.joints(chain.as_ref(), &mut findings);
        fitted::lay_bodies(&self.link_inertia, joints.as_mut(), &mut findings);
        let uncertainty = fitted::uncertainty(self.uncertainty.as_ref(), joints.as_deref(), &mut findings);
        check_gravity(self.gravity.as_ref(), &mut findings);
        check_payload(self.payload.as_ref(), &mut findings);
        if let Some(tcp) = &self.tcp {
            check_pose("tool.tcp", tcp, &mut findings);
        }
        check_frames(&self.frames, &mut findings);
        let spec = chain.zip(joints).map(|(chain, joints)| RobotSpec {
            joints,
            link_from_tip: chain.link_from_tip,
            gravity: self.gravity.unwrap_or(Vector3::new(0.0, 0.0, -STANDARD_GRAVITY)),
            payload: self.payload.unwrap_or(Inertial::zero()),
            tcp: self.tcp.unwrap_or(Isometry3::identity()),
            frames: self.frames.clone(),
            uncertainty,
        });
        let (spec, warnings) = findings.finish(spec)?;
        Ok(Resolved { spec, warnings })
    }

    fn chain(&self, findings: &mut Findings) -> Option<Chain> {
        match &self.kinematics {
            Kinematics::Dh { convention, links } => {
                if self.use_urdf_dynamics {
                    findings.warn("use_urdf_dynamics says nothing to a DH table");
                }
                dh::read(*convention, links, findings)
            }
            Kinematics::Urdf {
                text,
                base_link,
                tip_link,
            } => {
                let options = urdf::Options {
                    base_link: base_link.as_deref(),
                    tip_link: tip_link.as_deref(),
                    use_dynamics: self.use_urdf_dynamics,
                };
                urdf::read_chain(text, &options, findings)
            }
        }
    }

    /// The chain's joints with the entries laid over them; the entries are checked without a chain too.
    fn joints(&self, chain: Option<&Chain>, findings: &mut Findings) -> Option<Vec<JointSpec>> {
        let is_sound = entries::check(&self.joints, findings);
        let chain = chain?;
        let entry_of = entries::by_joint(&self.joints, chain, findings)?;
        if !is_sound {
            return None;
        }
        let mut joints = chain.joints.clone();
        for (joint, index) in joints.iter_mut().zip(entry_of) {
            if let Some(index) = index {
                merge::lay_over(joint, &self.joints[index], index, findings);
            }
        }
        warn_of_gaps(&joints, findings);
        Some(joints)
    }
}

/// What is not known of the joints, and what that means for plans.
fn warn_of_gaps(joints: &[JointSpec], findings: &mut Findings) {
    for joint in joints {
        let name = quoted(&joint.name);
        let drive = &joint.drive;
        let has_torque = drive.peak_torque.is_some();
        let has_acceleration = joint.limits.acceleration.is_some() || joint.limits.preset_acceleration.is_some();
        if !has_torque {
            findings.warn(format!("joint {name}: peak torque unknown, its torque is not checked"));
        }
        if joint.limits.velocity.is_none() {
            findings.warn(format!("joint {name}: speed limit unknown, a request must bring one"));
        }
        if !has_torque && !has_acceleration {
            findings.warn(format!(
                "joint {name}: neither torque nor acceleration limit known, a move is refused unless it brings one"
            ));
        }
        if let (Some(rated), Some(peak)) = (drive.rated_torque, drive.peak_torque)
            && rated > peak
        {
            findings.warn(format!(
                "joint {name}: rated torque {rated:?} is above peak torque {peak:?}"
            ));
        }
        for (what, preset, limit) in [
            (
                "acceleration",
                joint.limits.preset_acceleration,
                joint.limits.acceleration,
            ),
            (
                "deceleration",
                joint.limits.preset_deceleration,
                joint.limits.deceleration.or(joint.limits.acceleration),
            ),
        ] {
            if let (Some(preset), Some(limit)) = (preset, limit)
                && preset > limit
            {
                findings.warn(format!(
                    "joint {name}: preset {what} {preset:?} is above its limit {limit:?}"
                ));
            }
        }
    }
    let mass: f64 = joints.iter().map(|joint| joint.link.mass).sum();
    if mass > ODD_TOTAL_MASS {
        findings.warn(format!(
            "the moving links weigh {mass:.1} kg, more than {ODD_TOTAL_MASS:?} kg: are the masses in kg?"
        ));
    }
}

fn check_gravity(gravity: Option<&Vector3<f64>>, findings: &mut Findings) {
    let Some(gravity) = gravity else {
        return;
    };
    let path = "gravity_m_per_s2";
    let mut is_finite = true;
    for (index, value) in gravity.iter().enumerate() {
        if !value.is_finite() {
            findings.error(format!("{path}[{index}]"), format!("{value} must be a finite number"));
            is_finite = false;
        }
    }
    if is_finite {
        findings.check(path, gravity.norm(), &GRAVITY);
    }
}

/// A payload is the caller's own statement, so one that cannot be is refused where a file's link is only warned of.
fn check_payload(payload: Option<&Inertial>, findings: &mut Findings) {
    let Some(payload) = payload else {
        return;
    };
    findings.check("payload.mass_kg", payload.mass, &MASS);
    findings.check_vector("payload.center_of_mass_m", &payload.center_of_mass, &LENGTH);
    findings.check_tensor("payload.inertia_kg_m2", &payload.inertia, &INERTIA);
    if payload.mass == 0.0 && payload.inertia != Matrix3::zeros() {
        findings.error("payload.inertia_kg_m2", "must be zero where mass_kg is 0");
    }
    // A point mass is what most payloads are given as; no oddity.
    if payload.mass > 0.0
        && payload.inertia != Matrix3::zeros()
        && !findings.has_errors()
        && let Some(oddity) = inertial::oddity("payload", payload)
    {
        findings.warn(oddity);
    }
}

fn check_frames(frames: &[(String, Isometry3<f64>)], findings: &mut Findings) {
    if frames.len() > MAX_FRAMES {
        findings.error(
            "frames",
            format!("{} frames must be at most {MAX_FRAMES}", frames.len()),
        );
        return;
    }
    let mut names = std::collections::HashMap::with_capacity(frames.len());
    for (index, (name, pose)) in frames.iter().enumerate() {
        let path = format!("frames[{index}].name");
        if let Some(first) = names.insert(name.as_str(), index) {
            findings.error(path, format!("{} is the name of frames[{first}] too", quoted(name)));
        } else {
            findings.check_name(path, name);
        }
        check_pose(&format!("frames[{index}].pose"), pose, findings);
    }
}

fn check_pose(path: &str, pose: &Isometry3<f64>, findings: &mut Findings) {
    findings.check_vector(&format!("{path}.position_m"), &pose.translation.vector, &LENGTH);
    let norm = pose.rotation.quaternion().norm();
    if norm.is_nan() || (norm - 1.0).abs() > QUATERNION_ROUNDING {
        findings.error(
            format!("{path}.orientation"),
            format!("a norm of {norm:?} must be 1 within {QUATERNION_ROUNDING:?}"),
        );
    }
}
