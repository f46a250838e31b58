//! GNU Octave's `save -binary` format: a header, followed by the values.
//!
//! ```text
//! header   "Octave-1-L" (little endian) or "Octave-1-B" (big endian), float format (1 byte)
//! value    name, documentation, 1 if global (1 byte), FF, type name, then parts that depend on the
//!          type
//! string   length [bytes] (32 bits), characters; also for each name
//! matrix   minus the number of dimensions (32 bits), dimensions, numbers; or the numbers of rows
//!          and columns, numbers
//! floats   a byte with the storage type, then the numbers
//! ```
//!
//! `assembly.rs` calls the methods of [`Parts`], each of which reads one part.

use crate::formats::octave::assembly::{
    Parts, Sides, ValueHeading, byte_rows, read_value, texts_in_pages,
};
use crate::formats::octave::form::{Element, Form, NumberParts, StorageType};
use crate::formats::sparse_matrix::{CompressedColumns, SparseEntries};
use crate::formats::stored_number::{NumberClass, StoredNumber};
use crate::formats::variables::{TextArray, Value, Variable};
use crate::formats::{Contents, Importer};
use crate::reading_budget::{ReadingBudget, VariableFault};
use crate::variable_fault::octave_fault::OctaveFault;
use crate::variable_fault::unread::Unread;

/// Signature, followed by the byte order letter.
const MAGIC: &[u8] = b"Octave-1-";
/// Length of signature, byte order and float format \[bytes\].
const HEADER: usize = MAGIC.len() + 2;
/// Byte that announces a type name, instead of a type number as in old versions.
const NAMED_TYPE: u8 = 0xff;

/// Importer for files written by `save -binary`.
pub(crate) const OCTAVE_BINARY: Importer = Importer {
    name: "a GNU Octave file, written with -binary",
    endings: &["bin", "mat"],
    recognises: |bytes, _| bytes.starts_with(MAGIC),
    read: |bytes, path, budget| Contents::variables(read_variables(bytes, budget), path),
};

/// Reads the variables up to the first with an unknown type, which becomes opaque
/// ([`Value::Opaque`]) and ends the reading.
fn read_variables(
    bytes: &[u8],
    budget: &ReadingBudget<'_>,
) -> Result<Vec<Variable>, VariableFault> {
    let mut reader = BinaryReader {
        bytes,
        at: HEADER,
        big_endian: bytes.get(MAGIC.len()) == Some(&b'B'),
        budget,
    };
    let mut variables = Vec::new();
    while reader.at < bytes.len() {
        budget.take(1, size_of::<Variable>() as u64, "")?;
        let ValueHeading { name, type_name } = reader.read_heading("")?;
        match read_value(&mut reader, &type_name, &name) {
            Ok(value) => variables.push(Variable { name, value }),
            Err(VariableFault::Unsupported { content, .. }) => {
                // The value's length is unknown, so later values cannot be found.
                let value = Value::opaque(content.to_string(), Unread::UnsupportedEnd(content));
                variables.push(Variable { name, value });
                break;
            }
            Err(fault) => return Err(fault),
        }
    }
    Ok(variables)
}

/// State while a file is read.
struct BinaryReader<'b> {
    bytes: &'b [u8],
    /// Offset of the next byte.
    at: usize,
    big_endian: bool,
    budget: &'b ReadingBudget<'b>,
}

impl<'b> BinaryReader<'b> {
    fn take(&mut self, count: usize, variable: &str) -> Result<&'b [u8], VariableFault> {
        let end = self.at.saturating_add(count);
        let Some(found) = self.bytes.get(self.at..end) else {
            return Err(VariableFault::cut_off(variable, self.bytes.len()));
        };
        self.at = end;
        Ok(found)
    }

    /// Reads the next signed 32-bit integer.
    fn read_int(&mut self, variable: &str) -> Result<i32, VariableFault> {
        let bytes = self.take(4, variable)?.try_into().unwrap_or_default();
        Ok(if self.big_endian {
            i32::from_be_bytes(bytes)
        } else {
            i32::from_le_bytes(bytes)
        })
    }

    /// Reads a length or an index, which must not be negative.
    fn read_length(&mut self, variable: &str) -> Result<usize, VariableFault> {
        let length = self.read_int(variable)?;
        usize::try_from(length).map_err(|_| self.fault(variable, OctaveFault::NegativeLength))
    }

    fn read_lengths(&mut self, count: usize, variable: &str) -> Result<Vec<usize>, VariableFault> {
        let mut lengths = Vec::new();
        for _ in 0..count {
            lengths.push(self.read_length(variable)?);
        }
        Ok(lengths)
    }

    /// Reads a string, which is preceded by its length.
    fn read_string(&mut self, variable: &str) -> Result<String, VariableFault> {
        let length = self.read_length(variable)?;
        Ok(String::from_utf8_lossy(self.take(length, variable)?).into_owned())
    }

    /// Returns the number type as stored. For floats, which may be stored as integers or as shorter
    /// floats if nothing is lost, reads the byte that gives the type.
    fn read_number_type(
        &mut self,
        element: Element,
        variable: &str,
    ) -> Result<StoredNumber, VariableFault> {
        let storage = match element.storage {
            Some(storage) => Some(storage),
            None => float_storage(self.take(1, variable)?[0]),
        };
        storage
            .and_then(|storage| StoredNumber::new(storage.class, storage.size, self.big_endian))
            .ok_or_else(|| self.fault(variable, OctaveFault::NumberType))
    }
}

