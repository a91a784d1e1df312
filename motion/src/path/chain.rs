//! A chain of lines and arcs at one constant tool speed, with the joints that follow it: a path whose parameter is time.

use std::sync::Arc as Shared;

use super::arm::Arm;
use super::follow::{Guide, Halt, Seeds, follow};
use super::guided::Led;
use super::inverse::Followers;
use super::outcome::Location;
use super::shape::ToolCurve;
use super::stroke::Span;
use super::tool::{ToolPoint, product};
use super::track::Joints;
use crate::budget::{Budget, Stopped};
use crate::curve::{Curve, CurvePoint, Side};
use crate::jet::Jet;
use crate::process::ConstantSpeedMotion;

/// The chain, on one branch of the inverse kinematics; s is the time since it began.
#[derive(Debug)]
pub(super) struct Chain {
    arm: Shared<Arm>,
    course: Course,
    followers: Followers,
    seeds: Seeds,
    knots: Vec<f64>,
    spans: Vec<Span>,
}

/// What is given: the tool's position in time, its orientation along each segment, and the joints that are led.
#[derive(Debug, Clone)]
pub(super) struct Course {
    pub(super) motion: ConstantSpeedMotion,
    /// One a segment of the chain.
    pub(super) curves: Vec<ToolCurve>,
    pub(super) led: Vec<Led>,
    /// The request's segments.
    pub(super) segments: Vec<usize>,
}

impl Course {
    /// Where on the request's segments a time is.
    pub(super) fn location(&self, time: f64) -> Location {
        let at = self.motion.location(time);
        Location {
            segment: self.segments[at.segment],
            ..at
        }
    }

    /// The part of the whole way that is done at a time.
    fn progress(&self, segment: usize, fraction: Jet, next: Option<Jet>) -> Jet {
        let length = |segment: usize| self.motion.length(segment);
        let total: f64 = (0..self.curves.len()).map(length).sum();
        let done: f64 = (0..segment).map(length).sum();
        let ahead = next.map_or(Jet::default(), |next| next * length(segment + 1));
        (fraction * length(segment) + ahead + done) * (1.0 / total)
    }
}

impl Guide for Course {
    fn aim(&self, u: Jet, side: Side, q: &mut Joints) -> ToolPoint {
        let state = self.motion.evaluate(u.value(), side);
        let in_u = |jet: Jet| u.compose(jet.derivatives());
        let fraction = in_u(state.fraction);
        let next = state.next_fraction.map(in_u);
        if !self.led.is_empty() {
            let progress = self.progress(state.segment, fraction, next);
            for led in &self.led {
                q[led.joint] = progress * (led.end - led.start) + led.start;
            }
        }
        let mut turn = self.curves[state.segment].at(fraction, side).turn;
        if let Some(next) = next {
            // what the next segment turns from its start, on top of what this one has turned
            let curve = &self.curves[state.segment + 1];
            let [w, x, y, z] = curve.at(Jet::constant(0.0), Side::After).turn;
            turn = product(curve.at(next, side).turn, product([w, -x, -y, -z], turn));
        }
        ToolPoint {
            position: state.position.map(in_u),
            turn,
        }
    }
}

impl Chain {
    /// Follows a course from the joint positions `q`.
    pub(super) fn new(
        arm: &Shared<Arm>,
        course: Course,
        q: &[f64],
        budget: &Budget<'_>,
    ) -> Result<Result<Self, Halt>, Stopped> {
        let led: Vec<usize> = course.led.iter().map(|led| led.joint).collect();
        let followers = Followers::all_but(arm.joint_count(), &led);
        let mut start = Joints::default();
        for (jet, q) in start.iter_mut().zip(q) {
            *jet = Jet::constant(*q);
        }
        let duration = course.motion.duration();
        let seeds = follow(arm, &course, &followers, duration, &start, budget)?;
        let passes = course.motion.passes();
        let spans = course
            .segments
            .iter()
            .zip(passes.windows(2))
            .map(|(segment, ends)| Span {
                segment: *segment,
                begin: ends[0],
                end: ends[1],
            });
        let spans = spans.collect();
        Ok(seeds.map(|seeds| Self {
            arm: Shared::clone(arm),
            knots: course.motion.knots(),
            course,
            followers,
            seeds,
            spans,
        }))
    }

    pub(super) fn spans(&self) -> &[Span] {
        &self.spans
    }

    pub(super) fn location(&self, time: f64) -> Location {
        self.course.location(time)
    }

    /// The joints where it ends.
    pub(super) fn end(&self) -> Vec<f64> {
        self.seeds.end()
    }
}

impl Curve for Chain {
    fn joint_count(&self) -> usize {
        self.arm.joint_count()
    }

    fn length(&self) -> f64 {
        self.course.motion.duration()
    }

    fn knots(&self) -> &[f64] {
        &self.knots
    }

    fn evaluate(&self, s: f64, side: Side, point: &mut CurvePoint) {
        let time = s.clamp(0.0, self.length());
        let mut q = Joints::default();
        self.seeds.at(time, &mut q);
        let aim = self.course.aim(Jet::variable(time, 1.0), side, &mut q);
        self.followers.solve(&self.arm, &aim, &mut q);
        point.set(&q[..self.arm.joint_count()]);
    }
}
