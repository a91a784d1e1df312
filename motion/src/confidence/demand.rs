//! What a motion asks of the drives, bands included: walked through in samples, and followed to the largest sums.
//!
//! Stretches are sampled from within: where a joint starts, stops or turns back, friction has its side there.

use super::course::{Course, JointState};
use super::factor::Factor;
use super::width::Width;
use super::{Confidence, Over};
use crate::budget::{Budget, Stopped};
use crate::dynamics::regressor::Regressor;
use crate::dynamics::{self, Workspace};
use crate::robot::Robot;
use crate::robot::spec::Residual;
use crate::tolerance::{BAND_BLOCK, BAND_GOLDEN_ROUNDS, BAND_INSIDE, BAND_RESERVE};

/// What a motion asks of the drives.
#[derive(Debug, Clone)]
pub(crate) struct Demand {
    /// By joint; `None` where its limit is not known.
    pub(crate) tightest: Vec<Option<Tightest>>,
    /// By joint: by how much torque and band with its reserve exceed the limit where they do most; negative where they hold.
    pub(crate) excess: Vec<f64>,
    /// By joint: largest speed.
    pub(crate) peak_velocity: Vec<f64>,
    /// By joint: largest acceleration or deceleration.
    pub(crate) peak_acceleration: Vec<f64>,
}

/// The tightest moment of one joint.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Tightest {
    pub(crate) time: f64,
    pub(crate) stretch: usize,
    pub(crate) torque: f64,
    /// Of the parameters' part.
    pub(crate) deviation: f64,
    pub(crate) band: f64,
    pub(crate) limit: f64,
}

impl Tightest {
    /// (limit − |torque| − band) / limit.
    pub(crate) fn margin(&self) -> f64 {
        (self.limit - self.torque.abs() - self.band) / self.limit
    }

    fn excess(&self) -> f64 {
        let nominal = self.torque.abs() - self.limit;
        // where nothing is uncertain, the verifier has had its say
        if self.band == 0.0 {
            return nominal.min(0.0);
        }
        nominal + self.band * (1.0 + BAND_RESERVE)
    }
}

impl Demand {
    /// Whether every limit holds.
    pub(crate) fn holds(&self) -> bool {
        self.excess.iter().all(|excess| *excess <= 0.0)
    }

    /// The joint that exceeds its limit by the largest part of it, if any does.
    pub(crate) fn shortfall(&self) -> Option<(usize, Tightest)> {
        let known = self.tightest.iter().zip(&self.excess).enumerate();
        let over = known.filter(|(_, (_, excess))| **excess > 0.0);
        over.filter_map(|(joint, (tightest, _))| tightest.map(|tightest| (joint, tightest)))
            .min_by(|a, b| a.1.margin().total_cmp(&b.1.margin()))
    }
}

/// Scratch that computes torques and the deviations of their bands, reused from state to state.
#[derive(Debug)]
pub(crate) struct Bands<'a> {
    robot: &'a Robot,
    factor: &'a Factor,
    residuals: &'a [Residual],
    confidence: Confidence,
    regressor: Regressor,
    workspace: Workspace,
    state: JointState,
    torque: Vec<f64>,
    deviation: Vec<f64>,
    /// Lᵀφ of each joint, joint by joint.
    spread: Vec<f64>,
}

impl<'a> Bands<'a> {
    /// Scratch for a robot; `None` where it does not say how well it is known.
    pub(crate) fn new(robot: &'a Robot, confidence: Confidence) -> Option<Self> {
        let factor = robot.factor()?;
        let residuals = &robot.spec().uncertainty.as_ref()?.residuals;
        let count = robot.joint_count();
        Some(Self {
            robot,
            factor,
            residuals,
            confidence,
            regressor: Regressor::new(robot),
            workspace: Workspace::new(robot),
            state: JointState::new(count),
            torque: vec![0.0; count],
            deviation: vec![0.0; count],
            spread: vec![0.0; count * factor.parameter_count()],
        })
    }

