use nalgebra::{Point3, Vector3};

use super::{LIMIT, accepted, arm, body, check_refused, check_warned, joint, robot, tip};
use crate::robot::spec::JointKind;
use crate::robot::urdf::Options;

#[test]
fn base_is_the_root_and_tip_the_only_leaf() {
    let (chain, warnings) = accepted(&arm(""), &Options::default());
    let names: Vec<&str> = chain.joints.iter().map(|joint| joint.name.as_str()).collect();
    assert_eq!(names, ["shoulder", "elbow"]);
    assert_eq!(warnings, Vec::<String>::new());
}

#[test]
fn several_leaves_ask_for_a_tip_and_are_listed() {
    let more = [
        "<link name='tool'/><link name='camera'/>".to_owned(),
        joint("t", "fixed", "lower", "tool", ""),
        joint("c", "fixed", "lower", "camera", ""),
    ]
    .concat();
    check_refused(
        &arm(&more),
        &Options::default(),
        &["tip_link", "2 links", "\"tool\"", "\"camera\""],
    );
    accepted(&arm(&more), &tip("tool"));
}

#[test]
fn a_list_of_leaves_is_capped() {
    let more: String = (0..50)
        .map(|i| {
            format!(
                "<link name='l{i}'/>{}",
                joint(&format!("j{i}"), "fixed", "lower", &format!("l{i}"), "")
            )
        })
        .collect();
    check_refused(&arm(&more), &Options::default(), &["50 links", "\"l7\" and 42 more"]);
}

#[test]
fn the_chain_may_begin_and_end_in_mid_tree() {
    let options = Options {
        base_link: Some("upper"),
        ..tip("lower")
    };
    let (chain, _) = accepted(&arm(""), &options);
    assert_eq!(chain.joints.len(), 1);
    assert_eq!(
        chain.joints[0].link.mass, 1.0,
        "what is above the base link is not counted"
    );
    // The shoulder is above the elbow, so this base moves, but nothing beyond it does here.
    let (chain, warnings) = accepted(&arm(""), &tip("upper"));
    assert_eq!(chain.joints.len(), 1);
    assert_eq!(
        chain.joints[0].link.mass, 3.0,
        "the lower arm beyond the tip is held still and counted"
    );
    check_warned(&warnings, &["\"elbow\" at 0.0"]);
}

#[test]
fn a_tip_that_is_not_below_the_base_is_refused() {
    let options = Options {
        base_link: Some("lower"),
        ..tip("upper")
    };
    check_refused(
        &arm(""),
        &options,
        &["tip_link", "\"upper\" is not below base link \"lower\""],
    );
}

#[test]
fn unknown_base_and_tip_are_both_named() {
    let options = Options {
        base_link: Some("nowhere"),
        ..tip("neither")
    };
    let errors = super::refused(&arm(""), &options);
    assert_eq!(
        errors,
        [
            "base_link: link \"nowhere\" is not in the URDF",
            "tip_link: link \"neither\" is not in the URDF"
        ]
    );
}

#[test]
fn a_chain_without_moving_joints_is_refused() {
    let text = robot(&format!(
        "<link name='a'/><link name='b'/>{}",
        joint("j", "fixed", "a", "b", "")
    ));
    check_refused(
        &text,
        &Options::default(),
        &["no joint moves between base link \"a\" and tip link \"b\""],
    );
    check_refused(&robot("<link name='a'/>"), &Options::default(), &["no joint moves"]);
}

#[test]
fn fixed_joints_fold_into_the_link_before_them() {
    let more = [
        body("hand", 0.5),
        joint(
            "flange",
            "fixed",
            "lower",
            "hand",
            "<origin xyz='0 0 0.25' rpy='0 1.5 0'/>",
        ),
    ]
    .concat();
    let (chain, _) = accepted(&arm(&more), &Options::default());
    let link = &chain.joints[1].link;
    assert_eq!(link.mass, 1.5);
    assert!((link.center_of_mass - Vector3::new(0.0, 0.0, 0.25 / 3.0)).norm() < 1e-15);
    assert_eq!(chain.link_from_tip.translation.vector, Vector3::new(0.0, 0.0, 0.25));
}

