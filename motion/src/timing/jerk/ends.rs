//! Ends of a path at which the motion does not rest.
//!
//! There ṡ is given and s̈ is 0, so that another motion at constant speed along the same line can go on from it without a
//! jump of acceleration; s⃛ is free. What ṡ² is there are the first and the last unknown of the spline ([`super::basis`]).
//! A motion that keeps every limit keeps them run slower too, ends and all: a solve begins with one that is slow enough
//! and raises the speeds at its ends until they are those asked for. Where they stop short, that is the evidence.

use std::ops::Range;

/// At which ends the motion does not rest.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Moving {
    pub(crate) start: bool,
    pub(crate) end: bool,
}

/// What the first or the last unknown is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum End {
    /// One as the others: the motion rests at this end.
    Rest,
    /// ṡ² at this end, to be raised to this.
    Raised(f64),
    /// ṡ² at this end, which stays.
    Held,
}

impl Moving {
    pub(crate) fn of([start, end]: [f64; 2]) -> Self {
        Self {
            start: start > 0.0,
            end: end > 0.0,
        }
    }

    /// Which of a grid's intervals have no law of constant jerk from or to rest.
    pub(crate) fn spline_intervals(self, intervals: usize) -> Range<usize> {
        usize::from(!self.start)..intervals - usize::from(!self.end)
    }
}

/// ṡ² at rest ends and between the squares at moving ones, the parts `u` of the path; flat at moving ends, and as constant
/// jerk from rest has it at the others.
pub(crate) fn bridge(squares: [f64; 2], moving: Moving) -> impl Fn(f64) -> f64 {
    move |u| match moving {
        Moving { start: true, end: true } => {
            let smooth = u * u * (3.0 - 2.0 * u);
            squares[0] + (squares[1] - squares[0]) * smooth
        }
        Moving {
            start: true,
            end: false,
        } => squares[0] * four_thirds((1.0 - u) * (1.0 + u)),
        Moving {
            start: false,
            end: true,
        } => squares[1] * four_thirds(u * (2.0 - u)),
        Moving {
            start: false,
            end: false,
        } => 0.0,
    }
}

/// A hump: 0 at both ends, which it leaves at constant jerk, or flat where the motion moves there.
pub(crate) fn hump(moving: Moving) -> impl Fn(f64) -> f64 {
    move |u| {
        let (rest, moves) = match moving {
            Moving {
                start: false,
                end: false,
            } => (4.0 * u * (1.0 - u), 1.0),
            Moving { start: true, end: true } => (1.0, 4.0 * u * (1.0 - u)),
            Moving {
                start: true,
                end: false,
            } => (2.0 * (1.0 - u), 2.0 * u),
            Moving {
                start: false,
                end: true,
            } => (2.0 * u, 2.0 * (1.0 - u)),
        };
        four_thirds(rest) * moves * moves
    }
}

fn four_thirds(v: f64) -> f64 {
    v * libm::cbrt(v)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Values and slopes at both ends of every kind.
    #[test]
    fn shapes_have_their_ends() {
        let squares = [4.0, 9.0];
        for (start, end) in [(true, true), (true, false), (false, true), (false, false)] {
            let moving = Moving { start, end };
            let (bridge, hump) = (bridge(squares, moving), hump(moving));
            for (at, moves, square, inside) in [(0.0, start, squares[0], 1e-6), (1.0, end, squares[1], 1.0 - 1e-6)] {
                assert_eq!(bridge(at), if moves { square } else { 0.0 });
                assert_eq!(hump(at), 0.0);
                assert!((bridge(inside) - bridge(at)).abs() < 1e-6 && hump(inside) < 1e-6);
            }
            assert!((1..100).all(|k| hump(f64::from(k) / 100.0) > 0.0));
        }
    }
}
