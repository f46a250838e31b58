//! Discretises a state-space model exactly for inputs that are linear between samples.

use nalgebra::{DMatrix, DVector};

use crate::dataset::StateSpace;

/// A model discretised at sample time `T`, exact for inputs that are linear between samples
/// (first-order hold; C. F. Van Loan, IEEE Trans. Autom. Control 23, 1978).
///
/// ```text
///     [A T  B T  0]   [Phi  G1  G2]
/// exp [ 0    0   I] = [ 0   I   I ],    x[k+1] = Phi x[k] + G1 u[k] + G2 (u[k+1] - u[k]),    y = C x + D u
///     [ 0    0   0]   [ 0   0   I ]
/// ```
///
/// A is n x n, B n x m; k counts samples.
#[derive(Clone, Debug, PartialEq)]
pub struct FirstOrderHold {
    /// `Phi`, n x n.
    phi: DMatrix<f64>,
    /// `G1`, n x m: effect of a constant input.
    gamma: DMatrix<f64>,
    /// `G2`, n x m: effect of the change in the input within a sample.
    gamma_slope: DMatrix<f64>,
    c: DMatrix<f64>,
    d: DMatrix<f64>,
}

impl FirstOrderHold {
    /// Discretises `model` at `sample_time_s` \[s\]; `None` if the result is not finite.
    #[must_use]
    pub fn new(model: &StateSpace, sample_time_s: f64) -> Option<Self> {
        let n = model.order();
        let m = model.inputs();
        let mut exponent = DMatrix::zeros(n + 2 * m, n + 2 * m);
        exponent
            .view_mut((0, 0), (n, n))
            .copy_from(&model.a().scale(sample_time_s));
        exponent
            .view_mut((0, n), (n, m))
            .copy_from(&model.b().scale(sample_time_s));
        exponent.view_mut((n, n + m), (m, m)).fill_with_identity();
        if !exponent.norm().is_finite() {
            return None;
        }
        let exponential = exponent.exp();
        if exponential.iter().any(|entry| !entry.is_finite()) {
            return None;
        }
        Some(Self {
            phi: exponential.view((0, 0), (n, n)).into_owned(),
            gamma: exponential.view((0, n), (n, m)).into_owned(),
            gamma_slope: exponential.view((0, n + m), (n, m)).into_owned(),
            c: model.c().clone(),
            d: model.d().clone(),
        })
    }

    /// Simulates the outputs from the state `initial`; inputs and outputs have one row per sample.
    #[must_use]
    pub fn simulate(&self, initial: &DVector<f64>, inputs: &DMatrix<f64>) -> DMatrix<f64> {
        let mut outputs = DMatrix::zeros(inputs.nrows(), self.c.nrows());
        let mut x = initial.clone();
        for k in 0..inputs.nrows() {
            let u = inputs.row(k).transpose();
            outputs.set_row(k, &(&self.c * &x + &self.d * &u).transpose());
            if k + 1 < inputs.nrows() {
                let next = inputs.row(k + 1).transpose();
                x = &self.phi * x + &self.gamma * &u + &self.gamma_slope * (next - &u);
            }
        }
        outputs
    }

    /// Returns the free response `C Phi^k` to each initial state, for k = 0 ... `samples` - 1: one
    /// column per state, and for each sample one row per output.
    #[must_use]
    pub fn free_responses(&self, samples: usize) -> DMatrix<f64> {
        let (outputs, states) = self.c.shape();
        let mut responses = DMatrix::zeros(samples * outputs, states);
        let mut response = self.c.clone();
        for k in 0..samples {
            responses
                .rows_mut(k * outputs, outputs)
                .copy_from(&response);
            response = &response * &self.phi;
        }
        responses
    }
}
