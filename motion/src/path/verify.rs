//! The verifier of timed paths: what a motion asks of every joint, every drive and the tool, everywhere along it.
//!
//! It goes from s(t) to positions, velocities, accelerations and jerks in time, by the chain rule,
//!
//! ```text
//! q̇ = q′ṡ      q̈ = q′s̈ + q″ṡ²      q⃛ = q′s⃛ + 3q″ṡs̈ + q‴ṡ³
//! ```
//!
//! and from there to torques by inverse dynamics and to the tool by its own recursion. Of the planner's terms along the
//! path it uses none. Every interval of the time law, of the path between its knots, and of its limits is sampled
//! [`PARTS`] times, on both of its ends from within, where accelerations may jump, and halved until that shows how they
//! vary, and ends where the load of a joint's friction passes zero; between samples every maximum that might be the largest is searched for ([`extremes`]), with the friction of
//! either side where a joint turns back.

mod channels;
mod extremes;
mod kinks;
mod state;

use nalgebra::Isometry3;

use super::outcome::PathLimit;
use crate::budget::{Budget, Stopped};
use crate::curve::{Curve, Side};
use crate::dynamics::sweep::Sweep;
use crate::dynamics::{self, Workspace};
use crate::kinematics::{self, ToolMotion};
use crate::plan::outcome::OverrideSafety;
use crate::robot::Robot;
use crate::timing::law::TimeLaw;
use crate::timing::limits::Limits;
use crate::tolerance::{BREAKS_APART, EXTREME_GAIN, PATH_AT_REST};
use crate::verify::{JointDemand, Point, overrides};
use channels::{Channels, fill};
use extremes::{Node, Span, search, way};
pub(super) use state::State;

/// Samples of an interval of the time law, less one.
const PARTS: usize = 10;

/// Intervals computed at once: it bounds the scratch memory.
const BLOCK: usize = 48;

/// How far inside an interval its ends are sampled, as part of it.
const INSIDE: f64 = 1.0e-9;

/// Spans that may hold a channel's maximum, before those that cannot any more are dropped: it bounds the memory.
const CANDIDATES: usize = 1024;

/// An interval is halved where an acceleration bends from sample to sample by more than this part of its limit: a
/// parabola then still shows the extreme to a thousandth, from where it is followed.
const SPLIT_BEND: f64 = 0.02;

/// Smallest scale of a joint's acceleration without a limit, as part of the largest of all: below is rounding.
const SPLIT_FLOOR: f64 = 1.0e-3;

/// Most times an interval is halved, and most intervals of a block after it: they bound the work.
const SPLIT_ROUNDS: usize = 8;
const SPLIT_MOST: usize = 8 * BLOCK;

/// A path and when it is where.
#[derive(Clone, Copy)]
pub(super) struct Timed<'a> {
    pub(super) curve: &'a dyn Curve,
    pub(super) law: &'a TimeLaw,
    pub(super) limits: &'a Limits,
    /// When it begins, s.
    pub(super) begin: f64,
}

/// The tightest moment of one limit on one path.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Tightest {
    pub(super) kind: PathLimit,
    /// `None`: the tool's.
    pub(super) joint: Option<usize>,
    pub(super) value: f64,
    pub(super) limit: f64,
    /// |value| / limit.
    pub(super) ratio: f64,
    /// Since the whole motion began, s.
    pub(super) time: f64,
    pub(super) s: f64,
}

/// Which limit is the tightest in one interval of the time law.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Ruling {
    pub(super) begin: f64,
    pub(super) end: f64,
    pub(super) s: f64,
    pub(super) kind: PathLimit,
    pub(super) joint: Option<usize>,
}

/// What a path asks.
#[derive(Debug, Clone)]
pub(super) struct Examined {
    /// One a joint.
    pub(super) demands: Vec<JointDemand>,
    /// One for each limit that is known.
    pub(super) tightest: Vec<Tightest>,
    /// One for each interval.
    pub(super) rulings: Vec<Ruling>,
    /// The torque that comes closest to, or goes farthest beyond its limit, by how it scales with speed.
    pub(super) torque: Option<Point>,
    pub(super) override_safe: Option<OverrideSafety>,
}