    pub(crate) fn residuals(&self) -> &'a [Residual] {
        self.residuals
    }

    /// What a motion asks.
    ///
    /// # Errors
    /// [`Stopped`], when nobody waits any more.
    pub(crate) fn demand(&mut self, course: &mut dyn Course, budget: &Budget<'_>) -> Result<Demand, Stopped> {
        let turns = match self.confidence.over {
            Over::Sample => vec![0.0; self.torque.len()],
            Over::Move => self.turns(course, budget)?,
        };
        let count = self.torque.len();
        let limited = (0..count)
            .filter(|joint| (0..course.stretches()).any(|stretch| course.limit(stretch, *joint).is_some()))
            .count();
        let widths: Vec<Width> = self
            .residuals
            .iter()
            .zip(turns)
            .map(|(residual, turn)| Width::of(self.confidence, residual, limited, course.duration(), turn))
            .collect();
        let mut demand = Demand {
            tightest: vec![None; count],
            excess: vec![f64::NEG_INFINITY; count],
            peak_velocity: vec![0.0; count],
            peak_acceleration: vec![0.0; count],
        };
        for stretch in 0..course.stretches() {
            for (part, time) in moments(course, stretch).enumerate() {
                if part % BAND_BLOCK == 0 {
                    budget.check()?;
                }
                self.evaluate(course, stretch, time);
                demand.keep_rates(&self.state);
                for (joint, width) in widths.iter().enumerate() {
                    if let Some(found) = self.found(course, joint, width, stretch, time) {
                        demand.keep(joint, found);
                    }
                }
            }
        }
        for (joint, width) in widths.iter().enumerate() {
            budget.check()?;
            self.refine(course, joint, width, &mut demand);
        }
        Ok(demand)
    }

    /// How far the direction of each joint's Lᵀφ turns along a motion, rad. It and its opposite are the same direction.
    fn turns(&mut self, course: &mut dyn Course, budget: &Budget<'_>) -> Result<Vec<f64>, Stopped> {
        let count = self.torque.len();
        let parameters = self.factor.parameter_count();
        let mut turns = vec![0.0; count];
        let mut before: Vec<f64> = vec![0.0; self.spread.len()];
        for stretch in 0..course.stretches() {
            for (part, time) in moments(course, stretch).enumerate() {
                if part % BAND_BLOCK == 0 {
                    budget.check()?;
                }
                self.evaluate(course, stretch, time);
                for (joint, turn) in turns.iter_mut().enumerate() {
                    if self.deviation[joint] == 0.0 {
                        continue;
                    }
                    let of_joint = joint * parameters..(joint + 1) * parameters;
                    let inverse = 1.0 / self.deviation[joint];
                    let (now, before) = (&self.spread[of_joint.clone()], &mut before[of_joint]);
                    *turn += angle(now, inverse, before);
                }
            }
        }
        Ok(turns)
    }

    /// Computes torques, deviations and spreads at a moment.
    fn evaluate(&mut self, course: &mut dyn Course, stretch: usize, time: f64) {
        course.set(stretch, time, &mut self.state);
        let JointState {
            position,
            velocity,
            acceleration,
        } = &self.state;
        let (robot, workspace) = (self.robot, &mut self.workspace);
        dynamics::drive_torque(robot, workspace, position, velocity, acceleration, &mut self.torque);
        self.regressor.compute(robot, position, velocity, acceleration);
        let parameters = self.factor.parameter_count();
        for (joint, deviation) in self.deviation.iter_mut().enumerate() {
            let spread = &mut self.spread[joint * parameters..(joint + 1) * parameters];
            *deviation = self.factor.spread(joint, self.regressor.row(joint), spread);
        }
    }

    /// Torque and band of a joint as evaluated last.
    fn found(&self, course: &dyn Course, joint: usize, width: &Width, stretch: usize, time: f64) -> Option<Tightest> {
        let limit = course.limit(stretch, joint)?;
        let deviation = self.deviation[joint];
        Some(Tightest {
            time,
            stretch,
            torque: self.torque[joint],
            deviation,
            band: width.band(deviation),
            limit,
        })
    }

    /// Follows a joint's largest sum between the samples on both sides of it, by golden section.
    fn refine(&mut self, course: &mut dyn Course, joint: usize, width: &Width, demand: &mut Demand) {
        const GOLDEN: f64 = 0.618_033_988_749_894_9;
        let Some(best) = demand.tightest[joint] else { return };
        let [begin, end] = course.ends(best.stretch);
        if end <= begin {
            return;
        }
        let inset = BAND_INSIDE * (end - begin);
        let step = (end - begin) / course.parts(best.stretch).max(1) as f64;
        let mut low = (best.time - step).max(begin + inset);
        let mut high = (best.time + step).min(end - inset);
        let mut margin_at = |time: f64| {
            self.evaluate(course, best.stretch, time);
            let found = self.found(course, joint, width, best.stretch, time);
            found.map_or(f64::INFINITY, |found| {
                demand.keep(joint, found);
                found.margin()
            })
        };
        let mut left = high - GOLDEN * (high - low);
        let mut right = low + GOLDEN * (high - low);
        let (mut at_left, mut at_right) = (margin_at(left), margin_at(right));
        for _ in 0..BAND_GOLDEN_ROUNDS {
            if at_left < at_right {
                (high, right, at_right) = (right, left, at_left);
                left = high - GOLDEN * (high - low);
                at_left = margin_at(left);
            } else {
                (low, left, at_left) = (left, right, at_right);
                right = low + GOLDEN * (high - low);
                at_right = margin_at(right);
            }
        }
    }
}

impl Demand {
    fn keep(&mut self, joint: usize, found: Tightest) {
        self.excess[joint] = self.excess[joint].max(found.excess());
        let tighter = self.tightest[joint].is_none_or(|known| found.margin() < known.margin());
        if tighter {
            self.tightest[joint] = Some(found);
        }
    }

    fn keep_rates(&mut self, state: &JointState) {
        for (most, rate) in self.peak_velocity.iter_mut().zip(&state.velocity) {
            *most = most.max(rate.abs());
        }
        for (most, rate) in self.peak_acceleration.iter_mut().zip(&state.acceleration) {
            *most = most.max(rate.abs());
        }
    }
}

/// When a stretch is sampled.
fn moments(course: &dyn Course, stretch: usize) -> impl Iterator<Item = f64> + use<> {
    let [begin, end] = course.ends(stretch);
    let parts = course.parts(stretch);
    let inset = BAND_INSIDE * (end - begin);
    (0..=parts).map(move |part| {
        if parts == 0 {
            return begin;
        }
        let time = begin + (end - begin) * part as f64 / parts as f64;
        time.clamp(begin + inset, end - inset)
    })
}

/// The angle between two directions, either way round, the second of length 1 or not known yet: all zeros. It becomes the first.
fn angle(now: &[f64], inverse: f64, before: &mut [f64]) -> f64 {
    let first = before.iter().all(|value| *value == 0.0);
    let dot: f64 = now.iter().zip(before.iter()).map(|(a, b)| a * b).sum();
    let sign = if dot < 0.0 { -inverse } else { inverse };
    let mut apart = 0.0;
    for (before, now) in before.iter_mut().zip(now) {
        let direction = now * sign;
        apart += (direction - *before) * (direction - *before);
        *before = direction;
    }
    if first {
        return 0.0;
    }
    // from the chord: the arc cosine of the product loses small angles
    2.0 * libm::asin((0.5 * apart.sqrt()).min(1.0))
}
