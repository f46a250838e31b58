//! Lines that programs print above the rows of a matrix.

use super::cell_number::cell_number;

/// A line that names a matrix.
#[derive(Debug, PartialEq, Eq)]
pub(super) struct NameLine<'t> {
    /// The name.
    pub(super) name: &'t str,
    /// Whether an equals sign stands behind it.
    pub(super) assigned: bool,
    /// Numbers on the same line.
    pub(super) rest: &'t str,
}

/// Reads "A", "A =", "A:", "A (3x2)", "A = 5" and "A,,,".
pub(super) fn name_line(line: &str) -> Option<NameLine<'_>> {
    let line = line.trim().trim_end_matches([',', ';', '\t', ' ']);
    let end = line.find(|c: char| !(c.is_alphanumeric() || c == '_' || c == '.')).unwrap_or(line.len());
    let (name, behind) = line.split_at(end);
    let numeric = [false, true].iter().any(|&comma| cell_number(name, comma).is_some());
    if numeric || !name.starts_with(|c: char| c.is_alphabetic() || c == '_') {
        return None;
    }
    let behind = behind.trim_start();
    if let Some(rest) = behind.strip_prefix('=') {
        return Some(NameLine { name, assigned: true, rest: without_size(rest.trim()) });
    }
    let rest = without_size(behind.strip_prefix(':').unwrap_or(behind).trim());
    rest.is_empty().then_some(NameLine { name, assigned: false, rest })
}

/// A text without a size in front of it: "(3x2)", "\[3 x 2\]", "3x2".
fn without_size(text: &str) -> &str {
    let inner = text.trim_start_matches(['(', '[']);
    let (size, rest) = inner.split_at(inner.find([')', ']']).unwrap_or(inner.len()));
    let Some((rows, columns)) = size.split_once(['x', '×']) else { return text };
    let count = |word: &str| !word.trim().is_empty() && word.trim().bytes().all(|byte| byte.is_ascii_digit());
    if count(rows) && count(columns) { rest.trim_start_matches([')', ']']).trim() } else { text }
}

/// The factor of a line such as "1.0e+03 *".
pub(super) fn scale_line(line: &str) -> Option<f64> {
    let factor = line.trim().strip_suffix('*')?.trim();
    factor.parse().ok().filter(|factor: &f64| factor.is_finite())
}

/// Whether a line says which columns follow: "Columns 1 through 6", "Column 7:".
pub(super) fn is_columns_line(line: &str) -> bool {
    let mut words = line.trim().trim_end_matches(':').split_whitespace();
    matches!(words.next(), Some("Columns" | "Column"))
        && words.all(|word| matches!(word, "through" | "and" | "to") || word.bytes().all(|byte| byte.is_ascii_digit()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_stand_alone_or_before_a_sign() {
        let line = |text| name_line(text).map(|NameLine { name, assigned, rest }| (name, assigned, rest));
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
    fn factors_and_columns_are_seen() {
        assert_eq!(scale_line("   1.0e+03 *"), Some(1000.0));
        assert_eq!(scale_line("1 2"), None);
        assert!(
            is_columns_line(" Columns 1 through 6") && is_columns_line("Column 7:") && !is_columns_line("Column a")
        );
    }
}
