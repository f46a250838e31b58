//! Reads the numbers in a data element, in any stored type.
//!
//! Errors get the variable name later, from `ValuePath::locate`; hence the empty names.

use crate::formats::mat::element::{DataKind, Element};
use crate::reading_budget::{ReadingBudget, VariableFault};
use crate::variable_fault::damage::Damage;

/// Memory for a number, a size or a word \[bytes\].
const NUMBER_BYTES: u64 = 8;

/// Reads the numbers of an element, which must hold exactly `count`.
///
/// MATLAB stores an array's numbers in the smallest type that holds them, so the stored type may
/// differ from the array's type.
pub(super) fn read_numbers(
    element: &Element<'_>,
    count: usize,
    budget: &ReadingBudget<'_>,
) -> Result<Vec<f64>, VariableFault> {
    let found = element.count()?;
    if found != count {
        return Err(element.data.damaged(Damage::NumberCount {
            found,
            expected: count,
        }));
    }
    budget.take(count as u64, NUMBER_BYTES, "")?;
    Ok(element.number_type()?.decode_all(element.data.rest()))
}

/// Reads 32-bit integers that are sizes or indices; rejects negative values and other types.
pub(super) fn read_sizes(
    element: &Element<'_>,
    budget: &ReadingBudget<'_>,
) -> Result<Vec<usize>, VariableFault> {
    if !matches!(element.kind, DataKind::I32 | DataKind::U32) {
        return Err(element.data.damaged(Damage::SizesNotIntegers));
    }
    let count = element.count()?;
    // Memory for the sizes; `read_numbers` takes the memory for the numbers from which they are
    // converted.
    budget.take(count as u64, NUMBER_BYTES, "")?;
    let mut sizes = Vec::with_capacity(count);
    // 32-bit integers are exact as floats.
    for number in read_numbers(element, count, budget)? {
        if number < 0.0 {
            return Err(element.data.damaged(Damage::NegativeSize));
        }
        sizes.push(number as usize);
    }
    Ok(sizes)
}

/// Reads unsigned 64-bit integers without rounding; `None` for any other type.
pub(super) fn read_long_words(
    element: &Element<'_>,
    budget: &ReadingBudget<'_>,
) -> Result<Option<Vec<u64>>, VariableFault> {
    if element.kind != DataKind::U64 {
        return Ok(None);
    }
    budget.take(element.count()? as u64, NUMBER_BYTES, "")?;
    let order = element.data.order;
    let (words, _) = element.data.rest().as_chunks();
    Ok(Some(words.iter().map(|&bytes| order.u64(bytes)).collect()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::formats::mat::cursor::{ByteOrder, Cursor};

    fn read(kind: u8, data: &[u8], count: usize) -> Result<Vec<f64>, VariableFault> {
        let bytes = [&[kind, 0, 0, 0, data.len() as u8, 0, 0, 0], data].concat();
        let element = Element::read(&mut Cursor::file(&bytes, ByteOrder::Little)).unwrap();
        read_numbers(&element, count, &ReadingBudget::new(1 << 10))
    }

    #[test]
    fn every_kind_of_number_becomes_the_nearest() {
        assert_eq!(read(1, &[0xff], 1), Ok(vec![-1.0]));
        assert_eq!(read(3, &[0xfe, 0xff], 1), Ok(vec![-2.0]));
        assert_eq!(read(5, &(-3_i32).to_le_bytes(), 1), Ok(vec![-3.0]));
        assert_eq!(read(7, &0.5_f32.to_le_bytes(), 1), Ok(vec![0.5]));
        assert_eq!(read(12, &(-4_i64).to_le_bytes(), 1), Ok(vec![-4.0]));
        assert_eq!(
            read(13, &u64::MAX.to_le_bytes(), 1),
            Ok(vec![18_446_744_073_709_551_616.0])
        );
    }

    #[test]
    fn too_few_numbers_are_damage_and_numbers_beyond_the_budget_are_refused() {
        assert!(matches!(
            read(9, &[0; 8], 2),
            Err(VariableFault::Damaged { .. })
        ));
        assert!(matches!(
            read(2, &[0; 200], 200),
            Err(VariableFault::TooLarge { .. })
        ));
    }
}
