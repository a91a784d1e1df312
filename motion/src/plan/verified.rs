//! The corrected method: one time law along the straight joint path that keeps every limit everywhere.
//!
//! Along q(s) = q₀ + s·D the torque of a joint is a quadratic in the root of what is bounded ([`PathTerms`]):
//!
//! ```text
//! accelerating  α·(m + 2·s·k) + √(2·s·α)·c_v·D + (g + c_C)     at s from the start
//! braking       δ·(2·r·k − m) + √(2·r·δ)·c_v·D + (g + c_C)     at r = 1 − s from the target
//! cruising      v²·k          + v·c_v·D        + (g + c_C)
//! ```
//!
//! with quadratic friction, d·D·|D|, in k, and that of the load, which has a kink where g is zero, in c_C;
//! so each joint bounds α, δ and v at each sample in closed form, and [`time_law::fastest`] finds the fastest trapezoid. Its
//! plan is verified; where verification finds more torque between samples, its moments become samples, and the law is
//! computed again (the exchange of Remez). It ends with every limit kept and the limiting one touched.
//!
//! The smallest root is taken: from it down to creeping the limit holds too, so the plan is safe at every slower override. (Not
//! always when stopped on the way: an arm that friction helped to lower must then be held without it.)

use super::outcome::{Infeasible, Pattern};
use super::preset::speed;
use super::problem::Problem;
use super::time_law::{self, Bounds, TimeLaw};
use super::{Failure, feasible, slow};
use crate::budget::Budget;
use crate::dynamics::path::PathTerms;
use crate::tolerance::{
    CRUISE_MIN, EXCHANGE_ROUNDS, INTERVALS_MIN, PATH_ACCELERATION_MAX, PLAN_RESERVE, RATE_RESERVE, SAMPLE_TRAVEL,
    VERIFY_RESERVE,
};
use crate::trajectory::{self, Trajectory};
use crate::verify::{Verification, Verifier};

/// Samples closer than this part of the way are one.
const SAMPLE_APART: f64 = 1.0e-9;

/// Fewest samples of a path.
const SAMPLES_MIN: usize = 4 * INTERVALS_MIN;

/// How close to its limit a torque must come for its moment to become a sample.
const EXCHANGE_NEAR: f64 = 1.0 - 2.0 * PLAN_RESERVE;

/// A plan and its proof.
pub(super) type Verified = (Vec<Pattern>, Verification);

/// Plans a move in which at least one joint moves.
pub(super) fn plan(
    problem: &Problem,
    verifier: &mut Verifier,
    budget: &Budget<'_>,
) -> Result<Result<Verified, Infeasible>, Failure> {
    let mut path = Path::new(problem);
    let torque_limits = problem.torque_limits();
    let mut law: Option<TimeLaw> = None;
    let mut last = None;
    for round in 0..EXCHANGE_ROUNDS {
        budget.check()?;
        if let Some(infeasible) = path.infeasible.take() {
            return Ok(Err(infeasible));
        }
        let Some(mut found) = time_law::fastest(&path.bounds, path.velocity_max, law.as_ref()) else {
            break;
        };
        if round == 0 {
            // where the phases meet, torques are highest most often: make these samples before the first proof
            path.add(&[found.ramp_up(), 1.0 - found.ramp_down()]);
            found = time_law::fastest(&path.bounds, path.velocity_max, Some(&found)).unwrap_or(found);
        }
        let patterns = path.patterns(&found);
        let motion = Trajectory::of_patterns(&problem.start, &patterns);
        let verification = verifier.verify(problem.robot.chain(), problem.robot.drives(), &torque_limits, &motion);
        if excess(&verification, &torque_limits) <= -VERIFY_RESERVE {
            return Ok(Ok((patterns, verification)));
        }
        let places: Vec<f64> = verification
            .peaks
            .iter()
            .filter(|peak| peak.torque.abs() >= torque_limits[peak.joint].unwrap_or(f64::INFINITY) * EXCHANGE_NEAR)
            .map(|peak| found.position(peak.time))
            .chain([found.ramp_up(), 1.0 - found.ramp_down()])
            .collect();
        path.add(&places);
        law = Some(found);
        last = Some((patterns, verification));
    }
    // The exchange has not ended, mostly between two laws that take turns; what it lacks is a small part of the speed.
    let Some((patterns, verification)) = last else {
        return Ok(Err(feasible::no_speed(problem)));
    };
    let duration = trajectory::duration(&patterns);
    let slowed = slow::until_it_holds(problem, verifier, &patterns, verification, budget)?;
    Ok(slowed.map_err(|peak| feasible::never_slow_enough(problem, &peak, duration)))
}

