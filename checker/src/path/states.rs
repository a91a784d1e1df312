//! Every set-point by itself: its state against the limits, its torque and tool speed against those of its state.
//!
//! Coulomb friction opposes the motion, just before a set-point as just after it ([`super::ways`]); both torques count, and
//! the one just after is the set-point's own. An arm that stands must also be held, without friction's help.

use takt_motion::path::outcome::PathLimit;

use super::Case;
use super::bounds::SegmentBounds;
use super::report::{Extremes, FaultKind, PathReport, Source};
use super::samples::State;
use super::ways::{Way, Ways};
use crate::arm::Workspace;
use crate::tolerance;

pub(super) fn check(case: &Case<'_>, workspace: &mut Workspace, report: &mut PathReport) {
    let joint_count = case.samples.joints().len();
    let columns = case.samples.joints();
    let mut extremes = Extremes::new(Source::States, joint_count);
    let mut state = State::default();
    let mut torques = Torques {
        case,
        workspace,
        ways: Ways::default(),
        sizes: columns.iter().map(|column| largest(&column.acceleration)).collect(),
        scales: columns.iter().map(|column| largest(&column.torque)).collect(),
        direction: vec![0.0; joint_count],
        torque: vec![0.0; joint_count],
    };
    let fastest = largest(case.samples.tool_speed());
    for index in 0..case.samples.len() {
        let time = case.samples.times()[index];
        let bounds = &case.bounds[case.samples.locations()[index].segment];
        case.samples.state(index, &mut state);
        torques.check(index, &mut state, &mut extremes, report);
        let State { q, qd, qdd } = &state;
        for (joint, bounds) in bounds.joints.iter().enumerate() {
            let mut offer = |kind, value| extremes.joint(kind, joint, value, bounds, time);
            offer(PathLimit::Velocity, qd[joint]);
            offer(PathLimit::Acceleration, qdd[joint]);
            offer(PathLimit::PositionLower, q[joint]);
            offer(PathLimit::PositionUpper, q[joint]);
        }
        let tool = case.arm.tool_motion(torques.workspace, &case.tool, q, qd, qdd);
        let speed = tool.velocity.norm();
        extremes.tool(PathLimit::ToolVelocity, speed, bounds, time);
        extremes.tool(PathLimit::ToolAcceleration, tool.acceleration.norm(), bounds, time);
        let told = case.samples.tool_speed()[index];
        if (told - speed).abs() > tolerance::DYNAMICS * fastest {
            report.fault(FaultKind::ToolSpeedColumn, 0, time, told, speed);
        }
    }
    report.extremes.extend(extremes.found());
}

/// The torques at the set-points, against their limits and against their column.
struct Torques<'a, 'b> {
    case: &'a Case<'b>,
    workspace: &'a mut Workspace,
    ways: Ways,
    /// Largest acceleration of each joint.
    sizes: Vec<f64>,
    /// Largest torque that is told of each joint.
    scales: Vec<f64>,
    direction: Vec<f64>,
    torque: Vec<f64>,
}

impl Torques<'_, '_> {
    fn check(&mut self, index: usize, state: &mut State, extremes: &mut Extremes, report: &mut PathReport) {
        let time = self.case.samples.times()[index];
        let bounds = &self.case.bounds[self.case.samples.locations()[index].segment];
        self.ways.set(self.case, index, state, &self.sizes);
        self.compute(state, |way| way.after);
        self.offer(bounds, time, |way| way.after, extremes);
        self.column(index, state, report);
        if self.ways.joints.iter().any(|way| way.before != way.after) {
            self.compute(state, |way| way.before);
            self.offer(bounds, time, |way| way.before, extremes);
        }
        if self.ways.standing {
            state.qdd.fill(0.0);
            self.compute(state, |_| None);
            self.offer(bounds, time, |_| Some(0.0), extremes);
        }
    }

    /// Holds the told torques to those just after, which were just computed.
    fn column(&mut self, index: usize, state: &State, report: &mut PathReport) {
        let case = self.case;
        let time = case.samples.times()[index];
        let told = |joint: usize| case.samples.joints()[joint].torque[index];
        let close = |joint: usize, torque: f64, scale: f64| (told(joint) - torque).abs() <= tolerance::DYNAMICS * scale;
        let joints = self.torque.iter().zip(&self.scales).enumerate();
        let mut odd: Vec<(usize, f64)> = joints
            .filter(|(joint, (torque, scale))| !close(*joint, **torque, **scale))
            .map(|(joint, (torque, _))| (joint, *torque))
            .collect();
        // one that has not been told to move may stand still, or set out either way
        for friction in [0.0, 1.0, -1.0] {
            let mut open = odd.iter().filter(|(joint, _)| self.ways.joints[*joint].may_stand);
            if open.next().is_none() {
                break;
            }
            self.compute(state, |_| Some(friction));
            odd.retain(|(joint, _)| {
                let way = &self.ways.joints[*joint];
                let may_be = way.may_stand && (way.after.is_none() || friction == 0.0);
                !may_be || !close(*joint, self.torque[*joint], self.scales[*joint])
            });
        }
        for (joint, torque) in odd {
            report.fault(FaultKind::TorqueColumn, joint, time, told(joint), torque);
        }
    }

    /// Computes the torques with friction against some way of every joint, without where it is not known.
    fn compute(&mut self, state: &State, way: impl Fn(&Way) -> Option<f64>) {
        for (direction, joint) in self.direction.iter_mut().zip(&self.ways.joints) {
            *direction = way(joint).unwrap_or(0.0);
        }
        let State { q, qd, qdd } = state;
        let (direction, torque) = (&self.direction, &mut self.torque);
        self.case
            .arm
            .drive_torque(self.workspace, q, qd, qdd, direction, torque);
    }

    /// Looks at the torques of the joints whose way is known.
    fn offer(&self, bounds: &SegmentBounds, time: f64, way: impl Fn(&Way) -> Option<f64>, extremes: &mut Extremes) {
        for (joint, bounds) in bounds.joints.iter().enumerate() {
            if way(&self.ways.joints[joint]).is_some() {
                extremes.joint(PathLimit::Torque, joint, self.torque[joint], bounds, time);
            }
        }
    }
}

fn largest(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |most, value| most.max(value.abs()))
}
