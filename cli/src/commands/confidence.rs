//! The options that ask for a confidence.

use clap::Args;
use takt_client::v1;

use crate::numbers;

/// The confidence at which torque limits shall hold.
#[derive(Debug, Args)]
pub(super) struct ConfidenceArgs {
    /// Hold torque limits at this confidence, as in 95% or 0.95, given how well the model is known.
    #[arg(long, value_name = "LEVEL", value_parser = numbers::level)]
    confidence: Option<f64>,
    /// Of the whole motion and all joints at once, not of any one sample.
    #[arg(long, requires = "confidence")]
    per_move: bool,
}

impl ConfidenceArgs {
    /// What was asked for; the file's where nothing was.
    pub(super) fn or(&self, file: Option<v1::Confidence>) -> Option<v1::Confidence> {
        let Some(level) = self.confidence else { return file };
        let over = match self.per_move {
            true => v1::confidence::Over::Move,
            false => v1::confidence::Over::Sample,
        };
        Some(v1::Confidence {
            level,
            over: Some(over.into()),
        })
    }
}
