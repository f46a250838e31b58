//! Statements one after another.

use super::ahead::Ahead;
use super::expression::Parser;
use super::token::{Place, TokenKind};
use super::trouble::Trouble;
use crate::text::separator::refuse_binary;
use crate::variables::{MemoryBudget, Value, Variable, VariableFault};

/// Words that begin statements which are not run.
const PASSED_OVER: [&str; 32] = [
    "function",
    "clear",
    "clearvars",
    "clc",
    "close",
    "format",
    "return",
    "addpath",
    "rmpath",
    "figure",
    "hold",
    "grid",
    "warning",
    "more",
    "pkg",
    "global",
    "persistent",
    "disp",
    "fprintf",
    "printf",
    "load",
    "save",
    "plot",
    "bode",
    "title",
    "xlabel",
    "ylabel",
    "legend",
    "axis",
    "subplot",
    "else",
    "elseif",
];
/// Words that begin what may be run never, once or often.
const BLOCKS: [&str; 8] = ["if", "for", "while", "switch", "try", "parfor", "do", "unwind_protect"];
/// Words that end it.
const BLOCK_ENDS: [&str; 9] =
    ["end", "endif", "endfor", "endwhile", "endswitch", "end_try_catch", "endparfor", "until", "end_unwind_protect"];

/// What statements set.
#[derive(Clone, Debug, PartialEq)]
pub struct Literals {
    /// The variables in the order in which they were first set, with their last values. One whose value is not understood is
    /// [`Value::Opaque`] with the reason, its line and its column.
    pub variables: Vec<Variable>,
    /// Statements that were passed over, in words.
    pub notes: Vec<String>,
}

/// Reads variables from MATLAB or Octave statements.
pub fn read_literals(text: &str, meter: &MemoryBudget) -> Result<Literals, VariableFault> {
    refuse_binary(text, "MATLAB statements")?;
    let mut reading = Reading { parser: Parser::new(text, meter)?, notes: Vec::new(), blocks: 0 };
    while reading.parser.token.kind != TokenKind::End {
        meter.take(0, 1, "")?;
        reading.statement()?;
    }
    let Reading { parser, notes, .. } = reading;
    Ok(Literals { variables: parser.scope.into_variables(), notes })
}

struct Reading<'t, 'm> {
    parser: Parser<'t, 'm>,
    notes: Vec<String>,
    /// How many conditions and loops are open.
    blocks: usize,
}

/// What a statement does to the variable named at its start.
enum Change {
    /// Gives it, or one of its fields, a value.
    Whole,
    /// Changes a part of it.
    Part,
}

