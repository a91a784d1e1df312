//! The motion at one moment, by the chain rule.

use crate::curve::{Curve, CurvePoint, Side};
use crate::timing::law::TimeLaw;

/// The state of the motion at one moment.
#[derive(Debug)]
pub(in crate::path) struct State {
    pub(in crate::path) s: f64,
    pub(in crate::path) position: Vec<f64>,
    pub(in crate::path) velocity: Vec<f64>,
    pub(in crate::path) acceleration: Vec<f64>,
    pub(in crate::path) jerk: Vec<f64>,
    point: CurvePoint,
}

impl State {
    pub(in crate::path) fn new(joint_count: usize) -> Self {
        let zeros = || vec![0.0; joint_count];
        Self {
            s: 0.0,
            position: zeros(),
            velocity: zeros(),
            acceleration: zeros(),
            jerk: zeros(),
            point: CurvePoint::new(joint_count),
        }
    }

    /// At rest.
    pub(in crate::path) fn rest_at(&mut self, position: &[f64]) {
        self.position.copy_from_slice(position);
        for rates in [&mut self.velocity, &mut self.acceleration, &mut self.jerk] {
            rates.fill(0.0);
        }
    }

    /// The state at a time since the path began, from one side of a place where derivatives jump.
    pub(in crate::path) fn set(&mut self, curve: &dyn Curve, law: &TimeLaw, time: f64, side: Side) {
        let at = law.at(time);
        curve.evaluate(at.position, side, &mut self.point);
        self.s = at.position;
        let (rate, acceleration, jerk) = (at.velocity, at.acceleration, at.jerk);
        let point = &self.point;
        self.position.copy_from_slice(&point.position);
        for joint in 0..self.position.len() {
            let (first, second, third) = (point.first[joint], point.second[joint], point.third[joint]);
            self.velocity[joint] = first * rate;
            self.acceleration[joint] = first * acceleration + second * rate * rate;
            self.jerk[joint] = first * jerk + 3.0 * second * rate * acceleration + third * rate * rate * rate;
        }
    }
}
