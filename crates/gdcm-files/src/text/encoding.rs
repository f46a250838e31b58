//! Bytes of a text file as text.

use crate::variables::{MemoryBudget, VariableFault};

/// How the characters of a text were stored.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Encoding {
    /// UTF-8, with a byte order mark or without.
    Utf8,
    /// UTF-16 with a byte order mark.
    Utf16,
    /// Latin-1 as Windows has it (code page 1252), taken where the bytes are no UTF-8.
    Latin1,
}

/// A text and how it was stored.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct DecodedText {
    /// The text, without a byte order mark.
    pub text: String,
    /// How it was stored.
    pub encoding: Encoding,
}

/// Characters of code page 1252 from 0x80 to 0x9f; the five that it leaves open stay control characters.
const WINDOWS_1252: [char; 32] = [
    '€', '\u{81}', '‚', 'ƒ', '„', '…', '†', '‡', 'ˆ', '‰', 'Š', '‹', 'Œ', '\u{8d}', 'Ž', '\u{8f}', '\u{90}', '‘', '’',
    '“', '”', '•', '–', '—', '˜', '™', 'š', '›', 'œ', '\u{9d}', 'ž', 'Ÿ',
];

/// Finds out how a text is stored and gives its characters.
pub fn decode(bytes: &[u8], meter: &MemoryBudget) -> Result<DecodedText, VariableFault> {
    if let Some(body) = bytes.strip_prefix(&[0xff, 0xfe]) {
        return utf16(body, u16::from_le_bytes, meter);
    }
    if let Some(body) = bytes.strip_prefix(&[0xfe, 0xff]) {
        return utf16(body, u16::from_be_bytes, meter);
    }
    let body = bytes.strip_prefix(&[0xef, 0xbb, 0xbf]).unwrap_or(bytes);
    if let Some(at) = body.iter().position(|&byte| byte == 0) {
        let found = format!("a file that is no text (byte {at} of it is zero)");
        return Err(VariableFault::Format { expected: "a text", found });
    }
    // A character of Latin-1 takes at most three bytes of UTF-8.
    meter.take(body.len() as u64, 3, "")?;
    Ok(match std::str::from_utf8(body) {
        Ok(text) => DecodedText { text: text.to_owned(), encoding: Encoding::Utf8 },
        Err(_) => DecodedText { text: body.iter().map(|&byte| latin1(byte)).collect(), encoding: Encoding::Latin1 },
    })
}

fn latin1(byte: u8) -> char {
    match byte {
        0x80..=0x9f => WINDOWS_1252[usize::from(byte - 0x80)],
        _ => char::from(byte),
    }
}

fn utf16(body: &[u8], word: fn([u8; 2]) -> u16, meter: &MemoryBudget) -> Result<DecodedText, VariableFault> {
    let (pairs, rest) = body.as_chunks::<2>();
    if !rest.is_empty() {
        return Err(VariableFault::CutOff { variable: String::new(), offset: body.len() as u64 + 2 });
    }
    meter.take(pairs.len() as u64, 4, "")?;
    let decoded = char::decode_utf16(pairs.iter().map(|&pair| word(pair)));
    let text: String = decoded.map(|character| character.unwrap_or(char::REPLACEMENT_CHARACTER)).collect();
    Ok(DecodedText { text, encoding: Encoding::Utf16 })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(bytes: &[u8]) -> Result<DecodedText, VariableFault> {
        decode(bytes, &MemoryBudget::new(1 << 20, &|_| false))
    }

    #[test]
    fn the_degree_sign_comes_through_in_every_encoding() {
        let expected = |encoding| DecodedText { text: "δ [°]".to_owned(), encoding };
        assert_eq!(read("\u{feff}δ [°]".as_bytes()).unwrap(), expected(Encoding::Utf8));
        assert_eq!(read("δ [°]".as_bytes()).unwrap(), expected(Encoding::Utf8));
        let little: Vec<u8> = "\u{feff}δ [°]".encode_utf16().flat_map(u16::to_le_bytes).collect();
        assert_eq!(read(&little).unwrap(), expected(Encoding::Utf16));
        let big: Vec<u8> = "\u{feff}δ [°]".encode_utf16().flat_map(u16::to_be_bytes).collect();
        assert_eq!(read(&big).unwrap(), expected(Encoding::Utf16));
        assert_eq!(read(b"[\xb0] \x96").unwrap().text, "[°] –");
    }

    #[test]
    fn what_is_no_text_is_refused() {
        assert!(matches!(read(b"a\0b"), Err(VariableFault::Format { .. })));
        assert!(matches!(read(b"\xff\xfea"), Err(VariableFault::CutOff { .. })));
        let small = decode(b"abc", &MemoryBudget::new(8, &|_| false));
        assert!(matches!(small, Err(VariableFault::TooLarge { .. })));
    }
}
