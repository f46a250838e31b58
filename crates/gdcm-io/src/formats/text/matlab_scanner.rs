//! Scanner for MATLAB or Octave statements: blanks and comments, names, texts and numbers.

use crate::formats::text::lines::excerpt;
use crate::reading_budget::{ReadingBudget, VariableFault};

/// Remedy for unsupported statements.
pub(super) const REMEDY: &str =
    "write its numbers, or save the workspace in MATLAB: save -v7 workspace.mat";
/// Maximum nesting depth of values; each level takes stack space.
pub(super) const MOST_NESTED: usize = 64;

/// Whether a name can contain this character.
pub(super) fn is_of_word(character: char) -> bool {
    character.is_alphanumeric() || character == '_'
}

/// Whether a text begins like a name.
pub(super) fn begins_word(text: &str) -> bool {
    text.starts_with(|first: char| first.is_alphabetic() || first == '_')
}

/// Reason why a value was not read.
pub(super) enum ValueError {
    /// The value is not supported; other values may be readable.
    NotUnderstood { what: String, at: Position },
    /// A fault that ends the reading.
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

/// An unsigned number.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Number {
    pub(super) value: f64,
    pub(super) is_imaginary: bool,
}

/// A text with the current position.
#[derive(Clone)]
pub(super) struct Scanner<'t> {
    pub(super) text: &'t str,
    /// Offset in the text \[bytes\].
    pub(super) at: usize,
    line: usize,
    /// Offset at which the line begins \[bytes\].
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

    pub(super) fn rest(&self) -> &'t str {
        &self.text[self.at..]
    }

    pub(super) fn rest_of_line(&self) -> &'t str {
        self.rest().split(['\n', '\r']).next().unwrap_or_default()
    }

    pub(super) fn peek(&self) -> Option<char> {
        self.rest().chars().next()
    }

    /// Moves past a sign if it is next; returns whether it was.
    pub(super) fn take(&mut self, sign: &str) -> bool {
        let is_next = self.rest().starts_with(sign);
        if is_next {
            self.at += sign.len();
        }
        is_next
    }

    /// Returns the current position; in a line beyond 2000 bytes the column is counted in bytes.
    pub(super) fn position(&self) -> Position {
        /// Maximum length of text in which characters are counted \[bytes\].
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

    /// Moves to the line end.
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
                let what = "the comment opened here is never closed; write %} on a line of its own";
                return Err(VariableFault::line("", line, what));
            }
            self.new_line();
        }
    }

    /// Reads a name, if there is one at this position.
    pub(super) fn name(&mut self) -> Option<&'t str> {
        let rest = self.rest();
        if !begins_word(rest) {
            return None;
        }
        let end = rest.find(|c: char| !is_of_word(c)).unwrap_or(rest.len());
        self.at += end;
        Some(&rest[..end])
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
            let end = rest.find([quote, '\n', '\r']);
            let Some(end) = end.filter(|&end| rest[end..].starts_with(quote)) else {
                return refused(
                    format!("a text begins here and has no end; close it with {quote}"),
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

    /// Reads an unsigned number, if there is one at this position.
    pub(super) fn number(&mut self) -> Result<Option<Number>, ValueError> {
        let rest = self.rest();
        let place = self.position();
        let bytes = rest.as_bytes();
        if !(is_digit(bytes, 0) || (rest.starts_with('.') && is_digit(bytes, 1))) {
            return Ok(None);
        }
        let mut end = past_mantissa(bytes);
        end = past_exponent(bytes, end);
        let value = rest[..end].replace(['d', 'D'], "e").parse();
        let is_imaginary = matches!(bytes.get(end), Some(b'i' | b'j'));
        end += usize::from(is_imaginary);
        let tail = rest[end..]
            .find(|c: char| !is_of_word(c))
            .unwrap_or(rest.len() - end);
        self.at += end + tail;
        match value {
            Ok(value) if tail == 0 => Ok(Some(Number {
                value,
                is_imaginary,
            })),
            _ => refused(
                format!("\"{}\" is no number", excerpt(&rest[..end + tail])),
                place,
            ),
        }
    }

    /// Moves to the end of the statement. An unclosed bracket is a fault, as all text after it
    /// would belong to the statement.
    pub(super) fn pass_statement(&mut self, budget: &ReadingBudget) -> Result<(), VariableFault> {
        let mut open = OpenBrackets::default();
        loop {
            budget.work(1, "")?;
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

    /// Whether a quote begins a text; a single quote after an operand transposes it.
    fn begins_text(&self, quote: char, is_spaced: bool, open: &OpenBrackets) -> bool {
        if quote == '"' || (is_spaced && open.is_in_matrix()) {
            return true;
        }
        let before = self.text[..self.at].chars().next_back();
        let is_operand = before.is_some_and(|c| c.is_alphanumeric() || "_)]}'.".contains(c));
        !is_operand
    }

    /// Moves past a text, or past the whole line if the text has no end.
    fn pass_text(&mut self, budget: &ReadingBudget) -> Result<(), VariableFault> {
        match self.quoted(budget) {
            Err(ValueError::Fault(fault)) => return Err(fault),
            Err(ValueError::NotUnderstood { .. }) => self.pass_line(),
            Ok(_) => {}
        }
        Ok(())
    }

    /// Whether the text after a name changes part of the value: "+= 1", "++", "(2,1) = 3".
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

/// Whether an operator and the text after it change a value: "+= 1", "++".
fn is_update(sign: char, behind: &str) -> bool {
    if behind.starts_with('=') {
        return true;
    }
    let Some(rest) = behind.strip_prefix(sign) else {
        return false;
    };
    rest.trim_start().is_empty() || rest.starts_with(';')
}

/// Whether a line that begins with an opening bracket assigns to an element or to its field:
/// "(2,1) = 3", "{2}.name = 3".
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
                .trim_start_matches(|c: char| c == '.' || is_of_word(c))
                .trim_start();
            return behind.starts_with('=') && !behind.starts_with("==");
        }
    }
    false
}

/// Open brackets in a statement, from the outermost.
#[derive(Default)]
struct OpenBrackets(Vec<OpenBracket>);

struct OpenBracket {
    bracket: char,
    place: Position,
}

impl OpenBrackets {
    fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    fn is_in_matrix(&self) -> bool {
        matches!(
            self.0.last(),
            Some(OpenBracket {
                bracket: '[' | '{',
                ..
            })
        )
    }

    fn open(&mut self, bracket: char, place: Position) -> Result<(), VariableFault> {
        if self.0.len() >= MOST_NESTED {
            return Err(VariableFault::too_deep(""));
        }
        self.0.push(OpenBracket { bracket, place });
        Ok(())
    }

    /// Closes the last matching bracket with all brackets inside it; ignores a closing bracket
    /// without an opening bracket.
    fn close(&mut self, closing: char) {
        let opening = match closing {
            ')' => '(',
            ']' => '[',
            _ => '{',
        };
        if let Some(at) = self.0.iter().rposition(|open| open.bracket == opening) {
            self.0.truncate(at);
        }
    }

    /// Closes the innermost round brackets, up to a square or curly bracket: a round bracket
    /// extends at most to the end of its line.
    fn end_line(&mut self) {
        while self.0.last().is_some_and(|open| open.bracket == '(') {
            self.0.pop();
        }
    }

    /// Returns an error if a square or curly bracket is still open. Unclosed round brackets are
    /// tolerated.
    fn check_closed(self) -> Result<(), VariableFault> {
        let unclosed = self.0.into_iter().rfind(|open| open.bracket != '(');
        let Some(OpenBracket { bracket, place }) = unclosed else {
            return Ok(());
        };
        let what = format!(
            "the bracket {bracket} in column {} is never closed; close it",
            place.column
        );
        Err(VariableFault::line("", place.line, what))
    }
}

fn is_digit(bytes: &[u8], at: usize) -> bool {
    bytes.get(at).is_some_and(u8::is_ascii_digit)
}

/// Returns the offset after the digits that begin at `from`.
fn past_digits(bytes: &[u8], from: usize) -> usize {
    let mut at = from;
    while is_digit(bytes, at) {
        at += 1;
    }
    at
}

/// Returns the offset after digits with a decimal point.
fn past_mantissa(bytes: &[u8]) -> usize {
    let end = past_digits(bytes, 0);
    // A point before an operator belongs to the operator: "1./x", "2.^n", "1...".
    let is_operator = bytes
        .get(end + 1)
        .is_some_and(|byte| b"*/\\^'.".contains(byte));
    if bytes.get(end) == Some(&b'.') && !is_operator {
        past_digits(bytes, end + 1)
    } else {
        end
    }
}

/// Returns the offset after the exponent that begins at `from`, or `from` if there is none.
fn past_exponent(bytes: &[u8], from: usize) -> usize {
    if !matches!(bytes.get(from), Some(b'e' | b'E' | b'd' | b'D')) {
        return from;
    }
    let has_sign = matches!(bytes.get(from + 1), Some(b'+' | b'-'));
    let digits = from + 1 + usize::from(has_sign);
    if is_digit(bytes, digits) {
        past_digits(bytes, digits)
    } else {
        from
    }
}