impl<'t> Reading<'t, '_> {
    fn statement(&mut self) -> Result<(), VariableFault> {
        if self.parser.token.ends_statement() {
            self.parser.advance()?;
            return Ok(());
        }
        let place = self.parser.token.place;
        match self.parser.token.kind {
            TokenKind::Name(word) if BLOCKS.contains(&word) => {
                self.blocks += 1;
                self.pass_over(place, "is not run, and what is set in it is not read")
            }
            TokenKind::Name(word) if BLOCK_ENDS.contains(&word) => {
                self.blocks = self.blocks.saturating_sub(1);
                self.pass_to_end()
            }
            TokenKind::Name(word) if PASSED_OVER.contains(&word) && !self.assigns()? => {
                self.pass_over(place, "is not run")
            }
            TokenKind::Name(_) => self.named_statement(place),
            TokenKind::Sign("[") => self.several(place),
            _ => self.pass_over(place, "is not understood"),
        }
    }

    /// Whether the word at hand is the name of a variable that is set.
    fn assigns(&self) -> Result<bool, VariableFault> {
        let mut ahead = self.parser.lexer.clone();
        Ok(ahead.next()?.is("="))
    }

    fn named_statement(&mut self, place: Place) -> Result<(), VariableFault> {
        let mut path: Vec<&'t str> = Vec::new();
        while let TokenKind::Name(name) = self.parser.token.kind {
            self.parser.meter.take(1, 16, name)?;
            path.push(name);
            self.parser.advance()?;
            if !self.parser.token.is(".") {
                break;
            }
            self.parser.advance()?;
        }
        let change = self.change()?;
        let path = path.as_slice();
        match change {
            None => self.pass_over(place, "is not run"),
            Some(Change::Part) => {
                let why = "only a part of it is set here; write the whole of it in one statement";
                self.opaque(&path[..1], place, why.to_owned())?;
                self.pass_to_end()
            }
            Some(Change::Whole) if self.blocks > 0 => {
                let why = "it is set within a condition or a loop, which is not run; write its value outside";
                self.opaque(path, place, why.to_owned())?;
                self.pass_to_end()
            }
            Some(Change::Whole) => self.assignment(path, place),
        }
    }

    /// Finds out what the signs behind a name do, and stops behind "=".
    fn change(&mut self) -> Result<Option<Change>, VariableFault> {
        let parser = &mut self.parser;
        if let TokenKind::Sign("+=" | "-=" | "*=" | "/=" | "^=") = parser.token.kind {
            return Ok(Some(Change::Part));
        }
        if let TokenKind::Sign(sign @ ("+" | "-")) = parser.token.kind {
            let mut ahead = parser.lexer.clone();
            let (second, third) = (ahead.next()?, ahead.next()?);
            return Ok((second.is(sign) && third.ends_statement()).then_some(Change::Part));
        }
        if parser.token.is("=") {
            parser.advance()?;
            return Ok(Some(Change::Whole));
        }
        if !(parser.token.is("(") || parser.token.is("{")) {
            return Ok(None);
        }
        // Inside the brackets and behind them, up to a sign of equality at the outside.
        let mut ahead = Ahead { lexer: parser.lexer.clone(), token: parser.token.clone() };
        ahead.pass_to_outside("=")?;
        Ok(ahead.token.is("=").then_some(Change::Part))
    }

    fn assignment(&mut self, path: &[&'t str], place: Place) -> Result<(), VariableFault> {
        match self.parser.whole_expression() {
            Ok(value) => self.parser.scope.set(path, value, self.parser.meter),
            Err(Trouble::Fault(fault)) => Err(named(fault, path)),
            Err(Trouble::Words { what, place: at }) => {
                // A text without an end may have swallowed a bracket: it, not the bracket, is what to correct.
                let swallowed = matches!(self.parser.token.kind, TokenKind::Bad(_));
                let why = self.opaque(path, at.unwrap_or(place), what)?;
                match self.pass_to_end().map_err(|fault| named(fault, path)) {
                    Err(VariableFault::Line { variable, .. }) if swallowed => {
                        Err(VariableFault::Line { variable, line: at.unwrap_or(place).line, what: why })
                    }
                    result => result,
                }
            }
        }
    }

    /// Sets a variable to what cannot be read; gives the reason with its column.
    fn opaque(&mut self, path: &[&str], place: Place, what: String) -> Result<String, VariableFault> {
        let here = format!("column {}: {what}", self.parser.lexer.column(place));
        let why = format!("line {}, {here}", place.line);
        self.parser.meter.take(why.len() as u64, 1, path.first().unwrap_or(&""))?;
        let value = Value::Opaque { class: "an expression".to_owned(), why };
        self.parser.scope.set(path, value, self.parser.meter)?;
        Ok(here)
    }

    /// "[a, b] = …": results of a function, which is not run.
    fn several(&mut self, place: Place) -> Result<(), VariableFault> {
        let mut ahead = Ahead { lexer: self.parser.lexer.clone(), token: self.parser.token.clone() };
        ahead.pass_to_outside("=")?;
        if !ahead.token.is("=") {
            return self.pass_over(place, "is not run");
        }
        while !self.parser.token.is("=") {
            let token = self.parser.advance()?;
            if let TokenKind::Name(name) = token.kind {
                let why = "it is the result of a function, which is not run; write its value";
                self.opaque(&[name], token.place, why.to_owned())?;
            }
        }
        self.pass_to_end()
    }

    fn pass_over(&mut self, place: Place, why: &str) -> Result<(), VariableFault> {
        let note = format!("line {} (\"{}\") {why}", place.line, self.parser.lexer.excerpt(place));
        self.parser.meter.take(note.len() as u64 + 32, 1, "")?;
        self.notes.push(note);
        self.pass_to_end()
    }

    /// Goes on to the end of the statement; a bracket that is never closed is a fault, as it takes all that follows with it.
    fn pass_to_end(&mut self) -> Result<(), VariableFault> {
        loop {
            if self.parser.token.kind == TokenKind::NewLine {
                self.parser.lexer.close_round();
            }
            match (&self.parser.token.kind, self.parser.lexer.innermost()) {
                (TokenKind::End, Some((bracket, place))) if bracket != '(' => {
                    let column = self.parser.lexer.column(place);
                    let what = format!("the bracket {bracket} in column {column} is never closed; close it");
                    return Err(VariableFault::Line { variable: String::new(), line: place.line, what });
                }
                (TokenKind::End, _) => return Ok(()),
                (_, None) if self.parser.token.ends_statement() => return Ok(()),
                _ => {
                    self.parser.meter.take(0, 1, "")?;
                    self.parser.advance()?;
                }
            }
        }
    }
}

/// A fault with the name of the variable that was being read.
fn named(fault: VariableFault, path: &[&str]) -> VariableFault {
    let name = || path.join(".");
    match fault {
        VariableFault::Line { variable, line, what } if variable.is_empty() => {
            VariableFault::Line { variable: name(), line, what }
        }
        VariableFault::TooLarge { most_mib, .. } => VariableFault::TooLarge { variable: name(), most_mib },
        VariableFault::TooDeep { .. } => VariableFault::TooDeep { variable: name() },
        other => other,
    }
}
