//! True extremes of the torques between samples, by successive parabolic interpolation (Brent 1973, chapter 5), kept
//! from ending early.

use super::{JointDemand, Peak, Point, Stretch, Verifier};
use crate::dynamics::chain::Chain;
use crate::dynamics::drive::DriveTerms;
use crate::dynamics::sweep::Sweep;
use crate::tolerance::{REFINE_GAIN, REFINE_ROUNDS};
use crate::trajectory::Trajectory;

/// Part of its limit from which on a peak is reported, whether or not it is the joint's largest.
const NEAR_LIMIT: f64 = 0.99;

/// Torques that are lower than a joint's largest by this part of its limit may turn out to be larger between samples.
const NEAR_TOP: f64 = 1.0e-3;

/// What is verified, against what.
pub(super) struct Context<'a> {
    pub(super) chain: &'a Chain,
    pub(super) drives: &'a [DriveTerms],
    pub(super) limits: &'a [Option<f64>],
    pub(super) motion: &'a Trajectory,
    /// Segment by segment, one a joint.
    pub(super) directions: &'a [f64],
}

/// Probes keep off the middle of a bracket by this part of its longer side.
const PROBE_OFF: f64 = 0.125;

/// Three moments around an extreme, within one segment, and the torques there times the sign that makes it a maximum.
#[derive(Debug, Clone, Copy)]
struct Bracket {
    joint: usize,
    segment: usize,
    sign: f64,
    /// Since the segment began, s.
    times: [f64; 3],
    values: [f64; 3],
    /// The parabola before this one promised to raise the extreme by next to nothing.
    settled: bool,
}

impl Bracket {
    /// Where the parabola through the three has its top, and how high; `None` where it has none between them.
    fn top(&self) -> Option<(f64, f64)> {
        let [t0, t1, t2] = self.times;
        let [y0, y1, y2] = self.values;
        let (left, right) = ((y1 - y0) / (t1 - t0), (y2 - y1) / (t2 - t1));
        let curvature = (right - left) / (t2 - t0);
        if curvature.is_nan() || curvature >= 0.0 {
            return None;
        }
        let time = 0.5 * (t0 + t1) - 0.5 * left / curvature;
        if !(time > t0 && time < t2) {
            return None;
        }
        let value = y0 + (time - t0) * (left + curvature * (time - t1));
        Some((time, value))
    }

    /// What is known of the extreme.
    fn middle(&self, motion: &Trajectory) -> Peak {
        Peak {
            joint: self.joint,
            time: motion.times()[self.segment] + self.times[1],
            segment: self.segment,
            torque: self.sign * self.values[1],
        }
    }

    /// Where to look next for an extreme that the parabola has at `top`: there, but not closer to the middle than a part
    /// of the longer side, and then on that side. So no side stays long, and the next parabola is a narrower one, also
    /// where this one happens to peak in the middle.
    fn probe(&self, top: f64) -> f64 {
        let [t0, t1, t2] = self.times;
        let (left, right) = (t1 - t0, t2 - t1);
        let off = PROBE_OFF * left.max(right);
        if (top - t1).abs() >= off {
            return top;
        }
        if left > right { t1 - off } else { t1 + off }
    }

    /// The bracket of other moments and values, in the order of time.
    fn through(&self, mut three: [(f64, f64); 3]) -> Self {
        if three[0].0 > three[2].0 {
            three.reverse();
        }
        Self {
            times: three.map(|(time, _)| time),
            values: three.map(|(_, value)| value),
            ..*self
        }
    }

    /// Closes in on a new moment between the outer two.
    fn narrow(&mut self, time: f64, value: f64) {
        let [_, t1, _] = self.times;
        let [_, y1, _] = self.values;
        let (keep, replaced) = match (time > t1, value >= y1) {
            (true, true) => (true, 0),
            (true, false) => (false, 2),
            (false, true) => (true, 2),
            (false, false) => (false, 0),
        };
        if keep {
            // the new moment is the middle, the old middle an end
            self.times[replaced] = t1;
            self.values[replaced] = y1;
            self.times[1] = time;
            self.values[1] = value;
        } else {
            self.times[replaced] = time;
            self.values[replaced] = value;
        }
    }
}

