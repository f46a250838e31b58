//! Open brackets in a MATLAB or Octave statement that is skipped: they decide where the statement
//! ends, and whether a quotation mark begins a string.

use crate::formats::text::matlab_value_position::{MOST_NESTED, Position};
use crate::reading_budget::{NO_VARIABLE, VariableFault};
use crate::variable_fault::line_fault::LineFault;

/// Open brackets in a statement that is skipped, the outermost first.
#[derive(Default)]
pub(super) struct OpenBrackets(Vec<OpenBracket>);

struct OpenBracket {
    bracket: char,
    place: Position,
}

impl OpenBrackets {
    pub(super) fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    pub(super) fn is_in_matrix(&self) -> bool {
        matches!(
            self.0.last(),
            Some(OpenBracket {
                bracket: '[' | '{',
                ..
            })
        )
    }

    pub(super) fn open(&mut self, bracket: char, place: Position) -> Result<(), VariableFault> {
        if self.0.len() >= MOST_NESTED {
            return Err(VariableFault::too_deep(NO_VARIABLE));
        }
        self.0.push(OpenBracket { bracket, place });
        Ok(())
    }

    /// Closes the innermost open bracket that matches, with all brackets inside it; ignores
    /// `closing` if none matches.
    pub(super) fn close(&mut self, closing: char) {
        let opening = match closing {
            ')' => '(',
            ']' => '[',
            _ => '{',
        };
        if let Some(at) = self.0.iter().rposition(|open| open.bracket == opening) {
            self.0.truncate(at);
        }
    }

    /// Closes the round brackets inside the innermost square or curly bracket, because round
    /// brackets end with their line.
    pub(super) fn end_line(&mut self) {
        while self.0.last().is_some_and(|open| open.bracket == '(') {
            self.0.pop();
        }
    }

    /// Returns an error if a square or curly bracket is still open. Unclosed round brackets are
    /// tolerated.
    pub(super) fn check_closed(self) -> Result<(), VariableFault> {
        let unclosed = self.0.into_iter().rfind(|open| open.bracket != '(');
        let Some(OpenBracket { bracket, place }) = unclosed else {
            return Ok(());
        };
        Err(VariableFault::line(
            NO_VARIABLE,
            place.line,
            LineFault::OpenBracket {
                bracket,
                column: place.column,
            },
        ))
    }
}
