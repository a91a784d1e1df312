//! The verifier: what a motion asks of every drive, everywhere along it.
//!
//! It takes a motion as polynomials of time, knows nothing of how it was planned, and goes its own way to the torque: from
//! positions, velocities and accelerations through [`crate::dynamics`], not through terms of a path. Between switching
//! times torques are smooth, but for the kinks of friction in proportion to a load that passes zero, where stretches end; they
//! are sampled more densely than they can swing, and every extreme between samples is found by successive parabolic
//! interpolation.

mod extreme;
pub(crate) mod kinks;
pub(crate) mod overrides;

use crate::dynamics::chain::Chain;
use crate::dynamics::drive::{DriveTerms, any_loaded};
use crate::dynamics::sweep::Sweep;
use crate::plan::outcome::OverrideSafety;
use crate::tolerance::{INTERVALS_MIN, KINK_FLOOR, SAMPLE_TRAVEL};
use crate::trajectory::{Trajectory, evaluate};
use kinks::Search;

/// What a motion asks of the drives.
#[derive(Debug, Clone)]
pub(crate) struct Verification {
    /// One a joint.
    pub(crate) joints: Vec<JointDemand>,
    /// Every local extreme near or beyond a limit, for whoever plans again.
    pub(crate) peaks: Vec<Peak>,
    /// What slower overrides do; `None` where no torque limit is known.
    pub(crate) override_safe: Option<OverrideSafety>,
    /// The torque at every sample, split by how it scales with speed.
    pub(crate) points: Vec<Point>,
}

/// What a motion asks of one drive.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct JointDemand {
    /// The torque of largest magnitude, signed.
    pub(crate) peak_torque: f64,
    /// When, s.
    pub(crate) time: f64,
    /// In which segment of the motion.
    pub(crate) segment: usize,
    /// ∫ τ² dt over the motion.
    pub(crate) torque_squared: f64,
    /// Largest speed.
    pub(crate) peak_velocity: f64,
    /// W.
    pub(crate) peak_power: f64,
}

/// A local extreme of a torque.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Peak {
    pub(crate) joint: usize,
    pub(crate) time: f64,
    pub(crate) segment: usize,
    pub(crate) torque: f64,
}

/// Torque of a joint at a moment, by how it scales when the motion runs at a part λ of its speed: λ²·d + λ·f + c.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Point {
    pub(crate) joint: usize,
    pub(crate) time: f64,
    pub(crate) segment: usize,
    /// Inertia, rotor, velocity products and quadratic friction.
    pub(crate) dynamic: f64,
    /// Viscous friction.
    pub(crate) viscous: f64,
    /// Gravity and Coulomb friction, that of the load included.
    pub(crate) still: f64,
    /// Gravity alone.
    pub(crate) gravity: f64,
}

impl Point {
    /// The torque at a part of the speed.
    pub(crate) fn torque(&self, scale: f64) -> f64 {
        (self.dynamic * scale + self.viscous) * scale + self.still
    }
}

/// The samples of one segment, or of a part of it in which no load passes zero.
#[derive(Debug, Clone, Copy)]
struct Stretch {
    segment: usize,
    /// Begin and end, since the segment began, s.
    from: f64,
    to: f64,
    /// Index of the first sample.
    first: usize,
    intervals: usize,
}

impl Stretch {
    /// When a sample is, since the segment began.
    fn local(&self, k: usize) -> f64 {
        self.from + self.step() * k as f64
    }

    /// Time from sample to sample.
    fn step(&self) -> f64 {
        (self.to - self.from) / self.intervals as f64
    }

    /// Its samples, last included, of a column.
    fn of<'a>(&self, column: &'a [f64]) -> &'a [f64] {
        &column[self.first..=self.first + self.intervals]
    }
}

/// Scratch of the verifier, reused from plan to plan.
#[derive(Debug, Default)]
pub(crate) struct Verifier {
    sweep: Sweep,
    refine: Sweep,
    times: Vec<f64>,
    /// Total torque at the samples, joint by joint as in the sweep.
    torque: Vec<f64>,
}

impl Verifier {
    /// Verifies a motion. `limits` are the torque limits, `None` where unknown.
    pub(crate) fn verify(
        &mut self,
        chain: &Chain,
        drives: &[DriveTerms],
        limits: &[Option<f64>],
        motion: &Trajectory,
    ) -> Verification {
        let directions = directions(motion);
        let context = extreme::Context {
            chain,
            drives,
            limits,
            motion,
            directions: &directions,
        };
        let mut stretches = whole_segments(motion);
        self.sample(chain, motion, &stretches);
        if any_loaded(drives)
            && let Some(divided) = self.divided(&context, &stretches)
        {
            stretches = divided;
            self.sample(chain, motion, &stretches);
        }
        self.add_drives(drives, motion, &directions, &stretches);
        let mut joints = self.demands(motion, &stretches);
        let peaks = extreme::find(&context, self, &stretches, &mut joints);
        let points = self.points(&context, &stretches, &peaks);
        let override_safe = overrides::worst(&context, &mut self.refine, &points);
        Verification {
            joints,
            peaks,
            override_safe,
            points,
        }
    }

