//! From a request to a verified plan, or to the reason why there is none.

mod check;
mod endpoint;
pub(crate) mod feasible;
mod limiting;
pub(crate) mod margin;
pub mod outcome;
mod preset;
pub(crate) mod problem;
pub mod request;
mod sample;
mod slow;
mod time_law;
mod verified;

use crate::budget::{Budget, Stopped};
use crate::error::Invalid;
use crate::robot::Robot;
use crate::tolerance::{DURATION_MAX, SETPOINTS_MAX, VERIFY_RESERVE};
use crate::trajectory;
use crate::verify::{Verification, Verifier};
pub use check::check_trajectory;
pub(crate) use check::read_trajectory;
use outcome::{Fallback, Infeasible, MoveOutcome, MovePlan, Pattern};
use problem::Problem;
use request::{Method, MoveRequest, Sampling};

/// Why there is no answer.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Failure {
    /// The request is wrong: every finding, with its path in the request.
    Invalid(Vec<Invalid>),
    /// Nobody waits for the answer any more.
    Stopped,
}

impl From<Stopped> for Failure {
    fn from(_: Stopped) -> Self {
        Self::Stopped
    }
}

impl Failure {
    pub(crate) fn invalid(path: &str, message: String) -> Self {
        Self::Invalid(vec![Invalid::new(path, message)])
    }
}

/// A verified plan on its way out: patterns, their proof, and where they came from.
struct Draft {
    patterns: Vec<Pattern>,
    verification: Verification,
    fallback: Fallback,
    raw_excess: f64,
    raw_duration: f64,
}

/// Plans a point-to-point move at rest at both ends.
///
/// # Errors
/// A request that is wrong, or a budget that ended. A move that cannot be is not an error: it is an outcome.
pub fn plan_move(robot: &Robot, request: &MoveRequest, budget: &Budget<'_>) -> Result<MoveOutcome, Failure> {
    let problem = Problem::new(robot, request)?;
    if let Some(infeasible) = feasible::check_holding(&problem) {
        return Ok(MoveOutcome::Infeasible(infeasible));
    }
    let preset_plan = preset::plan(&problem);
    let verifier = &mut Verifier::default();
    let mut draft = match draft(&problem, request.method, preset_plan.as_deref(), verifier, budget)? {
        Ok(draft) => draft,
        Err(infeasible) => return Ok(MoveOutcome::Infeasible(infeasible)),
    };
    if let Sampling::Period(period) = request.sampling
        && let Err(infeasible) = stretch(&problem, &mut draft, period, verifier, budget)?
    {
        return Ok(MoveOutcome::Infeasible(infeasible));
    }
    let duration = trajectory::duration(&draft.patterns);
    check_duration(duration)?;
    let cycle_time = request.cycle_time.unwrap_or(duration);
    if cycle_time < duration {
        let message = format!("{cycle_time} s is shorter than the move, which takes {duration} s");
        return Err(Failure::invalid("cycle_time_s", message));
    }
    let setpoints = sample::setpoints(&problem, &draft.patterns, &request.target, request.sampling, budget)?;
    Ok(MoveOutcome::Plan(Box::new(MovePlan {
        duration,
        preset_duration: preset_plan.as_deref().map(trajectory::duration),
        preset_derived: problem.presets.iter().flatten().any(|preset| preset.derived),
        method: request.method,
        fallback: draft.fallback,
        torque_margins: margin::of_move(&problem, &draft.patterns, &draft.verification, cycle_time),
        limiting: limiting::of_move(&problem, &draft.patterns, &draft.verification, request.method),
        raw_excess: draft.raw_excess,
        raw_duration: draft.raw_duration,
        override_safe: draft.verification.override_safe,
        setpoints,
        warnings: problem.warnings.clone(),
        torque_utilization: request.torque_utilization,
        speed_scale: request.speed_scale,
        cycle_time,
        payload: *problem.robot.payload(),
        patterns: draft.patterns,
    })))
}

