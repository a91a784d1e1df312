//! Signs that a log is not in the units and directions that it is taken for: rad or m, seconds, torques that drive the joint in its
//! positive direction.
//!
//! A log is cut into windows of a tenth of a second. With Δq what the position changes by in one and I = ∫q̇ dt of the speeds beside it,
//!
//! ```text
//! r = Σ I·Δq / Σ Δq²            57.3: speeds in degrees; 1/57.3: positions in degrees; 1000: times in ms; −1: sign
//! ρ = Σ τ·m / √(Σ τ² · Σ m²)    −1: sign of the torque
//! ```
//!
//! where τ is the mean torque of two windows and m what the model takes (rigid body, rotor, friction) at the position between them, with
//! velocity and acceleration from differences. Positions, speeds and torques are held against their limits besides. Every hint is a
//! question to whoever made the log: nothing is converted, refused or left out for it.

mod say;

use super::fit::recording::Recording;
use super::telemetry::Telemetry;
use crate::budget::{Budget, Stopped};
use crate::dynamics::{self, Workspace};
use crate::robot::Robot;
use crate::tolerance::{BUDGET_STRIDE, LOG_TORQUE_EXCESS, LOG_WINDOW};

/// What is seen of a log as it comes.
#[derive(Debug)]
pub struct LogHints {
    robot: Robot,
    workspace: Workspace,
    columns: Columns,
    joints: Vec<Sums>,
    /// Times between samples: how many, and their sum.
    steps: (u32, f64),
    last: Option<Row>,
    open: Vec<Window>,
    closed: Vec<Window>,
    scratch: [Vec<f64>; 4],
}

/// What the columns are called.
#[derive(Debug, Clone, Copy)]
struct Columns {
    position: &'static str,
    torque: &'static str,
}

/// One sample: NaN is missing, or has no column.
#[derive(Debug, Clone, Default)]
struct Row {
    time: f64,
    position: Vec<f64>,
    velocity: Vec<f64>,
    torque: Vec<f64>,
}

/// One joint between two samples that are a window apart: changes and integrals.
#[derive(Debug, Clone, Copy, Default)]
struct Window {
    seconds: f64,
    change: f64,
    speed: f64,
    torque: f64,
}

/// What is known of one joint.
#[derive(Debug, Clone, Copy)]
struct Sums {
    lowest: f64,
    highest: f64,
    fastest: f64,
    strongest: Strongest,
    speed: Pair,
    torque: Pair,
}

/// The largest torque, and when it was; how many samples are beyond what the drive gives.
#[derive(Debug, Clone, Copy, Default)]
struct Strongest {
    torque: f64,
    time: f64,
    beyond: u32,
}

/// Sums of products of two signals.
#[derive(Debug, Clone, Copy, Default)]
struct Pair {
    count: u32,
    reported: f64,
    both: f64,
    expected: f64,
}

impl Pair {
    fn add(&mut self, reported: f64, expected: f64) {
        if !(reported * reported + expected * expected).is_finite() {
            return;
        }
        self.count += 1;
        self.reported += reported * reported;
        self.both += reported * expected;
        self.expected += expected * expected;
    }
}

impl Default for Sums {
    fn default() -> Self {
        Self {
            lowest: f64::INFINITY,
            highest: f64::NEG_INFINITY,
            fastest: 0.0,
            strongest: Strongest::default(),
            speed: Pair::default(),
            torque: Pair::default(),
        }
    }
}

impl LogHints {
    /// Nothing is known yet. The robot carries the payload that the arm does.
    #[must_use]
    pub fn new(robot: Robot) -> Self {
        let count = robot.joint_count();
        Self {
            workspace: Workspace::new(&robot),
            robot,
            columns: Columns {
                position: "position",
                torque: "torque",
            },
            joints: vec![Sums::default(); count],
            steps: (0, 0.0),
            last: None,
            open: vec![Window::default(); count],
            closed: vec![Window::default(); count],
            scratch: std::array::from_fn(|_| vec![0.0; count]),
        }
    }

    /// Hints of a whole recording, whatever is in it.
    ///
    /// # Errors
    /// The budget ended.
    pub fn of_recording(robot: &Robot, recording: &Recording, budget: &Budget<'_>) -> Result<Vec<String>, Stopped> {
        let mut hints = Self::new(robot.clone());
        if matches!(recording.effort, super::fit::recording::Effort::Current(_)) {
            hints.columns.torque = "motor_current";
        }
        let torque = recording.torque(robot);
        let at = |series: &[Vec<f64>], index: usize| {
            let values = series
                .iter()
                .map(|values| values.get(index).copied().unwrap_or(f64::NAN));
            values.collect::<Vec<f64>>()
        };
        for (index, &time) in recording.time.iter().enumerate() {
            if index % BUDGET_STRIDE == 0 {
                budget.check()?;
            }
            hints.add(Row {
                time,
                position: at(&recording.position, index),
                velocity: recording
                    .velocity
                    .as_ref()
                    .map_or_else(Vec::new, |series| at(series, index)),
                torque: at(&torque, index),
            });
        }
        Ok(hints.messages())
    }

