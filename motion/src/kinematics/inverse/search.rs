//! Solutions of any chain: Newton runs from many starts, the reference first.
//!
//! The starts are spread over the joint ranges by the additive recurrence xⱼ(k) = frac(k·√pⱼ), pⱼ the j-th prime (R. D.
//! Richtmyer, "The evaluation of definite integrals, and a quasi-Monte-Carlo method based on the properties of algebraic
//! numbers", 1951): no two runs differ, and no region is left out for long. The search ends when many starts in a row
//! brought nothing new, and at a cap of work in any case.

use super::gap::Gap;
use super::newton::Newton;
use super::ranges::{self, Range};
use super::screws::{Place, Screws};
use super::six::ClosedForm;
use crate::robot::JOINTS_MAX;
use crate::tolerance::{IK_PATIENCE, IK_POLISHED, IK_STARTS, IK_WORK};

/// The first 32 primes, one a joint.
const PRIMES: [f64; JOINTS_MAX] = [
    2.0, 3.0, 5.0, 7.0, 11.0, 13.0, 17.0, 19.0, 23.0, 29.0, 31.0, 37.0, 41.0, 43.0, 47.0, 53.0, 59.0, 61.0, 67.0, 71.0,
    73.0, 79.0, 83.0, 89.0, 97.0, 101.0, 103.0, 107.0, 109.0, 113.0, 127.0, 131.0,
];

/// What a search found.
#[derive(Debug)]
pub(super) struct Found {
    /// Distinct solutions, in the order found, each moved into its range where that is possible.
    pub(super) solutions: Vec<Vec<f64>>,
    /// Where the tool came closest, and what was missing there.
    pub(super) closest: (Vec<f64>, Gap),
}

/// The solution that one run from the reference leads to: moved into the ranges by whole turns, too, with `turns`,
/// otherwise by what the pose leaves free alone.
pub(super) fn from_reference(
    screws: &Screws,
    target: Place,
    ranges: &[Range],
    reference: &[f64],
    turns: bool,
) -> (Vec<f64>, Gap) {
    let mut newton = Newton::new(screws, target);
    let mut q = reference.to_vec();
    let run = newton.run(&mut q);
    if !run.gap.is_closed() {
        return (q, run.gap);
    }
    if turns {
        settle(&mut newton, ranges, &mut q, reference);
    } else {
        newton.attract(&mut q, reference);
        ranges::snap(ranges, &mut q);
        keep_within(&mut newton, ranges, &mut q, reference);
    }
    let gap = newton.gap(&q);
    (q, gap)
}

/// The solutions that a closed form's answers lead to. Those of an ideal arm are solutions but for rounding.
pub(super) fn from_candidates(
    screws: &Screws,
    closed_form: &ClosedForm,
    target: Place,
    ranges: &[Range],
    reference: &[f64],
) -> Vec<Vec<f64>> {
    let mut newton = Newton::new(screws, target);
    let mut solutions: Vec<Vec<f64>> = Vec::new();
    let mut add = |newton: &mut Newton<'_>, mut q: Vec<f64>, is_free: bool| {
        let is_polished = newton.gap(&q).squared(screws.size) <= IK_POLISHED * IK_POLISHED;
        if !is_polished && !newton.run(&mut q).gap.is_closed() {
            return;
        }
        if is_free {
            settle(newton, ranges, &mut q, reference);
        } else {
            ranges::fit(ranges, &mut q, reference);
        }
        if !is_known(ranges, &solutions, &q) {
            solutions.push(q);
        }
    };
    for candidate in closed_form.candidates(screws, &target, reference) {
        add(&mut newton, candidate.q.to_vec(), candidate.is_free);
    }
    if !closed_form.is_ideal {
        // near a singularity the ideal arm may lack a branch that the real one has
        add(&mut newton, reference.to_vec(), true);
    }
    solutions
}

