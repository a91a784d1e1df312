//! Piecewise polynomials of several coordinates: on each piece Σₖ cₖ·(u − uᵢ)ᵏ.

use crate::curve::Side;
use crate::jet::Jet;
use crate::tolerance::KNOT_ROUNDING;

/// Several coordinates as functions of u from the first knot to the last.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Piecewise {
    /// Strictly increasing, ends included.
    knots: Vec<f64>,
    dimension: usize,
    /// Coefficients of one coordinate on one piece: one more than the degree.
    stride: usize,
    /// By piece, coordinate, power.
    coefficients: Vec<f64>,
}

impl Piecewise {
    /// From coefficients by piece, coordinate, power.
    pub(super) fn new(knots: Vec<f64>, dimension: usize, degree: usize, coefficients: Vec<f64>) -> Self {
        debug_assert_eq!(coefficients.len(), (knots.len() - 1) * dimension * (degree + 1));
        Self {
            knots,
            dimension,
            stride: degree + 1,
            coefficients,
        }
    }

    /// Straight from one point to another while u runs from 0 to 1.
    pub(super) fn straight(start: &[f64], end: &[f64]) -> Self {
        let coefficients = start.iter().zip(end).flat_map(|(start, end)| [*start, end - start]);
        Self::new(vec![0.0, 1.0], start.len(), 1, coefficients.collect())
    }

    /// Whether it is of the first degree.
    pub(super) fn is_straight(&self) -> bool {
        self.stride == 2
    }

    pub(super) fn knots(&self) -> &[f64] {
        &self.knots
    }

    /// Where u ends.
    pub(super) fn length(&self) -> f64 {
        self.knots[self.knots.len() - 1]
    }

    /// The same curve with u stretched to end elsewhere.
    pub(super) fn stretched(mut self, length: f64) -> Self {
        let factor = length / self.length();
        for knot in &mut self.knots {
            *knot *= factor;
        }
        if let Some(last) = self.knots.last_mut() {
            *last = length;
        }
        for powers in self.coefficients.chunks_exact_mut(self.stride) {
            let mut scale = 1.0;
            for coefficient in powers {
                *coefficient *= scale;
                scale /= factor;
            }
        }
        self
    }

    /// All coordinates at u, a function of some parameter; at a knot, those of one side.
    pub(super) fn at(&self, u: Jet, side: Side, values: &mut [Jet]) {
        let piece = piece_at(&self.knots, u.value(), side);
        let t = u.value() - self.knots[piece];
        let size = self.dimension * self.stride;
        let coefficients = &self.coefficients[piece * size..(piece + 1) * size];
        for (value, powers) in values.iter_mut().zip(coefficients.chunks_exact(self.stride)) {
            *value = if let [start, slope] = powers {
                Jet([start + slope * t, slope * u.0[1], slope * u.0[2], slope * u.0[3]])
            } else {
                u.compose(derivatives(powers, t))
            };
        }
    }
}

/// Value and three derivatives of a polynomial, by Horner's scheme.
fn derivatives(powers: &[f64], t: f64) -> [f64; 4] {
    let [mut p, mut p1, mut p2, mut p3] = [0.0; 4];
    for coefficient in powers.iter().rev() {
        p3 = p3 * t + p2;
        p2 = p2 * t + p1;
        p1 = p1 * t + p;
        p = p * t + coefficient;
    }
    [p, p1, 2.0 * p2, 6.0 * p3]
}

/// Which piece between `knots` holds `u`; at a knot, and within rounding of it, that of one side.
pub(super) fn piece_at(knots: &[f64], u: f64, side: Side) -> usize {
    let inner = &knots[1..knots.len() - 1];
    let rounding = KNOT_ROUNDING * knots[knots.len() - 1];
    match side {
        Side::After => inner.partition_point(|knot| *knot <= u + rounding),
        Side::Before => inner.partition_point(|knot| *knot < u - rounding),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn derivatives_of_a_known_polynomial() {
        // 1 + 2t − t² + 4t³ + t⁵
        let t: f64 = 0.3;
        let got = derivatives(&[1.0, 2.0, -1.0, 4.0, 0.0, 1.0], t);
        let expected = [
            1.0 + 2.0 * t - t * t + 4.0 * t.powi(3) + t.powi(5),
            2.0 - 2.0 * t + 12.0 * t * t + 5.0 * t.powi(4),
            -2.0 + 24.0 * t + 20.0 * t.powi(3),
            24.0 + 60.0 * t * t,
        ];
        for (got, expected) in got.into_iter().zip(expected) {
            assert!((got - expected).abs() < 1e-14 * expected.abs());
        }
    }

    #[test]
    fn stretching_keeps_the_shape() {
        let curve = Piecewise::new(
            vec![0.0, 1.0, 3.0],
            1,
            3,
            vec![0.0, 1.0, 2.0, 3.0, 6.0, 14.0, 11.0, -1.0],
        );
        let stretched = curve.clone().stretched(0.6);
        let (mut one, mut other) = ([Jet::default()], [Jet::default()]);
        for i in 0..=60 {
            let u = f64::from(i) / 20.0;
            curve.at(Jet::variable(u, 5.0), Side::After, &mut one);
            stretched.at(Jet::variable(u / 5.0, 1.0), Side::After, &mut other);
            for k in 0..4 {
                assert!((one[0].0[k] - other[0].0[k]).abs() < 1e-11 * (1.0 + one[0].0[k].abs()));
            }
        }
    }

    #[test]
    fn sides_of_a_knot() {
        let knots = [0.0, 1.0, 2.0];
        assert_eq!(piece_at(&knots, 1.0, Side::Before), 0);
        assert_eq!(piece_at(&knots, 1.0, Side::After), 1);
        assert_eq!(piece_at(&knots, 0.0, Side::Before), 0);
        assert_eq!(piece_at(&knots, 2.0, Side::After), 1);
        assert_eq!(piece_at(&knots, 9.0, Side::After), 1);
    }
}
