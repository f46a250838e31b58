//! Where a value leads to objects.

use crate::variables::{ElementKind, Value};

/// What every reference begins with.
const REFERENCE: u32 = 0xdd00_0000;

/// Which objects a value stands for.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(in super::super) struct Reference {
    /// Number of objects along each dimension.
    pub(super) shape: Vec<usize>,
    /// Number of each object, the first index running fastest.
    pub(super) objects: Vec<u32>,
    /// Number of their class.
    pub(super) class: u32,
}

impl Reference {
    /// Reads `[0xDD000000, number of dimensions, dimensions, numbers of the objects, number of the class]`.
    pub(super) fn parse(words: &[u32]) -> Option<Self> {
        let [REFERENCE, dimensions, rest @ ..] = words else { return None };
        let (shape, rest) = rest.split_at_checked(*dimensions as usize)?;
        let shape: Vec<usize> = shape.iter().map(|&length| length as usize).collect();
        let (&class, objects) = rest.split_last()?;
        let count = shape.iter().try_fold(1_usize, |product, &length| product.checked_mul(length))?;
        let sides = shape.iter().try_fold(1_usize, |product, &length| product.checked_mul(length.max(1)));
        if shape.len() < 2 || sides.is_none() || count != objects.len() {
            return None;
        }
        Some(Self { shape, objects: objects.to_vec(), class })
    }

    /// The reference that a value is: a column of whole numbers.
    pub(in super::super) fn of(value: &Value) -> Option<Self> {
        let Value::Array(array) = value else { return None };
        let begins = array.re.first() == Some(&f64::from(REFERENCE));
        if !begins || array.kind != ElementKind::Integer || array.shape.get(1) != Some(&1) || array.im.is_some() {
            return None;
        }
        let word =
            |&number: &f64| if (0.0..=f64::from(u32::MAX)).contains(&number) { Some(number as u32) } else { None };
        let words: Option<Vec<u32>> = array.re.iter().map(word).collect();
        Self::parse(&words?)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::variables::Array;

    #[test]
    fn a_reference_names_its_objects_and_their_class() {
        let reference = Reference::parse(&[REFERENCE, 2, 1, 2, 7, 8, 3]);
        assert_eq!(reference, Some(Reference { shape: vec![1, 2], objects: vec![7, 8], class: 3 }));
    }

    #[test]
    fn what_does_not_fit_its_own_sizes_is_no_reference() {
        for words in [&[REFERENCE, 2, 1, 2, 7, 3][..], &[REFERENCE, 9, 1, 1, 1, 1], &[1, 2, 1, 1, 1, 1], &[]] {
            assert_eq!(Reference::parse(words), None);
        }
        assert_eq!(Reference::parse(&[REFERENCE, 4, u32::MAX, u32::MAX, u32::MAX, 0, 1]), None);
    }

    #[test]
    fn ordinary_numbers_are_no_reference_even_if_they_look_like_one() {
        let numbers = Array::matrix(6, 1, [REFERENCE, 2, 1, 1, 1, 1].map(f64::from).to_vec());
        assert_eq!(Reference::of(&Value::Array(numbers.clone())), None);
        let integers = Array { kind: ElementKind::Integer, ..numbers };
        assert!(Reference::of(&Value::Array(integers)).is_some());
    }
}
