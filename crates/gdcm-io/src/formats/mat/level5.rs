//! Files of levels 5 to 7: a header, and one element for each variable.
//!
//! Source: "MAT-File Format", The MathWorks, "Level 5 MAT-File Format".

use std::collections::HashSet;
use std::io::{ErrorKind, Read};

use flate2::read::ZlibDecoder;

use crate::formats::mat;
use crate::formats::mat::matrix::Arrays;
use crate::formats::mat::{FieldPath, Header};
use crate::formats::strides::{NumberClass, StoredNumber};
use crate::formats::variables::Variable;
use crate::reading_budget::{ReadingBudget, VariableFault};

/// Length of the file header, text and numbers \[bytes\].
pub(super) const HEADER_BYTES: usize = 128;
/// Offset of the version in the header.
const VERSION_AT: usize = 124;
/// Offset of the position of the objects in the header.
const OBJECTS_AT: usize = 116;

/// Reads the byte order and the major version; `None` if the header is not from such a file.
pub(super) fn version(bytes: &[u8]) -> Option<(ByteOrder, u8)> {
    match *bytes.get(VERSION_AT..HEADER_BYTES)? {
        [_, version, b'I', b'M'] => Some((ByteOrder::Little, version)),
        [version, _, b'M', b'I'] => Some((ByteOrder::Big, version)),
        _ => None,
    }
}

/// Reads all variables of a file.
pub(super) fn read(
    bytes: &[u8],
    order: ByteOrder,
    budget: &ReadingBudget<'_>,
) -> Result<Vec<Variable>, VariableFault> {
    let objects = match mat::objects(bytes, objects_at(bytes, order), order, budget) {
        Ok(objects) => Ok(objects),
        Err(fault) if fault.is_of_the_budget() => return Err(fault),
        Err(VariableFault::Damaged { what, .. }) => {
            Err(format!("the objects of this file cannot be read: {what}"))
        }
        Err(fault) => Err(format!("the objects of this file cannot be read: {fault}")),
    };
    let arrays = Arrays {
        budget,
        objects: objects.as_ref().map_err(String::as_str),
    };
    let mut file = Cursor::file(bytes, order);
    file.pass(HEADER_BYTES)?;
    let mut variables = Vec::new();
    let mut names = HashSet::new();
    while !file.is_empty() {
        budget.take(1, 2 * size_of::<Variable>() as u64, "")?;
        // Arrays without a name are internal to MATLAB, mainly the objects.
        let Some(variable) = variable(&mut file, &arrays)? else {
            continue;
        };
        if !names.insert(variable.name.clone()) {
            return Err(VariableFault::Duplicate {
                name: variable.name,
            });
        }
        variables.push(variable);
    }
    Ok(variables)
}

/// Reads the position of the objects, which old versions leave blank.
fn objects_at(bytes: &[u8], order: ByteOrder) -> Option<usize> {
    let place: [u8; 8] = bytes.get(OBJECTS_AT..VERSION_AT)?.try_into().ok()?;
    if place == [b' '; 8] || place == [0; 8] {
        None
    } else {
        usize::try_from(order.u64(place)).ok()
    }
}

fn variable(file: &mut Cursor<'_>, arrays: &Arrays<'_>) -> Result<Option<Variable>, VariableFault> {
    let start = *file;
    let element = Element::read(file)?;
    if element.kind != DataKind::Packed {
        let mut contents = matrix(element)?;
        let variable = named(&mut contents, arrays)?;
        *file = behind(start, element, contents, *file)?;
        return Ok(variable);
    }
    let bytes = unpacked(element.data, arrays.budget)?;
    let mut inner = Cursor::unpacked(&bytes, element.data.order, element.data.offset);
    named(&mut matrix(Element::read(&mut inner)?)?, arrays)
}

fn named(
    contents: &mut Cursor<'_>,
    arrays: &Arrays<'_>,
) -> Result<Option<Variable>, VariableFault> {
    let header = Header::read(contents, arrays.budget)?;
    if header.name.is_empty() {
        Element::pass_all(contents)?;
        return Ok(None);
    }
    let value = arrays.contents(&header, contents, &FieldPath::start(&header.name))?;
    Ok(Some(Variable {
        name: header.name,
        value,
    }))
}

