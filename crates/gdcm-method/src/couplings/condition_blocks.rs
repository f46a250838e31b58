//! A condition's contribution to the normal equations `G theta = b` in a pass, assembled from small
//! blocks; the design matrix's rows are not stored (M16.2).
//!
//! The fit is a sequence of *passes*, linear least-squares problems whose weights and closed loop
//! follow from the previous pass. A pass minimises, over the entries `theta` in the mixing `M` (m x
//! m) and the feedback `K` (m x p),
//!
//! ```text
//! sum q^2 |S R' - F M - F K R'|^2,    S = (I - H K_0)^-1,    F = S H
//! ```
//!
//! over conditions, frequencies and responses. `H` is the physics response and `R'` the flight
//! response without its channels' delays and leads, both p x m; `K_0` and `M_0` are the couplings
//! from the previous pass; `q` is a response's weight (`weighted_condition`). The residual is that
//! of `R' = (I - H K)^-1 H M`, multiplied by `I - H K`, which makes it linear in `theta`, and by
//! the previous pass's `S`.
//!
//! In input column i, the unknowns `M_ji` and `K_jo` multiply the column `F[:,j]` times 1 and times
//! `R'_oi`. With these factors as `t`, the entries in `G` and `b` are sums over the frequencies,
//! which are processed in chunks:
//!
//! ```text
//! 1  for each frequency in the chunk:
//!        F <- (I - H K_0)^-1 H,   S = I + F K_0
//!    for each input column i:
//!        for each frequency in the chunk:
//! 2          q^2 <- weights of column i, which depend on column i of F M_0, the model
//!                   response after the previous pass
//! 3          t   <- (1, R'_oi for every fed-back output o)
//! 4          z   <- F^H q^2 (S R')[:,i],   S R' = R' + F K_0 R'
//! 5          b[(a, j)] += Re conj(t_a) z_j
//! 6      G[(a, j), (b, l)] += sum over the chunk of Re conj(t_a) t_b P_jl,   P = F^H q^2 F
//! ```
//!
//! The index pair `(a, j)` means the unknown with the column `t_a F[:,j]`: `M_ji` for a = 0, and
//! `K_jo` for a > 0, where o is the a-th fed-back output. The airspeed, on which `M_ii` depends, is
//! the same at all frequencies in a condition; its powers are applied in `normal_equations`.

use nalgebra::{Complex, DMatrix, DVector};

use gdcm_model::progress::{Cancelled, Progress};

use super::closed_loop::ClosedLoop;
use super::coupling_matrices::CouplingMatrices;
use super::error::CouplingError;
use super::pair_products::{CHUNK, PairProducts, ProductChunk, RowParts, pair_count};
use super::weighted_condition::WeightedCondition;

/// A condition's contribution to the normal equations.
pub(super) struct ConditionBlocks {
    /// Blocks that involve unknowns in M, per input column.
    pub(super) columns: Vec<ColumnBlocks>,
    /// Entries in `G` for two unknowns in K, summed over the input columns.
    pub(super) feedback: PairProducts,
    /// Entries in `b` for the unknowns in K: one row per fed-back output, one column per input.
    pub(super) right: DMatrix<f64>,
}

/// Entries in `G` and `b` for M's unknowns in one input column.
#[derive(Clone)]
pub(super) struct ColumnBlocks {
    /// One row for each factor pair `t_0 t_b`, where `t_0 = 1`: M's unknowns with one another
    /// (b = 0), and with those in K.
    products: PairProducts,
    /// Entries in `b`, one for each input j.
    pub(super) right: DVector<f64>,
}

