//! A lift of 2 kg on one of 10 kg, with friction, in a world where things weigh 10 N a kilogramme; a program that goes
//! up, waits, and comes half the way back; and the plan that a truthful planner would make of it.

use nalgebra::{Isometry3, Matrix3, Vector3};
use takt_checker::path::bounds::{self, JointBounds};
use takt_checker::path::report::PathReport;
use takt_checker::{Density, recheck_path};
use takt_motion::path::outcome::{
    LimitCost, LimitingStretch, Location, PathLimit, PathLimitUse, PathPlan, PathSetpoints, SegmentReport, Smoothness,
};
use takt_motion::path::request::{PathRequest, Segment, Shape, Target, ToolLimits};
use takt_motion::plan::outcome::{JointColumns, Phase, Setpoints, TorqueMargin};
use takt_motion::plan::request::Sampling;
use takt_motion::robot::spec::{Drive, Friction, Inertial, JointKind, JointSpec, Limits, RobotSpec};

pub(crate) const LOWER: usize = 0;
pub(crate) const UPPER: usize = 1;

/// Where the program leads, m.
const STOPS: [[f64; 2]; 3] = [[0.25, 0.5], [1.25, 1.0], [0.75, 1.0]];

/// Its segments' durations and the dwell between them, s.
const TIMES: [f64; 2] = [2.0, 1.75];
const DWELL: f64 = 0.25;

const FRICTION: Friction = Friction {
    viscous: 6.0,
    coulomb_positive: 5.0,
    coulomb_negative: 3.0,
    load_coulomb: 0.0,
    quadratic: 0.0,
    presliding_stiffness: None,
};

/// How a segment is run through.
#[derive(Debug, Clone, Copy)]
enum Law {
    /// x³(10 − 15x + 6x²).
    Quintic,
    /// Up for a quarter, on for a half, down for a quarter of the time.
    Trapezoid,
}

/// One case.
pub(crate) struct Lifts {
    pub(crate) spec: RobotSpec,
    pub(crate) request: PathRequest,
    /// How many times faster the plan runs than it should.
    pub(crate) hurry: f64,
    law: Law,
}

#[derive(Debug, Clone, Copy, Default)]
struct State {
    q: [f64; 2],
    qd: [f64; 2],
    qdd: [f64; 2],
    /// Which way the joints move, just after.
    direction: [f64; 2],
    location: Location,
}

impl Lifts {
    pub(crate) fn new() -> Self {
        Self::sampled(Sampling::Period(0.001))
    }

    pub(crate) fn trapezoidal() -> Self {
        Self {
            law: Law::Trapezoid,
            ..Self::new()
        }
    }

    pub(crate) fn sampled(sampling: Sampling) -> Self {
        let segment = |target: [f64; 2], dwell| Segment {
            dwell,
            ..Segment::new(Shape::Joint {
                target: Target::Joints(target.to_vec()),
            })
        };
        Self {
            spec: spec(),
            request: PathRequest {
                tool_limits: ToolLimits {
                    velocity: Some(1.5),
                    acceleration: Some(2.5),
                },
                sampling,
                ..PathRequest::new(
                    STOPS[0].to_vec(),
                    vec![segment(STOPS[1], DWELL), segment(STOPS[2], 0.0)],
                )
            },
            hurry: 1.0,
            law: Law::Quintic,
        }
    }

    pub(crate) fn recheck(&self, plan: &PathPlan) -> PathReport {
        self.recheck_as(plan, Density::Resolving)
    }

    pub(crate) fn recheck_as(&self, plan: &PathPlan, density: Density) -> PathReport {
        recheck_path(&self.spec, &self.request, plan, density)
    }

    /// Limits that this motion just keeps.
    pub(crate) fn tighten_to_the_motion(&mut self) {
        let fastest = 1.875 / 2.0;
        let hardest = 10.0 / f64::sqrt(3.0) / 4.0;
        for (joint, way) in [(LOWER, 1.0), (UPPER, 0.5)] {
            let peak = self.largest_torque(joint);
            let limits = &mut self.spec.joints[joint].limits;
            limits.velocity = Some(fastest * way);
            limits.acceleration = Some(hardest * way);
            limits.jerk = Some(7.5 * way);
            self.spec.joints[joint].drive.peak_torque = Some(peak);
        }
        self.request.tool_limits = ToolLimits {
            velocity: Some(1.5 * fastest),
            acceleration: Some(1.5 * hardest),
        };
    }

    pub(crate) fn largest_torque(&self, joint: usize) -> f64 {
        let all = (0..=400_000).map(|step| self.torque(&self.state(1e-5 * f64::from(step)))[joint].abs());
        all.fold(0.0, f64::max)
    }

