//! An estimate as the friction of a model, for its next revision.
//!
//! The estimate replaces the terms of its law. Every other term was held at the model's value while it was made (`model`), so
//! that both together are what was measured: it stays.
//!
//! Friction takes power at every speed, and does not fall with speed within the speed limit v̂: no coefficient is below 0 but the quadratic one d, and
//! that not below −c/(2·v̂), so that the slope c + 2·d·v̂ is not below 0. Where an estimate breaks such a bound a·f + b ≥ 0 it is set on it, and the others
//! move to where they are likeliest then (the mean of their normal distribution given that: f − Σ·a·(a·f + b)/(a·Σ·a)).

use super::factor::lower;
use super::law::{FrictionLaw, at_the_joint};
use super::model::known;
use super::options::FrictionSide;
use super::report::{CommittedFriction, JointEstimate};
use crate::robot::spec::{Drive, Friction, Parameter, ParameterKind, Residual};
use crate::tolerance::SETTLED_VARIANCE;

use super::law::Term;

impl JointEstimate {
    /// The friction of the law's terms, seen from the joint, with what had to be changed so that it is physical.
    #[must_use]
    pub fn friction(&self) -> CommittedFriction {
        let mut values: Vec<f64> = self.coefficients.iter().map(|coefficient| coefficient.value).collect();
        let mut covariance = self.covariance.clone();
        let mut warnings = Vec::new();
        let bounds = self.bounds();
        // each round settles one bound for good
        for _ in 0..bounds.len() {
            let Some(broken) = worst(&bounds, &values, &covariance) else {
                break;
            };
            warnings.push(broken.says.clone());
            broken.condition(&mut values, &mut covariance);
        }
        // what was fitted to another bound can only break its own by rounding
        for bound in &bounds {
            if let [(index, a)] = bound.terms[..] {
                values[index] = values[index].max(-bound.constant / a);
            }
        }
        CommittedFriction {
            friction: self.law.friction(&values),
            warnings,
        }
    }

    /// What a commit writes, coefficient by coefficient, seen from the joint; `None` where the motion did not say enough.
    #[must_use]
    pub fn committed(&self) -> Option<Vec<f64>> {
        let committed = || self.law.coefficients(&self.friction().friction)[..self.law.count()].to_vec();
        self.missing.is_empty().then(committed)
    }

    /// Puts the friction into a drive, in the place of that side's; terms that the law does not have and the stiffness before
    /// sliding stay. The total friction stands for both sides', and is stated at the joint. Returns what had to be changed so
    /// that it is physical, and what was put together.
    pub fn commit(&self, drive: &mut Drive) -> Vec<String> {
        let CommittedFriction { friction, mut warnings } = self.friction();
        // stated where they stand, so that what stays stays to the last digit
        let keep = |friction: Friction, before: &Friction, gear_ratio: f64| {
            let rest = self.law.rest(before);
            let least = self
                .speed_limit
                .map_or(0.0, |limit| -friction.viscous / (2.0 * limit * gear_ratio.abs()));
            Friction {
                load_coulomb: friction.load_coulomb + rest.load_coulomb,
                // level at the speed limit may be an ulp below it
                quadratic: (friction.quadratic + rest.quadratic).max(least),
                presliding_stiffness: before.presliding_stiffness,
                ..friction
            }
        };
        let before = known(drive, self.side);
        if !self.law.by_direction && before.coulomb_positive.to_bits() != before.coulomb_negative.to_bits() {
            warnings.push(format!(
                "one Coulomb torque for both directions takes the place of the model's two, {:.4e} and {:.4e}",
                before.coulomb_positive, before.coulomb_negative
            ));
        }
        match self.side {
            FrictionSide::Total => {
                if !drive.motor_friction.is_zero() {
                    warnings.push(
                        "the total is stated at the joint: what the model had on the motor's side is part of it now"
                            .to_owned(),
                    );
                }
                drive.motor_friction = Friction::default();
                drive.joint_friction = keep(friction, &before, 1.0);
            }
            FrictionSide::Joint => drive.joint_friction = keep(friction, &drive.joint_friction, 1.0),
            FrictionSide::Motor => {
                let motor = at_the_joint(&friction, 1.0 / drive.gear_ratio);
                drive.motor_friction = keep(motor, &drive.motor_friction, drive.gear_ratio);
            }
        }
        warnings
    }