impl ConditionBlocks {
    /// Computes a condition's blocks, given the couplings `last` from the previous pass; `fed_back`
    /// lists the outputs with a column in `K`.
    ///
    /// # Errors
    /// [`CouplingError::SingularLoop`] if `I - K H` is singular at a frequency that counts,
    /// [`CouplingError::Cancelled`] if `progress` is cancelled.
    pub(super) fn new(
        condition: &WeightedCondition<'_>,
        last: &CouplingMatrices,
        fed_back: &[usize],
        progress: &dyn Progress,
    ) -> Result<Self, CouplingError> {
        let last = LastPass {
            mixing: last.mixing(condition.airspeed_kt),
            feedback: last.feedback(),
            fed_back,
        };
        let (inputs, outputs) = last.feedback.shape();
        let factors = fed_back.len() + 1;
        let mut blocks = Self::zeros(inputs, fed_back.len());
        let mut terms = ColumnTerms::zeros(inputs, outputs, factors);
        let mut chunk = ProductChunk::new(inputs, factors);
        let mut closed_loop = ClosedLoop::new(last.feedback);
        // Indices of the frequencies at which any response has a weight.
        let counting: Vec<usize> = (0..condition.omega.len())
            .filter(|&k| condition.has_weight_at(k))
            .collect();
        for frequencies in counting.chunks(CHUNK) {
            if progress.cancelled() {
                return Err(CouplingError::Cancelled(Cancelled));
            }
            // Step 1
            let mut closed = Vec::with_capacity(frequencies.len());
            for &k in frequencies {
                closed.push(ClosedResponse::new(condition, k, &mut closed_loop)?);
            }
            for input in 0..inputs {
                chunk.clear();
                for response in &closed {
                    // Steps 2 to 4
                    if terms.set(condition, response, &last, input) {
                        chunk.push(&terms.factors, &response.rows, &terms.squared_weights);
                        // Step 5
                        blocks.add_right(&terms, input);
                    }
                }
                // Step 6
                blocks.columns[input].products.add_pairs_with_first(&chunk);
                blocks.feedback.add_pairs_without_first(&chunk);
            }
        }
        Ok(blocks)
    }

    fn zeros(inputs: usize, fed_back: usize) -> Self {
        let column = ColumnBlocks {
            products: PairProducts::zeros(fed_back + 1, inputs),
            right: DVector::zeros(inputs),
        };
        Self {
            columns: vec![column; inputs],
            feedback: PairProducts::zeros(pair_count(fed_back), inputs),
            right: DMatrix::zeros(fed_back, inputs),
        }
    }

    /// Adds `Re conj(t_a) z_j` for an input column at one frequency (step 5); `t_0` is 1.
    fn add_right(&mut self, terms: &ColumnTerms, input: usize) {
        for (j, z) in terms.projection.iter().enumerate() {
            self.columns[input].right[j] += z.re;
            for (fed_back, t) in terms.factors[1..].iter().enumerate() {
                self.right[(fed_back, j)] += t.re * z.re + t.im * z.im;
            }
        }
    }

    /// Returns the memory needed for a condition's blocks \[bytes\].
    pub(super) fn bytes(inputs: usize, fed_back: usize) -> usize {
        let rows = inputs * (fed_back + 1) + pair_count(fed_back);
        // The products of real parts and those of imaginary parts.
        2 * std::mem::size_of::<f64>() * rows * pair_count(inputs)
    }
}

impl ColumnBlocks {
    /// Returns the entry in `G` for `M_ji` and `M_li`, without airspeed powers.
    pub(super) fn mixing_entry(&self, j: usize, l: usize) -> f64 {
        self.products.entry(0, j, l)
    }

    /// Returns the entry in `G` for `M_ji` and `K_lo`, without airspeed powers; `fed_back` is o's
    /// index among the fed-back outputs.
    pub(super) fn mixing_feedback_entry(&self, j: usize, l: usize, fed_back: usize) -> f64 {
        self.products.entry(fed_back + 1, j, l)
    }
}

/// The couplings from the previous pass, evaluated at a condition.
struct LastPass<'a> {
    /// Mixing `M_0` at the condition's airspeed, m x m.
    mixing: DMatrix<f64>,
    /// Feedback `K_0`, m x p.
    feedback: &'a DMatrix<f64>,
    /// Outputs with a column in `K`.
    fed_back: &'a [usize],
}

/// Closed-loop response `F = S H` at one frequency, in both storage orders.
struct ClosedResponse {
    /// The frequency's index in the condition.
    k: usize,
    /// `F`, column by column.
    columns: Vec<Complex<f64>>,
    /// `F`, row by row.
    rows: RowParts,
}

impl ClosedResponse {
    /// Closes the loop around the physics response at frequency `k` (step 1).
    fn new(
        condition: &WeightedCondition<'_>,
        k: usize,
        closed_loop: &mut ClosedLoop<'_>,
    ) -> Result<Self, CouplingError> {
        let mut columns = condition.physics(k).to_vec();
        if !closed_loop.close(&mut columns) {
            return Err(CouplingError::SingularLoop {
                condition: condition.id,
                omega_rad_s: condition.omega[k],
            });
        }
        let rows = RowParts::from_columns(&columns, condition.outputs());
        Ok(Self { k, columns, rows })
    }
}

