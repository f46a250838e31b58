//! GNU Octave's `save -text` format: lines with keys, followed by numbers.
//!
//! ```text
//! # name: A
//! # type: matrix
//! # rows: 2
//! # columns: 3
//!  1 2 3
//!  4 5 6
//! ```
//!
//! Matrices are written row by row; arrays with more than two dimensions have a line such as `#
//! ndims: 3`, a line with the dimensions, and their numbers in column-major order.

use gdcm_model::message_text::shortened;

use crate::file_error::FileError;
use crate::formats::octave::assembly::{Parts, Sides, ValueHeading, read_value, texts_in_pages};
use crate::formats::octave::form::{Element, Form, NumberParts};
use crate::formats::sparse_matrix::SparseEntries;
use crate::formats::text::encoding::decode;
use crate::formats::variables::{TextArray, Value, Variable};
use crate::formats::{Contents, Importer};
use crate::reading_budget::{ReadingBudget, VariableFault};
use crate::variable_fault::octave_fault::OctaveFault;
use crate::variable_fault::unread::Unread;

/// Number of bytes at the beginning of a file in which the first variable must appear.
const HEAD: usize = 2000;

/// Memory for an entry of a sparse matrix, row, column and number \[bytes\]; the factor 2: vectors
/// grow by doubling.
const ENTRY_MEMORY: u64 = 2 * 3 * 8;

/// Importer for files written by `save -text`.
pub(crate) const OCTAVE_TEXT: Importer = Importer {
    name: "a GNU Octave file, written with -text",
    endings: &["txt", "mat", "dat"],
    recognises: |bytes, _| begins_with_variable(bytes),
    read: |bytes, path, budget| {
        let text = decode(bytes, budget).map_err(|fault| FileError::variables(path, fault))?;
        Contents::variables(read_variables(&text, budget), path)
    },
};

/// Returns whether a file begins with a variable's name and type, after comments and empty lines
/// only.
fn begins_with_variable(bytes: &[u8]) -> bool {
    let head = String::from_utf8_lossy(&bytes[..bytes.len().min(HEAD)]);
    for line in head.lines() {
        if line.starts_with("# name: ") {
            break;
        }
        if !line.is_empty() && !line.starts_with('#') {
            return false;
        }
    }
    let mut lines = head.lines().map(str::trim_end);
    lines.any(|line| line.starts_with("# name: "))
        && lines
            .next()
            .is_some_and(|line| line.starts_with("# type: "))
}

fn read_variables(text: &str, budget: &ReadingBudget<'_>) -> Result<Vec<Variable>, VariableFault> {
    let mut reader = TextReader {
        text,
        at: 0,
        budget,
    };
    let mut variables = Vec::new();
    while reader.find_name() {
        budget.take(1, size_of::<Variable>() as u64, "")?;
        let ValueHeading { name, type_name } = reader.read_heading("")?;
        let value = match read_value(&mut reader, &type_name, &name) {
            Ok(value) => value,
            // Reading continues at the next line with a name, usually that of the next variable.
            Err(VariableFault::Unsupported { content, .. }) => {
                Value::opaque(content.to_string(), Unread::Unsupported(content))
            }
            Err(fault) => return Err(fault),
        };
        variables.push(Variable { name, value });
    }
    Ok(variables)
}

/// A text with the place up to which it has been read.
struct TextReader<'t> {
    text: &'t str,
    /// Offset of the next byte.
    at: usize,
    budget: &'t ReadingBudget<'t>,
}

