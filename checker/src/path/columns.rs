//! Velocities against positions, accelerations against velocities.
//!
//! Between two set-points, h apart, with q̈ between two bounds `a₋ ≤ q̈ ≤ a₊`, the velocity runs within a parallelogram,
//! and so
//!
//! ```text
//! |Δq/h − (q̇₀ + q̇₁)/2| ≤ h (a₊ − a₋)/8            a₋ ≤ Δq̇/h ≤ a₊
//! ```
//!
//! Where set-points are dense enough to resolve whatever the path does, the bounds are taken from the accelerations at
//! the four set-points around, as far beyond their least and largest as those are apart, or as the joint's jerk limit
//! lets them get in a step: an acceleration that jumps does so from one of its values to the other, and one that bends
//! has no room in a step to bend further. So what the step leaves open shrinks with it, and with the jumps, down to what
//! a timing without jerk limits may do in a part of a step, where two of its nodes are close. At a drive's
//! period the acceleration may do anything between two set-points that it does anywhere on the path, and as much again;
//! before a stop, anything that its limit lets it, and in the step that ends there anything if it has none: the set-point
//! there has the acceleration just after.

use super::report::{FaultKind, PathReport};
use super::{Case, Density};
use crate::tolerance;

pub(super) fn check(case: &Case<'_>, report: &mut PathReport) {
    let step = case.samples.step();
    let times = case.samples.times();
    for (joint, columns) in case.samples.joints().iter().enumerate() {
        let (q, qd, qdd) = (&columns.position, &columns.velocity, &columns.acceleration);
        let place = tolerance::POSITION_ROUNDING * largest(q).max(1.0);
        let speed = tolerance::RATE_ROUNDING * largest(qd);
        let everywhere = [lowest(qdd), highest(qdd)];
        let mut jerks = case.bounds.iter().map(|bounds| bounds.joints[joint].jerk);
        let bend = match jerks.try_fold(0.0, |most: f64, jerk| Some(most.max(jerk?))) {
            Some(jerk) => step * jerk,
            None => tolerance::BLIP * (everywhere[1] - everywhere[0]),
        };
        let limits: Vec<Option<f64>> = case
            .bounds
            .iter()
            .map(|bounds| bounds.joints[joint].acceleration)
            .collect();
        let most = limits.iter().flatten().copied().fold(0.0, f64::max);
        let unlimited = limits.contains(&None);
        for next in 1..times.len() {
            let bounds = match case.density {
                Density::Coarse => {
                    let apart = everywhere[1] - everywhere[0];
                    let most = match (stops(case, next - 1), stops(case, next)) {
                        (_, false) => 0.0,
                        (false, true) if unlimited => f64::INFINITY,
                        _ => most,
                    };
                    [(everywhere[0] - apart).min(-most), (everywhere[1] + apart).max(most)]
                }
                Density::Resolving => {
                    let around = &qdd[next.saturating_sub(2)..(next + 2).min(qdd.len())];
                    let apart = (highest(around) - lowest(around)).max(bend);
                    [lowest(around) - apart, highest(around) + apart]
                }
            };
            let time = 0.5 * (times[next - 1] + times[next]);

            let mean = (q[next] - q[next - 1]) / step;
            let told = 0.5 * (qd[next - 1] + qd[next]);
            let allowed = step * (bounds[1] - bounds[0]) / 8.0 + 2.0 * place / step + speed;
            if (mean - told).abs() > allowed {
                report.fault(FaultKind::VelocityColumn, joint, time, told, mean);
            }

            let mean = (qd[next] - qd[next - 1]) / step;
            let rounding = 2.0 * speed / step;
            if mean < bounds[0] - rounding || mean > bounds[1] + rounding {
                let told = 0.5 * (qdd[next - 1] + qdd[next]);
                report.fault(FaultKind::AccelerationColumn, joint, time, told, mean);
            }
        }
    }
}

/// Whether the arm stands at a set-point.
fn stops(case: &Case<'_>, index: usize) -> bool {
    let mut joints = case.samples.joints().iter();
    joints.all(|joint| joint.velocity[index] == 0.0)
}

fn lowest(values: &[f64]) -> f64 {
    values.iter().copied().fold(f64::INFINITY, f64::min)
}

fn highest(values: &[f64]) -> f64 {
    values.iter().copied().fold(f64::NEG_INFINITY, f64::max)
}

fn largest(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |most, value| most.max(value.abs()))
}
