use super::outcome::{InfeasibleReason, LimitingKind, Phase};
use super::request::LimitOverride;
use super::*;
use crate::robot::spec::Inertial;
use crate::test_arms::{lift, planar, random_arm, request, robot, values};
use crate::tolerance::PLAN_RESERVE;

fn plan(robot: &Robot, request: &MoveRequest) -> MovePlan {
    match plan_move(robot, request, &Budget::unlimited()).unwrap() {
        MoveOutcome::Plan(plan) => *plan,
        MoveOutcome::Infeasible(infeasible) => panic!("{infeasible:?}"),
    }
}

fn refusal(robot: &Robot, request: &MoveRequest) -> Infeasible {
    match plan_move(robot, request, &Budget::unlimited()).unwrap() {
        MoveOutcome::Plan(plan) => panic!("{plan:?}"),
        MoveOutcome::Infeasible(infeasible) => infeasible,
    }
}

fn findings(robot: &Robot, request: &MoveRequest) -> Vec<String> {
    match plan_move(robot, request, &Budget::unlimited()) {
        Err(Failure::Invalid(wrong)) => wrong.into_iter().map(|invalid| invalid.to_string()).collect(),
        other => panic!("{other:?}"),
    }
}

#[test]
fn a_lift_takes_the_time_that_its_force_allows() {
    // 5 kg against 10 m/s²: 100 N accelerate it upwards with 10 m/s² and brake it with 30 m/s²
    let robot = robot(lift(5.0));
    let done = plan(&robot, &request(&[0.0], &[1.0]));
    let pattern = done.patterns[0];
    assert!(
        (pattern.acceleration / 10.0 - 1.0).abs() < 3.0 * PLAN_RESERVE,
        "{pattern:?}"
    );
    // braking goes to rest at 30 m/s², or cruising shortens it; 2 m/s are reached after 0.2 m
    let closed_form = 0.2 + (1.0 - 0.2 - 2.0 / 30.0) / 2.0 + 2.0 / 30.0;
    assert!(
        (done.duration / closed_form - 1.0).abs() < 3.0 * PLAN_RESERVE,
        "{}",
        done.duration
    );
    assert_eq!(done.limiting.unwrap().kind, LimitingKind::Velocity);
    let margin = done.torque_margins[0];
    assert!(margin.margin > 0.0 && margin.margin < 2.0 * PLAN_RESERVE, "{margin:?}");
    assert_eq!(done.raw_excess, 0.0);
}

#[test]
fn a_short_lift_is_a_triangle() {
    let robot = robot(lift(5.0));
    let done = plan(&robot, &request(&[0.0], &[0.05]));
    // v² = 2·S·a·d/(a + d)
    let peak = (2.0_f64 * 0.05 * 10.0 * 30.0 / 40.0).sqrt();
    let pattern = done.patterns[0];
    assert_eq!(pattern.cruise_time, 0.0);
    assert!(
        (pattern.peak_velocity / peak - 1.0).abs() < 3.0 * PLAN_RESERVE,
        "{pattern:?}"
    );
    assert_eq!(done.limiting.unwrap().kind, LimitingKind::Torque);
}

#[test]
fn a_move_to_where_the_arm_is_takes_no_time_and_holds() {
    let robot = robot(lift(5.0));
    let done = plan(&robot, &request(&[0.4], &[0.4]));
    assert_eq!(done.duration, 0.0);
    assert_eq!(done.limiting, None);
    let margin = done.torque_margins[0];
    assert_eq!(
        (margin.peak_torque, margin.phase, margin.rms_torque),
        (50.0, Phase::Hold, 50.0)
    );
    assert_eq!(margin.margin, 0.5);
}

