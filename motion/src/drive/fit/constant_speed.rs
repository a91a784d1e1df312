//! Friction on either side of a transmission from runs at constant speed, the axis along gravity (eq 8, 9):
//!
//! ```text
//! Fq = τE(Φ)        FΘ = τmotor − τE(Φ)        Fq + FΘ = τmotor
//! F  = Fc±·sgn ω + Fv·ω
//! ```
//!
//! At constant speed nothing accelerates, and about a vertical axis gravity asks nothing, so what the transmission carries is the output
//! side's friction and what the motor gives beyond it is its own. Where no deformation was measured only their sum is known.

use super::least_squares::{Fitted, fit_columns};
use super::recording::is_value;
use super::report::Missing;
use crate::error::Invalid;
use crate::robot::spec::Friction;
use crate::tolerance::{FIT_SAMPLES_MAX, FIT_VALUE_MAX, REST_SPEED, SPEEDS_APART};

/// One run: means over a time at constant speed, all seen from the joint.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Run {
    /// rad/s or m/s, in the direction of motion.
    pub speed: f64,
    /// Motor torque, N m or N.
    pub motor_torque: f64,
    /// Deformation of the transmission Θ − q, rad or m.
    pub deformation: Option<f64>,
}

/// Friction of one side.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SideFriction {
    /// Viscous and Coulomb friction, seen from the joint; the rest is 0.
    pub friction: Friction,
    /// Standard deviations of viscous, positive and negative Coulomb friction.
    pub deviations: [f64; 3],
    /// Standard deviation of the torque about the law, N m or N.
    pub residual: f64,
}

/// Friction from runs at constant speed.
#[derive(Debug, Clone, PartialEq)]
pub struct ConstantSpeed {
    /// Of both sides together.
    pub total: SideFriction,
    /// Of the output side and of the motor's side, where deformations and a stiffness are given.
    pub sides: Option<(SideFriction, SideFriction)>,
    /// What is odd, a sentence each.
    pub warnings: Vec<String>,
}

/// What runs at constant speed say.
#[derive(Debug, Clone, PartialEq)]
pub enum ConstantSpeedOutcome {
    /// Friction.
    Fitted(Box<ConstantSpeed>),
    /// The runs do not tell.
    Missing(Missing),
}

/// Fits friction to runs at constant speed. `stiffness` are the coefficients kⱼ of the transmission; empty where it is not known.
///
/// # Errors
/// Numbers that are none.
pub fn fit_constant_speed(runs: &[Run], stiffness: &[f64]) -> Result<ConstantSpeedOutcome, Vec<Invalid>> {
    let faults = check(runs, stiffness);
    if !faults.is_empty() {
        return Err(faults);
    }
    if let Some(message) = lacking(runs) {
        return Ok(missing(message));
    }
    let motor: Vec<f64> = runs.iter().map(|run| run.motor_torque).collect();
    let Some(total) = law(runs, &motor) else {
        return Ok(missing(
            "the speeds do not tell viscous from Coulomb friction: take speeds further apart".to_owned(),
        ));
    };
    let carried: Option<Vec<f64>> = runs
        .iter()
        .map(|run| run.deformation.map(|phi| elastic(stiffness, phi)))
        .collect();
    let sides = carried.filter(|_| !stiffness.is_empty()).and_then(|carried| {
        let rest: Vec<f64> = motor.iter().zip(&carried).map(|(m, c)| m - c).collect();
        law(runs, &carried).zip(law(runs, &rest))
    });
    let mut warnings = Vec::new();
    let named = [
        ("both sides", Some(&total)),
        ("the output side", sides.as_ref().map(|s| &s.0)),
        ("the motor's side", sides.as_ref().map(|s| &s.1)),
    ];
    for (name, side) in named {
        let Some(side) = side else { continue };
        let friction = &side.friction;
        if friction.viscous < 0.0 || friction.coulomb_positive < 0.0 || friction.coulomb_negative < 0.0 {
            warnings.push(format!(
                "{name}: a coefficient is below 0, which no friction is: the axis may not be along gravity, or torques have an offset"
            ));
        }
    }
    Ok(ConstantSpeedOutcome::Fitted(Box::new(ConstantSpeed {
        total,
        sides,
        warnings,
    })))
}

fn missing(message: String) -> ConstantSpeedOutcome {
    ConstantSpeedOutcome::Missing(Missing {
        parameters: Vec::new(),
        message,
    })
}

/// What the runs lack.
fn lacking(runs: &[Run]) -> Option<String> {
    if runs.len() < 4 {
        return Some(format!(
            "{} runs are too few, four are the least for three coefficients",
            runs.len()
        ));
    }
    if let Some(run) = runs.iter().find(|run| run.speed.abs() < REST_SPEED) {
        return Some(format!(
            "a run at {} rad/s is at rest: below {REST_SPEED} friction is not sliding",
            run.speed
        ));
    }
    for (way, name) in [(1.0, "positive"), (-1.0, "negative")] {
        let speeds = runs.iter().map(|run| run.speed * way).filter(|speed| *speed > 0.0);
        if speeds.count() == 0 {
            return Some(format!("no run in the {name} direction"));
        }
    }
    let apart = [1.0, -1.0].iter().any(|way| {
        let speeds = runs.iter().map(|run| run.speed * way).filter(|speed| *speed > 0.0);
        let (least, most) = speeds.fold((f64::INFINITY, 0.0_f64), |(a, b), s| (a.min(s), b.max(s)));
        most > least * SPEEDS_APART
    });
    (!apart)
        .then(|| "all runs of a direction have the same speed: viscous and Coulomb friction are then one".to_owned())
}

