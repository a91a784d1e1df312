//! Trajectories that are wrong.

use takt_proto::v1::{CheckTrajectoryRequest, LimitOverride, Payload, Trajectory, TrajectoryPoint};
use takt_tests::fixtures::good_check;

use super::{AND_MORE, NOT_FOUND, Row};

const NAN: f64 = f64::NAN;
const INF: f64 = f64::INFINITY;

fn row(name: &str, change: impl FnOnce(&mut CheckTrajectoryRequest), fields: &[&str]) -> Row {
    let mut request = good_check(3);
    change(&mut request);
    Row::message(&format!("trajectory: {name}"), &request, fields)
}

fn points(request: &mut CheckTrajectoryRequest) -> &mut Vec<TrajectoryPoint> {
    &mut request.trajectory.get_or_insert_default().points
}

/// A change of the second point of three.
fn point(name: &str, change: impl FnOnce(&mut TrajectoryPoint), fields: &[&str]) -> Row {
    row(name, |m| change(&mut points(m)[1]), fields)
}

fn unknown_interpolation(interpolation: i32) -> Row {
    let mut request = good_check(3);
    let mut json = serde_json::to_value(&request).expect("a request can be written");
    json["trajectory"]["interpolation"] = interpolation.into();
    request.trajectory.get_or_insert_default().interpolation = Some(interpolation);
    let name = format!("trajectory: interpolation {interpolation} *");
    let json = json.to_string().into_bytes();
    Row::message_and_json(&name, &request, json, &["trajectory.interpolation"])
}

pub(super) fn rows() -> Vec<Row> {
    let mut rows = vec![
        row("none", |m| m.trajectory = None, &["trajectory", "trajectory.points"]),
        row(
            "empty",
            |m| m.trajectory = Some(Trajectory::default()),
            &["trajectory.points"],
        ),
        row("one point", |m| points(m).truncate(1), &["trajectory.points"]),
        row("too many points", |m| *m = thin(50_001), &["trajectory.points"]),
        point("time NaN", |p| p.time_s = NAN, &["trajectory.points[1].time_s"]),
        point("time infinite", |p| p.time_s = INF, &["trajectory.points[1].time_s"]),
        row(
            "time negative",
            |m| points(m)[0].time_s = -0.1,
            &["trajectory.points[0].time_s"],
        ),
        point("time twice", |p| p.time_s = 0.0, &["trajectory.points[1].time_s"]),
        point("time back", |p| p.time_s = 7.0, &["trajectory.points[2].time_s"]),
        point(
            "time a picosecond on",
            |p| p.time_s = 1e-12,
            &["trajectory.points[1].time_s"],
        ),
        point(
            "a position short",
            |p| p.position.truncate(5),
            &["trajectory.points[1].position"],
        ),
        point(
            "no position",
            |p| p.position.clear(),
            &["trajectory.points[1].position"],
        ),
        point(
            "position NaN",
            |p| p.position[3] = NAN,
            &["trajectory.points[1].position[3]"],
        ),
        point(
            "position 1e300",
            |p| p.position[3] = 1e300,
            &["trajectory.points[1].position[3]"],
        ),
        point(
            "a velocity too many",
            |p| p.velocity.push(0.0),
            &["trajectory.points[1].velocity"],
        ),
        point(
            "velocity infinite",
            |p| p.velocity[0] = -INF,
            &["trajectory.points[1].velocity[0]"],
        ),
        point(
            "velocity 1e12",
            |p| p.velocity[0] = 1e12,
            &["trajectory.points[1].velocity[0]"],
        ),
        point(
            "acceleration short",
            |p| p.acceleration.truncate(1),
            &["trajectory.points[1].acceleration"],
        ),
        point(
            "acceleration NaN",
            |p| p.acceleration[5] = NAN,
            &["trajectory.points[1].acceleration[5]"],
        ),
        row(
            "positions alone",
            |m| {
                for point in points(m) {
                    point.velocity.clear();
                    point.acceleration.clear();
                }
            },
            &["trajectory.interpolation"],
        ),
        row(
            "quintic without accelerations",
            |m| {
                m.trajectory.get_or_insert_default().interpolation = Some(3);
                points(m)[2].acceleration.clear();
            },
            &["trajectory.points[2].acceleration"],
        ),
        row(
            "interpolation that says nothing",
            |m| m.trajectory.get_or_insert_default().interpolation = Some(0),
            &["trajectory.interpolation"],
        ),
        unknown_interpolation(4),
        unknown_interpolation(-7),
        row(
            "utilization in percent",
            |m| m.torque_utilization = Some(80.0),
            &["torque_utilization"],
        ),
        row(
            "utilization NaN",
            |m| m.torque_utilization = Some(NAN),
            &["torque_utilization"],
        ),
        row(
            "cycle time too short",
            |m| m.cycle_time_s = Some(0.001),
            &["cycle_time_s"],
        ),
        row(
            "cycle time negative",
            |m| m.cycle_time_s = Some(-1.0),
            &["cycle_time_s"],
        ),
        row("cycle time infinite", |m| m.cycle_time_s = Some(INF), &["cycle_time_s"]),
        row(
            "payload without mass",
            |m| m.payload = Some(Payload::default()),
            &["payload.mass_kg"],
        ),
        row(
            "payload of 1e300 kg",
            |m| m.payload.get_or_insert_default().mass_kg = Some(1e300),
            &["payload.mass_kg"],
        ),
        row(
            "limits of a joint that is not there",
            |m| {
                m.limits = vec![LimitOverride {
                    joint: "hip".to_owned(),
                    ..Default::default()
                }];
            },
            &["limits[0].joint"],
        ),
        row(
            "limits looser",
            |m| {
                m.limits = vec![LimitOverride {
                    joint: "elbow_joint".to_owned(),
                    peak_torque: Some(1e6),
                    ..Default::default()
                }];
            },
            &["limits[0].peak_torque"],
        ),
        row("robot in capitals", |m| m.robot_id = "UR5E".to_owned(), &["robot_id"]),
        row("no such robot", |m| m.robot_id = "nobody".to_owned(), &[]).refused(NOT_FOUND),
        row("no such revision", |m| m.revision = Some("none".to_owned()), &[]).refused(NOT_FOUND),
    ];
    rows.push(row(
        "a thousand points of NaN",
        |m| {
            *m = good_check(1000);
            for point in points(m) {
                point.position.fill(NAN);
            }
        },
        &[
            "trajectory.points[0].position[0]",
            "trajectory.points[0].position[1]",
            AND_MORE,
        ],
    ));
    rows
}

/// Many points with as little in them as can be.
fn thin(count: u32) -> CheckTrajectoryRequest {
    let mut request = good_check(count);
    for point in points(&mut request) {
        point.position.clear();
        point.velocity.clear();
        point.acceleration.clear();
    }
    request
}
