//! Random moves of the example robots, every plan looked at again by the checker, which shares nothing with the planner:
//! no torque, speed, acceleration or position beyond its limit anywhere.

use takt_checker::{
    Arm, Bounds, Checker, Grid, Move,
    draw::{self, Draw},
};
use takt_motion::{
    budget::Budget,
    nalgebra::Matrix3,
    plan::{
        outcome::{Infeasible, MoveOutcome, MovePlan},
        plan_move,
        request::{LimitOverride, Method, MoveRequest, Sampling},
    },
    robot::{
        Robot,
        spec::{Inertial, RobotSpec},
    },
};
use takt_proto::convert::{self, Findings, Path};
use takt_tests::fixtures::example;

/// Plans of each robot that are looked at.
const PLANS: usize = 3000;

/// Excess that counts as none: roundings.
const EXCESS: f64 = 1e-9;

/// Joint travel between two samples of the planner's own verification, rad or m, and fewest samples of a stretch of
/// constant acceleration. The grid here is ten times as fine everywhere, also where a stretch has twice the mean speed.
const VERIFIER_TRAVEL: f64 = 0.2;
const VERIFIER_INTERVALS: usize = 8;
const FINER: usize = 10;

struct Trial {
    robot: Robot,
    draw: Draw,
    /// The heaviest payload that the maker allows, kg.
    max_payload: f64,
}

impl Trial {
    fn of(id: &str, seed: u64, max_payload: f64) -> Self {
        let mut findings = Findings::default();
        let wire = example(id);
        let description = convert::robot::description(&wire, Path::Root, &mut findings);
        assert!(findings.is_empty(), "{findings:?}");
        let resolved = description.expect("an example is a description").resolve();
        let resolved = resolved.unwrap_or_else(|errors| panic!("{errors:#?}"));
        Self {
            robot: Robot::new(resolved.spec, resolved.warnings).expect("an example is sound"),
            draw: Draw::seeded(seed),
            max_payload,
        }
    }

    fn spec(&self) -> &RobotSpec {
        self.robot.spec()
    }

    /// Anywhere, near, very near or hardly away at all; some joints stand still, some start or end at a limit.
    fn draw_ends(&mut self) -> (Vec<f64>, Vec<f64>) {
        let spec = self.robot.spec();
        let draw = &mut self.draw;
        let mut start = draw::pose_within(draw, spec);
        let mut target = draw::pose_within(draw, spec);
        let part = [1.0, 1.0, 0.3, 0.03, 1e-4][(draw.bits() % 5) as usize];
        for ((target, start), joint) in target.iter_mut().zip(&mut start).zip(&spec.joints) {
            *target = *start + (*target - *start) * part;
            let ends = (joint.limits.position_lower, joint.limits.position_upper);
            match draw.bits() % 32 {
                0..=2 => *target = *start,
                3 => *start = ends.0.unwrap_or(*start),
                4 => *target = ends.1.unwrap_or(*target),
                _ => {}
            }
        }
        (start, target)
    }

    fn draw_request(&mut self) -> MoveRequest {
        let (start, target) = self.draw_ends();
        let payload = self.draw_payload();
        let mut limits = self.draw_limits();
        let speeds: Vec<f64> = self
            .spec()
            .joints
            .iter()
            .filter_map(|joint| joint.limits.velocity)
            .collect();
        let draw = &mut self.draw;
        let asked: Vec<f64> = speeds.iter().map(|speed| speed * draw.between(0.05, 1.0)).collect();
        let target_velocity = draw.bits().is_multiple_of(4).then_some(asked);
        if target_velocity.is_some() {
            // A speed asked for above one's own limit is refused.
            limits.iter_mut().for_each(|own| own.velocity = None);
        }
        MoveRequest {
            start,
            target,
            target_velocity,
            payload,
            limits,
            torque_utilization: draw.between(0.3, 1.0),
            speed_scale: match draw.bits() % 3 {
                0 => 1.0,
                _ => draw.between(0.1, 1.0),
            },
            method: match draw.bits() % 8 {
                0 => Method::Preset,
                1 => Method::Endpoint,
                _ => Method::Verified,
            },
            sampling: Sampling::None,
            cycle_time: None,
        }
    }

