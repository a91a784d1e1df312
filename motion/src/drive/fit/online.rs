//! The interval that a controller can state which watches its own torques: the model's, moved, widened or narrowed by the recent
//! residual.
//!
//! ```text
//! e(k) = τ(k) − τ_model(k)            foretold h samples ahead:   e(k) in c ± w
//! c = φ·b(k)·e(k−h)/b(k−h)            φ = Σ λ·x(i)·x(i−h) / Σ λ·x(i−h)²,  x = e/b
//! w = b(k)·T·√(max S/N)·exp θ         S/N: means of (r/b)², r = e − c, one forgotten alike and one sooner
//! θ ← θ + γ·([|r| > w] − α)
//! ```
//!
//! b(k) is the deviation of the model's own interval at the sample, so what the model says of where it is uncertain stays. Two things of a
//! residual last from one moment to the next, and no fit knows them beforehand: where it lies (a body that is not right errs
//! to one side for as long as the pose lasts) and how large it is. c and S follow them. That a residual has grown is believed sooner than that it has
//! become small: of the two means the larger counts. They come from few independent errors, so they have a Student's T.
//! What friction errs by changes its side where a joint turns back, what a body errs by does not: φ and S of the h samples after a turn are learnt
//! apart from the others, beginning with no φ and more S.
//! θ takes in what Student's distribution does not say: it is adaptive conformal inference (I. Gibbs, E. Candès, "Adaptive conformal inference
//! under distribution shift", 2021; on a scale as in A. Angelopoulos et al., "Conformal PID control for time series prediction",
//! 2023). Over n samples the part outside differs from α by at most the way of θ over γ·n and h/n,
//! whatever the residual does, as long as θ is not at its bound.
//!
//! At a sample all is from residuals that are h samples old. Before the first, the interval is the model's. While a joint is at rest friction may
//! be anything between its two directions: the interval has the allowance for that, and nothing is learnt.
//!
//! The state is 2·h samples and a few numbers, whatever was seen.

use std::collections::VecDeque;

use crate::quantile;
use crate::robot::spec::Residual;
use crate::tolerance::{
    ONLINE_GAIN, ONLINE_HORIZON_BANDS, ONLINE_MEMORY, ONLINE_RATIO_MAX, ONLINE_SOON, ONLINE_TURN, REST_SPEED,
};

/// Samples by which an interval is foretold, at least one.
pub(crate) fn horizon_samples(band: f64, period: f64) -> usize {
    ((ONLINE_HORIZON_BANDS / (band * period)).round() as usize).max(1)
}

/// Where a residual is foretold to lie.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Foretold {
    /// Middle of the interval, from the model's torque, N m or N.
    pub(crate) centre: f64,
    pub(crate) half_width: f64,
}

impl Foretold {
    pub(crate) fn holds(&self, error: f64) -> bool {
        (error - self.centre).abs() <= self.half_width
    }
}

/// What the model says of a sample, and how the joint moves there.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Stated {
    /// Half width of the model's interval where the joint moves, N m or N.
    pub(crate) half_width: f64,
    /// What it is wider by at rest, N m or N.
    pub(crate) allowance: f64,
    /// rad/s or m/s.
    pub(crate) speed: f64,
}

/// A sample that has been seen.
#[derive(Debug, Clone, Copy)]
struct Seen {
    /// Error over the model's deviation; `None`: nothing is learnt from it.
    error: Option<f64>,
    /// What was left of it beside the foretold middle.
    left: f64,
    missed: bool,
    /// Whether the joint had turned back within the horizon.
    turned: bool,
}

/// Mean of squares that is forgotten.
#[derive(Debug, Clone, Copy)]
struct Mean {
    /// What a sample keeps of its weight for the next.
    keep: f64,
    squares: f64,
    weight: f64,
}

impl Mean {
    /// Over so many samples, as if they had all been of one square.
    fn over(samples: f64, square: f64) -> Self {
        let samples = samples.max(1.0);
        Self {
            keep: libm::exp(-1.0 / samples),
            squares: square * samples,
            weight: samples,
        }
    }

    fn add(&mut self, value: f64) {
        self.squares = self.keep * self.squares + value * value;
        self.weight = self.keep * self.weight + 1.0;
    }

    fn value(&self) -> f64 {
        self.squares / self.weight
    }
}

/// What is known of residuals of one kind: how the next goes with the last, and how large what is left of it is.
#[derive(Debug, Clone, Copy)]
struct Memory {
    along: f64,
    before: f64,
    left: [Mean; 2],
}

impl Memory {
    /// Over so many samples, as if they had all been correlated so and left one square.
    fn over(samples: f64, correlation: f64, square: f64) -> Self {
        Self {
            along: correlation * samples,
            before: samples,
            left: [1.0, ONLINE_SOON].map(|part| Mean::over(part * samples, square)),
        }
    }

    /// φ.
    fn share(&self) -> f64 {
        (self.along / self.before).clamp(-1.0, 1.0)
    }

