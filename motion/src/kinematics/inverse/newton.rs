//! From a start to a solution: damped Gauss-Newton steps on the tool's gap.
//!
//! With e = (Δp/size, log(R_target·Rᵀ)) and J its Jacobian, a step solves
//!
//! ```text
//! minimize |J·δ − e|² + λ·|δ|²        λ = μ·|e|²
//! ```
//!
//! (K. Levenberg 1944, D. Marquardt 1963). λ falls with the square of the gap, so that convergence is quadratic also
//! where J loses rank at the solution (N. Yamashita, M. Fukushima 2001; for arms T. Sugihara, "Solvability-unconcerned
//! inverse kinematics by the Levenberg-Marquardt method", 2011). μ shrinks with each step that helps and grows with
//! each that does not. Where there are fewer unknowns than equations the normal equations JᵀJ are solved, otherwise
//! J·Jᵀ, which gives the shortest step.
//!
//! What the pose leaves free (seven joints, or a singular place) is decided by the reference r: among the solutions of
//! one connected family the one nearest to it, |q − r| in rad and m alike, where (I − J⁺·J)·(r − q) = 0.

use super::gap::Gap;
use super::screws::{Frames, Place, Screws};
use super::square::{Square, TASK};
use crate::robot::JOINTS_MAX;
use crate::tolerance::{
    IK_ATTRACTION_ROUNDS, IK_DAMPING_FLOOR, IK_DAMPING_MAX, IK_FREE_PART, IK_FREE_STEP, IK_ITERATIONS, IK_POLISHED,
    IK_RANK, IK_ROUNDING, IK_STALLED, IK_STEP_MAX,
};

/// What one run from a start came to.
#[derive(Debug, Clone, Copy)]
pub(super) struct Run {
    pub(super) gap: Gap,
    /// How often the chain was evaluated.
    pub(super) work: usize,
}

/// A chain, a target, the joints that may move, and scratch.
#[derive(Debug)]
pub(super) struct Newton<'a> {
    screws: &'a Screws,
    target: Place,
    /// Joints that stay where they are.
    pub(super) held: [bool; JOINTS_MAX],
    frames: Frames,
    /// J, column by column, linear rows over the arm's size; held joints' columns are 0.
    columns: [[f64; TASK]; JOINTS_MAX],
}

impl<'a> Newton<'a> {
    pub(super) fn new(screws: &'a Screws, target: Place) -> Self {
        Self {
            screws,
            target,
            held: [false; JOINTS_MAX],
            frames: Frames::new(),
            columns: [[0.0; TASK]; JOINTS_MAX],
        }
    }

    /// What is missing at `q`.
    pub(super) fn gap(&mut self, q: &[f64]) -> Gap {
        self.screws.frames(q, &mut self.frames);
        Gap::between(&self.frames.tool, &self.target)
    }

    /// Moves `q` to a solution, or to where no step helps any more.
    pub(super) fn run(&mut self, q: &mut [f64]) -> Run {
        let count = self.screws.count();
        let size = self.screws.size;
        let mut step = [0.0; JOINTS_MAX];
        let mut trial = [0.0; JOINTS_MAX];
        let mut gap = self.gap(q);
        let mut error = gap.squared(size);
        let mut damping = 1.0;
        let mut stale = true;
        for work in 1..IK_ITERATIONS {
            if error <= IK_ROUNDING * IK_ROUNDING {
                return Run { gap, work };
            }
            if stale {
                self.jacobian();
            }
            self.step(&gap, damping * error + IK_DAMPING_FLOOR, &mut step[..count]);
            let longest = step[..count]
                .iter()
                .fold(0.0, |longest: f64, step| longest.max(step.abs()));
            let scale = if longest > IK_STEP_MAX {
                IK_STEP_MAX / longest
            } else {
                1.0
            };
            for j in 0..count {
                trial[j] = q[j] + scale * step[j];
            }
            let trial_gap = self.gap(&trial[..count]);
            let trial_error = trial_gap.squared(size);
            if trial_error < error {
                let stalled = trial_error > error * (1.0 - IK_STALLED);
                q.copy_from_slice(&trial[..count]);
                (gap, error, stale) = (trial_gap, trial_error, true);
                damping *= 0.125;
                if stalled {
                    return Run { gap, work };
                }
            } else {
                stale = false;
                damping *= 8.0;
                // no step however short helps: a minimum, or rounding
                if error <= IK_POLISHED * IK_POLISHED || damping > IK_DAMPING_MAX {
                    return Run { gap, work };
                }
            }
        }
        Run {
            gap,
            work: IK_ITERATIONS,
        }
    }

