//! Separators between the cells of a line.

use std::borrow::Cow;

use crate::formats::text::columns::{comment, is_rule};
use crate::reading_budget::{ReadingBudget, VariableFault};

/// Separator between the cells of a line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Separator {
    Tab,
    Semicolon,
    /// A vertical bar; a leading bar is skipped.
    Pipe,
    Comma,
    /// Any run of blanks and tabulators.
    Blanks,
}

impl Separator {
    /// All separators, the more specific first.
    pub(super) const ALL: [Separator; 5] = [
        Separator::Tab,
        Separator::Semicolon,
        Separator::Pipe,
        Separator::Comma,
        Separator::Blanks,
    ];

    /// Returns the name for messages.
    pub fn words(self) -> &'static str {
        match self {
            Separator::Tab => "tabulators",
            Separator::Semicolon => "semicolons",
            Separator::Pipe => "upright strokes",
            Separator::Comma => "commas",
            Separator::Blanks => "blanks",
        }
    }

    /// Returns the cells of a line, without surrounding quotes.
    pub(super) fn cells(self, line: &str) -> Cells<'_> {
        let line = match self {
            Separator::Pipe => line.trim_start().strip_prefix('|').unwrap_or(line),
            Separator::Blanks => line.trim(),
            _ => line,
        };
        Cells {
            rest: Some(line),
            separator: self,
        }
    }

    /// Returns the character to write between cells.
    pub(super) fn sign(self) -> char {
        match self {
            Separator::Tab => '\t',
            Separator::Semicolon => ';',
            Separator::Pipe => '|',
            Separator::Comma => ',',
            Separator::Blanks => ' ',
        }
    }

    /// Formats cells as a line; a cell that contains the separator is quoted.
    pub(super) fn line(self, cells: impl Iterator<Item = String>) -> String {
        let sign = self.sign();
        let cell = |cell: String| {
            if cell.contains(sign) {
                format!("\"{cell}\"")
            } else {
                cell
            }
        };
        cells
            .map(cell)
            .collect::<Vec<_>>()
            .join(&String::from(sign))
    }

    fn is(self, character: char) -> bool {
        if self == Separator::Blanks {
            character.is_whitespace()
        } else {
            character == self.sign()
        }
    }
}

/// Iterator over the cells of a line, so that a line of a million cells takes no memory.
pub(super) struct Cells<'t> {
    rest: Option<&'t str>,
    separator: Separator,
}

impl<'t> Iterator for Cells<'t> {
    type Item = Cow<'t, str>;

    fn next(&mut self) -> Option<Self::Item> {
        let mut rest = self.rest?;
        if self.separator == Separator::Blanks {
            rest = rest.trim_start();
            if rest.is_empty() {
                self.rest = None;
                return None;
            }
        }
        let (cell, behind) = quoted(rest).unwrap_or((Cow::Borrowed(""), rest));
        let end = behind.find(|character| self.separator.is(character));
        let between = &behind[..end.unwrap_or(behind.len())];
        self.rest = end.and_then(|end| behind.get(end..)).map(after_first);
        // Quotes followed by other text are ordinary characters.
        let whole = &rest[..rest.len() - behind.len() + between.len()];
        Some(if between.trim().is_empty() && !cell.is_empty() {
            cell
        } else {
            Cow::Borrowed(unquoted(whole))
        })
    }
}

fn after_first(text: &str) -> &str {
    let mut characters = text.chars();
    characters.next();
    characters.as_str()
}

/// Returns a cell without quotes; an empty pair of quotes is an empty cell.
fn unquoted(cell: &str) -> &str {
    if cell.trim() == "\"\"" { "" } else { cell }
}

/// Returns the quoted cell at the beginning of a text, and the text after it.
fn quoted(text: &str) -> Option<(Cow<'_, str>, &str)> {
    let inner = text.trim_start().strip_prefix('"')?;
    let mut from = 0;
    loop {
        let end = from + inner[from..].find('"')?;
        if !inner[end + 1..].starts_with('"') {
            let cell = &inner[..end];
            let cell = if cell.contains('"') {
                Cow::Owned(cell.replace("\"\"", "\""))
            } else {
                Cow::Borrowed(cell)
            };
            return Some((cell, &inner[end + 1..]));
        }
        from = end + 2;
    }
}

// Numbers in a table cell, in the notations of various programs.

