//! The value of an expression.

use super::arithmetic::{binary, range, scalar, transposed};
use super::block::text;
use super::brackets::Brackets;
use super::functions::{call, constant};
use super::lexer::Lexer;
use super::scope::{Scope, cost};
use super::token::{Token, TokenKind};
use super::trouble::Trouble;
use crate::variables::{CellArray, MemoryBudget, Value, VariableFault};

/// Reads statements token by token; the next token is always at hand.
pub(super) struct Parser<'t, 'm> {
    pub(super) lexer: Lexer<'t>,
    pub(super) token: Token<'t>,
    pub(super) scope: Scope,
    pub(super) meter: &'m MemoryBudget<'m>,
    /// Whether blanks separate elements, as between square and curly brackets.
    blanks_separate: bool,
}

impl<'t, 'm> Parser<'t, 'm> {
    pub(super) fn new(text: &'t str, meter: &'m MemoryBudget<'m>) -> Result<Self, VariableFault> {
        let mut lexer = Lexer::new(text);
        let token = lexer.next()?;
        Ok(Self { lexer, token, scope: Scope::default(), meter, blanks_separate: false })
    }

    /// Takes the token and reads the next.
    pub(super) fn advance(&mut self) -> Result<Token<'t>, VariableFault> {
        let next = self.lexer.next()?;
        Ok(std::mem::replace(&mut self.token, next))
    }

    /// The expression of a statement, up to its end.
    pub(super) fn whole_expression(&mut self) -> Result<Value, Trouble> {
        self.blanks_separate = false;
        let value = self.expression()?;
        if self.token.ends_statement() { Ok(value) } else { Err(self.unexpected()) }
    }

    fn unexpected(&self) -> Trouble {
        let found = self.token.words();
        let what = match &self.token.kind {
            TokenKind::Bad(why) => why.clone(),
            _ => format!("{found} is not understood here; write the value itself"),
        };
        Trouble::new(what).at(self.token.place)
    }

    fn expect(&mut self, sign: &str) -> Result<(), Trouble> {
        if !self.token.is(sign) {
            let found = self.token.words();
            return Err(Trouble::new(format!("\"{sign}\" is missing before {found}")).at(self.token.place));
        }
        self.advance()?;
        Ok(())
    }

    fn expression(&mut self) -> Result<Value, Trouble> {
        let place = self.token.place;
        let first = self.sum()?;
        if !self.token.is(":") {
            return Ok(first);
        }
        self.advance()?;
        let second = self.sum()?;
        let (step, last) = if self.token.is(":") {
            self.advance()?;
            (second, self.sum()?)
        } else {
            (scalar(1.0, 0.0), second)
        };
        range(&first, &step, &last, self.meter).map_err(|trouble| trouble.at(place))
    }

    /// Whether the token, a plus or minus between brackets, begins a new element: "\[1 -2\]".
    fn begins_element(&self) -> bool {
        self.blanks_separate && self.token.spaced && !self.token.space_behind
    }

    fn sign_of(&self, signs: &[&'static str]) -> Option<&'static str> {
        match self.token.kind {
            TokenKind::Sign(sign) if signs.contains(&sign) => Some(sign),
            _ => None,
        }
    }

    fn sum(&mut self) -> Result<Value, Trouble> {
        let mut value = self.product()?;
        while let Some(sign) = self.sign_of(&["+", "-"])
            && !self.begins_element()
        {
            let place = self.advance()?.place;
            let right = self.product()?;
            value = binary(value, sign, right, self.meter).map_err(|trouble| trouble.at(place))?;
        }
        Ok(value)
    }

    fn product(&mut self) -> Result<Value, Trouble> {
        let mut value = self.signed()?;
        while let Some(sign) = self.sign_of(&["*", "/", ".*", "./"]) {
            let place = self.advance()?.place;
            let right = self.signed()?;
            value = binary(value, sign, right, self.meter).map_err(|trouble| trouble.at(place))?;
        }
        Ok(value)
    }

    /// Counts the minuses before an operand.
    fn is_negative(&mut self) -> Result<bool, Trouble> {
        let mut negative = false;
        while let Some(sign) = self.sign_of(&["+", "-"]) {
            self.advance()?;
            negative ^= sign == "-";
        }
        Ok(negative)
    }

    fn negated(&mut self, value: Value) -> Result<Value, Trouble> {
        match value {
            Value::Array(mut array) => {
                array.re.iter_mut().for_each(|value| *value = -*value);
                array.im.iter_mut().flatten().for_each(|value| *value = -*value);
                Ok(Value::Array(array))
            }
            other => Err(Trouble::new(format!("{} has no negative", other.words())).at(self.token.place)),
        }
    }

    fn signed(&mut self) -> Result<Value, Trouble> {
        let negative = self.is_negative()?;
        let mut value = self.operand()?;
        // A power binds tighter than the sign before it: -2^2 is -4.
        while let Some(sign) = self.sign_of(&["^", ".^"]) {
            let place = self.advance()?.place;
            let negative = self.is_negative()?;
            let exponent = self.operand()?;
            let exponent = if negative { self.negated(exponent)? } else { exponent };
            value = binary(value, sign, exponent, self.meter).map_err(|trouble| trouble.at(place))?;
        }
        if negative { self.negated(value) } else { Ok(value) }
    }

    fn operand(&mut self) -> Result<Value, Trouble> {
        let place = self.token.place;
        let mut value = self.primary()?;
        while let Some(sign) = self.sign_of(&["'", ".'"]) {
            self.advance()?;
            self.meter.take(cost(&value, 0)?, 1, "")?;
            value = transposed(value, sign == "'").map_err(|trouble| trouble.at(place))?;
        }
        Ok(value)
    }

    fn primary(&mut self) -> Result<Value, Trouble> {
        let place = self.token.place;
        match &mut self.token.kind {
            TokenKind::Number { value, imaginary } => {
                let value = if *imaginary { scalar(0.0, *value) } else { scalar(*value, 0.0) };
                self.advance()?;
                Ok(value)
            }
            TokenKind::Text { text: words, .. } => {
                let words = std::mem::take(words);
                self.meter.take(words.len() as u64 + 128, 1, "")?;
                self.advance()?;
                Ok(text(words))
            }
            TokenKind::Name(name) => {
                let name = *name;
                self.advance()?;
                self.named(name).map_err(|trouble| trouble.at(place))
            }
            TokenKind::Sign("(") => {
                let before = std::mem::replace(&mut self.blanks_separate, false);
                self.advance()?;
                let value = self.expression()?;
                self.blanks_separate = before;
                self.expect(")")?;
                Ok(value)
            }
            TokenKind::Sign("[") => self.matrix().map_err(|trouble| trouble.at(place)),
            TokenKind::Sign("{") => self.cells(),
            TokenKind::Sign("@") => Err(Trouble::new("functions are not read; write the numbers").at(place)),
            _ => Err(self.unexpected()),
        }
    }

    /// Whether the token continues a name: between brackets a blank before it begins a new element.
    fn continues(&self, sign: &str) -> bool {
        self.token.is(sign) && !(self.blanks_separate && self.token.spaced)
    }

    /// The value of a variable, a field, a constant or a function.
    fn named(&mut self, name: &'t str) -> Result<Value, Trouble> {
        let mut path = vec![name];
        while self.continues(".") {
            self.advance()?;
            let TokenKind::Name(field) = self.token.kind else { return Err(self.unexpected()) };
            self.meter.take(1, 16, name)?;
            path.push(field);
            self.advance()?;
        }
        let known = self.scope.knows(name);
        if self.continues("{") || (self.continues("(") && (known || path.len() > 1)) {
            let what = format!("a part of {} is taken, which is not read; write its numbers", path.join("."));
            return Err(Trouble::new(what));
        }
        if self.continues("(") {
            let arguments = self.arguments()?;
            return call(name, arguments, self.meter);
        }
        match constant(name) {
            Some(value) if !known && path.len() == 1 => Ok(value),
            _ if !known && path.len() == 1 && matches!(name, "zeros" | "ones" | "eye") => {
                call(name, Vec::new(), self.meter)
            }
            _ => self.scope.copy(&path, self.meter),
        }
    }

    fn arguments(&mut self) -> Result<Vec<Value>, Trouble> {
        let before = std::mem::replace(&mut self.blanks_separate, false);
        self.advance()?;
        let mut arguments = Vec::new();
        while !self.token.is(")") {
            if !arguments.is_empty() {
                self.expect(",")?;
            }
            self.meter.take(1, 256, "")?;
            arguments.push(self.expression()?);
        }
        self.blanks_separate = before;
        self.advance()?;
        Ok(arguments)
    }

    /// Whether a text in double quotes begins here.
    fn at_string(&self) -> bool {
        matches!(self.token.kind, TokenKind::Text { double: true, .. })
    }

    fn matrix(&mut self) -> Result<Value, Trouble> {
        let before = std::mem::replace(&mut self.blanks_separate, true);
        self.advance()?;
        let mut brackets = Brackets::new(self.meter);
        while !self.token.is("]") {
            match self.token.kind {
                TokenKind::Sign(";") | TokenKind::NewLine => {
                    self.advance()?;
                    brackets.end_row()?;
                }
                TokenKind::Sign(",") => {
                    self.advance()?;
                }
                _ => {
                    let string = self.at_string();
                    let value = self.expression()?;
                    brackets.push(value, string)?;
                }
            }
        }
        self.blanks_separate = before;
        self.advance()?;
        brackets.finish()
    }

    /// Values between curly brackets.
    fn cells(&mut self) -> Result<Value, Trouble> {
        let (place, before) = (self.token.place, std::mem::replace(&mut self.blanks_separate, true));
        self.advance()?;
        let mut rows: Vec<Vec<Value>> = vec![Vec::new()];
        while !self.token.is("}") {
            match self.token.kind {
                TokenKind::Sign(";") | TokenKind::NewLine => {
                    self.advance()?;
                    if rows.last().is_some_and(|row| !row.is_empty()) {
                        self.meter.take(1, 64, "")?;
                        rows.push(Vec::new());
                    }
                }
                TokenKind::Sign(",") => {
                    self.advance()?;
                }
                _ => {
                    let value = self.expression()?;
                    self.meter.take(2 * cost(&value, 1)?, 1, "")?;
                    if let Some(row) = rows.last_mut() {
                        row.push(value);
                    }
                }
            }
        }
        self.blanks_separate = before;
        self.advance()?;
        cell_array(rows).map_err(|trouble| trouble.at(place))
    }
}

fn cell_array(mut rows: Vec<Vec<Value>>) -> Result<Value, Trouble> {
    rows.retain(|row| !row.is_empty());
    let columns = rows.first().map_or(0, Vec::len);
    if rows.iter().any(|row| row.len() != columns) {
        return Err(Trouble::new("the rows of this cell array have different lengths; complete the shorter"));
    }
    let shape = vec![rows.len(), columns];
    let mut rows: Vec<_> = rows.into_iter().map(Vec::into_iter).collect();
    let values = (0..columns).flat_map(|_| rows.iter_mut().filter_map(Iterator::next).collect::<Vec<_>>()).collect();
    Ok(Value::Cell(CellArray { shape, values }))
}
