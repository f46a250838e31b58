//! Numbers in table cells, in notations from different programs.
//!
//! A *missing number* is an empty cell, or a word or sign that programs write instead of a number,
//! such as "n/a"; its value is NaN.

/// Words that programs write instead of a missing number.
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

/// Maximum length \[bytes\] for a number in a notation that Rust does not parse; longer cells are
/// text.
const LONGEST: usize = 400;

/// Parses the number in a cell: NaN for a missing number, `None` for anything that is not a number.
///
/// The decimal mark is a comma if `decimal_comma`, otherwise a point; the other mark is rejected,
/// as it may group thousands.
pub(super) fn cell_number(cell: &str, decimal_comma: bool) -> Option<f64> {
    let cell = cell.trim();
    if cell.is_empty() {
        return Some(f64::NAN);
    }
    // Rust parses only decimal points: with decimal commas, only numbers without any mark.
    let has_other_mark = decimal_comma && cell.contains(['.', ',']);
    if !has_other_mark && let Ok(number) = cell.parse::<f64>() {
        return Some(number);
    }
    if is_missing(cell) {
        return Some(f64::NAN);
    }
    foreign_number(cell, decimal_comma)
}

/// Returns whether a cell is a number, with either decimal mark, or a missing number.
pub(super) fn is_number(cell: &str) -> bool {
    cell_number(cell, false).is_some() || cell_number(cell, true).is_some()
}

/// Returns whether a cell holds a number other than NaN.
pub(super) fn has_number(cell: &str, decimal_comma: bool) -> bool {
    cell_number(cell, decimal_comma).is_some_and(|number| !number.is_nan())
}

/// Returns whether a cell holds a word or sign for a missing number.
fn is_missing(cell: &str) -> bool {
    let unsigned = cell.trim_start_matches('-');
    MISSING.iter().any(|word| cell.eq_ignore_ascii_case(word))
        // How the older Windows C library writes NaN.
        || ["1.#IND", "1.#QNAN", "1.#SNAN"].iter().any(|start| unsigned.starts_with(start))
        // Fortran writes asterisks if a number is too wide for its field.
        || cell.bytes().all(|byte| byte == b'*')
}

/// Parses notations that Rust does not parse: decimal comma, typographic minus sign, Fortran
/// exponent (`1D3`, or `1.0-103` without a letter), and infinity in the older Windows C library.
fn foreign_number(cell: &str, decimal_comma: bool) -> Option<f64> {
    if cell.starts_with("1.#INF") {
        return Some(f64::INFINITY);
    }
    if cell.starts_with("-1.#INF") {
        return Some(f64::NEG_INFINITY);
    }
    if cell.len() > LONGEST || !cell.contains(|c: char| c.is_ascii_digit()) {
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
    // Insert the exponent letter, which Fortran omits before three digits: 1.0-103.
    if let Some(at) = plain.rfind(['+', '-'])
        && at > 0
        && plain.len() - at == 4
        && !plain.contains(['e', 'E'])
    {
        plain.insert(at, 'e');
    }
    plain.parse().ok()
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
