//! Numbers of a data element, whatever kind they are stored as.

use super::cursor::ByteOrder;
use super::element::{DataKind, Element};
use crate::variables::{MemoryBudget, VariableFault};

/// All numbers of an element, of which there must be `count`.
///
/// MATLAB stores the numbers of an array in the smallest kind that holds them, so that this is not the array's own kind.
pub(super) fn numbers(
    element: &Element<'_>,
    count: usize,
    meter: &MemoryBudget<'_>,
) -> Result<Vec<f64>, VariableFault> {
    let found = element.count()?;
    if found != count {
        return Err(element.data.damaged(format!("{found} numbers where there should be {count}")));
    }
    meter.take(count as u64, 8, "")?;
    Ok(converted(element.kind, element.data.rest(), element.data.order))
}

/// All whole numbers of an element: sizes and places.
pub(super) fn places(element: &Element<'_>, meter: &MemoryBudget<'_>) -> Result<Vec<usize>, VariableFault> {
    match element.kind {
        DataKind::I32 | DataKind::U32 => {}
        _ => return Err(element.data.damaged("numbers of another kind where sizes should stand")),
    }
    let count = element.count()?;
    meter.take(count as u64, 8, "")?;
    let values = numbers(element, count, meter)?;
    let place = |value: f64| if value < 0.0 { None } else { Some(value as usize) };
    let places: Option<Vec<usize>> = values.into_iter().map(place).collect();
    places.ok_or_else(|| element.data.damaged("a negative size"))
}

/// All whole numbers of 64 bits of an element, if it holds such.
pub(super) fn long_words(element: &Element<'_>, meter: &MemoryBudget<'_>) -> Result<Option<Vec<u64>>, VariableFault> {
    if element.kind != DataKind::U64 {
        return Ok(None);
    }
    meter.take(element.count()? as u64, 8, "")?;
    let order = element.data.order;
    Ok(Some(element.data.rest().as_chunks().0.iter().map(|&bytes| order.u64(bytes)).collect()))
}

fn converted(kind: DataKind, bytes: &[u8], order: ByteOrder) -> Vec<f64> {
    match kind {
        DataKind::I8 => bytes.iter().map(|&byte| f64::from(byte as i8)).collect(),
        DataKind::U8 | DataKind::Utf8 => bytes.iter().map(|&byte| f64::from(byte)).collect(),
        DataKind::I16 => each(bytes, |two| f64::from(order.u16(two) as i16)),
        DataKind::U16 | DataKind::Utf16 => each(bytes, |two| f64::from(order.u16(two))),
        DataKind::I32 => each(bytes, |four| f64::from(order.u32(four) as i32)),
        DataKind::U32 | DataKind::Utf32 => each(bytes, |four| f64::from(order.u32(four))),
        DataKind::F32 => each(bytes, |four| f64::from(f32::from_bits(order.u32(four)))),
        DataKind::F64 => each(bytes, |eight| f64::from_bits(order.u64(eight))),
        // The nearest number: beyond 2^53 not every whole number has one of its own.
        DataKind::I64 => each(bytes, |eight| order.u64(eight) as i64 as f64),
        DataKind::U64 => each(bytes, |eight| order.u64(eight) as f64),
        DataKind::Matrix | DataKind::Packed => Vec::new(),
    }
}

fn each<const N: usize>(bytes: &[u8], number: impl Fn([u8; N]) -> f64) -> Vec<f64> {
    bytes.as_chunks::<N>().0.iter().map(|&chunk| number(chunk)).collect()
}

#[cfg(test)]
mod tests {
    use super::super::cursor::Cursor;
    use super::*;

    fn read(kind: u8, data: &[u8], count: usize) -> Result<Vec<f64>, VariableFault> {
        let bytes = [&[kind, 0, 0, 0, data.len() as u8, 0, 0, 0], data].concat();
        let element = Element::read(&mut Cursor::file(&bytes, ByteOrder::Little)).unwrap();
        numbers(&element, count, &MemoryBudget::new(1 << 10, &|_| false))
    }

    #[test]
    fn every_kind_of_number_becomes_the_nearest() {
        assert_eq!(read(1, &[0xff], 1), Ok(vec![-1.0]));
        assert_eq!(read(3, &[0xfe, 0xff], 1), Ok(vec![-2.0]));
        assert_eq!(read(5, &(-3_i32).to_le_bytes(), 1), Ok(vec![-3.0]));
        assert_eq!(read(7, &0.5_f32.to_le_bytes(), 1), Ok(vec![0.5]));
        assert_eq!(read(12, &(-4_i64).to_le_bytes(), 1), Ok(vec![-4.0]));
        assert_eq!(read(13, &u64::MAX.to_le_bytes(), 1), Ok(vec![18_446_744_073_709_551_616.0]));
    }

    #[test]
    fn too_few_numbers_are_damage_and_too_many_are_not_taken() {
        assert!(matches!(read(9, &[0; 8], 2), Err(VariableFault::Damaged { .. })));
        assert!(matches!(read(2, &[0; 200], 200), Err(VariableFault::TooLarge { .. })));
    }
}
