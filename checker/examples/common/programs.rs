//! The random programs of the long run and of the tests: robot, program, sampling and jerk follow from a seed.

use takt_checker::Density;
use takt_checker::draw::Draw;
use takt_checker::draw_program::{self, Cell};
use takt_motion::SETPOINTS_MAX;
use takt_motion::path::request::PathRequest;
use takt_motion::plan::request::Sampling;

use crate::robots::Example;

/// The periods of drives, s.
const PERIODS: [f64; 4] = [0.001, 0.002, 0.004, 0.008];

/// Set-points of a trace for every stretch from stop to stop: ten times the intervals of the planner's timing grid
/// (`motion/src/tolerance.rs`).
pub(crate) const FINE: usize = 5000;

/// A robot's program.
pub(crate) struct Trial<'a> {
    pub(crate) example: &'a Example,
    pub(crate) request: PathRequest,
    /// Of the set-points that it asks for.
    pub(crate) density: Density,
}

/// The program of a seed. Every other one of a robot has jerk limits; one in four is sampled at a drive's period, the
/// others `fine` times between two stops.
pub(crate) fn of_seed(robots: &[Example], seed: u64, fine: usize) -> Trial<'_> {
    let count = robots.len() as u64;
    let example = &robots[(seed % count) as usize];
    let draw = &mut Draw::seeded(seed);
    let cell = Cell {
        spec: example.robot.spec(),
        payload_max: example.payload_max,
        sampling: Sampling::Period(PERIODS[(draw.bits() % 4) as usize]),
        limit_jerk: (seed / count).is_multiple_of(2),
    };
    let mut request = draw_program::program(draw, &cell);
    let mut density = Density::Coarse;
    if !draw.bits().is_multiple_of(4) {
        let stops = request
            .segments
            .iter()
            .filter(|segment| segment.blend.is_none())
            .count();
        request.sampling = Sampling::Trace((fine * stops + 1).min(SETPOINTS_MAX));
        // Without jerk limits an acceleration may go there and back within any step.
        if fine >= FINE && cell.limit_jerk {
            density = Density::Resolving;
        }
    }
    Trial {
        example,
        request,
        density,
    }
}
