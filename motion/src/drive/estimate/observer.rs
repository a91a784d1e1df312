//! The observer of the motor's side ("controlling a robot arm based on adaptive friction", fig. 11):
//!
//! ```text
//! ω̂' = (τ − F̂)/B        F̂ = L·B·(ω̂ − ω)        ⇒   F̂' = L·(τ − B·ω' − F̂)
//! ```
//!
//! τ is every torque on the rotor but friction (τmotor − τJ), B its inertia, ω its measured speed. F̂ follows the friction as a
//! first-order lag of rate L. With τ and ω as straight lines between samples that lag has a closed form,
//!
//! ```text
//! F̂₁ = e·F̂₀ + (p − e)·y₀ + (1 − p)·y₁        e = exp(−L·Δ), p = (1 − e)/(L·Δ), y = τ − B·(ω₁ − ω₀)/Δ
//! ```
//!
//! a weighted mean for any time Δ between samples: the observer cannot be unstable. ω̂ = ω + F̂/(L·B) need not be kept.

/// How a lag of a certain rate goes over one step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct LagStep {
    /// What is kept of the state.
    keep: f64,
    /// What is taken of the input at the beginning, and at the end.
    before: f64,
    after: f64,
    /// Over the time of the step, 1/s.
    rate: f64,
}

/// State of one observer.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Observer {
    /// F̂, N m or N.
    pub(super) friction: f64,
    /// Torque on the rotor, and its speed, at the last sample.
    pub(super) torque: f64,
    pub(super) velocity: f64,
}

impl LagStep {
    /// A lag of so many 1/s over so many seconds, both above 0.
    pub(super) fn new(rate: f64, seconds: f64) -> Self {
        let angle = rate * seconds;
        let lost = -libm::expm1(-angle);
        let mean = lost / angle;
        Self {
            keep: 1.0 - lost,
            before: mean - (1.0 - lost),
            after: 1.0 - mean,
            rate: 1.0 / seconds,
        }
    }

    /// The lag's state after an input that went from one value to another in a straight line.
    #[inline(always)]
    pub(super) fn follow(&self, state: f64, before: f64, after: f64) -> f64 {
        self.keep * state + self.before * before + self.after * after
    }
}

impl Observer {
    /// Begins where the friction is not known: none.
    pub(super) fn reset(&mut self, torque: f64, velocity: f64) {
        *self = Self {
            friction: 0.0,
            torque,
            velocity,
        };
    }

    /// Takes in the torque on the rotor and its speed, a step after the last.
    #[inline(always)]
    pub(super) fn update(&mut self, lag: &LagStep, inertia: f64, torque: f64, velocity: f64) {
        let accelerating = inertia * (velocity - self.velocity) * lag.rate;
        self.friction = lag.follow(self.friction, self.torque - accelerating, torque - accelerating);
        (self.torque, self.velocity) = (torque, velocity);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_arms::random;

    const INERTIA: f64 = 0.4;

    /// A rotor at constant acceleration and friction: the estimate is 1 − exp(−L·t) of it, at any sample time.
    #[test]
    fn it_follows_as_a_first_order_lag_of_its_rate() {
        for (rate, step) in [(20.0, 0.001), (20.0, 0.05), (200.0, 0.05), (1000.0, 1.0), (0.1, 0.001)] {
            let lag = LagStep::new(rate, step);
            let mut observer = Observer::default();
            let (friction, acceleration) = (3.0, 2.0);
            let torque = INERTIA * acceleration + friction;
            observer.reset(torque, 0.0);
            for index in 1..=50 {
                let time = f64::from(index) * step;
                observer.update(&lag, INERTIA, torque, acceleration * time);
                let expected = friction * (1.0 - libm::exp(-rate * time));
                assert!((observer.friction - expected).abs() < 1e-11, "{rate} {step} {index}");
            }
        }
    }

    /// Against the observer's own differential equation, ω̂' = (τ − F̂)/B, in steps a thousand times finer.
    #[test]
    fn it_is_the_observer_of_the_figure() {
        let (rate, step, fine) = (30.0, 0.01, 2000);
        let torque = |t: f64| 2.0 + libm::sin(7.0 * t);
        let velocity = |t: f64| 0.5 * libm::sin(3.0 * t);
        let lag = LagStep::new(rate, step);
        let mut observer = Observer::default();
        observer.reset(torque(0.0), velocity(0.0));
        let mut speed = velocity(0.0);
        for index in 0..100 {
            let from = f64::from(index) * step;
            let (u0, u1) = (torque(from), torque(from + step));
            let (w0, w1) = (velocity(from), velocity(from + step));
            for part in 0..fine {
                // the midpoint rule on signals that are straight between samples
                let middle = (f64::from(part) + 0.5) / f64::from(fine);
                let h = step / f64::from(fine);
                let at = |speed: f64| {
                    let measured = w0 + (w1 - w0) * middle;
                    (u0 + (u1 - u0) * middle) / INERTIA - rate * (speed - measured)
                };
                let half = speed + 0.5 * h * at(speed);
                speed += h * at(half);
            }
            observer.update(&lag, INERTIA, u1, w1);
            let expected = rate * INERTIA * (speed - w1);
            assert!(
                (observer.friction - expected).abs() < 1e-5,
                "{index}: {} {expected}",
                observer.friction
            );
        }
    }

    #[test]
    fn jitter_does_not_shake_it() {
        let state = &mut 9;
        let mut observer = Observer::default();
        observer.reset(5.0, 0.0);
        let mut velocity = 0.0;
        for _ in 0..10_000 {
            let step = 10.0_f64.powf(-4.0 + 3.0 * random(state));
            velocity += 0.3 * step;
            observer.update(&LagStep::new(25.0, step), INERTIA, 5.0, velocity);
            assert!((0.0..=5.0).contains(&observer.friction), "{}", observer.friction);
        }
        assert!(
            (observer.friction - (5.0 - 0.3 * INERTIA)).abs() < 1e-6,
            "{}",
            observer.friction
        );
    }
}
