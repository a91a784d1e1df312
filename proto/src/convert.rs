//! Wire ↔ domain, and nowhere else. Every number that comes in is checked finite here, and every finding has the path
//! of its field. A conversion collects all that is wrong and not just the first.

pub mod confidence;
pub mod drive;
pub mod dynamics;
pub mod fit;
pub mod path;
pub mod plan;
pub mod rehearse;
pub mod robot;
pub mod stream;

use std::{fmt, ops::RangeInclusive};

use takt_motion::{Invalid, nalgebra};

/// A count or an index as the wire has it; what it counts is far fewer than the largest.
fn count_to_wire(count: usize) -> u32 {
    u32::try_from(count).unwrap_or(u32::MAX)
}

/// Where in a message: a chain of borrowed steps that costs nothing until it is printed.
#[derive(Debug, Clone, Copy)]
pub enum Path<'a> {
    /// The message itself.
    Root,
    /// A field of a message.
    Field(&'a Self, &'static str),
    /// An entry of a list.
    Index(&'a Self, usize),
}

impl<'a> Path<'a> {
    /// A field below this place.
    #[must_use]
    pub fn field(&'a self, name: &'static str) -> Self {
        Self::Field(self, name)
    }

    /// An entry of the list at this place.
    #[must_use]
    pub fn index(&'a self, index: usize) -> Self {
        Self::Index(self, index)
    }
}

impl fmt::Display for Path<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Path::Root => Ok(()),
            Path::Field(Path::Root, name) => f.write_str(name),
            Path::Field(parent, name) => write!(f, "{parent}.{name}"),
            Path::Index(parent, index) => write!(f, "{parent}[{index}]"),
        }
    }
}

/// How many findings are kept; the rest is counted.
const KEPT: usize = 64;

/// What is wrong with a request.
#[derive(Debug, Default)]
pub struct Findings {
    found: Vec<Invalid>,
    dropped: usize,
}

impl Findings {
    /// Notes what is wrong at a place.
    pub fn push(&mut self, path: Path<'_>, message: impl Into<String>) {
        self.push_invalid(Invalid::new(path.to_string(), message));
    }

    /// Notes a finding that has its path already.
    pub fn push_invalid(&mut self, invalid: Invalid) {
        if self.found.len() < KEPT {
            self.found.push(invalid);
        } else {
            self.dropped += 1;
        }
    }

    /// Adds what a second look found, but for places where something is known to be wrong already.
    pub fn extend(&mut self, second: Vec<Invalid>) {
        let known_count = self.found.len();
        for invalid in second {
            let known = &self.found[..known_count];
            if !known.iter().any(|known| known.path == invalid.path) {
                self.push_invalid(invalid);
            }
        }
    }

