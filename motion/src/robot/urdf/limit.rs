//! The `<limit>` of a joint, as far as it says something.
//!
//! - effort or velocity 0, or none, is missing data, not a joint that cannot move;
//! - both of lower and upper missing is an unknown range (the specification's default 0 to 0 would be a fixed joint);
//!   one of them missing is 0, as specified;
//! - values beyond every bound are how files write "no limit";
//! - a continuous joint has no range, whatever is written;
//! - acceleration, deceleration and jerk are URDF 1.2's, read in any version.

use super::element::Element;
use super::model::Kind;
use crate::robot::bounds::{ACCELERATION, Bound, JERK, POSITION, TORQUE, VELOCITY};
use crate::robot::findings::{Findings, quoted};
use crate::robot::spec::Limits;

/// The limits of a joint and its effort. What is odd about them matters only on the chain, so it is handed back.
pub(super) fn read(
    joint: &Element<'_, '_>,
    kind: Kind,
    oddities: &mut Vec<String>,
    findings: &mut Findings,
) -> (Limits, Option<f64>) {
    let mut limits = Limits::default();
    if !kind.has_axis() {
        return (limits, None);
    }
    let name = quoted(joint.owner);
    let Some(limit) = joint.child("limit", findings) else {
        if kind.has_range() {
            oddities.push(format!("joint {name}: no <limit>, its position is taken as unlimited"));
        }
        return (limits, None);
    };
    let lower = limit.number("lower", findings);
    let upper = limit.number("upper", findings);
    if kind.has_range() {
        (limits.position_lower, limits.position_upper) = range(&limit, lower, upper, oddities, findings);
    } else if lower.unwrap_or(0.0) < upper.unwrap_or(0.0) {
        oddities.push(format!(
            "joint {name}: continuous, so its position limits {:?} to {:?} are not used",
            lower.unwrap_or(0.0),
            upper.unwrap_or(0.0)
        ));
    }
    limits.velocity = positive(&limit, "velocity", &VELOCITY, oddities, findings);
    limits.acceleration = positive(&limit, "acceleration", &ACCELERATION, oddities, findings);
    limits.deceleration = positive(&limit, "deceleration", &ACCELERATION, oddities, findings);
    limits.jerk = positive(&limit, "jerk", &JERK, oddities, findings);
    let effort = positive(&limit, "effort", &TORQUE, oddities, findings);
    (limits, effort)
}

fn range(
    limit: &Element<'_, '_>,
    lower: Option<f64>,
    upper: Option<f64>,
    oddities: &mut Vec<String>,
    findings: &mut Findings,
) -> (Option<f64>, Option<f64>) {
    let name = quoted(limit.owner);
    let (Some(lower), Some(upper)) = (lower.or(upper.and(Some(0.0))), upper.or(lower.and(Some(0.0)))) else {
        if limit.text("lower").is_none() && limit.text("upper").is_none() {
            oddities.push(format!(
                "joint {name}: no lower and upper in its <limit>, its position is taken as unlimited"
            ));
        }
        return (None, None);
    };
    if lower > upper {
        limit.error(
            &format!("lower limit {lower:?} must be at most upper limit {upper:?}"),
            findings,
        );
        return (None, None);
    }
    if lower == upper {
        oddities.push(format!(
            "joint {name}: lower = upper = {lower:?}, it has no room to move"
        ));
    }
    let within = |value: f64| POSITION.fault(value).is_none().then_some(value);
    if within(lower).is_none() || within(upper).is_none() {
        oddities.push(format!(
            "joint {name}: a position limit of {lower:?} to {upper:?} is beyond {:?} and taken as none",
            POSITION.max()
        ));
    }
    (within(lower), within(upper))
}

/// A limit that says something: above 0, and not one of the huge values that stand for none.
fn positive(
    limit: &Element<'_, '_>,
    attribute: &str,
    bound: &Bound,
    oddities: &mut Vec<String>,
    findings: &mut Findings,
) -> Option<f64> {
    let value = limit.number(attribute, findings)?;
    if value == 0.0 {
        return None;
    }
    if value > bound.max() {
        oddities.push(format!(
            "joint {}: {attribute} {value:?} is beyond {:?} and taken as no limit",
            quoted(limit.owner),
            bound.max()
        ));
        return None;
    }
    if value < 0.0 {
        limit.error(
            &format!("{attribute} of <limit> is {value:?}, it must not be negative"),
            findings,
        );
        return None;
    }
    limit.bounded(attribute, bound, findings)
}
