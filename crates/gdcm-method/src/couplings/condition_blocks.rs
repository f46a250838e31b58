//! A condition's contribution to the normal equations in one pass, assembled from small blocks
//! (M16.2).
//!
//! In input column i, every unknown has the column `F[:,j]` times a factor: `v^k` for `M_ji`,
//! `R'_oi` for `K_jo`. With `t = (1, R'_oi ...)` and `P = F^H q^2 F`, m x m, the blocks are
//!
//! ```text
//! G[(a, j), (b, l)] = Re conj(t_a) t_b P_jl,
//! b[(a, j)] = Re conj(t_a) z_j,    z = F^H q^2 (S R')[:,i],
//! ```
//!
//! summed over the frequencies. Rows of the design matrix are not stored. The airspeed `v` is the
//! same at all frequencies of a condition, and is applied in `normal_equations`.

use nalgebra::{Complex, DMatrix, DVector};

use gdcm_model::progress::{Cancelled, Progress};

use super::closed_loop::ClosedLoop;
use super::coupling_matrices::CouplingMatrices;
use super::error::CouplingError;
use super::pair_products::{CHUNK, PairProducts, ProductChunk, RowParts, pair_count};
use super::weighted_condition::WeightedCondition;

/// The couplings of the previous pass, evaluated at a condition.
struct LastPass<'a> {
    /// Mixing `M(V)`, m x m.
    mixing: DMatrix<f64>,
    /// Feedback `K`, m x p.
    feedback: &'a DMatrix<f64>,
    /// Outputs with a column in `K`.
    fed_back: &'a [usize],
}

/// A condition's contribution to the normal equations.
pub(super) struct ConditionBlocks {
    /// Blocks that involve unknowns of M, for each input column.
    pub(super) columns: Vec<ColumnBlocks>,
    /// Products of two unknowns of K, summed over the input columns.
    pub(super) feedback: PairProducts,
    /// Right-hand side for the unknowns of K: one row per fed-back output, one column per input.
    pub(super) right: DMatrix<f64>,
}

/// Products of the unknowns of M in one input column with one another and with the unknowns of K.
#[derive(Clone)]
pub(super) struct ColumnBlocks {
    /// One row for each product `t_0 t_b`, where `t_0 = 1`.
    pub(super) products: PairProducts,
    pub(super) right: DVector<f64>,
}

/// Work memory for one frequency.
struct Scratch {
    /// One column of `H_c = F M`.
    coupled: Vec<Complex<f64>>,
    /// One column of `S R'`.
    target: Vec<Complex<f64>>,
    /// `q^2` for each output.
    squared_weights: Vec<f64>,
    z: Vec<Complex<f64>>,
    t: Vec<Complex<f64>>,
}

/// Closed-loop response `F = S H` at one frequency.
struct ClosedResponse {
    /// Index of the frequency.
    k: usize,
    /// `F`, column by column.
    f: Vec<Complex<f64>>,
    rows: RowParts,
}

