//! Files of level 4: consecutive matrices of numbers or characters.
//!
//! ```text
//! header   five 32-bit integers: type, rows, columns, 1 if complex (else 0), length of the name
//! name     ended by a zero byte, which is included in its length
//! numbers  real parts column by column, then the imaginary parts if complex
//! ```
//!
//! The type is a decimal number with four digits, called M, O, P and T in the source: M is the byte
//! order (0 little endian, 1 big endian), O is 0, P the number type, T what the numbers mean.
//!
//! Source: "MAT-File Format", The MathWorks, "Level 4 MAT-File Format".

use std::collections::HashSet;

use crate::formats::mat::array_header::saturating_count;
use crate::formats::mat::characters::text_rows;
use crate::formats::mat::cursor::{ByteOrder, Cursor};
use crate::formats::mat::element::decode_name;
use crate::formats::mat::value_path::ValuePath;
use crate::formats::sparse_matrix::SparseEntries;
use crate::formats::stored_number::{NumberClass, StoredNumber};
use crate::formats::variables::{Array, Value, Variable};
use crate::reading_budget::{ReadingBudget, VariableFault};
use crate::variable_fault::damage::Damage;

struct MatrixHeader {
    /// Number type (digit P).
    number_type: StoredNumber,
    /// Meaning of the numbers (digit T).
    meaning: Meaning,
    rows: usize,
    columns: usize,
    is_complex: bool,
    name_length: usize,
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum Meaning {
    Numbers,
    Text,
    Sparse,
}

/// Returns whether a file begins with a level-4 header.
pub(super) fn begins(bytes: &[u8]) -> bool {
    MatrixHeader::read(&mut Cursor::file(bytes, ByteOrder::Little)).is_ok()
}

/// Reads a file's variables in file order.
pub(super) fn read(
    bytes: &[u8],
    budget: &ReadingBudget<'_>,
) -> Result<Vec<Variable>, VariableFault> {
    let mut file = Cursor::file(bytes, ByteOrder::Little);
    let mut variables = Vec::new();
    let mut names = HashSet::new();
    while !file.is_empty() {
        budget.take(1, 2 * size_of::<Variable>() as u64, "")?;
        let header = MatrixHeader::read(&mut file)?;
        let name = decode_name(file.take(header.name_length)?.rest());
        let value = header
            .read_value(&mut file, budget)
            .map_err(|fault| ValuePath::start(&name).locate(fault))?;
        if !names.insert(name.clone()) {
            return Err(VariableFault::Duplicate { name });
        }
        variables.push(Variable { name, value });
    }
    Ok(variables)
}

impl MatrixHeader {
    /// Reads the next header. The byte order may differ between matrices in a file.
    fn read(file: &mut Cursor<'_>) -> Result<Self, VariableFault> {
        let start = *file;
        let Some(order) = detect_order(start.rest()) else {
            return Err(no_matrix(start, "an unknown byte order"));
        };
        file.order = order;
        let type_digits = file.read_u32()?;
        let mut sizes = [0; 4];
        for size in &mut sizes {
            let number = file.read_u32()?;
            *size =
                i32::try_from(number).map_err(|_| no_matrix(start, "a negative size"))? as usize;
        }
        let [rows, columns, complex, name_length] = sizes;
        let Some(number_type) = number_type(type_digits / 10 % 10, order) else {
            return Err(no_matrix(start, "an unknown number type"));
        };
        let meaning = match type_digits % 10 {
            0 => Meaning::Numbers,
            1 => Meaning::Text,
            2 => Meaning::Sparse,
            _ => return Err(no_matrix(start, "an unknown matrix type")),
        };
        if complex > 1 || name_length == 0 {
            return Err(no_matrix(start, "an invalid header"));
        }
        Ok(Self {
            number_type,
            meaning,
            rows,
            columns,
            is_complex: complex == 1,
            name_length,
        })
    }

