//! Scanner for MATLAB or Octave statements: blanks and comments, names, strings and numbers.
//!
//! Methods that read or skip something move past it; methods that return `None` or false do not
//! move. A copy of the scanner keeps a position, to which reading can return.
//!
//! A `VariableFault` ends the reading; a `ValueError` may instead concern a single value that is
//! not supported, after which the caller continues with the next statement.

use crate::formats::text::lines::excerpt;
use crate::formats::text::matlab_brackets::OpenBrackets;
use crate::formats::text::matlab_number_syntax::{is_digit, past_exponent, past_mantissa};
use crate::formats::text::matlab_value_position::{MOST_NESTED, Position, ValueError, refused};
use crate::reading_budget::{NO_VARIABLE, ReadingBudget, VariableFault};
use crate::variable_fault::line_fault::LineFault;
use crate::variable_fault::matlab_value_fault::MatlabFault;

pub(super) fn is_name_character(character: char) -> bool {
    character.is_alphanumeric() || character == '_'
}

pub(super) fn begins_name(text: &str) -> bool {
    text.starts_with(|first: char| first.is_alphabetic() || first == '_')
}

/// An unsigned real or imaginary number.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Number {
    pub(super) value: f64,
    pub(super) is_imaginary: bool,
}

/// A text, and the current position in it.
#[derive(Clone)]
pub(super) struct Scanner<'t> {
    pub(super) text: &'t str,
    /// Offset of the current position \[bytes\].
    pub(super) at: usize,
    line: usize,
    /// Offset at which the current line begins \[bytes\].
    line_start: usize,
}

impl<'t> Scanner<'t> {
    pub(super) fn new(text: &'t str) -> Self {
        Self {
            text,
            at: 0,
            line: 1,
            line_start: 0,
        }
    }

