//! Motion planning for robot arms under torque limits: pure computation, no I/O, no clock, no threads.
//!
//! A drive must give, at its joint,
//!
//! ```text
//! τ = M(q)·q̈ + C(q, q̇)·q̇ + g(q) + ξ²·I_m·q̈ + friction(q̇)        |τ| ≤ T
//! ```
//!
//! and a move is a pattern of velocity for every joint, synchronized with the others, that takes the arm from rest to rest
//! while every joint keeps its torque, speed, acceleration and position limits all the way.
//!
//! The way of a request through the crate:
//!
//! 1. [`robot::description`] and [`robot::resolve`]: a URDF or a DH table becomes a [`robot::spec::RobotSpec`], or a list of
//!    everything that is wrong with it; [`robot::Robot`] makes it ready to compute with.
//! 2. [`plan::plan_move`]: from a request to a verified plan, or to the evidence why there is none.
//!    [`plan::check_trajectory`] finds the margins of a trajectory that somebody else made.
//! 3. [`dynamics`] and [`kinematics`] are the building blocks, free of allocation.
//!
//! The planner (`plan`) goes from a time law along a path to torques; the verifier (`verify`) goes from positions,
//! velocities and accelerations in time. What a plan says of its torques comes from the verifier alone. All tolerances are in
//! `tolerance`, each with its reason.
//!
//! Units are SI; positions are in rad or m, torques in N m or N, whichever the joint's kind asks for.

#![warn(missing_docs)]

pub mod budget;
pub mod confidence;
mod curve;
pub mod drive;
pub mod dynamics;
pub mod error;
mod jet;
pub mod kinematics;
pub mod path;
pub mod plan;
pub mod process;
mod quantile;
pub mod robot;
mod scalar;
#[cfg(test)]
mod test_arms;
mod timing;
mod tolerance;
mod trajectory;
mod verify;

pub use error::Invalid;
pub use nalgebra;
#[doc(hidden)]
pub use timing::measured;
pub use tolerance::{
    BEZIER_POINTS_MAX, DURATION_MAX, POSITION_MAX, SEGMENTS_MAX, SETPOINTS_MAX, SPLINE_POINTS_MAX, TARGETS_MAX,
    TELEMETRY_SAMPLES_MAX, TRAJECTORY_POINTS_MAX, TRAVEL_MAX,
};
