use super::{LIMIT, arm, body, check_refused, joint, refused, robot, tip};
use crate::robot::bounds::MAX_FINDINGS;
use crate::robot::urdf::Options;

fn check(text: &str, parts: &[&str]) {
    check_refused(text, &Options::default(), parts);
}

#[test]
fn what_is_not_a_urdf_is_told_apart() {
    check("", &["urdf", "XML"]);
    check("<robot", &["urdf", "XML"]);
    check("<robot>\n  <link name='a'>\n</robot>", &["not well-formed XML", "3:"]);
    check("<sdf version='1.6'/>", &["\"sdf\", a URDF's is \"robot\""]);
    check(
        "<!DOCTYPE robot [<!ENTITY a 'b'>]><robot>&a;</robot>",
        &["document type declaration"],
    );
    check("<robot/>", &["no <link>"]);
    check(
        "<robot xmlns:xacro='http://www.ros.org/wiki/xacro'>\n<xacro:macro name='m'/></robot>",
        &["line 2", "\"macro\"", "expand it with xacro"],
    );
}

#[test]
fn numbers_must_be_finite_and_are_named_with_their_line() {
    for (from, to, parts) in [
        (
            "lower='-1'",
            "lower='nan'",
            [
                "joint \"shoulder\" (line 5)",
                "lower of <limit> is \"nan\", not a finite number",
            ],
        ),
        (
            "upper='1'",
            "upper='1e999'",
            ["joint \"shoulder\" (line 5)", "\"1e999\""],
        ),
        (
            "effort='10'",
            "effort='inf'",
            ["joint \"shoulder\" (line 5)", "effort of <limit> is \"inf\""],
        ),
        (
            "velocity='2'",
            "velocity='fast'",
            ["joint \"shoulder\" (line 5)", "\"fast\""],
        ),
        ("velocity='2'", "velocity=''", ["joint \"shoulder\" (line 5)", "\"\""]),
        (
            "velocity='2'",
            "velocity='-2'",
            ["velocity of <limit> is -2.0", "must not be negative"],
        ),
        (
            "effort='10'",
            "effort='-1'",
            ["effort of <limit> is -1.0", "must not be negative"],
        ),
        (
            "lower='-1'",
            "lower='1.5'",
            ["joint \"shoulder\"", "lower limit 1.5 must be at most upper limit 1.0"],
        ),
        (
            "<axis xyz='0 0 1'/>",
            "<axis xyz='0 0 0'/>",
            ["joint \"shoulder\"", "length 0.0"],
        ),
        (
            "<axis xyz='0 0 1'/>",
            "<axis xyz='0 0'/>",
            ["joint \"shoulder\"", "xyz of <axis> has 2 numbers, it must have 3"],
        ),
        (
            "<origin xyz='1 0 0'/>",
            "<origin xyz='1 0 0 0'/>",
            ["joint \"elbow\"", "xyz of <origin> has 4 numbers"],
        ),
        (
            "<origin xyz='1 0 0'/>",
            "<origin xyz='1,0,0'/>",
            ["joint \"elbow\"", "\"1,0,0\""],
        ),
        (
            "<origin xyz='1 0 0'/>",
            "<origin xyz='1e6 0 0'/>",
            [
                "joint \"elbow\"",
                "xyz of <origin>: 1000000.0 m must be at most 100000.0 m",
            ],
        ),
        (
            "<origin xyz='1 0 0'/>",
            "<origin rpy='0 NaN 0'/>",
            ["joint \"elbow\"", "rpy of <origin> is \"NaN\""],
        ),
        (
            "value='2'",
            "value='-2'",
            [
                "link \"upper\" (line 3)",
                "value of <mass>: -2.0 kg must be at least 0.0 kg",
            ],
        ),
        ("value='2'", "value='${m}'", ["link \"upper\"", "\"${m}\""]),
        ("ixx='0.1'", "", ["link \"upper\"", "<inertia> has no ixx"]),
    ] {
        check(&arm("").replacen(from, to, 1), &parts);
    }
}

