//! Models from the triangular factor of the data matrix (M14, section 3, steps 3 to 5).
//!
//! ```text
//! Z0 = [z_0 ... z_{p-1}], Z1 = [z_1 ... z_p], U = u~_p, Y = y~_p, all of them columns of R
//! 1  Theta = argmin |[Z0 U] Theta - Y|^2 + ridge |Theta|^2                             predictor with an exogenous input
//! 2  Gamma K: block row i = the first (p - i) q columns of Theta', placed from column i q;   i = 0 ... f - 1, f = min(p, f_max)
//! 3  Gamma K Z0' = W S V';   T = S_n^-1/2 W_n' Gamma K;   X0 = Z0 T', X1 = Z1 T'        states
//! 4  [Co Do] from Y on [X0 U], residual E;   [Ao Bo Ko] from X1 on [X0 U E]
//! ```
//!
//! Chiuso, "The role of vector autoregressive modeling in predictor-based subspace identification", Automatica 43, 2007.

use super::*;
use nalgebra::{DMatrix, DMatrixView};

/// How a predictor is made.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct PredictorSettings {
    /// `f_max`: block rows of the map to the future at most.
    pub(super) longest_future: usize,
    /// Ridge over columns of length one.
    pub(super) ridge: f64,
}

/// The states of every order that one pole and one past window propose.
#[derive(Clone, Debug)]
pub(super) struct Subspace {
    pole: f64,
    inputs: usize,
    /// `R`, its leading (p + 1) q columns and rows.
    factor: DMatrix<f64>,
    /// `Gamma K`.
    map: DMatrix<f64>,
    /// `W`.
    left: DMatrix<f64>,
    /// The diagonal of `S`, descending.
    pub(super) singular_values: Vec<f64>,
}

impl Subspace {
    /// What the triangular factor of the data matrix of a pole \[rad/s\] says for the past window `past`; none where the
    /// regressors depend on each other or an iteration does not end.
    pub(super) fn new(
        factor: &TriangularFactor,
        pole: f64,
        (inputs, outputs): (usize, usize),
        past: usize,
        settings: PredictorSettings,
    ) -> Option<Self> {
        let channels = inputs + outputs;
        let width = past * channels;
        let all = width + channels;
        if factor.matrix().ncols() < all {
            return None;
        }
        let factor = factor.matrix().view((0, 0), (all, all)).into_owned();
        let theta = ridge_solution(factor.as_view(), width + inputs, settings.ridge)?.transpose();
        let future = past.min(settings.longest_future);
        let mut map = DMatrix::zeros(future * outputs, width);
        for row in 0..future {
            let kept = (past - row) * channels;
            map.view_mut((row * outputs, row * channels), (outputs, kept)).copy_from(&theta.columns(0, kept));
        }
        // The left factors of the transposed triangular factor of (Gamma K Z0')' are those of Gamma K Z0'.
        let mut transposed = TriangularFactor::empty(future * outputs);
        transposed.append(&(factor.view((0, 0), (width, width)) * map.transpose()));
        let decomposition = transposed.matrix().transpose().try_svd(true, false, f64::EPSILON, 10_000)?;
        let singular_values: Vec<f64> = decomposition.singular_values.iter().copied().collect();
        let finite = singular_values.iter().all(|value| value.is_finite());
        finite.then_some(Self { pole, inputs, factor, map, left: decomposition.u?, singular_values })
    }

    /// The model of an order; none where the data do not hold so many states.
    pub(super) fn model(&self, order: usize) -> Option<LaguerreModel> {
        let all = self.factor.ncols();
        let (inputs, width) = (self.inputs, self.map.ncols());
        let channels = all - width;
        let outputs = channels - inputs;
        let roots = self.singular_values.get(..order)?.iter().map(|value| value.sqrt());
        let mut states = self.left.columns(0, order).transpose() * &self.map;
        for (mut row, root) in states.row_iter_mut().zip(roots) {
            if root == 0.0 {
                return None;
            }
            row.unscale_mut(root);
        }
        let transposed = states.transpose();
        let before = self.factor.columns(0, width) * &transposed;
        let after = self.factor.columns(channels, width) * &transposed;
        let (u, y) = (self.factor.columns(width, inputs), self.factor.columns(width + inputs, outputs));
        let regressors = side_by_side(&[before.as_view(), u.as_view()]);
        let outputs_of = least_squares(&regressors, &y.into_owned())?;
        let innovation = y - &regressors * &outputs_of;
        let states_of = least_squares(&side_by_side(&[regressors.as_view(), innovation.as_view()]), &after)?;
        let part = |solution: &DMatrix<f64>, from, count| solution.rows(from, count).transpose();
        let (a, b) = (part(&states_of, 0, order), part(&states_of, order, inputs));
        let (c, d) = (part(&outputs_of, 0, order), part(&outputs_of, order, inputs));
        Some(LaguerreModel { pole: self.pole, matrices: StateSpace::new(a, b, c, d).ok()? })
    }
}

fn side_by_side(parts: &[DMatrixView<'_, f64>]) -> DMatrix<f64> {
    let rows = parts.first().map_or(0, |part| part.nrows());
    let columns: Vec<_> = parts.iter().flat_map(|part| part.column_iter()).collect();
    DMatrix::from_fn(rows, columns.len(), |row, column| columns[column][row])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_system_without_noise_comes_back() {
        let known = &answers()["pbsid_noise_free"];
        let (inputs, outputs) = (matrix(&known["u"]), matrix(&known["y"]));
        let channels = (inputs.ncols(), outputs.ncols());
        let (dt, past) = (number(&known["dt"]), number(&known["p"]) as usize);
        let segment = Segment { record: 0, start_s: 0.0, sample_time_s: dt, inputs, outputs };
        let projections = Projections { pole: number(&known["a"]), past, spacing_s: dt };
        let rows = projections.rows(&segment);
        let mut factor = TriangularFactor::empty(rows.ncols());
        factor.append(&rows);
        let settings = PredictorSettings { longest_future: 2, ridge: 0.0 };
        let subspace = Subspace::new(&factor, projections.pole, channels, past, settings).unwrap();
        // Independent numpy code; the tolerances stand in its file.
        for (found, expected) in subspace.singular_values.iter().zip(numbers(&known["singular_values"])) {
            assert!((found / expected - 1.0).abs() < 1e-6, "{found} {expected}");
        }
        let model = subspace.model(4).unwrap().continuous().unwrap();
        for (omega, expected) in numbers(&known["w"]).into_iter().zip(response(&known["H"])) {
            assert!((response_at(&model, omega) - expected).camax() < 1e-6);
        }
    }
}
