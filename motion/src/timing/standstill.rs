//! Can the arm be where the path leads at all: gravity and Coulomb friction, |g + F±|, against every torque limit.

use super::Obstacle;
use super::coefficients::Coefficients;
use super::limits::Limits;
use crate::path::outcome::PathInfeasibleReason;
use crate::tolerance::STATIC_ROOM;

/// The worst joint and place where even the slowest motion breaks a torque limit; `None` where there is no such place.
pub(super) fn obstacle(coefficients: &Coefficients, limits: &Limits) -> Option<Obstacle> {
    let mut worst: Option<(f64, Obstacle)> = None;
    for joint in 0..coefficients.joint_count {
        for (sample, stretch) in coefficients.stretch.iter().enumerate() {
            let Some(limit) = limits.stretches[*stretch].joints[joint].torque else {
                continue;
            };
            let entry = joint * coefficients.stride + sample;
            let gravity = coefficients.terms.gravity[entry];
            let (up, down) = (
                gravity + coefficients.coulomb_high[entry],
                gravity + coefficients.coulomb_low[entry],
            );
            let needed = if up >= -down { up } else { down };
            let ratio = needed.abs() / limit;
            if ratio < 1.0 - STATIC_ROOM || worst.as_ref().is_some_and(|(known, _)| *known >= ratio) {
                continue;
            }
            let at_end = sample == 0 || sample + 1 == coefficients.places.len();
            let held = gravity.abs() > limit && at_end;
            worst = Some((
                ratio,
                Obstacle {
                    reason: if held {
                        PathInfeasibleReason::HoldingTorque
                    } else {
                        PathInfeasibleReason::MovingTorque
                    },
                    s: coefficients.places[sample].s,
                    joint: Some(joint),
                    // what only the planner's reserve forbids needs a limit with room for the reserve
                    needed: if held { gravity } else { needed / (1.0 - STATIC_ROOM) },
                    available: limit,
                    gravity_torque: gravity,
                },
            ));
        }
    }
    worst.map(|(_, obstacle)| obstacle)
}
