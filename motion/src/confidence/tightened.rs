//! Limits of a request, tightened from outside.

use super::hold::Tightening;
use crate::plan::problem::JointLimit;
use crate::plan::request::LimitOverride;
use crate::robot::spec::JointSpec;

/// The overrides of a request with what a tightening takes off. `limits` are those in force under the request's own.
pub(crate) fn overrides(
    asked: &[LimitOverride],
    joints: &[JointSpec],
    limits: &[JointLimit],
    tightening: &Tightening,
) -> Vec<LimitOverride> {
    let mut overrides = asked.to_vec();
    for (joint, (spec, limit)) in joints.iter().zip(limits).enumerate() {
        let aside = tightening.aside[joint];
        let torque = limit.torque.filter(|_| aside > 0.0).map(|torque| torque - aside);
        let velocity = below(tightening.velocity[joint], Some(limit.velocity));
        let acceleration = below(tightening.acceleration[joint], limit.acceleration);
        let deceleration = below(tightening.acceleration[joint], limit.deceleration);
        if torque.is_none() && velocity.is_none() && acceleration.is_none() && deceleration.is_none() {
            continue;
        }
        let known = overrides.iter().position(|change| change.joint == spec.name);
        let index = known.unwrap_or_else(|| {
            overrides.push(LimitOverride {
                joint: spec.name.clone(),
                ..LimitOverride::default()
            });
            overrides.len() - 1
        });
        let change = &mut overrides[index];
        change.peak_torque = torque.or(change.peak_torque);
        change.velocity = velocity.or(change.velocity);
        change.acceleration = acceleration.or(change.acceleration);
        change.deceleration = deceleration.or(change.deceleration);
    }
    overrides
}

/// Torque limits of a segment's own, less what is set aside; `None`, where nothing is left of one.
pub(crate) fn tightened_torque(
    asked: &[LimitOverride],
    joints: &[JointSpec],
    aside: &[f64],
) -> Option<Vec<LimitOverride>> {
    let mut overrides = asked.to_vec();
    for change in &mut overrides {
        let joint = joints.iter().position(|joint| joint.name == change.joint);
        let (Some(peak), Some(joint)) = (change.peak_torque, joint) else {
            continue;
        };
        if aside[joint] >= peak {
            return None;
        }
        change.peak_torque = Some(peak - aside[joint]);
    }
    Some(overrides)
}

/// A limit that is below the one in force.
fn below(wanted: f64, known: Option<f64>) -> Option<f64> {
    (wanted < known.unwrap_or(f64::INFINITY)).then_some(wanted)
}
