//! The recheck of timed paths finds what is wrong, and nothing where nothing is: a lift on a lift, whose motion and
//! torques are written here by hand.

#[path = "path_recheck/lifts.rs"]
mod lifts;

use lifts::{LOWER, Lifts, UPPER};
use takt_checker::Density;
use takt_checker::path::bounds;
use takt_checker::path::report::{FaultKind, PathReport, Source};
use takt_motion::path::outcome::{PathLimit, PathPlan};
use takt_motion::path::request::{PathRequest, Shape, Target};
use takt_motion::plan::request::{LimitOverride, Sampling};

/// What is found after some change of the plan.
fn changed(change: impl FnOnce(&mut PathPlan)) -> PathReport {
    let lifts = Lifts::new();
    let mut plan = lifts.plan();
    change(&mut plan);
    lifts.recheck(&plan)
}

/// What is found after some change of what was asked for.
fn asked_otherwise(change: impl FnOnce(&mut PathRequest)) -> PathReport {
    let mut lifts = Lifts::new();
    let plan = lifts.plan();
    change(&mut lifts.request);
    lifts.recheck(&plan)
}

fn check_fault(kind: FaultKind, change: impl FnOnce(&mut PathPlan)) {
    let report = changed(change);
    assert!(
        report.faults.iter().any(|fault| fault.kind == kind),
        "{kind:?} not among {:?}",
        report.faults
    );
    assert!(!report.holds());
}

/// The broken limits, each with where it was seen.
fn broken(report: &PathReport) -> Vec<(PathLimit, Option<usize>, Source)> {
    let all = report.violations().map(|found| (found.kind, found.joint, found.source));
    all.collect()
}

#[test]
fn sound_plan_holds() {
    for sampling in [Sampling::Period(0.001), Sampling::Trace(4001), Sampling::Trace(40_001)] {
        let lifts = Lifts::sampled(sampling);
        let report = lifts.recheck(&lifts.plan());
        assert_eq!(report.faults, []);
        assert_eq!(broken(&report), []);
        assert!(report.holds());
    }
}

#[test]
fn extremes_are_those_of_the_closed_form() {
    let report = changed(|_| ());
    let near = |kind, joint, expected: f64| {
        for found in report
            .extremes
            .iter()
            .filter(|found| (found.kind, found.joint) == (kind, joint))
        {
            let off = (found.value.abs() - expected).abs() / expected;
            // A third difference is a mean over some milliseconds.
            let allowed = if kind == PathLimit::Jerk { 1e-2 } else { 1e-5 };
            assert!(off < allowed, "{found:?}, expected {expected}");
        }
        assert!(
            report
                .extremes
                .iter()
                .any(|found| (found.kind, found.joint) == (kind, joint))
        );
    };
    // x³(10 − 15x + 6x²): 15/8, 10/√3 and 60 are the largest of its derivatives.
    near(PathLimit::Velocity, Some(LOWER), 1.875 / 2.0);
    near(PathLimit::Acceleration, Some(LOWER), 10.0 / f64::sqrt(3.0) / 4.0);
    near(PathLimit::Jerk, Some(LOWER), 60.0 / 8.0);
    near(PathLimit::ToolVelocity, None, 1.5 * 1.875 / 2.0);
    near(PathLimit::ToolAcceleration, None, 1.5 * 10.0 / f64::sqrt(3.0) / 4.0);
    let torque = report
        .at_states(PathLimit::Torque, Some(UPPER))
        .expect("it has a limit");
    assert!(
        (torque.value - 2.0 * (10.0 + 1.5 * 10.0 / f64::sqrt(3.0) / 4.0)).abs() < 1e-3,
        "{torque:?}"
    );
}

