//! Arms of `tests/vectors/robots`.

use std::path::Path;

use serde_json::Value;
use takt_motion::robot::description::{Description, Kinematics};
use takt_motion::robot::resolve::Resolved;

/// The chain that an arm's oracle file names, with all of its limits from its URDF.
pub(crate) fn resolved(arm: &str) -> Resolved {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../tests/vectors/robots")
        .join(arm);
    let text = |file: &str| std::fs::read_to_string(folder.join(file)).expect("the repository has the file");
    let oracle: Value = serde_json::from_str(&text("oracle.json")).expect("the file is JSON");
    let link = |key: &str| oracle[key].as_str().map(str::to_owned);
    let description = Description {
        gravity: Some([0.0, 0.0, -9.81].into()),
        ..Description::new(Kinematics::Urdf {
            text: text(&format!("{arm}.urdf")),
            base_link: link("root_link"),
            tip_link: link("tip_link"),
        })
    };
    description.resolve().expect("the arm is sound")
}
