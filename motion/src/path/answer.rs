//! The parts of an answer: what the verification found, at its place in the program and in time.

use super::outcome::{
    BlendReport, LimitCost, LimitingStretch, Location, PathLimit, PathLimitUse, PathPlan, SegmentReport, Smoothness,
};
use super::plan::{Run, Runs, TimedRun};
use super::problem::Problem;
use super::request::{PathRequest, Timing};
use super::sample;
use crate::budget::Budget;
use crate::dynamics::{self, Workspace};
use crate::plan::Failure;
use crate::plan::margin;
use crate::plan::outcome::{OverrideSafety, Phase, TorqueMargin};
use crate::tolerance::{PATH_CRUISE, PATH_LOCATE_ROUNDS};
use crate::verify::{JointDemand, Verification};

/// Puts an answer together.
///
/// # Errors
/// A budget that ended.
pub(super) fn assemble(
    problem: &Problem,
    request: &PathRequest,
    runs: Runs,
    budget: &Budget<'_>,
) -> Result<PathPlan, Failure> {
    let duration = runs.duration();
    let setpoints = sample::setpoints(problem, request, &runs.runs, duration, budget)?;
    let parts = Parts {
        problem,
        request,
        runs: &runs.runs,
        initial_dwell: runs.initial_dwell,
        duration,
    };
    let limiting = parts.limiting();
    let limit_uses = parts.limit_uses();
    Ok(PathPlan {
        duration,
        continuity: runs.continuity,
        segments: parts.segments(&runs.tool_lengths),
        blends: parts.timed(runs.blends),
        torque_margins: parts.torque_margins(&limit_uses),
        limit_uses,
        limit_costs: costs(&limiting),
        limiting,
        constant_speed: runs.constant_speed,
        override_safe: parts.override_safe(),
        setpoints,
        smoothness: parts.smoothness(runs.continuity),
        warnings: runs.warnings,
        torque_utilization: request.torque_utilization,
        speed_scale: request.speed_scale,
        payload: *problem.robot.payload(),
    })
}

/// What an answer is made of.
struct Parts<'a> {
    problem: &'a Problem,
    request: &'a PathRequest,
    runs: &'a [TimedRun],
    initial_dwell: f64,
    duration: f64,
}

