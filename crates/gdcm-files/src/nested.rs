//! Numbers in lists in lists, as JSON writes matrices and tables.

use std::fmt;

use nalgebra::DMatrix;
use serde::de::{DeserializeSeed, Deserializer, Error, SeqAccess, Visitor};
use serde::ser::{SerializeSeq, Serializer};
use serde::{Deserialize, Serialize};

use super::list::too_long;
use gdcm_core::dataset::limits::{MOST_CHANNELS, MOST_FREQUENCIES, MOST_STATES};

/// A rectangular array of `DEPTH` dimensions, the last one running fastest: `[[1, 2], [3, 4]]` has the shape 2 x 2.
///
/// Read flat, so that a file of empty lists cannot take more memory than its own length; a matrix no further than the states of a
/// model go, a table of responses no further than the channels and the frequencies.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Nested<const DEPTH: usize> {
    /// Entries along each dimension; 0 where a dimension before it is empty.
    pub(super) shape: [usize; DEPTH],
    /// The numbers.
    pub(super) values: Vec<f64>,
}

impl<const DEPTH: usize> Nested<DEPTH> {
    /// Most entries of a list at a depth, 0 the outermost.
    const fn most(depth: usize) -> usize {
        match (DEPTH, depth) {
            (2, _) => MOST_STATES,
            (_, 0 | 1) => MOST_CHANNELS,
            _ => MOST_FREQUENCIES,
        }
    }
}

impl Nested<2> {
    /// A matrix, row by row.
    pub(super) fn of_matrix(matrix: &DMatrix<f64>) -> Self {
        // nalgebra stores columns, a file has rows.
        Self { shape: [matrix.nrows(), matrix.ncols()], values: matrix.transpose().as_slice().to_vec() }
    }
}

impl<'de, const DEPTH: usize> Deserialize<'de> for Nested<DEPTH> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let mut filling = Filling { lengths: [None; DEPTH], values: Vec::new() };
        List { filling: &mut filling, depth: 0 }.deserialize(deserializer)?;
        Ok(Self { shape: filling.lengths.map(Option::unwrap_or_default), values: filling.values })
    }
}

/// An array while it is read.
struct Filling<const DEPTH: usize> {
    /// Length of the lists of each depth, once the first of them has ended.
    lengths: [Option<usize>; DEPTH],
    values: Vec<f64>,
}

/// One list at a depth, 0 the outermost.
struct List<'f, const DEPTH: usize> {
    filling: &'f mut Filling<DEPTH>,
    depth: usize,
}

impl<'de, const DEPTH: usize> DeserializeSeed<'de> for List<'_, DEPTH> {
    type Value = ();

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<(), D::Error> {
        deserializer.deserialize_seq(self)
    }
}

impl<'de, const DEPTH: usize> Visitor<'de> for List<'_, DEPTH> {
    type Value = ();

    fn expecting(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(if self.depth + 1 == DEPTH { "a list of numbers" } else { "a list of lists of numbers" })
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut entries: A) -> Result<(), A::Error> {
        let mut length = 0;
        let depth = self.depth + 1;
        loop {
            if depth == DEPTH {
                let Some(value) = entries.next_element::<f64>()? else { break };
                self.filling.values.push(value);
            } else if entries.next_element_seed(List { filling: &mut *self.filling, depth })?.is_none() {
                break;
            }
            length += 1;
            if length > Nested::<DEPTH>::most(self.depth) {
                return Err(too_long(length - 1));
            }
        }
        match *self.filling.lengths[self.depth].get_or_insert(length) {
            expected if expected == length => Ok(()),
            expected => Err(A::Error::custom(format!(
                "expected {expected} entries, as in the first of these lists, found {length}"
            ))),
        }
    }
}

impl<const DEPTH: usize> Serialize for Nested<DEPTH> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        Part { shape: &self.shape, values: &self.values }.serialize(serializer)
    }
}

/// A list of an array while it is written.
struct Part<'v> {
    shape: &'v [usize],
    values: &'v [f64],
}

impl Serialize for Part<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self.shape {
            [] | [_] => self.values.serialize(serializer),
            [length, shape @ ..] => {
                let size: usize = shape.iter().product();
                let mut list = serializer.serialize_seq(Some(*length))?;
                for part in 0..*length {
                    list.serialize_element(&Part { shape, values: &self.values[part * size..(part + 1) * size] })?;
                }
                list.end()
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read<const DEPTH: usize>(text: &str) -> Result<Nested<DEPTH>, String> {
        serde_json::from_str(text).map_err(|error| error.to_string())
    }

    #[test]
    fn what_is_written_is_what_was_read() {
        for text in ["[[1.0,2.0,3.0],[4.0,5.0,6.0]]", "[]", "[[],[]]"] {
            assert_eq!(serde_json::to_string(&read::<2>(text).unwrap()).unwrap(), text);
        }
        let text = "[[[1.0],[2.0]],[[3.0],[4.0]]]";
        let table = read::<3>(text).unwrap();
        assert_eq!((table.shape, table.values.as_slice()), ([2, 2, 1], [1.0, 2.0, 3.0, 4.0].as_slice()));
        assert_eq!(serde_json::to_string(&table).unwrap(), text);
    }

    #[test]
    fn a_ragged_list_is_refused_at_any_depth() {
        for text in ["[[1, 2], [3]]", "[[], [3]]", "[[1], []]"] {
            assert!(read::<2>(text).unwrap_err().contains("as in the first"), "{text}");
        }
        assert!(read::<3>("[[[1], [2]], [[3]]]").unwrap_err().contains("expected 2 entries"));
    }
}