#[test]
fn every_limit_is_found_broken_by_a_thousandth() {
    // Each limit a tenth of a per cent below what the motion needs; jerk, whose bar that is, by a hundredth.
    let lower = 10.0 / f64::sqrt(3.0) / 4.0;
    let joint = |change: fn(&mut LimitOverride, f64), limit: f64| {
        broken(&asked_otherwise(|request| {
            let mut own = LimitOverride {
                joint: "lower".to_owned(),
                ..LimitOverride::default()
            };
            change(&mut own, limit);
            request.limits.push(own);
        }))
    };
    let both = |kind| {
        [
            (kind, Some(LOWER), Source::States),
            (kind, Some(LOWER), Source::Differences),
        ]
    };
    let found = joint(|own, limit| own.velocity = Some(limit), 0.999 * 1.875 / 2.0);
    assert_eq!(found, both(PathLimit::Velocity));
    let found = joint(|own, limit| own.acceleration = Some(limit), 0.999 * lower);
    assert_eq!(found, both(PathLimit::Acceleration));
    let found = joint(|own, limit| own.deceleration = Some(limit), 0.999 * lower);
    assert_eq!(found, both(PathLimit::Acceleration));
    let found = joint(|own, limit| own.jerk = Some(limit), 0.99 * 7.5);
    assert_eq!(found, [(PathLimit::Jerk, Some(LOWER), Source::Differences)]);
    let found = joint(|own, limit| own.position_upper = Some(limit), 1.25 * 0.999);
    assert_eq!(found, [(PathLimit::PositionUpper, Some(LOWER), Source::States)]);
    let found = joint(|own, limit| own.position_lower = Some(limit), 0.251);
    assert_eq!(found, [(PathLimit::PositionLower, Some(LOWER), Source::States)]);
    let peak = Lifts::new().largest_torque(LOWER);
    let found = joint(|own, limit| own.peak_torque = Some(limit), 0.999 * peak);
    assert_eq!(found, [(PathLimit::Torque, Some(LOWER), Source::States)]);

    let tool = |kind| [(kind, None, Source::States), (kind, None, Source::Differences)];
    let report = asked_otherwise(|request| request.tool_limits.velocity = Some(0.999 * 1.5 * 1.875 / 2.0));
    assert_eq!(broken(&report), tool(PathLimit::ToolVelocity));
    let report = asked_otherwise(|request| request.tool_limits.acceleration = Some(0.999 * 1.5 * lower));
    assert_eq!(broken(&report), tool(PathLimit::ToolAcceleration));
}

#[test]
fn scales_and_segments_put_limits_in_force() {
    let mut lifts = Lifts::new();
    let request = &mut lifts.request;
    request.torque_utilization = 0.5;
    request.speed_scale = 0.5;
    request.acceleration_scale = 0.25;
    request.jerk_scale = 0.125;
    request.segments[1].limits.push(LimitOverride {
        joint: "upper".to_owned(),
        velocity: Some(0.75),
        peak_torque: Some(30.0),
        jerk: Some(6.0),
        ..LimitOverride::default()
    });
    request.limits.push(LimitOverride {
        joint: "lower".to_owned(),
        peak_torque: Some(150.0),
        ..LimitOverride::default()
    });
    request.segments[0].tool_speed = Some(1.0);
    let bounds = bounds::of_program(&lifts.spec, request);
    let [first, second] = [&bounds[0].joints[UPPER], &bounds[1].joints[UPPER]];
    // Half of 40 N m; a segment's 30 N m would be looser.
    assert_eq!((first.torque, second.torque), (Some(20.0), Some(20.0)));
    assert_eq!((first.velocity, second.velocity), (Some(0.5), Some(0.375)));
    assert_eq!((first.jerk, second.jerk), (Some(1.25), Some(0.75)));
    assert_eq!(first.acceleration, Some(1.0));
    // A request's own torque is not multiplied.
    assert_eq!(bounds[0].joints[LOWER].torque, Some(150.0));
    assert_eq!(
        (bounds[0].tool_velocity, bounds[1].tool_velocity),
        (Some(0.5), Some(0.75))
    );
    assert_eq!(bounds[0].tool_acceleration, Some(2.5 * 0.25));
    request.limit_jerk = false;
    assert_eq!(bounds::of_program(&lifts.spec, request)[0].joints[UPPER].jerk, None);
}

#[test]
fn a_segments_own_limit_binds_on_that_segment_alone() {
    let on = |segment: usize, limit: f64| {
        broken(&asked_otherwise(|request| {
            request.segments[segment].limits.push(LimitOverride {
                joint: "lower".to_owned(),
                velocity: Some(limit),
                ..LimitOverride::default()
            });
        }))
        .len()
    };
    // 1 m in 2 s there, half of that in 1.75 s back.
    assert_eq!((on(0, 0.9), on(1, 0.9)), (2, 0));
    assert_eq!((on(0, 0.53), on(1, 0.53)), (2, 2));
}

