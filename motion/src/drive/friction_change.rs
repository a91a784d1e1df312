//! What becomes of a joint's friction from one model to the next, coefficient by coefficient: that of both sides of the gear
//! together, as seen from the joint (the law of `estimate/law.rs`, with a Coulomb torque by direction).

use super::estimate::{FrictionSide, known};
use crate::robot::spec::{Drive, Friction};

/// A coefficient of friction as a model has it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FrictionTerm {
    /// Coulomb torque moving in the positive direction, N m or N.
    CoulombPositive,
    /// Coulomb torque moving in the negative direction, its magnitude.
    CoulombNegative,
    /// Torque over speed.
    Viscous,
    /// Coulomb torque over the magnitude of the gravity torque.
    LoadCoulomb,
    /// Torque over speed squared.
    Quadratic,
    /// Torque over deflection before sliding.
    PreslidingStiffness,
}

/// One coefficient before and after.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FrictionChange {
    /// Which.
    pub term: FrictionTerm,
    /// What it was; a stiffness before sliding that is not stated is `None`.
    pub before: Option<f64>,
    /// What it becomes.
    pub after: Option<f64>,
}

/// Every coefficient that a joint has before or after.
#[must_use]
pub fn friction_changes(before: &Drive, after: &Drive) -> Vec<FrictionChange> {
    let [before, after] = [before, after].map(|drive| coefficients(&known(drive, FrictionSide::Total)));
    let pairs = before.into_iter().zip(after);
    let changes = pairs.map(|((term, before), (_, after))| FrictionChange { term, before, after });
    let is_there = |value: Option<f64>| value.is_some_and(|value| value != 0.0);
    changes
        .filter(|change| is_there(change.before) || is_there(change.after))
        .collect()
}

fn coefficients(friction: &Friction) -> [(FrictionTerm, Option<f64>); 6] {
    [
        (FrictionTerm::CoulombPositive, Some(friction.coulomb_positive)),
        (FrictionTerm::CoulombNegative, Some(friction.coulomb_negative)),
        (FrictionTerm::Viscous, Some(friction.viscous)),
        (FrictionTerm::LoadCoulomb, Some(friction.load_coulomb)),
        (FrictionTerm::Quadratic, Some(friction.quadratic)),
        (FrictionTerm::PreslidingStiffness, friction.presliding_stiffness),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sides_are_summed_at_the_joint_and_what_is_nowhere_is_not_listed() {
        let before = Drive {
            gear_ratio: -50.0,
            motor_friction: Friction {
                viscous: 0.001,
                coulomb_negative: 0.1,
                ..Friction::default()
            },
            joint_friction: Friction {
                viscous: 1.5,
                ..Friction::default()
            },
            ..Drive::default()
        };
        let mut after = before.clone();
        after.motor_friction = Friction::default();
        after.joint_friction.presliding_stiffness = Some(900.0);
        let change = |term, before, after| FrictionChange { term, before, after };
        assert_eq!(
            friction_changes(&before, &after),
            [
                change(FrictionTerm::CoulombNegative, Some(5.0), Some(0.0)),
                change(FrictionTerm::Viscous, Some(4.0), Some(1.5)),
                change(FrictionTerm::PreslidingStiffness, None, Some(900.0)),
            ]
        );
    }
}
