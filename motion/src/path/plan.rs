//! From a program to a verified, timed path, or to the evidence why there is none.

use std::fmt::Debug;

use super::answer;
use super::fault::infeasible;
use super::outcome::{
    BlendReport, ConstantSpeedReport, Location, PathInfeasible, PathInfeasibleReason, PathLimit, PathOutcome,
};
use super::problem::Problem;
use super::request::{PathRequest, Shape, Space, Target, Timing};
use super::stroke::{Span, Stroke};
use super::verify::{Examined, Tightest, Timed, examine};
use super::{build, constant};
use crate::budget::Budget;
use crate::curve::{Curve, CurvePoint, Side};
use crate::error::Invalid;
use crate::plan::Failure;
use crate::plan::feasible::{Rest, feasible_payload};
use crate::plan::request::Sampling;
use crate::robot::Robot;
use crate::timing::law::TimeLaw;
use crate::timing::{self, Obstacle, Task};
use crate::tolerance::{
    DURATION_MAX, LAW_CYCLE_ROUNDING, PATH_SLOW_RESERVE, PATH_SLOW_ROUNDS, SETPOINTS_MAX, TIMING_INTERVALS, TRAVEL_MIN,
};

/// A path without a stop within it, as the answer sees it.
pub(super) trait Run: Curve + Debug {
    /// Where its segments are, in order, without gaps.
    fn spans(&self) -> &[Span];

    /// Where on the request's segments a point is.
    fn location(&self, s: f64) -> Location;
}

/// A path, timed and verified.
#[derive(Debug)]
pub(super) struct TimedRun {
    pub(super) run: Box<dyn Run>,
    pub(super) law: TimeLaw,
    pub(super) examined: Examined,
    /// When it begins, s.
    pub(super) begin: f64,
    /// Time at rest after it, s.
    pub(super) dwell: f64,
    /// Whether the arm stands still where it ends.
    pub(super) ends_at_rest: bool,
}

/// Everything that runs, in time order, and what is said of it.
pub(super) struct Runs {
    pub(super) runs: Vec<TimedRun>,
    pub(super) initial_dwell: f64,
    pub(super) blends: Vec<BlendReport>,
    pub(super) tool_lengths: Vec<f64>,
    pub(super) warnings: Vec<String>,
    pub(super) continuity: u32,
    pub(super) constant_speed: Option<ConstantSpeedReport>,
}

impl Runs {
    /// When everything is over, s.
    pub(super) fn duration(&self) -> f64 {
        self.runs.last().map_or(self.initial_dwell, |run| run.end() + run.dwell)
    }
}

impl TimedRun {
    /// When it ends, before the dwell.
    pub(super) fn end(&self) -> f64 {
        self.begin + self.law.duration()
    }

    /// Where the arm stands after it: the taught joints themselves, not what rounding makes of them.
    pub(super) fn rest(&self, request: &PathRequest) -> Vec<f64> {
        let last = self.run.spans().last();
        let target = last.and_then(|span| request.segments[span.segment].shape.target());
        if let Some(Target::Joints(joints)) = target {
            return joints.clone();
        }
        let mut point = CurvePoint::new(self.run.joint_count());
        self.run.evaluate(self.run.length(), Side::Before, &mut point);
        point.position
    }
}

/// Plans a robot program.
///
/// # Errors
/// A request that is wrong, or a budget that ended. A program that cannot be run is not an error: it is an outcome.
pub fn plan_path(robot: &Robot, request: &PathRequest, budget: &Budget<'_>) -> Result<PathOutcome, Failure> {
    let problem = Problem::new(robot, request)?;
    let runs = match timed(&problem, request, budget)? {
        Ok(runs) => runs,
        Err(infeasible) => return Ok(PathOutcome::Infeasible(infeasible)),
    };
    let plan = answer::assemble(&problem, request, runs, budget)?;
    Ok(PathOutcome::Plan(Box::new(plan)))
}

