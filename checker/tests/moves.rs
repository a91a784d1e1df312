//! The planner's moves, looked at by someone else: every limit holds, the figures of a plan are true, and its end-pose
//! method is the one that JP4358979B2 describes.

#[path = "oracle/arms.rs"]
#[allow(dead_code, reason = "shared with tests that need more of it")]
mod arms;

use nalgebra::{Matrix3, Vector3};
use serde_json::Value;
use takt_checker::claims::{Figure, false_claims};
use takt_checker::draw::{self, Draw};
use takt_checker::endpoint::{self, EndpointMove, Preset};
use takt_checker::{Arm, Bounds, Checker, Grid, Move, Report};
use takt_motion::budget::Budget;
use takt_motion::plan::outcome::{Fallback, LimitKind, MoveOutcome, MovePlan, Pattern};
use takt_motion::plan::plan_move;
use takt_motion::plan::request::{LimitOverride, Method, MoveRequest};
use takt_motion::robot::Robot;
use takt_motion::robot::spec::{Inertial, RobotSpec};

/// Moves of each arm by each method.
const MOVES: usize = 300;

/// Excess that counts as none: roundings.
const EXCESS: f64 = 1e-9;

/// What a plan says may differ by so much from what the recheck samples: its grid misses a peak by up to 1e-4 of a
/// limit.
const CLAIMS: f64 = 1e-4;

/// Largest relative difference between two writings of the end-pose method.
const AGREEMENT: f64 = 1e-6;

/// The same for the peak power, which the planner reads off a parabola through its samples.
const POWER_CLAIMS: f64 = 1e-2;

struct Trial {
    robot: Robot,
    draw: Draw,
}

impl Trial {
    fn of(spec: RobotSpec) -> Self {
        Self {
            robot: Robot::new(spec, Vec::new()).expect("the arm is sound"),
            draw: Draw::seeded(7),
        }
    }

    /// A move anywhere, or near the start; now and then some joints stand still.
    fn draw_move(&mut self) -> (Vec<f64>, Vec<f64>) {
        let spec = self.robot.spec().clone();
        let draw = &mut self.draw;
        let start = draw::pose_within(draw, &spec);
        let mut target = draw::pose_within(draw, &spec);
        let part = [1.0, 0.3, 0.03, 1e-4][(draw.bits() % 4) as usize];
        for (target, start) in target.iter_mut().zip(&start) {
            *target = match draw.bits() % 8 {
                0 => *start,
                _ => start + (*target - start) * part,
            };
        }
        (start, target)
    }

    fn draw_request(&mut self, method: Method) -> MoveRequest {
        let (start, target) = self.draw_move();
        let draw = &mut self.draw;
        let joint = &self.robot.spec().joints[(draw.bits() % start.len() as u64) as usize];
        let tightened = LimitOverride {
            joint: joint.name.clone(),
            velocity: joint.limits.velocity.map(|speed| speed * draw.between(0.2, 1.0)),
            peak_torque: joint.drive.peak_torque.map(|peak| peak * draw.between(0.8, 1.0)),
            ..LimitOverride::default()
        };
        let payload = Inertial {
            mass: draw.between(0.0, 1.5),
            center_of_mass: draw::vector(draw, 0.1),
            inertia: Matrix3::identity() * 1e-3,
        };
        MoveRequest {
            payload: draw.bits().is_multiple_of(2).then_some(payload),
            limits: draw.bits().is_multiple_of(3).then_some(tightened).into_iter().collect(),
            torque_utilization: draw.between(0.7, 1.0),
            speed_scale: draw.between(0.5, 1.0),
            method,
            ..MoveRequest::new(start, target)
        }
    }

    fn plan(&self, request: &MoveRequest) -> Option<Box<MovePlan>> {
        match plan_move(&self.robot, request, &Budget::unlimited()).expect("the request is right") {
            MoveOutcome::Plan(plan) => Some(plan),
            MoveOutcome::Infeasible(_) => None,
        }
    }

    fn recheck(&self, request: &MoveRequest, bounds: &[Bounds], patterns: &[Pattern], grid: Grid) -> Report {
        let arm = Arm::new(self.robot.spec(), request.payload.as_ref());
        let emitted = Move {
            start: &request.start,
            target: &request.target,
            patterns,
        };
        Checker::new(arm)
            .check(bounds, &emitted, grid)
            .expect("one entry a joint")
    }

    /// The end-pose method by the checker's own writing, from the planner's presets.
    fn endpoint_move(&self, request: &MoveRequest, bounds: &[Bounds], fallback: Fallback) -> EndpointMove {
        let arm = Arm::new(self.robot.spec(), request.payload.as_ref());
        let of_joint = |joint| self.robot.preset(joint).expect("the arm has limits");
        let joints = 0..bounds.len();
        let preset = Preset {
            velocity: bounds.iter().filter_map(|one| one.velocity).collect(),
            acceleration: joints.clone().map(|joint| of_joint(joint).acceleration).collect(),
            deceleration: joints.map(|joint| of_joint(joint).deceleration).collect(),
        };
        endpoint::plan(&arm, bounds, &preset, &request.start, &request.target, fallback).expect("there is a plan")
    }

