//! How well recursive least squares know their coefficients, whatever the residuals are like.
//!
//! With the scores s = w·r·ψ of the samples and the prior's Q₀⁻¹·(f₀ − f),
//!
//! ```text
//! f̂ − f = Q·(λⁿ·Q₀⁻¹·(f₀ − f) + Σ λⁿ⁻ᵏ·sₖ)        Cov f̂ = Q·B·Q
//! B      = λ²ⁿ·Q₀⁻¹·C₀·Q₀⁻¹ + ½·Σ over blocks j (Sⱼ₋₁ + Sⱼ)·(Sⱼ₋₁ + Sⱼ)ᵀ        S = Σ over a block λⁿ⁻ᵏ·sₖ
//! ```
//!
//! which takes residuals for independent over two blocks' length alone, not from sample to sample (White 1980; Newey and West
//! 1987, whose kernel pairs of neighbouring blocks make, in constant memory). Blocks have three lengths; of those that there are
//! enough of, the one that makes the largest covariance is believed: residuals that stay alike for longer than a block show
//! in the longer ones. Intervals are Student's, with two thirds of the number of blocks as degrees of freedom (pairs overlap by
//! half: the variance of a mean of squares of such is 3/2 of that of independent ones, over the number of blocks).
//!
//! The r of a score is what a sample would leave if it counted in full, (y − ψ·f)/(1 + ψ·Q·ψᵀ/λ): where little is known yet, what the
//! coefficients lack is no noise.

use super::factor::{UnitFactor, lower, sandwich, times};
use super::law::{TERMS_MAX, TRIANGLE};
use crate::tolerance::{ESTIMATE_BLOCK_SECONDS, ESTIMATE_BLOCKS_MIN};

/// Lengths of blocks.
pub(super) const LEVELS: usize = 3;

/// Blocks of one length in a block of the next.
const BLOCKS_IN_NEXT: u64 = 4;

/// What is known of the scores.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Evidence {
    /// The prior's part of B.
    pub(super) prior: [f64; TRIANGLE],
    pub(super) levels: [Level; LEVELS],
}

/// Blocks of one length.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Level {
    /// Scores of the block that is open.
    pub(super) scores: [f64; TERMS_MAX],
    /// Residuals of the open block times their seconds.
    pub(super) impulse: f64,
    /// Product of its λ.
    pub(super) decay: f64,
    /// Its seconds.
    pub(super) seconds: f64,
    /// Blocks of the length before in it.
    pub(super) parts: u64,
    /// Scores of the block before it, as of its end.
    pub(super) before: [f64; TERMS_MAX],
    /// B of the blocks that are closed, as of the last one's end.
    pub(super) products: [f64; TRIANGLE],
    /// Sum of the weights of closed blocks, and of their squares.
    pub(super) weight: f64,
    pub(super) weight_squared: f64,
    /// Squared impulses of closed blocks, and their seconds, with the same forgetting.
    pub(super) impulses: f64,
    pub(super) duration: f64,
}

/// A covariance, and what it stands on.
#[derive(Debug, Clone, Copy)]
pub(super) struct Known {
    pub(super) covariance: [f64; TRIANGLE],
    /// `None`: the covariance is taken as known.
    pub(super) degrees_of_freedom: Option<f64>,
}

impl Level {
    const EMPTY: Self = Self {
        scores: [0.0; TERMS_MAX],
        impulse: 0.0,
        decay: 1.0,
        seconds: 0.0,
        parts: 0,
        before: [0.0; TERMS_MAX],
        products: [0.0; TRIANGLE],
        weight: 0.0,
        weight_squared: 0.0,
        impulses: 0.0,
        duration: 0.0,
    };

    /// How many independent blocks the sums are worth (Kish's count).
    fn blocks(&self) -> f64 {
        if self.weight_squared > 0.0 {
            return self.weight * self.weight / self.weight_squared;
        }
        0.0
    }

    /// Scores of the open block and the one before.
    fn pair(&self) -> [f64; TERMS_MAX] {
        let mut pair = self.scores;
        for (score, before) in pair.iter_mut().zip(self.before) {
            *score += self.decay * before;
        }
        pair
    }

    /// Closes the open block and returns it.
    fn close(&mut self) -> Self {
        let block = *self;
        let kept = block.decay * block.decay;
        let pair = block.pair();
        for row in 0..TERMS_MAX {
            for column in 0..=row {
                let product = &mut self.products[lower(row, column)];
                *product = kept * *product + 0.5 * pair[row] * pair[column];
            }
        }
        self.before = block.scores;
        self.weight = kept * self.weight + 1.0;
        self.weight_squared = kept * kept * self.weight_squared + 1.0;
        self.impulses = kept * self.impulses + block.impulse * block.impulse;
        self.duration = kept * self.duration + block.seconds;
        self.scores = [0.0; TERMS_MAX];
        (self.impulse, self.decay, self.seconds, self.parts) = (0.0, 1.0, 0.0, 0);
        block
    }

    /// Adds a block of the length before.
    fn take(&mut self, block: &Self) {
        for (score, part) in self.scores.iter_mut().zip(block.scores) {
            *score = block.decay * *score + part;
        }
        self.impulse += block.impulse;
        self.decay *= block.decay;
        self.seconds += block.seconds;
        self.parts += 1;
    }
}

