//! What every long run finds: plans, programs without one, how near each limit came, and what is wrong.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

/// What a run found, or a part of it. In its file these are fields of the run's own line.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
pub(crate) struct Findings {
    /// Plans by robot and how they were made.
    plans: BTreeMap<String, u64>,
    /// Requests without a plan, by robot and reason.
    refused: BTreeMap<String, u64>,
    /// By robot and limit: the largest excess, negative where there is room left, and its seed.
    worst: BTreeMap<String, (f64, u64)>,
    pub(crate) violations: Vec<String>,
}

impl Findings {
    pub(crate) fn count_plan(&mut self, key: String) {
        *self.plans.entry(key).or_default() += 1;
    }

    pub(crate) fn count_refusal(&mut self, key: String) {
        *self.refused.entry(key).or_default() += 1;
    }

    /// Keeps an excess where it is the largest of its limit.
    pub(crate) fn keep_excess(&mut self, key: String, excess: f64, seed: u64) {
        let worst = self.worst.entry(key).or_insert((excess, seed));
        if excess > worst.0 {
            *worst = (excess, seed);
        }
    }

    pub(crate) fn add(&mut self, part: &Self) {
        for (key, count) in &part.plans {
            *self.plans.entry(key.clone()).or_default() += count;
        }
        for (key, count) in &part.refused {
            *self.refused.entry(key.clone()).or_default() += count;
        }
        for (key, (excess, seed)) in &part.worst {
            self.keep_excess(key.clone(), *excess, *seed);
        }
        self.violations.extend(part.violations.iter().cloned());
    }

    /// Prints how many plans there are.
    pub(crate) fn print_counts(&self) {
        println!("\nplans");
        for (key, count) in &self.plans {
            println!("  {key:<40} {count:>9}");
        }
        println!("\nwithout a plan");
        for (key, count) in &self.refused {
            println!("  {key:<40} {count:>9}");
        }
    }

    /// Prints how near each limit came.
    pub(crate) fn print_worst(&self) {
        println!("\nlargest excess over a limit, as part of it; negative: room left");
        for (key, (excess, seed)) in &self.worst {
            println!("  {key:<40} {excess:>+10.2e}   seed {seed}");
        }
    }

    /// Prints what is wrong.
    pub(crate) fn print_violations(&self) {
        println!("\n{} violations", self.violations.len());
        for violation in &self.violations {
            println!("  {violation}");
        }
    }
}
