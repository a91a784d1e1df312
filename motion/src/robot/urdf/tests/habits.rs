//! What real files do, in the order of how often.

use super::{LIMIT, accepted, arm, body, check_refused, check_warned, joint, robot, tip};
use crate::robot::spec::{Friction, JointKind};
use crate::robot::urdf::Options;

fn without_warnings() -> Vec<String> {
    Vec::new()
}

#[test]
fn joints_inside_other_elements_are_not_joints() {
    let more = "<ros2_control name='c' type='system'><joint name='shoulder'/><joint name='x' type='nonsense'/></ros2_control>\
        <transmission name='t'><joint name='elbow'/></transmission><gazebo><link name='g'/></gazebo>";
    let (chain, _) = accepted(&arm(more), &Options::default());
    assert_eq!(chain.joints.len(), 2);
}

#[test]
fn links_may_follow_the_joints_that_name_them() {
    let text = robot(
        &[
            joint("j", "revolute", "a", "b", LIMIT),
            body("b", 1.0),
            "<link name='a'/>".to_owned(),
        ]
        .concat(),
    );
    accepted(&text, &Options::default());
}

fn gripper(mimic: &str) -> String {
    let slide = "<axis xyz='0 0 1'/><limit lower='0.25' upper='0.5' effort='1' velocity='1'/>";
    arm(&[
        "<link name='tool'/>".to_owned(),
        body("left", 1.0),
        body("right", 1.0),
        joint("t", "fixed", "lower", "tool", ""),
        // The master stands later in the file.
        joint(
            "right",
            "prismatic",
            "lower",
            "right",
            &format!("<axis xyz='0 0 1'/><limit effort='1' velocity='1'/>{mimic}"),
        ),
        joint("left", "prismatic", "lower", "left", slide),
    ]
    .concat())
}

#[test]
fn a_mimic_beside_the_chain_stands_where_its_master_puts_it() {
    for (mimic, position) in [
        ("<mimic joint='left'/>", 0.25),
        ("<mimic joint='left' multiplier='-1'/>", -0.25),
        ("<mimic joint='left' multiplier='-2' offset='1'/>", 0.5),
    ] {
        let (chain, warnings) = accepted(&gripper(mimic), &tip("tool"));
        assert_eq!(
            chain.joints[1].link.center_of_mass.z,
            (0.25 + position) / 3.0,
            "{mimic}"
        );
        check_warned(&warnings, &[&format!("\"right\" at {position:?}, \"left\" at 0.25")]);
    }
}

#[test]
fn a_mimic_of_a_joint_of_the_chain_stands_where_zero_puts_it() {
    let (chain, warnings) = accepted(
        &gripper("<mimic joint='elbow' multiplier='3' offset='0.5'/>"),
        &tip("tool"),
    );
    assert_eq!(chain.joints[1].link.center_of_mass.z, 0.75 / 3.0);
    check_warned(&warnings, &["joint \"right\"", "mimics joint \"elbow\", which moves"]);
}

#[test]
fn a_mimic_of_nothing_stands_at_rest() {
    let (_, warnings) = accepted(&gripper("<mimic joint='gone'/>"), &tip("tool"));
    check_warned(&warnings, &["joint \"right\"", "\"gone\", which is not there"]);
}

#[test]
fn a_mimic_on_the_chain_is_refused() {
    check_refused(
        &gripper("<mimic joint='left'/>"),
        &tip("right"),
        &["joint \"right\" (line", "mimics joint \"left\""],
    );
}

#[test]
fn mimics_of_each_other_are_refused() {
    let text = gripper("<mimic joint='left'/>").replace(
        "upper='0.5' effort='1' velocity='1'/>",
        "upper='0.5'/><mimic joint='right'/>",
    );
    let errors = super::refused(&text, &tip("tool"));
    assert!(errors[0].contains("mimics itself by way of others"), "{errors:?}");
}

#[test]
fn continuous_joints_have_no_range_whatever_is_written() {
    for (limit, is_warned) in [
        ("", false),
        ("<limit effort='10' velocity='2'/>", false),
        ("<limit lower='0' upper='0' effort='10' velocity='2'/>", false),
        ("<limit lower='-3' upper='3' effort='10' velocity='2'/>", true),
    ] {
        let text = arm("")
            .replacen("'revolute'", "'continuous'", 1)
            .replacen(LIMIT, limit, 1);
        let (chain, warnings) = accepted(&text, &Options::default());
        assert_eq!(chain.joints[0].kind, JointKind::Continuous);
        assert_eq!(chain.joints[0].limits.position_lower, None);
        assert_eq!(chain.joints[0].limits.position_upper, None);
        assert_eq!(!warnings.is_empty(), is_warned, "{limit}: {warnings:?}");
    }
}