#[test]
fn friction_acts_from_the_first_moment_on() {
    // Setting out upwards from rest takes 120 N and 30 N of friction; holding takes 120 N.
    let mut lifts = Lifts::new();
    lifts.spec.joints[LOWER].drive.joint_friction.coulomb_positive = 400.0;
    let report = lifts.recheck(&lifts.plan());
    let torque = report
        .at_states(PathLimit::Torque, Some(LOWER))
        .expect("it has a limit");
    assert!(torque.value > 520.0, "{torque:?}");
    // Upwards from rest: friction in full, at the very first set-point.
    let mut still = Lifts::new();
    still.spec.joints[LOWER].drive.joint_friction.coulomb_positive = 100.0;
    let mut plan = still.plan();
    for joint in &mut plan.setpoints.as_mut().expect("it has set-points").samples.joints {
        joint.acceleration.fill(0.0);
    }
    let report = still.recheck(&plan);
    let torque = report
        .at_states(PathLimit::Torque, Some(LOWER))
        .expect("it has a limit");
    assert!((torque.value - 220.0).abs() < 6.0, "{torque:?}");
}

#[test]
fn a_first_torque_without_friction_is_found() {
    // Up from rest at 4/3 m/s²: 12 kg and the 2 kg above it, and 5 N of friction from the first moment on.
    let lifts = Lifts::trapezoidal();
    let odd = |torque: f64| {
        let mut plan = lifts.plan();
        lifts::column(&mut plan, LOWER).torque[0] += torque;
        let faults = lifts.recheck(&plan).faults;
        faults
            .iter()
            .any(|fault| (fault.kind, fault.index) == (FaultKind::TorqueColumn, LOWER))
    };
    assert!(!odd(0.0));
    assert!(odd(-5.0));
    assert!(odd(-8.0));
    // Against a jerk limit the first acceleration is none: friction as the arm sets out, or none before; never the other.
    let lifts = Lifts::new();
    let odd = |torque: f64| {
        let mut plan = lifts.plan();
        lifts::column(&mut plan, LOWER).torque[0] += torque;
        !lifts.recheck(&plan).faults.is_empty()
    };
    assert!(!odd(0.0));
    assert!(!odd(-5.0));
    assert!(odd(-8.0));
}

#[test]
fn a_pose_that_cannot_be_held_is_found() {
    // Things fall upwards: going there, friction carries part of the load; while it dwells, it does not.
    let mut lifts = Lifts::new();
    lifts.spec.gravity = -lifts.spec.gravity;
    lifts.spec.joints[LOWER].drive.joint_friction.coulomb_positive = 50.0;
    lifts.spec.joints[LOWER].drive.peak_torque = Some(300.0);
    lifts.request.segments[0].limits.push(LimitOverride {
        joint: "lower".to_owned(),
        peak_torque: Some(119.9),
        ..LimitOverride::default()
    });
    let report = lifts.recheck(&lifts.plan());
    assert_eq!(broken(&report), [(PathLimit::Torque, Some(LOWER), Source::States)]);
    let torque = report
        .at_states(PathLimit::Torque, Some(LOWER))
        .expect("it has a limit");
    assert_eq!(torque.value, -120.0);
}