    /// Torque of friction at a speed ≠ 0, rad/s or m/s, and a gravity torque, N m or N; and its standard error.
    #[must_use]
    pub fn torque_at(&self, velocity: f64, gravity: f64) -> (f64, f64) {
        let psi = self.law.regressors(velocity, gravity);
        let count = self.coefficients.len();
        let torque = (0..count).map(|i| psi[i] * self.coefficients[i].value).sum();
        let variance: f64 = (0..count)
            .map(|i| {
                (0..count)
                    .map(|k| psi[i] * self.covariance[lower(i, k)] * psi[k])
                    .sum::<f64>()
            })
            .sum();
        (torque, libm::sqrt(variance.max(0.0)))
    }

    /// What the estimate leaves unsaid of the joint's torque; `None` before its correlation is known.
    #[must_use]
    pub fn residual(&self) -> Option<Residual> {
        Some(Residual {
            deviation: self.residual_rms,
            correlation_time: self.correlation_time?,
            degrees_of_freedom: self.residual_tails,
        })
    }

    /// The coefficients as parameters of a model's uncertainty, with their covariance (its lower triangle row by row). A Coulomb
    /// torque for both directions is two parameters that are off alike.
    #[must_use]
    pub fn parameters(&self, joint: usize) -> (Vec<Parameter>, Vec<f64>) {
        let of: Vec<(usize, ParameterKind)> = (0..self.coefficients.len())
            .flat_map(|index| kinds(self.law, index).iter().map(move |&kind| (index, kind)))
            .collect();
        let parameters = of.iter().map(|&(_, kind)| Parameter { joint, kind }).collect();
        let rows = of.iter().enumerate();
        let covariance = rows
            .flat_map(|(row, &(index, _))| of[..=row].iter().map(move |&(other, _)| lower(index, other)))
            .map(|entry| self.covariance[entry])
            .collect();
        (parameters, covariance)
    }

    fn bounds(&self) -> Vec<PhysicalBound> {
        let place = |term| (0..self.coefficients.len()).find(|&index| self.coefficients[index].term == term);
        let (viscous, quadratic) = (place(Term::Viscous), place(Term::Quadratic));
        let slope = viscous
            .zip(self.speed_limit)
            .filter(|_| quadratic.is_some() || self.held_quadratic < 0.0);
        let mut bounds = Vec::with_capacity(self.coefficients.len() + 1);
        for (index, coefficient) in self.coefficients.iter().enumerate() {
            if Some(index) == quadratic && slope.is_some() {
                continue;
            }
            bounds.push(PhysicalBound {
                terms: vec![(index, 1.0)],
                constant: 0.0,
                says: format!(
                    "the {} was estimated at {:.4e} with a standard error of {:.1e}: it is 0, and the other terms are fitted to that",
                    coefficient.term.name(),
                    coefficient.value,
                    coefficient.deviation
                ),
            });
        }
        if let Some((viscous, limit)) = slope {
            let mut terms = vec![(viscous, 1.0)];
            terms.extend(quadratic.map(|index| (index, 2.0 * limit)));
            bounds.push(PhysicalBound {
                terms,
                constant: 2.0 * limit * self.held_quadratic,
                says: format!(
                    "the friction that was estimated falls with speed below the limit of {limit:?}: it is level there, and the other terms are \
                     fitted to that{}",
                    match quadratic {
                        Some(_) => "",
                        None => "; the model's quadratic term stays, have it estimated too where viscous friction has become less",
                    }
                ),
            });
        }
        bounds
    }
}

