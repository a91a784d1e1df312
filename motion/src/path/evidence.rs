//! The evidence that a taught pose, or a curve of the tool, cannot be reached.

use super::fault::infeasible;
use super::follow::Halt;
use super::guided::Led;
use super::outcome::{Location, PathInfeasible, PathInfeasibleReason};
use super::shape::ToolCurve;
use super::taught::Teacher;
use crate::kinematics::inverse::Unreachable;
use crate::robot::spec::RobotSpec;
use crate::tolerance::{REACH_ABSURD, REACH_PROBES, SEGMENT_MIN, SINGULAR_MIN};

impl Teacher<'_> {
    /// A taught pose that cannot be taken.
    pub(super) fn missing(&self, segment: usize, unreachable: &Unreachable) -> PathInfeasible {
        let location = Location { segment, fraction: 1.0 };
        let evidence = |reason, needed, available| PathInfeasible {
            needed,
            available,
            ..infeasible(
                reason,
                location,
                format!("{unreachable}; teach another pose{}", self.units(gap(unreachable))),
            )
        };
        match unreachable {
            Unreachable::OutOfReach { .. } => {
                let needed = gap(unreachable).map_or(0.0, |(gap, _)| gap);
                evidence(PathInfeasibleReason::OutOfReach, needed, 0.0)
            }
            Unreachable::JointRange {
                joint,
                needed,
                available,
                ..
            } => PathInfeasible {
                joint: Some(*joint),
                ..evidence(PathInfeasibleReason::JointRange, *needed, *available)
            },
            Unreachable::Singular {
                smallest_singular_value,
                ..
            } => evidence(
                PathInfeasibleReason::Singularity,
                SINGULAR_MIN,
                *smallest_singular_value,
            ),
        }
    }

    /// A curve that could not be followed to its end: it leaves the reach, or meets a singularity.
    pub(super) fn halted(&self, segment: usize, curve: &ToolCurve, halt: Halt) -> PathInfeasible {
        let location = Location {
            segment,
            fraction: halt.at,
        };
        let percent = 100.0 * halt.at;
        let evidence = |reason, needed, available, suggestion| PathInfeasible {
            needed,
            available,
            reachable_fraction: Some(halt.at),
            ..infeasible(reason, location, suggestion)
        };
        // the largest gap on the rest of the way
        let rest = (1..=REACH_PROBES).map(|i| halt.at + (1.0 - halt.at) * i as f64 / REACH_PROBES as f64);
        let gaps = rest.filter_map(|v| gap(&self.inverse.nearest(&curve.pose(v), &self.q).err()?));
        let (gap, unit) = gaps.fold((0.0, "m"), |most, gap| if gap.0 > most.0 { gap } else { most });
        if gap > 0.0 {
            let suggestion = format!(
                "the segment leaves the arm's reach after {percent:.2} % of its way, by up to {gap:.6} {unit}; move the \
                 taught points to where the arm reaches, or the tool's orientation to one that the arm can take{}",
                self.units(Some((gap, unit)))
            );
            return evidence(PathInfeasibleReason::OutOfReach, gap, 0.0, suggestion);
        }
        let suggestion = format!(
            "the segment meets a singularity after {percent:.2} % of its way (smallest singular value {:.6}, at least \
             {SINGULAR_MIN} is needed); tilt or shift it, start it in another arm configuration, or make it a joint segment",
            halt.smallest
        );
        evidence(
            PathInfeasibleReason::Singularity,
            SINGULAR_MIN,
            halt.smallest,
            suggestion,
        )
    }

    /// What to say of a gap that no arm has: points taught in mm are a thousand times too far.
    fn units(&self, gap: Option<(f64, &'static str)>) -> &'static str {
        let reach = longest(self.robot.spec()) + self.tcp.translation.vector.norm();
        match gap {
            Some((gap, "m")) if gap > REACH_ABSURD * reach => "; positions are in m: are these millimetres?",
            _ => "",
        }
    }

    /// A curve that ends at its pose, but with the joints elsewhere than taught.
    pub(super) fn other_branch(&self, segment: usize, joint: usize, taught: f64, found: f64) -> PathInfeasible {
        let name = &self.robot.spec().joints[joint].name;
        let suggestion = format!(
            "the segment ends with joint \"{name}\" at {found:.6}, not at {taught:.6} as taught: it would have to change the \
             arm's configuration on the way; teach its end as a pose, or make it a joint segment"
        );
        PathInfeasible {
            joint: Some(joint),
            needed: taught,
            available: found,
            ..infeasible(
                PathInfeasibleReason::Singularity,
                Location { segment, fraction: 1.0 },
                suggestion,
            )
        }
    }

    /// Which joints are led on a segment, in words.
    pub(super) fn say_who_leads(&self, segment: usize, led: &[Led]) -> String {
        let joints = &self.robot.spec().joints;
        let who: Vec<String> = led
            .iter()
            .map(|led| {
                let name = &joints[led.joint].name;
                format!("joint \"{name}\" runs evenly from {:.4} to {:.4}", led.start, led.end)
            })
            .collect();
        format!("segment {segment}: {}, the others follow the tool", who.join(", "))
    }
}

/// No point of the tool is farther than this from the base, with every sliding joint at 0, m: Σ‖p_i‖ of the joints' places.
fn longest(spec: &RobotSpec) -> f64 {
    let places = spec
        .joints
        .iter()
        .map(|joint| joint.parent_from_joint.translation.vector.norm());
    places.sum()
}

/// How far a pose is out of reach, and the unit: m where its place is missed, rad where its orientation alone is.
fn gap(unreachable: &Unreachable) -> Option<(f64, &'static str)> {
    match unreachable {
        Unreachable::OutOfReach {
            position_gap,
            orientation_gap,
            ..
        } => Some(if *position_gap > SEGMENT_MIN {
            (*position_gap, "m")
        } else {
            (*orientation_gap, "rad")
        }),
        Unreachable::JointRange { .. } | Unreachable::Singular { .. } => None,
    }
}
