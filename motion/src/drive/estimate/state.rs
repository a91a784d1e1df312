//! An estimator taken out and put back: everything that it goes on from, as numbers in a fixed order.
//!
//! The numbers are for nobody to read; they hold for one version of their layout, and for the robot and the options that they were
//! made with, which stay with whoever keeps the state. All reals are finite. An estimator that goes on from its state gives the bits that it
//! would have given without.

use super::excitation::Excitation;
use super::factor::UnitFactor;
use super::filter::Filter;
use super::joint::JointState;
use super::kalman::Kalman;
use super::least_squares::LeastSquares;
use super::options::{EstimatorMethod, EstimatorOptions, FrictionSide};
use super::report::{SkippedOfJoint, SkippedSamples};
use super::{Behind, Combination, FrictionEstimator};
use crate::drive::telemetry::Signals;
use crate::error::Invalid;
use crate::robot::Robot;

/// Layout of the numbers and what they are of; a state of another one is refused. 2: terms that the law does not have are
/// taken off at the model's values. 3: samples of a clock that is behind.
const VERSION: u32 = 3;

/// What an estimator goes on from.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct EstimatorState {
    /// Layout of the numbers.
    pub version: u32,
    /// Sums, filters, coefficients.
    pub reals: Vec<f64>,
    /// Counts and switches.
    pub counts: Vec<u64>,
}

/// Visits every number of a state in one order, to write or to read it.
trait Port {
    fn real(&mut self, value: &mut f64);
    fn count(&mut self, value: &mut u64);

    fn reals(&mut self, values: &mut [f64]) {
        for value in values {
            self.real(value);
        }
    }

    fn switch(&mut self, value: &mut bool) {
        let mut count = u64::from(*value);
        self.count(&mut count);
        *value = count != 0;
    }
}

struct Writer(EstimatorState);

impl Port for Writer {
    fn real(&mut self, value: &mut f64) {
        self.0.reals.push(*value);
    }

    fn count(&mut self, value: &mut u64) {
        self.0.counts.push(*value);
    }
}

struct Reader<'a> {
    reals: std::slice::Iter<'a, f64>,
    counts: std::slice::Iter<'a, u64>,
    /// Whether there was a number for every place so far.
    complete: bool,
}

impl Port for Reader<'_> {
    fn real(&mut self, value: &mut f64) {
        match self.reals.next() {
            Some(read) => *value = *read,
            None => self.complete = false,
        }
    }

    fn count(&mut self, value: &mut u64) {
        match self.counts.next() {
            Some(read) => *value = *read,
            None => self.complete = false,
        }
    }
}

impl FrictionEstimator {
    /// Everything that it goes on from.
    #[must_use]
    pub fn state(&self) -> EstimatorState {
        let mut writer = Writer(EstimatorState {
            version: VERSION,
            ..EstimatorState::default()
        });
        // one order for both ways is worth the copy
        self.clone().visit(&mut writer);
        writer.0
    }

    /// Goes on from a state, with the robot and the options that it was made with.
    ///
    /// # Errors
    /// What is wrong with the options, and a state that is none of theirs.
    pub fn resume(robot: Robot, options: EstimatorOptions, state: &EstimatorState) -> Result<Self, Vec<Invalid>> {
        let mut estimator = Self::new(robot, options)?;
        let refuse = |path: &str, message: String| Err(vec![Invalid::new(path, message)]);
        if state.version != VERSION {
            let message = format!("{} is not the layout of this version, {VERSION}", state.version);
            return refuse("state.version", message);
        }
        if state.reals.iter().any(|value| !value.is_finite()) {
            return refuse("state.reals", "every value must be finite".to_owned());
        }
        let empty = estimator.state();
        for (path, count, wanted) in [
            ("state.reals", state.reals.len(), empty.reals.len()),
            ("state.counts", state.counts.len(), empty.counts.len()),
        ] {
            if count != wanted {
                let message = format!("{count} values, a state for this robot and these options has {wanted}");
                return refuse(path, message);
            }
        }
        if state.counts[0] != empty.counts[0] {
            let message = "the state was made with other options: method, side or law".to_owned();
            return refuse("state.counts[0]", message);
        }
        let mut reader = Reader {
            reals: state.reals.iter(),
            counts: state.counts.iter(),
            complete: true,
        };
        let signals = estimator.visit(&mut reader);
        if !(reader.complete && estimator.is_sound()) {
            return refuse("state", "its numbers are no state: a variance is below 0".to_owned());
        }
        if let Some(signals) = signals {
            let combination = Combination::of(&estimator.robot, &estimator.options, signals)?;
            estimator.rely_on(signals, combination);
        }
        Ok(estimator)
    }

    fn is_sound(&self) -> bool {
        self.joints.iter().all(|joint| {
            let count = joint.least_squares.count;
            joint.least_squares.factor.diagonal[..count].iter().all(|&d| d > 0.0)
                && super::model::is_covariance(count, &joint.kalman.covariance[..count * (count + 1) / 2])
                && joint.spread.robust > 0.0
                && joint.spread.second > 0.0
        })
    }

