//! Friction laws that are linear in their coefficients:
//!
//! ```text
//! F(ω, g) = c±·sgn ω + v·ω + k·|g|·sgn ω + a·ω·|ω|
//! ```
//!
//! c: Coulomb torque (one, or one by direction), v: viscous, k: Coulomb torque that the load adds over the joint's gravity
//! torque g, a: torque over speed squared. Everything is seen from the joint: coefficients c on the motor's side become |ξ|·c, v becomes
//! ξ²·v, k stays, a becomes |ξ|³·a, and stiffness σ becomes ξ²·σ.

use crate::robot::spec::Friction;

/// Most terms that a law has.
pub const TERMS_MAX: usize = 5;

/// Entries of the lower triangle of the largest covariance.
pub(super) const TRIANGLE: usize = TERMS_MAX * (TERMS_MAX + 1) / 2;

/// Which terms friction is made of. Viscous friction is always one.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct FrictionLaw {
    /// A Coulomb torque for each direction, not one for both.
    pub by_direction: bool,
    /// A Coulomb torque in proportion to the gravity torque.
    pub load: bool,
    /// A torque in proportion to the speed squared.
    pub quadratic: bool,
}

/// One term of a friction law.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Term {
    /// Coulomb torque in either direction, N m or N.
    Coulomb,
    /// Coulomb torque moving in the positive direction.
    CoulombPositive,
    /// Coulomb torque moving in the negative direction, its magnitude.
    CoulombNegative,
    /// Torque over speed.
    Viscous,
    /// Coulomb torque over the magnitude of the gravity torque.
    LoadCoulomb,
    /// Torque over speed squared.
    Quadratic,
}

impl FrictionLaw {
    /// How many terms there are.
    #[must_use]
    pub fn count(self) -> usize {
        2 + usize::from(self.by_direction) + usize::from(self.load) + usize::from(self.quadratic)
    }

    /// The terms, in the order of every list of coefficients.
    #[must_use]
    pub fn terms(self) -> Vec<Term> {
        (0..self.count()).map(|index| self.term(index)).collect()
    }

    pub(super) fn term(self, index: usize) -> Term {
        let after = index.wrapping_sub(1 + usize::from(self.by_direction));
        match (index, after) {
            (0, _) if self.by_direction => Term::CoulombPositive,
            (0, _) => Term::Coulomb,
            (_, 0) => Term::Viscous,
            (_, 1) if self.load => Term::LoadCoulomb,
            (1, _) => Term::CoulombNegative,
            _ => Term::Quadratic,
        }
    }

    /// What each coefficient is multiplied by at a speed ≠ 0 and a gravity torque.
    #[inline(always)]
    pub(super) fn regressors(self, velocity: f64, gravity: f64) -> [f64; TERMS_MAX] {
        let (sign, positive, negative) = if velocity < 0.0 {
            (-1.0, 0.0, -1.0)
        } else {
            (1.0, 1.0, 0.0)
        };
        let (load, square) = (gravity.abs() * sign, velocity * velocity.abs());
        // whole rows: a place that depends on the law would send every sample through memory
        match (self.by_direction, self.load, self.quadratic) {
            (false, false, false) => [sign, velocity, 0.0, 0.0, 0.0],
            (false, false, true) => [sign, velocity, square, 0.0, 0.0],
            (false, true, false) => [sign, velocity, load, 0.0, 0.0],
            (false, true, true) => [sign, velocity, load, square, 0.0],
            (true, false, false) => [positive, negative, velocity, 0.0, 0.0],
            (true, false, true) => [positive, negative, velocity, square, 0.0],
            (true, true, false) => [positive, negative, velocity, load, 0.0],
            (true, true, true) => [positive, negative, velocity, load, square],
        }
    }

    /// How large each regressor can be on a joint: what makes coefficients of different units comparable.
    pub(super) fn scales(self, speed: f64, torque: f64) -> [f64; TERMS_MAX] {
        let mut scales = [1.0; TERMS_MAX];
        for (index, scale) in scales.iter_mut().enumerate().take(self.count()) {
            *scale = match self.term(index) {
                Term::Coulomb | Term::CoulombPositive | Term::CoulombNegative => 1.0,
                Term::Viscous => speed,
                Term::LoadCoulomb => torque,
                Term::Quadratic => speed * speed,
            };
        }
        scales
    }

    /// The coefficients that come closest to a friction.
    pub(super) fn coefficients(self, friction: &Friction) -> [f64; TERMS_MAX] {
        let mut coefficients = [0.0; TERMS_MAX];
        for (index, coefficient) in coefficients.iter_mut().enumerate().take(self.count()) {
            *coefficient = match self.term(index) {
                Term::Coulomb => 0.5 * (friction.coulomb_positive + friction.coulomb_negative),
                Term::CoulombPositive => friction.coulomb_positive,
                Term::CoulombNegative => friction.coulomb_negative,
                Term::Viscous => friction.viscous,
                Term::LoadCoulomb => friction.load_coulomb,
                Term::Quadratic => friction.quadratic,
            };
        }
        coefficients
    }

