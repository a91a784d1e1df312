//! The fastest trapezoid along a path, under bounds known at samples of it.
//!
//! With path acceleration α, deceleration δ and cruise speed v, the ramps are x = v²/2α and y = v²/2δ long, and the move
//! takes T = (1 + x + y)/v. At each sample s three bounds are known: the largest α of a ramp that reaches s, the largest δ
//! of one that begins there, and the largest v² that cruises over it. For a given v the shortest ramps follow in closed
//! form between samples; what is left is a search over v alone.

use crate::tolerance::CRUISE_MIN;

/// Steps of the coarse search over the cruise speed.
const COARSE_STEPS: usize = 20;

/// Steps of the golden-section search: they narrow the bracket to a thousandth of it, and the duration is flat there.
const GOLDEN_STEPS: usize = 14;

/// Halvings between the fastest speed that holds and the slowest that does not, where the optimum is at the edge.
const EDGE_STEPS: usize = 20;

/// How far from a known law the next one is looked for, as part of its speed.
const NEAR: f64 = 0.02;

/// Part of the speed that is possible in any case which is kept back: at the speed itself two ramps may fill the way
/// exactly, and a rounding decides whether they fit. Pinned by `ramps_that_just_fit_are_found`.
const FIT_RESERVE: f64 = 1.0e-12;

/// Cruise speeds that differ by no more than this part are one, met again by the golden section.
const SAME_SPEED: f64 = 1.0e-12;

/// 1/φ.
const GOLDEN: f64 = 0.618_033_988_749_894_8;

/// A trapezoid along a path of length 1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct TimeLaw {
    /// 1/s.
    pub(super) velocity: f64,
    /// 1/s².
    pub(super) acceleration: f64,
    /// 1/s².
    pub(super) deceleration: f64,
}

/// What bounds a time law at samples of the path.
#[derive(Debug, Default)]
pub(super) struct Bounds {
    /// Path positions, from 0 to 1, strictly increasing.
    pub(super) s: Vec<f64>,
    /// Largest acceleration of a ramp from rest that reaches the sample.
    pub(super) acceleration: Vec<f64>,
    /// Largest deceleration of a ramp to rest that begins at the sample.
    pub(super) deceleration: Vec<f64>,
    /// Largest squared speed at constant speed.
    pub(super) cruise: Vec<f64>,
}

/// How long a ramp of the best constant rate must be to reach a speed, by squared speed.
#[derive(Debug)]
struct Ramp {
    /// Distance from the end at rest.
    distance: Vec<f64>,
    /// The smallest bound from the end at rest to here.
    rate: Vec<f64>,
    /// The largest squared speed that a ramp up to here can reach.
    reach: Vec<f64>,
}

impl TimeLaw {
    /// Part of the way that the acceleration takes.
    pub(super) fn ramp_up(&self) -> f64 {
        0.5 * self.velocity * self.velocity / self.acceleration
    }

    /// Part of the way that the deceleration takes.
    pub(super) fn ramp_down(&self) -> f64 {
        0.5 * self.velocity * self.velocity / self.deceleration
    }

    pub(super) fn duration(&self) -> f64 {
        (1.0 + self.ramp_up() + self.ramp_down()) / self.velocity
    }
}

impl Ramp {
    fn new(samples: impl ExactSizeIterator<Item = (f64, f64)>) -> Self {
        let count = samples.len();
        let mut ramp = Self {
            distance: Vec::with_capacity(count),
            rate: Vec::with_capacity(count),
            reach: Vec::with_capacity(count),
        };
        let (mut rate, mut reach) = (f64::INFINITY, 0.0_f64);
        for (distance, bound) in samples {
            rate = rate.min(bound);
            reach = reach.max(2.0 * distance * rate);
            ramp.distance.push(distance);
            ramp.rate.push(rate);
            ramp.reach.push(reach);
        }
        ramp
    }

