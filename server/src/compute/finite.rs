//! No number that is not finite leaves the service: JSON has none, and no controller should see one.

use takt_motion::{
    path::outcome::{PathInfeasible, PathOutcome, PathPlan, PathSetpoints},
    plan::outcome::{CheckReport, Infeasible, MoveOutcome, MovePlan, OverrideSafety, Pattern, Setpoints, TorqueMargin},
};
use takt_proto::v1;

pub(super) fn outcome(outcome: &MoveOutcome) -> bool {
    match outcome {
        MoveOutcome::Plan(plan) => self::plan(plan),
        MoveOutcome::Infeasible(refusal) => infeasible(refusal),
    }
}

pub(super) fn report(report: &CheckReport) -> bool {
    let uses = report.limit_uses.iter();
    report.duration.is_finite()
        && report.torque_margins.iter().all(margin)
        && uses
            .map(|limit| [limit.value, limit.limit, limit.time, limit.excess])
            .all(|numbers| all(&numbers))
        && report.override_safe.as_ref().is_none_or(safety)
}

pub(super) fn path(outcome: &PathOutcome) -> bool {
    match outcome {
        PathOutcome::Plan(plan) => path_plan(plan),
        PathOutcome::Infeasible(refusal) => path_infeasible(refusal),
    }
}

pub(super) fn inverse(result: &v1::InverseKinematicsResult) -> bool {
    let missing = result.out_of_reach.as_ref();
    let solutions = result.solutions.iter();
    solutions.clone().all(|solution| all(&solution.position))
        && solutions
            .map(|solution| {
                [
                    solution.position_error_m,
                    solution.orientation_error_rad,
                    solution.smallest_singular_value,
                ]
            })
            .all(|numbers| all(&numbers))
        && missing.is_none_or(|one| all(&one.nearest_position) && all(&[one.missing_m, one.missing_rad]))
}

fn all(numbers: &[f64]) -> bool {
    numbers.iter().all(|number| number.is_finite())
}

fn plan(plan: &MovePlan) -> bool {
    let times = [
        plan.duration,
        plan.preset_duration.unwrap_or(0.0),
        plan.raw_excess,
        plan.raw_duration,
        plan.cycle_time,
    ];
    let limiting = plan.limiting.as_ref();
    all(&times)
        && plan.patterns.iter().all(pattern)
        && plan.torque_margins.iter().all(margin)
        && limiting.is_none_or(|limiting| all(&[limiting.time, limiting.utilization]))
        && plan.override_safe.as_ref().is_none_or(safety)
        && plan.setpoints.as_ref().is_none_or(setpoints)
}

fn pattern(pattern: &Pattern) -> bool {
    all(&[
        pattern.displacement,
        pattern.peak_velocity,
        pattern.acceleration,
        pattern.deceleration,
        pattern.acceleration_time,
        pattern.cruise_time,
        pattern.deceleration_time,
    ])
}

fn margin(margin: &TorqueMargin) -> bool {
    all(&[
        margin.limit,
        margin.peak_torque,
        margin.time,
        margin.margin,
        margin.rms_torque,
        margin.peak_motor_speed,
        margin.peak_power,
    ])
}

fn safety(safety: &OverrideSafety) -> bool {
    all(&[safety.worst_override, safety.torque, safety.limit, safety.time])
}

fn setpoints(setpoints: &Setpoints) -> bool {
    let columns = setpoints.joints.iter();
    all(&setpoints.time)
        && columns
            .flat_map(|joint| [&joint.position, &joint.velocity, &joint.acceleration, &joint.torque])
            .all(|column| all(column))
}

fn infeasible(refusal: &Infeasible) -> bool {
    all(&[
        refusal.time,
        refusal.location,
        refusal.needed,
        refusal.available,
        refusal.gravity_torque,
        refusal.feasible_payload.unwrap_or(0.0),
    ])
}

fn path_plan(plan: &PathPlan) -> bool {
    let segments = plan.segments.iter().map(|one| [one.begin, one.end, one.tool_length]);
    let blends = plan.blends.iter().map(|one| {
        [
            one.begin_time,
            one.end_time,
            one.deviation,
            one.corner_distance,
            one.begin.fraction,
            one.end.fraction,
        ]
    });
    let uses = plan
        .limit_uses
        .iter()
        .map(|one| [one.value, one.limit, one.margin, one.time, one.location.fraction]);
    let stretches = plan
        .limiting
        .iter()
        .map(|one| [one.begin, one.end, one.location.fraction]);
    let transitions = plan
        .constant_speed
        .iter()
        .flat_map(|report| &report.transitions)
        .map(|one| {
            [
                one.begin_time,
                one.end_time,
                one.deviation,
                one.velocity_jump,
                one.acceleration_jump,
                one.lowest_speed,
            ]
        });
    let speeds = plan.constant_speed.iter().map(|one| [one.asked, one.speed, one.lowest]);
    plan.duration.is_finite()
        && every(segments)
        && every(blends)
        && plan.torque_margins.iter().all(margin)
        && every(uses)
        && every(stretches)
        && plan.limit_costs.iter().all(|one| one.time.is_finite())
        && every(transitions)
        && every(speeds)
        && plan.override_safe.as_ref().is_none_or(safety)
        && plan.setpoints.as_ref().is_none_or(path_setpoints)
}

fn every<const N: usize>(mut rows: impl Iterator<Item = [f64; N]>) -> bool {
    rows.all(|numbers| all(&numbers))
}

fn path_setpoints(path: &PathSetpoints) -> bool {
    let mut locations = path.locations.iter();
    setpoints(&path.samples) && all(&path.tool_speed) && locations.all(|one| one.fraction.is_finite())
}

fn path_infeasible(refusal: &PathInfeasible) -> bool {
    all(&[
        refusal.location.fraction,
        refusal.needed,
        refusal.available,
        refusal.gravity_torque,
        refusal.reachable_fraction.unwrap_or(0.0),
    ])
}
