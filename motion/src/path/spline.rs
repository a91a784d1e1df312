//! Splines through points, or near control points, as piecewise polynomials.
//!
//! - Quintic: through the points at given knots, q‴ and q⁗ continuous at them and 0 at both ends: of all such curves the one
//!   with the least ∫|q‴|² (the natural spline of order 3; de Boor 2001, chapter XIII). Unknown are q′ and q″ at the knots.
//! - Cubic: the natural spline: q″ continuous, 0 at both ends. Unknown is q′.
//! - B-spline: quintic with even knots, clamped at both ends; with fewer than six points, one polynomial.
//! - Bézier: one polynomial of one degree less than there are points.

use super::band::Band;
use super::piecewise::Piecewise;
use super::request::SplineKind;

/// Degree of a B-spline: the third derivative is continuous, and the fourth.
const DEGREE: usize = 5;

/// A spline over points; `distances` are those between neighbours, all positive. Its parameter runs over their sum.
pub(super) fn spline(kind: SplineKind, points: &[Vec<f64>], distances: &[f64]) -> Piecewise {
    if let [start, end] = points {
        return Piecewise::straight(start, end).stretched(distances[0]);
    }
    match kind {
        SplineKind::Quintic => quintic(points, distances),
        SplineKind::Cubic => cubic(points, distances),
        SplineKind::BSpline if points.len() > DEGREE => b_spline(points),
        SplineKind::BSpline | SplineKind::Bezier => bezier(points),
    }
}

fn knots(distances: &[f64]) -> Vec<f64> {
    let mut end = 0.0;
    let sums = distances.iter().map(|distance| {
        end += distance;
        end
    });
    std::iter::once(0.0).chain(sums).collect()
}

/// Third and fourth derivative of the quintic Hermite polynomial over a stretch of length h at its start, in the
/// difference Δ of its values, the slopes d and the curvatures e at both ends: Δ/h³, d₀/h², d₁/h², e₀/h, e₁/h and so on.
const THIRD: [f64; 5] = [60.0, -36.0, -24.0, -9.0, 3.0];
const FOURTH: [f64; 5] = [-360.0, 192.0, 168.0, 36.0, -24.0];

fn quintic(points: &[Vec<f64>], distances: &[f64]) -> Piecewise {
    let (count, dimension) = (points.len(), points[0].len());
    // unknowns 2k and 2k + 1: slope and curvature at knot k; rows 2k and 2k + 1: q‴ and q⁗ are the same on both sides
    let mut band = Band::new(2 * count, 3, dimension);
    for (piece, h) in distances.iter().enumerate() {
        for (order, [delta, d0, d1, e0, e1]) in [THIRD, FOURTH].into_iter().enumerate() {
            let scale = if order == 0 { h * h * h } else { (h * h) * (h * h) };
            let [d0, d1, e0, e1] = [d0 * h, d1 * h, e0 * h * h, e1 * h * h];
            // right minus left: this piece's start counts at its first knot, its end, negative, at its last. Seen from
            // there values, slopes and odd derivatives have the other sign
            let sign = if order == 0 { -1.0 } else { 1.0 };
            let (start, end) = (2 * piece, 2 * piece + 2);
            let entries = [
                (start + order, [d0, e0, d1, e1], delta),
                (
                    end + order,
                    [sign * d1, -sign * e1, sign * d0, -sign * e0],
                    sign * delta,
                ),
            ];
            for (row, coefficients, delta) in entries {
                for (offset, coefficient) in coefficients.into_iter().enumerate() {
                    band.add(row, start + offset, coefficient / scale);
                }
                for (side, (from, to)) in points[piece].iter().zip(&points[piece + 1]).enumerate() {
                    band.add_right(row, side, -delta * (to - from) / scale);
                }
            }
        }
    }
    let solved = band.solve();
    let mut coefficients = Vec::with_capacity(6 * dimension * distances.len());
    for (piece, h) in distances.iter().enumerate() {
        for side in 0..dimension {
            let at = |row: usize| solved[row * dimension + side];
            let (d0, e0) = (at(2 * piece) * h, at(2 * piece + 1) * h * h);
            let (d1, e1) = (at(2 * piece + 2) * h, at(2 * piece + 3) * h * h);
            let start = points[piece][side];
            let delta = points[piece + 1][side] - start;
            let h2 = h * h;
            coefficients.extend([
                start,
                d0 / h,
                0.5 * e0 / h2,
                (10.0 * delta - 6.0 * d0 - 4.0 * d1 - 1.5 * e0 + 0.5 * e1) / (h2 * h),
                (-15.0 * delta + 8.0 * d0 + 7.0 * d1 + 1.5 * e0 - e1) / (h2 * h2),
                (6.0 * delta - 3.0 * d0 - 3.0 * d1 - 0.5 * e0 + 0.5 * e1) / (h2 * h2 * h),
            ]);
        }
    }
    Piecewise::new(knots(distances), dimension, 5, coefficients)
}

