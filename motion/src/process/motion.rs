//! A chain at constant tool speed as a function of time: transitions, and between them the taught segments at Vs.
//!
//! The tool would pass taught point k at T₀ = ta₀, Tₖ₊₁ = Tₖ + Lₖ/Vs; its transition lasts from Tₖ − taₖ to Tₖ + taₖ.
//!
//! Orientation runs along each segment as a fraction of it: at the rate Vs/L between transitions, up from 0 and down to
//! 1 by the ramp of the transitions at its ends. During a seam two segments turn at once, as Δ− and Δ+ of the quartic
//! do: with a rotation wᵢ(f) of each segment, R = wᵢ₊₁(fᵢ₊₁)·wᵢ(fᵢ)·R_start in base axes. Its rate and acceleration are
//! continuous.

use nalgebra::Vector3;

use super::geometry::Segment;
use super::schedule::{Schedule, nodes};
use super::transition::{Curve, run_up};
use crate::curve::Side;
use crate::jet::Jet;
use crate::path::outcome::Location;
use crate::path::request::Transition;
use crate::tolerance::STRETCH_MIN;

/// The tool's motion along a chain, from rest to rest.
#[derive(Debug, Clone)]
pub(crate) struct ConstantSpeedMotion {
    segments: Vec<Segment>,
    speed: f64,
    /// Tₖ: when each taught point is passed, s. The first and the last are ta from the ends of the motion.
    passes: Vec<f64>,
    /// D, m.
    reaches: Vec<f64>,
    /// In time order; the first begins at 0.
    pieces: Vec<Piece>,
    duration: f64,
}

#[derive(Debug, Clone)]
struct Piece {
    begin: f64,
    kind: Kind,
}

#[derive(Debug, Clone)]
enum Kind {
    /// Along the segment at Vs.
    Stretch(usize),
    /// About the taught point.
    Transition(usize, Curve),
}

/// The tool at one time, with derivatives in time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct ToolState {
    /// Base axes, m.
    pub(crate) position: [Jet; 3],
    /// Which segment; within a seam the one before it.
    pub(crate) segment: usize,
    /// How much of the segment's rotation is done, 0 to 1.
    pub(crate) fraction: Jet,
    /// The same of the next segment, within a seam.
    pub(crate) next_fraction: Option<Jet>,
}

impl ConstantSpeedMotion {
    pub(super) fn new(segments: Vec<Segment>, schedule: &Schedule, form: Transition) -> Self {
        let speed = schedule.speed;
        let half_time = |node: usize| schedule.reaches[node] / speed;
        let mut passes = vec![half_time(0)];
        for segment in &segments {
            passes.push(passes[passes.len() - 1] + segment.length / speed);
        }
        let last = segments.len();
        let duration = passes[last] + half_time(last);
        let mut pieces = Vec::with_capacity(2 * last + 1);
        for (node, around) in nodes(&segments).iter().enumerate() {
            let begin = (passes[node] - half_time(node)).max(0.0);
            let curve = around.curve(form, schedule.reaches[node]);
            pieces.push(Piece {
                begin: if node == 0 { 0.0 } else { begin },
                kind: Kind::Transition(node, curve),
            });
            let end = passes[node] + half_time(node);
            let next = passes.get(node + 1).map(|pass| pass - half_time(node + 1));
            if next.is_some_and(|next| next - end > STRETCH_MIN * duration) {
                pieces.push(Piece {
                    begin: end,
                    kind: Kind::Stretch(node),
                });
            }
        }
        Self {
            segments,
            speed,
            passes,
            reaches: schedule.reaches.clone(),
            pieces,
            duration,
        }
    }

    /// s.
    pub(crate) fn duration(&self) -> f64 {
        self.duration
    }

    /// When the taught points are passed, s: one more than there are segments. At the ends the motion rests.
    pub(crate) fn passes(&self) -> Vec<f64> {
        let mut passes = self.passes.clone();
        passes[0] = 0.0;
        passes[self.segments.len()] = self.duration;
        passes
    }

    /// Length of a taught segment, m.
    pub(crate) fn length(&self, segment: usize) -> f64 {
        self.segments[segment].length
    }

    /// Where jerk may jump: the ends of all pieces, s, strictly increasing.
    pub(crate) fn knots(&self) -> Vec<f64> {
        self.pieces
            .iter()
            .map(|piece| piece.begin)
            .chain([self.duration])
            .collect()
    }

    /// When the transition about a taught point begins and ends, s.
    pub(super) fn transition_times(&self, node: usize) -> [f64; 2] {
        let half = self.reaches[node] / self.speed;
        let begin = if node == 0 { 0.0 } else { self.passes[node] - half };
        let end = if node == self.segments.len() {
            self.duration
        } else {
            self.passes[node] + half
        };
        [begin, end]
    }

