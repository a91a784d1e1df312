//! What a blend does to the tool's path: how far it leaves the two segments, how far it stays from their corner.

use nalgebra::Vector3;

use super::arm::Arm;
use super::corner::Mix;
use super::extent::Corner;
use super::outcome::{BlendReport, Location};
use super::track::{Joints, Track};
use crate::curve::Side;
use crate::tolerance::DEVIATION_SAMPLES;

/// The report of a blend. Its distances are of samples, true to about a thousandth of the blend's size.
pub(super) fn of_blend(arm: &Arm, first: &Track, second: &Track, corner: &Corner, mix: &Mix) -> BlendReport {
    let mut before = samples(first.length - corner.before, corner.before, |u| {
        first.tool_position(arm, u)
    });
    let point = first.tool_position(arm, first.length);
    before.extend(samples(0.0, corner.after, |u| second.tool_position(arm, u)));
    let length = mix.passage().length();
    let mut q = Joints::default();
    let blended = samples(0.0, length, |s| {
        mix.joints(arm, first, second, s, Side::After, &mut q);
        arm.position(&q[..arm.joint_count()])
    });
    let deviation = blended.iter().map(|p| distance(&before, p)).fold(0.0, f64::max);
    BlendReport {
        segment: first.segment,
        begin: Location {
            segment: first.segment,
            fraction: 1.0 - corner.before / first.length,
        },
        end: Location {
            segment: second.segment,
            fraction: corner.after / second.length,
        },
        begin_time: 0.0,
        end_time: 0.0,
        deviation,
        corner_distance: distance(&blended, &point),
        shrunk: corner.shrunk.clone(),
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
