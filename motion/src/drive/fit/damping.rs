//! Damping and Coulomb friction from a free oscillation of the motor against its transmission, the output held (eq 7).
//!
//! ```text
//! B·Θ̈ + (D + Fv)·Θ̇ + Fc·sgn Θ̇ + K·Θ = 0
//! ```
//!
//! From one maximum to the next on the same side, a period T later, friction moves the centre of each half swing by ±Fc/K and
//! damping shortens it by √r, r = exp(−σ·T), σ = (D + Fv)/(2·B), so
//!
//! ```text
//! A′ = r·A − (Fc/K)·(1 + √r)²            K = B·((2π/T)² + σ²)
//! ```
//!
//! (J. Den Hartog, "Forced vibrations with combined Coulomb and viscous friction", 1931, without the force.) Without Coulomb friction this is the logarithmic
//! decrement D + Fv = 2·B·ln(A₁/A₂)/(t₂ − t₁); with it one pair of maxima has one equation for two unknowns, and cannot
//! separate them: three maxima are the least. The motor's own viscous friction Fv is in the sum and is taken off by whoever
//! knows it from runs at constant speed.

use std::f64::consts::PI;

use super::least_squares::{Fitted, fit_columns};
use super::linear::dot;
use super::recording::{increases, is_value};
use super::report::Missing;
use crate::error::Invalid;
use crate::tolerance::{
    DECAY_MOST, DECAY_STEPS, FIT_SAMPLES_MAX, FIT_VALUE_MAX, GOLDEN_STEPS, OSCILLATION_UNEVEN, SWING_MIN,
};

/// What a free oscillation says, at the joint.
#[derive(Debug, Clone, PartialEq)]
pub struct Damping {
    /// D + Fv, torque over speed.
    pub viscous: f64,
    /// Fc, N m or N.
    pub coulomb: f64,
    /// K, torque over deformation, from the period.
    pub stiffness: f64,
    /// Period, s.
    pub period: f64,
    /// Standard deviations of D + Fv and Fc; `None` with three maxima, which leave nothing to judge by.
    pub deviations: Option<(f64, f64)>,
    /// What the logarithmic decrement of the first pair alone would have said of D + Fv (eq 7).
    pub decrement_of_first_pair: f64,
}

/// What came of it.
#[derive(Debug, Clone, PartialEq)]
pub enum DampingOutcome {
    /// Damping and friction.
    Fitted(Damping),
    /// The maxima do not tell.
    Missing(Missing),
}

/// Fits damping and Coulomb friction together to successive maxima on one side: their times (s) and amplitudes from the unloaded
/// position (rad or m, seen from the joint). `inertia` is B, that of the motor seen from the joint, kg m² or kg.
///
/// # Errors
/// Lengths that differ, numbers that are none, times that do not increase, amplitudes or an inertia that are not positive.
pub fn fit_damping(time: &[f64], amplitude: &[f64], inertia: f64) -> Result<DampingOutcome, Vec<Invalid>> {
    let faults = check(time, amplitude, inertia);
    if !faults.is_empty() {
        return Err(faults);
    }
    let missing = |message: String| {
        Ok(DampingOutcome::Missing(Missing {
            parameters: Vec::new(),
            message,
        }))
    };
    let count = time.len();
    if count < 3 {
        return missing(format!(
            "{count} maxima: one pair cannot tell damping from Coulomb friction, three are the least"
        ));
    }
    let period = (time[count - 1] - time[0]) / (count - 1) as f64;
    if let Some(k) = time
        .windows(2)
        .position(|pair| ((pair[1] - pair[0]) / period - 1.0).abs() > OSCILLATION_UNEVEN)
    {
        return missing(format!(
            "maxima {k} and {} are {:.4} s apart, others {period:.4} s: one is missing, or not of this oscillation",
            k + 1,
            time[k + 1] - time[k]
        ));
    }
    if amplitude[count - 1] > amplitude[0] * (1.0 - SWING_MIN) {
        return missing(format!(
            "the amplitude fell from {:e} to {:e}: nothing to see of damping, let it swing longer",
            amplitude[0],
            amplitude[count - 1]
        ));
    }
    let decay = least_decay(amplitude);
    let swing = Swing::new(amplitude, decay);
    let sigma = decay / period;
    let stiffness = inertia * ((2.0 * PI / period) * (2.0 * PI / period) + sigma * sigma);
    let root = libm::exp(-0.5 * decay);
    let to_coulomb = stiffness / ((1.0 + root) * (1.0 + root));
    let to_viscous = 2.0 * inertia / period;
    Ok(DampingOutcome::Fitted(Damping {
        viscous: to_viscous * decay,
        coulomb: to_coulomb * swing.loss,
        stiffness,
        period,
        deviations: swing
            .deviations(amplitude, decay)
            .map(|(of_decay, of_loss)| (to_viscous * of_decay, to_coulomb * of_loss)),
        decrement_of_first_pair: 2.0 * inertia * libm::log(amplitude[0] / amplitude[1]) / (time[1] - time[0]),
    }))
}