#[test]
fn effort_and_velocity_of_zero_are_unknown_and_stand_ins_pass() {
    for (written, effort, velocity) in [
        ("effort='0' velocity='0'", None, None),
        ("", None, None),
        ("effort='0.0' velocity='1'", None, Some(1.0)),
        ("effort='1000' velocity='50000'", Some(1000.0), Some(50000.0)),
    ] {
        let text = arm("").replacen(LIMIT, &format!("<limit lower='-1' upper='1' {written}/>"), 1);
        let (chain, warnings) = accepted(&text, &Options::default());
        assert_eq!(chain.joints[0].drive.peak_torque, effort);
        assert_eq!(chain.joints[0].limits.velocity, velocity);
        assert_eq!(warnings, without_warnings());
    }
}

#[test]
fn huge_limits_are_how_files_write_none() {
    let text = arm("").replacen(
        LIMIT,
        "<limit lower='-1e16' upper='1e16' effort='1e300' velocity='1e16'/>",
        1,
    );
    let (chain, warnings) = accepted(&text, &Options::default());
    assert_eq!(chain.joints[0].limits, crate::robot::spec::Limits::default());
    assert_eq!(chain.joints[0].drive.peak_torque, None);
    assert_eq!(warnings.len(), 3, "{warnings:?}");
}

#[test]
fn a_revolute_joint_without_limit_is_unlimited_with_a_warning() {
    for limit in ["", "<limit effort='1' velocity='1'/>"] {
        let text = arm("").replacen(LIMIT, limit, 1);
        let (chain, warnings) = accepted(&text, &Options::default());
        assert_eq!(chain.joints[0].limits.position_lower, None);
        check_warned(&warnings, &["joint \"shoulder\"", "unlimited"]);
    }
    let text = arm("").replacen(LIMIT, "<limit upper='2' effort='1' velocity='1'/>", 1);
    let (chain, _) = accepted(&text, &Options::default());
    assert_eq!(
        chain.joints[0].limits.position_lower,
        Some(0.0),
        "one of the two defaults to 0"
    );
}

fn lower_arm(inertial: &str) -> String {
    arm("").replace(
        body("lower", 1.0).trim_end(),
        &format!("<link name='lower'>{inertial}</link>"),
    )
}

fn inertial(mass: &str, xx: &str, yy: &str, zz: &str) -> String {
    format!(
        "<inertial><mass value='{mass}'/><inertia ixx='{xx}' ixy='0' ixz='0' iyy='{yy}' iyz='0' izz='{zz}'/></inertial>"
    )
}

#[test]
fn odd_bodies_are_warned_of_and_read() {
    for (body, words) in [
        (String::new(), "have no mass"),
        (inertial("0", "0", "0", "0"), "have no mass"),
        ("<inertial><mass value='1'/></inertial>".to_owned(), "point mass"),
        (inertial("1", "0", "0", "0"), "point mass"),
        (inertial("0", "0", "0.35", "0"), "is not a rigid body's"),
        (inertial("1", "0.1", "-0.01", "0.1"), "negative principal moment"),
        (inertial("1", "0.00368", "0.00796", "0.0127"), "triangle inequality"),
    ] {
        let (_, warnings) = accepted(&lower_arm(&body), &Options::default());
        check_warned(
            &warnings,
            &["\"lower\"", words].map(|part| {
                if words == "have no mass" && part == "\"lower\"" {
                    "\"elbow\""
                } else {
                    part
                }
            }),
        );
    }
}

#[test]
fn a_thin_rod_is_not_odd() {
    let (_, warnings) = accepted(&lower_arm(&inertial("1", "0.1", "0.1", "0")), &Options::default());
    assert_eq!(warnings, without_warnings());
}

#[test]
fn fixed_joints_may_have_axis_limit_and_no_origin() {
    let more = [
        "<link name='tool'/>".to_owned(),
        joint(
            "t",
            "fixed",
            "lower",
            "tool",
            "<axis xyz='0 0 0'/><limit lower='1' upper='-1' effort='-1'/>",
        ),
    ]
    .concat();
    let (chain, warnings) = accepted(&arm(&more), &Options::default());
    assert_eq!(chain.link_from_tip, nalgebra::Isometry3::identity());
    assert_eq!(warnings, without_warnings());
}

#[test]
fn ranges_need_not_hold_zero_and_may_be_over_one_turn() {
    let text = arm("").replacen(LIMIT, "<limit lower='0.5' upper='4.5' effort='1' velocity='1'/>", 1);
    let text = text.replacen(
        LIMIT,
        "<limit lower='-6.283185307179586' upper='6.283185307179586' effort='1' velocity='1'/>",
        1,
    );
    let (chain, warnings) = accepted(&text, &Options::default());
    assert_eq!(chain.joints[0].limits.position_lower, Some(0.5));
    assert_eq!(chain.joints[1].limits.position_upper, Some(std::f64::consts::TAU));
    assert_eq!(warnings, without_warnings());
}

#[test]
fn a_pitch_of_a_right_angle_is_a_rotation_like_any_other() {
    let text = arm("").replace("<origin xyz='1 0 0'/>", "<origin rpy='0.4 1.5707963267948966 0.1'/>");
    let (chain, _) = accepted(&text, &Options::default());
    let expected = nalgebra::Rotation3::from_euler_angles(0.4, std::f64::consts::FRAC_PI_2, 0.1);
    let actual = chain.joints[1].parent_from_joint.rotation.to_rotation_matrix();
    assert!((actual.matrix() - expected.matrix()).amax() < 1e-15);
}

