//! Programs at one constant tool speed: chains of lines and arcs, slowed down until the arm can follow.

use super::chain::{Chain, Course};
use super::check::check;
use super::fault::{Fault, infeasible};
use super::follow::Halt;
use super::outcome::{ConstantSpeedReport, Location, PathInfeasible, PathInfeasibleReason, PathLimit};
use super::plan::{Run, Runs, TimedRun, in_cycles, rest_after, slower, worst};
use super::problem::Problem;
use super::request::{Extent, OnExcess, PathRequest, Shape};
use super::shape::{Circle, ToolCurve};
use super::stroke::Span;
use super::taught::Teacher;
use super::verify::{Tightest, Timed, examine};
use crate::budget::Budget;
use crate::curve::Curve;
use crate::error::Invalid;
use crate::plan::Failure;
use crate::process::{ProcessRequest, ProcessSegment, constant_speed};
use crate::timing::law::TimeLaw;
use crate::tolerance::{CONSTANT_PARTS_MIN, CONSTANT_SLOW_ROUNDS, TIMING_INTERVALS};

/// Plans a program at constant speed.
pub(super) fn at_constant_speed(
    problem: &Problem,
    request: &PathRequest,
    cycle: Option<f64>,
    budget: &Budget<'_>,
) -> Result<Result<Runs, PathInfeasible>, Failure> {
    let mut wrong = check(&problem.robot, request);
    wrong.extend(check_constant(request));
    if !wrong.is_empty() {
        return Err(Failure::Invalid(wrong));
    }
    let mut planner = Planner {
        problem,
        request,
        cycle,
        teacher: Teacher::new(&problem.robot, &problem.tcp, request),
        runs: Runs {
            runs: Vec::new(),
            initial_dwell: 0.0,
            blends: Vec::new(),
            tool_lengths: vec![0.0; request.segments.len()],
            warnings: Vec::new(),
            continuity: 2,
            constant_speed: None,
        },
    };
    let mut first = 0;
    for (index, segment) in request.segments.iter().enumerate() {
        if segment.dwell == 0.0 && index + 1 < request.segments.len() {
            continue;
        }
        match planner.chain((first..=index).collect(), segment.dwell, budget) {
            Ok(()) => first = index + 1,
            Err(Fault::Infeasible(infeasible)) => return Ok(Err(*infeasible)),
            Err(Fault::Failure(failure)) => return Err(failure),
        }
    }
    Ok(Ok(planner.runs))
}

/// What constant speed asks of a program beyond its geometry.
fn check_constant(request: &PathRequest) -> Vec<Invalid> {
    let mut wrong = Vec::new();
    for (path, speed) in [("start_speed", request.start_speed), ("end_speed", request.end_speed)] {
        if speed.is_some() {
            wrong.push(Invalid::new(path, "a constant speed is from rest to rest"));
        }
    }
    let mut speed = None;
    for (index, segment) in request.segments.iter().enumerate() {
        if !matches!(segment.shape, Shape::Line { .. } | Shape::Arc(_)) {
            let message =
                "only lines and arcs run at constant speed; plan joint segments and splines with OPTIMAL timing";
            wrong.push(Invalid::new(format!("segments[{index}]"), message));
        }
        let path = format!("segments[{index}].tool_speed_m_per_s");
        match (speed, segment.tool_speed) {
            (None, None) => wrong.push(Invalid::new(path, "must be given at constant speed")),
            (Some(chain), Some(own)) if chain != own => {
                let message =
                    format!("{own} differs from {chain}: segments without a dwell between them have one speed");
                wrong.push(Invalid::new(path, message));
            }
            _ => {}
        }
        speed = speed.or(segment.tool_speed);
        // after a stop another speed may be given
        if segment.dwell > 0.0
            && let Some(next) = request.segments.get(index + 1).and_then(|next| next.tool_speed)
        {
            speed = Some(next);
        }
    }
    wrong
}

struct Planner<'a> {
    problem: &'a Problem,
    request: &'a PathRequest,
    cycle: Option<f64>,
    teacher: Teacher<'a>,
    runs: Runs,
}

/// The taught geometry of a chain.
struct Taught {
    segments: Vec<usize>,
    curves: Vec<ToolCurve>,
    geometry: Vec<ProcessSegment>,
    seam_reach: Vec<Option<f64>>,
    /// The joints at its start.
    start: Vec<f64>,
}

