//! Robot programs: joint moves, lines, arcs and splines, blended into paths q(s) that are smooth to the third derivative.

pub mod outcome;
pub mod request;
#[allow(dead_code, reason = "the path planner under construction")]
mod verify;

use crate::budget::Budget;
use crate::plan::Failure;
use crate::robot::Robot;
use outcome::PathOutcome;
use request::PathRequest;

/// Plans a robot program.
///
/// # Errors
/// A request that is wrong, or a budget that ended. A program that cannot be run is not an error: it is an outcome.
pub fn plan_path(_robot: &Robot, _request: &PathRequest, _budget: &Budget<'_>) -> Result<PathOutcome, Failure> {
    Err(Failure::Stopped)
}
