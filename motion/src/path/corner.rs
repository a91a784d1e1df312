//! Two segments mixed over their overlap.
//!
//! ```text
//! q = q₁(L₁ − b + b·x) + w(x)·(q₂(c·x) − q₁(L₁ − b + b·x))
//! ```

use super::arm::Arm;
use super::passage::Passage;
use super::request::Weight;
use super::track::{Joints, Track, pace};
use super::weight::weight;
use crate::curve::Side;
use crate::jet::Jet;
use crate::tolerance::{GOLDEN_ROUNDS, PACE_SAMPLES};

/// A blend of two tracks.
#[derive(Debug)]
pub(super) struct Mix {
    passage: Passage,
    weight: Weight,
}

impl Mix {
    pub(super) fn in_joint_space(passage: Passage, weight: Weight) -> Self {
        Self { passage, weight }
    }

    pub(super) fn passage(&self) -> Passage {
        self.passage
    }

    /// Parameter of the first track where the blend begins.
    pub(super) fn first_begin(&self, first: &Track) -> f64 {
        first.length - self.passage.before
    }

    /// The parameters of both tracks, and the weight, at s from the blend's beginning.
    fn parts(&self, first: &Track, s: f64) -> (Jet, Jet, Jet) {
        let x = self.passage.at(s);
        (
            x * self.passage.before + self.first_begin(first),
            x * self.passage.after,
            x.compose(weight(self.weight, x.value())),
        )
    }

    /// The joints at s from the blend's beginning.
    pub(super) fn joints(&self, arm: &Arm, first: &Track, second: &Track, s: f64, side: Side, q: &mut Joints) {
        let (u1, u2, w) = self.parts(first, s);
        let mut other = Joints::default();
        first.joints(arm, u1, side, q);
        second.joints(arm, u2, side, &mut other);
        for (q, other) in q.iter_mut().zip(&other).take(arm.joint_count()) {
            *q = *q + w * (*other - *q);
        }
    }

    /// The slowest that the blend passes anywhere, as the largest part of a joint's full speed at ṡ = 1. It is 0 where
    /// the path turns back on itself.
    pub(super) fn slowest(&self, arm: &Arm, first: &Track, second: &Track, speeds: &[f64]) -> f64 {
        let length = self.passage.length();
        let mut q = Joints::default();
        let mut at = |s: f64| {
            self.joints(arm, first, second, s, Side::After, &mut q);
            pace(&q, speeds)
        };
        let step = length / PACE_SAMPLES as f64;
        let paces: Vec<f64> = (0..=PACE_SAMPLES).map(|i| at(step * i as f64)).collect();
        let mut slowest = paces.iter().copied().fold(f64::INFINITY, f64::min);
        for i in 1..PACE_SAMPLES {
            if paces[i] <= paces[i - 1] && paces[i] <= paces[i + 1] {
                slowest = slowest.min(golden(&mut at, step * (i - 1) as f64, step * (i + 1) as f64));
            }
        }
        slowest
    }
}

/// The least value of a function with one valley, by golden section.
fn golden(f: &mut impl FnMut(f64) -> f64, mut low: f64, mut high: f64) -> f64 {
    let part = 0.5 * (5f64.sqrt() - 1.0);
    let (mut a, mut b) = (high - part * (high - low), low + part * (high - low));
    let (mut fa, mut fb) = (f(a), f(b));
    for _ in 0..GOLDEN_ROUNDS {
        if fa < fb {
            high = b;
            (b, fb) = (a, fa);
            a = high - part * (high - low);
            fa = f(a);
        } else {
            low = a;
            (a, fa) = (b, fb);
            b = low + part * (high - low);
            fb = f(b);
        }
    }
    fa.min(fb)
}
