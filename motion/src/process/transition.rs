//! One transition: how the tool goes from rest into a segment, over a taught corner, or out to rest.
//!
//! Time is h = (t + ta)/(2·ta), from 0 to 1. The only other parameter is the reach D = Vs·ta, the taught path length
//! that the transition takes on each side of its taught point: the curve depends on D alone, its speeds are Vs and its
//! accelerations Vs² times what is said here.
//!
//! ```text
//! quartic     p(h) = P + Δ− + [(Δ− + Δ+)·(2 − h)·h² − 2·Δ−]·h                   (JPH0743606B2, Δ± = P± − P)
//! quintic     p, p′ = 2D·t̂ and p″ = 4D²·κ at both ends                          (κ = n̂/r on an arc, 0 on a line)
//! ramp        σ(h) = D·(2 − h)·h³ along the taught segment; to rest the same backwards
//! ```
//!
//! The quartic is Δ− run down by the ramp plus Δ+ run up by it: (1 + h)(1 − h)³ = 1 − 2h + (2 − h)h³. Its velocity goes
//! from −Δ−/ta to Δ+/ta, its acceleration from 0 to 0: that fits lines, and arcs only by a jump. Between lines the
//! quintic is the quartic: its fifth power vanishes. By default seams are quintics, from rest and to rest there are
//! ramps; the source's form is the quartic everywhere.

use nalgebra::Vector3;

use super::geometry::{PathFrame, Segment};
use crate::jet::Jet;
use crate::path::request::Transition;

/// The taught point that a transition is about.
#[derive(Debug, Clone, Copy)]
pub(super) enum Node<'a> {
    /// The start: from rest into the segment.
    Start(&'a Segment),
    /// From the first segment into the second.
    Seam(&'a Segment, &'a Segment),
    /// The end: to rest.
    End(&'a Segment),
}

/// The curve of a transition.
#[derive(Debug, Clone)]
pub(super) enum Curve {
    /// Along the taught segment.
    Ramp(Ramp),
    /// A curve of its own.
    Polynomial(Polynomial),
}

/// Arc length along one segment from rest to full speed, or from that to rest.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Ramp {
    /// D, m.
    pub(super) reach: f64,
    /// σ of the end at rest, and whether that is the beginning.
    pub(super) rest: f64,
    pub(super) up: bool,
}

/// p(h) = P + Σ cₖ·hᵏ, m.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Polynomial {
    origin: Vector3<f64>,
    pub(super) coefficients: [Vector3<f64>; 6],
}

impl Node<'_> {
    /// The transition of this reach.
    pub(super) fn curve(&self, form: Transition, reach: f64) -> Curve {
        match *self {
            Node::Start(next) if form == Transition::Smooth || next.is_line() => Curve::Ramp(Ramp::up(reach)),
            Node::End(last) if form == Transition::Smooth || last.is_line() => {
                Curve::Ramp(Ramp::down(reach, last.length))
            }
            Node::Seam(last, next) if form == Transition::Smooth => {
                let [before, after] = self.chords(reach);
                let before = PathFrame {
                    position: before,
                    ..last.frame(last.length - reach)
                };
                let after = PathFrame {
                    position: after,
                    ..next.frame(reach)
                };
                Curve::Polynomial(Polynomial::quintic(&before, &after, reach).about(&self.corner()))
            }
            Node::Start(_) | Node::Seam(..) | Node::End(_) => {
                let [before, after] = self.chords(reach);
                Curve::Polynomial(Polynomial::quartic(&before, &Vector3::zeros(), &after).about(&self.corner()))
            }
        }
    }

    /// P, the taught point.
    pub(super) fn corner(&self) -> Vector3<f64> {
        match self {
            Node::Start(next) => next.frame(0.0).position,
            Node::Seam(last, _) | Node::End(last) => last.frame(last.length).position,
        }
    }

    /// Δ− and Δ+. A gap between two segments is taken in.
    fn chords(&self, reach: f64) -> [Vector3<f64>; 2] {
        let before = |last: &Segment| last.chord(last.length, -reach);
        let after = |next: &Segment| next.chord(0.0, reach);
        match self {
            Node::Start(next) => [Vector3::zeros(), after(next)],
            Node::Seam(last, next) => {
                let gap = next.frame(0.0).position - self.corner();
                [before(last), after(next) + gap]
            }
            Node::End(last) => [before(last), Vector3::zeros()],
        }
    }

    /// Largest |d²p/dσ²| of the taught path on both sides, 1/m.
    pub(super) fn taught_curvature(&self) -> f64 {
        match self {
            Node::Start(only) | Node::End(only) => only.curvature(),
            Node::Seam(last, next) => last.curvature().max(next.curvature()),
        }
    }

    /// The change of direction, |t̂+ − t̂−|, where only lines meet: there everything is known in closed form.
    pub(super) fn turn_of_lines(&self) -> Option<f64> {
        match self {
            Node::Start(only) | Node::End(only) => only.is_line().then_some(1.0),
            Node::Seam(last, next) => {
                let lines = last.is_line() && next.is_line();
                lines.then(|| (next.frame(0.0).tangent - last.frame(last.length).tangent).norm())
            }
        }
    }

    /// The shorter of the segments it reaches into, m.
    pub(super) fn room(&self) -> f64 {
        match self {
            Node::Start(only) | Node::End(only) => only.length,
            Node::Seam(last, next) => last.length.min(next.length),
        }
    }

    /// Distance of a point from the taught segments.
    pub(super) fn distance(&self, point: &Vector3<f64>) -> f64 {
        match self {
            Node::Start(only) | Node::End(only) => only.distance(point),
            Node::Seam(last, next) => last.distance(point).min(next.distance(point)),
        }
    }
}

