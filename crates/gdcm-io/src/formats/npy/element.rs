//! Element types of arrays.

use serde_json::Value as Json;

use crate::formats::strides::{NumberClass, StoredNumber, count};
use crate::reading_budget::{ReadingBudget, VariableFault};

/// Returns the fault for a description that `NumPy` does not write.
fn damaged(what: impl Into<String>) -> VariableFault {
    VariableFault::damaged("", what, 8)
}

/// Type of an array element: a `dtype.descr` of `NumPy`.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Element {
    Number(StoredNumber),
    /// Two floats: real and imaginary part.
    Complex(StoredNumber),
    /// 32-bit characters, padded with zeros.
    Unicode {
        characters: usize,
        big_endian: bool,
    },
    /// Bytes, padded with zeros.
    Bytes {
        count: usize,
    },
    /// Consecutive fields.
    Record {
        fields: Vec<Field>,
        size: usize,
    },
}

/// One field of a record.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Field {
    /// Empty for padding bytes.
    pub(super) name: String,
    pub(super) element: Element,
    /// A field may be an array, stored by rows.
    pub(super) shape: Vec<usize>,
    /// Offset of the field in its record \[bytes\].
    pub(super) offset: usize,
}

impl Element {
    /// Size \[bytes\].
    pub(super) fn size(&self) -> usize {
        match self {
            Self::Number(number) => number.size(),
            Self::Complex(part) => 2 * part.size(),
            Self::Unicode { characters, .. } => 4 * characters,
            Self::Bytes { count } => *count,
            Self::Record { size, .. } => *size,
        }
    }

    /// Parses the value of `descr`: a short text such as "<f8", or a list of fields.
    pub(super) fn parse(descr: &Json) -> Result<Self, VariableFault> {
        match descr {
            Json::String(code) => Self::parse_code(code),
            Json::Array(fields) => Self::parse_record(fields),
            _ => Err(damaged("the type of the elements is no text and no list")),
        }
    }

    fn parse_code(code: &str) -> Result<Self, VariableFault> {
        let unknown = || {
            damaged(format!(
                "\"{}\" is no type of elements",
                code.escape_default()
            ))
        };
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
            let refuse = || {
                VariableFault::unsupported(
                    "",
                    format!("numbers of type {code}"),
                    "save it as float64",
                )
            };
            StoredNumber::new(class, size, big_endian).ok_or_else(refuse)
        };
        Ok(match class {
            "b" => Self::Number(number(NumberClass::Logical, size)?),
            "i" => Self::Number(number(NumberClass::Signed, size)?),
            "u" => Self::Number(number(NumberClass::Unsigned, size)?),
            "f" => Self::Number(number(NumberClass::Float, size)?),
            "c" => Self::Complex(number(NumberClass::Float, size / 2)?),
            "U" => Self::Unicode {
                characters: size,
                big_endian,
            },
            "S" | "a" => Self::Bytes { count: size },
            "V" => Self::Record {
                fields: Vec::new(),
                size,
            },
            _ => return Err(unknown()),
        })
    }

    fn parse_record(list: &[Json]) -> Result<Self, VariableFault> {
        let too_large = || damaged("a record is too large");
        let mut fields = Vec::with_capacity(list.len());
        let mut offset = 0usize;
        for entry in list {
            let field = Field::parse(entry, offset)?;
            let count = count(&field.shape).ok_or_else(too_large)?;
            let length = count
                .checked_mul(field.element.size())
                .ok_or_else(too_large)?;
            offset = offset.checked_add(length).ok_or_else(too_large)?;
            // Padding bytes have no name.
            if !field.name.is_empty() {
                fields.push(field);
            }
        }
        Ok(Self::Record {
            fields,
            size: offset,
        })
    }
}

/// Returns the fault, with instructions, for a refused type.
fn unread(class: &str, code: &str) -> Option<VariableFault> {
    let (what, remedy) = match class {
        "O" => (
            "an array of Python objects".to_owned(),
            "save plain arrays, one for each name",
        ),
        "M" | "m" => (
            format!("dates or times of type {code}"),
            "save them as float64, with the unit in the name",
        ),
        _ => return None,
    };
    Some(VariableFault::unsupported("", what, remedy))
}

