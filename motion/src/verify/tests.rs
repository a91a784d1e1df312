use super::*;
use crate::budget::Budget;
use crate::dynamics::{Workspace, gravity_torque, rigid_torque};
use crate::plan::outcome::{MoveOutcome, Pattern};
use crate::plan::plan_move;
use crate::robot::Robot;
use crate::test_arms::{loaded, planar, random_arm, request, robot, values};
use crate::tolerance::VERIFY_RESERVE;

fn planned(robot: &Robot, start: &[f64], target: &[f64]) -> Vec<Pattern> {
    match plan_move(robot, &request(start, target), &Budget::unlimited()).unwrap() {
        MoveOutcome::Plan(plan) => plan.patterns,
        MoveOutcome::Infeasible(infeasible) => panic!("{infeasible:?}"),
    }
}

fn verify(robot: &Robot, motion: &Trajectory) -> Verification {
    let limits: Vec<Option<f64>> = robot
        .spec()
        .joints
        .iter()
        .map(|joint| joint.drive.peak_torque)
        .collect();
    Verifier::default().verify(robot.chain(), robot.drives(), &limits, motion)
}

/// The largest torques on a grid so dense that what is between its points does not matter.
fn dense_peaks(robot: &Robot, motion: &Trajectory, per_segment: usize) -> Vec<f64> {
    let count = robot.joint_count();
    let workspace = &mut Workspace::new(robot);
    let mut peaks = vec![0.0_f64; count];
    let (mut torque, mut gravity) = (vec![0.0; count], vec![0.0; count]);
    for segment in 0..motion.segment_count() {
        let span = motion.times()[segment + 1] - motion.times()[segment];
        let middle: Vec<f64> = motion
            .segment(segment)
            .iter()
            .map(|p| evaluate(p, 0.5 * span).velocity)
            .collect();
        for k in 0..=per_segment {
            let at: Vec<_> = motion
                .segment(segment)
                .iter()
                .map(|p| evaluate(p, span * k as f64 / per_segment as f64))
                .collect();
            let column =
                |value: &dyn Fn(&crate::trajectory::State) -> f64| -> Vec<f64> { at.iter().map(value).collect() };
            let (q, qd, qdd) = (
                column(&|s| s.position),
                column(&|s| s.velocity),
                column(&|s| s.acceleration),
            );
            rigid_torque(robot, workspace, &q, &qd, &qdd, &mut torque);
            gravity_torque(robot, workspace, &q, &mut gravity);
            for joint in 0..count {
                let drive = &robot.drives()[joint];
                let whole = torque[joint]
                    + drive.armature * qdd[joint]
                    + drive.viscous * qd[joint]
                    + drive.drag(qd[joint])
                    + drive.coulomb(middle[joint], gravity[joint]);
                peaks[joint] = peaks[joint].max(whole.abs());
            }
        }
    }
    peaks
}

#[test]
fn extremes_are_true_to_a_tenth_of_the_reserve() {
    for seed in 0..24 {
        let spec = random_arm(4, seed / 2);
        let robot = robot(if seed % 2 == 0 { spec } else { loaded(spec) });
        let state = &mut (seed + 100);
        let (start, target) = (values(4, 2.5, state), values(4, 2.5, state));
        let motion = Trajectory::of_patterns(&start, &planned(&robot, &start, &target));
        let found = verify(&robot, &motion);
        for (joint, dense) in dense_peaks(&robot, &motion, 4000).into_iter().enumerate() {
            let peak = found.joints[joint].peak_torque.abs();
            assert!(
                peak >= dense * (1.0 - 0.1 * VERIFY_RESERVE),
                "seed {seed}, joint {joint}: {peak} {dense}"
            );
            assert!(
                peak <= dense * (1.0 + 1.0e-4),
                "seed {seed}, joint {joint}: {peak} {dense}"
            );
        }
    }
}

