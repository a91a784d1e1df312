//! Which signals serve which estimate ("controlling a robot arm based on adaptive friction", eq 10 and 12):
//!
//! | friction | signals | from |
//! |---|---|---|
//! | total, Fq + FΘ | q (or Θ), motor torque or current | τmotor − B·Θ̈ − rigid(q, q̇, q̈) − τext |
//! | joint side, Fq | q, and τJ | τJ − rigid(q, q̇, q̈) − τext |
//! | joint side, Fq | q (or Θ), motor torque or current | the total, less FΘ as the model has it |
//! | motor side, FΘ | q (or Θ), motor torque or current, and τJ | τmotor − B·Θ̈ − τJ |
//! | motor side, FΘ | q (or Θ), motor torque or current | the total, less Fq as the model has it |
//!
//! τJ is what a torque sensor behind the gear reads, or else τE(Φ) + D·Φ̇ of the deformation Φ = Θ − q, which takes both
//! positions and a stiffness. One position alone stands for both, Θ = q: a stiff transmission. Positions alone, or torques alone, say
//! nothing. Where several rows serve, the upper one is taken. Rows that take the other side from the model are refused where the model has
//! no friction there on any joint: the total would pass for one side's.

use crate::drive::telemetry::Signals;
use crate::error::Invalid;
use crate::robot::Robot;
use crate::robot::spec::{Drive, Friction};

use super::options::{EstimatorMethod, EstimatorOptions, FrictionSide};

/// Where the joint's position is from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PositionSource {
    /// The output's encoder.
    Output,
    /// The motor's, over the gear ratio.
    Motor,
}

/// Where the motor's torque is from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MotorTorqueSource {
    /// It is reported.
    Torque,
    /// The current, times the torque constant.
    Current,
}

/// Where the transmission's torque is from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TransmissionTorqueSource {
    /// A torque sensor behind the gear.
    Sensor,
    /// The deformation between motor and output position.
    Deformation,
}

/// The signals that an estimate is made of.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Combination {
    /// Which friction it is.
    pub side: FrictionSide,
    /// The joint's position.
    pub position: PositionSource,
    /// The motor's acceleration is its own, not the joint's.
    pub motor_acceleration: bool,
    /// The motor's torque; `None`: not needed.
    pub motor_torque: Option<MotorTorqueSource>,
    /// The transmission's torque; `None`: not had, the rigid body stands for it.
    pub transmission_torque: Option<TransmissionTorqueSource>,
    /// The torque on the surroundings is taken off.
    pub external_torque: bool,
    /// The friction of the other side is taken from the model.
    pub other_side_from_model: bool,
}

impl Combination {
    /// Which signals serve an estimate, for a robot and options.
    ///
    /// # Errors
    /// What is missing, each with what would serve.
    pub fn of(robot: &Robot, options: &EstimatorOptions, signals: Signals) -> Result<Self, Vec<Invalid>> {
        let mut findings = Vec::new();
        let filtered = options.bandwidth.is_some();
        if !signals.output_position && !signals.motor_position {
            let message = "friction is torque at a speed: output_position, motor_position or both must be given";
            findings.push(Invalid::new("output_position", message));
        }
        if !filtered {
            for (path, given) in [
                ("output_position", signals.output_position),
                ("output_velocity", signals.output_velocity),
                ("output_acceleration", signals.output_acceleration),
            ] {
                if !given {
                    findings.push(Invalid::new(
                        path,
                        "must be given where no bandwidth is, which it could be derived with",
                    ));
                }
            }
        }
        let motor_torque = motor_torque(robot, signals, &mut findings);
        let transmission_torque = transmission_torque(robot, signals, filtered);
        let needs_motor = match options.side {
            FrictionSide::Total | FrictionSide::Motor => true,
            FrictionSide::Joint => transmission_torque.is_none(),
        };
        if needs_motor && motor_torque.is_none() && findings.is_empty() {
            let message = match options.side {
                FrictionSide::Joint => {
                    "the joint's friction takes motor_torque or motor_current, or transmission_torque, or both positions and a \
                     stiffness on every joint"
                }
                FrictionSide::Total | FrictionSide::Motor => {
                    "friction on the motor's side takes motor_torque or motor_current; transmission_torque alone, or both \
                     positions and a stiffness, give that of the joint's side"
                }
            };
            findings.push(Invalid::new("motor_torque", message));
        }
        if findings.is_empty() && transmission_torque.is_none() {
            known_other_side(robot, options.side, &mut findings);
        }
        observer(robot, options, needs_motor, &mut findings);
        if !findings.is_empty() {
            return Err(findings);
        }
        let used = match options.side {
            FrictionSide::Total => None,
            FrictionSide::Joint | FrictionSide::Motor => transmission_torque,
        };
        Ok(Self {
            side: options.side,
            position: if signals.output_position {
                PositionSource::Output
            } else {
                PositionSource::Motor
            },
            motor_acceleration: needs_motor && signals.motor_position && filtered,
            motor_torque: motor_torque.filter(|_| needs_motor),
            transmission_torque: used,
            // τJ is behind the gear already: what the arm does beyond it does not matter to the motor's side
            external_torque: signals.external_torque && (used.is_none() || options.side == FrictionSide::Joint),
            other_side_from_model: used.is_none() && options.side != FrictionSide::Total,
        })
    }

