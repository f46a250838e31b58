//! What the elements of an array are.

use crate::strides::{NumberClass, StoredNumber};
use crate::variables::VariableFault;

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
            let count = crate::strides::count(&field.shape).ok_or_else(too_large)?;
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

// What stands before the elements of an array.

/// What every `.npy` file begins with.
pub(super) const MAGIC: &[u8; 6] = b"\x93NUMPY";

/// The header of a `.npy` file (`numpy.lib.format`, versions 1.0 to 3.0).
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Header {
    pub(super) element: Element,
    pub(super) column_major: bool,
    /// As it stands in the file: of any number of dimensions, none included.
    pub(super) shape: Vec<usize>,
    /// Where the elements begin \[bytes\].
    pub(super) length: usize,
}

impl Header {
    /// Reads the header; `name` is what errors call the array.
    pub(super) fn parse(bytes: &[u8], name: &str) -> Result<Self, VariableFault> {
        let (text, length) = text(bytes, name)?;
        let damaged =
            |what: &str| VariableFault::Damaged { variable: name.to_owned(), what: what.to_owned(), offset: 8 };
        let Literal::Dictionary(mut entries) = Literal::parse(&text).map_err(damaged)? else {
            return Err(damaged("the header is no dictionary"));
        };
        let count = entries.len();
        let mut entry = |key: &str| {
            let at = entries.iter().position(|(name, _)| name == key)?;
            Some(entries.swap_remove(at).1)
        };
        let (Some(descr), Some(order), Some(shape), 3) =
            (entry("descr"), entry("fortran_order"), entry("shape"), count)
        else {
            return Err(damaged("the header has not the keys descr, fortran_order and shape"));
        };
        let Literal::Truth(column_major) = order else {
            return Err(damaged("fortran_order is neither True nor False"));
        };
        let shape = sides(&shape).ok_or_else(|| damaged("the shape is no tuple of whole numbers"))?;
        let element = Element::parse(&descr).map_err(|fault| match fault {
            ElementFault::Damaged(what) => damaged(&what),
            ElementFault::Unsupported { what, remedy } => {
                VariableFault::Unsupported { variable: name.to_owned(), what, remedy: remedy.to_owned() }
            }
        })?;
        Ok(Self { element, column_major, shape, length })
    }
}

/// The header's text, and where it ends.
fn text(bytes: &[u8], name: &str) -> Result<(String, usize), VariableFault> {
    if !bytes.starts_with(MAGIC) {
        let found = if bytes.is_empty() { "nothing" } else { "other bytes" };
        return Err(VariableFault::Format { expected: "an array of NumPy (.npy)", found: found.to_owned() });
    }
    let cut_off = || VariableFault::CutOff { variable: name.to_owned(), offset: bytes.len() as u64 };
    let &version = bytes.get(6).ok_or_else(cut_off)?;
    let from = match version {
        1 => 10,
        2 | 3 => 12,
        _ => {
            let what = format!("version {version} of the .npy format");
            let remedy = "save it with numpy.save of a plain array".to_owned();
            return Err(VariableFault::Unsupported { variable: name.to_owned(), what, remedy });
        }
    };
    let digits = bytes.get(8..from).ok_or_else(cut_off)?;
    let length = digits.iter().rev().fold(0, |length, &digit| length << 8 | usize::from(digit));
    let end = from.saturating_add(length);
    let text = bytes.get(from..end).ok_or_else(cut_off)?;
    // Versions 1 and 2 are in Latin-1, whose bytes are the first characters of Unicode; 3 is in UTF-8.
    let text = match version {
        3 => String::from_utf8(text.to_vec()).map_err(|_| VariableFault::Damaged {
            variable: name.to_owned(),
            what: "the header is not UTF-8".to_owned(),
            offset: from as u64,
        })?,
        _ => text.iter().copied().map(char::from).collect(),
    };
    Ok((text, end))
}

// The Python literals in which a header is written.

/// Deeper than any header that `NumPy` writes for values this program reads.
const DEEPEST: usize = 16;

/// A value of a header: the part of Python's literals that `numpy.lib.format` writes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Literal {
    Text(String),
    Whole(u64),
    Truth(bool),
    /// A tuple or a list.
    Sequence(Vec<Literal>),
    /// A dictionary whose keys are texts.
    Dictionary(Vec<(String, Literal)>),
}

impl Literal {
    /// Reads one literal, with blanks around it and nothing else; errors say in words what is wrong.
    pub(super) fn parse(text: &str) -> Result<Self, &'static str> {
        let mut scanner = Scanner { rest: text };
        let literal = scanner.value(DEEPEST)?;
        scanner.skip_blanks();
        if scanner.rest.is_empty() { Ok(literal) } else { Err("something follows the header's dictionary") }
    }
}

struct Scanner<'t> {
    rest: &'t str,
}