#[test]
fn a_plan_sped_up_by_one_per_cent_is_found() {
    // Made at its limits, then run faster: times shorter, rates and torques as they then are.
    let mut lifts = Lifts::new();
    lifts.tighten_to_the_motion();
    assert!(
        lifts.recheck(&lifts.plan()).holds(),
        "{:?}",
        lifts.recheck(&lifts.plan())
    );
    lifts.hurry = 1.01;
    let report = lifts.recheck(&lifts.plan());
    let found = broken(&report);
    for kind in [PathLimit::Velocity, PathLimit::Acceleration, PathLimit::Jerk] {
        assert!(
            found.contains(&(kind, Some(LOWER), Source::Differences)),
            "{kind:?}: {found:?}"
        );
    }
    for kind in [PathLimit::ToolVelocity, PathLimit::ToolAcceleration] {
        assert!(found.contains(&(kind, None, Source::States)), "{kind:?}: {found:?}");
        assert!(
            found.contains(&(kind, None, Source::Differences)),
            "{kind:?}: {found:?}"
        );
    }
    assert!(
        found.contains(&(PathLimit::Torque, Some(LOWER), Source::States)),
        "{found:?}"
    );
    // The times alone shortened: the columns are no longer each other's derivatives.
    let mut plan = Lifts::new().plan();
    for time in &mut plan.setpoints.as_mut().expect("it has set-points").samples.time {
        *time /= 1.01;
    }
    let faults = Lifts::new().recheck(&plan).faults;
    assert!(
        faults.iter().any(|fault| fault.kind == FaultKind::VelocityColumn),
        "{faults:?}"
    );
}

#[test]
fn a_set_point_nudged_is_found() {
    // By a thousandth of a millimetre, an encoder's step.
    let report = changed(|plan| lifts::column(plan, LOWER).position[1000] += 1e-6);
    assert!(broken(&report).contains(&(PathLimit::Jerk, Some(LOWER), Source::Differences)));
    assert!(
        report
            .faults
            .iter()
            .any(|fault| fault.kind == FaultKind::VelocityColumn),
        "{:?}",
        report.faults
    );
    check_fault(FaultKind::VelocityColumn, |plan| {
        lifts::column(plan, UPPER).velocity[700] += 1e-4
    });
    check_fault(FaultKind::AccelerationColumn, |plan| {
        lifts::column(plan, UPPER).velocity[700] += 1e-4
    });
    check_fault(FaultKind::AccelerationColumn, |plan| {
        lifts::column(plan, UPPER).acceleration.fill(0.1)
    });
    check_fault(FaultKind::TorqueColumn, |plan| {
        lifts::column(plan, UPPER).torque[1500] += 1e-6
    });
}

#[test]
fn columns_that_are_scaled_are_found() {
    check_fault(FaultKind::VelocityColumn, |plan| {
        lifts::column(plan, LOWER)
            .velocity
            .iter_mut()
            .for_each(|rate| *rate *= 1.0 + 1e-4);
    });
    check_fault(FaultKind::AccelerationColumn, |plan| {
        lifts::column(plan, LOWER)
            .acceleration
            .iter_mut()
            .for_each(|rate| *rate *= 1.01);
    });
}

#[test]
fn lists_and_times_are_found_wrong() {
    check_fault(FaultKind::Lists, |plan| plan.setpoints = None);
    check_fault(FaultKind::Lists, |plan| {
        lifts::column(plan, LOWER).torque.pop();
    });
    check_fault(FaultKind::Finite, |plan| {
        lifts::column(plan, LOWER).torque[7] = f64::NAN
    });
    check_fault(FaultKind::Times, |plan| lifts::setpoints(plan).samples.time[9] += 1e-6);
    check_fault(FaultKind::Times, |plan| plan.duration += 1e-6);
    check_fault(FaultKind::WholeCycles, |plan| plan.duration += 1e-6);
    check_fault(FaultKind::ToolSpeedColumn, |plan| {
        lifts::setpoints(plan).tool_speed[900] *= 1.0 + 1e-6
    });
}

#[test]
fn places_are_found_wrong() {
    check_fault(FaultKind::Start, |plan| lifts::column(plan, UPPER).position[0] += 1e-9);
    check_fault(FaultKind::Target, |plan| {
        let column = &mut lifts::column(plan, UPPER).position;
        let last = column.len() - 1;
        column[last] += 1e-9;
    });
    let elsewhere = asked_otherwise(|request| {
        request.segments[0].shape = Shape::Joint {
            target: Target::Joints(vec![1.25, 1.0 + 1e-9]),
        };
    });
    assert!(elsewhere.faults.iter().any(|fault| fault.kind == FaultKind::Target));
    check_fault(FaultKind::Rest, |plan| {
        lifts::column(plan, LOWER).position[2100] += 1e-9
    });
    check_fault(FaultKind::Rest, |plan| {
        let column = &mut lifts::column(plan, UPPER).velocity;
        let last = column.len() - 1;
        column[last] = 1e-6;
    });
    let longer = asked_otherwise(|request| request.segments[0].dwell = 0.26);
    assert!(longer.faults.iter().any(|fault| fault.kind == FaultKind::Dwell));
    check_fault(FaultKind::Location, |plan| {
        lifts::setpoints(plan).locations[500].fraction = 0.9
    });
    check_fault(FaultKind::Location, |plan| {
        lifts::setpoints(plan).locations[500].segment = 2
    });
    check_fault(FaultKind::SegmentTimes, |plan| plan.segments[1].begin += 0.01);
    let at_speed = asked_otherwise(|request| request.end_speed = Some(0.1));
    assert!(
        at_speed
            .faults
            .iter()
            .any(|fault| fault.kind == FaultKind::BoundarySpeed)
    );
}

