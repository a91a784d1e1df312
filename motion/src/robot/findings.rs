//! What reading a description brings to light: errors that refuse it, warnings that stay with it.

use std::fmt::{self, Write as _};

use nalgebra::{Matrix3, Vector3};

use super::bounds::{Bound, MAX_FINDINGS, MAX_LISTED_NAMES, MAX_NAME_BYTES};
use crate::error::Invalid;

/// Errors and warnings in the order of their discovery, capped so that a hostile input cannot write a long answer.
#[derive(Debug, Default)]
pub(crate) struct Findings {
    errors: Vec<Invalid>,
    further_errors: usize,
    warnings: Vec<String>,
    further_warnings: usize,
}

impl Findings {
    pub(crate) fn error(&mut self, path: impl Into<String>, message: impl Into<String>) {
        if self.errors.len() == MAX_FINDINGS {
            self.further_errors += 1;
            return;
        }
        self.errors.push(Invalid::new(path, message));
    }

    pub(crate) fn warn(&mut self, message: impl Into<String>) {
        if self.warnings.len() == MAX_FINDINGS {
            self.further_warnings += 1;
            return;
        }
        self.warnings.push(message.into());
    }

    /// Notes a value outside its bound.
    pub(crate) fn check(&mut self, path: impl Into<String>, value: f64, bound: &Bound) {
        if let Some(fault) = bound.fault(value) {
            self.error(path, fault);
        }
    }

    pub(crate) fn check_some(&mut self, path: impl Into<String>, value: Option<f64>, bound: &Bound) {
        if let Some(value) = value {
            self.check(path, value, bound);
        }
    }

    /// Notes the entries of a vector outside their bound.
    pub(crate) fn check_vector(&mut self, path: &str, vector: &Vector3<f64>, bound: &Bound) {
        for (index, value) in vector.iter().enumerate() {
            self.check(format!("{path}[{index}]"), *value, bound);
        }
    }

    /// Notes the entries of an inertia tensor outside their bound, counted as on the wire: xx yy zz xy xz yz.
    pub(crate) fn check_tensor(&mut self, path: &str, m: &Matrix3<f64>, bound: &Bound) {
        let entries = [m.m11, m.m22, m.m33, m.m12, m.m13, m.m23];
        for (index, value) in entries.into_iter().enumerate() {
            self.check(format!("{path}[{index}]"), value, bound);
        }
        let is_finite = m.iter().all(|entry| entry.is_finite());
        if is_finite && (m.m12 != m.m21 || m.m13 != m.m31 || m.m23 != m.m32) {
            self.error(path, "must be symmetric");
        }
    }

    /// Notes an empty or overlong name.
    pub(crate) fn check_name(&mut self, path: impl Into<String>, name: &str) {
        if name.is_empty() {
            self.error(path, "must not be empty");
        } else if name.len() > MAX_NAME_BYTES {
            self.error(path, format!("{} bytes must be at most {MAX_NAME_BYTES}", name.len()));
        }
    }

    pub(crate) fn has_errors(&self) -> bool {
        !self.errors.is_empty()
    }

    /// Takes over what another reading found.
    pub(crate) fn extend_errors(&mut self, errors: Vec<Invalid>) {
        for error in errors {
            self.error(error.path, error.message);
        }
    }

    /// The value and its warnings, or the errors.
    pub(crate) fn finish<T>(mut self, value: Option<T>) -> Result<(T, Vec<String>), Vec<Invalid>> {
        if self.further_errors > 0 {
            let message = format!("{} further errors are not listed", self.further_errors);
            self.errors.push(Invalid::new("", message));
        }
        if self.further_warnings > 0 {
            self.warnings
                .push(format!("{} further warnings are not listed", self.further_warnings));
        }
        match value {
            Some(value) if self.errors.is_empty() => Ok((value, self.warnings)),
            _ => {
                debug_assert!(!self.errors.is_empty(), "nothing was read, and nothing says why");
                Err(self.errors)
            }
        }
    }
}

/// Text of a caller as a message quotes it: in quotation marks, shortened.
pub(crate) fn quoted(text: &str) -> Quoted<'_> {
    Quoted(text)
}

/// See [`quoted`].
pub(crate) struct Quoted<'a>(&'a str);

/// Characters of a caller's text that a message repeats.
const QUOTED_CHARS: usize = 80;

impl fmt::Display for Quoted<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_char('"')?;
        for (count, c) in self.0.chars().enumerate() {
            if count == QUOTED_CHARS {
                f.write_char('…')?;
                break;
            }
            f.write_char(if c.is_control() { ' ' } else { c })?;
        }
        f.write_char('"')
    }
}

/// Names as a message lists them: quoted, comma-separated, the first few.
pub(crate) fn listed<'a>(names: impl IntoIterator<Item = &'a str>) -> String {
    let mut list = String::new();
    let mut further = 0_usize;
    for (count, name) in names.into_iter().enumerate() {
        if count >= MAX_LISTED_NAMES {
            further += 1;
            continue;
        }
        let separator = if count == 0 { "" } else { ", " };
        // Writing to a string cannot fail.
        let _ = write!(list, "{separator}{}", quoted(name));
    }
    if further > 0 {
        let _ = write!(list, " and {further} more");
    }
    list
}
