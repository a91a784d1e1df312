//! The segments of a random program, and where each leaves the arm.

use nalgebra::{DMatrix, Isometry3, Rotation3, Translation3, UnitQuaternion, Vector3};
use takt_motion::path::request::{Arc, ArcOrientation, Circle, Shape, Space, Spline, SplineKind, Target};
use takt_motion::robot::spec::{JointKind, RobotSpec};

use super::one_in;
use crate::arm::{Arm, Tool, Workspace};
use crate::draw::{self, Draw};

/// Joint positions whose smallest singular value (of the Jacobian in m and rad) is above this are far enough from a
/// singular pose for a tool path to begin there.
const DEXTEROUS: f64 = 0.05;

/// How often positions are drawn before the best of them has to do.
const TRIES: usize = 30;

/// Part of a range's middle that positions are drawn from: a redundant arm arrives elsewhere than where its points were
/// taken.
const INNER: f64 = 0.8;

/// An arm that is led through a program while it is drawn.
#[derive(Debug)]
pub(super) struct Hand<'a> {
    spec: &'a RobotSpec,
    arm: Arm,
    tool: Tool,
    workspace: Workspace,
    joints: Vec<f64>,
}

impl<'a> Hand<'a> {
    pub(super) fn new(spec: &'a RobotSpec, tcp: Option<&Isometry3<f64>>, draw: &mut Draw) -> Self {
        let mut hand = Self {
            spec,
            arm: Arm::new(spec, None),
            tool: Tool::new(spec, tcp),
            workspace: Workspace::default(),
            joints: vec![0.0; spec.joints.len()],
        };
        hand.joints = hand.best_of(draw, |hand, draw| {
            let ranges = hand.spec.joints.iter().map(range);
            ranges.map(|(low, high)| draw.between(low, high)).collect()
        });
        hand
    }

    /// Where the arm is.
    pub(super) fn joints(&self) -> &[f64] {
        &self.joints
    }

    /// The next segment.
    pub(super) fn shape(&mut self, draw: &mut Draw, in_joints: bool) -> Shape {
        match draw.bits() % 16 {
            _ if in_joints => self.joint(draw),
            0..4 => self.joint(draw),
            4..10 => self.line(draw),
            10..13 => self.arc(draw),
            _ => self.spline(draw),
        }
    }

    /// The next segment, one of the tool with a speed of its own: a line or an arc.
    pub(super) fn tool_shape(&mut self, draw: &mut Draw) -> Shape {
        match one_in(draw, 3) {
            true => self.arc(draw),
            false => self.line(draw),
        }
    }

    fn joint(&mut self, draw: &mut Draw) -> Shape {
        let reach = [1.5, 0.5, 0.1][(draw.bits() % 3) as usize];
        let joints = self.near(draw, reach);
        let target = match one_in(draw, 4) {
            true => self.pose_target(&joints),
            false => Target::Joints(joints.clone()),
        };
        self.joints = joints;
        Shape::Joint { target }
    }

    fn line(&mut self, draw: &mut Draw) -> Shape {
        let reach = [0.3, 0.1, 0.03][(draw.bits() % 3) as usize];
        let joints = self.near(draw, reach);
        // A redundant arm ends a line elsewhere than at the joints it was taught with: a pose says all there is.
        let target = match one_in(draw, 4) && self.spec.joints.len() <= 6 {
            true => Target::Joints(joints.clone()),
            false => self.pose_target(&joints),
        };
        self.joints = joints;
        Shape::Line { target }
    }

    fn arc(&mut self, draw: &mut Draw) -> Shape {
        let from = self.position(&self.joints.clone());
        let aside = |draw: &mut Draw, along: &Vector3<f64>| {
            let any = along.cross(&draw::vector(draw, 1.0));
            any.try_normalize(1e-9).unwrap_or_else(Vector3::z)
        };
        if one_in(draw, 6) {
            let radius = draw.between(0.02, 0.08);
            let out = draw::vector(draw, 1.0).try_normalize(1e-9).unwrap_or_else(Vector3::x);
            return Shape::Arc(Arc {
                circle: Circle::Center {
                    center: from + out * radius,
                    normal: Some(aside(draw, &out)),
                    long_way: false,
                    frame: None,
                },
                target: None,
                orientation: ArcOrientation::Interpolated,
            });
        }
        let joints = self.near(draw, 0.25);
        let to = self.position(&joints);
        let chord = to - from;
        let half = 0.5 * chord.norm();
        let middle = 0.5 * (from + to);
        let out = aside(draw, &chord);
        let circle = match draw.bits() % 3 {
            0 => Circle::Via {
                point: self.at(middle + out * (half * draw.between(0.2, 0.8)), &joints),
                second: None,
            },
            1 => Circle::Center {
                center: middle + out * (half * draw.between(0.2, 2.0)),
                normal: None,
                long_way: false,
                frame: None,
            },
            _ => Circle::Radius {
                radius: half * draw.between(1.1, 3.0),
                normal: out,
                long_way: false,
                frame: None,
            },
        };
        let target = Some(self.pose_target(&joints));
        self.joints = joints;
        Shape::Arc(Arc {
            circle,
            target,
            orientation: match one_in(draw, 6) {
                true => ArcOrientation::Tangent,
                false => ArcOrientation::Interpolated,
            },
        })
    }

