//! The example robots of `robots/`, as the service reads them.

use std::fs;
use std::path::Path as FilePath;

use takt_motion::robot::Robot;
use takt_proto::convert::{self, Findings, Path};
use takt_proto::v1::RobotDescription;

/// One arm to measure with.
pub(crate) struct Example {
    /// Stem of its file.
    pub(crate) name: String,
    pub(crate) robot: Robot,
    /// What its maker lets it carry, kg.
    pub(crate) payload_max: f64,
}

/// Every description in `robots/`, by name.
pub(crate) fn all() -> Vec<Example> {
    let folder = FilePath::new(env!("CARGO_MANIFEST_DIR")).join("../robots");
    let mut files: Vec<_> = fs::read_dir(&folder)
        .expect("the repository has robots")
        .map(|entry| entry.expect("a directory entry").path())
        .filter(|path| path.extension().is_some_and(|end| end == "json"))
        .collect();
    files.sort();
    files.iter().map(|file| read(file)).collect()
}

fn read(file: &FilePath) -> Example {
    let name = file.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    let text = fs::read_to_string(file).unwrap_or_else(|error| panic!("{name}: {error}"));
    let wire: RobotDescription = serde_json::from_str(&text).unwrap_or_else(|error| panic!("{name}: {error}"));
    let mut findings = Findings::default();
    let description = convert::robot::description(&wire, Path::Root, &mut findings);
    let resolved = findings
        .finish(description)
        .and_then(|description| description.expect("nothing was found wrong").resolve())
        .unwrap_or_else(|wrong| panic!("{name}: {wrong:?}"));
    Example {
        payload_max: payload_max(&name),
        robot: Robot::new(resolved.spec, resolved.warnings).unwrap_or_else(|wrong| panic!("{name}: {wrong:?}")),
        name,
    }
}

/// Rated payloads, kg; an arm of which none is known here carries up to 2 kg.
fn payload_max(name: &str) -> f64 {
    match name {
        "ur5e" => 5.0,
        "fr3" => 3.0,
        "puma560" => 2.5,
        _ => 2.0,
    }
}
