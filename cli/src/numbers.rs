//! Numbers as people type them: lists with commas, angles in degrees, times with units.

use std::{str::FromStr, time::Duration};

/// A joint value as it was typed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum JointValue {
    /// Without a unit: rad or m, or degrees where the command says so.
    Plain(f64),
    /// With `deg` or `°`.
    Degrees(f64),
    /// With `rad`, `m` or `mm`: in SI already.
    Si(f64),
}

impl JointValue {
    /// In rad or m. `in_degrees`: a plain number is degrees.
    pub(crate) fn si(self, in_degrees: bool) -> f64 {
        match self {
            Self::Plain(value) if in_degrees => value.to_radians(),
            Self::Degrees(value) => value.to_radians(),
            Self::Plain(value) | Self::Si(value) => value,
        }
    }
}

impl FromStr for JointValue {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let text = text.trim();
        for (suffix, read) in [
            ("deg", Self::Degrees as fn(f64) -> Self),
            ("°", Self::Degrees),
            ("rad", Self::Si),
            ("mm", |value| Self::Si(value / 1000.0)),
            ("m", Self::Si),
        ] {
            if let Some(number) = text.strip_suffix(suffix) {
                return finite(number).map(read);
            }
        }
        finite(text).map(Self::Plain)
    }
}

/// A part of a whole: `95%` or `0.95`.
pub(crate) fn part(text: &str) -> Result<f64, String> {
    match text.trim().strip_suffix('%') {
        Some(percent) => finite(percent).map(|percent| percent / 100.0),
        None => finite(text),
    }
}

/// Ratios above this are asked for in per cent: friction ten times the model's is no supposition, a forgotten % is likely.
const RATIO_PLAIN_MAX: f64 = 10.0;

/// A ratio: `150%` or `1.5`; a plain 50 is most likely meant as a percentage, and asked for as such.
pub(crate) fn ratio(text: &str) -> Result<f64, String> {
    let ratio = part(text)?;
    match ratio.abs() > RATIO_PLAIN_MAX {
        true if !text.contains('%') => Err(format!(
            "{ratio} is above {RATIO_PLAIN_MAX}: write it as {ratio}% or {}; it is a ratio ({ratio} times is {}%)",
            ratio / 100.0,
            ratio * 100.0
        )),
        _ => Ok(ratio),
    }
}

/// A probability: `95%` or `0.95`; a plain 95 is most likely meant as a percentage, and asked for as such.
pub(crate) fn level(text: &str) -> Result<f64, String> {
    let level = part(text)?;
    match level > 1.0 {
        true if !text.contains('%') => Err(format!("{level} is above 1: write it as {level}% or {}", level / 100.0)),
        _ => Ok(level),
    }
}

fn finite(text: &str) -> Result<f64, String> {
    let text = text.trim();
    let value: f64 = text.parse().map_err(|_| match text {
        "" => "a number is missing".to_owned(),
        _ => format!("{text:?} is no number"),
    })?;
    if value.is_finite() {
        Ok(value)
    } else {
        Err(format!("{text} is not a finite number"))
    }
}

/// Values of all joints: `0, -90deg, 1.57`.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct JointValues(pub(crate) Vec<JointValue>);

impl FromStr for JointValues {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        list(text).map(Self)
    }
}

/// A plain list: `0.1,0,0.05`.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Numbers(pub(crate) Vec<f64>);

impl FromStr for Numbers {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        text.trim_matches(['[', ']', ' '])
            .split(',')
            .map(finite)
            .collect::<Result<_, _>>()
            .map(Self)
    }
}

/// Brackets around and spaces between are forgiven: `[0, 1]` comes from copying.
fn list(text: &str) -> Result<Vec<JointValue>, String> {
    text.trim_matches(['[', ']', ' ']).split(',').map(str::parse).collect()
}

/// A time: `4ms`, `0.5s`, `2min`, or plain seconds.
pub(crate) fn seconds(text: &str) -> Result<f64, String> {
    let text = text.trim();
    // Divided, not multiplied by 0.001: 4ms is then the same double as 0.004.
    for (suffix, factor, divisor) in [
        ("ms", 1.0, 1e3),
        ("us", 1.0, 1e6),
        ("µs", 1.0, 1e6),
        ("min", 60.0, 1.0),
        ("s", 1.0, 1.0),
    ] {
        if let Some(number) = text.strip_suffix(suffix) {
            return Ok(finite(number)? * factor / divisor);
        }
    }
    finite(text)
}

/// A time longer than zero.
pub(crate) fn duration(text: &str) -> Result<Duration, String> {
    let seconds = seconds(text)?;
    match Duration::try_from_secs_f64(seconds) {
        Ok(duration) if !duration.is_zero() => Ok(duration),
        _ => Err("must be longer than zero, as in 500ms, 30s or 2min".to_owned()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn values(text: &str, in_degrees: bool) -> Vec<f64> {
        text.parse::<JointValues>()
            .unwrap()
            .0
            .into_iter()
            .map(|value| value.si(in_degrees))
            .collect()
    }

    #[test]
    fn lists_take_units_spaces_and_brackets() {
        assert_eq!(values("0,-1.5, 2e-1", false), [0.0, -1.5, 0.2]);
        assert_eq!(
            values("[180deg, 90°, 1rad, 5mm, 0.5m]", false),
            [std::f64::consts::PI, std::f64::consts::FRAC_PI_2, 1.0, 0.005, 0.5]
        );
        assert_eq!(values("180,1rad", true), [std::f64::consts::PI, 1.0]);
    }

    #[test]
    fn what_is_no_number_is_refused_by_name() {
        for (text, part) in [
            ("1,,2", "missing"),
            ("1,x", "\"x\""),
            ("nan", "finite"),
            ("inf", "finite"),
            ("", "missing"),
        ] {
            let error = text.parse::<JointValues>().unwrap_err();
            assert!(error.contains(part), "{text}: {error}");
        }
        assert!("1;2".parse::<Numbers>().is_err());
    }

    #[test]
    fn a_level_is_a_percentage_or_a_part() {
        assert_eq!(level("95%"), Ok(0.95));
        assert_eq!(level(" 0.95 "), Ok(0.95));
        assert_eq!(level("95"), Err("95 is above 1: write it as 95% or 0.95".to_owned()));
    }

    #[test]
    fn times_have_units() {
        assert_eq!(seconds("4ms"), Ok(0.004));
        assert_eq!(seconds("250us"), Ok(0.00025));
        assert_eq!(seconds("0.004"), Ok(0.004));
        assert_eq!(duration("2min"), Ok(Duration::from_secs(120)));
        for text in ["0", "-1s", "nan", "1h", "1e30"] {
            assert!(duration(text).is_err(), "{text}");
        }
    }
}
