//! A primal-dual interior point (Mehrotra 1992) for the fastest a(s) under [`Rows`]:
//!
//! ```text
//! minimise  Σ wᵢ/√aᵢ   subject to   zᵣ(a, b, c) ≥ 0,   (a, b, c) = E·x linear in the unknowns
//! ```
//!
//! The slacks are the rows' own values, not variables: every iterate obeys every row, so that whatever the last one is
//! can be used. Jerk rows have convex slacks; the step treats them by their tangents, which lie on the safe side
//! (Debrouwere et al. 2013), and each step takes new ones. The normal equations have three diagonals beside the main
//! one.
//!
//! Where the motion moves at an end, the unknown there is first raised to what it is to be: its part of that is worth many
//! times the duration, until it is there. From then on it stays.

use pulp::Arch;

use super::band::Band;
use super::ends::End;
use super::fold::{Evaluate, Fold, Recenter, Sample};
use super::pass::{Assemble, Correct, Normal, PerRow, Point, Predict, Second, ZERO};
use super::rows::{Block, Rows};
use crate::budget::{Budget, Stopped};
use crate::scalar::LANES_MAX;
use crate::tolerance::{JERK_BACKTRACKS, JERK_ITERATIONS, JERK_RAISE_WORTH};

/// Samples, their rows, and how many unknowns they see.
#[derive(Debug, Clone)]
pub(crate) struct Problem {
    pub(crate) unknown_count: usize,
    pub(crate) samples: Vec<Sample>,
    pub(crate) rows: Rows,
    /// The first and the last unknown.
    pub(crate) ends: [End; 2],
}

impl Problem {
    /// Which unknowns the ends are, and what they are.
    fn each_end(&self) -> [(usize, End); 2] {
        [(0, self.ends[0]), (self.unknown_count - 1, self.ends[1])]
    }

    /// Whether the speed at an end is not yet what it is to be.
    pub(crate) fn raises(&self) -> bool {
        self.ends.iter().any(|end| matches!(end, End::Raised(_)))
    }
}

/// How far, and from how far away.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Accuracy {
    /// Duality gap and dual residual at the end, as part of the duration.
    pub(crate) gap: f64,
    /// Complementarity l·z of every row at the start, as part of the duration over four rows a joint and sample. Too
    /// small is harmful from a start far from the end: the iterates then hug the first limits that they meet. After
    /// tightening, with the multipliers of the solve before, a thousandth does: three to five iterations instead of
    /// ten.
    pub(crate) first_center: f64,
}

/// The scratch of one problem, and the multipliers of its last solve.
#[derive(Debug)]
pub(crate) struct Solver {
    arch: Arch,
    x: Vec<f64>,
    trial: Vec<f64>,
    direction: Vec<f64>,
    descent: Vec<f64>,
    residual: Vec<f64>,
    band: Band,
    points: Vec<Point>,
    affine: Vec<Point>,
    directions: Vec<Point>,
    scale: Vec<Block>,
    multipliers: PerRow,
    moved: PerRow,
    step: PerRow,
    inverse: PerRow,
    normals: Vec<Normal>,
    seconds: Vec<Second>,
    /// What the whole speed at an end is worth while it is raised, s.
    worth: f64,
}

/// Where a solve ended.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Ended {
    pub(crate) iterations: usize,
    pub(crate) converged: bool,
    /// By the trapezoidal rule, s.
    pub(crate) duration: f64,
}

impl Solver {
    pub(crate) fn new(problem: &Problem) -> Self {
        let (rows, unknowns) = (&problem.rows, problem.unknown_count);
        let zeros = || vec![0.0; unknowns];
        let rest = || vec![[ZERO; 3]; rows.blocks];
        let normal = Normal {
            hessian: [ZERO; 6],
            pull: [ZERO; 3],
            gap: ZERO,
        };
        let second = Second {
            center: [ZERO; 3],
            cross: [ZERO; 3],
            gap: ZERO,
        };
        let one = [1.0; LANES_MAX];
        Self {
            arch: Arch::new(),
            x: zeros(),
            trial: zeros(),
            direction: zeros(),
            descent: zeros(),
            residual: zeros(),
            band: Band::default(),
            // lanes without a sample stay at a = 1, where their rows do not bind
            points: vec![[one, ZERO, ZERO]; rows.blocks],
            affine: rest(),
            directions: rest(),
            scale: vec![one; rows.blocks],
            multipliers: PerRow::new(rows),
            moved: PerRow::new(rows),
            step: PerRow::new(rows),
            inverse: PerRow::new(rows),
            normals: vec![normal; rows.blocks],
            seconds: vec![second; rows.blocks],
            worth: 0.0,
        }
    }

