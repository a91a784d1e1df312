//! The coefficients of friction that a controller learns while it runs: recursive least squares with forgetting, in two terms.
//!
//! ```text
//! ψ = [sgn ω, ω]     ε = y − ψ·f     L = Q·ψᵀ/(λ + ψ·Q·ψᵀ)     f ← f + L·ε     Q ← (Q − L·ψ·Q)/λ
//! ```
//!
//! ("controlling a robot arm based on adaptive friction", eq 15 to 20.) y is what the model's friction leaves over. At a turn the law knows
//! at once what the other direction takes, where an observer has to find out. At rest nothing is learned and nothing forgotten, and Q never
//! exceeds its start: a joint that runs at one speed only does not wind up. For reports of friction with what is known of it,
//! there are the estimators; this is the part that a control loop can afford.

use super::loss::sign;
use crate::tolerance::{ADAPT_PRIOR, ADAPT_REST};

/// What was learned of one side's friction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Learned {
    /// Coulomb torque beyond the model's.
    pub coulomb: f64,
    /// Viscous coefficient beyond the model's.
    pub viscous: f64,
    /// Q: both variances and the covariance, over that of a sample.
    pub spread: [f64; 3],
}

impl Default for Learned {
    fn default() -> Self {
        Self {
            coulomb: 0.0,
            viscous: 0.0,
            spread: [ADAPT_PRIOR, ADAPT_PRIOR, 0.0],
        }
    }
}

impl Learned {
    /// Friction beyond the model's at a speed.
    #[must_use]
    pub fn friction(&self, velocity: f64) -> f64 {
        self.coulomb * sign(velocity) + self.viscous * velocity
    }

    /// Learns from one sample; `forget` is λ.
    pub(crate) fn learn(&mut self, velocity: f64, left: f64, forget: f64) {
        if velocity.abs() < ADAPT_REST {
            return;
        }
        let direction = sign(velocity);
        let [cc, vv, cv] = self.spread;
        let (c, v) = (cc * direction + cv * velocity, cv * direction + vv * velocity);
        let weight = 1.0 / (forget + direction * c + velocity * v);
        let error = left - self.friction(velocity);
        self.coulomb += c * weight * error;
        self.viscous += v * weight * error;
        let next = [
            (cc - c * c * weight) / forget,
            (vv - v * v * weight) / forget,
            (cv - c * v * weight) / forget,
        ];
        if next[0] <= ADAPT_PRIOR && next[1] <= ADAPT_PRIOR {
            self.spread = next;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_arms::random;

    /// Without forgetting it is the least squares of all samples and of the prior, solved at once.
    #[test]
    fn it_is_the_batch_solution() {
        let state = &mut 3;
        let mut learned = Learned::default();
        let (mut aa, mut ab, mut bb) = (1.0 / ADAPT_PRIOR, 0.0, 1.0 / ADAPT_PRIOR);
        let (mut ay, mut by) = (0.0, 0.0);
        for _ in 0..500 {
            let velocity = 0.1f64.copysign(random(state)) + random(state);
            if velocity.abs() < ADAPT_REST {
                continue;
            }
            let left = 3.0 * velocity.signum() + 0.7 * velocity + 0.2 * random(state);
            learned.learn(velocity, left, 1.0);
            let s = velocity.signum();
            (aa, ab, bb) = (aa + s * s, ab + s * velocity, bb + velocity * velocity);
            (ay, by) = (ay + s * left, by + velocity * left);
        }
        let determinant = aa * bb - ab * ab;
        assert!((learned.coulomb - (bb * ay - ab * by) / determinant).abs() < 1e-9);
        assert!((learned.viscous - (aa * by - ab * ay) / determinant).abs() < 1e-9);
    }

    #[test]
    fn one_speed_and_rest_do_not_wind_it_up() {
        let mut learned = Learned::default();
        for k in 0..1_000_000 {
            learned.learn(if k % 3 == 0 { 0.0 } else { 0.5 }, 2.0, 0.99);
        }
        assert!((learned.friction(0.5) - 2.0).abs() < 1e-6, "{learned:?}");
        assert!(learned.spread[0] <= ADAPT_PRIOR && learned.spread[1] <= ADAPT_PRIOR);
        let before = learned;
        learned.learn(0.0, 100.0, 0.99);
        assert_eq!(before, learned);
    }
}
