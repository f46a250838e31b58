//! PlotStyle ahead in statements.

use super::lexer::Lexer;
use super::token::{Token, TokenKind};
use crate::variables::VariableFault;

/// Tokens that are looked at before it is known what they are for.
pub(super) struct Ahead<'t> {
    pub(super) lexer: Lexer<'t>,
    pub(super) token: Token<'t>,
}

impl Ahead<'_> {
    /// Goes on to a sign outside all brackets, or to the end of the statement.
    pub(super) fn pass_to_outside(&mut self, sign: &str) -> Result<(), VariableFault> {
        loop {
            let outside = self.lexer.innermost().is_none();
            let ended = self.token.kind == TokenKind::End || (outside && self.token.ends_statement());
            // No assignment to a part goes on in the next line.
            if ended || self.token.kind == TokenKind::NewLine || (outside && self.token.is(sign)) {
                return Ok(());
            }
            self.token = self.lexer.next()?;
        }
    }
}
