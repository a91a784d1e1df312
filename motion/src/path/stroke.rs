//! A path without a stop within it: tracks one after the other, overlapping where they are blended.

use std::sync::Arc as Shared;

use nalgebra::Vector3;

use super::arm::Arm;
use super::corner::{self, Corner, Mix};
use super::outcome::Location;
use super::piecewise::piece_at;
use super::track::{Joints, Track};
use crate::curve::{Curve, CurvePoint, Side};
use crate::jet::Jet;
use crate::robot::JOINTS_MAX;

/// One path from rest to rest.
#[derive(Debug)]
pub(crate) struct Stroke {
    arm: Shared<Arm>,
    tracks: Vec<Track>,
    pieces: Vec<Piece>,
    /// Where the pieces begin, and the end.
    seams: Vec<f64>,
    knots: Vec<f64>,
    spans: Vec<Span>,
    dwell: f64,
}

/// A stretch of one track, or of two that are blended.
#[derive(Debug)]
enum Piece {
    /// The track, and its parameter where the stretch begins.
    Single { track: usize, from: f64 },
    /// This track and the next.
    Blend { first: usize, mix: Mix },
}

/// Where one segment of the request is on a stroke: from the middle of the blend before it to that of the one after.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Span {
    pub(crate) segment: usize,
    /// s on the stroke.
    pub(crate) begin: f64,
    pub(crate) end: f64,
}

/// The tool centre point and its derivatives in s, in base-link axes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct ToolRates {
    /// m.
    pub(crate) position: Vector3<f64>,
    /// p′.
    pub(crate) first: Vector3<f64>,
    /// p″.
    pub(crate) second: Vector3<f64>,
    /// p‴.
    pub(crate) third: Vector3<f64>,
}

impl Stroke {
    /// Joins tracks; `mixes` has one entry a corner, one less than there are tracks.
    pub(super) fn new(arm: Shared<Arm>, tracks: Vec<Track>, mixes: Vec<Mix>, dwell: f64) -> Self {
        let mut stroke = Self {
            arm,
            pieces: Vec::with_capacity(2 * tracks.len()),
            seams: vec![0.0],
            knots: vec![0.0],
            spans: Vec::with_capacity(tracks.len()),
            tracks: Vec::new(),
            dwell,
        };
        let (mut end, mut from, mut middle) = (0.0, 0.0, 0.0);
        let mut mixes = mixes.into_iter();
        for (index, track) in tracks.iter().enumerate() {
            let mix = mixes.next();
            let until = mix.as_ref().map_or(track.length, |mix| mix.first_begin(track));
            if until > from {
                stroke.knots_of(track, from, until, |u| end + (u - from));
                end += until - from;
                stroke.close(Piece::Single { track: index, from }, end);
            }
            let begin = middle;
            middle = end;
            if let Some(mix) = mix {
                let next = &tracks[index + 1];
                let (passage, start) = (mix.passage(), end);
                stroke.knots_of(track, until, track.length, |u| {
                    start + passage.s_at((u - until) / passage.before)
                });
                stroke.knots_of(next, 0.0, passage.after, |u| start + passage.s_at(u / passage.after));
                middle = end + passage.s_at(0.5);
                end += passage.length();
                from = passage.after;
                stroke.close(Piece::Blend { first: index, mix }, end);
            }
            stroke.spans.push(Span {
                segment: track.segment,
                begin,
                end: middle,
            });
        }
        stroke.tracks = tracks;
        stroke.knots.extend_from_slice(&stroke.seams);
        stroke.knots.sort_by(f64::total_cmp);
        stroke.knots.dedup();
        stroke
    }

    /// Adds the knots of a track between two of its parameters.
    fn knots_of(&mut self, track: &Track, from: f64, to: f64, s_at: impl Fn(f64) -> f64) {
        let inside = track.knots.iter().filter(|knot| **knot > from && **knot < to);
        self.knots.extend(inside.map(|knot| s_at(*knot)));
    }

    fn close(&mut self, piece: Piece, end: f64) {
        self.pieces.push(piece);
        self.seams.push(end);
    }

    /// Time at rest after it, s.
    pub(crate) fn dwell(&self) -> f64 {
        self.dwell
    }

    /// Where its segments are, in order, without gaps.
    pub(crate) fn spans(&self) -> &[Span] {
        &self.spans
    }

    /// Where on the request's segments a point is.
    pub(crate) fn location(&self, s: f64) -> Location {
        let s = s.clamp(0.0, self.length());
        let piece = piece_at(&self.seams, s, Side::After);
        let local = s - self.seams[piece];
        match &self.pieces[piece] {
            Piece::Single { track, from } => {
                let track = &self.tracks[*track];
                Location {
                    segment: track.segment,
                    fraction: ((from + local) / track.length).clamp(0.0, 1.0),
                }
            }
            Piece::Blend { first, mix } => {
                corner::location(&mix.passage(), &self.tracks[*first], &self.tracks[first + 1], local)
            }
        }
    }

    /// The tool at a point of the path, from that point's joints.
    pub(crate) fn tool(&self, point: &CurvePoint) -> ToolRates {
        let mut q = [Jet::default(); JOINTS_MAX];
        for (joint, q) in q.iter_mut().enumerate().take(self.arm.joint_count()) {
            *q = Jet::of_derivatives([
                point.position[joint],
                point.first[joint],
                point.second[joint],
                point.third[joint],
            ]);
        }
        let q = &q[..self.arm.joint_count()];
        let frames = self.arm.frames(q);
        let [first, second, third] = self.arm.rates::<3>(&frames, q).linear;
        ToolRates {
            position: frames.position,
            first,
            second,
            third,
        }
    }

    /// The joints at s.
    pub(super) fn joints(&self, s: f64, side: Side, q: &mut Joints) {
        let s = s.clamp(0.0, self.length());
        let piece = piece_at(&self.seams, s, side);
        let local = s - self.seams[piece];
        match &self.pieces[piece] {
            Piece::Single { track, from } => {
                self.tracks[*track].joints(&self.arm, Jet::variable(from + local, 1.0), side, q);
            }
            Piece::Blend { first, mix } => {
                let corner = Corner {
                    arm: &self.arm,
                    first: &self.tracks[*first],
                    second: &self.tracks[first + 1],
                };
                mix.joints(corner, local, side, q);
            }
        }
    }
}

impl Curve for Stroke {
    fn joint_count(&self) -> usize {
        self.arm.joint_count()
    }

    fn length(&self) -> f64 {
        self.seams[self.seams.len() - 1]
    }

    fn knots(&self) -> &[f64] {
        &self.knots
    }

    fn evaluate(&self, s: f64, side: Side, point: &mut CurvePoint) {
        let mut q = [Jet::default(); JOINTS_MAX];
        self.joints(s, side, &mut q);
        point.set(&q[..self.arm.joint_count()]);
    }
}
