//! Constant tool speed along chains of lines and arcs, from rest to rest: for welding, cutting, gluing.
//!
//! The taught path is run at one speed Vs; about every taught point a transition of 2·ta takes the tool from rest, from
//! one segment into the next, or to rest (JPH0743606B2, with its transitions at arcs made exact: `transition.rs`). Tool
//! space alone, base axes, SI units: the joints follow by inverse kinematics. `docs/constant-speed.md` tells the scheme
//! and what was measured.
//!
//! - [`generator`]: set-points cycle by cycle, without allocation and without sines.
//! - `geometry`: the taught segments. `transition`: the curves. `measure`: what they cost. `schedule`: how fast.
//!   `motion`: all of it as a function of time.

pub mod generator;
mod geometry;
mod measure;
mod motion;
mod schedule;
mod search;
mod transition;

#[cfg(test)]
mod tests;

pub use geometry::PathFrame;
pub(crate) use geometry::ProcessSegment;
pub(crate) use motion::ConstantSpeedMotion;

use crate::budget::{Budget, Stopped};
use crate::error::Invalid;
use crate::path::outcome::{ConstantSpeedReport, TransitionReport};
use crate::path::request::Transition;
use crate::plan::Failure;
use crate::tolerance::{
    CYCLE_TIME_MIN, DURATION_MAX, JUMP_ROUNDING, PROCESS_LENGTH_MIN, PROCESS_SPEED_MAX, SEAM_GAP_MAX,
    TRANSITION_TIME_MIN,
};

use geometry::Segment;
use measure::{deviation, slowest};
use schedule::{Schedule, nodes, schedule};

/// A chain to be run at constant speed.
#[derive(Debug, Clone)]
pub(crate) struct ProcessRequest<'a> {
    /// Each begins where the one before it ends.
    pub(crate) segments: &'a [ProcessSegment],
    /// Vs, m/s.
    pub(crate) speed: f64,
    /// ta, half of what a transition takes, s; `None`: chosen by acceleration.
    pub(crate) transition_time: Option<f64>,
    /// Farthest that a transition may be from the taught path, m: it shortens that transition.
    pub(crate) tolerance: Option<f64>,
    /// By seam: farthest that its transition may reach into its two segments, m; missing entries do not bound.
    pub(crate) seam_reach: &'a [Option<f64>],
    /// Largest acceleration of the tool, m/s²: it lowers Vs.
    pub(crate) acceleration: Option<f64>,
    /// Part of the speed found, in (0, 1], at which the same curve is run: for arms that cannot follow at all of it.
    /// Every acceleration falls with its square; a lower `speed` would have shorter transitions instead.
    pub(crate) slow_down: f64,
    /// Δt, s; `None`: nothing is made whole.
    pub(crate) cycle_time: Option<f64>,
    /// Form of the transitions at arcs.
    pub(crate) form: Transition,
}

/// Runs a chain at constant speed. The report's times and segments count from the chain's beginning.
///
/// # Errors
/// What is wrong with the chain, with paths `segments[i]`, `speed` …; or that nobody waits any more.
pub(crate) fn constant_speed(
    request: &ProcessRequest<'_>,
    budget: &Budget<'_>,
) -> Result<(ConstantSpeedMotion, ConstantSpeedReport), Failure> {
    let segments = check(request).map_err(Failure::Invalid)?;
    let schedule = schedule(request, &segments, budget)?;
    let motion = ConstantSpeedMotion::new(segments.clone(), &schedule, request.form);
    if motion.duration() > DURATION_MAX || motion.duration().is_nan() {
        let message = format!(
            "takes {} s at {} m/s; the longest plan is {DURATION_MAX} s",
            motion.duration(),
            schedule.speed
        );
        return Err(Failure::Invalid(vec![Invalid::new("speed", message)]));
    }
    let report = report(request, &segments, &schedule, &motion, budget)?;
    Ok((motion, report))
}

