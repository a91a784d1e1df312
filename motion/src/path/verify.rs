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
//! vary; it ends where the load of a friction passes zero ([`kinks`]). Between samples every maximum that might be the
//! largest is searched for ([`extremes`]), with the friction of either side where a joint turns back.

mod channels;
mod extremes;
mod intervals;
mod kinks;
mod loads;
mod maxima;
mod state;

use nalgebra::Isometry3;

use super::outcome::PathLimit;
use crate::budget::{Budget, Stopped};
use crate::curve::{Curve, Side};
use crate::dynamics::Workspace;
use crate::dynamics::sweep::Sweep;
use crate::plan::outcome::OverrideSafety;
use crate::robot::Robot;
use crate::timing::law::TimeLaw;
use crate::timing::limits::Limits;
use crate::verify::{JointDemand, Point, overrides};
use channels::Channels;
use extremes::Span;
use intervals::breaks;
pub(super) use state::State;

/// Samples of an interval of the time law, less one.
const PARTS: usize = 10;

/// Intervals computed at once: it bounds the scratch memory.
const BLOCK: usize = 48;

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
        let mut breaks = self.sample_finely(breaks);
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
}
