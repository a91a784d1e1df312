//! A timing of a path: the squared path velocity a(s) = ṡ², piece by piece, and the motion s(t) that follows from it.
//!
//! ```text
//! ṡ = √a      s̈ = a′/2      s⃛ = ṡ·a″/2      t(s) = ∫ ds/√a
//! ```
//!
//! Where a is linear, s̈ is constant and t(s) and s(t) are closed forms. From rest at constant s⃛ = j it is
//! a = a₁·(x/h)^(4/3) with j = (2/9)·a₁^(3/2)/h² and s = j·t³/6. Other pieces are integrated by Gauss and Legendre's rule
//! of six points and inverted by Newton's method; a motion is never integrated step by step.

use crate::tolerance::{
    LAW_CYCLE_ROUNDING, LAW_INVERSE_ROUNDS, LAW_INVERSE_TIME, LAW_PANEL_CLEAR, LAW_PANEL_LEAST, LAW_PANELS_MAX,
};

/// How a(s) runs over a piece; x is the distance from where the piece begins, h its length.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Form {
    /// a = c₀ + c₁·x + c₂·x² + c₃·x³, positive but at the ends of a linear one.
    Polynomial([f64; 4]),
    /// From rest at constant jerk of the path: a = a₁·(x/h)^(4/3).
    FromRest {
        /// a₁, at the end of the piece.
        end: f64,
    },
    /// To rest at constant jerk of the path: a = a₁·((h − x)/h)^(4/3).
    ToRest {
        /// a₁, at the beginning of the piece.
        begin: f64,
    },
}

/// One piece of a timing.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Piece {
    /// Path position where it begins.
    pub(crate) begin: f64,
    /// Path position where it ends.
    pub(crate) end: f64,
    pub(crate) form: Form,
}

/// Where a motion is on its path, and how fast it goes.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct PathState {
    /// s.
    pub(crate) position: f64,
    /// ṡ.
    pub(crate) velocity: f64,
    /// s̈.
    pub(crate) acceleration: f64,
    /// s⃛.
    pub(crate) jerk: f64,
}

/// A timing of a whole path.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct TimeLaw {
    pieces: Vec<Piece>,
    /// When each piece begins, and when the last one ends, s.
    times: Vec<f64>,
}

impl Piece {
    /// A piece on which a changes linearly.
    pub(crate) fn linear(begin: f64, end: f64, [from, to]: [f64; 2]) -> Self {
        let form = Form::Polynomial([from, (to - from) / (end - begin), 0.0, 0.0]);
        Self { begin, end, form }
    }

    fn length(&self) -> f64 {
        self.end - self.begin
    }

    /// a, a′ and a″ at a distance from the beginning.
    fn at(&self, x: f64) -> [f64; 3] {
        let h = self.length();
        match self.form {
            Form::Polynomial([c0, c1, c2, c3]) => [
                (c0 + x * (c1 + x * (c2 + x * c3))).max(0.0),
                c1 + x * (2.0 * c2 + 3.0 * x * c3),
                2.0 * c2 + 6.0 * x * c3,
            ],
            Form::FromRest { end } => from_rest(end, h, x),
            Form::ToRest { begin } => {
                let [a, a1, a2] = from_rest(begin, h, h - x);
                [a, -a1, a2]
            }
        }
    }

    /// How long the way from the beginning to a distance takes.
    fn time_to(&self, x: f64) -> f64 {
        let h = self.length();
        match self.form {
            Form::Polynomial(_) | Form::FromRest { .. } if x <= 0.0 => 0.0,
            Form::Polynomial([c0, c1, 0.0, 0.0]) => 2.0 * x / (c0.max(0.0).sqrt() + (c0 + c1 * x).max(0.0).sqrt()),
            Form::Polynomial(_) => self.integrate(x),
            Form::FromRest { end } => libm::cbrt(6.0 * x / rest_jerk(end, h)),
            Form::ToRest { begin } => {
                let jerk = rest_jerk(begin, h);
                libm::cbrt(6.0 * h / jerk) - libm::cbrt(6.0 * (h - x).max(0.0) / jerk)
            }
        }
    }

