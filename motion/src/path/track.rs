//! One segment as a curve of the joints in its own parameter u, from 0 to its length in normalised time.

use nalgebra::Vector3;

use super::arm::Arm;
use super::guided::Guided;
use super::pace::{normal_length, samples, slowest};
use super::piecewise::Piecewise;
use super::tool::ToolPoint;
use crate::budget::{Budget, Stopped};
use crate::curve::Side;
use crate::jet::Jet;
use crate::robot::JOINTS_MAX;
use crate::tolerance::{PIECE_PANELS, WAY_PANELS};

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
    pub(super) fn of_joints(
        arm: &Arm,
        segment: usize,
        curve: Piecewise,
        speeds: &[f64],
        budget: &Budget<'_>,
    ) -> Result<Self, Stopped> {
        let samples = if curve.is_straight() {
            1
        } else {
            samples(curve.knots().len() - 1)
        };
        let end = curve.length();
        let length = normal_length(end, speeds, samples, budget, |u, q| curve.at(u, Side::After, q))?;
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
        Ok(track)
    }

    /// A curve of the tool, brought to normalised time.
    pub(super) fn of_tool(
        arm: &Arm,
        segment: usize,
        guided: Guided,
        speeds: &[f64],
        budget: &Budget<'_>,
    ) -> Result<Self, Stopped> {
        let samples = samples(guided.curve().knots().len() - 1);
        let length = normal_length(1.0, speeds, samples, budget, |v, q| {
            guided.joints(arm, v, Side::After, q)
        })?;
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
        Ok(track)
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
    pub(super) fn slowest(&self, arm: &Arm, speeds: &[f64], budget: &Budget<'_>) -> Result<(f64, f64), Stopped> {
        let samples = samples(self.knots.len() + 1);
        let (pace, u) = slowest(self.length, samples, speeds, budget, |u, q| {
            self.joints(arm, Jet::variable(u, 1.0), Side::After, q);
        })?;
        Ok((pace, u / self.length))
    }

    /// Whether the tool runs along it at constant speed in u.
    pub(super) fn is_uniform(&self) -> bool {
        match &self.geometry {
            Geometry::Joints(_) => false,
            Geometry::Tool(guided) => guided.curve().uniform_length().is_some(),
        }
    }

    /// |p′| of the tool at u.
    fn tool_pace(&self, arm: &Arm, u: f64) -> f64 {
        let u = Jet::variable(u, 1.0);
        match &self.geometry {
            Geometry::Joints(curve) => {
                let mut q = Joints::default();
                curve.at(u, Side::After, &mut q);
                let q = &q[..arm.joint_count()];
                arm.rates::<1>(&arm.frames(q), q).linear[0].norm()
            }
            Geometry::Tool(_) => {
                let position = self.tool(arm, u, Side::After).position;
                Vector3::from(position.map(|part| part.0[1])).norm()
            }
        }
    }

    /// Length of the tool's way between two values of u, m: ∫|p′|du from knot to knot, by Gauss's rule.
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
        let panels = if self.knots.is_empty() {
            WAY_PANELS
        } else {
            PIECE_PANELS
        };
        let half = 0.5 * (to - from) / panels as f64;
        let panel = |i: usize| {
            let middle = from + half * (2 * i + 1) as f64;
            let pair = |(node, weight): (f64, f64)| {
                let ends = [middle - half * node, middle + half * node];
                weight * half * ends.map(|u| self.tool_pace(arm, u)).iter().sum::<f64>()
            };
            GAUSS.into_iter().map(pair).sum::<f64>()
        };
        (0..panels).map(panel).sum()
    }
}

/// Nodes and weights of Gauss's rule with eight points, of one half of (−1, 1) (Abramowitz and Stegun 1964, table 25.4).
const GAUSS: [(f64, f64); 4] = [
    (0.183_434_642_495_649_8, 0.362_683_783_378_362),
    (0.525_532_409_916_329, 0.313_706_645_877_887_3),
    (0.796_666_477_413_626_7, 0.222_381_034_453_374_5),
    (0.960_289_856_497_536_3, 0.101_228_536_290_376_3),
];

/// The knots between the ends, stretched.
fn inner(knots: &[f64], factor: f64) -> Vec<f64> {
    knots[1..knots.len() - 1].iter().map(|knot| knot * factor).collect()
}
