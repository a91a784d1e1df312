//! One segment as a curve of the joints in its own parameter u, from 0 to its length in normalised time.

use nalgebra::Vector3;

use super::arm::Arm;
use super::guided::Guided;
use super::pace::{normal_length, slowest};
use super::piecewise::Piecewise;
use super::tool::ToolPoint;
use crate::curve::Side;
use crate::jet::Jet;
use crate::robot::JOINTS_MAX;
use crate::tolerance::{PACE_SAMPLES, TOOL_LENGTH_SAMPLES};

/// Jets of as many joints as there may be; the rest are zero.
pub(super) type Joints = [Jet; JOINTS_MAX];

/// One segment of a program that goes somewhere.
#[derive(Debug)]
pub(super) struct Track {
    /// Which one of the request.
    pub(super) segment: usize,
    /// In normalised time.
    pub(super) length: f64,
    /// Length of the tool's way, m.
    pub(super) tool_length: f64,
    /// Where the third derivative may jump, ends excluded.
    pub(super) knots: Vec<f64>,
    /// Lengths of blends on it are parts of it, not metres.
    pub(super) by_part: bool,
    geometry: Geometry,
}

#[derive(Debug)]
enum Geometry {
    /// Polynomials of the joints in u.
    Joints(Piecewise),
    /// A curve of the tool in v = u/length.
    Tool(Box<Guided>),
}

impl Track {
    /// A curve of the joints, brought to normalised time. `speeds` is what counts as full speed of each joint.
    pub(super) fn of_joints(arm: &Arm, segment: usize, curve: Piecewise, speeds: &[f64]) -> Self {
        let samples = if curve.is_straight() {
            1
        } else {
            PACE_SAMPLES * (curve.knots().len() - 1)
        };
        let end = curve.length();
        let length = normal_length(end, speeds, samples, |u, q| curve.at(u, Side::After, q));
        let curve = curve.stretched(length);
        let mut track = Self {
            segment,
            length,
            tool_length: 0.0,
            knots: inner(curve.knots(), 1.0),
            by_part: false,
            geometry: Geometry::Joints(curve),
        };
        track.tool_length = track.tool_way(arm, 0.0, length);
        track
    }

    /// A curve of the tool, brought to normalised time.
    pub(super) fn of_tool(arm: &Arm, segment: usize, guided: Guided, speeds: &[f64]) -> Self {
        let samples = PACE_SAMPLES * (guided.curve().knots().len() - 1);
        let length = normal_length(1.0, speeds, samples, |v, q| guided.joints(arm, v, Side::After, q));
        let uniform = guided.curve().uniform_length();
        let mut track = Self {
            segment,
            length,
            tool_length: 0.0,
            knots: inner(guided.curve().knots(), length),
            by_part: false,
            geometry: Geometry::Tool(Box::new(guided)),
        };
        track.tool_length = uniform.unwrap_or_else(|| track.tool_way(arm, 0.0, length));
        track
    }

    /// The joints at u, a function of some parameter.
    pub(super) fn joints(&self, arm: &Arm, u: Jet, side: Side, q: &mut Joints) {
        match &self.geometry {
            Geometry::Joints(curve) => curve.at(u, side, q),
            Geometry::Tool(guided) => guided.joints(arm, u * (1.0 / self.length), side, q),
        }
    }

    /// The tool at u.
    pub(super) fn tool(&self, arm: &Arm, u: Jet, side: Side) -> ToolPoint {
        match &self.geometry {
            Geometry::Joints(curve) => {
                let mut q = Joints::default();
                curve.at(u, side, &mut q);
                let q = &q[..arm.joint_count()];
                let frames = arm.frames(q);
                ToolPoint::of_arm(&frames, &arm.rates::<3>(&frames, q))
            }
            Geometry::Tool(guided) => guided.curve().at(u * (1.0 / self.length), side),
        }
    }

    /// The tool centre point at u.
    pub(super) fn tool_position(&self, arm: &Arm, u: f64) -> Vector3<f64> {
        match &self.geometry {
            Geometry::Joints(curve) => {
                let mut q = Joints::default();
                curve.at(Jet::constant(u), Side::After, &mut q);
                arm.position(&q[..arm.joint_count()])
            }
            Geometry::Tool(_) => self.tool(arm, Jet::constant(u), Side::After).value().0,
        }
    }

    /// The slowest that it passes anywhere, and at which part of it; of a spline alone it can be 0.
    pub(super) fn slowest(&self, arm: &Arm, speeds: &[f64]) -> (f64, f64) {
        let samples = PACE_SAMPLES * (self.knots.len() + 1);
        let (pace, u) = slowest(self.length, samples, speeds, |u, q| {
            self.joints(arm, Jet::variable(u, 1.0), Side::After, q);
        });
        (pace, u / self.length)
    }

    /// Whether the tool runs along it at constant speed in u.
    pub(super) fn is_uniform(&self) -> bool {
        match &self.geometry {
            Geometry::Joints(_) => false,
            Geometry::Tool(guided) => guided.curve().uniform_length().is_some(),
        }
    }

    /// Length of the tool's way between two values of u, m: chords between knots, extrapolated once (their error goes
    /// with the square of the step).
    pub(super) fn tool_way(&self, arm: &Arm, from: f64, to: f64) -> f64 {
        let (low, high) = (from.min(to), from.max(to));
        let inside = self.knots.iter().copied().filter(|knot| *knot > low && *knot < high);
        let mut begin = low;
        let mut sum = 0.0;
        for end in inside.chain([high]) {
            sum += self.smooth_way(arm, begin, end);
            begin = end;
        }
        sum
    }

    fn smooth_way(&self, arm: &Arm, from: f64, to: f64) -> f64 {
        let steps = TOOL_LENGTH_SAMPLES;
        let (mut fine, mut coarse) = (0.0, 0.0);
        let mut even = self.tool_position(arm, from);
        let mut last = even;
        for i in 1..=steps {
            let point = self.tool_position(arm, from + (to - from) * i as f64 / steps as f64);
            fine += (point - last).norm();
            if i % 2 == 0 {
                coarse += (point - even).norm();
                even = point;
            }
            last = point;
        }
        fine + (fine - coarse) / 3.0
    }
}

/// The knots between the ends, stretched.
fn inner(knots: &[f64], factor: f64) -> Vec<f64> {
    knots[1..knots.len() - 1].iter().map(|knot| knot * factor).collect()
}