    /// ∫ dx/√a from 0 to `x`, panel by panel. The panels are the same whatever `x` is, so that it grows without jumps.
    fn integrate(&self, x: f64) -> f64 {
        let whole = self.length();
        let least = whole * LAW_PANEL_LEAST;
        let (mut sum, mut begin, mut width) = (0.0, 0.0, whole);
        for _ in 0..LAW_PANELS_MAX {
            while width > least && !self.is_even(begin, width) {
                width *= 0.5;
            }
            sum += self.panel(begin, (x - begin).min(width));
            begin += width;
            if begin >= x || !sum.is_finite() {
                return sum;
            }
            width = (2.0 * width).min(whole - begin);
        }
        sum + self.panel(begin, x - begin)
    }

    /// ∫ dx/√a over one panel, by Gauss and Legendre's rule.
    fn panel(&self, begin: f64, width: f64) -> f64 {
        let middle = begin + 0.5 * width;
        let pair = |(node, weight): (f64, f64)| {
            let away = 0.5 * node * width;
            weight * (self.at(middle - away)[0].sqrt().recip() + self.at(middle + away)[0].sqrt().recip())
        };
        0.5 * width * GAUSS.into_iter().map(pair).sum::<f64>()
    }

    /// Whether √a varies so evenly over a panel that Gauss and Legendre's rule is exact there: a has no root, real or
    /// complex, within [`LAW_PANEL_CLEAR`] times its half width d around its middle, as |a| > Σ |a⁽ᵏ⁾|·dᵏ/k! says.
    fn is_even(&self, begin: f64, width: f64) -> bool {
        let Form::Polynomial([_, _, _, c3]) = self.form else {
            return true;
        };
        let [a, a1, a2] = self.at(begin + 0.5 * width);
        let d = 0.5 * LAW_PANEL_CLEAR * width;
        a > d * (a1.abs() + d * (0.5 * a2.abs() + d * c3.abs()))
    }

    /// How far a time after the beginning takes; `duration` is that of the whole piece.
    fn distance_after(&self, time: f64, duration: f64) -> f64 {
        let h = self.length();
        let distance = match self.form {
            Form::Polynomial([c0, c1, 0.0, 0.0]) => time * (c0.max(0.0).sqrt() + 0.25 * c1 * time),
            Form::Polynomial(_) => self.invert(time, duration),
            Form::FromRest { end } => rest_jerk(end, h) * time * time * time / 6.0,
            Form::ToRest { begin } => {
                let left = (duration - time).max(0.0);
                h - rest_jerk(begin, h) * left * left * left / 6.0
            }
        };
        distance.clamp(0.0, h)
    }

    /// The distance with t(x) = `time`: Newton's method, kept within a shrinking bracket.
    fn invert(&self, time: f64, duration: f64) -> f64 {
        let (mut low, mut high) = (0.0, self.length());
        let mut x = high * (time / duration).clamp(0.0, 1.0);
        for _ in 0..LAW_INVERSE_ROUNDS {
            let excess = self.time_to(x) - time;
            if excess.abs() <= LAW_INVERSE_TIME * duration {
                break;
            }
            if excess > 0.0 {
                high = x;
            } else {
                low = x;
            }
            let next = x - excess * self.at(x)[0].sqrt();
            x = if next > low && next < high {
                next
            } else {
                0.5 * (low + high)
            };
        }
        x
    }

    fn state(&self, x: f64) -> PathState {
        let h = self.length();
        let [a, a1, a2] = self.at(x);
        let velocity = a.sqrt();
        PathState {
            position: if x >= h { self.end } else { self.begin + x },
            velocity,
            acceleration: 0.5 * a1,
            jerk: match self.form {
                Form::Polynomial(_) => 0.5 * a2 * velocity,
                Form::FromRest { end } => rest_jerk(end, h),
                Form::ToRest { begin } => rest_jerk(begin, h),
            },
        }
    }

    fn slowed(&self, factor: f64) -> Self {
        let square = factor * factor;
        let form = match self.form {
            Form::Polynomial(c) => Form::Polynomial(c.map(|c| c * square)),
            Form::FromRest { end } => Form::FromRest { end: end * square },
            Form::ToRest { begin } => Form::ToRest { begin: begin * square },
        };
        Self { form, ..*self }
    }
}

