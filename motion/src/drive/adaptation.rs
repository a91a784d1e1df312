//! Whether the controller adapts friction, and how fast.

use super::gains::JointGains;
use crate::error::Invalid;
use crate::tolerance::ADAPT_MEMORY;

/// Whether, and how fast, friction is adapted. L is that of the motor's side; the output's side, whose friction is only seen
/// through the arm's own swinging, has a quarter of it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Adaptation {
    /// The model's friction.
    Off,
    /// By the observer.
    Observer {
        /// L, 1/s; `None`: K_p/K_d of the joint.
        rate: Option<f64>,
    },
    /// By coefficients that are learned, and by the observer for what they leave over.
    Law {
        /// L, 1/s; `None`: K_p/K_d of the joint.
        rate: Option<f64>,
        /// How long is remembered, s; `None`: 2.
        memory: Option<f64>,
    },
}

impl Default for Adaptation {
    fn default() -> Self {
        Self::Law {
            rate: None,
            memory: None,
        }
    }
}

impl Adaptation {
    /// L of a joint, 1/s.
    pub(super) fn rate(self, gains: &JointGains) -> f64 {
        match self {
            Self::Off => 0.0,
            Self::Observer { rate: Some(rate) } | Self::Law { rate: Some(rate), .. } => rate,
            Self::Observer { rate: None } | Self::Law { rate: None, .. } if gains.velocity > 0.0 => {
                gains.position / gains.velocity
            }
            Self::Observer { rate: None } | Self::Law { rate: None, .. } => 0.0,
        }
    }

    /// λ at a period; `None` where nothing is learned.
    pub(super) fn forget(self, period: f64) -> Option<f64> {
        let Self::Law { memory, .. } = self else { return None };
        Some(libm::exp(-period / memory.unwrap_or(ADAPT_MEMORY)))
    }

    pub(super) fn check(self, wrong: &mut Vec<Invalid>) {
        let (rate, memory) = match self {
            Self::Off => (None, None),
            Self::Observer { rate } => (rate, None),
            Self::Law { rate, memory } => (rate, memory),
        };
        if let Some(rate) = rate.filter(|rate| !(rate.is_finite() && *rate >= 0.0)) {
            let message = format!("{rate} must be finite and at least 0");
            wrong.push(Invalid::new("adaptation.rate", message));
        }
        if let Some(memory) = memory.filter(|memory| !(memory.is_finite() && *memory > 0.0)) {
            let message = format!("{memory} must be positive and finite");
            wrong.push(Invalid::new("adaptation.memory", message));
        }
    }
}

/// 1 − e^(−x).
pub(super) fn lag(x: f64) -> f64 {
    -libm::expm1(-x)
}
