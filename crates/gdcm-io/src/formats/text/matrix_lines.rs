//! Kinds of lines in printed matrices: names, column groups, common factors and rows.

use crate::formats::text::cell_number::is_number;

#[derive(Debug, PartialEq, Eq)]
pub(super) struct NameLine<'t> {
    pub(super) name: &'t str,
    /// Whether an equals sign follows the name.
    pub(super) has_equals_sign: bool,
    /// Text after the name on the same line, such as numbers.
    pub(super) rest: &'t str,
}

/// Parses a line with a name, such as "A", "A =", "A:", "A (3x2)", "A = 5" or "A,,,"; `None` for
/// any other line.
pub(super) fn name_line(line: &str) -> Option<NameLine<'_>> {
    let line = line.trim().trim_end_matches([',', ';', '\t', ' ']);
    let end = line
        .find(|c: char| !(c.is_alphanumeric() || c == '_' || c == '.'))
        .unwrap_or(line.len());
    let (name, behind) = line.split_at(end);
    if is_number(name) || !name.starts_with(|c: char| c.is_alphabetic() || c == '_') {
        return None;
    }
    let behind = behind.trim_start();
    if let Some(rest) = behind.strip_prefix('=') {
        return Some(NameLine {
            name,
            has_equals_sign: true,
            rest: without_size(rest.trim()),
        });
    }
    let rest = without_size(behind.strip_prefix(':').unwrap_or(behind).trim());
    if !rest.is_empty() {
        return None;
    }
    Some(NameLine {
        name,
        has_equals_sign: false,
        rest,
    })
}

/// Removes leading matrix dimensions from a text: "(3x2)", "\[3 x 2\]", "3x2".
fn without_size(text: &str) -> &str {
    let inner = text.trim_start_matches(['(', '[']);
    let (size, rest) = inner.split_at(inner.find([')', ']']).unwrap_or(inner.len()));
    let Some((rows, columns)) = size.split_once(['x', '×']) else {
        return text;
    };
    if is_count(rows.trim()) && is_count(columns.trim()) {
        rest.trim_start_matches([')', ']']).trim()
    } else {
        text
    }
}

/// Returns whether a word consists of digits.
fn is_count(word: &str) -> bool {
    !word.is_empty() && word.bytes().all(|byte| byte.is_ascii_digit())
}

/// Returns the factor in a line such as "1.0e+03 *"; `None` for any other line.
pub(super) fn scale_line(line: &str) -> Option<f64> {
    let factor = line.trim().strip_suffix('*')?.trim();
    let factor: f64 = factor.parse().ok()?;
    if factor.is_finite() {
        Some(factor)
    } else {
        None
    }
}

/// Returns whether a line announces a group of columns: "Columns 1 through 6", "Column 7:".
pub(super) fn is_columns_line(line: &str) -> bool {
    let mut words = line.trim().trim_end_matches(':').split_whitespace();
    matches!(words.next(), Some("Columns" | "Column"))
        && words.all(|word| {
            matches!(word, "through" | "and" | "to")
                || word.bytes().all(|byte| byte.is_ascii_digit())
        })
}

/// Returns whether a word, without a separator at its end, is a number or a missing number.
pub(super) fn is_number_word(word: &str) -> bool {
    let word = word.trim_end_matches([',', ';']);
    !word.is_empty() && is_number(word)
}

/// Returns whether a line contains only numbers, with any separator.
pub(super) fn is_row_of_numbers(line: &str) -> bool {
    let mut has_number = false;
    for word in line.split(|c: char| c.is_whitespace() || matches!(c, ',' | ';' | '|')) {
        if word.is_empty() {
            continue;
        }
        if !is_number_word(word) {
            return false;
        }
        has_number = true;
    }
    has_number
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_alone_or_before_a_sign() {
        let line = |text| {
            name_line(text).map(
                |NameLine {
                     name,
                     has_equals_sign,
                     rest,
                 }| (name, has_equals_sign, rest),
            )
        };
        assert_eq!(line("A"), Some(("A", false, "")));
        assert_eq!(line("  A =  "), Some(("A", true, "")));
        assert_eq!(line("sys.A = 5"), Some(("sys.A", true, "5")));
        assert_eq!(line("A: (3 x 2)"), Some(("A", false, "")));
        assert_eq!(line("A 3x2"), Some(("A", false, "")));
        assert_eq!(line("A,,,"), Some(("A", false, "")));
        for text in ["1 2", "nan", "x1 2 3", "x1 x2", "", "(A)"] {
            assert_eq!(line(text), None, "{text}");
        }
    }

    #[test]
    fn factors_and_column_lines_are_recognised() {
        assert_eq!(scale_line("   1.0e+03 *"), Some(1000.0));
        assert_eq!(scale_line("1 2"), None);
        assert!(
            is_columns_line(" Columns 1 through 6")
                && is_columns_line("Column 7:")
                && !is_columns_line("Column a")
        );
    }
}