/// By how much the largest torque exceeds its limit, relative to it; negative where all hold.
pub(super) fn excess(verification: &Verification, limits: &[Option<f64>]) -> f64 {
    verification
        .joints
        .iter()
        .zip(limits)
        .filter_map(|(joint, limit)| limit.map(|limit| joint.peak_torque.abs() / limit - 1.0))
        .fold(f64::NEG_INFINITY, f64::max)
}

impl TimeLaw {
    /// Where on the path the motion is at a time.
    fn position(&self, time: f64) -> f64 {
        let duration = self.duration();
        let up = self.velocity / self.acceleration;
        let left = duration - time;
        if time <= up {
            return 0.5 * self.acceleration * time * time;
        }
        if left <= self.velocity / self.deceleration {
            return 1.0 - 0.5 * self.deceleration * left * left;
        }
        self.ramp_up() + self.velocity * (time - up)
    }
}

/// The straight path of a move, and what bounds a time law along it.
struct Path<'a> {
    problem: &'a Problem,
    bounds: Bounds,
    velocity_max: f64,
    acceleration_max: f64,
    deceleration_max: f64,
    terms: PathTerms,
    /// Set once a sample shows that no speed is slow enough.
    infeasible: Option<Infeasible>,
}

impl<'a> Path<'a> {
    fn new(problem: &'a Problem) -> Self {
        let most = |value: &dyn Fn(usize) -> Option<f64>, cap: f64| {
            (0..problem.start.len())
                .filter(|joint| problem.moves(*joint))
                .filter_map(|joint| value(joint).map(|value| value / problem.displacement[joint].abs()))
                .fold(cap, f64::min)
        };
        let rate = |limit: Option<f64>| limit.map(|limit| limit * (1.0 - RATE_RESERVE));
        let mut path = Self {
            problem,
            bounds: Bounds::default(),
            velocity_max: most(&|joint| Some(speed(problem, joint)), f64::INFINITY),
            acceleration_max: most(&|joint| rate(problem.limits[joint].acceleration), PATH_ACCELERATION_MAX),
            deceleration_max: most(&|joint| rate(problem.limits[joint].deceleration), PATH_ACCELERATION_MAX),
            terms: PathTerms::default(),
            infeasible: None,
        };
        let travel: f64 = problem.displacement.iter().map(|d| d.abs()).sum();
        let intervals = ((travel / SAMPLE_TRAVEL).ceil() as usize).max(SAMPLES_MIN);
        let places: Vec<f64> = (0..=intervals)
            .map(|k| {
                // closer together at both ends, where viscous torque goes with the root of the distance
                let u = k as f64 / intervals as f64;
                u * u * (3.0 - 2.0 * u)
            })
            .collect();
        path.add(&places);
        path
    }

    /// Adds samples.
    fn add(&mut self, places: &[f64]) {
        let mut fresh: Vec<f64> = places
            .iter()
            .copied()
            .filter(|s| (0.0..=1.0).contains(s) && !self.has(*s))
            .collect();
        fresh.sort_by(f64::total_cmp);
        fresh.dedup_by(|a, b| *a - *b <= SAMPLE_APART);
        if fresh.is_empty() {
            return;
        }
        self.terms
            .set_line(&self.problem.start, &self.problem.displacement, &fresh);
        self.terms.compute(self.problem.robot.chain(), None);
        for (index, s) in fresh.into_iter().enumerate() {
            self.add_sample(s, index);
        }
    }

    fn has(&self, s: f64) -> bool {
        let after = self.bounds.s.partition_point(|at| *at < s);
        let near = |at: usize| self.bounds.s.get(at).is_some_and(|at| (at - s).abs() <= SAMPLE_APART);
        near(after) || after > 0 && near(after - 1)
    }

