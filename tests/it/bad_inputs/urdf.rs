//! URDFs that nobody writes by accident, and some that are.

use takt_proto::v1::{RegisterRobotRequest, RobotDescription};

use super::Row;

const LIMIT: &str = "<limit lower='-1' upper='1' effort='10' velocity='2'/>";

fn body(name: &str) -> String {
    format!(
        "<link name='{name}'><inertial><mass value='2'/>\
         <inertia ixx='0.1' ixy='0' ixz='0' iyy='0.1' iyz='0' izz='0.1'/></inertial></link>\n"
    )
}

fn joint(name: &str, kind: &str, parent: &str, child: &str, inside: &str) -> String {
    format!("<joint name='{name}' type='{kind}'><parent link='{parent}'/><child link='{child}'/>{inside}</joint>\n")
}

/// `base` –shoulder→ `upper` –elbow→ `lower`, and more elements.
fn arm(more: &str) -> String {
    [
        "<robot name='r'>\n<link name='base'/>\n".to_owned(),
        body("upper"),
        body("lower"),
        joint(
            "shoulder",
            "revolute",
            "base",
            "upper",
            &format!("<axis xyz='0 0 1'/>{LIMIT}"),
        ),
        joint(
            "elbow",
            "revolute",
            "upper",
            "lower",
            &format!("<origin xyz='1 0 0'/><axis xyz='0 1 0'/>{LIMIT}"),
        ),
        more.to_owned(),
        "</robot>".to_owned(),
    ]
    .concat()
}

fn described(name: &str, description: RobotDescription, fields: &[&str]) -> Row {
    let request = RegisterRobotRequest {
        robot_id: "urdf".to_owned(),
        description: Some(description),
        ..Default::default()
    };
    Row::message(&format!("URDF: {name}"), &request, fields)
}

fn row(name: &str, urdf: impl Into<String>) -> Row {
    let description = RobotDescription {
        urdf: urdf.into(),
        ..Default::default()
    };
    described(name, description, &["description.urdf"])
}

/// The good arm with one thing changed.
fn changed(name: &str, from: &str, to: &str) -> Row {
    let urdf = arm("");
    assert!(urdf.contains(from), "{from}");
    row(name, urdf.replacen(from, to, 1))
}

fn between(name: &str, base: &str, tip: &str, more: &str, field: &str) -> Row {
    let description = RobotDescription {
        urdf: arm(more),
        base_link: base.to_owned(),
        tip_link: tip.to_owned(),
        ..Default::default()
    };
    described(name, description, &[field])
}

pub(super) fn rows() -> Vec<Row> {
    let mut rows = documents();
    rows.extend(bombs());
    rows.extend(numbers());
    rows.extend(trees());
    rows.extend(choices());
    rows
}

fn documents() -> Vec<Row> {
    vec![
        row("a blank", " "),
        row("a word", "robot"),
        row("not closed", "<robot"),
        row("closed otherwise", "<robot><link name='a'></robot>"),
        row("half a file", &arm("")[..300]),
        row("SDF", "<sdf version='1.6'/>"),
        row("JSON", "{\"robot\": {}}"),
        row("no links", "<robot/>"),
        row(
            "xacro",
            "<robot xmlns:xacro='http://www.ros.org/wiki/xacro'><xacro:macro name='m'/></robot>",
        ),
        row("a zero byte", arm("\u{0}")),
        row("two documents", arm("") + &arm("")),
        row("a YAML", "robot:\n  - link: base\n"),
    ]
}

fn bombs() -> Vec<Row> {
    let laughs: String = (1..10)
        .map(|level| format!("<!ENTITY l{level} '{}'>", format!("&l{};", level - 1).repeat(10)))
        .collect();
    let attributes: String = (0..65).map(|index| format!(" a{index}='1'")).collect();
    let namespaces: String = (0..300).map(|index| format!("<x xmlns:n{index}='u'/>")).collect();
    let rings: String = (0..300)
        .map(|index| {
            let mimic = format!("<mimic joint='j{}'/>", (index + 1) % 300);
            let link = format!("l{index}");
            body(&link) + &joint(&format!("j{index}"), "continuous", "lower", &link, &mimic)
        })
        .collect();
    let star: String = (0..10_000).map(|index| format!("<link name='l{index}'/>")).collect();
    let wrong: String = (0..500)
        .map(|index| {
            let link = format!("l{index}");
            body(&link) + &joint(&format!("j{index}"), "magic", "lower", &link, "")
        })
        .collect();
    let long = "x".repeat(1 << 20);
    vec![
        row(
            "a billion laughs",
            format!("<!DOCTYPE robot [<!ENTITY l0 'ha'>{laughs}]><robot name='&l9;'/>"),
        ),
        row(
            "quadratic laughs",
            format!(
                "<!DOCTYPE robot [<!ENTITY a '{}'>]><robot>{}</robot>",
                "a".repeat(50_000),
                "&a;".repeat(50_000)
            ),
        ),
        row(
            "a file of the server",
            "<!DOCTYPE robot [<!ENTITY f SYSTEM 'file:///etc/passwd'>]><robot name='&f;'/>",
        ),
        row(
            "a URL of a parameter entity",
            "<!DOCTYPE robot [<!ENTITY % d SYSTEM 'http://127.0.0.1:9/'>%d;]><robot/>",
        ),
        row(
            "nested 100,000 deep",
            arm(&("<a>".repeat(100_000) + &"</a>".repeat(100_000))),
        ),
        row("nested 700,000 deep and not closed", arm(&"<a>".repeat(700_000))),
        row("65 attributes", arm(&format!("<x{attributes}/>"))),
        row("300 namespaces", arm(&namespaces)),
        row("450,000 elements", arm(&"<x/>".repeat(450_000))),
        row("five megabytes", arm(&" ".repeat(5 << 20))),
        row("a megabyte of a link's name", arm(&format!("<link name='{long}'/>"))),
        row(
            "a megabyte of a joint's name",
            arm(&joint(&long, "fixed", "lower", "tool", "")),
        ),
        row(
            "a megabyte of a joint's type",
            arm(&joint("j", &long, "lower", "tool", "")),
        ),
        row(
            "a megabyte of a number",
            arm("").replacen("value='2'", &format!("value='{}'", "9".repeat(1 << 20)), 1),
        ),
        described(
            "a ring of 300 mimics",
            RobotDescription {
                urdf: arm(&rings),
                tip_link: "lower".to_owned(),
                ..Default::default()
            },
            &["description.urdf"],
        ),
        row("ten thousand links beside the tree", arm(&star)),
        described(
            "five hundred mistakes",
            RobotDescription {
                urdf: arm(&wrong),
                ..Default::default()
            },
            &["description.urdf", "description.urdf", super::AND_MORE],
        ),
    ]
}

