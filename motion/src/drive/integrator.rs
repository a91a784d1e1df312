//! Ordinary differential equations by Dormand and Prince's explicit pair of orders 5 and 4 (J. Comput. Appl. Math. 6, 1980), with
//! error control by step length.
//!
//! An elastic joint is stiff only in name: its swinging is to be seen, not damped away, so that a method whose steps resolve it is
//! the cheaper one; what would be stiff, dry friction at speed, is not a differential equation here (`loss.rs`).

use crate::tolerance::{PLANT_STEP_FACTOR, PLANT_STEP_FIRST, PLANT_STEP_GROWTH, PLANT_STEP_SHRINK};

/// What is integrated.
pub(crate) trait System {
    /// The rates of a state.
    fn rates(&mut self, time: f64, state: &[f64], rates: &mut [f64]);

    /// Whether a step was fine enough for what the error estimate does not see.
    fn is_fine(&self, span: f64, from: &[f64], to: &[f64]) -> bool;

    /// A step was taken.
    fn accept(&mut self, span: f64, from: &[f64], to: &[f64]);
}

/// Scratch and step length.
#[derive(Debug)]
pub(crate) struct Integrator {
    /// Error that is allowed of each coordinate in a step.
    weights: Vec<f64>,
    /// Rates of each stage, one stage after the other.
    stages: [Vec<f64>; 7],
    trial: Vec<f64>,
    /// The first stage is the last one of the step before.
    carried: bool,
    /// Length that the next step should have, s.
    span: f64,
    /// Length of the step that was last taken, s; 0 where it was not.
    pub(crate) taken: f64,
    /// Steps that were tried.
    pub(crate) steps: u64,
}

/// Rows of the tableau: what each stage after the first takes of those before. The last row is the solution of order 5.
const STAGES: [&[f64]; 6] = [
    &[1.0 / 5.0],
    &[3.0 / 40.0, 9.0 / 40.0],
    &[44.0 / 45.0, -56.0 / 15.0, 32.0 / 9.0],
    &[19_372.0 / 6561.0, -25_360.0 / 2187.0, 64_448.0 / 6561.0, -212.0 / 729.0],
    &[
        9017.0 / 3168.0,
        -355.0 / 33.0,
        46_732.0 / 5247.0,
        49.0 / 176.0,
        -5103.0 / 18_656.0,
    ],
    &[
        35.0 / 384.0,
        0.0,
        500.0 / 1113.0,
        125.0 / 192.0,
        -2187.0 / 6784.0,
        11.0 / 84.0,
    ],
];

/// When each of them is, as part of the step.
const TIMES: [f64; 6] = [1.0 / 5.0, 3.0 / 10.0, 4.0 / 5.0, 8.0 / 9.0, 1.0, 1.0];

/// Order 5 less order 4.
const ERROR: [f64; 7] = [
    71.0 / 57_600.0,
    0.0,
    -71.0 / 16_695.0,
    71.0 / 1920.0,
    -17_253.0 / 339_200.0,
    22.0 / 525.0,
    -1.0 / 40.0,
];

impl Integrator {
    /// Scratch for states with so much error a step.
    pub(crate) fn new(weights: Vec<f64>) -> Self {
        let zeros = || vec![0.0; weights.len()];
        Self {
            stages: [(); 7].map(|()| zeros()),
            trial: zeros(),
            carried: false,
            span: PLANT_STEP_FIRST,
            taken: 0.0,
            steps: 0,
            weights,
        }
    }

    /// What acts on the system has changed.
    pub(crate) fn begin(&mut self) {
        self.carried = false;
    }

    /// Tries one step, at most `left` long. True where it went all of that way.
    pub(crate) fn step(&mut self, system: &mut impl System, time: f64, state: &mut [f64], left: f64) -> bool {
        self.steps += 1;
        self.taken = 0.0;
        let last = self.span >= left;
        let span = if last { left } else { self.span };
        if !self.carried {
            system.rates(time, state, &mut self.stages[0]);
        }
        self.carried = true;
        for (stage, (row, at)) in STAGES.iter().zip(TIMES).enumerate() {
            combine(&mut self.trial, state, &self.stages, row, span);
            system.rates(time + at * span, &self.trial, &mut self.stages[stage + 1]);
        }
        let error = self.error(span);
        let fine = system.is_fine(span, state, &self.trial);
        if error <= 1.0 && fine {
            system.accept(span, state, &self.trial);
            state.copy_from_slice(&self.trial);
            self.stages.swap(0, 6);
            self.taken = span;
            let growth = self.factor(error);
            // a step cut short by the end says little of how long the next may be
            self.span = if last {
                self.span.max(span * growth)
            } else {
                span * growth
            };
            return last;
        }
        self.span = span
            * if fine {
                self.factor(error).min(1.0)
            } else {
                PLANT_STEP_SHRINK
            };
        false
    }

    /// Largest error over what is allowed.
    fn error(&self, span: f64) -> f64 {
        let mut largest = 0.0_f64;
        for (index, weight) in self.weights.iter().enumerate() {
            let mut sum = 0.0;
            for (stage, part) in self.stages.iter().zip(ERROR) {
                sum += part * stage[index];
            }
            let error = (span * sum).abs() / weight;
            // not a number counts as too large
            if !(error <= largest) {
                largest = if error.is_nan() { f64::INFINITY } else { error };
            }
        }
        largest
    }

    /// The step's length that would have had an error just below what is allowed, over the one tried.
    fn factor(&self, error: f64) -> f64 {
        let factor = PLANT_STEP_FACTOR * libm::pow(error.max(f64::MIN_POSITIVE), -0.2);
        factor.clamp(PLANT_STEP_SHRINK, PLANT_STEP_GROWTH)
    }
}

/// `to` = `from` + `span`·Σ `row`·stages.
fn combine(to: &mut [f64], from: &[f64], stages: &[Vec<f64>; 7], row: &[f64], span: f64) {
    to.copy_from_slice(from);
    for (stage, part) in stages.iter().zip(row) {
        let part = part * span;
        for (to, rate) in to.iter_mut().zip(stage) {
            *to += part * rate;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two bodies about their common centre (Hairer, Nørsett and Wanner 1993, problem class A): closed orbit, period 2π.
    struct Orbit;

    impl System for Orbit {
        fn rates(&mut self, _: f64, s: &[f64], rates: &mut [f64]) {
            let cube = (s[0] * s[0] + s[1] * s[1]).powf(1.5);
            rates.copy_from_slice(&[s[2], s[3], -s[0] / cube, -s[1] / cube]);
        }

        fn is_fine(&self, _: f64, _: &[f64], _: &[f64]) -> bool {
            true
        }

        fn accept(&mut self, _: f64, _: &[f64], _: &[f64]) {}
    }

    #[test]
    fn an_orbit_closes_to_the_error_allowed() {
        let eccentricity = 0.5_f64;
        let begin = [
            1.0 - eccentricity,
            0.0,
            0.0,
            ((1.0 + eccentricity) / (1.0 - eccentricity)).sqrt(),
        ];
        let mut errors = Vec::new();
        for allowed in [1e-7, 1e-10] {
            let (mut integrator, mut state, mut time) = (Integrator::new(vec![allowed; 4]), begin, 0.0);
            let end = 2.0 * std::f64::consts::PI;
            while !integrator.step(&mut Orbit, time, &mut state, end - time) {
                time += integrator.taken;
            }
            let error = state.iter().zip(begin).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            assert!(error < 300.0 * allowed, "{error}");
            errors.push(error);
        }
        assert!(errors[1] < 2e-3 * errors[0], "{errors:?}");
    }
}
