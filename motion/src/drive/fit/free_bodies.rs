//! Whether a fit that believes the described bodies should: what each joint's torque leaves, on stretches that were left out, where it
//! may choose the bodies beyond the joint by itself. Friction that is fitted on a wrong body takes on what is the body's.

use super::design::Design;
use super::linear::dot;
use super::motion::alone;
use super::normal::{Gram, Normal};
use super::report::Scope;
use super::signals::Signals;
use super::unknowns::Unknowns;
use crate::budget::Budget;
use crate::plan::Failure;
use crate::robot::Robot;
use crate::tolerance::FIT_FOLDS;

/// Error over torque of each joint, validated, with bodies of its own choice.
pub(crate) fn validated(robot: &Robot, signals: &Signals, budget: &Budget<'_>) -> Result<Vec<f64>, Failure> {
    let unknowns = Unknowns::new(robot, Scope::Bodies);
    let design = Design::new(robot, signals, &unknowns, budget)?;
    let normal = Normal::new(&design, signals, FIT_FOLDS, unknowns.count(), budget)?;
    let mut errors = Vec::with_capacity(design.rows.len());
    for (joint, rows) in design.rows.iter().enumerate() {
        let whole = normal.of_joint(joint);
        let mut square = 0.0;
        for (stretch, grams) in normal.stretches.iter().zip(&normal.grams) {
            let others = less(&whole, &grams[joint]);
            let mut solution = vec![0.0; unknowns.count()];
            for (unknown, value) in rows.unknowns.iter().zip(alone(&others, budget)?) {
                solution[*unknown] = value;
            }
            let residual = rows.residual_of(&solution, stretch.0, stretch.1);
            square += dot(&residual, &residual);
        }
        let torque = signals.of(&signals.torque[joint]);
        errors.push((square / dot(torque, torque).max(f64::MIN_POSITIVE)).sqrt());
    }
    Ok(errors)
}

/// The equations without those of a stretch.
fn less(whole: &Gram, part: &Gram) -> Gram {
    let minus = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a - b).collect();
    Gram {
        matrix: minus(&whole.matrix, &part.matrix),
        product: minus(&whole.product, &part.product),
    }
}
