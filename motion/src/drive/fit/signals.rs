//! From a recording to what is fitted: evenly spaced states of the arm and torques, in one band.
//!
//! Time stamps of logs jitter, so everything is first put on an even grid at the recording's median period by straight
//! lines. Positions (and speeds, where they were measured) go through a low-pass at [`KINEMATIC_BAND`] times the band, speeds
//! and accelerations are differences of what comes out; the model is computed from these. Torque and model then go through
//! the same low-pass at the band, so that what one loses the other loses too (M. Gautier, P. Poignet, "Extended Kalman
//! filtering and weighted least squares dynamic identification of robot", 2001: "parallel filtering").

use std::ops::Range;

use super::filter::{LowPass, derivative};
use super::recording::{Recording, Selection};
use crate::budget::Budget;
use crate::error::Invalid;
use crate::plan::Failure;
use crate::robot::Robot;
use crate::tolerance::{FIT_BAND_SAMPLES, GAP_BANDS, KINEMATIC_BAND, NATIVE_BAND_SAMPLES};

/// States and torques on an even grid.
#[derive(Debug, Clone)]
pub(crate) struct Signals {
    /// Time between two samples, s.
    pub(crate) period: f64,
    /// Time stamps, s, of the recording's own.
    pub(crate) time: Vec<f64>,
    /// Positions, speeds, accelerations of each joint.
    pub(crate) q: Vec<Vec<f64>>,
    pub(crate) qd: Vec<Vec<f64>>,
    pub(crate) qdd: Vec<Vec<f64>>,
    /// Torques of each joint within the band.
    pub(crate) torque: Vec<Vec<f64>>,
    /// The filter that the model must go through to be compared with them.
    pub(crate) filter: LowPass,
    /// First sample of the selection, and the one after its last.
    pub(crate) selected: (usize, usize),
}

impl Signals {
    /// Prepares a recording that was found sound.
    pub(crate) fn new(
        robot: &Robot,
        recording: &Recording,
        selection: &Selection,
        budget: &Budget<'_>,
    ) -> Result<Self, Failure> {
        let time = &recording.time;
        let native = median_period(time);
        let band = selection.band;
        let fault = |path: &str, message: String| Failure::Invalid(vec![Invalid::new(path, message)]);
        if native * band * NATIVE_BAND_SAMPLES > 1.0 {
            let message = format!(
                "{band} Hz asks for samples at {} Hz and more, the recording has {:.1} Hz",
                band * NATIVE_BAND_SAMPLES,
                1.0 / native
            );
            return Err(fault("band", message));
        }
        let run = run_of(time, selection)?;
        let time = &time[run.clone()];
        let stride = ((1.0 / (native * band * FIT_BAND_SAMPLES)) as usize).max(1);
        let period = native * stride as f64;
        let smooth = LowPass::new(KINEMATIC_BAND * band, native);
        let even = |series: &[Vec<f64>]| -> Result<Vec<Vec<f64>>, Failure> {
            let mut all = Vec::with_capacity(series.len());
            for values in series {
                budget.check()?;
                let mut even = resample(time, &values[run.clone()], native);
                smooth.apply(&mut even);
                all.push(even);
            }
            Ok(all)
        };
        let thin = |series: &[f64]| -> Vec<f64> { series.iter().copied().step_by(stride).collect() };
        let q = even(&recording.position)?;
        let qd = match &recording.velocity {
            Some(velocity) => even(velocity)?,
            None => q.iter().map(|q| derivative(q, native)).collect(),
        };
        let qdd: Vec<Vec<f64>> = qd.iter().map(|qd| thin(&derivative(qd, native))).collect();
        let filter = LowPass::new(band, period);
        let mut torque: Vec<Vec<f64>> = even(&recording.torque(robot))?.iter().map(|t| thin(t)).collect();
        for torque in &mut torque {
            budget.check()?;
            filter.apply(torque);
        }
        let count = torque.first().map_or(0, Vec::len);
        let start = time[0];
        let times: Vec<f64> = (0..count).map(|k| start + period * k as f64).collect();
        let selected = match selection.range {
            None => (0, count),
            Some((from, to)) => (
                times.partition_point(|t| *t < from),
                times.partition_point(|t| *t <= to),
            ),
        };
        if selected.1 <= selected.0 {
            let (first, last) = (start, time[time.len() - 1]);
            let message = format!("no samples there, the recording goes from {first} s to {last} s");
            return Err(fault("range", message));
        }
        Ok(Self {
            period,
            time: times,
            q: q.iter().map(|q| thin(q)).collect(),
            qd: qd.iter().map(|qd| thin(qd)).collect(),
            qdd,
            torque,
            filter,
            selected,
        })
    }

    /// How many samples are selected.
    pub(crate) fn count(&self) -> usize {
        self.selected.1 - self.selected.0
    }

    /// The selected samples of a series.
    pub(crate) fn of<'a>(&self, series: &'a [f64]) -> &'a [f64] {
        &series[self.selected.0..self.selected.1]
    }
}

/// The samples without a gap around what is selected. What lies behind a gap is another run of the arm: no filter goes across.
fn run_of(time: &[f64], selection: &Selection) -> Result<Range<usize>, Failure> {
    let longest = GAP_BANDS / selection.band;
    let (from, to) = selection.range.unwrap_or((time[0], time[time.len() - 1]));
    let mut run = 0..time.len();
    for (i, pair) in time.windows(2).enumerate() {
        let gap = pair[1] - pair[0];
        if gap <= longest {
            continue;
        }
        if pair[1] <= from {
            run.start = i + 1;
        } else if pair[0] >= to {
            run.end = i + 1;
            break;
        } else {
            let message = format!(
                "a gap of {gap:.3} s, from {} to {} s; {longest:.3} s is the longest in a band of {} Hz: select a part on one side of it \
                 (`identify`, `test`), up to {} s or from {} s",
                pair[0], pair[1], selection.band, pair[0], pair[1]
            );
            return Err(Failure::Invalid(vec![Invalid::new(
                format!("time[{}]", i + 1),
                message,
            )]));
        }
    }
    Ok(run)
}

