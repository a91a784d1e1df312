//! Robot programs: joint moves, lines, arcs and splines, blended into paths q(s) that are smooth to the third derivative.
//!
//! A program becomes strokes, paths without a stop within them; between two of them the arm stands still. A stroke is
//! made of tracks, one a segment, each at its own pace in "normalised time": s runs so that the joint that is nearest
//! to its speed limit is, on average over the segment, just at it. Where two segments are blended they overlap in s, and
//!
//! ```text
//! q(s) = q₁(u₁(x))·(1 − w(x)) + q₂(u₂(x))·w(x)        x(s) from 0 to 1: `passage.rs`;   w: `weight.rs`
//! ```
//!
//! in joint space, or the same in tool space before inverse kinematics: positions p as q here, orientations as
//! R₁·exp(w·log(R₁ᵀR₂)) (JP2016-055404, paragraphs 0060 to 0090, 0169). Everything is evaluated where it is asked for, with
//! its derivatives, in Taylor arithmetic (`jet.rs`): nothing is interpolated between samples.

mod answer;
mod arm;
mod band;
mod build;
mod chain;
mod check;
mod circle;
pub(crate) mod confident;
mod constant;
mod corner;
mod evidence;
mod extent;
mod fault;
mod follow;
mod guided;
mod inverse;
pub mod outcome;
mod pace;
mod passage;
mod piecewise;
mod plan;
mod problem;
mod range;
mod report;
pub mod request;
mod sample;
mod shape;
mod spline;
mod square;
mod stroke;
mod taught;
mod taught_spline;
mod tool;
mod track;
mod verify;
mod weight;

pub(crate) use build::build;
pub use plan::plan_path;
pub(crate) use stroke::Stroke;

use outcome::BlendReport;

/// A request made paths: what the timing sees of it.
#[derive(Debug)]
pub(crate) struct Program {
    /// In order; between two of them the arm is at rest.
    pub(crate) strokes: Vec<Stroke>,
    /// Time at rest before the first stroke, s: dwells after segments that go nowhere.
    pub(crate) initial_dwell: f64,
    /// What became of each blend that was asked for; times are 0.
    pub(crate) blends: Vec<BlendReport>,
    /// Length of the tool's way on each segment of the request, m.
    pub(crate) tool_lengths: Vec<f64>,
    /// What the caller should know.
    pub(crate) warnings: Vec<String>,
    /// Derivatives in s that are continuous everywhere: 3, or 2 with a cubic spline.
    pub(crate) continuity: u32,
}

#[cfg(test)]
mod tests;