/// What friction must not fall below: Σ aᵢ·fᵢ + b ≥ 0.
struct PhysicalBound {
    terms: Vec<(usize, f64)>,
    constant: f64,
    /// Of an estimate that breaks it.
    says: String,
}

impl PhysicalBound {
    fn at(&self, values: &[f64]) -> f64 {
        self.terms.iter().map(|&(index, a)| a * values[index]).sum::<f64>() + self.constant
    }

    /// Σ·a.
    fn column(&self, covariance: &[f64], count: usize) -> Vec<f64> {
        let entry = |row: usize| {
            self.terms
                .iter()
                .map(|&(index, a)| a * covariance[lower(row, index)])
                .sum()
        };
        (0..count).map(entry).collect()
    }

    fn variance(&self, column: &[f64]) -> f64 {
        self.terms.iter().map(|&(index, a)| a * column[index]).sum()
    }

    /// Makes the sum 0, and known.
    fn condition(&self, values: &mut [f64], covariance: &mut [f64]) {
        let count = values.len();
        let column = self.column(covariance, count);
        let (value, variance) = (self.at(values), self.variance(&column));
        for row in 0..count {
            values[row] -= column[row] * value / variance;
            for other in 0..=row {
                covariance[lower(row, other)] -= column[row] * column[other] / variance;
            }
        }
        if let [(only, a)] = self.terms[..] {
            values[only] = -self.constant / a;
            (0..count).for_each(|index| covariance[lower(index, only)] = 0.0);
        }
    }
}

/// The bound that is broken furthest, in standard errors. One that is settled has none left.
fn worst<'a>(bounds: &'a [PhysicalBound], values: &[f64], covariance: &[f64]) -> Option<&'a PhysicalBound> {
    let spread = |bound: &PhysicalBound| {
        let column = bound.column(covariance, values.len());
        let whole: f64 = bound
            .terms
            .iter()
            .map(|&(index, a)| a * a * covariance[lower(index, index)])
            .sum();
        let variance = bound.variance(&column);
        // what rounding leaves of a settled sum's variance is none
        (variance > SETTLED_VARIANCE * whole).then(|| libm::sqrt(variance))
    };
    bounds
        .iter()
        .filter(|bound| bound.at(values) < 0.0)
        .filter_map(|bound| Some((bound, bound.at(values) / spread(bound)?)))
        .min_by(|a, b| a.1.total_cmp(&b.1))
        .map(|(bound, _)| bound)
}