    /// √(max S/N).
    fn spread(&self) -> f64 {
        self.left[0].value().max(self.left[1].value()).sqrt()
    }
}

/// One joint's interval on its way along the samples.
#[derive(Debug, Clone)]
pub(crate) struct OnlineInterval {
    horizon: usize,
    /// Part outside.
    tail: f64,
    /// Step of θ a sample.
    gain: f64,
    /// What a sample keeps of its weight for the next.
    keep: f64,
    /// Half width over deviation where the deviation is known from the memory's independent errors alone.
    unit: f64,
    /// The same of the normal distribution: between the model's half width and b.
    normal: f64,
    /// Newest last, at most twice the horizon.
    seen: VecDeque<Seen>,
    /// Of motion in one direction, and of the time after a turn.
    memories: [Memory; 2],
    theta: f64,
    /// Direction of the last motion.
    forwards: Option<bool>,
    /// Samples since it changed.
    since_turn: usize,
}

impl OnlineInterval {
    /// Of a confidence, for samples `period` s apart within a band, Hz.
    pub(crate) fn new(residual: &Residual, confidence: f64, band: f64, period: f64) -> Self {
        let horizon = horizon_samples(band, period);
        let tail = 1.0 - confidence;
        // 1 in the exponent is half of what the correlation time adds up: one side of it
        let correlation = libm::exp(-2.0 * horizon as f64 * period / residual.correlation_time);
        let memory = (ONLINE_MEMORY * residual.correlation_time / period).max(1.0);
        let square = 1.0 - correlation * correlation;
        Self {
            horizon,
            tail,
            gain: ONLINE_GAIN * 2.0 * band * period,
            keep: libm::exp(-1.0 / memory),
            // an exponential memory holds twice as many as its time constant has
            unit: quantile::student(2.0 * ONLINE_MEMORY, 0.5 * tail),
            normal: quantile::normal(0.5 * tail),
            seen: VecDeque::with_capacity(2 * horizon),
            memories: [
                Memory::over(memory, correlation, square),
                Memory::over(memory, 0.0, ONLINE_TURN * ONLINE_TURN * square),
            ],
            theta: 0.0,
            forwards: None,
            since_turn: horizon,
        }
    }

    /// Foretells the next sample, and then takes in its error.
    pub(crate) fn next(&mut self, stated: Stated, error: f64) -> Foretold {
        let turned = self.turned(stated.speed);
        let foretold = self.foretell(stated, turned);
        let deviation = stated.half_width / self.normal;
        let ratio = error / deviation;
        let is_told = stated.allowance <= 0.0 && ratio.is_finite();
        let left = (error - foretold.centre) / deviation;
        if self.seen.len() == 2 * self.horizon {
            self.seen.pop_front();
        }
        self.seen.push_back(Seen {
            error: is_told.then(|| ratio.clamp(-ONLINE_RATIO_MAX, ONLINE_RATIO_MAX)),
            left: left.clamp(-ONLINE_RATIO_MAX, ONLINE_RATIO_MAX),
            missed: !foretold.holds(error),
            turned,
        });
        foretold
    }

    /// Whether the joint has turned back, or begun to move, within the last horizon. Below the speed of rest it has no direction.
    fn turned(&mut self, speed: f64) -> bool {
        self.since_turn = self.since_turn.saturating_add(1);
        let forwards = Some(speed > 0.0);
        if speed.abs() >= REST_SPEED && forwards != self.forwards {
            self.forwards = forwards;
            self.since_turn = 0;
        }
        self.since_turn < self.horizon
    }

    fn foretell(&mut self, stated: Stated, turned: bool) -> Foretold {
        let Some(newest) = self.seen.len().checked_sub(self.horizon) else {
            return Foretold {
                centre: 0.0,
                half_width: stated.half_width + stated.allowance,
            };
        };
        let newest = self.seen[newest];
        if let Some(error) = newest.error {
            self.learn(error, newest);
        }
        let memory = &self.memories[usize::from(turned)];
        let deviation = stated.half_width / self.normal;
        let spread = memory.spread() * libm::exp(self.theta);
        Foretold {
            centre: memory.share() * newest.error.unwrap_or(0.0) * deviation,
            half_width: self.unit * spread * deviation + stated.allowance,
        }
    }

    fn learn(&mut self, error: f64, newest: Seen) {
        let earlier = (self.seen.len() == 2 * self.horizon).then(|| self.seen[0].error);
        let memory = &mut self.memories[usize::from(newest.turned)];
        if let Some(earlier) = earlier.flatten() {
            memory.along = self.keep * memory.along + error * earlier;
            memory.before = self.keep * memory.before + earlier * earlier;
        }
        for mean in &mut memory.left {
            mean.add(newest.left);
        }
        let missed = f64::from(u8::from(newest.missed));
        let most = libm::log(ONLINE_RATIO_MAX);
        self.theta = (self.theta + self.gain * (missed - self.tail)).clamp(-most, most);
    }
}

#[cfg(test)]
mod tests;