/// s⃛ of a motion from rest that has a₁ after a distance h.
fn rest_jerk(a1: f64, h: f64) -> f64 {
    2.0 / 9.0 * a1 * a1.sqrt() / (h * h)
}

/// a, a′ and a″ at a distance from rest. a″ is infinite at rest itself, where ṡ·a″ stays finite.
fn from_rest(a1: f64, h: f64, x: f64) -> [f64; 3] {
    let part = (x / h).max(0.0);
    let root = libm::cbrt(part);
    [
        a1 * part * root,
        4.0 / 3.0 * a1 / h * root,
        4.0 / 9.0 * a1 / (h * h) / (root * root),
    ]
}

/// Nodes and weights of Gauss and Legendre's rule of six points on [−1, 1]; one of each pair (Abramowitz and Stegun,
/// table 25.4).
const GAUSS: [(f64, f64); 3] = [
    (0.238_619_186_083_196_9, 0.467_913_934_572_691),
    (0.661_209_386_466_264_5, 0.360_761_573_048_138_6),
    (0.932_469_514_203_152, 0.171_324_492_379_170_36),
];

impl TimeLaw {
    /// Pieces that follow each other; `None` where the motion would not end.
    pub(crate) fn new(pieces: Vec<Piece>) -> Option<Self> {
        let mut times = Vec::with_capacity(pieces.len() + 1);
        let mut time = 0.0;
        times.push(time);
        for piece in &pieces {
            time += piece.time_to(piece.length());
            times.push(time);
        }
        time.is_finite().then_some(Self { pieces, times })
    }

    /// Pieces on which a is linear, from its values at nodes.
    pub(crate) fn linear(nodes: &[f64], squares: &[f64]) -> Option<Self> {
        let pairs = nodes.windows(2).zip(squares.windows(2));
        Self::new(pairs.map(|(s, a)| Piece::linear(s[0], s[1], [a[0], a[1]])).collect())
    }

    /// s.
    pub(crate) fn duration(&self) -> f64 {
        self.times.last().copied().unwrap_or(0.0)
    }

    /// When each piece begins, and when the last one ends.
    pub(crate) fn times(&self) -> &[f64] {
        &self.times
    }

    /// Where the motion is at a time; before it begins and after it ends, at its ends.
    pub(crate) fn at(&self, time: f64) -> PathState {
        let time = time.clamp(0.0, self.duration());
        let index = self.times.partition_point(|begin| *begin <= time).max(1) - 1;
        let index = index.min(self.pieces.len().saturating_sub(1));
        let Some(piece) = self.pieces.get(index) else {
            return PathState::default();
        };
        let duration = self.times[index + 1] - self.times[index];
        let after = (time - self.times[index]).min(duration);
        if after >= duration {
            return piece.state(piece.length());
        }
        piece.state(piece.distance_after(after, duration))
    }

    /// When the motion passes a place.
    pub(crate) fn time_at(&self, s: f64) -> f64 {
        let index = self.pieces.partition_point(|piece| piece.end < s);
        let Some(piece) = self.pieces.get(index) else {
            return self.duration();
        };
        self.times[index] + piece.time_to((s - piece.begin).clamp(0.0, piece.length()))
    }

    /// The same motion at `factor` times the speed.
    pub(crate) fn slowed(&self, factor: f64) -> Self {
        Self {
            pieces: self.pieces.iter().map(|piece| piece.slowed(factor)).collect(),
            times: self.times.iter().map(|time| time / factor).collect(),
        }
    }

    /// The same motion, slowed down evenly to last a whole number of cycles.
    pub(crate) fn in_whole_cycles(&self, cycle: f64) -> Self {
        if self.duration() <= 0.0 {
            return self.clone();
        }
        let cycles = (self.duration() / cycle * (1.0 - LAW_CYCLE_ROUNDING)).ceil().max(1.0);
        let mut stretched = self.slowed(self.duration() / (cycles * cycle));
        if let Some(end) = stretched.times.last_mut() {
            *end = cycles * cycle;
        }
        stretched
    }
}

#[cfg(test)]
mod tests;
