//! Types of array elements, given in a header by `descr`.
//!
//! ```text
//! type code   byte order (<, >, = or |), class letter, size: "<f8"; the size counts bytes, for U
//!             characters
//! record      a list of fields, each with name, type and possibly shape:
//!             [("omega", "<f8"), ("H", "<c16", (2, 2))]
//! ```
//!
//! The header is a Python literal; it arrives as JSON, with arrays for tuples (`python_literal`).

use serde_json::Value as Json;

use crate::formats::element_order::element_count;
use crate::formats::npy::TEXT_LENGTH_AT;
use crate::formats::stored_number::{NumberClass, StoredNumber};
use crate::reading_budget::VariableFault;
use crate::variable_fault::damage::Damage;
use crate::variable_fault::unsupported_content::UnsupportedContent;

/// Type of an array element, given by NumPy's `dtype.descr`.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Element {
    Number(StoredNumber),
    /// Complex number: two floats, the real and the imaginary part.
    Complex(StoredNumber),
    /// String of 32-bit characters, padded with zeros.
    Unicode {
        characters: usize,
        big_endian: bool,
    },
    /// Byte string, padded with zeros.
    Bytes {
        count: usize,
    },
    /// Record of consecutive fields; raw bytes (`V`) are a record without fields.
    Record {
        fields: Vec<Field>,
        /// Record size \[bytes\].
        size: usize,
    },
}

#[derive(Clone, Debug, PartialEq)]
pub(super) struct Field {
    /// Field name; empty for padding bytes.
    pub(super) name: String,
    pub(super) element: Element,
    /// Shape of the field if it is an array, which is stored in row-major order; empty for a single
    /// element.
    pub(super) shape: Vec<usize>,
    /// Field offset in its record \[bytes\].
    pub(super) offset: usize,
}

impl Element {
    /// Returns the element size \[bytes\].
    pub(super) fn size(&self) -> usize {
        match self {
            Self::Number(number) => number.size(),
            Self::Complex(part) => 2 * part.size(),
            Self::Unicode { characters, .. } => 4 * characters,
            Self::Bytes { count } => *count,
            Self::Record { size, .. } => *size,
        }
    }

    /// Parses the `descr` value: a type code such as "<f8", or a list of fields.
    pub(super) fn parse(descr: &Json) -> Result<Self, VariableFault> {
        match descr {
            Json::String(code) => Self::parse_code(code),
            Json::Array(fields) => Self::parse_record(fields),
            _ => Err(damaged(Damage::ElementTypeForm)),
        }
    }

    /// Parses a type code: byte order, class letter and size.
    fn parse_code(code: &str) -> Result<Self, VariableFault> {
        let (byte_order, rest) = code.split_at_checked(1).ok_or_else(|| unknown_code(code))?;
        let big_endian = match byte_order {
            "<" | "|" => false,
            ">" => true,
            "=" => cfg!(target_endian = "big"),
            _ => return Err(unknown_code(code)),
        };
        let (class_letter, size) = rest.split_at_checked(1).ok_or_else(|| unknown_code(code))?;
        refuse_class(class_letter, code)?;
        let size: u32 = size.parse().map_err(|_| unknown_code(code))?;
        let size = size as usize;
        let number_class = match class_letter {
            "b" => NumberClass::Logical,
            "i" => NumberClass::Signed,
            "u" => NumberClass::Unsigned,
            "f" | "c" => NumberClass::Float,
            "U" => {
                return Ok(Self::Unicode {
                    characters: size,
                    big_endian,
                });
            }
            "S" | "a" => return Ok(Self::Bytes { count: size }),
            "V" => {
                return Ok(Self::Record {
                    fields: Vec::new(),
                    size,
                });
            }
            _ => return Err(unknown_code(code)),
        };
        let is_complex = class_letter == "c";
        // A complex number's size includes both parts, which have the same size.
        let number_size = if is_complex { size / 2 } else { size };
        let is_divisible = !is_complex || size.is_multiple_of(2);
        let number = match StoredNumber::new(number_class, number_size, big_endian) {
            Some(number) if is_divisible => number,
            _ => {
                return Err(VariableFault::unsupported(
                    "",
                    UnsupportedContent::NumpyNumbers {
                        code: code.to_owned(),
                    },
                ));
            }
        };
        Ok(if is_complex {
            Self::Complex(number)
        } else {
            Self::Number(number)
        })
    }

    /// Parses a record's fields; each begins where the preceding field ends.
    fn parse_record(list: &[Json]) -> Result<Self, VariableFault> {
        let mut fields = Vec::with_capacity(list.len());
        let mut size = 0_usize;
        for entry in list {
            let field = Field::parse(entry, size)?;
            size = field.end().ok_or_else(|| damaged(Damage::RecordSize))?;
            // Skip padding bytes, which are fields without a name.
            if !field.name.is_empty() {
                fields.push(field);
            }
        }
        Ok(Self::Record { fields, size })
    }
}

