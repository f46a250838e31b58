//! GNU Octave's `save -binary`: after "Octave-1-L" or "Octave-1-B", values with the lengths of
//! their names and parts.

use super::{Element, Form, Parts, Sides, rows, texts_in_pages, value};
use crate::formats::strides::{Entries, NumberClass, StoredNumber};
use crate::formats::variables::{TextArray, Value, Variable};
use crate::formats::{Contents, Importer};
use crate::reading_budget::{ReadingBudget, VariableFault};

/// Signature before the letter of the byte order.
const MAGIC: &[u8] = b"Octave-1-";
/// Length of the header: signature, byte order and float format \[bytes\].
const HEADER: usize = MAGIC.len() + 2;
/// Storage types of floats, by the preceding byte.
const FLOATS: [(NumberClass, usize); 10] = [
    (NumberClass::Unsigned, 1),
    (NumberClass::Unsigned, 2),
    (NumberClass::Unsigned, 4),
    (NumberClass::Signed, 1),
    (NumberClass::Signed, 2),
    (NumberClass::Signed, 4),
    (NumberClass::Float, 4),
    (NumberClass::Float, 8),
    (NumberClass::Unsigned, 8),
    (NumberClass::Signed, 8),
];
/// Marks a named type.
const NAMED_TYPE: u8 = 0xff;

/// Files written by `save -binary`.
pub(crate) const OCTAVE_BINARY: Importer = Importer {
    name: "a file of GNU Octave, as it writes with -binary",
    endings: &["bin", "mat"],
    recognises: |bytes, _| bytes.starts_with(MAGIC),
    read: |bytes, path, budget| {
        let big_endian = bytes.get(MAGIC.len()) == Some(&b'B');
        let mut bytes = Bytes {
            bytes,
            at: HEADER,
            big_endian,
            budget,
        };
        Contents::variables(variables(&mut bytes), path)
    },
};

fn variables(bytes: &mut Bytes<'_>) -> Result<Vec<Variable>, VariableFault> {
    let mut variables = Vec::new();
    while bytes.at < bytes.bytes.len() {
        bytes.budget.take(1, size_of::<Variable>() as u64, "")?;
        let (name, kind) = bytes.member("")?;
        match value(bytes, &kind, &name, 0) {
            // The value has no length, so the following values cannot be found.
            Err(VariableFault::Unsupported { what, remedy, .. }) => {
                let why = format!("neither it nor what stands behind it can be read; {remedy}");
                variables.push(Variable {
                    name,
                    value: Value::opaque(what, why),
                });
                break;
            }
            value => variables.push(Variable {
                name,
                value: value?,
            }),
        }
    }
    Ok(variables)
}

/// A file during reading.
struct Bytes<'b> {
    bytes: &'b [u8],
    at: usize,
    big_endian: bool,
    budget: &'b ReadingBudget<'b>,
}

impl<'b> Bytes<'b> {
    fn next(&mut self, count: usize, variable: &str) -> Result<&'b [u8], VariableFault> {
        let end = self.at.saturating_add(count);
        let found = self
            .bytes
            .get(self.at..end)
            .ok_or_else(|| VariableFault::cut_off(variable, self.bytes.len()))?;
        self.at = end;
        Ok(found)
    }

    fn int(&mut self, variable: &str) -> Result<i32, VariableFault> {
        let bytes = self.next(4, variable)?.try_into().unwrap_or_default();
        Ok(if self.big_endian {
            i32::from_be_bytes(bytes)
        } else {
            i32::from_le_bytes(bytes)
        })
    }

    fn length(&mut self, variable: &str) -> Result<usize, VariableFault> {
        let length = self.int(variable)?;
        usize::try_from(length).map_err(|_| self.wrong(variable, "a length is below zero"))
    }

    fn string(&mut self, variable: &str) -> Result<String, VariableFault> {
        let length = self.length(variable)?;
        Ok(String::from_utf8_lossy(self.next(length, variable)?).into_owned())
    }

    /// Returns the stored number type: floats may be stored as integers or shorter floats if
    /// nothing is lost.
    fn stored(&mut self, element: Element, variable: &str) -> Result<StoredNumber, VariableFault> {
        let unknown = |bytes: &Self| bytes.wrong(variable, "numbers are of an unknown kind");
        let stored = match element.stored {
            None => FLOATS.get(usize::from(self.next(1, variable)?[0])).copied(),
            stored => stored,
        };
        let (class, size) = stored.ok_or_else(|| unknown(self))?;
        StoredNumber::new(class, size, self.big_endian).ok_or_else(|| unknown(self))
    }
}

