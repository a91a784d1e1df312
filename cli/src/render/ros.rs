//! Set-points as the JSON of a ROS 2 `trajectory_msgs/msg/JointTrajectory`: rows, with times since the start.

use serde::Serialize;
use takt_client::v1;

#[derive(Debug, Default, Serialize)]
struct Time {
    sec: i32,
    nanosec: u32,
}

#[derive(Debug, Default, Serialize)]
struct Header {
    stamp: Time,
    frame_id: String,
}

#[derive(Debug, Serialize)]
struct Point {
    positions: Vec<f64>,
    velocities: Vec<f64>,
    accelerations: Vec<f64>,
    effort: Vec<f64>,
    time_from_start: Time,
}

/// The message; its fields are ROS'.
#[derive(Debug, Serialize)]
pub(crate) struct JointTrajectory {
    header: Header,
    joint_names: Vec<String>,
    points: Vec<Point>,
}

/// The message of these set-points; the stamp 0 means "now" to a controller.
pub(crate) fn trajectory(setpoints: &v1::Setpoints) -> JointTrajectory {
    let row = |index: usize, column: fn(&v1::JointColumns) -> &Vec<f64>| {
        let joints = setpoints.joints.iter();
        joints.filter_map(|joint| column(joint).get(index).copied()).collect()
    };
    let points = setpoints.time_s.iter().enumerate().map(|(index, time)| Point {
        positions: row(index, |joint| &joint.position),
        velocities: row(index, |joint| &joint.velocity),
        accelerations: row(index, |joint| &joint.acceleration),
        effort: row(index, |joint| &joint.torque),
        time_from_start: since_start(*time),
    });
    JointTrajectory {
        header: Header::default(),
        joint_names: setpoints.joints.iter().map(|joint| joint.joint.clone()).collect(),
        points: points.collect(),
    }
}

/// Whole seconds, and the rest in nanoseconds, rounded.
fn since_start(time_s: f64) -> Time {
    const NANOS: f64 = 1e9;
    let nanos = (time_s.max(0.0) * NANOS).round();
    #[allow(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "a plan is shorter than 68 years, and casts saturate"
    )]
    let (sec, nanosec) = ((nanos / NANOS) as i32, (nanos % NANOS) as u32);
    Time { sec, nanosec }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::render::example;

    #[test]
    fn the_message_has_the_fields_of_ros() {
        let setpoints = example::plan().setpoints.unwrap();
        let json = serde_json::to_value(trajectory(&setpoints)).unwrap();
        assert_eq!(json["joint_names"], serde_json::json!(["turn", "slide"]));
        assert_eq!(json["points"].as_array().unwrap().len(), setpoints.time_s.len());
        let point = &json["points"][1];
        assert_eq!(
            point["time_from_start"],
            serde_json::json!({"sec": 0, "nanosec": 250_000_000})
        );
        assert_eq!(point["positions"][0], setpoints.joints[0].position[1]);
        assert_eq!(point["effort"][1], setpoints.joints[1].torque[1]);
        assert_eq!(json["header"]["stamp"]["sec"], 0);
    }

    #[test]
    fn times_are_whole_seconds_and_nanoseconds() {
        for (time_s, sec, nanosec) in [(0.004, 0, 4_000_000), (2.999_999_999_9, 3, 0), (12.5, 12, 500_000_000)] {
            let time = since_start(time_s);
            assert_eq!((time.sec, time.nanosec), (sec, nanosec), "{time_s}");
        }
    }
}
