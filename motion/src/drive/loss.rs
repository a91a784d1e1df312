//! Friction on one side of a transmission, seen from the joint.
//!
//! ```text
//! F(ω) = F_v·ω + F_q·ω·|ω| + (F_c± + k·|g|)·sgn ω
//! ```
//!
//! g is the joint's gravity torque. Coefficients of the motor's side are reflected by the gear ratio ξ: viscous ξ², Coulomb |ξ|,
//! quadratic |ξ|³, presliding ξ². The direction is always the joint's.
//!
//! Before a contact slides it is a spring (Dahl 1968): with z the part of the Coulomb torque that is in force and x the way,
//!
//! ```text
//! dz/dx = (1 − z·sgn ẋ)/δ        z(x) = s + (z₀ − s)·exp(−|x − x₀|/δ),   s = sgn(x − x₀),   δ = F_c/σ₀
//! ```
//!
//! so that between two turns z is a function of the way alone: nothing is stiff at speed, and standstill holds what it held.

use super::series::Series;
use crate::robot::spec::{Drive, Friction};
use crate::scalar::Real;
use crate::tolerance::{PRESLIDING_DEFAULT, PRESLIDING_SETTLED};

/// Friction on one side of a transmission, reflected to the joint.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Loss {
    pub(crate) viscous: f64,
    pub(crate) quadratic: f64,
    pub(crate) coulomb_positive: f64,
    pub(crate) coulomb_negative: f64,
    /// k.
    pub(crate) load: f64,
    /// δ, rad or m.
    pub(crate) presliding: f64,
}

impl Loss {
    /// Of the motor's side.
    pub(crate) fn of_motor(drive: &Drive) -> Self {
        Self::reflected(&drive.motor_friction, drive.gear_ratio.abs())
    }

    /// Of the joint's side.
    pub(crate) fn of_joint(drive: &Drive) -> Self {
        Self::reflected(&drive.joint_friction, 1.0)
    }

    fn reflected(friction: &Friction, ratio: f64) -> Self {
        let coulomb_positive = ratio * friction.coulomb_positive;
        let coulomb_negative = ratio * friction.coulomb_negative;
        let mean = 0.5 * (coulomb_positive + coulomb_negative);
        let presliding = match friction.presliding_stiffness {
            Some(stiffness) if stiffness > 0.0 && mean > 0.0 => mean / (ratio * ratio * stiffness),
            _ => PRESLIDING_DEFAULT,
        };
        Self {
            viscous: ratio * ratio * friction.viscous,
            quadratic: ratio * ratio * ratio * friction.quadratic,
            coulomb_positive,
            coulomb_negative,
            load: friction.load_coulomb,
            presliding,
        }
    }

    /// Whether there is a dry part.
    pub(crate) fn is_dry(&self) -> bool {
        self.coulomb_positive > 0.0 || self.coulomb_negative > 0.0 || self.load > 0.0
    }

    /// Sliding at a speed under a gravity torque; none at standstill.
    pub(crate) fn sliding(&self, velocity: f64, gravity: f64) -> f64 {
        self.wet(velocity) + self.dry(sign(velocity), gravity)
    }

    /// The part that depends on speed.
    #[inline]
    pub(crate) fn wet(&self, velocity: f64) -> f64 {
        velocity * (self.viscous + self.quadratic * velocity.abs())
    }

    /// The dry part, of which `part` (−1 to 1) is in force.
    #[inline]
    pub(crate) fn dry(&self, part: f64, gravity: f64) -> f64 {
        let magnitude = if part > 0.0 {
            self.coulomb_positive
        } else {
            self.coulomb_negative
        };
        part * (magnitude + self.load * gravity.abs())
    }

    /// The part of the dry friction that is in force after a way from where it was `part`.
    #[inline]
    pub(crate) fn part_after(&self, part: f64, way: f64) -> f64 {
        let direction = sign(way);
        let short = part - direction;
        if direction == 0.0 || short.abs() < PRESLIDING_SETTLED {
            return part;
        }
        direction + short * libm::exp(-way.abs() / self.presliding)
    }