/// Viscous and Coulomb friction of torques at the runs' speeds.
fn law(runs: &[Run], torque: &[f64]) -> Option<SideFriction> {
    let column = |f: &dyn Fn(f64) -> f64| -> Vec<f64> { runs.iter().map(|run| f(run.speed)).collect() };
    let columns = [
        column(&|speed| speed),
        column(&|speed| if speed > 0.0 { 1.0 } else { 0.0 }),
        column(&|speed| if speed < 0.0 { -1.0 } else { 0.0 }),
    ];
    let Fitted {
        values,
        deviations,
        residual,
    } = fit_columns(&columns, torque)?;
    Some(SideFriction {
        friction: Friction {
            viscous: values[0],
            coulomb_positive: values[1],
            coulomb_negative: values[2],
            ..Friction::default()
        },
        deviations: [deviations[0], deviations[1], deviations[2]],
        residual,
    })
}

/// τE(Φ).
fn elastic(stiffness: &[f64], phi: f64) -> f64 {
    stiffness.iter().rev().fold(0.0, |sum, k| sum * phi * phi + k) * phi
}

fn check(runs: &[Run], stiffness: &[f64]) -> Vec<Invalid> {
    let mut faults = Vec::new();
    if runs.len() > FIT_SAMPLES_MAX {
        faults.push(Invalid::new(
            "runs",
            format!("{} runs, the most is {FIT_SAMPLES_MAX}", runs.len()),
        ));
    }
    for (i, run) in runs.iter().enumerate() {
        let values = [
            ("speed", run.speed),
            ("motor_torque", run.motor_torque),
            ("deformation", run.deformation.unwrap_or(0.0)),
        ];
        for (name, value) in values {
            if !is_value(value) {
                let message = format!("{value} must be a number up to {FIT_VALUE_MAX:e}");
                faults.push(Invalid::new(format!("runs[{i}].{name}"), message));
            }
        }
    }
    if let Some(i) = stiffness.iter().position(|k| !k.is_finite()) {
        faults.push(Invalid::new(
            format!("stiffness[{i}]"),
            format!("{} must be a number", stiffness[i]),
        ));
    }
    faults
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_arms::random;

    const STIFFNESS: [f64; 2] = [2e4, 4e8];

    /// The deformation under a torque, by Newton's method.
    fn deformation(torque: f64) -> f64 {
        let mut phi = torque / STIFFNESS[0];
        for _ in 0..60 {
            let slope = STIFFNESS[0] + 3.0 * STIFFNESS[1] * phi * phi;
            phi -= (elastic(&STIFFNESS, phi) - torque) / slope;
        }
        phi
    }

    fn runs(noise: f64, state: &mut u64) -> Vec<Run> {
        let speeds = [-1.5, -1.0, -0.5, -0.2, 0.2, 0.5, 1.0, 1.5];
        let of = |speed: f64| {
            let output = if speed > 0.0 { 3.0 } else { -2.0 } + 1.2 * speed;
            let motor = if speed > 0.0 { 4.0 } else { -5.0 } + 7.0 * speed;
            Run {
                speed,
                motor_torque: output + motor + noise * random(state),
                deformation: Some(deformation(output)),
            }
        };
        speeds.into_iter().map(of).collect()
    }

    #[test]
    fn friction_of_either_side_comes_back() {
        let ConstantSpeedOutcome::Fitted(found) = fit_constant_speed(&runs(0.0, &mut 1), &STIFFNESS).unwrap() else {
            panic!()
        };
        let ConstantSpeed { total, sides, warnings } = *found;
        let (output, motor) = sides.unwrap();
        let expected = [
            (total, [8.2, 7.0, 7.0]),
            (output, [1.2, 3.0, 2.0]),
            (motor, [7.0, 4.0, 5.0]),
        ];
        for (side, [viscous, positive, negative]) in expected {
            assert!((side.friction.viscous - viscous).abs() < 1e-9);
            assert!((side.friction.coulomb_positive - positive).abs() < 1e-9);
            assert!((side.friction.coulomb_negative - negative).abs() < 1e-9);
        }
        assert!(warnings.is_empty());
    }

    #[test]
    fn the_truth_is_within_two_deviations_as_often_as_it_should() {
        let state = &mut 2;
        let count = 400;
        let within = (0..count)
            .filter(|_| {
                let Ok(ConstantSpeedOutcome::Fitted(found)) = fit_constant_speed(&runs(0.3, state), &[]) else {
                    panic!()
                };
                let total = found.total;
                // Student's with five degrees of freedom
                (total.friction.viscous - 8.2).abs() < 2.571 * total.deviations[0]
            })
            .count();
        let part = within as f64 / f64::from(count);
        assert!((0.92..=0.98).contains(&part), "{part}");
    }

    #[test]
    fn what_runs_lack_is_said() {
        let run = |speed: f64| Run {
            speed,
            motor_torque: speed,
            deformation: None,
        };
        let said = |speeds: &[f64]| {
            let runs: Vec<Run> = speeds.iter().map(|speed| run(*speed)).collect();
            match fit_constant_speed(&runs, &[]).unwrap() {
                ConstantSpeedOutcome::Missing(missing) => missing.message,
                ConstantSpeedOutcome::Fitted(_) => panic!(),
            }
        };
        assert!(said(&[1.0, -1.0]).contains("too few"));
        assert!(said(&[1.0, 2.0, 3.0, 4.0]).contains("negative direction"));
        assert!(said(&[1.0, -1.0, 1.0, -1.0]).contains("same speed"));
        assert!(said(&[1.0, -1.0, 0.001, -2.0]).contains("at rest"));
        let broken = [run(f64::INFINITY); 4];
        assert_eq!(fit_constant_speed(&broken, &[f64::NAN]).unwrap_err().len(), 9);
    }
}
