//! Computes the part of the normal equations that a segment's nuisance columns explain (M14.8,
//! M14.19).
//!
//! ```text
//! J: Jacobian, T: nuisance columns; V, S as in `normal_equations`; tau, c0, c1, b_q as in `cost`
//! A nuisance column is V times a real vector w, times a scalar sigma of the line:
//!    tau_i, c0_o, c1_o          unit vectors,   sigma = 1, 1, 1/(j omega)
//!    missing output o           unit vector,    sigma = b_q
//!    missing input j            [B_j; D_j],     sigma = b_q
//! The sums are those over the lines in a bin (`frequency_bins`); V is constant there.
//! 1  J'T[(v, s), (w, sigma)] = sum over bins of Re(V^H V[v, w] sum conj(S_s) sigma)
//! 2  T'T[(v, sigma), (w, sigma')] = sum over bins of Re(V^H V[v, w] sum conj(sigma) sigma')
//! 3  J'T F with F F' = (T'T)^+:  the caller subtracts (J'T F) (J'T F)' from G
//! ```

use nalgebra::{Complex, DMatrix};

use gdcm_model::dataset::channel::ChannelSide;

use super::binned_products::{BinnedScalars, VectorProducts};
use super::gram_matrix::pseudo_inverse_root;
use super::nuisance_columns::DEPENDENT;
use super::schur_model::SchurModel;
use super::spectral_lines::SpectralLines;

/// Index of the scalar sigma = 1.
const ONE: usize = 0;
/// Index of the scalar sigma = 1/(j omega).
const INTEGRATOR: usize = 1;
/// Index of the first hat.
const FIRST_HAT: usize = 2;

/// Sums over a segment's lines, bin by bin.
pub(super) struct NuisanceSums {
    /// `conj(S) sigma` for each scalar sigma; a column for each entry in S.
    with_parameters: Vec<BinnedScalars>,
    /// `conj(sigma) sigma'`; a column for each pair, sigma running fastest.
    squares: BinnedScalars,
}

impl NuisanceSums {
    /// Starts the sums; `size` is n + inputs.
    pub(super) fn new(size: usize, bins: usize, hats: usize) -> Self {
        let scalars = FIRST_HAT + hats;
        let mut with_parameters = Vec::with_capacity(scalars);
        for _ in 0..scalars {
            with_parameters.push(BinnedScalars::zeros(bins, size));
        }
        Self {
            with_parameters,
            squares: BinnedScalars::zeros(bins, scalars * scalars),
        }
    }

    /// Adds a segment's line `k`, which is in bin `bin`; `conjugate` is conj(S).
    pub(super) fn add(
        &mut self,
        lines: &SpectralLines,
        k: usize,
        bin: usize,
        conjugate: &[Complex<f64>],
    ) {
        let power = lines.scale * lines.scale;
        let scalars = scalars_of_line(lines, k);
        for (second, sigma) in scalars.iter().enumerate() {
            let weighted = sigma * power;
            for (entry, value) in conjugate.iter().enumerate() {
                self.with_parameters[second].add(bin, entry, value * weighted);
            }
            for (first, other) in scalars.iter().enumerate() {
                let column = second * scalars.len() + first;
                self.squares.add(bin, column, other.conj() * weighted);
            }
        }
    }

    /// Computes `J'T F` (steps 1 to 3), a row for each entry of `[[A, B], [C, D]]`; `None` if `T'T`
    /// is not finite, or its eigenvalue iteration does not converge.
    pub(super) fn explained(
        &self,
        products: &VectorProducts,
        lines: &SpectralLines,
        model: &SchurModel,
    ) -> Option<DMatrix<f64>> {
        let columns = nuisance_columns(lines, model);
        let with_parameters = self.with_parameters(products, &columns);
        let root = pseudo_inverse_root(self.with_each_other(products, &columns), DEPENDENT)?;
        Some(with_parameters * root)
    }

