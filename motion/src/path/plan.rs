//! From a program to a verified, timed path, or to the evidence why there is none.

use super::answer;
use super::fault::infeasible;
use super::outcome::{Location, PathInfeasible, PathInfeasibleReason, PathLimit, PathOutcome};
use super::problem::Problem;
use super::request::{PathRequest, Shape, Space, Target, Timing};
use super::stroke::Stroke;
use super::verify::{Examined, Tightest, Timed, examine};
use super::{Program, build};
use crate::budget::Budget;
use crate::curve::{Curve, CurvePoint, Side};
use crate::error::Invalid;
use crate::plan::Failure;
use crate::plan::request::Sampling;
use crate::robot::Robot;
use crate::timing::law::TimeLaw;
use crate::timing::limits::Limits;
use crate::timing::{self, Obstacle, Task};
use crate::tolerance::{
    DURATION_MAX, PATH_SLOW_RESERVE, PATH_SLOW_ROUNDS, SETPOINTS_MAX, TIMING_INTERVALS, TRAVEL_MIN,
};

/// A stroke, timed and verified.
#[derive(Debug)]
pub(super) struct TimedStroke {
    pub(super) stroke: Stroke,
    pub(super) limits: Limits,
    pub(super) law: TimeLaw,
    pub(super) examined: Examined,
    /// When it begins, s.
    pub(super) begin: f64,
    /// Time at rest after it, s.
    pub(super) dwell: f64,
}

impl TimedStroke {
    /// When it ends, before the dwell.
    pub(super) fn end(&self) -> f64 {
        self.begin + self.law.duration()
    }

    /// Where the arm stands after it: the taught joints themselves, not what rounding makes of them.
    pub(super) fn rest(&self, request: &PathRequest) -> Vec<f64> {
        let last = self.stroke.spans().last();
        let target = last.and_then(|span| request.segments[span.segment].shape.target());
        if let Some(Target::Joints(joints)) = target {
            return joints.clone();
        }
        let mut point = CurvePoint::new(self.stroke.joint_count());
        self.stroke.evaluate(self.stroke.length(), Side::Before, &mut point);
        point.position
    }
}

/// Plans a robot program.
///
/// # Errors
/// A request that is wrong, or a budget that ended. A program that cannot be run is not an error: it is an outcome.
pub fn plan_path(robot: &Robot, request: &PathRequest, budget: &Budget<'_>) -> Result<PathOutcome, Failure> {
    let problem = Problem::new(robot, request)?;
    let program = match build(&problem.robot, &problem.tcp, request, budget)? {
        Ok(program) => program,
        Err(infeasible) => return Ok(PathOutcome::Infeasible(infeasible)),
    };
    if request.timing == Timing::ConstantSpeed {
        return Err(Failure::Invalid(vec![Invalid::new(
            "timing",
            "CONSTANT_SPEED is not planned by this version",
        )]));
    }
    let Program {
        strokes,
        initial_dwell,
        blends,
        tool_lengths,
        mut warnings,
        continuity,
    } = program;
    let cycle = match request.sampling {
        Sampling::Period(period) => Some(period),
        Sampling::None | Sampling::Trace(_) => None,
    };
    let initial_dwell = in_cycles(initial_dwell, cycle);
    let last = strokes.len().saturating_sub(1);
    let mut begin = initial_dwell;
    let mut timed = Vec::with_capacity(strokes.len());
    for (index, stroke) in strokes.into_iter().enumerate() {
        let start = request.start_speed.filter(|_| index == 0);
        let end = request.end_speed.filter(|_| index == last);
        let speeds =
            [(0.0, start), (stroke.length(), end)].map(|(s, speed)| rate(&problem, request, &stroke, s, speed));
        let stroke = match time(&problem, stroke, speeds, begin, cycle, budget)? {
            Ok(stroke) => stroke,
            Err(infeasible) => return Ok(PathOutcome::Infeasible(infeasible)),
        };
        begin = stroke.end() + stroke.dwell;
        timed.push(stroke);
    }
    check_duration(begin, cycle)?;
    warnings.splice(0..0, problem.warnings.iter().cloned());
    let answer = answer::Parts {
        problem: &problem,
        request,
        strokes: &timed,
        initial_dwell,
        duration: begin,
        blends,
        tool_lengths,
        warnings,
        continuity,
    };
    Ok(PathOutcome::Plan(Box::new(answer.assemble(budget)?)))
}

