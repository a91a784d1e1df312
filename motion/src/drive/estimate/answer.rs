//! From an estimator's state to what it says.

use super::FrictionEstimator;
use super::factor::lower;
use super::filter;
use super::joint::JointState;
use super::law::TRIANGLE;
use super::options::EstimatorMethod;
use super::report::{Coefficient, EstimateReport, JointEstimate, MissingExcitation};
use crate::quantile;
use crate::tolerance::ESTIMATE_TOLD_PART;

/// What a report's interval beyond either end leaves: it holds 95 %.
const TAIL: f64 = 0.025;

impl FrictionEstimator {
    /// What is known by now.
    #[must_use]
    pub fn report(&self) -> EstimateReport {
        EstimateReport {
            joints: self
                .joints
                .iter()
                .enumerate()
                .map(|(index, joint)| self.joint_report(index, joint))
                .collect(),
            sample_count: self.sample_count,
            skipped: self.skipped,
            time: self.time,
            delay: self.options.bandwidth.map_or(0.0, filter::delay),
        }
    }

    fn joint_report(&self, index: usize, joint: &JointState) -> JointEstimate {
        let law = self.options.law;
        let count = law.count();
        let (covariance, degrees_of_freedom) = self.covariance(joint);
        let width = quantile::student(degrees_of_freedom.unwrap_or(f64::INFINITY), TAIL);
        let before = &self.models[index].deviations;
        let known = law.coefficients(&self.models[index].known);
        let values = joint.coefficients(self.options.method);
        let coefficients: Vec<Coefficient> = (0..count)
            .map(|term| {
                let deviation = libm::sqrt(covariance[lower(term, term)].max(0.0));
                Coefficient {
                    term: law.term(term),
                    value: values[term],
                    known: known[term],
                    deviation,
                    lower: values[term] - width * deviation,
                    upper: values[term] + width * deviation,
                    told: deviation < ESTIMATE_TOLD_PART * before[term],
                }
            })
            .collect();
        let spread = &joint.spread;
        JointEstimate {
            law,
            side: self.options.side,
            missing: self.missing(index, joint, &coefficients),
            coefficients,
            covariance: covariance[..count * (count + 1) / 2].to_vec(),
            held_quadratic: self.models[index].held.quadratic,
            speed_limit: self.models[index].speed_limit,
            degrees_of_freedom,
            residual_rms: libm::sqrt(spread.second),
            residual_deviation: libm::sqrt(spread.robust),
            correlation_time: match self.options.method {
                EstimatorMethod::Kalman => None,
                EstimatorMethod::LeastSquares | EstimatorMethod::Observer => {
                    joint.least_squares.evidence.correlation_time(spread.second)
                }
            },
            residual_tails: spread.tails(),
            friction_torque: (joint.used > 0).then_some(joint.friction),
            used_count: joint.used,
            discounted_count: joint.discounted,
            skipped: joint.skipped,
        }
    }

    fn covariance(&self, joint: &JointState) -> ([f64; TRIANGLE], Option<f64>) {
        match self.options.method {
            EstimatorMethod::Kalman => (joint.kalman_covariance(), None),
            EstimatorMethod::LeastSquares | EstimatorMethod::Observer => {
                let state = &joint.least_squares;
                let known = state.evidence.known(state.count, &state.factor, joint.spread.second);
                (known.covariance, known.degrees_of_freedom)
            }
        }
    }

    fn missing(&self, index: usize, joint: &JointState, coefficients: &[Coefficient]) -> Vec<MissingExcitation> {
        let mut missing = joint
            .excitation
            .missing(self.options.law, self.options.correlation_time);
        if !missing.is_empty() {
            return missing;
        }
        // what a caller knew beforehand need not be told again
        if self.options.priors.get(index).is_some_and(Option::is_some) {
            return missing;
        }
        missing.extend(
            coefficients
                .iter()
                .zip(&self.models[index].deviations)
                .filter(|(coefficient, _)| !coefficient.told)
                .map(|(coefficient, &before)| MissingExcitation::Untold {
                    term: coefficient.term,
                    deviation: coefficient.deviation,
                    before,
                }),
        );
        missing
    }
}
