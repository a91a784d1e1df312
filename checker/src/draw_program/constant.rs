//! Random programs at constant tool speed: lines and arcs, now and then a stop within them.

use takt_motion::path::request::{PathRequest, Segment, Timing, ToolLimits};

use super::shapes::Hand;
use super::{Cell, ball, limits, one_in, part, small_pose, tool_limits};
use crate::draw::{self, Draw};

/// Draws one program of 1 to 4 segments.
#[must_use]
pub fn at_constant_speed(draw: &mut Draw, cell: &Cell<'_>) -> PathRequest {
    let spec = cell.spec;
    let tcp = one_in(draw, 4).then(|| small_pose(draw));
    let mut hand = Hand::new(spec, tcp.as_ref(), draw);
    let start = hand.joints().to_vec();
    let count = 1 + (draw.bits() % 4) as usize;
    let mut segments = Vec::with_capacity(count);
    let mut speed = draw.between(0.05, 0.3);
    for _ in 0..count {
        let dwell = match one_in(draw, 4) {
            true => draw.between(0.01, 0.3),
            false => 0.0,
        };
        segments.push(Segment {
            dwell,
            tool_speed: Some(speed),
            ..Segment::new(hand.tool_shape(draw))
        });
        // only after a stop may it be another
        if dwell > 0.0 {
            speed = draw.between(0.05, 0.3);
        }
    }
    let payload = ball(draw.between(0.0, cell.payload_max), draw::vector(draw, 0.05));
    PathRequest {
        payload: (!one_in(draw, 4)).then_some(payload),
        tcp,
        limits: limits(draw, cell),
        tool_limits: match one_in(draw, 2) {
            true => tool_limits(draw),
            false => ToolLimits::default(),
        },
        torque_utilization: part(draw, 0.6),
        speed_scale: part(draw, 0.2),
        acceleration_scale: part(draw, 0.2),
        jerk_scale: part(draw, 0.2),
        limit_jerk: cell.limit_jerk,
        timing: Timing::ConstantSpeed,
        transition_time: one_in(draw, 2).then(|| draw.between(0.02, 0.1)),
        tolerance: one_in(draw, 4).then(|| draw.between(1e-4, 5e-3)),
        sampling: cell.sampling,
        ..PathRequest::new(start, segments)
    }
}