    /// The model's own, none, or anything up to the heaviest.
    fn draw_payload(&mut self) -> Option<Inertial> {
        let draw = &mut self.draw;
        let mass = match draw.bits() % 4 {
            0 => return None,
            1 => 0.0,
            _ => draw.between(0.0, self.max_payload),
        };
        Some(Inertial {
            mass,
            center_of_mass: draw::vector(draw, 0.08),
            inertia: Matrix3::identity() * (1e-3 * mass),
        })
    }

    /// Now and then one joint's limits tightened.
    fn draw_limits(&mut self) -> Vec<LimitOverride> {
        let draw = &mut self.draw;
        if !draw.bits().is_multiple_of(4) {
            return Vec::new();
        }
        let joints = &self.robot.spec().joints;
        let joint = &joints[(draw.bits() % joints.len() as u64) as usize];
        let mut part = |limit: Option<f64>, least: f64| limit.map(|limit| limit * draw.between(least, 1.0));
        vec![LimitOverride {
            joint: joint.name.clone(),
            velocity: part(joint.limits.velocity, 0.1),
            acceleration: part(joint.limits.acceleration, 0.1),
            peak_torque: part(joint.drive.peak_torque, 0.7),
            ..LimitOverride::default()
        }]
    }

    /// Asserts that a plan keeps every limit.
    fn check(&self, request: &MoveRequest, plan: &MovePlan) {
        let bounds = Bounds::of_request(self.spec(), request);
        let travel: f64 = request
            .start
            .iter()
            .zip(&request.target)
            .map(|(from, to)| (to - from).abs())
            .sum();
        let grid = Grid {
            per_interval: FINER * VERIFIER_INTERVALS,
            per_move: (2.0 * FINER as f64 * travel / VERIFIER_TRAVEL).ceil() as usize,
        };
        let emitted = Move {
            start: &request.start,
            target: &request.target,
            patterns: &plan.patterns,
        };
        let arm = Arm::new(self.spec(), request.payload.as_ref());
        let report = Checker::new(arm)
            .check(&bounds, &emitted, grid)
            .expect("one entry a joint");
        assert_eq!(report.inconsistencies, [], "{request:#?}\n{:#?}", plan.patterns);
        assert!(
            report.holds(EXCESS),
            "{:?}\n{request:#?}\n{:#?}",
            report.worst(),
            plan.patterns
        );
        for margin in &plan.torque_margins {
            assert!(margin.margin >= 0.0, "{margin:?}\n{request:#?}");
        }
    }

    fn run(mut self) {
        let (mut plan_count, mut infeasible_count) = (0, 0);
        while plan_count < PLANS {
            let request = self.draw_request();
            match plan_move(&self.robot, &request, &Budget::unlimited()).expect("the request is right") {
                MoveOutcome::Plan(plan) => {
                    self.check(&request, &plan);
                    plan_count += 1;
                }
                MoveOutcome::Infeasible(refusal) => {
                    check_evidence(&refusal, &request);
                    infeasible_count += 1;
                }
            }
        }
        assert!(
            infeasible_count <= plan_count,
            "{infeasible_count} moves cannot be, {plan_count} can"
        );
    }
}

/// A refusal says what is needed, and that it is more than there is.
fn check_evidence(refusal: &Infeasible, request: &MoveRequest) {
    assert!(refusal.needed.abs() > refusal.available, "{refusal:?}\n{request:#?}");
    assert!((0.0..=1.0).contains(&refusal.location), "{refusal:?}");
    assert!(!refusal.suggestion.is_empty(), "{refusal:?}");
}

#[test]
fn ur5e_keeps_every_limit() {
    Trial::of("ur5e", 0x05e5, 5.0).run();
}

#[test]
fn fr3_keeps_every_limit() {
    Trial::of("fr3", 0x0f43, 3.0).run();
}