/// Examines one path. `ranges` are the position limits of the joints.
///
/// # Errors
/// [`Stopped`], when nobody waits any more.
pub(super) fn examine(
    robot: &Robot,
    tcp: &Isometry3<f64>,
    timed: Timed<'_>,
    ranges: &[[Option<f64>; 2]],
    budget: &Budget<'_>,
) -> Result<Examined, Stopped> {
    let mut examiner = Examiner::new(robot, tcp, timed, ranges);
    let breaks = breaks(timed);
    let mut first = 0;
    while first + 1 < breaks.len() {
        budget.check()?;
        let last = (first + BLOCK).min(breaks.len() - 1);
        examiner.block(&breaks[first..=last]);
        first = last;
    }
    examiner.finish(budget)
}

/// When something may jump: where pieces of the time law meet, knots of the path, and places from where other limits hold.
fn breaks(timed: Timed<'_>) -> Vec<f64> {
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

struct Examiner<'a> {
    robot: &'a Robot,
    tcp: &'a Isometry3<f64>,
    timed: Timed<'a>,
    channels: Channels<'a>,
    sweep: Sweep,
    state: State,
    torque: Vec<f64>,
    gravity: Vec<f64>,
    workspace: Workspace,
    /// Which way the joints move at the samples of a block, laid out as the sweep's columns are.
    directions: Vec<f64>,
    /// Values of every limit at the samples of a block, sample by sample.
    values: Vec<f64>,
    places: Vec<f64>,
    times: Vec<f64>,
    examined: Examined,
    /// Index into `examined.tightest` by channel.
    known: Vec<Option<usize>>,
    /// By channel, where values between samples may be above all that is known.
    candidates: Vec<Vec<Span>>,
    worst: Option<overrides::Worst>,
}

impl<'a> Examiner<'a> {
    fn new(robot: &'a Robot, tcp: &'a Isometry3<f64>, timed: Timed<'a>, ranges: &'a [[Option<f64>; 2]]) -> Self {
        let count = robot.joint_count();
        let channels = Channels {
            joint_count: count,
            ranges,
        };
        Self {
            robot,
            tcp,
            timed,
            channels,
            sweep: Sweep::default(),
            state: State::new(count),
            torque: vec![0.0; count],
            gravity: vec![0.0; count],
            workspace: Workspace::new(robot),
            directions: Vec::new(),
            values: Vec::new(),
            places: Vec::new(),
            times: Vec::new(),
            examined: Examined {
                demands: vec![JointDemand::default(); count],
                tightest: Vec::new(),
                rulings: Vec::new(),
                torque: None,
                override_safe: None,
            },
            known: vec![None; channels.count()],
            candidates: vec![Vec::new(); channels.count()],
            worst: None,
        }
    }