fn numbers() -> Vec<Row> {
    vec![
        changed("a limit that is NaN", "lower='-1'", "lower='nan'"),
        changed("a limit beyond doubles", "upper='1'", "upper='1e999'"),
        changed("an infinite effort", "effort='10'", "effort='inf'"),
        changed("a negative effort", "effort='10'", "effort='-10'"),
        changed("a speed in words", "velocity='2'", "velocity='fast'"),
        changed("a negative speed", "velocity='2'", "velocity='-2'"),
        changed("a lower limit above the upper", "lower='-1'", "lower='1.5'"),
        changed("a negative mass", "value='2'", "value='-2'"),
        changed("a mass in micrograms", "value='2'", "value='2e9'"),
        changed("a mass that xacro left", "value='2'", "value='${m}'"),
        changed("an axis of length 0", "<axis xyz='0 0 1'/>", "<axis xyz='0 0 0'/>"),
        changed("an axis of two numbers", "<axis xyz='0 0 1'/>", "<axis xyz='0 0'/>"),
        changed(
            "an origin in micrometres",
            "<origin xyz='1 0 0'/>",
            "<origin xyz='1e6 0 0'/>",
        ),
        changed(
            "an origin with commas",
            "<origin xyz='1 0 0'/>",
            "<origin xyz='1,0,0'/>",
        ),
        changed(
            "an origin that is NaN",
            "<origin xyz='1 0 0'/>",
            "<origin rpy='0 NaN 0'/>",
        ),
        changed("half an inertia", "ixx='0.1'", ""),
        changed("an infinite inertia", "izz='0.1'", "izz='Infinity'"),
    ]
}

fn trees() -> Vec<Row> {
    let links = "<robot name='r'><link name='a'/><link name='b'/><link name='c'/>";
    let with = |joints: &[String]| format!("{links}{}</robot>", joints.concat());
    let fixed = |name: &str, parent: &str, child: &str| joint(name, "fixed", parent, child, "");
    vec![
        row(
            "a cycle of three",
            with(&[fixed("j", "a", "b"), fixed("k", "b", "c"), fixed("l", "c", "a")]),
        ),
        row(
            "a cycle of two beside a root",
            with(&[fixed("j", "b", "c"), fixed("k", "c", "b")]),
        ),
        row("a link on itself", with(&[fixed("j", "a", "a")])),
        row("two parents", with(&[fixed("j", "a", "c"), fixed("k", "b", "c")])),
        row("two roots", with(&[fixed("j", "a", "b")])),
        row("a child that is not there", with(&[fixed("j", "a", "x")])),
        row("a parent that is not there", with(&[fixed("j", "x", "a")])),
        row(
            "two joints of one name",
            with(&[fixed("j", "a", "b"), fixed("j", "b", "c")]),
        ),
        row("two links of one name", arm("<link name='lower'/>")),
        changed("a joint without a name", "name='shoulder'", ""),
        changed("a joint without a type", "type='revolute'", ""),
        changed("a ball joint", "type='revolute'", "type='ball'"),
        changed("a floating joint", "type='revolute'", "type='floating'"),
        changed("a joint without a parent", "<parent link='base'/>", ""),
        changed("a joint without a child", "<child link='upper'/>", "<child/>"),
        changed("a link without a name", "<link name='base'/>", "<link name=''/>"),
        changed("an inertia without a mass", "<mass value='2'/>", ""),
        changed(
            "a joint of the chain that mimics",
            "<origin xyz='1 0 0'/>",
            "<mimic joint='shoulder'/>",
        ),
        row(
            "33 joints",
            arm(&(0..31)
                .map(|index| {
                    let parent = if index == 0 {
                        "lower".to_owned()
                    } else {
                        format!("l{}", index - 1)
                    };
                    let link = format!("l{index}");
                    body(&link) + &joint(&format!("j{index}"), "revolute", &parent, &link, LIMIT)
                })
                .collect::<String>()),
        ),
    ]
}

fn choices() -> Vec<Row> {
    let hand = body("left")
        + &body("right")
        + &joint("l", "fixed", "lower", "left", "")
        + &joint("r", "fixed", "lower", "right", "");
    vec![
        between(
            "a base link that is not there",
            "floor",
            "",
            "",
            "description.base_link",
        ),
        between("a tip link that is not there", "", "hand", "", "description.tip_link"),
        between("a tip link above the base", "upper", "base", "", "description.tip_link"),
        between(
            "a tip link that could be one of two",
            "",
            "",
            &hand,
            "description.tip_link",
        ),
        between("nothing between base and tip", "upper", "upper", "", "description.urdf"),
        between(
            "a megabyte of a base link",
            &"x".repeat(1 << 20),
            "",
            "",
            "description.base_link",
        ),
    ]
}
