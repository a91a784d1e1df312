//! Six joints whose last three axes meet in a point: a spherical wrist on any three turning joints.
//!
//! The wrist centre w does not move with the last three joints, so that the first three place it (Pieper 1968):
//!
//! ```text
//! e₁·e₂·e₃·w = E·w
//! ```
//!
//! Let d lead from axis 1 to axis 2 along their common perpendicular, both feet taken as the axes' points, and
//! y = h₂·m + v, v ⊥ h₂, be the wrist centre seen from axis 2 after joints 2 and 3. m and |y|² do not depend on joint 2,
//! and are linear in (c₃, s₃). Joint 1 keeps the height along its axis and the distance from its point, g = E·w − p₁:
//!
//! ```text
//! a·v = h₁·g − (h₁·h₂)·m            a = h₁ − h₂·(h₁·h₂)
//! d·v = (|g|² − |d|² − |y|²)/2                            |v|² = |y|² − m²
//! ```
//!
//! a ⊥ d. Where neither is 0 the two give v, and its length a conic in (c₃, s₃): four answers. Where the axes meet
//! (d = 0) or are parallel (a = 0), that equation is linear in (c₃, s₃), and the other one leaves v two answers.
//!
//! The last three joints then make up the rotation: h₄·rot(h₅, q₅)·h₆ is known, two answers.

use nalgebra::{Matrix3, Vector3};

use super::circle::{Conic, Linear, Slack, beside, turning};
use super::six::{Candidate, Line, Motion, SIX, angle};
use crate::tolerance::{IK_BESIDE_MIN, IK_GEOMETRY, IK_SEPARATE};

/// What the geometry of the arm gives once.
#[derive(Debug, Clone)]
pub(super) struct Wrist {
    lines: [Line; SIX],
    /// w at 0.
    center: Vector3<f64>,
    size: f64,
    /// From axis 1 to axis 2.
    d: Vector3<f64>,
    /// The part of h₁ beside h₂.
    a: Vector3<f64>,
    shoulder: Shoulder,
    slack: Slack,
    /// m.
    m: Linear,
    /// |y|².
    squared: Linear,
    /// A vector beside h₆.
    beside: Vector3<f64>,
}

/// How axes 1 and 2 lie.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Shoulder {
    Skew,
    Meeting,
    Parallel,
}

impl Wrist {
    /// The closed form, and by how much the axes miss what it takes them for, rad or over the arm's size.
    pub(super) fn new(lines: &[Line; SIX], size: f64) -> Option<(Self, f64)> {
        let mut lines = *lines;
        let (center, miss) = meeting_point(&lines[3], &lines[4], &lines[5])?;
        if miss > IK_GEOMETRY * size {
            return None;
        }
        let (p1, p2) = lines[0].feet(&lines[1]);
        (lines[0].point, lines[1].point) = (p1, p2);
        let [h1, h2, h3] = [lines[0].axis, lines[1].axis, lines[2].axis];
        let a = h1 - h2 * h1.dot(&h2);
        let d = p2 - p1;
        let shoulder = match (a.norm() <= IK_GEOMETRY, d.norm() <= IK_SEPARATE * size) {
            (false, false) => Shoulder::Skew,
            (false, true) => Shoulder::Meeting,
            (true, false) => Shoulder::Parallel,
            (true, true) => return None,
        };
        let miss = match shoulder {
            Shoulder::Skew => miss / size,
            Shoulder::Meeting => (miss / size).max(d.norm() / size),
            Shoulder::Parallel => (miss / size).max(a.norm()),
        };
        // the wrist centre after joint 3, seen from axis 2
        let from_third = center - lines[2].point;
        let along = h3 * h3.dot(&from_third);
        let fixed = lines[2].point - p2 + along;
        let circle = [from_third - along, h3.cross(&from_third)];
        let squared = Linear(
            fixed.norm_squared() + circle[0].norm_squared(),
            2.0 * fixed.dot(&circle[0]),
            2.0 * fixed.dot(&circle[1]),
        );
        let form = Self {
            lines,
            center,
            size,
            d,
            a,
            shoulder,
            slack: Slack::of(miss),
            m: Linear(h2.dot(&fixed), h2.dot(&circle[0]), h2.dot(&circle[1])),
            squared,
            beside: beside(&lines[5].axis),
        };
        Some((form, miss))
    }