    /// Improves `x`, which must obey every row strictly; it does so all the way, whatever ends the iteration. Where ends are
    /// raised, that is all that is done: it ends when they have arrived and are held.
    ///
    /// # Errors
    /// [`Stopped`], when nobody waits any more.
    pub(crate) fn improve(
        &mut self,
        problem: &mut Problem,
        x: &mut Vec<f64>,
        accuracy: &Accuracy,
        budget: &Budget<'_>,
    ) -> Result<Ended, Stopped> {
        let mut ended = Ended {
            iterations: 0,
            converged: false,
            duration: f64::INFINITY,
        };
        self.x.clone_from(x);
        self.direction.fill(0.0);
        if !self.start(problem, accuracy.first_center) {
            return Ok(ended);
        }
        let raises = problem.raises();
        let (mut primal, mut dual) = (0.0, 0.0);
        for iteration in 0..=JERK_ITERATIONS {
            budget.check()?;
            if !self.advance(problem, primal, dual) {
                break;
            }
            x.clone_from(&self.x);
            if raises && self.arrived(problem) {
                break;
            }
            let duration = self.fold(problem);
            let gap = self.sum(problem, |solver, block, lane| solver.normals[block].gap[lane]);
            let error: f64 = self.residual.iter().zip(&self.x).map(|(r, x)| (r * x).abs()).sum();
            ended.duration = duration;
            ended.iterations = iteration;
            if iteration > 0 && gap < accuracy.gap * duration && error < 2.0 * accuracy.gap * duration {
                ended.converged = true;
                break;
            }
            (primal, dual) = self.turn(problem, gap, duration);
        }
        Ok(ended)
    }

    /// Slacks at the start, and multipliers with at least the same product everywhere; those of the solve before, where
    /// they are larger, as they are where its rows bind. False where the start breaks a row.
    fn start(&mut self, problem: &Problem, first_center: f64) -> bool {
        self.arch.dispatch(Evaluate {
            samples: &problem.samples,
            x: &self.x,
            points: &mut self.points,
        });
        let mut duration = 0.0;
        for (k, sample) in problem.samples.iter().enumerate() {
            let (block, lane) = (k / LANES_MAX, k % LANES_MAX);
            let speed = self.points[block][0][lane].sqrt();
            // also where a is negative or not a number
            if speed.is_nan() || speed <= 0.0 {
                return false;
            }
            self.scale[block][lane] = speed;
            duration += sample.weight / speed;
        }
        self.step.fill(0.0);
        if self.assemble(problem, 0.0) >= 0.0 {
            return false;
        }
        self.worth = if problem.raises() {
            JERK_RAISE_WORTH * duration
        } else {
            0.0
        };
        let rows = 4 * problem.samples.len() * problem.rows.joint_count().max(1);
        let center = first_center * duration / rows as f64;
        self.multipliers.at_least(&self.inverse, center);
        true
    }

    /// Takes a step, the primal one no further than to where an end arrives, and halved until every slack is positive. False
    /// where none is.
    fn advance(&mut self, problem: &Problem, mut primal: f64, dual: f64) -> bool {
        let mut arriving = None;
        if let Some((unknown, to, part)) = self.arriving(problem, primal) {
            arriving = Some((unknown, to));
            primal = part;
        }
        for _ in 0..JERK_BACKTRACKS {
            for ((trial, x), d) in self.trial.iter_mut().zip(&self.x).zip(&self.direction) {
                *trial = x + primal * d;
            }
            if let Some((unknown, to)) = arriving {
                self.trial[unknown] = to;
            }
            self.arch.dispatch(Evaluate {
                samples: &problem.samples,
                x: &self.trial,
                points: &mut self.points,
            });
            let positive = self.points.iter().all(|point| point[0].iter().all(|a| *a > 0.0));
            if positive && self.assemble(problem, dual) < 0.0 {
                std::mem::swap(&mut self.x, &mut self.trial);
                std::mem::swap(&mut self.multipliers, &mut self.moved);
                return true;
            }
            primal *= 0.5;
            arriving = None;
        }
        false
    }

    /// Which end arrives first within a step, where it does, and after what part of the direction.
    fn arriving(&self, problem: &Problem, primal: f64) -> Option<(usize, f64, f64)> {
        let mut first = None;
        let mut least = primal;
        for (unknown, end) in problem.each_end() {
            let End::Raised(to) = end else { continue };
            let (left, step) = (to - self.x[unknown], self.direction[unknown]);
            if step > 0.0 && left <= least * step {
                least = left / step;
                first = Some((unknown, to, least));
            }
        }
        first
    }

    fn assemble(&mut self, problem: &Problem, dual_step: f64) -> f64 {
        self.arch.dispatch(Assemble {
            rows: &problem.rows,
            points: &self.points,
            scale: &self.scale,
            multipliers: &self.multipliers,
            step: &self.step,
            dual_step,
            moved: &mut self.moved,
            inverse: &mut self.inverse,
            normals: &mut self.normals,
        })
    }

    /// Holds the ends that have arrived; whether all have.
    fn arrived(&self, problem: &mut Problem) -> bool {
        for (side, (unknown, end)) in problem.each_end().into_iter().enumerate() {
            if matches!(end, End::Raised(to) if self.x[unknown] >= to) {
                problem.ends[side] = End::Held;
            }
        }
        !problem.raises()
    }