#[test]
fn the_integral_of_the_squared_torque_is_that_of_a_dense_sum() {
    let robot = robot(planar());
    let (start, target) = ([-0.5, 0.3], [0.9, -1.2]);
    let motion = Trajectory::of_patterns(&start, &planned(&robot, &start, &target));
    let found = verify(&robot, &motion);
    let workspace = &mut Workspace::new(&robot);
    let mut sums = [0.0; 2];
    let per_segment = 20_000;
    for segment in 0..motion.segment_count() {
        let span = motion.times()[segment + 1] - motion.times()[segment];
        for k in 0..per_segment {
            let time = span * (f64::from(k) + 0.5) / f64::from(per_segment);
            let at: Vec<_> = motion.segment(segment).iter().map(|p| evaluate(p, time)).collect();
            let mut torque = [0.0; 2];
            rigid_torque(
                &robot,
                workspace,
                &[at[0].position, at[1].position],
                &[at[0].velocity, at[1].velocity],
                &[at[0].acceleration, at[1].acceleration],
                &mut torque,
            );
            for joint in 0..2 {
                sums[joint] += torque[joint] * torque[joint] * span / f64::from(per_segment);
            }
        }
    }
    for (joint, sum) in found.joints.iter().zip(sums) {
        let integral = joint.torque_squared;
        assert!((integral / sum - 1.0).abs() < 1.0e-4, "{integral} {sum}");
    }
}

#[test]
fn a_drive_that_viscous_friction_helps_is_not_safe_at_slower_overrides() {
    // an arm swings down through the horizontal, where gravity pulls most; at speed, friction carries half of it
    let mut spec = planar();
    spec.joints.truncate(1);
    spec.joints[0].drive.joint_friction.viscous = 10.0;
    let limits = [Some(25.0)];
    let robot = robot(spec);
    let pattern = Pattern {
        displacement: -2.4,
        peak_velocity: -1.5,
        acceleration: -3.0,
        deceleration: -3.0,
        acceleration_time: 0.5,
        cruise_time: 1.1,
        deceleration_time: 0.5,
    };
    let motion = Trajectory::of_patterns(&[1.2], &[pattern]);
    let found = Verifier::default().verify(robot.chain(), robot.drives(), &limits, &motion);
    assert!(found.joints[0].peak_torque.abs() < 25.0, "{:?}", found.joints);
    let safety = found.override_safe.unwrap();
    assert!(!safety.safe);
    assert_eq!(safety.worst_override, 0.0);
    assert!((safety.torque.abs() - 30.0).abs() < 1.0e-3, "{safety:?}");
}

/// Braking through the vertical, where the load passes zero: with I the inertia, G the largest gravity torque and φ the angle
/// beyond the vertical, the torque is F − I·δ − G·sin φ + κ·G·|sin φ|. With κ > 1 it is lowest at φ = 0, by κ ± 1 steep
/// on either side.
#[test]
fn a_kink_of_the_loads_friction_is_an_extreme_to_the_last_digits() {
    let mut spec = planar();
    spec.joints.truncate(1);
    spec.gravity.z = -1.0;
    spec.joints[0].drive.joint_friction.load_coulomb = 1.5;
    spec.joints[0].drive.joint_friction.coulomb_positive = 2.0;
    let inertia = 3.0 + 0.01;
    let robot = robot(spec);
    let pattern = Pattern {
        displacement: 1.75,
        peak_velocity: 3.0,
        acceleration: 6.0,
        deceleration: 18.0,
        acceleration_time: 0.5,
        cruise_time: 0.25,
        deceleration_time: 1.0 / 6.0,
    };
    // the vertical is in the middle of the braking, in time
    let vertical = 1.75 - 0.5 * 18.0 / 144.0;
    let start = 0.5 * std::f64::consts::PI - vertical;
    let motion = Trajectory::of_patterns(&[start], &[pattern]);
    let found = Verifier::default().verify(robot.chain(), robot.drives(), &[Some(60.0)], &motion);
    let demand = found.joints[0];
    let expected = 2.0 - inertia * 18.0;
    assert!((demand.peak_torque - expected).abs() < 1e-8, "{demand:?} {expected}");
    assert!((demand.time - (0.75 + 1.0 / 12.0)).abs() < 1e-8, "{demand:?}");
    let safety = found.override_safe.unwrap();
    assert!(safety.safe && (safety.torque - expected).abs() < 1e-8, "{safety:?}");
}