/// The solutions that the starts lead to, until `patience` of them in a row brought nothing new; more of them where none
/// is within the ranges yet.
pub(super) fn everywhere(
    screws: &Screws,
    target: Place,
    ranges: &[Range],
    reference: &[f64],
    patience: usize,
) -> Found {
    let mut newton = Newton::new(screws, target);
    let mut solutions: Vec<Vec<f64>> = Vec::new();
    let mut closest: Option<(Vec<f64>, Gap)> = None;
    let (mut work, mut fruitless, mut is_any_within) = (0, 0, false);
    for start in 0..IK_STARTS {
        let patience = if is_any_within { patience } else { IK_PATIENCE };
        if fruitless > patience || work * screws.count() > IK_WORK {
            break;
        }
        let mut q = place(start, screws, ranges, reference);
        let run = newton.run(&mut q);
        work += run.work;
        fruitless += 1;
        if !run.gap.is_closed() {
            let before = closest.as_ref().map(|(_, gap)| gap.squared(screws.size));
            if before.is_none_or(|before| run.gap.squared(screws.size) < before) {
                ranges::unwind(ranges, &mut q, reference);
                closest = Some((q, run.gap));
            }
            continue;
        }
        work += settle(&mut newton, ranges, &mut q, reference);
        if !is_known(ranges, &solutions, &q) {
            fruitless = 0;
            is_any_within |= ranges::worst(ranges, &q).is_none();
            solutions.push(q);
        }
    }
    let closest = closest.unwrap_or_else(|| (reference.to_vec(), newton.gap(reference)));
    Found { solutions, closest }
}

fn is_known(ranges: &[Range], solutions: &[Vec<f64>], q: &[f64]) -> bool {
    solutions.iter().any(|known| ranges::is_same(ranges, known, q))
}

/// The k-th start; the reference is the first.
fn place(k: usize, screws: &Screws, ranges: &[Range], reference: &[f64]) -> Vec<f64> {
    if k == 0 {
        return reference.to_vec();
    }
    let fraction = |j: usize| {
        let x = k as f64 * libm::sqrt(PRIMES[j % JOINTS_MAX]);
        x - x.floor()
    };
    ranges
        .iter()
        .enumerate()
        .map(|(j, range)| range.at(fraction(j), screws.size))
        .collect()
}

/// Moves a solution nearest to the reference, as far as the pose leaves it free, and into the ranges; where that leads out
/// of them, and it was within, it stays where it was. Returns the work done.
fn settle(newton: &mut Newton<'_>, ranges: &[Range], q: &mut Vec<f64>, reference: &[f64]) -> usize {
    ranges::unwind(ranges, q, reference);
    let mut before = q.clone();
    let mut work = newton.attract(q, reference).work;
    ranges::fit(ranges, q, reference);
    work += keep_within(newton, ranges, q, reference);
    if ranges::worst(ranges, q).is_some() {
        ranges::fit(ranges, &mut before, reference);
        if ranges::worst(ranges, &before).is_none() {
            *q = before;
        }
    }
    work
}

/// Joints that would leave their ranges, and need not, are held at the end of them, one after the other, while the others
/// make up for that. Where this does not help, `q` stays as it is. Returns the work done.
fn keep_within(newton: &mut Newton<'_>, ranges: &[Range], q: &mut Vec<f64>, reference: &[f64]) -> usize {
    let mut work = 0;
    let mut kept = q.clone();
    for _ in 0..q.len() {
        let Some(joint) = ranges::worst(ranges, &kept) else {
            q.clone_from(&kept);
            break;
        };
        if !newton.is_free(&kept, joint) {
            break;
        }
        newton.held[joint] = true;
        kept[joint] = kept[joint].max(ranges[joint].lower).min(ranges[joint].upper);
        let run = newton.run(&mut kept);
        work += run.work;
        if !run.gap.is_closed() {
            break;
        }
        work += newton.attract(&mut kept, reference).work;
    }
    newton.held = [false; JOINTS_MAX];
    work
}