    /// The shortest ramp that reaches a squared speed; `None` where none does.
    fn length(&self, square: f64) -> Option<f64> {
        let after = self.reach.partition_point(|reach| *reach < square);
        if after == self.reach.len() {
            return None;
        }
        let before = after.checked_sub(1)?;
        let (from, rate) = (self.distance[before], self.rate[before]);
        let slope = (self.rate[after] - rate) / (self.distance[after] - from);
        // 2·x·(rate + slope·(x − from)) = v², its smaller root
        let level = rate - slope * from;
        let root = (level * level + 2.0 * slope * square).max(0.0).sqrt();
        Some((square / (level + root)).clamp(from, self.distance[after]))
    }
}

/// The fastest time law within bounds, up to a cruise speed; `None` where no speed above 0 is possible.
///
/// `near` is a law that is known to be close, from bounds at fewer samples.
pub(super) fn fastest(bounds: &Bounds, velocity_max: f64, near: Option<&TimeLaw>) -> Option<TimeLaw> {
    let up = Ramp::new(bounds.s.iter().copied().zip(bounds.acceleration.iter().copied()));
    let down = Ramp::new(
        bounds
            .s
            .iter()
            .map(|s| 1.0 - s)
            .zip(bounds.deceleration.iter().copied())
            .rev(),
    );
    let search = Search { bounds, up, down };
    // below this speed nothing but the static bounds counts
    let lowest = |values: &[f64]| values.iter().copied().fold(f64::INFINITY, f64::min);
    let safe_square = lowest(&bounds.acceleration)
        .min(lowest(&bounds.deceleration))
        .min(lowest(&bounds.cruise));
    let safe = velocity_max.min(safe_square.max(0.0).sqrt() * (1.0 - FIT_RESERVE));
    if safe.is_nan() || safe <= 0.0 {
        return None;
    }
    let fastest = velocity_max.min(search.up.reach[search.up.reach.len() - 1].sqrt());
    if let Some(near) = near
        && let Some(law) = search.around(
            near.velocity * (1.0 - NEAR),
            (near.velocity * (1.0 + NEAR)).min(fastest),
        )
    {
        return Some(law);
    }
    let step = (fastest - safe) / COARSE_STEPS as f64;
    let candidates = (0..=COARSE_STEPS).map(|k| safe + step * k as f64);
    let best = candidates
        .map(|velocity| (search.duration(velocity), velocity))
        .min_by(|a, b| a.0.total_cmp(&b.0))?;
    if best.0 == f64::INFINITY {
        return search.law(safe);
    }
    search
        .around((best.1 - step).max(safe * 0.5), (best.1 + step).min(fastest))
        .or_else(|| search.law(best.1))
}

struct Search<'a> {
    bounds: &'a Bounds,
    up: Ramp,
    down: Ramp,
}

