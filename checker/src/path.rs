//! A timed path against its limits, from its set-points alone.
//!
//! What a robot is given are positions, velocities, accelerations and torques at times; what made them counts for
//! nothing here. So:
//!
//! - at every set-point: torque by the checker's own dynamics, the tool by its own kinematics, and
//!   both, with speed, acceleration and position, against the limits of the segment that the set-point is on;
//! - between set-points: with `h` from one to the next,
//!
//! ```text
//! Δq/h        is a mean of q̇ over h
//! Δ²q/h²      is a weighted mean of q̈ over 2 h
//! Δ³q/h³      is a weighted mean of q⃛ over 3 h      (the weights are B-splines', Curry and Schoenberg 1966)
//! ```
//!
//!   and means keep every limit that what they are of keeps: so do the differences, whatever the path does in between;
//! - the columns against each other: velocities are the derivatives of positions, accelerations those of velocities, to
//!   within what the step leaves open;
//! - what is at the ends and at the exact stops, and what the plan says of itself;
//! - at constant speed, the tool speeds between transitions and within them.
//!
//! A maximum of the torque between two set-points is seen only by asking for more of them.

pub mod bounds;
mod claims;
mod columns;
mod constant;
mod differences;
mod ends;
pub mod report;
mod samples;
mod states;
mod ways;

use takt_motion::path::outcome::PathPlan;
use takt_motion::path::request::PathRequest;
use takt_motion::robot::spec::RobotSpec;

use crate::arm::{Arm, Tool, Workspace};
use bounds::SegmentBounds;
use report::{FaultKind, PathReport};
use samples::Samples;

/// What a plan is checked against.
struct Case<'a> {
    request: &'a PathRequest,
    plan: &'a PathPlan,
    arm: Arm,
    tool: Tool,
    /// One a segment.
    bounds: Vec<SegmentBounds>,
    samples: Samples<'a>,
    density: Density,
}

/// How dense the set-points of a plan are.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Density {
    /// At some drive's period: between two of them the path may do something of its own.
    Coarse,
    /// Dense enough for a straight line between two of them to show all that the path does: ten times the grid that it
    /// was timed on, or more.
    Resolving,
}

/// Checks a plan of `request` for the arm of `spec`, whose set-points are as dense as `density` says.
#[must_use]
pub fn recheck_path(spec: &RobotSpec, request: &PathRequest, plan: &PathPlan, density: Density) -> PathReport {
    let mut report = PathReport::default();
    let Some(samples) = Samples::of(plan, spec.joints.len(), &mut report) else {
        return report;
    };
    let case = Case {
        request,
        plan,
        arm: Arm::new(spec, request.payload.as_ref()),
        tool: Tool::new(spec, request.tcp.as_ref()),
        bounds: bounds::of_program(spec, request),
        samples,
        density,
    };
    report.sample_count = case.samples.len();
    let beyond = |location: &takt_motion::path::outcome::Location| location.segment >= case.bounds.len();
    if let Some(lost) = case.samples.locations().iter().position(beyond) {
        let time = case.samples.times()[lost];
        let segment = case.samples.locations()[lost].segment;
        report.fault(
            FaultKind::Location,
            lost,
            time,
            segment as f64,
            case.bounds.len() as f64,
        );
        return report;
    }
    let workspace = &mut Workspace::default();
    states::check(&case, workspace, &mut report);
    differences::check(&case, workspace, &mut report);
    columns::check(&case, &mut report);
    ends::check(&case, spec, workspace, &mut report);
    claims::check(&case, &mut report);
    constant::check(&case, &mut report);
    report
}
