//! No number that is not finite leaves the service: JSON has none, and no controller should see one.

use takt_motion::plan::outcome::{
    CheckReport, Infeasible, MoveOutcome, MovePlan, OverrideSafety, Pattern, Setpoints, TorqueMargin,
};

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