/// Words that programs write for a missing number.
const MISSING: [&str; 14] = [
    "nan",
    "-nan",
    "n/a",
    "#n/a",
    "na",
    "null",
    "none",
    "missing",
    "-",
    "--",
    "nan(ind)",
    "-nan(ind)",
    "?",
    ".",
];

/// Parses the number in a cell: NaN for a missing number, `None` for anything else.
///
/// `decimal_comma` selects comma or point as the decimal mark; the other mark is not accepted, as
/// it may group thousands.
pub(super) fn cell_number(cell: &str, decimal_comma: bool) -> Option<f64> {
    let cell = cell.trim();
    if cell.is_empty() {
        return Some(f64::NAN);
    }
    if !(decimal_comma && cell.contains(['.', ',']))
        && let Ok(number) = cell.parse::<f64>()
    {
        return Some(number);
    }
    if is_missing(cell) {
        Some(f64::NAN)
    } else {
        spelled_otherwise(cell, decimal_comma)
    }
}

/// Whether a cell is a number or a missing number, with either decimal mark.
pub(super) fn is_number(cell: &str) -> bool {
    [false, true]
        .iter()
        .any(|&decimal_comma| cell_number(cell, decimal_comma).is_some())
}

fn is_missing(cell: &str) -> bool {
    let unsigned = cell.trim_start_matches('-');
    MISSING.iter().any(|word| cell.eq_ignore_ascii_case(word))
        // An older C library of Windows.
        || ["1.#IND", "1.#QNAN", "1.#SNAN"].iter().any(|start| unsigned.starts_with(start))
        // Fortran: the number does not fit its field.
        || cell.bytes().all(|byte| byte == b'*')
}

fn spelled_otherwise(cell: &str, decimal_comma: bool) -> Option<f64> {
    if cell.starts_with("1.#INF") {
        return Some(f64::INFINITY);
    }
    if cell.starts_with("-1.#INF") {
        return Some(f64::NEG_INFINITY);
    }
    // Numbers with a decimal comma or a Fortran exponent are never longer.
    if cell.len() > 400 || !cell.contains(|c: char| c.is_ascii_digit()) {
        return None;
    }
    let mut plain = String::with_capacity(cell.len() + 1);
    for character in cell.chars() {
        plain.push(match character {
            '0'..='9' | '+' | '-' | 'e' | 'E' => character,
            '\u{2212}' => '-',
            'd' | 'D' | 'q' | 'Q' => 'e',
            ',' if decimal_comma => '.',
            '.' if !decimal_comma => '.',
            _ => return None,
        });
    }
    // Fortran omits the letter before a three-digit exponent: 1.0-103.
    let sign = plain
        .rfind(['+', '-'])
        .filter(|&at| at > 0 && plain.len() - at == 4 && !plain.contains(['e', 'E']));
    if let Some(at) = sign {
        plain.insert(at, 'e');
    }
    plain.parse().ok()
}

// Clock times, with or without a date.

/// Seconds of a time such as "12:30:01.25", "12:30:01,25", "2026-03-01 12:30:01.25" or
/// "2026-03-01T12:30:01.250Z": since midnight, or since the beginning of 1970 if there is a date.
pub(super) fn clock_s(text: &str) -> Option<f64> {
    let text = text.trim().trim_end_matches('Z').trim();
    let (date, time) = match text.split_once(['T', ' ']) {
        Some((date, time)) => (Some(date), time.trim()),
        None => (None, text),
    };
    let mut parts = time.split(':');
    let hours = parts.next()?;
    let minutes = parts.next()?;
    let seconds = parts.next();
    if parts.next().is_some() {
        return None;
    }
    let whole = |text: &str, most: u32| {
        let is_digits =
            !text.is_empty() && text.len() <= 2 && text.bytes().all(|byte| byte.is_ascii_digit());
        text.parse::<u32>()
            .ok()
            .filter(|value| is_digits && *value <= most)
            .map(f64::from)
    };
    let hours = whole(hours, 24)?;
    let minutes = whole(minutes, 59)?;
    let seconds = match seconds {
        Some(text) if text.starts_with(|c: char| c.is_ascii_digit()) => {
            text.replace(',', ".").parse::<f64>().ok()?
        }
        Some(_) => return None,
        None => 0.0,
    };
    let day_s = match date {
        Some(date) => 86_400.0 * days(date)?,
        None => 0.0,
    };
    (0.0..61.0)
        .contains(&seconds)
        .then_some(day_s + 3600.0 * hours + 60.0 * minutes + seconds)
}

