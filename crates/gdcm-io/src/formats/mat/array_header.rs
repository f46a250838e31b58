//! Header of an array: three elements that precede its contents.
//!
//! ```text
//! flags   two 32-bit words; the lowest byte of the first is the number of the class
//! shape   a 32-bit integer for each dimension; missing in opaque arrays
//! name    of the variable; empty in nested arrays
//! ```
//!
//! Source: "MAT-File Format", The MathWorks, "miMATRIX Format".

use crate::formats::element_order;
use crate::formats::mat::cursor::Cursor;
use crate::formats::mat::element::{DataKind, Element};
use crate::formats::mat::numbers::read_sizes;
use crate::formats::variables::ElementKind;
use crate::reading_budget::{ReadingBudget, VariableFault};
use crate::variable_fault::damage::Damage;

/// Bits in the first word that hold the class number.
const CLASS_BITS: u32 = 0xff;
/// Flag for logical arrays.
pub(super) const LOGICAL: u32 = 0x0200;
/// Flag for complex arrays.
pub(super) const COMPLEX: u32 = 0x0800;
/// Class number for unsigned 64-bit integers.
const UINT64: u32 = 15;

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

#[derive(Clone, Debug)]
pub(super) struct ArrayHeader {
    pub(super) class: ArrayClass,
    /// Whether the elements are unsigned 64-bit integers, which `object_part.rs` reads without
    /// rounding.
    pub(super) has_long_words: bool,
    pub(super) is_logical: bool,
    pub(super) is_complex: bool,
    /// Length along each dimension. There are at least two dimensions; an opaque array is 1 x 1.
    pub(super) shape: Vec<usize>,
    pub(super) count: usize,
    /// Variable name; empty for an array nested in another.
    pub(super) name: String,
}

impl ArrayHeader {
    /// Reads an array's header and moves `contents` past it.
    pub(super) fn read(
        contents: &mut Cursor<'_>,
        budget: &ReadingBudget<'_>,
    ) -> Result<Self, VariableFault> {
        let flags = Element::read(contents)?;
        if flags.kind != DataKind::U32 {
            return Err(flags.data.damaged(Damage::ArrayWithoutFlags));
        }
        let mut words = flags.data;
        let bits = words.read_u32()?;
        let number = bits & CLASS_BITS;
        let Some(class) = ArrayClass::from_number(number) else {
            return Err(flags.data.damaged(Damage::UnknownArrayClass { number }));
        };
        let shape = if class == ArrayClass::Opaque {
            vec![1, 1]
        } else {
            read_shape(contents, budget)?
        };
        // Reject a shape whose nonzero dimensions have a product that overflows, as too large for
        // any budget.
        if element_order::element_count(&shape).is_none() {
            budget.take(u64::MAX, 1, "")?;
        }
        Ok(ArrayHeader {
            class,
            count: saturating_count(&shape),
            has_long_words: number == UINT64,
            is_logical: bits & LOGICAL != 0,
            is_complex: bits & COMPLEX != 0,
            shape,
            name: Element::read(contents)?.name()?,
        })
    }

    /// Returns the array's element kind; numbers in a sparse array are floats, unless they are
    /// logical.
    pub(super) fn element_kind(&self) -> ElementKind {
        if self.is_logical {
            return ElementKind::Logical;
        }
        match self.class {
            ArrayClass::Integer => ElementKind::Integer,
            _ => ElementKind::Float,
        }
    }
}

impl ArrayClass {
    fn from_number(number: u32) -> Option<Self> {
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

/// Returns an array's element count; `usize::MAX` if the product of the dimensions overflows.
pub(super) fn saturating_count(shape: &[usize]) -> usize {
    if shape.contains(&0) {
        return 0;
    }
    let mut count = 1_usize;
    for &side in shape {
        count = count.saturating_mul(side);
    }
    count
}

/// Reads the length along each dimension; appends ones until there are two dimensions.
fn read_shape(
    contents: &mut Cursor<'_>,
    budget: &ReadingBudget<'_>,
) -> Result<Vec<usize>, VariableFault> {
    let mut shape = read_sizes(&Element::read(contents)?, budget)?;
    while shape.len() < 2 {
        shape.push(1);
    }
    Ok(shape)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_array_with_an_empty_side_has_no_elements() {
        assert_eq!(saturating_count(&[usize::MAX, usize::MAX, 0]), 0);
        assert_eq!(saturating_count(&[3, 4]), 12);
        assert_eq!(saturating_count(&[usize::MAX, 2]), usize::MAX);
    }
}
