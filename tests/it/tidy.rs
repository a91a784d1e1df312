//! What the house rules say of the sources, as far as a program can see it.

use std::{
    fs,
    path::{Path, PathBuf},
};

use prost::Message;
use prost_types::{FileDescriptorProto, FileDescriptorSet, field_descriptor_proto::Type};
use takt_proto::DESCRIPTOR;

/// Longest file of Rust.
const LINES_MAX: usize = 600;

/// What a scalar's name may end with: its unit.
const UNITS: &[&str] = &[
    "_s",
    "_m",
    "_rad",
    "_kg",
    "_w",
    "_kg_m2",
    "_m_per_s",
    "_m_per_s2",
    "_nm_per_a",
    "_rad_per_s",
    "_per_s",
    "_hz",
    "_j",
    "_a",
    "_n",
    "_n_m",
];

/// Crates of the workspace, and the programs beside it.
const FOLDERS: [&str; 8] = ["proto", "motion", "checker", "server", "client", "cli", "tests", "fuzz"];

fn workspace() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// Every file of Rust or of the schema, by its path in the workspace.
fn sources() -> Vec<(String, String)> {
    let mut found = Vec::new();
    for folder in FOLDERS {
        collect(&workspace().join(folder), folder, &mut found);
    }
    assert!(found.len() > 100, "{} files", found.len());
    found
}

fn collect(folder: &Path, name: &str, found: &mut Vec<(String, String)>) {
    let Ok(entries) = fs::read_dir(folder) else { return };
    for entry in entries.flatten() {
        let (path, file) = (entry.path(), entry.file_name());
        let file = file.to_string_lossy();
        let name = format!("{name}/{file}");
        if path.is_dir() {
            if file != "target" {
                collect(&path, &name, found);
            }
        } else if [".rs", ".proto"].iter().any(|kind| file.ends_with(kind)) {
            found.push((name, fs::read_to_string(&path).unwrap()));
        }
    }
}

/// The lines of all sources that a rule forbids.
fn breaches(breaks: impl Fn(&str, &str) -> bool) -> Vec<String> {
    let mut found = Vec::new();
    for (path, text) in sources() {
        for (index, line) in text.lines().enumerate() {
            if breaks(&path, line) {
                found.push(format!("{path}:{}: {}", index + 1, line.trim()));
            }
        }
    }
    found
}

#[test]
fn files_are_short() {
    let long = sources().into_iter().filter_map(|(path, text)| {
        let count = text.lines().count();
        (count >= LINES_MAX).then(|| format!("{path}: {count} lines"))
    });
    assert_eq!(long.collect::<Vec<_>>(), [""; 0]);
}

#[test]
fn nothing_is_left_for_later() {
    let words = ["TO", "FIX", "XX"].map(|start| match start {
        "TO" => "TODO",
        "FIX" => "FIXME",
        _ => "XXX",
    });
    let found = breaches(|path, line| path != "tests/it/tidy.rs" && words.iter().any(|word| line.contains(word)));
    assert_eq!(found, [""; 0]);
}

#[test]
fn no_test_is_ignored() {
    let found = breaches(|path, line| path != "tests/it/tidy.rs" && line.contains("#[ignore"));
    assert_eq!(found, [""; 0]);
}

/// Tests wait for what happens, not for time to pass.
#[test]
fn no_test_sleeps() {
    let is_test = |path: &str| path.contains("/tests/") || path.starts_with("tests/") || path.ends_with("/tests.rs");
    let found = breaches(|path, line| path != "tests/it/tidy.rs" && is_test(path) && line.contains("sleep("));
    assert_eq!(found, [""; 0]);
}

