//! What the motors must do for the arm to follow a motion exactly.
//!
//! ```text
//! τJ,d = M(q)·q̈ + C(q, q̇)·q̇ + g(q) + Fq(q̇)          through the transmission
//! Θd   = q + τE⁻¹(τJ,d)                                  the motor, seen from the joint
//! Θ̇d   = q̇ + τ̇J,d/K       Θ̈d = q̈ + (τ̈J,d − K′·Φ̇²)/K       Φ̇ = τ̇J,d/K
//! τm   = B·Θ̈d + τJ,d + FΘ(Θ̇d)       i = τm/(ξ·k_t)
//! ```
//!
//! ("controlling a robot arm based on adaptive friction", eq 3 to 13; De Luca 2000 for the fourth derivative.) τ̇J,d and τ̈J,d come from
//! inverse dynamics in Taylor arithmetic (`series.rs`), so that they are exact where q has four derivatives. Where one up to the
//! third jumps, the transmission is taken as stiff: Θ̇d = q̇, Θ̈d = q̈; [`Smoothness`] says where. The damping of the
//! transmission is left out of the deformation: D·Φ̇ is D/K times the rate of a torque, a thousandth of it.
//! Everything is seen from the joint; N m or N, rad or m.

use super::loss::Loss;
use super::reference::{Derivatives, Reference};
use super::rehearse::outcome::TransmissionRange;
use super::series::Series;
use super::transmission::Transmission;
use crate::budget::{Budget, Stopped};
use crate::dynamics::rnea::{LinkWrench, rnea};
use crate::robot::Robot;
use crate::robot::spec::Drive;
use crate::tolerance::BUDGET_STRIDE;

/// What one joint is asked for at one time.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Desired {
    /// q.
    pub position: f64,
    /// q̇.
    pub velocity: f64,
    /// q̈.
    pub acceleration: f64,
    /// M·q̈ + C·q̇ + g, without friction.
    pub rigid_torque: f64,
    /// g alone.
    pub gravity_torque: f64,
    /// τJ,d, with the model's friction on the joint's side.
    pub transmission_torque: f64,
    /// τE⁻¹(τJ,d); 0 where the transmission is rigid.
    pub deformation: f64,
    /// Θ̇d.
    pub motor_velocity: f64,
    /// Θ̈d.
    pub motor_acceleration: f64,
    /// τm, with the model's friction.
    pub motor_torque: f64,
    /// A; `None` where the torque constant is not known.
    pub motor_current: Option<f64>,
}

/// How smooth a motion is, and what that means for the motors.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Smoothness {
    /// How many derivatives of q are continuous everywhere, rest before and after included: 3 is what an elastic transmission can
    /// follow exactly.
    pub continuity: u32,
    /// Steps at which the motor's velocity and acceleration are exact.
    pub exact_steps: usize,
    /// All steps. At the others Θ̈d = q̈, a stiff transmission.
    pub steps: usize,
}

/// The feed-forward of a whole motion.
#[derive(Debug, Clone, PartialEq)]
pub struct FeedForward {
    /// Between two steps, s.
    pub period: f64,
    /// Joints of the arm.
    pub joint_count: usize,
    /// Step by step, one a joint.
    pub desired: Vec<Desired>,
    /// Where it is exact.
    pub smoothness: Smoothness,
    /// Step by step, whether the motor's velocity and acceleration are exact.
    pub exact: Vec<bool>,
}

impl FeedForward {
    /// What is asked for at a step; after the last one, that.
    #[must_use]
    pub fn step(&self, step: usize) -> &[Desired] {
        let step = step.min(self.smoothness.steps - 1);
        &self.desired[step * self.joint_count..(step + 1) * self.joint_count]
    }
}

/// The drive of one joint, ready to compute with.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Joint {
    /// B = ξ²·I_m.
    pub(crate) inertia: f64,
    /// `None`: rigid.
    pub(crate) transmission: Option<Transmission>,
    pub(crate) motor: Loss,
    pub(crate) output: Loss,
    /// Kτ = ξ·k_t, N m/A at the joint.
    pub(crate) torque_constant: Option<f64>,
}

impl Joint {
    /// Of every joint of a robot.
    pub(crate) fn all(robot: &Robot) -> Vec<Self> {
        let joints = robot.spec().joints.iter();
        joints.map(|joint| Self::new(&joint.drive)).collect()
    }

    /// A transmission needs a rotor to swing against: without one the joint is rigid.
    pub(crate) fn new(drive: &Drive) -> Self {
        let inertia = drive.gear_ratio * drive.gear_ratio * drive.rotor_inertia;
        Self {
            inertia,
            transmission: Transmission::new(drive).filter(|_| inertia > 0.0),
            motor: Loss::of_motor(drive),
            output: Loss::of_joint(drive),
            torque_constant: drive.torque_constant.map(|constant| constant * drive.gear_ratio),
        }
    }
}