/// Returns the storage type of floats for the code byte that precedes them; `None` for an unknown
/// code.
fn float_storage(code: u8) -> Option<StorageType> {
    let (class, size) = match code {
        0 => (NumberClass::Unsigned, 1),
        1 => (NumberClass::Unsigned, 2),
        2 => (NumberClass::Unsigned, 4),
        3 => (NumberClass::Signed, 1),
        4 => (NumberClass::Signed, 2),
        5 => (NumberClass::Signed, 4),
        6 => (NumberClass::Float, 4),
        7 => (NumberClass::Float, 8),
        8 => (NumberClass::Unsigned, 8),
        9 => (NumberClass::Signed, 8),
        _ => return None,
    };
    Some(StorageType { class, size })
}

impl Parts for BinaryReader<'_> {
    fn budget(&self) -> &ReadingBudget<'_> {
        self.budget
    }

    fn read_heading(&mut self, variable: &str) -> Result<ValueHeading, VariableFault> {
        let name = self.read_string(variable)?;
        let _documentation = self.read_string(variable)?;
        let _is_global = self.take(1, variable)?;
        if self.take(1, variable)? != [NAMED_TYPE] {
            return Err(self.fault(&name, OctaveFault::UnnamedType));
        }
        Ok(ValueHeading {
            name,
            type_name: self.read_string(variable)?,
        })
    }

    fn read_sides(&mut self, variable: &str) -> Result<Sides, VariableFault> {
        // The dimension count precedes the dimensions, with a minus sign. Without the sign, `first`
        // is a matrix's row count.
        let first = self.read_int(variable)?;
        let shape = match usize::try_from(first) {
            Ok(rows) => vec![rows, self.read_length(variable)?],
            Err(_) => {
                let count = first.unsigned_abs() as usize;
                self.budget.take(count as u64, 8, variable)?;
                self.read_lengths(count, variable)?
            }
        };
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
        let number_type = self.read_number_type(element, variable)?;
        let count = if element.is_complex {
            count.saturating_mul(2)
        } else {
            count
        };
        let bytes = self.take(count.saturating_mul(number_type.size()), variable)?;
        Ok(number_type.decode_all(bytes))
    }

    fn read_sparse(
        &mut self,
        element: Element,
        variable: &str,
    ) -> Result<SparseEntries, VariableFault> {
        let shape = self.read_sides(variable)?.shape;
        let count = self.read_length(variable)?;
        let starts = self.read_lengths(shape[1].saturating_add(1), variable)?;
        let rows = self.read_lengths(count, variable)?;
        let NumberParts { re, im } = element.parts(self.read_numbers(element, count, variable)?);
        self.budget.take(count as u64, 8, variable)?;
        let columns = CompressedColumns {
            shape: [shape[0], shape[1]],
            kind: element.kind(),
            rows,
            starts,
            re,
            im,
        };
        columns
            .into_entries()
            .ok_or_else(|| self.fault(variable, OctaveFault::SparseMatrix))
    }

    fn read_text(&mut self, variable: &str) -> Result<TextArray, VariableFault> {
        let shape = self.read_sides(variable)?.shape;
        let &[height, columns] = shape.as_slice() else {
            return Err(texts_in_pages(variable));
        };
        let letters = self.take(height.saturating_mul(columns), variable)?;
        let texts = if letters.is_empty() { 0 } else { height as u64 };
        self.budget
            .take(texts, size_of::<String>() as u64, variable)?;
        Ok(byte_rows(letters, height))
    }

    fn read_field_count(&mut self, _: Form, variable: &str) -> Result<usize, VariableFault> {
        self.read_length(variable)
    }

    fn read_class(&mut self, variable: &str) -> Result<String, VariableFault> {
        self.read_string(variable)
    }

    fn fault(&self, variable: &str, fault: OctaveFault) -> VariableFault {
        VariableFault::damaged(variable, fault, self.at as u64)
    }
}
