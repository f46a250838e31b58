//! References to objects, as stored in MATLAB files: class and object numbers, which count the
//! classes and objects in the directory (`directory.rs`).

use crate::formats::element_order::element_count;
use crate::formats::variables::{ElementKind, Value};

/// First word in every reference.
const REFERENCE: u32 = 0xdd00_0000;

/// A reference to an object or an object array.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(in crate::formats::mat) struct Reference {
    pub(super) shape: Vec<usize>,
    /// Object numbers in column-major order.
    pub(super) objects: Vec<u32>,
    pub(super) class: u32,
}

impl Reference {
    /// Parses a reference's words: 0xDD000000, dimension count, dimensions, object numbers and
    /// class number. Returns `None` for any other words.
    pub(super) fn parse(words: &[u32]) -> Option<Self> {
        let [REFERENCE, dimensions, rest @ ..] = words else {
            return None;
        };
        let (sides, rest) = rest.split_at_checked(*dimensions as usize)?;
        let shape: Vec<usize> = sides.iter().map(|&side| side as usize).collect();
        let (&class, objects) = rest.split_last()?;
        if shape.len() < 2 || element_count(&shape)? != objects.len() {
            return None;
        }
        Some(Self {
            shape,
            objects: objects.to_vec(),
            class,
        })
    }

    /// Returns the reference in a value; `None` unless the value is a column of integers that form
    /// a reference.
    pub(in crate::formats::mat) fn from_value(value: &Value) -> Option<Self> {
        let Value::Array(array) = value else {
            return None;
        };
        let is_column_of_integers = array.kind == ElementKind::Integer
            && array.shape.get(1) == Some(&1)
            && array.im.is_none();
        if !is_column_of_integers || array.re.first() != Some(&f64::from(REFERENCE)) {
            return None;
        }
        let mut words = Vec::with_capacity(array.re.len());
        for &number in &array.re {
            if !(0.0..=f64::from(u32::MAX)).contains(&number) {
                return None;
            }
            words.push(number as u32);
        }
        Self::parse(&words)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::formats::variables::Array;

    #[test]
    fn a_reference_names_its_objects_and_their_class() {
        let reference = Reference::parse(&[REFERENCE, 2, 1, 2, 7, 8, 3]);
        assert_eq!(
            reference,
            Some(Reference {
                shape: vec![1, 2],
                objects: vec![7, 8],
                class: 3
            })
        );
    }

    #[test]
    fn words_that_contradict_their_sizes_are_no_reference() {
        for words in [
            &[REFERENCE, 2, 1, 2, 7, 3][..],
            &[REFERENCE, 9, 1, 1, 1, 1],
            &[1, 2, 1, 1, 1, 1],
            &[],
        ] {
            assert_eq!(Reference::parse(words), None);
        }
        assert_eq!(
            Reference::parse(&[REFERENCE, 4, u32::MAX, u32::MAX, u32::MAX, 0, 1]),
            None
        );
    }

    #[test]
    fn ordinary_numbers_are_no_reference_even_if_they_look_like_one() {
        let numbers = Array::matrix(6, 1, [REFERENCE, 2, 1, 1, 1, 1].map(f64::from).to_vec());
        assert_eq!(Reference::from_value(&Value::Array(numbers.clone())), None);
        let integers = Array {
            kind: ElementKind::Integer,
            ..numbers
        };
        assert!(Reference::from_value(&Value::Array(integers)).is_some());
    }
}
