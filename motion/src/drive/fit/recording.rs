//! A motion as it was recorded, and what can be wrong with it.

use crate::drive::fit::report::BAND_DEFAULT;
use crate::error::Invalid;
use crate::robot::Robot;
use crate::tolerance::{
    FIT_BAND_MAX, FIT_BAND_MIN, FIT_SAMPLES_MAX, FIT_VALUE_MAX, RANGE_SLACK, REST_SPEED, STANDSTILL_PART,
    STANDSTILL_WINDOW,
};

/// What the drives did over some time: joints in model order, one value a sample in each of them.
#[derive(Debug, Clone, PartialEq)]
pub struct Recording {
    /// Time stamps, s: increasing, not necessarily evenly.
    pub time: Vec<f64>,
    /// Positions of each joint, rad or m.
    pub position: Vec<Vec<f64>>,
    /// Speeds of each joint, rad/s or m/s; `None`: they are taken from the positions. Where the controller measured them they are the better
    /// ones: time stamps of a log jitter.
    pub velocity: Option<Vec<Vec<f64>>>,
    /// What drove the joints.
    pub effort: Effort,
}

/// What drove the joints: one row a joint, one value a sample.
#[derive(Debug, Clone, PartialEq)]
pub enum Effort {
    /// Torque at the joint in the direction of driving, N m or N.
    Torque(Vec<Vec<f64>>),
    /// Motor current, A: times torque constant and gear ratio it is the torque at the joint.
    Current(Vec<Vec<f64>>),
}

/// Which part of a recording, and in which band.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Selection {
    /// First and last time, s, of the recording's own; `None`: all of it.
    pub range: Option<(f64, f64)>,
    /// Corner of the low-pass filter that torque and model both go through, Hz.
    pub band: f64,
}

impl Default for Selection {
    fn default() -> Self {
        Self {
            range: None,
            band: BAND_DEFAULT,
        }
    }
}

/// Whether a number is one that can be computed with.
pub(crate) fn is_value(value: f64) -> bool {
    value.abs() <= FIT_VALUE_MAX
}

/// Whether a pair of times is in order.
pub(crate) fn increases(pair: &[f64]) -> bool {
    pair[0] < pair[1]
}

/// All that is wrong with a recording of an arm.
pub(crate) fn check(robot: &Robot, recording: &Recording, selection: &Selection) -> Vec<Invalid> {
    let mut faults = Vec::new();
    let count = recording.time.len();
    if count < 2 {
        faults.push(Invalid::new(
            "time",
            format!("{count} samples are too few to be a motion"),
        ));
    }
    if count > FIT_SAMPLES_MAX {
        faults.push(Invalid::new(
            "time",
            format!("{count} samples, the most is {FIT_SAMPLES_MAX}"),
        ));
    }
    if let Some((i, others)) = faulty(recording.time.iter(), |t| is_value(**t)) {
        let message = format!("{} is no time stamp{others}", recording.time[i]);
        faults.push(Invalid::new(format!("time[{i}]"), message));
    }
    if let Some((i, others)) = faulty(recording.time.windows(2), |pair| increases(pair)) {
        let (before, after) = (recording.time[i], recording.time[i + 1]);
        let message = format!("{after} s must be after {before} s, the sample before{others}");
        faults.push(Invalid::new(format!("time[{}]", i + 1), message));
    }
    check_series(robot, "position", &recording.position, count, &mut faults);
    if let Some(velocity) = &recording.velocity {
        check_series(robot, "velocity", velocity, count, &mut faults);
    }
    match &recording.effort {
        Effort::Torque(torque) => check_series(robot, "torque", torque, count, &mut faults),
        Effort::Current(current) => {
            check_series(robot, "current", current, count, &mut faults);
            for joint in &robot.spec().joints {
                if joint.drive.torque_constant.is_none() {
                    let message = format!(
                        "joint \"{}\" has no torque constant to make a torque of it: state its `drive.torque_constant_nm_per_a` in the description",
                        joint.name
                    );
                    faults.push(Invalid::new("current", message));
                }
            }
        }
    }
    let band = selection.band;
    if !(FIT_BAND_MIN..=FIT_BAND_MAX).contains(&band) {
        let message = format!("{band} Hz must be between {FIT_BAND_MIN} and {FIT_BAND_MAX} Hz");
        faults.push(Invalid::new("band", message));
    }
    if let Some((from, to)) = selection.range
        && !(from.is_finite() && to.is_finite() && from < to)
    {
        faults.push(Invalid::new("range", format!("from {from} s to {to} s is no time")));
    }
    faults
}

