//! What the benchmark `timing` measures, on paths that are polynomials of s: entry points for it, not part of the interface.

use nalgebra::Isometry3;

use super::coefficients::Coefficients;
use super::grid::{Grid, even, fixed_nodes};
use super::law::TimeLaw;
use super::limits::{JointLimits, Limits, Stretch};
use super::rows::{Rooms, RowPlaces, Rows};
use super::{Task, jerk, optimal, reach};
use crate::budget::Budget;
use crate::curve::{Curve, CurvePoint, Side};
use crate::jet::Jet;
use crate::robot::Robot;

/// One polynomial a joint, lowest power first, from s = 0 to a length.
#[derive(Debug)]
pub struct Polynomials {
    joints: Vec<Vec<f64>>,
    ends: [f64; 2],
}

impl Polynomials {
    /// Coefficients by joint, lowest power first.
    #[must_use]
    pub fn new(joints: Vec<Vec<f64>>, length: f64) -> Self {
        Self {
            joints,
            ends: [0.0, length],
        }
    }
}

impl Curve for Polynomials {
    fn joint_count(&self) -> usize {
        self.joints.len()
    }

    fn length(&self) -> f64 {
        self.ends[1]
    }

    fn knots(&self) -> &[f64] {
        &self.ends
    }

    fn evaluate(&self, s: f64, _: Side, point: &mut CurvePoint) {
        let s = Jet::variable(s.clamp(0.0, self.ends[1]), 1.0);
        for (joint, coefficients) in self.joints.iter().enumerate() {
            let sum = |sum: Jet, c: &f64| sum * s + *c;
            [
                point.position[joint],
                point.first[joint],
                point.second[joint],
                point.third[joint],
            ] = coefficients.iter().rev().fold(Jet::default(), sum).derivatives();
        }
    }
}

/// A robot's own limits of speed and torque.
fn limits(robot: &Robot) -> Limits {
    let joints = robot.spec().joints.iter();
    Limits::uniform(Stretch {
        joints: joints
            .map(|joint| JointLimits {
                velocity: joint.limits.velocity,
                torque: joint.drive.peak_torque,
                ..JointLimits::default()
            })
            .collect(),
        ..Stretch::default()
    })
}

/// Duration under the robot's limits of speed and torque, with rows at the nodes of an even grid and nothing looked at
/// between them: what toppra calls interpolation. `None` where there is none.
#[must_use]
pub fn interpolated(robot: &Robot, path: &Polynomials, intervals: usize) -> Option<f64> {
    let limits = limits(robot);
    let fixed = fixed_nodes(path, &limits);
    let grid = Grid::new(even(&fixed, intervals), &fixed, 1);
    let (tcp, budget) = (Isometry3::identity(), Budget::unlimited());
    let coefficients = Coefficients::compute(robot, &tcp, path, &limits, &grid.places, &budget).ok()?;
    let rooms = Rooms {
        reserve: 0.0,
        ..Rooms::full(&coefficients)
    };
    let places = RowPlaces::new(&grid, 1);
    let rows = Rows::new(&coefficients, &limits, &rooms, &places, None);
    let squares = reach::fastest(&grid, &rows, [0.0; 2], &budget).ok()?.ok()?;
    Some(TimeLaw::linear(&grid.nodes, &squares)?.duration())
}

/// Duration under the same limits, certified between samples. `None` where there is none.
#[must_use]
pub fn certified(robot: &Robot, path: &Polynomials, intervals: usize) -> Option<f64> {
    let task = Task {
        robot,
        tcp: &Isometry3::identity(),
        curve: path,
        limits: &limits(robot),
        end_speeds: [0.0; 2],
        intervals,
    };
    let timing = optimal(&task, &Budget::unlimited()).ok()?.ok()?;
    Some(timing.law.duration())
}

/// Duration under the same limits, 15 rad/s² and 150 rad/s³ of every joint, certified between samples. `None` where there
/// is none.
#[must_use]
pub fn jerk_limited(robot: &Robot, path: &Polynomials, intervals: usize) -> Option<f64> {
    let mut limits = limits(robot);
    for joint in limits.stretches.iter_mut().flat_map(|stretch| &mut stretch.joints) {
        (joint.acceleration, joint.jerk) = (Some(15.0), Some(150.0));
    }
    let task = Task {
        robot,
        tcp: &Isometry3::identity(),
        curve: path,
        limits: &limits,
        end_speeds: [0.0; 2],
        intervals,
    };
    let timing = jerk::jerk_limited(&task, &Budget::unlimited()).ok()?.ok()?;
    Some(timing.law.duration())
}