    /// Whether the rigid body's torque is part of it.
    pub(super) fn needs_rigid_torque(&self) -> bool {
        self.transmission_torque.is_none() || self.side == FrictionSide::Joint
    }
}

fn motor_torque(robot: &Robot, signals: Signals, findings: &mut Vec<Invalid>) -> Option<MotorTorqueSource> {
    if signals.motor_torque {
        return Some(MotorTorqueSource::Torque);
    }
    if !signals.motor_current {
        return None;
    }
    for (joint, spec) in robot.spec().joints.iter().enumerate() {
        if spec.drive.torque_constant.is_none() {
            let message = format!(
                "the current of joint {joint} \"{}\" says nothing without a torque constant: state its `drive.torque_constant_nm_per_a` in the description",
                spec.name
            );
            findings.push(Invalid::new(format!("joints[{joint}].drive.torque_constant"), message));
        }
    }
    Some(MotorTorqueSource::Current)
}

fn transmission_torque(robot: &Robot, signals: Signals, filtered: bool) -> Option<TransmissionTorqueSource> {
    if signals.transmission_torque {
        return Some(TransmissionTorqueSource::Sensor);
    }
    let is_elastic = robot
        .spec()
        .joints
        .iter()
        .all(|joint| !joint.drive.stiffness.is_empty());
    let both = signals.motor_position && signals.output_position;
    (both && is_elastic && filtered).then_some(TransmissionTorqueSource::Deformation)
}

/// Without a torque of the transmission, one side is the total less the other, which the model must know.
fn known_other_side(robot: &Robot, side: FrictionSide, findings: &mut Vec<Invalid>) {
    let (other, known): (_, fn(&Drive) -> &Friction) = match side {
        FrictionSide::Total => return,
        FrictionSide::Joint => ("motor's", |drive| &drive.motor_friction),
        FrictionSide::Motor => ("joint's", |drive| &drive.joint_friction),
    };
    if robot.spec().joints.iter().any(|joint| !known(&joint.drive).is_zero()) {
        return;
    }
    let message = format!(
        "friction of one side takes transmission_torque, or motor_position beside output_position with a stiffness on every \
         joint, or a model that has the {other} side's friction: this one has none on any joint; side total takes what is given"
    );
    findings.push(Invalid::new("transmission_torque", message));
}

