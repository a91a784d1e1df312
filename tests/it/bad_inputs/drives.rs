//! Streams of telemetry that cannot begin, and rehearsals that cannot be run. What is wrong with telemetry itself ends a
//! stream that has begun: that is in `telemetry.rs`.

use takt_proto::v1::{
    self, EstimateFrictionRequest, EstimateHeader, PlanMoveRequest, RehearseRequest, estimate_friction_request::Part,
    rehearse_request::Motion,
};
use takt_tests::fixtures::{good_check, good_move};

use super::{NOT_FOUND, Row};

fn estimate(name: &str, change: impl FnOnce(&mut EstimateHeader), fields: &[&str]) -> Row {
    let mut header = EstimateHeader::default();
    change(&mut header);
    let request = EstimateFrictionRequest {
        robot_id: "ur5e".to_owned(),
        part: Some(Part::Header(header)),
    };
    Row::message(&format!("telemetry: {name}"), &request, fields)
}

fn prior(joint: &str, mean: &[f64], covariance: &[f64]) -> v1::FrictionPrior {
    v1::FrictionPrior {
        joint: joint.to_owned(),
        mean: mean.to_vec(),
        covariance: covariance.to_vec(),
    }
}

fn rehearse(name: &str, change: impl FnOnce(&mut RehearseRequest), fields: &[&str]) -> Row {
    let mut request = RehearseRequest {
        robot_id: "ur5e".to_owned(),
        motion: Some(Motion::Move(PlanMoveRequest {
            robot_id: String::new(),
            ..good_move()
        })),
        ..Default::default()
    };
    change(&mut request);
    Row::message(&format!("rehearsal: {name}"), &request, fields)
}

fn motion(name: &str, change: impl FnOnce(&mut PlanMoveRequest), fields: &[&str]) -> Row {
    rehearse(
        name,
        |m| {
            if let Some(Motion::Move(motion)) = &mut m.motion {
                change(motion);
            }
        },
        fields,
    )
}

fn truth(name: &str, truth: v1::FrictionTruth, fields: &[&str]) -> Row {
    rehearse(name, |m| m.friction = vec![truth], fields)
}

fn encoder(name: &str, encoder: v1::Encoder, fields: &[&str]) -> Row {
    rehearse(name, |m| m.encoders = vec![encoder], fields)
}

pub(super) fn rows() -> Vec<Row> {
    [estimates(), rehearsals()].into_iter().flatten().collect()
}

fn estimates() -> Vec<Row> {
    let nan = f64::NAN;
    vec![
        estimate("method unspecified", |m| m.method = Some(0), &["header.method"]),
        estimate("side unspecified", |m| m.side = Some(0), &["header.side"]),
        estimate("half-life 0", |m| m.half_life_s = Some(0.0), &["header.half_life_s"]),
        estimate("half-life NaN", |m| m.half_life_s = Some(nan), &["header.half_life_s"]),
        estimate("forgetting 2", |m| m.forgetting = Some(2.0), &["header.forgetting"]),
        estimate("forgetting 0", |m| m.forgetting = Some(0.0), &["header.forgetting"]),
        estimate(
            "two memories",
            |m| (m.half_life_s, m.forgetting) = (Some(1.0), Some(0.9)),
            &["header.forgetting"],
        ),
        estimate("dead band below 0", |m| m.dead_band = Some(-1.0), &["header.dead_band"]),
        estimate(
            "bandwidth 1e9",
            |m| m.bandwidth_hz = Some(1e9),
            &["header.bandwidth_hz"],
        ),
        estimate("gap 0", |m| m.gap_s = Some(0.0), &["header.gap_s"]),
        estimate("gap infinite", |m| m.gap_s = Some(f64::INFINITY), &["header.gap_s"]),
        estimate(
            "threshold 0.5",
            |m| m.outlier_threshold = Some(0.5),
            &["header.outlier_threshold"],
        ),
        estimate(
            "rate 0",
            |m| m.observer_rate_per_s = Some(0.0),
            &["header.observer_rate_per_s"],
        ),
        estimate("drift NaN", |m| m.drift = Some(nan), &["header.drift"]),
        estimate(
            "period 0",
            |m| m.report_period_s = Some(0.0),
            &["header.report_period_s"],
        ),
        estimate(
            "period NaN",
            |m| m.report_period_s = Some(nan),
            &["header.report_period_s"],
        ),
        estimate(
            "a prior of nobody",
            |m| m.prior = vec![prior("tail", &[1.0, 1.0], &[1.0, 0.0, 1.0])],
            &["header.prior[0].joint"],
        ),
        estimate(
            "a prior twice",
            |m| m.prior = vec![prior("elbow_joint", &[1.0, 1.0], &[1.0, 0.0, 1.0]); 2],
            &["header.prior[1].joint"],
        ),
        estimate(
            "a prior of three terms",
            |m| m.prior = vec![prior("elbow_joint", &[1.0, 1.0, 1.0], &[1.0, 0.0, 1.0])],
            &["header.prior[0].mean"],
        ),
        estimate(
            "a prior that cannot be",
            |m| m.prior = vec![prior("elbow_joint", &[1.0, 1.0], &[1.0, 2.0, 1.0])],
            &["header.prior[0].covariance"],
        ),
        estimate(
            "a prior that is no number",
            |m| m.prior = vec![prior("elbow_joint", &[nan, 1.0], &[1.0, 0.0, 1.0])],
            &["header.prior[0].mean[0]"],
        ),
        estimate(
            "an empty state",
            |m| m.state = Some(v1::FrictionState::default()),
            &["header.state.version"],
        ),
        estimate(
            "a state of another robot",
            |m| {
                m.state = Some(v1::FrictionState {
                    version: 3,
                    reals: vec![1.0; 3],
                    counts: vec![1; 3],
                });
            },
            &["header.state.reals"],
        ),
        estimate(
            "a state and a prior",
            |m| {
                m.state = Some(v1::FrictionState::default());
                m.prior = vec![prior("elbow_joint", &[1.0, 1.0], &[1.0, 0.0, 1.0])];
            },
            &["header.prior"],
        ),
        estimate(
            "a payload below 0",
            |m| m.payload.get_or_insert_default().mass_kg = Some(-1.0),
            &["header.payload.mass_kg"],
        ),
        estimate("no such revision", |m| m.revision = Some("r".to_owned()), &[]).refused(NOT_FOUND),
    ]
}

