//! A matrix between brackets, row by row.

use super::block::{above, beside};
use super::scope::cost;
use super::trouble::Trouble;
use crate::variables::{Array, ElementKind, MemoryBudget, Value};

/// The elements of a row: single numbers as long as there is nothing else, as most matrices have many.
enum Row {
    Numbers { re: Vec<f64>, im: Vec<f64>, complex: bool },
    Parts { values: Vec<Value>, strings: bool },
}

/// The rows between brackets as far as they are read.
pub(super) struct Brackets<'m> {
    meter: &'m MemoryBudget<'m>,
    rows: Vec<Row>,
    row: Row,
}

impl Row {
    fn new() -> Self {
        Row::Numbers { re: Vec::new(), im: Vec::new(), complex: false }
    }

    fn is_empty(&self) -> bool {
        match self {
            Row::Numbers { re, .. } => re.is_empty(),
            Row::Parts { values, .. } => values.is_empty(),
        }
    }

    fn into_value(self) -> Result<(Value, bool), Trouble> {
        match self {
            Row::Numbers { re, im, complex } => {
                let (shape, im) = (vec![1, re.len()], complex.then_some(im));
                Ok((Value::Array(Array { shape, kind: ElementKind::Float, re, im }), false))
            }
            Row::Parts { values, strings } => Ok((beside(values, strings)?, strings)),
        }
    }
}

impl<'m> Brackets<'m> {
    pub(super) fn new(meter: &'m MemoryBudget<'m>) -> Self {
        Self { meter, rows: Vec::new(), row: Row::new() }
    }

    /// Adds an element; `string` says that it is a text in double quotes.
    pub(super) fn push(&mut self, value: Value, string: bool) -> Result<(), Trouble> {
        // A number takes twice its size while the vectors grow, and again when the rows are put together.
        self.meter.take(1, 64, "")?;
        if let (Row::Numbers { re, im, complex }, Value::Array(array)) = (&mut self.row, &value)
            && array.re.len() == 1
        {
            re.push(array.re[0]);
            let imaginary = array.im.as_ref().map_or(0.0, |im| im[0]);
            im.push(imaginary);
            *complex |= array.im.is_some();
            return Ok(());
        }
        self.meter.take(2 * cost(&value, 0)?, 1, "")?;
        if let Row::Numbers { re, .. } = &self.row {
            let values = if re.is_empty() {
                Vec::new()
            } else {
                vec![std::mem::replace(&mut self.row, Row::new()).into_value()?.0]
            };
            self.row = Row::Parts { values, strings: false };
        }
        if let Row::Parts { values, strings } = &mut self.row {
            values.push(value);
            *strings |= string;
        }
        Ok(())
    }

    /// Ends a row; an empty one is none.
    pub(super) fn end_row(&mut self) -> Result<(), Trouble> {
        if !self.row.is_empty() {
            self.meter.take(1, 256, "")?;
            self.rows.push(std::mem::replace(&mut self.row, Row::new()));
        }
        Ok(())
    }

    /// The matrix.
    pub(super) fn finish(mut self) -> Result<Value, Trouble> {
        self.end_row()?;
        if self.rows.is_empty() {
            return Ok(Value::Array(Array::matrix(0, 0, Vec::new())));
        }
        if let Some(matrix) = self.plain()? {
            return Ok(matrix);
        }
        let (mut values, mut strings) = (Vec::with_capacity(self.rows.len()), false);
        for row in self.rows {
            let (value, string) = row.into_value()?;
            self.meter.take(cost(&value, 0)?, 3, "")?;
            values.push(value);
            strings |= string;
        }
        above(values, strings)
    }

    /// The matrix if there are only single numbers in it.
    fn plain(&self) -> Result<Option<Value>, Trouble> {
        let mut rows = Vec::with_capacity(self.rows.len());
        for row in &self.rows {
            match row {
                Row::Numbers { re, im, complex } => rows.push((re, im, *complex)),
                Row::Parts { .. } => return Ok(None),
            }
        }
        let columns = rows.first().map_or(0, |(re, ..)| re.len());
        if let Some(index) = rows.iter().position(|(re, ..)| re.len() != columns) {
            let (found, row) = (rows[index].0.len(), index + 1);
            let what = format!("row {row} has {found} columns, the first {columns}; complete the shorter");
            return Err(Trouble::new(what));
        }
        let by_columns = |part: &dyn Fn(usize, usize) -> f64| -> Vec<f64> {
            (0..columns).flat_map(|column| (0..rows.len()).map(move |row| part(row, column))).collect()
        };
        let re = by_columns(&|row, column| rows[row].0[column]);
        let complex = rows.iter().any(|(.., complex)| *complex);
        let im = complex.then(|| by_columns(&|row, column| rows[row].1[column]));
        Ok(Some(Value::Array(Array { shape: vec![rows.len(), columns], kind: ElementKind::Float, re, im })))
    }
}
