//! One run: the controller and the simulated arm, period by period, and what is kept of it.

use nalgebra::Isometry3;

use super::outcome::{FrictionFollowed, FrictionPoint, JointRun, Run, RunEnd, Trace, TraceColumns, TransmissionRange};
use super::request::{Encoder, FrictionTruth, RehearsalRequest};
use crate::budget::Budget;
use crate::drive::controller::{Command, Controller, Measured};
use crate::drive::encoder::Noise;
use crate::drive::feedforward::{Desired, FeedForward, Joint};
use crate::drive::plant::{Drift, Plant, PlantJoint, Stuck, Wrench};
use crate::kinematics;
use crate::plan::Failure;
use crate::robot::Robot;
use crate::tolerance::REHEARSAL_DIVERGED;

/// Moments at which it is said how friction was followed.
const FRICTION_POINTS: usize = 11;

/// What is run, on which arm.
pub(super) struct Rehearsed<'a> {
    pub(super) request: &'a RehearsalRequest,
    /// The simulated arm.
    pub(super) truth: &'a Robot,
    pub(super) planned: &'a FeedForward,
    pub(super) tcp: Isometry3<f64>,
}

impl Rehearsed<'_> {
    pub(super) fn run(&self, controller: &Controller, budget: &Budget<'_>) -> Result<Run, Failure> {
        let steps = self.planned.smoothness.steps;
        let count = self.planned.joint_count;
        let first = self.planned.step(0);
        let (q, qd): (Vec<f64>, Vec<f64>) = first.iter().map(|at| (at.position, at.velocity)).unzip();
        let mut plant = Plant::new(self.truth, self.plant_joints(), &q, &qd);
        let mut noise = Noise::new(self.request.seed);
        let mut states = controller.start();
        let mut measured = vec![Measured::default(); count];
        let mut commands = vec![Command::default(); count];
        let (mut torque, mut before) = (vec![0.0; count], vec![0.0; count]);
        let mut sums = Sums::new(count, controller, self.request, self.planned);
        let mut end = RunEnd::Completed;
        for step in 0..steps {
            let desired = self.planned.step(step);
            let time = step as f64 * self.request.period;
            self.measure(&plant, &mut noise, &mut measured);
            controller.step(
                &mut states,
                &measured,
                desired,
                self.planned.step(step + 1),
                &mut commands,
            );
            self.keep(step, &plant, desired, &commands, &mut sums);
            if let Some(stop) = self.outside(&plant, desired, time) {
                end = stop;
                break;
            }
            // what is commanded at the last step has no period to act in
            if step + 1 == steps {
                break;
            }
            for ((torque, command), sum) in torque.iter_mut().zip(&commands).zip(&mut sums.joints) {
                *torque = command.torque;
                sum.acted(command, self.request.period);
            }
            before.copy_from_slice(plant.motor_position());
            match plant.advance(&torque, self.wrench(time), self.request.period, budget) {
                Ok(()) => {}
                Err(Stuck::Stopped) => return Err(Failure::Stopped),
                Err(Stuck::TooStiff) => {
                    end = RunEnd::TooStiff { time };
                    break;
                }
                Err(Stuck::Diverged) => {
                    let joint = farthest(plant.position(), desired);
                    end = RunEnd::Diverged { joint, time };
                    break;
                }
            }
            for ((torque, before), after) in torque.iter().zip(&before).zip(plant.motor_position()) {
                let work = torque * (after - before);
                sums.work += work;
                sums.given += work.max(0.0);
            }
        }
        Ok(sums.into_run(end, plant.steps()))
    }

    fn plant_joints(&self) -> Vec<PlantJoint> {
        let joints = self.truth.spec().joints.iter().enumerate();
        joints
            .map(|(index, joint)| {
                let truth = self.request.friction.get(index).copied().unwrap_or_default();
                let FrictionTruth {
                    coulomb_scale,
                    viscous_scale,
                    coulomb_rate,
                    viscous_rate,
                } = truth;
                PlantJoint {
                    joint: Joint::new(&joint.drive),
                    dry: Drift {
                        scale: coulomb_scale,
                        rate: coulomb_rate,
                    },
                    wet: Drift {
                        scale: viscous_scale,
                        rate: viscous_rate,
                    },
                }
            })
            .collect()
    }

    fn measure(&self, plant: &Plant<'_>, noise: &mut Noise, measured: &mut [Measured]) {
        let positions = plant.motor_position().iter().zip(plant.position());
        for (joint, (measured, (motor, output))) in measured.iter_mut().zip(positions).enumerate() {
            let encoder: Encoder = self.request.encoders.get(joint).copied().unwrap_or_default();
            measured.motor_position = noise.shown(*motor, encoder.motor_step, encoder.motor_noise);
            measured.output_position = encoder
                .has_output
                .then(|| noise.shown(*output, encoder.output_step, encoder.output_noise));
        }
    }

    /// The sum of the wrenches that act in the period from a time on.
    fn wrench(&self, time: f64) -> Option<Wrench> {
        let middle = time + 0.5 * self.request.period;
        let acting = self
            .request
            .wrenches
            .iter()
            .filter(|pulse| pulse.begin <= middle && middle < pulse.end);
        acting.fold(None, |sum: Option<Wrench>, pulse| {
            let sum = sum.unwrap_or_default();
            Some(Wrench {
                force: sum.force + pulse.force,
                moment: sum.moment + pulse.moment,
            })
        })
    }

    /// Why a run cannot go on.
    fn outside(&self, plant: &Plant<'_>, desired: &[Desired], time: f64) -> Option<RunEnd> {
        let positions = plant.position().iter().zip(plant.motor_position()).zip(desired);
        for (joint, ((q, motor), desired)) in positions.enumerate() {
            // not a number is too far
            if !((q - desired.position).abs() <= REHEARSAL_DIVERGED && motor.is_finite()) {
                return Some(RunEnd::Diverged { joint, time });
            }
            let Some(elastic) = &plant.arm.joints[joint].joint.transmission else {
                continue;
            };
            let (deformation, largest) = (motor - q, elastic.largest());
            if deformation.abs() > largest.deformation {
                return Some(RunEnd::TransmissionRange(TransmissionRange {
                    joint,
                    time,
                    torque: largest.torque.copysign(deformation),
                    largest: largest.torque,
                }));
            }
        }
        None
    }

    fn keep(&self, step: usize, plant: &Plant<'_>, desired: &[Desired], commands: &[Command], sums: &mut Sums) {
        let time = step as f64 * self.request.period;
        let planned: Vec<f64> = desired.iter().map(|at| at.position).collect();
        let (should, is) = (
            kinematics::pose(self.truth, &planned, &self.tcp),
            kinematics::pose(self.truth, plant.position(), &self.tcp),
        );
        let distance = (is.translation.vector - should.translation.vector).norm();
        sums.tool(time, distance, is.rotation.angle_to(&should.rotation));
        let traced = self.request.trace_every.is_some_and(|every| step % every == 0);
        if let Some(trace) = sums.trace.as_mut().filter(|_| traced) {
            trace.time.push(time);
            trace.tool_error.push(distance);
        }
        for (joint, (desired, command)) in desired.iter().zip(commands).enumerate() {
            let (q, motor) = (plant.position()[joint], plant.motor_position()[joint]);
            let (through, friction) = plant.torques(joint);
            sums.joints[joint].seen(time, q - desired.position, motor - q, command);
            sums.friction(step, joint, time, command.friction, friction);
            if let Some(trace) = sums.trace.as_mut().filter(|_| traced) {
                let columns = &mut trace.joints[joint];
                columns.planned_position.push(desired.position);
                columns.position.push(q);
                columns.motor_position.push(motor);
                columns.velocity.push(plant.velocity()[joint]);
                columns.motor_torque.push(command.torque);
                columns.transmission_torque.push(through);
                columns.assumed_friction.push(command.friction);
                columns.true_friction.push(friction);
            }
        }
        sums.seen += 1;
    }
}