impl Parts<'_> {
    /// When each segment is run through. One that goes nowhere has the time at which the one before it ends.
    fn segments(&self, tool_lengths: &[f64]) -> Vec<SegmentReport> {
        let mut reports: Vec<Option<SegmentReport>> = vec![None; self.request.segments.len()];
        for timed in self.runs {
            for span in timed.run.spans() {
                reports[span.segment] = Some(SegmentReport {
                    begin: timed.begin + timed.law.time_at(span.begin),
                    end: timed.begin + timed.law.time_at(span.end),
                    tool_length: tool_lengths[span.segment],
                });
            }
        }
        let mut end = self.initial_dwell;
        let known = reports.into_iter().map(|report| {
            let report = report.unwrap_or(SegmentReport {
                begin: end,
                end,
                tool_length: 0.0,
            });
            end = report.end;
            report
        });
        known.collect()
    }

    /// With a limited jerk the squared path speed is a cubic spline: its second derivative, and so the jerk, is continuous.
    fn smoothness(&self, continuity: u32) -> Smoothness {
        let optimal = self.request.timing == Timing::Optimal;
        let limits_jerk = |run: &TimedRun| self.problem.limits_jerk(run.run.spans());
        let jerk_limited = optimal && self.runs.iter().all(limits_jerk);
        Smoothness {
            continuity: if jerk_limited || !optimal { 2 } else { 1 },
            jerk_is_continuous: jerk_limited && continuity >= 3,
            stops: self.runs.iter().flat_map(|run| [run.begin, run.end()]).collect(),
        }
    }

    /// Blends with their times.
    fn timed(&self, mut blends: Vec<BlendReport>) -> Vec<BlendReport> {
        for blend in &mut blends {
            let runs = |timed: &&TimedRun| timed.run.spans().iter().any(|span| span.segment == blend.segment);
            let Some(timed) = self.runs.iter().find(runs) else {
                continue;
            };
            let at = |location: Location| timed.begin + timed.law.time_at(place(timed.run.as_ref(), location));
            (blend.begin_time, blend.end_time) = (at(blend.begin), at(blend.end));
        }
        blends
    }

    /// The tightest moment of every joint's torque: where a segment has a limit of its own, perhaps not the largest one.
    fn torque_margins(&self, uses: &[PathLimitUse]) -> Vec<TorqueMargin> {
        let mut margins = self.largest_torques();
        for margin in &mut margins {
            let mut of_joint = uses.iter().filter(|used| used.joint == Some(margin.joint));
            let Some(used) = of_joint.find(|used| used.kind == PathLimit::Torque) else {
                continue;
            };
            if used.margin < margin.margin {
                margin.limit = used.limit;
                margin.peak_torque = used.value;
                margin.time = used.time;
                margin.margin = used.margin;
                margin.phase = self.phase(used.time);
            }
        }
        margins
    }

    fn largest_torques(&self) -> Vec<TorqueMargin> {
        let robot = &self.problem.robot;
        let count = robot.joint_count();
        let mut demands = vec![JointDemand::default(); count];
        let mut rests = vec![(0.0, self.request.start.clone())];
        for timed in self.runs {
            for (sum, demand) in demands.iter_mut().zip(&timed.examined.demands) {
                if demand.peak_torque.abs() > sum.peak_torque.abs() {
                    (sum.peak_torque, sum.time) = (demand.peak_torque, demand.time);
                }
                sum.torque_squared += demand.torque_squared;
                sum.peak_velocity = sum.peak_velocity.max(demand.peak_velocity);
                sum.peak_power = sum.peak_power.max(demand.peak_power);
            }
            let end = timed.rest(self.request);
            self.add_rest(&end, timed.dwell, &mut demands);
            rests.push((timed.end(), end));
        }
        self.add_rest(&self.request.start, self.initial_dwell, &mut demands);
        let verification = Verification {
            joints: demands,
            peaks: Vec::new(),
            override_safe: None,
            points: Vec::new(),
        };
        let rests: Vec<(f64, &[f64])> = rests.iter().map(|(time, rest)| (*time, rest.as_slice())).collect();
        margin::of_demands(
            robot,
            &self.problem.torque_limits(),
            &verification,
            self.duration,
            self.duration,
            &rests,
            |_, demand| self.phase(demand.time),
        )
    }

    /// Adds the torque that holds the arm at rest for a time.
    fn add_rest(&self, position: &[f64], time: f64, demands: &mut [JointDemand]) {
        if time <= 0.0 {
            return;
        }
        let robot = &self.problem.robot;
        let mut torque = vec![0.0; position.len()];
        dynamics::gravity_torque(robot, &mut Workspace::new(robot), position, &mut torque);
        for (demand, torque) in demands.iter_mut().zip(torque) {
            demand.torque_squared += torque * torque * time;
        }
    }

    /// Whether the path is gaining speed at a time.
    fn phase(&self, time: f64) -> Phase {
        let after = self.runs.partition_point(|timed| timed.begin <= time);
        let Some(timed) = after.checked_sub(1).map(|index| &self.runs[index]) else {
            return Phase::Hold;
        };
        if time > timed.end() {
            return Phase::Hold;
        }
        let at = timed.law.at(time - timed.begin);
        let change = at.acceleration * timed.law.duration();
        if change.abs() <= PATH_CRUISE * at.velocity {
            return Phase::Cruise;
        }
        if change > 0.0 {
            Phase::Acceleration
        } else {
            Phase::Deceleration
        }
    }

    /// The tightest moment of every limit, tightest first.
    fn limit_uses(&self) -> Vec<PathLimitUse> {
        let mut uses: Vec<PathLimitUse> = Vec::new();
        for timed in self.runs {
            for tightest in &timed.examined.tightest {
                let found = PathLimitUse {
                    kind: tightest.kind,
                    joint: tightest.joint,
                    value: tightest.value,
                    limit: tightest.limit,
                    margin: 1.0 - tightest.ratio,
                    time: tightest.time,
                    location: timed.run.location(tightest.s),
                };
                let known = uses
                    .iter_mut()
                    .find(|known| (known.kind, known.joint) == (found.kind, found.joint));
                match known {
                    Some(known) if known.margin <= found.margin => {}
                    Some(known) => *known = found,
                    None => uses.push(found),
                }
            }
        }
        uses.sort_by(|a, b| a.margin.total_cmp(&b.margin));
        uses
    }

    /// Which limit holds the path when: in time order, without gaps.
    fn limiting(&self) -> Vec<LimitingStretch> {
        let mut stretches: Vec<LimitingStretch> = Vec::new();
        let mut add = |stretch: LimitingStretch| match stretches.last_mut() {
            Some(last) if (last.kind, last.joint) == (stretch.kind, stretch.joint) => last.end = stretch.end,
            _ => stretches.push(stretch),
        };
        let rest = |begin: f64, end: f64, location: Location| LimitingStretch {
            begin,
            end,
            kind: PathLimit::Rest,
            joint: None,
            location,
        };
        if self.initial_dwell > 0.0 {
            add(rest(0.0, self.initial_dwell, Location::default()));
        }
        for timed in self.runs {
            for ruling in &timed.examined.rulings {
                add(LimitingStretch {
                    begin: ruling.begin,
                    end: ruling.end,
                    kind: ruling.kind,
                    joint: ruling.joint,
                    location: timed.run.location(ruling.s),
                });
            }
            if timed.dwell > 0.0 {
                let end = timed.end();
                add(rest(end, end + timed.dwell, timed.run.location(timed.run.length())));
            }
        }
        stretches
    }

    fn override_safe(&self) -> Option<OverrideSafety> {
        let ratio = |safety: &OverrideSafety| safety.torque.abs() / safety.limit;
        let strokes = self.runs.iter();
        strokes
            .filter_map(|timed| timed.examined.override_safe)
            .fold(None, |worst: Option<OverrideSafety>, safety| match worst {
                Some(worst) if ratio(&worst) >= ratio(&safety) => Some(worst),
                _ => Some(safety),
            })
    }
}

/// Time spent at each limit, longest first.
fn costs(limiting: &[LimitingStretch]) -> Vec<LimitCost> {
    let mut costs: Vec<LimitCost> = Vec::new();
    for stretch in limiting {
        let time = stretch.end - stretch.begin;
        let known = costs
            .iter_mut()
            .find(|cost| (cost.kind, cost.joint) == (stretch.kind, stretch.joint));
        match known {
            Some(cost) => cost.time += time,
            None => costs.push(LimitCost {
                kind: stretch.kind,
                joint: stretch.joint,
                time,
            }),
        }
    }
    costs.sort_by(|a, b| b.time.total_cmp(&a.time));
    costs
}

/// The path position of a location, which grows with it, by bisection.
fn place(run: &dyn Run, location: Location) -> f64 {
    let before = |s: f64| {
        let at = run.location(s);
        (at.segment, at.fraction) < (location.segment, location.fraction)
    };
    let (mut low, mut high) = (0.0, run.length());
    for _ in 0..PATH_LOCATE_ROUNDS {
        let middle = 0.5 * (low + high);
        if before(middle) {
            low = middle;
        } else {
            high = middle;
        }
    }
    high
}
