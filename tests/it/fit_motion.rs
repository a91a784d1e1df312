//! Fits to one recording that are compared with another, over both protocols.

use takt_client::{
    Code, Error,
    v1::{self, fit_drive_request::Fit, fit_drive_response::Outcome, motion_fit_request::Scope},
};
use takt_tests::{
    Protocol, TestServer,
    telemetry::{ROBOT, Reporter},
};

/// Every so many samples of 1 kHz are kept: 50 Hz, above what the band asks for.
const THINNED: usize = 20;

/// So many seconds of the arm, from when its clock was at 0.
fn recorded(seconds: u32) -> v1::Telemetry {
    let mut recording = Reporter::default().block(1000 * seconds);
    let thin = |values: &mut Vec<f64>| *values = values.iter().copied().step_by(THINNED).collect();
    thin(&mut recording.time_s);
    for joint in &mut recording.joints {
        for column in [&mut joint.position, &mut joint.velocity, &mut joint.torque] {
            thin(column);
        }
    }
    recording
}

fn part(begin_s: f64, end_s: f64) -> Option<v1::TimeRange> {
    Some(v1::TimeRange { begin_s, end_s })
}

/// A fit of friction to the first 7 s of a recording.
fn motion() -> v1::MotionFitRequest {
    v1::MotionFitRequest {
        recording: Some(recorded(10)),
        identify: part(0.0, 7.0),
        scope: Some(Scope::Friction.into()),
        presliding: Some(false),
        ..Default::default()
    }
}

async fn ask(server: &TestServer, motion: v1::MotionFitRequest) -> Result<v1::FitDriveResponse, Error> {
    let mut both = Vec::new();
    for protocol in Protocol::BOTH {
        let request = v1::FitDriveRequest {
            robot_id: ROBOT.to_owned(),
            fit: Some(Fit::Motion(motion.clone())),
            ..Default::default()
        };
        both.push(server.client(protocol).fit_drive(request).await);
    }
    let (http, grpc) = (both.pop().unwrap(), both.pop().unwrap());
    match (&http, &grpc) {
        (Ok(http), Ok(grpc)) => assert_eq!(http, grpc, "both protocols say the same"),
        (Err(http), Err(grpc)) => assert_eq!(http.violations(), grpc.violations()),
        _ => panic!("{http:?} {grpc:?}"),
    }
    http
}

async fn fitted(server: &TestServer, motion: v1::MotionFitRequest) -> v1::MotionFit {
    match ask(server, motion).await.unwrap().outcome {
        Some(Outcome::Motion(fit)) => fit,
        other => panic!("{other:?}"),
    }
}

/// What is wrong: field and words.
async fn refused(server: &TestServer, motion: v1::MotionFitRequest) -> Vec<(String, String)> {
    let error = ask(server, motion).await.unwrap_err();
    assert_eq!(error.code(), Code::InvalidRequest, "{error}");
    let violations = error.violations().iter();
    violations
        .map(|one| (one.field.clone(), one.description.clone()))
        .collect()
}

#[tokio::test]
async fn another_recording_is_compared_with_as_a_part_of_the_same_is() {
    let server = TestServer::start().await;
    let within = v1::MotionFitRequest {
        test: part(7.5, 9.5),
        ..motion()
    };
    let one = fitted(&server, within.clone()).await;
    let beside = v1::MotionFitRequest {
        test_recording: within.recording.clone(),
        ..within
    };
    let two = fitted(&server, beside.clone()).await;
    assert_eq!(one, two, "the same samples, the same figures");

    // the torques of another day are larger by a half: a third of them is not said
    let mut other = recorded(4);
    for joint in &mut other.joints {
        joint.torque.iter_mut().for_each(|torque| *torque *= 1.5);
    }
    let count = other.time_s.len();
    let all = v1::MotionFitRequest {
        test: None,
        test_recording: Some(other),
        ..beside
    };
    let fit = fitted(&server, all.clone()).await;
    assert_eq!((&fit.estimates, &fit.joints), (&one.estimates, &one.joints));
    let (before, after) = (fit.before.unwrap(), fit.after.unwrap());
    // an even grid ends up to a period before the last sample
    assert!(
        (count - 1..=count).contains(&(after.sample_count as usize)),
        "{after:?}"
    );
    for (before, after) in before.joints.iter().zip(&after.joints) {
        assert!((after.error - 1.0 / 3.0).abs() < 0.03, "{after:?}");
        assert!(before.error > after.error, "{before:?} {after:?}");
    }
    let overlapping = v1::MotionFitRequest {
        test: part(1.0, 3.0),
        ..all
    };
    let fit = fitted(&server, overlapping.clone()).await;
    assert!(fit.after.unwrap().sample_count < after.sample_count);
    let one_recording = v1::MotionFitRequest {
        test_recording: None,
        ..overlapping
    };
    let found = refused(&server, one_recording).await;
    assert_eq!(found[0].0, "motion.test", "{found:?}");
}

