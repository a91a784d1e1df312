//! Motion planning for robot arms under torque limits: pure computation, no I/O, no clock, no threads.

#![warn(missing_docs)]

pub mod budget;
pub mod dynamics;
pub mod error;
pub mod kinematics;
pub mod plan;
pub mod robot;
mod scalar;
#[cfg(test)]
mod test_arms;
mod tolerance;
mod trajectory;
mod verify;

pub use error::Invalid;
pub use nalgebra;
pub use tolerance::{DURATION_MAX, POSITION_MAX, SETPOINTS_MAX, TRAJECTORY_POINTS_MAX, TRAVEL_MAX};
