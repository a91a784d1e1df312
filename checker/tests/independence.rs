//! The checker shares nothing with the planner: of `takt-motion` it takes passive types, and none of their methods.

use std::fs;
use std::path::{Path, PathBuf};

/// Modules that hold passive data alone.
const PASSIVE: [&str; 5] = [
    "path::outcome::",
    "path::request::",
    "plan::outcome::",
    "plan::request::",
    "robot::spec::",
];

/// Methods of those types, all of which compute something.
const METHODS: [&str; 4] = ["seen_from(", "joined(", "is_zero(", "Inertial::zero("];

#[test]
fn library_uses_nothing_of_the_planner_but_passive_types() {
    let mut files = Vec::new();
    find_files(&Path::new(env!("CARGO_MANIFEST_DIR")).join("src"), &mut files);
    for path in &files {
        let text = fs::read_to_string(path).expect("sources are files of text");
        let shown = path.display();
        for (_, used) in text
            .match_indices("takt_motion::")
            .map(|(at, name)| text.split_at(at + name.len()))
        {
            let passive = PASSIVE.iter().any(|module| used.starts_with(module));
            let name: String = used.chars().take_while(|letter| *letter != ';').collect();
            assert!(passive, "{shown} uses takt_motion::{name}");
        }
        for method in METHODS {
            assert!(!text.contains(method), "{shown} calls {method}…)");
        }
    }
    assert!(files.len() >= 20, "{} files found", files.len());
}

fn find_files(folder: &Path, files: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).expect("the crate has sources") {
        let path = entry.expect("a directory entry").path();
        if path.is_dir() {
            find_files(&path, files);
        } else {
            files.push(path);
        }
    }
}

#[test]
fn library_depends_on_nothing_else_that_computes() {
    let manifest = Path::new(env!("CARGO_MANIFEST_DIR")).join("Cargo.toml");
    let text = fs::read_to_string(manifest).expect("the crate has a manifest");
    let (_, rest) = text.split_once("[dependencies]").expect("it has dependencies");
    let (own, _) = rest.split_once("\n[").expect("and sections after them");
    let names: Vec<&str> = own
        .lines()
        .map(str::trim)
        .filter(|line| !line.is_empty() && !line.starts_with('#'))
        .filter_map(|line| line.split(['.', ' ', '=']).next())
        .collect();
    assert_eq!(names, ["nalgebra", "takt-motion"]);
}
