//! Comparisons of numbers.

/// Entries smaller than this are as good as none: the floor that the oracle files use.
const SMALLEST: f64 = 1e-6;

/// Largest difference of two lists over the largest entry of the expected one.
#[must_use]
pub fn relative_difference(actual: &[f64], expected: &[f64]) -> f64 {
    assert_eq!(actual.len(), expected.len(), "{actual:?} and {expected:?}");
    let largest = expected.iter().fold(SMALLEST, |most, value| most.max(value.abs()));
    let pairs = actual.iter().zip(expected);
    let differences = pairs.map(|(actual, expected)| (actual - expected).abs() / largest);
    // A NaN must not be lost in a maximum.
    differences.fold(0.0, |most, one| if one > most || one.is_nan() { one } else { most })
}

/// Asserts that two lists agree.
pub fn assert_close(what: &str, actual: &[f64], expected: &[f64], tolerance: f64) {
    let difference = relative_difference(actual, expected);
    assert!(
        difference <= tolerance,
        "{what}: off by {difference:e}\n{actual:?}\n{expected:?}"
    );
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn differences_are_relative_and_nan_is_one() {
        assert_eq!(relative_difference(&[1.0, 11.0], &[1.0, 10.0]), 0.1);
        assert_eq!(relative_difference(&[0.0], &[0.0]), 0.0);
        assert!(relative_difference(&[f64::NAN, 1.0], &[1.0, 1.0]).is_nan());
        assert!(relative_difference(&[1.0, f64::NAN], &[1.0, 1.0]).is_nan());
    }
}
