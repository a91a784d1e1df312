//! Six joints of which the second, third and fourth have parallel axes, as most arms that people work beside have.
//!
//! Turns about h move nothing along h. What joints 2 to 4 do is thus not seen along h, by the direction of axis 6 nor by
//! a point on it:
//!
//! ```text
//! h·rot(h₁, −q₁)·(R·h₆)             = h·rot(h₅, q₅)·h₆
//! h·rot(h₁, −q₁)·(E·p₆ − p₁) + h·p₁ = h·rot(h₅, q₅)·(p₆ − p₅) + h·p₅
//! ```
//!
//! Two equations, linear in (c₁, s₁) and in (c₅, s₅). With p₅ and p₆ the feet of the axes' common perpendicular, their
//! rows in (c₅, s₅) are at right angles. Where axes 5 and 6 neither meet nor are parallel, they give (c₅, s₅), and its
//! length a conic in (c₁, s₁). Where they meet the second one, where they are parallel the first one, is without q₅.
//!
//! Joint 6 then turns h to where joints 1 and 5 ask for it, and joints 2 to 4 are two links in a plane.

use nalgebra::Vector3;

use super::circle::{Conic, Direction, Directions, Linear, Slack, beside, turning};
use super::six::{Candidate, Line, Motion, SIX, angle};
use crate::tolerance::{IK_BESIDE_MIN, IK_GEOMETRY, IK_SEPARATE, IK_UNDETERMINED};

/// What the geometry of the arm gives once.
#[derive(Debug, Clone)]
pub(super) struct Parallel {
    lines: [Line; SIX],
    /// The direction of the parallel axes.
    h: Vector3<f64>,
    /// Whether joints 2 to 4 turn about h, 1, or about −h, −1.
    sign: [f64; 3],
    size: f64,
    hand: Hand,
    slack: Slack,
    /// The right sides of the two equations, the second over the arm's size.
    tilt: Linear,
    offset: Linear,
    /// The links of the plane: axis 2 to 3, and 3 to 4.
    upper: Vector3<f64>,
    lower: Vector3<f64>,
    /// A vector beside h.
    beside: Vector3<f64>,
}

/// How axes 5 and 6 lie.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Hand {
    Skew,
    Meeting,
    Parallel,
}

impl Parallel {
    /// The closed form, and by how much the axes miss what it takes them for, rad or over the arm's size.
    pub(super) fn new(lines: &[Line; SIX], size: f64) -> Option<(Self, f64)> {
        let mut lines = *lines;
        let h = lines[2].axis;
        let miss = lines[1].sine(&lines[2]).max(lines[3].sine(&lines[2]));
        if miss > IK_GEOMETRY || h.cross(&lines[4].axis).norm() < IK_BESIDE_MIN {
            return None;
        }
        let sign = [1, 2, 3].map(|i| if lines[i].axis.dot(&h) < 0.0 { -1.0 } else { 1.0 });
        let (p5, p6) = lines[4].feet(&lines[5]);
        (lines[4].point, lines[5].point) = (p5, p6);
        let arm = p6 - p5;
        let hand = match (
            lines[4].sine(&lines[5]) <= IK_GEOMETRY,
            arm.norm() <= IK_SEPARATE * size,
        ) {
            (false, false) => Hand::Skew,
            (false, true) => Hand::Meeting,
            (true, false) => Hand::Parallel,
            (true, true) => return None,
        };
        let miss = match hand {
            Hand::Skew => miss,
            Hand::Meeting => miss.max(arm.norm() / size),
            Hand::Parallel => miss.max(lines[4].sine(&lines[5])),
        };
        let across = |x: Vector3<f64>| x - h * h.dot(&x);
        let upper = across(lines[2].point - lines[1].point);
        let lower = across(lines[3].point - lines[2].point);
        if upper.norm().min(lower.norm()) <= IK_SEPARATE * size {
            return None;
        }
        let h5 = lines[4].axis;
        let mut offset = Linear::along_turned(&h, &h5, &arm);
        offset.0 += h.dot(&p5) - h.dot(&lines[0].point);
        let form = Self {
            lines,
            h,
            sign,
            size,
            hand,
            slack: Slack::of(miss),
            tilt: Linear::along_turned(&h, &h5, &lines[5].axis),
            offset: offset.scaled(1.0 / size),
            upper,
            lower,
            beside: beside(&h),
        };
        Some((form, miss))
    }