#[test]
fn every_method_keeps_the_limits_and_the_corrected_one_is_not_slower_than_the_conventional() {
    for seed in 0..20 {
        let robot = robot(random_arm(5, seed));
        let state = &mut (seed + 1000);
        let mut asked = request(&values(5, 2.0, state), &values(5, 2.0, state));
        let corrected = plan(&robot, &asked);
        for method in [Method::Preset, Method::Endpoint] {
            asked.method = method;
            let other = plan(&robot, &asked);
            for margin in &other.torque_margins {
                assert!(margin.margin > 0.0, "seed {seed}: {margin:?}");
            }
            assert!(other.duration >= other.raw_duration * (1.0 - 1e-12));
            assert_eq!(
                other.raw_excess > 0.0,
                other.duration > other.raw_duration * (1.0 + 1e-9)
            );
            assert_eq!(other.preset_duration, corrected.preset_duration);
        }
        assert!(corrected.duration <= corrected.preset_duration.unwrap() * 1.001);
    }
}

#[test]
fn a_corrected_plan_touches_a_limit_and_is_safe_at_every_slower_override() {
    for seed in 0..20 {
        let spec = random_arm(4, seed);
        let robot = robot(spec.clone());
        let state = &mut (seed + 77);
        let asked = request(&values(4, 1.0, state), &values(4, 1.0, state));
        let done = plan(&robot, &asked);
        let limiting = done.limiting.unwrap();
        assert!(
            limiting.utilization > 1.0 - 2.0 * PLAN_RESERVE,
            "seed {seed}: {limiting:?}"
        );
        let problem = Problem::new(&robot, &asked).unwrap();
        for part in [0.95, 0.7, 0.4, 0.1, 0.01] {
            let slower: Vec<Pattern> = done
                .patterns
                .iter()
                .map(|pattern| slow::slowed(pattern, part))
                .collect();
            let found = slow::verify(&problem, &mut Verifier::default(), &slower);
            let excess = verified::excess(&found, &problem.torque_limits());
            assert!(excess <= 0.0, "seed {seed}, override {part}: {excess}");
        }
    }
}

#[test]
fn no_trapezoid_nearby_is_faster() {
    for seed in 0..6 {
        let robot = robot(random_arm(3, seed));
        let state = &mut (seed + 5);
        let asked = request(&values(3, 1.2, state), &values(3, 1.2, state));
        let done = plan(&robot, &asked);
        let problem = Problem::new(&robot, &asked).unwrap();
        let limits = problem.torque_limits();
        let pace = done.patterns.iter().position(Pattern::moves).unwrap();
        let first = done.patterns[pace];
        let law = |factors: [f64; 3]| -> Vec<Pattern> {
            done.patterns
                .iter()
                .map(|pattern| {
                    let part = pattern.displacement / first.displacement;
                    let velocity = first.peak_velocity * factors[0];
                    let (up, down) = (first.acceleration * factors[1], first.deceleration * factors[2]);
                    let cruise = (first.displacement - 0.5 * velocity * velocity * (1.0 / up + 1.0 / down)) / velocity;
                    Pattern {
                        displacement: pattern.displacement,
                        peak_velocity: velocity * part,
                        acceleration: up * part,
                        deceleration: down * part,
                        acceleration_time: velocity / up,
                        cruise_time: cruise,
                        deceleration_time: velocity / down,
                    }
                })
                .collect()
        };
        let steps = [0.9, 0.98, 0.999, 1.0, 1.001, 1.02, 1.1];
        for v in steps {
            for up in steps {
                for down in steps {
                    let other = law([v, up, down]);
                    let shorter = trajectory::duration(&other) < done.duration * (1.0 - 2.0e-4);
                    if other[pace].cruise_time < 0.0 || !shorter {
                        continue;
                    }
                    let too_fast = other
                        .iter()
                        .zip(&problem.limits)
                        .any(|(pattern, limit)| pattern.peak_velocity.abs() > limit.velocity);
                    let found = slow::verify(&problem, &mut Verifier::default(), &other);
                    assert!(
                        too_fast || verified::excess(&found, &limits) > 0.0,
                        "seed {seed}: {v} {up} {down} takes {} instead of {}",
                        trajectory::duration(&other),
                        done.duration
                    );
                }
            }
        }
    }
}