/// A tolerance has a name and a reason.
#[test]
fn small_numbers_of_the_planner_are_constants() {
    let found = breaches(|path, line| {
        let code = line.split("//").next().unwrap_or("");
        let is_checked = path.starts_with("motion/src/") && !path.contains("test");
        let is_named = ["const ", "symmetric(", "between("]
            .iter()
            .any(|word| code.contains(word));
        is_checked && !is_named && (code.contains("1e-") || code.contains("1.0e-"))
    });
    // What stands in the tests of a module is no tolerance of the planner.
    let in_code = found.into_iter().filter(|breach| !is_in_unit_test(breach));
    assert_eq!(in_code.collect::<Vec<_>>(), [""; 0]);
}

fn is_in_unit_test(breach: &str) -> bool {
    let mut parts = breach.split(':');
    let (Some(path), Some(line)) = (parts.next(), parts.next()) else {
        return false;
    };
    let line: usize = line.parse().unwrap();
    let text = fs::read_to_string(workspace().join(path)).unwrap();
    let tests = text.lines().position(|line| line == "mod tests {");
    tests.is_some_and(|tests| line > tests)
}

/// The verification shares nothing with the planner that it judges.
#[test]
fn the_verifier_imports_no_planner() {
    let found = breaches(|path, line| {
        path.starts_with("motion/src/verify")
            && !path.contains("tests")
            && line.contains("crate::plan")
            && !line.contains("crate::plan::outcome")
    });
    assert_eq!(found, [""; 0]);
}

/// The edges know the service, and neither the planner's library nor the stores.
#[test]
fn edges_decide_nothing() {
    let found = breaches(|path, line| {
        let is_edge = path == "server/src/grpc.rs" || path.starts_with("server/src/http");
        is_edge
            && (line.contains("crate::registry")
                || line.contains("crate::compute")
                || line.contains("takt_motion::plan"))
    });
    assert_eq!(found, [""; 0]);
}

fn files() -> Vec<FileDescriptorProto> {
    let set = FileDescriptorSet::decode(DESCRIPTOR).unwrap();
    set.file
        .into_iter()
        .filter(|file| file.package() == "takt.v1")
        .collect()
}

/// A double says its unit by its name; one that is a joint's quantity or a ratio needs none; every other says it in a
/// comment above it or above its message.
#[test]
fn every_number_of_the_schema_has_a_unit() {
    let mut without = Vec::new();
    for file in files() {
        let info = file.source_code_info.as_ref().unwrap();
        let comment = |path: &[i32]| {
            let place = info.location.iter().find(|location| location.path == path);
            place
                .map(|place| place.leading_comments().to_owned())
                .unwrap_or_default()
        };
        for (index, message) in file.message_type.iter().enumerate() {
            let above = comment(&[4, index as i32]);
            for (number, field) in message.field.iter().enumerate() {
                let name = field.name();
                let own = comment(&[4, index as i32, 2, number as i32]);
                let by_name = UNITS.iter().any(|unit| name.ends_with(unit))
                    || [JOINT_QUANTITIES, RATIOS]
                        .concat()
                        .iter()
                        .any(|word| name.contains(word));
                let by_comment = [&own, &above]
                    .iter()
                    .any(|text| WRITTEN.iter().any(|unit| text.contains(unit)));
                if field.r#type() == Type::Double && !by_name && !by_comment {
                    without.push(format!("{}.{name}", message.name()));
                }
            }
        }
    }
    assert_eq!(without, [""; 0]);
}

/// Quantities of one joint, in the joint's own unit: `robot.proto` says it of all of them.
const JOINT_QUANTITIES: &[&str] = &[
    "position",
    "displacement",
    "velocity",
    "acceleration",
    "deceleration",
    "jerk",
    "torque",
];

/// Parts of a whole.
const RATIOS: &[&str] = &[
    "utilization",
    "scale",
    "margin",
    "excess",
    "ratio",
    "location",
    "override",
    "orientation",
    "fraction",
    "normal",
    "steepness",
    "singular",
    "degrees_of_freedom",
];

/// Units as comments write them.
const WRITTEN: &[&str] = &["rad", "N m", "kg m^2", "row by row", "the unit of", "a ratio"];
