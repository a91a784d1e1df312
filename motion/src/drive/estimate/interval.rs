//! Quantiles of Student's distribution.

/// The 97.5 % point of the normal distribution.
const NORMAL: f64 = 1.959_963_984_540_054;

/// The 97.5 % point of Student's distribution, for 3 degrees of freedom and more: half the width of a 95 % interval in
/// standard errors (Cornish and Fisher's expansion, Abramowitz and Stegun 26.7.5; true to 4e-3 at 3 degrees, 2e-5 from 8 on).
pub(super) fn half_width(degrees_of_freedom: f64) -> f64 {
    let z = NORMAL;
    let n = degrees_of_freedom.max(3.0);
    let square = z * z;
    let terms = [
        z * (square + 1.0) / 4.0,
        z * ((5.0 * square + 16.0) * square + 3.0) / 96.0,
        z * (((3.0 * square + 19.0) * square + 17.0) * square - 15.0) / 384.0,
        z * ((((79.0 * square + 776.0) * square + 1482.0) * square - 1920.0) * square - 945.0) / 92_160.0,
    ];
    z + terms.iter().rev().fold(0.0, |sum, term| (sum + term) / n)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Percentage points of the t-distribution, NIST/SEMATECH e-Handbook of Statistical Methods, 1.3.6.7.2.
    #[test]
    fn it_is_the_tables() {
        for (n, expected) in [
            (3.0, 3.182),
            (5.0, 2.571),
            (8.0, 2.306),
            (10.0, 2.228),
            (30.0, 2.042),
            (100.0, 1.984),
        ] {
            let actual = half_width(n);
            assert!((actual - expected).abs() < 6e-3, "{n}: {actual}");
            if n >= 8.0 {
                assert!((actual - expected).abs() < 6e-4, "{n}: {actual}");
            }
        }
        assert!((half_width(f64::INFINITY) - NORMAL).abs() < 1e-15);
    }
}
