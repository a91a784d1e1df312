//! The low pass that all signals go through, so that positions can be differentiated twice:
//!
//! ```text
//! H(s) = (a/(s + a))³        x₀ = H·u, x₁ = s·H·u, x₂ = s²·H·u        a = 2π·bandwidth
//! ```
//!
//! x₁ and x₂ are the exact derivatives of x₀. Torques, positions and velocities go through the same H, so that a balance that
//! holds between the signals holds between the filtered ones wherever it is linear; all are late by 3/a at low frequencies. Where it
//! is not, the filter's memory (variance 3/a²) leaves about ½·g''(q)·q̇²·3/a²: for 80 N m of gravity torque at 1.8 rad/s and
//! 10 Hz 0.1 N m, a quarter of that at 20 Hz. Between
//! samples a signal is a straight line, and for that the step is exact, whatever its length: with r the line's slope,
//! the line itself, less the lag, solves the equation (x₀ = u − 3·r/a, x₁ = r, x₂ = 0), and what differs from it dies out as
//! exp(A·Δ) = exp(−a·Δ)·(I + (A + aI)·Δ + (A + aI)²·Δ²/2).

use std::f64::consts::TAU;

/// How a filter goes over one step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct FilterStep {
    /// exp(A·Δ), by columns.
    columns: [[f64; 3]; 3],
    /// 1/Δ and 3/a.
    rate: f64,
    lag: f64,
}

/// Value, first and second derivative of a filtered signal, and the signal.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Filter {
    pub(super) state: [f64; 3],
    pub(super) input: f64,
}

/// What a filter of a bandwidth in Hz is late by, s.
pub(super) fn delay(bandwidth: f64) -> f64 {
    3.0 / (TAU * bandwidth)
}

impl FilterStep {
    /// A step of so many seconds of a filter of so many Hz, both above 0.
    pub(super) fn new(bandwidth: f64, seconds: f64) -> Self {
        let a = TAU * bandwidth;
        let (t, kept) = (seconds, libm::exp(-a * seconds));
        // N = A + aI, and its square
        let n = [[a, 1.0, 0.0], [0.0, a, 1.0], [-a * a * a, -3.0 * a * a, -2.0 * a]];
        let square = [
            [a * a, 2.0 * a, 1.0],
            [-a * a * a, -2.0 * a * a, -a],
            [a * a * a * a, 2.0 * a * a * a, a * a],
        ];
        let mut columns = [[0.0; 3]; 3];
        for row in 0..3 {
            for column in 0..3 {
                let unit = if row == column { 1.0 } else { 0.0 };
                columns[column][row] = kept * (unit + n[row][column] * t + 0.5 * square[row][column] * t * t);
            }
        }
        Self {
            columns,
            rate: 1.0 / seconds,
            lag: 3.0 / a,
        }
    }
}

impl Filter {
    /// Begins as if the signal had been moving at a constant rate for ever.
    pub(super) fn reset(&mut self, input: f64, rate: f64, lag: f64) {
        *self = Self {
            state: [input - rate * lag, rate, 0.0],
            input,
        };
    }

    /// Takes in the signal's value a step after the last.
    #[inline(always)]
    pub(super) fn update(&mut self, step: &FilterStep, input: f64) {
        let slope = (input - self.input) * step.rate;
        let late = slope * step.lag;
        let off = [
            self.state[0] - (self.input - late),
            self.state[1] - slope,
            self.state[2],
        ];
        let [m0, m1, m2] = &step.columns;
        let line = [input - late, slope, 0.0];
        for row in 0..3 {
            self.state[row] = line[row] + (m0[row] * off[0] + m1[row] * off[1] + m2[row] * off[2]);
        }
        self.input = input;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_arms::random;

    /// exp(A·Δ) by the Taylor series of the companion matrix.
    #[test]
    fn the_step_is_the_exponential_of_the_companion_matrix() {
        for (bandwidth, seconds) in [(10.0, 0.001), (2.0, 0.05), (1.0, 0.2)] {
            let a = TAU * bandwidth;
            let companion =
                nalgebra::Matrix3::new(0.0, 1.0, 0.0, 0.0, 0.0, 1.0, -a * a * a, -3.0 * a * a, -3.0 * a) * seconds;
            let (mut sum, mut term) = (nalgebra::Matrix3::identity(), nalgebra::Matrix3::identity());
            for order in 1..60 {
                term = term * companion / f64::from(order);
                sum += term;
            }
            let step = FilterStep::new(bandwidth, seconds);
            for row in 0..3 {
                for column in 0..3 {
                    let (actual, expected): (f64, f64) = (step.columns[column][row], sum[(row, column)]);
                    let scale = libm::pow(a, row as f64 - column as f64);
                    assert!((actual - expected).abs() < 1e-12 * scale, "{row} {column}");
                }
            }
        }
    }

    /// |H| = 1/(1 + (f/f₀)²)^(3/2), and the derivatives are those of the value, with samples at any times.
    #[test]
    fn a_sine_comes_out_by_the_transfer_function() {
        let (bandwidth, frequency) = (5.0, 3.0);
        let state = &mut 4;
        let mut filter = Filter::default();
        let mut time = 0.0;
        let omega = TAU * frequency;
        let a = TAU * bandwidth;
        // 1/(1 + jω/a)³
        let (gain, phase) = (
            libm::pow(1.0 + (omega / a) * (omega / a), -1.5),
            -3.0 * libm::atan(omega / a),
        );
        for index in 0..60_000 {
            let seconds = 0.000_05 * (1.5 + random(state));
            time += seconds;
            filter.update(&FilterStep::new(bandwidth, seconds), libm::sin(omega * time));
            if index < 20_000 {
                continue;
            }
            let angle = omega * time + phase;
            let expected = [
                gain * libm::sin(angle),
                gain * omega * libm::cos(angle),
                -gain * omega * omega * libm::sin(angle),
            ];
            for (order, expected) in expected.iter().enumerate() {
                let scale = libm::pow(omega, order as f64);
                let error = (filter.state[order] - expected).abs();
                assert!(error < 1e-5 * scale, "{index} {order}: {error}");
            }
        }
    }

    #[test]
    fn a_line_comes_out_late_by_the_delay_from_the_first_sample() {
        let mut filter = Filter::default();
        filter.reset(1.0, 2.0, delay(10.0));
        for index in 1..1000 {
            let seconds = if index % 7 == 0 { 0.004 } else { 0.001 };
            filter.update(&FilterStep::new(10.0, seconds), filter.input + 2.0 * seconds);
            let expected = filter.input - 2.0 * delay(10.0);
            assert!((filter.state[0] - expected).abs() < 1e-12);
            assert!((filter.state[1] - 2.0).abs() < 1e-10 && filter.state[2].abs() < 1e-8);
        }
    }
}
