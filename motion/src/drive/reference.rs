//! A motion at the controller's times: q and its first four derivatives, and where they are to be trusted.
//!
//! Moves and trajectories made elsewhere are polynomials of time, whose derivatives are exact. Timed paths have them exact to the third;
//! the fourth is the third's central difference over two periods. Where a derivative up to the third jumps within a
//! period of a sample, the third and fourth have no meaning for a controller, and the sample is marked.

use super::rehearse::request::{Motion, SetpointMotion};
use crate::budget::Budget;
use crate::path::outcome::{PathInfeasible, PathOutcome, PathPlan};
use crate::path::plan_path;
use crate::path::request::PathRequest;
use crate::plan::outcome::{Infeasible, MoveOutcome, MovePlan};
use crate::plan::request::{MoveRequest, Sampling};
use crate::plan::{Failure, plan_move, read_trajectory};
use crate::robot::Robot;
use crate::robot::spec::Inertial;
use crate::tolerance::{SETPOINTS_MAX, SMOOTH_JUMP};
use crate::trajectory::{Polynomial, Trajectory};

/// Position and its first four derivatives.
pub(crate) type Derivatives = [f64; 5];

/// A motion, sampled at the controller's times from 0 on; after its last sample it rests there.
#[derive(Debug, Clone, PartialEq)]
pub struct Reference {
    pub(super) joint_count: usize,
    /// s.
    pub(super) period: f64,
    /// Of the motion, s.
    pub(super) duration: f64,
    /// Sample by sample, one a joint.
    pub(super) states: Vec<Derivatives>,
    /// Whether the third and fourth derivatives mean something there.
    pub(super) smooth: Vec<bool>,
    /// How many derivatives are continuous everywhere, rest before and after included.
    pub(super) continuity: u32,
    /// What the motion was planned to carry.
    pub(super) payload: Option<Inertial>,
    pub(super) warnings: Vec<String>,
}

/// Why there is no motion.
#[derive(Debug, Clone, PartialEq)]
pub enum NoMotion {
    /// The move cannot be planned.
    Move(Box<Infeasible>),
    /// The program cannot be planned.
    Path(Box<PathInfeasible>),
}

impl Reference {
    /// Plans a motion and samples it; `settle` s of rest are added at its end.
    ///
    /// # Errors
    /// A request that is wrong, or a budget that ended.
    pub fn new(
        robot: &Robot,
        motion: &Motion,
        period: f64,
        settle: f64,
        budget: &Budget<'_>,
    ) -> Result<Result<Self, NoMotion>, Failure> {
        let reference = match motion {
            Motion::Move(request) => Self::of_move(robot, request, period, budget)?,
            Motion::Path(request) => Self::of_path(robot, request, period, budget)?,
            Motion::Setpoints(points) => Ok(Self::of_points(robot, points, period)?),
        };
        let mut reference = match reference {
            Ok(reference) => reference,
            Err(none) => return Ok(Err(none)),
        };
        let rest = (settle / period).ceil() as usize;
        if reference.steps() + rest > SETPOINTS_MAX {
            let message = format!(
                "{} steps of {period} s, the most is {SETPOINTS_MAX}",
                reference.steps() + rest
            );
            return Err(Failure::invalid("period_s", message));
        }
        let last = reference.states.len() - reference.joint_count;
        let target: Vec<Derivatives> = reference.states[last..]
            .iter()
            .map(|at| [at[0], 0.0, 0.0, 0.0, 0.0])
            .collect();
        for _ in 0..rest {
            reference.states.extend_from_slice(&target);
            reference.smooth.push(true);
        }
        Ok(Ok(reference))
    }

    /// Samples.
    #[must_use]
    pub fn steps(&self) -> usize {
        self.smooth.len()
    }

    pub(super) fn at(&self, step: usize) -> &[Derivatives] {
        &self.states[step * self.joint_count..(step + 1) * self.joint_count]
    }

