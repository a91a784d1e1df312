//! The second writing of the end-pose method does what JP4358979B2 says.

#[path = "oracle/arms.rs"]
#[allow(dead_code, reason = "shared with tests that need more of it")]
mod arms;

use takt_checker::draw::{self, Draw};
use takt_checker::endpoint::{self, EndpointMove, Preset};
use takt_checker::{Arm, Bounds, Grid, Move, Report, Workspace, recheck};
use takt_motion::plan::outcome::{Fallback, LimitKind, Pattern};
use takt_motion::robot::Robot;
use takt_motion::robot::spec::RobotSpec;

/// Roundings.
const ROUNDING: f64 = 1e-9;

struct Trial {
    spec: RobotSpec,
    arm: Arm,
    bounds: Vec<Bounds>,
    preset: Preset,
}

impl Trial {
    fn of(spec: RobotSpec) -> Self {
        let arm = Arm::new(&spec, None);
        let bounds = Bounds::of_robot(&spec);
        let preset = endpoint::derive_preset(&spec, &arm, &bounds, 512).expect("the arm has limits");
        Self {
            spec,
            arm,
            bounds,
            preset,
        }
    }

    fn plan(&self, start: &[f64], target: &[f64], preferred: Fallback) -> Option<EndpointMove> {
        endpoint::plan(&self.arm, &self.bounds, &self.preset, start, target, preferred).ok()
    }

    fn recheck(&self, start: &[f64], target: &[f64], patterns: &[Pattern]) -> Report {
        let planned = Move {
            start,
            target,
            patterns,
        };
        recheck(&self.spec, None, &self.bounds, &planned, Grid::default()).expect("one entry a joint")
    }

    /// Largest |torque| over limit at one end, with the speeds and accelerations of eq 33 to 40: cruising speed at the
    /// end pose.
    fn end_use(&self, pose: &[f64], velocity: &[f64], acceleration: &[f64]) -> f64 {
        let mut tau = vec![0.0; pose.len()];
        let mut workspace = Workspace::default();
        self.arm
            .drive_torque(&mut workspace, pose, velocity, acceleration, velocity, &mut tau);
        tau.iter()
            .zip(&self.bounds)
            .filter_map(|(tau, bounds)| Some(tau.abs() / bounds.torque?))
            .fold(0.0, f64::max)
    }
}

/// Calls `check` with plans of random moves of two arms, with and without friction, by either fallback.
fn for_random_moves(mut check: impl FnMut(&Trial, &[f64], &[f64], &EndpointMove, &EndpointMove)) {
    let specs = [
        arms::from_urdf("fr3", "fr3.urdf", "oracle.json").spec,
        arms::puma_from_table().spec,
    ];
    for spec in specs {
        let trial = Trial::of(spec);
        let mut draw = Draw::seeded(41);
        let mut planned_count = 0;
        for _ in 0..300 {
            let start = draw::pose_within(&mut draw, &trial.spec);
            let mut target = draw::pose_within(&mut draw, &trial.spec);
            // Now and then a joint stands still.
            if draw.bits().is_multiple_of(4) {
                target[1] = start[1];
            }
            let plans = [Fallback::Resynchronized, Fallback::Rebased].map(|one| trial.plan(&start, &target, one));
            if let [Some(one), Some(other)] = &plans {
                check(&trial, &start, &target, one, other);
                planned_count += 1;
            }
        }
        assert!(planned_count > 150, "{planned_count} of 300 moves have a plan");
    }
}

#[test]
fn patterns_are_sound_and_within_speed_and_position() {
    for_random_moves(|trial, start, target, one, other| {
        for planned in [one, other] {
            let report = trial.recheck(start, target, &planned.patterns);
            assert_eq!(report.inconsistencies, []);
            assert!((report.duration - planned.duration).abs() <= ROUNDING * planned.duration);
            for kind in [LimitKind::Velocity, LimitKind::PositionLower, LimitKind::PositionUpper] {
                let worst = report.worst_of(kind).expect("the arm is limited so");
                assert!(worst.excess <= ROUNDING, "{worst:?}");
            }
        }
    });
}

