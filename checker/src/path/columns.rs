//! Velocities against positions, accelerations against velocities.
//!
//! Between two set-points, h apart, with q̈ between two bounds `a₋ ≤ q̈ ≤ a₊`, the velocity runs within a parallelogram,
//! and so
//!
//! ```text
//! |Δq/h − (q̇₀ + q̇₁)/2| ≤ h (a₊ − a₋)/8            a₋ ≤ Δq̇/h ≤ a₊
//! ```
//!
//! The bounds are taken from the accelerations at the four set-points around, as far beyond their least and largest as
//! those are apart: an acceleration that jumps does so from one of its values to the other, and one that bends has no
//! room in a step to bend further. So what the step leaves open shrinks with it, and with the jumps.

use super::Case;
use super::report::{FaultKind, PathReport};
use crate::tolerance;

pub(super) fn check(case: &Case<'_>, report: &mut PathReport) {
    let step = case.samples.step();
    let times = case.samples.times();
    for (joint, columns) in case.samples.joints().iter().enumerate() {
        let (q, qd, qdd) = (&columns.position, &columns.velocity, &columns.acceleration);
        let place = tolerance::POSITION_ROUNDING * largest(q).max(1.0);
        let speed = tolerance::RATE_ROUNDING * largest(qd);
        for next in 1..times.len() {
            let around = &qdd[next.saturating_sub(2)..(next + 2).min(qdd.len())];
            let lowest = around.iter().copied().fold(f64::INFINITY, f64::min);
            let highest = around.iter().copied().fold(f64::NEG_INFINITY, f64::max);
            let apart = highest - lowest;
            let time = 0.5 * (times[next - 1] + times[next]);

            let mean = (q[next] - q[next - 1]) / step;
            let told = 0.5 * (qd[next - 1] + qd[next]);
            let allowed = step * (3.0 * apart) / 8.0 + 2.0 * place / step + speed;
            if (mean - told).abs() > allowed {
                report.fault(FaultKind::VelocityColumn, joint, time, told, mean);
            }

            let mean = (qd[next] - qd[next - 1]) / step;
            let rounding = 2.0 * speed / step;
            if mean < lowest - apart - rounding || mean > highest + apart + rounding {
                let told = 0.5 * (qdd[next - 1] + qdd[next]);
                report.fault(FaultKind::AccelerationColumn, joint, time, told, mean);
            }
        }
    }
}

fn largest(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |most, value| most.max(value.abs()))
}
