//! Why a program has no path: the request is wrong, nobody waits any more, or it cannot be run.

use super::outcome::{Location, PathInfeasible, PathInfeasibleReason};
use crate::budget::Stopped;
use crate::error::Invalid;
use crate::plan::Failure;

/// What ends the making of a path.
#[derive(Debug)]
pub(super) enum Fault {
    Failure(Failure),
    Infeasible(Box<PathInfeasible>),
}

impl From<Stopped> for Fault {
    fn from(stopped: Stopped) -> Self {
        Self::Failure(stopped.into())
    }
}

impl From<Failure> for Fault {
    fn from(failure: Failure) -> Self {
        Self::Failure(failure)
    }
}

impl From<PathInfeasible> for Fault {
    fn from(infeasible: PathInfeasible) -> Self {
        Self::Infeasible(Box::new(infeasible))
    }
}

impl Fault {
    pub(super) fn invalid(path: String, message: impl Into<String>) -> Self {
        Self::Failure(Failure::Invalid(vec![Invalid::new(path, message)]))
    }
}

/// Evidence without a joint to blame.
pub(super) fn infeasible(reason: PathInfeasibleReason, location: Location, suggestion: String) -> PathInfeasible {
    PathInfeasible {
        reason,
        location,
        joint: None,
        needed: 0.0,
        available: 0.0,
        gravity_torque: 0.0,
        feasible_payload: None,
        reachable_fraction: None,
        suggestion,
    }
}