/// Finds the extremes between samples, and corrects the demands by them. Returns every one near or beyond a limit.
pub(super) fn find(
    context: &Context<'_>,
    verifier: &mut Verifier,
    stretches: &[Stretch],
    joints: &mut [JointDemand],
) -> Vec<Peak> {
    let mut brackets = brackets(context, verifier, stretches, joints);
    brackets.extend(end_brackets(context, verifier, stretches, joints));
    for bracket in &brackets {
        // that of an end is no sample
        raise(&mut joints[bracket.joint], &bracket.middle(context.motion));
    }
    let mut found: Vec<Peak> = Vec::new();
    for _ in 0..REFINE_ROUNDS {
        let tops: Vec<(Bracket, f64)> = brackets
            .iter()
            .filter_map(|bracket| {
                let (time, value) = bracket.top()?;
                let limit = context.limits[bracket.joint].unwrap_or(f64::INFINITY);
                let settled = value - bracket.values[1] <= REFINE_GAIN * limit.min(value.abs());
                let next = Bracket { settled, ..*bracket };
                (!(settled && bracket.settled)).then(|| (next, bracket.probe(time)))
            })
            .collect();
        if tops.is_empty() {
            break;
        }
        let moments: Vec<(usize, f64)> = tops.iter().map(|(b, time)| (b.segment, *time)).collect();
        context.compute_at(&mut verifier.refine, &moments);
        brackets.clear();
        for (index, (mut bracket, time)) in tops.into_iter().enumerate() {
            let torque = context.torque(&verifier.refine, index, bracket.segment, bracket.joint);
            let peak = Peak {
                joint: bracket.joint,
                time: context.motion.times()[bracket.segment] + time,
                segment: bracket.segment,
                torque,
            };
            raise(&mut joints[bracket.joint], &peak);
            let limit = context.limits[bracket.joint].unwrap_or(f64::INFINITY);
            if torque.abs() >= NEAR_LIMIT * limit {
                found.push(peak);
            }
            bracket.narrow(time, bracket.sign * torque);
            brackets.push(bracket);
        }
    }
    for (joint, demand) in joints.iter().enumerate() {
        let limit = context.limits[joint].unwrap_or(f64::INFINITY);
        if demand.peak_torque.abs() >= NEAR_LIMIT * limit {
            found.push(Peak {
                joint,
                time: demand.time,
                segment: demand.segment,
                torque: demand.peak_torque,
            });
        }
    }
    found
}

fn raise(demand: &mut JointDemand, peak: &Peak) {
    if peak.torque.abs() > demand.peak_torque.abs() {
        demand.peak_torque = peak.torque;
        demand.time = peak.time;
        demand.segment = peak.segment;
    }
}

/// The torque from which on a joint's may turn out to be its largest.
fn near_top(demand: &JointDemand, limit: Option<f64>) -> f64 {
    let top = demand.peak_torque.abs();
    top - NEAR_TOP * limit.unwrap_or(top)
}

/// The brackets whose parabola rises above what the joint reached on samples, or to where its limit is near.
fn brackets(context: &Context<'_>, verifier: &Verifier, stretches: &[Stretch], joints: &[JointDemand]) -> Vec<Bracket> {
    let mut brackets = Vec::new();
    for (joint, demand) in joints.iter().enumerate() {
        let column = verifier.sweep.column(joint);
        let limit = context.limits[joint].unwrap_or(f64::INFINITY);
        let worth = near_top(demand, context.limits[joint]).min(NEAR_LIMIT * limit);
        for stretch in stretches {
            let step = stretch.step();
            let samples = stretch.of(&verifier.torque[column..]);
            for middle in 1..stretch.intervals {
                let values = [samples[middle - 1], samples[middle], samples[middle + 1]];
                let top = values.iter().fold(0.0, |top: f64, v| top.max(v.abs()));
                // the parabola through equidistant values rises above them by at most an eighth of their bend
                let bend = (values[0] - 2.0 * values[1] + values[2]).abs();
                if top + bend < worth {
                    continue;
                }
                let sign = if values[1] + values[0] + values[2] >= 0.0 {
                    1.0
                } else {
                    -1.0
                };
                let bracket = Bracket {
                    joint,
                    segment: stretch.segment,
                    sign,
                    times: [middle - 1, middle, middle + 1].map(|k| stretch.local(k)),
                    values: values.map(|v| sign * v),
                    settled: false,
                };
                let Some((time, value)) = bracket.top() else {
                    continue;
                };
                // a top belongs to the bracket whose middle is nearest, with some overlap since neighbouring parabolas
                // differ, or to the bracket at an end of the segment
                let off = time - bracket.times[1];
                let at_end = middle == 1 && off < 0.0 || middle + 1 == stretch.intervals && off > 0.0;
                if value >= worth && (off.abs() <= 0.75 * step || at_end) {
                    brackets.push(bracket);
                }
            }
        }
    }
    brackets
}