#[test]
fn what_cannot_be_held_is_refused_with_evidence_and_a_payload_that_can() {
    let robot = robot(lift(5.0));
    let mut asked = request(&[0.0], &[1.0]);
    let heavy = |mass| {
        Some(Inertial {
            mass,
            ..Inertial::zero()
        })
    };
    asked.payload = heavy(6.0);
    let no = refusal(&robot, &asked);
    assert_eq!(no.reason, InfeasibleReason::HoldingTorque);
    assert_eq!(
        (no.joint, no.needed, no.available, no.gravity_torque),
        (0, 110.0, 100.0, 110.0)
    );
    let most = no.feasible_payload.unwrap();
    assert!((most - 5.0).abs() < 1e-9, "{most}");
    assert!(no.suggestion.contains("at most 5.0000 kg"), "{}", no.suggestion);
    asked.payload = heavy(most * 0.999);
    plan(&robot, &asked);
}

#[test]
fn what_friction_makes_too_heavy_on_the_way_is_refused() {
    let mut spec = lift(9.0);
    spec.joints[0].drive.joint_friction.coulomb_positive = 15.0;
    let robot = robot(spec);
    let no = refusal(&robot, &request(&[0.0], &[1.0]));
    assert_eq!(no.reason, InfeasibleReason::MovingTorque);
    assert_eq!((no.needed, no.gravity_torque), (105.0, 90.0));
    // downwards there is no such friction
    plan(&robot, &request(&[1.0], &[0.0]));
}

#[test]
fn set_points_end_on_a_whole_period_exactly_at_the_target() {
    let robot = robot(planar());
    let mut asked = request(&[-0.5, 0.3], &[0.9, -1.2]);
    let free = plan(&robot, &asked);
    asked.sampling = Sampling::Period(0.004);
    let done = plan(&robot, &asked);
    let setpoints = done.setpoints.unwrap();
    assert!(done.duration >= free.duration && done.duration < free.duration + 0.004 + 1e-9);
    let last = setpoints.time.len() - 1;
    assert!((setpoints.time[last] - 0.004 * last as f64).abs() < 1e-12);
    assert!((setpoints.time[last] - done.duration).abs() < 1e-9);
    for (joint, columns) in setpoints.joints.iter().enumerate() {
        assert_eq!(columns.position[0], asked.start[joint]);
        assert_eq!(columns.position[last], asked.target[joint]);
        assert_eq!((columns.velocity[last], columns.acceleration[last]), (0.0, 0.0));
        let limit = robot.spec().joints[joint].drive.peak_torque.unwrap();
        assert!(columns.torque.iter().all(|torque| torque.abs() <= limit));
    }
}

#[test]
fn a_trace_has_both_sides_of_every_switching_time() {
    let robot = robot(planar());
    let mut asked = request(&[-0.5, 0.3], &[0.9, -1.2]);
    asked.sampling = Sampling::Trace(50);
    let done = plan(&robot, &asked);
    let trace = done.setpoints.unwrap();
    let up = done.patterns[0].acceleration_time;
    let at: Vec<usize> = (0..trace.time.len())
        .filter(|k| (trace.time[*k] - up).abs() < 1e-12)
        .collect();
    assert_eq!(at.len(), 2);
    let acceleration = &trace.joints[0].acceleration;
    assert!(acceleration[at[0]] > 0.0 && acceleration[at[1]] <= 0.0);
    assert!(trace.time.windows(2).all(|pair| pair[0] <= pair[1]));
}

#[test]
fn utilization_and_speed_scale_bound_what_is_used() {
    let robot = robot(lift(2.0));
    let mut asked = request(&[0.0], &[1.0]);
    asked.torque_utilization = 0.5;
    asked.speed_scale = 0.25;
    let done = plan(&robot, &asked);
    assert_eq!(done.torque_margins[0].limit, 50.0);
    assert!(done.torque_margins[0].margin > 0.0);
    assert!(done.patterns[0].peak_velocity <= 0.5);
    assert!((done.patterns[0].acceleration / 15.0 - 1.0).abs() < 1e-4);
}