/// Days from 1970-01-01 to a date in the order year, month, day.
fn days(date: &str) -> Option<f64> {
    let mut parts = date.split(['-', '/']).map(|part| part.parse::<i16>().ok());
    let year = parts.next()??;
    let month = parts.next()??;
    let day = parts.next()??;
    let date = jiff::civil::Date::new(year, month.try_into().ok()?, day.try_into().ok()?).ok()?;
    let since = date.since(jiff::civil::date(1970, 1, 1)).ok()?;
    Some(f64::from(since.get_days()))
}

// Decoding of text files.

/// Characters 0x80 to 0x9f of code page 1252; its five undefined codes remain control characters.
const WINDOWS_1252: [char; 32] = [
    '€', '\u{81}', '‚', 'ƒ', '„', '…', '†', '‡', 'ˆ', '‰', 'Š', '‹', 'Œ', '\u{8d}', 'Ž', '\u{8f}',
    '\u{90}', '‘', '’', '“', '”', '•', '–', '—', '˜', '™', 'š', '›', 'œ', '\u{9d}', 'ž', 'Ÿ',
];

/// Decodes a text: UTF-8 with or without a byte order mark, UTF-16 with one, or code page 1252 if
/// the bytes are not UTF-8.
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
    // A Latin-1 character takes at most three bytes in UTF-8.
    budget.take(body.len() as u64, 3, "")?;
    Ok(match std::str::from_utf8(body) {
        Ok(text) => text.to_owned(),
        Err(_) => body.iter().map(|&byte| latin1(byte)).collect(),
    })
}

fn latin1(byte: u8) -> char {
    match byte {
        0x80..=0x9f => WINDOWS_1252[usize::from(byte - 0x80)],
        _ => char::from(byte),
    }
}

fn utf16(
    body: &[u8],
    word: fn([u8; 2]) -> u16,
    budget: &ReadingBudget,
) -> Result<String, VariableFault> {
    let (pairs, rest) = body.as_chunks::<2>();
    if !rest.is_empty() {
        return Err(VariableFault::cut_off("", body.len() + 2));
    }
    budget.take(pairs.len() as u64, 4, "")?;
    let decoded = char::decode_utf16(pairs.iter().map(|&pair| word(pair)));
    Ok(decoded
        .map(|character| character.unwrap_or(char::REPLACEMENT_CHARACTER))
        .collect())
}

// Lines of a text with any line ending.

/// Iterator over numbered lines, from 1; a line ends in a line feed, a carriage return, or both.
pub(super) struct Lines<'t> {
    rest: Option<&'t str>,
    number: usize,
}

/// Returns the lines of `text`.
pub(super) fn lines(text: &str) -> Lines<'_> {
    Lines {
        rest: Some(text.strip_prefix('\u{feff}').unwrap_or(text)),
        number: 0,
    }
}

