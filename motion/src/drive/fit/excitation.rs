//! Whether a motion says what is asked of it, and what it would have to do where it does not.
//!
//! A joint must move both ways, and the columns of what is not known beforehand (viscous and Coulomb torque, rotors, the
//! payload's mass and first moment), each scaled to length 1, must be independent: a singular value of theirs below
//! [`EXCITATION_MIN`] belongs to a combination of parameters that the motion does not tell apart.

use super::linear::eigen;
use super::normal::Normal;
use super::report::{Missing, Scope, Unknown};
use super::signals::Signals;
use super::unknowns::Unknowns;
use crate::budget::{Budget, Stopped};
use crate::robot::Robot;
use crate::robot::spec::{Parameter, ParameterKind};
use crate::tolerance::{EXCITATION_MIN, EXCITATION_NAMED, FIT_PERIODS_MIN, REST_SPEED};

/// What is missing for a fit at all, before there are equations.
pub(crate) fn check_motion(robot: &Robot, signals: &Signals, band: f64) -> Vec<Missing> {
    let duration = signals.period * signals.count() as f64;
    if duration * band < FIT_PERIODS_MIN {
        let needed = FIT_PERIODS_MIN / band;
        let message = format!("{duration:.2} s are too short, a band of {band} Hz asks for {needed:.2} s at least");
        return vec![Missing {
            parameters: Vec::new(),
            message,
        }];
    }
    let mut missing = Vec::new();
    for (joint, of) in robot.spec().joints.iter().enumerate() {
        let speeds = signals.of(&signals.qd[joint]);
        let moving = |way: f64| speeds.iter().filter(|qd| **qd * way > REST_SPEED).count() as f64 * signals.period;
        let ways = [
            (1.0, "positive", ParameterKind::CoulombPositive),
            (-1.0, "negative", ParameterKind::CoulombNegative),
        ];
        for (way, name, kind) in ways {
            let time = moving(way);
            if time * band >= 1.0 {
                continue;
            }
            let message = format!(
                "joint \"{}\" moves for {time:.2} s in its {name} direction, {:.2} s are needed",
                of.name,
                1.0 / band
            );
            missing.push(Missing {
                parameters: vec![Unknown::Joint(Parameter { joint, kind })],
                message,
            });
        }
    }
    missing
}

/// What the equations leave open.
pub(crate) fn check_rank(
    robot: &Robot,
    normal: &Normal,
    unknowns: &Unknowns,
    scope: Scope,
    weights: &[f64],
    budget: &Budget<'_>,
) -> Result<Vec<Missing>, Stopped> {
    let asked: Vec<usize> = (0..unknowns.count())
        .filter(|k| is_asked(unknowns.list[*k], scope))
        .collect();
    let (matrix, _) = normal.sum(weights, None);
    let (n, size) = (unknowns.count(), asked.len());
    let length: Vec<f64> = asked.iter().map(|k| matrix[k * n + k].sqrt()).collect();
    let mut scaled = Vec::with_capacity(size * size);
    for (row, a) in asked.iter().zip(&length) {
        for (column, b) in asked.iter().zip(&length) {
            let product = a * b;
            scaled.push(if product > 0.0 {
                matrix[row * n + column] / product
            } else {
                0.0
            });
        }
    }
    let (values, vectors) = eigen(&scaled, size, budget)?;
    let mut missing = Vec::new();
    for (value, vector) in values.iter().zip(&vectors) {
        if *value >= EXCITATION_MIN * EXCITATION_MIN {
            continue;
        }
        let involved: Vec<Unknown> = asked
            .iter()
            .zip(vector)
            .filter(|(_, part)| part.abs() >= EXCITATION_NAMED)
            .map(|(k, _)| unknowns.list[*k])
            .collect();
        let names: Vec<String> = involved.iter().map(|unknown| name(robot, *unknown)).collect();
        let message = match names.as_slice() {
            [one] => format!("the motion says nothing of {one}"),
            several => format!(
                "the motion does not tell {} apart: it needs other speeds, accelerations or poses",
                several.join(", ")
            ),
        };
        missing.push(Missing {
            parameters: involved,
            message,
        });
    }
    Ok(missing)
}

/// Whether something must come from the motion: what is left is known beforehand, more or less.
fn is_asked(unknown: Unknown, scope: Scope) -> bool {
    use ParameterKind as K;
    match unknown {
        Unknown::Payload(part) => part < 4,
        Unknown::Joint(parameter) => match parameter.kind {
            K::Viscous | K::CoulombPositive | K::CoulombNegative => true,
            K::Armature => scope == Scope::Rotors,
            K::LoadCoulomb | K::Quadratic | K::Mass | K::FirstMoment(_) | K::Inertia(_) => false,
        },
    }
}

/// What a parameter is called in a sentence.
pub(crate) fn name(robot: &Robot, unknown: Unknown) -> String {
    use ParameterKind as K;
    const AXES: [&str; 3] = ["x", "y", "z"];
    const ENTRIES: [&str; 6] = ["xx", "yy", "zz", "xy", "xz", "yz"];
    let parameter = match unknown {
        Unknown::Payload(0) => return "the payload's mass".to_owned(),
        Unknown::Payload(k @ 1..=3) => return format!("the payload's first moment {}", AXES[k - 1]),
        Unknown::Payload(k) => return format!("the payload's inertia {}", ENTRIES[(k - 4).min(5)]),
        Unknown::Joint(parameter) => parameter,
    };
    let joint = robot
        .spec()
        .joints
        .get(parameter.joint)
        .map_or("", |joint| joint.name.as_str());
    let what = match parameter.kind {
        K::Mass => "mass".to_owned(),
        K::FirstMoment(axis) => format!("first moment {}", AXES[axis.min(2)]),
        K::Inertia(entry) => format!("inertia {}", ENTRIES[entry.min(5)]),
        K::Armature => "rotor inertia".to_owned(),
        K::Viscous => "viscous friction".to_owned(),
        K::CoulombPositive => "Coulomb friction in positive direction".to_owned(),
        K::CoulombNegative => "Coulomb friction in negative direction".to_owned(),
        K::LoadCoulomb => "load-dependent friction".to_owned(),
        K::Quadratic => "quadratic friction".to_owned(),
    };
    format!("{what} of joint \"{joint}\"")
}
