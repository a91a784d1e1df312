//! How far each blend reaches: from what the caller says, a radius, a part or a length, to the overlap in s.
//!
//! The helper point of a segment (P12, P21 of the patent) is where its part of the overlap ends: for a radius, the point
//! nearest to the corner along the segment whose distance from the corner is the radius. A segment that is blended at both
//! of its ends is shared: a blend has what the other one leaves, and at least half.

use super::arm::Arm;
use super::request::{Blend, Extent};
use super::track::Track;
use crate::budget::{Budget, Stopped};
use crate::tolerance::{BISECTIONS, HELPER_SAMPLES, PIECE_SAMPLES, SEAM_ROUNDING};

/// One corner to be blended.
#[derive(Debug, Clone)]
pub(super) struct Reach {
    pub(super) blend: Blend,
    /// What of the track before takes part, in its parameter.
    pub(super) before: f64,
    /// What of the track after.
    pub(super) after: f64,
    /// Why it is shorter than asked for.
    pub(super) shrunk: Option<String>,
}

/// One end of a track, as a corner sees it.
#[derive(Debug, Clone, Copy)]
struct Leg<'a> {
    track: &'a Track,
    at_end: bool,
}

/// Finds the extents of all corners; `corners[i]` is between tracks i and i + 1, `None` an exact stop.
pub(super) fn settle(
    arm: &Arm,
    tracks: &[Track],
    blends: &[Option<Blend>],
    budget: &Budget<'_>,
) -> Result<Vec<Option<Reach>>, Stopped> {
    let mut corners: Vec<Option<Reach>> = Vec::with_capacity(blends.len());
    for (blend, tracks) in blends.iter().zip(tracks.windows(2)) {
        budget.check()?;
        corners.push(blend.map(|blend| wanted(arm, &tracks[0], &tracks[1], blend)));
    }
    for (index, track) in tracks.iter().enumerate() {
        share(track, &mut corners, index);
    }
    for (corner, tracks) in corners.iter_mut().zip(tracks.windows(2)) {
        if let Some(corner) = corner {
            budget.check()?;
            even_out(arm, &tracks[0], &tracks[1], corner);
        }
    }
    for (index, track) in tracks.iter().enumerate().skip(1) {
        let entering = corners[index - 1].as_ref().map_or(0.0, |corner| corner.after);
        if let Some(Some(corner)) = corners.get_mut(index)
            && track.length - entering - corner.before <= SEAM_ROUNDING * track.length
        {
            // the two blends meet: no sliver of the segment is left between them
            corner.before = track.length - entering;
        }
    }
    Ok(corners)
}

/// What a blend would have if it were alone.
fn wanted(arm: &Arm, first: &Track, second: &Track, blend: Blend) -> Reach {
    let sides = [end_of(first), start_of(second)];
    let reaches = match blend.extent {
        Extent::Radius(radius) => sides.map(|side| side.at_distance(arm, radius)),
        Extent::Fraction(part) => sides.map(|side| Some(part * side.track.length)),
        Extent::Lengths { before, after } => [sides[0].at_way(arm, before), sides[1].at_way(arm, after)],
    };
    let shrunk = sides.iter().zip(reaches).find_map(|(side, reach)| {
        let segment = side.track.segment;
        reach
            .is_none()
            .then(|| format!("segment {segment} is shorter than the blend's reach"))
    });
    Reach {
        blend,
        before: reaches[0].unwrap_or(first.length),
        after: reaches[1].unwrap_or(second.length),
        shrunk,
    }
}