impl Field {
    fn parse(entry: &Json, offset: usize) -> Result<Self, VariableFault> {
        let wrong = || damaged("a field of the records has no name and type");
        let Json::Array(parts) = entry else {
            return Err(wrong());
        };
        let [name, descr, shape @ ..] = parts.as_slice() else {
            return Err(wrong());
        };
        let name = match name {
            Json::String(name) => name.clone(),
            // A field with a title: (title, name).
            Json::Array(titled) => match titled.as_slice() {
                [Json::String(_), Json::String(name)] => name.clone(),
                _ => return Err(wrong()),
            },
            _ => return Err(wrong()),
        };
        let shape = match shape {
            [] => Vec::new(),
            [shape] => sides(shape).ok_or_else(wrong)?,
            _ => return Err(wrong()),
        };
        Ok(Self {
            name,
            element: Element::parse(descr)?,
            shape,
            offset,
        })
    }
}

/// Parses the lengths along each dimension.
fn sides(shape: &Json) -> Option<Vec<usize>> {
    let Json::Array(sides) = shape else {
        return None;
    };
    sides
        .iter()
        .map(|side| usize::try_from(side.as_u64()?).ok())
        .collect()
}

// Header before the elements of an array.

/// Signature of every `.npy` file.
pub(super) const MAGIC: &[u8; 6] = b"\x93NUMPY";

/// The header of a `.npy` file (`numpy.lib.format`, versions 1.0 to 3.0).
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Header {
    pub(super) element: Element,
    pub(super) column_major: bool,
    /// Shape as stored: any number of dimensions, including none.
    pub(super) shape: Vec<usize>,
    /// Offset of the elements \[bytes\].
    pub(super) length: usize,
}

impl Header {
    /// Parses the header; `name` is the name of the array in errors.
    pub(super) fn parse(
        bytes: &[u8],
        name: &str,
        budget: &ReadingBudget<'_>,
    ) -> Result<Self, VariableFault> {
        let (text, length) = text(bytes, name)?;
        let damaged = |what: &str| VariableFault::damaged(name, what, 8);
        // Memory of the JSON text and of the parsed tree.
        budget.take(text.len() as u64, 40, name)?;
        let header = json_of(&text).map_err(damaged)?;
        let entries = header.as_object().filter(|entries| entries.len() == 3);
        let entry = |key: &str| entries.and_then(|entries| entries.get(key));
        let (Some(descr), Some(order), Some(shape)) =
            (entry("descr"), entry("fortran_order"), entry("shape"))
        else {
            return Err(damaged(
                "the header has not the keys descr, fortran_order and shape",
            ));
        };
        let column_major = order
            .as_bool()
            .ok_or_else(|| damaged("fortran_order is neither True nor False"))?;
        let shape =
            sides(shape).ok_or_else(|| damaged("the shape is no tuple of whole numbers"))?;
        let element = Element::parse(descr).map_err(|fault| fault.of(|| name.to_owned()))?;
        Ok(Self {
            element,
            column_major,
            shape,
            length,
        })
    }
}

/// Returns the text of the header, and its end.
fn text(bytes: &[u8], name: &str) -> Result<(String, usize), VariableFault> {
    if !bytes.starts_with(MAGIC) {
        return Err(VariableFault::other_bytes(
            "an array of NumPy (.npy)",
            bytes,
        ));
    }
    let cut_off = || VariableFault::cut_off(name, bytes.len());
    let &version = bytes.get(6).ok_or_else(cut_off)?;
    let from = match version {
        1 => 10,
        2 | 3 => 12,
        _ => {
            let what = format!("version {version} of the .npy format");
            return Err(VariableFault::unsupported(
                name,
                what,
                "save it with numpy.save of a plain array",
            ));
        }
    };
    let digits = bytes.get(8..from).ok_or_else(cut_off)?;
    let length = digits
        .iter()
        .rev()
        .fold(0, |length, &digit| length << 8 | usize::from(digit));
    let end = from.saturating_add(length);
    let text = bytes.get(from..end).ok_or_else(cut_off)?;
    // Versions 1 and 2 use Latin-1, whose codes are the first characters of Unicode; version 3 uses
    // UTF-8.
    let text = match version {
        3 => String::from_utf8(text.to_vec())
            .map_err(|_| VariableFault::damaged(name, "the header is not UTF-8", from as u64))?,
        _ => text.iter().copied().map(char::from).collect(),
    };
    Ok((text, end))
}

// Python literals of headers.

