//! Random programs at constant tool speed: lines and arcs, now and then a stop within them.

use takt_motion::path::request::{OnExcess, PathRequest, Segment, Timing, ToolLimits, Transition};

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
            shape: hand.tool_shape(draw),
            blend: None,
            dwell,
            limits: Vec::new(),
            tool_limits: ToolLimits::default(),
            tool_speed: Some(speed),
        });
        // only after a stop may it be another
        if dwell > 0.0 {
            speed = draw.between(0.05, 0.3);
        }
    }
    let payload = ball(draw.between(0.0, cell.payload_max), draw::vector(draw, 0.05));
    PathRequest {
        start,
        segments,
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
        on_excess: OnExcess::SlowDown,
        transition: Transition::Smooth,
        transition_time: one_in(draw, 2).then(|| draw.between(0.02, 0.1)),
        tolerance: one_in(draw, 4).then(|| draw.between(1e-4, 5e-3)),
        start_speed: None,
        end_speed: None,
        sampling: cell.sampling,
    }
}
