//! From taught points to tracks: each segment from where the one before it ended.

use std::sync::Arc as Shared;

use nalgebra::{Isometry3, Matrix6, Point3, Vector6};

use super::arm::Arm;
use super::circle;
use super::fault::Fault;
use super::guided::{Guided, Led};
use super::piecewise::Piecewise;
use super::request::{Arc, ArcOrientation, Circle, PathRequest, Shape, Space, Target};
use super::shape::{ToolCurve, Turn};
use super::track::Track;
use crate::budget::Budget;
use crate::jet::Jet;
use crate::kinematics;
use crate::kinematics::inverse::Inverse;
use crate::robot::Robot;
use crate::tolerance::{SAME_BRANCH, SEGMENT_MIN};

/// The arm on its way through a program.
#[derive(Debug)]
pub(super) struct Teacher<'a> {
    pub(super) robot: &'a Robot,
    pub(super) tcp: &'a Isometry3<f64>,
    pub(super) arm: Shared<Arm>,
    pub(super) inverse: Inverse,
    /// What counts as full speed of each joint: its limit, 1 where it has none.
    pub(super) speeds: Vec<f64>,
    /// Where the arm is.
    pub(super) q: Vec<f64>,
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
    pub(super) fn track(
        &mut self,
        segment: usize,
        shape: &Shape,
        warnings: &mut Vec<String>,
        budget: &Budget<'_>,
    ) -> Result<Option<Track>, Fault> {
        let (curve, target) = match shape {
            Shape::Joint { target } => return self.joint(segment, target, budget),
            Shape::Line { target } => (ToolCurve::line(&self.pose(), &self.pose_of(target)), Some(target)),
            Shape::Arc(arc) => {
                let target = arc
                    .target
                    .as_ref()
                    .filter(|_| arc.orientation == ArcOrientation::Interpolated);
                (self.arc(&format!("segments[{segment}].arc"), arc)?, target)
            }
            Shape::Spline(spline) => {
                let path = format!("segments[{segment}].spline");
                let curve = match spline.space {
                    Space::Joint => return self.joint_spline(segment, &path, spline, budget),
                    Space::Tool => self.tool_spline(&path, spline)?,
                };
                let Some(curve) = curve else { return Ok(None) };
                let track = self.guided(segment, &curve, spline.points.last(), warnings, budget)?;
                self.check_pace(&path, &track, budget)?;
                return Ok(Some(track));
            }
        };
        if curve.is_shorter_than(SEGMENT_MIN) {
            return Ok(None);
        }
        self.guided(segment, &curve, target, warnings, budget).map(Some)
    }

    /// The curve of a line or an arc from where the arm is; `None` where it goes nowhere.
    pub(super) fn curve(&self, segment: usize, shape: &Shape) -> Result<Option<ToolCurve>, Fault> {
        let curve = match shape {
            Shape::Line { target } => ToolCurve::line(&self.pose(), &self.pose_of(target)),
            Shape::Arc(arc) => self.arc(&format!("segments[{segment}].arc"), arc)?,
            Shape::Joint { .. } | Shape::Spline(_) => return Ok(None),
        };
        Ok((!curve.is_shorter_than(SEGMENT_MIN)).then_some(curve))
    }

    /// Puts the arm where a segment ends, nearest to where it is.
    pub(super) fn stand_at(&mut self, segment: usize, pose: &Isometry3<f64>) -> Result<(), Fault> {
        let found = self.inverse.nearest(pose, &self.q);
        self.q = found.map_err(|unreachable| self.missing(segment, &unreachable))?;
        Ok(())
    }

    /// The joints beyond six on the way from where the arm is to where a curve ends.
    pub(super) fn led_to(&self, segment: usize, curve: &ToolCurve) -> Result<Vec<Led>, Fault> {
        self.led(segment, curve, None)
    }

    /// A segment whose curve is the tool's. `target` is where it was taught to end, pose and joints.
    fn guided(
        &mut self,
        segment: usize,
        curve: &ToolCurve,
        target: Option<&Target>,
        warnings: &mut Vec<String>,
        budget: &Budget<'_>,
    ) -> Result<Track, Fault> {
        let taught = match target {
            Some(Target::Joints(positions)) => Some(positions.as_slice()),
            Some(Target::Pose { .. }) | None => None,
        };
        let led = self.led(segment, curve, taught)?;
        if !led.is_empty() {
            warnings.push(self.say_who_leads(segment, &led));
        }
        let guided = match Guided::new(&self.arm, curve.clone(), led, &self.q, budget)? {
            Ok(guided) => guided,
            Err(halt) => return Err(self.halted(segment, curve, halt).into()),
        };
        let end = guided.end();
        if let Some(taught) = taught
            && let Some(joint) = (0..end.len()).find(|joint| (end[*joint] - taught[*joint]).abs() > SAME_BRANCH)
        {
            return Err(self.other_branch(segment, joint, taught[joint], end[joint]).into());
        }
        self.q = end;
        Ok(Track::of_tool(&self.arm, segment, guided, &self.speeds, budget)?)
    }

    /// The joints beyond six, each led evenly from where it is to where it is at the end.
    fn led(&self, segment: usize, curve: &ToolCurve, taught: Option<&[f64]>) -> Result<Vec<Led>, Fault> {
        if self.q.len() <= 6 {
            return Ok(Vec::new());
        }
        let end = match taught {
            Some(taught) => taught.to_vec(),
            None => {
                let found = self.inverse.nearest(&curve.pose(1.0), &self.q);
                found.map_err(|unreachable| self.missing(segment, &unreachable))?
            }
        };
        let led = self.leaders(&self.q, &end).into_iter().map(|joint| Led {
            joint,
            start: self.q[joint],
            end: end[joint],
        });
        Ok(led.collect())
    }

    /// Which joints beyond six to lead between two positions: one after the other, those that the others can best do
    /// without, by the least of det JJᵀ at both (Yoshikawa 1985).
    pub(super) fn leaders(&self, start: &[f64], end: &[f64]) -> Vec<usize> {
        let mut leaders = Vec::new();
        let columns = [start, end].map(|q| self.columns(q));
        while start.len() - leaders.len() > 6 {
            let manipulability = |without: usize| {
                let at = |columns: &[Vector6<f64>]| {
                    let kept = (0..start.len()).filter(|joint| *joint != without && !leaders.contains(joint));
                    let gram = kept.fold(Matrix6::zeros(), |sum: Matrix6<f64>, joint| {
                        sum + columns[joint] * columns[joint].transpose()
                    });
                    gram.determinant()
                };
                at(&columns[0]).min(at(&columns[1]))
            };
            let free = (0..start.len()).filter(|joint| !leaders.contains(joint));
            let scores: Vec<(usize, f64)> = free.map(|joint| (joint, manipulability(joint))).collect();
            let best = scores.iter().copied().max_by(|a, b| a.1.total_cmp(&b.1));
            leaders.extend(best.map(|(joint, _)| joint));
        }
        leaders
    }

    /// Columns of the Jacobian, linear rows in parts of the arm's length.
    fn columns(&self, q: &[f64]) -> Vec<Vector6<f64>> {
        let q: Vec<Jet> = q.iter().map(|q| Jet::constant(*q)).collect();
        let frames = self.arm.frames(&q);
        let column = |joint| {
            let (linear, angular) = self.arm.column(&frames, joint);
            let linear = linear / self.arm.span();
            Vector6::new(linear.x, linear.y, linear.z, angular.x, angular.y, angular.z)
        };
        (0..q.len()).map(column).collect()
    }

    fn arc(&self, path: &str, arc: &Arc) -> Result<ToolCurve, Fault> {
        let start = self.pose();
        let end = arc.target.as_ref().map(|target| self.pose_of(target));
        let (a, c) = (start.translation.vector, end.map(|end| end.translation.vector));
        let circle = match &arc.circle {
            Circle::Via { point, second } => {
                let b = self.pose_of(point).translation.vector;
                let second = second.as_ref().map(|second| self.pose_of(second).translation.vector);
                circle::through(&a, &b, &c.or(second).unwrap_or(a), c.is_none())
            }
            Circle::Center {
                center,
                normal,
                long_way,
                frame,
            } => {
                let frame = self.frame(frame.as_deref());
                let center = frame * Point3::from(*center);
                let normal = normal.map(|normal| frame * normal);
                circle::around(&a, &center.coords, c.as_ref(), normal.as_ref(), *long_way)
            }
            Circle::Radius {
                radius,
                normal,
                long_way,
                frame,
            } => {
                let normal = self.frame(frame.as_deref()) * normal;
                circle::of_radius(&a, &c.unwrap_or(a), *radius, &normal, *long_way)
            }
        };
        let circle = circle.map_err(|(field, message)| Fault::invalid(format!("{path}{field}"), message))?;
        let turn = match arc.orientation {
            ArcOrientation::Interpolated => Turn::between(&start.rotation, &end.unwrap_or(start).rotation),
            ArcOrientation::Tangent => {
                let normal = circle.radial.cross(&circle.tangent).normalize();
                Turn::about(&start.rotation, normal, circle.sweep)
            }
        };
        Ok(ToolCurve::Arc { circle, turn })
    }

    fn joint(&mut self, segment: usize, target: &Target, budget: &Budget<'_>) -> Result<Option<Track>, Fault> {
        let end = self.joints_of(segment, target, &self.q)?;
        let travel = self.q.iter().zip(&end).map(|(from, to)| (to - from).abs());
        if travel.fold(0.0, f64::max) < SEGMENT_MIN {
            return Ok(None);
        }
        let curve = Piecewise::straight(&self.q, &end);
        self.q = end;
        let mut track = Track::of_joints(&self.arm, segment, curve, &self.speeds, budget)?;
        track.by_part = true;
        Ok(Some(track))
    }

    /// Where the tool is.
    pub(super) fn pose(&self) -> Isometry3<f64> {
        kinematics::pose(self.robot, &self.q, self.tcp)
    }

    /// The joint positions of a taught point; of a pose, those nearest to a reference.
    pub(super) fn joints_of(&self, segment: usize, target: &Target, reference: &[f64]) -> Result<Vec<f64>, Fault> {
        match target {
            Target::Joints(positions) => Ok(positions.clone()),
            Target::Pose { .. } => {
                let pose = self.pose_of(target);
                let found = self.inverse.nearest(&pose, reference);
                found.map_err(|unreachable| self.missing(segment, &unreachable).into())
            }
        }
    }

    /// The pose of a taught point in base-link axes.
    pub(super) fn pose_of(&self, target: &Target) -> Isometry3<f64> {
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
}
