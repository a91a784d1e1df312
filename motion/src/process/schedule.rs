//! How fast and with which transitions: the constant speed Vs, and the reach D of every transition.
//!
//! ```text
//! D = min(Vs·ta, cap)             ta asked for; the cap from a tolerance or from what may be used of the segments
//! D₋ + D₊ ≤ L                     every segment holds the transitions at its two ends
//! n = ⌈(L/Vs − ta₀ − ta₁)/Δt⌉     Vs = L/(n·Δt + ta₀ + ta₁)
//! ```
//!
//! with L the length of the whole chain, ta₀ and ta₁ half of what its first and last transitions take: a chain has one
//! speed, whose one value cannot make every stretch between its transitions whole at once. Without ta it is chosen by
//! acceleration: the ramp from rest has its peak at ¾·Vs/ta; every transition takes at least that ta where tolerance
//! and length allow, and longer where it must be gentler.

use super::ProcessRequest;
use super::geometry::Segment;
use super::measure::{reach_gentle, reach_within, sharpest};
use super::search::largest_that;
use super::transition::Node;
use crate::budget::{Budget, Stopped};
use crate::path::request::Transition;
use crate::tolerance::{CYCLE_SLACK, GENTLE_ROUNDS, RATE_RESERVE, TRANSITION_ACCELERATION, TRANSITION_TIME_LEAST};

/// What was settled.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Schedule {
    /// Vs, m/s.
    pub(super) speed: f64,
    /// D of every transition, m: one more than there are segments.
    pub(super) reaches: Vec<f64>,
    /// Why Vs is lower than asked for.
    pub(super) lowered: Vec<String>,
}

/// What bounds the reach of one transition.
#[derive(Debug, Clone, Copy)]
struct Bound {
    /// ta, s; infinite where the cap alone decides.
    half_time: f64,
    /// m; infinite where there is none.
    cap: f64,
}

impl Bound {
    fn reach(&self, speed: f64) -> f64 {
        (speed * self.half_time).min(self.cap)
    }
}

/// The nodes of a chain: its start, its seams, its end.
pub(super) fn nodes(segments: &[Segment]) -> Vec<Node<'_>> {
    let seams = segments.windows(2).map(|pair| Node::Seam(&pair[0], &pair[1]));
    let start = segments.first().map(Node::Start);
    let end = segments.last().map(Node::End);
    start.into_iter().chain(seams).chain(end).collect()
}

pub(super) fn schedule(
    request: &ProcessRequest<'_>,
    segments: &[Segment],
    budget: &Budget<'_>,
) -> Result<Schedule, Stopped> {
    let nodes = nodes(segments);
    let mut bounds = Vec::with_capacity(nodes.len());
    for (index, node) in nodes.iter().enumerate() {
        budget.check()?;
        bounds.push(bound(request, node, index));
    }
    let mut settled = Settled {
        speed: request.speed,
        lowered: Vec::new(),
    };
    for (index, segment) in segments.iter().enumerate() {
        let most = holding_both(segment.length, bounds[index], bounds[index + 1]);
        settled.lower(most, || {
            format!("segment {index} must hold the transitions at its two ends")
        });
    }
    if let Some(limit) = request.acceleration {
        let most = gentle_enough(request.form, limit, settled.speed, &nodes, &bounds, budget)?;
        settled.lower(most, || "the limit of the tool's acceleration".to_owned());
    }
    if request.slow_down < 1.0 {
        for bound in &mut bounds {
            *bound = Bound {
                half_time: f64::INFINITY,
                cap: bound.reach(settled.speed),
            };
        }
        let most = settled.speed * request.slow_down;
        settled.lower(most, || "slowed down".to_owned());
    }
    let last = bounds.len() - 1;
    for end in [0, last] {
        let reach = bounds[end].reach(settled.speed);
        bounds[end] = Bound {
            half_time: reach / settled.speed,
            cap: f64::INFINITY,
        };
    }
    if let Some(cycle) = request.cycle_time {
        let length: f64 = segments.iter().map(|segment| segment.length).sum();
        let most = whole_cycles(
            length,
            settled.speed,
            bounds[0].half_time + bounds[last].half_time,
            cycle,
        );
        settled.lower(most, || "whole cycles".to_owned());
    }
    Ok(Schedule {
        speed: settled.speed,
        reaches: bounds.iter().map(|bound| bound.reach(settled.speed)).collect(),
        lowered: settled.lowered,
    })
}