    /// Visits every number; returns which signals there are, if any were seen, which follow from no other number.
    fn visit(&mut self, port: &mut impl Port) -> Option<Signals> {
        port.count(&mut fingerprint(&self.options));
        let mut signals = self.sources.map(|(signals, _)| signals).unwrap_or_default();
        let mut known = self.sources.is_some();
        port.switch(&mut known);
        visit_signals(&mut signals, port);
        let mut has_time = self.time.is_some();
        let mut time = self.time.unwrap_or(0.0);
        port.switch(&mut has_time);
        port.real(&mut time);
        self.time = has_time.then_some(time);
        let mut is_behind = self.behind.is_some();
        let Behind { mut time, mut seconds } = self.behind.unwrap_or_default();
        port.switch(&mut is_behind);
        port.real(&mut time);
        port.real(&mut seconds);
        self.behind = is_behind.then_some(Behind { time, seconds });
        port.count(&mut self.sample_count);
        let SkippedSamples {
            not_finite,
            out_of_range,
            time_went_backwards,
            gaps,
        } = &mut self.skipped;
        for count in [not_finite, out_of_range, time_went_backwards, gaps] {
            port.count(count);
        }
        for joint in &mut self.joints {
            visit_joint(joint, port);
        }
        known.then_some(signals)
    }
}

/// Tells options apart whose states do not fit each other.
fn fingerprint(options: &EstimatorOptions) -> u64 {
    let method = match options.method {
        EstimatorMethod::LeastSquares => 0,
        EstimatorMethod::Observer => 1,
        EstimatorMethod::Kalman => 2,
    };
    let side = match options.side {
        FrictionSide::Total => 0,
        FrictionSide::Joint => 1,
        FrictionSide::Motor => 2,
    };
    let law =
        u64::from(options.law.by_direction) + 2 * u64::from(options.law.load) + 4 * u64::from(options.law.quadratic);
    method + 4 * side + 16 * law + 128 * u64::from(options.bandwidth.is_some())
}

fn visit_signals(signals: &mut Signals, port: &mut impl Port) {
    let Signals {
        motor_position,
        output_position,
        output_velocity,
        output_acceleration,
        motor_torque,
        motor_current,
        transmission_torque,
        external_torque,
    } = signals;
    for switch in [
        motor_position,
        output_position,
        output_velocity,
        output_acceleration,
        motor_torque,
        motor_current,
        transmission_torque,
        external_torque,
    ] {
        port.switch(switch);
    }
}

fn visit_joint(joint: &mut JointState, port: &mut impl Port) {
    let JointState {
        position,
        velocity,
        acceleration,
        motor,
        torque,
        torque_lost,
        settling,
        direction,
        moving,
        waiting,
        least_squares,
        kalman,
        observer,
        lagged,
        regressors,
        spread,
        excitation,
        friction,
        used,
        discounted,
        skipped,
    } = joint;
    for Filter { state, input } in [position, velocity, acceleration, motor, torque] {
        port.reals(state);
        port.real(input);
    }
    port.switch(torque_lost);
    for value in [settling, direction, moving, waiting, friction] {
        port.real(value);
    }
    visit_least_squares(least_squares, port);
    let Kalman {
        count: _,
        coefficients,
        covariance,
        drift: _,
        caps: _,
    } = kalman;
    port.reals(coefficients);
    port.reals(covariance);
    for value in [&mut observer.friction, &mut observer.torque, &mut observer.velocity] {
        port.real(value);
    }
    port.reals(lagged);
    port.reals(regressors);
    for value in [
        &mut spread.robust,
        &mut spread.second,
        &mut spread.fourth,
        &mut spread.samples,
    ] {
        port.real(value);
    }
    let Excitation { seconds, speed, load } = excitation;
    for values in [seconds, speed, load] {
        port.reals(values);
    }
    port.count(used);
    port.count(discounted);
    let SkippedOfJoint {
        at_rest,
        reversing,
        settling,
        not_finite,
        out_of_range,
        outlier,
    } = skipped;
    for count in [at_rest, reversing, settling, not_finite, out_of_range, outlier] {
        port.count(count);
    }
}

fn visit_least_squares(state: &mut LeastSquares, port: &mut impl Port) {
    let LeastSquares {
        count: _,
        coefficients,
        factor,
        caps: _,
        room,
        evidence,
    } = state;
    port.reals(coefficients);
    // looked at again
    *room = 0.0;
    let UnitFactor { upper, diagonal } = factor;
    port.reals(upper);
    port.reals(diagonal);
    port.reals(&mut evidence.prior);
    for level in &mut evidence.levels {
        port.reals(&mut level.scores);
        port.reals(&mut level.before);
        port.reals(&mut level.products);
        for value in [
            &mut level.impulse,
            &mut level.decay,
            &mut level.seconds,
            &mut level.weight,
            &mut level.weight_squared,
            &mut level.impulses,
            &mut level.duration,
        ] {
            port.real(value);
        }
        port.count(&mut level.parts);
    }
}
