//! Requests in the query of a URL.

use std::str::FromStr;

use takt_motion::Invalid;
use takt_proto::convert::quoted;

use crate::error::ServiceError;

/// The parameters of a query, taken out one by one; what is left over is a violation.
#[derive(Debug)]
pub(super) struct Query {
    pairs: Vec<(String, String)>,
    violations: Vec<Invalid>,
}

impl Query {
    pub(super) fn of(uri: &http::Uri) -> Self {
        let query = uri.query().unwrap_or("");
        let pairs = query.split('&').filter(|pair| !pair.is_empty());
        let pairs = pairs.map(|pair| {
            let (name, value) = pair.split_once('=').unwrap_or((pair, ""));
            (decoded(name), decoded(value))
        });
        Self {
            pairs: pairs.collect(),
            violations: Vec::new(),
        }
    }

    /// A parameter by either of its names, in snake or camel case.
    pub(super) fn text(&mut self, name: &str) -> Option<String> {
        let mut found = None;
        let camel = camel(name);
        self.pairs.retain_mut(|(key, value)| {
            if key != name && *key != camel {
                return true;
            }
            if found.replace(std::mem::take(value)).is_some() {
                self.violations.push(Invalid::new(name, "is there twice"));
            }
            false
        });
        found
    }

    /// A parameter that is not text.
    pub(super) fn value<T: FromStr>(&mut self, name: &str, kind: &str) -> Option<T> {
        let text = self.text(name)?;
        let value = text.parse().ok();
        if value.is_none() {
            let message = format!("{} is not {kind}", quoted(&text));
            self.violations.push(Invalid::new(name, message));
        }
        value
    }

    /// Everything must have been taken out.
    pub(super) fn finish(mut self) -> Result<(), ServiceError> {
        for (name, _) in &self.pairs {
            let name = quoted(name);
            let invalid = Invalid::new("?", format!("{name} is not a parameter of this path"));
            self.violations.push(invalid);
        }
        if self.violations.is_empty() {
            return Ok(());
        }
        Err(ServiceError::invalid(self.violations))
    }
}

fn decoded(text: &str) -> String {
    let spaced = text.replace('+', " ");
    let decoded = percent_encoding::percent_decode_str(&spaced);
    decoded.decode_utf8_lossy().into_owned()
}

fn camel(name: &str) -> String {
    let mut words = name.split('_');
    let first = words.next().unwrap_or("").to_owned();
    words.fold(first, |mut text, word| {
        let (head, tail) = word.split_at(word.len().min(1));
        text.push_str(&head.to_ascii_uppercase());
        text.push_str(tail);
        text
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn query(text: &str) -> Query {
        Query::of(&format!("/v1/robots?{text}").parse().unwrap())
    }

    #[test]
    fn parameters_are_read() {
        let mut query = query("page_token=a%20b+c&pageSize=7&as_urdf=true");
        assert_eq!(query.text("page_token").as_deref(), Some("a b c"));
        assert_eq!(query.value::<u32>("page_size", "a number"), Some(7));
        assert_eq!(query.value::<bool>("as_urdf", "true or false"), Some(true));
        assert!(query.finish().is_ok());
    }

    #[test]
    fn what_is_unknown_or_unreadable_is_named() {
        let mut query = query("page_size=x&other=1&page_token=a&page_token=b");
        assert_eq!(query.value::<u32>("page_size", "a number"), None);
        query.text("page_token");
        let error = query.finish().unwrap_err();
        let fields: Vec<_> = error
            .wire()
            .violations
            .iter()
            .map(|invalid| invalid.path.as_str())
            .collect();
        assert_eq!(fields, ["page_size", "page_token", "?"]);
    }
}
