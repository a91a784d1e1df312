//! Where the tool is and how it moves: against other engines, and against differences of itself.

#[path = "oracle/arms.rs"]
#[allow(dead_code, reason = "shared with tests that need more of it")]
mod arms;

use arms::numbers;
use nalgebra::{DMatrix, DVector, Isometry3, Matrix3, Rotation3, Translation3, UnitQuaternion};
use takt_checker::arm::{Tool, ToolMotion};
use takt_checker::draw::{self, Draw};
use takt_checker::{Arm, Workspace};

/// Largest difference over 1 m, or 1 m/s: roundings, as the oracles agree with each other.
const AGREEMENT: f64 = 1e-12;

/// Half the time between the two states of a central difference, s; its error goes with the square.
const STEP: f64 = 1e-4;

/// What central differences are true to here: third derivatives of some hundred m/s³ times STEP²/6.
const DIFFERENCES: f64 = 1e-5;

/// Poses and Jacobians of the tip by Pinocchio 4.1.0 and MuJoCo 4.0.0 (`tests/vectors/robots/README.md`).
#[test]
fn tip_is_where_other_engines_have_it() {
    for (folder, urdf, oracle) in [
        ("ur5e", "ur5e.urdf", "oracle.json"),
        ("fr3", "fr3.urdf", "oracle.json"),
        ("panda", "fer.urdf", "oracle.json"),
        ("denso_hsr065", "denso_hsr065.urdf", "oracle.json"),
        ("stretch_re1", "stretch_re1.urdf", "oracle_chain.json"),
    ] {
        let case = arms::from_urdf(folder, urdf, oracle);
        let arm = Arm::new(&case.spec, None);
        let tool = Tool::new(&case.spec, Some(&Isometry3::identity()));
        let states = case.oracle["states"].as_array().expect("the file has states");
        for state in states {
            let [q, qd, qdd] = ["q", "qd", "qdd"].map(|key| numbers(&state[key]));
            let found = arm.tool_motion(&mut Workspace::default(), &tool, &q, &qd, &qdd);
            let [position, rotation] = ["tip_position", "tip_rotation"].map(|key| flat(&state[key]));
            assert!(
                off(found.position.as_slice(), &position) < AGREEMENT,
                "{folder}: {found:?}"
            );
            let axes = Matrix3::from_row_slice(&rotation);
            assert!((found.axes - axes).amax() < AGREEMENT, "{folder}: {found:?}");
            let jacobian = DMatrix::from_row_slice(6, q.len(), &flat(&state["jacobian"]));
            let rates = jacobian * DVector::from_vec(qd);
            assert!(
                off(found.velocity.as_slice(), &rates.as_slice()[..3]) < AGREEMENT,
                "{folder}"
            );
            assert!(
                off(found.angular_velocity.as_slice(), &rates.as_slice()[3..]) < AGREEMENT,
                "{folder}"
            );
        }
    }
}

#[test]
fn rates_are_the_differences_of_places() {
    let mut draw = Draw::seeded(11);
    for count in [1, 2, 4, 6, 7] {
        for _ in 0..20 {
            let spec = draw::arm(&mut draw, count);
            let tcp = Isometry3::from_parts(
                Translation3::from(draw::vector(&mut draw, 0.3)),
                UnitQuaternion::from_scaled_axis(draw::vector(&mut draw, 3.0)),
            );
            let (arm, tool) = (Arm::new(&spec, None), Tool::new(&spec, Some(&tcp)));
            let q = draw::values(&mut draw, count, 3.0);
            let qd = draw::values(&mut draw, count, 1.5);
            let qdd = draw::values(&mut draw, count, 5.0);
            // The joints' motion carried on for a time at constant acceleration.
            let at = |time: f64| -> ToolMotion {
                let carried = |joint: usize| q[joint] + time * (qd[joint] + 0.5 * time * qdd[joint]);
                let q: Vec<f64> = (0..count).map(carried).collect();
                let qd: Vec<f64> = (0..count).map(|joint| qd[joint] + time * qdd[joint]).collect();
                arm.tool_motion(&mut Workspace::default(), &tool, &q, &qd, &qdd)
            };
            let [before, now, after] = [-STEP, 0.0, STEP].map(at);
            let velocity = (after.position - before.position) / (2.0 * STEP);
            assert!((velocity - now.velocity).norm() < DIFFERENCES * now.velocity.norm().max(1.0));
            let acceleration = (after.velocity - before.velocity) / (2.0 * STEP);
            assert!((acceleration - now.acceleration).norm() < DIFFERENCES * now.acceleration.norm().max(1.0));
            let turned = Rotation3::from_matrix_unchecked(after.axes * before.axes.transpose());
            let spin = turned.scaled_axis() / (2.0 * STEP);
            assert!((spin - now.angular_velocity).norm() < DIFFERENCES * now.angular_velocity.norm().max(1.0));
        }
    }
}

fn off(found: &[f64], expected: &[f64]) -> f64 {
    let pairs = found.iter().zip(expected);
    pairs.map(|(one, other)| (one - other).abs()).fold(0.0, f64::max)
}

/// The numbers of a list, or of a list of lists, one after the other.
fn flat(value: &serde_json::Value) -> Vec<f64> {
    let entries = value.as_array().expect("a list");
    entries
        .iter()
        .flat_map(|entry| entry.as_f64().map_or_else(|| flat(entry), |number| vec![number]))
        .collect()
}