/// Shares a track between the blends at its two ends.
fn share(track: &Track, corners: &mut [Option<Reach>], index: usize) {
    if index == 0 || index >= corners.len() {
        return;
    }
    let (left, right) = corners.split_at_mut(index);
    let (Some(Some(entering)), Some(Some(leaving))) = (left.last_mut(), right.first_mut()) else {
        return;
    };
    if entering.after + leaving.before <= track.length {
        return;
    }
    let half = 0.5 * track.length;
    let message = format!("the blends at both ends of segment {} meet on it", track.segment);
    let entering_was = entering.after;
    if entering.after > half {
        entering.after = (track.length - leaving.before).max(half);
        entering.shrunk.get_or_insert(message.clone());
    }
    if leaving.before > half {
        leaving.before = (track.length - entering_was).max(half);
        leaving.shrunk.get_or_insert(message);
    }
}

/// A radius that one side cut short is cut on both.
fn even_out(arm: &Arm, first: &Track, second: &Track, corner: &mut Reach) {
    let (Extent::Radius(radius), Some(shrunk)) = (corner.blend.extent, &mut corner.shrunk) else {
        return;
    };
    let sides = [end_of(first), start_of(second)];
    let left = sides[0]
        .distance(arm, corner.before)
        .min(sides[1].distance(arm, corner.after));
    let left = left.min(radius);
    if left > 0.0 {
        let reaches = sides.map(|side| side.at_distance(arm, left));
        corner.before = corner.before.min(reaches[0].unwrap_or(corner.before));
        corner.after = corner.after.min(reaches[1].unwrap_or(corner.after));
    }
    *shrunk = format!("{shrunk}: radius {radius} m became {left:.6} m");
}

fn end_of(track: &Track) -> Leg<'_> {
    Leg { track, at_end: true }
}

fn start_of(track: &Track) -> Leg<'_> {
    Leg { track, at_end: false }
}

impl Leg<'_> {
    /// The track's parameter at some distance in it from the corner.
    fn parameter(&self, reach: f64) -> f64 {
        if self.at_end { self.track.length - reach } else { reach }
    }

    /// How far the tool is from the corner, m.
    fn distance(&self, arm: &Arm, reach: f64) -> f64 {
        let corner = self.track.tool_position(arm, self.parameter(0.0));
        (self.track.tool_position(arm, self.parameter(reach)) - corner).norm()
    }

    /// Where the tool first is that far from the corner; `None`: nowhere on the track.
    fn at_distance(&self, arm: &Arm, radius: f64) -> Option<f64> {
        let samples = HELPER_SAMPLES.max(PIECE_SAMPLES * (self.track.knots.len() + 1));
        let step = self.track.length / samples as f64;
        let far = (1..=samples).find(|i| self.distance(arm, step * *i as f64) >= radius)?;
        let (low, high) = (step * (far - 1) as f64, step * far as f64);
        Some(bisect(low, high, |reach| self.distance(arm, reach) >= radius))
    }

    /// Where the way from the corner is that long, m; on a joint segment, that part of it. `None`: beyond the track.
    fn at_way(&self, arm: &Arm, way: f64) -> Option<f64> {
        let length = self.track.length;
        if self.track.by_part {
            return (way <= 1.0).then_some(way * length);
        }
        if way > self.track.tool_length {
            return None;
        }
        if self.track.is_uniform() {
            return Some(way / self.track.tool_length * length);
        }
        // from knot to knot, and then within one
        let knots = self.track.knots.iter();
        let mut reaches: Vec<f64> = knots.map(|knot| self.parameter(*knot)).chain([length]).collect();
        reaches.sort_by(f64::total_cmp);
        let (mut low, mut left) = (0.0, way);
        for high in reaches {
            let way_to = |reach: f64| self.track.tool_way(arm, self.parameter(low), self.parameter(reach));
            let piece = way_to(high);
            if piece >= left {
                return Some(bisect(low, high, |reach| way_to(reach) >= left));
            }
            (low, left) = (high, left - piece);
        }
        Some(length)
    }
}

/// Where a condition begins to hold.
fn bisect(mut low: f64, mut high: f64, holds: impl Fn(f64) -> bool) -> f64 {
    for _ in 0..BISECTIONS {
        let middle = 0.5 * (low + high);
        if holds(middle) {
            high = middle;
        } else {
            low = middle;
        }
    }
    high
}
