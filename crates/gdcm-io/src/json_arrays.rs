//! Rectangular arrays of numbers in JSON: matrices and response tables as nested lists. An array
//! that exceeds a limit is rejected before the excess occupies memory.

use std::fmt;

use nalgebra::DMatrix;
use serde::de::{DeserializeSeed, Deserializer, Error, SeqAccess, Visitor};
use serde::ser::{SerializeSeq, Serializer};
use serde::{Deserialize, Serialize};

use gdcm_model::dataset::limits::{MOST_CHANNELS, MOST_FREQUENCIES, MOST_STATES};

use crate::json_lists::too_long;

/// Text between the expected and the found length in the message about list lengths that differ;
/// `json_errors.rs` recognises the message by it.
pub(super) const DIFFERENT_LENGTHS: &str = " entries, as in the first of these lists, found ";

/// A rectangular array with `DEPTH` dimensions; the last index runs fastest: `[[1, 2], [3, 4]]` has
/// the shape 2 x 2.
///
/// The values are stored in a flat vector, so that a file with empty lists cannot take more memory
/// than its own length. The state limit bounds a matrix's dimensions; the channel and frequency
/// limits bound a response table's.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Nested<const DEPTH: usize> {
    /// Length per dimension; 0 if a previous dimension is empty.
    pub(super) shape: [usize; DEPTH],
    pub(super) values: Vec<f64>,
}

impl<const DEPTH: usize> Nested<DEPTH> {
    /// Returns the maximum list length at a depth, 0 being the outermost.
    const fn most(depth: usize) -> usize {
        match (DEPTH, depth) {
            (2, _) => MOST_STATES,
            (_, 0 | 1) => MOST_CHANNELS,
            _ => MOST_FREQUENCIES,
        }
    }
}

impl Nested<2> {
    /// Converts a matrix to values in row order.
    pub(super) fn of_matrix(matrix: &DMatrix<f64>) -> Self {
        // nalgebra stores matrices by columns, a file by rows.
        Self {
            shape: [matrix.nrows(), matrix.ncols()],
            values: matrix.transpose().as_slice().to_vec(),
        }
    }
}

impl<'de, const DEPTH: usize> Deserialize<'de> for Nested<DEPTH> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let mut array = ArrayBuilder {
            lengths: [None; DEPTH],
            values: Vec::new(),
        };
        ListReader {
            array: &mut array,
            depth: 0,
        }
        .deserialize(deserializer)?;
        Ok(Self {
            shape: array.lengths.map(Option::unwrap_or_default),
            values: array.values,
        })
    }
}

/// Array under construction while its nested lists are read: serde calls [`ListReader::visit_seq`]
/// for each list, from the outside in.
struct ArrayBuilder<const DEPTH: usize> {
    /// List length at each depth; `None` until the first list at this depth has ended.
    lengths: [Option<usize>; DEPTH],
    values: Vec<f64>,
}

/// Reader for a list at `depth`, 0 being the outermost.
struct ListReader<'f, const DEPTH: usize> {
    array: &'f mut ArrayBuilder<DEPTH>,
    depth: usize,
}

impl<'de, const DEPTH: usize> DeserializeSeed<'de> for ListReader<'_, DEPTH> {
    type Value = ();

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<(), D::Error> {
        deserializer.deserialize_seq(self)
    }
}

impl<'de, const DEPTH: usize> Visitor<'de> for ListReader<'_, DEPTH> {
    type Value = ();

    fn expecting(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(if self.depth + 1 == DEPTH {
            "a list of numbers"
        } else {
            "a list of lists of numbers"
        })
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut entries: A) -> Result<(), A::Error> {
        let mut length = 0;
        let depth = self.depth + 1;
        loop {
            if depth == DEPTH {
                let Some(value) = entries.next_element::<f64>()? else {
                    break;
                };
                self.array.values.push(value);
            } else if entries
                .next_element_seed(ListReader {
                    array: &mut *self.array,
                    depth,
                })?
                .is_none()
            {
                break;
            }
            length += 1;
            if length > Nested::<DEPTH>::most(self.depth) {
                return Err(too_long(length - 1));
            }
        }
        let expected = *self.array.lengths[self.depth].get_or_insert(length);
        if length != expected {
            return Err(A::Error::custom(format!(
                "expected {expected}{DIFFERENT_LENGTHS}{length}"
            )));
        }
        Ok(())
    }
}

impl<const DEPTH: usize> Serialize for Nested<DEPTH> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        ListWriter {
            shape: &self.shape,
            values: &self.values,
        }
        .serialize(serializer)
    }
}

/// Writer for a list within an array.
struct ListWriter<'v> {
    shape: &'v [usize],
    values: &'v [f64],
}

impl Serialize for ListWriter<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self.shape {
            [] | [_] => self.values.serialize(serializer),
            [length, shape @ ..] => {
                let size: usize = shape.iter().product();
                let mut list = serializer.serialize_seq(Some(*length))?;
                for part in 0..*length {
                    list.serialize_element(&ListWriter {
                        shape,
                        values: &self.values[part * size..(part + 1) * size],
                    })?;
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
    fn written_lists_are_read_back() {
        for text in ["[[1.0,2.0,3.0],[4.0,5.0,6.0]]", "[]", "[[],[]]"] {
            assert_eq!(
                serde_json::to_string(&read::<2>(text).unwrap()).unwrap(),
                text
            );
        }
        let text = "[[[1.0],[2.0]],[[3.0],[4.0]]]";
        let table = read::<3>(text).unwrap();
        assert_eq!(
            (table.shape, table.values.as_slice()),
            ([2, 2, 1], [1.0, 2.0, 3.0, 4.0].as_slice())
        );
        assert_eq!(serde_json::to_string(&table).unwrap(), text);
    }

    #[test]
    fn a_ragged_list_is_refused_at_any_depth() {
        for text in ["[[1, 2], [3]]", "[[], [3]]", "[[1], []]"] {
            let message = read::<2>(text).unwrap_err();
            assert!(message.contains(DIFFERENT_LENGTHS), "{text}: {message}");
        }
        let lengths = format!("expected 2{DIFFERENT_LENGTHS}1");
        let message = read::<3>("[[[1], [2]], [[3]]]").unwrap_err();
        assert_eq!(message.split(" at line ").next(), Some(lengths.as_str()));
    }
}
