//! Friction from telemetry: what is found, what is passed over, what ends a stream, and what others notice of it.

use futures::{StreamExt, stream};
use takt_client::{
    Client, Code, Error,
    v1::{self, friction_coefficient::Term, plan_move_response::Outcome},
};
use takt_tests::{
    Protocol, TestServer,
    fixtures::good_move,
    telemetry::{COULOMB, ROBOT, Reporter, VISCOUS},
};

/// Every answer of a stream.
async fn estimates(
    client: &Client,
    header: v1::EstimateHeader,
    blocks: Vec<v1::Telemetry>,
) -> Result<Vec<v1::EstimateFrictionResponse>, (Vec<v1::EstimateFrictionResponse>, Error)> {
    let mut found = Vec::new();
    let mut answers = match client.estimate_friction(ROBOT, header, stream::iter(blocks)).await {
        Ok(answers) => answers,
        Err(error) => return Err((found, error)),
    };
    loop {
        match answers.next().await {
            Ok(Some(answer)) => found.push(answer),
            Ok(None) => return Ok(found),
            Err(error) => return Err((found, error)),
        }
    }
}

fn last(answers: Vec<v1::EstimateFrictionResponse>) -> v1::EstimateFrictionResponse {
    answers.into_iter().next_back().unwrap()
}

fn coefficient(joint: &v1::FrictionEstimate, term: Term) -> v1::FrictionCoefficient {
    *joint.coefficients.iter().find(|one| one.term() == term).unwrap()
}

#[tokio::test]
async fn the_friction_of_the_telemetry_is_found() {
    let server = TestServer::start().await;
    let blocks = Reporter::default().blocks(120);
    let mut both = Vec::new();
    for protocol in Protocol::BOTH {
        let client = server.client(protocol);
        let answers = estimates(&client, v1::EstimateHeader::default(), blocks.clone())
            .await
            .unwrap();
        assert!((115..=122).contains(&answers.len()), "ten a second: {}", answers.len());
        assert!(
            answers
                .iter()
                .rev()
                .skip(1)
                .all(|answer| !answer.last && answer.state.is_none())
        );
        assert!(answers[0].provenance.is_some());
        both.push(answers);
    }
    assert_eq!(both[0], both[1], "both protocols say the same");
    let answer = last(both.remove(0));
    assert_eq!(answer.sample_count, 12_000);
    assert_eq!(answer.skipped, Some(v1::SkippedSamples::default()));
    for (index, joint) in answer.joints.iter().enumerate() {
        let (coulomb, viscous) = (coefficient(joint, Term::Coulomb), coefficient(joint, Term::Viscous));
        assert!(
            (coulomb.value - COULOMB[index]).abs() < 0.08 * COULOMB[index],
            "{joint:?}"
        );
        assert!(
            (viscous.value - VISCOUS[index]).abs() < 0.08 * VISCOUS[index],
            "{joint:?}"
        );
        assert!(coulomb.lower < coulomb.value && coulomb.value < coulomb.upper);
        assert_eq!(joint.missing, [""; 0]);
        let skipped = joint.skipped.unwrap();
        let counted = joint.used_count
            + skipped.at_rest
            + skipped.reversing
            + skipped.settling
            + skipped.not_finite
            + skipped.out_of_range
            + skipped.outlier;
        assert_eq!(
            counted, answer.sample_count,
            "every sample is used or its reason counted: {joint:?}"
        );
    }
}

