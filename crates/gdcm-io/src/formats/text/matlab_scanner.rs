//! Scanner for MATLAB or Octave statements: blanks and comments, names, texts and numbers.

use crate::formats::text::separator::excerpt;
use crate::reading_budget::{ReadingBudget, VariableFault};

/// Deepest nesting of values; each level takes stack space.
pub(super) const MOST_NESTED: usize = 64;

/// Whether a name can contain this character.
pub(super) fn is_of_word(character: char) -> bool {
    character.is_alphanumeric() || character == '_'
}

/// Whether a text begins with the first character of a name.
pub(super) fn begins_word(text: &str) -> bool {
    text.starts_with(|first: char| first.is_alphabetic() || first == '_')
}

/// Reason why a value was not read.
pub(super) enum ValueError {
    /// The value is not understood; other values may be.
    NotUnderstood { what: String, at: Position },
    /// Ends the reading.
    Fault(VariableFault),
}

impl From<VariableFault> for ValueError {
    fn from(fault: VariableFault) -> Self {
        Self::Fault(fault)
    }
}

pub(super) fn refused<T>(what: impl Into<String>, at: Position) -> Result<T, ValueError> {
    Err(ValueError::NotUnderstood {
        what: what.into(),
        at,
    })
}

/// A line and a column, both from 1.
#[derive(Clone, Copy)]
pub(super) struct Position {
    pub(super) line: usize,
    pub(super) column: usize,
}

/// A text with the current position.
#[derive(Clone)]
pub(super) struct Scanner<'t> {
    pub(super) text: &'t str,
    pub(super) at: usize,
    line: usize,
    line_start: usize,
}

impl<'t> Scanner<'t> {
    /// Starts at the beginning of a text.
    pub(super) fn new(text: &'t str) -> Self {
        Self {
            text,
            at: 0,
            line: 1,
            line_start: 0,
        }
    }

