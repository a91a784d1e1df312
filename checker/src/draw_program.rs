//! Random robot programs that an arm can mostly run: taught points are where nearby random joint positions put the tool,
//! and those are kept away from singular poses. Same seed, same program.

mod constant;
mod shapes;

use nalgebra::{Isometry3, Matrix3, Translation3, UnitQuaternion, Vector3};
use takt_motion::path::request::{Blend, Extent, PathRequest, Segment, Shape, Space, ToolLimits, Weight};
use takt_motion::plan::request::{LimitOverride, Sampling};
use takt_motion::robot::spec::{Inertial, JointSpec, RobotSpec};

use crate::draw::{self, Draw};
pub use constant::at_constant_speed;
use shapes::Hand;

/// What the programs of one robot are drawn for.
#[derive(Debug, Clone, Copy)]
pub struct Cell<'a> {
    /// The arm.
    pub spec: &'a RobotSpec,
    /// What it may carry, kg.
    pub payload_max: f64,
    /// How its paths are sampled.
    pub sampling: Sampling,
    /// Respect jerk limits. Joints without any get some.
    pub limit_jerk: bool,
}

/// Jerk, as a multiple of the speed limit, of joints whose description has none, 1/s²: an arm that reaches full
/// acceleration in some hundredths of a second.
const JERK_OVER_SPEED: f64 = 800.0;

/// Draws one program of 2 to 8 segments.
#[must_use]
pub fn program(draw: &mut Draw, cell: &Cell<'_>) -> PathRequest {
    let spec = cell.spec;
    let tcp = one_in(draw, 4).then(|| small_pose(draw));
    let mut hand = Hand::new(spec, tcp.as_ref(), draw);
    let start = hand.joints().to_vec();
    let in_joints = one_in(draw, 4);
    let count = 2 + (draw.bits() % 7) as usize;
    let mut segments = Vec::with_capacity(count);
    for index in 0..count {
        let shape = hand.shape(draw, in_joints);
        let last = index + 1 == count;
        let blend = (!last && !one_in(draw, 3)).then(|| blend(draw, &shape));
        segments.push(Segment {
            dwell: match blend.is_none() && one_in(draw, 3) {
                true => draw.between(0.0, 0.3),
                false => 0.0,
            },
            blend,
            limits: match one_in(draw, 5) {
                true => {
                    let joint = any_joint(draw, spec);
                    vec![tightened(draw, joint)]
                }
                false => Vec::new(),
            },
            tool_limits: match one_in(draw, 5) {
                true => tool_limits(draw),
                false => ToolLimits::default(),
            },
            tool_speed: one_in(draw, 8).then(|| draw.between(0.05, 1.0)),
            shape,
        });
    }
    let payload = ball(draw.between(0.0, cell.payload_max), draw::vector(draw, 0.05));
    PathRequest {
        payload: (!one_in(draw, 4)).then_some(payload),
        tcp,
        limits: limits(draw, cell),
        tool_limits: match one_in(draw, 2) {
            true => tool_limits(draw),
            false => ToolLimits::default(),
        },
        torque_utilization: part(draw, 0.6),
        speed_scale: part(draw, 0.2),
        acceleration_scale: part(draw, 0.2),
        jerk_scale: part(draw, 0.2),
        limit_jerk: cell.limit_jerk,
        sampling: cell.sampling,
        ..PathRequest::new(start, segments)
    }
}

/// Gives a program a speed at its start, at its end, or at both; nothing rests after an end at speed.
pub fn with_boundary_speeds(draw: &mut Draw, spec: &RobotSpec, request: &mut PathRequest) {
    let fastest = spec.joints.iter().filter_map(|joint| joint.limits.velocity);
    let fastest = fastest.fold(0.0, f64::max);
    let mut speed = |segment: &Segment| match &segment.shape {
        Shape::Joint { .. } => fastest * request.speed_scale * draw.between(0.01, 0.5),
        Shape::Spline(spline) if spline.space == Space::Joint => {
            fastest * request.speed_scale * draw.between(0.01, 0.5)
        }
        Shape::Line { .. } | Shape::Arc(_) | Shape::Spline(_) => draw.between(0.01, 0.5),
    };
    let (first, last) = (
        request.segments.first().map(&mut speed),
        request.segments.last().map(&mut speed),
    );
    let which = draw.bits() % 3;
    request.start_speed = first.filter(|_| which != 1);
    request.end_speed = last.filter(|_| which != 0);
    if let (Some(_), Some(last)) = (request.end_speed, request.segments.last_mut()) {
        last.dwell = 0.0;
    }
}

