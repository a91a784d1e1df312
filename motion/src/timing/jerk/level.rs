//! One grid: its spline, its samples and their rows.
//!
//! Samples are the inner nodes (on a knot of the path or a border of the limits, one on each side) and the middles of
//! the inner intervals: at nodes alone, c could zigzag around limits of acceleration and torque in between. What bounds
//! the first and last interval, where the law of constant jerk holds, is linear in powers of its one number a₁: eight
//! samples of each bound a₁ from above.
//!
//! Where the motion moves at an end ([`super::ends`]), ṡ and s̈ are given there: what bounds them alone is looked at once, and
//! the sample has rows of jerk only.

use super::basis::Basis;
use super::certificate::{Certificate, inside};
use super::ends::{End, Moving, bridge, hump};
use super::fold::Sample;
use super::interior::Problem;
use super::profile::Profile;
use super::rest;
use super::rows::{Counts, Rows, Tightening};
use crate::budget::{Budget, Stopped};
use crate::curve::Side;
use crate::scalar::LANES_MAX;
use crate::timing::coefficients::Coefficients;
use crate::timing::grid::Place;
use crate::timing::limits::{JointLimits, Limits};
use crate::timing::{Obstacle, Task, standstill};
use crate::tolerance::{JERK_HUMPS, JERK_START_FLOOR, TIMING_RESERVE};

/// Samples of each end interval.
const END_SAMPLES: usize = LANES_MAX;

/// A grid with its problem.
#[derive(Debug)]
pub(crate) struct Level {
    basis: Basis,
    pub(crate) problem: Problem,
    /// Interval and part of it of each sample of the problem.
    parts: Vec<(usize, f64)>,
    /// The sample of each node of the spline (of those with two, the one before it).
    node_samples: Vec<usize>,
    moving: Moving,
    /// ṡ² at ends that move: as asked for, or the most that limits of speed, acceleration and torque allow there.
    targets: [f64; 2],
}

/// Which joints have rows of each kind anywhere on the path.
struct Kinds {
    jerk: Vec<usize>,
    acceleration: Vec<usize>,
    torque: Vec<usize>,
    tool: bool,
}

impl Kinds {
    fn of(limits: &Limits, joint_count: usize) -> Self {
        let any = |bounds: fn(&JointLimits) -> Option<f64>| {
            (0..joint_count)
                .filter(|joint| {
                    limits
                        .stretches
                        .iter()
                        .any(|stretch| bounds(&stretch.joints[*joint]).is_some())
                })
                .collect()
        };
        Self {
            jerk: any(|joint| joint.jerk),
            acceleration: any(|joint| joint.acceleration),
            torque: any(|joint| joint.torque),
            tool: limits
                .stretches
                .iter()
                .any(|stretch| stretch.tool_acceleration.is_some()),
        }
    }

    fn counts(&self) -> Counts {
        Counts {
            jerk: self.jerk.len(),
            acceleration: self.acceleration.len(),
            torque: self.torque.len(),
            tool: self.tool,
        }
    }

    /// Writes the rows of a place as those of a sample.
    fn fill(&self, limits: &Limits, at: &Coefficients, place: usize, rows: &mut Rows, sample: usize) {
        self.fill_jerk(limits, at, place, rows, sample);
        self.fill_others(limits, at, place, rows, sample);
    }

    fn fill_jerk(&self, limits: &Limits, at: &Coefficients, place: usize, rows: &mut Rows, sample: usize) {
        let stretch = &limits.stretches[at.stretch[place]];
        let entry = |joint: usize| joint * at.stride + place;
        for (row, joint) in self.jerk.iter().enumerate() {
            let Some(limit) = stretch.joints[*joint].jerk else {
                continue;
            };
            let [q1, q2, q3] =
                [&at.terms.first, &at.terms.second, &at.third].map(|column| column[entry(*joint)] / limit);
            rows.jerk.set(sample, row, [q1, 3.0 * q2, q3]);
        }
    }

