//! Recordings in, fits out.

mod outcome;
mod request;

pub use self::{
    outcome::{assessment_to_wire, fit_to_wire, missing_to_wire},
    request::{MotionFitRequest, finding_on_recording, motion_fit_request},
};
