//! No number that is not finite leaves the service: JSON has none, and no controller should see one.

use takt_motion::{
    confidence::{Confident, JointConfidence},
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

/// What a confidence adds to an answer.
pub(super) fn confidence<O>(answer: &Confident<O>) -> bool {
    let report = answer.report.as_ref();
    let numbers = |joint: &JointConfidence| {
        [
            joint.limit,
            joint.torque,
            joint.band,
            joint.margin,
            joint.time,
            joint.parameter_deviation,
            joint.residual_deviation,
            joint.set_aside,
        ]
    };
    all(&[answer.band.unwrap_or(0.0)])
        && report.is_none_or(|report| {
            all(&[report.nominal_duration.unwrap_or(0.0)])
                && report.joints.iter().map(numbers).all(|numbers| all(&numbers))
        })
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

pub(super) fn estimate(answer: &v1::EstimateFrictionResponse) -> bool {
    all(&[answer.time_s.unwrap_or(0.0), answer.delay_s])
        && answer.joints.iter().all(|joint| {
            let coefficients = joint.coefficients.iter();
            let numbers = [
                joint.residual_rms,
                joint.residual_deviation,
                joint.residual_tails,
                joint.correlation_time_s.unwrap_or(0.0),
                joint.friction_torque.unwrap_or(0.0),
                joint.degrees_of_freedom.unwrap_or(0.0),
            ];
            all(&numbers)
                && all(&joint.covariance)
                && every(coefficients.map(|one| {
                    let committed = one.committed.unwrap_or(0.0);
                    [
                        one.value,
                        one.standard_error,
                        one.lower,
                        one.upper,
                        one.model,
                        committed,
                    ]
                }))
        })
}

pub(super) fn fit(answer: &v1::MotionFit) -> bool {
    let estimates = answer
        .estimates
        .iter()
        .map(|one| [one.value, one.described, one.standard_error, one.told]);
    let joints = answer.joints.iter().map(|one| {
        [
            one.fitted_error,
            one.validated_error,
            one.correlation_time_s,
            one.pose_share,
            one.presliding_deflection.unwrap_or(0.0),
        ]
    });
    let bins = answer
        .joints
        .iter()
        .flat_map(|one| one.by_position.iter().chain(&one.by_speed));
    let assessed = answer.before.iter().chain(&answer.after).flat_map(|one| &one.joints);
    let assessed = assessed.map(|one| {
        let interval = one.interval.unwrap_or_default();
        let online = one.online.unwrap_or_default();
        [
            one.error,
            one.percentile,
            one.percentile_of_peak.unwrap_or(0.0),
            interval.coverage,
            interval.half_width,
            interval.over_narrowest,
            online.coverage,
            online.half_width,
            online.over_narrowest,
        ]
    });
    all(&[answer.ridge.unwrap_or(0.0), answer.determined])
        && every(estimates)
        && every(joints)
        && every(bins.map(|bin| [bin.from, bin.to, bin.mean, bin.rms]))
        && every(assessed)
}

pub(super) fn bench(outcome: &v1::fit_drive_response::Outcome) -> bool {
    use v1::fit_drive_response::Outcome;
    let side = |one: &v1::SideFit| {
        let own = [
            one.viscous,
            one.coulomb_positive,
            one.coulomb_negative,
            one.residual_torque,
        ];
        all(&own) && all(&one.standard_errors)
    };
    match outcome {
        Outcome::Motion(motion) => fit(motion),
        Outcome::NotExcited(_) => true,
        Outcome::Stiffness(one) => {
            all(&one.stiffness)
                && all(&one.standard_error)
                && all(&[
                    one.offset_torque,
                    one.residual_torque,
                    one.deformation_lower,
                    one.deformation_upper,
                ])
        }
        Outcome::Damping(one) => {
            let own = [one.damping_and_viscous, one.damping, one.coulomb, one.stiffness];
            all(&own) && all(&[one.period_s, one.decrement_of_first_pair]) && all(&one.standard_errors)
        }
        Outcome::ConstantSpeed(one) => {
            let sides = [&one.total, &one.joint_side, &one.motor_side];
            sides.into_iter().flatten().all(side)
        }
    }
}

pub(super) fn rehearsal(outcome: &v1::rehearse_response::Outcome) -> bool {
    use v1::rehearse_response::Outcome;
    match outcome {
        Outcome::Rehearsal(rehearsal) => {
            let gains = rehearsal.joints.iter().map(|joint| {
                let gains = joint.gains.clone().unwrap_or_default();
                [
                    joint.planned_torque,
                    gains.position,
                    gains.velocity,
                    gains.torque,
                    gains.velocity_filter_rad_per_s,
                ]
            });
            all(&[rehearsal.period_s, rehearsal.duration_s])
                && every(gains)
                && rehearsal.plain.iter().chain(&rehearsal.adapted).all(run)
        }
        Outcome::MoveInfeasible(no) => all(&[no.time_s, no.needed, no.available, no.gravity_torque]),
        Outcome::PathInfeasible(no) => all(&[no.needed, no.available, no.gravity_torque]),
        Outcome::TransmissionRange(range) => all(&[range.time_s, range.torque, range.largest_torque]),
    }
}

fn run(run: &v1::RehearsalRun) -> bool {
    let joints = run.joints.iter().map(|one| {
        [
            one.position_error_peak,
            one.position_error_time_s,
            one.position_error_rms,
            one.position_error_end,
            one.torque_peak,
            one.torque_time_s,
            one.torque_rms,
            one.torque_limit.unwrap_or(0.0),
            one.margin.unwrap_or(0.0),
            one.limited_time_s,
            one.current_peak_a.unwrap_or(0.0),
            one.current_rms_a.unwrap_or(0.0),
            one.deformation_peak,
            one.friction_torque_rms,
            one.friction_torque_error_rms,
            one.friction_torque_error_rms_last,
        ]
    });
    let points = run.joints.iter().flat_map(|joint| &joint.friction);
    let columns = run.trace.iter().flat_map(|trace| &trace.joints).flat_map(|joint| {
        [
            &joint.planned_position,
            &joint.position,
            &joint.motor_position,
            &joint.velocity,
            &joint.motor_torque,
            &joint.transmission_torque,
            &joint.assumed_friction_torque,
            &joint.true_friction_torque,
        ]
    });
    let mut own = run
        .trace
        .iter()
        .flat_map(|trace| [&trace.time_s, &trace.tool_error_m])
        .chain(columns);
    let tool = [
        run.end_time_s.unwrap_or(0.0),
        run.tool_error_peak_m,
        run.tool_error_time_s,
        run.tool_error_rms_m,
        run.tool_angle_peak_rad,
        run.work_j,
        run.energy_given_j,
    ];
    all(&tool)
        && every(joints)
        && every(points.map(|point| [point.time_s, point.assumed_torque, point.true_torque]))
        && own.all(|column| all(column))
}

pub(super) fn all(numbers: &[f64]) -> bool {
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
