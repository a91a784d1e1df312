//! Student's distribution, and the noise of a residual: its tails, its scale, and the time over which it stays alike.
//!
//! A residual e beside a torque whose parameters leave the variance v is taken as Student-distributed with ν degrees of
//! freedom and the variance s² + v; ν and s are the likeliest ones. The correlation time is 1 + 2·Σ ρ(k) samples, up to the
//! first ρ(k) ≤ 0 (G. Priestley, "Spectral Analysis and Time Series", 1981, §5.3).

use std::f64::consts::PI;

use super::linear::dot;
use crate::budget::{Budget, Stopped};
use crate::quantile;
use crate::tolerance::{GOLDEN_STEPS, NOISE_SAMPLES_MAX, STUDENT_DEGREES, STUDENT_SCALE_RANGE};

/// Noise of one joint's torque.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Noise {
    /// Standard deviation, N m or N.
    pub(crate) deviation: f64,
    pub(crate) degrees_of_freedom: f64,
}

impl Noise {
    /// The likeliest noise of residuals beside given variances of the model. Of many samples it takes some, evenly: neighbours are
    /// alike.
    pub(crate) fn of(residuals: &[f64], variances: &[f64], budget: &Budget<'_>) -> Result<Self, Stopped> {
        let stride = residuals.len().div_ceil(NOISE_SAMPLES_MAX).max(1);
        let thin = |values: &[f64]| -> Vec<f64> { values.iter().copied().step_by(stride).collect() };
        let (residuals, variances) = (&thin(residuals)[..], &thin(variances)[..]);
        let mean_square = dot(residuals, residuals) / residuals.len().max(1) as f64;
        let rms = mean_square.sqrt();
        let mut best = (
            f64::NEG_INFINITY,
            Self {
                deviation: rms,
                degrees_of_freedom: STUDENT_DEGREES[STUDENT_DEGREES.len() - 1],
            },
        );
        if rms.is_nan() || rms <= 0.0 {
            return Ok(best.1);
        }
        for degrees in STUDENT_DEGREES {
            budget.check()?;
            let likelihood = |ln: f64| log_likelihood(residuals, variances, degrees, rms * libm::exp(ln));
            let (ln, value) = golden(&likelihood, -STUDENT_SCALE_RANGE, STUDENT_SCALE_RANGE);
            if value > best.0 {
                best = (
                    value,
                    Self {
                        deviation: rms * libm::exp(ln),
                        degrees_of_freedom: degrees,
                    },
                );
            }
        }
        Ok(best.1)
    }

    /// Half width, over the standard deviation, of the interval that holds a part `confidence`.
    pub(crate) fn unit(&self, confidence: f64) -> f64 {
        let degrees = self.degrees_of_freedom;
        quantile::student(degrees, 0.5 * (1.0 - confidence)) * ((degrees - 2.0) / degrees).sqrt()
    }
}

fn log_likelihood(residuals: &[f64], variances: &[f64], degrees: f64, deviation: f64) -> f64 {
    let to_scale = (degrees - 2.0) / degrees;
    let half = 0.5 * (degrees + 1.0);
    let constant = libm::lgamma(half) - libm::lgamma(0.5 * degrees) - 0.5 * libm::log(degrees * PI);
    let terms = residuals.iter().zip(variances).map(|(e, v)| {
        let square = (deviation * deviation + v) * to_scale;
        constant - 0.5 * libm::log(square) - half * libm::log1p(e * e / (degrees * square))
    });
    terms.sum()
}

/// Where a function that rises and then falls is greatest.
fn golden(f: &impl Fn(f64) -> f64, mut from: f64, mut to: f64) -> (f64, f64) {
    const PART: f64 = 0.618_033_988_749_894_9;
    let mut inner = [to - PART * (to - from), from + PART * (to - from)];
    let mut values = inner.map(f);
    for _ in 0..GOLDEN_STEPS / 2 {
        if values[0] > values[1] {
            to = inner[1];
            inner = [to - PART * (to - from), inner[0]];
            values = [f(inner[0]), values[0]];
        } else {
            from = inner[0];
            inner = [inner[1], from + PART * (to - from)];
            values = [values[1], f(inner[1])];
        }
    }
    if values[0] > values[1] {
        return (inner[0], values[0]);
    }
    (inner[1], values[1])
}

/// How many samples a residual stays alike.
pub(crate) fn correlated_samples(residual: &[f64], budget: &Budget<'_>) -> Result<f64, Stopped> {
    let count = residual.len();
    let mean = residual.iter().sum::<f64>() / count.max(1) as f64;
    let centred: Vec<f64> = residual.iter().map(|e| e - mean).collect();
    let whole = dot(&centred, &centred);
    if whole.is_nan() || whole <= 0.0 {
        return Ok(1.0);
    }
    let mut sum = 1.0;
    for lag in 1..count {
        budget.check()?;
        let correlation = dot(&centred[lag..], &centred[..count - lag]) / whole;
        if correlation <= 0.0 {
            break;
        }
        sum += 2.0 * correlation;
    }
    Ok(sum)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_arms::random;

    /// A normal deviate (G. Box, M. Muller).
    fn normal(state: &mut u64) -> f64 {
        let (u, v) = (0.5 * (random(state) + 1.0), random(state));
        (-2.0 * libm::log(u.max(1e-300))).sqrt() * libm::cos(PI * v)
    }

    #[test]
    fn the_scale_of_noise_is_found_beside_known_variances() {
        let state = &mut 5;
        let variances: Vec<f64> = (0..20_000).map(|k| if k % 2 == 0 { 0.0 } else { 0.09 }).collect();
        let residuals: Vec<f64> = variances.iter().map(|v| (0.04 + v).sqrt() * normal(state)).collect();
        let noise = Noise::of(&residuals, &variances, &Budget::unlimited()).unwrap();
        assert!((noise.deviation - 0.2).abs() < 0.01, "{noise:?}");
        assert!(noise.degrees_of_freedom >= 30.0);
    }

    #[test]
    fn heavy_tails_are_seen() {
        let state = &mut 6;
        // Student's with 4 degrees of freedom: a normal deviate over the root of a mean of four squares
        let residuals: Vec<f64> = (0..20_000)
            .map(|_| {
                let square: f64 = (0..4).map(|_| normal(state).powi(2)).sum();
                normal(state) / (square / 4.0).sqrt()
            })
            .collect();
        let noise = Noise::of(&residuals, &vec![0.0; residuals.len()], &Budget::unlimited()).unwrap();
        assert_eq!(noise.degrees_of_freedom, 4.0);
        let within = residuals
            .iter()
            .filter(|e| e.abs() < noise.unit(0.95) * noise.deviation)
            .count();
        assert!((within as f64 / 20_000.0 - 0.95).abs() < 0.01);
    }

    /// x(k) = ρ·x(k−1) + e has (1 + ρ)/(1 − ρ) correlated samples.
    #[test]
    fn the_correlation_of_a_first_order_process_is_its_closed_form() {
        let state = &mut 8;
        for rho in [0.0, 0.5, 0.9] {
            let mut x = 0.0;
            let series: Vec<f64> = (0..200_000)
                .map(|_| {
                    x = rho * x + normal(state);
                    x
                })
                .collect();
            let expected = (1.0 + rho) / (1.0 - rho);
            assert!(
                (correlated_samples(&series[..50_000], &Budget::unlimited()).unwrap() / expected - 1.0).abs() < 0.2,
                "{rho}"
            );
        }
    }
}
