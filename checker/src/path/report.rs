//! What a recheck of a timed path finds.

use takt_motion::path::outcome::PathLimit;

use super::bounds::{JointBounds, SegmentBounds};
use crate::tolerance;

/// What a recheck found.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct PathReport {
    /// How many set-points there were.
    pub sample_count: usize,
    /// The tightest moment of every limit, by where it was looked for.
    pub extremes: Vec<PathExtreme>,
    /// What does not hold between the plan's parts, or between plan and request.
    pub faults: Vec<PathFault>,
}

/// The tightest moment of one limit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PathExtreme {
    /// Which limit.
    pub kind: PathLimit,
    /// Of which joint; `None`: the tool's.
    pub joint: Option<usize>,
    /// Where it was looked for.
    pub source: Source,
    /// The value, signed where it is a joint's.
    pub value: f64,
    /// The limit in force there.
    pub limit: f64,
    /// (|value| − limit)/limit; for a position, the way beyond the limit over the joint's range. Negative where there
    /// is room left, infinite where the value is not a number.
    pub excess: f64,
    /// When, s.
    pub time: f64,
}

/// Where an extreme was looked for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Source {
    /// In the states at the set-points, by the checker's own dynamics and kinematics.
    States,
    /// In the differences of the positions from set-point to set-point: weighted means of what lies between them.
    Differences,
}

/// Something of a plan that is not as it should be.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PathFault {
    /// What.
    pub kind: FaultKind,
    /// Of which joint, segment or entry.
    pub index: usize,
    /// When, s.
    pub time: f64,
    /// What was found.
    pub found: f64,
    /// What it should be, or may be at most.
    pub expected: f64,
}

/// What of a plan can be wrong besides its limits.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum FaultKind {
    /// There are no set-points, or their lists do not have the length they should.
    Lists,
    /// A figure is not a number.
    Finite,
    /// Times do not increase evenly from 0 to the duration.
    Times,
    /// The duration is not a whole number of cycles.
    WholeCycles,
    /// The first set-point is not the start.
    Start,
    /// The set-point at an exact stop is not the segment's target. Rad, m.
    Target,
    /// The arm moves at the end, at an exact stop, or while it should dwell.
    Rest,
    /// A dwell is shorter than asked for, s.
    Dwell,
    /// The boundary speed is not the one asked for.
    BoundarySpeed,
    /// The speed changes at an end of the path where it should not.
    BoundaryAcceleration,
    /// Velocities are not the derivatives of the positions.
    VelocityColumn,
    /// Accelerations are not the derivatives of the velocities.
    AccelerationColumn,
    /// Torques are not those of the states.
    TorqueColumn,
    /// Tool speeds are not those of the states.
    ToolSpeedColumn,
    /// Locations run backwards, or leave the program.
    Location,
    /// A location is not within its segment's time.
    SegmentTimes,
    /// The stretches of the limiting limits have gaps, or the times spent at them do not sum up.
    Limiting,
    /// A known limit has no entry among the uses, or a joint none among the margins.
    Presence,
    /// The limit of an entry is not the one in force.
    Limit,
    /// An entry states more room than was found.
    Use,
    /// An entry's margin is not that of its value.
    Margin,
    /// A figure that is echoed is not the request's.
    Echo,
    /// A constant tool speed is not the one that the plan says, or it says none.
    ConstantSpeed,
}

impl PathReport {
    /// Whether no limit is exceeded by more than its bar and nothing else is wrong.
    #[must_use]
    pub fn holds(&self) -> bool {
        self.faults.is_empty() && self.violations().next().is_none()
    }

    /// The limits that are exceeded by more than their bars.
    pub fn violations(&self) -> impl Iterator<Item = &PathExtreme> {
        self.extremes.iter().filter(|extreme| {
            // Not a number is above every bar.
            let within = extreme.excess <= tolerance::path_excess(extreme.kind);
            !within
        })
    }

    /// The tightest moment of a limit at the set-points themselves; `None` where it does not bound.
    #[must_use]
    pub fn at_states(&self, kind: PathLimit, joint: Option<usize>) -> Option<&PathExtreme> {
        self.extremes
            .iter()
            .find(|extreme| (extreme.kind, extreme.joint, extreme.source) == (kind, joint, Source::States))
    }