/// Converts a header, which is a Python literal, to JSON: quotes, tuples as lists, trailing commas,
/// and the words for true and false.
fn json_of(text: &str) -> Result<Json, &'static str> {
    let mut json = String::with_capacity(text.len());
    let mut rest = text;
    while let Some(sign) = rest.chars().next() {
        let length = match sign {
            '\'' | '"' => {
                let end = rest[1..]
                    .find(sign)
                    .ok_or("a text of the header does not end")?;
                // Escapes occur only in field names with quotes, backslashes or control characters.
                if rest[1..=end].contains('\\') {
                    return Err("the header holds an escape");
                }
                json.push_str(&Json::from(&rest[1..=end]).to_string());
                end + 2
            }
            'T' | 'F' | 't' | 'f' | 'n' => {
                let end = rest
                    .find(|sign: char| !sign.is_alphanumeric())
                    .unwrap_or(rest.len());
                json.push_str(match &rest[..end] {
                    "True" => "true",
                    "False" => "false",
                    _ => return Err("the header holds something that is no value"),
                });
                end
            }
            '(' | '[' => {
                json.push('[');
                1
            }
            ')' | ']' | '}' => {
                if json.ends_with(',') {
                    json.pop();
                }
                json.push(if sign == '}' { '}' } else { ']' });
                1
            }
            // Python 2 appends an L to long integers.
            ' ' | '\t' | '\r' | '\n' | 'L' => 1,
            _ => {
                json.push(sign);
                sign.len_utf8()
            }
        };
        rest = &rest[length..];
    }
    serde_json::from_str(&json)
        .map_err(|_| "the header is no dictionary of texts, numbers and tuples")
}

#[cfg(test)]
mod element_tests {
    use super::*;

    fn parse(descr: &str) -> Result<Element, VariableFault> {
        Element::parse(&json_of(descr).unwrap())
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
    fn objects_dates_and_long_floats_come_with_a_way_out() {
        for descr in ["'|O'", "'<M8[ns]'", "'<f16'", "'<c32'", "'<i3'"] {
            assert!(
                matches!(parse(descr), Err(VariableFault::Unsupported { .. })),
                "{descr}"
            );
        }
    }

    #[test]
    fn what_is_no_type_is_refused() {
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

#[cfg(test)]
mod header_tests {
    use super::*;

    fn header_of(bytes: &[u8]) -> Result<Header, VariableFault> {
        Header::parse(bytes, "x", &ReadingBudget::new(1 << 20))
    }

    fn file(version: u8, text: &[u8]) -> Vec<u8> {
        let length = (text.len() as u32).to_le_bytes();
        let length = if version == 1 {
            &length[..2]
        } else {
            &length[..]
        };
        [MAGIC.as_slice(), &[version, 0], length, text].concat()
    }

    #[test]
    fn all_three_versions_are_read() {
        let text = b"{'descr': '<f8', 'fortran_order': True, 'shape': (2, 3), }\n";
        for version in 1..=3 {
            let header = header_of(&file(version, text)).unwrap();
            assert_eq!((header.column_major, header.shape), (true, vec![2, 3]));
        }
        assert!(matches!(
            header_of(&file(4, text)),
            Err(VariableFault::Unsupported { .. })
        ));
    }

    #[test]
    fn a_header_needs_its_three_keys_and_no_other() {
        for text in [
            "{'descr': '<f8', 'fortran_order': True}",
            "{'descr': '<f8', 'fortran_order': True, 'shape': (), 'more': 1}",
            "{'descr': '<f8', 'descr': '<f8', 'shape': ()}",
            "{'descr': '<f8', 'fortran_order': 1, 'shape': ()}",
            "{'descr': '<f8', 'fortran_order': True, 'shape': 3}",
            "[]",
        ] {
            assert!(
                matches!(
                    header_of(&file(1, text.as_bytes())),
                    Err(VariableFault::Damaged { .. })
                ),
                "{text}"
            );
        }
        assert!(matches!(
            header_of(&file(3, &[0xff])),
            Err(VariableFault::Damaged { .. })
        ));
        assert!(matches!(
            header_of(b"PK"),
            Err(VariableFault::Format { .. })
        ));
    }
}

#[cfg(test)]
mod literal_tests {
    use serde_json::json;

    use super::*;

    #[test]
    fn a_header_of_numpy_is_read() {
        let read = json_of(
            "{'descr': [('a', '<f8', (2,))], 'fortran_order': False, 'shape': (3, 4L), }   \n",
        )
        .unwrap();
        assert_eq!(
            read,
            json!({"descr": [["a", "<f8", [2]]], "fortran_order": false, "shape": [3, 4]})
        );
    }

    #[test]
    fn whatever_else_python_knows_is_refused() {
        for text in [
            "",
            "{",
            "{'a' 1}",
            "{1: 2}",
            "'a",
            "__import__('os')",
            "True1",
            "() ()",
            "'\\x00'",
        ] {
            assert!(json_of(text).is_err(), "{text}");
        }
        assert!(json_of(&"(".repeat(100_000)).is_err());
    }
}
