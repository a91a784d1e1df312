//! What is asked for: a robot program of segments, how they are blended, and what bounds the motion. Passive data.

use nalgebra::{Isometry3, Vector3};

use crate::plan::request::{LimitOverride, Sampling};
use crate::robot::spec::Inertial;

/// A robot program, to be made one path and timed.
#[derive(Debug, Clone, PartialEq)]
pub struct PathRequest {
    /// Joint positions to start from, "rad or m" in model order.
    pub start: Vec<f64>,
    /// What to run through, in order.
    pub segments: Vec<Segment>,
    /// Payload in the tip link's frame; `None`: the model's.
    pub payload: Option<Inertial>,
    /// Tool centre point in the tip link's frame; `None`: the model's.
    pub tcp: Option<Isometry3<f64>>,
    /// Joint limits tightened for the whole path.
    pub limits: Vec<LimitOverride>,
    /// Limits of the tool for the whole path.
    pub tool_limits: ToolLimits,
    /// Part of each peak torque that may be used, in (0, 1].
    pub torque_utilization: f64,
    /// Part of each speed that may be used, in (0, 1].
    pub speed_scale: f64,
    /// Part of each acceleration that may be used, in (0, 1].
    pub acceleration_scale: f64,
    /// Part of each jerk that may be used, in (0, 1].
    pub jerk_scale: f64,
    /// Respect the joints' jerk limits, where they have any.
    pub limit_jerk: bool,
    /// How the path is timed.
    pub timing: Timing,
    /// What to do where the arm cannot follow at constant speed.
    pub on_excess: OnExcess,
    /// Form of the transitions at constant speed.
    pub transition: Transition,
    /// Half of what a transition takes at constant speed, s; `None`: chosen by the tool's acceleration.
    pub transition_time: Option<f64>,
    /// Farthest that a transition at constant speed may be from the taught path, m.
    pub tolerance: Option<f64>,
    /// Tool speed at the start of the path, m/s (joint paths: rad/s of the fastest joint); `None`: rest.
    pub start_speed: Option<f64>,
    /// The same at the end.
    pub end_speed: Option<f64>,
    /// Which samples to return.
    pub sampling: Sampling,
}

impl PathRequest {
    /// A program from rest to rest with all that the arm has, as fast as that allows, without samples.
    #[must_use]
    pub fn new(start: Vec<f64>, segments: Vec<Segment>) -> Self {
        Self {
            start,
            segments,
            payload: None,
            tcp: None,
            limits: Vec::new(),
            tool_limits: ToolLimits::default(),
            torque_utilization: 1.0,
            speed_scale: 1.0,
            acceleration_scale: 1.0,
            jerk_scale: 1.0,
            limit_jerk: true,
            timing: Timing::Optimal,
            on_excess: OnExcess::SlowDown,
            transition: Transition::Smooth,
            transition_time: None,
            tolerance: None,
            start_speed: None,
            end_speed: None,
            sampling: Sampling::None,
        }
    }
}

/// Limits of the tool centre point.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct ToolLimits {
    /// Largest speed, m/s.
    pub velocity: Option<f64>,
    /// Largest acceleration, m/s².
    pub acceleration: Option<f64>,
}

/// How a path is timed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Timing {
    /// As fast as every limit allows.
    Optimal,
    /// At one constant tool speed, from rest to rest.
    ConstantSpeed,
}

/// What to do where the arm cannot follow at constant speed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum OnExcess {
    /// Lower the speed until it can.
    SlowDown,
    /// Answer that it is infeasible.
    Refuse,
}

/// Form of the transitions at constant speed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Transition {
    /// Speed and acceleration without jumps everywhere.
    Smooth,
    /// The patent's own form, whose jumps at arcs are stated.
    Source,
}

/// One segment of a program; it begins where the one before it ends.
#[derive(Debug, Clone, PartialEq)]
pub struct Segment {
    /// Its geometry.
    pub shape: Shape,
    /// How it goes over into the next one; `None`: an exact stop. Not used on the last.
    pub blend: Option<Blend>,
    /// Time at rest after it, s; only after an exact stop.
    pub dwell: f64,
    /// Joint limits tightened for this segment.
    pub limits: Vec<LimitOverride>,
    /// Limits of the tool for this segment.
    pub tool_limits: ToolLimits,
    /// Tool speed at constant speed, m/s; bounds the tool speed under optimal timing.
    pub tool_speed: Option<f64>,
}

impl Segment {
    /// A shape that ends in an exact stop.
    #[must_use]
    pub fn new(shape: Shape) -> Self {
        Self {
            shape,
            blend: None,
            dwell: 0.0,
            limits: Vec::new(),
            tool_limits: ToolLimits::default(),
            tool_speed: None,
        }
    }
}