/// Times and verifies a program.
pub(super) fn timed(
    problem: &Problem,
    request: &PathRequest,
    budget: &Budget<'_>,
) -> Result<Result<Runs, PathInfeasible>, Failure> {
    let cycle = match request.sampling {
        Sampling::Period(period) => Some(period),
        Sampling::None | Sampling::Trace(_) => None,
    };
    let runs = match request.timing {
        Timing::Optimal => fastest(problem, request, cycle, budget)?,
        Timing::ConstantSpeed => constant::at_constant_speed(problem, request, cycle, budget)?,
    };
    let mut runs = match runs {
        Ok(runs) => runs,
        Err(infeasible) => return Ok(Err(infeasible)),
    };
    check_duration(runs.duration(), cycle)?;
    runs.warnings.splice(0..0, problem.warnings.iter().cloned());
    Ok(Ok(runs))
}

/// Times every stroke of the program as fast as its limits allow.
fn fastest(
    problem: &Problem,
    request: &PathRequest,
    cycle: Option<f64>,
    budget: &Budget<'_>,
) -> Result<Result<Runs, PathInfeasible>, Failure> {
    let program = match build(&problem.robot, &problem.tcp, request, budget)? {
        Ok(program) => program,
        Err(infeasible) => return Ok(Err(infeasible)),
    };
    let mut runs = Runs {
        runs: Vec::with_capacity(program.strokes.len()),
        initial_dwell: in_cycles(program.initial_dwell, cycle),
        blends: program.blends,
        tool_lengths: program.tool_lengths,
        warnings: program.warnings,
        continuity: program.continuity,
        constant_speed: None,
    };
    let last = program.strokes.len().saturating_sub(1);
    for (index, stroke) in program.strokes.into_iter().enumerate() {
        let start = request.start_speed.filter(|_| index == 0);
        let end = request.end_speed.filter(|_| index == last);
        let ends = [(0.0, start), (stroke.length(), end)];
        let ends = ends.map(|(s, speed)| speed.map(|speed| EndSpeed::new(problem, request, &stroke, s, speed)));
        let run = match time(problem, stroke, ends, runs.duration(), cycle, budget)? {
            Ok(run) => run,
            Err(infeasible) => return Ok(Err(infeasible)),
        };
        runs.runs.push(run);
    }
    Ok(Ok(runs))
}

impl Run for Stroke {
    fn spans(&self) -> &[Span] {
        Self::spans(self)
    }

    fn location(&self, s: f64) -> Location {
        Self::location(self, s)
    }
}

/// A speed asked for at an end of a path.
#[derive(Debug, Clone, Copy)]
struct EndSpeed {
    /// ṡ.
    rate: f64,
    /// The speed asked for at ṡ = 1: of the tool, or of the fastest joint where the path there is one of the joints or turns
    /// the tool on the spot.
    unit: f64,
}

impl EndSpeed {
    fn new(problem: &Problem, request: &PathRequest, stroke: &Stroke, s: f64, speed: f64) -> Self {
        let mut point = CurvePoint::new(problem.robot.joint_count());
        stroke.evaluate(s, Side::After, &mut point);
        let of_joints = match &request.segments[stroke.location(s).segment].shape {
            Shape::Joint { .. } => true,
            Shape::Spline(spline) => spline.space == Space::Joint,
            Shape::Line { .. } | Shape::Arc(_) => false,
        };
        let tool = stroke.tool(&point).first.norm();
        let unit = if of_joints || tool <= TRAVEL_MIN {
            point.first.iter().fold(0.0, |most: f64, rate| most.max(rate.abs()))
        } else {
            tool
        };
        let rate = if unit > TRAVEL_MIN { speed / unit } else { 0.0 };
        Self { rate, unit }
    }
}

/// A time at rest as a whole number of cycles.
pub(super) fn in_cycles(dwell: f64, cycle: Option<f64>) -> f64 {
    cycle.map_or(dwell, |cycle| (dwell / cycle).ceil() * cycle)
}

/// How long the arm rests after a motion that ends at `end`: what is asked for, and to the end of a cycle.
pub(super) fn rest_after(end: f64, dwell: f64, cycle: Option<f64>) -> f64 {
    let Some(cycle) = cycle else { return dwell };
    let cycles = ((end + dwell) / cycle * (1.0 - LAW_CYCLE_ROUNDING)).ceil();
    let rest = cycles * cycle - end;
    if rest > LAW_CYCLE_ROUNDING * end { rest } else { 0.0 }
}

