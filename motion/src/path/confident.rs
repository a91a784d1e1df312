//! Robot programs whose torque limits hold at a confidence: the planner as it is, within limits tightened from outside.

use super::answer;
use super::fault::infeasible;
use super::outcome::{Location, PathInfeasible, PathInfeasibleReason, PathLimit, PathOutcome};
use super::plan::{Runs, TimedRun, timed};
use super::problem::Problem;
use super::request::{PathRequest, Segment};
use super::verify::State;
use crate::budget::{Budget, Stopped};
use crate::confidence::{
    Bands, Confidence, ConfidenceReport, Confident, Course, Demand, Held, JointState, Planner, Short, Tightening, hold,
    overrides, suggestion, tightened_torque,
};
use crate::curve::Side;
use crate::dynamics::{self, Workspace};
use crate::plan::Failure;
use crate::plan::problem::{JointLimit, limits_in_force};
use crate::robot::Robot;
use crate::timing::limits::Limits;
use crate::tolerance::BAND_PARTS_MIN;

/// Plans a robot program whose torque limits hold at a confidence.
///
/// # Errors
/// A request or a confidence that is wrong, or a budget that ended.
pub fn plan_path(
    robot: &Robot,
    request: &PathRequest,
    confidence: Confidence,
    budget: &Budget<'_>,
) -> Result<Confident<PathOutcome>, Failure> {
    confidence.check(robot)?;
    let problem = Problem::new(robot, request)?;
    let refused = |infeasible, band| Confident {
        outcome: PathOutcome::Infeasible(infeasible),
        report: None,
        band,
    };
    let nominal = match timed(&problem, request, budget)? {
        Ok(runs) => runs,
        Err(infeasible) => return Ok(refused(infeasible, None)),
    };
    let Some(bands) = Bands::new(&problem.robot, confidence) else {
        return Err(Failure::invalid(
            "confidence",
            "the model has no uncertainty".to_owned(),
        ));
    };
    let nominal_duration = nominal.duration();
    let joints = limits_in_force(robot, &request.limits, request.torque_utilization, &mut Vec::new());
    let mut paths = Paths {
        robot,
        problem: &problem,
        request,
        joints: &joints,
        bands,
        budget,
    };
    let held = match hold(&mut paths, nominal, &problem.torque_limits())? {
        Ok(held) => held,
        Err(short) => {
            let evidence = evidence(&problem, request, &short, confidence);
            return Ok(refused(evidence, Some(short.tightest.band)));
        }
    };
    let residuals = paths.bands.residuals();
    let report = ConfidenceReport::new(confidence, &held.demand, &held.aside, Some(nominal_duration), residuals);
    let plan = answer::assemble(&problem, request, against_whole_limits(held), budget)?;
    Ok(Confident {
        outcome: PathOutcome::Plan(Box::new(plan)),
        report: Some(report),
        band: None,
    })
}

/// Torques as parts of the whole limits again, not of the tightened ones.
fn against_whole_limits(held: Held<Runs>) -> Runs {
    let mut runs = held.plan;
    for tightest in runs.runs.iter_mut().flat_map(|run| &mut run.examined.tightest) {
        let Some(joint) = tightest.joint.filter(|_| tightest.kind == PathLimit::Torque) else {
            continue;
        };
        tightest.limit += held.aside[joint];
        tightest.ratio = tightest.value.abs() / tightest.limit;
    }
    runs
}

struct Paths<'a> {
    robot: &'a Robot,
    problem: &'a Problem,
    request: &'a PathRequest,
    /// In force for the whole path, unscaled.
    joints: &'a [JointLimit],
    bands: Bands<'a>,
    budget: &'a Budget<'a>,
}

impl Planner for Paths<'_> {
    type Plan = Runs;

    fn plan(&mut self, tightening: &Tightening) -> Result<Option<Runs>, Failure> {
        let specs = &self.robot.spec().joints;
        let mut segments = Vec::with_capacity(self.request.segments.len());
        for segment in &self.request.segments {
            let Some(limits) = tightened_torque(&segment.limits, specs, &tightening.aside) else {
                return Ok(None);
            };
            segments.push(Segment {
                limits,
                ..segment.clone()
            });
        }
        let request = PathRequest {
            limits: overrides(&self.request.limits, specs, self.joints, tightening),
            segments,
            ..self.request.clone()
        };
        let problem = Problem::new(self.robot, &request)?;
        Ok(timed(&problem, &request, self.budget)?.ok())
    }

    fn demand(&mut self, runs: &Runs) -> Result<Demand, Stopped> {
        let mut course = Strokes::new(self.problem, self.request, runs);
        self.bands.demand(&mut course, self.budget)
    }

    fn duration(&self, runs: &Runs) -> f64 {
        runs.duration()
    }
}