/// Finds the next array after the array at `start`. Its `unread` bytes do not belong to it if
/// nothing begins at the end given by its tag: GNU Octave counts too many bytes for some texts and
/// objects.
pub(super) fn behind<'b>(
    start: Cursor<'b>,
    array: Element<'b>,
    unread: Cursor<'b>,
    end: Cursor<'b>,
) -> Result<Cursor<'b>, VariableFault> {
    if unread.is_empty() || (array.whole && Element::begins_array(&end)) {
        return Ok(end);
    }
    let mut behind = start;
    behind.pass(8 + array.data.len().saturating_sub(unread.len()))?;
    Ok(behind)
}

/// Returns the contents of an element that must be an array.
pub(super) fn matrix(element: Element<'_>) -> Result<Cursor<'_>, VariableFault> {
    match element.kind {
        DataKind::Matrix => Ok(element.data),
        _ => Err(element
            .data
            .damaged("something else where an array should stand")),
    }
}

// Sequential reading in the byte order of the file.

/// Byte order of a number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum ByteOrder {
    Little,
    Big,
}

/// A position in a stretch of bytes that reading cannot leave.
///
/// Its faults name no variable: [`crate::formats::mat::FieldPath::name`] adds the name.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cursor<'b> {
    bytes: &'b [u8],
    pub(super) order: ByteOrder,
    /// Offset of the next byte in the file.
    pub(super) offset: u64,
    stretch: Stretch,
}

/// Origin of a stretch of bytes, which decides the fault when it ends too early.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Stretch {
    /// The file itself, which is cut off.
    File,
    /// An element of the file, whose size is wrong.
    Element,
    /// An unpacked element: its position is the beginning of the packed element.
    Unpacked,
}

impl<'b> Cursor<'b> {
    /// Starts at the beginning of a file.
    pub(super) fn file(bytes: &'b [u8], order: ByteOrder) -> Self {
        Self {
            bytes,
            order,
            offset: 0,
            stretch: Stretch::File,
        }
    }

    /// Starts at the beginning of unpacked or embedded bytes at `offset` of the file.
    pub(super) fn unpacked(bytes: &'b [u8], order: ByteOrder, offset: u64) -> Self {
        Self {
            bytes,
            order,
            offset,
            stretch: Stretch::Unpacked,
        }
    }

    /// Returns the remaining bytes.
    pub(super) fn rest(&self) -> &'b [u8] {
        self.bytes
    }

    /// Number of remaining bytes.
    pub(super) fn len(&self) -> usize {
        self.bytes.len()
    }

    /// Whether no bytes remain.
    pub(super) fn is_empty(&self) -> bool {
        self.bytes.is_empty()
    }

    /// Takes the next `length` bytes as an element.
    pub(super) fn take(&mut self, length: usize) -> Result<Cursor<'b>, VariableFault> {
        let (bytes, rest) = self
            .bytes
            .split_at_checked(length)
            .ok_or_else(|| self.too_short())?;
        let stretch = if self.stretch == Stretch::File {
            Stretch::Element
        } else {
            self.stretch
        };
        let taken = Cursor {
            bytes,
            order: self.order,
            offset: self.offset,
            stretch,
        };
        self.bytes = rest;
        if self.stretch != Stretch::Unpacked {
            self.offset = self.offset.saturating_add(length as u64);
        }
        Ok(taken)
    }

    /// Takes all remaining bytes and moves to their end. If they are too few, the fault refers to
    /// this stretch.
    pub(super) fn take_all(&mut self) -> Result<Cursor<'b>, VariableFault> {
        let rest = *self;
        self.pass(rest.len())?;
        Ok(rest)
    }

    /// Skips `length` bytes, or all remaining bytes.
    pub(super) fn pass(&mut self, length: usize) -> Result<(), VariableFault> {
        self.take(length.min(self.len())).map(drop)
    }

    /// Reads the next `N` bytes.
    pub(super) fn array<const N: usize>(&mut self) -> Result<[u8; N], VariableFault> {
        let taken = self.take(N)?;
        <[u8; N]>::try_from(taken.bytes).map_err(|_| self.too_short())
    }

    /// Reads a 32-bit integer.
    pub(super) fn u32(&mut self) -> Result<u32, VariableFault> {
        let order = self.order;
        let bytes = self.array()?;
        Ok(order.u32(bytes))
    }

    /// Returns the fault for bytes at this position that contradict the format.
    pub(super) fn damaged(&self, what: impl Into<String>) -> VariableFault {
        VariableFault::damaged("", what, self.offset)
    }

    fn too_short(&self) -> VariableFault {
        match self.stretch {
            Stretch::File => VariableFault::CutOff {
                variable: String::new(),
                offset: self.offset,
            },
            _ => self.damaged("an element is longer than the one it lies in"),
        }
    }
}