    /// Reads the numbers after header and name, and converts them to a value.
    fn read_value(
        &self,
        file: &mut Cursor<'_>,
        budget: &ReadingBudget<'_>,
    ) -> Result<Value, VariableFault> {
        let start = *file;
        let re = self.read_numbers(file, budget)?;
        let im = if self.is_complex {
            Some(self.read_numbers(file, budget)?)
        } else {
            None
        };
        let shape = vec![self.rows, self.columns];
        match self.meaning {
            Meaning::Numbers => Ok(Value::Array(Array {
                shape,
                kind: self.number_type.kind(),
                re,
                im,
            })),
            Meaning::Text => {
                budget.take(re.len() as u64, 16, "")?;
                let codes: Vec<u32> = re.iter().map(|&number| number as u32).collect();
                Ok(Value::Text(text_rows(&codes, &shape, "", budget)?))
            }
            Meaning::Sparse => {
                budget.take(re.len() as u64, 8, "")?;
                let entries = self
                    .sparse_entries(&re)
                    .ok_or_else(|| sparse_damage(start))?;
                let full = entries.full_matrix("", budget, || sparse_damage(start))?;
                Ok(Value::Array(full))
            }
        }
    }

    /// Reads the real or the imaginary parts of all elements.
    fn read_numbers(
        &self,
        file: &mut Cursor<'_>,
        budget: &ReadingBudget<'_>,
    ) -> Result<Vec<f64>, VariableFault> {
        let count = saturating_count(&[self.rows, self.columns]);
        let bytes = file.take(count.saturating_mul(self.number_type.size()))?;
        budget.take(count as u64, 8, "")?;
        Ok(self.number_type.decode_all(bytes.rest()))
    }

