//! Following a curve of the tool on one branch of the inverse kinematics, from one end to the other.
//!
//! Each step is predicted by the Taylor series of the joints and corrected by Newton's method; it is taken where both agree
//! closely, so that no other branch can have been met. What is kept are seeds: the joints with two derivatives at the steps,
//! between which a quintic Hermite polynomial comes close enough for Newton's method.

use super::arm::Arm;
use super::inverse::Followers;
use super::piecewise::piece_at;
use super::tool::ToolPoint;
use super::track::Joints;
use crate::budget::{Budget, Stopped};
use crate::curve::Side;
use crate::jet::Jet;
use crate::tolerance::{CLOSED, FOLLOW_MIN, FOLLOW_STEPS, SEED_ERROR, SINGULAR_MIN};

/// A curve of the tool.
pub(super) trait Guide {
    /// The tool at u; writes the joints that are led.
    fn aim(&self, u: Jet, side: Side, q: &mut Joints) -> ToolPoint;
}

/// Seeds of the joints along a curve.
#[derive(Debug)]
pub(super) struct Seeds {
    places: Vec<f64>,
    joint_count: usize,
    /// By place and joint: q, q′, q″.
    values: Vec<[f64; 3]>,
}

/// Where following ended too early.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Halt {
    /// How far it came.
    pub(super) at: f64,
    /// A lower bound of the Jacobian's smallest singular value there.
    pub(super) smallest: f64,
}

/// Follows a curve of the given length from `q`.
pub(super) fn follow(
    arm: &Arm,
    guide: &impl Guide,
    followers: &Followers,
    length: f64,
    q: &Joints,
    budget: &Budget<'_>,
) -> Result<Result<Seeds, Halt>, Stopped> {
    let mut seeds = Seeds {
        places: Vec::new(),
        joint_count: arm.joint_count(),
        values: Vec::new(),
    };
    let mut at = 0.0;
    let mut now = *q;
    let aim = guide.aim(Jet::variable(0.0, 1.0), Side::After, &mut now);
    let reached = followers.solve(arm, &aim, &mut now);
    let mut smallest = reached.smallest();
    let halt = |at, smallest| Ok(Err(Halt { at, smallest }));
    if reached.gap > CLOSED || smallest < SINGULAR_MIN {
        return halt(at, smallest);
    }
    seeds.push(at, &now);
    let mut step = 0.125 * length;
    for _ in 0..FOLLOW_STEPS {
        if at >= length {
            return Ok(Ok(seeds));
        }
        budget.check()?;
        let last = at + step >= length;
        let next = if last { length } else { at + step };
        let mut q = predicted(&now, next - at);
        let prediction = q;
        let aim = guide.aim(Jet::variable(next, 1.0), Side::Before, &mut q);
        let reached = followers.solve(arm, &aim, &mut q);
        let error = distance(followers, &prediction, &q);
        let there = reached.smallest();
        if reached.gap <= CLOSED && error <= SEED_ERROR && there >= SINGULAR_MIN {
            (at, now, smallest) = (next, q, there);
            seeds.push(at, &now);
            // the error goes with the fourth power of the step
            step *= (0.8 * (SEED_ERROR / error.max(f64::MIN_POSITIVE)).sqrt().sqrt()).clamp(0.5, 4.0);
            continue;
        }
        step = 0.25 * (next - at);
        if step < FOLLOW_MIN * length {
            return halt(at, smallest.min(there));
        }
    }
    halt(at, smallest)
}

/// Where the joints would be a step on.
fn predicted(q: &Joints, step: f64) -> Joints {
    q.map(|Jet([c0, c1, c2, c3])| Jet::constant(c0 + step * (c1 + step * (c2 + step * c3))))
}

fn distance(followers: &Followers, one: &Joints, other: &Joints) -> f64 {
    let apart = |joint: &usize| (one[*joint].value() - other[*joint].value()).abs();
    followers.joints().iter().map(apart).fold(0.0, f64::max)
}

impl Seeds {
    fn push(&mut self, place: f64, q: &Joints) {
        self.places.push(place);
        let joints = q.iter().take(self.joint_count);
        self.values.extend(joints.map(|q| [q.0[0], q.0[1], 2.0 * q.0[2]]));
    }

    /// Seeds at u.
    pub(super) fn at(&self, u: f64, q: &mut Joints) {
        let piece = piece_at(&self.places, u, Side::After);
        let (from, to) = (self.places[piece], self.places[piece + 1]);
        let width = to - from;
        let x = ((u - from) / width).clamp(0.0, 1.0);
        let [start, end] = [piece, piece + 1].map(|i| &self.values[i * self.joint_count..(i + 1) * self.joint_count]);
        let basis = hermite(x);
        for (q, (start, end)) in q.iter_mut().zip(start.iter().zip(end)) {
            let scale = [1.0, width, width * width];
            let mut value = 0.0;
            for k in 0..3 {
                value += scale[k] * (basis[0][k] * start[k] + basis[1][k] * end[k]);
            }
            q.0[0] = value;
        }
    }

    /// The joints where the curve ends.
    pub(super) fn end(&self) -> Vec<f64> {
        let last = self.values.len() - self.joint_count;
        self.values[last..].iter().map(|[q, ..]| *q).collect()
    }
}

/// Weights of value, slope and curvature at both ends of the unit interval.
fn hermite(x: f64) -> [[f64; 3]; 2] {
    let side = |x: f64| {
        let y = 1.0 - x;
        let cube = y * y * y;
        [
            cube * (1.0 + x * (3.0 + 6.0 * x)),
            cube * x * (1.0 + 3.0 * x),
            0.5 * cube * x * x,
        ]
    };
    let [value, slope, curvature] = side(1.0 - x);
    [side(x), [value, -slope, curvature]]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Quintics are met exactly.
    #[test]
    fn seeds_between_two_places_are_quintic() {
        let quintic = |u: f64| 1.0 - 2.0 * u + u * u + 0.5 * u.powi(3) - u.powi(4) + 0.25 * u.powi(5);
        let slope = |u: f64| -2.0 + 2.0 * u + 1.5 * u * u - 4.0 * u.powi(3) + 1.25 * u.powi(4);
        let curvature = |u: f64| 2.0 + 3.0 * u - 12.0 * u * u + 5.0 * u.powi(3);
        let mut seeds = Seeds {
            places: Vec::new(),
            joint_count: 1,
            values: Vec::new(),
        };
        for place in [0.0, 0.7, 2.0] {
            let mut q = Joints::default();
            q[0] = Jet::of_derivatives([quintic(place), slope(place), curvature(place), 0.0]);
            seeds.push(place, &q);
        }
        for i in 0..=40 {
            let u = f64::from(i) / 20.0;
            let mut q = Joints::default();
            seeds.at(u, &mut q);
            assert!((q[0].value() - quintic(u)).abs() < 1e-13);
        }
        assert_eq!(seeds.end(), [quintic(2.0)]);
    }
}
