//! Character encodings for text files.

use crate::reading_budget::{NO_VARIABLE, ReadingBudget, VariableFault};
use crate::variable_fault::found_content::FoundContent;

/// Characters 0x80 to 0x9f of code page 1252; its five undefined codes become control characters.
const WINDOWS_1252: [char; 32] = [
    '€', '\u{81}', '‚', 'ƒ', '„', '…', '†', '‡', 'ˆ', '‰', 'Š', '‹', 'Œ', '\u{8d}', 'Ž', '\u{8f}',
    '\u{90}', '‘', '’', '“', '”', '•', '–', '—', '˜', '™', 'š', '›', 'œ', '\u{9d}', 'ž', 'Ÿ',
];

/// Decodes a text file: UTF-16 if a byte order mark announces it, UTF-8 if the bytes are valid,
/// otherwise code page 1252. The byte order mark is removed.
///
/// # Errors
/// [`VariableFault`] for a zero byte outside UTF-16, which only a binary file has, for UTF-16 with
/// an odd byte count, and if the budget is exhausted.
pub fn decode(bytes: &[u8], budget: &ReadingBudget) -> Result<String, VariableFault> {
    if let Some(body) = bytes.strip_prefix(&[0xff, 0xfe]) {
        return utf16(body, u16::from_le_bytes, budget);
    }
    if let Some(body) = bytes.strip_prefix(&[0xfe, 0xff]) {
        return utf16(body, u16::from_be_bytes, budget);
    }
    let body = bytes.strip_prefix(&[0xef, 0xbb, 0xbf]).unwrap_or(bytes);
    if let Some(at) = body.iter().position(|&byte| byte == 0) {
        return Err(no_text("a text", at));
    }
    // A code page 1252 character needs at most three bytes in UTF-8.
    budget.take(body.len() as u64, 3, NO_VARIABLE)?;
    Ok(match std::str::from_utf8(body) {
        Ok(text) => text.to_owned(),
        Err(_) => body.iter().map(|&byte| windows_1252(byte)).collect(),
    })
}

/// Decodes a byte of code page 1252, which equals Latin-1 outside 0x80 to 0x9f.
fn windows_1252(byte: u8) -> char {
    match byte {
        0x80..=0x9f => WINDOWS_1252[usize::from(byte - 0x80)],
        _ => char::from(byte),
    }
}

/// Decodes UTF-16 after its byte order mark; `word` combines two bytes in the file's byte order.
fn utf16(
    body: &[u8],
    word: fn([u8; 2]) -> u16,
    budget: &ReadingBudget,
) -> Result<String, VariableFault> {
    let (pairs, rest) = body.as_chunks::<2>();
    if !rest.is_empty() {
        return Err(VariableFault::cut_off(NO_VARIABLE, body.len() + 2));
    }
    // An upper bound: a UTF-16 word needs at most three bytes in UTF-8.
    budget.take(pairs.len() as u64, 4, NO_VARIABLE)?;
    let decoded = char::decode_utf16(pairs.iter().map(|&pair| word(pair)));
    Ok(decoded
        .map(|character| character.unwrap_or(char::REPLACEMENT_CHARACTER))
        .collect())
}

/// Rejects binary files, which are recognised by zero bytes.
pub(super) fn refuse_binary(text: &str, expected: &'static str) -> Result<(), VariableFault> {
    match text.find('\0') {
        Some(at) => Err(no_text(expected, at)),
        None => Ok(()),
    }
}

/// Returns the error for a binary file, whose byte `at` is zero.
fn no_text(expected: &'static str, at: usize) -> VariableFault {
    VariableFault::format(expected, FoundContent::Binary { byte: at })
}

#[cfg(test)]
mod encoding_tests {
    use super::*;

    fn read(bytes: &[u8]) -> Result<String, VariableFault> {
        decode(bytes, &ReadingBudget::new(1 << 20))
    }

    #[test]
    fn the_degree_sign_is_decoded_in_every_encoding() {
        let expected = "δ [°]";
        assert_eq!(read("\u{feff}δ [°]".as_bytes()).unwrap(), expected);
        assert_eq!(read("δ [°]".as_bytes()).unwrap(), expected);
        let little: Vec<u8> = "\u{feff}δ [°]"
            .encode_utf16()
            .flat_map(u16::to_le_bytes)
            .collect();
        assert_eq!(read(&little).unwrap(), expected);
        let big: Vec<u8> = "\u{feff}δ [°]"
            .encode_utf16()
            .flat_map(u16::to_be_bytes)
            .collect();
        assert_eq!(read(&big).unwrap(), expected);
        assert_eq!(read(b"[\xb0] \x96").unwrap(), "[°] –");
    }

    #[test]
    fn binary_and_cut_off_data_are_refused() {
        assert!(matches!(read(b"a\0b"), Err(VariableFault::Format { .. })));
        assert!(matches!(
            read(b"\xff\xfea"),
            Err(VariableFault::CutOff { .. })
        ));
        let small = decode(b"abc", &ReadingBudget::new(8));
        assert!(matches!(small, Err(VariableFault::TooLarge { .. })));
    }

    #[test]
    fn a_zero_byte_is_no_text() {
        let binary = FoundContent::Binary { byte: 2 };
        assert_eq!(
            refuse_binary("ab\0c", "a table"),
            Err(VariableFault::format("a table", binary))
        );
    }
}
