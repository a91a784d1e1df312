use super::*;
use crate::curve::Side;
use crate::jet::Jet;
use crate::test_arms::{random, values};

fn at(curve: &Piecewise, u: f64, side: Side, dimension: usize) -> Vec<[f64; 4]> {
    let mut q = vec![Jet::default(); dimension];
    curve.at(Jet::variable(u, 1.0), side, &mut q);
    q.into_iter().map(Jet::derivatives).collect()
}

fn random_points(count: usize, state: &mut u64) -> (Vec<Vec<f64>>, Vec<f64>) {
    let points: Vec<Vec<f64>> = (0..count).map(|_| values(3, 1.0, state)).collect();
    let distances = points.windows(2).map(|_| 0.2 + 0.8 * random(state).abs()).collect();
    (points, distances)
}

#[test]
fn interpolating_splines_meet_their_points_smoothly() {
    let state = &mut 1;
    for count in [3, 4, 7, 40] {
        for (kind, order) in [(SplineKind::Quintic, 3), (SplineKind::Cubic, 2)] {
            let (points, distances) = random_points(count, state);
            let curve = spline(kind, &points, &distances);
            for (k, knot) in curve.knots().iter().enumerate() {
                let (before, after) = (at(&curve, *knot, Side::Before, 3), at(&curve, *knot, Side::After, 3));
                for side in 0..3 {
                    assert!((after[side][0] - points[k][side]).abs() < 1e-11 || k + 1 == count);
                    assert!((before[side][0] - points[k][side]).abs() < 1e-11 || k == 0);
                    if k == 0 || k + 1 == count {
                        // natural ends: q″ of a cubic, q‴ of a quintic
                        let end = if k == 0 { after[side] } else { before[side] };
                        assert!(end[order].abs() < 1e-8, "{} {kind:?}", end[order]);
                        continue;
                    }
                    for derivative in 0..=order {
                        let (one, other) = (before[side][derivative], after[side][derivative]);
                        assert!((one - other).abs() < 1e-9 * (1.0 + one.abs()), "{kind:?} {derivative}");
                    }
                }
            }
        }
    }
}

/// The fourth derivative too, from third derivatives on both sides of a knot.
#[test]
fn the_fourth_derivative_of_a_quintic_is_continuous() {
    let state = &mut 3;
    let (points, distances) = random_points(8, state);
    for curve in [
        spline(SplineKind::Quintic, &points, &distances),
        spline(SplineKind::BSpline, &points, &distances),
    ] {
        let h = 1e-5;
        let inner = &curve.knots()[1..curve.knots().len() - 1];
        for knot in inner {
            let third = |u: f64| at(&curve, u, Side::After, 3)[0][3];
            // one-sided, second order
            let left = (3.0 * third(*knot - 1e-12) - 4.0 * third(knot - h) + third(knot - 2.0 * h)) / (2.0 * h);
            let right = (-3.0 * third(*knot) + 4.0 * third(knot + h) - third(knot + 2.0 * h)) / (2.0 * h);
            assert!((left - right).abs() < 1e-4 * (100.0 + left.abs()), "{left} {right}");
        }
    }
}

/// Polynomials that are natural splines themselves are given back.
#[test]
fn a_parabola_stays_a_parabola() {
    let distances = [0.3, 1.0, 0.2, 0.7];
    let mut u = 0.0;
    let f = |u: f64| 1.0 - u + 2.0 * u * u;
    let points: Vec<Vec<f64>> = std::iter::once(vec![f(0.0)])
        .chain(distances.iter().map(|distance| {
            u += distance;
            vec![f(u)]
        }))
        .collect();
    let curve = spline(SplineKind::Quintic, &points, &distances);
    for i in 0..=44 {
        let u = 0.05 * f64::from(i);
        let got = at(&curve, u, Side::After, 1)[0];
        for (got, expected) in got.into_iter().zip([f(u), -1.0 + 4.0 * u, 4.0, 0.0]) {
            assert!((got - expected).abs() < 1e-9, "{u}: {got} {expected}");
        }
    }
}