    fn spline(&mut self, draw: &mut Draw) -> Shape {
        let space = match one_in(draw, 2) {
            true => Space::Tool,
            false => Space::Joint,
        };
        let kind = match draw.bits() % 8 {
            0..4 => SplineKind::Quintic,
            4..6 => SplineKind::Cubic,
            6 => SplineKind::BSpline,
            _ => SplineKind::Bezier,
        };
        let count = match kind {
            SplineKind::BSpline | SplineKind::Bezier => 5 + draw.bits() % 3,
            SplineKind::Quintic | SplineKind::Cubic => 2 + draw.bits() % 4,
        };
        let reach = if space == Space::Tool { 0.12 } else { 0.5 };
        let points = (0..count).map(|_| {
            let joints = self.near(draw, reach);
            let target = match space {
                Space::Tool => self.pose_target(&joints),
                Space::Joint => Target::Joints(joints.clone()),
            };
            self.joints = joints;
            target
        });
        Shape::Spline(Spline {
            kind,
            points: points.collect(),
            space,
        })
    }

    /// Joint positions within `reach`, rad, of where the arm is; of a slide, within the same part of its range.
    fn near(&mut self, draw: &mut Draw, reach: f64) -> Vec<f64> {
        self.best_of(draw, |hand, draw| {
            let here = hand.joints.iter().zip(&hand.spec.joints);
            here.map(|(here, joint)| {
                let (low, high) = range(joint);
                let reach = match joint.kind {
                    JointKind::Prismatic => reach * 0.5 * (high - low),
                    JointKind::Revolute | JointKind::Continuous => reach,
                };
                draw.between(low.max(here - reach), high.min(here + reach))
            })
            .collect()
        })
    }

    /// The first positions drawn that are dexterous, or else the most dexterous.
    fn best_of(&mut self, draw: &mut Draw, make: impl Fn(&Self, &mut Draw) -> Vec<f64>) -> Vec<f64> {
        let mut best = (f64::NEG_INFINITY, Vec::new());
        for _ in 0..TRIES {
            let joints = make(self, draw);
            let dexterity = self.dexterity(&joints);
            if dexterity > best.0 {
                best = (dexterity, joints);
            }
            if best.0 > DEXTEROUS {
                break;
            }
        }
        best.1
    }

    /// The smallest singular value of the Jacobian, whose columns are the tool's motion at unit speed of each joint.
    fn dexterity(&mut self, joints: &[f64]) -> f64 {
        let count = joints.len();
        let mut jacobian = DMatrix::zeros(6, count);
        let still = vec![0.0; count];
        for joint in 0..count {
            let mut rates = still.clone();
            rates[joint] = 1.0;
            let motion = self
                .arm
                .tool_motion(&mut self.workspace, &self.tool, joints, &rates, &still);
            jacobian.fixed_view_mut::<3, 1>(0, joint).copy_from(&motion.velocity);
            jacobian
                .fixed_view_mut::<3, 1>(3, joint)
                .copy_from(&motion.angular_velocity);
        }
        jacobian.singular_values().min()
    }

    fn pose(&mut self, joints: &[f64]) -> Isometry3<f64> {
        let still = vec![0.0; joints.len()];
        let motion = self
            .arm
            .tool_motion(&mut self.workspace, &self.tool, joints, &still, &still);
        let rotation = Rotation3::from_matrix_unchecked(motion.axes);
        Isometry3::from_parts(
            Translation3::from(motion.position),
            UnitQuaternion::from_rotation_matrix(&rotation),
        )
    }

    fn position(&mut self, joints: &[f64]) -> Vector3<f64> {
        self.pose(joints).translation.vector
    }

    fn pose_target(&mut self, joints: &[f64]) -> Target {
        Target::Pose {
            pose: self.pose(joints),
            frame: None,
        }
    }

    /// A point with the orientation that some joints give.
    fn at(&mut self, point: Vector3<f64>, joints: &[f64]) -> Target {
        let mut pose = self.pose(joints);
        pose.translation.vector = point;
        Target::Pose { pose, frame: None }
    }
}

/// Where a joint's positions are drawn: the inner part of its range, at most half a turn either way.
fn range(joint: &takt_motion::robot::spec::JointSpec) -> (f64, f64) {
    let widest = std::f64::consts::PI;
    let low = joint.limits.position_lower.unwrap_or(-widest);
    let high = joint.limits.position_upper.unwrap_or(widest);
    let (middle, half) = (0.5 * (low + high), (0.5 * (high - low) * INNER).min(widest));
    (middle - half, middle + half)
}