struct Settled {
    speed: f64,
    lowered: Vec<String>,
}

impl Settled {
    fn lower(&mut self, most: f64, reason: impl FnOnce() -> String) {
        if most < self.speed {
            self.speed = most;
            self.lowered.push(reason());
        }
    }
}

/// What bounds one transition, at the speed asked for.
fn bound(request: &ProcessRequest<'_>, node: &Node<'_>, index: usize) -> Bound {
    let form = request.form;
    let mut cap = f64::INFINITY;
    if let (Node::Seam(..), Some(reach)) = (
        node,
        index
            .checked_sub(1)
            .and_then(|seam| request.seam_reach.get(seam).copied().flatten()),
    ) {
        cap = reach;
    }
    if let Some(tolerance) = request.tolerance {
        let tolerance = tolerance * (1.0 - RATE_RESERVE);
        cap = cap.min(reach_within(node, form, tolerance, node.room()));
    }
    if let Some(half_time) = request.transition_time {
        return Bound { half_time, cap };
    }
    // half of each segment at most, so that its other half is left to its other end
    let most = cap.min(0.5 * node.room());
    let limit = request.acceleration.unwrap_or(TRANSITION_ACCELERATION) * (1.0 - RATE_RESERVE);
    let square = request.speed * request.speed;
    let least = (0.75 * square / limit).max(request.speed * TRANSITION_TIME_LEAST);
    let reach = reach_gentle(node, form, limit / square, least, most);
    if let Node::Seam(..) = node {
        return Bound {
            half_time: f64::INFINITY,
            cap: reach,
        };
    }
    let half_time = reach / request.speed;
    let half_time = match request.cycle_time {
        // the whole transition takes whole cycles, so that the stretch after it begins on one
        Some(cycle) => 0.5 * cycle * (2.0 * half_time / cycle - CYCLE_SLACK).ceil().max(1.0),
        None => half_time,
    };
    Bound { half_time, cap }
}

/// The largest speed at which a segment of this length holds the transitions at both of its ends. Their sum is the
/// least of four lines in the speed: the root is the largest of theirs.
fn holding_both(length: f64, a: Bound, b: Bound) -> f64 {
    if a.cap + b.cap <= length {
        return f64::INFINITY;
    }
    let both = length / (a.half_time + b.half_time);
    // NaN, of an infinite cap beside an infinite time, is passed over by max
    both.max((length - a.cap) / b.half_time)
        .max((length - b.cap) / a.half_time)
}

/// The largest speed, up to `speed`, at which no acceleration exceeds the limit.
fn gentle_enough(
    form: Transition,
    limit: f64,
    speed: f64,
    nodes: &[Node<'_>],
    bounds: &[Bound],
    budget: &Budget<'_>,
) -> Result<f64, Stopped> {
    let limit = limit * (1.0 - RATE_RESERVE);
    let mut most = speed;
    // a second round only confirms, unless a shorter reach has made an earlier transition sharper
    for _ in 0..GENTLE_ROUNDS {
        let before = most;
        for (node, bound) in nodes.iter().zip(bounds) {
            budget.check()?;
            let holds = |speed: f64| {
                let square = speed * speed;
                square * node.taught_curvature() <= limit && square * sharpest(node, form, bound.reach(speed)) <= limit
            };
            most = largest_that(most, holds);
        }
        if most == before {
            break;
        }
    }
    Ok(most)
}

/// The largest speed, up to `speed`, at which the time between the first transition and the last is whole cycles.
fn whole_cycles(length: f64, speed: f64, transitions: f64, cycle: f64) -> f64 {
    let between = (length / speed - transitions) / cycle;
    let cycles = (between - CYCLE_SLACK).ceil().max(0.0);
    speed.min(length / (cycles * cycle + transitions))
}
