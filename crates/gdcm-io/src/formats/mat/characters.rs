//! Character arrays in MATLAB files: a string for each row. Files store a numeric code for each
//! character, or encoded text.

use crate::formats::mat::array_header::saturating_count;
use crate::formats::mat::element::{DataKind, Element};
use crate::formats::mat::numbers::read_numbers;
use crate::formats::variables::TextArray;
use crate::reading_budget::{ReadingBudget, VariableFault};
use crate::variable_fault::damage::Damage;

/// Reads a character array, stored as encoded text or as numeric character codes.
pub(super) fn read_text(
    element: &Element<'_>,
    shape: &[usize],
    budget: &ReadingBudget<'_>,
) -> Result<TextArray, VariableFault> {
    let expected = saturating_count(shape);
    budget.take(expected as u64, 16, "")?;
    let mut codes = character_codes(element, expected, budget)?;
    if codes.is_empty() {
        // Files of old versions omit the characters of an array that holds only blanks.
        codes = vec![u32::from(b' '); expected];
    }
    if codes.len() != expected {
        let found = codes.len();
        return Err(element
            .data
            .damaged(Damage::CharacterCount { found, expected }));
    }
    text_rows(&codes, shape, "", budget)
}

/// Reads an element's character codes; `expected` is the character count in its shape.
fn character_codes(
    element: &Element<'_>,
    expected: usize,
    budget: &ReadingBudget<'_>,
) -> Result<Vec<u32>, VariableFault> {
    if element.kind == DataKind::Utf8 {
        return Ok(utf8_codes(element.data.rest(), expected));
    }
    let found = element.count()?;
    let numbers = read_numbers(element, found, budget)?;
    Ok(numbers.into_iter().map(|number| number as u32).collect())
}

/// Decodes UTF-8 into character codes, depending on whether `expected`, the character count in the
/// shape, counts UTF-16 units (MATLAB), bytes (files that declare Latin-1 as UTF-8) or characters
/// (some other programs).
fn utf8_codes(bytes: &[u8], expected: usize) -> Vec<u32> {
    let text = String::from_utf8_lossy(bytes);
    let units = text.encode_utf16().count();
    if units == expected {
        text.encode_utf16().map(u32::from).collect()
    } else if bytes.len() == expected {
        bytes.iter().copied().map(u32::from).collect()
    } else {
        text.chars().map(u32::from).collect()
    }
}

/// Splits a character array in column-major order into a string for each row of each page.
///
/// An array without characters becomes a single empty string, such as MATLAB's `''`, unless it has
/// several rows.
pub(crate) fn text_rows(
    codes: &[u32],
    shape: &[usize],
    variable: &str,
    budget: &ReadingBudget<'_>,
) -> Result<TextArray, VariableFault> {
    // The dimensions are rows, characters in a row, and pages.
    let height = shape.first().copied().unwrap_or(1);
    let length = shape.get(1).copied().unwrap_or(1);
    let pages = shape.get(2..).unwrap_or_default();
    if codes.is_empty() && height <= 1 {
        return Ok(TextArray::one(""));
    }
    let shape: Vec<usize> = [height, 1].iter().chain(pages).copied().collect();
    let count = saturating_count(&shape);
    budget.take(count as u64, size_of::<String>() as u64, variable)?;
    // A UTF-16 unit needs up to three bytes in UTF-8.
    budget.take(codes.len() as u64, 3, variable)?;
    let page_size = height.saturating_mul(length);
    let mut texts = Vec::with_capacity(count);
    for text in 0..count {
        let page = text / height;
        let row = text % height;
        // Place of the row's first character; the following are `height` apart.
        let first = page.saturating_mul(page_size).saturating_add(row);
        let row_codes = (0..length).filter_map(|column| {
            let place = first.saturating_add(column.saturating_mul(height));
            codes.get(place).copied()
        });
        texts.push(decode_codes(row_codes));
    }
    Ok(TextArray { shape, texts })
}

/// Decodes character codes. A character beyond 16 bits may be a single code or a UTF-16 surrogate
/// pair; an invalid code becomes the replacement character.
fn decode_codes(codes: impl Iterator<Item = u32>) -> String {
    let mut units = Vec::new();
    for code in codes {
        if let Ok(unit) = u16::try_from(code) {
            units.push(unit);
        } else if let Some(letter) = char::from_u32(code) {
            units.extend_from_slice(letter.encode_utf16(&mut [0; 2]));
        } else {
            units.push(char::REPLACEMENT_CHARACTER as u16);
        }
    }
    String::from_utf16_lossy(&units)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::formats::mat::cursor::{ByteOrder, Cursor};

    fn read(kind: u8, data: &[u8], shape: &[usize]) -> Result<TextArray, VariableFault> {
        let bytes = [&[kind, 0, 0, 0, data.len() as u8, 0, 0, 0], data].concat();
        let element = Element::read(&mut Cursor::file(&bytes, ByteOrder::Little)).unwrap();
        read_text(&element, shape, &ReadingBudget::new(1 << 16))
    }

    #[test]
    fn the_rows_of_an_array_are_texts() {
        let found = read(16, b"adbecf", &[2, 3]).unwrap();
        assert_eq!(
            found,
            TextArray {
                shape: vec![2, 1],
                texts: vec!["abc".to_owned(), "def".to_owned()]
            }
        );
        let paged = read(16, b"abcd", &[1, 2, 2]).unwrap();
        assert_eq!(
            paged,
            TextArray {
                shape: vec![1, 1, 2],
                texts: vec!["ab".to_owned(), "cd".to_owned()]
            }
        );
    }

    #[test]
    fn letters_beyond_16_bits_are_read_however_they_are_counted() {
        for length in [2, 1, 4] {
            let found = read(16, "\u{1f681}".as_bytes(), &[1, length]).unwrap();
            assert_eq!(found.texts[0] == "\u{1f681}", length < 4);
        }
        assert_eq!(
            read(17, &[0x3d, 0xd8, 0x81, 0xde], &[1, 2]).unwrap().texts,
            ["\u{1f681}"]
        );
        assert_eq!(
            read(18, &[0x81, 0xf6, 1, 0], &[1, 1]).unwrap().texts,
            ["\u{1f681}"]
        );
    }

    #[test]
    fn no_characters_are_an_empty_text_and_omitted_blanks_are_restored() {
        assert_eq!(
            read(4, &[], &[0, 0]).unwrap(),
            TextArray {
                shape: vec![1, 1],
                texts: vec![String::new()]
            }
        );
        assert_eq!(read(4, &[], &[3, 0]).unwrap().texts, ["", "", ""]);
        assert_eq!(read(4, &[], &[1, 3]).unwrap().texts, ["   "]);
        assert!(matches!(
            read(4, &[65, 0], &[1, 3]),
            Err(VariableFault::Damaged { .. })
        ));
        assert!(matches!(
            read(4, &[], &[1 << 20, 1 << 20]),
            Err(VariableFault::TooLarge { .. })
        ));
    }
}
