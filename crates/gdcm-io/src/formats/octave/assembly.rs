//! Assembles values from their parts, which the text and binary encodings store in the same order.
//!
//! A value's *parts* are, for example, its dimensions and its numbers. They follow its name and its
//! type; the type determines the value's storage form (`form.rs`), and thereby which parts there
//! are.

use crate::formats::octave::form::{Element, Form, NumberParts};

use crate::formats::element_order::{Places, element_count};
use crate::formats::octave::range::Range;
use crate::formats::sparse_matrix::SparseEntries;
use crate::formats::variables::{Array, CellArray, Object, StructArray, TextArray, Value};
use crate::reading_budget::{ReadingBudget, VariableFault};
use crate::variable_fault::octave_fault::OctaveFault;
use crate::variable_fault::unsupported_content::UnsupportedContent;

/// Maximum nesting depth of values.
const DEEPEST: usize = 64;

/// Length along each dimension, and whether numbers are in row-major order.
pub(super) struct Sides {
    pub(super) shape: Vec<usize>,
    pub(super) by_rows: bool,
}

/// Name and type, which precede a value.
pub(super) struct ValueHeading {
    pub(super) name: String,
    pub(super) type_name: String,
}

/// Reads the consecutive value parts in one of the encodings, text or binary. Each method reads the
/// part at the current position and moves past it; `variable` is the value's name in errors.
pub(super) trait Parts {
    fn budget(&self) -> &ReadingBudget<'_>;
    fn read_heading(&mut self, variable: &str) -> Result<ValueHeading, VariableFault>;
    /// Reads array dimensions; there are at least two.
    fn read_sides(&mut self, variable: &str) -> Result<Sides, VariableFault>;
    /// Reads `count` elements; each complex element yields two numbers.
    fn read_numbers(
        &mut self,
        element: Element,
        count: usize,
        variable: &str,
    ) -> Result<Vec<f64>, VariableFault>;
    /// Reads a sparse matrix's dimensions and nonzero elements.
    fn read_sparse(
        &mut self,
        element: Element,
        variable: &str,
    ) -> Result<SparseEntries, VariableFault>;
    /// Reads a character array's dimensions and rows.
    fn read_text(&mut self, variable: &str) -> Result<TextArray, VariableFault>;
    /// Reads how many fields a struct or an object has.
    fn read_field_count(&mut self, form: Form, variable: &str) -> Result<usize, VariableFault>;
    fn read_class(&mut self, variable: &str) -> Result<String, VariableFault>;
    /// Returns the error `fault` at the current position in the file.
    fn fault(&self, variable: &str, fault: OctaveFault) -> VariableFault;
}

/// Reads a variable's value, after its name and type.
pub(super) fn read_value(
    parts: &mut dyn Parts,
    type_name: &str,
    variable: &str,
) -> Result<Value, VariableFault> {
    Assembler { parts }.read_value(type_name, variable, 0)
}

/// Assembles values; `depth` in the methods is a value's nesting depth.
struct Assembler<'p> {
    parts: &'p mut dyn Parts,
}