    /// Sliding along a motion, with its rates.
    pub(crate) fn series(&self, velocity: Series, gravity: Series) -> Series {
        let direction = sign(velocity.0[0]);
        let magnitude = if direction > 0.0 {
            self.coulomb_positive
        } else {
            self.coulomb_negative
        };
        let load = gravity * (self.load * sign(gravity.0[0]));
        velocity * self.viscous
            + velocity * velocity * (self.quadratic * direction)
            + (load + velocity.splat(magnitude)) * direction
    }
}

/// −1, 0 or 1.
#[inline]
pub(crate) fn sign(value: f64) -> f64 {
    if value > 0.0 {
        1.0
    } else if value < 0.0 {
        -1.0
    } else {
        0.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn drive() -> Drive {
        let friction = Friction {
            viscous: 2.0e-3,
            coulomb_positive: 0.03,
            coulomb_negative: 0.04,
            load_coulomb: 0.05,
            quadratic: 1.0e-5,
            presliding_stiffness: Some(0.5),
        };
        Drive {
            gear_ratio: -50.0,
            motor_friction: friction,
            joint_friction: friction,
            ..Drive::default()
        }
    }

    /// Power is the same on either side of the gear: τ_joint·ω_joint = τ_motor·ω_motor, the joint's direction deciding.
    #[test]
    fn the_gear_keeps_the_power() {
        let drive = drive();
        let loss = Loss::of_motor(&drive);
        for omega in [-1.7, 0.3, 2.0] {
            let motor_speed: f64 = 50.0 * omega;
            let own = &drive.motor_friction;
            let coulomb = if omega > 0.0 {
                own.coulomb_positive
            } else {
                own.coulomb_negative
            };
            let power = own.viscous * motor_speed * motor_speed
                + own.quadratic * motor_speed.abs() * motor_speed * motor_speed
                + coulomb * motor_speed.abs()
                + own.load_coulomb * 7.0 * omega.abs();
            assert!((loss.sliding(omega, -7.0) * omega - power).abs() < 1e-12 * power);
        }
        assert_eq!(loss.sliding(0.0, 3.0), 0.0);
        // 0.035·50 over 0.5·50²
        assert!((loss.presliding - 0.035 / 25.0).abs() < 1e-15);
    }

    /// Against Dahl's differential equation, integrated in small steps with a turn in between.
    #[test]
    fn presliding_is_dahls() {
        let loss = Loss::of_joint(&drive());
        let (steps, mut followed, mut integrated) = (20_000, 0.0, 0.0);
        let mut turning = [(0.0, 0.0); 2];
        let way = |k: usize| {
            let x = 3.0 * loss.presliding * k as f64 / steps as f64;
            if k <= steps / 2 { x } else { 3.0 * loss.presliding - x }
        };
        for k in 0..steps {
            let dx = way(k + 1) - way(k);
            let middle = integrated + 0.5 * dx * (1.0 - integrated * sign(dx)) / loss.presliding;
            integrated += dx * (1.0 - middle * sign(dx)) / loss.presliding;
            if k == steps / 2 {
                followed = loss.part_after(turning[0].1, way(k) - turning[0].0);
                turning[1] = (way(k), followed);
            }
        }
        let last = loss.part_after(turning[1].1, way(steps) - turning[1].0);
        assert!((last - integrated).abs() < 1e-6, "{last} {integrated} {followed}");
    }

    #[test]
    fn rates_are_those_of_the_torque() {
        let loss = Loss::of_motor(&drive());
        let velocity = |t: f64| -1.0 + 2.0 * t - 3.0 * t * t;
        let gravity = |t: f64| 20.0 - 5.0 * t + 4.0 * t * t;
        let at = |t: f64| loss.sliding(velocity(t), gravity(t));
        let [value, rate, second] = loss
            .series(Series([-1.0, 2.0, -3.0]), Series([20.0, -5.0, 4.0]))
            .derivatives();
        let h = 1e-4;
        assert!((value - at(0.0)).abs() < 1e-12);
        assert!((rate - (at(h) - at(-h)) / (2.0 * h)).abs() < 1e-6);
        assert!((second - (at(h) - 2.0 * at(0.0) + at(-h)) / (h * h)).abs() < 1e-5);
    }
}
