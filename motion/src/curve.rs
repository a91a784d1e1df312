//! A path of the joints, as the timing sees it: q(s) and its derivatives in s.

use crate::jet::Jet;

/// q and its first three derivatives in s at one point of a path, one value a joint.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct CurvePoint {
    /// q, "rad or m".
    pub(crate) position: Vec<f64>,
    /// q′.
    pub(crate) first: Vec<f64>,
    /// q″.
    pub(crate) second: Vec<f64>,
    /// q‴.
    pub(crate) third: Vec<f64>,
}

/// Which one-sided limit is meant where the third derivative (of a cubic spline: the second) jumps.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Side {
    /// From below.
    Before,
    /// From above.
    After,
}

/// A path of all joints from s = 0 to [`Curve::length`], without a stop within it. Three times differentiable between
/// knots, at least twice across them.
pub(crate) trait Curve {
    fn joint_count(&self) -> usize;

    /// Length in the path's own parameter.
    fn length(&self) -> f64;

    /// Where the third derivative may jump or have a kink, both ends included, strictly increasing. The timing grid has
    /// them all.
    fn knots(&self) -> &[f64];

    /// The point at `s`; at a knot, that of one side. Outside 0 to the length, that of the end.
    fn evaluate(&self, s: f64, side: Side, point: &mut CurvePoint);
}

impl CurvePoint {
    /// Takes the values and derivatives of jets, one a joint.
    pub(crate) fn set(&mut self, joints: &[Jet]) {
        for (joint, jet) in joints.iter().enumerate() {
            let [value, first, second, third] = jet.derivatives();
            self.position[joint] = value;
            self.first[joint] = first;
            self.second[joint] = second;
            self.third[joint] = third;
        }
    }

    /// Room for so many joints.
    pub(crate) fn new(joint_count: usize) -> Self {
        let zeros = || vec![0.0; joint_count];
        Self {
            position: zeros(),
            first: zeros(),
            second: zeros(),
            third: zeros(),
        }
    }
}
