//! Which limit holds a timing where, and what each of them costs.

use super::law::TimeLaw;
use crate::path::outcome::{LimitCost, PathLimit};

/// The tightest limit on a piece of a timing.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Limiting {
    pub(crate) kind: PathLimit,
    /// Of which joint; `None`: the tool's.
    pub(crate) joint: Option<usize>,
    /// Part of the limit in the middle of the piece.
    pub(crate) ratio: f64,
}

/// Pieces of a timing in a row with the same tightest limit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct LimitedStretch {
    /// s.
    pub(crate) begin_time: f64,
    /// s.
    pub(crate) end_time: f64,
    /// Path position where it begins.
    pub(crate) begin: f64,
    pub(crate) limiting: Limiting,
}

impl Default for Limiting {
    fn default() -> Self {
        Self {
            kind: PathLimit::Rest,
            joint: None,
            ratio: 0.0,
        }
    }
}

/// The tightest limits in time order, without gaps.
pub(crate) fn stretches(law: &TimeLaw, limiting: &[Limiting]) -> Vec<LimitedStretch> {
    let mut stretches: Vec<LimitedStretch> = Vec::new();
    for ((piece, times), limiting) in law.pieces().iter().zip(law.times().windows(2)).zip(limiting) {
        match stretches.last_mut() {
            Some(last) if (last.limiting.kind, last.limiting.joint) == (limiting.kind, limiting.joint) => {
                last.end_time = times[1];
                last.limiting.ratio = last.limiting.ratio.max(limiting.ratio);
            }
            _ => stretches.push(LimitedStretch {
                begin_time: times[0],
                end_time: times[1],
                begin: piece.begin,
                limiting: *limiting,
            }),
        }
    }
    stretches
}

/// Time spent at each limit, longest first.
pub(crate) fn costs(stretches: &[LimitedStretch]) -> Vec<LimitCost> {
    let mut costs: Vec<LimitCost> = Vec::new();
    for stretch in stretches {
        let (kind, joint) = (stretch.limiting.kind, stretch.limiting.joint);
        let time = stretch.end_time - stretch.begin_time;
        match costs.iter_mut().find(|cost| (cost.kind, cost.joint) == (kind, joint)) {
            Some(cost) => cost.time += time,
            None => costs.push(LimitCost { kind, joint, time }),
        }
    }
    costs.sort_by(|a, b| b.time.total_cmp(&a.time));
    costs
}