/// Plans by the method asked for.
fn draft(
    problem: &Problem,
    method: Method,
    preset_plan: Option<&[Pattern]>,
    verifier: &mut Verifier,
    budget: &Budget<'_>,
) -> Result<Result<Draft, Infeasible>, Failure> {
    if !(0..problem.start.len()).any(|joint| problem.moves(joint)) {
        let patterns = vec![preset::still(); problem.start.len()];
        return Ok(Ok(Draft::holding(patterns, Verification::at_rest(problem.start.len()))));
    }
    if method == Method::Verified {
        return Ok(verified::plan(problem, verifier, budget)?
            .map(|(patterns, verification)| Draft::holding(patterns, verification)));
    }
    let Some(preset_plan) = preset_plan else {
        let message = "a joint that moves has neither a preset acceleration nor what it could be derived from; give the \
                       model preset_acceleration, or plan with the method VERIFIED";
        return Err(Failure::invalid("method", message.to_owned()));
    };
    check_duration(trajectory::duration(preset_plan))?;
    let candidates = if method == Method::Preset {
        vec![(Fallback::None, preset_plan.to_vec())]
    } else {
        match endpoint::plans(problem, preset_plan) {
            Ok(plans) => plans,
            Err(infeasible) => return Ok(Err(infeasible)),
        }
    };
    let mut best: Option<Result<Draft, Infeasible>> = None;
    for (fallback, raw) in candidates {
        let drafted = slowed_down(problem, fallback, &raw, verifier, budget)?;
        let better = match (&best, &drafted) {
            (Some(Ok(best)), Ok(new)) => new.duration() < best.duration(),
            (Some(Ok(_)), Err(_)) => false,
            (Some(Err(_)) | None, _) => true,
        };
        if better {
            best = Some(drafted);
        }
    }
    best.ok_or_else(|| Failure::invalid("method", "the method has no plan".to_owned()))
}

/// Verifies a raw plan, and slows it down until it holds.
fn slowed_down(
    problem: &Problem,
    fallback: Fallback,
    raw: &[Pattern],
    verifier: &mut Verifier,
    budget: &Budget<'_>,
) -> Result<Result<Draft, Infeasible>, Failure> {
    let raw_duration = trajectory::duration(raw);
    check_duration(raw_duration)?;
    let verification = slow::verify(problem, verifier, raw);
    let excess = verified::excess(&verification, &problem.torque_limits());
    Ok(
        match slow::until_it_holds(problem, verifier, raw, verification, budget)? {
            Ok((patterns, verification)) => Ok(Draft {
                patterns,
                verification,
                fallback,
                raw_excess: excess.max(0.0),
                raw_duration,
            }),
            Err(peak) => Err(feasible::never_slow_enough(problem, &peak, raw_duration)),
        },
    )
}

/// Stretches a plan to a whole number of periods. A slower plan is verified again, since slower need not be safer.
fn stretch(
    problem: &Problem,
    draft: &mut Draft,
    period: f64,
    verifier: &mut Verifier,
    budget: &Budget<'_>,
) -> Result<Result<(), Infeasible>, Failure> {
    loop {
        let duration = draft.duration();
        check_duration(duration)?;
        let periods = (duration / period).ceil();
        if periods >= SETPOINTS_MAX as f64 {
            let message =
                format!("{period} s makes {periods} set-points of a move of {duration} s, the most is {SETPOINTS_MAX}");
            return Err(Failure::invalid("sample_period_s", message));
        }
        let part = if periods > 0.0 {
            duration / (periods * period)
        } else {
            1.0
        };
        if part >= 1.0 {
            return Ok(Ok(()));
        }
        draft.patterns = draft
            .patterns
            .iter()
            .map(|pattern| slow::slowed(pattern, part))
            .collect();
        draft.verification = slow::verify(problem, verifier, &draft.patterns);
        if verified::excess(&draft.verification, &problem.torque_limits()) <= -VERIFY_RESERVE {
            return Ok(Ok(()));
        }
        let verification = draft.verification.clone();
        match slow::until_it_holds(problem, verifier, &draft.patterns, verification, budget)? {
            Ok((patterns, verification)) => {
                draft.patterns = patterns;
                draft.verification = verification;
            }
            Err(peak) => return Ok(Err(feasible::never_slow_enough(problem, &peak, duration))),
        }
    }
}

fn check_duration(duration: f64) -> Result<(), Failure> {
    if duration <= DURATION_MAX {
        return Ok(());
    }
    let message = format!(
        "the move would take {duration} s, the most is {DURATION_MAX} s: a speed, acceleration or torque limit is too small"
    );
    Err(Failure::invalid("limits", message))
}

impl Draft {
    /// A plan that held its limits as it was made.
    fn holding(patterns: Vec<Pattern>, verification: Verification) -> Self {
        let raw_duration = trajectory::duration(&patterns);
        Self {
            patterns,
            verification,
            fallback: Fallback::None,
            raw_excess: 0.0,
            raw_duration,
        }
    }

    fn duration(&self) -> f64 {
        trajectory::duration(&self.patterns)
    }
}

#[cfg(test)]
mod tests;
