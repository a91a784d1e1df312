//! What the motion that an estimate stands on had: time in either direction, and the spread of speeds and loads, with the
//! estimate's own forgetting.

use super::law::{FrictionLaw, Term};
use super::report::MissingExcitation;
use crate::tolerance::{ESTIMATE_LOAD_SPREAD_MIN, ESTIMATE_MOTION_MIN, ESTIMATE_SPEED_SPREAD_MIN};

/// Sums over the samples used, each times its seconds.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Excitation {
    /// Seconds in the positive and in the negative direction.
    pub(super) seconds: [f64; 2],
    /// Of the speed's magnitude, and its square.
    pub(super) speed: [f64; 2],
    /// Of the gravity torque's magnitude, and its square.
    pub(super) load: [f64; 2],
}

impl Excitation {
    /// Takes in a sample that was used.
    #[inline(always)]
    pub(super) fn add(&mut self, velocity: f64, gravity: f64, lambda: f64, seconds: f64) {
        let (speed, load) = (velocity.abs(), gravity.abs());
        let negative = usize::from(velocity < 0.0);
        for index in 0..2 {
            self.seconds[index] *= lambda;
        }
        self.seconds[negative] += seconds;
        self.speed[0] = lambda * self.speed[0] + seconds * speed;
        self.speed[1] = lambda * self.speed[1] + seconds * speed * speed;
        self.load[0] = lambda * self.load[0] + seconds * load;
        self.load[1] = lambda * self.load[1] + seconds * load * load;
    }

    /// What it lacks for a law.
    pub(super) fn missing(&self, law: FrictionLaw, correlation_time: f64) -> Vec<MissingExcitation> {
        let needed = ESTIMATE_MOTION_MIN * correlation_time;
        let total = self.seconds[0] + self.seconds[1];
        if total < needed {
            return vec![MissingExcitation::Motion { seconds: total, needed }];
        }
        let mut missing = Vec::new();
        let part = 0.5 * needed;
        // a torque that the rigid body gets wrong is told from friction by moving both ways
        if self.seconds[0] < part {
            missing.push(MissingExcitation::PositiveDirection {
                seconds: self.seconds[0],
                needed: part,
            });
        }
        if self.seconds[1] < part {
            missing.push(MissingExcitation::NegativeDirection {
                seconds: self.seconds[1],
                needed: part,
            });
        }
        let (mean, deviation) = spread(self.speed, total);
        let wanted = ESTIMATE_SPEED_SPREAD_MIN * if law.quadratic { 2.0 } else { 1.0 };
        if deviation < wanted * mean {
            missing.push(MissingExcitation::SpeedsAlike {
                mean,
                deviation,
                needed: wanted * mean,
            });
        }
        if law.load {
            let (mean, deviation) = spread(self.load, total);
            if deviation <= ESTIMATE_LOAD_SPREAD_MIN * mean {
                missing.push(MissingExcitation::LoadsAlike {
                    mean,
                    deviation,
                    needed: ESTIMATE_LOAD_SPREAD_MIN * mean,
                });
            }
        }
        missing
    }
}

/// Mean and standard deviation.
fn spread(sums: [f64; 2], total: f64) -> (f64, f64) {
    let mean = sums[0] / total;
    (mean, libm::sqrt((sums[1] / total - mean * mean).max(0.0)))
}

impl MissingExcitation {
    /// What is missing, in a sentence.
    #[must_use]
    pub fn message(&self) -> String {
        match *self {
            Self::Motion { seconds, needed } => {
                format!("{seconds:.2} s of motion outside the dead band, it takes {needed:.2} s")
            }
            Self::PositiveDirection { seconds, needed } => {
                format!("no samples in the positive direction to speak of: {seconds:.2} s, it takes {needed:.2} s")
            }
            Self::NegativeDirection { seconds, needed } => {
                format!("no samples in the negative direction to speak of: {seconds:.2} s, it takes {needed:.2} s")
            }
            Self::SpeedsAlike {
                mean,
                deviation,
                needed,
            } => format!(
                "speeds too alike to separate viscous from Coulomb friction: {mean:.3} with a standard deviation of {deviation:.3}, \
                 it takes {needed:.3}"
            ),
            Self::LoadsAlike {
                mean,
                deviation,
                needed,
            } => format!(
                "gravity torques too alike to separate the load's friction: {mean:.3} with a standard deviation of {deviation:.3}, \
                 it takes {needed:.3}"
            ),
            Self::Untold {
                term,
                deviation,
                before,
            } => format!(
                "the samples hardly say anything of the {}: standard error {deviation:.3e}, {before:.3e} beforehand",
                term.name()
            ),
        }
    }
}

impl Term {
    /// Its name in a sentence.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Coulomb => "Coulomb torque",
            Self::CoulombPositive => "Coulomb torque in the positive direction",
            Self::CoulombNegative => "Coulomb torque in the negative direction",
            Self::Viscous => "viscous friction",
            Self::LoadCoulomb => "load's Coulomb torque",
            Self::Quadratic => "friction over speed squared",
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn after(law: FrictionLaw, samples: impl Iterator<Item = (f64, f64)>) -> Vec<MissingExcitation> {
        let mut excitation = Excitation::default();
        for (velocity, gravity) in samples {
            excitation.add(velocity, gravity, 0.9999, 0.001);
        }
        excitation.missing(law, 0.2)
    }

    #[test]
    fn each_lack_is_named() {
        let law = FrictionLaw {
            load: true,
            ..FrictionLaw::default()
        };
        use MissingExcitation::{LoadsAlike, Motion, NegativeDirection, PositiveDirection, SpeedsAlike};
        let speeds = |sign: f64| (0..9000).map(move |i| sign * (0.1 + 1e-4 * f64::from(i)));
        let loads = |speeds: Vec<f64>| speeds.into_iter().enumerate().map(|(i, v)| (v, (i % 50) as f64));
        let both: Vec<f64> = speeds(1.0).chain(speeds(-1.0)).collect();
        assert_eq!(after(law, loads(both.clone())), []);
        assert!(matches!(after(law, loads(both[..300].to_vec()))[..], [Motion { .. }]));
        assert!(matches!(
            after(law, loads(speeds(1.0).collect()))[..],
            [NegativeDirection { .. }]
        ));
        assert!(matches!(
            after(law, loads(speeds(-1.0).collect()))[..],
            [PositiveDirection { .. }]
        ));
        let same = both.iter().map(|v| 0.5 * v.signum()).collect();
        assert!(matches!(after(law, loads(same))[..], [SpeedsAlike { .. }]));
        let level = both.iter().map(|&v| (v, 0.0));
        assert!(matches!(after(law, level.clone())[..], [LoadsAlike { .. }]));
        assert_eq!(after(FrictionLaw::default(), level), []);
    }
}