impl<'t> TextReader<'t> {
    /// Returns the text from the current position on.
    fn rest(&self) -> &'t str {
        &self.text[self.at..]
    }

    /// Returns the next line without its line ending.
    fn read_line(&mut self) -> Option<&'t str> {
        let rest = self.rest();
        if rest.is_empty() {
            return None;
        }
        let end = rest.find('\n').unwrap_or(rest.len());
        self.at += (end + 1).min(rest.len());
        Some(rest[..end].trim_end_matches('\r'))
    }

    /// Moves to the next line that begins a value with its name; returns false if there is none.
    fn find_name(&mut self) -> bool {
        loop {
            let begin = self.at;
            match self.read_line() {
                None => return false,
                Some(line) if line.starts_with("# name: ") => {
                    self.at = begin;
                    return true;
                }
                Some(_) => {}
            }
        }
    }

    /// Returns the text after `# key: ` on the next nonempty line.
    fn read_key(&mut self, key: &str, variable: &str) -> Result<&'t str, VariableFault> {
        let line = loop {
            match self.read_line() {
                None => return Err(self.cut_off(variable)),
                Some(line) if line.trim().is_empty() => {}
                Some(line) => break line,
            }
        };
        match text_after_key(line, key) {
            Some(text) => Ok(text.trim()),
            None => Err(self.fault(
                variable,
                OctaveFault::MissingKey {
                    key: key.to_owned(),
                },
            )),
        }
    }

    /// Returns the non-negative integer after `# key: ` on the next nonempty line.
    fn read_key_number(&mut self, key: &str, variable: &str) -> Result<usize, VariableFault> {
        let text = self.read_key(key, variable)?;
        text.parse().map_err(|_| {
            self.fault(
                variable,
                OctaveFault::KeyNotWhole {
                    key: key.to_owned(),
                    found: shortened(text),
                },
            )
        })
    }

    /// Returns whether the next nonempty line begins with `# key`.
    fn has_key(&self, key: &str) -> bool {
        match self.rest().trim_start().strip_prefix("# ") {
            Some(rest) => rest.starts_with(key),
            None => false,
        }
    }

    /// Returns the next word, which may be on a later line.
    fn read_word(&mut self, variable: &str) -> Result<&'t str, VariableFault> {
        let rest = self.rest();
        let Some(begin) = rest.find(|letter: char| !letter.is_whitespace()) else {
            return Err(self.cut_off(variable));
        };
        let rest = &rest[begin..];
        let length = rest.find(char::is_whitespace).unwrap_or(rest.len());
        self.at += begin + length;
        Ok(&rest[..length])
    }

    /// Reads the next word as a non-negative integer.
    fn read_index(&mut self, variable: &str) -> Result<usize, VariableFault> {
        let word = self.read_word(variable)?;
        word.parse().map_err(|_| {
            let found = shortened(word);
            self.fault(variable, OctaveFault::NotWhole { found })
        })
    }

    fn parse_number(&self, word: &str, variable: &str) -> Result<f64, VariableFault> {
        // Octave writes NA for a missing number.
        if word == "NA" {
            return Ok(f64::NAN);
        }
        word.parse().map_err(|_| {
            let found = shortened(word);
            self.fault(variable, OctaveFault::NotANumber { found })
        })
    }

    /// Returns the next `length` bytes, which may contain line breaks. If no line ends after them,
    /// because the text was saved in another encoding, returns the rest of the line instead.
    fn read_text_with_length(
        &mut self,
        length: usize,
        variable: &str,
    ) -> Result<&'t str, VariableFault> {
        if let Some((text, after)) = self.rest().split_at_checked(length)
            && (after.is_empty() || after.starts_with(['\n', '\r']))
        {
            self.at += length;
            self.read_line();
            return Ok(text);
        }
        self.read_line().ok_or_else(|| self.cut_off(variable))
    }

    fn cut_off(&self, variable: &str) -> VariableFault {
        VariableFault::cut_off(variable, self.text.len())
    }
}

/// Returns the text after `# key:`; `None` if the line has another key.
fn text_after_key<'t>(line: &'t str, key: &str) -> Option<&'t str> {
    line.strip_prefix("# ")?
        .strip_prefix(key)?
        .strip_prefix(':')
}

/// Splits a complex number `(re,im)` into its two parts.
fn complex_parts(word: &str) -> Option<(&str, &str)> {
    word.strip_prefix('(')?.strip_suffix(')')?.split_once(',')
}

