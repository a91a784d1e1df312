//! What the domain finds wrong, with the paths of the wire.

use takt_motion::{Invalid, robot::spec::RobotSpec};

use crate::{convert::quoted, v1};

/// A finding on the resolved arm, where joints stand in model order, as a finding on the description that it came from.
#[must_use]
pub fn finding_on_spec(invalid: Invalid, spec: &RobotSpec, wire: &v1::RobotDescription) -> Invalid {
    let Some((index, rest)) = indexed("joints", &invalid.path) else {
        return finding_on_description(invalid, wire);
    };
    let Some(joint) = spec.joints.get(index) else {
        return invalid;
    };
    let entry = wire.joints.iter().position(|entry| entry.name == joint.name);
    let row = wire.dh.as_ref();
    let row = row.and_then(|table| table.links.iter().position(|row| row.name == joint.name));
    let on_link = rest.strip_prefix("link");
    let fitted = wire.link_inertia.iter().position(|body| body.joint == joint.name);
    if let (Some(rest), Some(fitted)) = (on_link, fitted) {
        let message = format!("joint {}: {}", quoted(&joint.name), invalid.message);
        return Invalid::new(format!("link_inertia[{fitted}]{rest}"), message);
    }
    let path = match (on_link, entry, row) {
        (Some(rest), _, Some(row)) => format!("dh.links[{row}]{rest}"),
        (None, Some(entry), _) => format!("joints[{entry}]{}{rest}", if rest.is_empty() { "" } else { "." }),
        (_, None, Some(row)) => format!("dh.links[{row}]"),
        _ => "urdf".to_owned(),
    };
    let message = format!("joint {}: {}", quoted(&joint.name), invalid.message);
    finding_on_description(Invalid::new(path, message), wire)
}

/// A finding on the domain's description with the names that the wire has for its fields.
#[must_use]
pub fn finding_on_description(mut invalid: Invalid, wire: &v1::RobotDescription) -> Invalid {
    let Some((index, rest)) = indexed("joints", &invalid.path) else {
        return invalid;
    };
    let sides = [
        ("drive.motor_friction", v1::friction::Side::Motor),
        ("drive.joint_friction", v1::friction::Side::Joint),
    ];
    for (name, side) in sides {
        let Some(below) = rest.strip_prefix(name) else {
            continue;
        };
        let drive = wire.joints.get(index).and_then(|joint| joint.drive.as_ref());
        let entry = drive.and_then(|drive| drive.friction.iter().position(|entry| entry.side == i32::from(side)));
        let entry = entry.map_or(String::new(), |entry| format!("[{entry}]"));
        invalid.path = format!("joints[{index}].drive.friction{entry}{below}");
        return invalid;
    }
    invalid
}

/// The index and the rest of a path that begins with an entry of a list.
fn indexed<'a>(list: &str, path: &'a str) -> Option<(usize, &'a str)> {
    let rest = path.strip_prefix(list)?.strip_prefix('[')?;
    let (index, rest) = rest.split_once(']')?;
    Some((index.parse().ok()?, rest.strip_prefix('.').unwrap_or(rest)))
}
