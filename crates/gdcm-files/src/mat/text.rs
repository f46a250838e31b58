//! Arrays of characters.

use super::element::{DataKind, Element};
use super::header::count;
use super::numbers::numbers;
use crate::variables::{MemoryBudget, TextArray, VariableFault};

/// The rows of an array of characters, stored as text or as numbers of characters.
pub(super) fn text(
    element: &Element<'_>,
    shape: &[usize],
    meter: &MemoryBudget<'_>,
) -> Result<TextArray, VariableFault> {
    let wanted = count(shape);
    meter.take(wanted as u64, 16, "")?;
    let mut characters = characters(element, wanted, meter)?;
    if characters.is_empty() {
        // Old versions leave out characters that are all blank.
        characters = vec![u32::from(b' '); wanted];
    }
    if characters.len() != wanted {
        let found = characters.len();
        return Err(element.data.damaged(format!("{found} characters where there should be {wanted}")));
    }
    rows(&characters, shape, meter)
}

/// The texts in the rows of an array of characters, of which there are as many as the shape says.
///
/// An array without characters is one empty text, as MATLAB's `''` is, unless it has several rows.
pub(super) fn rows(characters: &[u32], shape: &[usize], meter: &MemoryBudget<'_>) -> Result<TextArray, VariableFault> {
    let (height, length) = (shape.first().copied().unwrap_or(1), shape.get(1).copied().unwrap_or(1));
    let pages = shape.get(2..).unwrap_or_default();
    if characters.is_empty() && height <= 1 {
        return Ok(TextArray { shape: vec![1, 1], texts: vec![String::new()] });
    }
    let shape: Vec<usize> = [height, 1].iter().chain(pages).copied().collect();
    let texts = count(&shape);
    meter.take(texts as u64, size_of::<String>() as u64, "")?;
    let page = height.saturating_mul(length);
    let row = |text: usize| {
        let first = (text / height).saturating_mul(page).saturating_add(text % height);
        let places = (0..length).map(|column| first.saturating_add(column.saturating_mul(height)));
        written(places.filter_map(|place| characters.get(place).copied()))
    };
    Ok(TextArray { shape, texts: (0..texts).map(row).collect() })
}

/// Text of characters' numbers, whether those beyond 16 bits are one number or two (as in UTF-16).
fn written(numbers: impl Iterator<Item = u32>) -> String {
    let mut units = Vec::new();
    for number in numbers {
        match char::from_u32(number).filter(|_| number > 0xffff) {
            Some(letter) => units.extend_from_slice(letter.encode_utf16(&mut [0; 2])),
            None => units.push(u16::try_from(number).unwrap_or(0xfffd)),
        }
    }
    String::from_utf16_lossy(&units)
}

fn characters(element: &Element<'_>, wanted: usize, meter: &MemoryBudget<'_>) -> Result<Vec<u32>, VariableFault> {
    if element.kind == DataKind::Utf8 {
        return Ok(of_utf8(element.data.rest(), wanted));
    }
    let found = element.count()?;
    Ok(numbers(element, found, meter)?.into_iter().map(|number| number as u32).collect())
}

/// The shape counts units of UTF-16 in files of MATLAB, characters in those of some other programs, and bytes in those that
/// call Latin-1 UTF-8.
fn of_utf8(bytes: &[u8], wanted: usize) -> Vec<u32> {
    let text = String::from_utf8_lossy(bytes);
    let units = text.encode_utf16().count();
    if units == wanted {
        text.encode_utf16().map(u32::from).collect()
    } else if bytes.len() == wanted {
        bytes.iter().copied().map(u32::from).collect()
    } else {
        text.chars().map(u32::from).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::super::cursor::{ByteOrder, Cursor};
    use super::*;

    fn read(kind: u8, data: &[u8], shape: &[usize]) -> Result<TextArray, VariableFault> {
        let bytes = [&[kind, 0, 0, 0, data.len() as u8, 0, 0, 0], data].concat();
        let element = Element::read(&mut Cursor::file(&bytes, ByteOrder::Little)).unwrap();
        text(&element, shape, &MemoryBudget::new(1 << 16, &|_| false))
    }

    #[test]
    fn the_rows_of_an_array_are_texts() {
        let found = read(16, b"adbecf", &[2, 3]).unwrap();
        assert_eq!(found, TextArray { shape: vec![2, 1], texts: vec!["abc".to_owned(), "def".to_owned()] });
        let paged = read(16, b"abcd", &[1, 2, 2]).unwrap();
        assert_eq!(paged, TextArray { shape: vec![1, 1, 2], texts: vec!["ab".to_owned(), "cd".to_owned()] });
    }

    #[test]
    fn letters_beyond_16_bits_are_read_however_they_are_counted() {
        for length in [2, 1, 4] {
            let found = read(16, "\u{1f681}".as_bytes(), &[1, length]).unwrap();
            assert_eq!(found.texts[0] == "\u{1f681}", length < 4);
        }
        assert_eq!(read(17, &[0x3d, 0xd8, 0x81, 0xde], &[1, 2]).unwrap().texts, ["\u{1f681}"]);
        assert_eq!(read(18, &[0x81, 0xf6, 1, 0], &[1, 1]).unwrap().texts, ["\u{1f681}"]);
    }

    #[test]
    fn nothing_is_one_empty_text_and_blanks_that_were_left_out_come_back() {
        assert_eq!(read(4, &[], &[0, 0]).unwrap(), TextArray { shape: vec![1, 1], texts: vec![String::new()] });
        assert_eq!(read(4, &[], &[3, 0]).unwrap().texts, ["", "", ""]);
        assert_eq!(read(4, &[], &[1, 3]).unwrap().texts, ["   "]);
        assert!(matches!(read(4, &[65, 0], &[1, 3]), Err(VariableFault::Damaged { .. })));
        assert!(matches!(read(4, &[], &[1 << 20, 1 << 20]), Err(VariableFault::TooLarge { .. })));
    }
}
