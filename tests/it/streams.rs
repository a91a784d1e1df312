//! Set-points in a stream, and batches: whole, in order, bounded, and ended by whoever has enough of them.

use std::collections::HashSet;

use futures::stream;
use takt_client::{
    Code,
    v1::{self, plan_batch_response::Answer, plan_move_response::Outcome, setpoints_header},
};
use takt_server::{Config, Limits};
use takt_tests::{
    Protocol, TestServer,
    fixtures::{good_move, good_stream, plan_move},
};

const LINES: &str = "application/x-ndjson";

/// Streams a move in pieces of seven, and expects the set-points of the same plan in one piece.
async fn is_streamed_whole(server: &TestServer, robot: &str, request: v1::PlanMoveRequest) -> v1::Setpoints {
    let mut both = Vec::new();
    for protocol in Protocol::BOTH {
        let client = server.client(protocol);
        let mut expected = client.plan_move(request.clone()).await.unwrap();
        let setpoints = match &mut expected.outcome {
            Some(Outcome::Plan(plan)) => plan.setpoints.take().unwrap(),
            other => panic!("{other:?}"),
        };
        let streamed = v1::StreamSetpointsRequest {
            robot_id: robot.to_owned(),
            chunk_points: Some(7),
            // What stands beside the motion counts for it.
            motion: Some(v1::stream_setpoints_request::Motion::Move(v1::PlanMoveRequest {
                robot_id: String::new(),
                sample_period_s: None,
                ..request.clone()
            })),
            sample_period_s: request.sample_period_s,
        };
        let mut stream = client.stream_setpoints(streamed).await.unwrap();
        let header = stream.header().clone();
        assert_eq!(
            header.answer,
            Some(setpoints_header::Answer::Move(expected)),
            "{protocol:?}"
        );
        assert_eq!(header.setpoint_count as usize, setpoints.time_s.len());
        assert_eq!(header.sample_period_s, 0.004);
        let mut found = v1::Setpoints::default();
        let mut is_last = false;
        while let Some(chunk) = stream.next().await.unwrap() {
            assert!(!is_last, "nothing comes after the last chunk");
            is_last = chunk.last;
            append(&mut found, chunk.setpoints.unwrap());
        }
        assert!(is_last);
        assert_eq!(found, setpoints, "{protocol:?}");
        both.push(found);
    }
    assert_eq!(both[0], both[1]);
    both.remove(0)
}

#[tokio::test]
async fn a_stream_is_the_plan_and_its_set_points_piece_by_piece() {
    let server = TestServer::start().await;
    let request = v1::PlanMoveRequest {
        sample_period_s: Some(0.004),
        ..good_move()
    };
    is_streamed_whole(&server, "ur5e", request).await;
}

#[tokio::test]
async fn set_points_of_motors_are_streamed_with_those_of_joints() {
    let server = TestServer::start().await;
    let request = v1::PlanMoveRequest {
        sample_period_s: Some(0.004),
        motor_setpoints: Some(true),
        ..plan_move("scara", &[-1.0, 1.0, 0.1, 0.0], &[-0.5, 0.6, 0.12, 0.4])
    };
    let found = is_streamed_whole(&server, "scara", request).await;
    assert!(found.exact_motor_points.is_some());
    for joint in &found.joints {
        assert_eq!(joint.motor_torque.len(), found.time_s.len(), "{}", joint.joint);
    }
}

fn append(all: &mut v1::Setpoints, piece: v1::Setpoints) {
    assert!((1..=7).contains(&piece.time_s.len()));
    all.time_s.extend(piece.time_s);
    if let Some(exact) = piece.exact_motor_points {
        *all.exact_motor_points.get_or_insert_default() += exact;
    }
    if all.joints.is_empty() {
        all.joints = piece.joints;
        return;
    }
    for (all, piece) in all.joints.iter_mut().zip(piece.joints) {
        assert_eq!(all.joint, piece.joint);
        all.position.extend(piece.position);
        all.velocity.extend(piece.velocity);
        all.acceleration.extend(piece.acceleration);
        all.torque.extend(piece.torque);
        all.motor_torque.extend(piece.motor_torque);
        all.motor_current_a.extend(piece.motor_current_a);
    }
}