    fn fill_others(&self, limits: &Limits, at: &Coefficients, place: usize, rows: &mut Rows, sample: usize) {
        let stretch = &limits.stretches[at.stretch[place]];
        let entry = |joint: usize| joint * at.stride + place;
        for (row, joint) in self.acceleration.iter().enumerate() {
            let Some(limit) = stretch.joints[*joint].acceleration else {
                continue;
            };
            let values = [&at.terms.first, &at.terms.second].map(|column| column[entry(*joint)] / limit);
            rows.acceleration.set(sample, row, values);
        }
        for (row, joint) in self.torque.iter().enumerate() {
            let Some(limit) = stretch.joints[*joint].torque else {
                continue;
            };
            let k = entry(*joint);
            let [m, v, f] = [&at.terms.mass, &at.terms.velocity, &at.viscous].map(|column| column[k] / limit);
            let gravity = at.terms.gravity[k];
            let up = 1.0 - (gravity + at.coulomb_high[k]) / limit;
            let down = 1.0 + (gravity + at.coulomb_low[k]) / limit;
            rows.torque.set(sample, row, [m, v, f, up, down]);
        }
        if let Some(limit) = stretch.tool_acceleration {
            let (p1, p2) = (at.tool_first(place), at.tool_second(place));
            let dot = |x: [f64; 3], y: [f64; 3]| (x[0] * y[0] + x[1] * y[1] + x[2] * y[2]) / (limit * limit);
            rows.tool.set(sample, 0, [dot(p1, p1), dot(p1, p2), dot(p2, p2)]);
        }
        rows.speed.set(sample, 0, [1.0 / at.speed_bound[place]]);
    }

    /// How many times the speed may be at an end that moves without acceleration along the path, for all limits but jerk's.
    fn speed_at_end(&self, limits: &Limits, at: &Coefficients, place: usize, square: f64) -> f64 {
        let mut rows = Rows::new(1, self.counts());
        self.fill_others(limits, at, place, &mut rows, 0);
        let room = (1.0 - TIMING_RESERVE) * (1.0 - TIMING_RESERVE);
        rows.uniform_speed(0, [square, 0.0, 0.0], room, f64::INFINITY)
    }
}