impl<'t> Iterator for Lines<'t> {
    type Item = (usize, &'t str);

    fn next(&mut self) -> Option<Self::Item> {
        let rest = self.rest?;
        self.number += 1;
        let Some(end) = rest.find(['\n', '\r']) else {
            self.rest = None;
            return Some((self.number, rest));
        };
        let (line, behind) = rest.split_at(end);
        self.rest = behind.strip_prefix("\r\n").or_else(|| behind.get(1..));
        Some((self.number, line))
    }
}

/// Refuses binary data: a text of numbers contains no zero byte.
pub(super) fn refuse_binary(text: &str, expected: &'static str) -> Result<(), VariableFault> {
    text.find('\0')
        .map_or(Ok(()), |at| Err(no_text(expected, at)))
}

fn no_text(expected: &'static str, at: usize) -> VariableFault {
    VariableFault::format(
        expected,
        format!("a file that is no text (byte {at} of it is zero)"),
    )
}

/// Shortens a text for a message: its first line, at most 40 characters, visible characters only.
pub(super) fn excerpt(text: &str) -> String {
    // Only the displayed part is examined: a line may be as long as the text.
    let mut line = text
        .trim_start()
        .chars()
        .take_while(|c| !matches!(c, '\n' | '\r'));
    let shown: String = line
        .by_ref()
        .take(40)
        .map(|c| if c.is_control() { '\u{fffd}' } else { c })
        .collect();
    let mut short = shown.trim_end().to_owned();
    if line.next().is_some() {
        short.push('…');
    }
    short
}

// Consecutive tables in one text, each with a heading.

/// Splits a text before every heading that follows rows; returns the number of the first line and
/// the text of each part. A log that is restarted with other columns is split where they change.
pub fn sections(text: &str) -> Vec<(usize, &str)> {
    let mut starts: Vec<(usize, usize)> = vec![(1, 0)];
    let mut has_rows = false;
    for (number, line) in lines(text) {
        if line.trim().is_empty() || comment(line).is_some() || is_rule(line) {
            continue;
        }
        let is_heading = is_heading(line);
        if is_heading && has_rows {
            // Each line is a slice of the text.
            starts.push((number, line.as_ptr() as usize - text.as_ptr() as usize));
        }
        has_rows = !is_heading;
    }
    let ends = starts.iter().skip(1).map(|(_, at)| *at).chain([text.len()]);
    starts
        .iter()
        .zip(ends)
        .filter_map(|(&(line, start), end)| Some((line, text.get(start..end)?)))
        .collect()
}

/// Whether no cell of a line is a number, and at least one contains letters.
fn is_heading(line: &str) -> bool {
    let strong = ['|', ';', '\t', ','];
    let is_strong = line.contains(strong);
    let is_between = |c: char| {
        if is_strong {
            strong.contains(&c)
        } else {
            c.is_whitespace()
        }
    };
    let mut cells = line
        .split(is_between)
        .map(str::trim)
        .filter(|cell| !cell.is_empty());
    let is_number = |cell: &str| cell_number(cell, false).is_some_and(|number| !number.is_nan());
    line.chars().any(char::is_alphabetic) && !cells.any(is_number)
}

#[cfg(test)]
mod separator_tests {
    use super::*;

    fn cells(separator: Separator, line: &str) -> Vec<String> {
        separator.cells(line).map(Cow::into_owned).collect()
    }

    #[test]
    fn cells_are_cut_at_their_separator() {
        assert_eq!(cells(Separator::Comma, "1, 2,,"), ["1", " 2", "", ""]);
        assert_eq!(
            cells(Separator::Blanks, "  1 \t 2\u{a0}3 "),
            ["1", "2", "3"]
        );
        assert_eq!(cells(Separator::Pipe, " | 1 | 2 |"), [" 1 ", " 2 ", ""]);
        assert_eq!(cells(Separator::Tab, "1\t\t2"), ["1", "", "2"]);
    }