#[tokio::test]
async fn the_recording_that_was_fitted_is_no_other_one() {
    let server = TestServer::start().await;
    let cut = |seconds| v1::MotionFitRequest {
        test_recording: Some(recorded(seconds)),
        ..motion()
    };
    let whole = v1::MotionFitRequest {
        identify: None,
        ..cut(10)
    };
    // a shorter one of the same is the beginning of it
    let overlapping = v1::MotionFitRequest {
        test: part(6.0, 9.0),
        ..cut(10)
    };
    for (motion, part) in [
        (whole, "`identify` is not given"),
        (cut(4), "0 to 7 s are fitted"),
        (overlapping, "6 to 7 s are in both"),
    ] {
        let found = refused(&server, motion).await;
        assert_eq!(found[0].0, "motion.test_recording", "{found:?}");
        for part in [part, "has the samples of `recording`"] {
            assert!(found[0].1.contains(part), "{found:?}");
        }
    }
}

#[tokio::test]
async fn what_is_wrong_with_the_other_recording_is_named_there() {
    let server = TestServer::start().await;
    let with = |test: Option<v1::TimeRange>, change: &dyn Fn(&mut v1::Telemetry)| {
        let mut other = recorded(4);
        // named joints may come in any order: places are those of the request
        other.joints.reverse();
        change(&mut other);
        v1::MotionFitRequest {
            test,
            test_recording: Some(other),
            ..motion()
        }
    };
    for (motion, field) in [
        (
            with(None, &|other| other.joints[1].torque[7] = f64::NAN),
            "motion.test_recording.joints[1].torque[7]",
        ),
        (
            with(None, &|other| other.joints[2].position[9] = 1e12),
            "motion.test_recording.joints[2].position[9]",
        ),
        (
            with(None, &|other| other.time_s[5] = 0.0),
            "motion.test_recording.time_s[5]",
        ),
        (
            with(None, &|other| {
                other.joints[3].velocity.pop();
            }),
            "motion.test_recording.joints[3].velocity",
        ),
        (
            with(None, &|other| {
                other.joints.pop();
            }),
            "motion.test_recording.joints",
        ),
        (with(part(100.0, 101.0), &|_| {}), "motion.test"),
    ] {
        let found = refused(&server, motion).await;
        let fields: Vec<&str> = found.iter().map(|(field, _)| field.as_str()).collect();
        assert_eq!(fields[0], field, "{found:?}");
    }
}

/// A log whose sensor failed has thousands of values that are none: they are counted, and what else is wrong is still said.
#[tokio::test]
async fn many_values_that_are_no_numbers_are_one_finding_a_series() {
    let server = TestServer::start().await;
    let mut motion = motion();
    let mut other = recorded(4);
    let recording = motion.recording.as_mut().unwrap();
    recording.joints[2].torque[100..].fill(f64::NAN);
    recording.joints[4].velocity[3] = f64::NAN;
    other.joints[0].position[20..].fill(f64::NAN);
    let (torques, positions) = (recording.time_s.len() - 100, other.time_s.len() - 20);
    motion.test_recording = Some(other);
    let found = refused(&server, motion.clone()).await;
    assert_eq!(found.len(), 3, "{found:?}");
    for (field, said) in [
        (
            "motion.recording.joints[4].velocity[3]",
            "NaN is not a finite number".to_owned(),
        ),
        (
            "motion.recording.joints[2].torque[100]",
            format!("NaN is not a finite number; the first of {torques} places"),
        ),
        (
            "motion.test_recording.joints[0].position[20]",
            format!("NaN is not a finite number; the first of {positions} places"),
        ),
    ] {
        let of = found.iter().find(|(of, _)| of == field);
        assert!(of.is_some_and(|(_, words)| words.contains(&said)), "{field}: {found:?}");
    }
    motion.test_recording = None;
    motion.recording = Some(recorded(10));
    motion.recording.as_mut().unwrap().joints[1].torque[200..].fill(1e12);
    let found = refused(&server, motion).await;
    let (field, words) = &found[0];
    assert_eq!(field, "motion.recording.joints[1].torque[200]", "{found:?}");
    assert!(words.contains("the first of 300 places"), "{words}");
}