/// The place of the first entry that is not sound, and what to say of how many there are.
fn faulty<T>(entries: impl Iterator<Item = T> + Clone, is_sound: impl Fn(&T) -> bool) -> Option<(usize, String)> {
    let first = entries.clone().position(|entry| !is_sound(&entry))?;
    let others = match entries.filter(|entry| !is_sound(entry)).count() {
        1 => String::new(),
        count => format!("; the first of {count} places"),
    };
    Some((first, others))
}

fn check_series(robot: &Robot, name: &str, series: &[Vec<f64>], count: usize, faults: &mut Vec<Invalid>) {
    if series.len() != robot.joint_count() {
        let message = format!("{} joints, the arm has {}", series.len(), robot.joint_count());
        faults.push(Invalid::new(name, message));
    }
    for (j, values) in series.iter().enumerate() {
        if values.len() != count {
            let message = format!("{} values for {count} time stamps", values.len());
            faults.push(Invalid::new(format!("{name}[{j}]"), message));
        }
        if let Some((i, others)) = faulty(values.iter(), |value| is_value(**value)) {
            let message = format!("{} must be a number up to {FIT_VALUE_MAX:e}{others}", values[i]);
            faults.push(Invalid::new(format!("{name}[{j}][{i}]"), message));
        }
    }
}

impl Selection {
    /// What a part has in common with another one, from its first to its last time; `None` where they are apart.
    #[must_use]
    pub fn overlap(&self, other: &Self) -> Option<(f64, f64)> {
        let all = (f64::NEG_INFINITY, f64::INFINITY);
        let (a, b) = (self.range.unwrap_or(all), other.range.unwrap_or(all));
        let common = (a.0.max(b.0), a.1.min(b.1));
        (common.0 < common.1).then_some(common)
    }
}

impl Recording {
    /// What is wrong with another recording beside this one: together they have more samples than one may have.
    #[must_use]
    pub fn too_long_with(&self, other: &Self) -> Option<String> {
        let (fitted, compared) = (self.time.len(), other.time.len());
        (fitted.saturating_add(compared) > FIT_SAMPLES_MAX).then(|| {
            format!(
                "{compared} samples, with the {fitted} of the recording that is fitted the most is {FIT_SAMPLES_MAX}: cut one of them"
            )
        })
    }

    /// Whether both have torques, or both currents.
    #[must_use]
    pub fn has_the_effort_of(&self, other: &Self) -> bool {
        matches!(
            (&self.effort, &other.effort),
            (Effort::Torque(_), Effort::Torque(_)) | (Effort::Current(_), Effort::Current(_))
        )
    }

    /// What a part that is asked for has more than the recording, in a sentence; `name` is that of the part.
    #[must_use]
    pub fn shortfall(&self, selection: &Selection, name: &str) -> Option<String> {
        let (from, to) = selection.range?;
        let (first, last) = (*self.time.first()?, *self.time.last()?);
        let slack = RANGE_SLACK * (last - first) / (self.time.len() - 1).max(1) as f64;
        (from < first - slack || to > last + slack).then(|| {
            format!(
                "{name}: {} to {} s is used of the {from} to {to} s that were asked for, the recording has no more",
                from.max(first),
                to.min(last)
            )
        })
    }

    /// Where the arm stands still at the ends of a part for long, in a sentence; `name` is that of the part. A torque at rest is anything within friction:
    /// it is an error that no model is to blame for.
    #[must_use]
    pub fn standstill(&self, selection: &Selection, name: &str) -> Option<String> {
        let (from, to) = selection.range.unwrap_or((f64::NEG_INFINITY, f64::INFINITY));
        let begin = self.time.partition_point(|time| *time < from);
        let end = self.time.partition_point(|time| *time <= to);
        let time = self.time.get(begin..end).filter(|time| time.len() > 1)?;
        let (first, last) = (time[0], time[time.len() - 1]);
        let (mut sets_out, mut arrives) = (None, first);
        let mut before = 0;
        for now in 1..time.len() {
            let seconds = time[now] - time[before];
            if seconds < STANDSTILL_WINDOW {
                continue;
            }
            let is_moving = |q: &Vec<f64>| (q[begin + now] - q[begin + before]).abs() > REST_SPEED * seconds;
            if self.position.iter().any(is_moving) {
                sets_out = sets_out.or(Some(time[before]));
                arrives = time[now];
            }
            before = now;
        }
        let sets_out = sets_out?;
        let still = (sets_out - first) + (last - arrives);
        (still > STANDSTILL_PART * (last - first)).then(|| {
            format!(
                "{name}: the arm stands still for {still:.1} of these {:.1} s, where torques may be anything within friction: it moves from \
                 {sets_out:.1} to {arrives:.1} s",
                last - first
            )
        })
    }