/// Computes what the motors of a robot must do along a motion. The robot carries what the motion was planned with.
///
/// # Errors
/// A budget that ended. A torque that a transmission's polynomial does not reach is no error: it is said where.
pub fn feed_forward(
    robot: &Robot,
    reference: &Reference,
    budget: &Budget<'_>,
) -> Result<Result<FeedForward, TransmissionRange>, Stopped> {
    let count = reference.joint_count;
    let joints = Joint::all(robot);
    let mut dynamics = TorqueSeries::new(count);
    let mut desired = Vec::with_capacity(reference.states.len());
    for step in 0..reference.steps() {
        if step % BUDGET_STRIDE == 0 {
            budget.check()?;
        }
        let states = reference.at(step);
        let smooth = reference.smooth[step];
        dynamics.compute(robot, states, smooth);
        for (index, (joint, state)) in joints.iter().zip(states).enumerate() {
            match joint.desired(state, dynamics.torque[index], dynamics.gravity[index], smooth) {
                Ok(found) => desired.push(found),
                Err((torque, largest)) => {
                    return Ok(Err(TransmissionRange {
                        joint: index,
                        time: step as f64 * reference.period,
                        torque,
                        largest,
                    }));
                }
            }
        }
    }
    Ok(Ok(FeedForward {
        period: reference.period,
        joint_count: count,
        desired,
        smoothness: Smoothness {
            continuity: reference.continuity,
            exact_steps: reference.smooth.iter().filter(|smooth| **smooth).count(),
            steps: reference.steps(),
        },
        exact: reference.smooth.clone(),
    }))
}

/// Torques of the rigid bodies and of gravity, with their rates.
struct TorqueSeries {
    q: Vec<Series>,
    qd: Vec<Series>,
    qdd: Vec<Series>,
    links: Vec<LinkWrench<Series>>,
    torque: Vec<Series>,
    gravity: Vec<Series>,
}

impl TorqueSeries {
    fn new(count: usize) -> Self {
        let zeros = || vec![Series::ZERO; count];
        Self {
            q: zeros(),
            qd: zeros(),
            qdd: zeros(),
            links: vec![LinkWrench::zero(Series::ZERO); count],
            torque: zeros(),
            gravity: zeros(),
        }
    }

    fn compute(&mut self, robot: &Robot, states: &[Derivatives], smooth: bool) {
        for (joint, &[q, qd, qdd, jerk, snap]) in states.iter().enumerate() {
            let (jerk, snap) = if smooth { (jerk, snap) } else { (0.0, 0.0) };
            self.q[joint] = Series::of_derivatives([q, qd, qdd]);
            self.qd[joint] = Series::of_derivatives([qd, qdd, jerk]);
            self.qdd[joint] = Series::of_derivatives([qdd, jerk, snap]);
        }
        rnea::<Series, true>(
            robot.chain(),
            &self.q,
            &self.qd,
            &self.qdd,
            &mut self.links,
            &mut self.torque,
            &mut self.gravity,
        );
    }
}

impl Joint {
    /// What is asked for at a state; the torque and the largest one where the transmission does not pass it.
    fn desired(
        &self,
        state: &Derivatives,
        rigid: Series,
        gravity: Series,
        smooth: bool,
    ) -> Result<Desired, (f64, f64)> {
        let &[position, velocity, acceleration, jerk, _] = state;
        let speed = Series::of_derivatives([velocity, acceleration, jerk]);
        let [torque, rate, second] = (rigid + self.output.series(speed, gravity)).derivatives();
        let (mut motor_velocity, mut motor_acceleration) = (velocity, acceleration);
        let mut deformation = 0.0;
        if let Some(transmission) = &self.transmission {
            deformation = transmission
                .deformation(torque)
                .ok_or((torque, transmission.largest().torque))?;
            let stiffness = transmission.stiffness(deformation);
            let winding = rate / stiffness;
            let bend = transmission.stiffness_slope(deformation) * winding * winding;
            if smooth {
                motor_velocity += winding;
                motor_acceleration += (second - bend) / stiffness;
            }
        }
        let motor_torque =
            self.inertia * motor_acceleration + torque + self.motor.sliding(motor_velocity, gravity.0[0]);
        Ok(Desired {
            position,
            velocity,
            acceleration,
            rigid_torque: rigid.0[0],
            gravity_torque: gravity.0[0],
            transmission_torque: torque,
            deformation,
            motor_velocity,
            motor_acceleration,
            motor_torque,
            motor_current: self.torque_constant.map(|constant| motor_torque / constant),
        })
    }
}

#[cfg(test)]
mod tests;