fn check(request: &ProcessRequest<'_>) -> Result<Vec<Segment>, Vec<Invalid>> {
    let mut wrong = Vec::new();
    let mut least = |path: &str, value: Option<f64>, least: f64, unit: &str| {
        if let Some(value) = value.filter(|value| !(*value >= least && value.is_finite())) {
            wrong.push(Invalid::new(
                path,
                format!("is {value} {unit}, must be finite and {least} {unit} or more"),
            ));
        }
    };
    least("speed", Some(request.speed), f64::MIN_POSITIVE, "m/s");
    least("transition_time", request.transition_time, TRANSITION_TIME_MIN, "s");
    least("tolerance", request.tolerance, PROCESS_LENGTH_MIN, "m");
    least("acceleration", request.acceleration, f64::MIN_POSITIVE, "m/s²");
    least("cycle_time", request.cycle_time, CYCLE_TIME_MIN, "s");
    for (seam, reach) in request.seam_reach.iter().enumerate() {
        least(&format!("seam_reach[{seam}]"), *reach, PROCESS_LENGTH_MIN, "m");
    }
    if request.speed > PROCESS_SPEED_MAX {
        let message = format!("is {} m/s, must be {PROCESS_SPEED_MAX} m/s or less", request.speed);
        wrong.push(Invalid::new("speed", message));
    }
    if !(request.slow_down > 0.0 && request.slow_down <= 1.0) {
        let message = format!("is {}, must be above 0 and 1 or less", request.slow_down);
        wrong.push(Invalid::new("slow_down", message));
    }
    if request.segments.is_empty() {
        wrong.push(Invalid::new("segments", "has no segment"));
    }
    let mut segments: Vec<Segment> = Vec::with_capacity(request.segments.len());
    for (index, taught) in request.segments.iter().enumerate() {
        let path = || format!("segments[{index}]");
        match Segment::new(taught) {
            Ok(segment) => segments.push(segment),
            Err(message) => {
                wrong.push(Invalid::new(path(), message));
                continue;
            }
        }
        // neighbours, unless one of them is refused already
        if let [.., before, here] = segments.as_slice()
            && segments.len() == index + 1
        {
            let gap = (here.frame(0.0).position - before.frame(before.length).position).norm();
            if gap > SEAM_GAP_MAX || gap.is_nan() {
                wrong.push(Invalid::new(
                    path(),
                    format!("begins {gap} m from where the one before it ends"),
                ));
            }
        }
    }
    if wrong.is_empty() { Ok(segments) } else { Err(wrong) }
}

fn report(
    request: &ProcessRequest<'_>,
    segments: &[Segment],
    schedule: &Schedule,
    motion: &ConstantSpeedMotion,
    budget: &Budget<'_>,
) -> Result<ConstantSpeedReport, Stopped> {
    let speed = schedule.speed;
    let mut transitions = Vec::with_capacity(schedule.reaches.len());
    let around = nodes(segments).into_iter().zip(&schedule.reaches).zip(motion.jumps());
    for (index, ((node, reach), [velocity, acceleration])) in around.enumerate() {
        budget.check()?;
        let [begin_time, end_time] = motion.transition_times(index);
        // what is left of rounding is no jump
        let jump = |jump: f64, scale: f64| if jump > JUMP_ROUNDING * scale { jump } else { 0.0 };
        transitions.push(TransitionReport {
            segment: index.checked_sub(1),
            begin_time,
            end_time,
            deviation: deviation(&node, request.form, *reach),
            velocity_jump: jump(velocity, speed),
            acceleration_jump: jump(acceleration, speed * speed / reach),
            lowest_speed: speed * slowest(&node, request.form, *reach),
        });
    }
    let seams = &transitions[1..segments.len()];
    Ok(ConstantSpeedReport {
        asked: request.speed,
        speed,
        lowered: (!schedule.lowered.is_empty()).then(|| schedule.lowered.join("; ")),
        lowest: seams.iter().map(|seam| seam.lowest_speed).fold(speed, f64::min),
        transitions,
    })
}