    fn of_move(
        robot: &Robot,
        request: &MoveRequest,
        period: f64,
        budget: &Budget<'_>,
    ) -> Result<Result<Self, NoMotion>, Failure> {
        // a whole number of periods, as a controller runs it
        let request = MoveRequest {
            sampling: Sampling::Period(period),
            ..request.clone()
        };
        let plan = match plan_move(robot, &request, budget)? {
            MoveOutcome::Plan(plan) => plan,
            MoveOutcome::Infeasible(infeasible) => return Ok(Err(NoMotion::Move(Box::new(infeasible)))),
        };
        Ok(Ok(Self::of_planned_move(&request, &plan, period)?))
    }

    /// A move as it was planned, on a period of which its duration is a whole number.
    ///
    /// # Errors
    /// More samples than there may be.
    pub fn of_planned_move(request: &MoveRequest, plan: &MovePlan, period: f64) -> Result<Self, Failure> {
        let mut reference = if plan.duration > 0.0 {
            let motion = Trajectory::of_patterns(&request.start, &plan.patterns);
            Self::of_trajectory(&motion, period, plan.duration)?
        } else {
            Self::at_rest(&request.start, period)
        };
        // the target itself, not what rounding makes of it
        let last = reference.states.len() - reference.joint_count;
        for (state, target) in reference.states[last..].iter_mut().zip(&request.target) {
            *state = [*target, 0.0, 0.0, 0.0, 0.0];
        }
        reference.payload = request.payload;
        reference.warnings.clone_from(&plan.warnings);
        Ok(reference)
    }

    fn of_path(
        robot: &Robot,
        request: &PathRequest,
        period: f64,
        budget: &Budget<'_>,
    ) -> Result<Result<Self, NoMotion>, Failure> {
        let request = PathRequest {
            sampling: Sampling::Period(period),
            ..request.clone()
        };
        match plan_path(robot, &request, budget)? {
            PathOutcome::Plan(plan) => Ok(Ok(Self::of_planned_path(&request, &plan, period)?)),
            PathOutcome::Infeasible(infeasible) => Ok(Err(NoMotion::Path(Box::new(infeasible)))),
        }
    }

    fn of_points(robot: &Robot, points: &SetpointMotion, period: f64) -> Result<Self, Failure> {
        let motion = read_trajectory(robot, &points.points, points.interpolation)?;
        let duration = motion.times()[motion.segment_count()];
        let mut reference = Self::of_trajectory(&motion, period, duration)?;
        reference.payload = points.payload;
        Ok(reference)
    }

    fn at_rest(position: &[f64], period: f64) -> Self {
        Self {
            joint_count: position.len(),
            period,
            duration: 0.0,
            states: position.iter().map(|q| [*q, 0.0, 0.0, 0.0, 0.0]).collect(),
            smooth: vec![true],
            continuity: 3,
            payload: None,
            warnings: Vec::new(),
        }
    }

    fn of_trajectory(motion: &Trajectory, period: f64, duration: f64) -> Result<Self, Failure> {
        let periods = (duration / period - SMOOTH_JUMP).ceil().max(1.0);
        if periods >= SETPOINTS_MAX as f64 {
            let message = format!("{periods} steps of {period} s, the most is {SETPOINTS_MAX}");
            return Err(Failure::invalid("period_s", message));
        }
        let (count, steps) = (motion.joint_count(), periods as usize + 1);
        let mut states = Vec::with_capacity(steps * count);
        let mut segment = 0;
        for step in 0..steps {
            let time = step as f64 * period;
            while segment + 1 < motion.segment_count() && motion.times()[segment + 1] <= time {
                segment += 1;
            }
            let since = (time - motion.times()[segment]).min(motion.times()[segment + 1] - motion.times()[segment]);
            states.extend(motion.segment(segment).iter().map(|p| derivatives(p, since)));
        }
        let (continuity, jumps) = jumps(motion);
        Ok(Self {
            joint_count: count,
            period,
            duration,
            states,
            smooth: away_from(&jumps, steps, period),
            continuity,
            payload: None,
            warnings: Vec::new(),
        })
    }

