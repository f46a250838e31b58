//! Separators between cells in a line.

use std::borrow::Cow;

/// Separator between cells in a line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Separator {
    Tab,
    Semicolon,
    /// A vertical bar; a bar that begins a line is ignored.
    Pipe,
    Comma,
    /// Any run of blanks and tabs.
    Blanks,
}

impl Separator {
    /// All separators, in the order in which they are tried.
    pub(super) const ALL: [Separator; 5] = [
        Separator::Tab,
        Separator::Semicolon,
        Separator::Pipe,
        Separator::Comma,
        Separator::Blanks,
    ];

    /// Returns the separator's name, for messages.
    pub fn words(self) -> &'static str {
        match self {
            Separator::Tab => "tabs",
            Separator::Semicolon => "semicolons",
            Separator::Pipe => "vertical bars",
            Separator::Comma => "commas",
            Separator::Blanks => "blanks",
        }
    }

    /// Returns a line's cells, without quotation marks around them.
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

    /// Returns the character that is written between cells.
    pub(super) fn sign(self) -> char {
        match self {
            Separator::Tab => '\t',
            Separator::Semicolon => ';',
            Separator::Pipe => '|',
            Separator::Comma => ',',
            Separator::Blanks => ' ',
        }
    }

    /// Formats cells as a line; a cell that contains the separator is put in quotation marks.
    pub(super) fn line(self, cells: impl Iterator<Item = String>) -> String {
        let sign = self.sign();
        let mut line = String::new();
        for (index, cell) in cells.enumerate() {
            if index > 0 {
                line.push(sign);
            }
            if cell.contains(sign) {
                line.push('"');
                line.push_str(&cell);
                line.push('"');
            } else {
                line.push_str(&cell);
            }
        }
        line
    }

    /// Returns whether a character ends a cell.
    fn matches(self, character: char) -> bool {
        if self == Separator::Blanks {
            character.is_whitespace()
        } else {
            character == self.sign()
        }
    }
}

/// Iterates over a line's cells without allocating a list, because a line may have millions of
/// cells.
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
        // The cell ends at the next separator in `behind`, the text after a quotation, if there is
        // one.
        let Quoted { cell, behind } = Quoted::parse(rest).unwrap_or(Quoted {
            cell: Cow::Borrowed(""),
            behind: rest,
        });
        let end = behind.find(|character| self.separator.matches(character));
        let between = &behind[..end.unwrap_or(behind.len())];
        self.rest = end.and_then(|end| behind.get(end..)).map(without_first);
        if between.trim().is_empty() && !cell.is_empty() {
            return Some(cell);
        }
        // If other text follows the closing quotation mark, the marks are ordinary characters.
        let whole = &rest[..rest.len() - behind.len() + between.len()];
        Some(Cow::Borrowed(unquoted(whole)))
    }
}

/// Removes a text's first character, if there is one.
fn without_first(text: &str) -> &str {
    let mut characters = text.chars();
    characters.next();
    characters.as_str()
}

/// Returns an empty cell for two quotation marks with nothing between them; returns any other cell
/// unchanged.
fn unquoted(cell: &str) -> &str {
    if cell.trim() == "\"\"" { "" } else { cell }
}

/// A cell in quotation marks at the beginning of a text.
struct Quoted<'t> {
    /// Cell content; each doubled quotation mark is replaced by a single one.
    cell: Cow<'t, str>,
    /// Text after the closing quotation mark.
    behind: &'t str,
}

impl<'t> Quoted<'t> {
    /// Parses a cell in quotation marks; `None` if the opening or the closing mark is missing.
    fn parse(text: &'t str) -> Option<Self> {
        let inner = text.trim_start().strip_prefix('"')?;
        let mut from = 0;
        loop {
            let end = from + inner[from..].find('"')?;
            let behind = &inner[end + 1..];
            if !behind.starts_with('"') {
                let cell = &inner[..end];
                let cell = if cell.contains('"') {
                    Cow::Owned(cell.replace("\"\"", "\""))
                } else {
                    Cow::Borrowed(cell)
                };
                return Some(Self { cell, behind });
            }
            from = end + 2;
        }
    }
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
