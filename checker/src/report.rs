//! What a recheck finds.

use takt_motion::plan::outcome::LimitKind;

use crate::bounds::Bounds;
use crate::motion::Inconsistency;

/// What a recheck found.
#[derive(Debug, Clone, PartialEq)]
pub struct Report {
    /// Of the longest pattern, s.
    pub duration: f64,
    /// How many states were looked at.
    pub sample_count: usize,
    /// One a joint, in model order.
    pub joints: Vec<JointReport>,
    /// What does not hold between the figures of the move; empty for a sound one. A move with figures that are no
    /// numbers, or with negative times, is not sampled.
    pub inconsistencies: Vec<Inconsistency>,
}

/// The extremes of one joint.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct JointReport {
    /// Drive torque of largest magnitude while the arm moves (or holds, in a move that takes no time), signed, N m or N.
    pub torque: Extreme,
    /// Torque of largest magnitude that holds the arm still just before the start or just after the end, signed, N m or
    /// N; at time 0 or the duration.
    pub holding: Extreme,
    /// Velocity of largest magnitude, signed.
    pub velocity: Extreme,
    /// Acceleration of largest magnitude while speeding up, signed.
    pub acceleration: Extreme,
    /// Acceleration of largest magnitude while slowing down, signed.
    pub deceleration: Extreme,
    /// Lowest position.
    pub lowest: Extreme,
    /// Highest position.
    pub highest: Extreme,
    /// Torque × velocity at the joint of largest magnitude, signed, W. It has no limit.
    pub power: Extreme,
    /// Torque that holds the joint still just after the end, N m or N.
    pub holding_at_end: f64,
    /// Integral of the squared torque over the motion, by trapezoids, N² m² s or N² s.
    pub squared_torque: f64,
    /// An eighth of the largest second difference of the torque between neighbouring samples, N m or N: by about so
    /// much can the true extreme lie beyond the sampled one.
    pub torque_resolution: f64,
}

/// The tightest moment of one quantity of one joint.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Extreme {
    /// The value, signed.
    pub value: f64,
    /// When, s.
    pub time: f64,
    /// The limit, a magnitude for all but positions; `None`: there is none.
    pub limit: Option<f64>,
    /// (|value| − limit)/limit; for a position, the way beyond the limit over the joint's range, or as it stands where
    /// only one end is limited. Negative where there is room left; infinite where the value is not a number.
    pub excess: Option<f64>,
}

/// The largest excess of a move.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Worst {
    /// Which limit.
    pub kind: LimitKind,
    /// Index of the joint.
    pub joint: usize,
    /// Value, time, limit, excess.
    pub extreme: Extreme,
    /// The excess, negative where all limits hold with room left.
    pub excess: f64,
}

impl Report {
    /// Whether the move is sound and no limit is exceeded by more than `tolerance`, relative.
    #[must_use]
    pub fn holds(&self, tolerance: f64) -> bool {
        self.inconsistencies.is_empty() && self.worst().is_none_or(|worst| worst.excess <= tolerance)
    }

    /// RMS torque of a joint over a cycle of `cycle_time`, s, in which it holds still after the motion; over the motion
    /// where that is longer. The holding torque where nothing takes time.
    #[must_use]
    pub fn rms_torque(&self, joint: usize, cycle_time: f64) -> f64 {
        let found = &self.joints[joint];
        let cycle = cycle_time.max(self.duration);
        if cycle == 0.0 {
            return found.holding_at_end.abs();
        }
        let held = found.holding_at_end * found.holding_at_end * (cycle - self.duration);
        ((found.squared_torque + held) / cycle).sqrt()
    }

    /// The largest excess of all limits; `None` where there is no limit.
    #[must_use]
    pub fn worst(&self) -> Option<Worst> {
        self.worst_among(|_| true)
    }

