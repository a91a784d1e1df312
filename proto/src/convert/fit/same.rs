//! Whether two recordings are of the same samples: then what was fitted of one foretells nothing of the other.

use takt_motion::drive::fit::recording::{Effort, Recording};

/// The times that two recordings share, from first to last, where they have the same samples throughout them: they are one
/// recording, or parts cut of one. `None` where any time, position or effort differs, or where there is one moment at most.
pub(super) fn shared(a: &Recording, b: &Recording) -> Option<(f64, f64)> {
    let begin = a.time.first()?.max(*b.time.first()?);
    let end = a.time.last()?.min(*b.time.last()?);
    let within = |recording: &Recording| {
        let from = recording.time.partition_point(|time| *time < begin);
        let to = recording.time.partition_point(|time| *time <= end);
        from..to
    };
    let (of_a, of_b) = (within(a), within(b));
    let is_same = |a: &[f64], b: &[f64]| match (a.get(of_a.clone()), b.get(of_b.clone())) {
        (Some(a), Some(b)) => a
            .iter()
            .map(|value| value.to_bits())
            .eq(b.iter().map(|value| value.to_bits())),
        // Times out of order, which is a finding of their own.
        _ => false,
    };
    let all_same = |a: &[Vec<f64>], b: &[Vec<f64>]| a.len() == b.len() && a.iter().zip(b).all(|(a, b)| is_same(a, b));
    let has_same_effort = match (&a.effort, &b.effort) {
        (Effort::Torque(a), Effort::Torque(b)) | (Effort::Current(a), Effort::Current(b)) => all_same(a, b),
        (Effort::Torque(_), Effort::Current(_)) | (Effort::Current(_), Effort::Torque(_)) => false,
    };
    let is_one = begin < end && is_same(&a.time, &b.time) && has_same_effort && all_same(&a.position, &b.position);
    is_one.then_some((begin, end))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn recording(times: std::ops::Range<u32>) -> Recording {
        let time: Vec<f64> = times.map(|index| 0.01 * f64::from(index)).collect();
        let of = |rate: f64| time.iter().map(|time| (rate * time).sin()).collect::<Vec<f64>>();
        Recording {
            position: vec![of(1.0), of(2.0)],
            velocity: None,
            effort: Effort::Torque(vec![of(3.0), of(4.0)]),
            time,
        }
    }

    #[test]
    fn a_recording_and_what_is_cut_of_it_are_one() {
        let whole = recording(0..300);
        assert_eq!(shared(&whole, &whole), Some((0.0, whole.time[299])));
        let cut = recording(100..200);
        assert_eq!(shared(&whole, &cut), Some((whole.time[100], whole.time[199])));
        assert_eq!(shared(&cut, &recording(200..300)), None, "apart");
        assert_eq!(shared(&cut, &recording(199..300)), None, "one moment");
    }

    #[test]
    fn one_value_that_differs_makes_two() {
        let whole = recording(0..300);
        let mut other = whole.clone();
        other.position[1][17] += 1e-12;
        assert_eq!(shared(&whole, &other), None);
        let mut other = whole.clone();
        let Effort::Torque(torque) = other.effort else { return };
        other.effort = Effort::Current(torque);
        assert_eq!(shared(&whole, &other), None);
        let mut other = whole.clone();
        other.time[17] += 1e-9;
        assert_eq!(shared(&whole, &other), None);
    }

    #[test]
    fn times_out_of_order_and_missing_values_do_not_matter() {
        let whole = recording(0..300);
        let mut other = recording(0..300);
        other.time.reverse();
        assert_eq!(shared(&whole, &other), None);
        other.time.clear();
        assert_eq!(shared(&whole, &other), None);
        let mut short = recording(0..300);
        short.position[0].truncate(20);
        assert_eq!(shared(&whole, &short), None);
    }
}