/// Brackets at ends of segments where a torque is near its joint's largest.
///
/// There a torque may still rise for a moment before it falls, within so little of the first interval that the samples do
/// not show it; two probes close to the end do.
fn end_brackets(
    context: &Context<'_>,
    verifier: &mut Verifier,
    stretches: &[Stretch],
    joints: &[JointDemand],
) -> Vec<Bracket> {
    let mut ends: Vec<Bracket> = Vec::new();
    for (joint, demand) in joints.iter().enumerate() {
        let column = verifier.sweep.column(joint);
        let worth = near_top(demand, context.limits[joint]);
        for stretch in stretches {
            let step = stretch.step();
            for (at_end, next, time, inwards) in [
                (0, 1, stretch.from, step),
                (stretch.intervals, stretch.intervals - 1, stretch.to, -step),
            ] {
                let first = column + stretch.first;
                let (here, beyond) = (verifier.torque[first + at_end], verifier.torque[first + next]);
                if here.abs() < worth {
                    continue;
                }
                let sign = here.signum();
                ends.push(Bracket {
                    joint,
                    segment: stretch.segment,
                    sign,
                    times: [time, time + inwards / 16.0, time + inwards],
                    values: [sign * here, 0.0, sign * beyond],
                    settled: false,
                });
            }
        }
    }
    let moments: Vec<(usize, f64)> = ends
        .iter()
        .flat_map(|end| {
            [
                (end.segment, end.times[1]),
                (end.segment, end.times[0] + 4.0 * (end.times[1] - end.times[0])),
            ]
        })
        .collect();
    context.compute_at(&mut verifier.refine, &moments);
    let mut brackets = Vec::with_capacity(2 * ends.len());
    for (index, end) in ends.iter().enumerate() {
        let probe = |sample: usize| end.sign * context.torque(&verifier.refine, sample, end.segment, end.joint);
        let near = (moments[2 * index].1, probe(2 * index));
        let far = (moments[2 * index + 1].1, probe(2 * index + 1));
        let (outer, inner) = ((end.times[0], end.values[0]), (end.times[2], end.values[2]));
        for three in [[outer, near, far], [near, far, inner]] {
            brackets.push(end.through(three));
        }
    }
    brackets
}

impl Context<'_> {
    /// Computes rigid-body torques at moments given by segment and time since it began.
    pub(super) fn compute_at(&self, sweep: &mut Sweep, moments: &[(usize, f64)]) {
        sweep.reset(self.drives.len(), moments.len());
        for (sample, &(segment, local)) in moments.iter().enumerate() {
            sweep.set(sample, self.motion.segment(segment), local);
        }
        sweep.compute(self.chain);
    }

    /// The joints that move in a segment and whose friction depends on their load.
    pub(super) fn loaded(&self, segment: usize) -> impl Iterator<Item = usize> {
        let directions = &self.directions[segment * self.drives.len()..];
        let loaded = move |(joint, drive): (usize, &DriveTerms)| {
            (drive.load_coulomb != 0.0 && directions[joint] != 0.0).then_some(joint)
        };
        self.drives.iter().enumerate().filter_map(loaded)
    }

    /// Total torque of a joint at a sample of a sweep.
    pub(super) fn torque(&self, sweep: &Sweep, sample: usize, segment: usize, joint: usize) -> f64 {
        self.point(sweep, sample, segment, joint, 0.0).torque(1.0)
    }

    /// The torque of a joint at a sample of a sweep, split by how it scales with speed.
    pub(super) fn point(&self, sweep: &Sweep, sample: usize, segment: usize, joint: usize, time: f64) -> Point {
        let entry = sweep.column(joint) + sample;
        let drive = &self.drives[joint];
        let (gravity, velocity) = (sweep.gravity[entry], sweep.velocity[entry]);
        let direction = self.directions[segment * self.drives.len() + joint];
        Point {
            joint,
            time,
            segment,
            dynamic: sweep.torque[entry] - gravity + drive.armature * sweep.acceleration[entry] + drive.drag(velocity),
            viscous: drive.viscous * velocity,
            still: gravity + drive.coulomb(direction, gravity),
            gravity,
        }
    }

    /// The segment of a time, and the time since it began.
    pub(super) fn locate(&self, time: f64) -> (usize, f64) {
        let times = self.motion.times();
        let segment = times.partition_point(|t| *t <= time).clamp(1, times.len() - 1) - 1;
        (segment, time - times[segment])
    }

    /// The points of peaks.
    pub(super) fn points_at(&self, sweep: &mut Sweep, peaks: &[Peak]) -> Vec<Point> {
        let times = self.motion.times();
        let moments: Vec<(usize, f64)> = peaks
            .iter()
            .map(|peak| (peak.segment, peak.time - times[peak.segment]))
            .collect();
        self.compute_at(sweep, &moments);
        peaks
            .iter()
            .zip(&moments)
            .enumerate()
            .filter(|(_, (peak, _))| self.limits[peak.joint].is_some())
            .map(|(sample, (peak, (segment, _)))| self.point(sweep, sample, *segment, peak.joint, peak.time))
            .collect()
    }
}
