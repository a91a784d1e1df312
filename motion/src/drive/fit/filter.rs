//! A low-pass filter without delay, and the derivative that goes with it.
//!
//! Butterworth of the fourth order as two sections by the bilinear transform, run forwards and backwards, so that phase
//! cancels and the gain is |H|² = 1/(1 + (tan(π·f·T)/tan(π·f_c·T))⁸) for samples T apart and a corner f_c (A. Oppenheim,
//! R. Schafer, "Discrete-Time Signal Processing", §7.1). At its ends the signal is continued by its point reflection.

use std::f64::consts::PI;

use crate::tolerance::FILTER_PAD_PERIODS;

/// One section of the second order, transposed direct form II.
#[derive(Debug, Clone, Copy)]
struct Section {
    b: [f64; 3],
    a: [f64; 2],
}

/// A zero-phase low-pass for evenly spaced samples.
#[derive(Debug, Clone)]
pub(crate) struct LowPass {
    sections: [Section; 2],
    pad: usize,
}

impl LowPass {
    /// A filter with its corner at `corner` Hz for samples `period` s apart; the corner is below half the sampling rate.
    pub(crate) fn new(corner: f64, period: f64) -> Self {
        let c = libm::tan(PI * corner * period);
        let section = |k: f64| {
            let damping = 2.0 * libm::sin(PI * (2.0 * k + 1.0) / 8.0);
            let norm = 1.0 / (1.0 + damping * c + c * c);
            Section {
                b: [c * c * norm, 2.0 * c * c * norm, c * c * norm],
                a: [2.0 * (c * c - 1.0) * norm, (1.0 - damping * c + c * c) * norm],
            }
        };
        Self {
            sections: [section(0.0), section(1.0)],
            pad: (FILTER_PAD_PERIODS / (corner * period)) as usize,
        }
    }

    /// Filters a signal in place.
    pub(crate) fn apply(&self, signal: &mut [f64]) {
        let count = signal.len();
        let (Some(&first), Some(&last)) = (signal.first(), signal.last()) else {
            return;
        };
        let pad = self.pad.min(count - 1);
        let mut padded = Vec::with_capacity(count + 2 * pad);
        padded.extend((1..=pad).rev().map(|k| 2.0 * first - signal[k]));
        padded.extend_from_slice(signal);
        padded.extend((1..=pad).map(|k| 2.0 * last - signal[count - 1 - k]));
        for section in &self.sections {
            section.run(padded.iter_mut());
        }
        for section in &self.sections {
            section.run(padded.iter_mut().rev());
        }
        signal.copy_from_slice(&padded[pad..pad + count]);
    }
}

impl Section {
    fn run<'a>(&self, signal: impl Iterator<Item = &'a mut f64>) {
        let mut state: Option<[f64; 2]> = None;
        for x in signal {
            // as if the first value had been there for ever: the gain at rest is 1
            let [z1, z2] = state.unwrap_or_else(|| {
                let z2 = (self.b[2] - self.a[1]) * *x;
                [(self.b[1] - self.a[0]) * *x + z2, z2]
            });
            let y = self.b[0] * *x + z1;
            state = Some([self.b[1] * *x - self.a[0] * y + z2, self.b[2] * *x - self.a[1] * y]);
            *x = y;
        }
    }
}

/// Derivative of evenly spaced samples by central differences of the fourth order, of lower order at the ends.
pub(crate) fn derivative(signal: &[f64], period: f64) -> Vec<f64> {
    let last = signal.len().saturating_sub(1);
    let at = |i: usize| {
        if last == 0 {
            return 0.0;
        }
        if i == 0 {
            return signal[1] - signal[0];
        }
        if i == last {
            return signal[last] - signal[last - 1];
        }
        if i == 1 || i + 1 == last {
            return 0.5 * (signal[i + 1] - signal[i - 1]);
        }
        (8.0 * (signal[i + 1] - signal[i - 1]) - (signal[i + 2] - signal[i - 2])) / 12.0
    };
    (0..signal.len()).map(|i| at(i) / period).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sine(frequency: f64, period: f64, count: usize) -> Vec<f64> {
        (0..count)
            .map(|k| libm::sin(2.0 * PI * frequency * period * k as f64 + 0.3))
            .collect()
    }

    #[test]
    fn a_sine_keeps_its_phase_and_loses_what_the_formula_says() {
        let period = 0.008;
        let filter = LowPass::new(5.0, period);
        for frequency in [0.5, 3.0, 5.0, 8.0, 20.0] {
            let input = sine(frequency, period, 2000);
            let mut output = input.clone();
            filter.apply(&mut output);
            let ratio = libm::tan(PI * frequency * period) / libm::tan(PI * 5.0 * period);
            let gain = 1.0 / (1.0 + ratio.powi(8));
            for k in 500..1500 {
                assert!((output[k] - gain * input[k]).abs() < 1e-9, "{frequency} Hz");
            }
        }
    }

    #[test]
    fn a_line_passes_unchanged() {
        let line: Vec<f64> = (0..300).map(|k| 2.0 - 0.01 * f64::from(k)).collect();
        let mut output = line.clone();
        LowPass::new(5.0, 0.01).apply(&mut output);
        for (x, y) in line.iter().zip(&output) {
            // 1e-4 of what a line rises in the filter's delay
            assert!((x - y).abs() < 2e-5);
        }
    }

    /// By `scipy.signal.sosfiltfilt(butter(4, 5, fs=125, output='sos'), x, padlen=100)` of SciPy 1.17.1.
    #[test]
    fn agrees_with_another_implementation() {
        let mut signal: Vec<f64> = (0..200).map(|k| if k < 100 { 0.0 } else { 1.0 }).collect();
        LowPass::new(5.0, 0.008).apply(&mut signal);
        for (k, value) in STEP {
            assert!((signal[k] - value).abs() < 1e-9, "{k}: {} {value}", signal[k]);
        }
    }

    const STEP: [(usize, f64); 5] = [
        (80, -0.007636047677993062),
        (95, 0.16111716849442034),
        (99, 0.45900424077248897),
        (104, 0.8388828318356704),
        (120, 0.9988807465739569),
    ];

    #[test]
    fn the_derivative_of_a_sine_is_true_to_the_fourth_order() {
        let period = 0.01;
        let found = derivative(&sine(2.0, period, 200), period);
        let omega = 2.0 * PI * 2.0;
        for (k, found) in found.iter().enumerate().take(190).skip(10) {
            let exact = omega * libm::cos(omega * period * k as f64 + 0.3);
            assert!((found - exact).abs() < omega * (omega * period).powi(4) / 29.0);
        }
    }
}
