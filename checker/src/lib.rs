//! An independent check of planned moves.
//!
//! The planner says that a move keeps every limit; this crate asks again, with nothing of the planner's: it takes the
//! passive descriptions of `takt-motion` (what an arm is, what a request asks for, what a pattern is) and none of its
//! kinematics, dynamics, planning or verification. What both could get wrong in the same way is thereby little more
//! than the meaning of those descriptions' fields.
//!
//! - [`arm`]: inverse dynamics, Newton and Euler for each body in the base frame, moments summed about each joint axis.
//! - [`motion`]: a pattern as the motion of one joint over time, and whether its figures agree with each other.
//! - [`band`]: how far a torque may be from what a model says, given how well it is known.
//! - [`bounds`]: the limits that a request puts in force.
//! - [`recheck`](mod@recheck): a whole move on a dense grid of times, both sides of every switching time included.
//! - [`report`]: what it finds: the extremes of every joint, and what does not agree.
//! - [`claims`]: what a plan says of itself, against what was found.
//! - [`path`]: a timed path, from its set-points alone.
//! - [`endpoint`]: the end-pose method of JP4358979B2 written a second time, to measure what it lets through.
//! - [`statistics`], [`draw`], [`draw_program`]: distributions of excesses, and the random numbers and programs behind
//!   them.
//!
//! SI units throughout: rad, m, s, kg, N m, N. A joint's position is "rad or m", and so are its derivatives; its torque
//! is "N m or N".

#![warn(missing_docs)]

pub mod arm;
pub mod band;
pub mod bounds;
pub mod claims;
pub mod draw;
pub mod draw_program;
pub mod endpoint;
pub mod motion;
pub mod path;
pub mod recheck;
pub mod report;
pub mod statistics;
pub mod tolerance;

pub use arm::{Arm, Workspace};
pub use bounds::Bounds;
pub use path::{Density, recheck_path};
pub use recheck::{Checker, Grid, Move, recheck};
pub use report::Report;
