//! Files that people write: JSON, YAML or TOML of the messages, and standard input.

use std::{fs, io::Read, path::Path};

use serde::{Deserialize, de::DeserializeOwned};
use takt_client::v1;

use crate::{failure::Failure, io::Io};

/// How a text is written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Format {
    Json,
    Yaml,
    Toml,
}

impl Format {
    /// By the file's name; what has none is told by its first character.
    fn of(name: &str, text: &str) -> Self {
        match Path::new(name).extension().and_then(|extension| extension.to_str()) {
            Some("yaml" | "yml") => Self::Yaml,
            Some("toml") => Self::Toml,
            Some("json") => Self::Json,
            _ if text.trim_start().starts_with(['{', '[']) => Self::Json,
            _ => Self::Yaml,
        }
    }

    fn parse<T: DeserializeOwned>(self, text: &str) -> Result<T, String> {
        match self {
            Self::Json => serde_json::from_str(text).map_err(|error| error.to_string()),
            Self::Yaml => serde_saphyr::from_str(text).map_err(|error| error.to_string()),
            Self::Toml => toml::from_str(text).map_err(|error| error.to_string().trim_end().to_owned()),
        }
    }
}

/// Reads a file, or standard input where the name is `-`.
pub(crate) fn read(name: &str, io: &mut Io) -> Result<String, Failure> {
    if name == "-" {
        let mut text = String::new();
        return match io.input.read_to_string(&mut text) {
            Ok(_) => Ok(text),
            Err(error) => Err(Failure::usage(format!("cannot read standard input: {error}"))),
        };
    }
    fs::read_to_string(name).map_err(|error| Failure::usage(format!("cannot read {name}: {error}")))
}

/// Writes a file that the caller asked for.
pub(crate) fn write(name: &str, text: &str) -> Result<(), Failure> {
    fs::write(name, text).map_err(|error| Failure::service(format!("cannot write {name}: {error}")))
}

/// Reads a message from a text in JSON, YAML or TOML; `name` tells which, and stands in the failure.
pub(crate) fn message<T: DeserializeOwned>(name: &str, text: &str) -> Result<T, Failure> {
    Format::of(name, text).parse(text).map_err(|error| wrong(name, &error))
}

fn wrong(name: &str, error: &str) -> Failure {
    let name = if name == "-" { "standard input" } else { name };
    // the YAML reader calls every text by this name
    let error = error.strip_prefix("error: ").unwrap_or(error).replace("<input>", name);
    Failure::usage(format!("{name}: {error}"))
}

/// Only whether a key is there.
pub(crate) fn has_key(name: &str, text: &str, key: &str) -> bool {
    let value: Result<serde_json::Value, _> = Format::of(name, text).parse(text);
    value.is_ok_and(|value| value.get(key).is_some())
}

/// The shapes that a segment of a program may have.
const SHAPES: [&str; 4] = ["joint", "line", "arc", "spline"];

/// Reads a program. Two shapes in one segment are named; the readers of the formats call the second a duplicate of the first.
pub(crate) fn program(name: &str, text: &str) -> Result<v1::PlanPathRequest, Failure> {
    let failure = match message(name, text) {
        Ok(program) => return Ok(program),
        Err(failure) => failure,
    };
    let value: Result<serde_json::Value, _> = Format::of(name, text).parse(text);
    let segments = value.ok().and_then(|value| value["segments"].as_array().cloned());
    for (index, segment) in segments.unwrap_or_default().iter().enumerate() {
        let given: Vec<&str> = SHAPES
            .into_iter()
            .filter(|shape| segment.get(shape).is_some())
            .collect();
        if given.len() > 1 {
            let message = format!("segment {index} has {}, a segment has one shape", given.join(" and "));
            return Err(
                wrong(name, &message).hint("make each shape a segment of its own, with a dash before it in YAML")
            );
        }
    }
    Err(failure)
}

/// Reads a description: as such, or as the whole request to register one.
pub(crate) fn description(name: &str, text: &str) -> Result<v1::RobotDescription, Failure> {
    if has_key(name, text, "description") {
        let request: v1::RegisterRobotRequest = message(name, text)?;
        return Ok(request.description.unwrap_or_default());
    }
    message(name, text)
}

/// Reads a list of joints: bare, or under the key `joints` (the only way in TOML).
pub(crate) fn joints(name: &str, text: &str) -> Result<Vec<v1::JointDescription>, Failure> {
    #[derive(Deserialize)]
    #[serde(deny_unknown_fields)]
    struct Joints {
        joints: Vec<v1::JointDescription>,
    }
    if Format::of(name, text) == Format::Toml || has_key(name, text, "joints") {
        return message(name, text).map(|Joints { joints }| joints);
    }
    message(name, text).map_err(|failure: Failure| {
        failure.hint("a list of joints is wanted, bare or under `joints`, as in: [{\"name\": \"elbow\", \"limits\": {\"velocity\": 2}}]")
    })
}

/// Reads what is to be checked: a request, a trajectory, or the reply to a plan with its set-points.
pub(crate) fn check_request(name: &str, text: &str) -> Result<v1::CheckTrajectoryRequest, Failure> {
    if has_key(name, text, "trajectory") {
        return message(name, text);
    }
    let trajectory = if has_key(name, text, "points") {
        message(name, text)?
    } else {
        let setpoints = setpoints_of_reply(name, text)?;
        let setpoints = setpoints.ok_or_else(|| {
            wrong(
                name,
                "no trajectory in it: neither `trajectory`, nor `points`, nor a plan with set-points",
            )
            .hint("ask for set-points when planning: takt plan move … --sample-period 4ms --json")
        })?;
        trajectory_of(&setpoints)
    };
    Ok(v1::CheckTrajectoryRequest {
        trajectory: Some(trajectory),
        ..Default::default()
    })
}

