//! GNU Octave's `save -binary`: behind "Octave-1-L" or "Octave-1-B" each value with the lengths of its name and of its parts.

use std::path::Path;

use super::{Element, Filled, Form, Parts, Sides, Stored, value};
use crate::file_error::FileError;
use crate::importer::{Contents, Importer};
use crate::strides::{NumberClass, StoredNumber};
use crate::variables::{ReadingBudget, TextArray, Value, Variable, VariableFault};

/// Files of `save -binary`.
pub(crate) struct OctaveBinary;

/// What they begin with, before the letter of the byte order.
const MAGIC: &[u8] = b"Octave-1-";
/// The byte order and the format of floats behind it.
const HEADER: usize = MAGIC.len() + 2;
/// What stands before the name of a type.
const NAMED_TYPE: u8 = 0xff;

impl Importer for OctaveBinary {
    fn name(&self) -> &'static str {
        "a file of GNU Octave, as it writes with -binary"
    }

    fn endings(&self) -> &'static [&'static str] {
        &["bin", "mat"]
    }

    fn recognises(&self, bytes: &[u8], _: &str) -> bool {
        bytes.starts_with(MAGIC)
    }

    fn read(&self, bytes: &[u8], path: &Path, budget: &ReadingBudget<'_>) -> Result<Contents, FileError> {
        let big_endian = bytes.get(MAGIC.len()) == Some(&b'B');
        let mut bytes = Bytes { bytes, at: HEADER, big_endian, budget };
        Contents::variables(variables(&mut bytes), path)
    }
}

fn variables(bytes: &mut Bytes<'_>) -> Result<Vec<Variable>, VariableFault> {
    let mut variables = Vec::new();
    while bytes.at < bytes.bytes.len() {
        bytes.budget.take(1, size_of::<Variable>() as u64, "")?;
        let (name, kind) = bytes.member("")?;
        match value(bytes, &kind, &name, 0) {
            // It does not say how long it is: what stands behind it is not found.
            Err(VariableFault::Unsupported { what, remedy, .. }) => {
                let why = format!("neither it nor what stands behind it can be read; {remedy}");
                variables.push(Variable { name, value: Value::Opaque { class: what, why } });
                break;
            }
            value => variables.push(Variable { name, value: value? }),
        }
    }
    Ok(variables)
}

/// A file while it is read.
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
            .ok_or_else(|| VariableFault::CutOff { variable: variable.to_owned(), offset: self.bytes.len() as u64 })?;
        self.at = end;
        Ok(found)
    }

    fn int(&mut self, variable: &str) -> Result<i32, VariableFault> {
        let bytes = self.next(4, variable)?.try_into().unwrap_or_default();
        Ok(if self.big_endian { i32::from_be_bytes(bytes) } else { i32::from_le_bytes(bytes) })
    }

    fn length(&mut self, variable: &str) -> Result<usize, VariableFault> {
        let length = self.int(variable)?;
        usize::try_from(length).map_err(|_| self.wrong(variable, "a length is below zero"))
    }

    fn string(&mut self, variable: &str) -> Result<String, VariableFault> {
        let length = self.length(variable)?;
        Ok(String::from_utf8_lossy(self.next(length, variable)?).into_owned())
    }

    /// How numbers are stored: floats may be stored as whole numbers, or as shorter ones, where nothing is lost.
    fn stored(&mut self, element: Element, variable: &str) -> Result<StoredNumber, VariableFault> {
        use NumberClass::{Float, Logical, Signed, Unsigned};
        let (class, size) = match element.stored {
            Stored::Logical => (Logical, 1),
            Stored::Integer { signed, size } => (if signed { Signed } else { Unsigned }, size),
            Stored::Float => match self.next(1, variable)?[0] {
                0 => (Unsigned, 1),
                1 => (Unsigned, 2),
                2 => (Unsigned, 4),
                3 => (Signed, 1),
                4 => (Signed, 2),
                5 => (Signed, 4),
                6 => (Float, 4),
                7 => (Float, 8),
                8 => (Unsigned, 8),
                9 => (Signed, 8),
                _ => return Err(self.wrong(variable, "numbers are of an unknown kind")),
            },
        };
        StoredNumber::new(class, size, self.big_endian)
            .ok_or_else(|| self.wrong(variable, "numbers are of an unknown kind"))
    }
}