/// Limits of the whole path: now and then some are tightened; with jerk, every joint has one.
fn limits(draw: &mut Draw, cell: &Cell<'_>) -> Vec<LimitOverride> {
    let mut limits = Vec::new();
    for joint in &cell.spec.joints {
        let mut own = match one_in(draw, 6) {
            true => tightened(draw, joint),
            false => LimitOverride {
                joint: joint.name.clone(),
                ..LimitOverride::default()
            },
        };
        let speed = joint.limits.velocity.unwrap_or(1.0);
        if cell.limit_jerk && joint.limits.jerk.is_none() {
            own.jerk = Some(JERK_OVER_SPEED * speed * draw.between(0.5, 2.0));
        }
        let bare = LimitOverride {
            joint: own.joint.clone(),
            ..LimitOverride::default()
        };
        if own != bare {
            limits.push(own);
        }
    }
    limits
}

/// Tightens some of a joint's limits; one that has no acceleration limit gets one now and then.
fn tightened(draw: &mut Draw, joint: &JointSpec) -> LimitOverride {
    let mut cut = |limit: Option<f64>| {
        let part = draw.between(0.3, 1.0);
        limit.filter(|_| one_in(draw, 2)).map(|limit| limit * part)
    };
    let known = &joint.limits;
    let usual = known.velocity.map(|speed| 10.0 * speed);
    LimitOverride {
        joint: joint.name.clone(),
        velocity: cut(known.velocity),
        acceleration: cut(known.acceleration.or(usual)),
        jerk: cut(known.jerk),
        peak_torque: joint
            .drive
            .peak_torque
            .filter(|_| one_in(draw, 4))
            .map(|peak| peak * 0.9),
        ..LimitOverride::default()
    }
}

fn tool_limits(draw: &mut Draw) -> ToolLimits {
    ToolLimits {
        velocity: one_in(draw, 2).then(|| draw.between(0.1, 2.0)),
        acceleration: one_in(draw, 2).then(|| draw.between(1.0, 20.0)),
    }
}

/// All of it, or from `lowest` on.
fn part(draw: &mut Draw, lowest: f64) -> f64 {
    match one_in(draw, 2) {
        true => 1.0,
        false => draw.between(lowest, 1.0),
    }
}

fn blend(draw: &mut Draw, shape: &Shape) -> Blend {
    let extent = match draw.bits() % 4 {
        0 => Extent::Radius(draw.between(0.005, 0.1)),
        1 if matches!(shape, Shape::Line { .. } | Shape::Arc(_)) => Extent::Lengths {
            before: draw.between(0.005, 0.05),
            after: draw.between(0.005, 0.05),
        },
        _ => Extent::Fraction(draw.between(0.05, 0.5)),
    };
    Blend {
        extent,
        space: match one_in(draw, 3) {
            true => Space::Tool,
            false => Space::Joint,
        },
        weight: match one_in(draw, 4) {
            true => Weight::TanSigmoid {
                a: draw.between(1.5, 5.0),
            },
            false => Weight::Smoothstep,
        },
    }
}

fn any_joint<'a>(draw: &mut Draw, spec: &'a RobotSpec) -> &'a JointSpec {
    &spec.joints[(draw.bits() % spec.joints.len() as u64) as usize]
}

fn small_pose(draw: &mut Draw) -> Isometry3<f64> {
    Isometry3::from_parts(
        Translation3::from(draw::vector(draw, 0.15)),
        UnitQuaternion::from_scaled_axis(draw::vector(draw, 1.0)),
    )
}

/// A payload with its centre at `center`, in the tip link's frame; it turns like a ball of 5 cm.
fn ball(mass: f64, center: Vector3<f64>) -> Inertial {
    Inertial {
        mass,
        center_of_mass: center,
        inertia: Matrix3::identity() * (0.4 * 0.05 * 0.05 * mass),
    }
}

fn one_in(draw: &mut Draw, count: u64) -> bool {
    draw.bits().is_multiple_of(count)
}