impl Scanner<'_> {
    fn skip_blanks(&mut self) {
        self.rest = self.rest.trim_start_matches([' ', '\t', '\r', '\n']);
    }

    fn take(&mut self, sign: char) -> bool {
        self.skip_blanks();
        let rest = self.rest.strip_prefix(sign);
        self.rest = rest.unwrap_or(self.rest);
        rest.is_some()
    }

    fn value(&mut self, depth: usize) -> Result<Literal, &'static str> {
        let deeper = depth.checked_sub(1).ok_or("the header is nested too deeply")?;
        self.skip_blanks();
        match self.rest.chars().next() {
            Some('\'' | '"') => Ok(Literal::Text(self.text()?)),
            Some('0'..='9') => self.whole(),
            Some('(') => self.sequence('(', ')', deeper),
            Some('[') => self.sequence('[', ']', deeper),
            Some('{') => self.dictionary(deeper),
            Some('T' | 'F') => self.truth(),
            Some(_) => Err("the header holds something that is no value"),
            None => Err("the header ends too early"),
        }
    }

    fn text(&mut self) -> Result<String, &'static str> {
        let quote = if self.rest.starts_with('"') { '"' } else { '\'' };
        let body = &self.rest[1..];
        let end = body.find(quote).ok_or("a text of the header does not end")?;
        let text = &body[..end];
        // Escapes would stand only in names of fields that hold quotes, backslashes or control characters.
        if text.contains('\\') {
            return Err("the header holds an escape");
        }
        self.rest = &body[end + 1..];
        Ok(text.to_owned())
    }

    fn whole(&mut self) -> Result<Literal, &'static str> {
        let end = self.rest.find(|sign: char| !sign.is_ascii_digit()).unwrap_or(self.rest.len());
        let (digits, rest) = self.rest.split_at(end);
        // Python 2 wrote an L behind long numbers.
        self.rest = rest.strip_prefix('L').unwrap_or(rest);
        digits.parse().map(Literal::Whole).map_err(|_| "a number of the header is too large")
    }

    fn truth(&mut self) -> Result<Literal, &'static str> {
        for (word, truth) in [("True", true), ("False", false)] {
            if let Some(rest) = self.rest.strip_prefix(word) {
                self.rest = rest;
                return Ok(Literal::Truth(truth));
            }
        }
        Err("the header holds something that is no value")
    }

    fn sequence(&mut self, open: char, close: char, depth: usize) -> Result<Literal, &'static str> {
        let mut values = Vec::new();
        self.take(open);
        while !self.take(close) {
            values.push(self.value(depth)?);
            if !self.take(',') && !self.rest.starts_with(close) {
                return Err("the header lacks a comma");
            }
        }
        Ok(Literal::Sequence(values))
    }

    fn dictionary(&mut self, depth: usize) -> Result<Literal, &'static str> {
        let mut entries = Vec::new();
        self.take('{');
        while !self.take('}') {
            let Literal::Text(key) = self.value(depth)? else { return Err("a key of the header is no text") };
            if !self.take(':') {
                return Err("the header lacks a colon");
            }
            entries.push((key, self.value(depth)?));
            if !self.take(',') && !self.rest.starts_with('}') {
                return Err("the header lacks a comma");
            }
        }
        Ok(Literal::Dictionary(entries))
    }
}

#[cfg(test)]
mod element_tests {
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

#[cfg(test)]
mod header_tests {
    use super::*;

    fn file(version: u8, text: &[u8]) -> Vec<u8> {
        let length = (text.len() as u32).to_le_bytes();
        let length = if version == 1 { &length[..2] } else { &length[..] };
        [MAGIC.as_slice(), &[version, 0], length, text].concat()
    }

    #[test]
    fn all_three_versions_are_read() {
        let text = b"{'descr': '<f8', 'fortran_order': True, 'shape': (2, 3), }\n";
        for version in 1..=3 {
            let header = Header::parse(&file(version, text), "x").unwrap();
            assert_eq!((header.column_major, header.shape), (true, vec![2, 3]));
        }
        assert!(matches!(Header::parse(&file(4, text), "x"), Err(VariableFault::Unsupported { .. })));
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
                matches!(Header::parse(&file(1, text.as_bytes()), "x"), Err(VariableFault::Damaged { .. })),
                "{text}"
            );
        }
        assert!(matches!(Header::parse(&file(3, &[0xff]), "x"), Err(VariableFault::Damaged { .. })));
        assert!(matches!(Header::parse(b"PK", "x"), Err(VariableFault::Format { .. })));
    }
}

#[cfg(test)]
mod literal_tests {
    use super::*;

    #[test]
    fn a_header_of_numpy_is_read() {
        let read =
            Literal::parse("{'descr': [('a', '<f8', (2,))], 'fortran_order': False, 'shape': (3, 4L), }   \n").unwrap();
        let text = |text: &str| Literal::Text(text.to_owned());
        let field = Literal::Sequence(vec![text("a"), text("<f8"), Literal::Sequence(vec![Literal::Whole(2)])]);
        let expected = Literal::Dictionary(vec![
            ("descr".to_owned(), Literal::Sequence(vec![field])),
            ("fortran_order".to_owned(), Literal::Truth(false)),
            ("shape".to_owned(), Literal::Sequence(vec![Literal::Whole(3), Literal::Whole(4)])),
        ]);
        assert_eq!(read, expected);
    }

    #[test]
    fn whatever_else_python_knows_is_refused() {
        for text in
            ["", "{", "{'a' 1}", "(1 2)", "-1", "1e3", "{1: 2}", "'a", "__import__('os')", "True1", "() ()", "'\\x00'"]
        {
            assert!(Literal::parse(text).is_err(), "{text}");
        }
        assert!(Literal::parse(&"(".repeat(100_000)).is_err());
        assert!(Literal::parse("99999999999999999999999").is_err());
    }
}