    /// Samples and examines some intervals, given by their ends.
    fn block(&mut self, breaks: &[f64]) {
        let mut breaks = breaks.to_vec();
        self.sample(&breaks);
        for _ in 0..SPLIT_ROUNDS {
            if !self.halve(&mut breaks) {
                break;
            }
            self.sample(&breaks);
        }
        self.sweep.compute(self.robot.chain());
        if self.robot.is_loaded() && self.divide(&mut breaks) {
            self.sample(&breaks);
            self.sweep.compute(self.robot.chain());
        }
        self.add_torques(self.times.len());
        for (interval, ends) in breaks.windows(2).enumerate() {
            self.interval(interval * (PARTS + 1), ends);
        }
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
    fn sample(&mut self, breaks: &[f64]) {
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

    fn tool(&self) -> ToolMotion {
        let state = &self.state;
        kinematics::tool_motion(
            self.robot,
            &state.position,
            &state.velocity,
            &state.acceleration,
            self.tcp,
        )
    }

    /// Completes the rigid bodies' torques by the drives', and keeps what slower overrides need.
    fn add_torques(&mut self, samples: usize) {
        let channels = self.channels.count();
        let limits = self.timed.limits;
        let mut points = Vec::new();
        for (joint, drive) in self.robot.drives().iter().enumerate() {
            for sample in 0..samples {
                let entry = self.sweep.column(joint) + sample;
                let (velocity, acceleration) = (self.sweep.velocity[entry], self.sweep.acceleration[entry]);
                let gravity = self.sweep.gravity[entry];
                let point = Point {
                    joint,
                    time: self.timed.begin + self.times[sample],
                    segment: 0,
                    dynamic: self.sweep.torque[entry] - gravity + drive.armature * acceleration + drive.drag(velocity),
                    viscous: drive.viscous * velocity,
                    still: gravity + drive.coulomb(self.directions[entry], gravity),
                    gravity,
                };
                let torque = point.torque(1.0);
                self.values[sample * channels + Channels::torque(joint)] = torque;
                let demand = &mut self.examined.demands[joint];
                if torque.abs() > demand.peak_torque.abs() {
                    (demand.peak_torque, demand.time) = (torque, point.time);
                }
                demand.peak_velocity = demand.peak_velocity.max(velocity.abs());
                demand.peak_power = demand.peak_power.max((torque * velocity).abs());
                let before = sample % (PARTS + 1) != 0;
                if before {
                    let step = self.times[sample] - self.times[sample - 1];
                    let last = self.values[(sample - 1) * channels + Channels::torque(joint)];
                    // Simpson's rule would need the middle; at eleven samples the trapezoid is as true as it need be
                    demand.torque_squared += 0.5 * step * (torque * torque + last * last);
                }
                points.push(point);
            }
        }
        // a joint's limit may differ from stretch to stretch: the tightest one is taken for all
        let tightest = |joint: usize| {
            let stretches = limits.stretches.iter();
            stretches
                .filter_map(|stretch| stretch.joints[joint].torque)
                .fold(f64::INFINITY, f64::min)
        };
        let worst = overrides::tightest(points.iter(), &tightest);
        if let Some(worst) = worst
            && worst.ratio.is_finite()
            && self.worst.as_ref().is_none_or(|known| worst.ratio > known.ratio)
        {
            self.worst = Some(worst);
        }
    }

    /// Finds the maxima of one interval, whose samples begin at `first`.
    fn interval(&mut self, first: usize, ends: &[f64]) {
        let side = Side::After;
        let middle = self.places[first + PARTS / 2];
        let limits = self.timed.limits;
        let stretch = &limits.stretches[limits.stretch_at(middle, side)];
        let mut ruling: Option<(f64, usize)> = None;
        for channel in 0..self.channels.count() {
            let Some(limit) = self.channels.limit(channel, stretch) else {
                continue;
            };
            let value = |part: usize| self.values[(first + part) * self.channels.count() + channel];
            let ratios: [f64; PARTS + 1] = std::array::from_fn(|part| self.channels.ratio(channel, value(part), limit));
            let top = (0..=PARTS).fold(0, |top, part| if ratios[part] > ratios[top] { part } else { top });
            let found = (value(top), self.times[first + top], self.places[first + top]);
            self.keep(channel, limit, found);
            self.consider(channel, limit, first);
            let ranged = matches!(
                self.channels.of(channel).0,
                PathLimit::PositionLower | PathLimit::PositionUpper
            );
            if !ranged && ruling.is_none_or(|(ratio, _)| ratios[top] > ratio) {
                ruling = Some((ratios[top], channel));
            }
        }
        if let Some((_, channel)) = ruling {
            let (kind, joint) = self.channels.of(channel);
            self.examined.rulings.push(Ruling {
                begin: self.timed.begin + ends[0],
                end: self.timed.begin + ends[1],
                s: self.places[first],
                kind,
                joint,
            });
        }
    }

    /// Keeps a value where it is the tightest of its channel.
    fn keep(&mut self, channel: usize, limit: f64, (value, time, s): (f64, f64, f64)) {
        let ratio = self.channels.ratio(channel, value, limit);
        let (kind, joint) = self.channels.of(channel);
        let tightest = Tightest {
            kind,
            joint,
            value,
            limit,
            ratio,
            time: self.timed.begin + time,
            s,
        };
        match self.known[channel] {
            Some(known) if self.examined.tightest[known].ratio >= ratio => {}
            Some(known) => self.examined.tightest[known] = tightest,
            None => {
                self.known[channel] = Some(self.examined.tightest.len());
                self.examined.tightest.push(tightest);
            }
        }
        if kind == PathLimit::Torque
            && let Some(joint) = joint
        {
            let demand = &mut self.examined.demands[joint];
            if value.abs() > demand.peak_torque.abs() {
                (demand.peak_torque, demand.time) = (value, self.timed.begin + time);
            }
        }
    }

    /// Remembers where an interval's channel may be above all that is known, between the samples from `first` on.
    fn consider(&mut self, channel: usize, limit: f64, first: usize) {
        let nodes: [Node; PARTS + 1] = std::array::from_fn(|part| self.sampled(channel, limit, first + part));
        let second = |middle: usize| {
            let bend = |way: usize| {
                let [before, here, after] = [middle - 1, middle, middle + 1].map(|part| nodes[part].parts[way]);
                (before - 2.0 * here + after).abs()
            };
            bend(0).max(bend(1)).max(bend(2))
        };
        let bends: [f64; PARTS + 1] = std::array::from_fn(|part| second(part.clamp(1, PARTS - 1)));
        let least = self.ratio_known(channel) + EXTREME_GAIN;
        for part in 0..PARTS {
            let around = &bends[part.saturating_sub(1)..(part + 3).min(PARTS + 1)];
            let span = Span {
                ends: [nodes[part], nodes[part + 1]],
                bend: around.iter().fold(0.0, |most: f64, bend| most.max(*bend)),
                limit,
            };
            if span.bound(|part| self.channels.size(channel, part)) > least {
                self.candidates[channel].push(span);
            }
        }
        if self.candidates[channel].len() > CANDIDATES {
            self.drop_candidates(channel);
        }
    }

    /// The largest part of its limit that is known of a channel.
    fn ratio_known(&self, channel: usize) -> f64 {
        self.known[channel].map_or(f64::NEG_INFINITY, |known| self.examined.tightest[known].ratio)
    }

    /// Drops the spans that cannot be above what is known by now.
    fn drop_candidates(&mut self, channel: usize) {
        let least = self.ratio_known(channel) + EXTREME_GAIN;
        let size = |part: f64| self.channels.size(channel, part);
        self.candidates[channel].retain(|span| span.bound(size) > least);
    }

    /// Follows every maximum between samples that may be its channel's largest.
    fn follow(&mut self, budget: &Budget<'_>) -> Result<(), Stopped> {
        let channels = self.channels;
        for channel in 0..channels.count() {
            self.drop_candidates(channel);
            let spans = std::mem::take(&mut self.candidates[channel]);
            let known = self.ratio_known(channel);
            let size = |part: f64| channels.size(channel, part);
            search(
                spans,
                known,
                size,
                |span, time| self.evaluated(channel, span.limit, time),
                budget,
            )?;
        }
        Ok(())
    }

    /// A sample of a channel.
    fn sampled(&self, channel: usize, limit: f64, sample: usize) -> Node {
        let value = self.values[sample * self.channels.count() + channel];
        let time = self.times[sample];
        let part = |value: f64| self.channels.part(channel, value, limit);
        let (PathLimit::Torque, Some(joint)) = self.channels.of(channel) else {
            return Node {
                time,
                parts: [part(value); 3],
                way: way(0.0),
                rates: [0.0; 2],
            };
        };
        let entry = self.sweep.column(joint) + sample;
        let drive = self.robot.drives()[joint];
        let (direction, gravity) = (self.directions[entry], self.sweep.gravity[entry]);
        let smooth = value - drive.coulomb(direction, gravity);
        Node {
            time,
            parts: [-1.0, 0.0, 1.0].map(|way| part(smooth + drive.coulomb(way, gravity))),
            way: way(direction),
            rates: [self.sweep.velocity[entry], self.sweep.acceleration[entry]],
        }
    }

    /// A channel at some time, kept where it is the tightest.
    fn evaluated(&mut self, channel: usize, limit: f64, time: f64) -> Node {
        let channels = self.channels;
        let part = |value: f64| channels.part(channel, value, limit);
        let (PathLimit::Torque, Some(joint)) = channels.of(channel) else {
            let value = self.value_at(channel, time);
            self.keep(channel, limit, (value, time, self.state.s));
            return Node {
                time,
                parts: [part(value); 3],
                way: way(0.0),
                rates: [0.0; 2],
            };
        };
        let torques = self.torques_at(joint, time);
        let way = way(self.state.direction[joint]);
        self.keep(channel, limit, (torques[way], time, self.state.s));
        Node {
            time,
            parts: torques.map(part),
            way,
            rates: [self.state.velocity[joint], self.state.acceleration[joint]],
        }
    }

    /// The value of one channel but the torques' at one time.
    fn value_at(&mut self, channel: usize, time: f64) -> f64 {
        self.state.set(self.timed.curve, self.timed.law, time, Side::After);
        let state = &self.state;
        match self.channels.of(channel) {
            (PathLimit::Velocity, Some(joint)) => state.velocity[joint],
            (PathLimit::Acceleration, Some(joint)) => state.acceleration[joint],
            (PathLimit::Jerk, Some(joint)) => state.jerk[joint],
            (PathLimit::PositionLower | PathLimit::PositionUpper, Some(joint)) => state.position[joint],
            (PathLimit::ToolVelocity, _) => self.tool().velocity.norm(),
            _ => self.tool().acceleration.norm(),
        }
    }

    /// The torque of a drive at one time with Coulomb friction against a motion backwards, without, and against one
    /// forwards: [`way`] says which of them holds.
    fn torques_at(&mut self, joint: usize, time: f64) -> [f64; 3] {
        self.state.set(self.timed.curve, self.timed.law, time, Side::After);
        let state = &self.state;
        let (velocity, acceleration) = (state.velocity[joint], state.acceleration[joint]);
        dynamics::rigid_torque(
            self.robot,
            &mut self.workspace,
            &state.position,
            &state.velocity,
            &state.acceleration,
            &mut self.torque,
        );
        // stays zero where no friction depends on it
        if self.robot.is_loaded() {
            dynamics::gravity_torque(self.robot, &mut self.workspace, &state.position, &mut self.gravity);
        }
        let drive = self.robot.drives()[joint];
        let (rigid, gravity) = (self.torque[joint] + drive.armature * acceleration, self.gravity[joint]);
        [-1.0, 0.0, 1.0].map(|way| rigid + drive.friction_towards(velocity, way, gravity))
    }

    /// Looks at the arm held still where the path begins and ends, without the help of friction.
    fn hold(&mut self) {
        let duration = self.timed.law.duration();
        let limits = self.timed.limits;
        let slow = PATH_AT_REST * self.timed.curve.length();
        for (time, side) in [(0.0, Side::After), (duration, Side::Before)] {
            if self.timed.law.at(time).velocity * duration > slow {
                continue;
            }
            self.state.set(self.timed.curve, self.timed.law, time, side);
            let s = self.state.s;
            dynamics::gravity_torque(self.robot, &mut self.workspace, &self.state.position, &mut self.torque);
            let stretch = &limits.stretches[limits.stretch_at(s, side)];
            for joint in 0..self.robot.joint_count() {
                let channel = Channels::torque(joint);
                if let Some(limit) = self.channels.limit(channel, stretch) {
                    self.keep(channel, limit, (self.torque[joint], time, s));
                }
            }
        }
    }

    fn finish(mut self, budget: &Budget<'_>) -> Result<Examined, Stopped> {
        self.hold();
        self.follow(budget)?;
        let of_torque = |tightest: &&Tightest| tightest.kind == PathLimit::Torque;
        let torques = self.examined.tightest.iter().filter(of_torque);
        let worst = torques.fold(None::<Tightest>, |worst, tightest| match worst {
            Some(worst) if worst.ratio >= tightest.ratio => Some(worst),
            _ => Some(*tightest),
        });
        self.examined.torque = worst.and_then(|worst| self.split(&worst));
        self.examined.override_safe = self.worst.take().map(|worst| {
            let limit = self.timed.limits.stretches.iter();
            let joint = worst.point.joint;
            worst.safety(
                limit
                    .filter_map(|stretch| stretch.joints[joint].torque)
                    .fold(f64::INFINITY, f64::min),
            )
        });
        Ok(self.examined)
    }

    /// A torque by how it scales with speed.
    fn split(&mut self, tightest: &Tightest) -> Option<Point> {
        let joint = tightest.joint?;
        let [_, smooth, _] = self.torques_at(joint, tightest.time - self.timed.begin);
        dynamics::gravity_torque(self.robot, &mut self.workspace, &self.state.position, &mut self.gravity);
        let gravity = self.gravity[joint];
        let drive = self.robot.drives()[joint];
        let velocity = self.state.velocity[joint];
        if tightest.value == gravity {
            // held still: no speed makes it less
            return Some(Point {
                joint,
                time: tightest.time,
                segment: 0,
                dynamic: 0.0,
                viscous: 0.0,
                still: tightest.value,
                gravity: tightest.value,
            });
        }
        let viscous = drive.viscous * velocity;
        // which way it acts, the torque says itself: where the joint turns back just there, it does either
        let coulomb = tightest.value - smooth;
        Some(Point {
            joint,
            time: tightest.time,
            segment: 0,
            dynamic: tightest.value - coulomb - viscous - gravity,
            viscous,
            still: gravity + coulomb,
            gravity,
        })
    }
}