impl ByteOrder {
    /// Decodes a 32-bit integer.
    pub(super) fn u32(self, bytes: [u8; 4]) -> u32 {
        match self {
            ByteOrder::Little => u32::from_le_bytes(bytes),
            ByteOrder::Big => u32::from_be_bytes(bytes),
        }
    }

    /// Decodes a 64-bit integer.
    pub(super) fn u64(self, bytes: [u8; 8]) -> u64 {
        match self {
            ByteOrder::Little => u64::from_le_bytes(bytes),
            ByteOrder::Big => u64::from_be_bytes(bytes),
        }
    }
}

// One data element: a tag with the kind and length of the data, and the data.
//
// Source: "MAT-File Format", The MathWorks, "Data Element Format".

/// Data type of an element.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum DataKind {
    I8 = 1,
    U8 = 2,
    I16 = 3,
    U16 = 4,
    I32 = 5,
    U32 = 6,
    F32 = 7,
    F64 = 9,
    I64 = 12,
    U64 = 13,
    Matrix = 14,
    Packed = 15,
    Utf8 = 16,
    Utf16 = 17,
    Utf32 = 18,
}

/// A data element.
#[derive(Clone, Copy, Debug)]
pub(super) struct Element<'b> {
    pub(super) kind: DataKind,
    /// Without the padding to eight bytes.
    pub(super) data: Cursor<'b>,
    /// Whether all bytes announced by the tag are present; an array may have fewer.
    pub(super) whole: bool,
}

/// All data types with their number types; matrices and packed data have none.
const KINDS: [(DataKind, Option<(NumberClass, usize)>); 15] = [
    (DataKind::I8, Some((NumberClass::Signed, 1))),
    (DataKind::U8, Some((NumberClass::Unsigned, 1))),
    (DataKind::I16, Some((NumberClass::Signed, 2))),
    (DataKind::U16, Some((NumberClass::Unsigned, 2))),
    (DataKind::I32, Some((NumberClass::Signed, 4))),
    (DataKind::U32, Some((NumberClass::Unsigned, 4))),
    (DataKind::F32, Some((NumberClass::Float, 4))),
    (DataKind::F64, Some((NumberClass::Float, 8))),
    (DataKind::I64, Some((NumberClass::Signed, 8))),
    (DataKind::U64, Some((NumberClass::Unsigned, 8))),
    (DataKind::Matrix, None),
    (DataKind::Packed, None),
    (DataKind::Utf8, Some((NumberClass::Unsigned, 1))),
    (DataKind::Utf16, Some((NumberClass::Unsigned, 2))),
    (DataKind::Utf32, Some((NumberClass::Unsigned, 4))),
];

impl DataKind {
    fn of(number: u32) -> Option<Self> {
        KINDS
            .iter()
            .map(|(kind, _)| *kind)
            .find(|kind| *kind as u32 == number)
    }

    /// Returns the number type, if the element holds numbers.
    pub(super) fn stored(self, order: ByteOrder) -> Option<StoredNumber> {
        let (class, size) = KINDS.iter().find(|(kind, _)| *kind == self)?.1?;
        StoredNumber::new(class, size, order == ByteOrder::Big)
    }
}

impl<'b> Element<'b> {
    /// Reads the next element and its padding.
    pub(super) fn read(cursor: &mut Cursor<'b>) -> Result<Self, VariableFault> {
        let tag = *cursor;
        let unknown = |number: u32| tag.damaged(format!("an element of the unknown kind {number}"));
        let first = cursor.u32()?;
        // A small element holds up to four bytes in its tag, whose upper half is their number.
        let small = first >> 16;
        if small != 0 {
            let number = first & 0xffff;
            let kind = DataKind::of(number).ok_or_else(|| unknown(number))?;
            let data = cursor.take(4)?.take(small as usize)?;
            return Ok(Self {
                kind,
                data,
                whole: true,
            });
        }
        let kind = DataKind::of(first).ok_or_else(|| unknown(first))?;
        let length = cursor.u32()? as usize;
        if kind == DataKind::Matrix && length > cursor.len() {
            // GNU Octave announces a few bytes too many for some arrays.
            return Ok(Self {
                kind,
                data: cursor.take_all()?,
                whole: false,
            });
        }
        let data = cursor.take(length)?;
        if kind != DataKind::Packed {
            cursor.pass(length.wrapping_neg() % 8)?;
        }
        Ok(Self {
            kind,
            data,
            whole: true,
        })
    }