/// scipy 1.17.1: CubicSpline(bc_type="natural"), and make_interp_spline(k=5) with third and fourth derivatives 0 at both
/// ends, over knots 0, 1, 1.5, 3, 4 and values 0, 2, 1, -1, 0.5; at u = 0.4, 1.2, 2.9.
#[test]
fn agrees_with_scipy() {
    let points: Vec<Vec<f64>> = [0.0, 2.0, 1.0, -1.0, 0.5].map(|v| vec![v]).into();
    let distances = [1.0, 0.5, 1.5, 1.0];
    for (kind, expected) in [(SplineKind::Cubic, SCIPY_CUBIC), (SplineKind::Quintic, SCIPY_QUINTIC)] {
        let curve = spline(kind, &points, &distances);
        for (u, expected) in [0.4, 1.2, 2.9].into_iter().zip(expected) {
            let got = at(&curve, u, Side::After, 1)[0];
            for (got, expected) in got.into_iter().zip(expected) {
                assert!(
                    (got - expected).abs() < 1e-9 * (1.0 + expected.abs()),
                    "{kind:?} {u}: {got} {expected}"
                );
            }
        }
    }
}

/// scipy 1.17.1: BSpline with knots 0 six times, 1, 2, 3 six times, and control points 0, 2, 1, -1, 0.5, 1.5, 1, 0.
#[test]
fn b_splines_agree_with_scipy() {
    let points: Vec<Vec<f64>> = [0.0, 2.0, 1.0, -1.0, 0.5, 1.5, 1.0, 0.0].map(|v| vec![v]).into();
    let curve = spline(SplineKind::BSpline, &points, &[1.0; 7]);
    assert_eq!(curve.knots(), [0.0, 1.0, 2.0, 3.0]);
    for (u, expected) in [0.4, 1.2, 2.9].into_iter().zip(SCIPY_B_SPLINE) {
        let got = at(&curve, u, Side::After, 1)[0];
        for (got, expected) in got.into_iter().zip(expected) {
            assert!(
                (got - expected).abs() < 1e-10 * (1.0 + expected.abs()),
                "{u}: {got} {expected}"
            );
        }
    }
}

/// By Bernstein's polynomials.
#[test]
fn bezier_curves_are_sums_of_bernstein_polynomials() {
    let state = &mut 9;
    for count in [3, 4, 6, 11] {
        let points: Vec<Vec<f64>> = (0..count).map(|_| values(1, 1.0, state)).collect();
        let distances = vec![1.0; count - 1];
        let curve = spline(SplineKind::Bezier, &points, &distances);
        for i in 0..=10 {
            let u = 0.1 * f64::from(i);
            let degree = count - 1;
            let mut binomial = 1.0;
            let mut expected = 0.0;
            for (k, point) in points.iter().enumerate() {
                expected += binomial * u.powi(k as i32) * (1.0 - u).powi((degree - k) as i32) * point[0];
                binomial *= (degree - k) as f64 / (k + 1) as f64;
            }
            let got = at(&curve, u, Side::After, 1)[0][0];
            assert!((got - expected).abs() < 1e-11);
        }
    }
}

const SCIPY_CUBIC: [[f64; 4]; 3] = [
    [
        1.2558076923076924,
        2.7054166666666664,
        -3.2557692307692307,
        -8.139423076923077,
    ],
    [
        1.718519230769231,
        -1.981987179487179,
        -4.549038461538464,
        17.951923076923062,
    ],
    [
        -1.0295438034188031,
        0.14312500000000017,
        2.994871794871795,
        1.5416666666666656,
    ],
];
const SCIPY_QUINTIC: [[f64; 4]; 3] = [
    [
        1.622304992421961,
        2.6193283372581164,
        -7.089643247975481,
        1.1565933876055638,
    ],
    [
        1.6857706975251665,
        -1.9465928873398206,
        -3.170845070654315,
        9.04845699277742,
    ],
    [
        -1.029072929006692,
        0.17335143340952502,
        2.3695462227466226,
        -0.6714902818438111,
    ],
];
const SCIPY_B_SPLINE: [[f64; 4]; 3] = [
    [
        1.2879170370370374,
        -0.9365925925925931,
        -10.388148148148147,
        59.422222222222224,
    ],
    [
        0.09926999999999997,
        -0.3582500000000002,
        4.034999999999999,
        -1.4749999999999979,
    ],
    [
        0.42941674768518545,
        -3.6308721064814797,
        -12.447060185185183,
        -23.629861111111108,
    ],
];