#[test]
fn soft_limits_are_not_limits() {
    let text = arm("").replacen(
        LIMIT,
        &format!("{LIMIT}<safety_controller soft_lower_limit='-9' soft_upper_limit='9' k_velocity='1'/>"),
        1,
    );
    let (chain, _) = accepted(&text, &Options::default());
    assert_eq!(chain.joints[0].limits.position_upper, Some(1.0));
}

#[test]
fn dynamics_are_friction_only_when_asked_for() {
    let text = arm("").replacen(
        LIMIT,
        &format!("{LIMIT}<dynamics damping='0.003' friction='0.2' mu_viscous='16'/>"),
        1,
    );
    let (chain, warnings) = accepted(&text, &Options::default());
    assert!(chain.joints[0].drive.joint_friction.is_zero());
    check_warned(
        &warnings,
        &["<dynamics> of joint \"shoulder\"", "damping 0.003, friction 0.2"],
    );
    let options = Options {
        use_dynamics: true,
        ..Options::default()
    };
    let (chain, warnings) = accepted(&text, &options);
    let friction = Friction {
        viscous: 0.003,
        coulomb_positive: 0.2,
        coulomb_negative: 0.2,
        ..Friction::default()
    };
    assert_eq!(chain.joints[0].drive.joint_friction, friction);
    assert_eq!(warnings, without_warnings());
    check_refused(
        &text.replace("friction='0.2'", "friction='-0.2'"),
        &options,
        &["\"shoulder\"", "-0.2 must be at least 0.0"],
    );
}

#[test]
fn limits_of_urdf_1_2_are_read() {
    let limit = "<limit lower='-1' upper='1' effort='1' velocity='1' acceleration='5' deceleration='6' jerk='100'/>";
    let (chain, _) = accepted(&arm("").replacen(LIMIT, limit, 1), &Options::default());
    let limits = &chain.joints[0].limits;
    assert_eq!(
        (limits.acceleration, limits.deceleration, limits.jerk),
        (Some(5.0), Some(6.0), Some(100.0))
    );
}

#[test]
fn elements_that_are_not_urdf_are_passed_over() {
    let text = arm("<wheel_hub/>").replacen(
        LIMIT,
        &format!("{LIMIT}<position_based_velocity_limits deceleration_limit='6.0'/><hardware K='x'/>"),
        1,
    );
    accepted(&text, &Options::default());
}

#[test]
fn a_joint_and_a_link_may_share_a_name() {
    let text = arm("").replace("name='elbow'", "name='lower'");
    accepted(&text, &Options::default());
}

#[test]
fn two_arms_a_head_and_wheels_give_the_chain_that_is_asked_for() {
    let branch = |side: &str| {
        [
            body(&format!("{side}_upper"), 2.0),
            body(&format!("{side}_lower"), 1.0),
            joint(
                &format!("{side}_shoulder"),
                "revolute",
                "torso",
                &format!("{side}_upper"),
                LIMIT,
            ),
            joint(
                &format!("{side}_elbow"),
                "revolute",
                &format!("{side}_upper"),
                &format!("{side}_lower"),
                LIMIT,
            ),
        ]
        .concat()
    };
    let text = robot(
        &[
            "<link name='base'/>".to_owned(),
            body("wheel", 3.0),
            body("torso", 10.0),
            joint("wheel", "continuous", "base", "wheel", ""),
            joint(
                "lift",
                "prismatic",
                "base",
                "torso",
                "<axis xyz='0 0 1'/><limit lower='0' upper='1' effort='900' velocity='1'/>",
            ),
            branch("left"),
            branch("right"),
        ]
        .concat(),
    );
    let (chain, warnings) = accepted(&text, &tip("right_lower"));
    let masses: Vec<f64> = chain.joints.iter().map(|joint| joint.link.mass).collect();
    assert_eq!(masses, [13.0, 2.0, 1.0]);
    check_warned(&warnings, &["\"left_shoulder\" at 0.0, \"left_elbow\" at 0.0"]);
}

#[test]
fn byte_order_mark_crlf_tabs_comments_and_namespaces_are_xml() {
    let text = format!(
        "\u{feff}<?xml version='1.0'?>\r\n<!-- a > b = <link> -->\r\n{}",
        arm("<xs:link xmlns:xs='urn:x' name='not a link'/>")
            .replace(
                "<robot ",
                "<robot\txmlns='http://www.ros.org' xmlns:xacro='http://ros.org/wiki/xacro' "
            )
            .replace('\n', "\r\n\t")
    );
    let (chain, _) = accepted(&text, &Options::default());
    assert_eq!(chain.joints.len(), 2);
}

#[test]
fn a_second_element_of_a_kind_is_warned_of() {
    let text = arm("").replacen(LIMIT, &format!("{LIMIT}<limit lower='-9' upper='9'/>"), 1);
    let (chain, warnings) = accepted(&text, &Options::default());
    assert_eq!(chain.joints[0].limits.position_upper, Some(1.0));
    check_warned(&warnings, &["joint \"shoulder\"", "a second <limit> is not read"]);
}
