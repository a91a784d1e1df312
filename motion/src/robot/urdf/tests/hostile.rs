//! Inputs that nobody writes by accident.

use proptest::prelude::*;

use super::{LIMIT, arm, body, check_refused, joint, robot};
use crate::robot::bounds::{MAX_LINKS, MAX_NAME_BYTES, MAX_URDF_BYTES, MAX_XML_ATTRIBUTES, MAX_XML_DEPTH};
use crate::robot::urdf::{Options, read};

fn check(text: &str, parts: &[&str]) {
    check_refused(text, &Options::default(), parts);
}

#[test]
fn size_is_capped() {
    let filler = " ".repeat(MAX_URDF_BYTES);
    check(&arm(&filler), &["bytes of text must be at most 4194304"]);
}

#[test]
fn nesting_is_capped() {
    let nested = |depth: usize| arm(&("<a>".repeat(depth) + &"</a>".repeat(depth)));
    super::accepted(&nested(MAX_XML_DEPTH - 1), &Options::default());
    check(&nested(MAX_XML_DEPTH), &["nested 65 deep must be at most 64"]);
    check(&nested(1_000_000 / 7), &["nested 65 deep"]);
}

#[test]
fn attributes_are_capped() {
    let tag = |count: usize| {
        let attributes: String = (0..count).map(|i| format!(" a{i}='>'")).collect();
        arm(&format!("<x{attributes}/>"))
    };
    super::accepted(&tag(MAX_XML_ATTRIBUTES), &Options::default());
    check(
        &tag(MAX_XML_ATTRIBUTES + 1),
        &["65 attributes of one element must be at most 64"],
    );
}

#[test]
fn namespaces_and_nodes_are_capped() {
    let many: String = (0..300).map(|i| format!("<x xmlns:n{i}='u'/>")).collect();
    check(&arm(&many), &["300 namespace declarations must be at most 256"]);
    check(&arm(&"<x/>".repeat(450_000)), &["must be at most 400000"]);
}

#[test]
fn links_are_capped_and_their_number_is_no_burden() {
    // One long branch, as deep as links go: walked without recursion.
    let branch = |count: usize| {
        let links = (0..count).map(|i| {
            let parent = if i == 0 {
                "lower".to_owned()
            } else {
                format!("l{}", i - 1)
            };
            let kind = if i % 2 == 0 { "fixed" } else { "continuous" };
            format!(
                "{}{}",
                body(&format!("l{i}"), 1.0),
                joint(
                    &format!("j{i}"),
                    kind,
                    &parent,
                    &format!("l{i}"),
                    "<origin rpy='1 2 3'/>"
                )
            )
        });
        arm(&links.collect::<String>())
    };
    let (chain, _) = super::accepted(&branch(MAX_LINKS - 3), &super::tip("lower"));
    assert_eq!(chain.joints[1].link.mass, 9998.0);
    check(&branch(MAX_LINKS), &["must be at most 10000"]);
}

#[test]
fn long_masters_of_masters_are_followed_without_recursion() {
    let count = 3000;
    let links: String = (0..count)
        .map(|i| {
            let mimic = if i + 1 < count {
                format!("<mimic joint='j{}'/>", i + 1)
            } else {
                String::new()
            };
            let limit = "<limit lower='0.5' upper='1' effort='1' velocity='1'/>";
            format!(
                "{}{}",
                body(&format!("l{i}"), 1.0),
                joint(
                    &format!("j{i}"),
                    "prismatic",
                    "lower",
                    &format!("l{i}"),
                    &format!("{limit}{mimic}")
                )
            )
        })
        .collect();
    let (chain, _) = super::accepted(&arm(&links), &super::tip("lower"));
    assert!((chain.joints[1].link.center_of_mass.x - 0.5 * 3000.0 / 3001.0).abs() < 1e-9);
}

#[test]
fn a_ring_of_mimics_is_found_once() {
    let count = 3000;
    let links: String = (0..count)
        .map(|i| {
            let mimic = format!("<mimic joint='j{}'/>", (i + 1) % count);
            format!(
                "{}{}",
                body(&format!("l{i}"), 1.0),
                joint(&format!("j{i}"), "continuous", "lower", &format!("l{i}"), &mimic)
            )
        })
        .collect();
    check_refused(&arm(&links), &super::tip("lower"), &["mimics itself by way of others"]);
}

#[test]
fn names_are_capped_and_quoted_short() {
    let long = "x".repeat(MAX_NAME_BYTES + 1);
    check(
        &arm(&format!("<link name='{long}'/>")),
        &["a name of 257 bytes must have at most 256"],
    );
    check(
        &arm("").replacen("lower='-1'", &format!("lower='{}'", "9x".repeat(1000)), 1),
        &["9x9x…\""],
    );
    let text = robot(&format!(
        "<link name='a'/>{}{}",
        body("b", 1.0),
        joint("two\u{85}&#10;lines", "revolute", "a", "b", LIMIT)
    ));
    super::accepted(&text, &Options::default());
}

proptest! {
    /// Whatever is cut out of a good file, or put into it, reading it ends with an answer.
    #[test]
    fn damaged_files_get_an_answer(
        at in 0.0..1.0_f64,
        length in 0_usize..60,
        put in "[<>/='\"a-z0-9 &;.-]{0,12}",
    ) {
        let text = arm("<!-- c --><gazebo reference='lower'><x y='z'/></gazebo>");
        prop_assert!(text.is_ascii());
        let from = (at * text.len() as f64) as usize;
        let to = (from + length).min(text.len());
        let damaged = format!("{}{put}{}", &text[..from], &text[to..]);
        if let Err(errors) = read(&damaged, &Options::default()) {
            prop_assert!(!errors.is_empty());
        }
    }

    #[test]
    fn any_text_gets_an_answer(text in "\\PC{0,200}") {
        prop_assert!(read(&text, &Options::default()).is_err());
    }
}