    /// Whether nothing is wrong.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.found.is_empty()
    }

    /// The value, if nothing is wrong.
    ///
    /// # Errors
    /// All findings, if there are any.
    pub fn finish<T>(self, value: T) -> Result<T, Vec<Invalid>> {
        if self.is_empty() {
            return Ok(value);
        }
        Err(self.into_list())
    }

    /// All findings.
    #[must_use]
    pub fn into_list(mut self) -> Vec<Invalid> {
        if self.dropped > 0 {
            self.found
                .push(Invalid::new("", format!("{} more findings", self.dropped)));
        }
        self.found
    }

    /// Checks one number finite. Returns 0 in place of another.
    pub fn finite(&mut self, path: Path<'_>, value: f64) -> f64 {
        if value.is_finite() {
            return value;
        }
        if self.found.len() < KEPT {
            self.push(path, format!("{value} is not a finite number"));
        } else {
            self.dropped += 1;
        }
        0.0
    }

    /// Checks an optional number finite. Another is as good as absent: nothing more is said of it.
    pub fn finite_option(&mut self, path: Path<'_>, value: Option<f64>) -> Option<f64> {
        let value = value?;
        self.finite(path, value);
        value.is_finite().then_some(value)
    }

    /// Checks every number of a list finite.
    pub fn finite_list(&mut self, path: Path<'_>, values: &[f64]) {
        for (index, &value) in values.iter().enumerate() {
            self.finite(path.index(index), value);
        }
    }

    /// Checks every number of a measured series finite: one finding with their count, at the first. A sensor that fails leaves
    /// thousands, which would crowd out every other finding.
    pub fn finite_series(&mut self, path: Path<'_>, values: &[f64]) {
        let Some(first) = values.iter().position(|value| !value.is_finite()) else {
            return;
        };
        let count = values.iter().filter(|value| !value.is_finite()).count();
        if count == 1 {
            self.finite(path.index(first), values[first]);
            return;
        }
        let message = format!("{} is not a finite number; the first of {count} places", values[first]);
        self.push(path.index(first), message);
    }

    /// A list of joint values: finite, one a joint where the count is known.
    pub fn joint_values(&mut self, path: Path<'_>, values: &[f64], joint_count: Option<usize>) {
        self.finite_list(path, values);
        if let Some(count) = joint_count
            && values.len() != count
        {
            let found = values.len();
            self.push(path, format!("has {found} values, the robot has {count} joints"));
        }
    }

    /// A list of exactly `N` finite numbers; empty, or something else: `None`.
    pub fn array<const N: usize>(&mut self, path: Path<'_>, values: &[f64]) -> Option<[f64; N]> {
        if values.is_empty() {
            return None;
        }
        self.finite_list(path, values);
        let Ok(array) = <[f64; N]>::try_from(values) else {
            self.push(path, format!("has {} values instead of {N}", values.len()));
            return None;
        };
        array.iter().all(|value| value.is_finite()).then_some(array)
    }

    /// Three finite numbers; empty: `None`.
    pub fn vector(&mut self, path: Path<'_>, values: &[f64]) -> Option<nalgebra::Vector3<f64>> {
        self.array::<3>(path, values).map(Into::into)
    }

    /// A number of an enum: known and specified. The names go into the message.
    pub fn enumerated<E: TryFrom<i32>>(&mut self, path: Path<'_>, value: i32, names: &'static str) -> Option<E> {
        if value == 0 {
            self.push(path, format!("must be one of {names}"));
            return None;
        }
        let Ok(known) = E::try_from(value) else {
            self.push(path, format!("{value} is not one of {names}"));
            return None;
        };
        Some(known)
    }

    /// A part of a whole, above 0 up to 1; absent: 1.
    pub fn fraction(&mut self, path: Path<'_>, value: Option<f64>) -> f64 {
        let Some(value) = value else { return 1.0 };
        self.within(path, value, SMALLEST..=1.0, "")
    }

    /// A number above 0 that can be computed with; absent: `None`.
    pub fn positive_option(&mut self, path: Path<'_>, value: Option<f64>, unit: &str) -> Option<f64> {
        value.map(|value| self.within(path, value, SMALLEST..=LARGEST, unit))
    }

    /// A finite number within a range.
    pub fn within(&mut self, path: Path<'_>, value: f64, range: RangeInclusive<f64>, unit: &str) -> f64 {
        if value.is_finite() && !range.contains(&value) {
            let (least, most) = (range.start(), range.end());
            let message = format!("{value}{unit} must be at least {least}{unit} and at most {most}{unit}");
            self.push(path, message);
        }
        self.finite(path, value)
    }

    /// Finite numbers, each at most so large either way.
    pub fn at_most(&mut self, path: Path<'_>, values: &[f64], most: f64) {
        for (index, &value) in values.iter().enumerate() {
            if value.is_finite() && value.abs() > most && self.found.len() < KEPT {
                let message = format!("{value} must be at most {most} either way");
                self.push(path.index(index), message);
            }
        }
    }
}

/// Smallest positive number that a request may state: squares of smaller ones leave what can be computed with. The
/// model's own limits begin here too.
const SMALLEST: f64 = 1e-9;

/// Largest limit or time that a request may state, where the model has none.
const LARGEST: f64 = 1e12;

/// A caller's text for a message: quoted, and cut where it is long.
#[must_use]
pub fn quoted(text: &str) -> String {
    const LONGEST: usize = 64;
    match text.char_indices().nth(LONGEST) {
        Some((end, _)) => format!("{:?}…", &text[..end]),
        None => format!("{text:?}"),
    }
}

/// "the robot has no joint "elbo"; it has "elbow", …": a name that is not among those of a robot.
pub(crate) fn unknown<'a>(kind: &str, name: &str, known: impl Iterator<Item = &'a str>) -> String {
    const LISTED: usize = 12;
    let mut known: Vec<String> = known.take(LISTED + 1).map(quoted).collect();
    if known.len() > LISTED {
        known[LISTED] = "…".to_owned();
    }
    let known = match known.is_empty() {
        true => "none".to_owned(),
        false => known.join(", "),
    };
    format!("the robot has no {kind} {}; it has {known}", quoted(name))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_unknown_name_is_answered_with_the_known_ones() {
        let many: Vec<String> = (0..20).map(|i| format!("j{i}")).collect();
        let text = unknown("joint", "elbo", many.iter().map(String::as_str));
        assert!(
            text.starts_with(r#"the robot has no joint "elbo"; it has "j0", "j1""#),
            "{text}"
        );
        assert!(text.ends_with(r#""j11", …"#), "{text}");
        assert_eq!(
            unknown("frame", "a", std::iter::empty()),
            r#"the robot has no frame "a"; it has none"#
        );
    }

    #[test]
    fn paths_print_as_field_paths() {
        let joints = Path::Root.field("joints");
        let joint = joints.index(2);
        assert_eq!(joint.field("drive").to_string(), "joints[2].drive");
    }

    #[test]
    fn findings_beyond_the_kept_ones_are_counted() {
        let mut findings = Findings::default();
        findings.finite_list(Path::Root.field("q"), &[f64::NAN; 100]);
        let list = findings.into_list();
        assert_eq!(list.len(), KEPT + 1);
        assert_eq!(list[3].path, "q[3]");
        assert_eq!(list[KEPT].message, "36 more findings");
    }

    #[test]
    fn long_text_is_cut() {
        assert_eq!(quoted("ab\n"), "\"ab\\n\"");
        assert!(quoted(&"é".repeat(100)).ends_with("\"…"));
    }
}