#[test]
fn a_start_just_outside_its_range_is_accepted_inwards_only() {
    let robot = robot(lift(2.0));
    let inwards = plan(&robot, &request(&[3.005], &[1.0]));
    assert!(
        inwards
            .warnings
            .iter()
            .any(|warning| warning.contains("above the upper limit 3"))
    );
    let outwards = findings(&robot, &request(&[-3.005], &[-3.0049]));
    assert!(
        outwards.iter().any(|finding| finding.starts_with("target.position[0]")),
        "{outwards:?}"
    );
    let far = findings(&robot, &request(&[3.01], &[1.0]));
    assert!(
        far[0].starts_with("start.position[0]: joint \"lift\": position 3.01"),
        "{far:?}"
    );
}

#[test]
fn overrides_may_tighten_only() {
    let robot = robot(lift(2.0));
    let mut asked = request(&[0.0], &[1.0]);
    let change = |peak_torque, velocity| LimitOverride {
        joint: "lift".to_owned(),
        peak_torque,
        velocity,
        ..LimitOverride::default()
    };
    asked.limits = vec![change(Some(101.0), Some(2.5))];
    let wrong = findings(&robot, &asked);
    assert_eq!(wrong.len(), 2, "{wrong:?}");
    assert!(wrong[0].contains("limits[0].peak_torque") && wrong[0].contains("101") && wrong[0].contains("100"));
    asked.limits = vec![change(Some(30.0), Some(0.5))];
    let done = plan(&robot, &asked);
    assert_eq!(done.torque_margins[0].limit, 30.0);
    assert!(done.patterns[0].peak_velocity <= 0.5);
    asked.limits = vec![change(Some(30.0), None), change(Some(20.0), None)];
    assert!(findings(&robot, &asked)[0].contains("a second time"));
    asked.limits = vec![LimitOverride {
        joint: "lifd".to_owned(),
        ..LimitOverride::default()
    }];
    assert!(findings(&robot, &asked)[0].contains("no joint \"lifd\"; the joints are lift"));
}

#[test]
fn a_jerk_limit_of_a_move_is_checked_and_does_not_apply() {
    let mut spec = lift(2.0);
    spec.joints[0].limits.jerk = Some(100.0);
    let robot = robot(spec);
    let mut asked = request(&[0.0], &[1.0]);
    let change = |jerk| LimitOverride {
        joint: "lift".to_owned(),
        jerk: Some(jerk),
        ..LimitOverride::default()
    };
    let without = plan(&robot, &asked);
    asked.limits = vec![change(50.0)];
    let with = plan(&robot, &asked);
    assert_eq!(with.patterns, without.patterns);
    assert!(
        with.warnings.iter().any(|warning| warning.contains("jerk")),
        "{:?}",
        with.warnings
    );
    asked.limits = vec![change(101.0)];
    assert!(findings(&robot, &asked)[0].contains("limits[0].jerk"));
}

#[test]
fn a_tighter_acceleration_tightens_the_deceleration_that_is_not_given() {
    let deceleration = |own: Option<f64>, asked: LimitOverride| {
        let mut spec = lift(2.0);
        spec.joints[0].limits.acceleration = Some(8.0);
        spec.joints[0].limits.deceleration = own;
        let mut request = request(&[0.0], &[0.5]);
        request.limits = vec![LimitOverride {
            joint: "lift".to_owned(),
            ..asked
        }];
        plan(&robot(spec), &request).patterns[0].deceleration
    };
    let tighter = |acceleration, deceleration| LimitOverride {
        acceleration,
        deceleration,
        ..LimitOverride::default()
    };
    for (own, asked, most) in [
        (None, tighter(None, None), 8.0),
        (None, tighter(Some(3.0), None), 3.0),
        (None, tighter(Some(3.0), Some(6.0)), 6.0),
        (Some(7.0), tighter(Some(3.0), None), 7.0),
        (Some(7.0), tighter(Some(3.0), Some(2.0)), 2.0),
    ] {
        let found = deceleration(own, asked.clone());
        assert!((found / most - 1.0).abs() < 1e-6, "{own:?} {asked:?}: {found}");
    }
}