impl Parts for Bytes<'_> {
    fn budget(&self) -> &ReadingBudget<'_> {
        self.budget
    }

    fn member(&mut self, variable: &str) -> Result<(String, String), VariableFault> {
        let (name, _doc) = (self.string(variable)?, self.string(variable)?);
        // Whether the value is global.
        self.next(1, variable)?;
        if self.next(1, variable)? != [NAMED_TYPE] {
            return Err(self.wrong(&name, "the type of the value has no name"));
        }
        Ok((name, self.string(variable)?))
    }

    fn sides(&mut self, variable: &str) -> Result<Sides, VariableFault> {
        let count = self.int(variable)?;
        // Two sides without their number stand before some matrices.
        let shape = match usize::try_from(count) {
            Ok(rows) => vec![rows, self.length(variable)?],
            Err(_) => {
                let count = count.unsigned_abs() as usize;
                self.budget.take(count as u64, 8, variable)?;
                (0..count).map(|_| self.length(variable)).collect::<Result<_, _>>()?
            }
        };
        match shape.len() {
            0 | 1 => Err(self.wrong(variable, "an array has fewer than two dimensions")),
            _ => Ok(Sides { shape, by_rows: false }),
        }
    }

    fn numbers(&mut self, element: Element, count: usize, variable: &str) -> Result<Vec<f64>, VariableFault> {
        let stored = self.stored(element, variable)?;
        let count = if element.complex { count.saturating_mul(2) } else { count };
        let bytes = self.next(count.saturating_mul(stored.size()), variable)?;
        Ok(bytes.chunks(stored.size()).map(|number| stored.decode(number)).collect())
    }

    fn sparse(&mut self, element: Element, variable: &str) -> Result<Filled, VariableFault> {
        let shape = self.sides(variable)?.shape;
        let (rows, columns) = (shape[0], shape[1]);
        let count = self.length(variable)?;
        let starts = (0..=columns).map(|_| self.length(variable)).collect::<Result<Vec<_>, _>>()?;
        let indices = (0..count).map(|_| self.length(variable)).collect::<Result<Vec<_>, _>>()?;
        if starts.last() != Some(&count) {
            return Err(self.wrong(variable, "the sparse matrix contradicts itself"));
        }
        let mut places = Vec::new();
        for (column, bounds) in starts.windows(2).enumerate() {
            let rows_of = indices.get(bounds[0]..bounds[1]);
            for &row in rows_of.ok_or_else(|| self.wrong(variable, "the sparse matrix contradicts itself"))? {
                if row >= rows {
                    return Err(self.wrong(variable, "a number lies outside the matrix"));
                }
                places.push(column.saturating_mul(rows).saturating_add(row));
            }
        }
        Ok(Filled { shape, places, numbers: self.numbers(element, count, variable)? })
    }

    fn text(&mut self, variable: &str) -> Result<TextArray, VariableFault> {
        let shape = self.sides(variable)?.shape;
        let &[rows, columns] = shape.as_slice() else {
            let what = "an array of texts of more than two dimensions".to_owned();
            let remedy = "save it as a cell array".to_owned();
            return Err(VariableFault::Unsupported { variable: variable.to_owned(), what, remedy });
        };
        let letters = self.next(rows.saturating_mul(columns), variable)?;
        if letters.is_empty() {
            return Ok(TextArray { shape: vec![1, 1], texts: vec![String::new()] });
        }
        self.budget.take(rows as u64, size_of::<String>() as u64, variable)?;
        let row = |row: usize| letters.iter().skip(row).step_by(rows).copied().collect::<Vec<u8>>();
        let texts = (0..rows).map(|of| String::from_utf8_lossy(&row(of)).into_owned()).collect();
        Ok(TextArray { shape: vec![rows, 1], texts })
    }

    fn members(&mut self, _: Form, variable: &str) -> Result<usize, VariableFault> {
        self.length(variable)
    }

    fn class(&mut self, variable: &str) -> Result<String, VariableFault> {
        self.string(variable)
    }

    fn wrong(&self, variable: &str, what: &str) -> VariableFault {
        VariableFault::Damaged { variable: variable.to_owned(), what: what.to_owned(), offset: self.at as u64 }
    }
}
