//! Numbers as the JSON form of protobuf has them: a JSON number, or a text with one, which is how it writes 64-bit integers,
//! `NaN` and `Infinity`.
//!
//! The generated code is made for `pbjson`'s own reader of numbers, which tries one form after the other and writes an error's
//! text for each that does not fit: a third of the time that telemetry over HTTP took. `build.rs` puts this one in its place.

use std::{fmt, marker::PhantomData, str::FromStr};

use serde::{
    Deserialize, Deserializer,
    de::{self, Unexpected, Visitor},
};

/// A number that was read.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(crate) struct Number<T>(pub(crate) T);

/// A type of numbers of the schema.
pub(crate) trait Numeric: FromStr {
    /// What whole numbers it can be.
    const RANGE: &'static str;
    /// `None`: it is no such number.
    fn of_u64(value: u64) -> Option<Self>;
    /// The same.
    fn of_i64(value: i64) -> Option<Self>;
    /// The same.
    fn of_f64(value: f64) -> Option<Self>;
}

impl Numeric for f64 {
    const RANGE: &'static str = "any number";

    fn of_u64(value: u64) -> Option<Self> {
        Some(value as Self)
    }

    fn of_i64(value: i64) -> Option<Self> {
        Some(value as Self)
    }

    fn of_f64(value: f64) -> Option<Self> {
        Some(value)
    }
}

macro_rules! integer {
    ($($type:ty, $bits:literal);*) => {$(
        impl Numeric for $type {
            const RANGE: &'static str = concat!("a whole number that ", $bits, " hold");

            fn of_u64(value: u64) -> Option<Self> {
                value.try_into().ok()
            }

            fn of_i64(value: i64) -> Option<Self> {
                value.try_into().ok()
            }

            fn of_f64(_: f64) -> Option<Self> {
                None
            }
        }
    )*};
}

integer!(i32, "32 bits with a sign"; u32, "32 bits"; u64, "64 bits");

impl<'de, T: Numeric> Deserialize<'de> for Number<T> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(Reader(PhantomData)).map(Self)
    }
}

struct Reader<T>(PhantomData<T>);

impl<T: Numeric> Visitor<'_> for Reader<T> {
    type Value = T;

    fn expecting(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str("a number")
    }

    fn visit_f64<E: de::Error>(self, value: f64) -> Result<T, E> {
        T::of_f64(value).ok_or_else(|| E::invalid_type(Unexpected::Float(value), &"a whole number"))
    }

    fn visit_u64<E: de::Error>(self, value: u64) -> Result<T, E> {
        T::of_u64(value).ok_or_else(|| E::invalid_value(Unexpected::Unsigned(value), &T::RANGE))
    }

    fn visit_i64<E: de::Error>(self, value: i64) -> Result<T, E> {
        T::of_i64(value).ok_or_else(|| E::invalid_value(Unexpected::Signed(value), &T::RANGE))
    }

    fn visit_str<E: de::Error>(self, value: &str) -> Result<T, E> {
        value
            .parse()
            .map_err(|_| E::invalid_value(Unexpected::Str(value), &self))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read<T: Numeric>(json: &str) -> Result<T, String> {
        let read = serde_json::from_str::<Number<T>>(json);
        read.map(|number| number.0).map_err(|error| error.to_string())
    }

    #[test]
    fn numbers_and_texts_with_numbers_are_read() {
        assert_eq!(read::<f64>("0.1"), Ok(0.1));
        assert_eq!(read::<f64>("-3"), Ok(-3.0));
        assert_eq!(read::<f64>("18446744073709551615"), Ok(18_446_744_073_709_551_615.0));
        assert_eq!(read::<f64>("\"1e-3\""), Ok(1e-3));
        assert_eq!(read::<f64>("\"-Infinity\""), Ok(f64::NEG_INFINITY));
        assert!(read::<f64>("\"NaN\"").unwrap().is_nan());
        assert_eq!(read::<u64>("\"18446744073709551615\""), Ok(u64::MAX));
        assert_eq!(read::<i32>("-7"), Ok(-7));
    }

    #[test]
    fn what_is_no_such_number_is_told() {
        let told = |found: Result<u32, String>| found.unwrap_err();
        assert!(told(read("1.5")).contains("a whole number"));
        assert!(told(read("-1")).contains("32 bits"));
        assert!(told(read("4294967296")).contains("32 bits"));
        for json in ["true", "null", "[1]", "{}", "\"one\""] {
            let error = read::<f64>(json).unwrap_err();
            assert!(error.contains("expected a number"), "{json}: {error}");
        }
    }
}
