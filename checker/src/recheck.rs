//! A whole move against its limits, on a dense grid of times.
//!
//! Between two switching times of any joint all accelerations are constant and torque is smooth; at a switching time it
//! jumps. So every such interval is sampled by itself, both ends included, each joint by the law that holds inside the
//! interval: a switching time is sampled twice, once from either side. Before the start and after the end the arm
//! holds still, and the torque that this takes counts too.

use takt_motion::plan::outcome::Pattern;
use takt_motion::robot::spec::{Inertial, RobotSpec};

use crate::arm::{Arm, Workspace};
use crate::bounds::Bounds;
use crate::motion::{self, Inconsistency, Part, Relation};
use crate::report::{JointReport, Report};
use crate::tolerance;

/// A move as emitted, one entry a joint in model order.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Move<'a> {
    /// Positions to start from, rad or m.
    pub start: &'a [f64],
    /// Positions to end at, rad or m.
    pub target: &'a [f64],
    /// The pattern of every joint.
    pub patterns: &'a [Pattern],
}

/// How densely a move is sampled. An interval between switching times that takes the part w of the duration has
/// `per_interval + w × per_move` steps.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Grid {
    /// Steps in every interval, however short.
    pub per_interval: usize,
    /// Steps besides, spread evenly over the move.
    pub per_move: usize,
}

/// Lists that should have one entry a joint and have not.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct LengthMismatch {
    /// Which list.
    pub what: &'static str,
    /// Its length.
    pub found: usize,
    /// The number of joints.
    pub joint_count: usize,
}

/// Checks one move of one arm; see [`Checker`] for many.
///
/// `payload` is in the tip link's frame; `None`: the description's own.
///
/// # Errors
/// [`LengthMismatch`] where a list has not one entry a joint.
pub fn recheck(
    spec: &RobotSpec,
    payload: Option<&Inertial>,
    bounds: &[Bounds],
    planned: &Move<'_>,
    grid: Grid,
) -> Result<Report, LengthMismatch> {
    Checker::new(Arm::new(spec, payload)).check(bounds, planned, grid)
}

/// Checks moves of one arm with one payload, one after the other; allocates nothing for a sample.
#[derive(Debug, Clone)]
pub struct Checker {
    arm: Arm,
    workspace: Workspace,
    switchings: Vec<f64>,
    parts: Vec<Part>,
    sample: Sample,
    /// Torque of the last two samples, the later one first.
    earlier: [Vec<f64>; 2],
}

#[derive(Debug, Clone, Default)]
struct Sample {
    q: Vec<f64>,
    qd: Vec<f64>,
    qdd: Vec<f64>,
    direction: Vec<f64>,
    tau: Vec<f64>,
}

impl Checker {
    /// A checker of moves of `arm`.
    #[must_use]
    pub fn new(arm: Arm) -> Self {
        let room = vec![0.0; arm.joint_count()];
        Self {
            workspace: Workspace::default(),
            switchings: Vec::new(),
            parts: vec![Part::Rest; arm.joint_count()],
            sample: Sample {
                q: room.clone(),
                qd: room.clone(),
                qdd: room.clone(),
                direction: room.clone(),
                tau: room.clone(),
            },
            earlier: [room.clone(), room],
            arm,
        }
    }

    /// Checks one move.
    ///
    /// # Errors
    /// [`LengthMismatch`] where a list has not one entry a joint.
    pub fn check(&mut self, bounds: &[Bounds], planned: &Move<'_>, grid: Grid) -> Result<Report, LengthMismatch> {
        self.check_lengths(bounds, planned)?;
        let duration = planned.patterns.iter().map(motion::duration).fold(0.0, f64::max);
        let mut report = Report {
            duration,
            sample_count: 0,
            joints: bounds
                .iter()
                .zip(planned.start)
                .map(|(bounds, start)| JointReport::before(bounds, *start))
                .collect(),
            inconsistencies: inconsistencies(planned, duration),
        };
        let unusable = |found: &Inconsistency| matches!(found.relation, Relation::Finite | Relation::TimesNotNegative);
        if !report.inconsistencies.iter().any(unusable) {
            self.hold(planned, 0.0, &mut report);
            self.sweep(planned, duration, grid, &mut report);
            self.hold(planned, duration, &mut report);
            for (joint, tau) in report.joints.iter_mut().zip(&self.sample.tau) {
                joint.holding_at_end = *tau;
            }
        }
        for (joint, bounds) in report.joints.iter_mut().zip(bounds) {
            joint.judge(bounds);
        }
        Ok(report)
    }