fn cubic(points: &[Vec<f64>], distances: &[f64]) -> Piecewise {
    let (count, dimension) = (points.len(), points[0].len());
    let mut band = Band::new(count, 1, dimension);
    for (piece, h) in distances.iter().enumerate() {
        // q″ at the start is (6Δ − 4d₀h − 2d₁h)/h², at the end (−6Δ + 2d₀h + 4d₁h)/h²
        for (row, own, other) in [(piece, piece, piece + 1), (piece + 1, piece + 1, piece)] {
            band.add(row, own, 4.0 / h);
            band.add(row, other, 2.0 / h);
            for (side, (from, to)) in points[piece].iter().zip(&points[piece + 1]).enumerate() {
                band.add_right(row, side, 6.0 * (to - from) / (h * h));
            }
        }
    }
    let solved = band.solve();
    let mut coefficients = Vec::with_capacity(4 * dimension * distances.len());
    for (piece, h) in distances.iter().enumerate() {
        for side in 0..dimension {
            let (d0, d1) = (solved[piece * dimension + side], solved[(piece + 1) * dimension + side]);
            let start = points[piece][side];
            let slope = (points[piece + 1][side] - start) / h;
            coefficients.extend([
                start,
                d0,
                (3.0 * slope - 2.0 * d0 - d1) / h,
                (d0 + d1 - 2.0 * slope) / (h * h),
            ]);
        }
    }
    Piecewise::new(knots(distances), dimension, 3, coefficients)
}

/// One polynomial: coefficient k is C(n, k)·Δᵏ of the control points (de Casteljau's differences).
fn bezier(points: &[Vec<f64>]) -> Piecewise {
    let (degree, dimension) = (points.len() - 1, points[0].len());
    let mut coefficients = vec![0.0; dimension * (degree + 1)];
    for side in 0..dimension {
        let mut differences: Vec<f64> = points.iter().map(|point| point[side]).collect();
        let mut binomial = 1.0;
        for k in 0..=degree {
            coefficients[side * (degree + 1) + k] = binomial * differences[0];
            binomial *= (degree - k) as f64 / (k + 1) as f64;
            for i in 0..degree - k {
                differences[i] = differences[i + 1] - differences[i];
            }
        }
    }
    Piecewise::new(vec![0.0, 1.0], dimension, degree, coefficients)
}

/// A quintic B-spline with knots one apart, sixfold at both ends.
fn b_spline(points: &[Vec<f64>]) -> Piecewise {
    let (count, dimension) = (points.len(), points[0].len());
    let pieces = count - DEGREE;
    let knot = |i: usize| i.clamp(DEGREE, count) as f64 - DEGREE as f64;
    let mut coefficients = Vec::with_capacity(6 * dimension * pieces);
    for piece in 0..pieces {
        for side in 0..dimension {
            // control points of the k-th derivative that matter on this piece, and its value where the piece begins
            let mut control: Vec<f64> = points[piece..=piece + DEGREE].iter().map(|point| point[side]).collect();
            let mut factorial = 1.0;
            for order in 0..=DEGREE {
                let degree = DEGREE - order;
                coefficients.push(de_boor(&control, piece + order, degree, piece as f64, knot) / factorial);
                factorial *= (order + 1) as f64;
                for i in 0..degree {
                    let first = piece + order + i + 1;
                    let span = knot(first + degree) - knot(first);
                    control[i] = (control[i + 1] - control[i]) * degree as f64 / span;
                }
                control.truncate(degree);
            }
        }
    }
    let knots = (0..=pieces).map(|i| i as f64).collect();
    Piecewise::new(knots, dimension, DEGREE, coefficients)
}

/// The value at t of a B-spline (de Boor 1972); `first` is the index of its first control point, whose basis function
/// begins at that knot.
fn de_boor(control: &[f64], first: usize, degree: usize, t: f64, knot: impl Fn(usize) -> f64) -> f64 {
    let mut points = control.to_vec();
    for level in 1..=degree {
        for i in (level..=degree).rev() {
            let (low, high) = (knot(first + i), knot(first + i + degree + 1 - level));
            let part = (t - low) / (high - low);
            points[i] = points[i - 1] + part * (points[i] - points[i - 1]);
        }
    }
    points[degree]
}

#[cfg(test)]
mod tests;
