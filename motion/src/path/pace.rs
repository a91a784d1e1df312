//! How fast a path passes at ṡ = 1: the largest part of its speed limit at which a joint moves.

use super::track::Joints;
use crate::budget::{Budget, Stopped};
use crate::jet::Jet;
use crate::tolerance::{BUDGET_STRIDE, GOLDEN_ROUNDS, PACE_SAMPLES, PIECE_SAMPLES, VALLEY_MAX};

/// Samples of a curve of so many polynomials.
pub(super) fn samples(pieces: usize) -> usize {
    PACE_SAMPLES.max(PIECE_SAMPLES * pieces)
}

/// ∫ max_j |q′_j|/V_j du: how long the curve takes where the joint that is nearest to its speed limit is just at it.
pub(super) fn normal_length(
    end: f64,
    speeds: &[f64],
    samples: usize,
    budget: &Budget<'_>,
    at: impl Fn(Jet, &mut Joints),
) -> Result<f64, Stopped> {
    let mut q = Joints::default();
    let mut sum = 0.0;
    for i in 0..samples {
        if i % BUDGET_STRIDE == 0 {
            budget.check()?;
        }
        let u = end * (i as f64 + 0.5) / samples as f64;
        at(Jet::variable(u, 1.0), &mut q);
        sum += pace(&q, speeds);
    }
    Ok(sum / samples as f64 * end)
}

/// max_j |q′_j|/V_j.
pub(super) fn pace(q: &Joints, speeds: &[f64]) -> f64 {
    q.iter()
        .zip(speeds)
        .map(|(q, speed)| q.0[1].abs() / speed)
        .fold(0.0, f64::max)
}

/// The slowest pace of a path and where it is: 0 where the path has a cusp or turns back on itself.
pub(super) fn slowest(
    length: f64,
    samples: usize,
    speeds: &[f64],
    budget: &Budget<'_>,
    at: impl Fn(f64, &mut Joints),
) -> Result<(f64, f64), Stopped> {
    let mut q = Joints::default();
    let mut pace_at = |s: f64| {
        at(s, &mut q);
        pace(&q, speeds)
    };
    let step = length / samples as f64;
    let mut paces = Vec::with_capacity(samples + 1);
    for i in 0..=samples {
        if i % BUDGET_STRIDE == 0 {
            budget.check()?;
        }
        paces.push(pace_at(step * i as f64));
    }
    let mut least = (f64::INFINITY, 0.0);
    for (i, pace) in paces.iter().enumerate() {
        if *pace < least.0 {
            least = (*pace, step * i as f64);
        }
    }
    for i in 1..samples {
        let valley = paces[i] <= paces[i - 1] && paces[i] <= paces[i + 1];
        if valley && paces[i] < VALLEY_MAX {
            budget.check()?;
            let (low, high) = (step * (i - 1) as f64, step * (i + 1) as f64);
            let valley = golden(&mut pace_at, low, high, GOLDEN_ROUNDS);
            if valley.0 < least.0 {
                least = valley;
            }
        }
    }
    Ok(least)
}

/// The least value of a function with one valley, and where, by golden section.
pub(super) fn golden(f: &mut impl FnMut(f64) -> f64, mut low: f64, mut high: f64, rounds: usize) -> (f64, f64) {
    let part = 0.5 * (5f64.sqrt() - 1.0);
    let (mut a, mut b) = (high - part * (high - low), low + part * (high - low));
    let (mut fa, mut fb) = (f(a), f(b));
    for _ in 0..rounds {
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
    if fa < fb { (fa, a) } else { (fb, b) }
}
