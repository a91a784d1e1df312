//! What a plan says of itself, against what was found: it may not promise more room than there is.

use takt_motion::path::outcome::{PathLimit, PathLimitUse};

use super::Case;
use super::report::{FaultKind, PathExtreme, PathReport, limit_of, tool_limit_of};
use crate::tolerance;

pub(super) fn check(case: &Case<'_>, report: &mut PathReport) {
    locations(case, report);
    uses(case, report);
    margins(case, report);
    limiting(case, report);
    let (plan, request) = (case.plan, case.request);
    for (index, (told, asked)) in [
        (plan.torque_utilization, request.torque_utilization),
        (plan.speed_scale, request.speed_scale),
    ]
    .into_iter()
    .enumerate()
    {
        if told != asked {
            report.fault(FaultKind::Echo, index, 0.0, told, asked);
        }
    }
}

/// Set-points run through the program forwards, each within the time of its segment and the dwell after it.
fn locations(case: &Case<'_>, report: &mut PathReport) {
    let segments = &case.plan.segments;
    if segments.len() != case.bounds.len() {
        report.fault(
            FaultKind::Lists,
            1,
            0.0,
            segments.len() as f64,
            case.bounds.len() as f64,
        );
        return;
    }
    let slack = tolerance::STOP_TIME;
    let all = case.samples.locations().iter().zip(case.samples.times()).enumerate();
    let mut last = (0, 0.0);
    for (index, (location, time)) in all {
        let inside = (-tolerance::PART..=1.0 + tolerance::PART).contains(&location.fraction);
        let backwards =
            location.segment < last.0 || (location.segment == last.0 && location.fraction < last.1 - tolerance::PART);
        if backwards || !inside {
            report.fault(FaultKind::Location, location.segment, *time, location.fraction, last.1);
        }
        last = (location.segment, location.fraction);
        let begin = segments[location.segment].begin;
        let until = match segments.get(location.segment + 1) {
            // Of several that go nowhere, the time is the last one's.
            Some(next) => next.begin.max(segments[location.segment].end),
            None => case.plan.duration,
        };
        // Before the first motion there may be a dwell.
        let early = *time < begin - slack && location.segment > 0;
        if early || *time > until + slack {
            report.fault(FaultKind::SegmentTimes, location.segment, *time, index as f64, until);
        }
    }
}

/// Every limit that was seen is among the uses, with the limit in force and no more room than was found.
fn uses(case: &Case<'_>, report: &mut PathReport) {
    for (index, told) in case.plan.limit_uses.iter().enumerate() {
        let Some(bounds) = case.bounds.get(told.location.segment) else {
            report.fault(FaultKind::Location, index, told.time, told.location.segment as f64, 0.0);
            continue;
        };
        let limit = match told.joint {
            Some(joint) => bounds.joints.get(joint).and_then(|bounds| limit_of(bounds, told.kind)),
            None => tool_limit_of(bounds, told.kind),
        };
        let near = |limit: f64| (told.limit - limit).abs() <= tolerance::SAME_LIMIT * limit.abs();
        if !limit.is_some_and(near) {
            report.fault(
                FaultKind::Limit,
                index,
                told.time,
                told.limit,
                limit.unwrap_or(f64::INFINITY),
            );
        }
        let of_range = matches!(told.kind, PathLimit::PositionLower | PathLimit::PositionUpper);
        let margin = (told.limit - told.value.abs()) / told.limit;
        if !of_range && (told.margin - margin).abs() > tolerance::SAME_LIMIT {
            report.fault(FaultKind::Margin, index, told.time, told.margin, margin);
        }
    }
    let found: Vec<PathExtreme> = report.extremes.clone();
    for (index, extreme) in found.iter().enumerate() {
        let same = |told: &&PathLimitUse| (told.kind, told.joint) == (extreme.kind, extreme.joint);
        let told = case.plan.limit_uses.iter().filter(same);
        let Some(tightest) = told.map(|told| told.margin).reduce(f64::min) else {
            // What does not move uses nothing of a limit of its rate.
            if extreme.value != 0.0 && case.plan.duration > 0.0 {
                report.fault(FaultKind::Presence, index, extreme.time, extreme.value, extreme.limit);
            }
            continue;
        };
        if tightest > -extreme.excess + tolerance::path_claim(extreme.kind) {
            report.fault(FaultKind::Use, index, extreme.time, tightest, -extreme.excess);
        }
    }
}

/// A joint's torque margin is no larger than what its set-points leave.
fn margins(case: &Case<'_>, report: &mut PathReport) {
    for joint in 0..case.samples.joints().len() {
        let Some(found) = report.at_states(PathLimit::Torque, Some(joint)).copied() else {
            continue;
        };
        let mut told = case.plan.torque_margins.iter().filter(|told| told.joint == joint);
        let (Some(told), None) = (told.next(), told.next()) else {
            report.fault(FaultKind::Presence, joint, 0.0, 0.0, 1.0);
            continue;
        };
        let margin = (told.limit - told.peak_torque.abs()) / told.limit;
        if (told.margin - margin).abs() > tolerance::SAME_LIMIT {
            report.fault(FaultKind::Margin, joint, told.time, told.margin, margin);
        }
        if told.margin > -found.excess + tolerance::path_claim(PathLimit::Torque) {
            report.fault(FaultKind::Use, joint, found.time, told.margin, -found.excess);
        }
    }
}

/// The limiting limits follow each other without gaps, and their times sum up to what is said of each.
fn limiting(case: &Case<'_>, report: &mut PathReport) {
    let duration = case.plan.duration;
    let slack = tolerance::EVEN_TIMES * duration;
    let mut reached = 0.0;
    for (index, stretch) in case.plan.limiting.iter().enumerate() {
        if (stretch.begin - reached).abs() > slack || stretch.end < stretch.begin {
            report.fault(FaultKind::Limiting, index, stretch.begin, stretch.begin, reached);
        }
        reached = stretch.end;
    }
    if (reached - duration).abs() > slack {
        let count = case.plan.limiting.len();
        report.fault(FaultKind::Limiting, count, duration, reached, duration);
    }
    for cost in &case.plan.limit_costs {
        let same = case
            .plan
            .limiting
            .iter()
            .filter(|stretch| (stretch.kind, stretch.joint) == (cost.kind, cost.joint));
        let sum: f64 = same.map(|stretch| stretch.end - stretch.begin).sum();
        if (sum - cost.time).abs() > slack {
            report.fault(FaultKind::Limiting, usize::MAX, 0.0, cost.time, sum);
        }
    }
    let sum: f64 = case.plan.limit_costs.iter().map(|cost| cost.time).sum();
    if (sum - duration).abs() > slack {
        report.fault(FaultKind::Limiting, usize::MAX, 0.0, sum, duration);
    }
}