    /// The tool at a time; at the end of a piece, from one side. Outside 0 to the duration, at the end.
    pub(crate) fn evaluate(&self, time: f64, side: Side) -> ToolState {
        let time = time.max(0.0).min(self.duration);
        let begun = match side {
            Side::Before => self.pieces.partition_point(|piece| piece.begin < time),
            Side::After => self.pieces.partition_point(|piece| piece.begin <= time),
        };
        let piece = &self.pieces[begun.max(1) - 1];
        match &piece.kind {
            Kind::Stretch(segment) => self.on_stretch(*segment, (time - self.passes[*segment]) * self.speed),
            Kind::Transition(node, curve) => {
                let rate = 0.5 * self.speed / self.reaches[*node];
                self.within(*node, curve, 0.5 + (time - self.passes[*node]) * rate)
            }
        }
    }

    /// On a segment at Vs, at an arc length.
    fn on_stretch(&self, segment: usize, way: f64) -> ToolState {
        let way = Jet::variable(way, self.speed);
        ToolState {
            position: self.segments[segment].point(way),
            segment,
            fraction: self.fraction(segment, way),
            next_fraction: None,
        }
    }

    fn within(&self, node: usize, curve: &Curve, h: f64) -> ToolState {
        let reach = self.reaches[node];
        // 1/(2·ta)
        let h = Jet::variable(h, 0.5 * self.speed / reach);
        let up = |segment: usize| self.fraction(segment, run_up(h) * reach);
        let down = |segment: usize| -self.fraction(segment, run_up(-h + 1.0) * reach) + 1.0;
        let last = self.segments.len();
        let segment = node.max(1) - 1;
        ToolState {
            position: match curve {
                Curve::Ramp(ramp) => self.segments[segment].point(ramp.way(h)),
                Curve::Polynomial(polynomial) => polynomial.point(h),
            },
            segment,
            fraction: if node == 0 { up(0) } else { down(segment) },
            next_fraction: (node > 0 && node < last).then(|| up(node)),
        }
    }

    /// Largest jumps of velocity, m/s, and of acceleration, m/s², at both ends of every transition; before and after
    /// the motion there is rest. From the ends of the curves themselves: a time as large as the motion's rounds too
    /// much to tell where a short transition ends.
    pub(super) fn jumps(&self) -> Vec<[f64; 2]> {
        let rest = [Vector3::zeros(); 2];
        let mut jumps = vec![[0.0; 2]; self.reaches.len()];
        let mut before = (None, rest);
        for piece in &self.pieces {
            let (node, [begin, end]) = match &piece.kind {
                Kind::Stretch(segment) => {
                    let way = [
                        self.reaches[*segment],
                        self.segments[*segment].length - self.reaches[segment + 1],
                    ];
                    (None, way.map(|way| rates(&self.on_stretch(*segment, way))))
                }
                Kind::Transition(node, curve) => {
                    (Some(*node), [0.0, 1.0].map(|h| rates(&self.within(*node, curve, h))))
                }
            };
            note(&mut jumps, [before.0, node], before.1, begin);
            before = (node, end);
        }
        note(&mut jumps, [before.0, None], before.1, rest);
        jumps
    }

    fn fraction(&self, segment: usize, way: Jet) -> Jet {
        way * (1.0 / self.segments[segment].length)
    }

    /// Where on the taught path: within a seam, the taught point that would be passed without it.
    pub(crate) fn location(&self, time: f64) -> Location {
        let last = self.segments.len() - 1;
        let [_, end_of_start] = self.transition_times(0);
        let [begin_of_end, _] = self.transition_times(last + 1);
        if time < end_of_start || time > begin_of_end {
            let state = self.evaluate(time, Side::After);
            if state.next_fraction.is_none() {
                return Location {
                    segment: state.segment,
                    fraction: state.fraction.value().clamp(0.0, 1.0),
                };
            }
        }
        let segment = self.passes[1..=last].partition_point(|pass| *pass <= time);
        let way = (time - self.passes[segment]) * self.speed;
        Location {
            segment,
            fraction: (way / self.segments[segment].length).clamp(0.0, 1.0),
        }
    }
}

/// Velocity and acceleration.
fn rates(tool: &ToolState) -> [Vector3<f64>; 2] {
    let [x, y, z] = tool.position.map(Jet::derivatives);
    [1, 2].map(|order| Vector3::new(x[order], y[order], z[order]))
}

/// Takes the jump between two pieces into account of those of them that are transitions.
fn note(jumps: &mut [[f64; 2]], nodes: [Option<usize>; 2], before: [Vector3<f64>; 2], after: [Vector3<f64>; 2]) {
    for node in nodes.into_iter().flatten() {
        for order in 0..2 {
            jumps[node][order] = jumps[node][order].max((after[order] - before[order]).norm());
        }
    }
}
