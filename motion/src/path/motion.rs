//! A program as a motion in time, for whoever runs it: q and its derivatives to the third at every cycle.

use super::outcome::PathInfeasible;
use super::plan::timed;
use super::problem::Problem;
use super::request::{PathRequest, Timing};
use super::sample::Sampler;
use crate::budget::Budget;
use crate::plan::Failure;
use crate::plan::request::Sampling;
use crate::robot::Robot;
use crate::robot::spec::Inertial;
use crate::tolerance::BUDGET_STRIDE;

/// A timed, verified program, sampled.
pub(crate) struct PathMotion {
    pub(crate) joint_count: usize,
    /// s.
    pub(crate) duration: f64,
    /// Position, velocity, acceleration, jerk: sample by sample, one a joint.
    pub(crate) states: Vec<[f64; 4]>,
    /// Jerk is continuous but at the stops.
    pub(crate) smooth: bool,
    /// How many derivatives in time are continuous everywhere.
    pub(crate) continuity: u32,
    /// Where strokes begin and end, s.
    pub(crate) stops: Vec<f64>,
    pub(crate) payload: Option<Inertial>,
    pub(crate) warnings: Vec<String>,
}

/// Plans a program and samples its motion once a period.
///
/// # Errors
/// A request that is wrong, or a budget that ended.
pub(crate) fn path_motion(
    robot: &Robot,
    request: &PathRequest,
    period: f64,
    budget: &Budget<'_>,
) -> Result<Result<PathMotion, PathInfeasible>, Failure> {
    let request = &PathRequest {
        sampling: Sampling::Period(period),
        ..request.clone()
    };
    let problem = Problem::new(robot, request)?;
    let runs = match timed(&problem, request, budget)? {
        Ok(runs) => runs,
        Err(infeasible) => return Ok(Err(infeasible)),
    };
    let duration = runs.duration();
    let cycles = (duration / period).round() as usize;
    let mut sampler = Sampler::new(&problem, request, &runs.runs);
    let count = robot.joint_count();
    let mut states = Vec::with_capacity((cycles + 1) * count);
    for cycle in 0..=cycles {
        if cycle % BUDGET_STRIDE == 0 {
            budget.check()?;
        }
        sampler.set(cycle as f64 * period);
        let at = &sampler.state;
        states.extend((0..count).map(|j| [at.position[j], at.velocity[j], at.acceleration[j], at.jerk[j]]));
    }
    // with a limited jerk the squared path speed is a cubic spline: its second derivative, and so the jerk, is continuous
    let optimal = request.timing == Timing::Optimal;
    let jerk_limited = optimal && runs.runs.iter().all(|run| problem.limits_jerk(run.run.spans()));
    Ok(Ok(PathMotion {
        joint_count: count,
        duration,
        states,
        smooth: jerk_limited && runs.continuity >= 3,
        continuity: if jerk_limited || !optimal { 2 } else { 1 },
        stops: runs.runs.iter().flat_map(|run| [run.begin, run.end()]).collect(),
        payload: request.payload,
        warnings: runs.warnings,
    }))
}