    /// Torques at the joints, N m or N; the arm must have its torque constants where currents were recorded.
    pub(crate) fn torque(&self, robot: &Robot) -> Vec<Vec<f64>> {
        match &self.effort {
            Effort::Torque(torque) => torque.clone(),
            Effort::Current(current) => {
                let drives = robot.spec().joints.iter().map(|joint| &joint.drive);
                let scaled = current.iter().zip(drives).map(|(current, drive)| {
                    let factor = drive.torque_constant.unwrap_or(0.0) * drive.gear_ratio;
                    current.iter().map(|i| i * factor).collect()
                });
                scaled.collect()
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn part(range: Option<(f64, f64)>) -> Selection {
        Selection {
            range,
            ..Selection::default()
        }
    }

    #[test]
    fn parts_overlap_where_they_share_more_than_a_moment() {
        let identify = part(Some((0.0, 8.0)));
        assert_eq!(identify.overlap(&part(Some((8.0, 12.0)))), None, "they may touch");
        assert_eq!(identify.overlap(&part(Some((7.5, 12.0)))), Some((7.5, 8.0)));
        let test = part(Some((8.5, 12.0)));
        assert_eq!(part(None).overlap(&test), Some((8.5, 12.0)), "all of it is fitted");
    }

    #[test]
    fn two_recordings_together_are_as_long_as_one_may_be() {
        let of = |count: usize| Recording {
            time: vec![0.0; count],
            position: Vec::new(),
            velocity: None,
            effort: Effort::Torque(Vec::new()),
        };
        let (fitted, rest) = (of(10), FIT_SAMPLES_MAX - 10);
        assert_eq!(fitted.too_long_with(&of(rest)), None);
        let said = fitted.too_long_with(&of(rest + 1)).unwrap();
        assert!(said.contains("999991 samples, with the 10 of"), "{said}");
    }

    #[test]
    fn many_faults_of_a_series_are_one_with_their_count() {
        let entries = [0.0, 2.0, 3.0, 2.5];
        let said = |most: f64| faulty(entries.iter(), |value| **value <= most);
        assert_eq!(said(3.0), None);
        assert_eq!(said(2.5), Some((2, String::new())));
        assert_eq!(said(1.0), Some((1, "; the first of 3 places".to_owned())));
    }

    /// Two seconds of rest, 4.7 of motion with a rest in it, which is the motion's own, and rest again; encoders tremble.
    #[test]
    fn an_arm_that_stands_still_at_the_ends_of_a_part_is_said() {
        let time: Vec<f64> = (0..9000).map(|k| 1e-3 * f64::from(k)).collect();
        let position = |t: &f64| {
            let moved = (t - 2.0).clamp(0.0, 6.0);
            0.3 * libm::sin(2.0 * moved).max(0.0) + 1e-4 * libm::sin(1e4 * t)
        };
        let recording = Recording {
            position: vec![vec![0.4; 9000], time.iter().map(position).collect()],
            time,
            velocity: None,
            effort: Effort::Torque(Vec::new()),
        };
        let said = |range| recording.standstill(&part(range), "test");
        let whole = said(None).unwrap();
        assert!(
            whole.starts_with("test: the arm stands still for 4.2 of these 9.0 s"),
            "{whole}"
        );
        assert!(whole.ends_with("it moves from 1.9 to 6.8 s"), "{whole}");
        assert_eq!(said(Some((2.0, 6.7))), None);
        assert_eq!(
            said(Some((0.0, 1.5))),
            None,
            "what never moves is told by what is missing"
        );
    }

    #[test]
    fn a_part_that_the_recording_does_not_have_is_said() {
        let recording = Recording {
            time: (0..1000).map(|k| 1e-3 * f64::from(k)).collect(),
            position: Vec::new(),
            velocity: None,
            effort: Effort::Torque(Vec::new()),
        };
        let said = |from, to| recording.shortfall(&part(Some((from, to))), "test");
        assert_eq!(said(0.0, 1.0), None, "the last sample begins a period that ends at 1 s");
        assert_eq!(recording.shortfall(&part(None), "test"), None);
        let said = said(0.5, 1.5).unwrap();
        assert!(said.starts_with("test: 0.5 to 0.999 s is used"), "{said}");
    }
}