    /// Computes `J'T` (step 1).
    fn with_parameters(
        &self,
        products: &VectorProducts,
        columns: &[NuisanceColumn],
    ) -> DMatrix<f64> {
        let vectors = products.size;
        let size = self.with_parameters[ONE].count();
        let mut result = DMatrix::zeros(vectors * size, columns.len());
        for (scalar, sums) in self.with_parameters.iter().enumerate() {
            // Only the range of columns in V that this scalar's nuisance columns use is computed.
            let with_scalar = columns.iter().filter(|column| column.scalar == scalar);
            let used = with_scalar.flat_map(|column| column.vector.iter().map(|(w, _)| *w));
            let Some(first) = used.clone().min() else {
                continue;
            };
            let last = used.max().unwrap_or(first);
            // Rows are entries (v, w), columns are entries in S.
            let table = products.times(first, last - first + 1, sums);
            for (number, column) in columns.iter().enumerate() {
                if column.scalar != scalar {
                    continue;
                }
                for &(w, factor) in &column.vector {
                    let block = table.rows((w - first) * vectors, vectors);
                    let mut to = result.column_mut(number);
                    for (entry, value) in to.iter_mut().zip(block.iter()) {
                        *entry += value * factor;
                    }
                }
            }
        }
        result
    }

    /// Computes `T'T` (step 2).
    fn with_each_other(
        &self,
        products: &VectorProducts,
        columns: &[NuisanceColumn],
    ) -> DMatrix<f64> {
        let vectors = products.size;
        let scalars = self.with_parameters.len();
        let table = products.times(0, vectors, &self.squares);
        let mut result = DMatrix::zeros(columns.len(), columns.len());
        for (number, second) in columns.iter().enumerate() {
            for (other, first) in columns.iter().enumerate().take(number + 1) {
                let pair = second.scalar * scalars + first.scalar;
                let mut product = 0.0;
                for &(w, right) in &second.vector {
                    for &(v, left) in &first.vector {
                        product += table[(w * vectors + v, pair)] * left * right;
                    }
                }
                result[(other, number)] = product;
                result[(number, other)] = product;
            }
        }
        result
    }
}

/// Returns the nuisance columns' scalars at a line: 1, 1/(j omega), the hats.
fn scalars_of_line(lines: &SpectralLines, k: usize) -> Vec<Complex<f64>> {
    let mut scalars = vec![Complex::from(1.0), Complex::new(0.0, -1.0 / lines.omega[k])];
    scalars.extend(lines.hats.iter().map(|hat| hat.lines[k]));
    scalars
}

/// A nuisance column: `V vector` times a scalar.
struct NuisanceColumn {
    /// The vector's nonzero entries, each with its column index in `V`.
    vector: Vec<(usize, f64)>,
    /// Index of its scalar sigma.
    scalar: usize,
}

/// Returns a segment's nuisance columns: tau, c0, c1, hats.
fn nuisance_columns(lines: &SpectralLines, model: &SchurModel) -> Vec<NuisanceColumn> {
    let order = model.order();
    let outputs = model.c().nrows();
    let mut columns = Vec::with_capacity(order + 2 * outputs + lines.hats.len());
    for vector in 0..order + outputs {
        columns.push(NuisanceColumn {
            vector: vec![(vector, 1.0)],
            scalar: ONE,
        });
    }
    for output in 0..outputs {
        columns.push(NuisanceColumn {
            vector: vec![(order + output, 1.0)],
            scalar: INTEGRATOR,
        });
    }
    for (number, hat) in lines.hats.iter().enumerate() {
        let vector = match hat.side {
            ChannelSide::Output => vec![(order + hat.channel, 1.0)],
            ChannelSide::Input => {
                let b = model.b().column(hat.channel);
                let d = model.d().column(hat.channel);
                b.iter().chain(d.iter()).copied().enumerate().collect()
            }
        };
        columns.push(NuisanceColumn {
            vector,
            scalar: FIRST_HAT + number,
        });
    }
    columns
}
