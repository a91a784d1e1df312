//! One grid: its spline, its samples and their rows.
//!
//! Samples are the inner nodes (on a knot of the path or a border of the limits, one on each side) and the middles of
//! the inner intervals: at nodes alone, c could zigzag around limits of acceleration and torque in between. What bounds
//! the first and last interval, where the law of constant jerk holds, is linear in powers of its one number a₁: eight
//! samples of each bound a₁ from above.

use super::basis::Basis;
use super::certificate::{Certificate, inside};
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
use crate::tolerance::JERK_START_FLOOR;

/// Samples of each end interval.
const END_SAMPLES: usize = LANES_MAX;

/// A grid with its problem.
#[derive(Debug)]
pub(crate) struct Level {
    basis: Basis,
    pub(crate) problem: Problem,
    /// Interval and part of it of each sample of the problem.
    parts: Vec<(usize, f64)>,
    /// The sample of each inner node (of those with two, the one before it).
    node_samples: Vec<usize>,
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
        let basis = Basis::new(nodes);
        let nodes = basis.nodes();
        let last = nodes.len() - 1;
        let mut places = Vec::with_capacity(2 * nodes.len() + fixed.len() + 2 * END_SAMPLES);
        let part = |k: usize| k as f64 / END_SAMPLES as f64;
        let before = |s| Place { s, side: Side::Before };
        let after = |s| Place { s, side: Side::After };
        places.extend((1..=END_SAMPLES).map(|k| before(nodes[0] + part(k) * (nodes[1] - nodes[0]))));
        let mut parts = Vec::with_capacity(places.capacity());
        let mut node_samples = Vec::with_capacity(last);
        for interval in 1..last - 1 {
            let (low, high) = (nodes[interval], nodes[interval + 1]);
            let is_fixed = fixed.binary_search_by(|s| s.total_cmp(&low)).is_ok();
            if interval == 1 {
                node_samples.push(parts.len());
            }
            if interval == 1 || is_fixed {
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
        places.extend((1..=END_SAMPLES).rev().map(|k| after(nodes[last] - part(k) * end)));
        let at = Coefficients::compute(task.robot, task.tcp, task.curve, task.limits, &places, budget)?;

        if let Some(obstacle) = standstill::obstacle(&at, task.limits) {
            return Ok(Err(obstacle));
        }
        let kinds = Kinds::of(task.limits, at.joint_count);
        let mut rows = Rows::new(parts.len().div_ceil(LANES_MAX), kinds.counts());
        let mut samples = Vec::with_capacity(parts.len());
        for (sample, (interval, _)) in parts.iter().enumerate() {
            let place = END_SAMPLES + sample;
            kinds.fill(task.limits, &at, place, &mut rows, sample);
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
        let ends = [(0, 0, 1.0), (parts.len() - 1, END_SAMPLES + parts.len(), -1.0)];
        for (sample, first, direction) in ends {
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
        };
        Ok(Ok(Self {
            basis,
            problem,
            parts,
            node_samples,
        }))
    }

    /// Unknowns of a profile with these values, run at the part `target` of every limit.
    pub(crate) fn unknowns(&self, square: impl Fn(f64) -> f64, target: f64) -> Vec<f64> {
        let mut x: Vec<f64> = self.basis.centers().map(square).collect();
        let floor = JERK_START_FLOOR * x.iter().copied().fold(0.0, f64::max);
        for x in &mut x {
            *x = x.max(floor);
        }
        self.run_at(&mut x, target, f64::INFINITY);
        x
    }

    /// Runs the motion evenly faster, up to `most` times, or slower, so that it uses the part `target` of a limit at
    /// the samples.
    pub(crate) fn run_at(&self, x: &mut [f64], target: f64, most: f64) {
        let mut speed = most;
        for (k, sample) in self.problem.samples.iter().enumerate() {
            speed = self.problem.rows.uniform_speed(k, sample.form.apply(x), target, speed);
        }
        for x in x {
            *x *= speed * speed;
        }
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
        Profile {
            nodes: self.basis.nodes(),
            inner: self
                .node_samples
                .iter()
                .map(|sample| samples[*sample].form.apply(x))
                .collect(),
        }
    }
}
