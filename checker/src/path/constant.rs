//! A constant tool speed: what the plan says of it, against the tool speeds at the set-points.
//!
//! A program is run in chains from rest to rest. From the end of a chain's first transition to the beginning of its last,
//! the tool has one speed outside of transitions, and within them none below what each says of itself. What the plan says
//! of all its chains is the slowest of their speeds, and the lowest of all between their ends.

use takt_motion::path::outcome::TransitionReport;
use takt_motion::path::request::Timing;

use super::Case;
use super::report::{FaultKind, PathReport};
use crate::tolerance;

pub(super) fn check(case: &Case<'_>, report: &mut PathReport) {
    let asked = case.request.timing == Timing::ConstantSpeed;
    let Some(told) = &case.plan.constant_speed else {
        if asked {
            report.fault(FaultKind::ConstantSpeed, 0, 0.0, 0.0, 1.0);
        }
        return;
    };
    let given = case.request.segments.iter().filter_map(|segment| segment.tool_speed);
    let slowest = given.fold(f64::INFINITY, f64::min) * case.request.speed_scale;
    if !asked || below(told.asked, slowest) || below(told.asked, told.speed) {
        report.fault(FaultKind::ConstantSpeed, 1, 0.0, told.asked, slowest);
    }
    let mut speeds = Vec::new();
    for chain in told.transitions.chunk_by(|_, next| next.segment.is_some()) {
        let speed = chain_speed(case, chain, told.lowest, report);
        speeds.push(speed.unwrap_or(f64::INFINITY));
    }
    let slowest = speeds.iter().copied().fold(f64::INFINITY, f64::min);
    // a chain without a set-point outside of its transitions may be the slowest
    let shown = speeds.iter().all(|speed| speed.is_finite());
    if below(slowest, told.speed) || (shown && below(told.speed, slowest)) {
        report.fault(FaultKind::ConstantSpeed, 2, 0.0, told.speed, slowest);
    }
}

fn below(speed: f64, least: f64) -> bool {
    speed < least * (1.0 - tolerance::CONSTANT_SPEED)
}

/// The speed of one chain outside of its transitions; `None` where no set-point shows it.
fn chain_speed(case: &Case<'_>, chain: &[TransitionReport], lowest: f64, report: &mut PathReport) -> Option<f64> {
    let [first, .., last] = chain else {
        report.fault(FaultKind::ConstantSpeed, 3, 0.0, chain.len() as f64, 2.0);
        return None;
    };
    let mut speed: Option<f64> = None;
    for (time, found) in case.samples.times().iter().zip(case.samples.tool_speed()) {
        if *time < first.end_time || *time > last.begin_time {
            continue;
        }
        let within = |transition: &&TransitionReport| (transition.begin_time..=transition.end_time).contains(time);
        let transition = chain.iter().find(within);
        let least = transition.map_or_else(|| *speed.get_or_insert(*found), |transition| transition.lowest_speed);
        let slack = tolerance::CONSTANT_SPEED * least;
        let off = match transition {
            Some(_) => least - found,
            None => (found - least).abs(),
        };
        if off > slack {
            report.fault(FaultKind::ConstantSpeed, 4, *time, *found, least);
        }
        if below(*found, lowest) {
            report.fault(FaultKind::ConstantSpeed, 5, *time, *found, lowest);
        }
    }
    speed
}