    /// The terms of a friction that the law does not have: an estimate holds them at their values.
    pub(super) fn rest(self, friction: &Friction) -> Friction {
        Friction {
            load_coulomb: if self.load { 0.0 } else { friction.load_coulomb },
            quadratic: if self.quadratic { 0.0 } else { friction.quadratic },
            ..Friction::default()
        }
    }

    /// The friction that has these coefficients, at the joint.
    pub(super) fn friction(self, coefficients: &[f64]) -> Friction {
        let mut friction = Friction::default();
        for (index, &coefficient) in coefficients.iter().enumerate().take(self.count()) {
            match self.term(index) {
                Term::Coulomb => {
                    friction.coulomb_positive = coefficient;
                    friction.coulomb_negative = coefficient;
                }
                Term::CoulombPositive => friction.coulomb_positive = coefficient,
                Term::CoulombNegative => friction.coulomb_negative = coefficient,
                Term::Viscous => friction.viscous = coefficient,
                Term::LoadCoulomb => friction.load_coulomb = coefficient,
                Term::Quadratic => friction.quadratic = coefficient,
            }
        }
        friction
    }
}

/// Friction stated on the motor's side, as the joint sees it.
pub(super) fn at_the_joint(motor: &Friction, gear_ratio: f64) -> Friction {
    let ratio = gear_ratio.abs();
    let square = ratio * ratio;
    Friction {
        viscous: square * motor.viscous,
        coulomb_positive: ratio * motor.coulomb_positive,
        coulomb_negative: ratio * motor.coulomb_negative,
        load_coulomb: motor.load_coulomb,
        quadratic: square * ratio * motor.quadratic,
        presliding_stiffness: motor.presliding_stiffness.map(|stiffness| square * stiffness),
    }
}

/// Torque of a friction at the joint, sliding at a speed; none at rest.
#[inline]
pub(super) fn torque(friction: &Friction, velocity: f64, gravity: f64) -> f64 {
    let load = friction.load_coulomb * gravity.abs();
    let smooth = (friction.viscous + friction.quadratic * velocity.abs()) * velocity;
    if velocity > 0.0 {
        return smooth + friction.coulomb_positive + load;
    }
    if velocity < 0.0 {
        return smooth - friction.coulomb_negative - load;
    }
    0.0
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every law there is.
    fn laws() -> impl Iterator<Item = FrictionLaw> {
        (0..8).map(|mask| FrictionLaw {
            by_direction: mask & 1 != 0,
            load: mask & 2 != 0,
            quadratic: mask & 4 != 0,
        })
    }

    #[test]
    fn regressors_times_coefficients_are_the_torque() {
        let friction = Friction {
            viscous: 0.7,
            coulomb_positive: 2.0,
            coulomb_negative: 2.0,
            ..Friction::default()
        };
        for law in laws() {
            let mut friction = friction;
            if law.by_direction {
                friction.coulomb_negative = 3.0;
            }
            friction.load_coulomb = if law.load { 0.05 } else { 0.0 };
            friction.quadratic = if law.quadratic { 0.4 } else { 0.0 };
            let coefficients = law.coefficients(&friction);
            assert_eq!(law.friction(&coefficients), friction, "{law:?}");
            assert_eq!(law.terms().len(), law.count());
            for velocity in [-2.0, -0.1, 0.3, 1.5] {
                let psi = law.regressors(velocity, -11.0);
                let sum: f64 = psi.iter().zip(coefficients).map(|(psi, f)| psi * f).sum();
                let direct = torque(&friction, velocity, -11.0);
                assert!((sum - direct).abs() < 1e-14, "{law:?}: {sum} {direct}");
            }
        }
    }

    /// The same power is lost whichever side the coefficients are stated on: F_j·ω_j = F_m·ω_m with ω_m = ξ·ω_j.
    #[test]
    fn a_gear_keeps_the_power_that_friction_takes() {
        let motor = Friction {
            viscous: 0.01,
            coulomb_positive: 0.2,
            coulomb_negative: 0.3,
            load_coulomb: 0.05,
            quadratic: 0.003,
            presliding_stiffness: None,
        };
        for ratio in [-50.0, -0.5, 3.0, 100.0_f64] {
            let joint = at_the_joint(&motor, ratio);
            for velocity in [-1.3, 0.4] {
                // the direction is the joint's, on either side; the motor carries the load over the ratio
                let motor_speed = ratio.abs() * velocity;
                let at_motor = torque(&motor, motor_speed, 20.0 / ratio) * motor_speed;
                let at_joint = torque(&joint, velocity, 20.0) * velocity;
                assert!((at_motor - at_joint).abs() < 1e-12 * at_joint, "{at_motor} {at_joint}");
            }
        }
    }
}