fn observer(robot: &Robot, options: &EstimatorOptions, needs_motor: bool, findings: &mut Vec<Invalid>) {
    if options.method != EstimatorMethod::Observer {
        return;
    }
    if !needs_motor {
        let message = "the observer watches the motor: the joint's friction from the transmission's torque is for the other methods";
        findings.push(Invalid::new("method", message));
    }
    for (joint, drive) in robot.drives().iter().enumerate() {
        if drive.armature <= 0.0 {
            let message = "the observer needs the rotor's inertia";
            findings.push(Invalid::new(format!("joints[{joint}].drive.rotor_inertia"), message));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_arms::{planar, robot};

    fn signals(names: &[&str]) -> Signals {
        let has = |name: &str| names.contains(&name);
        Signals {
            motor_position: has("motor"),
            output_position: has("output"),
            output_velocity: has("velocity"),
            output_acceleration: has("acceleration"),
            motor_torque: has("torque"),
            motor_current: has("current"),
            transmission_torque: has("sensor"),
            external_torque: has("external"),
        }
    }

    fn of(side: FrictionSide, names: &[&str], elastic: bool) -> Result<Combination, Vec<Invalid>> {
        let mut spec = planar();
        spec.joints[1].drive.motor_friction.viscous = 1e-4;
        spec.joints[1].drive.joint_friction.viscous = 1.0;
        if elastic {
            for joint in &mut spec.joints {
                joint.drive.stiffness = vec![1e4];
            }
        }
        let options = EstimatorOptions {
            side,
            ..EstimatorOptions::default()
        };
        Combination::of(&robot(spec), &options, signals(names))
    }

    #[test]
    fn each_row_of_the_table() {
        let total = of(FrictionSide::Total, &["output", "torque"], true).expect("total");
        assert!(total.transmission_torque.is_none() && !total.other_side_from_model && !total.motor_acceleration);
        let joint = of(FrictionSide::Joint, &["output", "sensor"], false).expect("joint by sensor");
        assert!(joint.motor_torque.is_none() && joint.needs_rigid_torque() && !joint.other_side_from_model);
        let joint = of(FrictionSide::Joint, &["output", "motor"], true).expect("joint by deformation");
        assert_eq!(joint.transmission_torque, Some(TransmissionTorqueSource::Deformation));
        let joint = of(FrictionSide::Joint, &["motor", "torque"], false).expect("joint by motor");
        assert!(joint.other_side_from_model && joint.position == PositionSource::Motor);
        let motor = of(FrictionSide::Motor, &["output", "motor", "torque", "external"], true).expect("motor");
        assert!(!motor.needs_rigid_torque() && motor.motor_acceleration && !motor.external_torque);
        let motor = of(FrictionSide::Motor, &["output", "torque", "external"], true).expect("motor by rigid body");
        assert!(motor.other_side_from_model && motor.external_torque);
    }

    #[test]
    fn what_is_missing_is_said() {
        let path = |findings: Result<Combination, Vec<Invalid>>| findings.expect_err("too little")[0].path.clone();
        assert_eq!(path(of(FrictionSide::Total, &["torque"], false)), "output_position");
        assert_eq!(path(of(FrictionSide::Total, &["output"], false)), "motor_torque");
        assert_eq!(
            path(of(FrictionSide::Total, &["output", "sensor"], false)),
            "motor_torque"
        );
        assert_eq!(
            path(of(FrictionSide::Joint, &["output", "motor"], false)),
            "motor_torque"
        );
        let path = path(of(FrictionSide::Total, &["output", "current"], false));
        assert_eq!(path, "joints[0].drive.torque_constant");
    }

    /// Without anything that tells the sides apart, the total would pass for one of them.
    #[test]
    fn a_side_needs_a_sensor_or_a_model_of_the_other_side() {
        let without = |side| {
            let mut spec = planar();
            for joint in &mut spec.joints {
                joint.drive.motor_friction = Friction::default();
                joint.drive.joint_friction = Friction::default();
            }
            let options = EstimatorOptions {
                side,
                ..EstimatorOptions::default()
            };
            Combination::of(&robot(spec), &options, signals(&["output", "torque"]))
        };
        assert!(without(FrictionSide::Total).is_ok());
        for (side, other) in [
            (FrictionSide::Joint, "motor's side"),
            (FrictionSide::Motor, "joint's side"),
        ] {
            let found = without(side).expect_err("nothing tells them apart");
            assert_eq!((found.len(), found[0].path.as_str()), (1, "transmission_torque"));
            assert!(found[0].message.contains(other), "{found:?}");
        }
    }

    #[test]
    fn the_observer_needs_a_rotor_and_no_bandwidth_needs_rates() {
        let options = EstimatorOptions {
            method: EstimatorMethod::Observer,
            bandwidth: None,
            ..EstimatorOptions::default()
        };
        let findings = Combination::of(&robot(planar()), &options, signals(&["output", "torque"])).expect_err("two");
        let paths: Vec<&str> = findings.iter().map(|finding| finding.path.as_str()).collect();
        assert_eq!(
            paths,
            [
                "output_velocity",
                "output_acceleration",
                "joints[0].drive.rotor_inertia",
                "joints[1].drive.rotor_inertia"
            ]
        );
    }
}
