//! A motion of all joints over time, as polynomials between switching times: what patterns and foreign trajectories are
//! turned into before they are verified.

use crate::plan::outcome::{Pattern, Phase};
use crate::tolerance::{SWITCH_APART, TRAVEL_MIN};

/// Coefficients of 1, τ, τ² … τ⁵ with τ the time since the segment began.
pub(crate) type Polynomial = [f64; 6];

/// A motion as polynomials of time.
#[derive(Debug, Clone)]
pub(crate) struct Trajectory {
    joint_count: usize,
    /// Ends of the segments, s: one more than there are segments, strictly increasing.
    times: Vec<f64>,
    /// Segment by segment, one a joint.
    polynomials: Vec<Polynomial>,
}

/// Position, velocity, acceleration.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct State {
    pub(crate) position: f64,
    pub(crate) velocity: f64,
    pub(crate) acceleration: f64,
}

/// Value, first and second derivative of a polynomial.
#[inline]
pub(crate) fn evaluate(p: &Polynomial, t: f64) -> State {
    State {
        position: p[0] + t * (p[1] + t * (p[2] + t * (p[3] + t * (p[4] + t * p[5])))),
        velocity: p[1] + t * (2.0 * p[2] + t * (3.0 * p[3] + t * (4.0 * p[4] + t * 5.0 * p[5]))),
        acceleration: 2.0 * p[2] + t * (6.0 * p[3] + t * (12.0 * p[4] + t * 20.0 * p[5])),
    }
}

impl Trajectory {
    /// A motion given by its segments. Segments whose ends coincide are left out by the caller.
    pub(crate) fn new(joint_count: usize, times: Vec<f64>, polynomials: Vec<Polynomial>) -> Self {
        debug_assert_eq!((times.len() - 1) * joint_count, polynomials.len());
        Self {
            joint_count,
            times,
            polynomials,
        }
    }

    /// The motion of synchronized patterns from `start`.
    pub(crate) fn of_patterns(start: &[f64], patterns: &[Pattern]) -> Self {
        let duration = duration(patterns);
        let mut times = vec![0.0, duration];
        for pattern in patterns.iter().filter(|p| p.moves()) {
            times.push(pattern.acceleration_time);
            times.push(duration - pattern.deceleration_time);
        }
        times.sort_by(f64::total_cmp);
        let same = duration * SWITCH_APART;
        times.dedup_by(|later, earlier| *later - *earlier <= same);
        if let Some(last) = times.last_mut() {
            *last = duration;
        }
        let polynomials = times
            .windows(2)
            .flat_map(|ends| {
                let middle = 0.5 * (ends[0] + ends[1]);
                let from = ends[0];
                start.iter().zip(patterns).map(move |(&start, pattern)| {
                    pattern.polynomial(start, duration, pattern.phase(middle, duration), from)
                })
            })
            .collect();
        Self::new(patterns.len(), times, polynomials)
    }

    /// A stretch of the same motion; its time begins at 0.
    pub(crate) fn piece(&self, first: usize, count: usize) -> Self {
        let last = (first + count).min(self.segment_count());
        let begin = self.times[first];
        Self {
            joint_count: self.joint_count,
            times: self.times[first..=last].iter().map(|time| time - begin).collect(),
            polynomials: self.polynomials[first * self.joint_count..last * self.joint_count].to_vec(),
        }
    }

    pub(crate) fn joint_count(&self) -> usize {
        self.joint_count
    }

    pub(crate) fn segment_count(&self) -> usize {
        self.times.len() - 1
    }

    /// Ends of the segments, s.
    pub(crate) fn times(&self) -> &[f64] {
        &self.times
    }

    /// The middle of a segment, s.
    pub(crate) fn middle(&self, segment: usize) -> f64 {
        0.5 * (self.times[segment] + self.times[segment + 1])
    }

    /// The polynomials of a segment, one a joint.
    pub(crate) fn segment(&self, index: usize) -> &[Polynomial] {
        &self.polynomials[index * self.joint_count..(index + 1) * self.joint_count]
    }
}

/// When the last joint of synchronized patterns ends, s.
pub(crate) fn duration(patterns: &[Pattern]) -> f64 {
    patterns.iter().map(Pattern::duration).fold(0.0, f64::max)
}

impl Pattern {
    /// Whether the joint moves at all.
    #[must_use]
    pub fn moves(&self) -> bool {
        self.displacement.abs() > TRAVEL_MIN
    }

    /// s.
    #[must_use]
    pub fn duration(&self) -> f64 {
        self.acceleration_time + self.cruise_time + self.deceleration_time
    }

    /// In which part of the pattern a time lies.
    #[must_use]
    pub fn phase(&self, time: f64, duration: f64) -> Phase {
        if !self.moves() {
            return Phase::Hold;
        }
        if time < self.acceleration_time {
            return Phase::Acceleration;
        }
        if time < duration - self.deceleration_time {
            return Phase::Cruise;
        }
        Phase::Deceleration
    }

    /// The polynomial of one phase in the time since `from`.
    fn polynomial(&self, start: f64, duration: f64, phase: Phase, from: f64) -> Polynomial {
        let [position, velocity, half] = match phase {
            Phase::Hold => [start, 0.0, 0.0],
            Phase::Acceleration => {
                let velocity = self.acceleration * from;
                [start + 0.5 * velocity * from, velocity, 0.5 * self.acceleration]
            }
            Phase::Cruise => {
                let ramp = 0.5 * self.peak_velocity * self.acceleration_time;
                let gone = ramp + self.peak_velocity * (from - self.acceleration_time);
                [start + gone, self.peak_velocity, 0.0]
            }
            Phase::Deceleration => {
                let left = duration - from;
                let velocity = self.deceleration * left;
                let target = start + self.displacement;
                [target - 0.5 * velocity * left, velocity, -0.5 * self.deceleration]
            }
        };
        [position, velocity, half, 0.0, 0.0, 0.0]
    }
}