/// The joint that is farthest from where the plan has it.
fn farthest(positions: &[f64], desired: &[Desired]) -> usize {
    let errors = positions.iter().zip(desired).map(|(q, at)| (q - at.position).abs());
    errors
        .enumerate()
        .fold(
            (0, 0.0),
            |worst, (joint, error)| if error > worst.1 { (joint, error) } else { worst },
        )
        .0
}

/// What is added up over a run.
struct Sums {
    joints: Vec<JointSums>,
    friction: Vec<FrictionFollowed>,
    /// Steps at which friction is stated.
    friction_stride: usize,
    /// From which step on the last quarter is.
    last_quarter: usize,
    seen: usize,
    tool_peak: (f64, f64),
    tool_squared: f64,
    tool_angle: f64,
    work: f64,
    given: f64,
    trace: Option<Trace>,
}

#[derive(Default)]
struct JointSums {
    error_peak: (f64, f64),
    error_squared: f64,
    error_end: f64,
    demanded_peak: (f64, f64),
    torque_squared: f64,
    current_squared: f64,
    current_peak: Option<f64>,
    acted: f64,
    limited: f64,
    limit: f64,
    deformation: f64,
}

impl JointSums {
    fn seen(&mut self, time: f64, error: f64, deformation: f64, command: &Command) {
        self.error_squared += error * error;
        self.error_end = error;
        if error.abs() > self.error_peak.0 {
            self.error_peak = (error.abs(), time);
        }
        if command.demanded.abs() > self.demanded_peak.0.abs() {
            self.demanded_peak = (command.demanded, time);
        }
        if deformation.abs() > self.deformation.abs() {
            self.deformation = deformation;
        }
    }

