//! The PUMA 560's DH table, in the layout of its own file.

use serde_json::Value;
use takt_motion::nalgebra::{Matrix3, Vector3};
use takt_motion::robot::description::{Description, DhConvention, DhLink, Kinematics};

use super::arm::{json, numbers};

/// The table as a description.
pub(crate) fn description() -> Description {
    let file = json("tests/vectors/robots/puma560/puma560.json");
    let links = file["links"].as_array().expect("the file has links");
    Description::new(Kinematics::Dh {
        convention: DhConvention::Standard,
        links: links.iter().map(link).collect(),
    })
}

fn link(value: &Value) -> DhLink {
    let number = |key: &str| value[key].as_f64().unwrap_or(0.0);
    let [xx, yy, zz, xy, yz, xz] = numbers(&value["inertia"])[..] else {
        panic!("six entries of an inertia tensor");
    };
    DhLink {
        name: value["joint"].as_str().expect("a joint has a name").to_owned(),
        prismatic: false,
        a: number("a"),
        alpha: number("alpha"),
        d: number("d"),
        theta: number("theta"),
        mass: number("mass"),
        center_of_mass: Vector3::from_column_slice(&numbers(&value["com"])),
        inertia: Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz),
    }
}
