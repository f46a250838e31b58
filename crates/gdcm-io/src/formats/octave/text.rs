//! GNU Octave's `save -text`: lines `# name: A`, `# type: matrix`, `# rows: 8`, and numbers.

use super::{Element, Form, Parts, Sides, texts_in_pages, value};
use crate::file_error::FileError;
use crate::formats::strides::Entries;
use crate::formats::text::encoding::decode;
use crate::formats::variables::{TextArray, Value, Variable};
use crate::formats::{Contents, Importer};
use crate::reading_budget::{ReadingBudget, VariableFault};

/// Largest offset of the first variable in a file \[bytes\].
const HEAD: usize = 2000;

/// Files written by `save -text`.
pub(crate) const OCTAVE_TEXT: Importer = Importer {
    name: "a file of GNU Octave, as it writes with -text",
    endings: &["txt", "mat", "dat"],
    recognises: |bytes, _| {
        let head = String::from_utf8_lossy(&bytes[..bytes.len().min(HEAD)]);
        let mut lines = head
            .lines()
            .map(str::trim_end)
            .skip_while(|line| !line.starts_with("# name: "));
        let before = head
            .lines()
            .take_while(|line| !line.starts_with("# name: "));
        lines
            .nth(1)
            .is_some_and(|line| line.starts_with("# type: "))
            && before
                .into_iter()
                .all(|line| line.is_empty() || line.starts_with('#'))
    },
    read: |bytes, path, budget| {
        let wrong = |fault| FileError::variables(path, fault);
        let text = decode(bytes, budget).map_err(wrong)?;
        Contents::variables(variables(&text, budget), path)
    },
};

/// Reads the variables of a text.
fn variables(text: &str, budget: &ReadingBudget<'_>) -> Result<Vec<Variable>, VariableFault> {
    let mut lines = Lines {
        text,
        at: 0,
        budget,
    };
    let mut variables = Vec::new();
    while lines.find_name() {
        budget.take(1, size_of::<Variable>() as u64, "")?;
        let (name, kind) = lines.member("")?;
        let value = match value(&mut lines, &kind, &name, 0) {
            // The other values remain readable: only a value begins with a name at the start of a
            // line.
            Err(VariableFault::Unsupported { what, remedy, .. }) => Value::opaque(what, remedy),
            value => value?,
        };
        variables.push(Variable { name, value });
    }
    Ok(variables)
}

/// A text during reading.
struct Lines<'t> {
    text: &'t str,
    at: usize,
    budget: &'t ReadingBudget<'t>,
}

impl<'t> Lines<'t> {
    fn rest(&self) -> &'t str {
        &self.text[self.at..]
    }

    /// Returns the next line, with any line ending.
    fn line(&mut self) -> Option<&'t str> {
        let rest = self.rest();
        if rest.is_empty() {
            return None;
        }
        let end = rest.find('\n').unwrap_or(rest.len());
        self.at += (end + 1).min(rest.len());
        Some(rest[..end].trim_end_matches('\r'))
    }

    /// Moves to the next line that names a value.
    fn find_name(&mut self) -> bool {
        loop {
            let begin = self.at;
            match self.line() {
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
    fn key(&mut self, key: &str, variable: &str) -> Result<&'t str, VariableFault> {
        let line = loop {
            match self.line() {
                None => return Err(self.cut_off(variable)),
                Some(line) if line.trim().is_empty() => {}
                Some(line) => break line,
            }
        };
        let said = line
            .strip_prefix("# ")
            .and_then(|line| line.strip_prefix(key)?.strip_prefix(':'));
        said.map(str::trim)
            .ok_or_else(|| self.wrong(variable, &format!("expected \"# {key}: …\"")))
    }

    fn whole(&mut self, key: &str, variable: &str) -> Result<usize, VariableFault> {
        let said = self.key(key, variable)?;
        said.parse()
            .map_err(|_| self.wrong(variable, &format!("{key}: expected a whole number")))
    }

    fn has_key(&self, key: &str) -> bool {
        self.rest()
            .trim_start()
            .strip_prefix("# ")
            .is_some_and(|rest| rest.starts_with(key))
    }

    /// Returns the next word, on this line or a later line.
    fn word(&mut self, variable: &str) -> Result<&'t str, VariableFault> {
        let rest = self.rest();
        let begin = rest
            .find(|letter: char| !letter.is_whitespace())
            .ok_or_else(|| self.cut_off(variable))?;
        let rest = &rest[begin..];
        let length = rest.find(char::is_whitespace).unwrap_or(rest.len());
        self.at += begin + length;
        Ok(&rest[..length])
    }

    fn index(&mut self, variable: &str) -> Result<usize, VariableFault> {
        let word = self.word(variable)?;
        word.parse()
            .map_err(|_| self.wrong(variable, "expected a whole number"))
    }

    fn number(&self, word: &str, variable: &str) -> Result<f64, VariableFault> {
        match word {
            // Octave's "not available".
            "NA" => Ok(f64::NAN),
            _ => word
                .parse()
                .map_err(|_| self.wrong(variable, "expected a number")),
        }
    }

    fn cut_off(&self, variable: &str) -> VariableFault {
        VariableFault::cut_off(variable, self.text.len())
    }
}