    fn acted(&mut self, command: &Command, period: f64) {
        self.acted += period;
        self.torque_squared += command.torque * command.torque * period;
        if let Some(current) = command.current {
            self.current_squared += current * current * period;
            let before = self.current_peak.unwrap_or(0.0);
            self.current_peak = Some(if current.abs() > before.abs() { current } else { before });
        }
        if command.demanded.abs() > self.limit {
            self.limited += period;
        }
    }
}

impl Sums {
    fn new(count: usize, controller: &Controller, request: &RehearsalRequest, planned: &FeedForward) -> Self {
        let joints = controller.joints().iter().map(|joint| JointSums {
            limit: joint.limit(),
            ..JointSums::default()
        });
        let steps = planned.smoothness.steps;
        Self {
            joints: joints.collect(),
            friction: vec![FrictionFollowed::default(); count],
            friction_stride: (steps - 1).div_ceil(FRICTION_POINTS - 1).max(1),
            last_quarter: steps - steps.div_ceil(4),
            seen: 0,
            tool_peak: (0.0, 0.0),
            tool_squared: 0.0,
            tool_angle: 0.0,
            work: 0.0,
            given: 0.0,
            trace: request.trace_every.map(|_| Trace {
                joints: vec![TraceColumns::default(); count],
                ..Trace::default()
            }),
        }
    }

    fn tool(&mut self, time: f64, distance: f64, angle: f64) {
        self.tool_squared += distance * distance;
        self.tool_angle = self.tool_angle.max(angle);
        if distance > self.tool_peak.0 {
            self.tool_peak = (distance, time);
        }
    }

    fn friction(&mut self, step: usize, joint: usize, time: f64, assumed: f64, truth: f64) {
        let followed = &mut self.friction[joint];
        let error = (assumed - truth) * (assumed - truth);
        followed.truth_rms += truth * truth;
        followed.error_rms += error;
        if step >= self.last_quarter {
            followed.error_rms_last += error;
        }
        if step % self.friction_stride == 0 {
            followed.points.push(FrictionPoint { time, assumed, truth });
        }
    }

    fn into_run(self, end: RunEnd, integrator_steps: u64) -> Run {
        let count = self.seen.max(1) as f64;
        let last = self.seen.saturating_sub(self.last_quarter).max(1) as f64;
        let joints = self.joints.into_iter().zip(self.friction).map(|(sums, mut friction)| {
            friction.truth_rms = (friction.truth_rms / count).sqrt();
            friction.error_rms = (friction.error_rms / count).sqrt();
            friction.error_rms_last = (friction.error_rms_last / last).sqrt();
            let acted = sums.acted.max(f64::MIN_POSITIVE);
            let known = sums.limit.is_finite().then_some(sums.limit);
            JointRun {
                error_peak: sums.error_peak.0,
                error_time: sums.error_peak.1,
                error_rms: (sums.error_squared / count).sqrt(),
                error_end: sums.error_end,
                torque_peak: sums.demanded_peak.0,
                torque_time: sums.demanded_peak.1,
                torque_rms: (sums.torque_squared / acted).sqrt(),
                torque_limit: known,
                margin: known.map(|limit| (limit - sums.demanded_peak.0.abs()) / limit),
                limited_time: sums.limited,
                current_peak: sums.current_peak,
                current_rms: sums.current_peak.map(|_| (sums.current_squared / acted).sqrt()),
                deformation_peak: sums.deformation,
                friction,
            }
        });
        Run {
            end,
            steps: self.seen,
            joints: joints.collect(),
            tool_error_peak: self.tool_peak.0,
            tool_error_time: self.tool_peak.1,
            tool_error_rms: (self.tool_squared / count).sqrt(),
            tool_angle_peak: self.tool_angle,
            work: self.work,
            energy_given: self.given,
            integrator_steps,
            trace: self.trace,
        }
    }
}
