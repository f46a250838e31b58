//! The words and signs of MATLAB statements.

/// Where a token stands.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Place {
    /// Number of the line, from 1.
    pub(super) line: usize,
    /// Where the line begins \[bytes\].
    pub(super) line_start: usize,
    /// Where the token begins \[bytes\].
    pub(super) start: usize,
}

/// What a token is.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum TokenKind<'t> {
    /// A number without a sign; an imaginary one ends in i or j.
    Number {
        /// The number.
        value: f64,
        /// Whether it is imaginary.
        imaginary: bool,
    },
    /// A name or a word of the language.
    Name(&'t str),
    /// A text between quotes.
    Text {
        /// The text.
        text: String,
        /// Whether the quotes are double ones.
        double: bool,
    },
    /// An operator, a bracket or a separator.
    Sign(&'static str),
    /// The end of a line.
    NewLine,
    /// What is no part of the language, and why.
    Bad(String),
    /// The end of the text.
    End,
}

/// A token, where it stands and whether blanks are around it: they separate the elements of a matrix.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Token<'t> {
    pub(super) kind: TokenKind<'t>,
    pub(super) place: Place,
    /// Whether a blank stands before it.
    pub(super) spaced: bool,
    /// Whether a blank stands behind it.
    pub(super) space_behind: bool,
}

impl Token<'_> {
    /// Whether this is a certain sign.
    pub(super) fn is(&self, sign: &str) -> bool {
        matches!(self.kind, TokenKind::Sign(found) if found == sign)
    }

    /// Whether a statement ends here, outside brackets.
    pub(super) fn ends_statement(&self) -> bool {
        matches!(self.kind, TokenKind::NewLine | TokenKind::End | TokenKind::Sign(";" | ","))
    }

    /// The token in a message.
    pub(super) fn words(&self) -> String {
        match &self.kind {
            TokenKind::Number { value, .. } => format!("the number {value}"),
            TokenKind::Name(name) => format!("\"{}\"", crate::text::separator::excerpt(name)),
            TokenKind::Text { .. } => "a text".to_owned(),
            TokenKind::Sign(sign) => format!("\"{sign}\""),
            TokenKind::NewLine => "the end of the line".to_owned(),
            TokenKind::End => "the end of the text".to_owned(),
            TokenKind::Bad(why) => why.clone(),
        }
    }
}
