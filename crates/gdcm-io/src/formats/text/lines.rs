//! Lines of a text: line endings, comments, ruled lines, and excerpts for messages.

/// Marks that begin a comment line.
const COMMENT_MARKS: [&str; 5] = ["#", "%", "//", "!", ";"];
/// Marks that begin a comment after a line's cells, with the blanks around them.
const TRAILING_MARKS: [&str; 7] = [" # ", " % ", " ! ", " // ", "\t# ", "\t% ", "\t! "];
/// Maximum excerpt length in a message \[characters\].
const EXCERPT: usize = 40;

/// A line with its number in the text.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct NumberedLine {
    /// Line number, counted from 1.
    pub number: usize,
    pub text: String,
}

/// Iterator over lines and their numbers, from 1; a line ends in a line feed, a carriage return, or
/// both.
pub(super) struct Lines<'t> {
    rest: Option<&'t str>,
    number: usize,
}

/// Returns a text's lines with their numbers, without a byte order mark.
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

/// Returns the text after the mark in a comment line; `None` for any other line.
pub(super) fn comment(line: &str) -> Option<&str> {
    let line = line.trim_start();
    let mark = COMMENT_MARKS.iter().find(|&&mark| line.starts_with(mark))?;
    Some(line.trim_start_matches(mark))
}

/// Returns a line without the comment at its end. The mark must be between blanks, because "#N/A"
/// and "50%" contain the same characters.
pub(super) fn without_comment(line: &str) -> &str {
    if !line.contains(['#', '%', '!', '/']) {
        return line;
    }
    let ends = TRAILING_MARKS.iter().filter_map(|mark| line.find(mark));
    match ends.min() {
        Some(end) => &line[..end],
        None => line,
    }
}

/// Returns whether a line is a ruled line such as "-----", "|---|---|" or "=====".
pub(super) fn is_rule(line: &str) -> bool {
    // "- - -" is a row of missing numbers, not a rule.
    line.trim().len() >= 3
        && line.bytes().all(|byte| b"-=+|:_ \t".contains(&byte))
        && !line.trim().contains("- -")
}

/// Shortens a text for a message to at most 40 visible characters from its first line.
pub(super) fn excerpt(text: &str) -> String {
    // Examine only what is displayed: a line may be as long as the text.
    let mut shown = String::new();
    let mut is_cut = false;
    for (index, character) in text.trim_start().chars().enumerate() {
        if matches!(character, '\n' | '\r') {
            break;
        }
        if index == EXCERPT {
            is_cut = true;
            break;
        }
        shown.push(if character.is_control() {
            '\u{fffd}'
        } else {
            character
        });
    }
    shown.truncate(shown.trim_end().len());
    if is_cut {
        shown.push('…');
    }
    shown
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_end_as_on_any_system() {
        let found: Vec<_> = lines("\u{feff}a\r\nb\rc\n\nd").collect();
        assert_eq!(found, [(1, "a"), (2, "b"), (3, "c"), (4, ""), (5, "d")]);
    }

    #[test]
    fn excerpts_are_short_and_printable() {
        assert_eq!(excerpt("\n ab\u{7}c\nd"), "ab\u{fffd}c");
        assert_eq!(excerpt(&"x".repeat(50)).chars().count(), 41);
        assert_eq!(excerpt(&"x".repeat(40)).chars().count(), 40);
    }

    #[test]
    fn only_marks_between_blanks_begin_a_trailing_comment() {
        assert_eq!(without_comment("1 #N/A 50%"), "1 #N/A 50%");
        assert_eq!(without_comment("1 2 # first"), "1 2");
    }

    #[test]
    fn rules_are_recognised() {
        assert!(is_rule("|---|---|") && is_rule("====") && !is_rule("- - -") && !is_rule("-1"));
    }
}
