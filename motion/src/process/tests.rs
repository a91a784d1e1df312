//! The source's claims, chains of every kind, and what is refused or lowered.

mod chains;
mod figures;
mod limits;
mod refusals;
mod source;

use std::f64::consts::PI;

use nalgebra::{Rotation3, Unit, Vector3};

use super::*;
use crate::curve::Side;
use crate::jet::Jet;
use crate::test_arms::random;

fn asked<'a>(segments: &'a [ProcessSegment], speed: f64, half_time: f64) -> ProcessRequest<'a> {
    ProcessRequest {
        segments,
        speed,
        transition_time: Some(half_time),
        tolerance: None,
        seam_reach: &[],
        acceleration: None,
        slow_down: 1.0,
        cycle_time: None,
        form: Transition::Smooth,
    }
}

fn run(request: &ProcessRequest<'_>) -> (ConstantSpeedMotion, ConstantSpeedReport) {
    constant_speed(request, &Budget::unlimited()).unwrap()
}

fn refusals(request: &ProcessRequest<'_>) -> Vec<String> {
    match constant_speed(request, &Budget::unlimited()) {
        Err(Failure::Invalid(wrong)) => wrong.iter().map(Invalid::to_string).collect(),
        other => panic!("{other:?}"),
    }
}

/// Position, velocity, acceleration and jerk.
fn state(motion: &ConstantSpeedMotion, time: f64, side: Side) -> [Vector3<f64>; 4] {
    let [x, y, z] = motion.evaluate(time, side).position.map(Jet::derivatives);
    [0, 1, 2, 3].map(|order| Vector3::new(x[order], y[order], z[order]))
}

fn line(from: [f64; 3], to: [f64; 3]) -> ProcessSegment {
    ProcessSegment::Line {
        from: from.into(),
        to: to.into(),
    }
}

/// Two lines of half a metre; the second turns away from the first by so many degrees.
fn corner(degrees: f64) -> [ProcessSegment; 2] {
    let (sin, cos) = degrees.to_radians().sin_cos();
    [
        line([-0.5, 0.0, 0.2], [0.0, 0.0, 0.2]),
        line([0.0, 0.0, 0.2], [0.5 * cos, 0.5 * sin, 0.2]),
    ]
}

/// An arc about the z axis from (r, 0, 0).
fn arc(radius: f64, angle: f64) -> ProcessSegment {
    ProcessSegment::Arc {
        center: Vector3::zeros(),
        normal: Vector3::z(),
        start: Vector3::new(radius, 0.0, 0.0),
        angle,
    }
}

/// A line that meets the arc above at a tangent.
fn line_into_arc(radius: f64, angle: f64) -> [ProcessSegment; 2] {
    [line([radius, -0.4, 0.0], [radius, 0.0, 0.0]), arc(radius, angle)]
}

fn vector(state: &mut u64) -> Vector3<f64> {
    Vector3::new(random(state), random(state), random(state))
}

/// Lines and arcs of 0.1 to 3 m; half of the seams are tangential, the others turn by up to 2 rad.
fn random_chain(count: usize, state: &mut u64) -> Vec<ProcessSegment> {
    let mut here = vector(state);
    let mut tangent = vector(state).normalize();
    (0..count)
        .map(|_| {
            let axis = Unit::new_normalize(tangent.cross(&vector(state)));
            if random(state) > 0.0 {
                tangent = Rotation3::from_axis_angle(&axis, 2.0 * random(state)) * tangent;
            }
            let from = here;
            if random(state) > 0.0 {
                here += tangent * (0.3 + 0.2 * random(state));
                return ProcessSegment::Line { from, to: here };
            }
            let normal = tangent.cross(&vector(state)).normalize();
            let radius = 0.3 + 0.2 * random(state);
            let angle = 3.5 + (2.0 * PI - 3.5) * random(state);
            let center = here + normal.cross(&tangent) * radius;
            let turn = Rotation3::from_axis_angle(&Unit::new_normalize(normal), angle);
            here = center + turn * (here - center);
            tangent = turn * tangent;
            ProcessSegment::Arc {
                center,
                normal,
                start: from,
                angle,
            }
        })
        .collect()
}
