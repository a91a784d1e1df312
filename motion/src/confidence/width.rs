//! The half-width of a joint's band, from how well its parameters are known and from what its model leaves over.
//!
//! ```text
//! |τ_true − τ| ≤ b       τ_true = τ + φᵀ·δ + e       δ ~ N(0, Σ)       e = r·√((ν − 2)/ν)·T_ν
//! p² = φᵀ·Σ·φ
//! ```
//!
//! r is the deviation of the residual e, T_ν a Student variable. α is 1 less the level.
//!
//! **At a sample**: b = z·√(p² + r²), P(|τ_true − τ| > b) ≤ α at every joint and every moment. Of the sum of both parts neither
//! distribution is that of either: z is the larger of the normal quantile and that of Student's scaled to variance 1, each at
//! α/2. In between, the sum is a mixture of normal ones. Its tail beyond z·√(p² + r²), by quadrature over ν from 2.2 to 100,
//! p²/(p² + r²) from 0.02 to 0.98 and levels from 0.5 to 0.99999, is above α by 1.5e-4 of it at the most, where both quantiles are
//! alike; [`MIXTURE_RESERVE`] makes up for that.
//!
//! **Over a move**: P(|τ_true − τ| > b anywhere, at any joint) ≤ α. Of n joints each gets α/n (Bonferroni: residuals of
//! different joints need not be independent), of which half goes to each part, so that b = u·p + z·r.
//! - The parameters are drawn once: φᵀδ/p = γ·ξ with ξ standard normal and γ = Lᵀφ/|Lᵀφ| a curve on the unit sphere. Where it
//!   stands still one draw decides, 2·Q(u); where it turns by κ in all, P(|γ·ξ| > u anywhere) ≤ 2·Q(u) + κ/π·exp(−u²/2)
//!   (H. Hotelling 1939; D. Naiman, "Conservative confidence bands in curvilinear regression", Ann. Stat. 14, 1986).
//!   A jump of γ, where friction changes sides, counts with its angle.
//! - The residual is alike over a correlation time τ_c and drawn anew after it: a motion of duration T sees at most
//!   N = 1 + T/τ_c draws in the mean, and z is the Student quantile at α/(4·n·N) (Bonferroni again).

use super::{Confidence, Over};
use crate::quantile::{largest_of_process, normal, student};
use crate::robot::spec::Residual;
use crate::tolerance::MIXTURE_RESERVE;

/// How a joint's band comes from its parts.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Width {
    /// Of the parameters' part.
    parameters: f64,
    /// Of the residual's.
    residual: f64,
    /// The residual's deviation.
    deviation: f64,
    over: Over,
}

impl Width {
    /// The band of a joint at any one sample.
    pub(super) fn at_sample(level: f64, residual: &Residual) -> Self {
        let tail = 0.5 * (1.0 - level);
        let multiplier = if residual.degrees_of_freedom == f64::INFINITY {
            normal(tail)
        } else {
            normal(tail).max(unit_student(residual, tail)) * (1.0 + MIXTURE_RESERVE)
        };
        Self {
            parameters: multiplier,
            residual: multiplier,
            deviation: residual.deviation,
            over: Over::Sample,
        }
    }

    /// The band of one of `joints` joints over a whole motion: its duration, s, and by how much its direction in the space of the
    /// parameters turns, rad.
    pub(super) fn over_move(level: f64, residual: &Residual, joints: usize, duration: f64, turn: f64) -> Self {
        let part = 0.5 * (1.0 - level) / joints.max(1) as f64;
        let draws = 1.0 + duration / residual.correlation_time;
        Self {
            parameters: largest_of_process(turn, part),
            residual: unit_student(residual, 0.5 * part / draws),
            deviation: residual.deviation,
            over: Over::Move,
        }
    }

    /// The width for a motion, by what the confidence is over.
    pub(super) fn of(confidence: Confidence, residual: &Residual, joints: usize, duration: f64, turn: f64) -> Self {
        match confidence.over {
            Over::Sample => Self::at_sample(confidence.level, residual),
            Over::Move => Self::over_move(confidence.level, residual, joints, duration, turn),
        }
    }

    /// Half the band's width where the parameters' part has this deviation.
    pub(super) fn band(&self, deviation: f64) -> f64 {
        match self.over {
            Over::Sample => self.residual * (deviation * deviation + self.deviation * self.deviation).sqrt(),
            Over::Move => self.parameters * deviation + self.residual * self.deviation,
        }
    }
}

/// Beyond it lies `tail` of a residual of deviation 1.
fn unit_student(residual: &Residual, tail: f64) -> f64 {
    let nu = residual.degrees_of_freedom;
    if nu == f64::INFINITY {
        return normal(tail);
    }
    student(nu, tail) * ((nu - 2.0) / nu).sqrt()
}

#[cfg(test)]
mod tests;
