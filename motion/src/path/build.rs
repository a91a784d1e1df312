//! From a request to strokes: tracks, corners, blends, and what is wrong with them.

use std::sync::Arc as Shared;

use nalgebra::Isometry3;

use super::check::check;
use super::corner::{self, Corner, Mix};
use super::extent::{self, Reach};
use super::fault::{Fault, infeasible};
use super::inverse::Followers;
use super::outcome::{PathInfeasible, PathInfeasibleReason};
use super::passage::Passage;
use super::range::Ranges;
use super::request::{Blend, PathRequest, Segment, Shape, Space, SplineKind};
use super::stroke::Stroke;
use super::taught::Teacher;
use super::track::{Joints, Track};
use super::{Program, report};
use crate::budget::Budget;
use crate::curve::Side;
use crate::jet::Jet;
use crate::plan::Failure;
use crate::robot::Robot;
use crate::tolerance::{BLEND_ANGLE_MAX, BLEND_MIN, PACE_MIN, SAME_BRANCH, SINGULAR_MIN};

/// Makes the paths of a program. `robot` carries the request's payload; `tcp` is its tool in the tip link's frame.
///
/// # Errors
/// A request that is wrong, or a budget that ended. A program that cannot be run is not an error.
pub(crate) fn build(
    robot: &Robot,
    tcp: &Isometry3<f64>,
    request: &PathRequest,
    budget: &Budget<'_>,
) -> Result<Result<Program, PathInfeasible>, Failure> {
    match program(robot, tcp, request, budget) {
        Ok(program) => Ok(Ok(program)),
        Err(Fault::Infeasible(infeasible)) => Ok(Err(*infeasible)),
        Err(Fault::Failure(failure)) => Err(failure),
    }
}

/// The tracks of a program, and what is at their corners.
#[derive(Debug, Default)]
struct Chain {
    tracks: Vec<Track>,
    /// After each track: how it goes over into the next; `None`: an exact stop.
    blends: Vec<Option<Blend>>,
    /// Time at rest after each track, s.
    dwells: Vec<f64>,
    initial_dwell: f64,
}

fn program(robot: &Robot, tcp: &Isometry3<f64>, request: &PathRequest, budget: &Budget<'_>) -> Result<Program, Fault> {
    let wrong = check(robot, request);
    if !wrong.is_empty() {
        return Err(Fault::Failure(Failure::Invalid(wrong)));
    }
    let mut teacher = Teacher::new(robot, tcp, request);
    let mut warnings = Vec::new();
    let chain = chain(&mut teacher, request, &mut warnings, budget)?;
    let mut program = Program {
        strokes: Vec::new(),
        initial_dwell: chain.initial_dwell,
        blends: Vec::new(),
        tool_lengths: vec![0.0; request.segments.len()],
        warnings,
        continuity: 3,
    };
    for track in &chain.tracks {
        program.tool_lengths[track.segment] = track.tool_length;
    }
    let inner = chain.tracks.len().saturating_sub(1);
    let corners = extent::settle(&teacher.arm, &chain.tracks, &chain.blends[..inner], budget)?;
    let mut mixes = Vec::with_capacity(inner);
    for (corner, tracks) in corners.into_iter().zip(chain.tracks.windows(2)) {
        budget.check()?;
        mixes.push(match corner {
            Some(reach) => {
                let corner = Corner {
                    arm: &teacher.arm,
                    first: &tracks[0],
                    second: &tracks[1],
                };
                mix(&teacher, corner, reach, &mut program, budget)?
            }
            None => None,
        });
    }
    if request.segments.iter().any(is_cubic) {
        program.continuity = 2;
    }
    program.strokes = strokes(&teacher, chain, mixes);
    let ranges = Ranges::new(robot, request);
    for stroke in &program.strokes {
        ranges.check(stroke, budget)?;
    }
    Ok(program)
}

/// Whether the second derivative is all that is continuous: at the knots of a cubic spline.
fn is_cubic(segment: &Segment) -> bool {
    match &segment.shape {
        Shape::Spline(spline) => spline.kind == SplineKind::Cubic && spline.points.len() > 1,
        Shape::Joint { .. } | Shape::Line { .. } | Shape::Arc(_) => false,
    }
}

/// Makes every segment a track, and leaves out those that go nowhere.
fn chain(
    teacher: &mut Teacher<'_>,
    request: &PathRequest,
    warnings: &mut Vec<String>,
    budget: &Budget<'_>,
) -> Result<Chain, Fault> {
    let mut chain = Chain::default();
    for (index, segment) in request.segments.iter().enumerate() {
        budget.check()?;
        if let Some(track) = teacher.track(index, &segment.shape, warnings, budget)? {
            chain.tracks.push(track);
            chain.blends.push(segment.blend);
            chain.dwells.push(segment.dwell);
            continue;
        }
        warnings.push(format!("segment {index} goes nowhere and is left out"));
        match (chain.blends.last_mut(), chain.dwells.last_mut()) {
            (Some(blend), Some(dwell)) => {
                *dwell += segment.dwell;
                // an exact stop here is one at the end of the segment before
                if segment.blend.is_none() {
                    *blend = None;
                }
            }
            _ => chain.initial_dwell += segment.dwell,
        }
    }
    Ok(chain)
}

