//! The published arms of `tests/vectors/robots`, with their drives where those are published too.

use std::fs;
use std::path::Path;

use nalgebra::{Matrix3, Vector3};
use serde_json::Value;
use takt_motion::robot::description::{
    Description, DhConvention, DhLink, DriveEntry, FrictionEntry, JointEntry, Kinematics,
};
use takt_motion::robot::spec::{Inertial, Limits, RobotSpec};

/// An arm and the values that other engines computed for it.
#[derive(Debug, Clone)]
pub(crate) struct Case {
    pub(crate) spec: RobotSpec,
    pub(crate) oracle: Value,
}

/// The chain that an oracle file names, out of a URDF.
pub(crate) fn from_urdf(folder: &str, urdf: &str, oracle: &str) -> Case {
    let oracle = json(&format!("{folder}/{oracle}"));
    let link = |key: &str| oracle[key].as_str().map(str::to_owned);
    let kinematics = Kinematics::Urdf {
        text: text(&format!("{folder}/{urdf}")),
        base_link: link("root_link"),
        tip_link: link("tip_link"),
    };
    resolved(kinematics, Vec::new(), oracle)
}

/// The PUMA 560 from its DH table, with rotors, gears, friction, and limits of torque and speed.
pub(crate) fn puma_from_table() -> Case {
    let file = json("puma560/puma560.json");
    let links = file["links"].as_array().expect("the file has links");
    let kinematics = Kinematics::Dh {
        convention: DhConvention::Standard,
        links: links.iter().map(dh_link).collect(),
    };
    resolved(kinematics, puma_joints(), json("puma560/oracle.json"))
}

/// The PUMA 560 from its URDF, with the same drives.
pub(crate) fn puma_from_urdf() -> Case {
    let kinematics = Kinematics::Urdf {
        text: text("puma560/puma560.urdf"),
        base_link: Some("base_link".to_owned()),
        tip_link: Some("flange".to_owned()),
    };
    resolved(kinematics, puma_joints(), json("puma560/oracle.json"))
}

fn resolved(kinematics: Kinematics, joints: Vec<JointEntry>, oracle: Value) -> Case {
    let description = Description {
        joints,
        gravity: Some(vector(&oracle["gravity"])),
        ..Description::new(kinematics)
    };
    let spec = description
        .resolve()
        .unwrap_or_else(|errors| panic!("{errors:#?}"))
        .spec;
    Case { spec, oracle }
}

fn dh_link(link: &Value) -> DhLink {
    let number = |key: &str| link[key].as_f64().unwrap_or(0.0);
    // As [xx yy zz xy yz xz].
    let [xx, yy, zz, xy, yz, xz] = numbers(&link["inertia"])[..] else {
        panic!("an inertia tensor has six entries");
    };
    DhLink {
        name: name(link),
        prismatic: false,
        a: number("a"),
        alpha: number("alpha"),
        d: number("d"),
        theta: number("theta"),
        mass: number("mass"),
        center_of_mass: vector(&link["com"]),
        inertia: Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz),
    }
}

fn puma_joints() -> Vec<JointEntry> {
    let file = json("puma560/puma560.json");
    let links = file["links"].as_array().expect("the file has links");
    links
        .iter()
        .map(|link| {
            let number = |key: &str| link[key].as_f64();
            let coulomb = numbers(&link["coulomb"]);
            let range = numbers(&link["qlim"]);
            JointEntry {
                name: name(link),
                limits: Limits {
                    position_lower: Some(range[0]),
                    position_upper: Some(range[1]),
                    velocity: number("velocity"),
                    ..Limits::default()
                },
                drive: DriveEntry {
                    peak_torque: number("effort"),
                    gear_ratio: number("gear_ratio"),
                    rotor_inertia: number("rotor_inertia"),
                    motor_friction: Some(FrictionEntry {
                        viscous: number("viscous"),
                        coulomb_positive: Some(coulomb[0]),
                        coulomb_negative: Some(-coulomb[1]),
                        ..FrictionEntry::default()
                    }),
                    ..DriveEntry::default()
                },
            }
        })
        .collect()
}

/// The payload of an oracle file, in the tip link's frame; `None`: it has none.
pub(crate) fn payload(oracle: &Value) -> Option<Inertial> {
    let payload = oracle.get("payload")?;
    // As [xx xy xz yy yz zz].
    let [xx, xy, xz, yy, yz, zz] = numbers(&payload["inertia"])[..] else {
        panic!("an inertia tensor has six entries");
    };
    Some(Inertial {
        mass: payload["mass"].as_f64().expect("a payload has a mass"),
        center_of_mass: vector(&payload["com"]),
        inertia: Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz),
    })
}

pub(crate) fn numbers(value: &Value) -> Vec<f64> {
    let list = value.as_array().expect("a list of numbers");
    list.iter().map(|number| number.as_f64().expect("a number")).collect()
}

fn vector(value: &Value) -> Vector3<f64> {
    Vector3::from_column_slice(&numbers(value))
}

fn name(link: &Value) -> String {
    link["joint"].as_str().expect("a joint has a name").to_owned()
}

fn json(path: &str) -> Value {
    serde_json::from_str(&text(path)).unwrap_or_else(|error| panic!("{path}: {error}"))
}

fn text(path: &str) -> String {
    let path = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../tests/vectors/robots")
        .join(path);
    fs::read_to_string(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}