    /// Plans random moves by one method and calls `check` with each plan.
    fn for_plans(
        &mut self,
        count: usize,
        method: Method,
        mut check: impl FnMut(&Self, &MoveRequest, &[Bounds], &MovePlan),
    ) {
        let mut plan_count = 0;
        for _ in 0..count {
            let request = self.draw_request(method);
            let Some(plan) = self.plan(&request) else {
                continue;
            };
            let bounds = Bounds::of_request(self.robot.spec(), &request);
            check(self, &request, &bounds, &plan);
            plan_count += 1;
        }
        assert!(plan_count * 2 > count, "{plan_count} of {count} moves have a plan");
    }

    /// Every limit holds everywhere, every figure is true.
    fn check_all(mut self) {
        for method in [Method::Verified, Method::Endpoint, Method::Preset] {
            self.for_plans(MOVES, method, |trial, request, bounds, plan| {
                let report = trial.recheck(request, bounds, &plan.patterns, Grid::default());
                assert_eq!(report.inconsistencies, [], "{request:#?}\n{:#?}", plan.patterns);
                assert!(
                    report.holds(EXCESS),
                    "{:?}\n{request:#?}\n{:#?}",
                    report.worst(),
                    plan.patterns
                );
                for claim in false_claims(trial.robot.spec(), bounds, plan, &report, CLAIMS) {
                    let tolerance = match claim.figure {
                        Figure::PeakPower => POWER_CLAIMS,
                        _ => CLAIMS,
                    };
                    assert!(
                        claim.mismatch <= tolerance,
                        "{claim:?}\n{request:#?}\n{:#?}",
                        plan.patterns
                    );
                }
            });
        }
    }
}

fn ur5e() -> RobotSpec {
    arms::from_urdf("ur5e", "ur5e.urdf", "oracle.json").spec
}

/// With the accelerations that Franka publishes, rad/s².
fn fr3() -> RobotSpec {
    let mut spec = arms::from_urdf("fr3", "fr3.urdf", "oracle.json").spec;
    for joint in &mut spec.joints {
        joint.limits.acceleration = Some(10.0);
    }
    spec
}

fn panda() -> RobotSpec {
    arms::from_urdf("panda", "fer.urdf", "oracle.json").spec
}

fn stretch() -> RobotSpec {
    arms::from_urdf("stretch_re1", "stretch_re1.urdf", "oracle_chain.json").spec
}

#[test]
fn ur5e_keeps_every_limit() {
    Trial::of(ur5e()).check_all();
}

#[test]
fn fr3_keeps_every_limit() {
    Trial::of(fr3()).check_all();
}

#[test]
fn panda_keeps_every_limit() {
    Trial::of(panda()).check_all();
}

#[test]
fn puma_keeps_every_limit() {
    Trial::of(arms::puma_from_table().spec).check_all();
}

#[test]
fn stretch_keeps_every_limit() {
    Trial::of(stretch()).check_all();
}

#[test]
fn friction_that_differs_by_direction_keeps_every_limit() {
    let mut spec = ur5e_with_friction();
    // Mounted on a wall, leaning.
    spec.gravity = Vector3::new(6.0, 3.0, -7.0);
    Trial::of(spec).check_all();
}

#[test]
fn friction_of_the_load_and_of_the_speed_squared_keeps_every_limit() {
    let mut draw = Draw::seeded(9);
    for spec in [ur5e_with_friction(), fr3(), arms::puma_from_table().spec] {
        Trial::of(draw::with_rich_friction(&mut draw, spec)).check_all();
    }
}

fn ur5e_with_friction() -> RobotSpec {
    let mut spec = ur5e();
    for (joint, size) in spec.joints.iter_mut().zip([8.0, 8.0, 6.0, 2.0, 2.0, 1.5]) {
        joint.drive.joint_friction.viscous = size;
        joint.drive.joint_friction.coulomb_positive = size;
        joint.drive.joint_friction.coulomb_negative = 0.6 * size;
        joint.drive.gear_ratio = -101.0;
        joint.drive.rotor_inertia = 1.2e-5 * size;
    }
    spec
}

