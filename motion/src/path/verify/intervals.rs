//! Where the verifier samples: intervals within which nothing jumps, halved until their samples show how the accelerations
//! of the joints vary.

use super::channels::fill;
use super::{BLOCK, Examiner, PARTS, Timed};
use crate::curve::Side;
use crate::tolerance::BREAKS_APART;

/// How far inside an interval its ends are sampled, as part of it.
const INSIDE: f64 = 1.0e-9;

/// An interval is halved where an acceleration bends from sample to sample by more than this part of its limit: a
/// parabola then still shows the extreme to a thousandth, from where it is followed.
const SPLIT_BEND: f64 = 0.02;

/// Smallest scale of a joint's acceleration without a limit, as part of the largest of all: below is rounding.
const SPLIT_FLOOR: f64 = 1.0e-3;

/// Most times an interval is halved, and most intervals of a block after it: they bound the work.
const SPLIT_ROUNDS: usize = 8;
const SPLIT_MOST: usize = 8 * BLOCK;

/// When something may jump: where pieces of the time law meet, knots of the path, and places from where other limits hold.
pub(super) fn breaks(timed: Timed<'_>) -> Vec<f64> {
    let mut breaks = timed.law.times().to_vec();
    let apart = BREAKS_APART * timed.law.duration();
    let borders = timed.limits.stretches.iter().map(|stretch| stretch.end);
    for s in timed.curve.knots().iter().copied().chain(borders) {
        let time = timed.law.time_at(s);
        let next = breaks.partition_point(|known| *known < time);
        let near = |index: usize| breaks.get(index).is_none_or(|known| (known - time).abs() <= apart);
        // beyond the ends there is nothing
        if next > 0 && !near(next) && !near(next - 1) {
            breaks.insert(next, time);
        }
    }
    breaks
}

impl Examiner<'_> {
    /// Samples some intervals, given by their ends, and halves of them where they are too long; returns the ends of those.
    pub(super) fn sample_finely(&mut self, breaks: &[f64]) -> Vec<f64> {
        let mut breaks = breaks.to_vec();
        self.sample(&breaks);
        for _ in 0..SPLIT_ROUNDS {
            if !self.halve(&mut breaks) {
                break;
            }
            self.sample(&breaks);
        }
        breaks
    }

    /// Halves the intervals whose samples are too few to show how an acceleration varies; false where none is.
    fn halve(&self, breaks: &mut Vec<f64>) -> bool {
        let largest = |values: &[f64]| values.iter().fold(0.0, |most: f64, a| most.max(a.abs()));
        let floor = SPLIT_FLOOR * largest(&self.sweep.acceleration);
        let scales: Vec<f64> = (0..self.robot.joint_count())
            .map(|joint| largest(self.accelerations(joint)).max(floor))
            .collect();
        let intervals = 0..breaks.len() - 1;
        let coarse: Vec<bool> = intervals.map(|interval| self.is_coarse(interval, &scales)).collect();
        if breaks.len() > SPLIT_MOST || coarse.iter().all(|coarse| !coarse) {
            return false;
        }
        let halves = breaks.windows(2).zip(&coarse).flat_map(|(ends, coarse)| {
            let middle = coarse.then_some(0.5 * (ends[0] + ends[1]));
            std::iter::once(ends[0]).chain(middle)
        });
        *breaks = halves.chain(breaks.last().copied()).collect();
        true
    }

    /// Whether some joint's acceleration bends between the samples of an interval by more than a part of its limit; of
    /// its scale here, where it has none.
    fn is_coarse(&self, interval: usize, scales: &[f64]) -> bool {
        let first = interval * (PARTS + 1);
        let stretches = &self.timed.limits.stretches;
        let stretch = &stretches[self
            .timed
            .limits
            .stretch_at(self.places[first + PARTS / 2], Side::After)];
        scales.iter().enumerate().any(|(joint, scale)| {
            let allowed = SPLIT_BEND * stretch.joints[joint].acceleration.unwrap_or(*scale);
            let samples = &self.accelerations(joint)[first..=first + PARTS];
            let mut bends = samples.windows(3).map(|three| three[2] - 2.0 * three[1] + three[0]);
            bends.any(|bend| bend.abs() > allowed)
        })
    }

    /// The sampled accelerations of a joint.
    fn accelerations(&self, joint: usize) -> &[f64] {
        let column = self.sweep.column(joint);
        &self.sweep.acceleration[column..column + self.times.len()]
    }

    /// Samples the states of some intervals.
    pub(super) fn sample(&mut self, breaks: &[f64]) {
        let count = self.robot.joint_count();
        let samples = (breaks.len() - 1) * (PARTS + 1);
        let bounds_tool = self.timed.limits.bound_the_tool();
        let channels = self.channels.count();
        self.sweep.reset(count, samples);
        self.directions.resize(self.sweep.column(count), 0.0);
        self.values.clear();
        self.values.resize(samples * channels, 0.0);
        self.places.clear();
        self.times.clear();
        for (interval, ends) in breaks.windows(2).enumerate() {
            for part in 0..=PARTS {
                let sample = interval * (PARTS + 1) + part;
                let (time, side) = self.moment(ends, part);
                self.state.set(self.timed.curve, self.timed.law, time, side);
                for joint in 0..count {
                    let entry = self.sweep.column(joint) + sample;
                    self.sweep.position[entry] = self.state.position[joint];
                    self.sweep.velocity[entry] = self.state.velocity[joint];
                    self.sweep.acceleration[entry] = self.state.acceleration[joint];
                    self.directions[entry] = self.state.direction[joint];
                }
                let tool = bounds_tool.then(|| self.tool());
                fill(
                    &self.state,
                    tool,
                    &mut self.values[sample * channels..(sample + 1) * channels],
                );
                self.places.push(self.state.s);
                self.times.push(time);
            }
        }
    }

    /// When an interval is sampled, and from which side: at both its ends from within, which at those of the whole motion
    /// is at the ends themselves.
    fn moment(&self, ends: &[f64], part: usize) -> (f64, Side) {
        let length = ends[1] - ends[0];
        match part {
            0 if ends[0] <= 0.0 => (0.0, Side::After),
            0 => (ends[0] + INSIDE * length, Side::After),
            PARTS if ends[1] >= self.timed.law.duration() => (ends[1], Side::Before),
            PARTS => (ends[1] - INSIDE * length, Side::Before),
            _ => (ends[0] + length * part as f64 / PARTS as f64, Side::After),
        }
    }
}
