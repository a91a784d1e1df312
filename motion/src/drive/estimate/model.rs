//! What an estimator has of the robot's description, one joint at a time, worked out once.

use super::combination::{Combination, MotorTorqueSource, TransmissionTorqueSource};
use super::excitation::Excitation;
use super::factor::{UnitFactor, lower};
use super::joint::JointState;
use super::kalman::Kalman;
use super::law::{FrictionLaw, TERMS_MAX, TRIANGLE, at_the_joint};
use super::least_squares::LeastSquares;
use super::options::{EstimatorOptions, FrictionSide};
use super::spread::Spread;
use crate::error::Invalid;
use crate::robot::Robot;
use crate::robot::spec::{Drive, Friction};
use crate::tolerance::{ESTIMATE_NOISE_PART, ESTIMATE_PRIOR_PART, ESTIMATE_TORQUE_DEFAULT, ESTIMATE_VELOCITY_DEFAULT};

const SECONDS_IN_HOUR: f64 = 3600.0;

/// Constants of one joint.
#[derive(Debug, Clone)]
pub(super) struct JointModel {
    pub(super) gear_ratio: f64,
    /// What a motor position is multiplied by to be Θ.
    pub(super) joint_over_motor: f64,
    /// B, kg m² or kg.
    pub(super) armature: f64,
    /// B where the motor's torque is in the balance, 0 where it is not.
    pub(super) armature_used: f64,
    /// What a reported motor torque or current is multiplied by.
    pub(super) motor_gain: f64,
    /// What the torque sensor's reading is multiplied by in the balance.
    pub(super) sensor_sign: f64,
    /// The same for the deformation's torque.
    pub(super) deformation_sign: f64,
    pub(super) stiffness: Vec<f64>,
    pub(super) damping: f64,
    /// Friction of the side that is not estimated, at the joint.
    pub(super) other_side: Friction,
    /// The friction that the model has of what is estimated, at the joint.
    pub(super) known: Friction,
    /// Those terms of it that the law does not have: they are taken off the balance, and stay in the model.
    pub(super) held: Friction,
    /// The joint's, rad/s or m/s, where it has one.
    pub(super) speed_limit: Option<f64>,
    /// Standard deviations of the coefficients beforehand.
    pub(super) deviations: [f64; TERMS_MAX],
}

impl JointModel {
    pub(super) fn new(robot: &Robot, joint: usize, side: FrictionSide, law: FrictionLaw) -> Self {
        let spec = &robot.spec().joints[joint];
        let drive = &spec.drive;
        let known = known(drive, side);
        Self {
            gear_ratio: drive.gear_ratio,
            joint_over_motor: 1.0 / drive.gear_ratio,
            armature: robot.drives()[joint].armature,
            armature_used: 0.0,
            motor_gain: 0.0,
            sensor_sign: 0.0,
            deformation_sign: 0.0,
            stiffness: drive.stiffness.clone(),
            damping: drive.damping.unwrap_or(0.0),
            other_side: match side {
                FrictionSide::Joint => at_the_joint(&drive.motor_friction, drive.gear_ratio),
                FrictionSide::Motor => drive.joint_friction,
                FrictionSide::Total => Friction::default(),
            },
            known,
            held: law.rest(&known),
            speed_limit: spec.limits.velocity,
            deviations: [0.0; TERMS_MAX],
        }
    }

    /// Takes on how torques are combined.
    pub(super) fn combine(&mut self, combination: &Combination, torque_constant: Option<f64>) {
        self.motor_gain = match combination.motor_torque {
            Some(MotorTorqueSource::Torque) => self.gear_ratio,
            Some(MotorTorqueSource::Current) => self.gear_ratio * torque_constant.unwrap_or(0.0),
            None => 0.0,
        };
        self.armature_used = if combination.motor_torque.is_some() {
            self.armature
        } else {
            0.0
        };
        // τJ drives the arm, and burdens the motor
        let sign = if combination.side == FrictionSide::Motor {
            -1.0
        } else {
            1.0
        };
        (self.sensor_sign, self.deformation_sign) = match combination.transmission_torque {
            Some(TransmissionTorqueSource::Sensor) => (sign, 0.0),
            Some(TransmissionTorqueSource::Deformation) => (0.0, sign),
            None => (0.0, 0.0),
        };
    }

    /// τE(Φ) + D·Φ̇ (eq 4 and 6).
    #[inline]
    pub(super) fn transmission(&self, deformation: f64, rate: f64) -> f64 {
        let square = deformation * deformation;
        let polynomial = self.stiffness.iter().rev().fold(0.0, |sum, k| sum * square + k);
        polynomial * deformation + self.damping * rate
    }