/// Rejects Python objects, dates and times, which are not supported.
fn refuse_class(class: &str, code: &str) -> Result<(), VariableFault> {
    match class {
        "O" => Err(VariableFault::unsupported(
            "",
            UnsupportedContent::PythonObjects,
        )),
        "M" | "m" => Err(VariableFault::unsupported(
            "",
            UnsupportedContent::NumpyTimes {
                code: code.to_owned(),
            },
        )),
        _ => Ok(()),
    }
}

impl Field {
    /// Parses a field at `offset` \[bytes\]: name, type and, for an array, its shape.
    fn parse(entry: &Json, offset: usize) -> Result<Self, VariableFault> {
        let Json::Array(parts) = entry else {
            return Err(wrong_field());
        };
        let [name, descr, shape @ ..] = parts.as_slice() else {
            return Err(wrong_field());
        };
        let name = field_name(name).ok_or_else(wrong_field)?;
        let shape = match shape {
            [] => Vec::new(),
            [shape] => parse_sides(shape).ok_or_else(wrong_field)?,
            _ => return Err(wrong_field()),
        };
        Ok(Self {
            name: name.to_owned(),
            element: Element::parse(descr)?,
            shape,
            offset,
        })
    }

    /// Returns the offset just after the field; `None` on overflow.
    fn end(&self) -> Option<usize> {
        let length = element_count(&self.shape)?.checked_mul(self.element.size())?;
        self.offset.checked_add(length)
    }
}

/// Returns the field name: the string itself, or the second string in a (title, name) pair.
fn field_name(name: &Json) -> Option<&str> {
    match name {
        Json::String(name) => Some(name),
        Json::Array(titled) => match titled.as_slice() {
            [Json::String(_), Json::String(name)] => Some(name),
            _ => None,
        },
        _ => None,
    }
}

/// Parses the length along each dimension; `None` unless all are non-negative integers.
pub(super) fn parse_sides(shape: &Json) -> Option<Vec<usize>> {
    let Json::Array(sides) = shape else {
        return None;
    };
    sides
        .iter()
        .map(|side| usize::try_from(side.as_u64()?).ok())
        .collect()
}

fn wrong_field() -> VariableFault {
    damaged(Damage::RecordField)
}

fn unknown_code(code: &str) -> VariableFault {
    damaged(Damage::ElementTypeCode {
        code: code.to_owned(),
    })
}

/// Returns the error for a header that NumPy would not write, without the array name, which
/// `Header::parse` adds.
fn damaged(damage: Damage) -> VariableFault {
    VariableFault::damaged("", damage, TEXT_LENGTH_AT as u64)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::formats::npy::python_literal::parse_literal;

    fn parse(descr: &str) -> Result<Element, VariableFault> {
        Element::parse(&parse_literal(descr).unwrap())
    }

    #[test]
    fn sizes_are_those_of_numpy() {
        for (descr, size) in [
            ("'|b1'", 1),
            ("'>i8'", 8),
            ("'<f2'", 2),
            ("'<c8'", 8),
            ("'<U3'", 12),
            ("'|S5'", 5),
            ("'|V7'", 7),
        ] {
            assert_eq!(parse(descr).unwrap().size(), size, "{descr}");
        }
        assert_eq!(
            parse("[('a', '<f8', (2, 3)), ('', '|V4'), ('b', '|u1')]")
                .unwrap()
                .size(),
            53
        );
    }

    #[test]
    fn objects_dates_and_long_floats_come_with_a_remedy() {
        for descr in ["'|O'", "'<M8[ns]'", "'<f16'", "'<c32'", "'<c9'", "'<i3'"] {
            assert!(
                matches!(parse(descr), Err(VariableFault::Unsupported { .. })),
                "{descr}"
            );
        }
    }

    #[test]
    fn descriptions_that_are_no_type_are_refused() {
        for descr in [
            "''",
            "'f8'",
            "'<'",
            "'<f'",
            "'<f-8'",
            "'<x8'",
            "'\u{e9}f8'",
            "'<\u{e9}8'",
            "3",
            "[('a',)]",
            "[3]",
        ] {
            assert!(
                matches!(parse(descr), Err(VariableFault::Damaged { .. })),
                "{descr}"
            );
        }
        let huge = "[('a', '<f8', (9223372036854775807, 3))]";
        assert!(matches!(parse(huge), Err(VariableFault::Damaged { .. })));
    }
}