    /// Every branch.
    pub(super) fn candidates(&self, target: &Motion, reference: &[f64; SIX]) -> Vec<Candidate> {
        let mut candidates = Vec::with_capacity(8);
        let [first, .., sixth] = &self.lines;
        let left = |x: Vector3<f64>| Linear::along_turned(&self.h, &first.axis, &x).reversed();
        let tilt = left(target.rotation * sixth.axis);
        let offset = left(target.of(&sixth.point) - first.point).scaled(1.0 / self.size);
        let mut both = |alone: (Linear, Linear), other: (Linear, Linear)| {
            // the one equation has no q₅, the other one two answers for each q₁
            let shoulders = zeros_or(alone.0.minus(Linear(alone.1.0, 0.0, 0.0)), self.slack, reference[0]);
            for &q1 in shoulders.as_slice() {
                let fifth = other.1.minus(Linear(other.0.at(q1), 0.0, 0.0)).zeros(self.slack);
                for &q5 in fifth.as_slice() {
                    self.plane(q1, q5, target, reference, &mut candidates);
                }
            }
        };
        match self.hand {
            Hand::Meeting => both((offset, self.offset), (tilt, self.tilt)),
            Hand::Parallel => both((tilt, self.tilt), (offset, self.offset)),
            Hand::Skew => {
                // (c₅, s₅) = Σ row·(left − constant)/|row|², both rows being at right angles
                let [t, o] = [&self.tilt, &self.offset].map(|row| 1.0 / (row.1 * row.1 + row.2 * row.2));
                let tilt = tilt.minus(Linear(self.tilt.0, 0.0, 0.0)).scaled(t);
                let offset = offset.minus(Linear(self.offset.0, 0.0, 0.0)).scaled(o);
                let mut excess = Conic {
                    k: -1.0,
                    ..Conic::default()
                };
                excess.add_square(tilt, 1.0 / t);
                excess.add_square(offset, 1.0 / o);
                for &q1 in excess.zeros(self.slack).as_slice() {
                    let (x, y) = (tilt.at(q1), offset.at(q1));
                    let q5 = (x * self.tilt.1 + y * self.offset.1, x * self.tilt.2 + y * self.offset.2);
                    let norm = libm::sqrt(q5.0 * q5.0 + q5.1 * q5.1);
                    if norm > 0.0 {
                        self.plane(q1, (q5.0 / norm, q5.1 / norm), target, reference, &mut candidates);
                    }
                }
            }
        }
        candidates
    }

    /// Joint 6 of joints 1 and 5, then joints 2 to 4.
    fn plane(
        &self,
        q1: Direction,
        q5: Direction,
        target: &Motion,
        reference: &[f64; SIX],
        candidates: &mut Vec<Candidate>,
    ) {
        let [first, second, third, fourth, fifth, sixth] = &self.lines;
        let (turn1, turn5) = (first.turn(q1), fifth.turn(q5));
        let asked = turn5.tr_mul(&self.h);
        let given = target.rotation.tr_mul(&(turn1 * self.h));
        let q6 = turning(&sixth.axis, &given, &asked, 1.0, reference[5]);
        // what joints 2 to 4 have to do: e₁⁻¹·E·e₆⁻¹·e₅⁻¹, of the direction beside h and of axis 4's point
        let hand = turn5 * sixth.turn(q6.direction);
        let turned = turn1.tr_mul(&(target.rotation * hand.tr_mul(&self.beside)));
        let total = turning(&self.h, &self.beside, &turned, 1.0, 0.0);
        let on_sixth = sixth
            .turn(q6.direction)
            .tr_mul(&(turn5.tr_mul(&(fourth.point - fifth.point)) + fifth.point - sixth.point))
            + sixth.point;
        let place = first.point + turn1.tr_mul(&(target.of(&on_sixth) - first.point)) - second.point;
        let place = place - self.h * self.h.dot(&place);
        // |upper + rot(h, θ₃)·lower|² = |place|²
        let excess = Linear::along_turned(&self.upper, &self.h, &self.lower).minus(Linear(
            0.5 * (place.norm_squared() - self.upper.norm_squared() - self.lower.norm_squared()),
            0.0,
            0.0,
        ));
        for &q3 in excess.zeros(self.slack).as_slice() {
            let reached = self.upper + third.turn(q3) * self.lower;
            let q2 = turning(&self.h, &reached, &place, self.size, self.sign[0] * reference[1]);
            let [upper, elbow] = [angle(q2.direction), angle(q3)];
            let wrist = angle(total.direction) - upper - elbow;
            candidates.push(Candidate {
                q: [
                    angle(q1),
                    self.sign[0] * upper,
                    self.sign[1] * elbow,
                    self.sign[2] * wrist,
                    angle(q5),
                    angle(q6.direction),
                ],
                is_free: q6.is_free || q2.is_free,
            });
        }
    }
}

/// The zeros; where the equation says nothing of the angle, the reference.
fn zeros_or(f: Linear, slack: Slack, reference: f64) -> Directions {
    let mut zeros = f.zeros(slack);
    if f.amplitude() <= IK_UNDETERMINED {
        let (s, c) = libm::sincos(reference);
        zeros = Directions::default();
        zeros.push((c, s));
    }
    zeros
}