impl Ramp {
    fn up(reach: f64) -> Self {
        Self {
            reach,
            rest: 0.0,
            up: true,
        }
    }

    fn down(reach: f64, length: f64) -> Self {
        Self {
            reach,
            rest: length,
            up: false,
        }
    }

    /// σ.
    pub(super) fn way(&self, h: Jet) -> Jet {
        if self.up {
            return run_up(h) * self.reach + self.rest;
        }
        -(run_up(-h + 1.0) * self.reach) + self.rest
    }

    /// |dσ/dh| and |d²σ/dh²|.
    pub(super) fn rates(&self, h: f64) -> [f64; 2] {
        let h = if self.up { h } else { 1.0 - h };
        [self.reach * h * h * (6.0 - 4.0 * h), self.reach * 12.0 * h * (1.0 - h)]
    }
}

/// (2 − h)·h³: from rest to the rate 2, without acceleration at both ends.
pub(super) fn run_up(h: Jet) -> Jet {
    (-h + 2.0) * h * h * h
}

impl Polynomial {
    /// The source's form, from P− over P to P+.
    pub(super) fn quartic(before: &Vector3<f64>, corner: &Vector3<f64>, after: &Vector3<f64>) -> Self {
        let (before, after) = (before - corner, after - corner);
        let (zero, sum) = (Vector3::zeros(), before + after);
        Self {
            origin: *corner,
            coefficients: [before, before * -2.0, zero, sum * 2.0, -sum, zero],
        }
    }

    /// The same curve moved to the taught point that its coordinates count from.
    fn about(self, corner: &Vector3<f64>) -> Self {
        Self {
            origin: self.origin + corner,
            ..self
        }
    }

    /// Position, velocity and acceleration of both ends.
    pub(super) fn quintic(before: &PathFrame, after: &PathFrame, reach: f64) -> Self {
        let rate = 2.0 * reach;
        let way = after.position - before.position;
        let (v0, v1) = (before.tangent * rate, after.tangent * rate);
        let (a0, a1) = (before.curvature * (rate * rate), after.curvature * (rate * rate));
        Self {
            origin: before.position,
            coefficients: [
                Vector3::zeros(),
                v0,
                a0 * 0.5,
                way * 10.0 - v0 * 6.0 - v1 * 4.0 - a0 * 1.5 + a1 * 0.5,
                way * -15.0 + v0 * 8.0 + v1 * 7.0 + a0 * 1.5 - a1,
                way * 6.0 - (v0 + v1) * 3.0 + (a1 - a0) * 0.5,
            ],
        }
    }

    pub(super) fn point(&self, h: Jet) -> [Jet; 3] {
        std::array::from_fn(|axis| {
            let sum = self
                .coefficients
                .iter()
                .rev()
                .fold(Jet::default(), |sum, c| sum * h + c[axis]);
            sum + self.origin[axis]
        })
    }

    #[inline]
    pub(super) fn position(&self, h: f64) -> Vector3<f64> {
        let sum = self
            .coefficients
            .iter()
            .rev()
            .fold(Vector3::zeros(), |sum, c| sum * h + c);
        sum + self.origin
    }

    /// dp/dh and d²p/dh².
    pub(super) fn rates(&self, h: f64) -> [Vector3<f64>; 2] {
        let [_, c1, c2, c3, c4, c5] = self.coefficients;
        [
            c1 + (c2 * 2.0 + (c3 * 3.0 + (c4 * 4.0 + c5 * (5.0 * h)) * h) * h) * h,
            c2 * 2.0 + (c3 * 6.0 + (c4 * 12.0 + c5 * (20.0 * h)) * h) * h,
        ]
    }
}