    pub(super) fn fault(&mut self, kind: FaultKind, index: usize, time: f64, found: f64, expected: f64) {
        // One of a kind and index is enough; a wrong column would fill the memory.
        let known = self
            .faults
            .iter()
            .any(|fault| (fault.kind, fault.index) == (kind, index));
        if !known {
            self.faults.push(PathFault {
                kind,
                index,
                time,
                found,
                expected,
            });
        }
    }
}

/// Collects extremes of one source: one place for every limit of every joint and of the tool.
#[derive(Debug)]
pub(super) struct Extremes {
    source: Source,
    /// Every kind of every joint, then those of the tool.
    found: Vec<Option<PathExtreme>>,
}

const OF_JOINTS: [PathLimit; 6] = [
    PathLimit::Torque,
    PathLimit::Velocity,
    PathLimit::Acceleration,
    PathLimit::Jerk,
    PathLimit::PositionLower,
    PathLimit::PositionUpper,
];

impl Extremes {
    pub(super) fn new(source: Source, joint_count: usize) -> Self {
        Self {
            source,
            found: vec![None; joint_count * OF_JOINTS.len() + 2],
        }
    }

    /// Looks at a value of a joint; a limit that does not bound is left out.
    pub(super) fn joint(&mut self, kind: PathLimit, joint: usize, value: f64, bounds: &JointBounds, time: f64) {
        let Some(limit) = limit_of(bounds, kind) else { return };
        let excess = match kind {
            PathLimit::PositionLower => (limit - value) / bounds.range(),
            PathLimit::PositionUpper => (value - limit) / bounds.range(),
            _ => (value.abs() - limit) / limit,
        };
        let place = OF_JOINTS.iter().position(|known| *known == kind).unwrap_or(0);
        let found = PathExtreme {
            kind,
            joint: Some(joint),
            source: self.source,
            value,
            limit,
            excess,
            time,
        };
        self.keep(joint * OF_JOINTS.len() + place, found);
    }

    /// Looks at a magnitude of the tool's motion.
    pub(super) fn tool(&mut self, kind: PathLimit, value: f64, bounds: &SegmentBounds, time: f64) {
        let Some(limit) = tool_limit_of(bounds, kind) else {
            return;
        };
        let place = self.found.len() - if kind == PathLimit::ToolVelocity { 2 } else { 1 };
        let found = PathExtreme {
            kind,
            joint: None,
            source: self.source,
            value,
            limit,
            excess: (value - limit) / limit,
            time,
        };
        self.keep(place, found);
    }

    fn keep(&mut self, place: usize, found: PathExtreme) {
        // What is not a number exceeds every limit, and stays.
        let excess = match found.excess.is_nan() {
            true => f64::INFINITY,
            false => found.excess,
        };
        if self.found[place].is_none_or(|known| excess > known.excess) {
            self.found[place] = Some(PathExtreme { excess, ..found });
        }
    }

    pub(super) fn found(self) -> impl Iterator<Item = PathExtreme> {
        self.found.into_iter().flatten()
    }
}

/// A joint's limit of one kind.
pub(super) fn limit_of(bounds: &JointBounds, kind: PathLimit) -> Option<f64> {
    match kind {
        PathLimit::Torque => bounds.torque,
        PathLimit::Velocity => bounds.velocity,
        PathLimit::Acceleration => bounds.acceleration,
        PathLimit::Jerk => bounds.jerk,
        PathLimit::PositionLower => bounds.position_lower,
        PathLimit::PositionUpper => bounds.position_upper,
        PathLimit::ToolVelocity | PathLimit::ToolAcceleration | PathLimit::ConstantSpeed | PathLimit::Rest => None,
    }
}

/// The tool's limit of one kind.
pub(super) fn tool_limit_of(bounds: &SegmentBounds, kind: PathLimit) -> Option<f64> {
    match kind {
        PathLimit::ToolVelocity => bounds.tool_velocity,
        PathLimit::ToolAcceleration => bounds.tool_acceleration,
        _ => None,
    }
}