    #[test]
    fn quotes_keep_separators_together() {
        assert_eq!(
            cells(Separator::Comma, r#""1,5", "a ""b""",c"#),
            ["1,5", "a \"b\"", "c"]
        );
        assert_eq!(
            cells(Separator::Blanks, r#""omega [rad/s]" "" x"#),
            ["omega [rad/s]", "", "x"]
        );
    }

    #[test]
    fn a_quote_that_is_not_closed_is_a_character() {
        assert_eq!(cells(Separator::Comma, "\"1,2"), ["\"1", "2"]);
        assert_eq!(cells(Separator::Comma, "\"1\"a,2"), ["\"1\"a", "2"]);
    }
}

#[cfg(test)]
mod cell_number_tests {
    use proptest::prelude::*;

    use super::*;

    #[test]
    fn numbers_are_read_as_programs_write_them() {
        for (text, expected) in [
            ("1", 1.0),
            (" +.5 ", 0.5),
            ("-1.", -1.0),
            ("1.0D+03", 1000.0),
            ("1d-3", 0.001),
            ("2.5-101", 2.5e-101),
            ("\u{2212}3e2", -300.0),
            ("Inf", f64::INFINITY),
            ("-1.#INF00", f64::NEG_INFINITY),
        ] {
            assert_eq!(cell_number(text, false), Some(expected), "{text}");
        }
        assert_eq!(cell_number("-1,5E2", true), Some(-150.0));
    }

    #[test]
    fn what_says_that_there_is_no_number_is_not_a_number() {
        for text in ["", "  ", "NaN", "n/a", "#N/A", "NA", "-", "****", "-1.#IND"] {
            assert!(cell_number(text, false).is_some_and(f64::is_nan), "{text}");
        }
    }

    #[test]
    fn other_words_and_grouped_thousands_are_no_numbers() {
        for text in [
            "a", "1 2", "1,5", "0x10", "1.2.3", "e", "d", "--1", "1e", "12:30",
        ] {
            assert_eq!(cell_number(text, false), None, "{text}");
        }
        assert_eq!(cell_number("1.500", true), None);
        assert_eq!(cell_number("1.500,0", true), None);
    }

    proptest! {
        #[test]
        fn a_number_written_comes_back(number in proptest::num::f64::NORMAL | proptest::num::f64::ZERO) {
            let text = format!("{number:e}");
            prop_assert_eq!(cell_number(&text, false), Some(number));
            prop_assert_eq!(cell_number(&text.replace('.', ","), true), Some(number));
            prop_assert_eq!(cell_number(&text.replace('e', "D"), false), Some(number));
        }

        #[test]
        fn any_text_is_read_or_refused(text in ".*", comma: bool) {
            let _ = cell_number(&text, comma);
        }
    }
}

#[cfg(test)]
mod clock_tests {
    use super::*;

    #[test]
    fn times_with_a_date_and_without_are_seconds() {
        assert_eq!(clock_s("12:30:01.25"), Some(45_001.25));
        assert_eq!(clock_s("00:00:00,5"), Some(0.5));
        // date -u -d "2026-03-01 12:30:01" +%s
        assert_eq!(clock_s("2026-03-01T12:30:01Z"), Some(1_772_368_201.0));
        assert_eq!(clock_s("2026/03/01 12:30:01"), Some(1_772_368_201.0));
        for wrong in [
            "12",
            "12:61:00",
            "a:b:c",
            "1:2:3:4",
            "12:30:nan",
            "2026-13-01 12:00:00",
            "",
        ] {
            assert_eq!(clock_s(wrong), None, "{wrong}");
        }
    }
}

#[cfg(test)]
mod encoding_tests {
    use super::*;

    fn read(bytes: &[u8]) -> Result<String, VariableFault> {
        decode(bytes, &ReadingBudget::new(1 << 20))
    }

    #[test]
    fn the_degree_sign_comes_through_in_every_encoding() {
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
    fn what_is_no_text_is_refused() {
        assert!(matches!(read(b"a\0b"), Err(VariableFault::Format { .. })));
        assert!(matches!(
            read(b"\xff\xfea"),
            Err(VariableFault::CutOff { .. })
        ));
        let small = decode(b"abc", &ReadingBudget::new(8));
        assert!(matches!(small, Err(VariableFault::TooLarge { .. })));
    }
}

#[cfg(test)]
mod lines_tests {
    use super::*;

    #[test]
    fn lines_end_as_on_any_system() {
        let found: Vec<_> = lines("\u{feff}a\r\nb\rc\n\nd").collect();
        assert_eq!(found, [(1, "a"), (2, "b"), (3, "c"), (4, ""), (5, "d")]);
    }

    #[test]
    fn a_zero_byte_is_no_text() {
        let fault = refuse_binary("ab\0c", "a table").unwrap_err();
        assert_eq!(
            fault.to_string(),
            "expected a table, found a file that is no text (byte 2 of it is zero)"
        );
    }

    #[test]
    fn a_message_shows_a_short_beginning() {
        assert_eq!(excerpt("\n ab\u{7}c\nd"), "ab\u{fffd}c");
        assert_eq!(excerpt(&"x".repeat(50)).chars().count(), 41);
    }
}

#[cfg(test)]
mod sections_tests {
    use super::*;

    #[test]
    fn a_text_is_cut_where_a_heading_stands_behind_rows() {
        let text = "\nt | P |\n1 | 2 |\n2 | nan |\n\nt | P | Q |\n\nt | P | Q |\n1 | 2 | 3 |\n";
        let found = sections(text);
        assert_eq!(
            found,
            [
                (1, "\nt | P |\n1 | 2 |\n2 | nan |\n\n"),
                (6, "t | P | Q |\n\nt | P | Q |\n1 | 2 | 3 |\n")
            ]
        );
        assert_eq!(
            sections("# by hand\na b\n1 2\n# middle\n3 4"),
            [(1, "# by hand\na b\n1 2\n# middle\n3 4")]
        );
        assert_eq!(sections(""), [(1, "")]);
    }
}