#[test]
fn puma_keeps_every_limit() {
    Trial::of("puma560", 0x0560, 2.5).run();
}

#[test]
fn scara_keeps_every_limit() {
    Trial::of("scara", 0x5ca4, 2.0).run();
}

/// A move that an earlier planner got wrong.
struct Found {
    robot: &'static str,
    start: &'static [f64],
    target: &'static [f64],
    payload_kg: f64,
    payload_center: [f64; 3],
    torque_utilization: f64,
    speed_scale: f64,
    method: Method,
}

impl Found {
    /// Asserts that it has a plan, and that the plan keeps every limit.
    fn check(&self) {
        let trial = Trial::of(self.robot, 0, 0.0);
        let request = MoveRequest {
            payload: Some(Inertial {
                mass: self.payload_kg,
                center_of_mass: self.payload_center.into(),
                inertia: Matrix3::identity() * (1e-3 * self.payload_kg),
            }),
            torque_utilization: self.torque_utilization,
            speed_scale: self.speed_scale,
            method: self.method,
            ..MoveRequest::new(self.start.to_vec(), self.target.to_vec())
        };
        let outcome = plan_move(&trial.robot, &request, &Budget::unlimited());
        match outcome.expect("the request is right") {
            MoveOutcome::Plan(plan) => trial.check(&request, &plan),
            MoveOutcome::Infeasible(refusal) => panic!("{refusal:?}"),
        }
    }
}

/// Its torque limit was exceeded by 3e-6, 28 ms after a switching time.
#[test]
fn a_peak_soon_after_a_switching_time_is_seen() {
    Found {
        robot: "ur5e",
        start: &[
            1.9586408090251926,
            -5.329509687343432,
            2.0249232581299887,
            2.929321995481658,
            -2.4812812237706097,
            5.000242329719843,
        ],
        target: &[
            -0.6752551449916133,
            -0.24076288580445926,
            -1.545613809313278,
            -0.3746817729847516,
            -4.94583587935986,
            5.000242329719843,
        ],
        payload_kg: 3.1968181749042133,
        payload_center: [0.05055242249049961, 0.034580942698722514, 0.015046465427218894],
        torque_utilization: 0.5806504428342663,
        speed_scale: 1.0,
        method: Method::Preset,
    }
    .check();
}

/// It was said to have no feasible speed: acceleration and deceleration just fill the way, and a rounding decided.
#[test]
fn ramps_that_just_fill_the_way_are_planned() {
    Found {
        robot: "fr3",
        start: &[
            1.5694021177561823,
            0.7693861499491077,
            -2.609698753757953,
            -2.6420881104898277,
            -0.43383135025771313,
            1.9927677163689537,
            -2.6152598806523275,
        ],
        target: &[
            1.5876003664647143,
            0.7504697724958962,
            -2.601263995726098,
            -2.6461096094475764,
            -0.4065875095524071,
            1.9827258396401204,
            -2.6152598806523275,
        ],
        payload_kg: 2.5272228043480194,
        payload_center: [0.06891494779299671, 0.0430164549438226, -0.03948804803360902],
        torque_utilization: 0.4581869151337843,
        speed_scale: 0.6965456793180083,
        method: Method::Verified,
    }
    .check();
}

/// It was said to have no feasible speed: planning and verifying took turns for longer than they may.
#[test]
fn a_plan_that_needs_many_rounds_is_found() {
    Found {
        robot: "scara",
        start: &[
            -1.8392686658546542,
            1.6026464002244798,
            0.1207108714082664,
            -4.5983652875193295,
        ],
        target: &[
            -2.216562656980207,
            -0.296033897211331,
            0.1907182473826838,
            -5.375793383537693,
        ],
        payload_kg: 1.4384526612676265,
        payload_center: [0.04770362687800066, -0.03374451639642501, -0.07735182127012387],
        torque_utilization: 0.59941604075698,
        speed_scale: 1.0,
        method: Method::Verified,
    }
    .check();
}
