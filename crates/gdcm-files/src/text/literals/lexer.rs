//! Cuts MATLAB statements into tokens.

use super::token::{Place, Token, TokenKind};
use crate::variables::VariableFault;

/// Brackets within brackets that are followed; nobody writes more, and each takes room on the stack of the program.
const MOST_NESTED: usize = 64;
/// Signs of the language, the longer first.
const SIGNS: [&str; 36] = [
    ".*", "./", ".\\", ".^", ".'", "==", "~=", "!=", "<=", ">=", "&&", "||", "+=", "-=", "*=", "/=", "^=", "+", "-",
    "*", "/", "\\", "^", "(", ")", "[", "]", "{", "}", ",", ";", ":", "=", ".", "@", "~",
];

/// A text and how far it is cut into tokens.
#[derive(Clone)]
pub(super) struct Lexer<'t> {
    text: &'t str,
    at: usize,
    line: usize,
    line_start: usize,
    /// Brackets that are open, the innermost last.
    open: Vec<(char, Place)>,
    /// Whether the last token ends an operand: a quote behind it transposes.
    operand: bool,
}

impl<'t> Lexer<'t> {
    pub(super) fn new(text: &'t str) -> Self {
        Self { text, at: 0, line: 1, line_start: 0, open: Vec::new(), operand: false }
    }

    /// The innermost bracket that is open.
    pub(super) fn innermost(&self) -> Option<(char, Place)> {
        self.open.last().copied()
    }

    /// Forgets round brackets that a line leaves open: none reaches beyond its line.
    pub(super) fn close_round(&mut self) {
        while matches!(self.open.last(), Some(('(', _))) {
            self.open.pop();
        }
    }

    /// Number of a token's column, from 1: characters, or bytes in a line longer than anybody counts in.
    pub(super) fn column(&self, place: Place) -> usize {
        let before = self.text.get(place.line_start..place.start).unwrap_or_default();
        1 + if before.len() > 2000 { before.len() } else { before.chars().count() }
    }

    /// The text from a place on, for a message.
    pub(super) fn excerpt(&self, place: Place) -> String {
        crate::text::separator::excerpt(self.text.get(place.start..).unwrap_or_default())
    }

