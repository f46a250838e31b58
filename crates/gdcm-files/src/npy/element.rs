//! What the elements of an array are.

use super::literal::Literal;
use crate::stored_number::{NumberClass, StoredNumber};

/// Why elements cannot be read.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum ElementFault {
    /// `NumPy` writes no such description.
    Damaged(String),
    /// `NumPy` does, this program does not read it.
    Unsupported { what: String, remedy: &'static str },
}

/// One element of an array: a `dtype.descr` of `NumPy`.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Element {
    Number(StoredNumber),
    /// Two floats: real and imaginary part.
    Complex(StoredNumber),
    /// Characters of 32 bits, zeros behind the last.
    Unicode {
        characters: usize,
        big_endian: bool,
    },
    /// Bytes, zeros behind the last.
    Bytes {
        count: usize,
    },
    /// Fields one after another.
    Record {
        fields: Vec<Field>,
        size: usize,
    },
}

/// One field of a record.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Field {
    /// The name; empty for bytes that only fill up.
    pub(super) name: String,
    pub(super) element: Element,
    /// A field may be an array by itself; rows one after another.
    pub(super) shape: Vec<usize>,
    /// Where the field begins in its record \[bytes\].
    pub(super) offset: usize,
}

impl Element {
    /// Number of bytes.
    pub(super) fn size(&self) -> usize {
        match self {
            Self::Number(number) => number.size(),
            Self::Complex(part) => 2 * part.size(),
            Self::Unicode { characters, .. } => 4 * characters,
            Self::Bytes { count } => *count,
            Self::Record { size, .. } => *size,
        }
    }

    /// Reads the value of `descr`: a short text such as "<f8", or a list of fields.
    pub(super) fn parse(descr: &Literal) -> Result<Self, ElementFault> {
        match descr {
            Literal::Text(code) => Self::parse_code(code),
            Literal::Sequence(fields) => Self::parse_record(fields),
            _ => Err(ElementFault::Damaged("the type of the elements is no text and no list".to_owned())),
        }
    }

    fn parse_code(code: &str) -> Result<Self, ElementFault> {
        let unknown = || ElementFault::Damaged(format!("\"{}\" is no type of elements", code.escape_default()));
        let (order, rest) = code.split_at_checked(1).ok_or_else(unknown)?;
        let big_endian = match order {
            "<" | "|" => false,
            ">" => true,
            "=" => cfg!(target_endian = "big"),
            _ => return Err(unknown()),
        };
        let (class, size) = rest.split_at_checked(1).ok_or_else(unknown)?;
        if let Some(fault) = unread(class, code) {
            return Err(fault);
        }
        let size: u32 = size.parse().map_err(|_| unknown())?;
        let size = size as usize;
        let number = |class, size| {
            let refuse =
                || ElementFault::Unsupported { what: format!("numbers of type {code}"), remedy: "save it as float64" };
            StoredNumber::new(class, size, big_endian).ok_or_else(refuse)
        };
        Ok(match class {
            "b" => Self::Number(number(NumberClass::Logical, size)?),
            "i" => Self::Number(number(NumberClass::Signed, size)?),
            "u" => Self::Number(number(NumberClass::Unsigned, size)?),
            "f" => Self::Number(number(NumberClass::Float, size)?),
            "c" => Self::Complex(number(NumberClass::Float, size / 2)?),
            "U" => Self::Unicode { characters: size, big_endian },
            "S" | "a" => Self::Bytes { count: size },
            "V" => Self::Record { fields: Vec::new(), size },
            _ => return Err(unknown()),
        })
    }

    fn parse_record(list: &[Literal]) -> Result<Self, ElementFault> {
        let too_large = || ElementFault::Damaged("a record is too large".to_owned());
        let (mut fields, mut offset) = (Vec::with_capacity(list.len()), 0usize);
        for entry in list {
            let field = Field::parse(entry, offset)?;
            let count = crate::places::count(&field.shape).ok_or_else(too_large)?;
            let length = count.checked_mul(field.element.size()).ok_or_else(too_large)?;
            offset = offset.checked_add(length).ok_or_else(too_large)?;
            // Bytes that only fill up have no name.
            if !field.name.is_empty() {
                fields.push(field);
            }
        }
        Ok(Self::Record { fields, size: offset })
    }
}

/// The classes that are refused, with the way out.
fn unread(class: &str, code: &str) -> Option<ElementFault> {
    let (what, remedy) = match class {
        "O" => ("an array of Python objects".to_owned(), "save plain arrays, one for each name"),
        "M" | "m" => (format!("dates or times of type {code}"), "save them as float64, with the unit in the name"),
        _ => return None,
    };
    Some(ElementFault::Unsupported { what, remedy })
}

impl Field {
    fn parse(entry: &Literal, offset: usize) -> Result<Self, ElementFault> {
        let wrong = || ElementFault::Damaged("a field of the records has no name and type".to_owned());
        let Literal::Sequence(parts) = entry else { return Err(wrong()) };
        let [name, descr, shape @ ..] = parts.as_slice() else { return Err(wrong()) };
        let name = match name {
            Literal::Text(name) => name.clone(),
            // A field with a title: (title, name).
            Literal::Sequence(titled) => match titled.as_slice() {
                [Literal::Text(_), Literal::Text(name)] => name.clone(),
                _ => return Err(wrong()),
            },
            _ => return Err(wrong()),
        };
        let shape = match shape {
            [] => Vec::new(),
            [shape] => sides(shape).ok_or_else(wrong)?,
            _ => return Err(wrong()),
        };
        Ok(Self { name, element: Element::parse(descr)?, shape, offset })
    }
}

/// The lengths along each dimension.
pub(super) fn sides(shape: &Literal) -> Option<Vec<usize>> {
    let Literal::Sequence(sides) = shape else { return None };
    let side = |side: &Literal| match side {
        Literal::Whole(side) => usize::try_from(*side).ok(),
        _ => None,
    };
    sides.iter().map(side).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parse(descr: &str) -> Result<Element, ElementFault> {
        Element::parse(&Literal::parse(descr).unwrap())
    }

    #[test]
    fn sizes_are_those_of_numpy() {
        for (descr, size) in
            [("'|b1'", 1), ("'>i8'", 8), ("'<f2'", 2), ("'<c8'", 8), ("'<U3'", 12), ("'|S5'", 5), ("'|V7'", 7)]
        {
            assert_eq!(parse(descr).unwrap().size(), size, "{descr}");
        }
        assert_eq!(parse("[('a', '<f8', (2, 3)), ('', '|V4'), ('b', '|u1')]").unwrap().size(), 53);
    }

    #[test]
    fn objects_dates_and_long_floats_come_with_a_way_out() {
        for descr in ["'|O'", "'<M8[ns]'", "'<f16'", "'<c32'", "'<i3'"] {
            assert!(matches!(parse(descr), Err(ElementFault::Unsupported { .. })), "{descr}");
        }
    }

    #[test]
    fn what_is_no_type_is_refused() {
        for descr in
            ["''", "'f8'", "'<'", "'<f'", "'<f-8'", "'<x8'", "'\u{e9}f8'", "'<\u{e9}8'", "3", "[('a',)]", "[3]"]
        {
            assert!(matches!(parse(descr), Err(ElementFault::Damaged(_))), "{descr}");
        }
        let huge = "[('a', '<f8', (9223372036854775807, 3))]";
        assert!(matches!(parse(huge), Err(ElementFault::Damaged(_))));
    }
}
