//! Files of level 4: consecutive matrices of numbers or characters.
//!
//! Source: "MAT-File Format", The MathWorks, "Level 4 MAT-File Format".

use std::collections::HashSet;

use crate::formats::mat::level5::{ByteOrder, Cursor, name_of};
use crate::formats::mat::matrix::rows;
use crate::formats::mat::{FieldPath, count};
use crate::formats::strides::{Entries, NumberClass, StoredNumber};
use crate::formats::variables::{Array, Value, Variable};
use crate::reading_budget::{ReadingBudget, VariableFault};

/// Header of a matrix.
struct Header {
    /// Number type: P of the type MOPT.
    stored: StoredNumber,
    /// T of the type MOPT.
    meaning: Meaning,
    rows: usize,
    columns: usize,
    complex: bool,
    name_length: usize,
}

/// Meaning of the numbers.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Meaning {
    Numbers,
    Text,
    Sparse,
}

/// Whether a file begins with a level-4 header.
pub(super) fn begins(bytes: &[u8]) -> bool {
    header(&mut Cursor::file(bytes, ByteOrder::Little)).is_ok()
}

/// Reads all variables of a file.
pub(super) fn read(
    bytes: &[u8],
    budget: &ReadingBudget<'_>,
) -> Result<Vec<Variable>, VariableFault> {
    let mut file = Cursor::file(bytes, ByteOrder::Little);
    let mut variables = Vec::new();
    let mut names = HashSet::new();
    while !file.is_empty() {
        budget.take(1, 2 * size_of::<Variable>() as u64, "")?;
        let header = header(&mut file)?;
        let name = name_of(file.take(header.name_length)?.rest());
        let value = header
            .value(&mut file, budget)
            .map_err(|fault| FieldPath::start(&name).name(fault))?;
        if !names.insert(name.clone()) {
            return Err(VariableFault::Duplicate { name });
        }
        variables.push(Variable { name, value });
    }
    Ok(variables)
}

fn header(file: &mut Cursor<'_>) -> Result<Header, VariableFault> {
    let start = *file;
    let damaged = |what: &str| start.damaged(format!("{what} where the next matrix should begin"));
    let order = order(start.rest()).ok_or_else(|| damaged("no type of a matrix"))?;
    file.order = order;
    let kind = file.u32()?;
    let mut sizes = [0; 4];
    for size in &mut sizes {
        *size = i32::try_from(file.u32()?).map_err(|_| damaged("a negative size"))? as usize;
    }
    let [rows, columns, complex, name_length] = sizes;
    let stored = stored_number(kind / 10 % 10, order)
        .ok_or_else(|| damaged("an unknown kind of numbers"))?;
    let meaning = match kind % 10 {
        0 => Meaning::Numbers,
        1 => Meaning::Text,
        2 => Meaning::Sparse,
        _ => return Err(damaged("an unknown kind of matrix")),
    };
    if complex > 1 || name_length == 0 {
        return Err(damaged("no matrix"));
    }
    Ok(Header {
        stored,
        meaning,
        rows,
        columns,
        complex: complex == 1,
        name_length,
    })
}

/// Determines the byte order: read in the correct order the type is below 2000, with 0 (little) or
/// 1 (big) as its thousands digit and 0 as its hundreds digit.
fn order(bytes: &[u8]) -> Option<ByteOrder> {
    let first = *bytes.first_chunk::<4>()?;
    let fits = |order: ByteOrder, thousands: u32| order.u32(first) / 100 == thousands * 10;
    if fits(ByteOrder::Little, 0) {
        return Some(ByteOrder::Little);
    }
    if fits(ByteOrder::Big, 1) {
        Some(ByteOrder::Big)
    } else {
        None
    }
}

/// Number type for P of the type MOPT.
fn stored_number(kind: u32, order: ByteOrder) -> Option<StoredNumber> {
    let (class, size) = match kind {
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

impl Header {
    fn value(
        &self,
        file: &mut Cursor<'_>,
        budget: &ReadingBudget<'_>,
    ) -> Result<Value, VariableFault> {
        let start = *file;
        let re = self.numbers(file, budget)?;
        let im = if self.complex {
            Some(self.numbers(file, budget)?)
        } else {
            None
        };
        let shape = vec![self.rows, self.columns];
        match self.meaning {
            Meaning::Numbers => Ok(Value::Array(Array {
                shape,
                kind: self.stored.kind(),
                re,
                im,
            })),
            Meaning::Text => {
                budget.take(re.len() as u64, 16, "")?;
                let characters: Vec<u32> = re.iter().map(|&number| number as u32).collect();
                Ok(Value::Text(rows(&characters, &shape, "", budget)?))
            }
            Meaning::Sparse => self.sparse(&re, start, budget).map(Value::Array),
        }
    }

    fn numbers(
        &self,
        file: &mut Cursor<'_>,
        budget: &ReadingBudget<'_>,
    ) -> Result<Vec<f64>, VariableFault> {
        let count = count(&[self.rows, self.columns]);
        let bytes = file.take(count.saturating_mul(self.stored.size()))?;
        budget.take(count as u64, 8, "")?;
        Ok(bytes
            .rest()
            .chunks_exact(self.stored.size())
            .map(|number| self.stored.decode(number))
            .collect())
    }

    /// Reads columns of row indices, column indices, real parts and imaginary parts; the last row
    /// gives the size of the matrix.
    fn sparse(
        &self,
        columns: &[f64],
        start: Cursor<'_>,
        budget: &ReadingBudget<'_>,
    ) -> Result<Array, VariableFault> {
        let damaged = || start.damaged("a sparse matrix whose numbers do not fit it");
        budget.take(columns.len() as u64, 8, "")?;
        let parts: Vec<&[f64]> = columns.chunks_exact(self.rows.max(1)).collect();
        let (rows, columns, re, im) = match *parts.as_slice() {
            [rows, columns, re] => (rows, columns, re, None),
            [rows, columns, re, im] => (rows, columns, re, Some(im)),
            _ => return Err(damaged()),
        };
        let whole = |number: f64| {
            if number >= 0.0 {
                Some(number as usize)
            } else {
                None
            }
        };
        let (&height, rows) = rows.split_last().ok_or_else(damaged)?;
        let (&width, columns) = columns.split_last().ok_or_else(damaged)?;
        let shape = whole(height)
            .zip(whole(width))
            .map(|(height, width)| [height, width])
            .ok_or_else(damaged)?;
        let place = |&number: &f64| whole(number)?.checked_sub(1);
        let entries = Entries {
            shape,
            kind: self.stored.kind(),
            rows: rows
                .iter()
                .map(place)
                .collect::<Option<_>>()
                .ok_or_else(damaged)?,
            columns: columns
                .iter()
                .map(place)
                .collect::<Option<_>>()
                .ok_or_else(damaged)?,
            re: re.to_vec(),
            im: im.map(<[f64]>::to_vec),
        };
        entries.filled("", budget, damaged)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::formats::variables::ElementKind;

    /// A matrix in the given byte order.
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
    fn what_is_no_matrix_of_level_4_is_not_taken_for_one() {
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
