//! Paths whose third derivative jumps at their knots, some of them very close together.

use super::*;
use crate::curve::{CurvePoint, Side};

/// Cubic pieces, twice continuously differentiable.
struct Pieces {
    knots: Vec<f64>,
    /// q, q′, q″ and q‴ of every joint at the beginning of every piece.
    pieces: Vec<Vec<[f64; 4]>>,
}

fn moved([q, q1, q2, q3]: [f64; 4], x: f64) -> [f64; 4] {
    [
        q + x * (q1 + x * (q2 / 2.0 + x * q3 / 6.0)),
        q1 + x * (q2 + x * q3 / 2.0),
        q2 + x * q3,
        q3,
    ]
}

impl Pieces {
    fn new(knots: Vec<f64>, joints: usize) -> Self {
        let joint = |joint: usize| [0.1 * joint as f64 - 0.3, 1.0 - 0.3 * joint as f64, 0.5, 0.0];
        let mut at: Vec<[f64; 4]> = (0..joints).map(joint).collect();
        let mut pieces = Vec::new();
        for (k, pair) in knots.windows(2).enumerate() {
            for (j, at) in at.iter_mut().enumerate() {
                at[3] = 20.0 * (7.3 * k as f64 + 1.7 * j as f64).sin();
            }
            pieces.push(at.clone());
            for at in &mut at {
                *at = moved(*at, pair[1] - pair[0]);
            }
        }
        Self { knots, pieces }
    }
}

impl Curve for Pieces {
    fn joint_count(&self) -> usize {
        self.pieces[0].len()
    }

    fn length(&self) -> f64 {
        self.knots[self.knots.len() - 1]
    }

    fn knots(&self) -> &[f64] {
        &self.knots
    }

    fn evaluate(&self, s: f64, side: Side, point: &mut CurvePoint) {
        let s = s.clamp(0.0, self.length());
        let after = match side {
            Side::Before => self.knots.partition_point(|knot| *knot < s),
            Side::After => self.knots.partition_point(|knot| *knot <= s),
        };
        let piece = after.clamp(1, self.pieces.len()) - 1;
        for (joint, begin) in self.pieces[piece].iter().enumerate() {
            [
                point.position[joint],
                point.first[joint],
                point.second[joint],
                point.third[joint],
            ] = moved(*begin, s - self.knots[piece]);
        }
    }
}

/// Jerk is kept on both sides of every jump, and knots that nearly coincide cost nothing.
#[test]
fn both_sides_of_a_jump_count() {
    let arm = with_drives(&ur5e());
    let limits = Limits::uniform(with_jerk(own_limits(&arm), 15.0, 150.0));
    for close in [
        vec![],
        vec![0.6 + 1e-3],
        vec![0.6 + 1e-5],
        vec![0.6 + 1e-8],
        vec![1e-6, 1.0 - 1e-7],
    ] {
        let mut knots = vec![0.0, 0.25, 0.6, 0.8, 1.0];
        knots.extend(close);
        knots.sort_by(f64::total_cmp);
        let curve = Pieces::new(knots, 6);
        let timing = timed(&arm, &curve, &limits, 300).unwrap();
        let [jerk, others] = worst_uses(&arm, &curve, &limits, &timing.law, 4000, 4);
        assert!(jerk <= 1.0 + 1e-3 && others <= 1.0 - 1e-6, "{jerk} {others}");
        assert!(jerk.max(others) > 0.98, "{jerk} {others}");
        assert!(timing.law.duration() < 2.0, "{}", timing.law.duration());
    }
}

/// The length of a path's own parameter means nothing.
#[test]
fn the_parameter_may_have_any_length() {
    let arm = with_drives(&ur5e());
    let limits = Limits::uniform(with_jerk(own_limits(&arm), 15.0, 150.0));
    let duration = |length: f64| {
        let joint = |joint: usize| {
            let c = [0.1 * joint as f64, 1.0, -0.4 * joint as f64, 0.7];
            (0..4).map(|power| c[power as usize] / length.powi(power)).collect()
        };
        let curve = Polynomials::new((0..6).map(joint).collect(), length);
        timed(&arm, &curve, &limits, 200).unwrap().law.duration()
    };
    let one = duration(1.0);
    for length in [1e-3, 1e4] {
        assert!((duration(length) / one - 1.0).abs() < 1e-6, "{length}");
    }
}
