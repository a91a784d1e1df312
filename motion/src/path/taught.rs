//! From taught points to tracks: each segment from where the one before it ended.

use std::sync::Arc as Shared;

use nalgebra::Isometry3;

use super::arm::Arm;
use super::fault::{Fault, infeasible};
use super::outcome::{Location, PathInfeasible, PathInfeasibleReason};
use super::piecewise::Piecewise;
use super::request::{PathRequest, Shape, Target};
use super::track::Track;
use crate::kinematics;
use crate::kinematics::inverse::{Inverse, Unreachable};
use crate::robot::Robot;
use crate::tolerance::SEGMENT_MIN;

/// The arm on its way through a program.
#[derive(Debug)]
pub(super) struct Teacher<'a> {
    pub(super) robot: &'a Robot,
    pub(super) tcp: &'a Isometry3<f64>,
    pub(super) arm: Shared<Arm>,
    inverse: Inverse,
    /// What counts as full speed of each joint: its limit, 1 where it has none.
    pub(super) speeds: Vec<f64>,
    /// Where the arm is.
    q: Vec<f64>,
}

impl<'a> Teacher<'a> {
    pub(super) fn new(robot: &'a Robot, tcp: &'a Isometry3<f64>, request: &PathRequest) -> Self {
        let speeds = robot.spec().joints.iter().map(|joint| {
            let tightened = request.limits.iter().find(|limit| limit.joint == joint.name);
            let asked = tightened
                .and_then(|limit| limit.velocity)
                .filter(|v| v.is_finite() && *v > 0.0);
            asked.or(joint.limits.velocity).unwrap_or(1.0)
        });
        Self {
            robot,
            tcp,
            arm: Shared::new(Arm::new(robot, tcp)),
            inverse: Inverse::new(robot, tcp),
            speeds: speeds.collect(),
            q: request.start.clone(),
        }
    }

    /// The next segment; `None` where it goes nowhere.
    pub(super) fn track(&mut self, segment: usize, shape: &Shape) -> Result<Option<Track>, Fault> {
        match shape {
            Shape::Joint { target } => self.joint(segment, target),
            Shape::Line { .. } | Shape::Arc(_) | Shape::Spline(_) => {
                let message = "only joint segments can be planned so far";
                Err(Fault::invalid(format!("segments[{segment}]"), message))
            }
        }
    }

    fn joint(&mut self, segment: usize, target: &Target) -> Result<Option<Track>, Fault> {
        let end = self.joints_of(segment, target)?;
        let travel = self.q.iter().zip(&end).map(|(from, to)| (to - from).abs());
        if travel.fold(0.0, f64::max) < SEGMENT_MIN {
            return Ok(None);
        }
        let curve = Piecewise::straight(&self.q, &end);
        self.q = end;
        let mut track = Track::of_joints(&self.arm, segment, curve, &self.speeds);
        track.by_part = true;
        Ok(Some(track))
    }

    /// The joint positions of a taught point; of a pose, those nearest to where the arm is.
    fn joints_of(&self, segment: usize, target: &Target) -> Result<Vec<f64>, Fault> {
        match target {
            Target::Joints(positions) => Ok(positions.clone()),
            Target::Pose { .. } => {
                let pose = self.pose_of(target);
                let found = self.inverse.nearest(&pose, &self.q);
                found.map_err(|unreachable| self.missing(segment, unreachable).into())
            }
        }
    }

    /// The pose of a taught point in base-link axes.
    fn pose_of(&self, target: &Target) -> Isometry3<f64> {
        match target {
            Target::Joints(positions) => kinematics::pose(self.robot, positions, self.tcp),
            Target::Pose { pose, frame } => self.frame(frame.as_deref()) * pose,
        }
    }

    /// A named frame in base-link axes.
    fn frame(&self, name: Option<&str>) -> Isometry3<f64> {
        let frames = &self.robot.spec().frames;
        let named = frames.iter().find(|(known, _)| Some(known.as_str()) == name);
        named.map_or_else(Isometry3::identity, |(_, frame)| *frame)
    }

    /// The evidence that a taught pose cannot be taken.
    fn missing(&self, segment: usize, unreachable: Unreachable) -> PathInfeasible {
        let location = Location { segment, fraction: 1.0 };
        let evidence = |reason, needed, available| PathInfeasible {
            needed,
            available,
            ..infeasible(reason, location, format!("{unreachable}; teach another pose"))
        };
        match unreachable {
            Unreachable::OutOfReach {
                position_gap,
                orientation_gap,
                ..
            } => {
                // m where the place is missed, rad where the orientation alone is
                let gap = if position_gap > SEGMENT_MIN {
                    position_gap
                } else {
                    orientation_gap
                };
                evidence(PathInfeasibleReason::OutOfReach, gap, 0.0)
            }
            Unreachable::JointRange {
                joint,
                needed,
                available,
                ..
            } => PathInfeasible {
                joint: Some(joint),
                ..evidence(PathInfeasibleReason::JointRange, needed, available)
            },
            Unreachable::Singular { .. } => evidence(PathInfeasibleReason::Singularity, 0.0, 0.0),
        }
    }
}