fn median_period(time: &[f64]) -> f64 {
    let mut periods: Vec<f64> = time.windows(2).map(|pair| pair[1] - pair[0]).collect();
    let middle = periods.len() / 2;
    let (_, median, _) = periods.select_nth_unstable_by(middle, f64::total_cmp);
    *median
}

/// Values at even times from the first stamp on, by straight lines.
fn resample(time: &[f64], values: &[f64], period: f64) -> Vec<f64> {
    let span = time[time.len() - 1] - time[0];
    let count = (span / period) as usize + 1;
    let mut at = 0;
    let even = (0..count).map(|k| {
        let t = time[0] + period * k as f64;
        while at + 2 < time.len() && time[at + 1] <= t {
            at += 1;
        }
        let part = ((t - time[at]) / (time[at + 1] - time[at])).clamp(0.0, 1.0);
        values[at] + part * (values[at + 1] - values[at])
    });
    even.collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::drive::fit::recording::Effort;
    use crate::test_arms::{planar, random, robot};

    /// q = sin(2π·0.7·t), sampled with jittering stamps.
    fn recording(count: usize, state: &mut u64) -> Recording {
        let time: Vec<f64> = (0..count).map(|k| 0.004 * k as f64 + 0.001 * random(state)).collect();
        let row: Vec<f64> = time.iter().map(|t| libm::sin(4.4 * t)).collect();
        Recording {
            position: vec![row.clone(); 2],
            velocity: None,
            effort: Effort::Torque(vec![row; 2]),
            time,
        }
    }

    #[test]
    fn speeds_and_accelerations_of_a_slow_sine_come_back_from_jittering_stamps() {
        let arm = robot(planar());
        let signals = Signals::new(
            &arm,
            &recording(4000, &mut 1),
            &Selection::default(),
            &Budget::unlimited(),
        )
        .unwrap();
        assert!((signals.period - 0.008).abs() < 0.0005);
        for (k, t) in signals.time.iter().enumerate() {
            if *t < 1.0 || *t > 14.0 {
                continue;
            }
            assert!((signals.q[0][k] - libm::sin(4.4 * t)).abs() < 1e-4);
            assert!((signals.qd[1][k] - 4.4 * libm::cos(4.4 * t)).abs() < 5e-3);
            assert!((signals.qdd[0][k] + 4.4 * 4.4 * libm::sin(4.4 * t)).abs() < 0.3);
            assert!((signals.torque[0][k] - libm::sin(4.4 * t)).abs() < 1e-4);
        }
    }

    #[test]
    fn gaps_coarse_stamps_and_empty_ranges_are_named() {
        let arm = robot(planar());
        let fault = |recording: &Recording, selection: Selection| match Signals::new(
            &arm,
            recording,
            &selection,
            &Budget::unlimited(),
        ) {
            Err(Failure::Invalid(faults)) => faults[0].clone(),
            other => panic!("{other:?}"),
        };
        let refused = |recording: &Recording, selection: Selection| fault(recording, selection).path;
        let sound = recording(1000, &mut 2);
        let mut gap = sound.clone();
        gap.time[500..].iter_mut().for_each(|t| *t += 1.0);
        assert_eq!(refused(&gap, Selection::default()), "time[500]");
        let sides = format!("up to {} s or from {} s", gap.time[499], gap.time[500]);
        let said = fault(&gap, Selection::default()).message;
        assert!(said.contains(&sides), "{said}");
        let across = Selection {
            range: Some((1.9, 3.2)),
            ..Selection::default()
        };
        assert_eq!(refused(&gap, across), "time[500]");
        let of_band = |band| Selection { range: None, band };
        assert_eq!(refused(&sound, of_band(60.0)), "band");
        let late = Selection {
            range: Some((100.0, 200.0)),
            ..Selection::default()
        };
        assert_eq!(refused(&sound, late), "range");
    }
    /// What is selected beside a gap is the run of the arm on that side alone, as if the other had not been recorded.
    #[test]
    fn the_runs_on_either_side_of_a_gap_are_apart() {
        let arm = robot(planar());
        let sound = recording(1000, &mut 3);
        let mut gap = sound.clone();
        gap.time[500..].iter_mut().for_each(|t| *t += 1.0);
        gap.position[0][500..].iter_mut().for_each(|q| *q += 3.0);
        let of = |recording: &Recording, from, to| {
            let selection = Selection {
                range: Some((from, to)),
                ..Selection::default()
            };
            Signals::new(&arm, recording, &selection, &Budget::unlimited()).unwrap()
        };
        let mut first = sound;
        first.time.truncate(500);
        let (before, alone) = (of(&gap, 0.0, 1.9), of(&first, 0.0, 1.9));
        assert_eq!(before.q, alone.q);
        assert_eq!(before.selected, alone.selected);
        let after = of(&gap, 3.2, 4.8);
        assert!(after.time[after.selected.0] >= 3.2 && after.time[0] >= gap.time[500]);
        assert!(after.of(&after.q[0]).iter().all(|q| *q > 1.9));
    }
}