/// The geometry of a segment.
#[derive(Debug, Clone, PartialEq)]
pub enum Shape {
    /// Straight in joint space.
    Joint {
        /// Where it ends.
        target: Target,
    },
    /// A straight line of the tool centre point; the orientation turns about one axis, the shortest way.
    Line {
        /// Where it ends.
        target: Target,
    },
    /// A circular arc of the tool centre point.
    Arc(Arc),
    /// A smooth curve through or near points.
    Spline(Spline),
}

impl Shape {
    /// Where the segment ends; `None`: a full circle, where it began.
    #[must_use]
    pub fn target(&self) -> Option<&Target> {
        match self {
            Self::Joint { target } | Self::Line { target } => Some(target),
            Self::Arc(arc) => arc.target.as_ref(),
            Self::Spline(spline) => spline.points.last(),
        }
    }
}

/// A taught point.
#[derive(Debug, Clone, PartialEq)]
pub enum Target {
    /// Joint positions.
    Joints(Vec<f64>),
    /// A pose of the tool centre point.
    Pose {
        /// In the frame; the orientation is the tool's.
        pose: Isometry3<f64>,
        /// A frame named by the robot's description; `None`: base-link axes.
        frame: Option<String>,
    },
}

/// A circular arc.
#[derive(Debug, Clone, PartialEq)]
pub struct Arc {
    /// How the circle is given.
    pub circle: Circle,
    /// Where it ends; `None`: a full circle, back to where it began (with [`Circle::Via`], [`Circle::Center`]).
    pub target: Option<Target>,
    /// How the tool turns along it.
    pub orientation: ArcOrientation,
}

/// How the circle of an arc is given.
#[derive(Debug, Clone, PartialEq)]
pub enum Circle {
    /// Through a point on the way. Of a full circle it is the opposite point's side: start, via and the normal decide.
    Via {
        /// The point; its orientation is not used.
        point: Target,
        /// Another point, needed by a full circle alone.
        second: Option<Target>,
    },
    /// By its centre and the direction of turning.
    Center {
        /// In base-link axes or the frame, m.
        center: Vector3<f64>,
        /// Turning is right-handed about it; needed where start, centre and end lie on one line, and by a full circle.
        normal: Option<Vector3<f64>>,
        /// Take the longer way round.
        long_way: bool,
        /// The frame of centre and normal; `None`: base-link axes.
        frame: Option<String>,
    },
    /// By its radius.
    Radius {
        /// m.
        radius: f64,
        /// Turning is right-handed about it.
        normal: Vector3<f64>,
        /// Take the longer way round.
        long_way: bool,
        /// The frame of the normal; `None`: base-link axes.
        frame: Option<String>,
    },
}

/// How the tool turns along an arc.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ArcOrientation {
    /// About one axis from the orientation at the start to that at the end, the shortest way.
    Interpolated,
    /// With the tangent, as at the start.
    Tangent,
}

/// A spline.
#[derive(Debug, Clone, PartialEq)]
pub struct Spline {
    /// Which kind.
    pub kind: SplineKind,
    /// Points after the start: interpolated, or control points.
    pub points: Vec<Target>,
    /// Whether it is smooth in joint space or in tool space.
    pub space: Space,
}

/// Which spline.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SplineKind {
    /// Interpolates; four times continuously differentiable.
    Quintic,
    /// Interpolates; twice continuously differentiable: the answer says `continuity: 2`.
    Cubic,
    /// Control points of a uniform quintic B-spline, clamped at its ends.
    BSpline,
    /// Control points of one Bézier curve.
    Bezier,
}

/// In which space something is interpolated.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Space {
    /// Of the joints.
    Joint,
    /// Of the tool's position and orientation.
    Tool,
}

/// How one segment goes over into the next.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Blend {
    /// How far it reaches.
    pub extent: Extent,
    /// In which space the two are mixed.
    pub space: Space,
    /// With which weight.
    pub weight: Weight,
}

/// How far a blend reaches into its two segments.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Extent {
    /// Distance of the tool from the corner, m, on both sides.
    Radius(f64),
    /// Part of each of the two segments, in (0, 1).
    Fraction(f64),
    /// Path lengths from the corner, m (joint segments: part of the segment): up to where the first segment is followed
    /// exactly, and from where on the second.
    Lengths {
        /// On the first segment.
        before: f64,
        /// On the second.
        after: f64,
    },
}

/// The weight of a blend, from 0 to 1 over it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Weight {
    /// x⁴(35 − 84x + 70x² − 20x³): three derivatives are zero at both ends.
    Smoothstep,
    /// 1/(1 + exp(−a·tan(π(x − ½)))): the patent's, all derivatives zero at both ends.
    TanSigmoid {
        /// Steepness, above 0.
        a: f64,
    },
}