#[tokio::test]
async fn what_is_infeasible_ends_with_its_header() {
    let server = TestServer::start().await;
    for protocol in Protocol::BOTH {
        let mut request = good_stream(0.004);
        if let Some(v1::stream_setpoints_request::Motion::Move(motion)) = &mut request.motion {
            motion.payload.get_or_insert_default().mass_kg = Some(500.0);
        }
        let mut stream = server.client(protocol).stream_setpoints(request).await.unwrap();
        let Some(setpoints_header::Answer::Move(answer)) = &stream.header().answer else {
            panic!("{:?}", stream.header());
        };
        assert!(matches!(answer.outcome, Some(Outcome::Infeasible(_))));
        assert_eq!(stream.header().setpoint_count, 0);
        assert!(stream.next().await.unwrap().is_none());
    }
}

#[tokio::test]
async fn a_refused_stream_has_a_status_and_no_pieces() {
    let server = TestServer::start().await;
    for protocol in Protocol::BOTH {
        let client = server.client(protocol);
        let mut request = good_stream(0.004);
        request.chunk_points = Some(0);
        let error = client.stream_setpoints(request).await.unwrap_err();
        assert_eq!(error.code(), Code::InvalidRequest);
        assert_eq!(error.violations()[0].field, "chunk_points");
    }
}

/// So many set-points that they do not fit between the two ends.
fn long_stream() -> v1::StreamSetpointsRequest {
    good_stream(2e-5)
}

#[tokio::test]
async fn a_stream_that_is_left_gives_its_place_back() {
    let server = TestServer::narrow(1, 3600.0).await;
    for protocol in Protocol::BOTH {
        let mut stream = server.client(protocol).stream_setpoints(long_stream()).await.unwrap();
        assert!(stream.next().await.unwrap().is_some());
        let other = server.client(protocol).plan_move(good_move()).await.unwrap_err();
        assert_eq!(other.code(), Code::Overloaded, "a stream is a request in work");
        drop(stream);
        server.until_there_is_room().await;
    }
}

#[tokio::test]
async fn a_stream_that_nobody_reads_is_given_up_and_says_so() {
    let server = TestServer::narrow(1, 0.05).await;
    let mut http = server.http().await;
    let body = serde_json::to_string(&v1::StreamSetpointsRequest {
        robot_id: String::new(),
        ..long_stream()
    })
    .unwrap();
    let head = format!(
        "POST /v1/robots/ur5e:streamSetpoints HTTP/1.1\r\nhost: takt\r\ncontent-length: {}\r\n\r\n{body}",
        body.len()
    );
    http.send(head.as_bytes()).await;
    server.until_there_is_room().await;
    let mut stream = server
        .client(Protocol::Grpc)
        .stream_setpoints(long_stream())
        .await
        .unwrap();
    server.until_there_is_room().await;
    let error = loop {
        match stream.next().await {
            Ok(piece) => assert!(piece.is_some_and(|chunk| !chunk.last)),
            Err(error) => break error,
        }
    };
    assert_eq!(error.code(), Code::DeadlineExceeded, "{error}");
    let reply = http.receive("POST").await;
    let lines = reply.json_lines();
    assert_eq!(lines[lines.len() - 1]["error"]["status"], "DEADLINE_EXCEEDED");
}

#[tokio::test]
async fn a_batch_to_which_nothing_is_added_ends() {
    let server = TestServer::narrow(1, 0.05).await;
    for protocol in Protocol::BOTH {
        let client = server.client(protocol);
        let mut answers = client.plan_batch("ur5e", stream::pending()).await.unwrap();
        let error = answers.next().await.unwrap_err();
        assert_eq!(error.code(), Code::DeadlineExceeded, "{error}");
        server.until_there_is_room().await;
    }
}

/// Distinct moves, as requests of a batch.
fn batch(count: u32, ordered: bool) -> Vec<v1::PlanBatchRequest> {
    let requests = (0..count).map(|number| {
        let mut motion = good_move();
        motion.robot_id.clear();
        motion.target.get_or_insert_default().position[0] = 0.2 + 1e-3 * f64::from(number);
        v1::PlanBatchRequest {
            id: format!("move-{number}"),
            motion: Some(v1::plan_batch_request::Motion::Move(motion)),
            ordered: Some(ordered),
            ..Default::default()
        }
    });
    requests.collect()
}

