//! Robot programs: joint moves, lines, arcs and splines, blended into paths q(s) that are smooth to the third derivative.

pub mod outcome;
pub mod request;
#[allow(dead_code, reason = "the path planner under construction")]
mod verify;
