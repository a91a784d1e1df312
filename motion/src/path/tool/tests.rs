use nalgebra::UnitQuaternion;

use super::*;
use crate::test_arms::{random, values};

fn close(got: [f64; 4], expected: [f64; 4], part: f64) {
    for (k, (got, expected)) in got.into_iter().zip(expected).enumerate() {
        assert!(
            (got - expected).abs() < part * (1.0 + expected.abs()),
            "{k}: {got} {expected}"
        );
    }
}

/// Closed forms, where they lose no digits.
#[test]
fn series_agree_with_closed_forms() {
    for i in 1..20 {
        let phi = 0.3 + 0.065 * f64::from(i);
        let (sin, cos) = phi.sin_cos();
        let m = 2.0 * (1.0 - cos);
        // by m, with c = 1 − m/2
        let d1 = phi / sin;
        let d2 = (1.0 - phi * cos / sin) / (2.0 * sin * sin);
        let h = 1e-4;
        let curvature = |m: f64| half_angle_squared(m)[2];
        let d3 = (curvature(m + h) - curvature(m - h)) / (2.0 * h);
        close(half_angle_squared(m), [phi * phi, d1, d2, d3], 1e-7);
        let got = half_angle_squared(m);
        assert!((got[0] - phi * phi).abs() < 1e-14 && (got[1] - d1).abs() < 1e-13 && (got[2] - d2).abs() < 1e-12);
        let z = phi * phi;
        let s = sin / phi;
        let s1 = (cos - s) / (2.0 * z);
        let s2 = -(6.0 * s1 + s) / (4.0 * z);
        let s3 = -(10.0 * s2 + s1) / (4.0 * z);
        close(sinc_of_square(z), [s, s1, s2, s3], 1e-12);
    }
    close(half_angle_squared(0.0), [0.0, 1.0, 1.0 / 6.0, 1.0 / 15.0], 1e-15);
    close(sinc_of_square(0.0), [1.0, -1.0 / 6.0, 1.0 / 60.0, -1.0 / 840.0], 1e-15);
}

fn pose(state: &mut u64, reach: f64) -> ToolPoint {
    let axis = Vector3::from_iterator(values(3, 1.0, state)).normalize();
    let from = UnitQuaternion::from_scaled_axis(Vector3::from_iterator(values(3, reach, state)));
    let angle = Jet(<[f64; 4]>::try_from(values(4, reach, state)).unwrap());
    ToolPoint {
        position: [
            Jet::constant(1.0),
            Jet::variable(2.0, 1.0),
            Jet::constant(random(state)),
        ],
        turn: turned(&axis, angle, &from),
    }
}

/// The middle of two orientations, and their ends, as nalgebra has them.
#[test]
fn mixing_is_the_shortest_rotation() {
    let state = &mut 8;
    for _ in 0..200 {
        let (one, other) = (pose(state, 0.6), pose(state, 0.6));
        for w in [0.0, 0.25, 0.5, 1.0] {
            let (_, got) = one.mixed(&other, Jet::constant(w)).value();
            let unit = |pose: &ToolPoint| UnitQuaternion::new_normalize(pose.value().1);
            let (a, b) = (unit(&one), unit(&other));
            let expected = a * UnitQuaternion::from_scaled_axis((a.inverse() * b).scaled_axis() * w);
            assert!(UnitQuaternion::new_unchecked(got).angle_to(&expected) < 1e-7);
            assert!((got.norm() - 1.0).abs() < 1e-14);
            let error = (got.coords - expected.coords)
                .norm()
                .min((got.coords + expected.coords).norm());
            assert!(error < 1e-13, "{error}");
        }
    }
}

fn after(jet: Jet, h: f64) -> Jet {
    let [c0, c1, c2, c3] = jet.0;
    Jet([
        c0 + h * (c1 + h * (c2 + h * c3)),
        c1 + h * (2.0 * c2 + 3.0 * h * c3),
        c2 + 3.0 * h * c3,
        c3,
    ])
}

/// Derivatives of a mix, and of ω, as differences along the motion; both ends turn about one axis each.
#[test]
fn derivatives_of_a_mix_are_those_of_its_value() {
    let state = &mut 21;
    let h = 1e-4;
    for reach in [1e-9, 1e-3, 0.5] {
        let axes = [0, 1].map(|_| Vector3::from_iterator(values(3, 1.0, state)).normalize());
        let angles = [0, 1].map(|_| Jet(<[f64; 4]>::try_from(values(4, reach, state)).unwrap()));
        let w = Jet([0.4, 0.8, -0.3, 0.2]);
        let at = |s: f64| {
            let ends = [0, 1].map(|i| ToolPoint {
                position: [Jet::constant(0.0); 3],
                turn: turned(&axes[i], after(angles[i], s), &Quaternion::identity()),
            });
            ends[0].mixed(&ends[1], after(w, s))
        };
        let (low, point, high) = (at(-h), at(0.0), at(h));
        for i in 0..4 {
            let (low, got, high) = (
                low.turn[i].derivatives(),
                point.turn[i].derivatives(),
                high.turn[i].derivatives(),
            );
            for k in 0..3 {
                let slope = (high[k] - low[k]) / (2.0 * h);
                assert!(
                    (slope - got[k + 1]).abs() < 1e-6 * (reach + got[k + 1].abs()) + 1e-11,
                    "{k} {reach}"
                );
            }
        }
        let (low, got, high) = (low.rates().angular, point.rates().angular, high.rates().angular);
        for k in 0..2 {
            let slope = (high[k] - low[k]) / (2.0 * h);
            assert!((slope - got[k + 1]).norm() < 1e-6 * (reach + slope.norm()) + 1e-11);
        }
    }
}
