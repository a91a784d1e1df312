//! Samples of a timed path: set-points on the caller's cycle, or a trace for looking at.

use super::outcome::{Location, PathSetpoints};
use super::plan::TimedRun;
use super::problem::Problem;
use super::request::PathRequest;
use super::verify::State;
use crate::budget::Budget;
use crate::curve::Side;
use crate::dynamics::sweep::Sweep;
use crate::kinematics;
use crate::plan::Failure;
use crate::plan::outcome::{JointColumns, Setpoints};
use crate::plan::request::Sampling;
use crate::tolerance::SAMPLE_AT_STOP;

/// Samples computed at once: it bounds the scratch memory.
const BLOCK: usize = 512;

/// Samples a plan as asked; `None` where no samples were asked for.
pub(super) fn setpoints(
    problem: &Problem,
    request: &PathRequest,
    runs: &[TimedRun],
    duration: f64,
    budget: &Budget<'_>,
) -> Result<Option<PathSetpoints>, Failure> {
    let times: Vec<f64> = match request.sampling {
        Sampling::None => return Ok(None),
        Sampling::Period(period) => {
            let cycles = (duration / period).round() as usize;
            (0..=cycles).map(|k| period * k as f64).collect()
        }
        Sampling::Trace(points) => {
            let step = duration / (points.max(2) - 1) as f64;
            (0..points).map(|k| (step * k as f64).min(duration)).collect()
        }
    };
    let mut sampler = Sampler::new(problem, request, runs);
    for block in times.chunks(BLOCK) {
        budget.check()?;
        sampler.block(block);
    }
    let mut setpoints = sampler.setpoints;
    setpoints.samples.time = times;
    Ok(Some(setpoints))
}

struct Sampler<'a> {
    problem: &'a Problem,
    runs: &'a [TimedRun],
    start: &'a [f64],
    /// Where the arm stands after each stroke.
    rests: Vec<Vec<f64>>,
    sweep: Sweep,
    /// Which way the joints move, laid out as the sweep's columns are.
    directions: Vec<f64>,
    state: State,
    setpoints: PathSetpoints,
}

impl<'a> Sampler<'a> {
    fn new(problem: &'a Problem, request: &'a PathRequest, runs: &'a [TimedRun]) -> Self {
        let count = problem.robot.joint_count();
        Self {
            problem,
            runs,
            start: &request.start,
            rests: runs.iter().map(|run| run.rest(request)).collect(),
            sweep: Sweep::default(),
            directions: Vec::new(),
            state: State::new(count),
            setpoints: PathSetpoints {
                samples: Setpoints {
                    time: Vec::new(),
                    joints: vec![JointColumns::default(); count],
                },
                locations: Vec::new(),
                tool_speed: Vec::new(),
                jerk: Vec::new(),
            },
        }
    }

    fn block(&mut self, times: &[f64]) {
        let count = self.problem.robot.joint_count();
        self.sweep.reset(count, times.len());
        self.directions.resize(self.sweep.column(count), 0.0);
        for (sample, time) in times.iter().enumerate() {
            let location = self.set(*time);
            let state = &self.state;
            let tool = kinematics::tool_motion(
                &self.problem.robot,
                &state.position,
                &state.velocity,
                &state.acceleration,
                &self.problem.tcp,
            );
            self.setpoints.tool_speed.push(tool.velocity.norm());
            self.setpoints.locations.push(location);
            self.setpoints.jerk.extend_from_slice(&state.jerk);
            for joint in 0..count {
                let entry = self.sweep.column(joint) + sample;
                self.sweep.position[entry] = state.position[joint];
                self.sweep.velocity[entry] = state.velocity[joint];
                self.sweep.acceleration[entry] = state.acceleration[joint];
                self.directions[entry] = state.direction[joint];
            }
        }
        self.sweep.compute(self.problem.robot.chain());
        for (joint, columns) in self.setpoints.samples.joints.iter_mut().enumerate() {
            let drive = &self.problem.robot.drives()[joint];
            let column = self.sweep.column(joint);
            for entry in column..column + times.len() {
                let (velocity, acceleration) = (self.sweep.velocity[entry], self.sweep.acceleration[entry]);
                columns.position.push(self.sweep.position[entry]);
                columns.velocity.push(velocity);
                columns.acceleration.push(acceleration);
                let friction = drive.friction_towards(velocity, self.directions[entry], self.sweep.gravity[entry]);
                let drives = drive.armature * acceleration + friction;
                columns.torque.push(self.sweep.torque[entry] + drives);
            }
        }
    }

    /// Sets the state at a time, and says where it is. A time or a place that a rounding separates from a stop is the
    /// stop's.
    fn set(&mut self, time: f64) -> Location {
        let slack = SAMPLE_AT_STOP * self.runs.last().map_or(0.0, TimedRun::end);
        let after = self.runs.partition_point(|run| run.begin <= time + slack);
        let Some((run, rest)) = after
            .checked_sub(1)
            .map(|index| (&self.runs[index], &self.rests[index]))
        else {
            self.state.rest_at(self.start);
            return Location::default();
        };
        let last = after == self.runs.len();
        // a path that ends at speed is sampled to its very end
        if time + slack < run.end() || (last && !run.ends_at_rest) {
            let since = (time - run.begin).clamp(0.0, run.law.duration());
            self.state.set(run.run.as_ref(), &run.law, since, Side::After);
            let s = self.state.s;
            if run.ends_at_rest && s > 0.0 && s >= run.run.length() {
                self.set(run.end());
            }
            return run.run.location(s);
        }
        self.state.rest_at(rest);
        run.run.location(run.run.length())
    }
}