/// The set-points of the reply to a move or to a program.
fn setpoints_of_reply(name: &str, text: &str) -> Result<Option<v1::Setpoints>, Failure> {
    let value: Result<serde_json::Value, _> = Format::of(name, text).parse(text);
    let is_path = value.is_ok_and(|value| value["plan"].get("segments").is_some());
    if is_path {
        let reply: v1::PlanPathResponse = message(name, text)?;
        return Ok(match reply.outcome {
            Some(v1::plan_path_response::Outcome::Plan(plan)) => plan.setpoints,
            _ => None,
        });
    }
    let reply: v1::PlanMoveResponse = message(name, text)?;
    Ok(match reply.outcome {
        Some(v1::plan_move_response::Outcome::Plan(plan)) => plan.setpoints,
        _ => None,
    })
}

/// Columns become points; a column that is too short leaves its values out, and the server says so.
fn trajectory_of(setpoints: &v1::Setpoints) -> v1::Trajectory {
    let row = |column: fn(&v1::JointColumns) -> &Vec<f64>, index: usize| {
        setpoints
            .joints
            .iter()
            .filter_map(|joint| column(joint).get(index).copied())
            .collect()
    };
    let points = setpoints
        .time_s
        .iter()
        .enumerate()
        .map(|(index, &time_s)| v1::TrajectoryPoint {
            time_s,
            position: row(|joint| &joint.position, index),
            velocity: row(|joint| &joint.velocity, index),
            acceleration: row(|joint| &joint.acceleration, index),
        });
    v1::Trajectory {
        points: points.collect(),
        interpolation: None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn joints_are_read_from_every_format() {
        let json = r#"[{"name": "a", "limits": {"velocity": 2}, "drive": {"gear_ratio": -100}}]"#;
        let yaml = "- name: a\n  limits: {velocity: 2}\n  drive:\n    gear_ratio: -100\n";
        let toml = "[[joints]]\nname = \"a\"\nlimits = { velocity = 2 }\ndrive.gear_ratio = -100\n";
        let expected = joints("j.json", json).unwrap();
        assert_eq!(expected[0].limits.as_ref().unwrap().velocity, Some(2.0));
        assert_eq!(joints("j.yaml", yaml).unwrap(), expected);
        assert_eq!(joints("j.toml", toml).unwrap(), expected);
        assert_eq!(joints("-", json).unwrap(), expected);
        assert_eq!(joints("j.yml", &format!("joints:\n{yaml}")).unwrap(), expected);
    }

    #[test]
    fn a_mistake_is_named_with_its_place() {
        let failure = joints("j.yaml", "- name: a\n  limit: {velocity: 2}\n").unwrap_err();
        let text = failure.render(false);
        assert!(
            text.contains("j.yaml") && text.contains("limit") && text.contains('2'),
            "{text}"
        );
        assert!(!text.contains("<input>") && text.contains("j.yaml:2"), "{text}");
        assert!(joints("j.toml", "[[joint]]\nname = \"a\"\n").is_err());
        assert!(description("d.json", r#"{"urdff": ""}"#).is_err());
    }

    #[test]
    fn two_shapes_in_one_segment_are_named() {
        let yaml = "segments:\n- joint: {target: {position: [0]}}\n- line: {}\n  arc: {}\n";
        let json = r#"{"segments": [{"joint": {}}, {"line": {}, "arc": {}}]}"#;
        for (name, text) in [("p.yaml", yaml), ("p.json", json)] {
            let said = program(name, text).unwrap_err().render(false);
            assert!(said.contains("segment 1 has line and arc"), "{said}");
        }
        assert_eq!(program("p.yaml", "segments:\n- joint: {}\n").unwrap().segments.len(), 1);
    }

    #[test]
    fn joints_that_are_no_list_are_refused_with_what_is_wanted() {
        let said = joints("limits.json", r#"{"limits": []}"#).unwrap_err().render(false);
        assert!(said.contains("a list of joints is wanted"), "{said}");
    }

    #[test]
    fn a_description_may_come_as_a_request() {
        for text in ["tip_link: t\n", "description: {tip_link: t}\n"] {
            assert_eq!(description("d.yaml", text).unwrap().tip_link, "t");
        }
        let list = "joints:\n- name: a\n  limits: {velocity: 2}\ngravity_m_per_s2: [0, 0, -9.81]\n";
        assert_eq!(description("d.yaml", list).unwrap().gravity_m_per_s2, [0.0, 0.0, -9.81]);
    }

    #[test]
    fn a_plan_can_be_checked_as_it_came() {
        let reply = r#"{"plan": {"setpoints": {"time_s": [0, 1], "joints": [
            {"joint": "a", "position": [0, 1], "velocity": [0, 0], "acceleration": [1, -1]},
            {"joint": "b", "position": [5, 6], "velocity": [0, 0], "acceleration": [2, -2]}]}}}"#;
        let trajectory = check_request("-", reply).unwrap().trajectory.unwrap();
        assert_eq!(trajectory.points[1].position, [1.0, 6.0]);
        assert_eq!(trajectory.points[0].acceleration, [1.0, 2.0]);
        assert!(
            check_request("-", r#"{"infeasible": {}}"#)
                .unwrap_err()
                .render(false)
                .contains("hint")
        );
    }
}
