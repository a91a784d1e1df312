//! One segment as a curve of the joints in its own parameter u, from 0 to its length in normalised time.

use nalgebra::Vector3;

use super::arm::Arm;
use super::piecewise::Piecewise;
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
    /// Polynomials of the joints.
    Joints(Piecewise),
}

impl Track {
    /// A curve of the joints, brought to normalised time. `speeds` is what counts as full speed of each joint.
    pub(super) fn of_joints(arm: &Arm, segment: usize, curve: Piecewise, speeds: &[f64]) -> Self {
        let samples = if curve.is_straight() {
            1
        } else {
            PACE_SAMPLES * (curve.knots().len() - 1)
        };
        let length = pace_of(&curve, speeds, samples);
        let curve = curve.stretched(length);
        let mut track = Self {
            segment,
            length,
            tool_length: 0.0,
            by_part: false,
            knots: curve.knots()[1..curve.knots().len() - 1].to_vec(),
            geometry: Geometry::Joints(curve),
        };
        track.tool_length = track.tool_way(arm, 0.0, length);
        track
    }

    /// The joints at u, a function of some parameter.
    pub(super) fn joints(&self, _arm: &Arm, u: Jet, side: Side, q: &mut Joints) {
        match &self.geometry {
            Geometry::Joints(curve) => curve.at(u, side, q),
        }
    }

    /// The tool centre point at u.
    pub(super) fn tool_position(&self, arm: &Arm, u: f64) -> Vector3<f64> {
        let mut q = Joints::default();
        self.joints(arm, Jet::constant(u), Side::After, &mut q);
        arm.position(&q[..arm.joint_count()])
    }

    /// Length of the tool's way between two values of u, m: chords, extrapolated once (their error goes with the square
    /// of the step).
    pub(super) fn tool_way(&self, arm: &Arm, from: f64, to: f64) -> f64 {
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

/// ∫ max_j |q′_j|/V_j du: how long the curve takes where the joint that is nearest to its speed limit is just at it.
fn pace_of(curve: &Piecewise, speeds: &[f64], samples: usize) -> f64 {
    let length = curve.length();
    let mut q = Joints::default();
    let mut sum = 0.0;
    for i in 0..samples {
        let u = length * (i as f64 + 0.5) / samples as f64;
        curve.at(Jet::variable(u, 1.0), Side::After, &mut q);
        sum += pace(&q, speeds);
    }
    sum / samples as f64 * length
}

/// max_j |q′_j|/V_j.
pub(super) fn pace(q: &Joints, speeds: &[f64]) -> f64 {
    q.iter()
        .zip(speeds)
        .map(|(q, speed)| q.0[1].abs() / speed)
        .fold(0.0, f64::max)
}
