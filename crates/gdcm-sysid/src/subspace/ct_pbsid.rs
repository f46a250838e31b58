//! Computes models of all orders from the data matrix's triangular factor: CT-PBSID (M14.3).
//!
//! Predictor-based subspace identification (PBSID) fits a predictor, finds states in its map from
//! the past to the future, and fits a model to the states. In continuous time (CT), Laguerre
//! projections take the place of past samples.
//!
//! ```text
//! z_k = [u~_k; y~_k]: k-th Laguerre projections of the inputs u and the outputs y (`data_matrix`)
//! p past window, q channels (inputs and outputs), l outputs, n order
//! R triangular factor of the data matrix Z = [z_0 ... z_p]. R'R = Z'Z, so that least squares on
//!   columns of R and on those of Z agree; the leading block of R serves a shorter past window
//! Gamma K: map from the past to the future (observability times controllability matrix)
//! W, S left singular vectors and singular values; W_n, S_n the first n of them; T map to n states
//!
//! Z0 = [z_0 ... z_{p-1}], Z1 = [z_1 ... z_p], U = u~_p, Y = y~_p, columns of R
//! 1  Theta = argmin |[Z0 U] Theta - Y|^2 + ridge |Theta|^2     predictor with an exogenous input
//! 2  Gamma K: block row i = i q columns of zeros, then the first (p - i) q columns of Theta'
//!    i = 0 ... f - 1, f = min(p, f_max): f l rows suffice for f l states
//! 3  Gamma K Z0' = W S V';   T = S_n^-1/2 W_n' Gamma K;   states X0 = Z0 T', X1 = Z1 T'
//! 4  [Co Do] from Y on [X0 U], residual E;   [Ao Bo Ko] from X1 on [X0 U E]
//! 5  (Ao, Bo, Co, Do), a model in k, to continuous time (`continuous_model`)
//! ```
//!
//! A. Chiuso, "The role of vector autoregressive modeling in predictor-based subspace
//! identification", Automatica 43, 2007.

use nalgebra::{DMatrix, DMatrixView};

use gdcm_model::dataset::StateSpace;

use super::continuous_model::continuous;
use super::triangular_factor::{TriangularFactor, least_squares, ridge_solution};

/// Channel counts, and the chosen sizes of the past and the future.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SubspaceShape {
    pub(crate) inputs: usize,
    pub(crate) outputs: usize,
    /// Past window p.
    pub(crate) past: usize,
    /// Maximum number of block rows in the map to the future, `f_max`: more rows than the highest
    /// order needs only enlarge the decomposition.
    pub(crate) longest_future: usize,
}

impl SubspaceShape {
    /// Returns q, the number of channels.
    fn channels(self) -> usize {
        self.inputs + self.outputs
    }

    /// Returns p q, the number of columns in `Z0`.
    fn past_columns(self) -> usize {
        self.past * self.channels()
    }
}

/// States for models of all orders, from one Laguerre pole and one past window.
#[derive(Clone, Debug)]
pub(crate) struct Subspace {
    /// Laguerre pole \[rad/s\].
    pole: f64,
    inputs: usize,
    /// The leading (p + 1) q rows and columns in `R`.
    factor: DMatrix<f64>,
    /// `Gamma K`, the map to the future.
    map: DMatrix<f64>,
    /// `W`, the left singular vectors of `Gamma K Z0'`.
    left_vectors: DMatrix<f64>,
    /// The diagonal of `S`, descending.
    pub(crate) singular_values: Vec<f64>,
}