/// Times one stroke, and slows it down until the verifier finds every limit kept.
fn time(
    problem: &Problem,
    stroke: Stroke,
    ends: [Option<EndSpeed>; 2],
    begin: f64,
    cycle: Option<f64>,
    budget: &Budget<'_>,
) -> Result<Result<TimedRun, PathInfeasible>, Failure> {
    let limits = problem.limits(stroke.spans());
    let speeds = ends.map(|end| end.map_or(0.0, |end| end.rate));
    let task = Task {
        robot: &problem.robot,
        tcp: &problem.tcp,
        curve: &stroke,
        limits: &limits,
        end_speeds: speeds,
        intervals: TIMING_INTERVALS,
    };
    let timing = if problem.limits_jerk(stroke.spans()) {
        timing::jerk::jerk_limited(&task, budget)?
    } else {
        timing::optimal(&task, budget)?
    };
    let mut law = match timing {
        Ok(timing) => timing.law,
        Err(obstacle) => return Ok(Err(refusal(problem, &stroke, &obstacle, ends))),
    };
    if let Some(cycle) = cycle
        && speeds == [0.0; 2]
    {
        law = law.in_whole_cycles(cycle);
    }
    let ranges = problem.ranges();
    for _ in 0..PATH_SLOW_ROUNDS {
        let timed = Timed {
            curve: &stroke,
            law: &law,
            limits: &limits,
            begin,
        };
        let examined = examine(&problem.robot, &problem.tcp, timed, &ranges, budget)?;
        let Some(worst) = worst(&examined) else {
            let ends_at_rest = speeds[1] == 0.0;
            return Ok(Ok(TimedRun {
                dwell: if ends_at_rest {
                    rest_after(begin + law.duration(), stroke.dwell(), cycle)
                } else {
                    0.0
                },
                run: Box::new(stroke),
                law,
                examined,
                begin,
                ends_at_rest,
            }));
        };
        let factor = match slower(&worst, &examined) {
            Some(factor) if speeds == [0.0; 2] => factor,
            _ => return Ok(Err(broken(&stroke, &worst, &examined))),
        };
        law = law.slowed(factor);
        if let Some(cycle) = cycle {
            law = law.in_whole_cycles(cycle);
        }
    }
    let why = "no timing was found that keeps every limit".to_owned();
    Ok(Err(infeasible(
        PathInfeasibleReason::NoTiming,
        stroke.location(0.0),
        why,
    )))
}

/// The limit that is broken most, if any is.
pub(super) fn worst(examined: &Examined) -> Option<Tightest> {
    let broken = examined.tightest.iter().filter(|tightest| tightest.ratio > 1.0);
    broken.fold(None, |worst: Option<Tightest>, tightest| match worst {
        Some(worst) if worst.ratio >= tightest.ratio => Some(worst),
        _ => Some(*tightest),
    })
}

/// The part of the speed at which a broken limit holds; `None` where no speed helps.
pub(super) fn slower(worst: &Tightest, examined: &Examined) -> Option<f64> {
    let factor = match worst.kind {
        PathLimit::Velocity | PathLimit::ToolVelocity | PathLimit::ConstantSpeed => 1.0 / worst.ratio,
        PathLimit::Acceleration | PathLimit::ToolAcceleration => worst.ratio.sqrt().recip(),
        PathLimit::Jerk => libm::cbrt(worst.ratio).recip(),
        PathLimit::Torque => {
            let point = examined.torque?;
            let holds = |scale: f64| point.torque(scale).abs() <= worst.limit;
            if !holds(0.0) {
                return None;
            }
            let (mut low, mut high) = (0.0, 1.0);
            for _ in 0..PATH_SLOW_ROUNDS {
                let middle = 0.5 * (low + high);
                if holds(middle) {
                    low = middle;
                } else {
                    high = middle;
                }
            }
            low
        }
        PathLimit::PositionLower | PathLimit::PositionUpper | PathLimit::Rest => return None,
    };
    (factor > 0.0).then_some(factor * (1.0 - PATH_SLOW_RESERVE))
}

