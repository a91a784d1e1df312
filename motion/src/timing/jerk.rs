//! Time-optimal timing under jerk limits too.

mod band;
mod basis;
mod fold;
mod interior;
mod pass;
mod rest;
mod rows;