/// The motion of a program. Its rests are a stretch each: at the start, and after every run that ends at rest.
struct Strokes<'a> {
    runs: &'a Runs,
    /// Limits of each run.
    limits: Vec<Limits>,
    whole: Vec<Option<f64>>,
    start: &'a [f64],
    /// Where the arm rests after each run.
    rests: Vec<Option<Vec<f64>>>,
    /// Of each stretch: its run, and which interval of its law; `None`: at rest after it, or at the start without a run.
    stretches: Vec<(Option<usize>, Option<usize>)>,
    state: State,
}

impl<'a> Strokes<'a> {
    fn new(problem: &Problem, request: &'a PathRequest, runs: &'a Runs) -> Self {
        let rests: Vec<Option<Vec<f64>>> = runs
            .runs
            .iter()
            .map(|run| run.ends_at_rest.then(|| run.rest(request)))
            .collect();
        let mut stretches = Vec::new();
        if request.start_speed.is_none() {
            stretches.push((None, None));
        }
        for (index, run) in runs.runs.iter().enumerate() {
            let intervals = run.law.times().len().saturating_sub(1);
            stretches.extend((0..intervals).map(|interval| (Some(index), Some(interval))));
            if rests[index].is_some() {
                stretches.push((Some(index), None));
            }
        }
        Self {
            limits: runs.runs.iter().map(|run| problem.limits(run.run.spans())).collect(),
            whole: problem.torque_limits(),
            start: &request.start,
            rests,
            stretches,
            state: State::new(request.start.len()),
            runs,
        }
    }

    fn run(&self, stretch: usize) -> Option<&'a TimedRun> {
        self.stretches[stretch].0.map(|run| &self.runs.runs[run])
    }
}

impl Course for Strokes<'_> {
    fn duration(&self) -> f64 {
        self.runs.duration()
    }

    fn stretches(&self) -> usize {
        self.stretches.len()
    }

    fn ends(&self, stretch: usize) -> [f64; 2] {
        let Some(run) = self.run(stretch) else { return [0.0; 2] };
        match self.stretches[stretch].1 {
            Some(interval) => {
                let times = run.law.times();
                [run.begin + times[interval], run.begin + times[interval + 1]]
            }
            None => [run.end(); 2],
        }
    }

    fn parts(&self, stretch: usize) -> usize {
        match self.stretches[stretch].1 {
            Some(_) => BAND_PARTS_MIN,
            None => 0,
        }
    }

    fn limit(&self, stretch: usize, joint: usize) -> Option<f64> {
        let (Some(index), Some(interval)) = self.stretches[stretch] else {
            return self.whole[joint];
        };
        let times = self.runs.runs[index].law.times();
        let middle = 0.5 * (times[interval] + times[interval + 1]);
        let limits = &self.limits[index];
        let place = self.runs.runs[index].law.at(middle).position;
        limits.stretches[limits.stretch_at(place, Side::After)].joints[joint].torque
    }

    fn set(&mut self, stretch: usize, time: f64, state: &mut JointState) {
        match self.stretches[stretch] {
            (Some(index), Some(interval)) => {
                let run = &self.runs.runs[index];
                let local = time - run.begin;
                let times = run.law.times();
                let early = local < 0.5 * (times[interval] + times[interval + 1]);
                let side = if early { Side::After } else { Side::Before };
                self.state.set(run.run.as_ref(), &run.law, local, side);
            }
            (Some(index), None) => self.state.rest_at(self.rests[index].as_deref().unwrap_or(self.start)),
            (None, _) => self.state.rest_at(self.start),
        }
        state.position.copy_from_slice(&self.state.position);
        state.velocity.copy_from_slice(&self.state.velocity);
        state.acceleration.copy_from_slice(&self.state.acceleration);
    }
}

/// The evidence where a program holds at no speed.
fn evidence(problem: &Problem, request: &PathRequest, short: &Short<Runs>, confidence: Confidence) -> PathInfeasible {
    let (joint, tightest) = (short.joint, &short.tightest);
    let mut course = Strokes::new(problem, request, &short.plan);
    let mut state = JointState::new(request.start.len());
    course.set(tightest.stretch, tightest.time, &mut state);
    let location = course.run(tightest.stretch).map_or(Location::default(), |run| {
        run.run.location(run.law.at(tightest.time - run.begin).position)
    });
    let mut gravity = vec![0.0; state.position.len()];
    let robot = &problem.robot;
    dynamics::gravity_torque(robot, &mut Workspace::new(robot), &state.position, &mut gravity);
    let reason = if state.velocity.iter().all(|velocity| *velocity == 0.0) {
        PathInfeasibleReason::HoldingTorque
    } else {
        PathInfeasibleReason::MovingTorque
    };
    let name = &robot.spec().joints[joint].name;
    PathInfeasible {
        joint: Some(joint),
        needed: tightest.torque + tightest.band.copysign(tightest.torque),
        available: tightest.limit,
        gravity_torque: gravity[joint],
        ..infeasible(reason, location, suggestion(confidence, name, tightest))
    }
}