    /// The truthful plan.
    pub(crate) fn plan(&self) -> PathPlan {
        let duration = (TIMES[0] + DWELL + TIMES[1]) / self.hurry;
        let count = match self.request.sampling {
            Sampling::Trace(count) => count,
            // A plan that was hurried keeps its set-points, at shorter times.
            _ => 4001,
        };
        let mut setpoints = PathSetpoints {
            samples: Setpoints {
                time: Vec::new(),
                joints: vec![JointColumns::default(); 2],
            },
            locations: Vec::new(),
            tool_speed: Vec::new(),
            jerk: Vec::new(),
        };
        for index in 0..count {
            let part = index as f64 / (count - 1) as f64;
            let state = self.state(part * (TIMES[0] + DWELL + TIMES[1]));
            let torque = self.torque(&state);
            setpoints.samples.time.push(part * duration);
            setpoints.locations.push(state.location);
            setpoints.tool_speed.push((state.qd[0] + state.qd[1]).abs());
            for (joint, columns) in setpoints.samples.joints.iter_mut().enumerate() {
                columns.position.push(state.q[joint]);
                columns.velocity.push(state.qd[joint]);
                columns.acceleration.push(state.qdd[joint]);
                columns.torque.push(torque[joint]);
            }
        }
        let [first, dwell] = [TIMES[0] / self.hurry, DWELL / self.hurry];
        let report = |begin, end| SegmentReport {
            begin,
            end,
            tool_length: 0.0,
        };
        let stretches = [
            (0.0, first, PathLimit::Jerk),
            (first, first + dwell, PathLimit::Rest),
            (first + dwell, duration, PathLimit::Velocity),
        ];
        PathPlan {
            duration,
            continuity: 3,
            segments: vec![report(0.0, first), report(first + dwell, duration)],
            blends: Vec::new(),
            torque_margins: self.margins(),
            limit_uses: self.uses(),
            limiting: stretches
                .iter()
                .map(|(begin, end, kind)| LimitingStretch {
                    begin: *begin,
                    end: *end,
                    kind: *kind,
                    joint: None,
                    location: Location::default(),
                })
                .collect(),
            limit_costs: stretches
                .iter()
                .map(|(begin, end, kind)| LimitCost {
                    kind: *kind,
                    joint: None,
                    time: end - begin,
                })
                .collect(),
            constant_speed: None,
            override_safe: None,
            setpoints: Some(setpoints),
            smoothness: Smoothness::default(),
            warnings: Vec::new(),
            torque_utilization: self.request.torque_utilization,
            speed_scale: self.request.speed_scale,
            payload: Inertial::zero(),
        }
    }

    /// The state at a time of the motion as it should be run.
    fn state(&self, time: f64) -> State {
        let back = TIMES[0] + DWELL;
        if time >= TIMES[0] && time < back {
            return State {
                q: STOPS[1],
                location: Location {
                    segment: 0,
                    fraction: 1.0,
                },
                ..State::default()
            };
        }
        let segment = usize::from(time >= back);
        let duration = TIMES[segment];
        let since = if segment == 0 { time } else { time - back };
        let x = (since / duration).min(1.0);
        let [way, rate, gain] = self.law.at(x);
        let part = |joint: usize| STOPS[segment + 1][joint] - STOPS[segment][joint];
        // The end of the program is at rest, whatever the law has there.
        let moving = if segment == 1 && x >= 1.0 { 0.0 } else { self.hurry };
        let each = |value: &dyn Fn(usize) -> f64| [value(0), value(1)];
        State {
            q: each(&|joint| STOPS[segment][joint] + part(joint) * way),
            qd: each(&|joint| part(joint) * rate / duration * moving),
            qdd: each(&|joint| part(joint) * gain / duration / duration * moving * moving),
            direction: each(&|joint| if moving > 0.0 { part(joint) } else { 0.0 }),
            location: Location { segment, fraction: way },
        }
    }

    /// 12 kg and 2 kg against their weight, and friction below.
    fn torque(&self, state: &State) -> [f64; 2] {
        let friction = &self.spec.joints[LOWER].drive.joint_friction;
        let rate = state.qd[LOWER];
        let coulomb = match state.direction[LOWER] {
            up if up > 0.0 => friction.coulomb_positive,
            up if up < 0.0 => -friction.coulomb_negative,
            _ => 0.0,
        };
        let [lower, upper] = state.qdd;
        let weight = -self.spec.gravity.z;
        [
            12.0 * (weight + lower) + 2.0 * upper + friction.viscous * rate + coulomb,
            2.0 * (weight + lower + upper),
        ]
    }

    fn margins(&self) -> Vec<TorqueMargin> {
        let of_joint = |joint: usize| {
            let peak = self.largest_torque(joint) * self.hurry * self.hurry;
            let limit = self.bounds(joint).torque.expect("both are limited");
            TorqueMargin {
                joint,
                limit,
                peak_torque: peak,
                time: 0.0,
                phase: Phase::Acceleration,
                margin: (limit - peak) / limit,
                rms_torque: 0.0,
                rated_torque: None,
                peak_motor_speed: 0.0,
                peak_power: 0.0,
            }
        };
        vec![of_joint(LOWER), of_joint(UPPER)]
    }

