//! What lies between set-points, by differences of their positions.
//!
//! The n-th difference over steps of h, divided by hⁿ, is a mean of the n-th derivative over n steps, with a weight that
//! is nowhere negative. So it keeps the derivative's limit; over several segments, the loosest of theirs. An error e of
//! every position shows in it as up to 2ⁿ e/hⁿ; where that were more than a part of the bar, the difference is formed
//! over as many steps at once as it takes.
//!
//! Tool: the way between two points is no longer than the path, so |Δp|/h ≤ mean of |ṗ|; and |Δ²p|/h² ≤ mean of |p̈|.

use nalgebra::Vector3;
use takt_motion::path::outcome::PathLimit;

use super::Case;
use super::bounds::{JointBounds, SegmentBounds};
use super::report::{Extremes, PathReport, Source, limit_of, tool_limit_of};
use super::samples::State;
use crate::arm::Workspace;
use crate::tolerance;

const ORDERS: [(usize, PathLimit); 3] = [
    (1, PathLimit::Velocity),
    (2, PathLimit::Acceleration),
    (3, PathLimit::Jerk),
];

pub(super) fn check(case: &Case<'_>, workspace: &mut Workspace, report: &mut PathReport) {
    if case.samples.len() < 2 {
        return;
    }
    let mut extremes = Extremes::new(Source::Differences, case.samples.joints().len());
    for (joint, columns) in case.samples.joints().iter().enumerate() {
        let size = columns.position.iter().fold(1.0, |most: f64, q| most.max(q.abs()));
        for (order, kind) in ORDERS {
            let of_segment = |bounds: &SegmentBounds| limit_of(&bounds.joints[joint], kind);
            let Some(window) = Window::of(case, order, size, kind, of_segment) else {
                continue;
            };
            for from in 0..case.samples.len() - window.width() {
                let Some(limit) = window.limit(case, from, of_segment) else {
                    continue;
                };
                let value = window.quotient(&columns.position, from);
                let bounds = only(kind, limit);
                let reduced = value.signum() * (value.abs() - window.rounding).max(0.0);
                extremes.joint(kind, joint, reduced, &bounds, window.time(case, from));
            }
        }
    }
    tool(case, workspace, &mut extremes);
    report.extremes.extend(extremes.found());
}

fn tool(case: &Case<'_>, workspace: &mut Workspace, extremes: &mut Extremes) {
    let bounds_tool = |bounds: &SegmentBounds| bounds.tool_velocity.is_some() || bounds.tool_acceleration.is_some();
    if !case.bounds.iter().any(bounds_tool) {
        return;
    }
    let mut state = State::default();
    let path: Vec<Vector3<f64>> = (0..case.samples.len())
        .map(|index| {
            case.samples.state(index, &mut state);
            case.arm
                .tool_motion(workspace, &case.tool, &state.q, &state.qd, &state.qdd)
                .position
        })
        .collect();
    let size = path.iter().fold(1.0, |most: f64, point| most.max(point.amax()));
    for (order, kind) in [(1, PathLimit::ToolVelocity), (2, PathLimit::ToolAcceleration)] {
        let of_segment = |bounds: &SegmentBounds| tool_limit_of(bounds, kind);
        let Some(window) = Window::of(case, order, size, kind, of_segment) else {
            continue;
        };
        for from in 0..case.samples.len() - window.width() {
            let Some(limit) = window.limit(case, from, of_segment) else {
                continue;
            };
            let value = window.vector_quotient(&path, from).norm();
            let bounds = SegmentBounds {
                tool_velocity: Some(limit),
                tool_acceleration: Some(limit),
                ..SegmentBounds::default()
            };
            extremes.tool(
                kind,
                (value - window.rounding).max(0.0),
                &bounds,
                window.time(case, from),
            );
        }
    }
}

/// Differences of one order over one stride.
#[derive(Debug, Clone, Copy)]
struct Window {
    order: usize,
    /// Set-points from one to the next of a difference.
    stride: usize,
    /// The time of a stride, s.
    step: f64,
    /// What rounding may make of it.
    rounding: f64,
}

impl Window {
    /// The shortest stride at which rounding is small against the bar; `None` where nothing bounds, or the path is too
    /// short.
    fn of(
        case: &Case<'_>,
        order: usize,
        size: f64,
        kind: PathLimit,
        limit: impl Fn(&SegmentBounds) -> Option<f64>,
    ) -> Option<Self> {
        let tightest = case.bounds.iter().filter_map(limit).reduce(f64::min)?;
        let allowed = tolerance::ROUNDING_SHARE * tolerance::path_excess(kind) * tightest;
        let error = tolerance::POSITION_ROUNDING * size;
        let mut stride = 1;
        while order * stride < case.samples.len() {
            let step = case.samples.step() * stride as f64;
            let rounding = error * (2.0 / step).powi(order as i32);
            if rounding <= allowed {
                return Some(Self {
                    order,
                    stride,
                    step,
                    rounding,
                });
            }
            stride *= 2;
        }
        None
    }

    /// Set-points from the first to the last of a difference.
    fn width(&self) -> usize {
        self.order * self.stride
    }

    /// The loosest limit of the segments that a difference spans; `None` where one of them has none.
    fn limit(&self, case: &Case<'_>, from: usize, of: impl Fn(&SegmentBounds) -> Option<f64>) -> Option<f64> {
        let spanned = case.samples.segments(from, from + self.width());
        spanned
            .map(|segment| of(&case.bounds[segment]))
            .try_fold(0.0, |loosest: f64, limit| limit.map(|limit| loosest.max(limit)))
    }

    fn time(&self, case: &Case<'_>, from: usize) -> f64 {
        let times = case.samples.times();
        0.5 * (times[from] + times[from + self.width()])
    }

    fn quotient(&self, values: &[f64], from: usize) -> f64 {
        let at = |index: usize| values[from + index * self.stride];
        let difference = match self.order {
            1 => at(1) - at(0),
            2 => (at(2) - at(1)) - (at(1) - at(0)),
            _ => ((at(3) - at(2)) - (at(2) - at(1))) - ((at(2) - at(1)) - (at(1) - at(0))),
        };
        difference / self.step.powi(self.order as i32)
    }

    fn vector_quotient(&self, points: &[Vector3<f64>], from: usize) -> Vector3<f64> {
        let at = |index: usize| points[from + index * self.stride];
        let difference = match self.order {
            1 => at(1) - at(0),
            _ => (at(2) - at(1)) - (at(1) - at(0)),
        };
        difference / self.step.powi(self.order as i32)
    }
}

/// Bounds of one kind alone.
fn only(kind: PathLimit, limit: f64) -> JointBounds {
    let limit = Some(limit);
    match kind {
        PathLimit::Velocity => JointBounds {
            velocity: limit,
            ..JointBounds::default()
        },
        PathLimit::Acceleration => JointBounds {
            acceleration: limit,
            ..JointBounds::default()
        },
        _ => JointBounds {
            jerk: limit,
            ..JointBounds::default()
        },
    }
}