#[tokio::test]
async fn the_kalman_filter_finds_it_too_and_the_observer_says_what_it_misses() {
    use v1::estimate_header::Method;
    let server = TestServer::start().await;
    let client = server.client(Protocol::Grpc);
    let header = |method: Method| v1::EstimateHeader {
        method: Some(method.into()),
        ..Default::default()
    };
    let answers = estimates(&client, header(Method::Kalman), Reporter::default().blocks(60)).await;
    let joint = &last(answers.unwrap()).joints[0];
    let viscous = coefficient(joint, Term::Viscous).value;
    assert!((viscous - VISCOUS[0]).abs() < 0.1 * VISCOUS[0], "{joint:?}");
    let refused = estimates(&client, header(Method::Observer), Reporter::default().blocks(1)).await;
    let (answers, error) = refused.expect_err("the example states no rotor inertia");
    assert_eq!(error.code(), Code::InvalidRequest);
    assert!(error.message().contains("rotor"), "{error}");
    assert_eq!(last(answers).sample_count, 0);
}

/// The service keeps nothing: a stream goes on elsewhere, and says what it would have said here.
#[tokio::test]
async fn a_stream_goes_on_on_another_server() {
    let (here, there) = (TestServer::start().await, TestServer::start().await);
    let blocks = Reporter::default().blocks(40);
    for protocol in Protocol::BOTH {
        let (here, there) = (here.client(protocol), there.client(protocol));
        let whole = estimates(&here, v1::EstimateHeader::default(), blocks.clone())
            .await
            .unwrap();
        let first = estimates(&here, v1::EstimateHeader::default(), blocks[..17].to_vec())
            .await
            .unwrap();
        let header = v1::EstimateHeader {
            state: last(first).state,
            ..Default::default()
        };
        let second = estimates(&there, header, blocks[17..].to_vec()).await.unwrap();
        // What was asked for was another thing, as the header had a state.
        let without = |answer| v1::EstimateFrictionResponse {
            provenance: None,
            ..last(answer)
        };
        assert_eq!(without(second), without(whole), "{protocol:?}");
    }
}

#[tokio::test]
async fn what_is_hostile_is_passed_over_counted_and_without_harm() {
    let server = TestServer::start().await;
    for protocol in Protocol::BOTH {
        let client = server.client(protocol);
        let mut blocks = Reporter::default().blocks(60);
        let clean = last(
            estimates(&client, v1::EstimateHeader::default(), blocks.clone())
                .await
                .unwrap(),
        );
        // Torques that are none, or too large to be any.
        blocks[10].joints[0].torque[3] = f64::NAN;
        blocks[11].joints[1].torque[3] = 1e300;
        // Positions that are none.
        blocks[12].joints[2].position[0] = f64::NAN;
        blocks[13].joints[2].position[1] = 1e300;
        // Clocks that are none, or go backwards.
        blocks[14].time_s[5] = f64::NAN;
        blocks[15].time_s[7] = 0.5;
        blocks[16].time_s[8] = -1e300;
        let found = last(estimates(&client, v1::EstimateHeader::default(), blocks).await.unwrap());
        let skipped = found.skipped.unwrap();
        assert_eq!(
            (skipped.not_finite, skipped.out_of_range, skipped.time_went_backwards),
            (2, 2, 1),
            "{protocol:?}"
        );
        assert_eq!(
            found.sample_count + 5,
            clean.sample_count,
            "nothing is dropped without a word"
        );
        assert_eq!(found.joints[0].skipped.unwrap().not_finite, 1);
        for (found, clean) in found.joints.iter().zip(&clean.joints) {
            let [found, clean] = [found, clean].map(|joint| coefficient(joint, Term::Viscous).value);
            assert!((found - clean).abs() < 0.02 * clean, "{found} {clean}");
        }
    }
}

/// A gap starts filters anew and is said.
#[tokio::test]
async fn a_gap_is_said() {
    let server = TestServer::start().await;
    let mut blocks = Reporter::default().blocks(40);
    blocks.drain(10..20);
    let found = last(
        estimates(&server.client(Protocol::Grpc), v1::EstimateHeader::default(), blocks)
            .await
            .unwrap(),
    );
    assert_eq!(found.skipped.unwrap().gaps, 1);
    assert_eq!(found.sample_count, 3000);
}