    fn check_lengths(&self, bounds: &[Bounds], planned: &Move<'_>) -> Result<(), LengthMismatch> {
        let joint_count = self.arm.joint_count();
        let lists = [
            ("bounds", bounds.len()),
            ("start", planned.start.len()),
            ("target", planned.target.len()),
            ("patterns", planned.patterns.len()),
        ];
        match lists.into_iter().find(|(_, found)| *found != joint_count) {
            Some((what, found)) => Err(LengthMismatch {
                what,
                found,
                joint_count,
            }),
            None => Ok(()),
        }
    }

    /// Samples the motion, interval by interval.
    fn sweep(&mut self, planned: &Move<'_>, duration: f64, grid: Grid, report: &mut Report) {
        self.find_switchings(planned.patterns, duration);
        for index in 1..self.switchings.len() {
            let (from, to) = (self.switchings[index - 1], self.switchings[index]);
            let middle = 0.5 * (from + to);
            for (part, pattern) in self.parts.iter_mut().zip(planned.patterns) {
                *part = motion::part_at(pattern, middle);
            }
            let share = (to - from) / duration * grid.per_move as f64;
            let steps = (grid.per_interval + share.ceil() as usize).max(1);
            for step in 0..=steps {
                let time = from + (to - from) * (step as f64 / steps as f64);
                self.take(planned, time, report);
                self.resolve(step, report);
                let ends = if step == 0 || step == steps { 0.5 } else { 1.0 };
                self.integrate(ends * (to - from) / steps as f64, report);
            }
        }
    }

    /// Collects the times at which any joint switches, sorted, those closer than the tolerances say as one.
    fn find_switchings(&mut self, patterns: &[Pattern], duration: f64) {
        self.switchings.clear();
        if duration == 0.0 {
            return;
        }
        self.switchings.extend([0.0, duration]);
        for pattern in patterns {
            let cruise_from = pattern.acceleration_time;
            let brake_from = cruise_from + pattern.cruise_time;
            let end = brake_from + pattern.deceleration_time;
            self.switchings.extend([cruise_from, brake_from, end]);
        }
        self.switchings.sort_by(f64::total_cmp);
        let shortest_ramp = patterns
            .iter()
            .flat_map(|pattern| [pattern.acceleration_time, pattern.deceleration_time])
            .filter(|time| *time > 0.0)
            .fold(duration, f64::min);
        let closest = (tolerance::SWITCHING * duration).min(tolerance::SWITCHING_OF_RAMP * shortest_ramp);
        self.switchings.dedup_by(|later, earlier| *later - *earlier <= closest);
    }

    /// Looks at one state of the motion, every joint by the law of its part in force.
    fn take(&mut self, planned: &Move<'_>, time: f64, report: &mut Report) {
        let sample = &mut self.sample;
        for (joint, pattern) in planned.patterns.iter().enumerate() {
            let part = self.parts[joint];
            let state = motion::state_in(pattern, part, motion::within(pattern, part, time));
            sample.q[joint] = planned.start[joint] + state.travelled;
            sample.qd[joint] = state.velocity;
            sample.qdd[joint] = state.acceleration;
            // Inside an interval a joint that moves, moves in the direction of its peak velocity, also where the
            // interval touches the time at which it stands still.
            sample.direction[joint] = match part {
                Part::Rest => 0.0,
                _ => pattern.peak_velocity,
            };
        }
        self.evaluate(time, report);
    }

