//! The table columns that hold a frequency response, and its points.

use crate::formats::text::text_table::TextTable;
use crate::reading_budget::{NO_VARIABLE, VariableFault};
use crate::variable_fault::column_place::ColumnPlace;
use crate::variable_fault::line_fault::LineFault;

/// A frequency response in table columns; its frequencies are in another column, shared by all
/// responses in the table.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct RecognisedResponse {
    /// Output, if the column names give it.
    pub(crate) output: Option<String>,
    /// Input, if the column names give it.
    pub(crate) input: Option<String>,
    pub(super) parts: ResponseParts,
    pub(crate) coherence: Option<CoherenceColumn>,
}

/// A coherence column. Its numbers, multiplied by `factor` and squared if they are γ, give γ² as a
/// fraction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct CoherenceColumn {
    /// Column index, from 0.
    pub(super) column: usize,
    pub(super) factor: f64,
    pub(super) is_gamma: bool,
}

/// The two columns that give a complex number, with indices from 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum ResponseParts {
    Polar {
        magnitude: usize,
        in_db: bool,
        phase: usize,
        in_degrees: bool,
    },
    Rectangular {
        re: usize,
        im: usize,
    },
}

/// Points of a frequency response.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct ResponsePoints {
    /// Frequencies \[rad/s\], strictly increasing.
    pub(crate) omega: Vec<f64>,
    pub(crate) re: Vec<f64>,
    pub(crate) im: Vec<f64>,
    /// Coherence γ² as a fraction, NaN at points where it is missing; `None` without a coherence
    /// column.
    pub(crate) coherence: Option<Vec<f64>>,
}

impl CoherenceColumn {
    /// Returns γ² in a row, as a fraction.
    fn gamma_squared(self, table: &TextTable, row: usize) -> f64 {
        let value = self.factor * table.columns[self.column][row];
        if self.is_gamma { value * value } else { value }
    }
}

impl RecognisedResponse {
    /// Returns the response's points. Rows in which both parts of the complex number are missing
    /// are omitted; `omega` is the frequency of each row \[rad/s\].
    ///
    /// # Errors
    /// [`VariableFault`] with the line if only one part of a complex number is missing or a part is
    /// infinite (both [`LineFault::IncompleteResponse`]), or the magnitude is too large.
    pub(super) fn points(
        &self,
        table: &TextTable,
        omega: &[f64],
    ) -> Result<ResponsePoints, VariableFault> {
        let columns = self.parts.columns();
        let mut points = ResponsePoints {
            omega: Vec::with_capacity(omega.len()),
            re: Vec::with_capacity(omega.len()),
            im: Vec::with_capacity(omega.len()),
            coherence: self.coherence.map(|_| Vec::with_capacity(omega.len())),
        };
        for (row, &omega) in omega.iter().enumerate() {
            let line = table.lines[row];
            let number = |column: usize| table.columns[column][row];
            if columns.iter().all(|&column| number(column).is_nan()) {
                continue;
            }
            for column in columns {
                if !number(column).is_finite() {
                    let place = column_place(table, column);
                    return Err(VariableFault::line(
                        NO_VARIABLE,
                        line,
                        LineFault::IncompleteResponse { place },
                    ));
                }
            }
            let (re, im) = self.parts.complex(table, row);
            if !(re.is_finite() && im.is_finite()) {
                let place = column_place(table, columns[0]);
                return Err(VariableFault::line(
                    NO_VARIABLE,
                    line,
                    LineFault::Magnitude { place },
                ));
            }
            points.omega.push(omega);
            points.re.push(re);
            points.im.push(im);
            if let Some(column) = self.coherence
                && let Some(values) = &mut points.coherence
            {
                values.push(column.gamma_squared(table, row));
            }
        }
        Ok(points)
    }
}

impl ResponseParts {
    /// Returns the two column indices: magnitude and phase, or real and imaginary part.
    pub(super) fn columns(self) -> [usize; 2] {
        match self {
            ResponseParts::Polar {
                magnitude, phase, ..
            } => [magnitude, phase],
            ResponseParts::Rectangular { re, im } => [re, im],
        }
    }

    /// Returns the real and the imaginary part in a row.
    pub(super) fn complex(self, table: &TextTable, row: usize) -> (f64, f64) {
        match self {
            ResponseParts::Rectangular { re, im } => {
                (table.columns[re][row], table.columns[im][row])
            }
            ResponseParts::Polar {
                magnitude,
                in_db,
                phase,
                in_degrees,
            } => {
                let mut magnitude = table.columns[magnitude][row];
                if in_db {
                    magnitude = 10_f64.powf(magnitude / 20.0);
                }
                let mut phase_rad = table.columns[phase][row];
                if in_degrees {
                    phase_rad = phase_rad.to_radians();
                }
                (magnitude * phase_rad.cos(), magnitude * phase_rad.sin())
            }
        }
    }
}

/// Returns a column's name; for example "column 5" if it has no name.
pub(super) fn column_name(table: &TextTable, column: usize) -> String {
    match table.name(column) {
        Some(name) => name.to_owned(),
        None => format!("column {}", column + 1),
    }
}

/// Describes a column for messages: its number, counted from 1, and its name.
pub(super) fn column_place(table: &TextTable, column: usize) -> ColumnPlace {
    ColumnPlace {
        number: column + 1,
        name: table.name(column).map(str::to_owned),
    }
}