impl Planner<'_> {
    /// Plans one chain from rest to rest.
    fn chain(&mut self, segments: Vec<usize>, dwell: f64, budget: &Budget<'_>) -> Result<(), Fault> {
        let taught = self.taught(segments, budget)?;
        if taught.curves.is_empty() {
            let dwell = in_cycles(dwell, self.cycle);
            match self.runs.runs.last_mut() {
                Some(run) => run.dwell += dwell,
                None => self.runs.initial_dwell += dwell,
            }
            return Ok(());
        }
        let given = self.request.segments[..=taught.segments[0]].iter();
        let asked = given.rev().find_map(|segment| segment.tool_speed).unwrap_or(0.0) * self.request.speed_scale;
        let mut slow_down = 1.0;
        let mut lowered: Option<String> = None;
        for _ in 0..CONSTANT_SLOW_ROUNDS {
            let (run, mut report) = self.followed(&taught, asked, slow_down, budget)?;
            let law = even_law(&run);
            let begin = self.runs.duration();
            let limits = self.problem.limits(run.spans());
            let timed = Timed {
                curve: &run,
                law: &law,
                limits: &limits,
                begin,
            };
            let mut examined = examine(
                &self.problem.robot,
                &self.problem.tcp,
                timed,
                &self.problem.ranges(),
                budget,
            )?;
            let Some(broken) = worst(&examined) else {
                (report.asked, report.lowered) = (asked, join(lowered, report.lowered));
                // whatever comes closest, it is the speed asked for that makes the motion last
                for ruling in &mut examined.rulings {
                    (ruling.kind, ruling.joint) = (PathLimit::ConstantSpeed, None);
                }
                self.add_report(report, &taught, begin);
                self.teacher.q = run.end();
                let dwell = rest_after(begin + law.duration(), dwell, self.cycle);
                self.runs.runs.push(TimedRun {
                    run: Box::new(run),
                    law,
                    examined,
                    begin,
                    dwell,
                    ends_at_rest: true,
                });
                return Ok(());
            };
            let factor = slower(&broken, &examined).filter(|_| self.request.on_excess == OnExcess::SlowDown);
            let Some(factor) = factor else {
                return Err(self.refusal(&run, &broken, report.speed).into());
            };
            lowered = Some(format!("the arm cannot follow faster: {}", self.describe(&broken)));
            slow_down *= factor;
        }
        let at = Location {
            segment: taught.segments[0],
            fraction: 0.0,
        };
        let why =
            "no constant speed was found at which the arm can follow; relax the limits, or lower the speed".to_owned();
        Err(infeasible(PathInfeasibleReason::ConstantSpeed, at, why).into())
    }

    /// Reads the geometry of a chain; segments that go nowhere are left out. Leaves the teacher at its start.
    fn taught(&mut self, segments: Vec<usize>, budget: &Budget<'_>) -> Result<Taught, Fault> {
        let mut taught = Taught {
            segments: Vec::with_capacity(segments.len()),
            curves: Vec::with_capacity(segments.len()),
            geometry: Vec::with_capacity(segments.len()),
            seam_reach: Vec::new(),
            start: self.teacher.q.clone(),
        };
        for segment in segments {
            budget.check()?;
            let wanted = &self.request.segments[segment];
            let Some(curve) = self.teacher.curve(segment, &wanted.shape)? else {
                let message = format!("segment {segment} goes nowhere and is left out");
                self.runs.warnings.push(message);
                continue;
            };
            let Some(geometry) = geometry(&curve) else {
                continue;
            };
            let length = curve.uniform_length().unwrap_or(0.0);
            self.runs.tool_lengths[segment] = length;
            let reach = wanted.blend.map(|blend| match blend.extent {
                Extent::Radius(radius) => radius,
                Extent::Fraction(fraction) => fraction * length,
                Extent::Lengths { before, after } => before.min(after),
            });
            taught.seam_reach.push(reach);
            taught.geometry.push(geometry);
            self.teacher.stand_at(segment, &curve.pose(1.0))?;
            taught.curves.push(curve);
            taught.segments.push(segment);
        }
        self.teacher.q.clone_from(&taught.start);
        Ok(taught)
    }

    /// The chain at a speed, with the joints that follow it.
    fn followed(
        &self,
        taught: &Taught,
        speed: f64,
        slow_down: f64,
        budget: &Budget<'_>,
    ) -> Result<(Chain, ConstantSpeedReport), Fault> {
        let process = ProcessRequest {
            segments: &taught.geometry,
            speed,
            slow_down,
            transition_time: self.request.transition_time,
            tolerance: self.request.tolerance,
            seam_reach: &taught.seam_reach,
            acceleration: self.problem.tool_acceleration(&taught.segments),
            cycle_time: self.cycle,
            form: self.request.transition,
        };
        let (motion, report) = constant_speed(&process, budget).map_err(|failure| named(failure, taught))?;
        let course = Course {
            motion,
            curves: taught.curves.clone(),
            led: match (taught.segments.last(), taught.curves.last()) {
                (Some(segment), Some(curve)) => self.teacher.led_to(*segment, curve)?,
                _ => Vec::new(),
            },
            segments: taught.segments.clone(),
        };
        let places = course.clone();
        match Chain::new(&self.teacher.arm, course, &taught.start, budget)? {
            Ok(chain) => Ok((chain, report)),
            Err(halt) => {
                let location = places.location(halt.at);
                let index = taught.segments.iter().position(|segment| *segment == location.segment);
                let halt = Halt {
                    at: location.fraction,
                    ..halt
                };
                let curve = &taught.curves[index.unwrap_or(0)];
                Err(self.teacher.halted(location.segment, curve, halt).into())
            }
        }
    }

    fn add_report(&mut self, mut report: ConstantSpeedReport, taught: &Taught, begin: f64) {
        for transition in &mut report.transitions {
            transition.begin_time += begin;
            transition.end_time += begin;
            transition.segment = transition.segment.map(|segment| taught.segments[segment]);
        }
        self.runs.constant_speed = Some(match self.runs.constant_speed.take() {
            None => report,
            Some(mut known) => {
                known.transitions.append(&mut report.transitions);
                known.lowered = join(known.lowered, report.lowered);
                known.asked = known.asked.min(report.asked);
                known.speed = known.speed.min(report.speed);
                known.lowest = known.lowest.min(report.lowest);
                known
            }
        });
    }

    /// A broken limit in words.
    fn describe(&self, broken: &Tightest) -> String {
        let joint = broken
            .joint
            .map(|joint| self.problem.robot.spec().joints[joint].name.as_str());
        let whose = joint.map_or_else(|| "the tool".to_owned(), |joint| format!("joint \"{joint}\""));
        let what = broken.kind.name();
        format!(
            "{what} of {whose} would be {:.4}, the limit is {:.4}",
            broken.value, broken.limit
        )
    }

    fn refusal(&self, run: &Chain, broken: &Tightest, speed: f64) -> PathInfeasible {
        let what = self.describe(broken);
        let suggestion = format!("at {speed:.4} m/s {what}; give a lower tool speed, or on_excess SLOW_DOWN");
        PathInfeasible {
            joint: broken.joint,
            needed: broken.value,
            available: broken.limit,
            ..infeasible(PathInfeasibleReason::ConstantSpeed, run.location(broken.s), suggestion)
        }
    }
}