#[test]
fn both_fallbacks_take_the_same_time() {
    let mut fallback_count = 0;
    for_random_moves(|_, _, _, one, other| {
        assert!((one.duration - other.duration).abs() <= ROUNDING * one.duration);
        assert_eq!(one.fallback == Fallback::None, other.fallback == Fallback::None);
        fallback_count += usize::from(one.fallback != Fallback::None);
    });
    assert!(fallback_count > 0, "no move needed a fallback");
}

#[test]
fn torque_touches_its_limit_at_both_ends() {
    for_random_moves(|trial, start, target, _, planned| {
        if planned.fallback != Fallback::None {
            return;
        }
        // The predicted speeds (eq 67) are the preset pattern's.
        let signs: Vec<f64> = start.iter().zip(target).map(|(s, e)| (e - s).signum()).collect();
        let velocity = predicted_speeds(trial, start, target, &signs);
        let up: Vec<f64> = planned.patterns.iter().map(|one| one.acceleration).collect();
        let down: Vec<f64> = planned.patterns.iter().map(|one| -one.deceleration).collect();
        let uses = [
            trial.end_use(start, &velocity, &up),
            trial.end_use(target, &velocity, &down),
        ];
        for used in uses {
            assert!((used - 1.0).abs() < ROUNDING, "{used} of the limit at an end");
        }
    });
}

/// Eq 41 to 51 and 67, from their definition: the peak of each preset pattern, drawn out to the longest.
fn predicted_speeds(trial: &Trial, start: &[f64], target: &[f64], signs: &[f64]) -> Vec<f64> {
    let preset = &trial.preset;
    let times_and_peaks: Vec<(f64, f64)> = (0..start.len())
        .map(|joint| {
            let way = (target[joint] - start[joint]).abs();
            let (speed, rate) = (preset.velocity[joint], preset.acceleration[joint]);
            // Acceleration and deceleration are equal here: the ramps take v/a each and v²/a in all.
            if way >= speed * speed / rate {
                (way / speed + speed / rate, speed)
            } else {
                (2.0 * (way / rate).sqrt(), (way * rate).sqrt())
            }
        })
        .collect();
    let longest = times_and_peaks.iter().map(|(time, _)| *time).fold(0.0, f64::max);
    times_and_peaks
        .iter()
        .zip(signs)
        .map(|((time, peak), sign)| peak * time / longest * sign)
        .collect()
}

#[test]
fn end_poses_are_not_the_whole_motion() {
    // The statement that docs/verification.md measures: plans that keep the limit at both ends exceed it between.
    let mut over_count = 0;
    let mut count = 0;
    for_random_moves(|trial, start, target, _, planned| {
        let report = trial.recheck(start, target, &planned.patterns);
        let worst = report.worst_of(LimitKind::Torque).expect("torque is limited");
        over_count += usize::from(worst.excess > 1e-3);
        count += 1;
    });
    assert!(over_count * 4 > count, "{over_count} of {count}");
}

#[test]
fn nothing_to_do_takes_no_time() {
    let trial = Trial::of(arms::puma_from_table().spec);
    let pose = [0.0, 0.5, -0.5, 0.0, 0.3, 0.0];
    // No acceleration is asked for, so none is the largest.
    assert_eq!(trial.plan(&pose, &pose, Fallback::Rebased), None);
}

#[test]
fn derived_presets_are_the_planners() {
    // Both take the first percentile over their own 4096 poses: as far apart as two such samples are.
    let specs = [
        arms::from_urdf("ur5e", "ur5e.urdf", "oracle.json").spec,
        arms::from_urdf("fr3", "fr3.urdf", "oracle.json").spec,
        arms::puma_from_table().spec,
    ];
    for spec in specs {
        let arm = Arm::new(&spec, None);
        let own = endpoint::derive_preset(&spec, &arm, &Bounds::of_robot(&spec), 4096).expect("the arm has limits");
        let robot = Robot::new(spec, Vec::new()).expect("the arm is sound");
        for (joint, own) in own.acceleration.iter().enumerate() {
            let theirs = robot.preset(joint).expect("the arm has limits").acceleration;
            let ratio = own / theirs;
            assert!(
                (0.9..1.1).contains(&ratio),
                "joint {joint}: {own} here, {theirs} by the planner"
            );
        }
    }
}