    /// The next token; the end of the text comes again and again.
    pub(super) fn next(&mut self) -> Result<Token<'t>, VariableFault> {
        let spaced = self.pass_blanks()?;
        let place = self.place();
        let in_matrix = matches!(self.open.last(), Some(('[' | '{', _)));
        let kind = match self.peek() {
            None => TokenKind::End,
            Some('\n' | '\r') => self.new_line(),
            Some('\'') if self.operand && !(spaced && in_matrix) => self.sign("'"),
            Some(quote @ ('\'' | '"')) => self.quoted(quote),
            Some(c) if c.is_ascii_digit() || (c == '.' && self.second().is_some_and(|c| c.is_ascii_digit())) => {
                self.number()
            }
            Some(c) if c.is_alphabetic() || c == '_' => self.name(),
            Some(c) => match SIGNS.into_iter().find(|sign| self.rest().starts_with(sign)) {
                Some(sign) => self.bracket_or_sign(sign, place)?,
                None => {
                    self.at += c.len_utf8();
                    TokenKind::Bad(format!("the character {c:?} has no meaning here"))
                }
            },
        };
        let ends = |sign: &str| matches!(sign, ")" | "]" | "}" | "'" | ".'");
        self.operand = match kind {
            TokenKind::Number { .. } | TokenKind::Name(_) | TokenKind::Text { .. } => true,
            TokenKind::Sign(sign) => ends(sign),
            _ => false,
        };
        let space_behind = self.peek().is_none_or(char::is_whitespace) || self.rest().starts_with("...");
        Ok(Token { kind, place, spaced, space_behind })
    }

    fn rest(&self) -> &'t str {
        &self.text[self.at..]
    }

    fn peek(&self) -> Option<char> {
        self.rest().chars().next()
    }

    fn second(&self) -> Option<char> {
        self.rest().chars().nth(1)
    }

    fn place(&self) -> Place {
        Place { line: self.line, line_start: self.line_start, start: self.at }
    }

    fn new_line(&mut self) -> TokenKind<'t> {
        self.at += if self.rest().starts_with("\r\n") { 2 } else { 1 };
        self.line += 1;
        self.line_start = self.at;
        TokenKind::NewLine
    }

    fn pass_line(&mut self) {
        self.at += self.rest().find(['\n', '\r']).unwrap_or(self.rest().len());
    }

    /// Passes over blanks, comments and line ends that are continued; says whether there were any.
    fn pass_blanks(&mut self) -> Result<bool, VariableFault> {
        let from = self.at;
        while let Some(character) = self.peek() {
            match character {
                '\n' | '\r' => break,
                _ if character.is_whitespace() || character == '\u{feff}' => self.at += character.len_utf8(),
                '%' | '#' if self.opens_block() => self.pass_block()?,
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

    /// Whether a comment of several lines begins: "%{" alone on its line.
    fn opens_block(&self) -> bool {
        self.text[self.line_start..self.at].trim().is_empty() && self.mark_on_line('{')
    }

    /// Whether the rest of the line is a mark of comment and this bracket.
    fn mark_on_line(&self, bracket: char) -> bool {
        let end = self.rest().find(['\n', '\r']).unwrap_or(self.rest().len());
        let mut characters = self.rest()[..end].trim().chars();
        matches!(characters.next(), Some('%' | '#'))
            && characters.next() == Some(bracket)
            && characters.next().is_none()
    }

    fn pass_block(&mut self) -> Result<(), VariableFault> {
        let (line, mut depth) = (self.line, 0_usize);
        loop {
            if self.mark_on_line('{') {
                depth += 1;
            } else if self.mark_on_line('}') {
                depth -= 1;
            }
            self.pass_line();
            if depth == 0 {
                return Ok(());
            }
            if self.peek().is_none() {
                let what = "the comment opened here is never closed; write %} on a line of its own".to_owned();
                return Err(VariableFault::Line { variable: String::new(), line, what });
            }
            self.new_line();
        }
    }

    fn sign(&mut self, sign: &'static str) -> TokenKind<'t> {
        self.at += sign.len();
        TokenKind::Sign(sign)
    }

    fn bracket_or_sign(&mut self, sign: &'static str, place: Place) -> Result<TokenKind<'t>, VariableFault> {
        let kind = self.sign(sign);
        let (opening, closing) = match sign {
            "(" | "[" | "{" => (sign.chars().next(), None),
            ")" => (None, Some('(')),
            "]" => (None, Some('[')),
            "}" => (None, Some('{')),
            _ => (None, None),
        };
        if let Some(bracket) = opening {
            if self.open.len() >= MOST_NESTED {
                return Err(VariableFault::TooDeep { variable: String::new() });
            }
            self.open.push((bracket, place));
        }
        if let Some(wanted) = closing {
            let found = self.open.iter().rposition(|(bracket, _)| *bracket == wanted);
            let matches = found.is_some_and(|index| index + 1 == self.open.len());
            self.open.truncate(found.unwrap_or(self.open.len()));
            if !matches {
                return Ok(TokenKind::Bad(format!("\"{sign}\" closes no bracket; open it or take it out")));
            }
        }
        Ok(kind)
    }

    fn name(&mut self) -> TokenKind<'t> {
        let rest = self.rest();
        let end = rest.find(|c: char| !(c.is_alphanumeric() || c == '_')).unwrap_or(rest.len());
        self.at += end;
        TokenKind::Name(&rest[..end])
    }

    /// A text up to its closing quote on the same line; a doubled quote is a character.
    fn quoted(&mut self, quote: char) -> TokenKind<'t> {
        self.at += 1;
        let mut text = String::new();
        loop {
            let rest = self.rest();
            let Some(end) = rest.find([quote, '\n', '\r']).filter(|&end| rest[end..].starts_with(quote)) else {
                self.pass_line();
                return TokenKind::Bad(format!("a text begins here and has no end; write {quote} behind it"));
            };
            text.push_str(&rest[..end]);
            self.at += end + 1;
            if self.peek() != Some(quote) {
                return TokenKind::Text { text, double: quote == '"' };
            }
            text.push(quote);
            self.at += 1;
        }
    }

    fn number(&mut self) -> TokenKind<'t> {
        let rest = self.rest();
        let bytes = rest.as_bytes();
        let digits = |mut at: usize| {
            while bytes.get(at).is_some_and(u8::is_ascii_digit) {
                at += 1;
            }
            at
        };
        let mut end = digits(0);
        // A point before an operator belongs to it: "1./x", "2.^n", "1...".
        let operator = |at: usize| bytes.get(at).is_some_and(|byte| b"*/\\^'.".contains(byte));
        if bytes.get(end) == Some(&b'.') && !operator(end + 1) {
            end = digits(end + 1);
        }
        if bytes.get(end).is_some_and(|byte| b"eEdD".contains(byte)) {
            let signed = end + 1 + usize::from(bytes.get(end + 1).is_some_and(|byte| b"+-".contains(byte)));
            if digits(signed) > signed {
                end = digits(signed);
            }
        }
        let value = rest[..end].replace(['d', 'D'], "e").parse();
        let imaginary = matches!(bytes.get(end), Some(b'i' | b'j'));
        end += usize::from(imaginary);
        let tail = rest[end..].find(|c: char| !(c.is_alphanumeric() || c == '_')).unwrap_or(rest.len() - end);
        self.at += end + tail;
        match value {
            Ok(value) if tail == 0 => TokenKind::Number { value, imaginary },
            _ => TokenKind::Bad(format!("\"{}\" is no number", crate::text::separator::excerpt(&rest[..end + tail]))),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn kinds(text: &str) -> Vec<TokenKind<'_>> {
        let mut lexer = Lexer::new(text);
        let mut kinds = Vec::new();
        loop {
            match lexer.next().unwrap().kind {
                TokenKind::End => return kinds,
                kind => kinds.push(kind),
            }
        }
    }

    fn number(value: f64) -> TokenKind<'static> {
        TokenKind::Number { value, imaginary: false }
    }

    #[test]
    fn a_point_belongs_to_the_number_or_to_the_operator() {
        assert_eq!(kinds("1.e3"), [number(1000.0)]);
        assert_eq!(kinds("1./2"), [number(1.0), TokenKind::Sign("./"), number(2.0)]);
        assert_eq!(kinds(".5D-1"), [number(0.05)]);
        assert_eq!(kinds("1..."), [number(1.0)]);
        assert_eq!(kinds("2j"), [TokenKind::Number { value: 2.0, imaginary: true }]);
        assert!(matches!(kinds("3x")[0], TokenKind::Bad(_)));
    }

    #[test]
    fn a_quote_transposes_behind_an_operand_and_begins_a_text_elsewhere() {
        let text = |text: &str| TokenKind::Text { text: text.to_owned(), double: false };
        assert_eq!(kinds("a'"), [TokenKind::Name("a"), TokenKind::Sign("'")]);
        assert_eq!(kinds("a '"), [TokenKind::Name("a"), TokenKind::Sign("'")]);
        assert_eq!(kinds("{a 'b'}")[2], text("b"));
        assert_eq!(kinds("'it''s'"), [text("it's")]);
        assert!(matches!(kinds("= 'open\n1")[1], TokenKind::Bad(_)));
    }

    #[test]
    fn comments_and_continued_lines_are_blanks() {
        assert_eq!(kinds("1 % one\n2 # two"), [number(1.0), TokenKind::NewLine, number(2.0)]);
        assert_eq!(kinds("1 ... more\n 2"), [number(1.0), number(2.0)]);
        assert_eq!(kinds("%{\nx\n%{\ny\n%}\n%}\n3"), [TokenKind::NewLine, number(3.0)]);
        assert_eq!(kinds("%{ not a block\n3"), [TokenKind::NewLine, number(3.0)]);
        assert!(Lexer::new("\n%{\nx").next().is_ok());
    }

    #[test]
    fn brackets_are_counted() {
        assert!(matches!(kinds("[1)")[2], TokenKind::Bad(_)));
        let mut lexer = Lexer::new(Box::leak("[".repeat(100).into_boxed_str()));
        let deep = (0..100).find_map(|_| lexer.next().err());
        assert!(matches!(deep, Some(VariableFault::TooDeep { .. })));
    }
}