impl Level {
    /// Over nodes; `fixed` places have a sample on each side, nodes or not.
    ///
    /// # Errors
    /// [`Stopped`], when nobody waits any more.
    pub(crate) fn new(
        task: &Task<'_>,
        nodes: Vec<f64>,
        fixed: &[f64],
        budget: &Budget<'_>,
    ) -> Result<Result<Self, Obstacle>, Stopped> {
        let moving = Moving::of(task.end_speeds);
        let basis = Basis::new(nodes, moving);
        let nodes = basis.nodes();
        let spline = basis.spline();
        let last = nodes.len() - 1;
        let mut places = Vec::with_capacity(2 * nodes.len() + fixed.len() + 2 * END_SAMPLES);
        let part = |k: usize| k as f64 / END_SAMPLES as f64;
        let before = |s| Place { s, side: Side::Before };
        let after = |s| Place { s, side: Side::After };
        if !moving.start {
            places.extend((1..=END_SAMPLES).map(|k| before(nodes[0] + part(k) * (nodes[1] - nodes[0]))));
        }
        let before_samples = places.len();
        let mut parts = Vec::with_capacity(places.capacity());
        let mut node_samples = Vec::with_capacity(last);
        for interval in spline.clone() {
            let (low, high) = (nodes[interval], nodes[interval + 1]);
            let is_fixed = fixed.binary_search_by(|s| s.total_cmp(&low)).is_ok();
            if interval == spline.start {
                node_samples.push(parts.len());
            }
            if interval == spline.start || is_fixed {
                places.push(after(low));
                parts.push((interval, 0.0));
            }
            // both sides of what was too close to another node to be one, too
            let close = inside(fixed, &[low, high]).iter().flat_map(|s| [before(*s), after(*s)]);
            let mut inner: Vec<Place> = close.chain([before(0.5 * (low + high))]).collect();
            inner.sort_by(|a, b| a.s.total_cmp(&b.s));
            for place in inner {
                parts.push((interval, (place.s - low) / (high - low)));
                places.push(place);
            }
            node_samples.push(parts.len());
            places.push(before(high));
            parts.push((interval, 1.0));
        }
        let end = nodes[last] - nodes[last - 1];
        if !moving.end {
            places.extend((1..=END_SAMPLES).rev().map(|k| after(nodes[last] - part(k) * end)));
        }
        let at = Coefficients::compute(task.robot, task.tcp, task.curve, task.limits, &places, budget)?;

        if let Some(obstacle) = standstill::obstacle(&at, task.limits) {
            return Ok(Err(obstacle));
        }
        let kinds = Kinds::of(task.limits, at.joint_count);
        let mut rows = Rows::new(parts.len().div_ceil(LANES_MAX), kinds.counts());
        let mut samples = Vec::with_capacity(parts.len());
        let final_sample = parts.len() - 1;
        for (sample, (interval, _)) in parts.iter().enumerate() {
            let place = before_samples + sample;
            if (moving.start && sample == 0) || (moving.end && sample == final_sample) {
                kinds.fill_jerk(task.limits, &at, place, &mut rows, sample);
            } else {
                kinds.fill(task.limits, &at, place, &mut rows, sample);
            }
            let s = places[place].s;
            let before = if sample == 0 { s } else { places[place - 1].s };
            let after = if sample + 1 == parts.len() {
                s
            } else {
                places[place + 1].s
            };
            samples.push(Sample {
                form: basis.form(*interval, s),
                weight: 0.5 * (after - before),
            });
        }
        let mut targets = [0.0; 2];
        let ends = [
            (0, 0, 1.0, moving.start),
            (final_sample, before_samples + parts.len(), -1.0, moving.end),
        ];
        for (side, (sample, first, direction, moves)) in ends.into_iter().enumerate() {
            if moves {
                let square = task.end_speeds[side] * task.end_speeds[side];
                let most = kinds.speed_at_end(task.limits, &at, before_samples + sample, square);
                targets[side] = square * (most * most).min(1.0);
                // what is given has no part in what is best; however slow, it must not hide the rest
                let neighbour = if direction > 0.0 { sample + 1 } else { sample - 1 };
                samples[neighbour].weight += samples[sample].weight;
                samples[sample].weight = 0.0;
                continue;
            }
            let h = if direction > 0.0 { nodes[1] - nodes[0] } else { end };
            let mut ends = Rows::new(1, kinds.counts());
            let mut most = f64::INFINITY;
            for k in 0..END_SAMPLES {
                kinds.fill(task.limits, &at, first + k, &mut ends, k);
                let x = if direction > 0.0 {
                    part(k + 1)
                } else {
                    part(END_SAMPLES - k)
                };
                let [sd, sdd, sddd] = rest::rates(h, direction, 1.0, x);
                most = ends.uniform_speed(k, [sd * sd, sdd, sddd / sd], 1.0, most);
            }
            samples[sample].weight += 3.0 * h;
            let [bound] = rows.speed.get(sample, 0);
            rows.speed.set(sample, 0, [bound.max(1.0 / (most * most))]);
        }
        let problem = Problem {
            unknown_count: basis.unknown_count(),
            samples,
            rows,
            ends: [End::Rest; 2],
        };
        Ok(Ok(Self {
            basis,
            problem,
            parts,
            node_samples,
            moving,
            targets,
        }))
    }

    /// Unknowns of a profile with these values, run at the part `target` of every limit, up to `most` times as fast.
    pub(crate) fn unknowns(&self, square: impl Fn(f64) -> f64, target: f64, most: f64) -> Vec<f64> {
        let mut x = self.sampled(square);
        self.run_at(&mut x, target, most);
        x
    }

    fn sampled(&self, square: impl Fn(f64) -> f64) -> Vec<f64> {
        let mut x: Vec<f64> = self.basis.centers().map(&square).collect();
        let floor = JERK_START_FLOOR * x.iter().copied().fold(0.0, f64::max);
        for x in &mut x {
            *x = x.max(floor);
        }
        let (nodes, last) = (self.nodes(), x.len() - 1);
        if self.moving.start {
            x[0] = square(nodes[0]);
        }
        if self.moving.end {
            x[last] = square(nodes[nodes.len() - 1]);
        }
        x
    }