    /// Fills the sweep with samples of the motion and computes their rigid-body torques.
    fn sample(&mut self, chain: &Chain, motion: &Trajectory, stretches: &[Stretch]) {
        let count = stretches.last().map_or(0, |last| last.first + last.intervals + 1);
        self.sweep.reset(motion.joint_count(), count);
        self.times.clear();
        for stretch in stretches {
            let begin = motion.times()[stretch.segment];
            for k in 0..=stretch.intervals {
                let local = stretch.local(k);
                self.sweep
                    .set(stretch.first + k, motion.segment(stretch.segment), local);
                self.times.push(begin + local);
            }
        }
        self.sweep.compute(chain);
    }

    /// The stretches, divided where the load of a moving joint's friction passes zero; `None` where none does.
    fn divided(&mut self, context: &extreme::Context<'_>, stretches: &[Stretch]) -> Option<Vec<Stretch>> {
        let sweep = &self.sweep;
        let floor = KINK_FLOOR
            * sweep
                .gravity
                .iter()
                .fold(0.0, |most: f64, gravity| most.max(gravity.abs()));
        let mut cuts = vec![Vec::new(); stretches.len()];
        // of which stretch, of which joint
        let mut searches: Vec<(usize, usize, Search)> = Vec::new();
        for (index, stretch) in stretches.iter().enumerate() {
            let times: Vec<f64> = (0..=stretch.intervals).map(|k| stretch.local(k)).collect();
            for joint in context.loaded(stretch.segment) {
                let gravity = stretch.of(&sweep.gravity[sweep.column(joint)..]);
                let begun = Search::begin(&times, gravity, floor, &mut cuts[index]);
                searches.extend(begun.into_iter().map(|search| (index, joint, search)));
            }
        }
        while !searches.is_empty() {
            let moments: Vec<(usize, f64)> = searches
                .iter()
                .map(|(index, _, search)| (stretches[*index].segment, search.probe()))
                .collect();
            context.compute_at(&mut self.refine, &moments);
            let looked = std::mem::take(&mut searches);
            for (sample, (index, joint, search)) in looked.into_iter().enumerate() {
                let gravity = self.refine.gravity[self.refine.column(joint) + sample];
                let next = search.step(gravity, floor, &mut cuts[index]);
                searches.extend(next.into_iter().flatten().map(|search| (index, joint, search)));
            }
        }
        let mut divided = Vec::with_capacity(stretches.len());
        for (stretch, mut cuts) in stretches.iter().zip(cuts) {
            kinks::keep_apart(&mut cuts, stretch.from, stretch.to);
            let mut from = stretch.from;
            for to in cuts.into_iter().chain([stretch.to]) {
                push_stretch(&mut divided, context.motion, stretch.segment, [from, to]);
                from = to;
            }
        }
        (divided.len() > stretches.len()).then_some(divided)
    }

    /// Adds rotors and friction to the rigid-body torques.
    fn add_drives(&mut self, drives: &[DriveTerms], motion: &Trajectory, directions: &[f64], stretches: &[Stretch]) {
        self.torque.clear();
        self.torque.extend_from_slice(&self.sweep.torque);
        let count = motion.joint_count();
        for (joint, drive) in drives.iter().enumerate() {
            let column = self.sweep.column(joint);
            for stretch in stretches {
                let direction = directions[stretch.segment * count + joint];
                let samples = column + stretch.first..=column + stretch.first + stretch.intervals;
                for entry in samples {
                    let velocity = self.sweep.velocity[entry];
                    self.torque[entry] += drive.armature * self.sweep.acceleration[entry]
                        + drive.viscous * velocity
                        + drive.drag(velocity)
                        + drive.coulomb(direction, self.sweep.gravity[entry]);
                }
            }
        }
    }