    /// Interprets the numbers of a sparse matrix, which is stored as a full matrix with a row for
    /// each nonzero element: its row index, its column index, its real part and, in a fourth column
    /// if present, its imaginary part. The first two columns of the last row hold the dimensions.
    /// Returns `None` for any other number of columns, and for invalid dimensions or indices.
    fn sparse_entries(&self, stored: &[f64]) -> Option<SparseEntries> {
        let stored_columns: Vec<&[f64]> = stored.chunks_exact(self.rows.max(1)).collect();
        let [row_indices, column_indices, re, fourth @ ..] = stored_columns.as_slice() else {
            return None;
        };
        let im = match fourth {
            [] => None,
            [im] => Some(im.to_vec()),
            _ => return None,
        };
        let (&height, row_indices) = row_indices.split_last()?;
        let (&width, column_indices) = column_indices.split_last()?;
        Some(SparseEntries {
            shape: [nonnegative(height)?, nonnegative(width)?],
            kind: self.number_type.kind(),
            rows: indices_from_zero(row_indices)?,
            columns: indices_from_zero(column_indices)?,
            // The last row's numbers, beside the dimensions, belong to no element.
            re: re.to_vec(),
            im,
        })
    }
}

/// Returns the error for `found` at `start`, where a matrix was expected.
fn no_matrix(start: Cursor<'_>, found: &'static str) -> VariableFault {
    start.damaged(Damage::NoMatrix { found })
}

/// Returns the error for an invalid sparse matrix at `start`.
fn sparse_damage(start: Cursor<'_>) -> VariableFault {
    start.damaged(Damage::SparseNumbers)
}

/// Converts indices that count from 1 to indices that count from 0; `None` if an index is negative,
/// zero or NaN.
fn indices_from_zero(indices: &[f64]) -> Option<Vec<usize>> {
    let mut converted = Vec::with_capacity(indices.len());
    for &index in indices {
        converted.push(nonnegative(index)?.checked_sub(1)?);
    }
    Some(converted)
}

fn nonnegative(number: f64) -> Option<usize> {
    if number >= 0.0 {
        Some(number as usize)
    } else {
        None
    }
}

/// Determines the byte order: read in the correct order, the type is below 2000, its thousands
/// digit is 0 (little endian) or 1 (big endian), and its hundreds digit is 0.
fn detect_order(bytes: &[u8]) -> Option<ByteOrder> {
    let first = *bytes.first_chunk::<4>()?;
    if ByteOrder::Little.u32(first) / 100 == 0 {
        Some(ByteOrder::Little)
    } else if ByteOrder::Big.u32(first) / 100 == 10 {
        Some(ByteOrder::Big)
    } else {
        None
    }
}

/// Returns the number type for digit P; `None` for an unknown digit.
fn number_type(digit: u32, order: ByteOrder) -> Option<StoredNumber> {
    let (class, size) = match digit {
        0 => (NumberClass::Float, 8),
        1 => (NumberClass::Float, 4),
        2 => (NumberClass::Signed, 4),
        3 => (NumberClass::Signed, 2),
        4 => (NumberClass::Unsigned, 2),
        5 => (NumberClass::Unsigned, 1),
        _ => return None,
    };
    StoredNumber::new(class, size, order == ByteOrder::Big)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::formats::variables::ElementKind;

    /// Returns the bytes of a matrix in the given byte order.
    fn matrix(kind: u32, sizes: [u32; 4], order: ByteOrder, data: &[u8]) -> Vec<u8> {
        let word = |word: u32| {
            if order == ByteOrder::Little {
                word.to_le_bytes()
            } else {
                word.to_be_bytes()
            }
        };
        let head: Vec<u8> = [&[kind][..], &sizes]
            .concat()
            .into_iter()
            .flat_map(word)
            .collect();
        [head, b"x\0".to_vec(), data.to_vec()].concat()
    }

    fn first(bytes: &[u8]) -> Result<Value, VariableFault> {
        assert!(begins(bytes));
        let mut variables = read(bytes, &ReadingBudget::new(1 << 16))?;
        assert_eq!(variables[0].name, "x");
        Ok(variables.remove(0).value)
    }

    #[test]
    fn numbers_are_read_in_both_orders_of_bytes() {
        let wanted = Array {
            kind: ElementKind::Integer,
            ..Array::matrix(1, 2, vec![-2.0, 3.0])
        };
        let little = [-2_i16, 3].map(i16::to_le_bytes).concat();
        assert_eq!(
            first(&matrix(30, [1, 2, 0, 2], ByteOrder::Little, &little)),
            Ok(Value::Array(wanted.clone()))
        );
        let big = [-2_i16, 3].map(i16::to_be_bytes).concat();
        assert_eq!(
            first(&matrix(1030, [1, 2, 0, 2], ByteOrder::Big, &big)),
            Ok(Value::Array(wanted))
        );
    }

    #[test]
    fn text_is_stored_as_numbers_of_characters() {
        let Ok(Value::Text(text)) = first(&matrix(51, [2, 2, 0, 2], ByteOrder::Little, b"acbd"))
        else {
            panic!()
        };
        assert_eq!(text.texts, ["ab", "cd"]);
    }

    #[test]
    fn sparse_matrices_that_contradict_themselves_are_damaged() {
        let sparse = |numbers: [f64; 6]| {
            let data = numbers.map(f64::to_le_bytes).concat();
            first(&matrix(2, [2, 3, 0, 2], ByteOrder::Little, &data))
        };
        let Ok(Value::Array(array)) = sparse([2.0, 3.0, 1.0, 1.0, 7.0, 0.0]) else {
            panic!()
        };
        assert_eq!((array.shape, array.re), (vec![3, 1], vec![0.0, 7.0, 0.0]));
        for numbers in [
            [4.0, 3.0, 1.0, 1.0, 7.0, 0.0],
            [0.0, 3.0, 1.0, 1.0, 7.0, 0.0],
            [2.0, f64::NAN, 1.0, 1.0, 7.0, 0.0],
        ] {
            assert!(
                matches!(sparse(numbers), Err(VariableFault::Damaged { .. })),
                "{numbers:?}"
            );
        }
        let large = sparse([2.0, 1e18, 1.0, 1e18, 7.0, 0.0]);
        assert!(
            matches!(large, Err(VariableFault::TooLarge { .. })),
            "{large:?}"
        );
    }

    #[test]
    fn other_bytes_are_no_level_4_matrix() {
        assert!(!begins(&[0; 20]));
        assert!(!begins(&matrix(
            4000,
            [1, 1, 0, 2],
            ByteOrder::Little,
            &[0; 8]
        )));
        assert!(!begins(&matrix(
            60,
            [1, 1, 0, 2],
            ByteOrder::Little,
            &[0; 8]
        )));
        assert!(!begins(&matrix(
            0,
            [1, u32::MAX, 0, 2],
            ByteOrder::Little,
            &[0; 8]
        )));
        let claimed = first(&matrix(
            0,
            [1 << 30, 1 << 30, 0, 2],
            ByteOrder::Little,
            &[0; 8],
        ));
        assert!(
            matches!(claimed, Err(VariableFault::CutOff { .. })),
            "{claimed:?}"
        );
    }
}
