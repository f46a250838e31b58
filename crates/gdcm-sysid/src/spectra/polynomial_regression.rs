//! The linear regression for a local polynomial (step 2 in [`local_polynomial`]).
//!
//! ```text
//! row of a line    [U, x U, x^2 U | Y],   x = (omega_k - omega) / h;   Y in the last columns
//! column           power inputs + i holds x^power U_i
//! rows             the lines of one record after the other, then a diagonal ridge
//! ```
//!
//! [`local_polynomial`]: super::local_polynomial::local_polynomial

use nalgebra::{Complex, DMatrix, DVector};

use super::polynomial_window::Window;
use super::spectrum::Spectrum;

/// Ridge relative to the column length; it bounds the estimate if an input copies another.
const RIDGE: f64 = 1e-9;

/// The linear regression in a window.
pub(super) struct Regression {
    /// Rows `[A B]` from all records with the transients removed, then the ridge's rows.
    pub(super) rows: DMatrix<Complex<f64>>,
    /// Sum of `|Y|^2` for each output.
    pub(super) power: DVector<f64>,
}

impl Regression {
    /// Fills all records' rows in the window, each record without its transient, and adds the
    /// ridge.
    pub(super) fn new(spectra: &[Spectrum], window: &Window) -> Self {
        let inputs = spectra[0].inputs.nrows();
        let outputs = spectra[0].outputs.nrows();
        let unknowns = window.terms * inputs;
        let mut regression = Self {
            rows: DMatrix::zeros(window.count + unknowns, unknowns + outputs),
            power: DVector::zeros(outputs),
        };
        // Row for the record's first line.
        let mut top = 0;
        for (spectrum, lines) in spectra.iter().zip(&window.lines) {
            if lines.is_empty() {
                continue;
            }
            let x: Vec<f64> = spectrum.omega[lines.clone()]
                .iter()
                .map(|w| (w - window.omega) / window.half_width)
                .collect();
            for (k, (line, x)) in lines.clone().zip(&x).enumerate() {
                regression.fill_row(top + k, spectrum, line, *x, window.terms);
            }
            regression.remove_transient(top, &x, window.terms);
            top += x.len();
        }
        regression.add_ridge(top, unknowns);
        regression
    }

    /// Writes `[U, x U, x^2 U | Y]` for a line.
    fn fill_row(&mut self, row: usize, spectrum: &Spectrum, line: usize, x: f64, terms: usize) {
        let inputs = spectrum.inputs.nrows();
        for (i, u) in spectrum.inputs.column(line).iter().enumerate() {
            let mut term = *u;
            for power in 0..terms {
                self.rows[(row, power * inputs + i)] = term;
                term *= x;
            }
        }
        for (o, y) in spectrum.outputs.column(line).iter().enumerate() {
            self.rows[(row, terms * inputs + o)] = *y;
            self.power[o] += y.norm_sqr();
        }
    }

    /// Subtracts from a record's rows their projection on its polynomial transient.
    fn remove_transient(&mut self, top: usize, x: &[f64], terms: usize) {
        let powers = DMatrix::from_fn(x.len(), terms, |line, power| x[line].powi(power as i32));
        let transient = powers.qr().q().map(Complex::from);
        let mut record_rows = self.rows.rows_mut(top, x.len());
        let explained = &transient * transient.ad_mul(&record_rows);
        record_rows -= explained;
    }

    /// Adds a ridge proportional to the column lengths in `A`; 1 for a zero column.
    fn add_ridge(&mut self, top: usize, unknowns: usize) {
        for column in 0..unknowns {
            let length = self.rows.column(column).norm();
            let ridge = if length > 0.0 { RIDGE * length } else { 1.0 };
            self.rows[(top + column, column)] = Complex::from(ridge);
        }
    }
}