    /// Peaks and integrals over the samples.
    fn demands(&self, motion: &Trajectory, stretches: &[Stretch]) -> Vec<JointDemand> {
        (0..motion.joint_count())
            .map(|joint| {
                let column = self.sweep.column(joint);
                let mut demand = JointDemand::default();
                for stretch in stretches {
                    let span = stretch.to - stretch.from;
                    let mut sum = 0.0;
                    // the last two powers: a parabola through three rises above the middle one
                    let (mut before, mut last) = (0.0_f64, 0.0_f64);
                    for k in 0..=stretch.intervals {
                        let sample = stretch.first + k;
                        let torque = self.torque[column + sample];
                        let velocity = self.sweep.velocity[column + sample];
                        if torque.abs() > demand.peak_torque.abs() {
                            demand.peak_torque = torque;
                            demand.time = self.times[sample];
                            demand.segment = stretch.segment;
                        }
                        demand.peak_velocity = demand.peak_velocity.max(velocity.abs());
                        let power = (torque * velocity).abs();
                        demand.peak_power = demand.peak_power.max(power);
                        if k >= 2 && last >= before && last >= power {
                            demand.peak_power = demand.peak_power.max(parabola_top(before, last, power));
                        }
                        (before, last) = (last, power);
                        sum += simpson_weight(k, stretch.intervals) * torque * torque;
                    }
                    demand.torque_squared += sum * span / (3.0 * stretch.intervals as f64);
                }
                demand
            })
            .collect()
    }

    /// Every sample of every limited joint, and the extremes between them, split by how they scale with speed.
    fn points(&mut self, context: &extreme::Context<'_>, stretches: &[Stretch], peaks: &[Peak]) -> Vec<Point> {
        let count = context.drives.len();
        let mut points = Vec::with_capacity(self.times.len() * count + peaks.len());
        for (joint, drive) in context.drives.iter().enumerate() {
            if context.limits[joint].is_none() {
                continue;
            }
            let column = self.sweep.column(joint);
            for stretch in stretches {
                let direction = context.directions[stretch.segment * count + joint];
                for sample in stretch.first..=stretch.first + stretch.intervals {
                    let entry = column + sample;
                    let gravity = self.sweep.gravity[entry];
                    let velocity = self.sweep.velocity[entry];
                    points.push(Point {
                        joint,
                        time: self.times[sample],
                        segment: stretch.segment,
                        dynamic: self.sweep.torque[entry] - gravity
                            + drive.armature * self.sweep.acceleration[entry]
                            + drive.drag(velocity),
                        viscous: drive.viscous * velocity,
                        still: gravity + drive.coulomb(direction, gravity),
                        gravity,
                    });
                }
            }
        }
        points.extend(context.points_at(&mut self.refine, peaks));
        points
    }
}

impl Verification {
    /// What standing still asks: nothing that holding does not.
    pub(crate) fn at_rest(joint_count: usize) -> Self {
        Self {
            joints: vec![JointDemand::default(); joint_count],
            peaks: Vec::new(),
            override_safe: None,
            points: Vec::new(),
        }
    }
}

/// One stretch a segment.
fn whole_segments(motion: &Trajectory) -> Vec<Stretch> {
    let mut stretches = Vec::with_capacity(motion.segment_count());
    for (segment, ends) in motion.times().windows(2).enumerate() {
        push_stretch(&mut stretches, motion, segment, [0.0, ends[1] - ends[0]]);
    }
    stretches
}

/// Adds a stretch with as many samples as its travel needs.
fn push_stretch(stretches: &mut Vec<Stretch>, motion: &Trajectory, segment: usize, [from, to]: [f64; 2]) {
    // velocities do not change sign within a segment
    let travel: f64 = motion
        .segment(segment)
        .iter()
        .map(|p| (evaluate(p, to).position - evaluate(p, from).position).abs())
        .sum();
    let halves = (0.5 * travel / SAMPLE_TRAVEL).ceil() as usize;
    stretches.push(Stretch {
        segment,
        from,
        to,
        first: stretches.last().map_or(0, |last| last.first + last.intervals + 1),
        intervals: (2 * halves).max(INTERVALS_MIN),
    });
}

/// Top of the parabola through three equidistant values, the middle one the largest.
fn parabola_top(left: f64, middle: f64, right: f64) -> f64 {
    let bend = 2.0 * middle - left - right;
    if bend <= 0.0 {
        return middle;
    }
    let slope = right - left;
    middle + slope * slope / (8.0 * bend)
}

/// Weights 1 4 2 4 … 4 1 of Simpson's rule.
fn simpson_weight(k: usize, intervals: usize) -> f64 {
    if k == 0 || k == intervals {
        return 1.0;
    }
    if k % 2 == 1 { 4.0 } else { 2.0 }
}

/// The direction in which each joint moves in each segment: 1, −1, or 0 for one that stands.
///
/// At the ends of a motion, where speeds are 0, friction has the sign of the motion just after and just before.
fn directions(motion: &Trajectory) -> Vec<f64> {
    let mut directions = Vec::with_capacity(motion.segment_count() * motion.joint_count());
    for (segment, ends) in motion.times().windows(2).enumerate() {
        let middle = 0.5 * (ends[1] - ends[0]);
        directions.extend(motion.segment(segment).iter().map(|p| {
            let velocity = evaluate(p, middle).velocity;
            if velocity == 0.0 { 0.0 } else { velocity.signum() }
        }));
    }
    directions
}

#[cfg(test)]
mod tests;
