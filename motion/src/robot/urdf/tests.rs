//! Small documents written by hand, one for each thing that real files do.

mod chains;
mod habits;
mod hostile;
mod refusals;

use super::{Options, read};
use crate::robot::chain::Chain;

/// A robot of these elements.
fn robot(elements: &str) -> String {
    format!("<robot name='r'>\n{elements}\n</robot>")
}

/// A link with a mass of `mass` kg at its origin.
fn body(name: &str, mass: f64) -> String {
    format!(
        "<link name='{name}'><inertial><mass value='{mass}'/>\
         <inertia ixx='0.1' ixy='0' ixz='0' iyy='0.1' iyz='0' izz='0.1'/></inertial></link>\n"
    )
}

/// A joint with whatever is inside it.
fn joint(name: &str, kind: &str, parent: &str, child: &str, inside: &str) -> String {
    format!("<joint name='{name}' type='{kind}'><parent link='{parent}'/><child link='{child}'/>{inside}</joint>\n")
}

const LIMIT: &str = "<limit lower='-1' upper='1' effort='10' velocity='2'/>";

/// `base` –shoulder→ `upper` –elbow→ `lower`, and more elements.
fn arm(more: &str) -> String {
    robot(
        &[
            "<link name='base'/>\n".to_owned(),
            body("upper", 2.0),
            body("lower", 1.0),
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
                &format!("<origin xyz='1 0 0'/><axis xyz='0 0 1'/>{LIMIT}"),
            ),
            more.to_owned(),
        ]
        .concat(),
    )
}

fn tip<'a>(name: &'a str) -> Options<'a> {
    Options {
        tip_link: Some(name),
        ..Options::default()
    }
}

fn accepted(text: &str, options: &Options<'_>) -> (Chain, Vec<String>) {
    read(text, options).unwrap_or_else(|errors| panic!("{errors:#?}\n{text}"))
}

/// The errors, as a caller sees them.
fn refused(text: &str, options: &Options<'_>) -> Vec<String> {
    let errors = read(text, options).expect_err("should be refused");
    errors.iter().map(ToString::to_string).collect()
}

/// Whether exactly one error is found, and says all of `parts`.
fn check_refused(text: &str, options: &Options<'_>, parts: &[&str]) {
    let errors = refused(text, options);
    assert_eq!(errors.len(), 1, "{errors:#?}");
    for part in parts {
        assert!(errors[0].contains(part), "{part:?} is not in {:?}", errors[0]);
    }
}

fn check_warned(warnings: &[String], parts: &[&str]) {
    let says_all = |warning: &&String| parts.iter().all(|part| warning.contains(part));
    assert!(
        warnings.iter().any(|warning| says_all(&warning)),
        "{parts:?} in {warnings:#?}"
    );
}