    /// Whether an array or the end of the data is at the cursor.
    pub(super) fn begins_array(cursor: &Cursor<'_>) -> bool {
        let mut tag = *cursor;
        let kind = tag.u32().map(DataKind::of);
        let length = tag.u32();
        let fits = length.is_ok_and(|length| length as usize <= tag.len());
        cursor.is_empty() || (fits && matches!(kind, Ok(Some(DataKind::Matrix | DataKind::Packed))))
    }

    /// Skips all remaining elements.
    pub(super) fn pass_all(cursor: &mut Cursor<'_>) -> Result<(), VariableFault> {
        while !cursor.is_empty() {
            Element::read(cursor)?;
        }
        Ok(())
    }

    /// Number of values in the element.
    pub(super) fn count(&self) -> Result<usize, VariableFault> {
        let stored = self.kind.stored(self.data.order);
        let width = stored
            .ok_or_else(|| self.data.damaged("a matrix where numbers should stand"))?
            .size();
        if !self.data.len().is_multiple_of(width) {
            return Err(self.data.damaged(format!(
                "{} bytes of numbers of {width} bytes each",
                self.data.len()
            )));
        }
        Ok(self.data.len() / width)
    }

    /// Reads a name, one byte for each character.
    pub(super) fn name(&self) -> Result<String, VariableFault> {
        match self.kind {
            DataKind::I8 | DataKind::U8 | DataKind::Utf8 => Ok(name_of(self.data.rest())),
            _ => Err(self.data.damaged("numbers where a name should stand")),
        }
    }
}

/// Decodes a name up to the first zero; bytes that are not UTF-8 are read as Latin-1, the encoding
/// of old programs.
pub(super) fn name_of(bytes: &[u8]) -> String {
    let bytes = bytes.split(|&byte| byte == 0).next().unwrap_or_default();
    match std::str::from_utf8(bytes) {
        Ok(name) => name.to_owned(),
        Err(_) => bytes.iter().copied().map(char::from).collect(),
    }
}

// Packed arrays.
//
// Source: "MAT-File Format", The MathWorks, "Data Compression"; RFC 1950.

/// Largest ratio of unpacked to packed bytes, rounded up (RFC 1951: 258 bytes from two bits).
const MOST_EXPANSION: u64 = 1040;
/// Number of bytes unpacked between two checks of the budget.
const CHUNK: u64 = 1 << 20;

/// Unpacks an element: its tag, and the bytes announced by the tag.
pub(super) fn unpacked(
    packed: Cursor<'_>,
    budget: &ReadingBudget<'_>,
) -> Result<Vec<u8>, VariableFault> {
    let mut decoder = ZlibDecoder::new(packed.rest());
    let mut bytes = Vec::new();
    unpack_more(&mut decoder, 8, &mut bytes, packed, budget)?;
    let mut tag = Cursor::unpacked(&bytes, packed.order, packed.offset);
    tag.pass(4)?;
    let length = u64::from(tag.u32()?);
    if length > (packed.len() as u64).saturating_mul(MOST_EXPANSION) {
        return Err(packed.damaged(format!(
            "{} packed bytes that claim to hold {length}",
            packed.len()
        )));
    }
    unpack_more(&mut decoder, length, &mut bytes, packed, budget)?;
    // The checksum at the end is compared when the end is read.
    let more = decoder
        .read(&mut [0])
        .map_err(|_| packed.damaged("the packed bytes were changed"))?;
    if more != 0 {
        return Err(packed.damaged("more packed bytes than they say themselves"));
    }
    Ok(bytes)
}

