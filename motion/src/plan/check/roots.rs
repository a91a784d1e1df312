//! Roots of polynomials up to the fifth degree in an interval.

use crate::trajectory::Polynomial;

/// Halvings of a bracket: they take any interval down to the spacing of numbers.
const BISECTIONS: usize = 80;

/// Coefficients of the derivative.
pub(super) fn derivative(p: &Polynomial) -> Polynomial {
    [p[1], 2.0 * p[2], 3.0 * p[3], 4.0 * p[4], 5.0 * p[5], 0.0]
}

fn value(p: &Polynomial, t: f64) -> f64 {
    p.iter().rev().fold(0.0, |sum, coefficient| sum * t + coefficient)
}

/// Where a polynomial changes its sign strictly within an interval, in order.
///
/// Between neighbouring extremes it is monotone, so that bisection finds every one; the extremes are the sign changes of
/// the derivative, found the same way.
pub(super) fn roots(p: &Polynomial, from: f64, to: f64) -> Vec<f64> {
    let Some(degree) = (0..p.len()).rev().find(|k| p[*k] != 0.0) else {
        return Vec::new();
    };
    if degree == 0 {
        return Vec::new();
    }
    let mut edges = vec![from];
    edges.extend(roots(&derivative(p), from, to));
    edges.push(to);
    edges
        .windows(2)
        .filter_map(|edge| sign_change(p, edge[0], edge[1]))
        .filter(|root| *root > from && *root < to)
        .collect()
}

fn sign_change(p: &Polynomial, from: f64, to: f64) -> Option<f64> {
    let (mut low, mut high) = (from, to);
    let rising = value(p, high) > 0.0;
    if (value(p, low) > 0.0) == rising {
        return None;
    }
    for _ in 0..BISECTIONS {
        let middle = 0.5 * (low + high);
        if (value(p, middle) > 0.0) == rising {
            high = middle;
        } else {
            low = middle;
        }
    }
    Some(0.5 * (low + high))
}

#[cfg(test)]
mod tests {
    use super::roots;

    #[test]
    fn every_sign_change_is_found() {
        // (t − 0.1)(t − 0.2)(t − 0.5)(t − 0.9)(t + 3)
        let mut p = [0.0; 6];
        p[0] = 1.0;
        for root in [0.1, 0.2, 0.5, 0.9, -3.0] {
            for k in (0..6).rev() {
                p[k] = if k > 0 { p[k - 1] } else { 0.0 } - root * p[k];
            }
        }
        let found = roots(&p, 0.0, 1.0);
        assert_eq!(found.len(), 4, "{found:?}");
        for (found, root) in found.iter().zip([0.1, 0.2, 0.5, 0.9]) {
            assert!((found - root).abs() < 1e-13, "{found} {root}");
        }
    }

    #[test]
    fn touching_zero_and_standing_on_it_are_no_sign_changes() {
        assert!(roots(&[0.25, -1.0, 1.0, 0.0, 0.0, 0.0], 0.0, 1.0).len() <= 2);
        assert!(roots(&[0.0; 6], 0.0, 1.0).is_empty());
        assert!(roots(&[2.0, 0.0, 0.0, 0.0, 0.0, 0.0], 0.0, 1.0).is_empty());
    }
}
