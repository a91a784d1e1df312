//! What drives report while an arm works: samples in columns.
//!
//! Conventions, for every column the drive's own, so that nobody has to convert before sending:
//!
//! - time: seconds on any clock that only goes forward;
//! - motor position: the motor shaft's, rad (eq 1: Θ = motor position / gear ratio);
//! - output position, velocity, acceleration: the joint's, rad or m;
//! - motor torque: at the motor shaft, N m (τmotor = gear ratio · motor torque); motor current: A, with the description's torque constant;
//! - transmission torque: what a torque sensor behind the gear reads, at the joint, N m or N: τJ;
//! - external torque: what the ARM exerts on its surroundings, at the joint: a wrench F on the flange is −Jᵀ·F.

use crate::error::Invalid;
use crate::tolerance::TELEMETRY_SAMPLES_MAX;

/// Samples of all joints of an arm, column by column.
///
/// Every column but the time holds one value a joint, sample after sample (`samples × joints`, row by row), or is empty
/// where the drives do not report it. A value that is missing from one sample is NaN: it is skipped, and said so.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Telemetry {
    /// When each sample was taken, s.
    pub time: Vec<f64>,
    /// Angle of the motor shaft, rad, from the place where the joint is at its zero and its transmission relaxed.
    pub motor_position: Vec<f64>,
    /// Position of the joint, rad or m.
    pub output_position: Vec<f64>,
    /// Its velocity.
    pub output_velocity: Vec<f64>,
    /// Its acceleration.
    pub output_acceleration: Vec<f64>,
    /// Torque of the motor at its shaft, N m.
    pub motor_torque: Vec<f64>,
    /// Current of the motor, A.
    pub motor_current: Vec<f64>,
    /// Torque through the transmission as a sensor at the joint reads it, N m or N.
    pub transmission_torque: Vec<f64>,
    /// Torque that the arm exerts on its surroundings, at the joint, N m or N; empty: none.
    pub external_torque: Vec<f64>,
}

/// Which columns there are.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Signals {
    /// Angle of the motor shaft.
    pub motor_position: bool,
    /// Position of the joint.
    pub output_position: bool,
    /// Velocity of the joint.
    pub output_velocity: bool,
    /// Acceleration of the joint.
    pub output_acceleration: bool,
    /// Torque of the motor.
    pub motor_torque: bool,
    /// Current of the motor.
    pub motor_current: bool,
    /// Torque through the transmission.
    pub transmission_torque: bool,
    /// Torque on the surroundings.
    pub external_torque: bool,
}

impl Telemetry {
    /// How many samples there are.
    #[must_use]
    pub fn sample_count(&self) -> usize {
        self.time.len()
    }

    /// Which columns there are.
    #[must_use]
    pub fn signals(&self) -> Signals {
        Signals {
            motor_position: !self.motor_position.is_empty(),
            output_position: !self.output_position.is_empty(),
            output_velocity: !self.output_velocity.is_empty(),
            output_acceleration: !self.output_acceleration.is_empty(),
            motor_torque: !self.motor_torque.is_empty(),
            motor_current: !self.motor_current.is_empty(),
            transmission_torque: !self.transmission_torque.is_empty(),
            external_torque: !self.external_torque.is_empty(),
        }
    }

    /// Checks the shape for an arm of so many joints. Values are not looked at: one that is no number is a missing one.
    ///
    /// # Errors
    /// Columns of another length, and more samples than one block may have.
    pub fn check(&self, joint_count: usize) -> Result<(), Vec<Invalid>> {
        let samples = self.sample_count();
        if samples > TELEMETRY_SAMPLES_MAX {
            let message = format!("{samples} samples, the most in one block is {TELEMETRY_SAMPLES_MAX}");
            return Err(vec![Invalid::new("time", message)]);
        }
        let wanted = samples * joint_count;
        let findings: Vec<Invalid> = self
            .columns()
            .into_iter()
            .filter(|(_, column)| !column.is_empty() && column.len() != wanted)
            .map(|(name, column)| {
                let message = format!(
                    "{} values, but {samples} samples of {joint_count} joints are {wanted}",
                    column.len()
                );
                Invalid::new(name, message)
            })
            .collect();
        if findings.is_empty() { Ok(()) } else { Err(findings) }
    }

    fn columns(&self) -> [(&'static str, &[f64]); 8] {
        [
            ("motor_position", &self.motor_position),
            ("output_position", &self.output_position),
            ("output_velocity", &self.output_velocity),
            ("output_acceleration", &self.output_acceleration),
            ("motor_torque", &self.motor_torque),
            ("motor_current", &self.motor_current),
            ("transmission_torque", &self.transmission_torque),
            ("external_torque", &self.external_torque),
        ]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_block_is_checked_by_its_shape() {
        let mut block = Telemetry {
            time: vec![0.0, 0.001],
            output_position: vec![0.0; 4],
            motor_torque: vec![f64::NAN; 4],
            ..Telemetry::default()
        };
        assert_eq!(block.check(2), Ok(()));
        let findings = block.check(3).expect_err("two joints");
        let paths: Vec<&str> = findings.iter().map(|finding| finding.path.as_str()).collect();
        assert_eq!(paths, ["output_position", "motor_torque"]);
        assert!(block.signals().motor_torque && !block.signals().motor_current);

        block.time = vec![0.0; 1_000_000];
        let findings = block.check(2).expect_err("a million samples");
        assert_eq!((findings.len(), findings[0].path.as_str()), (1, "time"));
    }
}