    /// The state before the first sample, at the prior.
    pub(super) fn state(
        &mut self,
        robot: &Robot,
        joint: usize,
        options: &EstimatorOptions,
    ) -> Result<JointState, Invalid> {
        let spec = &robot.spec().joints[joint];
        let law = options.law;
        let count = law.count();
        let torque = spec
            .drive
            .peak_torque
            .or(spec.drive.rated_torque)
            .unwrap_or(ESTIMATE_TORQUE_DEFAULT);
        let speed = spec.limits.velocity.unwrap_or(ESTIMATE_VELOCITY_DEFAULT);
        let deviation = options
            .noise
            .get(joint)
            .copied()
            .unwrap_or(ESTIMATE_NOISE_PART * torque);
        let noise = deviation * deviation;
        let scales = law.scales(speed, torque);
        let (mut mean, mut covariance) = ([0.0; TERMS_MAX], [0.0; TRIANGLE]);
        if let Some(Some(prior)) = options.priors.get(joint) {
            mean[..count].copy_from_slice(&prior.mean);
            covariance[..prior.covariance.len()].copy_from_slice(&prior.covariance);
        } else {
            mean = law.coefficients(&self.known);
            for index in 0..count {
                let deviation = ESTIMATE_PRIOR_PART * torque / scales[index];
                covariance[lower(index, index)] = deviation * deviation;
            }
        }
        // the most that a coefficient may be unknown by: it makes the whole torque of the joint at full speed
        let mut caps = [0.0; TERMS_MAX];
        let mut drift = [0.0; TERMS_MAX];
        for index in 0..count {
            let whole = torque / scales[index];
            let variance = covariance[lower(index, index)];
            self.deviations[index] = libm::sqrt(variance);
            caps[index] = (whole * whole).max(variance);
            drift[index] = (options.drift * whole) * (options.drift * whole) / SECONDS_IN_HOUR;
        }
        let scaled = caps.map(|cap| cap / noise);
        let least_squares = LeastSquares::new(count, &mean, &covariance, noise, scaled).ok_or_else(|| {
            let message = "the prior's covariance is not positive definite over the noise's variance";
            Invalid::new(format!("priors[{joint}].covariance"), message)
        })?;
        Ok(JointState {
            position: Default::default(),
            velocity: Default::default(),
            acceleration: Default::default(),
            motor: Default::default(),
            torque: Default::default(),
            torque_lost: true,
            settling: 0.0,
            direction: 0.0,
            moving: 0.0,
            waiting: 0.0,
            least_squares,
            kalman: Kalman {
                count,
                coefficients: mean,
                covariance,
                drift,
                caps,
            },
            observer: Default::default(),
            lagged: [0.0; TERMS_MAX],
            regressors: [0.0; TERMS_MAX],
            spread: Spread::new(deviation),
            excitation: Excitation::default(),
            friction: 0.0,
            used: 0,
            discounted: 0,
            skipped: Default::default(),
        })
    }
}

/// The friction that a drive has on a side, at the joint.
pub(in crate::drive) fn known(drive: &Drive, side: FrictionSide) -> Friction {
    let motor = at_the_joint(&drive.motor_friction, drive.gear_ratio);
    let own = drive.joint_friction;
    match side {
        FrictionSide::Joint => own,
        FrictionSide::Motor => motor,
        FrictionSide::Total => Friction {
            viscous: own.viscous + motor.viscous,
            coulomb_positive: own.coulomb_positive + motor.coulomb_positive,
            coulomb_negative: own.coulomb_negative + motor.coulomb_negative,
            load_coulomb: own.load_coulomb + motor.load_coulomb,
            quadratic: own.quadratic + motor.quadratic,
            presliding_stiffness: presliding(own.presliding_stiffness, motor.presliding_stiffness),
        },
    }
}

/// The stiffness before sliding that both sides have together, at the joint.
fn presliding(joint: Option<f64>, motor: Option<f64>) -> Option<f64> {
    match (joint, motor) {
        // contacts that slide on either side of one gear deflect one after the other
        (Some(joint), Some(motor)) => Some(joint.min(motor)),
        (joint, motor) => joint.or(motor),
    }
}

/// Whether a triangle has factors.
pub(super) fn is_covariance(count: usize, triangle: &[f64]) -> bool {
    let mut whole = [0.0; TRIANGLE];
    whole[..triangle.len()].copy_from_slice(triangle);
    UnitFactor::of(count, &whole).is_some()
}