#[test]
fn claims_are_found_wrong() {
    check_fault(FaultKind::Presence, |plan| {
        plan.limit_uses.remove(0);
    });
    check_fault(FaultKind::Presence, |plan| {
        plan.torque_margins.remove(0);
    });
    check_fault(FaultKind::Limit, |plan| plan.limit_uses[0].limit *= 1.0 + 1e-6);
    check_fault(FaultKind::Margin, |plan| plan.limit_uses[0].margin += 1e-6);
    check_fault(FaultKind::Margin, |plan| plan.torque_margins[1].margin += 1e-6);
    check_fault(FaultKind::Use, |plan| {
        let told = &mut plan.limit_uses[0];
        told.value *= 0.99;
        told.margin = (told.limit - told.value.abs()) / told.limit;
    });
    check_fault(FaultKind::Use, |plan| {
        let told = &mut plan.torque_margins[0];
        told.peak_torque *= 0.99;
        told.margin = (told.limit - told.peak_torque.abs()) / told.limit;
    });
    check_fault(FaultKind::Limiting, |plan| plan.limiting[1].begin += 1e-6);
    check_fault(FaultKind::Limiting, |plan| plan.limit_costs[0].time += 1e-6);
    check_fault(FaultKind::Limiting, |plan| {
        plan.limiting.pop();
    });
    check_fault(FaultKind::Echo, |plan| plan.speed_scale = 0.5);
}

#[test]
fn jumps_of_acceleration_are_no_faults() {
    // A trapezoid of velocity: accelerations jump, velocities and positions do not.
    let lifts = Lifts::trapezoidal();
    let report = lifts.recheck(&lifts.plan());
    let columns = [FaultKind::VelocityColumn, FaultKind::AccelerationColumn];
    let odd: Vec<_> = report
        .faults
        .iter()
        .filter(|fault| columns.contains(&fault.kind))
        .collect();
    assert!(odd.is_empty(), "{odd:?}");
    // Yet the third difference of one sees them.
    assert!(broken(&report).contains(&(PathLimit::Jerk, Some(LOWER), Source::Differences)));
}

#[test]
fn what_a_joint_does_just_before_a_stop_is_within_its_limit() {
    // Set-points every half second: the one at the stop has the acceleration of the dwell, none.
    let mut lifts = Lifts::trapezoidal();
    lifts.request.sampling = Sampling::Trace(9);
    let mut plan = lifts.plan();
    let column = lifts::column(&mut plan, LOWER);
    assert_eq!(column.velocity[4], 0.0);
    column.velocity[1..4].copy_from_slice(&[1.5, 3.0, 4.0]);
    let odd = |lifts: &Lifts| {
        let faults = lifts.recheck_as(&plan, Density::Coarse).faults;
        let kind = FaultKind::AccelerationColumn;
        let mut found = faults.iter().filter(|fault| (fault.kind, fault.index) == (kind, LOWER));
        found.next().map(|fault| (fault.time, fault.expected))
    };
    // From 4 m/s to rest within the last half second, which 8 m/s² do.
    lifts.spec.joints[LOWER].limits.acceleration = Some(7.9);
    assert_eq!(odd(&lifts), Some((1.75, -8.0)));
    lifts.spec.joints[LOWER].limits.acceleration = Some(8.1);
    assert_eq!(odd(&lifts), None);
}