    /// Moves a solution along what the pose leaves free, to the place nearest to `reference`.
    pub(super) fn attract(&mut self, q: &mut [f64], reference: &[f64]) -> Run {
        let count = self.screws.count();
        let mut run = Run {
            gap: self.gap(q),
            work: 1,
        };
        let mut moved = [0.0; JOINTS_MAX];
        let mut scale = 1.0;
        for _ in 0..IK_ATTRACTION_ROUNDS {
            self.gap(q);
            self.jacobian();
            for j in 0..count {
                moved[j] = if self.held[j] { 0.0 } else { reference[j] - q[j] };
            }
            self.project(&mut moved[..count]);
            let longest = moved[..count]
                .iter()
                .fold(0.0, |longest: f64, step| longest.max(step.abs()));
            if longest * scale <= IK_FREE_STEP {
                return run;
            }
            let shorter = if longest > IK_STEP_MAX {
                IK_STEP_MAX / longest
            } else {
                1.0
            };
            for j in 0..count {
                moved[j] = q[j] + scale * shorter * moved[j];
            }
            let corrected = self.run(&mut moved[..count]);
            run.work += corrected.work + 1;
            if corrected.gap.is_closed()
                && squared_distance(&moved[..count], reference) < squared_distance(q, reference)
            {
                q.copy_from_slice(&moved[..count]);
                run.gap = corrected.gap;
            } else {
                scale *= 0.25;
            }
        }
        run
    }

    /// Whether joint `j` can move at `q` while the tool stands still.
    pub(super) fn is_free(&mut self, q: &[f64], j: usize) -> bool {
        let mut unit = [0.0; JOINTS_MAX];
        unit[j] = 1.0;
        self.gap(q);
        self.jacobian();
        self.project(&mut unit[..q.len()]);
        !self.held[j] && unit[j] > IK_FREE_PART
    }

    /// J·Jᵀ, or JᵀJ where that is smaller, at the place looked at last.
    pub(super) fn normal_matrix(&mut self) -> Square {
        self.jacobian();
        let columns = &self.columns[..self.screws.count()];
        if columns.len() < TASK {
            return Square::of_columns(columns, 0.0);
        }
        Square::of_rows(columns, 0.0)
    }

    /// J at the frames computed last.
    fn jacobian(&mut self) {
        let per_size = 1.0 / self.screws.size;
        for j in 0..self.screws.count() {
            if self.held[j] {
                self.columns[j] = [0.0; TASK];
                continue;
            }
            let (linear, angular) = self.screws.column(&self.frames, j);
            let linear = linear * per_size;
            self.columns[j] = [linear.x, linear.y, linear.z, angular.x, angular.y, angular.z];
        }
    }

    /// δ = Jᵀ·(J·Jᵀ + λ)⁻¹·e = (JᵀJ + λ)⁻¹·Jᵀ·e, whichever matrix is smaller.
    fn step(&self, gap: &Gap, damping: f64, step: &mut [f64]) {
        let linear = gap.linear / self.screws.size;
        let e = [
            linear.x,
            linear.y,
            linear.z,
            gap.angular.x,
            gap.angular.y,
            gap.angular.z,
        ];
        let columns = &self.columns[..step.len()];
        if columns.len() < TASK {
            let mut x = [0.0; TASK];
            for (x, column) in x.iter_mut().zip(columns) {
                *x = dot(column, &e);
            }
            Square::of_columns(columns, damping).solve(&mut x);
            step.copy_from_slice(&x[..step.len()]);
            return;
        }
        let mut x = e;
        Square::of_rows(columns, damping).solve(&mut x);
        for (step, column) in step.iter_mut().zip(columns) {
            *step = dot(column, &x);
        }
    }

    /// (I − J⁺·J)·x.
    fn project(&self, x: &mut [f64]) {
        let columns = &self.columns[..x.len()];
        let mut along = [0.0; TASK];
        for (x, column) in x.iter().zip(columns) {
            for (along, entry) in along.iter_mut().zip(column) {
                *along += x * entry;
            }
        }
        let trace: f64 = columns.iter().map(|column| dot(column, column)).sum();
        Square::of_rows(columns, trace * IK_RANK).solve(&mut along);
        for (x, column) in x.iter_mut().zip(columns) {
            *x -= dot(column, &along);
        }
    }
}

/// |q − r|².
pub(super) fn squared_distance(q: &[f64], r: &[f64]) -> f64 {
    q.iter().zip(r).map(|(q, r)| (q - r) * (q - r)).sum()
}

#[inline]
fn dot(a: &[f64; TASK], b: &[f64; TASK]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}