/// What ends a stream early is an error after the last answer, which has the state up to then.
#[tokio::test]
async fn what_cannot_be_taken_ends_the_stream_with_what_was_learned() {
    let server = TestServer::start().await;
    let mut reporter = Reporter::default();
    let good = reporter.blocks(20);
    let lengthened = |count: usize| {
        let mut block = good[0].clone();
        block.time_s.resize(count, 0.0);
        block
    };
    let mut without = |change: fn(&mut v1::Telemetry)| {
        let mut block = reporter.block(100);
        change(&mut block);
        block
    };
    let cases = [
        ("a million samples", lengthened(1_000_000), "telemetry.time_s"),
        ("one sample too many", lengthened(1001), "telemetry.time_s"),
        (
            "a joint too few",
            without(|block| block.joints.truncate(5)),
            "telemetry.joints",
        ),
        (
            "an unknown joint",
            without(|block| block.joints[2].joint = "tail".to_owned()),
            "telemetry.joints[2].joint",
        ),
        (
            "a joint twice",
            without(|block| block.joints[2].joint = block.joints[1].joint.clone()),
            "telemetry.joints[2].joint",
        ),
        (
            "a value too few",
            without(|block| block.joints[3].torque.truncate(99)),
            "telemetry.joints[3].torque",
        ),
        (
            "a column for some",
            without(|block| block.joints[3].acceleration = vec![0.0; 100]),
            "telemetry.joints[0].acceleration",
        ),
        (
            "torque said twice",
            without(|block| {
                for joint in &mut block.joints {
                    joint.motor_torque = joint.torque.clone();
                }
            }),
            "telemetry.joints[0].torque",
        ),
        (
            "other columns than before",
            without(|block| {
                for joint in &mut block.joints {
                    joint.velocity.clear();
                }
            }),
            "telemetry",
        ),
    ];
    for protocol in Protocol::BOTH {
        let client = server.client(protocol);
        let whole = last(
            estimates(&client, v1::EstimateHeader::default(), good.clone())
                .await
                .unwrap(),
        );
        for (name, bad, field) in &cases {
            let blocks = good.iter().cloned().chain([bad.clone(), good[0].clone()]).collect();
            let ended = estimates(&client, v1::EstimateHeader::default(), blocks).await;
            let (answers, error) = ended.expect_err(name);
            assert_eq!(error.code(), Code::InvalidRequest, "{name}: {error}");
            assert_eq!(error.violations()[0].field, *field, "{name}: {error}");
            assert_eq!(last(answers), whole, "{name}: {protocol:?}");
        }
    }
}

