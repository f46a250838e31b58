//! Whole numbers in JSON, which many programs write as `7.0`.

use std::fmt;
use std::marker::PhantomData;

use serde::Deserialize;
use serde::de::{Deserializer, Error, Unexpected, Visitor};

/// Integer types that can be deserialised from a whole number. All are read through `i64`, so that a
/// larger number is rejected.
pub trait WholeNumber: TryFrom<i64> {
    /// Expected value in words, for error messages.
    const EXPECTED: &'static str;
}

impl WholeNumber for i64 {
    const EXPECTED: &'static str = "a whole number";
}

impl WholeNumber for u64 {
    const EXPECTED: &'static str = "a whole number not below 0";
}

impl WholeNumber for usize {
    const EXPECTED: &'static str = "a whole number not below 0";
}

/// Deserialises an integer, also if written with a zero fraction (`7.0`); used as
/// `#[serde(deserialize_with = "…")]`.
pub fn whole<'de, T: WholeNumber, D: Deserializer<'de>>(deserializer: D) -> Result<T, D::Error> {
    deserializer.deserialize_any(WholeVisitor(PhantomData))
}

/// Deserialises as [`whole`], or null as `None`; used for an optional key with `#[serde(default)]`.
pub fn whole_or_none<'de, T: WholeNumber, D: Deserializer<'de>>(
    deserializer: D,
) -> Result<Option<T>, D::Error> {
    /// Wraps a whole number, so that it can be deserialised inside an option.
    #[derive(Deserialize)]
    #[serde(bound = "T: WholeNumber", transparent)]
    struct Wrapped<T>(#[serde(deserialize_with = "whole")] T);
    Ok(Option::deserialize(deserializer)?.map(|Wrapped(number)| number))
}

/// Visitor that accepts integers, and floating-point numbers without a fraction.
struct WholeVisitor<T>(PhantomData<T>);

impl<T: WholeNumber> Visitor<'_> for WholeVisitor<T> {
    type Value = T;

    fn expecting(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(T::EXPECTED)
    }

    fn visit_i64<E: Error>(self, number: i64) -> Result<T, E> {
        T::try_from(number).map_err(|_| E::invalid_value(Unexpected::Signed(number), &self))
    }

    fn visit_u64<E: Error>(self, number: u64) -> Result<T, E> {
        match i64::try_from(number) {
            Ok(number) => self.visit_i64(number),
            Err(_) => Err(E::invalid_value(Unexpected::Unsigned(number), &self)),
        }
    }

    fn visit_f64<E: Error>(self, number: f64) -> Result<T, E> {
        /// 2^53: up to this magnitude every whole number is exact in `f64`.
        const LARGEST: f64 = 9_007_199_254_740_992.0;
        if number.fract() == 0.0 && number.abs() <= LARGEST {
            self.visit_i64(number as i64)
        } else {
            Err(E::invalid_type(Unexpected::Float(number), &self))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[derive(Debug, Deserialize)]
    struct Numbers {
        #[serde(deserialize_with = "whole")]
        id: i64,
        #[serde(default, deserialize_with = "whole_or_none")]
        order: Option<usize>,
    }

    fn read(text: &str) -> Result<(i64, Option<usize>), String> {
        let numbers = serde_json::from_str::<Numbers>(text).map_err(|error| error.to_string())?;
        Ok((numbers.id, numbers.order))
    }

    #[test]
    fn a_zero_fraction_is_accepted() {
        assert_eq!(read(r#"{"id": 7.0, "order": 4.00}"#), Ok((7, Some(4))));
        assert_eq!(read(r#"{"id": -7e0, "order": null}"#), Ok((-7, None)));
        assert_eq!(read(r#"{"id": 9223372036854775807}"#), Ok((i64::MAX, None)));
    }

    #[test]
    fn other_values_are_refused() {
        for (text, value, expected) in [
            (r#"{"id": 7.5}"#, "`7.5`", i64::EXPECTED),
            (r#"{"id": "7"}"#, "\"7\"", i64::EXPECTED),
            (r#"{"id": 1e300}"#, "", i64::EXPECTED),
            (r#"{"id": 1, "order": -2.0}"#, "`-2`", usize::EXPECTED),
            (r#"{"id": 1, "order": true}"#, "`true`", usize::EXPECTED),
        ] {
            let error = read(text).unwrap_err();
            assert!(error.contains(value) && error.contains(expected), "{error}");
        }
    }
}
