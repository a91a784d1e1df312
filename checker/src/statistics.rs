//! Distributions of excesses over many moves.

/// How often and how far moves exceed a limit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ExcessStatistics {
    /// How many moves there were.
    pub count: usize,
    /// Part of them with an excess above the threshold, 0 to 1.
    pub share_over: f64,
    /// Median excess of those; 0 where there are none.
    pub median: f64,
    /// 95th percentile of those; 0 where there are none.
    pub percentile_95: f64,
    /// Largest excess; 0 where none is above the threshold.
    pub largest: f64,
}

impl ExcessStatistics {
    /// The statistics of signed relative excesses, one a move; those above `threshold` count as over.
    #[must_use]
    pub fn of(excesses: &[f64], threshold: f64) -> Self {
        let mut over: Vec<f64> = excesses.iter().copied().filter(|excess| *excess > threshold).collect();
        over.sort_by(f64::total_cmp);
        Self {
            count: excesses.len(),
            share_over: over.len() as f64 / excesses.len().max(1) as f64,
            median: quantile(&over, 0.5),
            percentile_95: quantile(&over, 0.95),
            largest: quantile(&over, 1.0),
        }
    }
}

/// The value below which the part `share` of a sorted list lies, linear between neighbours; 0 for an empty list.
#[must_use]
pub fn quantile(sorted: &[f64], share: f64) -> f64 {
    let Some(last) = sorted.len().checked_sub(1) else {
        return 0.0;
    };
    let place = share.clamp(0.0, 1.0) * last as f64;
    let below = place.floor() as usize;
    let above = (below + 1).min(last);
    let part = place - below as f64;
    sorted[below] + (sorted[above] - sorted[below]) * part
}

impl std::fmt::Display for ExcessStatistics {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(
            f,
            "{} moves, {:.1} % over; of those median {:.1} %, 95th percentile {:.1} %, largest {:.1} %",
            self.count,
            100.0 * self.share_over,
            100.0 * self.median,
            100.0 * self.percentile_95,
            100.0 * self.largest,
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn statistics_are_of_those_over_the_threshold() {
        let found = ExcessStatistics::of(&[-0.5, 0.1, 0.3, 0.0005, 0.2], 1e-3);
        assert_eq!(found.count, 5);
        assert!((found.share_over - 0.6).abs() < 1e-15);
        assert!((found.median - 0.2).abs() < 1e-15);
        assert!((found.percentile_95 - 0.29).abs() < 1e-15);
        assert_eq!(found.largest, 0.3);
    }

    #[test]
    fn no_moves_have_no_excess() {
        let found = ExcessStatistics::of(&[], 0.0);
        assert_eq!((found.share_over, found.median, found.largest), (0.0, 0.0, 0.0));
    }
}
