//! Recordings in, fits out.

mod bench;
mod outcome;
mod request;
mod same;

pub use self::{
    bench::{constant_speed_to_wire, damping_to_wire, finding_on_bench, joint, runs, stiffness_to_wire},
    outcome::{assessment_to_wire, fit_to_wire, missing_to_wire},
    request::{MotionFitRequest, Part, finding_on_recording, motion_fit_request},
};