/// The evidence where a limit is broken and slowing down does not help.
pub(super) fn broken(run: &dyn Run, worst: &Tightest, examined: &Examined) -> PathInfeasible {
    let (reason, suggestion) = match worst.kind {
        PathLimit::PositionLower | PathLimit::PositionUpper => (
            PathInfeasibleReason::JointRange,
            "teach the points of this segment so that the joint stays within its range",
        ),
        PathLimit::Torque if examined.torque.is_some_and(|point| point.still.abs() > worst.limit) => (
            PathInfeasibleReason::MovingTorque,
            "a lighter payload, or a way on which gravity pulls less on this joint",
        ),
        _ => (
            PathInfeasibleReason::NoTiming,
            "a lower speed at the start or the end of the path",
        ),
    };
    PathInfeasible {
        joint: worst.joint,
        needed: worst.value,
        available: worst.limit,
        gravity_torque: examined
            .torque
            .filter(|point| Some(point.joint) == worst.joint && worst.kind == PathLimit::Torque)
            .map_or(0.0, |point| point.gravity),
        ..infeasible(reason, run.location(worst.s), suggestion.to_owned())
    }
}

/// The evidence of the timing, at its place in the program; a speed as it was asked for.
fn refusal(problem: &Problem, stroke: &Stroke, obstacle: &Obstacle, ends: [Option<EndSpeed>; 2]) -> PathInfeasible {
    let location: Location = stroke.location(obstacle.s);
    let end = ends[usize::from(obstacle.s > 0.0)];
    let unit = match obstacle.reason {
        PathInfeasibleReason::BoundarySpeed => end.map_or(1.0, |end| end.unit),
        _ => 1.0,
    };
    let payload = lighter(problem, stroke, obstacle);
    let ways = match payload {
        Some(mass) => format!(
            "carry at most {mass:.4} kg, or a higher torque utilization, or a way on which gravity pulls less on this joint"
        ),
        None => suggestion(obstacle.reason).to_owned(),
    };
    PathInfeasible {
        joint: obstacle.joint,
        needed: obstacle.needed * unit,
        available: obstacle.available * unit,
        gravity_torque: obstacle.gravity_torque,
        feasible_payload: payload,
        ..infeasible(obstacle.reason, location, ways)
    }
}

/// The payload that could be held, or moved slowly, where the path meets a torque limit even at rest.
fn lighter(problem: &Problem, stroke: &Stroke, obstacle: &Obstacle) -> Option<f64> {
    let direction = match obstacle.reason {
        PathInfeasibleReason::HoldingTorque => 0.0,
        PathInfeasibleReason::MovingTorque => obstacle.needed,
        _ => return None,
    };
    let joint = obstacle.joint?;
    let mut point = CurvePoint::new(problem.robot.joint_count());
    stroke.evaluate(obstacle.s, Side::Before, &mut point);
    let rest = Rest::of_joint(
        &problem.robot,
        joint,
        direction,
        obstacle.needed,
        obstacle.gravity_torque,
    );
    feasible_payload(&problem.robot, &point.position, joint, &rest, obstacle.available)
}

/// What would make a path feasible.
fn suggestion(reason: PathInfeasibleReason) -> &'static str {
    match reason {
        PathInfeasibleReason::HoldingTorque | PathInfeasibleReason::MovingTorque => {
            "a lighter payload, a higher torque utilization, or a way on which gravity pulls less on this joint"
        }
        PathInfeasibleReason::BoundarySpeed => "a lower speed at the start or the end of the path",
        _ => "looser limits, or a path without sharp bends",
    }
}

fn check_duration(duration: f64, cycle: Option<f64>) -> Result<(), Failure> {
    let failure = |path: &str, message: String| Err(Failure::Invalid(vec![Invalid::new(path, message)]));
    if duration > DURATION_MAX {
        let message = format!("the path takes {duration:.3e} s, the most is {DURATION_MAX} s: a limit is far too low");
        return failure("limits", message);
    }
    if let Some(cycle) = cycle
        && duration / cycle > SETPOINTS_MAX as f64
    {
        let count = duration / cycle;
        return failure(
            "sample_period_s",
            format!("{cycle} s makes {count:.0} set-points, the most is {SETPOINTS_MAX}"),
        );
    }
    Ok(())
}