    /// Looks at the arm held still before the start (time 0) or after the end.
    fn hold(&mut self, planned: &Move<'_>, time: f64, report: &mut Report) {
        let sample = &mut self.sample;
        for (joint, pattern) in planned.patterns.iter().enumerate() {
            let travelled = if time > 0.0 { motion::travel(pattern) } else { 0.0 };
            sample.q[joint] = planned.start[joint] + travelled;
        }
        for list in [&mut sample.qd, &mut sample.qdd, &mut sample.direction] {
            list.fill(0.0);
        }
        self.compute_torque(report);
        let at_rest = report.duration == 0.0;
        for (found, tau) in report.joints.iter_mut().zip(&self.sample.tau) {
            found.holding.offer(*tau, time);
            if at_rest {
                found.torque.offer(*tau, time);
            }
        }
    }

    fn compute_torque(&mut self, report: &mut Report) {
        let sample = &mut self.sample;
        self.arm.drive_torque(
            &mut self.workspace,
            &sample.q,
            &sample.qd,
            &sample.qdd,
            &sample.direction,
            &mut sample.tau,
        );
        report.sample_count += 1;
    }

    fn evaluate(&mut self, time: f64, report: &mut Report) {
        self.compute_torque(report);
        let sample = &self.sample;
        for (joint, found) in report.joints.iter_mut().enumerate() {
            let (qdd, direction) = (sample.qdd[joint], sample.direction[joint]);
            found.torque.offer(sample.tau[joint], time);
            found.velocity.offer(sample.qd[joint], time);
            found.power.offer(sample.tau[joint] * sample.qd[joint], time);
            if qdd * direction > 0.0 {
                found.acceleration.offer(qdd, time);
            } else {
                found.deceleration.offer(qdd, time);
            }
            found.lowest.offer_lower(sample.q[joint], time);
            found.highest.offer_higher(sample.q[joint], time);
        }
    }

    /// Adds what the sample stands for to the integrals.
    fn integrate(&self, weight: f64, report: &mut Report) {
        for (joint, tau) in report.joints.iter_mut().zip(&self.sample.tau) {
            joint.squared_torque += tau * tau * weight;
        }
    }

    /// Estimates, from the third sample of an interval on, what may lie between the samples.
    fn resolve(&mut self, step: usize, report: &mut Report) {
        let [last, before_last] = &mut self.earlier;
        if step >= 2 {
            for (joint, found) in report.joints.iter_mut().enumerate() {
                let bend = self.sample.tau[joint] - 2.0 * last[joint] + before_last[joint];
                found.torque_resolution = found.torque_resolution.max(bend.abs() / 8.0);
            }
        }
        std::mem::swap(last, before_last);
        last.copy_from_slice(&self.sample.tau);
    }
}

fn inconsistencies(planned: &Move<'_>, duration: f64) -> Vec<Inconsistency> {
    let mut all = Vec::new();
    for (joint, pattern) in planned.patterns.iter().enumerate() {
        let mut add = |relation, mismatch| {
            all.push(Inconsistency {
                relation,
                joint,
                mismatch,
            });
        };
        motion::examine(pattern, duration, tolerance::CONSISTENCY, &mut add);
        let (start, target) = (planned.start[joint], planned.target[joint]);
        let scale = start.abs().max(target.abs()).max(1.0);
        let missed = (start + pattern.displacement - target).abs() / scale;
        if !start.is_finite() || !target.is_finite() {
            add(Relation::Finite, f64::INFINITY);
        } else if missed > tolerance::ARRIVAL {
            add(Relation::Arrival, missed);
        }
    }
    all
}

impl Default for Grid {
    /// About 1100 states in a move whose joints switch together.
    fn default() -> Self {
        Self {
            per_interval: 16,
            per_move: 1000,
        }
    }
}

impl std::fmt::Display for LengthMismatch {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self {
            what,
            found,
            joint_count,
        } = self;
        write!(f, "{what}: {found} entries for {joint_count} joints")
    }
}

impl std::error::Error for LengthMismatch {}