    /// Returns the text from the current position on.
    pub(super) fn rest(&self) -> &'t str {
        &self.text[self.at..]
    }

    pub(super) fn rest_of_line(&self) -> &'t str {
        self.rest().split(['\n', '\r']).next().unwrap_or_default()
    }

    /// Returns the next character, without moving.
    pub(super) fn peek(&self) -> Option<char> {
        self.rest().chars().next()
    }

    /// Moves past `sign` if it comes next; returns whether it does.
    pub(super) fn take(&mut self, sign: &str) -> bool {
        let is_next = self.rest().starts_with(sign);
        if is_next {
            self.at += sign.len();
        }
        is_next
    }

    /// Returns the current position. The column counts characters, in very long lines bytes.
    pub(super) fn position(&self) -> Position {
        /// Maximum number of bytes before the position in which characters are counted.
        const COUNTED: usize = 2000;
        let before = &self.text[self.line_start..self.at];
        let characters = if before.len() > COUNTED {
            before.len()
        } else {
            before.chars().count()
        };
        Position {
            line: self.line,
            column: 1 + characters,
        }
    }

    /// Moves past a line end.
    pub(super) fn new_line(&mut self) {
        if self.rest().starts_with("\r\n") {
            self.at += 2;
        } else if !self.rest().is_empty() {
            self.at += 1;
        }
        self.line += 1;
        self.line_start = self.at;
    }

    /// Moves to the end of the line, before the line feed.
    fn pass_line(&mut self) {
        self.at += self.rest().find(['\n', '\r']).unwrap_or(self.rest().len());
    }

    /// Skips blanks, comments, and line ends after "..."; returns whether there were any.
    pub(super) fn pass_blanks(&mut self) -> Result<bool, VariableFault> {
        let from = self.at;
        while let Some(character) = self.peek() {
            match character {
                '\n' | '\r' => break,
                _ if character.is_whitespace() || character == '\u{feff}' => {
                    self.at += character.len_utf8()
                }
                '%' | '#' if self.begins_line() && self.is_block_mark('{') => {
                    self.pass_block_comment()?
                }
                '%' | '#' => self.pass_line(),
                '.' if self.rest().starts_with("...") => {
                    self.pass_line();
                    if self.peek().is_some() {
                        self.new_line();
                    }
                }
                _ => break,
            }
        }
        Ok(self.at > from)
    }

    fn begins_line(&self) -> bool {
        self.text[self.line_start..self.at].trim().is_empty()
    }

    /// Returns whether the rest of the line is a comment mark and `bracket`, which begin or end a
    /// block comment.
    fn is_block_mark(&self, bracket: char) -> bool {
        let line = self.rest_of_line().trim();
        let Some(rest) = line.strip_prefix(['%', '#']) else {
            return false;
        };
        rest.strip_prefix(bracket) == Some("")
    }

    fn pass_block_comment(&mut self) -> Result<(), VariableFault> {
        let line = self.line;
        let mut depth = 0_usize;
        loop {
            if self.is_block_mark('{') {
                depth += 1;
            } else if self.is_block_mark('}') {
                depth -= 1;
            }
            self.pass_line();
            if depth == 0 {
                return Ok(());
            }
            if self.peek().is_none() {
                return Err(VariableFault::line(
                    NO_VARIABLE,
                    line,
                    LineFault::OpenComment,
                ));
            }
            self.new_line();
        }
    }

    /// Reads the name at this position; `None` if there is none.
    pub(super) fn read_name(&mut self) -> Option<&'t str> {
        let rest = self.rest();
        if !begins_name(rest) {
            return None;
        }
        let end = rest
            .find(|c: char| !is_name_character(c))
            .unwrap_or(rest.len());
        self.at += end;
        Some(&rest[..end])
    }

    /// Reads the names at this position, separated by points as in "sys.A"; empty if there are
    /// none.
    pub(super) fn read_path(
        &mut self,
        budget: &ReadingBudget,
    ) -> Result<Vec<&'t str>, VariableFault> {
        let mut path: Vec<&'t str> = self.read_name().into_iter().collect();
        while let Some(first) = path.first() {
            if path.len() > MOST_NESTED {
                return Err(VariableFault::too_deep(first));
            }
            let before = self.clone();
            let next = if self.take(".") {
                self.read_name()
            } else {
                None
            };
            let Some(name) = next else {
                *self = before;
                break;
            };
            budget.take(1, 16, name)?;
            path.push(name);
        }
        Ok(path)
    }

    /// Reads a string up to the closing quotation mark, which must be on the same line; a doubled
    /// quotation mark means a single one.
    pub(super) fn read_quoted(&mut self, budget: &ReadingBudget) -> Result<String, ValueError> {
        let opening = self.position();
        let quote = self.peek().unwrap_or('\'');
        self.at += 1;
        let mut text = String::new();
        loop {
            let rest = self.rest();
            let end = rest.find([quote, '\n', '\r']);
            let Some(end) = end.filter(|&end| rest[end..].starts_with(quote)) else {
                return refused(MatlabFault::OpenString { quote }, opening);
            };
            budget.take(2 * end as u64 + 2, 1, NO_VARIABLE)?;
            text.push_str(&rest[..end]);
            self.at += end + 1;
            if self.peek() != Some(quote) {
                return Ok(text);
            }
            text.push(quote);
            self.at += 1;
        }
    }

    /// Reads the unsigned number at this position; `None` if there is none.
    pub(super) fn read_number(&mut self) -> Result<Option<Number>, ValueError> {
        let rest = self.rest();
        let place = self.position();
        let bytes = rest.as_bytes();
        if !(is_digit(bytes, 0) || (rest.starts_with('.') && is_digit(bytes, 1))) {
            return Ok(None);
        }
        // Offsets in `rest`: mantissa, exponent, letter i or j, then letters that make it invalid.
        let mut end = past_mantissa(bytes);
        end = past_exponent(bytes, end);
        let value = rest[..end].replace(['d', 'D'], "e").parse();
        let is_imaginary = matches!(bytes.get(end), Some(b'i' | b'j'));
        end += usize::from(is_imaginary);
        let tail = rest[end..]
            .find(|c: char| !is_name_character(c))
            .unwrap_or(rest.len() - end);
        self.at += end + tail;
        match value {
            Ok(value) if tail == 0 => Ok(Some(Number {
                value,
                is_imaginary,
            })),
            _ => refused(
                MatlabFault::NotANumber {
                    text: excerpt(&rest[..end + tail]),
                },
                place,
            ),
        }
    }

    /// Moves to the end of the statement.
    ///
    /// # Errors
    /// [`VariableFault`] for an unclosed square or curly bracket or block comment, because all
    /// following text would belong to the statement; also for brackets nested too deeply, and if
    /// the budget is exhausted.
    pub(super) fn pass_statement(&mut self, budget: &ReadingBudget) -> Result<(), VariableFault> {
        let mut open = OpenBrackets::default();
        loop {
            budget.work(1, NO_VARIABLE)?;
            let is_spaced = self.pass_blanks()?;
            let Some(character) = self.peek() else {
                return open.check_closed();
            };
            match character {
                '\n' | '\r' => {
                    open.end_line();
                    if open.is_empty() {
                        return Ok(());
                    }
                    self.new_line();
                    continue;
                }
                ';' | ',' if open.is_empty() => return Ok(()),
                '\'' | '"' if self.begins_text(character, is_spaced, &open) => {
                    self.pass_text(budget)?;
                    continue;
                }
                '(' | '[' | '{' => open.open(character, self.position())?,
                ')' | ']' | '}' => open.close(character),
                _ => {}
            }
            self.at += character.len_utf8();
        }
    }

    /// Returns whether a quotation mark begins a string; a single one after an operand denotes the
    /// transpose, unless a blank precedes it in a matrix.
    fn begins_text(&self, quote: char, is_spaced: bool, open: &OpenBrackets) -> bool {
        if quote == '"' || (is_spaced && open.is_in_matrix()) {
            return true;
        }
        let before = self.text[..self.at].chars().next_back();
        let is_operand = before.is_some_and(|c| c.is_alphanumeric() || "_)]}'.".contains(c));
        !is_operand
    }

    /// Moves past a string, or to the end of the line if the string is not closed.
    fn pass_text(&mut self, budget: &ReadingBudget) -> Result<(), VariableFault> {
        match self.read_quoted(budget) {
            Err(ValueError::Fault(fault)) => return Err(fault),
            Err(ValueError::NotUnderstood { .. }) => self.pass_line(),
            Ok(_) => {}
        }
        Ok(())
    }

    /// Returns whether the text after a name changes the named value in part or in place: "+= 1",
    /// "++", "(2,1) = 3".
    pub(super) fn changes_part(&self) -> bool {
        let line = self.rest_of_line();
        match line.chars().next() {
            Some(sign @ ('+' | '-' | '*' | '/' | '^')) => is_update(sign, &line[1..]),
            Some('(') => is_indexed_assignment(line, '(', ')'),
            Some('{') => is_indexed_assignment(line, '{', '}'),
            _ => false,
        }
    }
}

/// Returns whether the operator `sign` and the text after it change a value in place: "+= 1", "++".
fn is_update(sign: char, behind: &str) -> bool {
    if behind.starts_with('=') {
        return true;
    }
    let Some(rest) = behind.strip_prefix(sign) else {
        return false;
    };
    rest.trim_start().is_empty() || rest.starts_with(';')
}

/// Returns whether a line that begins with an opening bracket assigns to an element, or to an
/// element's field: "(2,1) = 3", "{2}.name = 3".
fn is_indexed_assignment(line: &str, open: char, close: char) -> bool {
    let mut depth = 0_usize;
    for (at, character) in line.char_indices() {
        if character == open {
            depth += 1;
        } else if character == close {
            depth -= 1;
        }
        if depth == 0 {
            let behind = line[at + 1..]
                .trim_start()
                .trim_start_matches(|c: char| c == '.' || is_name_character(c))
                .trim_start();
            return behind.starts_with('=') && !behind.starts_with("==");
        }
    }
    false
}
