//! What stands between the cells of a line.

use std::borrow::Cow;

/// What stands between the cells of a line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Separator {
    /// A tabulator.
    Tab,
    /// A semicolon.
    Semicolon,
    /// An upright stroke; one in front of the first cell is passed over.
    Pipe,
    /// A comma.
    Comma,
    /// Any run of blanks and tabulators.
    Blanks,
}

impl Separator {
    /// All of them, the more telling first.
    pub(super) const ALL: [Separator; 5] =
        [Separator::Tab, Separator::Semicolon, Separator::Pipe, Separator::Comma, Separator::Blanks];

    /// Its name in a message.
    pub fn words(self) -> &'static str {
        match self {
            Separator::Tab => "tabulators",
            Separator::Semicolon => "semicolons",
            Separator::Pipe => "upright strokes",
            Separator::Comma => "commas",
            Separator::Blanks => "blanks",
        }
    }

    /// The cells of a line, without the quotes around them.
    pub(super) fn cells(self, line: &str) -> Cells<'_> {
        let line = match self {
            Separator::Pipe => line.trim_start().strip_prefix('|').unwrap_or(line),
            Separator::Blanks => line.trim(),
            _ => line,
        };
        Cells { rest: Some(line), separator: self }
    }

    fn is(self, character: char) -> bool {
        match self {
            Separator::Tab => character == '\t',
            Separator::Semicolon => character == ';',
            Separator::Pipe => character == '|',
            Separator::Comma => character == ',',
            Separator::Blanks => character.is_whitespace(),
        }
    }
}

/// The cells of a line one after another: a line of a million cells takes no memory.
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
        // Where something follows the quotes, they are characters like others.
        let whole = &rest[..rest.len() - behind.len() + between.len()];
        Some(if between.trim().is_empty() && !cell.is_empty() { cell } else { Cow::Borrowed(unquoted(whole)) })
    }
}

fn after_first(text: &str) -> &str {
    let mut characters = text.chars();
    characters.next();
    characters.as_str()
}

/// An empty pair of quotes is an empty cell.
fn unquoted(cell: &str) -> &str {
    if cell.trim() == "\"\"" { "" } else { cell }
}

/// The cell between the quotes at the start of a text, and what follows them.
fn quoted(text: &str) -> Option<(Cow<'_, str>, &str)> {
    let inner = text.trim_start().strip_prefix('"')?;
    let mut from = 0;
    loop {
        let end = from + inner[from..].find('"')?;
        if !inner[end + 1..].starts_with('"') {
            let cell = &inner[..end];
            let cell = if cell.contains('"') { Cow::Owned(cell.replace("\"\"", "\"")) } else { Cow::Borrowed(cell) };
            return Some((cell, &inner[end + 1..]));
        }
        from = end + 2;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cells(separator: Separator, line: &str) -> Vec<String> {
        separator.cells(line).map(Cow::into_owned).collect()
    }

    #[test]
    fn cells_are_cut_at_their_separator() {
        assert_eq!(cells(Separator::Comma, "1, 2,,"), ["1", " 2", "", ""]);
        assert_eq!(cells(Separator::Blanks, "  1 \t 2\u{a0}3 "), ["1", "2", "3"]);
        assert_eq!(cells(Separator::Pipe, " | 1 | 2 |"), [" 1 ", " 2 ", ""]);
        assert_eq!(cells(Separator::Tab, "1\t\t2"), ["1", "", "2"]);
    }

    #[test]
    fn quotes_keep_separators_together() {
        assert_eq!(cells(Separator::Comma, r#""1,5", "a ""b""",c"#), ["1,5", "a \"b\"", "c"]);
        assert_eq!(cells(Separator::Blanks, r#""omega [rad/s]" "" x"#), ["omega [rad/s]", "", "x"]);
    }

    #[test]
    fn a_quote_that_is_not_closed_is_a_character() {
        assert_eq!(cells(Separator::Comma, "\"1,2"), ["\"1", "2"]);
        assert_eq!(cells(Separator::Comma, "\"1\"a,2"), ["\"1\"a", "2"]);
    }
}
