//! Curves of the tool in their own parameter v from 0 to 1: straight lines, arcs, splines.
//!
//! Lines and arcs run at constant speed in v and turn about one fixed axis at constant rate, the shortest way. On a spline
//! the orientation is the direction of a spline of quaternions, which goes through the taught ones.

use nalgebra::{Isometry3, Quaternion, UnitQuaternion, Vector3};

use super::piecewise::Piecewise;
use super::tool::{ToolPoint, turned};
use crate::curve::Side;
use crate::jet::Jet;

/// A curve of the tool.
#[derive(Debug, Clone)]
pub(super) enum ToolCurve {
    /// p = a + v·(b − a).
    Line {
        start: Vector3<f64>,
        way: Vector3<f64>,
        turn: Turn,
    },
    /// p = c + r·(cos(φv)·e₁ + sin(φv)·e₂).
    Arc { circle: Circle, turn: Turn },
    /// Position, then a quaternion w x y z of any length.
    Spline(Piecewise),
}

/// A part of a circle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Circle {
    pub(super) center: Vector3<f64>,
    /// From the centre to the start, m.
    pub(super) radial: Vector3<f64>,
    /// As long, a quarter of a turn on.
    pub(super) tangent: Vector3<f64>,
    /// φ, rad; positive.
    pub(super) sweep: f64,
}

/// A turn about a fixed axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Turn {
    start: Quaternion<f64>,
    /// In base-link axes.
    axis: Vector3<f64>,
    angle: f64,
}

impl Turn {
    /// From one orientation to another, the shortest way.
    pub(super) fn between(start: &UnitQuaternion<f64>, end: &UnitQuaternion<f64>) -> Self {
        let turn = (end * start.inverse()).into_inner();
        let turn = if turn.w < 0.0 { -turn } else { turn };
        let sine = turn.imag().norm();
        if sine == 0.0 {
            return Self::about(start, Vector3::z(), 0.0);
        }
        Self::about(start, turn.imag() / sine, 2.0 * libm::atan2(sine, turn.w))
    }

    pub(super) fn about(start: &UnitQuaternion<f64>, axis: Vector3<f64>, angle: f64) -> Self {
        Self {
            start: start.into_inner(),
            axis,
            angle,
        }
    }

    fn at(&self, v: Jet) -> [Jet; 4] {
        turned(&self.axis, v * self.angle, &self.start)
    }
}

impl ToolCurve {
    /// A straight line.
    pub(super) fn line(start: &Isometry3<f64>, end: &Isometry3<f64>) -> Self {
        Self::Line {
            start: start.translation.vector,
            way: end.translation.vector - start.translation.vector,
            turn: Turn::between(&start.rotation, &end.rotation),
        }
    }

    /// The tool at v, a function of some parameter.
    pub(super) fn at(&self, v: Jet, side: Side) -> ToolPoint {
        match self {
            Self::Line { start, way, turn } => ToolPoint {
                position: std::array::from_fn(|i| v * way[i] + start[i]),
                turn: turn.at(v),
            },
            Self::Arc { circle, turn } => {
                let (sin, cos) = (v * circle.sweep).sin_cos();
                let Circle {
                    center,
                    radial,
                    tangent,
                    ..
                } = circle;
                ToolPoint {
                    position: std::array::from_fn(|i| cos * radial[i] + sin * tangent[i] + center[i]),
                    turn: turn.at(v),
                }
            }
            Self::Spline(curve) => {
                let mut values = [Jet::default(); 7];
                curve.at(v, side, &mut values);
                let [x, y, z, turn @ ..] = values;
                let square = turn.iter().fold(Jet::default(), |sum, part| sum + *part * *part);
                let scale = square.sqrt().recip();
                ToolPoint {
                    position: [x, y, z],
                    turn: turn.map(|part| part * scale),
                }
            }
        }
    }

    /// The pose at v.
    pub(super) fn pose(&self, v: f64) -> Isometry3<f64> {
        let (position, turn) = self.at(Jet::constant(v), Side::Before).value();
        Isometry3::from_parts(position.into(), UnitQuaternion::new_normalize(turn))
    }

    /// Where the third derivative may jump, ends included.
    pub(super) fn knots(&self) -> &[f64] {
        match self {
            Self::Line { .. } | Self::Arc { .. } => &[0.0, 1.0],
            Self::Spline(curve) => curve.knots(),
        }
    }

    /// Length of the way where it runs at constant speed, m.
    pub(super) fn uniform_length(&self) -> Option<f64> {
        match self {
            Self::Line { way, .. } => Some(way.norm()),
            Self::Arc { circle, .. } => Some(circle.radial.norm() * circle.sweep),
            Self::Spline(_) => None,
        }
    }

    /// Whether it neither moves nor turns by more than so much, m and rad; a spline always does.
    pub(super) fn is_shorter_than(&self, least: f64) -> bool {
        let turn = match self {
            Self::Line { turn, .. } | Self::Arc { turn, .. } => turn.angle,
            Self::Spline(_) => return false,
        };
        turn.abs() < least && self.uniform_length().is_some_and(|length| length < least)
    }
}
