//! A curve of the tool with the joints that follow it.

use super::arm::Arm;
use super::follow::{Guide, Halt, Seeds, follow};
use super::inverse::Followers;
use super::shape::ToolCurve;
use super::tool::ToolPoint;
use super::track::Joints;
use crate::budget::{Budget, Stopped};
use crate::curve::Side;
use crate::jet::Jet;

/// A joint whose course is given: from one position to another, evenly in v.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Led {
    pub(super) joint: usize,
    pub(super) start: f64,
    pub(super) end: f64,
}

/// A curve of the tool in v from 0 to 1, on one branch of the inverse kinematics.
#[derive(Debug)]
pub(super) struct Guided {
    course: Course,
    followers: Followers,
    seeds: Seeds,
}

/// What is given.
#[derive(Debug)]
struct Course {
    curve: ToolCurve,
    led: Vec<Led>,
}

impl Guide for Course {
    fn aim(&self, v: Jet, side: Side, q: &mut Joints) -> ToolPoint {
        for led in &self.led {
            q[led.joint] = v * (led.end - led.start) + led.start;
        }
        self.curve.at(v, side)
    }
}

impl Guided {
    /// Follows the curve from the joint positions `q`.
    pub(super) fn new(
        arm: &Arm,
        curve: ToolCurve,
        led: Vec<Led>,
        q: &[f64],
        budget: &Budget<'_>,
    ) -> Result<Result<Self, Halt>, Stopped> {
        let names: Vec<usize> = led.iter().map(|led| led.joint).collect();
        let followers = Followers::all_but(arm.joint_count(), &names);
        let course = Course { curve, led };
        let mut start = Joints::default();
        for (jet, q) in start.iter_mut().zip(q) {
            *jet = Jet::constant(*q);
        }
        let seeds = follow(arm, &course, &followers, 1.0, &start, budget)?;
        Ok(seeds.map(|seeds| Self {
            course,
            followers,
            seeds,
        }))
    }

    pub(super) fn curve(&self) -> &ToolCurve {
        &self.course.curve
    }

    /// The joints at v.
    pub(super) fn joints(&self, arm: &Arm, v: Jet, side: Side, q: &mut Joints) {
        self.seeds.at(v.value(), q);
        let aim = self.course.aim(v, side, q);
        self.followers.solve(arm, &aim, q);
    }

    /// The joints where it ends.
    pub(super) fn end(&self) -> Vec<f64> {
        self.seeds.end()
    }
}