    /// A first motion at the part `target` of every limit, from rest to rest or with the speeds at its ends, where that is
    /// possible, or else with slower ones.
    pub(crate) fn first(&self, target: f64) -> Vec<f64> {
        let length = self.basis.nodes()[self.basis.nodes().len() - 1];
        let hump = hump(self.moving);
        let humped = self.unknowns(|s| hump(s / length), target, f64::INFINITY);
        if self.moving == Moving::default() {
            return humped;
        }
        let bridge = bridge(self.targets, self.moving);
        let bridged = self.sampled(|s| bridge(s / length));
        // the highest hump that leaves the ends their speeds
        let mut part = 1.0;
        let mut best = (0.0, Vec::new());
        for _ in 0..JERK_HUMPS {
            let both = bridged.iter().zip(&humped);
            let x: Vec<f64> = both.map(|(bridged, humped)| bridged + part * humped).collect();
            let speed = self.speed(&x, target, 1.0);
            if speed > best.0 {
                best = (speed, x);
            }
            if speed >= 1.0 {
                break;
            }
            part *= 0.25;
        }
        let (_, mut x) = best;
        self.run_at(&mut x, target, 1.0);
        x
    }

    /// Makes ends that move to be raised.
    pub(crate) fn raise(&mut self) {
        let each = [self.moving.start, self.moving.end].into_iter().zip(self.targets);
        for (end, (moves, target)) in self.problem.ends.iter_mut().zip(each) {
            if moves {
                *end = End::Raised(target);
            }
        }
    }

    /// The end that lacks most of its speed, if any does: which, and what ṡ it has.
    pub(crate) fn short_end(&self, x: &[f64], speeds: [f64; 2]) -> Option<(usize, f64)> {
        let at = [x[0], x[x.len() - 1]];
        let mut short = None;
        let mut least = 1.0;
        for side in 0..2 {
            let held = self.problem.ends[side] != End::Rest;
            let part = at[side] / (speeds[side] * speeds[side]);
            if held && at[side] < speeds[side] * speeds[side] && part < least {
                (short, least) = (Some((side, at[side].sqrt())), part);
            }
        }
        short
    }

    /// Runs the motion evenly faster, up to `most` times, or slower, so that it uses the part `target` of a limit at
    /// the samples.
    pub(crate) fn run_at(&self, x: &mut [f64], target: f64, most: f64) {
        let speed = self.speed(x, target, most);
        for x in x {
            *x *= speed * speed;
        }
    }

    /// How many times as fast a motion may be run, up to `most`, to use the part `target` of a limit at the samples.
    fn speed(&self, x: &[f64], target: f64, most: f64) -> f64 {
        let mut speed = most;
        for (k, sample) in self.problem.samples.iter().enumerate() {
            speed = self.problem.rows.uniform_speed(k, sample.form.apply(x), target, speed);
        }
        speed
    }

    /// Lowers the limits at samples around which they are exceeded.
    pub(crate) fn tighten(&mut self, certificate: &Certificate<'_>) {
        for (sample, (interval, part)) in self.parts.iter().enumerate() {
            let by = certificate.tightening(*interval, *part);
            if by != Tightening::NONE {
                self.problem.rows.tighten(sample, &by);
            }
        }
    }

    pub(crate) fn nodes(&self) -> &[f64] {
        self.basis.nodes()
    }

    pub(crate) fn profile(&self, x: &[f64]) -> Profile<'_> {
        let samples = &self.problem.samples;
        let at_nodes = self.node_samples.iter();
        let mut inner: Vec<[f64; 3]> = at_nodes.map(|sample| samples[*sample].form.apply(x)).collect();
        // without the rounding of the spline
        let (nodes, unknowns) = (inner.len() - 1, x.len() - 1);
        if self.moving.start {
            inner[0] = [x[0], 0.0, inner[0][2]];
        }
        if self.moving.end {
            inner[nodes] = [x[unknowns], 0.0, inner[nodes][2]];
        }
        Profile {
            nodes: self.basis.nodes(),
            moving: self.moving,
            inner,
        }
    }
}
