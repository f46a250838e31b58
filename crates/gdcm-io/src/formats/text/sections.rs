//! Consecutive tables in a text, each with a heading.

use crate::formats::text::cell_number::has_number;
use crate::formats::text::lines::{comment, is_rule, lines};

/// Separators between cells that may contain blanks.
const STRONG_SEPARATORS: [char; 4] = ['|', ';', '\t', ','];

/// Splits a text before every heading that follows rows, as in a log that was restarted with other
/// columns. Returns each part with the number of its first line, counted from 1.
pub fn sections(text: &str) -> Vec<(usize, &str)> {
    let mut sections = Vec::new();
    let mut first_line = 1;
    let mut start = 0;
    let mut has_rows = false;
    for (number, line) in lines(text) {
        if line.trim().is_empty() || comment(line).is_some() || is_rule(line) {
            continue;
        }
        let is_heading = is_heading(line);
        if is_heading && has_rows {
            // The line's offset in the text, of which the line is a slice.
            let end = line.as_ptr() as usize - text.as_ptr() as usize;
            sections.extend(text.get(start..end).map(|part| (first_line, part)));
            first_line = number;
            start = end;
        }
        // Any line that is no heading counts as a row.
        has_rows = !is_heading;
    }
    sections.extend(text.get(start..).map(|part| (first_line, part)));
    sections
}

/// Returns whether a line contains letters and no cell is a number.
fn is_heading(line: &str) -> bool {
    if !line.chars().any(char::is_alphabetic) {
        return false;
    }
    let is_strong = line.contains(STRONG_SEPARATORS);
    let mut cells = line.split(|character: char| {
        if is_strong {
            STRONG_SEPARATORS.contains(&character)
        } else {
            character.is_whitespace()
        }
    });
    !cells.any(|cell| has_number(cell, false))
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
