//! The limits that a motion is held to, as numbered channels: those of each joint, then those of the tool.

use super::state::State;
use crate::kinematics::ToolMotion;
use crate::path::outcome::PathLimit;
use crate::timing::limits::Stretch;

/// Limits of each joint before those of the tool.
const JOINT_CHANNELS: [PathLimit; 6] = [
    PathLimit::Torque,
    PathLimit::Velocity,
    PathLimit::Acceleration,
    PathLimit::Jerk,
    PathLimit::PositionLower,
    PathLimit::PositionUpper,
];

/// What the channels of an arm are.
#[derive(Debug, Clone, Copy)]
pub(super) struct Channels<'a> {
    pub(super) joint_count: usize,
    /// Position limits by joint.
    pub(super) ranges: &'a [[Option<f64>; 2]],
}

impl Channels<'_> {
    pub(super) fn count(&self) -> usize {
        self.joint_count * JOINT_CHANNELS.len() + 2
    }

    /// The channel of a joint's torque.
    pub(super) fn torque(joint: usize) -> usize {
        joint * JOINT_CHANNELS.len()
    }

    /// What a channel is of.
    pub(super) fn of(&self, channel: usize) -> (PathLimit, Option<usize>) {
        let joints = self.joint_count * JOINT_CHANNELS.len();
        match channel.checked_sub(joints) {
            None => (
                JOINT_CHANNELS[channel % JOINT_CHANNELS.len()],
                Some(channel / JOINT_CHANNELS.len()),
            ),
            Some(0) => (PathLimit::ToolVelocity, None),
            Some(_) => (PathLimit::ToolAcceleration, None),
        }
    }

    /// The limit of a channel on a stretch; `None` where there is none.
    pub(super) fn limit(&self, channel: usize, stretch: &Stretch) -> Option<f64> {
        let (kind, joint) = self.of(channel);
        let of_joint = |joint: usize| &stretch.joints[joint];
        match (kind, joint) {
            (PathLimit::Torque, Some(joint)) => of_joint(joint).torque,
            (PathLimit::Velocity, Some(joint)) => of_joint(joint).velocity,
            (PathLimit::Acceleration, Some(joint)) => of_joint(joint).acceleration,
            (PathLimit::Jerk, Some(joint)) => of_joint(joint).jerk,
            (PathLimit::PositionLower, Some(joint)) => self.ranges[joint][0],
            (PathLimit::PositionUpper, Some(joint)) => self.ranges[joint][1],
            (PathLimit::ToolVelocity, _) => stretch.tool_velocity,
            _ => stretch.tool_acceleration,
        }
    }

    /// How much of a limit a value uses: above 1 it is broken. Of a range, counted from its other end.
    pub(super) fn ratio(&self, channel: usize, value: f64, limit: f64) -> f64 {
        self.size(channel, self.part(channel, value, limit))
    }

    /// A value as part of its limit, with its sign; of a range, counted from its other end.
    pub(super) fn part(&self, channel: usize, value: f64, limit: f64) -> f64 {
        let (kind, joint) = self.of(channel);
        let range = || {
            let [lower, upper] = joint.map_or([None; 2], |joint| self.ranges[joint]);
            lower
                .zip(upper)
                .map_or(1.0, |(lower, upper)| (upper - lower).max(f64::MIN_POSITIVE))
        };
        match kind {
            PathLimit::PositionLower => 1.0 + (limit - value) / range(),
            PathLimit::PositionUpper => 1.0 + (value - limit) / range(),
            _ => value / limit,
        }
    }

    /// What counts of a part: either sign, but of a range.
    pub(super) fn size(&self, channel: usize, part: f64) -> f64 {
        match self.of(channel).0 {
            PathLimit::PositionLower | PathLimit::PositionUpper => part,
            _ => part.abs(),
        }
    }
}

/// Writes the values of every limit but the torques'.
pub(super) fn fill(state: &State, tool: Option<ToolMotion>, values: &mut [f64]) {
    let (joints, of_tool) = values.split_at_mut(values.len() - 2);
    for (joint, values) in joints.chunks_exact_mut(JOINT_CHANNELS.len()).enumerate() {
        let position = state.position[joint];
        values[1..].copy_from_slice(&[
            state.velocity[joint],
            state.acceleration[joint],
            state.jerk[joint],
            position,
            position,
        ]);
    }
    if let Some(tool) = tool {
        of_tool.copy_from_slice(&[tool.velocity.norm(), tool.acceleration.norm()]);
    }
}
