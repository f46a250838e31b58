//! What stands before the contents of an array: its class, its flags, its shape and its name.
//!
//! Source: "MAT-File Format", The MathWorks, "miMATRIX Format".

use super::cursor::Cursor;
use super::element::{DataKind, Element};
use super::numbers::places;
use crate::variables::{ElementKind, MemoryBudget, VariableFault};

/// The class of an array.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum ArrayClass {
    Cell,
    Struct,
    Object,
    Char,
    Sparse,
    Float,
    Integer,
    FunctionHandle,
    Opaque,
}

/// What stands before the contents of an array.
#[derive(Clone, Debug)]
pub(super) struct Header {
    /// Its class.
    pub(super) class: ArrayClass,
    /// Whether its numbers are whole numbers of 64 bits without sign.
    pub(super) long_words: bool,
    /// Whether its numbers are true and false.
    pub(super) logical: bool,
    /// Whether its numbers have imaginary parts.
    pub(super) complex: bool,
    /// Number of elements along each dimension, at least two; of an opaque array 1 x 1.
    pub(super) shape: Vec<usize>,
    /// Number of elements.
    pub(super) count: usize,
    /// Its name; that of a value in another has no letters.
    pub(super) name: String,
}

impl Header {
    /// Reads what stands before the contents.
    pub(super) fn read(contents: &mut Cursor<'_>, meter: &MemoryBudget<'_>) -> Result<Self, VariableFault> {
        let flags = Element::read(contents)?;
        if flags.kind != DataKind::U32 {
            return Err(flags.data.damaged("an array without flags"));
        }
        let bits = { flags.data }.u32()?;
        let number = bits & 0xff;
        let class = ArrayClass::of(number)
            .ok_or_else(|| flags.data.damaged(format!("an array of the unknown class {number}")))?;
        let shape = if class == ArrayClass::Opaque { vec![1, 1] } else { shape(contents, meter)? };
        // Nobody who multiplies the sides shall come beyond what can be counted, not even on the way to none.
        let sides = shape.iter().try_fold(1_usize, |product, &length| product.checked_mul(length.max(1)));
        if sides.is_none() {
            meter.take(u64::MAX, 1, "")?;
        }
        Ok(Header {
            class,
            count: count(&shape),
            long_words: number == 15,
            logical: bits & 0x0200 != 0,
            complex: bits & 0x0800 != 0,
            shape,
            name: Element::read(contents)?.name()?,
        })
    }

    /// What its numbers are.
    pub(super) fn element_kind(&self) -> ElementKind {
        match self.class {
            _ if self.logical => ElementKind::Logical,
            ArrayClass::Integer => ElementKind::Integer,
            _ => ElementKind::Float,
        }
    }
}

impl ArrayClass {
    fn of(number: u32) -> Option<Self> {
        Some(match number {
            1 => ArrayClass::Cell,
            2 => ArrayClass::Struct,
            3 => ArrayClass::Object,
            4 => ArrayClass::Char,
            5 => ArrayClass::Sparse,
            6 | 7 => ArrayClass::Float,
            8..=15 => ArrayClass::Integer,
            16 => ArrayClass::FunctionHandle,
            17 => ArrayClass::Opaque,
            _ => return None,
        })
    }
}

/// Number of elements of an array of this shape, or the most that can be counted.
pub(super) fn count(shape: &[usize]) -> usize {
    let product = shape.iter().fold(1_usize, |product, &length| product.saturating_mul(length));
    if shape.contains(&0) { 0 } else { product }
}

fn shape(contents: &mut Cursor<'_>, meter: &MemoryBudget<'_>) -> Result<Vec<usize>, VariableFault> {
    let mut shape = places(&Element::read(contents)?, meter)?;
    while shape.len() < 2 {
        shape.push(1);
    }
    Ok(shape)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_array_with_a_side_of_none_has_no_elements_however_long_the_others_are() {
        assert_eq!(count(&[usize::MAX, usize::MAX, 0]), 0);
        assert_eq!(count(&[3, 4]), 12);
        assert_eq!(count(&[usize::MAX, 2]), usize::MAX);
    }
}
