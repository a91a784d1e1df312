//! Which way every joint moves at a set-point, just before and just after: Coulomb friction acts against that.
//!
//! A velocity says so itself. Where it is zero, the acceleration does: just after, a joint moves as it accelerates; just
//! before, if the others were moving and it came that way, against it. An arm that stands with all its joints moved
//! before as another acceleration had it, which its set-points do not tell: no torque of that moment is known.
//!
//! Where acceleration is zero as well, a joint stands, or sets out or arrives with a higher derivative. What it does, its
//! neighbours say, if there are enough of them to show every reversal ([`Density::Resolving`]); those plans have jerk
//! limits, and so no acceleration where an arm that stands sets out or arrives.

use super::samples::State;
use super::{Case, Density};
use crate::tolerance;

/// The way of one joint at a set-point; positive, negative, or 0 where it stands.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Way {
    /// Just before; `None`: what was then the set-point does not tell.
    pub(super) before: Option<f64>,
    /// Just after; `None`: it does not tell that either.
    pub(super) after: Option<f64>,
    /// Whether it may as well stand: it has neither velocity nor acceleration.
    pub(super) may_stand: bool,
}

/// Every joint's way at one set-point.
#[derive(Debug, Default)]
pub(super) struct Ways {
    pub(super) joints: Vec<Way>,
    /// Whether the arm stands: no joint has a velocity.
    pub(super) standing: bool,
}

impl Ways {
    /// The ways at one set-point; `sizes` are the largest accelerations of the joints.
    pub(super) fn set(&mut self, case: &Case<'_>, index: usize, state: &State, sizes: &[f64]) {
        let duration = case.plan.duration;
        let tells = |joint: usize| {
            let least = tolerance::WAY * sizes[joint].max((duration * duration).recip());
            state.qdd[joint].abs() > least
        };
        self.standing = state.qd.iter().all(|rate| *rate == 0.0);
        let resting = self.standing && !(0..state.qd.len()).any(tells);
        self.joints.clear();
        for (joint, (&velocity, &acceleration)) in state.qd.iter().zip(&state.qdd).enumerate() {
            let rates = &case.samples.joints()[joint].velocity;
            let last = index.checked_sub(1).map_or(0.0, |last| rates[last]);
            let next = rates.get(index + 1).copied().unwrap_or(0.0);
            let way = if velocity != 0.0 {
                Way::known(Some(velocity), velocity)
            } else if tells(joint) {
                let turns = !self.standing && last * acceleration < 0.0;
                Way::known(turns.then_some(-acceleration), acceleration)
            } else {
                let shown = resting && case.density == Density::Resolving;
                Way {
                    before: shown.then_some(last),
                    after: shown.then_some(next),
                    may_stand: true,
                }
            };
            self.joints.push(way);
        }
    }
}

impl Way {
    fn known(before: Option<f64>, after: f64) -> Self {
        Self {
            before,
            after: Some(after),
            may_stand: false,
        }
    }
}
