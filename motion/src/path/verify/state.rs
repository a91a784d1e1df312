//! The motion at one moment, by the chain rule, and which way every joint moves, against which its friction acts.
//!
//! A joint moves the way of its velocity. Where that is zero, it moves as it does just after, or just before:
//!
//! - where the path sets out or arrives, as q′ points a little way inside: there q′ itself may be zero, and higher
//!   derivatives say where the joint goes;
//! - on the way, where it turns back, as it accelerates; just before, the other way;
//! - a joint that stands moves no way, and has no friction.

use crate::curve::{Curve, CurvePoint, Side};
use crate::timing::law::TimeLaw;
use crate::tolerance::{PATH_AT_REST, PATH_DEPARTURE, TRAVEL_MIN};

/// The state of the motion at one moment.
#[derive(Debug)]
pub(in crate::path) struct State {
    pub(in crate::path) s: f64,
    pub(in crate::path) position: Vec<f64>,
    pub(in crate::path) velocity: Vec<f64>,
    pub(in crate::path) acceleration: Vec<f64>,
    pub(in crate::path) jerk: Vec<f64>,
    /// Of the motion by its sign; 0 where a joint stands.
    pub(in crate::path) direction: Vec<f64>,
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
            direction: zeros(),
            point: CurvePoint::new(joint_count),
        }
    }

    /// At rest.
    pub(in crate::path) fn rest_at(&mut self, position: &[f64]) {
        self.position.copy_from_slice(position);
        let Self {
            velocity,
            acceleration,
            jerk,
            direction,
            ..
        } = self;
        for rates in [velocity, acceleration, jerk, direction] {
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
        self.set_direction(curve, law, rate, side);
    }

    fn set_direction(&mut self, curve: &dyn Curve, law: &TimeLaw, rate: f64, side: Side) {
        let (length, duration) = (curve.length(), law.duration());
        let inside = PATH_DEPARTURE * length;
        let near_end = self.s < inside || self.s > length - inside;
        let at_end = self.s <= 0.0 || self.s >= length;
        if at_end || (near_end && rate * duration <= PATH_AT_REST * length) {
            curve.evaluate(self.s.clamp(inside, length - inside), side, &mut self.point);
            self.direction.copy_from_slice(&self.point.first);
            // rest, of which a path that is timed already leaves the rounding of its derivatives; elsewhere a joint still moves,
            // and what is left of its velocity says which way
            let rests = |velocity: &f64| velocity.abs() * duration <= TRAVEL_MIN;
            if at_end && self.velocity.iter().all(rests) {
                self.velocity.fill(0.0);
            }
            return;
        }
        // slower than this the whole motion would not take a joint anywhere
        let slowest = TRAVEL_MIN / (duration * duration);
        for (joint, direction) in self.direction.iter_mut().enumerate() {
            let (velocity, acceleration) = (self.velocity[joint], self.acceleration[joint]);
            *direction = match side {
                _ if velocity != 0.0 => velocity,
                _ if acceleration.abs() <= slowest => 0.0,
                Side::After => acceleration,
                Side::Before => -acceleration,
            };
        }
    }
}

#[cfg(test)]
mod tests;
