//! What commands on one robot share.

use clap::Args;
use takt_client::{Client, v1};

use crate::{
    failure::Failure,
    io::Io,
    numbers::{JointValues, Numbers},
};

/// Reads a robot at a revision.
pub(crate) async fn robot(client: &Client, robot_id: &str, revision: Option<&str>) -> Result<v1::Robot, Failure> {
    let request = v1::GetRobotRequest {
        robot_id: robot_id.to_owned(),
        revision: revision.map(str::to_owned),
        as_urdf: None,
    };
    Ok(client.get_robot(request).await?.robot.unwrap_or_default())
}

/// Turns typed values into rad or m. Where plain numbers are degrees, those of prismatic joints stay m.
pub(crate) fn si(values: &JointValues, degrees: bool, robot: Option<&v1::Robot>) -> Vec<f64> {
    let prismatic = |index: usize| {
        let joint = robot.and_then(|robot| robot.joints.get(index));
        joint.is_some_and(|joint| joint.r#type() == v1::JointType::Prismatic)
    };
    values
        .0
        .iter()
        .enumerate()
        .map(|(index, value)| value.si(degrees && !prismatic(index)))
        .collect()
}

/// Prints a reply as it came.
pub(crate) fn print_json<M: serde::Serialize>(reply: &M, io: &mut Io) -> Result<(), Failure> {
    let mut text = serde_json::to_string_pretty(reply)
        .map_err(|error| Failure::service(format!("the reply cannot be written as JSON: {error}")))?;
    text.push('\n');
    io.print(&text)
}

/// A motion: a move between two configurations, or what a file says.
#[derive(Debug, Args)]
pub(crate) struct MotionArgs {
    /// Joint positions to start from, in model order: rad or m, or with a unit (90deg, 5mm).
    #[arg(
        long,
        value_name = "Q1,Q2,…",
        required_unless_present = "program",
        allow_hyphen_values = true
    )]
    from: Option<JointValues>,
    /// Joint positions to end at.
    #[arg(
        long,
        value_name = "Q1,Q2,…",
        required_unless_present = "program",
        allow_hyphen_values = true
    )]
    to: Option<JointValues>,
    /// A program, or the request of a move, in YAML, TOML or JSON; - for standard input.
    #[arg(long, value_name = "FILE", conflicts_with_all = ["from", "to"])]
    pub(crate) program: Option<String>,
}

impl MotionArgs {
    /// The move between the two configurations. Where plain numbers are degrees the robot says which joints turn.
    pub(crate) async fn between(
        &self,
        degrees: bool,
        client: &Client,
        robot_id: &str,
        revision: Option<&str>,
    ) -> Result<v1::PlanMoveRequest, Failure> {
        let robot = match degrees {
            true => Some(robot(client, robot_id, revision).await?),
            false => None,
        };
        let position = |values: &Option<JointValues>| {
            let values = values.as_ref();
            values.map(|values| v1::JointPosition {
                position: si(values, degrees, robot.as_ref()),
            })
        };
        Ok(v1::PlanMoveRequest {
            start: position(&self.from),
            target: position(&self.to),
            ..Default::default()
        })
    }
}

/// What the arm carries in this request.
#[derive(Debug, Args)]
#[command(next_help_heading = "Payload")]
pub(crate) struct PayloadArgs {
    /// Mass carried, kg, in place of the model's payload.
    #[arg(long, value_name = "KG")]
    payload: Option<f64>,
    /// Its centre of mass in the tip link's frame, m.
    #[arg(long, value_name = "X,Y,Z", requires = "payload", allow_hyphen_values = true)]
    payload_com: Option<Numbers>,
    /// Its inertia about the centre of mass, kg m².
    #[arg(
        long,
        value_name = "XX,YY,ZZ,XY,XZ,YZ",
        requires = "payload",
        allow_hyphen_values = true
    )]
    payload_inertia: Option<Numbers>,
}