/// Path speed that gives the tool a speed, or the fastest joint where the path there is one of the joints.
fn rate(problem: &Problem, request: &PathRequest, stroke: &Stroke, s: f64, speed: Option<f64>) -> f64 {
    let Some(speed) = speed else { return 0.0 };
    let mut point = CurvePoint::new(problem.robot.joint_count());
    stroke.evaluate(s, Side::After, &mut point);
    let of_joints = match &request.segments[stroke.location(s).segment].shape {
        Shape::Joint { .. } => true,
        Shape::Spline(spline) => spline.space == Space::Joint,
        Shape::Line { .. } | Shape::Arc(_) => false,
    };
    let unit = if of_joints {
        point.first.iter().fold(0.0, |most: f64, rate| most.max(rate.abs()))
    } else {
        stroke.tool(&point).first.norm()
    };
    if unit > TRAVEL_MIN { speed / unit } else { 0.0 }
}

/// A time at rest as a whole number of cycles.
fn in_cycles(dwell: f64, cycle: Option<f64>) -> f64 {
    cycle.map_or(dwell, |cycle| (dwell / cycle).ceil() * cycle)
}

/// Times one stroke, and slows it down until the verifier finds every limit kept.
fn time(
    problem: &Problem,
    stroke: Stroke,
    speeds: [f64; 2],
    begin: f64,
    cycle: Option<f64>,
    budget: &Budget<'_>,
) -> Result<Result<TimedStroke, PathInfeasible>, Failure> {
    let limits = problem.limits(&stroke);
    let task = Task {
        robot: &problem.robot,
        tcp: &problem.tcp,
        curve: &stroke,
        limits: &limits,
        end_speeds: speeds,
        intervals: TIMING_INTERVALS,
    };
    let timing = if problem.limits_jerk(&stroke) {
        timing::jerk::jerk_limited(&task, budget)?
    } else {
        timing::optimal(&task, budget)?
    };
    let mut law = match timing {
        Ok(timing) => timing.law,
        Err(obstacle) => return Ok(Err(refusal(&stroke, &obstacle))),
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
            let dwell = in_cycles(stroke.dwell(), cycle);
            return Ok(Ok(TimedStroke {
                stroke,
                limits,
                law,
                examined,
                begin,
                dwell,
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
fn worst(examined: &Examined) -> Option<Tightest> {
    let broken = examined.tightest.iter().filter(|tightest| tightest.ratio > 1.0);
    broken.fold(None, |worst: Option<Tightest>, tightest| match worst {
        Some(worst) if worst.ratio >= tightest.ratio => Some(worst),
        _ => Some(*tightest),
    })
}

/// The part of the speed at which a broken limit holds; `None` where no speed helps.
fn slower(worst: &Tightest, examined: &Examined) -> Option<f64> {
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
fn broken(stroke: &Stroke, worst: &Tightest, examined: &Examined) -> PathInfeasible {
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
            PathInfeasibleReason::BoundarySpeed,
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
        ..infeasible(reason, stroke.location(worst.s), suggestion.to_owned())
    }
}

/// The evidence of the timing, at its place in the program.
fn refusal(stroke: &Stroke, obstacle: &Obstacle) -> PathInfeasible {
    let location: Location = stroke.location(obstacle.s);
    PathInfeasible {
        joint: obstacle.joint,
        needed: obstacle.needed,
        available: obstacle.available,
        gravity_torque: obstacle.gravity_torque,
        ..infeasible(obstacle.reason, location, suggestion(obstacle.reason).to_owned())
    }
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