    /// Takes held ends out of a direction.
    fn hold(problem: &Problem, direction: &mut [f64]) {
        for (unknown, end) in problem.each_end() {
            if end == End::Held {
                direction[unknown] = 0.0;
            }
        }
    }

    /// The normal equations, factorized; returns the duration.
    fn fold(&mut self, problem: &Problem) -> f64 {
        self.band.clear(problem.unknown_count);
        self.descent.fill(0.0);
        self.residual.fill(0.0);
        let duration = self.arch.dispatch(Fold {
            samples: &problem.samples,
            points: &self.points,
            normals: &self.normals,
            band: &mut self.band,
            descent: &mut self.descent,
            residual: &mut self.residual,
        });
        for (unknown, end) in problem.each_end() {
            match end {
                End::Rest => {}
                End::Raised(to) => {
                    self.descent[unknown] += self.worth / to;
                    self.residual[unknown] += self.worth / to;
                }
                End::Held => self.band.hold(unknown),
            }
        }
        Self::hold(problem, &mut self.descent);
        Self::hold(problem, &mut self.residual);
        self.band.factorize();
        duration
    }

    /// Predictor and corrector: the direction, and how far to go along it, primal and dual.
    fn turn(&mut self, problem: &Problem, gap: f64, duration: f64) -> (f64, f64) {
        self.direction.copy_from_slice(&self.descent);
        self.band.solve(&mut self.direction);
        self.arch.dispatch(Evaluate {
            samples: &problem.samples,
            x: &self.direction,
            points: &mut self.affine,
        });
        let [primal, dual] = self.arch.dispatch(Predict {
            rows: &problem.rows,
            points: &self.points,
            scale: &self.scale,
            directions: &self.affine,
            multipliers: &self.multipliers,
            inverse: &self.inverse,
            seconds: &mut self.seconds,
        });
        let primal = step(1.0, primal.max(slowing(&self.points, &self.affine)));
        let dual = step(1.0, 1.0 + dual);
        let product = self.sum(problem, |solver, block, lane| solver.seconds[block].gap[lane]);
        let least = primal.min(dual);
        let reached = ((1.0 - least) * gap + least * least * product).max(0.0) / gap;
        // Mehrotra's cube; where the affine step is short its promise is worth little
        let floor = if least < SHORT { CENTERING_SHORT } else { CENTERING_MIN };
        let centering = (reached * reached * reached).clamp(floor, 1.0);
        let center = centering * gap / self.row_count(problem);
        let damping = primal * dual;

        self.direction.copy_from_slice(&self.descent);
        self.arch.dispatch(Recenter {
            samples: &problem.samples,
            seconds: &self.seconds,
            center,
            damping,
            x: &mut self.direction,
        });
        Self::hold(problem, &mut self.direction);
        self.band.solve(&mut self.direction);
        self.arch.dispatch(Evaluate {
            samples: &problem.samples,
            x: &self.direction,
            points: &mut self.directions,
        });
        let [primal, dual] = self.arch.dispatch(Correct {
            rows: &problem.rows,
            points: &self.points,
            scale: &self.scale,
            affine: &self.affine,
            directions: &self.directions,
            multipliers: &self.multipliers,
            inverse: &self.inverse,
            center,
            damping,
            step: &mut self.step,
        });
        let part = if gap < CLOSE * duration { PART_CLOSE } else { PART };
        let primal = primal.max(slowing(&self.points, &self.directions));
        (step(part, primal), step(part, dual))
    }

    /// A sum over samples' lanes in order of the samples, which no processor's lanes change. Lanes without a sample
    /// count in gaps as any row.
    fn sum(&self, problem: &Problem, value: impl Fn(&Self, usize, usize) -> f64) -> f64 {
        let mut lanes = [0.0; LANES_MAX];
        for block in 0..problem.rows.blocks {
            for (lane, sum) in lanes.iter_mut().enumerate() {
                *sum += value(self, block, lane);
            }
        }
        lanes.iter().sum()
    }

    fn row_count(&self, problem: &Problem) -> f64 {
        (problem.rows.row_count() * LANES_MAX) as f64
    }
}

/// Shorter affine steps than this are short.
const SHORT: f64 = 0.1;
/// Least part of the gap to aim at after a short affine step, and otherwise.
const CENTERING_SHORT: f64 = 0.3;
const CENTERING_MIN: f64 = 1.0e-4;
/// Part of the way to the nearest limit that a step goes, and close to the end.
const PART: f64 = 0.98;
const PART_CLOSE: f64 = 0.995;
/// The end is close below this part of the duration.
const CLOSE: f64 = 1.0e-2;

/// The longest step up to 1 that goes the part `part` of the way to where `rate` leads to a limit.
fn step(part: f64, rate: f64) -> f64 {
    if rate <= part { 1.0 } else { part / rate }
}

/// The largest −δa/a.
fn slowing(points: &[Point], directions: &[Point]) -> f64 {
    let mut worst = 0.0_f64;
    for (point, direction) in points.iter().zip(directions) {
        for (a, da) in point[0].iter().zip(&direction[0]) {
            worst = worst.max(-da / a);
        }
    }
    worst
}