    /// The largest excess of one kind of limit; `None` where there is none of that kind.
    #[must_use]
    pub fn worst_of(&self, kind: LimitKind) -> Option<Worst> {
        self.worst_among(|other| other == kind)
    }

    fn worst_among(&self, wanted: impl Fn(LimitKind) -> bool) -> Option<Worst> {
        self.joints
            .iter()
            .enumerate()
            .flat_map(|(joint, report)| {
                report.extremes().into_iter().filter_map(move |(kind, extreme)| {
                    extreme.excess.map(|excess| Worst {
                        kind,
                        joint,
                        extreme,
                        excess,
                    })
                })
            })
            .filter(|worst| wanted(worst.kind))
            .max_by(|one, other| one.excess.total_cmp(&other.excess))
    }
}

impl JointReport {
    /// Nothing seen but the start.
    pub(crate) fn before(bounds: &Bounds, start: f64) -> Self {
        let limited = |limit| Extreme {
            limit,
            ..Extreme::default()
        };
        let placed = |limit| Extreme {
            value: start,
            limit,
            ..Extreme::default()
        };
        Self {
            torque: limited(bounds.torque),
            holding: limited(bounds.torque),
            velocity: limited(bounds.velocity),
            acceleration: limited(bounds.acceleration),
            deceleration: limited(bounds.deceleration),
            lowest: placed(bounds.position_lower),
            highest: placed(bounds.position_upper),
            ..Self::default()
        }
    }

    /// Every extreme with the limit that it is held against.
    #[must_use]
    pub fn extremes(&self) -> [(LimitKind, Extreme); 7] {
        [
            (LimitKind::Torque, self.torque),
            (LimitKind::Torque, self.holding),
            (LimitKind::Velocity, self.velocity),
            (LimitKind::Acceleration, self.acceleration),
            (LimitKind::Deceleration, self.deceleration),
            (LimitKind::PositionLower, self.lowest),
            (LimitKind::PositionUpper, self.highest),
        ]
    }

    pub(crate) fn judge(&mut self, bounds: &Bounds) {
        for extreme in [
            &mut self.torque,
            &mut self.holding,
            &mut self.velocity,
            &mut self.acceleration,
            &mut self.deceleration,
        ] {
            extreme.excess = extreme.limit.map(|limit| relative_excess(extreme.value.abs(), limit));
        }
        let range = match (bounds.position_lower, bounds.position_upper) {
            (Some(lower), Some(upper)) if upper > lower => upper - lower,
            _ => 1.0,
        };
        let beyond = |way: f64| {
            if way.is_nan() { f64::INFINITY } else { way / range }
        };
        self.lowest.excess = self.lowest.limit.map(|limit| beyond(limit - self.lowest.value));
        self.highest.excess = self.highest.limit.map(|limit| beyond(self.highest.value - limit));
    }
}

/// By how much `magnitude` exceeds `limit`, relative to it; nothing but rest keeps a limit of 0.
fn relative_excess(magnitude: f64, limit: f64) -> f64 {
    let excess = (magnitude - limit) / limit;
    match excess.is_nan() {
        true if magnitude == 0.0 => 0.0,
        true => f64::INFINITY,
        false => excess,
    }
}

// Once a value is not a number it stays the extreme: no comparison may lose it.
impl Extreme {
    pub(crate) fn offer(&mut self, value: f64, time: f64) {
        self.take_if(value.is_nan() || value.abs() > self.value.abs(), value, time);
    }

    pub(crate) fn offer_lower(&mut self, value: f64, time: f64) {
        self.take_if(value.is_nan() || value < self.value, value, time);
    }

    pub(crate) fn offer_higher(&mut self, value: f64, time: f64) {
        self.take_if(value.is_nan() || value > self.value, value, time);
    }

    fn take_if(&mut self, tighter: bool, value: f64, time: f64) {
        if tighter && !self.value.is_nan() {
            self.value = value;
            self.time = time;
        }
    }
}
