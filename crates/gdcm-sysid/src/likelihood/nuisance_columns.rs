//! A segment's nuisance columns, and their elimination from a vector: steps 1 to 3 in `cost`.
//!
//! A *nuisance column* of `T` is the whitened effect, on the segment's lines, of an unknown that is
//! no parameter of the model: an entry of the transient tau, of the step c0 or of the drift c1, or
//! the height of a *hat*, a triangle that describes missing samples (`gap_hat`).

use nalgebra::{Complex, DMatrix, DVector};

use gdcm_model::dataset::channel::ChannelSide;

use super::gram_matrix::pseudo_inverse_root;
use super::schur_model::SchurModel;
use super::spectral_lines::{SpectralLines, whiten};

/// Eigenvalues of the nuisance columns' Gram matrix below this share of the largest are dropped.
pub(super) const DEPENDENT: f64 = 1e-12;

/// A vector fitted by the nuisance columns.
pub(super) struct Elimination {
    /// Coefficients of the columns for tau.
    pub(super) transient: DVector<f64>,
    /// Coefficients of the columns for the hats.
    pub(super) hat_values: Vec<f64>,
    /// The vector less its fit, outputs x lines.
    pub(super) residual: DMatrix<Complex<f64>>,
    /// Squared norm of the residual.
    pub(super) square: f64,
}

/// A segment's nuisance columns `T` in real form: two rows for each output at each line, the real
/// and the imaginary part.
///
/// The columns are tau, c0, c1, the hats, and last the vector to be fitted, which is zero until
/// [`Self::eliminate`].
pub(super) struct NuisanceColumns<'s> {
    lines: &'s SpectralLines,
    /// `C (j omega - A)^-1` at each line.
    resolvents: Vec<&'s [Complex<f64>]>,
    order: usize,
    /// Number of nuisance columns; `matrix` has one column more.
    count: usize,
    matrix: DMatrix<f64>,
}

impl<'s> NuisanceColumns<'s> {
    /// Fills the columns (step 1); `resolvents` is `C (j omega - A)^-1` at each line.
    pub(super) fn new(
        lines: &'s SpectralLines,
        model: &SchurModel,
        resolvents: Vec<&'s [Complex<f64>]>,
    ) -> Self {
        let outputs = lines.outputs.nrows();
        let order = model.order();
        let count = order + 2 * outputs + lines.hats.len();
        let mut columns = Self {
            lines,
            resolvents,
            order,
            count,
            matrix: DMatrix::zeros(2 * outputs * lines.omega.len(), count + 1),
        };
        columns.fill_transient();
        for number in 0..lines.hats.len() {
            columns.fill_hat(number, model);
        }
        columns
    }

    /// Writes a column's value for an output at a line.
    fn put(&mut self, k: usize, column: usize, output: usize, value: Complex<f64>) {
        let row = 2 * (k * self.lines.outputs.nrows() + output);
        self.matrix[(row, column)] = value.re;
        self.matrix[(row + 1, column)] = value.im;
    }

    /// Fills the columns for tau, c0 and c1 (step 1).
    fn fill_transient(&mut self) {
        let outputs = self.lines.outputs.nrows();
        for (k, &omega) in self.lines.omega.iter().enumerate() {
            let weight = &self.lines.weights[k];
            let cr = self.resolvents[k];
            for (state, values) in cr.chunks_exact(outputs).enumerate() {
                whiten(weight, values, |o, value| self.put(k, state, o, value));
            }
            let integrator = Complex::new(0.0, -1.0 / omega);
            for column in 0..outputs {
                for o in column..outputs {
                    let value = weight[(o, column)];
                    self.put(k, self.order + column, o, value);
                    self.put(k, self.order + outputs + column, o, value * integrator);
                }
            }
        }
    }

    /// Fills a hat's column (step 1): `W e_o b_q` for an output o, `W G_i b_q` for an input i.
    fn fill_hat(&mut self, number: usize, model: &SchurModel) {
        let outputs = self.lines.outputs.nrows();
        let column = self.order + 2 * outputs + number;
        let hat = &self.lines.hats[number];
        for (k, line) in hat.lines.iter().enumerate() {
            let mut effect = vec![Complex::default(); outputs];
            match hat.side {
                ChannelSide::Output => effect[hat.channel] = *line,
                ChannelSide::Input => {
                    let b = model.b().column(hat.channel);
                    let d = model.d().column(hat.channel);
                    for (o, value) in effect.iter_mut().enumerate() {
                        let states = self.resolvents[k].chunks_exact(outputs).zip(b.iter());
                        let g: Complex<f64> = states.map(|(cr, b)| cr[o] * *b).sum();
                        *value = (g + d[o]) * line;
                    }
                }
            }
            whiten(&self.lines.weights[k], &effect, |o, value| {
                self.put(k, column, o, value)
            });
        }
    }

    /// Fits the columns to a vector, outputs x lines, by least squares (steps 2 and 3).
    ///
    /// Returns `None` if the residual is not finite, or if the eigenvalue iteration does not
    /// converge.
    pub(super) fn eliminate(mut self, vector: &DMatrix<Complex<f64>>) -> Option<Elimination> {
        let (outputs, lines) = self.lines.outputs.shape();
        for (k, values) in vector.column_iter().enumerate() {
            for (o, value) in values.iter().enumerate() {
                self.put(k, self.count, o, *value);
            }
        }
        let gram = self.matrix.transpose() * &self.matrix;
        let count = self.count;
        let root = pseudo_inverse_root(gram.view((0, 0), (count, count)).into_owned(), DEPENDENT)?;
        let fitted = &root * (root.transpose() * gram.view((0, count), (count, 1)));
        let left = self.matrix.column(count) - self.matrix.columns(0, count) * &fitted;
        let square = left.norm_squared();
        if !square.is_finite() {
            return None;
        }
        let residual = left
            .as_slice()
            .chunks_exact(2)
            .map(|parts| Complex::new(parts[0], parts[1]));
        Some(Elimination {
            transient: fitted.rows(0, self.order).column(0).into_owned(),
            hat_values: fitted
                .rows(self.order + 2 * outputs, self.lines.hats.len())
                .iter()
                .copied()
                .collect(),
            residual: DMatrix::from_iterator(outputs, lines, residual),
            square,
        })
    }

    /// Averages the diagonal of `T (T'T)^+ T'` over each line's rows; `None` if the eigenvalue
    /// iteration does not converge.
    pub(super) fn shares(self) -> Option<Vec<f64>> {
        let columns = self.matrix.columns(0, self.count);
        let gram = columns.transpose() * columns;
        let projected = columns * pseudo_inverse_root(gram, DEPENDENT)?;
        let rows = 2 * self.lines.outputs.nrows();
        let mut shares = Vec::with_capacity(self.lines.omega.len());
        for k in 0..self.lines.omega.len() {
            shares.push(projected.rows(k * rows, rows).norm_squared() / rows as f64);
        }
        Some(shares)
    }
}
