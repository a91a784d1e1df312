//! The chains of published arms against values of other engines: poses, mass matrices and gravity torques, from
//! textbook formulas written out here.

mod arm;
mod puma;

use arm::{Arm, json};

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
