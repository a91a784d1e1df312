//! The chains of published arms against values of other engines: poses, mass matrices and gravity torques, from
//! textbook formulas written out here.

mod allocation;
mod arm;
mod example;
mod puma;

use takt_motion::robot::Robot;
use takt_motion::robot::resolve::Resolved;
use takt_motion::robot::urdf;

use arm::{Arm, json, text};

#[test]
fn ur5e() {
    Arm::urdf("ur5e", "ur5e.urdf", "oracle.json").check();
}

#[test]
fn fr3() {
    Arm::urdf("fr3", "fr3.urdf", "oracle.json").check();
}

#[test]
fn fr3_with_position_dependent_speed_limits() {
    Arm::urdf("fr3_position_limits", "fr3.urdf", "oracle.json").check();
}

#[test]
fn panda_whose_fourth_link_is_no_rigid_body() {
    let arm = Arm::urdf("panda", "fer.urdf", "oracle.json");
    arm.check();
    let is_named = |warning: &String| warning.contains("fer_link4") && warning.contains("triangle");
    assert!(
        arm.resolved.warnings.iter().any(is_named),
        "{:?}",
        arm.resolved.warnings
    );
}

#[test]
fn denso_scara_with_a_prismatic_joint() {
    Arm::urdf("denso_hsr065", "denso_hsr065.urdf", "oracle.json").check();
}

#[test]
fn stretch_with_head_and_wheels_held_still() {
    Arm::urdf("stretch_re1", "stretch_re1.urdf", "oracle_chain.json").check();
}

#[test]
fn puma560_from_its_urdf() {
    Arm::urdf("puma560", "puma560.urdf", "oracle.json").check();
}

#[test]
fn puma560_from_its_dh_table() {
    let oracle = json("tests/vectors/robots/puma560/oracle.json");
    Arm::described(puma::description(), oracle).check();
}

#[test]
fn every_arm_survives_being_written_as_a_urdf() {
    for (folder, urdf, oracle) in [
        ("ur5e", "ur5e.urdf", "oracle.json"),
        ("fr3", "fr3.urdf", "oracle.json"),
        ("denso_hsr065", "denso_hsr065.urdf", "oracle.json"),
        ("stretch_re1", "stretch_re1.urdf", "oracle_chain.json"),
    ] {
        Arm::urdf(folder, urdf, oracle).rewritten().check();
    }
}

/// Reading ends with an answer, whatever is missing.
#[test]
fn damaged_files_get_an_answer() {
    const CUTS: usize = 400;
    const LENGTH: usize = 37;
    for file in ["ur5e/ur5e.urdf", "stretch_re1/stretch_re1.urdf"] {
        let text = text(&format!("tests/vectors/robots/{file}"));
        for cut in 0..CUTS {
            let from = text.floor_char_boundary(cut * text.len() / CUTS);
            let to = text.floor_char_boundary((from + LENGTH).min(text.len()));
            let damaged = format!("{}{}", &text[..from], &text[to..]);
            if let Err(errors) = urdf::read(&damaged, &urdf::Options::default()) {
                assert!(!errors.is_empty());
            }
        }
    }
}

/// The example's figures are rounded to twelve digits, and the URDF's right angles to ten.
const EXAMPLE_TOLERANCE: f64 = 1e-6;

fn check_example(name: &str, folder: &str) {
    let oracle = json(&format!("tests/vectors/robots/{folder}/oracle.json"));
    let arm = Arm::described(example::description(name), oracle);
    arm.check_dynamics(EXAMPLE_TOLERANCE);
    assert_eq!(arm.resolved.warnings.len(), 0, "{:?}", arm.resolved.warnings);
}

#[test]
fn the_example_ur5e_moves_and_weighs_as_its_urdf() {
    check_example("ur5e", "ur5e");
}

#[test]
fn the_example_fr3_moves_and_weighs_as_its_urdf() {
    check_example("fr3", "fr3");
}

#[test]
fn the_example_puma560_is_the_published_one() {
    let oracle = json("tests/vectors/robots/puma560/oracle.json");
    let arm = Arm::described(example::description("puma560"), oracle);
    arm.check();
    let [first, third] = &arm.resolved.warnings[..] else {
        panic!("{:?}", arm.resolved.warnings);
    };
    assert!(
        first.contains("\"joint_1\": mass 0 with a rotational inertia"),
        "{first}"
    );
    assert!(third.contains("\"joint_3\": principal moments"), "{third}");
    let drives = arm.resolved.spec.joints.iter().map(|joint| &joint.drive);
    let reflected: Vec<f64> = drives
        .map(|drive| drive.gear_ratio.powi(2) * drive.rotor_inertia)
        .collect();
    let published = [0.78, 2.3, 0.58, 0.19, 0.17, 0.19];
    for (actual, expected) in reflected.iter().zip(published) {
        assert!((actual - expected).abs() < 0.05, "{reflected:?}");
    }
}

#[test]
fn the_example_scara_is_complete() {
    let resolved = example::description("scara").resolve().unwrap();
    assert_eq!(resolved.warnings.len(), 0, "{:?}", resolved.warnings);
    assert_eq!(resolved.spec.joints.len(), 4);
}

/// Each can hold itself up and accelerate, so its conventional pattern can be derived.
#[test]
fn the_examples_are_robots() {
    for name in ["ur5e", "fr3", "puma560", "scara"] {
        let Resolved { spec, warnings } = example::description(name).resolve().unwrap();
        let robot = Robot::new(spec, warnings).unwrap();
        for joint in 0..robot.joint_count() {
            assert!(robot.preset(joint).is_some(), "{name}: no preset for joint {joint}");
        }
    }
}