impl PayloadArgs {
    /// The payload, where one is given.
    pub(crate) fn payload(&self) -> Option<v1::Payload> {
        let list = |numbers: &Option<Numbers>| numbers.as_ref().map(|list| list.0.clone()).unwrap_or_default();
        self.payload.map(|mass_kg| v1::Payload {
            mass_kg: Some(mass_kg),
            center_of_mass_m: list(&self.payload_com),
            inertia_kg_m2: list(&self.payload_inertia),
        })
    }
}

/// A limit tightened for one request: `elbow.velocity=1.5`.
pub(crate) fn limit(text: &str) -> Result<(String, String, f64), String> {
    const FORM: &str = "write it as JOINT.LIMIT=VALUE, as in elbow.velocity=1.5";
    let (name, value) = text.rsplit_once('=').ok_or(FORM)?;
    let (joint, kind) = name.rsplit_once('.').ok_or(FORM)?;
    let value: f64 = value
        .trim()
        .parse()
        .map_err(|_| format!("{value:?} is no number; {FORM}"))?;
    let mut trial = v1::LimitOverride::default();
    set_limit(&mut trial, kind, value)?;
    Ok((joint.to_owned(), kind.to_owned(), value))
}

/// Gathers limits by joint, in the order of their first mention.
pub(crate) fn limits(given: &[(String, String, f64)]) -> Vec<v1::LimitOverride> {
    let mut list: Vec<v1::LimitOverride> = Vec::new();
    for (joint, kind, value) in given {
        let index = list.iter().position(|entry| entry.joint == *joint).unwrap_or_else(|| {
            list.push(v1::LimitOverride {
                joint: joint.clone(),
                ..Default::default()
            });
            list.len() - 1
        });
        // The kind was checked when it was read.
        let _ = set_limit(&mut list[index], kind, *value);
    }
    list
}

fn set_limit(entry: &mut v1::LimitOverride, kind: &str, value: f64) -> Result<(), String> {
    let field = match kind {
        "position_lower" => &mut entry.position_lower,
        "position_upper" => &mut entry.position_upper,
        "velocity" => &mut entry.velocity,
        "acceleration" => &mut entry.acceleration,
        "deceleration" => &mut entry.deceleration,
        "peak_torque" => &mut entry.peak_torque,
        "jerk" => &mut entry.jerk,
        _ => {
            return Err(format!(
                "no limit {kind:?}; there are position_lower, position_upper, velocity, acceleration, deceleration, \
                 peak_torque, jerk"
            ));
        }
    };
    *field = Some(value);
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn limits_are_gathered_by_joint() {
        let given: Vec<_> = ["a.b.velocity=1.5", "c.peak_torque=9", "a.b.acceleration=2"]
            .map(|text| limit(text).unwrap())
            .into();
        let list = limits(&given);
        assert_eq!(list.len(), 2);
        assert_eq!(
            (list[0].joint.as_str(), list[0].velocity, list[0].acceleration),
            ("a.b", Some(1.5), Some(2.0))
        );
        assert_eq!(list[1].peak_torque, Some(9.0));
        for text in ["a", "a=1", "a.speed=1", "a.velocity=x"] {
            assert!(limit(text).is_err(), "{text}");
        }
    }

    #[test]
    fn degrees_leave_prismatic_joints_alone() {
        let joint = |kind: v1::JointType| v1::JointSummary {
            r#type: kind.into(),
            ..Default::default()
        };
        let robot = v1::Robot {
            joints: vec![joint(v1::JointType::Revolute), joint(v1::JointType::Prismatic)],
            ..Default::default()
        };
        let values = "180,0.5".parse().unwrap();
        assert_eq!(si(&values, true, Some(&robot)), [std::f64::consts::PI, 0.5]);
        assert_eq!(si(&values, false, Some(&robot)), [180.0, 0.5]);
    }
}
