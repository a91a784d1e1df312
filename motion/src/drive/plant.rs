//! The simulated arm.