/// Blends one corner; `None` where it has to be an exact stop.
fn mix(
    teacher: &Teacher<'_>,
    corner: Corner<'_>,
    reach: Reach,
    program: &mut Program,
    budget: &Budget<'_>,
) -> Result<Option<Mix>, Fault> {
    let Corner { first, second, .. } = corner;
    let mut stop = |why: &str| {
        let (one, other) = (first.segment, second.segment);
        program
            .warnings
            .push(format!("an exact stop between segments {one} and {other}: {why}"));
        program.blends.push(report::of_stop(first, second, why.to_owned()));
    };
    if reach.before.min(reach.after) < BLEND_MIN {
        stop("the blend is shorter than can be moved along");
        return Ok(None);
    }
    let passage = Passage {
        before: reach.before,
        after: reach.after,
    };
    let mix = match reach.blend.space {
        Space::Joint => Mix::in_joint_space(passage, reach.blend.weight),
        Space::Tool => tool_mix(teacher, corner, passage, reach.blend, budget)?,
    };
    if mix.slowest(corner, &teacher.speeds, budget)?.0 < PACE_MIN {
        stop("the path turns back on itself there");
        return Ok(None);
    }
    program.blends.push(report::of_blend(corner, &mix, reach.shrunk));
    Ok(Some(mix))
}

/// Blends one corner in tool space.
fn tool_mix(
    teacher: &Teacher<'_>,
    corner: Corner<'_>,
    passage: Passage,
    blend: Blend,
    budget: &Budget<'_>,
) -> Result<Mix, Fault> {
    let Corner { arm, first, second } = corner;
    let (segment, next) = (first.segment, second.segment);
    let angle = corner.largest_angle(&passage);
    if angle > BLEND_ANGLE_MAX {
        let message = format!(
            "the orientations of segments {segment} and {next} are up to {angle:.4} rad apart where they overlap, the most \
             is {BLEND_ANGLE_MAX}; make the blend shorter, or blend in joint space"
        );
        return Err(Fault::invalid(format!("segments[{segment}].blend"), message));
    }
    let (mut begin, mut end) = (Joints::default(), Joints::default());
    first.joints(
        arm,
        Jet::constant(first.length - passage.before),
        Side::After,
        &mut begin,
    );
    second.joints(arm, Jet::constant(passage.after), Side::Before, &mut end);
    let values = |q: &Joints| -> Vec<f64> { q.iter().take(arm.joint_count()).map(|q| q.value()).collect() };
    let leaders = teacher.leaders(&values(&begin), &values(&end));
    let followers = Followers::all_but(arm.joint_count(), &leaders);
    let fault = |s: f64, smallest: f64, why: &str| PathInfeasible {
        needed: SINGULAR_MIN,
        available: smallest,
        ..infeasible(
            PathInfeasibleReason::Singularity,
            corner::location(&passage, first, second, s),
            format!("the blend of segments {segment} and {next} {why}; make it shorter, or blend in joint space"),
        )
    };
    let mix = match Mix::in_tool_space(corner, passage, blend.weight, followers, budget)? {
        Ok(mix) => mix,
        Err(halt) => return Err(fault(halt.at, halt.smallest, "meets a singularity or the end of the reach").into()),
    };
    let ends = mix.followed_end().unwrap_or_default();
    if ends
        .iter()
        .zip(values(&end))
        .any(|(got, asked)| (got - asked).abs() > SAME_BRANCH)
    {
        return Err(fault(
            passage.length(),
            SINGULAR_MIN,
            "ends in another configuration of the arm",
        )
        .into());
    }
    Ok(mix)
}

/// Cuts the chain at its exact stops.
fn strokes(teacher: &Teacher<'_>, chain: Chain, mixes: Vec<Option<Mix>>) -> Vec<Stroke> {
    let mut strokes = Vec::new();
    let (mut tracks, mut joined) = (Vec::new(), Vec::new());
    let mut mixes = mixes.into_iter();
    for (track, dwell) in chain.tracks.into_iter().zip(chain.dwells) {
        tracks.push(track);
        if let Some(Some(mix)) = mixes.next() {
            joined.push(mix);
            continue;
        }
        strokes.push(Stroke::new(
            Shared::clone(&teacher.arm),
            std::mem::take(&mut tracks),
            std::mem::take(&mut joined),
            dwell,
        ));
    }
    strokes
}