impl Parts for Bytes<'_> {
    fn budget(&self) -> &ReadingBudget<'_> {
        self.budget
    }

    fn member(&mut self, variable: &str) -> Result<(String, String), VariableFault> {
        let name = self.string(variable)?;
        let _doc = self.string(variable)?;
        // Flag of a global variable.
        self.next(1, variable)?;
        if self.next(1, variable)? != [NAMED_TYPE] {
            return Err(self.wrong(&name, "the type of the value has no name"));
        }
        Ok((name, self.string(variable)?))
    }

    fn sides(&mut self, variable: &str) -> Result<Sides, VariableFault> {
        let count = self.int(variable)?;
        // Some matrices store two sides without the number of dimensions.
        let shape = match usize::try_from(count) {
            Ok(rows) => vec![rows, self.length(variable)?],
            Err(_) => {
                let count = count.unsigned_abs() as usize;
                self.budget.take(count as u64, 8, variable)?;
                (0..count)
                    .map(|_| self.length(variable))
                    .collect::<Result<_, _>>()?
            }
        };
        match shape.len() {
            0 | 1 => Err(self.wrong(variable, "an array has fewer than two dimensions")),
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
        let stored = self.stored(element, variable)?;
        let count = if element.complex {
            count.saturating_mul(2)
        } else {
            count
        };
        let bytes = self.next(count.saturating_mul(stored.size()), variable)?;
        Ok(bytes
            .chunks(stored.size())
            .map(|number| stored.decode(number))
            .collect())
    }

    fn sparse(&mut self, element: Element, variable: &str) -> Result<Entries, VariableFault> {
        let shape = self.sides(variable)?.shape;
        let count = self.length(variable)?;
        let starts = (0..=shape[1])
            .map(|_| self.length(variable))
            .collect::<Result<Vec<_>, _>>()?;
        let rows = (0..count)
            .map(|_| self.length(variable))
            .collect::<Result<Vec<_>, _>>()?;
        let numbers = element.parts(self.numbers(element, count, variable)?);
        self.budget.take(count as u64, 8, variable)?;
        let stored =
            Entries::of_columns([shape[0], shape[1]], element.kind(), rows, &starts, numbers);
        stored.ok_or_else(|| self.wrong(variable, "the sparse matrix contradicts itself"))
    }

    fn text(&mut self, variable: &str) -> Result<TextArray, VariableFault> {
        let shape = self.sides(variable)?.shape;
        let &[height, columns] = shape.as_slice() else {
            return Err(texts_in_pages(variable));
        };
        let letters = self.next(height.saturating_mul(columns), variable)?;
        self.budget.take(
            if letters.is_empty() { 0 } else { height as u64 },
            size_of::<String>() as u64,
            variable,
        )?;
        Ok(rows(letters, height))
    }

    fn members(&mut self, _: Form, variable: &str) -> Result<usize, VariableFault> {
        self.length(variable)
    }

    fn class(&mut self, variable: &str) -> Result<String, VariableFault> {
        self.string(variable)
    }

    fn wrong(&self, variable: &str, what: &str) -> VariableFault {
        VariableFault::damaged(variable, what, self.at as u64)
    }
}