/// The amplitudes A₀·r^k − c·(1 + r + … + r^(k−1)) that suit best for a decay −ln r: c is the loss a period by Coulomb friction.
struct Swing {
    first: f64,
    loss: f64,
    square: f64,
}

impl Swing {
    fn new(amplitude: &[f64], decay: f64) -> Self {
        let (powers, sums) = columns(amplitude.len(), decay);
        let (pp, ps, ss) = (dot(&powers, &powers), dot(&powers, &sums), dot(&sums, &sums));
        let (pa, sa) = (dot(&powers, amplitude), dot(&sums, amplitude));
        let determinant = pp * ss - ps * ps;
        let loss = (ps * pa - pp * sa) / determinant;
        // friction takes energy and gives none
        let (first, loss) = if loss > 0.0 {
            ((pa + loss * ps) / pp, loss)
        } else {
            (pa / pp, 0.0)
        };
        let square = amplitude
            .iter()
            .zip(powers.iter().zip(&sums))
            .map(|(a, (p, s))| {
                let off = a - first * p + loss * s;
                off * off
            })
            .sum();
        Self { first, loss, square }
    }

    /// Standard deviations of the decay and the loss, from the slope of the amplitudes by both.
    fn deviations(&self, amplitude: &[f64], decay: f64) -> Option<(f64, f64)> {
        let (powers, sums) = columns(amplitude.len(), decay);
        let r = libm::exp(-decay);
        let mut sum_slope = 0.0;
        let by_decay: Vec<f64> = (0..amplitude.len())
            .map(|k| {
                // d(r^k) = −k·r^k, and the sum's by its recursion S′ = r·S + 1
                let slope = -self.first * k as f64 * powers[k] - self.loss * sum_slope;
                sum_slope = r * sum_slope - r * sums[k];
                slope
            })
            .collect();
        let columns = [powers, sums, by_decay];
        let residuals: Vec<f64> = amplitude
            .iter()
            .zip(columns[0].iter().zip(&columns[1]))
            .map(|(a, (p, s))| a - self.first * p + self.loss * s)
            .collect();
        let Fitted { deviations, .. } = fit_columns(&columns, &residuals)?;
        Some((deviations[2], deviations[1]))
    }
}

/// r^k, and 1 + r + … + r^(k−1).
fn columns(count: usize, decay: f64) -> (Vec<f64>, Vec<f64>) {
    let r = libm::exp(-decay);
    let (mut power, mut sum) = (1.0, 0.0);
    let mut columns = (Vec::with_capacity(count), Vec::with_capacity(count));
    for _ in 0..count {
        columns.0.push(power);
        columns.1.push(sum);
        sum += power;
        power *= r;
    }
    columns
}