fn unpack_more(
    decoder: &mut impl Read,
    length: u64,
    bytes: &mut Vec<u8>,
    packed: Cursor<'_>,
    budget: &ReadingBudget<'_>,
) -> Result<(), VariableFault> {
    let mut left = length;
    while left > 0 {
        let chunk = left.min(CHUNK);
        // Vectors grow by doubling.
        budget.take(2 * chunk, 1, "")?;
        let found = decoder
            .by_ref()
            .take(chunk)
            .read_to_end(bytes)
            .map_err(|error| match error.kind() {
                ErrorKind::UnexpectedEof => packed.damaged("the packed bytes end too early"),
                _ => packed.damaged("the packed bytes were changed"),
            })?;
        if (found as u64) < chunk {
            // GNU Octave announces too many bytes; whether too few are present shows when they are
            // read.
            return Ok(());
        }
        left -= chunk;
    }
    Ok(())
}

#[cfg(test)]
mod level5_tests {
    use super::*;
    use crate::formats::mat::sample_tests::{chars, doubles, element, file, matrix, record};
    use crate::formats::variables::Value;

    /// The same array with a tag that counts four bytes too many.
    fn too_long(array: Vec<u8>) -> Vec<u8> {
        let length = array.len() as u32 - 8 + 4;
        [&array[..4], &length.to_le_bytes(), &array[8..]].concat()
    }

    fn variables(bytes: &[u8]) -> Result<Vec<Variable>, VariableFault> {
        read(bytes, ByteOrder::Little, &ReadingBudget::new(1 << 16))
    }

    #[test]
    fn the_header_says_how_the_file_is_written() {
        assert_eq!(version(&file(&[])), Some((ByteOrder::Little, 1)));
        assert_eq!(
            version(&[&[b' '; 124][..], b"\x01\0MI"].concat()),
            Some((ByteOrder::Big, 1))
        );
        assert_eq!(version(&[b' '; 128]), None);
    }

    #[test]
    fn arrays_that_octave_counts_too_long_are_read_with_what_follows_them() {
        let text = too_long(chars("ch", "acbd"));
        let last = too_long(doubles("last", &[1, 1], &[2.0]));
        let found =
            variables(&file(&[text, doubles("x", &[1, 1], &[1.0]), last].concat())).unwrap();
        assert_eq!(
            found
                .iter()
                .map(|variable| variable.name.as_str())
                .collect::<Vec<_>>(),
            ["ch", "x", "last"]
        );
    }

    #[test]
    fn arrays_within_others_that_octave_counts_too_long_are_read_too() {
        let fields = [
            ("a", too_long(chars("", "acbd"))),
            ("b", too_long(doubles("", &[1, 1], &[1.0]))),
        ];
        let found = variables(&file(&too_long(record("s", &fields)))).unwrap();
        let Value::Struct(records) = &found[0].value else {
            panic!()
        };
        assert_eq!(
            records.field("b").unwrap(),
            [Value::Array(crate::formats::variables::Array::matrix(
                1,
                1,
                vec![1.0]
            ))]
        );
    }

    #[test]
    fn arrays_without_a_name_are_passed_over_if_they_are_whole() {
        let nameless = doubles("", &[1, 2], &[1.0, 2.0]);
        assert_eq!(variables(&file(&nameless)), Ok(Vec::new()));
        let cut = file(&nameless[..nameless.len() - 8]);
        assert!(matches!(variables(&cut), Err(VariableFault::CutOff { .. })));
    }

    #[test]
    fn numbers_where_a_variable_should_stand_are_damage() {
        assert!(matches!(
            variables(&file(&element(9, &[0; 8]))),
            Err(VariableFault::Damaged { .. })
        ));
        assert!(matches!(
            variables(&file(&matrix(99, &[1, 1], "x", &[]))),
            Err(VariableFault::Damaged { .. })
        ));
    }
}

#[cfg(test)]
mod cursor_tests {
    use super::*;

    #[test]
    fn a_number_is_read_in_both_orders() {
        assert_eq!(Cursor::file(&[1, 0, 0, 0], ByteOrder::Little).u32(), Ok(1));
        assert_eq!(Cursor::file(&[0, 0, 0, 1], ByteOrder::Big).u32(), Ok(1));
    }

    #[test]
    fn the_end_of_the_file_is_not_the_end_of_an_element() {
        let mut file = Cursor::file(&[0; 6], ByteOrder::Little);
        let mut element = file.take(3).unwrap();
        assert!(matches!(
            element.u32(),
            Err(VariableFault::Damaged { offset: 0, .. })
        ));
        assert!(matches!(
            file.u32(),
            Err(VariableFault::CutOff { offset: 3, .. })
        ));
        assert!(file.pass(9).is_ok() && file.is_empty());
    }
}

#[cfg(test)]
mod element_tests {
    use super::*;