    /// Every branch.
    pub(super) fn candidates(&self, target: &Motion, reference: &[f64; SIX]) -> Vec<Candidate> {
        let mut candidates = Vec::with_capacity(8);
        let g = target.of(&self.center) - self.lines[0].point;
        let [h1, h2] = [self.lines[0].axis, self.lines[1].axis];
        // a·v and d·v as functions of joint 3
        let height = Linear(h1.dot(&g), 0.0, 0.0).minus(self.m.scaled(h1.dot(&h2)));
        let span = Linear(g.norm_squared() - self.d.norm_squared(), 0.0, 0.0)
            .minus(self.squared)
            .scaled(0.5);
        let (a_squared, d_squared) = (self.a.norm_squared(), self.d.norm_squared());
        let elbows = match self.shoulder {
            Shoulder::Meeting => span.zeros(self.slack),
            Shoulder::Parallel => height.zeros(self.slack),
            Shoulder::Skew => {
                let mut excess = Conic::default();
                excess.add_square(height, 1.0 / a_squared);
                excess.add_square(span, 1.0 / d_squared);
                excess.add_square(self.m, 1.0);
                excess.add(self.squared, -1.0);
                excess.zeros(self.slack)
            }
        };
        for &q3 in elbows.as_slice() {
            let free = self.squared.at(q3) - self.m.at(q3) * self.m.at(q3);
            let (known, beside) = match self.shoulder {
                Shoulder::Skew => {
                    let v = self.a * (height.at(q3) / a_squared) + self.d * (span.at(q3) / d_squared);
                    self.arm(&v, q3, &g, target, reference, &mut candidates);
                    continue;
                }
                Shoulder::Meeting => (self.a * (height.at(q3) / a_squared), h2.cross(&self.a)),
                Shoulder::Parallel => (self.d * (span.at(q3) / d_squared), h2.cross(&self.d)),
            };
            let squared_size = self.size * self.size;
            let Some(rest) = self.slack.root((free - known.norm_squared()) / squared_size) else {
                continue;
            };
            let rest = beside * (rest * self.size / beside.norm());
            self.arm(&(known + rest), q3, &g, target, reference, &mut candidates);
            if rest != Vector3::zeros() {
                self.arm(&(known - rest), q3, &g, target, reference, &mut candidates);
            }
        }
        candidates
    }

    /// Joints 1 and 2 of v, then the wrist.
    fn arm(
        &self,
        v: &Vector3<f64>,
        q3: (f64, f64),
        g: &Vector3<f64>,
        target: &Motion,
        reference: &[f64; SIX],
        candidates: &mut Vec<Candidate>,
    ) {
        let [first, second, third, ..] = &self.lines;
        let turned = third.turn(q3);
        let y = third.point + turned * (self.center - third.point) - second.point;
        let q2 = turning(&second.axis, &y, v, self.size, reference[1]);
        let placed = second.turn(q2.direction) * y + self.d;
        let q1 = turning(&first.axis, &placed, g, self.size, reference[0]);
        let rotation = first.turn(q1.direction) * second.turn(q2.direction) * turned;
        let arm = [angle(q1.direction), angle(q2.direction), angle(q3)];
        let is_free = q1.is_free || q2.is_free;
        self.hand(
            arm,
            is_free,
            &(rotation.transpose() * target.rotation),
            reference,
            candidates,
        );
    }

    /// Joints 4 to 6 of the rotation that they have to make.
    fn hand(
        &self,
        [q1, q2, q3]: [f64; 3],
        is_free: bool,
        rotation: &Matrix3<f64>,
        reference: &[f64; SIX],
        candidates: &mut Vec<Candidate>,
    ) {
        let [.., fourth, fifth, sixth] = &self.lines;
        let h6 = rotation * sixth.axis;
        let excess =
            Linear::along_turned(&fourth.axis, &fifth.axis, &sixth.axis).minus(Linear(fourth.axis.dot(&h6), 0.0, 0.0));
        for &q5 in excess.zeros(self.slack).as_slice() {
            let turned = fifth.turn(q5);
            let q4 = turning(&fourth.axis, &(turned * sixth.axis), &h6, 1.0, reference[3]);
            let rest = (fourth.turn(q4.direction) * turned).tr_mul(&(rotation * self.beside));
            let q6 = turning(&sixth.axis, &self.beside, &rest, 1.0, reference[5]);
            candidates.push(Candidate {
                q: [q1, q2, q3, angle(q4.direction), angle(q5), angle(q6.direction)],
                is_free: is_free || q4.is_free,
            });
        }
    }
}

/// The point with the least squared distances from three lines, and the largest distance; `None` where neighbours are
/// nearly parallel.
fn meeting_point(a: &Line, b: &Line, c: &Line) -> Option<(Vector3<f64>, f64)> {
    if a.sine(b) < IK_BESIDE_MIN || b.sine(c) < IK_BESIDE_MIN {
        return None;
    }
    let mut matrix = Matrix3::zeros();
    let mut right = Vector3::zeros();
    for line in [a, b, c] {
        let across = Matrix3::identity() - line.axis * line.axis.transpose();
        matrix += across;
        right += across * line.point;
    }
    let point = matrix.try_inverse()? * right;
    let miss = a.distance(&point).max(b.distance(&point)).max(c.distance(&point));
    Some((point, miss))
}