#[test]
fn what_a_joint_lacks_is_named() {
    for (from, to, parts) in [
        ("type='revolute'", "", ["joint \"shoulder\"", "has no type"]),
        (
            "type='revolute'",
            "type='ball'",
            ["joint \"shoulder\"", "\"ball\" must be fixed, revolute"],
        ),
        (
            "<parent link='base'/>",
            "",
            ["joint \"shoulder\"", "has no <parent link=…>"],
        ),
        (
            "<child link='upper'/>",
            "<child/>",
            ["joint \"shoulder\"", "has no <child link=…>"],
        ),
        ("name='shoulder'", "", ["<joint> (line 5)", "has no name"]),
        (
            "<link name='base'/>",
            "<link name=''/>",
            ["<link> (line 2)", "has no name"],
        ),
        ("<mass value='2'/>", "", ["link \"upper\"", "<inertial> has no <mass>"]),
    ] {
        check(&arm("").replacen(from, to, 1), &parts);
    }
}

#[test]
fn trees_that_are_none_are_refused() {
    let links = "<link name='a'/><link name='b'/><link name='c'/>";
    let with = |joints: &[String]| robot(&format!("{links}\n{}", joints.concat()));
    check(
        &with(&[joint("j", "fixed", "a", "a", "")]),
        &["joint \"j\" (line 3)", "with itself"],
    );
    check(
        &with(&[joint("j", "fixed", "a", "x", "")]),
        &["joint \"j\" (line 3)", "child link \"x\" is not there"],
    );
    check(
        &with(&[joint("j", "fixed", "x", "a", "")]),
        &["parent link \"x\" is not there"],
    );
    check(
        &with(&[joint("j", "fixed", "a", "b", "")]),
        &["one root", "\"a\", \"c\""],
    );
    check(
        &with(&[joint("j", "fixed", "a", "c", ""), joint("k", "fixed", "b", "c", "")]),
        &["link \"c\" (line 2) has two parents: joint \"j\" (line 3) and joint \"k\" (line 4)"],
    );
    check(
        &with(&[joint("j", "fixed", "b", "c", ""), joint("k", "fixed", "c", "b", "")]),
        &["closes a loop"],
    );
    check(
        &with(&[
            joint("j", "fixed", "a", "b", ""),
            joint("k", "fixed", "b", "c", ""),
            joint("l", "fixed", "c", "a", ""),
        ]),
        &["no root"],
    );
    check(
        &with(&[joint("j", "fixed", "a", "b", ""), joint("j", "fixed", "b", "c", "")]),
        &["joint \"j\" (line 4) has the name of the joint on line 3"],
    );
    check(
        &arm("<link name='lower'/>"),
        &["link \"lower\" (line 7) has the name of the link on line 4"],
    );
}

#[test]
fn all_errors_are_found_up_to_a_cap() {
    let text = arm("")
        .replace("velocity='2'", "velocity='-2'")
        .replace("effort='10'", "effort='x'");
    assert_eq!(refused(&text, &Options::default()).len(), 4);
    let bad: String = (0..500)
        .map(|i| {
            format!(
                "{}{}",
                body(&format!("l{i}"), 1.0),
                joint(&format!("j{i}"), "magic", "lower", &format!("l{i}"), "")
            )
        })
        .collect();
    let errors = refused(&arm(&bad), &Options::default());
    assert_eq!(errors.len(), MAX_FINDINGS + 1);
    assert_eq!(errors[MAX_FINDINGS], "400 further errors are not listed");
}

#[test]
fn thirty_three_moving_joints_are_one_too_many() {
    let links = |count: usize| {
        let joints = (0..count).map(|i| {
            let (parent, child) = (format!("l{i}"), format!("l{}", i + 1));
            format!(
                "{}{}",
                body(&child, 1.0),
                joint(&format!("j{i}"), "revolute", &parent, &child, LIMIT)
            )
        });
        robot(&format!("<link name='l0'/>{}", joints.collect::<String>()))
    };
    super::accepted(&links(32), &Options::default());
    check(&links(33), &["33 moving joints on the chain must be at most 32"]);
    super::accepted(&links(33), &tip("l32"));
}
