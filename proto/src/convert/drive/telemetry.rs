//! Columns by joint become the rows by sample that estimators read.

use takt_motion::{drive::telemetry::Telemetry, robot::spec::RobotSpec};

use crate::{
    convert::{Findings, Path, quoted},
    v1,
};

/// A column of one joint.
pub(in crate::convert) type Column = fn(&v1::TelemetryColumns) -> &Vec<f64>;
type Rows = fn(&mut Telemetry) -> &mut Vec<f64>;

const COLUMNS: [(&str, Column, Rows); 8] = [
    ("position", |one| &one.position, |all| &mut all.output_position),
    ("velocity", |one| &one.velocity, |all| &mut all.output_velocity),
    (
        "acceleration",
        |one| &one.acceleration,
        |all| &mut all.output_acceleration,
    ),
    (
        "motor_position",
        |one| &one.motor_position,
        |all| &mut all.motor_position,
    ),
    ("motor_torque", |one| &one.motor_torque, |all| &mut all.motor_torque),
    ("motor_current", |one| &one.motor_current, |all| &mut all.motor_current),
    (
        "transmission_torque",
        |one| &one.transmission_torque,
        |all| &mut all.transmission_torque,
    ),
    (
        "external_torque",
        |one| &one.external_torque,
        |all| &mut all.external_torque,
    ),
];

/// Reads a block of samples. A value that is no finite number is a missing one, and no finding: whoever uses the sample
/// says that it was.
pub fn telemetry(wire: &v1::Telemetry, at: Path<'_>, robot: &RobotSpec, findings: &mut Findings) -> Telemetry {
    let joints_at = at.field("joints");
    let Some(joints) = in_model_order(&wire.joints, joints_at, robot, findings) else {
        return Telemetry::default();
    };
    let mut block = Telemetry {
        time: wire.time_s.clone(),
        ..Telemetry::default()
    };
    let count = wire.time_s.len();
    for (name, column, rows) in COLUMNS {
        if is_given(name, column, count, &joints, joints_at, findings) {
            *rows(&mut block) = by_sample(count, &joints, column, |_, value| value);
        }
    }
    const TORQUE: &str = "torque";
    if is_given(TORQUE, |one| &one.torque, count, &joints, joints_at, findings) {
        for (name, rows) in [
            ("motor_torque", &block.motor_torque),
            ("motor_current", &block.motor_current),
        ] {
            if !rows.is_empty() {
                let message = format!("must not be given together with `{name}`: both say what the motor does");
                findings.push(joints_at.index(joints[0].0).field(TORQUE), message);
            }
        }
        let at_shaft = |joint: usize, value: f64| value / robot.joints[joint].drive.gear_ratio;
        block.motor_torque = by_sample(count, &joints, |one| &one.torque, at_shaft);
    }
    block
}

/// The entries in model order, each with its place in the list.
pub(in crate::convert) fn in_model_order<'a>(
    wire: &'a [v1::TelemetryColumns],
    at: Path<'_>,
    robot: &RobotSpec,
    findings: &mut Findings,
) -> Option<Vec<(usize, &'a v1::TelemetryColumns)>> {
    let count = robot.joints.len();
    if wire.len() != count {
        findings.push(at, format!("has {} entries, the robot has {count} joints", wire.len()));
        return None;
    }
    let mut ordered = vec![None; count];
    for (index, entry) in wire.iter().enumerate() {
        let place = match entry.joint.as_str() {
            "" => Some(index),
            name => robot.joints.iter().position(|joint| joint.name == name),
        };
        let Some(place) = place else {
            let message = format!("the robot has no joint {}", quoted(&entry.joint));
            findings.push(at.index(index).field("joint"), message);
            return None;
        };
        if ordered[place].replace((index, entry)).is_some() {
            let message = format!("a second entry of {}", quoted(&robot.joints[place].name));
            findings.push(at.index(index).field("joint"), message);
            return None;
        }
    }
    ordered.into_iter().collect()
}

/// Whether every joint has a column, with one value a sample; that some have it and others not is a finding.
pub(in crate::convert) fn is_given(
    name: &'static str,
    column: Column,
    count: usize,
    joints: &[(usize, &v1::TelemetryColumns)],
    at: Path<'_>,
    findings: &mut Findings,
) -> bool {
    if joints.iter().all(|(_, one)| column(one).is_empty()) {
        return false;
    }
    let mut is_whole = true;
    for (index, one) in joints {
        let found = column(one).len();
        if found != count {
            let message = match found {
                0 => "must be given for every joint or for none".to_owned(),
                _ => format!("has {found} values, there are {count} times"),
            };
            findings.push(at.index(*index).field(name), message);
            is_whole = false;
        }
    }
    is_whole
}

fn by_sample(
    count: usize,
    joints: &[(usize, &v1::TelemetryColumns)],
    column: Column,
    convert: impl Fn(usize, f64) -> f64,
) -> Vec<f64> {
    let width = joints.len();
    let mut rows = vec![0.0; count * width];
    for (joint, (_, one)) in joints.iter().enumerate() {
        for (sample, value) in column(one).iter().enumerate() {
            rows[sample * width + joint] = convert(joint, *value);
        }
    }
    rows
}
