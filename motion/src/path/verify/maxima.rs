//! Which spans between samples may hold a limit's largest use, and what the motion asks at any moment of them.

use super::extremes::{Node, Span, search, way};
use super::{Examiner, PARTS};
use crate::budget::{Budget, Stopped};
use crate::curve::Side;
use crate::dynamics;
use crate::kinematics::{self, ToolMotion};
use crate::path::outcome::PathLimit;
use crate::tolerance::EXTREME_GAIN;

/// Spans that may hold a channel's maximum, before those that cannot any more are dropped: it bounds the memory.
const CANDIDATES: usize = 1024;

impl Examiner<'_> {
    /// Remembers where an interval's channel may be above all that is known, between the samples from `first` on.
    pub(super) fn consider(&mut self, channel: usize, limit: f64, first: usize) {
        let nodes: [Node; PARTS + 1] = std::array::from_fn(|part| self.sampled(channel, limit, first + part));
        let second = |middle: usize| {
            let bend = |way: usize| {
                let [before, here, after] = [middle - 1, middle, middle + 1].map(|part| nodes[part].parts[way]);
                (before - 2.0 * here + after).abs()
            };
            bend(0).max(bend(1)).max(bend(2))
        };
        let bends: [f64; PARTS + 1] = std::array::from_fn(|part| second(part.clamp(1, PARTS - 1)));
        let least = self.ratio_known(channel) + EXTREME_GAIN;
        for part in 0..PARTS {
            let around = &bends[part.saturating_sub(1)..(part + 3).min(PARTS + 1)];
            let span = Span {
                ends: [nodes[part], nodes[part + 1]],
                bend: around.iter().fold(0.0, |most: f64, bend| most.max(*bend)),
                limit,
            };
            if span.bound(|part| self.channels.size(channel, part)) > least {
                self.candidates[channel].push(span);
            }
        }
        if self.candidates[channel].len() > CANDIDATES {
            self.drop_candidates(channel);
        }
    }

    /// The largest part of its limit that is known of a channel.
    fn ratio_known(&self, channel: usize) -> f64 {
        self.known[channel].map_or(f64::NEG_INFINITY, |known| self.examined.tightest[known].ratio)
    }

    /// Drops the spans that cannot be above what is known by now.
    fn drop_candidates(&mut self, channel: usize) {
        let least = self.ratio_known(channel) + EXTREME_GAIN;
        let size = |part: f64| self.channels.size(channel, part);
        self.candidates[channel].retain(|span| span.bound(size) > least);
    }

    /// Follows every maximum between samples that may be its channel's largest.
    pub(super) fn follow(&mut self, budget: &Budget<'_>) -> Result<(), Stopped> {
        let channels = self.channels;
        for channel in 0..channels.count() {
            self.drop_candidates(channel);
            let spans = std::mem::take(&mut self.candidates[channel]);
            let known = self.ratio_known(channel);
            let size = |part: f64| channels.size(channel, part);
            search(
                spans,
                known,
                size,
                |span, time| self.evaluated(channel, span.limit, time),
                budget,
            )?;
        }
        Ok(())
    }

    /// A sample of a channel.
    fn sampled(&self, channel: usize, limit: f64, sample: usize) -> Node {
        let value = self.values[sample * self.channels.count() + channel];
        let time = self.times[sample];
        let part = |value: f64| self.channels.part(channel, value, limit);
        let (PathLimit::Torque, Some(joint)) = self.channels.of(channel) else {
            return Node {
                time,
                parts: [part(value); 3],
                way: way(0.0),
                rates: [0.0; 2],
            };
        };
        let entry = self.sweep.column(joint) + sample;
        let drive = self.robot.drives()[joint];
        let (direction, gravity) = (self.directions[entry], self.sweep.gravity[entry]);
        let smooth = value - drive.coulomb(direction, gravity);
        Node {
            time,
            parts: [-1.0, 0.0, 1.0].map(|way| part(smooth + drive.coulomb(way, gravity))),
            way: way(direction),
            rates: [self.sweep.velocity[entry], self.sweep.acceleration[entry]],
        }
    }

    /// A channel at some time, kept where it is the tightest.
    fn evaluated(&mut self, channel: usize, limit: f64, time: f64) -> Node {
        let channels = self.channels;
        let part = |value: f64| channels.part(channel, value, limit);
        let (PathLimit::Torque, Some(joint)) = channels.of(channel) else {
            let value = self.value_at(channel, time);
            self.keep(channel, limit, (value, time, self.state.s));
            return Node {
                time,
                parts: [part(value); 3],
                way: way(0.0),
                rates: [0.0; 2],
            };
        };
        let torques = self.torques_at(joint, time);
        let way = way(self.state.direction[joint]);
        self.keep(channel, limit, (torques[way], time, self.state.s));
        Node {
            time,
            parts: torques.map(part),
            way,
            rates: [self.state.velocity[joint], self.state.acceleration[joint]],
        }
    }

    /// The value of one channel but the torques' at one time.
    fn value_at(&mut self, channel: usize, time: f64) -> f64 {
        self.state.set(self.timed.curve, self.timed.law, time, Side::After);
        let state = &self.state;
        match self.channels.of(channel) {
            (PathLimit::Velocity, Some(joint)) => state.velocity[joint],
            (PathLimit::Acceleration, Some(joint)) => state.acceleration[joint],
            (PathLimit::Jerk, Some(joint)) => state.jerk[joint],
            (PathLimit::PositionLower | PathLimit::PositionUpper, Some(joint)) => state.position[joint],
            (PathLimit::ToolVelocity, _) => self.tool().velocity.norm(),
            _ => self.tool().acceleration.norm(),
        }
    }

    /// The torque of a drive at one time with Coulomb friction against a motion backwards, without, and against one
    /// forwards: [`way`] says which of them holds.
    pub(super) fn torques_at(&mut self, joint: usize, time: f64) -> [f64; 3] {
        self.state.set(self.timed.curve, self.timed.law, time, Side::After);
        let state = &self.state;
        let (velocity, acceleration) = (state.velocity[joint], state.acceleration[joint]);
        dynamics::rigid_torque(
            self.robot,
            &mut self.workspace,
            &state.position,
            &state.velocity,
            &state.acceleration,
            &mut self.torque,
        );
        // stays zero where no friction depends on it
        if self.robot.is_loaded() {
            dynamics::gravity_torque(self.robot, &mut self.workspace, &state.position, &mut self.gravity);
        }
        let drive = self.robot.drives()[joint];
        let (rigid, gravity) = (self.torque[joint] + drive.armature * acceleration, self.gravity[joint]);
        [-1.0, 0.0, 1.0].map(|way| rigid + drive.friction_towards(velocity, way, gravity))
    }

    /// The tool in the state that was set last.
    pub(super) fn tool(&self) -> ToolMotion {
        let state = &self.state;
        kinematics::tool_motion(
            self.robot,
            &state.position,
            &state.velocity,
            &state.acceleration,
            self.tcp,
        )
    }
}