fn rehearsals() -> Vec<Row> {
    let nan = f64::NAN;
    let of = |coulomb_scale| v1::FrictionTruth {
        coulomb_scale: Some(coulomb_scale),
        ..Default::default()
    };
    vec![
        rehearse("no motion", |m| m.motion = None, &["move"]),
        rehearse("no such robot", |m| m.robot_id = "nobody".to_owned(), &[]).refused(NOT_FOUND),
        rehearse("robot without a name", |m| m.robot_id = "?".to_owned(), &["robot_id"]),
        rehearse("no such revision", |m| m.revision = Some("r".to_owned()), &[]).refused(NOT_FOUND),
        motion("another robot", |m| m.robot_id = "fr3".to_owned(), &["move.robot_id"]),
        motion(
            "samples",
            |m| m.sample_period_s = Some(0.004),
            &["move.sample_period_s"],
        ),
        motion("a trace", |m| m.trace_points = Some(9), &["move.trace_points"]),
        motion("a move without target", |m| m.target = None, &["move.target"]),
        motion(
            "a move at twice the speed",
            |m| m.speed_scale = Some(2.0),
            &["move.speed_scale"],
        ),
        rehearse("period 0", |m| m.period_s = Some(0.0), &["period_s"]),
        rehearse("period NaN", |m| m.period_s = Some(nan), &["period_s"]),
        rehearse("period of a second", |m| m.period_s = Some(1.0), &["period_s"]),
        rehearse("settling backwards", |m| m.settle_s = Some(-1.0), &["settle_s"]),
        rehearse("settling for ever", |m| m.settle_s = Some(1e11), &["settle_s"]),
        rehearse("every 0th step", |m| m.trace_every = Some(0), &["trace_every"]),
        rehearse(
            "rate below 0",
            |m| m.adaptation_rate_per_s = Some(-1.0),
            &["adaptation_rate_per_s"],
        ),
        truth("friction below 0", of(-1.0), &["friction[0].coulomb_scale"]),
        truth("friction NaN", of(nan), &["friction[0].coulomb_scale"]),
        truth(
            "friction of nobody",
            v1::FrictionTruth {
                joint: "tail".to_owned(),
                ..Default::default()
            },
            &["friction[0].joint"],
        ),
        truth(
            "friction that grows too fast",
            v1::FrictionTruth {
                joint: "elbow_joint".to_owned(),
                viscous_scale_rate: Some(1e9),
                ..Default::default()
            },
            &["friction[0].viscous_scale_rate"],
        ),
        rehearse(
            "friction of all twice",
            |m| m.friction = vec![v1::FrictionTruth::default(); 2],
            &["friction[1].joint"],
        ),
        encoder(
            "an encoder of metres",
            v1::Encoder {
                motor_step: Some(2.0),
                ..Default::default()
            },
            &["encoders[0].motor_step"],
        ),
        encoder(
            "an encoder with noise below 0",
            v1::Encoder {
                output_noise: Some(-1.0),
                ..Default::default()
            },
            &["encoders[0].output_noise"],
        ),
        rehearse(
            "a wrench of two numbers",
            |m| {
                m.wrenches = vec![v1::WrenchPulse {
                    force_n: vec![1.0, 2.0],
                    end_s: 1.0,
                    ..Default::default()
                }];
            },
            &["wrenches[0].force_n"],
        ),
        rehearse(
            "a wrench that ends first",
            |m| {
                m.wrenches = vec![v1::WrenchPulse {
                    begin_s: 1.0,
                    ..Default::default()
                }];
            },
            &["wrenches[0]"],
        ),
        rehearse(
            "gains of one joint",
            |m| {
                m.gains = vec![v1::JointGains {
                    joint: "elbow_joint".to_owned(),
                    ..Default::default()
                }];
            },
            &["gains"],
        ),
        rehearse(
            "a current limit of 0",
            |m| m.current_limits = vec![v1::CurrentLimit::default()],
            &["current_limits[0].current_a"],
        ),
        rehearse(
            "a payload below 0",
            |m| m.true_payload.get_or_insert_default().mass_kg = Some(-1.0),
            &["true_payload.mass_kg"],
        ),
        rehearse(
            "set-points without points",
            |m| {
                let trajectory = good_check(0).trajectory;
                m.motion = Some(Motion::Setpoints(v1::SetpointMotion {
                    trajectory,
                    payload: None,
                }));
            },
            &["setpoints.trajectory.points"],
        ),
        rehearse(
            "set-points without a trajectory",
            |m| m.motion = Some(Motion::Setpoints(v1::SetpointMotion::default())),
            &["setpoints.trajectory"],
        ),
    ]
}