impl Assembler<'_> {
    /// Reads a value's parts in the order that its form requires.
    fn read_value(
        &mut self,
        type_name: &str,
        variable: &str,
        depth: usize,
    ) -> Result<Value, VariableFault> {
        if depth >= DEEPEST {
            return Err(VariableFault::too_deep(variable));
        }
        let size = size_of::<Value>() as u64;
        self.parts.budget().take(1, size, variable)?;
        let local_type = type_name.strip_prefix("global ").unwrap_or(type_name);
        let Some(form) = Form::from_type_name(local_type) else {
            return Err(VariableFault::unsupported(
                variable,
                UnsupportedContent::OctaveType {
                    type_name: type_name.to_owned(),
                },
            ));
        };
        Ok(match form {
            Form::Scalar(element) => {
                let numbers = self.parts.read_numbers(element, 1, variable)?;
                Value::Array(element.array(vec![1, 1], numbers))
            }
            Form::Matrix(element) => Value::Array(self.read_matrix(element, variable)?),
            Form::Diagonal(element) => Value::Array(self.read_diagonal(element, variable)?),
            Form::Sparse(element) => {
                let entries = self.parts.read_sparse(element, variable)?;
                Value::Array(self.full_matrix(&entries, variable)?)
            }
            Form::Range => Value::Array(self.read_range(variable)?),
            Form::Text => Value::Text(self.parts.read_text(variable)?),
            Form::Cell => Value::Cell(self.read_cell(variable, depth)?),
            Form::ScalarStruct => {
                Value::Struct(self.read_records(form, vec![1, 1], variable, depth)?)
            }
            Form::StructArray => {
                let shape = self.parts.read_sides(variable)?.shape;
                Value::Struct(self.read_records(form, shape, variable, depth)?)
            }
            Form::Class => {
                let class = self.parts.read_class(variable)?;
                let records = self.read_records(form, vec![1, 1], variable, depth)?;
                Value::Object(Object { class, records })
            }
        })
    }

    /// Returns the element count after taking `size` bytes for each from the budget.
    ///
    /// # Errors
    /// [`VariableFault`] if the count overflows, or the budget is exhausted.
    fn take_elements(
        &self,
        shape: &[usize],
        size: u64,
        variable: &str,
    ) -> Result<usize, VariableFault> {
        let Some(count) = element_count(shape) else {
            return Err(self.parts.fault(variable, OctaveFault::ElementCount));
        };
        self.parts.budget().take(count as u64, size, variable)?;
        Ok(count)
    }

    fn read_matrix(&mut self, element: Element, variable: &str) -> Result<Array, VariableFault> {
        let Sides { shape, by_rows } = self.parts.read_sides(variable)?;
        // Number of numbers per element: a complex element has a real and an imaginary part.
        let width = if element.is_complex { 2 } else { 1 };
        let count = self.take_elements(&shape, 16 * width as u64, variable)?;
        let mut numbers = self.parts.read_numbers(element, count, variable)?;
        if by_rows && let Some(places) = Places::row_major(&shape) {
            numbers = places
                .flat_map(|place| &numbers[place * width..(place + 1) * width])
                .copied()
                .collect();
        }
        Ok(element.array(shape, numbers))
    }

    fn read_diagonal(&mut self, element: Element, variable: &str) -> Result<Array, VariableFault> {
        let shape = self.parts.read_sides(variable)?.shape;
        let rows = shape[0];
        let columns = shape[1];
        let length = rows.min(columns);
        let numbers = self.parts.read_numbers(element, length, variable)?;
        let NumberParts { re, im } = element.parts(numbers);
        let entries = SparseEntries {
            shape: [rows, columns],
            kind: element.kind(),
            rows: (0..length).collect(),
            columns: (0..length).collect(),
            re,
            im,
        };
        self.full_matrix(&entries, variable)
    }

    fn full_matrix(&self, entries: &SparseEntries, variable: &str) -> Result<Array, VariableFault> {
        entries.full_matrix(variable, self.parts.budget(), || {
            self.parts
                .fault(variable, OctaveFault::ElementOutsideMatrix)
        })
    }

    fn read_range(&mut self, variable: &str) -> Result<Array, VariableFault> {
        let numbers = self.parts.read_numbers(Element::FLOAT, 3, variable)?;
        let &[first, limit, step] = numbers.as_slice() else {
            return Err(self.parts.fault(variable, OctaveFault::RangeNumbers));
        };
        let range = Range { first, limit, step };
        range.array(variable, self.parts.budget())
    }

    fn read_cell(&mut self, variable: &str, depth: usize) -> Result<CellArray, VariableFault> {
        let shape = self.parts.read_sides(variable)?.shape;
        let count = self.take_elements(&shape, size_of::<Value>() as u64, variable)?;
        let mut values = Vec::new();
        for index in 1..=count {
            let inner = format!("{variable}{{{index}}}");
            let ValueHeading { type_name, .. } = self.parts.read_heading(&inner)?;
            values.push(self.read_value(&type_name, &inner, depth + 1)?);
        }
        Ok(CellArray { shape, values })
    }

    /// Reads a struct's or an object's records. In a struct array or an object, each field is a
    /// cell array with a value for each record.
    fn read_records(
        &mut self,
        form: Form,
        shape: Vec<usize>,
        variable: &str,
        depth: usize,
    ) -> Result<StructArray, VariableFault> {
        let count = self.take_elements(&shape, size_of::<Value>() as u64, variable)?;
        let mut fields = Vec::new();
        for _ in 0..self.parts.read_field_count(form, variable)? {
            let ValueHeading { name, type_name } = self.parts.read_heading(variable)?;
            let inner = format!("{variable}.{name}");
            let values = match (form, self.read_value(&type_name, &inner, depth + 1)?) {
                (Form::StructArray | Form::Class, Value::Cell(cell)) => cell.values,
                (_, value) => vec![value],
            };
            if values.len() != count {
                return Err(self.parts.fault(&inner, OctaveFault::FieldLength));
            }
            fields.push((name, values));
        }
        Ok(StructArray { shape, fields })
    }
}

/// Splits a byte array in column-major order into a string for each row; without bytes, returns a
/// single empty string.
pub(super) fn byte_rows(letters: &[u8], height: usize) -> TextArray {
    if letters.is_empty() {
        return TextArray::one("");
    }
    let mut texts = Vec::new();
    for row in 0..height {
        // Letters in a row are `height` apart.
        let letters: Vec<u8> = letters.iter().skip(row).step_by(height).copied().collect();
        texts.push(String::from_utf8_lossy(&letters).into_owned());
    }
    TextArray {
        shape: vec![height, 1],
        texts,
    }
}

/// Returns the error for a character array with more than two dimensions, which is not supported.
pub(super) fn texts_in_pages(variable: &str) -> VariableFault {
    VariableFault::unsupported(variable, UnsupportedContent::OctavePages)
}