#[test]
fn every_wrong_number_is_named_at_once() {
    let robot = robot(planar());
    let mut asked = request(&[f64::NAN, 0.0], &[0.0, f64::INFINITY]);
    asked.torque_utilization = 1.5;
    asked.speed_scale = 0.0;
    asked.target_velocity = Some(vec![1.0]);
    asked.sampling = Sampling::Period(-1.0);
    asked.cycle_time = Some(f64::NAN);
    let wrong = findings(&robot, &asked);
    for path in [
        "start.position[0]",
        "target.position[1]",
        "torque_utilization",
        "speed_scale",
        "target_velocity",
        "sample_period_s",
        "cycle_time_s",
    ] {
        assert!(
            wrong.iter().any(|finding| finding.starts_with(path)),
            "{path}: {wrong:?}"
        );
    }
}

#[test]
fn a_joint_that_nothing_bounds_is_not_moved() {
    let mut spec = planar();
    spec.joints[1].drive.peak_torque = None;
    spec.joints[1].limits.velocity = None;
    let robot = robot(spec);
    let asked = request(&[0.0, 0.0], &[0.1, 0.1]);
    let wrong = findings(&robot, &asked);
    assert!(
        wrong.iter().any(|finding| finding.contains("no speed limit")),
        "{wrong:?}"
    );
    assert!(
        wrong.iter().any(|finding| finding.contains("nothing bounds the move")),
        "{wrong:?}"
    );
    let mut bounded = asked;
    bounded.limits = vec![LimitOverride {
        joint: "elbow".to_owned(),
        velocity: Some(1.0),
        acceleration: Some(2.0),
        ..LimitOverride::default()
    }];
    let done = plan(&robot, &bounded);
    assert_eq!(done.torque_margins.len(), 1);
    assert!(done.patterns[1].acceleration <= 2.0);
    assert!(
        done.warnings
            .iter()
            .any(|warning| warning.contains("torque not checked: elbow"))
    );
}

#[test]
fn the_cycle_time_dilutes_the_rms_torque_with_holding() {
    let robot = robot(lift(5.0));
    let mut asked = request(&[0.0], &[1.0]);
    let alone = plan(&robot, &asked);
    asked.cycle_time = Some(100.0);
    let diluted = plan(&robot, &asked);
    assert!(alone.torque_margins[0].rms_torque > 55.0);
    assert!((diluted.torque_margins[0].rms_torque - 50.0).abs() < 0.5);
    asked.cycle_time = Some(0.1);
    assert!(findings(&robot, &asked)[0].starts_with("cycle_time_s: 0.1 s is shorter"));
}

#[test]
fn a_budget_that_ended_stops_the_plan() {
    let robot = robot(planar());
    let over = || true;
    let stopped = plan_move(&robot, &request(&[0.0, 0.0], &[1.0, 1.0]), &Budget::until(&over));
    assert_eq!(stopped.unwrap_err(), Failure::Stopped);
}

#[test]
fn plans_that_would_take_for_ever_or_fill_the_memory_are_refused() {
    let robot = robot(lift(5.0));
    let mut asked = request(&[0.0], &[1.0]);
    asked.target_velocity = Some(vec![1.0e-12]);
    assert!(findings(&robot, &asked)[0].starts_with("limits: the move would take"));
    asked.target_velocity = None;
    asked.sampling = Sampling::Period(1.0e-9);
    assert!(findings(&robot, &asked)[0].starts_with("sample_period_s"));
}

#[test]
fn a_joint_alone_and_joints_that_stand_are_planned() {
    for seed in 0..8 {
        let robot = robot(random_arm(6, seed));
        let mut start = values(6, 1.5, &mut (seed + 3));
        start[4] = 0.25;
        let mut target = start.clone();
        target[(seed % 6) as usize] += 0.4;
        for method in [Method::Verified, Method::Preset, Method::Endpoint] {
            let mut asked = request(&start, &target);
            asked.method = method;
            let done = plan(&robot, &asked);
            assert_eq!(done.patterns.iter().filter(|pattern| pattern.moves()).count(), 1);
            assert!(done.duration > 0.0 && done.torque_margins.iter().all(|margin| margin.margin > 0.0));
        }
    }
}
