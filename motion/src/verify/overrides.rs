//! Slower is not always safer: viscous friction may help to hold a load, and a stopped drive holds it without any.
//!
//! At an override λ a torque is λ²·d + λ·f + c, so its extremes over λ in (0, 1] are at 1, at the start c, and at the
//! vertex −f/2d; held still, it is gravity alone.

use super::Point;
use super::extreme::Context;
use crate::dynamics::sweep::Sweep;
use crate::plan::outcome::OverrideSafety;

/// Points between samples that are looked at around the worst one, either side.
const LOCAL_POINTS: usize = 16;

/// A torque at an override, over its limit.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Worst {
    pub(crate) ratio: f64,
    scale: f64,
    torque: f64,
    pub(crate) point: Point,
}

impl Worst {
    /// What it says of the motion, given the joint's torque limit.
    pub(crate) fn safety(&self, limit: f64) -> OverrideSafety {
        OverrideSafety {
            safe: self.ratio <= 1.0,
            worst_override: self.scale,
            joint: self.point.joint,
            torque: self.torque,
            limit,
            time: self.point.time,
        }
    }
}

/// The override at which a motion's torque is tightest; `None` where no limit is known.
pub(super) fn worst(context: &Context<'_>, sweep: &mut Sweep, points: &[Point]) -> Option<OverrideSafety> {
    let limit = |joint: usize| context.limits[joint].unwrap_or(f64::INFINITY);
    let mut worst = tightest(points.iter(), &limit)?;
    if worst.scale < 1.0 {
        let near = around(context, sweep, &worst.point, points);
        if let Some(local) = tightest(near.iter(), &limit)
            && local.ratio > worst.ratio
        {
            worst = local;
        }
    }
    Some(worst.safety(limit(worst.point.joint)))
}

/// The tightest torque at any override; `limit` is infinite where none is known.
pub(crate) fn tightest<'a>(points: impl Iterator<Item = &'a Point>, limit: &dyn Fn(usize) -> f64) -> Option<Worst> {
    let mut worst: Option<Worst> = None;
    for point in points {
        let limit = limit(point.joint);
        let mut consider = |scale: f64, torque: f64| {
            let ratio = torque.abs() / limit;
            if worst.as_ref().is_none_or(|known| ratio > known.ratio) {
                worst = Some(Worst {
                    ratio,
                    scale,
                    torque,
                    point: *point,
                });
            }
        };
        consider(1.0, point.torque(1.0));
        // creeping, and held still
        consider(0.0, point.still);
        consider(0.0, point.gravity);
        if point.viscous != 0.0 {
            let vertex = -0.5 * point.viscous / point.dynamic;
            if vertex > 0.0 && vertex < 1.0 {
                consider(vertex, point.torque(vertex));
            }
        }
    }
    worst
}

/// Points of the same joint between a sample and its neighbours.
fn around(context: &Context<'_>, sweep: &mut Sweep, worst: &Point, points: &[Point]) -> Vec<Point> {
    let times = || points.iter().filter(|p| p.joint == worst.joint).map(|p| p.time);
    let before = times()
        .filter(|t| *t < worst.time)
        .fold(worst.time, |n: f64, t| if n == worst.time { t } else { n.max(t) });
    let after = times()
        .filter(|t| *t > worst.time)
        .fold(worst.time, |n: f64, t| if n == worst.time { t } else { n.min(t) });
    let moments: Vec<(f64, (usize, f64))> = [before, after]
        .into_iter()
        .flat_map(|end| {
            (1..LOCAL_POINTS).map(move |k| worst.time + (end - worst.time) * k as f64 / LOCAL_POINTS as f64)
        })
        .map(|time| (time, context.locate(time)))
        .collect();
    let located: Vec<(usize, f64)> = moments.iter().map(|(_, at)| *at).collect();
    context.compute_at(sweep, &located);
    moments
        .iter()
        .enumerate()
        .map(|(sample, (time, (segment, _)))| context.point(sweep, sample, *segment, worst.joint, *time))
        .collect()
}