    /// A program as it was planned, with set-points at the period.
    ///
    /// # Errors
    /// A plan without set-points.
    pub fn of_planned_path(request: &PathRequest, plan: &PathPlan, period: f64) -> Result<Self, Failure> {
        let Some(setpoints) = &plan.setpoints else {
            let message = "must be given: motors have set-points on the controller's cycle";
            return Err(Failure::invalid("sample_period_s", message.to_owned()));
        };
        let (joints, jerk) = (&setpoints.samples.joints, &setpoints.jerk);
        let (count, steps) = (joints.len(), setpoints.samples.time.len());
        let mut smooth = if plan.smoothness.jerk_is_continuous {
            away_from(&plan.smoothness.stops, steps, period)
        } else {
            vec![false; steps]
        };
        // their neighbours are needed for the fourth derivative
        smooth[0] = false;
        smooth[steps - 1] = false;
        let states = (0..steps * count).map(|entry| {
            let (step, columns) = (entry / count, &joints[entry % count]);
            let snap = if smooth[step] {
                (jerk[entry + count] - jerk[entry - count]) / (2.0 * period)
            } else {
                0.0
            };
            [
                columns.position[step],
                columns.velocity[step],
                columns.acceleration[step],
                jerk[entry],
                snap,
            ]
        });
        Ok(Self {
            joint_count: count,
            period,
            duration: plan.duration,
            states: states.collect(),
            smooth,
            continuity: plan.smoothness.continuity,
            payload: request.payload,
            warnings: plan.warnings.clone(),
        })
    }
}

/// Value and derivatives of a polynomial.
fn derivatives(p: &Polynomial, t: f64) -> Derivatives {
    let mut coefficients = *p;
    std::array::from_fn(|_| {
        let value = coefficients.iter().rev().fold(0.0, |sum, c| sum * t + c);
        for k in 0..coefficients.len() {
            coefficients[k] = coefficients.get(k + 1).map_or(0.0, |next| next * (k + 1) as f64);
        }
        value
    })
}

/// How many derivatives are continuous everywhere, and the times at which one up to the third jumps. Before and after is rest.
fn jumps(motion: &Trajectory) -> (u32, Vec<f64>) {
    let count = motion.joint_count();
    let segments = motion.segment_count();
    let rest = vec![[0.0; 5]; count];
    let states = |segment: usize, end: bool| -> Vec<Derivatives> {
        let span = motion.times()[segment + 1] - motion.times()[segment];
        let at = if end { span } else { 0.0 };
        motion.segment(segment).iter().map(|p| derivatives(p, at)).collect()
    };
    let mut largest = [0.0_f64; 4];
    let mut apart: Vec<[f64; 4]> = Vec::with_capacity(segments + 1);
    let mut before = rest.clone();
    for segment in 0..=segments {
        let after = if segment < segments {
            states(segment, false)
        } else {
            rest.clone()
        };
        let mut jump = [0.0_f64; 4];
        for (before, after) in before.iter().zip(&after) {
            for order in 1..4 {
                largest[order] = largest[order].max(before[order].abs()).max(after[order].abs());
                jump[order] = jump[order].max((after[order] - before[order]).abs());
            }
        }
        apart.push(jump);
        if segment < segments {
            before = states(segment, true);
        }
    }
    let mut continuity = 3;
    let mut times = Vec::new();
    for (jump, time) in apart.iter().zip(motion.times()) {
        let Some(order) = (1..4).find(|order| jump[*order] > SMOOTH_JUMP * largest[*order]) else {
            continue;
        };
        continuity = continuity.min(order as u32 - 1);
        times.push(*time);
    }
    (continuity, times)
}

/// Which samples are farther than a period from every one of some times, in order.
fn away_from(times: &[f64], steps: usize, period: f64) -> Vec<bool> {
    let mut smooth = vec![true; steps];
    for time in times {
        let at = time / period;
        let first = (at - 1.0 - SMOOTH_JUMP).ceil().max(0.0) as usize;
        let last = (at + 1.0 + SMOOTH_JUMP).floor() as usize;
        for flag in smooth.iter_mut().take(last + 1).skip(first) {
            *flag = false;
        }
    }
    smooth
}
