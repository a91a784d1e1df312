//! Axes: round ticks, ranges, and curves thinned to what can be seen.

/// A range of values shown over a range of the picture.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Axis {
    pub(crate) low: f64,
    pub(crate) high: f64,
}

impl Axis {
    /// The range of all values, widened where it would be empty; values that are not finite do not count.
    pub(crate) fn around(values: impl IntoIterator<Item = f64>) -> Self {
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        for value in values.into_iter().filter(|value| value.is_finite()) {
            low = low.min(value);
            high = high.max(value);
        }
        if low > high {
            return Self { low: 0.0, high: 1.0 };
        }
        if high - low > f64::EPSILON * high.abs().max(low.abs()) {
            Self { low, high }
        } else {
            let room = if low == 0.0 { 1.0 } else { low.abs() / 2.0 };
            Self {
                low: low - room,
                high: high + room,
            }
        }
    }

    /// Room at both ends, as a part of the range.
    pub(crate) fn padded(self, part: f64) -> Self {
        let room = part * (self.high - self.low);
        Self {
            low: self.low - room,
            high: self.high + room,
        }
    }

    /// Where a value lies: 0 at the low end, 1 at the high end.
    pub(crate) fn part(self, value: f64) -> f64 {
        (value - self.low) / (self.high - self.low)
    }

    /// Round values within the range, about so many, as text too.
    pub(crate) fn ticks(self, count: u32) -> Vec<(f64, String)> {
        let rough = (self.high - self.low) / f64::from(count.max(1));
        if !(rough.is_finite() && rough > 0.0) {
            return Vec::new();
        }
        let power = 10_f64.powf(rough.log10().floor());
        let step = power
            * [1.0, 2.0, 5.0, 10.0]
                .into_iter()
                .find(|factor| factor * power >= rough)
                .unwrap_or(10.0);
        #[allow(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "clamped to a handful of decimals"
        )]
        let decimals = (-step.log10().floor()).clamp(0.0, 9.0) as usize;
        let first = (self.low / step).ceil();
        (0..=2 * count)
            .map(|index| (first + f64::from(index)) * step)
            .take_while(|value| *value <= self.high + 1e-9 * step)
            .map(|value| (value, super::table::fixed(value, decimals)))
            .collect()
    }
}

/// A curve thinned to at most two points a column of the picture, the lowest and the highest there: peaks stay.
pub(crate) fn thinned(time: &[f64], values: &[f64], columns: usize) -> Vec<(f64, f64)> {
    let all = time
        .iter()
        .copied()
        .zip(values.iter().copied())
        .filter(|(t, value)| t.is_finite() && value.is_finite());
    let all: Vec<(f64, f64)> = all.collect();
    if all.len() <= 2 * columns.max(1) {
        return all;
    }
    let chunk = all.len().div_ceil(columns.max(1));
    let mut out = Vec::with_capacity(2 * columns + 2);
    for part in all.chunks(chunk) {
        let low = part.iter().enumerate().min_by(|a, b| a.1.1.total_cmp(&b.1.1));
        let high = part.iter().enumerate().max_by(|a, b| a.1.1.total_cmp(&b.1.1));
        if let (Some((low, a)), Some((high, b))) = (low, high) {
            out.extend(if low < high { [*a, *b] } else { [*b, *a] });
        }
    }
    out.extend(all.last());
    out.dedup();
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_are_round_and_inside() {
        let texts = |low, high| {
            Axis { low, high }
                .ticks(5)
                .into_iter()
                .map(|(_, text)| text)
                .collect::<Vec<_>>()
        };
        assert_eq!(texts(0.0, 1.05), ["0.0", "0.5", "1.0"]);
        assert_eq!(texts(-150.0, 150.0), ["-100", "0", "100"]);
        assert_eq!(texts(0.0, 0.012), ["0.000", "0.005", "0.010"]);
        assert!(texts(f64::NAN, 1.0).is_empty());
        assert!(texts(1.0, 1.0).is_empty());
    }

    #[test]
    fn ranges_are_never_empty() {
        for values in [
            vec![],
            vec![0.0, 0.0],
            vec![3.0],
            vec![f64::NAN, f64::INFINITY],
            vec![-2.0, -2.0],
        ] {
            let axis = Axis::around(values.clone());
            assert!(axis.high > axis.low, "{values:?}");
        }
    }

    #[test]
    fn thinning_keeps_ends_and_peaks() {
        let time: Vec<f64> = (0..10_000).map(f64::from).collect();
        let mut values = vec![0.0; 10_000];
        values[6_789] = 9.0;
        let thin = thinned(&time, &values, 100);
        assert!(thin.len() <= 202);
        assert!(thin.contains(&(6_789.0, 9.0)));
        assert_eq!(thin.first(), Some(&(0.0, 0.0)));
        assert_eq!(thin.last(), Some(&(9_999.0, 0.0)));
        assert!(thin.windows(2).all(|pair| pair[0].0 <= pair[1].0));
    }
}