/// Among 60,000 random moves by an early planner these exceeded their torque limit, by 5e-6 to 3e-5: the torque has a
/// maximum just before a switching time.
#[test]
fn torque_peaks_just_before_a_switching_time_are_seen() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/late_peaks.json");
    let text = std::fs::read_to_string(path).expect("the file of cases is there");
    let cases: Vec<Value> = serde_json::from_str(&text).expect("it is JSON");
    assert!(!cases.is_empty());
    for case in &cases {
        let trial = Trial::of(match case["arm"].as_str() {
            Some("ur5e") => ur5e(),
            Some("ur5e_with_friction") => ur5e_with_friction(),
            Some("fr3") => fr3(),
            other => panic!("no arm {other:?}"),
        });
        let number = |key: &str| case[key].as_f64().expect("a number");
        let request = MoveRequest {
            payload: Some(Inertial {
                mass: number("payload_mass"),
                center_of_mass: Vector3::from_column_slice(&arms::numbers(&case["payload_center"])),
                inertia: Matrix3::identity() * 1e-3,
            }),
            torque_utilization: number("torque_utilization"),
            speed_scale: number("speed_scale"),
            ..MoveRequest::new(arms::numbers(&case["start"]), arms::numbers(&case["target"]))
        };
        let bounds = Bounds::of_request(trial.robot.spec(), &request);
        let plan = trial.plan(&request).expect("the move is feasible");
        let report = trial.recheck(&request, &bounds, &plan.patterns, Grid::default());
        assert!(report.holds(EXCESS), "{:?} in {case}", report.worst());
    }
}

#[test]
fn endpoint_method_is_the_patents() {
    let rich = draw::with_rich_friction(&mut Draw::seeded(10), ur5e_with_friction());
    for spec in [ur5e(), fr3(), panda(), arms::puma_from_table().spec, rich] {
        let mut compared_count = 0;
        Trial::of(spec).for_plans(MOVES, Method::Endpoint, |trial, request, bounds, plan| {
            if plan.duration == 0.0 {
                return;
            }
            let own = trial.endpoint_move(request, bounds, plan.fallback);
            assert_close(plan.preset_duration.expect("the arm has presets"), own.preset_duration);
            assert_close(plan.raw_duration, own.duration);
            // The plan may have been slowed down as a whole since.
            let hurry = plan.duration / plan.raw_duration;
            let same_fallback = plan.fallback == own.fallback;
            for (emitted, own) in plan.patterns.iter().zip(&own.patterns) {
                let raw = slowed(emitted, hurry);
                assert_close(raw.displacement, own.displacement);
                assert_close(raw.peak_velocity, own.peak_velocity);
                // Fallbacks may differ in the accelerations where a rounding decides which is needed.
                if same_fallback {
                    assert_close(raw.acceleration, own.acceleration);
                    assert_close(raw.deceleration, own.deceleration);
                }
            }
            let report = trial.recheck(request, bounds, &own.patterns, Grid::default());
            let torque = report.worst_of(LimitKind::Torque).expect("torque is limited");
            let missed = torque_resolution(&report, bounds);
            if same_fallback {
                let excess = torque.excess.max(0.0);
                let slack = AGREEMENT + missed;
                let told = plan.raw_excess;
                assert!((told - excess).abs() <= slack, "{told} and {torque:?}: {request:#?}");
                compared_count += 1;
            }
        });
        assert!(compared_count > 20, "{compared_count} excesses compared");
    }
}

/// Relative; speeds and accelerations have a reserve of 1e-10 in the planner.
fn assert_close(one: f64, other: f64) {
    assert!((one - other).abs() <= AGREEMENT * other.abs(), "{one} and {other}");
}

fn torque_resolution(report: &Report, bounds: &[Bounds]) -> f64 {
    let of_joint = report.joints.iter().zip(bounds);
    of_joint
        .filter_map(|(found, bounds)| Some(found.torque_resolution / bounds.torque?))
        .fold(0.0, f64::max)
}

#[test]
fn what_is_said_of_slower_overrides_is_true() {
    let grid = Grid {
        per_interval: 8,
        per_move: 200,
    };
    for spec in [ur5e(), arms::puma_from_table().spec] {
        let mut trial = Trial::of(spec);
        trial.for_plans(MOVES, Method::Verified, |trial, request, bounds, plan| {
            let said = plan.override_safe.expect("torque is limited");
            let at = |factor: f64| {
                let slowed: Vec<Pattern> = plan.patterns.iter().map(|one| slowed(one, factor)).collect();
                let report = trial.recheck(request, bounds, &slowed, grid);
                report.worst_of(LimitKind::Torque).expect("torque is limited").excess
            };
            let tightest = (1..=50).map(|step| at(f64::from(step) / 50.0)).fold(f64::MIN, f64::max);
            let worst = said.torque.abs() / said.limit - 1.0;
            assert_eq!(said.safe, worst <= 0.0, "{said:?}");
            assert!(
                tightest <= worst + 1e-6,
                "{tightest} found, {worst} said: {said:?} {request:#?}"
            );
        });
    }
}

/// The pattern run at a part of its speed.
fn slowed(pattern: &Pattern, factor: f64) -> Pattern {
    Pattern {
        displacement: pattern.displacement,
        peak_velocity: pattern.peak_velocity * factor,
        acceleration: pattern.acceleration * factor * factor,
        deceleration: pattern.deceleration * factor * factor,
        acceleration_time: pattern.acceleration_time / factor,
        cruise_time: pattern.cruise_time / factor,
        deceleration_time: pattern.deceleration_time / factor,
    }
}