impl Search<'_> {
    /// Lengths of both ramps at a cruise speed; `None` where a bound is broken.
    fn ramps(&self, velocity: f64) -> Option<(f64, f64)> {
        let square = velocity * velocity;
        let up = self.up.length(square)?;
        let down = self.down.length(square)?;
        if up + down > 1.0 {
            return None;
        }
        let s = &self.bounds.s;
        let (from, to) = (up, 1.0 - down);
        let first = s.partition_point(|s| *s < from);
        let last = s.partition_point(|s| *s <= to);
        let inside = &self.bounds.cruise[first.min(last)..last];
        let holds = |bound: f64| bound >= square;
        let held = inside.iter().all(|bound| holds(*bound)) && holds(self.cruise_at(from)) && holds(self.cruise_at(to));
        held.then_some((up, down))
    }

    /// The bound on the squared cruise speed between samples.
    fn cruise_at(&self, s: f64) -> f64 {
        let after = self
            .bounds
            .s
            .partition_point(|at| *at < s)
            .clamp(1, self.bounds.s.len() - 1);
        let (s0, s1) = (self.bounds.s[after - 1], self.bounds.s[after]);
        let (c0, c1) = (self.bounds.cruise[after - 1], self.bounds.cruise[after]);
        if c0 == f64::INFINITY || c1 == f64::INFINITY {
            return c0.max(c1);
        }
        c0 + (c1 - c0) * (s - s0) / (s1 - s0)
    }

    fn duration(&self, velocity: f64) -> f64 {
        self.ramps(velocity)
            .map_or(f64::INFINITY, |(up, down)| (1.0 + up + down) / velocity)
    }

    fn law(&self, velocity: f64) -> Option<TimeLaw> {
        let (up, mut down) = self.ramps(velocity)?;
        if 1.0 - up - down < CRUISE_MIN {
            down = 1.0 - up;
        }
        let half = 0.5 * velocity * velocity;
        Some(TimeLaw {
            velocity,
            acceleration: half / up,
            deceleration: half / down,
        })
    }

    /// The fastest law between two cruise speeds: golden section, then, where the best speed borders on speeds that break
    /// a bound, halving towards the border.
    fn around(&self, low: f64, high: f64) -> Option<TimeLaw> {
        let mut seen = Seen::default();
        let (mut low, mut high) = (low, high);
        for end in [low, high] {
            seen.add(end, self.duration(end));
        }
        for _ in 0..GOLDEN_STEPS {
            let left = high - GOLDEN * (high - low);
            let right = low + GOLDEN * (high - low);
            let at_left = seen.of(left, self);
            let at_right = seen.of(right, self);
            // where both break a bound, what is possible lies below
            if at_left <= at_right {
                high = right;
            } else {
                low = left;
            }
        }
        for _ in 0..EDGE_STEPS {
            if seen.broken == f64::INFINITY {
                break;
            }
            let middle = 0.5 * (seen.velocity + seen.broken);
            let duration = self.duration(middle);
            if duration.is_finite() && duration >= seen.duration {
                break;
            }
            seen.add(middle, duration);
        }
        if seen.duration == f64::INFINITY {
            return None;
        }
        self.law(seen.velocity)
    }
}

/// What a search has seen: the best speed, and the slowest speed above it that breaks a bound.
struct Seen {
    velocity: f64,
    duration: f64,
    broken: f64,
    /// The last two probes: a golden section meets one of them again.
    last: [(f64, f64); 2],
}

impl Default for Seen {
    fn default() -> Self {
        Self {
            velocity: 0.0,
            duration: f64::INFINITY,
            broken: f64::INFINITY,
            last: [(0.0, f64::INFINITY); 2],
        }
    }
}

impl Seen {
    fn add(&mut self, velocity: f64, duration: f64) {
        if duration < self.duration {
            self.velocity = velocity;
            self.duration = duration;
            if self.broken <= velocity {
                self.broken = f64::INFINITY;
            }
        } else if duration == f64::INFINITY && velocity > self.velocity {
            self.broken = self.broken.min(velocity);
        }
    }

    /// The duration at a speed, computed only where it is new.
    fn of(&mut self, velocity: f64, search: &Search<'_>) -> f64 {
        if let Some((_, duration)) = self
            .last
            .iter()
            .find(|(known, _)| (known - velocity).abs() <= velocity * SAME_SPEED)
        {
            return *duration;
        }
        let duration = search.duration(velocity);
        self.add(velocity, duration);
        self.last = [self.last[1], (velocity, duration)];
        duration
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ramps_that_just_fit_are_found() {
        for step in 1..1000 {
            let rate = 0.37 * f64::from(step);
            let bounds = Bounds {
                s: vec![0.0, 0.3, 0.5, 1.0],
                acceleration: vec![rate; 4],
                deceleration: vec![rate; 4],
                cruise: vec![f64::INFINITY; 4],
            };
            let law = fastest(&bounds, f64::MAX, None).expect("half the way up, half the way down");
            assert!(law.acceleration <= rate && law.deceleration <= rate, "{law:?}");
            let duration = 2.0 / rate.sqrt();
            assert!((law.duration() - duration).abs() <= 1e-9 * duration, "{law:?}");
        }
    }
}