/// The decay a period that suits best: the best of a grid, then a golden section about it.
fn least_decay(amplitude: &[f64]) -> f64 {
    const PART: f64 = 0.618_033_988_749_894_9;
    let square = |decay: f64| Swing::new(amplitude, decay).square;
    let step = DECAY_MOST / DECAY_STEPS as f64;
    let best = (0..=DECAY_STEPS)
        .min_by(|a, b| square(step * *a as f64).total_cmp(&square(step * *b as f64)))
        .unwrap_or(0);
    let (mut from, mut to) = (step * best.saturating_sub(1) as f64, step * (best + 1) as f64);
    for _ in 0..GOLDEN_STEPS {
        let inner = [to - PART * (to - from), from + PART * (to - from)];
        if square(inner[0]) <= square(inner[1]) {
            to = inner[1];
        } else {
            from = inner[0];
        }
    }
    if square(from) <= square(to) { from } else { to }
}

fn check(time: &[f64], amplitude: &[f64], inertia: f64) -> Vec<Invalid> {
    let mut faults = Vec::new();
    if !(inertia > 0.0 && inertia <= FIT_VALUE_MAX) {
        faults.push(Invalid::new("inertia", format!("{inertia} kg m² must be above 0")));
    }
    if time.len() != amplitude.len() {
        let message = format!("{} values for {} times", amplitude.len(), time.len());
        faults.push(Invalid::new("amplitude", message));
    }
    if time.len() > FIT_SAMPLES_MAX {
        let message = format!("{} values, the most is {FIT_SAMPLES_MAX}", time.len());
        faults.push(Invalid::new("time", message));
    }
    if let Some(i) = time.iter().position(|t| !is_value(*t)) {
        faults.push(Invalid::new(format!("time[{i}]"), format!("{} is no time", time[i])));
    }
    if let Some(i) = time.windows(2).position(|pair| !increases(pair)) {
        let message = format!("{} s must be after {} s", time[i + 1], time[i]);
        faults.push(Invalid::new(format!("time[{}]", i + 1), message));
    }
    if let Some(i) = amplitude.iter().position(|a| !(*a > 0.0 && *a <= FIT_VALUE_MAX)) {
        let message = format!("{} must be above 0", amplitude[i]);
        faults.push(Invalid::new(format!("amplitude[{i}]"), message));
    }
    faults
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_arms::random;

    const INERTIA: f64 = 0.5;
    const STIFFNESS: f64 = 8000.0;

    /// Maxima of the oscillation, by half swings: each is a damped oscillation about a centre that friction holds off zero.
    fn maxima(viscous: f64, coulomb: f64, count: usize) -> (Vec<f64>, Vec<f64>) {
        let sigma = viscous / (2.0 * INERTIA);
        let omega = (STIFFNESS / INERTIA - sigma * sigma).sqrt();
        let half = PI / omega;
        let (mut time, mut amplitude) = (vec![0.0], vec![0.1]);
        for k in 1..count {
            let mut a = amplitude[k - 1];
            for _ in 0..2 {
                a = (a - coulomb / STIFFNESS) * (-sigma * half).exp() - coulomb / STIFFNESS;
            }
            time.push(2.0 * half * k as f64);
            amplitude.push(a);
        }
        (time, amplitude)
    }

    fn fitted(time: &[f64], amplitude: &[f64]) -> Damping {
        match fit_damping(time, amplitude, INERTIA).unwrap() {
            DampingOutcome::Fitted(damping) => damping,
            DampingOutcome::Missing(missing) => panic!("{}", missing.message),
        }
    }

    #[test]
    fn damping_and_friction_come_back_from_three_maxima_and_from_more() {
        for (viscous, coulomb) in [(4.0, 6.0), (10.0, 0.0), (0.0, 8.0), (1.0, 15.0)] {
            for count in [3, 4, 5] {
                let (time, amplitude) = maxima(viscous, coulomb, count);
                let found = fitted(&time, &amplitude);
                assert!((found.viscous - viscous).abs() < 1e-5, "{viscous} {coulomb}: {found:?}");
                assert!((found.coulomb - coulomb).abs() < 1e-4, "{viscous} {coulomb}: {found:?}");
                assert!((found.stiffness / STIFFNESS - 1.0).abs() < 1e-6);
                assert_eq!(found.deviations.is_some(), count > 3);
            }
        }
    }

    /// The same motion by an integrator (Runge and Kutta's of fourth order), which knows nothing of half swings.
    #[test]
    fn the_amplitudes_are_those_of_the_equation_of_motion() {
        let (viscous, coulomb) = (4.0, 6.0);
        let (time, amplitude) = maxima(viscous, coulomb, 3);
        let (mut x, mut v) = (amplitude[0], 0.0);
        let steps = 20_000;
        let dt = 0.5 * time[1] / f64::from(steps);
        let mut extremes = vec![x];
        for half in 0..4 {
            // during a half swing the direction does not change
            let way = if half % 2 == 0 { -1.0 } else { 1.0 };
            let rate = |x: f64, v: f64| -(viscous * v + coulomb * way + STIFFNESS * x) / INERTIA;
            for _ in 0..steps {
                let (a1, v1) = (rate(x, v), v);
                let (a2, v2) = (rate(x + 0.5 * dt * v1, v + 0.5 * dt * a1), v + 0.5 * dt * a1);
                let (a3, v3) = (rate(x + 0.5 * dt * v2, v + 0.5 * dt * a2), v + 0.5 * dt * a2);
                let (a4, v4) = (rate(x + dt * v3, v + dt * a3), v + dt * a3);
                x += dt * (v1 + 2.0 * v2 + 2.0 * v3 + v4) / 6.0;
                v += dt * (a1 + 2.0 * a2 + 2.0 * a3 + a4) / 6.0;
            }
            assert!(v.abs() < 1e-6);
            extremes.push(x);
        }
        assert!((extremes[2] - amplitude[1]).abs() < 1e-9 && (extremes[4] - amplitude[2]).abs() < 1e-9);
    }

    #[test]
    fn without_coulomb_friction_it_is_the_logarithmic_decrement() {
        let (time, amplitude) = maxima(10.0, 0.0, 6);
        let found = fitted(&time, &amplitude);
        assert!((found.decrement_of_first_pair - 10.0).abs() < 1e-9);
        let (time, amplitude) = maxima(4.0, 6.0, 3);
        assert!(fitted(&time, &amplitude).decrement_of_first_pair > 4.4);
    }

    #[test]
    fn the_truth_is_within_two_deviations_as_often_as_it_should() {
        let state = &mut 4;
        let runs = 300;
        let (time, exact) = maxima(4.0, 6.0, 8);
        let mut within = [0, 0];
        for _ in 0..runs {
            let amplitude: Vec<f64> = exact.iter().map(|a| a + 2e-5 * random(state)).collect();
            let found = fitted(&time, &amplitude);
            let (viscous, coulomb) = found.deviations.unwrap();
            // the 95 % interval of Student's distribution with five degrees of freedom
            within[0] += usize::from((found.viscous - 4.0).abs() < 2.571 * viscous);
            within[1] += usize::from((found.coulomb - 6.0).abs() < 2.571 * coulomb);
        }
        for within in within {
            let part = within as f64 / f64::from(runs);
            assert!((0.91..=0.985).contains(&part), "{part}");
        }
    }

    #[test]
    fn one_pair_cannot_separate_them_and_that_is_said() {
        let said = |time: &[f64], amplitude: &[f64]| match fit_damping(time, amplitude, 1.0).unwrap() {
            DampingOutcome::Missing(missing) => missing.message,
            DampingOutcome::Fitted(found) => panic!("{found:?}"),
        };
        assert!(said(&[0.0, 1.0], &[2.0, 1.0]).contains("one pair cannot tell"));
        assert!(said(&[0.0, 1.0, 3.0], &[2.0, 1.0, 0.5]).contains("missing"));
        assert!(said(&[0.0, 1.0, 2.0], &[2.0, 2.0, 2.0]).contains("nothing to see"));
        assert_eq!(fit_damping(&[1.0, 0.0], &[-1.0], f64::NAN).unwrap_err().len(), 4);
    }
}