    /// Adds the sample whose terms are at `index`.
    fn add_sample(&mut self, s: f64, index: usize) {
        let r = 1.0 - s;
        let (root_s, root_r) = ((2.0 * s).sqrt(), (2.0 * r).sqrt());
        let (mut acceleration, mut deceleration) = (self.acceleration_max, self.deceleration_max);
        let mut cruise = f64::INFINITY;
        for (joint, limit) in self.problem.limits.iter().enumerate() {
            let Some(limit) = limit.torque else { continue };
            let displacement = self.displacement(joint);
            let drive = &self.problem.robot.drives()[joint];
            let entry = joint * self.terms.stride + index;
            let mass = self.terms.mass[entry] + drive.armature * displacement;
            let velocity = self.terms.velocity[entry] + drive.drag(displacement);
            let gravity = self.terms.gravity[entry];
            let still = gravity + drive.coulomb(displacement, gravity);
            let viscous = drive.viscous * displacement;
            let planned = limit * (1.0 - PLAN_RESERVE);
            if still.abs() >= planned {
                let worse = self
                    .infeasible
                    .as_ref()
                    .is_none_or(|known| still.abs() / limit > known.needed.abs() / known.available);
                if worse {
                    self.infeasible = Some(feasible::moving(self.problem, joint, s, still, limit, gravity));
                }
                continue;
            }
            let largest = |dynamic: f64, viscous: f64| {
                let upwards = || first_root(dynamic, viscous, planned - still);
                let downwards = || first_root(-dynamic, -viscous, planned + still);
                // both parts one way: the limit the other way is out of reach
                if dynamic >= 0.0 && viscous >= 0.0 {
                    return upwards();
                }
                if dynamic <= 0.0 && viscous <= 0.0 {
                    return downwards();
                }
                upwards().min(downwards())
            };
            acceleration = acceleration.min(largest(mass + 2.0 * s * velocity, root_s * viscous));
            deceleration = deceleration.min(largest(2.0 * r * velocity - mass, root_r * viscous));
            cruise = cruise.min(largest(velocity, viscous));
        }
        let at = self.bounds.s.partition_point(|at| *at < s);
        self.bounds.s.insert(at, s);
        self.bounds.acceleration.insert(at, acceleration);
        self.bounds.deceleration.insert(at, deceleration);
        self.bounds.cruise.insert(at, cruise);
    }

    fn displacement(&self, joint: usize) -> f64 {
        if self.problem.moves(joint) {
            self.problem.displacement[joint]
        } else {
            0.0
        }
    }

    fn patterns(&self, law: &TimeLaw) -> Vec<Pattern> {
        let up = law.velocity / law.acceleration;
        let down = law.velocity / law.deceleration;
        let part = 1.0 - law.ramp_up() - law.ramp_down();
        // what rounding leaves of a triangle's cruise is none
        let cruise = if part < 0.5 * CRUISE_MIN {
            0.0
        } else {
            part / law.velocity
        };
        (0..self.problem.start.len())
            .map(|joint| {
                if !self.problem.moves(joint) {
                    return Pattern::default();
                }
                let displacement = self.problem.displacement[joint];
                Pattern {
                    displacement,
                    peak_velocity: law.velocity * displacement,
                    acceleration: law.acceleration * displacement,
                    deceleration: law.deceleration * displacement,
                    acceleration_time: up,
                    cruise_time: cruise,
                    deceleration_time: down,
                }
            })
            .collect()
    }
}

/// Square of the smallest positive z with d·z² + f·z = room, for a positive room; infinite where there is none.
fn first_root(d: f64, f: f64, room: f64) -> f64 {
    let discriminant = f * f + 4.0 * d * room;
    if discriminant < 0.0 {
        return f64::INFINITY;
    }
    let below = f + discriminant.sqrt();
    if below <= 0.0 {
        return f64::INFINITY;
    }
    let z = 2.0 * room / below;
    z * z
}

#[cfg(test)]
mod tests {
    use super::first_root;

    #[test]
    fn the_first_root_is_the_smallest_positive_one() {
        for (d, f, room, z) in [
            (1.0, 0.0, 4.0, 2.0),
            (0.0, 2.0, 4.0, 2.0),
            (-1.0, 3.0, 2.0, 1.0),
            (1.0, -3.0, 4.0, 4.0),
            (2.0, 3.0, 5.0, 1.0),
        ] {
            assert!((first_root(d, f, room) - z * z).abs() < 1e-14, "{d} {f} {room}");
        }
        for (d, f) in [(-1.0, 1.0), (-1.0, -3.0), (0.0, -1.0), (0.0, 0.0)] {
            assert_eq!(first_root(d, f, 4.0), f64::INFINITY);
        }
    }
}