impl Run for Chain {
    fn spans(&self) -> &[Span] {
        Self::spans(self)
    }

    fn location(&self, s: f64) -> Location {
        Self::location(self, s)
    }
}

/// The geometry as constant speed takes it; splines have none.
fn geometry(curve: &ToolCurve) -> Option<ProcessSegment> {
    match curve {
        ToolCurve::Line { start, way, .. } => Some(ProcessSegment::Line {
            from: *start,
            to: start + way,
        }),
        ToolCurve::Arc { circle, .. } => {
            let Circle {
                center,
                radial,
                tangent,
                sweep,
            } = circle;
            Some(ProcessSegment::Arc {
                center: *center,
                normal: radial.cross(tangent),
                start: center + radial,
                angle: *sweep,
            })
        }
        ToolCurve::Spline(_) => None,
    }
}

/// Time as its own law, cut into intervals that the verifier samples.
fn even_law(run: &Chain) -> TimeLaw {
    let knots = run.knots();
    let whole = run.length();
    let mut nodes = vec![0.0];
    for ends in knots.windows(2) {
        let length = ends[1] - ends[0];
        let parts = (length / whole * TIMING_INTERVALS as f64).ceil() as usize;
        let parts = parts.max(CONSTANT_PARTS_MIN);
        nodes.extend((1..=parts).map(|part| ends[0] + length * part as f64 / parts as f64));
    }
    let ones = vec![1.0; nodes.len()];
    TimeLaw::linear(&nodes, &ones).unwrap_or_default()
}

/// The chain's findings, at their places in the request.
fn named(failure: Failure, taught: &Taught) -> Failure {
    let Failure::Invalid(findings) = failure else {
        return failure;
    };
    let first = taught.segments[0];
    let named = findings.into_iter().map(|finding| {
        let index = finding
            .path
            .strip_prefix("segments[")
            .and_then(|rest| rest.strip_suffix(']'))
            .and_then(|index| index.parse::<usize>().ok());
        let path = match (index, finding.path.as_str()) {
            (Some(index), _) => format!("segments[{}]", taught.segments[index]),
            (None, "speed") => format!("segments[{first}].tool_speed_m_per_s"),
            (None, "transition_time") => "transition_time_s".to_owned(),
            (None, "tolerance") => "tolerance_m".to_owned(),
            (None, "cycle_time") => "sample_period_s".to_owned(),
            (None, _) => format!("segments[{first}].blend"),
        };
        Invalid::new(path, finding.message)
    });
    Failure::Invalid(named.collect())
}

fn join(one: Option<String>, other: Option<String>) -> Option<String> {
    match (one, other) {
        (Some(one), Some(other)) => Some(format!("{one}; {other}")),
        (one, other) => one.or(other),
    }
}