impl Subspace {
    /// Computes the states (steps 1 to 3) from the triangular factor at a Laguerre pole \[rad/s\];
    /// `ridge` applies to columns scaled to unit length.
    ///
    /// Returns `None` if `factor` has fewer projections than the past window, if the regressors
    /// depend on each other, or if an iteration does not converge.
    pub(crate) fn new(
        factor: &TriangularFactor,
        pole: f64,
        shape: SubspaceShape,
        ridge: f64,
    ) -> Option<Self> {
        let size = shape.past_columns() + shape.channels();
        if factor.matrix().ncols() < size {
            return None;
        }
        let factor = factor.matrix().view((0, 0), (size, size)).into_owned();
        let predictor = transposed_predictor(&factor, shape, ridge)?;
        let map = map_to_future(&predictor, shape);
        let decomposition = decompose(&factor, &map)?;
        Some(Self {
            pole,
            inputs: shape.inputs,
            factor,
            map,
            left_vectors: decomposition.left_vectors,
            singular_values: decomposition.singular_values,
        })
    }

    /// Computes the continuous-time model at an order (steps 4 and 5); `None` if the data do not
    /// contain so many states, or do not determine the model.
    pub(crate) fn model(&self, order: usize) -> Option<StateSpace> {
        let model_in_k = self.model_in_k(order)?;
        continuous(self.pole, &model_in_k)
    }

    /// Step 4: fits `(Ao, Bo, Co, Do)`. `Ko` is fitted and dropped, because a model has no noise
    /// input; as `E` is orthogonal to `[X0 U]`, it changes `Ao` and `Bo` only by rounding.
    fn model_in_k(&self, order: usize) -> Option<StateSpace> {
        let inputs = self.inputs;
        let DataBlocks { z0, z1, u, y } = self.data_blocks();
        let to_states = self.state_map(order)?.transpose();
        let x0 = z0 * &to_states;
        let x1 = z1 * &to_states;
        let regressors = side_by_side(&[x0.as_view(), u.as_view()]);
        let output_solution = least_squares(&regressors, &y.into_owned())?;
        let residual = y - &regressors * &output_solution;
        let regressors = side_by_side(&[regressors.as_view(), residual.as_view()]);
        let state_solution = least_squares(&regressors, &x1)?;
        let a = state_solution.rows(0, order).transpose();
        let b = state_solution.rows(order, inputs).transpose();
        let c = output_solution.rows(0, order).transpose();
        let d = output_solution.rows(order, inputs).transpose();
        StateSpace::new(a, b, c, d).ok()
    }

    /// Returns the blocks of `R` as named above.
    fn data_blocks(&self) -> DataBlocks<'_> {
        let past_columns = self.map.ncols();
        let channels = self.factor.ncols() - past_columns;
        let outputs = channels - self.inputs;
        DataBlocks {
            z0: self.factor.columns(0, past_columns),
            z1: self.factor.columns(channels, past_columns),
            u: self.factor.columns(past_columns, self.inputs),
            y: self.factor.columns(past_columns + self.inputs, outputs),
        }
    }

    /// Computes `T = S_n^-1/2 W_n' Gamma K` (step 3); `None` if there are fewer than `order`
    /// nonzero singular values.
    fn state_map(&self, order: usize) -> Option<DMatrix<f64>> {
        let singular_values = self.singular_values.get(..order)?;
        let mut map = self.left_vectors.columns(0, order).transpose() * &self.map;
        for (mut row, value) in map.row_iter_mut().zip(singular_values) {
            let root = value.sqrt();
            if root == 0.0 {
                return None;
            }
            row.unscale_mut(root);
        }
        Some(map)
    }
}

/// Blocks of columns in `R`: all past projections `Z0`, the same one projection later `Z1`, and the
/// last projections of inputs and outputs.
struct DataBlocks<'a> {
    z0: DMatrixView<'a, f64>,
    z1: DMatrixView<'a, f64>,
    u: DMatrixView<'a, f64>,
    y: DMatrixView<'a, f64>,
}

/// Step 1: computes `Theta'`, a row for each output; `None` if the regressors depend on each other.
fn transposed_predictor(
    factor: &DMatrix<f64>,
    shape: SubspaceShape,
    ridge: f64,
) -> Option<DMatrix<f64>> {
    let regressors = shape.past_columns() + shape.inputs;
    Some(ridge_solution(factor.as_view(), regressors, ridge)?.transpose())
}