impl Parts for TextReader<'_> {
    fn budget(&self) -> &ReadingBudget<'_> {
        self.budget
    }

    fn read_heading(&mut self, variable: &str) -> Result<ValueHeading, VariableFault> {
        Ok(ValueHeading {
            name: self.read_key("name", variable)?.to_owned(),
            type_name: self.read_key("type", variable)?.to_owned(),
        })
    }

    fn read_sides(&mut self, variable: &str) -> Result<Sides, VariableFault> {
        if self.has_key("rows") {
            let rows = self.read_key_number("rows", variable)?;
            let columns = self.read_key_number("columns", variable)?;
            return Ok(Sides {
                shape: vec![rows, columns],
                by_rows: true,
            });
        }
        let count = self.read_key_number("ndims", variable)?;
        self.budget.take(count as u64, 8, variable)?;
        let mut shape = Vec::new();
        for _ in 0..count {
            shape.push(self.read_index(variable)?);
        }
        if shape.len() < 2 {
            return Err(self.fault(variable, OctaveFault::Dimensions { found: shape.len() }));
        }
        Ok(Sides {
            shape,
            by_rows: false,
        })
    }

    fn read_numbers(
        &mut self,
        element: Element,
        count: usize,
        variable: &str,
    ) -> Result<Vec<f64>, VariableFault> {
        // Skip the line before the three numbers in a range.
        if self.has_key("base, limit") {
            self.read_line();
        }
        let mut numbers = Vec::new();
        for _ in 0..count {
            let word = self.read_word(variable)?;
            if element.is_complex {
                let Some((re, im)) = complex_parts(word) else {
                    let found = shortened(word);
                    return Err(self.fault(variable, OctaveFault::NotComplex { found }));
                };
                numbers.extend([
                    self.parse_number(re, variable)?,
                    self.parse_number(im, variable)?,
                ]);
            } else {
                numbers.push(self.parse_number(word, variable)?);
            }
        }
        Ok(numbers)
    }

    fn read_sparse(
        &mut self,
        element: Element,
        variable: &str,
    ) -> Result<SparseEntries, VariableFault> {
        let count = self.read_key_number("nnz", variable)?;
        let height = self.read_key_number("rows", variable)?;
        let width = self.read_key_number("columns", variable)?;
        let mut rows = Vec::new();
        let mut columns = Vec::new();
        let mut numbers = Vec::new();
        for _ in 0..count {
            // Indices count from 1 in Octave; the invalid index 0 wraps to a large number and is
            // rejected below.
            let row = self.read_index(variable)?.wrapping_sub(1);
            let column = self.read_index(variable)?.wrapping_sub(1);
            if row >= height || column >= width {
                return Err(self.fault(variable, OctaveFault::ElementOutsideMatrix));
            }
            self.budget.take(1, ENTRY_MEMORY, variable)?;
            rows.push(row);
            columns.push(column);
            numbers.extend(self.read_numbers(element, 1, variable)?);
        }
        let NumberParts { re, im } = element.parts(numbers);
        Ok(SparseEntries {
            shape: [height, width],
            kind: element.kind(),
            rows,
            columns,
            re,
            im,
        })
    }

    fn read_text(&mut self, variable: &str) -> Result<TextArray, VariableFault> {
        if !self.has_key("elements") {
            return Err(texts_in_pages(variable));
        }
        let count = self.read_key_number("elements", variable)?;
        if count == 0 {
            if self.has_key("length") {
                self.read_line();
            }
            return Ok(TextArray::one(""));
        }
        let mut texts = Vec::new();
        for _ in 0..count {
            let length = self.read_key_number("length", variable)?;
            texts.push(self.read_text_with_length(length, variable)?.to_owned());
        }
        Ok(TextArray {
            shape: vec![texts.len(), 1],
            texts,
        })
    }

    fn read_field_count(&mut self, form: Form, variable: &str) -> Result<usize, VariableFault> {
        if form == Form::ScalarStruct {
            self.read_sides(variable)?;
        }
        self.read_key_number("length", variable)
    }

    fn read_class(&mut self, variable: &str) -> Result<String, VariableFault> {
        Ok(self.read_key("classname", variable)?.to_owned())
    }

    fn fault(&self, variable: &str, fault: OctaveFault) -> VariableFault {
        // The fault is on the line that contains the byte before the current position.
        let read = &self.text.as_bytes()[..self.at.saturating_sub(1).min(self.text.len())];
        let line = 1 + read.iter().filter(|byte| **byte == b'\n').count();
        VariableFault::line(variable, line, fault)
    }
}
