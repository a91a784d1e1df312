//! Streams that cannot begin. A batch always begins: what is wrong with its requests is in the answers.

use takt_proto::v1::{PlanMoveRequest, PlanPathRequest, StreamSetpointsRequest, stream_setpoints_request::Motion};
use takt_tests::fixtures::{good_program, good_stream};

use super::{NOT_FOUND, Row};

fn stream(name: &str, change: impl FnOnce(&mut StreamSetpointsRequest), fields: &[&str]) -> Row {
    let mut request = good_stream(0.008);
    change(&mut request);
    Row::message(&format!("set-points: {name}"), &request, fields)
}

/// A change of the move in it.
fn motion(name: &str, change: impl FnOnce(&mut PlanMoveRequest), fields: &[&str]) -> Row {
    stream(
        name,
        |m| {
            if let Some(Motion::Move(motion)) = &mut m.motion {
                change(motion);
            }
        },
        fields,
    )
}

/// A program in place of the move.
fn path(name: &str, change: impl FnOnce(&mut PlanPathRequest), fields: &[&str]) -> Row {
    let mut program = PlanPathRequest {
        robot_id: String::new(),
        ..good_program()
    };
    change(&mut program);
    stream(name, |m| m.motion = Some(Motion::Path(program)), fields)
}

pub(super) fn rows() -> Vec<Row> {
    vec![
        stream("no motion", |m| m.motion = None, &["move"]),
        stream("no period", |m| m.sample_period_s = None, &["move.sample_period_s"]),
        stream("period 0", |m| m.sample_period_s = Some(0.0), &["move.sample_period_s"]),
        stream(
            "period NaN",
            |m| m.sample_period_s = Some(f64::NAN),
            &["move.sample_period_s"],
        ),
        stream(
            "too many set-points",
            |m| m.sample_period_s = Some(1e-6),
            &["move.sample_period_s"],
        ),
        stream("chunks of nothing", |m| m.chunk_points = Some(0), &["chunk_points"]),
        stream("chunks of 201", |m| m.chunk_points = Some(201), &["chunk_points"]),
        motion(
            "two periods",
            |m| m.sample_period_s = Some(0.004),
            &["move.sample_period_s"],
        ),
        motion("a trace", |m| m.trace_points = Some(10), &["move.trace_points"]),
        motion("another robot", |m| m.robot_id = "fr3".to_owned(), &["move.robot_id"]),
        motion("no such revision", |m| m.revision = Some("r".to_owned()), &[]).refused(NOT_FOUND),
        motion(
            "no target",
            |m| m.target = None,
            &["move.target", "move.target.position"],
        ),
        motion("scale 2", |m| m.speed_scale = Some(2.0), &["move.speed_scale"]),
        path("a program without segments", |m| m.segments.clear(), &["path.segments"]),
        path(
            "a program of another robot",
            |m| m.robot_id = "fr3".to_owned(),
            &["path.robot_id"],
        ),
        path(
            "a program and a trace",
            |m| m.trace_points = Some(10),
            &["path.trace_points"],
        ),
        stream("no such robot", |m| m.robot_id = "nobody".to_owned(), &[]).refused(NOT_FOUND),
        stream("robot without a name", |m| m.robot_id = "?".to_owned(), &["robot_id"]),
    ]
}
