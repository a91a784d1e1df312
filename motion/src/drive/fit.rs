//! Calibration: what recorded samples say of an arm's drives and bodies.
//!
//! | fit | from |
//! |---|---|
//! | [`stiffness::fit_stiffness`] | torques and the deformations under them |
//! | [`damping::fit_damping`] | the maxima of a free oscillation |
//! | [`constant_speed::fit_constant_speed`] | runs at constant speed |
//! | [`motion::fit_motion`] | a motion of the whole arm: friction together with payload, rotors or bodies |
//! | [`assess::assess`] | how well a model says the torque of a motion that it was not fitted to |
//!
//! What is wrong with the input is an error with field paths; data that cannot tell give an answer that says what is missing.

pub mod assess;
pub mod constant_speed;
pub mod damping;
pub mod motion;
pub mod recording;
pub mod report;
pub mod stiffness;

mod deflect;
mod design;
mod excitation;
mod filter;
mod free_bodies;
mod least_squares;
mod linear;
mod normal;
mod online;
mod payload;
mod pose;
mod pseudo;
mod signals;
mod solve;
mod student;
mod uncertain;
mod unknowns;
mod validate;