impl ConditionBlocks {
    /// Computes the blocks of a condition for the couplings `last` of the previous pass; `fed_back`
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
        let mut scratch = Scratch::new(inputs, outputs, factors);
        let mut chunk = ProductChunk::new(inputs, factors);
        let mut closed_loop = ClosedLoop::new(last.feedback);
        let counting: Vec<usize> = (0..condition.omega.len())
            .filter(|&k| condition.counts_at(k))
            .collect();
        for frequencies in counting.chunks(CHUNK) {
            if progress.cancelled() {
                return Err(CouplingError::Cancelled(Cancelled));
            }
            let mut closed = Vec::with_capacity(frequencies.len());
            for &k in frequencies {
                closed.push(ClosedResponse::new(condition, k, &mut closed_loop)?);
            }
            for input in 0..inputs {
                chunk.clear();
                for response in &closed {
                    scratch.mix(&response.f, &last, input);
                    if scratch.weigh(condition, response.k, input) {
                        scratch.project(&response.f, condition.flight(response.k, input), &last);
                        chunk.push(&scratch.t, &response.rows, &scratch.squared_weights);
                        blocks.add_right(&scratch, input);
                    }
                }
                blocks.columns[input].products.add_chunk(&chunk, 0);
                blocks.feedback.add_chunk(&chunk, factors);
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

    /// Adds the right-hand sides of an input column at one frequency.
    fn add_right(&mut self, scratch: &Scratch, input: usize) {
        for (j, z) in scratch.z.iter().enumerate() {
            self.columns[input].right[j] += z.re;
            for (fed_back, t) in scratch.t[1..].iter().enumerate() {
                self.right[(fed_back, j)] += t.re * z.re + t.im * z.im;
            }
        }
    }

    /// Returns the memory needed for the blocks of a condition \[bytes\].
    pub(super) fn bytes(inputs: usize, fed_back: usize) -> usize {
        let rows = inputs * (fed_back + 1) + pair_count(fed_back);
        2 * std::mem::size_of::<f64>() * rows * pair_count(inputs)
    }
}

impl ClosedResponse {
    fn new(
        condition: &WeightedCondition<'_>,
        k: usize,
        closed_loop: &mut ClosedLoop<'_>,
    ) -> Result<Self, CouplingError> {
        let mut f = condition.physics(k).to_vec();
        if !closed_loop.close(&mut f) {
            return Err(CouplingError::SingularLoop {
                condition: condition.id,
                omega_rad_s: condition.omega[k],
            });
        }
        let inputs = condition.inputs();
        let outputs = condition.outputs();
        let mut re = Vec::with_capacity(f.len());
        let mut im = Vec::with_capacity(f.len());
        for output in 0..outputs {
            for input in 0..inputs {
                let value = f[input * outputs + output];
                re.push(value.re);
                im.push(value.im);
            }
        }
        Ok(Self {
            k,
            f,
            rows: RowParts { re, im },
        })
    }
}

impl Scratch {
    fn new(inputs: usize, outputs: usize, factors: usize) -> Self {
        let zero = Complex::new(0.0, 0.0);
        Self {
            coupled: vec![zero; outputs],
            target: vec![zero; outputs],
            squared_weights: vec![0.0; outputs],
            z: vec![zero; inputs],
            t: vec![zero; factors],
        }
    }

    /// Computes column `input` of `H_c = F M`.
    fn mix(&mut self, f: &[Complex<f64>], last: &LastPass<'_>, input: usize) {
        self.coupled.fill(Complex::new(0.0, 0.0));
        for (column, factor) in f
            .chunks_exact(self.coupled.len())
            .zip(last.mixing.column(input).iter())
        {
            for (sum, value) in self.coupled.iter_mut().zip(column) {
                *sum += value * *factor;
            }
        }
    }

    /// Computes `q^2` in column `input`; returns `false` if every weight is zero.
    fn weigh(&mut self, condition: &WeightedCondition<'_>, k: usize, input: usize) -> bool {
        condition.squared_weights(k, input, &self.coupled, &mut self.squared_weights)
    }

    /// Computes `t` and `z` for the column `flight` of `R'`. Since `S = I + F K`, the product
    /// `S R'` is `R' + F K R'`.
    fn project(&mut self, f: &[Complex<f64>], flight: &[Complex<f64>], last: &LastPass<'_>) {
        self.t[0] = Complex::new(1.0, 0.0);
        for (t, &output) in self.t[1..].iter_mut().zip(last.fed_back) {
            *t = flight[output];
        }
        self.target.copy_from_slice(flight);
        let outputs = flight.len();
        for (row, column) in f.chunks_exact(outputs).enumerate() {
            let fed: Complex<f64> = last
                .fed_back
                .iter()
                .map(|&output| flight[output] * last.feedback[(row, output)])
                .sum();
            for (sum, value) in self.target.iter_mut().zip(column) {
                *sum += value * fed;
            }
        }
        for (z, column) in self.z.iter_mut().zip(f.chunks_exact(outputs)) {
            *z = column
                .iter()
                .zip(&self.target)
                .zip(&self.squared_weights)
                .map(|((value, target), squared)| value.conj() * target * *squared)
                .sum();
        }
    }
}