/// Terms for an input column at one frequency; the memory is reused.
struct ColumnTerms {
    /// Column of `F M_0`, p values.
    coupled: Vec<Complex<f64>>,
    /// `q^2` for each output.
    squared_weights: Vec<f64>,
    /// `t`: 1, then each fed-back output's flight response.
    factors: Vec<Complex<f64>>,
    /// Column of `S R'`, p values.
    target: Vec<Complex<f64>>,
    /// `z = F^H q^2 (S R')[:,i]`, m values.
    projection: Vec<Complex<f64>>,
}

impl ColumnTerms {
    fn zeros(inputs: usize, outputs: usize, factors: usize) -> Self {
        let zero = Complex::new(0.0, 0.0);
        Self {
            coupled: vec![zero; outputs],
            squared_weights: vec![0.0; outputs],
            factors: vec![zero; factors],
            target: vec![zero; outputs],
            projection: vec![zero; inputs],
        }
    }

    /// Computes the terms for column `input` (steps 2 to 4). Returns `false`, without valid terms,
    /// if every weight is zero; the frequency then does not count in this column.
    fn set(
        &mut self,
        condition: &WeightedCondition<'_>,
        closed: &ClosedResponse,
        last: &LastPass<'_>,
        input: usize,
    ) -> bool {
        let flight = condition.flight(closed.k, input);
        // Step 2
        set_coupled(&mut self.coupled, &closed.columns, last, input);
        let counts =
            condition.squared_weights(closed.k, input, &self.coupled, &mut self.squared_weights);
        if !counts {
            return false;
        }
        // Step 3
        set_factors(&mut self.factors, flight, last.fed_back);
        // Step 4
        set_target(&mut self.target, &closed.columns, flight, last);
        set_projection(
            &mut self.projection,
            &closed.columns,
            &self.squared_weights,
            &self.target,
        );
        true
    }
}

/// Sets `coupled` to column `input` of `F M_0`.
fn set_coupled(
    coupled: &mut [Complex<f64>],
    f: &[Complex<f64>],
    last: &LastPass<'_>,
    input: usize,
) {
    coupled.fill(Complex::new(0.0, 0.0));
    let outputs = coupled.len();
    let mixing = last.mixing.column(input);
    for (column, factor) in f.chunks_exact(outputs).zip(mixing.iter()) {
        for (sum, value) in coupled.iter_mut().zip(column) {
            *sum += value * *factor;
        }
    }
}

/// Sets `t` to 1 and the fed-back outputs' flight responses (step 3).
fn set_factors(t: &mut [Complex<f64>], flight: &[Complex<f64>], fed_back: &[usize]) {
    t[0] = Complex::new(1.0, 0.0);
    for (t, &output) in t[1..].iter_mut().zip(fed_back) {
        *t = flight[output];
    }
}

/// Sets `target` to `R' + F K_0 R'` for the input column `flight` of `R'` (step 4).
fn set_target(
    target: &mut [Complex<f64>],
    f: &[Complex<f64>],
    flight: &[Complex<f64>],
    last: &LastPass<'_>,
) {
    target.copy_from_slice(flight);
    for (input, column) in f.chunks_exact(flight.len()).enumerate() {
        // Entry `input` of `K_0 R'`.
        let fed: Complex<f64> = last
            .fed_back
            .iter()
            .map(|&output| flight[output] * last.feedback[(input, output)])
            .sum();
        for (sum, value) in target.iter_mut().zip(column) {
            *sum += value * fed;
        }
    }
}

/// Sets `z` to `F^H q^2 target` (step 4).
fn set_projection(
    z: &mut [Complex<f64>],
    f: &[Complex<f64>],
    squared_weights: &[f64],
    target: &[Complex<f64>],
) {
    for (z, column) in z.iter_mut().zip(f.chunks_exact(target.len())) {
        *z = column
            .iter()
            .zip(target)
            .zip(squared_weights)
            .map(|((value, target), squared)| value.conj() * target * *squared)
            .sum();
    }
}