#[tokio::test]
async fn a_thousand_moves_have_a_thousand_answers_and_a_bad_one_is_one_of_them() {
    const COUNT: u32 = 1000;
    const BAD: usize = 500;
    let server = TestServer::start().await;
    for (protocol, ordered) in [(Protocol::Grpc, true), (Protocol::Http, false), (Protocol::Http, true)] {
        let client = server.client(protocol);
        let mut requests = batch(COUNT, ordered);
        if let Some(v1::plan_batch_request::Motion::Move(motion)) = &mut requests[BAD].motion {
            motion.speed_scale = Some(7.0);
        }
        let mut answers = client.plan_batch("ur5e", stream::iter(requests.clone())).await.unwrap();
        let mut seen = HashSet::new();
        let mut next = 0;
        while let Some(answer) = answers.next().await.unwrap() {
            let index = answer.index as usize;
            assert!(seen.insert(index), "{index} is answered twice");
            assert_eq!(answer.id, requests[index].id);
            assert!(!ordered || index == next, "{index} in place of {next}");
            next += 1;
            match answer.answer {
                Some(Answer::Error(error)) if index == BAD => {
                    assert_eq!(error.status, "INVALID_ARGUMENT");
                    assert_eq!(error.violations[0].field, "move.speed_scale");
                }
                Some(Answer::Move(answer)) if index != BAD => {
                    assert!(matches!(answer.outcome, Some(Outcome::Plan(_))), "{index}");
                }
                other => panic!("{index}: {other:?}"),
            }
        }
        assert_eq!(seen.len(), requests.len(), "{protocol:?}");
    }
}

#[tokio::test]
async fn an_answer_of_a_batch_is_that_of_a_call_of_its_own() {
    let server = TestServer::start().await;
    for protocol in Protocol::BOTH {
        let client = server.client(protocol);
        let alone = client.plan_move(good_move()).await.unwrap();
        let request = v1::PlanBatchRequest {
            motion: Some(v1::plan_batch_request::Motion::Move(good_move())),
            ..Default::default()
        };
        let mut answers = client.plan_batch("ur5e", stream::iter([request])).await.unwrap();
        let answer = answers.next().await.unwrap().unwrap();
        assert_eq!(answer.answer, Some(Answer::Move(alone)));
        assert!(answers.next().await.unwrap().is_none());
    }
}

#[tokio::test]
async fn requests_of_a_batch_are_refused_one_by_one() {
    let server = TestServer::start().await;
    for protocol in Protocol::BOTH {
        let client = server.client(protocol);
        let [mut other_robot, nobody] = [batch(1, true), batch(1, true)].map(|mut one| one.remove(0));
        if let Some(v1::plan_batch_request::Motion::Move(motion)) = &mut other_robot.motion {
            motion.robot_id = "fr3".to_owned();
        }
        let nothing = v1::PlanBatchRequest {
            motion: None,
            ..nobody.clone()
        };
        let requests = [other_robot, nothing, nobody];
        let mut answers = client.plan_batch("ur5e", stream::iter(requests.clone())).await.unwrap();
        let mut fields = Vec::new();
        while let Some(answer) = answers.next().await.unwrap() {
            if let Some(Answer::Error(error)) = answer.answer {
                assert_eq!(error.code, 3);
                fields.extend(error.violations.into_iter().map(|violation| violation.field));
            }
        }
        assert_eq!(fields, ["move.robot_id", "move"], "{protocol:?}");
        let mut answers = client.plan_batch("nobody", stream::iter(requests)).await.unwrap();
        let mut statuses = Vec::new();
        while let Some(answer) = answers.next().await.unwrap() {
            match answer.answer {
                Some(Answer::Error(error)) => statuses.push(error.status),
                other => panic!("{other:?}"),
            }
        }
        assert_eq!(statuses, ["INVALID_ARGUMENT", "INVALID_ARGUMENT", "NOT_FOUND"]);
    }
}