#[tokio::test]
async fn messages_in_the_wrong_order_are_refused() {
    let server = TestServer::start().await;
    let mut http = server.http().await;
    let path = format!("/v1/robots/{ROBOT}:estimateFriction");
    let kind = [("content-type", "application/x-ndjson")];
    for (body, status, field) in [
        ("", 400, "header"),
        (r#"{"telemetry": {}}"#, 400, "header"),
        ("{}", 400, "header"),
        (r#"{"header": {"half_life_s": -1}}"#, 400, "header.half_life_s"),
        ("{\"header\": {}}\n{\"header\": {}}", 200, "header"),
        ("{\"header\": {}}\n{}", 200, "telemetry"),
        ("{\"header\": {}}\n{\"telemetry\": {\"samples\": 1}}", 200, "telemetry"),
    ] {
        let reply = http.request("POST", &path, &kind, body.as_bytes()).await;
        assert_eq!(reply.status, status, "{body}: {}", reply.text());
        let lines = reply.json_lines();
        let error = &lines[lines.len() - 1]["error"];
        assert_eq!(error["status"], "INVALID_ARGUMENT", "{body}");
        let named = &error["details"][0]["field_violations"][0]["field"];
        assert!(named.as_str().unwrap().starts_with(field), "{body}: {named}");
    }
}

#[tokio::test]
async fn a_stream_to_which_nothing_is_added_ends_with_what_was_learned() {
    let server = TestServer::narrow(1, 0.05).await;
    for protocol in Protocol::BOTH {
        let blocks = stream::iter(Reporter::default().blocks(3)).chain(stream::pending());
        let client = server.client(protocol);
        let mut answers = client
            .estimate_friction(ROBOT, v1::EstimateHeader::default(), blocks)
            .await
            .unwrap();
        let mut found = Vec::new();
        let error = loop {
            match answers.next().await {
                Ok(answer) => found.push(answer.unwrap()),
                Err(error) => break error,
            }
        };
        assert_eq!(error.code(), Code::DeadlineExceeded, "{error}");
        assert!(last(found).state.is_some());
        server.until_there_is_room().await;
    }
}

/// Who reads nothing is given up; what others stream meanwhile is not touched by it.
#[tokio::test]
async fn a_caller_who_stops_reading_is_given_up_and_others_do_not_notice() {
    let server = TestServer::narrow(3, 0.3).await;
    // Every sample has its answer, and none is read.
    let header = r#"{"header": {"report_period_s": 0.001}}"#;
    let mut reporter = Reporter::default();
    let lines: String = (0..3000)
        .map(|_| {
            let request = v1::EstimateFrictionRequest {
                robot_id: String::new(),
                part: Some(v1::estimate_friction_request::Part::Telemetry(reporter.block(1))),
            };
            serde_json::to_string(&request).unwrap() + "\n"
        })
        .collect();
    let body = format!("{header}\n{lines}");
    let head = format!(
        "POST /v1/robots/{ROBOT}:estimateFriction HTTP/1.1\r\nhost: takt\r\ncontent-length: {}\r\n\r\n",
        body.len()
    );
    let mut deaf = server.http().await;
    let sending = async {
        deaf.send(head.as_bytes()).await;
        deaf.send(body.as_bytes()).await;
    };
    let client = server.client(Protocol::Grpc);
    let working = async {
        let mut expected = None;
        for _ in 0..3 {
            let found = estimates(&client, v1::EstimateHeader::default(), Reporter::default().blocks(20)).await;
            let found = last(found.unwrap());
            assert_eq!(*expected.get_or_insert(found.clone()), found);
        }
    };
    // What is sent to one who does not read may never be taken; it is left at the end.
    tokio::select! {
        () = async { working.await; } => {}
        () = async { sending.await; std::future::pending().await } => {}
    }
}

/// What a stream holds does not grow with its length.
#[tokio::test]
async fn a_state_is_as_large_after_ten_seconds_as_after_one() {
    use prost::Message;
    let server = TestServer::start().await;
    let client = server.client(Protocol::Grpc);
    let mut sizes = Vec::new();
    for blocks in [10, 100] {
        let header = v1::EstimateHeader {
            report_period_s: Some(10.0),
            ..Default::default()
        };
        let found = last(
            estimates(&client, header, Reporter::default().blocks(blocks))
                .await
                .unwrap(),
        );
        let state = found.state.unwrap();
        sizes.push((state.reals.len(), state.counts.len()));
        assert!(state.encoded_len() < 64 << 10, "{}", state.encoded_len());
    }
    assert_eq!(sizes[0], sizes[1]);
}

/// An estimate becomes a revision; plans of the old one stay as they were, those of the new one have its friction.
#[tokio::test]
async fn an_estimate_is_committed() {
    let server = TestServer::start().await;
    for protocol in Protocol::BOTH {
        let client = server.client(protocol);
        let id = format!("arm-{protocol:?}").to_lowercase();
        let registered = client
            .register_robot(v1::RegisterRobotRequest {
                robot_id: id.clone(),
                description: Some(takt_tests::fixtures::example(ROBOT)),
                ..Default::default()
            })
            .await
            .unwrap();
        let before = registered.robot.unwrap().revision;
        let plan = async |revision: Option<&str>| {
            let request = v1::PlanMoveRequest {
                robot_id: id.clone(),
                revision: revision.map(str::to_owned),
                ..good_move()
            };
            client.plan_move(request).await.unwrap()
        };
        let old = plan(None).await;
        let blocks = stream::iter(Reporter::default().blocks(120));
        let mut answers = client
            .estimate_friction(&id, v1::EstimateHeader::default(), blocks)
            .await
            .unwrap();
        let mut found = None;
        while let Some(answer) = answers.next().await.unwrap() {
            found = Some(answer);
        }
        let estimate = found.unwrap();
        let proposal = estimate.proposal.clone().unwrap();
        assert_eq!(proposal.base_revision, before);
        assert_eq!(proposal.joints.len(), 6);
        // What every coefficient becomes is what the estimate says a commit writes.
        for joint in &estimate.joints {
            let committed = coefficient(joint, Term::Viscous).committed;
            let mut changes = proposal.friction.iter().filter(|change| change.joint == joint.joint);
            let viscous = changes.find(|change| change.term() == v1::friction_change::Term::Viscous);
            assert!(
                committed.is_some() && viscous.is_some_and(|change| change.after == committed),
                "{joint:?}"
            );
        }
        assert_eq!(estimate.warnings, [""; 0]);
        let commit = v1::RegisterRobotRequest {
            robot_id: id.clone(),
            description: proposal.description,
            expected_revision: Some(proposal.base_revision),
            ..Default::default()
        };
        let committed = client.register_robot(commit.clone()).await.unwrap().robot.unwrap();
        assert_ne!(committed.revision, before);
        let friction = &committed.joints[0].drive.as_ref().unwrap().friction[0];
        assert!(
            (friction.coulomb_positive.unwrap() - COULOMB[0]).abs() < 0.3,
            "{friction:?}"
        );
        let read = client
            .get_robot(v1::GetRobotRequest {
                robot_id: id.clone(),
                ..Default::default()
            })
            .await
            .unwrap();
        let description = read.description.unwrap();
        assert_eq!(description.origin.unwrap().base_revision, before);
        let known = description.uncertainty.unwrap();
        assert_eq!(
            known.parameters.len(),
            18,
            "viscous and Coulomb either way, of six joints"
        );
        // Friction takes time; what was planned before stays what it was.
        assert_eq!(plan(Some(&before)).await, old);
        let (Some(Outcome::Plan(old)), Some(Outcome::Plan(new))) = (old.outcome, plan(None).await.outcome) else {
            panic!("no plans");
        };
        assert!(new.duration_s > old.duration_s, "{} {}", new.duration_s, old.duration_s);
        // Whoever was slower is told so.
        let late = client.register_robot(commit).await.unwrap_err();
        assert_eq!(late.code(), Code::Conflict);
    }
}

/// A robot that is deleted meanwhile: the estimate stands, there is nothing to change.
#[tokio::test]
async fn a_robot_that_is_gone_has_no_proposal() {
    let server = TestServer::start().await;
    let client = server.client(Protocol::Grpc);
    let deleting = client.clone();
    let blocks = stream::iter(Reporter::default().blocks(60));
    let gone = stream::once(async move {
        let request = v1::DeleteRobotRequest {
            robot_id: ROBOT.to_owned(),
            ..Default::default()
        };
        deleting.delete_robot(request).await.unwrap();
        v1::Telemetry {
            joints: vec![v1::TelemetryColumns::default(); 6],
            ..Default::default()
        }
    });
    let mut answers = client
        .estimate_friction(ROBOT, v1::EstimateHeader::default(), blocks.chain(gone))
        .await
        .unwrap();
    let mut found = None;
    while let Some(answer) = answers.next().await.unwrap() {
        found = Some(answer);
    }
    let found = found.unwrap();
    assert!(found.last && found.state.is_some() && found.proposal.is_none());
}