impl Evidence {
    /// Nothing but a prior: Q₀⁻¹·C₀·Q₀⁻¹.
    pub(super) fn new(prior: [f64; TRIANGLE]) -> Self {
        Self {
            prior,
            levels: [Level::EMPTY; LEVELS],
        }
    }

    /// Adds a sample: what would remain of its torque if it counted in full.
    #[inline(always)]
    pub(super) fn add<const N: usize>(
        &mut self,
        psi: &[f64; TERMS_MAX],
        weight: f64,
        lambda: f64,
        seconds: f64,
        remaining: f64,
    ) {
        let open = &mut self.levels[0];
        let weighted = weight * remaining;
        for (score, psi) in open.scores.iter_mut().zip(psi).take(N) {
            *score = lambda * *score + weighted * psi;
        }
        open.impulse += remaining * seconds;
        open.decay *= lambda;
        open.seconds += seconds;
        if open.seconds >= ESTIMATE_BLOCK_SECONDS {
            self.close();
        }
    }

    #[cold]
    fn close(&mut self) {
        let mut block = self.levels[0].close();
        let kept = block.decay * block.decay;
        for value in &mut self.prior {
            *value *= kept;
        }
        for level in &mut self.levels[1..] {
            level.take(&block);
            if level.parts < BLOCKS_IN_NEXT {
                return;
            }
            block = level.close();
        }
    }

    /// Information was added at the present estimate, about one coefficient: Q⁻¹ ← Q⁻¹ + ρ·e·eᵀ. The covariance Q·B·Q stays,
    /// and so do the open blocks' parts in it: s ← (I + ρ·e·(Q·e)ᵀ)·s. `column` is Q·e before.
    pub(super) fn told<const N: usize>(&mut self, index: usize, column: &[f64; TERMS_MAX], information: f64) {
        let turn = |products: &mut [f64; TRIANGLE]| {
            let product = times(N, products, column);
            let twice: f64 = (0..N).map(|i| column[i] * product[i]).sum();
            for (row, value) in product.iter().enumerate().take(N) {
                products[lower(row, index)] += information * value;
            }
            // the diagonal has the term from either side
            products[lower(index, index)] += information * (product[index] + information * twice);
        };
        turn(&mut self.prior);
        for level in &mut self.levels {
            turn(&mut level.products);
            let along: f64 = (0..N).map(|i| column[i] * level.scores[i]).sum();
            level.scores[index] += information * along;
            let along: f64 = (0..N).map(|i| column[i] * level.before[i]).sum();
            level.before[index] += information * along;
        }
    }

    /// Covariance of the coefficients, with `variance` that of a sample's noise, for as long as there are too few blocks to
    /// say: then samples are worth their weights.
    pub(super) fn known(&self, count: usize, factor: &UnitFactor, variance: f64) -> Known {
        let matrix = factor.matrix(count);
        let mut best: Option<(f64, Known)> = None;
        // the open block of a level: its own samples after those of the shorter blocks that it consists of
        let mut open = Level::EMPTY;
        let mut prior = self.prior;
        let since = self.levels[0].decay * self.levels[0].decay;
        for value in &mut prior {
            *value *= since;
        }
        for level in &self.levels {
            let mut part = *level;
            // `before` stays the level's own: its block ended where the open one began
            part.take(&open);
            open = part;
            let blocks = level.blocks();
            if blocks < ESTIMATE_BLOCKS_MIN {
                continue;
            }
            let kept = open.decay * open.decay;
            let (mut inner, pair) = (prior, open.pair());
            for row in 0..count {
                for column in 0..=row {
                    inner[lower(row, column)] +=
                        kept * level.products[lower(row, column)] + 0.5 * pair[row] * pair[column];
                }
            }
            let covariance = sandwich(count, &matrix, &inner);
            // over Q's own variances: what units the coefficients have does not matter
            let size = (0..count).map(|i| covariance[lower(i, i)] / matrix[lower(i, i)]).sum();
            if best.as_ref().is_none_or(|(largest, _)| size > *largest) {
                let known = Known {
                    covariance,
                    degrees_of_freedom: Some(blocks * 2.0 / 3.0),
                };
                best = Some((size, known));
            }
        }
        if let Some((_, known)) = best {
            return known;
        }
        let mut covariance = matrix;
        for value in &mut covariance {
            *value *= variance;
        }
        Known {
            covariance,
            degrees_of_freedom: None,
        }
    }

    /// Time over which residuals stay alike, s: half of the time for which a residual of the same variance would have to
    /// last to have the same mean square over a long block. `None` with too few blocks. `variance` is that of the residuals that the
    /// impulses are of.
    pub(super) fn correlation_time(&self, variance: f64) -> Option<f64> {
        let densities = self.levels.iter().filter(|level| level.blocks() >= ESTIMATE_BLOCKS_MIN);
        let density = densities
            .map(|level| level.impulses / level.duration)
            .fold(None, |largest: Option<f64>, density| {
                Some(largest.map_or(density, |largest| largest.max(density)))
            })?;
        (variance > 0.0).then(|| 0.5 * density / variance)
    }
}
