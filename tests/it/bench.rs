//! Fits of one joint on the bench, over both protocols: what was put in comes out, and is proposed.

use takt_client::{
    Code,
    v1::{self, fit_drive_request::Fit, fit_drive_response::Outcome},
};
use takt_tests::{Protocol, TestServer};

/// A joint of the example arm that has a rotor.
const JOINT: &str = "shoulder";

async fn fit(server: &TestServer, fit: Fit) -> (Outcome, Option<v1::ModelProposal>) {
    let mut both = Vec::new();
    for protocol in Protocol::BOTH {
        let request = v1::FitDriveRequest {
            robot_id: "scara".to_owned(),
            fit: Some(fit.clone()),
            ..Default::default()
        };
        both.push(server.client(protocol).fit_drive(request).await.unwrap());
    }
    assert_eq!(both[0], both[1], "both protocols say the same");
    let reply = both.remove(0);
    (reply.outcome.unwrap(), reply.proposal)
}

fn drive(proposal: v1::ModelProposal) -> v1::Drive {
    assert_eq!(proposal.joints, [JOINT]);
    let joints = proposal.description.unwrap().joints;
    let joint = joints.into_iter().find(|joint| joint.name == JOINT);
    joint.unwrap().drive.unwrap()
}

#[tokio::test]
async fn a_spring_is_found() {
    let server = TestServer::start().await;
    let deformation: Vec<f64> = (-10..=10).map(|step| f64::from(step) * 1e-4).collect();
    let torque = deformation.iter().map(|at| 12_000.0 * at + 3e9 * at.powi(3) + 0.5);
    let (outcome, proposal) = fit(
        &server,
        Fit::Stiffness(v1::StiffnessFitRequest {
            joint: JOINT.to_owned(),
            torque: torque.collect(),
            deformation,
            terms: Some(2),
        }),
    )
    .await;
    let Outcome::Stiffness(found) = outcome else {
        panic!("{outcome:?}");
    };
    assert!(
        (found.stiffness[0] - 12_000.0).abs() < 1e-3 && (found.offset_torque - 0.5).abs() < 1e-6,
        "{found:?}"
    );
    let drive = drive(proposal.unwrap());
    assert_eq!(drive.stiffness, found.stiffness);
    assert_eq!(drive.friction.len(), 1, "what was not fitted stays");
}

#[tokio::test]
async fn friction_at_constant_speed_is_found() {
    let server = TestServer::start().await;
    let runs = [-2.0, -1.0, -0.5, 0.5, 1.0, 2.0].map(|speed: f64| v1::ConstantSpeedRun {
        speed,
        motor_torque: 3.0 * speed + if speed > 0.0 { 5.0 } else { -4.0 },
        deformation: None,
    });
    let (outcome, proposal) = fit(
        &server,
        Fit::ConstantSpeed(v1::ConstantSpeedFitRequest {
            joint: JOINT.to_owned(),
            runs: runs.into(),
        }),
    )
    .await;
    let Outcome::ConstantSpeed(found) = outcome else {
        panic!("{outcome:?}");
    };
    let total = found.total.unwrap();
    for (found, truth) in [
        (total.viscous, 3.0),
        (total.coulomb_positive, 5.0),
        (total.coulomb_negative, 4.0),
    ] {
        assert!((found - truth).abs() < 1e-9, "{total:?}");
    }
    assert_eq!(
        drive(proposal.unwrap()).friction[0].coulomb_negative,
        Some(total.coulomb_negative)
    );
}

/// Two maxima cannot tell damping from Coulomb friction: that is an answer.
#[tokio::test]
async fn what_maxima_do_not_tell_is_said() {
    let server = TestServer::start().await;
    let maxima = |time_s: &[f64], amplitude: &[f64]| {
        Fit::Damping(v1::DampingFitRequest {
            joint: JOINT.to_owned(),
            time_s: time_s.to_vec(),
            amplitude: amplitude.to_vec(),
        })
    };
    let (outcome, proposal) = fit(&server, maxima(&[0.0, 0.02], &[1e-3, 0.8e-3])).await;
    assert!(matches!(outcome, Outcome::NotExcited(_)), "{outcome:?}");
    assert!(proposal.is_none());
    let ratio: f64 = 0.8;
    let amplitude: Vec<f64> = (0..5).map(|step| 1e-3 * ratio.powi(step)).collect();
    let (outcome, proposal) = fit(&server, maxima(&[0.0, 0.02, 0.04, 0.06, 0.08], &amplitude)).await;
    let Outcome::Damping(found) = outcome else {
        panic!("{outcome:?}");
    };
    assert!(found.coulomb.abs() < 1e-6 && found.damping > 0.0, "{found:?}");
    assert_eq!(drive(proposal.unwrap()).damping, Some(found.damping));
}

#[tokio::test]
async fn what_is_wrong_is_named() {
    let server = TestServer::start().await;
    let stiffness = |joint: &str, torque: &[f64], terms| {
        Some(Fit::Stiffness(v1::StiffnessFitRequest {
            joint: joint.to_owned(),
            torque: torque.to_vec(),
            deformation: vec![0.0, 1e-3, 2e-3],
            terms,
        }))
    };
    for protocol in Protocol::BOTH {
        for (fit, field) in [
            (None, "motion"),
            (stiffness("tail", &[0.0, 1.0, 2.0], None), "stiffness.joint"),
            (stiffness(JOINT, &[0.0, 1.0], None), "stiffness.deformation"),
            (stiffness(JOINT, &[0.0, f64::NAN, 2.0], None), "stiffness.torque[1]"),
            (stiffness(JOINT, &[0.0, 1.0, 2.0], Some(0)), "stiffness.terms"),
            (
                Some(Fit::Damping(v1::DampingFitRequest {
                    joint: JOINT.to_owned(),
                    time_s: vec![0.0, 1.0, 0.5],
                    amplitude: vec![1.0, 0.5, 0.3],
                })),
                "damping.time_s[2]",
            ),
        ] {
            let request = v1::FitDriveRequest {
                robot_id: "scara".to_owned(),
                fit,
                ..Default::default()
            };
            let error = server.client(protocol).fit_drive(request).await.unwrap_err();
            assert_eq!(error.code(), Code::InvalidRequest, "{field}");
            assert_eq!(error.violations()[0].field, field, "{error}");
        }
    }
}

/// An arm at rest, logged in degrees, is no fit; that is said, and what is odd about it.
#[tokio::test]
async fn a_fit_that_cannot_be_tells_what_looks_wrong_with_the_log() {
    let server = TestServer::start().await;
    let times: Vec<f64> = (0..400).map(|index| 0.01 * f64::from(index)).collect();
    let of = |of: &dyn Fn(f64) -> f64| times.iter().map(|time| of(*time)).collect::<Vec<_>>();
    let joint = v1::TelemetryColumns {
        position: of(&|_| 90.0),
        torque: of(&|time| time.cos()),
        ..Default::default()
    };
    let motion = Fit::Motion(v1::MotionFitRequest {
        recording: Some(v1::Telemetry {
            joints: vec![joint; 4],
            time_s: times.clone(),
        }),
        scope: Some(1),
        ..Default::default()
    });
    let (outcome, proposal) = fit(&server, motion).await;
    let Outcome::NotExcited(told) = outcome else {
        panic!("{outcome:?}");
    };
    assert!(proposal.is_none());
    assert!(told.warnings.iter().any(|hint| hint.contains("degrees")), "{told:?}");
}