    fn bounds(&self, joint: usize) -> JointBounds {
        bounds::of_program(&self.spec, &self.request)[0].joints[joint]
    }

    fn uses(&self) -> Vec<PathLimitUse> {
        let mut all = Vec::new();
        let mut add = |kind, joint, value: f64, limit: Option<f64>, margin: Option<f64>| {
            let Some(limit) = limit else { return };
            all.push(PathLimitUse {
                kind,
                joint,
                value,
                limit,
                margin: margin.unwrap_or((limit - value.abs()) / limit),
                time: 0.0,
                location: Location::default(),
            });
        };
        let [fastest, hardest] = [
            1.875 / 2.0 * self.hurry,
            10.0 / f64::sqrt(3.0) / 4.0 * self.hurry * self.hurry,
        ];
        for (joint, way, lowest, highest) in [(LOWER, 1.0, 0.25, 1.25), (UPPER, 0.5, 0.5, 1.0)] {
            let bounds = self.bounds(joint);
            let range = bounds.range();
            let torque = self.largest_torque(joint) * self.hurry * self.hurry;
            add(PathLimit::Torque, Some(joint), torque, bounds.torque, None);
            add(PathLimit::Velocity, Some(joint), fastest * way, bounds.velocity, None);
            add(
                PathLimit::Acceleration,
                Some(joint),
                hardest * way,
                bounds.acceleration,
                None,
            );
            add(
                PathLimit::Jerk,
                Some(joint),
                7.5 * way * self.hurry.powi(3),
                bounds.jerk,
                None,
            );
            let (lower, upper) = (bounds.position_lower, bounds.position_upper);
            let room = lower.map(|lower| (lowest - lower) / range);
            add(PathLimit::PositionLower, Some(joint), lowest, lower, room);
            let room = upper.map(|upper| (upper - highest) / range);
            add(PathLimit::PositionUpper, Some(joint), highest, upper, room);
        }
        let tool = self.request.tool_limits;
        add(PathLimit::ToolVelocity, None, 1.5 * fastest, tool.velocity, None);
        add(
            PathLimit::ToolAcceleration,
            None,
            1.5 * hardest,
            tool.acceleration,
            None,
        );
        all
    }
}

impl Law {
    /// The part of the way, and its first two derivatives.
    fn at(self, x: f64) -> [f64; 3] {
        match self {
            Self::Quintic => [
                x * x * x * (10.0 - 15.0 * x + 6.0 * x * x),
                30.0 * x * x * (1.0 - x) * (1.0 - x),
                60.0 * x * (1.0 - x) * (1.0 - 2.0 * x),
            ],
            Self::Trapezoid => {
                let [peak, ramp] = [4.0 / 3.0, 16.0 / 3.0];
                if x < 0.25 {
                    [0.5 * ramp * x * x, ramp * x, ramp]
                } else if x < 0.75 {
                    [peak * (x - 0.125), peak, 0.0]
                } else {
                    let left = 1.0 - x;
                    [1.0 - 0.5 * ramp * left * left, ramp * left, -ramp]
                }
            }
        }
    }
}

fn spec() -> RobotSpec {
    let lift = |name: &str, mass, jerk, drive| JointSpec {
        name: name.to_owned(),
        kind: JointKind::Prismatic,
        parent_from_joint: Isometry3::identity(),
        axis: Vector3::z(),
        link: Inertial {
            mass,
            center_of_mass: Vector3::zeros(),
            inertia: Matrix3::zeros(),
        },
        limits: Limits {
            position_lower: Some(0.0),
            position_upper: Some(2.0),
            velocity: Some(1.0),
            acceleration: Some(4.0),
            jerk: Some(jerk),
            ..Limits::default()
        },
        drive,
    };
    let drive = |peak, joint_friction| Drive {
        peak_torque: Some(peak),
        joint_friction,
        ..Drive::default()
    };
    RobotSpec {
        joints: vec![
            lift("lower", 10.0, 10.0, drive(200.0, FRICTION)),
            lift("upper", 2.0, 10.0, drive(40.0, Friction::default())),
        ],
        link_from_tip: Isometry3::identity(),
        gravity: Vector3::new(0.0, 0.0, -10.0),
        payload: Inertial::zero(),
        tcp: Isometry3::identity(),
        frames: Vec::new(),
        uncertainty: None,
    }
}

/// The set-points of a plan.
pub(crate) fn setpoints(plan: &mut PathPlan) -> &mut PathSetpoints {
    plan.setpoints.as_mut().expect("it has set-points")
}

/// The columns of one joint of a plan.
pub(crate) fn column(plan: &mut PathPlan, joint: usize) -> &mut JointColumns {
    &mut setpoints(plan).samples.joints[joint]
}