/// Lines that no client writes: the stream goes on behind each of them.
#[tokio::test]
async fn lines_that_cannot_be_read_are_answered() {
    let server = TestServer::with(Config {
        examples: true,
        limits: Limits {
            max_request_bytes: 4096,
            ..Limits::default()
        },
        ..Config::default()
    })
    .await;
    let mut http = server.http().await;
    let good = serde_json::to_string(&batch(1, true)[0]).unwrap();
    let long = format!("{{\"id\": \"{}\"}}", "x".repeat(10_000));
    let lines = [
        good.as_str(),
        "",
        "no JSON",
        "{\"id\": \"a\", \"colour\": \"red\"}",
        long.as_str(),
        "{\"robot_id\": \"fr3\"}",
        good.as_str(),
    ];
    let body = lines.join("\r\n");
    let kind = [("content-type", LINES)];
    let reply = http
        .request("POST", "/v1/robots/ur5e:planBatch", &kind, body.as_bytes())
        .await;
    assert_eq!((reply.status, reply.header("content-type")), (200, Some(LINES)));
    let answers = reply.json_lines();
    let codes: Vec<_> = answers
        .iter()
        .map(|answer| answer["error"]["status"].as_str().unwrap_or("answered"))
        .collect();
    let expected = [
        "answered",
        "INVALID_ARGUMENT",
        "INVALID_ARGUMENT",
        "OUT_OF_RANGE",
        "INVALID_ARGUMENT",
        "answered",
    ];
    assert_eq!(codes, expected);
    assert_eq!(answers[4]["error"]["violations"][0]["field"], "robot_id");
    assert_eq!(answers[5]["id"], "move-0");
}

/// A caller who writes and reads in turn gets each answer before the next request.
#[tokio::test]
async fn answers_do_not_wait_for_the_end_of_the_requests() {
    let server = TestServer::start().await;
    let mut http = server.http().await;
    http.begin("/v1/robots/ur5e:planBatch", LINES).await;
    let requests = batch(5, false);
    let mut head = None;
    for request in &requests {
        let line = serde_json::to_string(request).unwrap() + "\n";
        http.send_chunk(line.as_bytes()).await;
        if head.is_none() {
            head = Some(http.receive_head().await.status);
        }
        let answer = http.receive_chunk().await.unwrap();
        let answer: serde_json::Value = serde_json::from_slice(&answer).unwrap();
        assert_eq!(answer["id"], request.id.as_str());
    }
    assert_eq!(head, Some(200));
    http.send_chunk(b"").await;
    assert_eq!(http.receive_chunk().await, None);
    // The connection goes on.
    assert_eq!(http.get("/readyz").await.status, 200);
}

#[tokio::test]
async fn a_batch_whose_caller_is_gone_gives_its_place_back() {
    let server = TestServer::narrow(1, 3600.0).await;
    let line = serde_json::to_string(&batch(1, false)[0]).unwrap() + "\n";
    let mut http = server.http().await;
    http.begin("/v1/robots/ur5e:planBatch", LINES).await;
    http.send_chunk(line.as_bytes()).await;
    drop(http);
    server.until_there_is_room().await;
    let client = server.client(Protocol::Grpc);
    let mut answers = client.plan_batch("ur5e", stream::iter(batch(50, false))).await.unwrap();
    assert!(answers.next().await.unwrap().is_some());
    drop(answers);
    server.until_there_is_room().await;
}

/// What has been answered is not held any more: a batch may be longer than what all requests together may hold.
#[tokio::test]
async fn a_batch_holds_no_more_than_what_is_in_work() {
    let server = TestServer::with(Config {
        examples: true,
        limits: Limits {
            max_bytes_in_work: 32 << 10,
            ..Limits::default()
        },
        ..Config::default()
    })
    .await;
    for protocol in Protocol::BOTH {
        let client = server.client(protocol);
        let requests = batch(600, false);
        let bytes: usize = requests.iter().map(prost::Message::encoded_len).sum();
        assert!(bytes > 64 << 10, "{bytes}");
        let mut answers = client.plan_batch("ur5e", stream::iter(requests)).await.unwrap();
        let mut count = 0;
        while let Some(answer) = answers.next().await.unwrap() {
            assert!(matches!(answer.answer, Some(Answer::Move(_))), "{answer:?}");
            count += 1;
        }
        assert_eq!(count, 600);
    }
}
