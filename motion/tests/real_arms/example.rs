//! The example descriptions in `robots/`, as far as motion knows of the wire: DH tables, limits and drives.

use serde_json::Value;
use takt_motion::nalgebra::{Isometry3, Matrix3, Quaternion, Translation3, UnitQuaternion, Vector3};
use takt_motion::robot::description::{
    Description, DhConvention, DhLink, DriveEntry, FrictionEntry, JointEntry, Kinematics,
};
use takt_motion::robot::spec::{Inertial, Limits};

use super::arm::{json, numbers};

/// The description in `robots/{name}.json`.
pub(crate) fn description(name: &str) -> Description {
    let file = json(&format!("robots/{name}.json"));
    let convention = match file["dh"]["convention"].as_str() {
        Some("STANDARD") => DhConvention::Standard,
        Some("MODIFIED") => DhConvention::Modified,
        other => panic!("convention {other:?}"),
    };
    Description {
        joints: array(&file["joints"]).iter().map(entry).collect(),
        payload: file.get("payload").map(inertial),
        tcp: file.get("tool").map(|tool| pose(&tool["tcp"])),
        ..Description::new(Kinematics::Dh {
            convention,
            links: array(&file["dh"]["links"]).iter().map(link).collect(),
        })
    }
}

fn link(value: &Value) -> DhLink {
    let number = |key: &str| value[key].as_f64().expect("a number");
    let body = inertial(value);
    DhLink {
        name: text(&value["name"]),
        prismatic: value["type"] == "PRISMATIC",
        a: number("a_m"),
        alpha: number("alpha_rad"),
        d: number("d_m"),
        theta: number("theta_rad"),
        mass: body.mass,
        center_of_mass: body.center_of_mass,
        inertia: body.inertia,
    }
}

fn inertial(value: &Value) -> Inertial {
    let [xx, yy, zz, xy, xz, yz] = numbers(&value["inertia_kg_m2"])[..] else {
        panic!("six entries of an inertia tensor");
    };
    Inertial {
        mass: value["mass_kg"].as_f64().expect("a mass"),
        center_of_mass: Vector3::from_column_slice(&numbers(&value["center_of_mass_m"])),
        inertia: Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz),
    }
}

fn pose(value: &Value) -> Isometry3<f64> {
    let [x, y, z, w] = numbers(&value["orientation"])[..] else {
        panic!("four entries of a quaternion");
    };
    let position = Vector3::from_column_slice(&numbers(&value["position_m"]));
    let rotation = UnitQuaternion::new_unchecked(Quaternion::new(w, x, y, z));
    Isometry3::from_parts(Translation3::from(position), rotation)
}

fn entry(value: &Value) -> JointEntry {
    let limit = |key: &str| value["limits"][key].as_f64();
    let drive = |key: &str| value["drive"][key].as_f64();
    JointEntry {
        name: text(&value["name"]),
        limits: Limits {
            position_lower: limit("position_lower"),
            position_upper: limit("position_upper"),
            velocity: limit("velocity"),
            acceleration: limit("acceleration"),
            jerk: limit("jerk"),
            ..Limits::default()
        },
        drive: DriveEntry {
            peak_torque: drive("peak_torque"),
            rated_torque: drive("rated_torque"),
            gear_ratio: drive("gear_ratio"),
            rotor_inertia: drive("rotor_inertia_kg_m2"),
            motor_friction: friction(&value["drive"], "MOTOR"),
            joint_friction: friction(&value["drive"], "JOINT"),
            ..DriveEntry::default()
        },
    }
}

fn friction(drive: &Value, side: &str) -> Option<FrictionEntry> {
    let sides = drive.get("friction")?;
    let value = array(sides).iter().find(|entry| entry["side"] == side)?;
    Some(FrictionEntry {
        viscous: value["viscous"].as_f64(),
        coulomb_positive: value["coulomb_positive"].as_f64(),
        coulomb_negative: value["coulomb_negative"].as_f64(),
        ..FrictionEntry::default()
    })
}

fn array(value: &Value) -> &[Value] {
    value.as_array().map_or(&[], Vec::as_slice)
}

fn text(value: &Value) -> String {
    value.as_str().expect("a text").to_owned()
}