    fn read(bytes: &[u8]) -> Result<Element<'_>, VariableFault> {
        Element::read(&mut Cursor::file(bytes, ByteOrder::Little))
    }

    #[test]
    fn small_data_stand_in_the_tag() {
        let element = read(&[1, 0, 3, 0, b'a', b'b', b'c', 0]).unwrap();
        assert_eq!(
            (element.kind, element.name().unwrap().as_str()),
            (DataKind::I8, "abc")
        );
        assert!(matches!(
            read(&[1, 0, 5, 0, 0, 0, 0, 0]),
            Err(VariableFault::Damaged { .. })
        ));
    }

    #[test]
    fn the_next_element_begins_at_a_multiple_of_eight_bytes() {
        let bytes = [
            &[2, 0, 0, 0, 5, 0, 0, 0, 1, 2, 3, 4, 5, 0, 0, 0][..],
            &[2, 0, 1, 0, 7, 0, 0, 0],
        ]
        .concat();
        let mut cursor = Cursor::file(&bytes, ByteOrder::Little);
        assert_eq!(Element::read(&mut cursor).unwrap().count(), Ok(5));
        assert_eq!(Element::read(&mut cursor).unwrap().data.rest(), [7]);
    }

    #[test]
    fn an_array_begins_where_its_tag_fits_what_follows() {
        let begins = |bytes: &[u8]| Element::begins_array(&Cursor::file(bytes, ByteOrder::Little));
        assert!(begins(&[]) && begins(&[14, 0, 0, 0, 0, 0, 0, 0]));
        for bytes in [
            &[14, 0, 0, 0, 1, 0, 0, 0][..],
            &[9, 0, 0, 0, 0, 0, 0, 0],
            &[14, 0, 0, 0],
        ] {
            assert!(!begins(bytes), "{bytes:?}");
        }
    }

    #[test]
    fn an_unknown_kind_and_half_numbers_are_damage() {
        assert!(matches!(
            read(&[8, 0, 0, 0, 0, 0, 0, 0]),
            Err(VariableFault::Damaged { .. })
        ));
        assert!(read(&[4, 0, 3, 0, 0, 0, 0, 0]).unwrap().count().is_err());
    }

    #[test]
    fn names_that_are_not_utf_8_are_latin_1() {
        assert_eq!(name_of(b"caf\xe9\0\0"), "caf\u{e9}");
    }
}

#[cfg(test)]
mod inflate_tests {
    use std::io::Write;

    use super::*;

    fn packed(length: u32, data: &[u8]) -> Vec<u8> {
        let mut encoder = flate2::write::ZlibEncoder::new(Vec::new(), flate2::Compression::best());
        encoder.write_all(&14_u32.to_le_bytes()).unwrap();
        encoder.write_all(&length.to_le_bytes()).unwrap();
        encoder.write_all(data).unwrap();
        encoder.finish().unwrap()
    }

    fn read(bytes: &[u8], most: u64) -> Result<Vec<u8>, VariableFault> {
        unpacked(
            Cursor::file(bytes, ByteOrder::Little),
            &ReadingBudget::new(most),
        )
    }

    #[test]
    fn as_much_is_unpacked_as_the_tag_says() {
        for length in [3, 4] {
            assert_eq!(
                read(&packed(length, &[1, 2, 3]), 100).unwrap()[8..],
                [1, 2, 3]
            );
        }
        assert!(matches!(
            read(&packed(2, &[1, 2, 3]), 100),
            Err(VariableFault::Damaged { .. })
        ));
    }

    #[test]
    fn what_unpacks_to_too_much_is_refused_before_it_is_unpacked() {
        let bomb = packed(1 << 22, &vec![0; 1 << 22]);
        assert!(bomb.len() < 1 << 13);
        assert!(matches!(
            read(&bomb, 1 << 20),
            Err(VariableFault::TooLarge { .. })
        ));
        assert!(matches!(
            read(&packed(u32::MAX, &[0; 99]), u64::MAX),
            Err(VariableFault::Damaged { .. })
        ));
    }

    #[test]
    fn changed_bytes_are_found_by_their_checksum() {
        let mut bytes = packed(3, &[1, 2, 3]);
        *bytes.last_mut().unwrap() ^= 1;
        assert!(matches!(
            read(&bytes, 100),
            Err(VariableFault::Damaged { .. })
        ));
    }
}
