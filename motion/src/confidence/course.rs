//! A motion as bands see it: stretches of time, and the joints at any moment of them.

use crate::plan::problem::JointLimit;
use crate::tolerance::{BAND_PARTS_MAX, BAND_TRAVEL};
use crate::trajectory::{Trajectory, evaluate};

/// Joints at a moment, "rad or m" and their time derivatives.
#[derive(Debug, Clone)]
pub(crate) struct JointState {
    pub(crate) position: Vec<f64>,
    pub(crate) velocity: Vec<f64>,
    pub(crate) acceleration: Vec<f64>,
}

impl JointState {
    pub(crate) fn new(joint_count: usize) -> Self {
        let zeros = || vec![0.0; joint_count];
        Self {
            position: zeros(),
            velocity: zeros(),
            acceleration: zeros(),
        }
    }
}

/// A motion in time. A stretch without duration is a rest.
pub(crate) trait Course {
    /// s, rests at its ends included.
    fn duration(&self) -> f64;

    fn stretches(&self) -> usize;

    /// When a stretch begins and ends, s since the motion began.
    fn ends(&self, stretch: usize) -> [f64; 2];

    /// Samples that show how the torque varies on a stretch, less one.
    fn parts(&self, stretch: usize) -> usize;

    /// A joint's torque limit on a stretch.
    fn limit(&self, stretch: usize, joint: usize) -> Option<f64>;

    /// The joints at a time within a stretch.
    fn set(&mut self, stretch: usize, time: f64, state: &mut JointState);
}

/// Polynomials of time, with the rests at their ends.
#[derive(Debug)]
pub(super) struct Polynomials<'a> {
    pub(super) motion: &'a Trajectory,
    pub(super) limits: &'a [JointLimit],
    /// Fewest samples in a segment, less one.
    pub(super) parts_min: usize,
}

impl Course for Polynomials<'_> {
    fn duration(&self) -> f64 {
        self.motion.times()[self.motion.segment_count()]
    }

    fn stretches(&self) -> usize {
        self.motion.segment_count() + 2
    }

    fn ends(&self, stretch: usize) -> [f64; 2] {
        let times = self.motion.times();
        match stretch {
            0 => [times[0]; 2],
            _ if stretch < times.len() => [times[stretch - 1], times[stretch]],
            _ => [times[times.len() - 1]; 2],
        }
    }

    fn parts(&self, stretch: usize) -> usize {
        let [begin, end] = self.ends(stretch);
        if end <= begin {
            return 0;
        }
        // joints do not turn round within a segment
        let travel: f64 = self
            .motion
            .segment(stretch - 1)
            .iter()
            .map(|p| (evaluate(p, end - begin).position - p[0]).abs())
            .sum();
        ((travel / BAND_TRAVEL).ceil() as usize).clamp(self.parts_min, BAND_PARTS_MAX)
    }

    fn limit(&self, _: usize, joint: usize) -> Option<f64> {
        self.limits[joint].torque
    }

    fn set(&mut self, stretch: usize, time: f64, state: &mut JointState) {
        let last = self.motion.segment_count();
        let segment = stretch.clamp(1, last) - 1;
        let local = time - self.motion.times()[segment];
        let rests = stretch == 0 || stretch > last;
        for (joint, p) in self.motion.segment(segment).iter().enumerate() {
            let at = evaluate(p, local);
            state.position[joint] = at.position;
            state.velocity[joint] = if rests { 0.0 } else { at.velocity };
            state.acceleration[joint] = if rests { 0.0 } else { at.acceleration };
        }
    }
}