    pub(super) fn rest(&self) -> &'t str {
        &self.text[self.at..]
    }

    pub(super) fn rest_of_line(&self) -> &'t str {
        self.rest().split(['\n', '\r']).next().unwrap_or_default()
    }

    pub(super) fn peek(&self) -> Option<char> {
        self.rest().chars().next()
    }

    pub(super) fn take(&mut self, sign: &str) -> bool {
        let is_next = self.rest().starts_with(sign);
        self.at += if is_next { sign.len() } else { 0 };
        is_next
    }

    /// Returns the current position; in a very long line the column is counted in bytes.
    pub(super) fn position(&self) -> Position {
        let before = &self.text[self.line_start..self.at];
        Position {
            line: self.line,
            column: 1 + if before.len() > 2000 {
                before.len()
            } else {
                before.chars().count()
            },
        }
    }

    pub(super) fn new_line(&mut self) {
        self.at += if self.rest().starts_with("\r\n") {
            2
        } else {
            usize::from(!self.rest().is_empty())
        };
        self.line += 1;
        self.line_start = self.at;
    }

    fn pass_line(&mut self) {
        self.at += self.rest().find(['\n', '\r']).unwrap_or(self.rest().len());
    }

    /// Skips blanks, comments and continued line ends; returns whether there were any.
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

    /// Whether the rest of the line is a comment mark and this bracket, which begin or end a block
    /// comment.
    fn is_block_mark(&self, bracket: char) -> bool {
        let line = self.rest_of_line().trim();
        line.strip_prefix(['%', '#'])
            .is_some_and(|rest| rest.strip_prefix(bracket) == Some(""))
    }

    fn pass_block_comment(&mut self) -> Result<(), VariableFault> {
        let line = self.line;
        let mut depth = 0_usize;
        loop {
            depth =
                depth + usize::from(self.is_block_mark('{')) - usize::from(self.is_block_mark('}'));
            self.pass_line();
            if depth == 0 {
                return Ok(());
            }
            if self.peek().is_none() {
                let what = "the comment opened here is never closed; write %} on a line of its own";
                return Err(VariableFault::line("", line, what));
            }
            self.new_line();
        }
    }

    /// Reads a name, if there is one at this position.
    pub(super) fn name(&mut self) -> Option<&'t str> {
        let rest = self.rest();
        let end = rest.find(|c: char| !is_of_word(c)).unwrap_or(rest.len());
        let is_name = begins_word(rest);
        self.at += if is_name { end } else { 0 };
        is_name.then_some(&rest[..end])
    }

    /// Reads names separated by points, if there are any at this position: "sys.A".
    pub(super) fn path(&mut self, budget: &ReadingBudget) -> Result<Vec<&'t str>, VariableFault> {
        let mut path: Vec<&'t str> = self.name().into_iter().collect();
        while let Some(first) = path.first() {
            if path.len() > MOST_NESTED {
                return Err(VariableFault::too_deep(first));
            }
            let before = self.clone();
            let next = if self.take(".") { self.name() } else { None };
            let Some(name) = next else {
                *self = before;
                break;
            };
            budget.take(1, 16, name)?;
            path.push(name);
        }
        Ok(path)
    }

    /// Reads a text up to its closing quote on the same line; a doubled quote is a character.
    pub(super) fn quoted(&mut self, budget: &ReadingBudget) -> Result<String, ValueError> {
        let opening = self.position();
        let quote = self.peek().unwrap_or('\'');
        self.at += 1;
        let mut text = String::new();
        loop {
            let rest = self.rest();
            let Some(end) = rest
                .find([quote, '\n', '\r'])
                .filter(|&end| rest[end..].starts_with(quote))
            else {
                return refused(
                    format!("a text begins here and has no end; write {quote} behind it"),
                    opening,
                );
            };
            budget.take(2 * end as u64 + 2, 1, "")?;
            text.push_str(&rest[..end]);
            self.at += end + 1;
            if self.peek() != Some(quote) {
                return Ok(text);
            }
            text.push(quote);
            self.at += 1;
        }
    }

    /// Reads an unsigned number, and whether it is imaginary, if there is one at this position.
    pub(super) fn number(&mut self) -> Result<Option<(f64, bool)>, ValueError> {
        let rest = self.rest();
        let place = self.position();
        let bytes = rest.as_bytes();
        let digits = |from: usize| {
            from + bytes[from..]
                .iter()
                .take_while(|byte| byte.is_ascii_digit())
                .count()
        };
        let begins = |at: usize| bytes.get(at).is_some_and(u8::is_ascii_digit);
        if !(begins(0) || (rest.starts_with('.') && begins(1))) {
            return Ok(None);
        }
        let mut end = digits(0);
        // A point before an operator belongs to the operator: "1./x", "2.^n", "1...".
        let operator = |at: usize| bytes.get(at).is_some_and(|byte| b"*/\\^'.".contains(byte));
        if bytes.get(end) == Some(&b'.') && !operator(end + 1) {
            end = digits(end + 1);
        }
        if bytes.get(end).is_some_and(|byte| b"eEdD".contains(byte)) {
            let signed =
                end + 1 + usize::from(bytes.get(end + 1).is_some_and(|byte| b"+-".contains(byte)));
            end = if begins(signed) { digits(signed) } else { end };
        }
        let value = rest[..end].replace(['d', 'D'], "e").parse();
        let imaginary = matches!(bytes.get(end), Some(b'i' | b'j'));
        end += usize::from(imaginary);
        let tail = rest[end..]
            .find(|c: char| !is_of_word(c))
            .unwrap_or(rest.len() - end);
        self.at += end + tail;
        match value {
            Ok(value) if tail == 0 => Ok(Some((value, imaginary))),
            _ => refused(
                format!("\"{}\" is no number", excerpt(&rest[..end + tail])),
                place,
            ),
        }
    }

    /// Moves to the end of the statement; an unclosed bracket is a fault, as it would include all
    /// that follows.
    pub(super) fn pass_statement(&mut self, budget: &ReadingBudget) -> Result<(), VariableFault> {
        let mut open: Vec<(char, Position)> = Vec::new();
        loop {
            budget.work(1, "")?;
            let spaced = self.pass_blanks()?;
            let Some(character) = self.peek() else { break };
            let before = self.text[..self.at].chars().next_back();
            let is_operand = before.is_some_and(|c| c.is_alphanumeric() || "_)]}'.".contains(c));
            let in_matrix = matches!(open.last(), Some(('[' | '{', _)));
            match character {
                '\n' | '\r' => {
                    // A round bracket ends at the latest with its line.
                    open.truncate(
                        open.iter()
                            .rposition(|(bracket, _)| *bracket != '(')
                            .map_or(0, |last| last + 1),
                    );
                    if open.is_empty() {
                        return Ok(());
                    }
                    self.new_line();
                    continue;
                }
                ';' | ',' if open.is_empty() => return Ok(()),
                '\'' | '"' if character == '"' || !is_operand || (spaced && in_matrix) => {
                    match self.quoted(budget) {
                        Err(ValueError::Fault(fault)) => return Err(fault),
                        Err(ValueError::NotUnderstood { .. }) => self.pass_line(),
                        Ok(_) => {}
                    }
                    continue;
                }
                '(' | '[' | '{' if open.len() >= MOST_NESTED => {
                    return Err(VariableFault::too_deep(""));
                }
                '(' | '[' | '{' => open.push((character, self.position())),
                ')' | ']' | '}' => {
                    let opening = if character == ')' {
                        '('
                    } else {
                        char::from(character as u8 - 2)
                    };
                    open.truncate(
                        open.iter()
                            .rposition(|(bracket, _)| *bracket == opening)
                            .unwrap_or(open.len()),
                    );
                }
                _ => {}
            }
            self.at += character.len_utf8();
        }
        match open.into_iter().rev().find(|(bracket, _)| *bracket != '(') {
            None => Ok(()),
            Some((bracket, Position { line, column })) => {
                let what =
                    format!("the bracket {bracket} in column {column} is never closed; close it");
                Err(VariableFault::line("", line, what))
            }
        }
    }

    /// Whether the text after a name changes part of its value: "+= 1", "++", "(2,1) = 3".
    pub(super) fn changes_part(&self) -> bool {
        let line = self.rest_of_line();
        let Some(sign) = line.chars().next() else {
            return false;
        };
        if "+-*/^".contains(sign) {
            return line[1..].starts_with('=')
                || line[1..]
                    .strip_prefix(sign)
                    .is_some_and(|rest| rest.trim_start().is_empty() || rest.starts_with(';'));
        }
        let close = match sign {
            '(' => ')',
            '{' => '}',
            _ => return false,
        };
        let mut open = 0_usize;
        for (at, character) in line.char_indices() {
            open = open + usize::from(character == sign) - usize::from(character == close);
            if open == 0 {
                let behind = line[at + 1..].trim_start();
                let behind = behind
                    .trim_start_matches(|c: char| c == '.' || is_of_word(c))
                    .trim_start();
                return behind.starts_with('=') && !behind.starts_with("==");
            }
        }
        false
    }
}