impl Parts for Lines<'_> {
    fn budget(&self) -> &ReadingBudget<'_> {
        self.budget
    }

    fn member(&mut self, variable: &str) -> Result<(String, String), VariableFault> {
        let name = self.key("name", variable)?;
        Ok((name.to_owned(), self.key("type", variable)?.to_owned()))
    }

    fn sides(&mut self, variable: &str) -> Result<Sides, VariableFault> {
        if self.has_key("rows") {
            let shape = vec![
                self.whole("rows", variable)?,
                self.whole("columns", variable)?,
            ];
            return Ok(Sides {
                shape,
                by_rows: true,
            });
        }
        let count = self.whole("ndims", variable)?;
        self.budget.take(count as u64, 8, variable)?;
        let shape = (0..count)
            .map(|_| self.index(variable))
            .collect::<Result<Vec<_>, _>>()?;
        match shape.len() {
            0 | 1 => Err(self.wrong(variable, "expected two dimensions or more")),
            _ => Ok(Sides {
                shape,
                by_rows: false,
            }),
        }
    }

    fn numbers(
        &mut self,
        element: Element,
        count: usize,
        variable: &str,
    ) -> Result<Vec<f64>, VariableFault> {
        if self.has_key("base, limit") {
            self.line();
        }
        let mut numbers = Vec::new();
        for _ in 0..count {
            let word = self.word(variable)?;
            if element.complex {
                let parts = word
                    .strip_prefix('(')
                    .and_then(|word| word.strip_suffix(')')?.split_once(','));
                let (re, im) = parts
                    .ok_or_else(|| self.wrong(variable, "expected a complex number, (re,im)"))?;
                numbers.extend([self.number(re, variable)?, self.number(im, variable)?]);
            } else {
                numbers.push(self.number(word, variable)?);
            }
        }
        Ok(numbers)
    }

    fn sparse(&mut self, element: Element, variable: &str) -> Result<Entries, VariableFault> {
        let count = self.whole("nnz", variable)?;
        let shape = [
            self.whole("rows", variable)?,
            self.whole("columns", variable)?,
        ];
        let mut rows = Vec::new();
        let mut columns = Vec::new();
        let mut numbers = Vec::new();
        for _ in 0..count {
            let row = self.index(variable)?;
            let column = self.index(variable)?;
            let row = row.wrapping_sub(1);
            let column = column.wrapping_sub(1);
            if row >= shape[0] || column >= shape[1] {
                return Err(self.wrong(variable, "a number lies outside the matrix"));
            }
            // Vectors grow by doubling.
            self.budget.take(1, 48, variable)?;
            rows.push(row);
            columns.push(column);
            numbers.extend(self.numbers(element, 1, variable)?);
        }
        let (re, im) = element.parts(numbers);
        Ok(Entries {
            shape,
            kind: element.kind(),
            rows,
            columns,
            re,
            im,
        })
    }

    fn text(&mut self, variable: &str) -> Result<TextArray, VariableFault> {
        if !self.has_key("elements") {
            return Err(texts_in_pages(variable));
        }
        let count = self.whole("elements", variable)?;
        if count == 0 {
            if self.has_key("length") {
                self.line();
            }
            return Ok(TextArray::one(""));
        }
        let mut texts = Vec::new();
        for _ in 0..count {
            let length = self.whole("length", variable)?;
            // The length counts bytes, and a text may contain line breaks; a file in another
            // encoding has other lengths.
            let bytes = self.rest().get(..length).filter(|_| {
                self.rest()[length..].starts_with(['\n', '\r'])
                    || self.at + length == self.text.len()
            });
            match bytes {
                Some(text) => {
                    self.at += length;
                    self.line();
                    texts.push(text.to_owned());
                }
                None => texts.push(
                    self.line()
                        .ok_or_else(|| self.cut_off(variable))?
                        .to_owned(),
                ),
            }
        }
        Ok(TextArray {
            shape: vec![texts.len(), 1],
            texts,
        })
    }

    fn members(&mut self, form: Form, variable: &str) -> Result<usize, VariableFault> {
        if form == Form::Struct {
            self.sides(variable)?;
        }
        self.whole("length", variable)
    }

    fn class(&mut self, variable: &str) -> Result<String, VariableFault> {
        Ok(self.key("classname", variable)?.to_owned())
    }

    fn wrong(&self, variable: &str, what: &str) -> VariableFault {
        let read = &self.text.as_bytes()[..self.at.saturating_sub(1).min(self.text.len())];
        let line = 1 + read.iter().filter(|byte| **byte == b'\n').count();
        VariableFault::line(variable, line, what)
    }
}
