//! From a request to strokes: tracks, corners, blends, and what is wrong with them.

use std::sync::Arc as Shared;

use nalgebra::Isometry3;

use super::check::check;
use super::corner::Mix;
use super::extent::{self, Corner};
use super::fault::Fault;
use super::outcome::{BlendReport, PathInfeasible};
use super::passage::Passage;
use super::request::{Blend, PathRequest};
use super::stroke::Stroke;
use super::taught::Teacher;
use super::track::Track;
use super::{Program, report};
use crate::budget::Budget;
use crate::plan::Failure;
use crate::robot::Robot;
use crate::tolerance::{BLEND_MIN, PACE_MIN};

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
    let corners = extent::settle(&teacher.arm, &chain.tracks, &chain.blends[..inner]);
    let mut mixes = Vec::with_capacity(inner);
    for (corner, tracks) in corners.into_iter().zip(chain.tracks.windows(2)) {
        budget.check()?;
        mixes.push(match corner {
            Some(corner) => mix(&teacher, &tracks[0], &tracks[1], corner, &mut program)?,
            None => None,
        });
    }
    program.strokes = strokes(&teacher, chain, mixes);
    Ok(program)
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
        if let Some(track) = teacher.track(index, &segment.shape)? {
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
    first: &Track,
    second: &Track,
    corner: Corner,
    program: &mut Program,
) -> Result<Option<Mix>, Fault> {
    let mut stop = |why: &str| {
        let (one, other) = (first.segment, second.segment);
        program
            .warnings
            .push(format!("an exact stop between segments {one} and {other}: {why}"));
        program.blends.push(report::of_stop(first, second, why.to_owned()));
    };
    if corner.before.min(corner.after) < BLEND_MIN {
        stop("the blend is shorter than can be moved along");
        return Ok(None);
    }
    let passage = Passage {
        before: corner.before,
        after: corner.after,
    };
    let mix = Mix::in_joint_space(passage, corner.blend.weight);
    if mix.slowest(&teacher.arm, first, second, &teacher.speeds) < PACE_MIN {
        stop("the path turns back on itself there");
        return Ok(None);
    }
    let report: BlendReport = report::of_blend(&teacher.arm, first, second, &corner, &mix);
    program.blends.push(report);
    Ok(Some(mix))
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
