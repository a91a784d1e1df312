//! Fits of one joint on the bench.

use takt_motion::{
    Invalid,
    drive::fit::{
        constant_speed::{Run, SideFriction},
        damping::Damping,
        stiffness::Stiffness,
    },
    robot::spec::RobotSpec,
};

use crate::{
    convert::{Findings, Path, quoted},
    v1,
};

/// The index of the joint that a fit is of; `field` is that of the fit.
pub fn joint(name: &str, field: &'static str, robot: Option<&RobotSpec>, findings: &mut Findings) -> Option<usize> {
    let found = robot?.joints.iter().position(|joint| joint.name == name);
    if found.is_none() {
        let message = format!("the robot has no joint {}", quoted(name));
        findings.push(Path::Root.field(field).field("joint"), message);
    }
    found
}

/// Reads runs at constant speed; their numbers are checked where they are fitted.
#[must_use]
pub fn runs(wire: &[v1::ConstantSpeedRun]) -> Vec<Run> {
    let runs = wire.iter().map(|run| Run {
        speed: run.speed,
        motor_torque: run.motor_torque,
        deformation: run.deformation,
    });
    runs.collect()
}

/// What a fit finds wrong, in the words of the wire.
#[must_use]
pub fn finding_on_bench(found: Invalid, field: &str) -> Invalid {
    let Invalid { path, message } = found;
    let path = match path.strip_prefix("time") {
        Some(rest) => format!("time_s{rest}"),
        None => path,
    };
    Invalid::new(format!("{field}.{path}"), message)
}

/// Writes a stiffness polynomial.
#[must_use]
pub fn stiffness_to_wire(fit: &Stiffness, joint: &str) -> v1::StiffnessFit {
    v1::StiffnessFit {
        joint: joint.to_owned(),
        stiffness: fit.coefficients.clone(),
        standard_error: fit.deviations.clone(),
        offset_torque: fit.offset,
        residual_torque: fit.residual,
        deformation_lower: fit.range.0,
        deformation_upper: fit.range.1,
    }
}

/// Writes what a free oscillation says; `damping` is what is left without the motor's own friction.
#[must_use]
pub fn damping_to_wire(fit: &Damping, damping: f64, joint: &str) -> v1::DampingFit {
    v1::DampingFit {
        joint: joint.to_owned(),
        damping_and_viscous: fit.viscous,
        damping,
        coulomb: fit.coulomb,
        stiffness: fit.stiffness,
        period_s: fit.period,
        standard_errors: fit
            .deviations
            .map_or_else(Vec::new, |(viscous, coulomb)| vec![viscous, coulomb]),
        decrement_of_first_pair: fit.decrement_of_first_pair,
    }
}

/// Writes friction at constant speed.
#[must_use]
pub fn constant_speed_to_wire(
    total: &SideFriction,
    sides: Option<&(SideFriction, SideFriction)>,
    warnings: Vec<String>,
    joint: &str,
) -> v1::ConstantSpeedFit {
    v1::ConstantSpeedFit {
        joint: joint.to_owned(),
        total: Some(side(total)),
        joint_side: sides.map(|(output, _)| side(output)),
        motor_side: sides.map(|(_, motor)| side(motor)),
        warnings,
    }
}

fn side(fit: &SideFriction) -> v1::SideFit {
    v1::SideFit {
        viscous: fit.friction.viscous,
        coulomb_positive: fit.friction.coulomb_positive,
        coulomb_negative: fit.friction.coulomb_negative,
        standard_errors: fit.deviations.to_vec(),
        residual_torque: fit.residual,
    }
}