fn kinds(law: FrictionLaw, index: usize) -> &'static [ParameterKind] {
    match law.term(index) {
        Term::Coulomb => &[ParameterKind::CoulombPositive, ParameterKind::CoulombNegative],
        Term::CoulombPositive => &[ParameterKind::CoulombPositive],
        Term::CoulombNegative => &[ParameterKind::CoulombNegative],
        Term::Viscous => &[ParameterKind::Viscous],
        Term::LoadCoulomb => &[ParameterKind::LoadCoulomb],
        Term::Quadratic => &[ParameterKind::Quadratic],
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::drive::estimate::report::{Coefficient, SkippedOfJoint};

    fn estimate(law: FrictionLaw, values: &[f64], covariance: &[f64], side: FrictionSide) -> JointEstimate {
        let coefficients = values
            .iter()
            .enumerate()
            .map(|(index, &value)| Coefficient {
                term: law.term(index),
                value,
                known: 0.0,
                deviation: covariance[lower(index, index)].sqrt(),
                lower: value,
                upper: value,
                told: true,
            })
            .collect();
        JointEstimate {
            side,
            law,
            coefficients,
            covariance: covariance.to_vec(),
            degrees_of_freedom: Some(30.0),
            held_quadratic: 0.0,
            speed_limit: None,
            residual_rms: 0.5,
            residual_deviation: 0.4,
            correlation_time: Some(0.2),
            residual_tails: 6.0,
            friction_torque: None,
            used_count: 1,
            discounted_count: 0,
            skipped: SkippedOfJoint::default(),
            missing: Vec::new(),
        }
    }

    #[test]
    fn what_cannot_be_is_zero_and_the_rest_follows() {
        // Coulomb and viscous friction that could not be told apart: only their sum at 1 rad/s is known
        let given = estimate(
            FrictionLaw::default(),
            &[-1.0, 3.0],
            &[4.0, -3.99, 4.0],
            FrictionSide::Total,
        );
        let committed = given.friction();
        assert_eq!(committed.friction.coulomb_positive, 0.0);
        assert!((committed.friction.viscous - 2.0).abs() < 0.01, "{committed:?}");
        assert_eq!(committed.warnings.len(), 1);
        assert!(
            committed.warnings[0].contains("Coulomb torque"),
            "{:?}",
            committed.warnings
        );

        let given = estimate(
            FrictionLaw::default(),
            &[-1.0, -3.0],
            &[0.01, 0.0, 0.01],
            FrictionSide::Total,
        );
        let committed = given.friction();
        assert!(committed.friction.is_zero() && committed.warnings.len() == 2);
    }

    #[test]
    fn quadratic_friction_may_be_negative_as_far_as_friction_does_not_fall_within_the_speed_limit() {
        let law = FrictionLaw {
            quadratic: true,
            ..FrictionLaw::default()
        };
        let covariance = [0.01, 0.0, 0.04, 0.0, -0.01, 0.01];
        let of = |speed_limit| {
            let mut given = estimate(law, &[2.0, 3.0, -0.5], &covariance, FrictionSide::Total);
            given.speed_limit = speed_limit;
            given.friction()
        };
        assert_eq!(of(Some(2.0)).friction.quadratic, -0.5);
        assert!(of(Some(2.0)).warnings.is_empty());
        let level = of(Some(4.0));
        let slope = level.friction.viscous + 8.0 * level.friction.quadratic;
        assert!(slope.abs() < 1e-13 && level.friction.quadratic < 0.0, "{level:?}");
        assert!(
            level.friction.viscous < 3.0,
            "they are known to be off against each other"
        );
        assert!(
            level.warnings[0].contains("below the limit of 4.0"),
            "{:?}",
            level.warnings
        );
        let none = of(None);
        assert_eq!(none.friction.quadratic, 0.0);
        assert!(none.warnings[0].contains("it is 0"), "{:?}", none.warnings);

        // held at the model's, the viscous term must carry it
        let mut given = estimate(
            FrictionLaw::default(),
            &[2.0, 3.0],
            &[0.01, 0.0, 0.04],
            FrictionSide::Total,
        );
        (given.held_quadratic, given.speed_limit) = (-0.5, Some(4.0));
        assert!((given.friction().friction.viscous - 4.0).abs() < 1e-13);
        assert_eq!(given.friction().warnings.len(), 1);
    }

    #[test]
    fn a_commit_replaces_the_side_that_was_estimated() {
        let law = FrictionLaw {
            by_direction: true,
            ..FrictionLaw::default()
        };
        let covariance = [0.01, 0.0, 0.01, 0.0, 0.0, 0.01];
        let drive = Drive {
            gear_ratio: -50.0,
            motor_friction: Friction {
                viscous: 1.0,
                presliding_stiffness: Some(2.0),
                ..Friction::default()
            },
            joint_friction: Friction {
                viscous: 7.0,
                presliding_stiffness: Some(9000.0),
                ..Friction::default()
            },
            ..Drive::default()
        };
        let committed = |side| {
            let mut drive = drive.clone();
            let said = estimate(law, &[2.0, 3.0, 5.0], &covariance, side).commit(&mut drive);
            assert_eq!(said.len(), usize::from(side == FrictionSide::Total), "{said:?}");
            drive
        };
        let total = committed(FrictionSide::Total);
        assert!(total.motor_friction.is_zero());
        assert_eq!(
            (total.joint_friction.viscous, total.joint_friction.coulomb_negative),
            (5.0, 3.0)
        );
        assert_eq!(
            total.joint_friction.presliding_stiffness,
            Some(5000.0),
            "the softer of 2·50² and 9000"
        );
        let joint = committed(FrictionSide::Joint);
        assert_eq!(
            (joint.motor_friction, joint.joint_friction.coulomb_positive),
            (drive.motor_friction, 2.0)
        );
        let motor = committed(FrictionSide::Motor);
        assert_eq!(motor.joint_friction, drive.joint_friction);
        let back = at_the_joint(&motor.motor_friction, drive.gear_ratio);
        assert!((back.viscous - 5.0).abs() < 1e-12 && (back.coulomb_positive - 2.0).abs() < 1e-12);
        assert_eq!(motor.motor_friction.presliding_stiffness, Some(2.0));
    }

    /// Digit by digit: a ratio there and back would leave 0.30000000000000004.
    #[test]
    fn terms_that_the_law_does_not_have_stay_where_they_are() {
        let own = Friction {
            coulomb_positive: 4.0,
            coulomb_negative: 3.0,
            load_coulomb: 0.06,
            quadratic: 0.5,
            presliding_stiffness: Some(9000.0),
            ..Friction::default()
        };
        let motor = Friction {
            load_coulomb: 0.02,
            quadratic: 0.3e-5,
            ..Friction::default()
        };
        let drive = Drive {
            gear_ratio: -49.0,
            motor_friction: motor,
            joint_friction: own,
            ..Drive::default()
        };
        let load = FrictionLaw {
            load: true,
            ..FrictionLaw::default()
        };
        for (law, side) in [FrictionLaw::default(), load]
            .into_iter()
            .flat_map(|law| [FrictionSide::Total, FrictionSide::Joint, FrictionSide::Motor].map(|side| (law, side)))
        {
            let values = &[2.0, 5.0, 0.1][..law.count()];
            let mut after = drive.clone();
            let said = estimate(
                law,
                values,
                &[0.01, 0.0, 0.01, 0.0, 0.0, 0.01][..law.count() * (law.count() + 1) / 2],
                side,
            )
            .commit(&mut after);
            let [now, then] = [&after, &drive].map(|drive| known(drive, side));
            assert_eq!(
                (now.coulomb_positive, now.coulomb_negative),
                if side == FrictionSide::Motor {
                    let back = 49.0 * (2.0 / 49.0);
                    (back, back)
                } else {
                    (2.0, 2.0)
                }
            );
            assert_eq!(
                now.load_coulomb,
                if law.load { 0.1 } else { then.load_coulomb },
                "{law:?} {side:?}"
            );
            assert_eq!(
                (now.quadratic, now.presliding_stiffness),
                (then.quadratic, then.presliding_stiffness)
            );
            let directions = said.iter().any(|text| text.contains("both directions"));
            assert_eq!(directions, side != FrictionSide::Motor, "{said:?}");
        }
    }

    #[test]
    fn parameters_and_the_torques_error_say_the_same() {
        let given = estimate(
            FrictionLaw::default(),
            &[2.0, 3.0],
            &[0.04, 0.01, 0.09],
            FrictionSide::Total,
        );
        let (torque, deviation) = given.torque_at(-2.0, 0.0);
        assert!((torque + 8.0).abs() < 1e-14);
        assert!((deviation - (0.04_f64 + 2.0 * 2.0 * 0.01 + 4.0 * 0.09).sqrt()).abs() < 1e-14);
        let (parameters, covariance) = given.parameters(3);
        let kinds: Vec<ParameterKind> = parameters.iter().map(|parameter| parameter.kind).collect();
        assert_eq!(
            kinds,
            [
                ParameterKind::CoulombPositive,
                ParameterKind::CoulombNegative,
                ParameterKind::Viscous
            ]
        );
        assert_eq!(covariance, [0.04, 0.04, 0.04, 0.01, 0.01, 0.09]);
        assert_eq!(given.residual().map(|residual| residual.deviation), Some(0.5));
    }
}
