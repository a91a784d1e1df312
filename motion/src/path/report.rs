//! What a blend does to the tool's path: how far it leaves the two segments, how far it stays from their corner.

use nalgebra::Vector3;

use super::corner::{Corner, Mix};
use super::outcome::{BlendReport, Location};
use super::pace::golden;
use super::passage::Passage;
use super::track::{Joints, Track};
use crate::curve::Side;
use crate::tolerance::{DEVIATION_ROUNDS, DEVIATION_SAMPLES};

/// The report of a blend. Its distances are of samples, true to about a thousandth of the blend's size.
pub(super) fn of_blend(corner: Corner<'_>, mix: &Mix, shrunk: Option<String>) -> BlendReport {
    let Corner { arm, first, second } = corner;
    let Passage { before, after } = mix.passage();
    let mut taught = samples(first.length - before, before, |u| first.tool_position(arm, u));
    let point = first.tool_position(arm, first.length);
    taught.extend(samples(0.0, after, |u| second.tool_position(arm, u)));
    let length = mix.passage().length();
    let mut q = Joints::default();
    let mut blended = |s: f64| {
        mix.joints(corner, s, Side::After, &mut q);
        arm.position(&q[..arm.joint_count()])
    };
    let line = samples(0.0, length, &mut blended);
    let mut depth = |s: f64| -distance(&taught, &blended(s));
    let step = length / DEVIATION_SAMPLES as f64;
    let depths: Vec<f64> = line.iter().map(|point| distance(&taught, point)).collect();
    let deepest = (0..depths.len()).max_by(|a, b| depths[*a].total_cmp(&depths[*b]));
    let around = step * deepest.unwrap_or(0) as f64;
    let (low, high) = ((around - step).max(0.0), (around + step).min(length));
    let deviation = -golden(&mut depth, low, high, DEVIATION_ROUNDS).0;
    BlendReport {
        segment: first.segment,
        begin: Location {
            segment: first.segment,
            fraction: 1.0 - before / first.length,
        },
        end: Location {
            segment: second.segment,
            fraction: after / second.length,
        },
        begin_time: 0.0,
        end_time: 0.0,
        deviation,
        corner_distance: distance(&line, &point),
        shrunk,
    }
}

/// The report of a corner that is not blended after all: an exact stop.
pub(super) fn of_stop(first: &Track, second: &Track, why: String) -> BlendReport {
    BlendReport {
        segment: first.segment,
        begin: Location {
            segment: first.segment,
            fraction: 1.0,
        },
        end: Location {
            segment: second.segment,
            fraction: 0.0,
        },
        begin_time: 0.0,
        end_time: 0.0,
        deviation: 0.0,
        corner_distance: 0.0,
        shrunk: Some(why),
    }
}

fn samples(from: f64, length: f64, mut at: impl FnMut(f64) -> Vector3<f64>) -> Vec<Vector3<f64>> {
    let steps = DEVIATION_SAMPLES;
    (0..=steps)
        .map(|i| at(from + length * i as f64 / steps as f64))
        .collect()
}

/// Distance of a point from a polyline.
fn distance(line: &[Vector3<f64>], point: &Vector3<f64>) -> f64 {
    line.windows(2)
        .map(|ends| {
            let (chord, to) = (ends[1] - ends[0], point - ends[0]);
            let square = chord.norm_squared();
            let part = if square > 0.0 {
                (to.dot(&chord) / square).clamp(0.0, 1.0)
            } else {
                0.0
            };
            (to - chord * part).norm()
        })
        .fold(f64::INFINITY, f64::min)
}