/// Step 2: computes `Gamma K` from `Theta'`. The predictor of `y~_{p+i}` uses `z_i` to `z_{p+i-1}`,
/// of which `z_i` to `z_{p-1}` are in the past window.
fn map_to_future(predictor: &DMatrix<f64>, shape: SubspaceShape) -> DMatrix<f64> {
    let outputs = shape.outputs;
    let channels = shape.channels();
    let future = shape.past.min(shape.longest_future);
    let mut map = DMatrix::zeros(future * outputs, shape.past_columns());
    for row in 0..future {
        let kept = (shape.past - row) * channels;
        map.view_mut((row * outputs, row * channels), (outputs, kept))
            .copy_from(&predictor.columns(0, kept));
    }
    map
}

/// `W` and the diagonal of `S` in step 3.
struct LeftDecomposition {
    left_vectors: DMatrix<f64>,
    singular_values: Vec<f64>,
}

/// Step 3: decomposes `Gamma K Z0'`; `None` if the iteration does not converge.
fn decompose(factor: &DMatrix<f64>, map: &DMatrix<f64>) -> Option<LeftDecomposition> {
    let past_columns = map.ncols();
    // (Gamma K Z0')' is tall: the transpose of its small triangular factor has the same left
    // singular vectors and singular values as Gamma K Z0'. `R` is triangular, so that `Z0` has
    // entries in its first rows only.
    let z0 = factor.view((0, 0), (past_columns, past_columns));
    let mut transposed = TriangularFactor::empty(map.nrows());
    transposed.append(&(z0 * map.transpose()));
    let decomposition =
        transposed
            .matrix()
            .transpose()
            .try_svd(true, false, f64::EPSILON, 10_000)?;
    let singular_values: Vec<f64> = decomposition.singular_values.iter().copied().collect();
    if !singular_values.iter().all(|value| value.is_finite()) {
        return None;
    }
    Some(LeftDecomposition {
        left_vectors: decomposition.u?,
        singular_values,
    })
}

/// Joins matrices side by side.
fn side_by_side(parts: &[DMatrixView<'_, f64>]) -> DMatrix<f64> {
    let rows = parts.first().map_or(0, |part| part.nrows());
    let columns: Vec<_> = parts.iter().flat_map(|part| part.column_iter()).collect();
    DMatrix::from_fn(rows, columns.len(), |row, column| columns[column][row])
}

#[cfg(test)]
mod tests {
    use gdcm_model::simulation::Segment;

    use super::*;
    use crate::identification::known_answers_tests::{
        answers, matrix, number, numbers, response, response_at,
    };
    use crate::subspace::data_matrix::Projections;

    #[test]
    fn a_system_without_noise_comes_back() {
        let known = &answers()["pbsid_noise_free"];
        let inputs = matrix(&known["u"]);
        let outputs = matrix(&known["y"]);
        let dt = number(&known["dt"]);
        let shape = SubspaceShape {
            inputs: inputs.ncols(),
            outputs: outputs.ncols(),
            past: number(&known["p"]) as usize,
            longest_future: 2,
        };
        let segment = Segment {
            record: 0,
            start_s: 0.0,
            sample_time_s: dt,
            inputs,
            outputs,
        };
        let projections = Projections {
            pole: number(&known["a"]),
            past: shape.past,
            spacing_s: dt,
        };
        let rows = projections.rows(&segment);
        let mut factor = TriangularFactor::empty(rows.ncols());
        factor.append(&rows);
        let subspace = Subspace::new(&factor, projections.pole, shape, 0.0).unwrap();
        // Expected values from independent numpy code; their file states the tolerances.
        for (found, expected) in subspace
            .singular_values
            .iter()
            .zip(numbers(&known["singular_values"]))
        {
            assert!((found / expected - 1.0).abs() < 1e-6, "{found} {expected}");
        }
        let model = subspace.model(4).unwrap();
        for (omega, expected) in numbers(&known["w"]).into_iter().zip(response(&known["H"])) {
            assert!((response_at(&model, omega) - expected).camax() < 1e-6);
        }
    }
}