    /// Takes in a block, which fits the arm and follows the one before.
    pub fn add_telemetry(&mut self, block: &Telemetry) {
        let count = self.joints.len();
        let drives = self.robot.spec().joints.iter().map(|joint| &joint.drive);
        // of one current or torque at the shaft, at the joint
        let (effort, factors): (&[f64], Vec<f64>) = if block.motor_torque.is_empty() {
            let factor = drives.map(|drive| drive.gear_ratio * drive.torque_constant.unwrap_or(f64::NAN));
            (&block.motor_current, factor.collect())
        } else {
            (&block.motor_torque, drives.map(|drive| drive.gear_ratio).collect())
        };
        if block.motor_torque.is_empty() {
            self.columns.torque = "motor_current";
        }
        let is_motor = block.output_position.is_empty();
        if is_motor {
            self.columns.position = "motor_position";
        }
        let ratio = |joint: usize| self.robot.spec().joints[joint].drive.gear_ratio;
        let at = |column: &[f64], row: usize, joint: usize| column.get(row + joint).copied().unwrap_or(f64::NAN);
        let mut rows = Vec::with_capacity(block.time.len());
        for (index, &time) in block.time.iter().enumerate() {
            let row = index * count;
            let joints = 0..count;
            rows.push(Row {
                time,
                position: joints
                    .clone()
                    .map(|joint| match is_motor {
                        true => at(&block.motor_position, row, joint) / ratio(joint),
                        false => at(&block.output_position, row, joint),
                    })
                    .collect(),
                velocity: joints
                    .clone()
                    .map(|joint| at(&block.output_velocity, row, joint))
                    .collect(),
                torque: joints
                    .map(|joint| {
                        let external = block.external_torque.get(row + joint).copied().unwrap_or(0.0);
                        factors[joint] * at(effort, row, joint) - external
                    })
                    .collect(),
            });
        }
        for row in rows {
            self.add(row);
        }
    }

    /// Takes in one sample.
    fn add(&mut self, row: Row) {
        if !row.time.is_finite() || row.position.iter().any(|q| !q.is_finite()) {
            self.restart(None);
            return;
        }
        for ((joint, sums), spec) in self.joints.iter_mut().enumerate().zip(&self.robot.spec().joints) {
            let torque = row.torque.get(joint).map_or(0.0, |torque| torque.abs());
            if torque.is_finite() && torque > sums.strongest.torque {
                (sums.strongest.torque, sums.strongest.time) = (torque, row.time);
            }
            let most = spec.drive.peak_torque.map(|peak| LOG_TORQUE_EXCESS * peak);
            sums.strongest.beyond += u32::from(most.is_some_and(|most| torque > most));
            sums.lowest = sums.lowest.min(row.position[joint]);
            sums.highest = sums.highest.max(row.position[joint]);
            let speed = row.velocity.get(joint).map_or(0.0, |qd| qd.abs());
            sums.fastest = sums.fastest.max(if speed.is_finite() { speed } else { 0.0 });
        }
        let Some(last) = &self.last else {
            self.restart(Some(row));
            return;
        };
        let seconds = row.time - last.time;
        if seconds <= 0.0 {
            self.restart(Some(row));
            return;
        }
        self.steps.0 = self.steps.0.saturating_add(1);
        self.steps.1 += seconds;
        let mean = |a: &[f64], b: &[f64], joint: usize| match (a.get(joint), b.get(joint)) {
            (Some(a), Some(b)) => 0.5 * (a + b) * seconds,
            _ => f64::NAN,
        };
        for (joint, window) in self.open.iter_mut().enumerate() {
            window.seconds += seconds;
            window.change += row.position[joint] - last.position[joint];
            window.speed += mean(&last.velocity, &row.velocity, joint);
            window.torque += mean(&last.torque, &row.torque, joint);
        }
        if self.open.first().is_some_and(|window| window.seconds >= LOG_WINDOW) {
            self.close(&row);
        }
        self.last = Some(row);
    }

    /// Begins a window anew.
    fn restart(&mut self, row: Option<Row>) {
        self.open.fill(Window::default());
        self.closed.fill(Window::default());
        self.last = row;
    }

    /// Ends a window at a sample.
    fn close(&mut self, row: &Row) {
        for (sums, window) in self.joints.iter_mut().zip(&self.open) {
            sums.speed.add(window.speed, window.change);
        }
        self.compare_torque(row);
        std::mem::swap(&mut self.open, &mut self.closed);
        self.open.fill(Window::default());
    }

    /// Torques of the last two windows beside the model's, where both are as short as windows are.
    fn compare_torque(&mut self, row: &Row) {
        let is_short = |windows: &[Window]| {
            let seconds = windows.first().map_or(0.0, |window| window.seconds);
            seconds > 0.0 && seconds <= 2.0 * LOG_WINDOW
        };
        if !is_short(&self.open) || !is_short(&self.closed) {
            return;
        }
        let [q, qd, qdd, torque] = &mut self.scratch;
        for (joint, (now, before)) in self.open.iter().zip(&self.closed).enumerate() {
            let speeds = [before.change / before.seconds, now.change / now.seconds];
            q[joint] = row.position[joint] - now.change;
            qd[joint] = 0.5 * (speeds[0] + speeds[1]);
            qdd[joint] = (speeds[1] - speeds[0]) / (0.5 * (before.seconds + now.seconds));
        }
        dynamics::drive_torque(&self.robot, &mut self.workspace, q, qd, qdd, torque);
        for (joint, (now, before)) in self.open.iter().zip(&self.closed).enumerate() {
            let reported = (before.torque + now.torque) / (before.seconds + now.seconds);
            self.joints[joint].torque.add(reported, torque[joint]);
        }
    }
}

#[cfg(test)]
mod tests;