#[test]
fn a_fixed_joint_before_the_first_moves_its_frame_only() {
    let text = robot(
        &[
            body("world", 50.0),
            body("pedestal", 30.0),
            body("side", 20.0),
            body("arm", 1.0),
            joint("stand", "fixed", "world", "pedestal", "<origin xyz='0 0 2'/>"),
            joint("hinge", "revolute", "pedestal", "side", LIMIT),
            joint("turn", "continuous", "pedestal", "arm", "<origin xyz='0 0 1'/>"),
        ]
        .concat(),
    );
    let (chain, warnings) = accepted(&text, &tip("arm"));
    assert_eq!(chain.joints[0].parent_from_joint.translation.vector.z, 3.0);
    assert_eq!(chain.joints[0].link.mass, 1.0, "what hangs on the base counts nowhere");
    assert_eq!(warnings, Vec::<String>::new());
}

#[test]
fn side_branches_are_held_at_zero_or_the_nearest_limit() {
    let slide = "<origin xyz='0 0 1'/><axis xyz='0 0 2'/><limit lower='0.5' upper='0.75' effort='1' velocity='1'/>";
    let more = [
        "<link name='tool'/>".to_owned(),
        body("finger", 1.0),
        joint("t", "fixed", "lower", "tool", ""),
        joint("slide", "prismatic", "lower", "finger", slide),
    ]
    .concat();
    let (chain, warnings) = accepted(&arm(&more), &tip("tool"));
    // 1 kg at the origin and 1 kg at 1 + 0.5.
    assert_eq!(chain.joints[1].link.center_of_mass, Vector3::new(0.0, 0.0, 0.75));
    check_warned(&warnings, &["held still", "\"slide\" at 0.5"]);
}

#[test]
fn floating_and_planar_joints_are_held_beside_the_chain_and_refused_on_it() {
    let more = [body("bird", 1.0), joint("free", "floating", "lower", "bird", "")].concat();
    let (chain, _) = accepted(&arm(&more), &tip("lower"));
    assert_eq!(chain.joints[1].link.mass, 2.0);
    check_refused(&arm(&more), &tip("bird"), &["joint \"free\"", "floating"]);
}

#[test]
fn roll_pitch_and_yaw_turn_about_fixed_axes() {
    let text = arm("").replace("<origin xyz='1 0 0'/>", "<origin xyz='1 0 0' rpy='0.1 0.2 0.3'/>");
    let (chain, _) = accepted(&text, &Options::default());
    let matrix = chain.joints[1].parent_from_joint.rotation.to_rotation_matrix();
    let expected = nalgebra::Rotation3::from_euler_angles(0.1, 0.2, 0.3);
    assert!((matrix.matrix() - expected.matrix()).amax() < 1e-15);
}

#[test]
fn axes_are_made_unit_vectors_and_default_to_x() {
    let text = arm("").replacen("<axis xyz='0 0 1'/>", "<axis xyz='-0.000000 3 -4'/>", 1);
    let (chain, _) = accepted(&text, &Options::default());
    assert_eq!(chain.joints[0].axis, Vector3::new(0.0, 0.6, -0.8));
    assert!(chain.joints[0].axis.x.is_sign_positive());
    let text = arm("").replace("<axis xyz='0 0 1'/>", "");
    let (chain, _) = accepted(&text, &Options::default());
    assert_eq!(chain.joints[0].axis, Vector3::x());
}

#[test]
fn inertials_in_rotated_frames_are_turned_into_the_link() {
    let turned = "<link name='lower'><inertial><origin xyz='0 0 1' rpy='0 1.5707963267948966 0'/><mass value='1'/>\
        <inertia ixx='1' ixy='0' ixz='0' iyy='2' iyz='0' izz='3'/></inertial></link>";
    let text = arm("").replace(body("lower", 1.0).trim_end(), turned);
    let (chain, _) = accepted(&text, &Options::default());
    let inertia = chain.joints[1].link.inertia;
    assert!((inertia.diagonal() - Vector3::new(3.0, 2.0, 1.0)).norm() < 1e-15);
    assert_eq!(chain.joints[1].kind, JointKind::Revolute);
    let tip = chain.link_from_tip * Point3::origin();
    assert_eq!(tip, Point3::origin());
}
