//! The normal equations of one pass, put together from small blocks, and their solution (M16.2).
//!
//! In input column i of the equations every unknown has the column `F[:,j]` times a number: `v^k` for `M_ji`, `R'_oi` for `K_jo`. With
//! `t = (1, R'_oi ...)` and `P = F^H q^2 F`, m x m, the blocks are
//!
//! ```text
//! G[(a, j), (b, l)] = Re conj(t_a) t_b P_jl,    b[(a, j)] = Re conj(t_a) z_j,    z = F^H q^2 (S R')[:,i],
//! ```
//!
//! summed over the frequencies of a condition; `v` is the same at all of them and comes in afterwards. No row of the design is kept.

use nalgebra::{Complex, DMatrix, DVector};

use super::{ClosedLoop, CouplingError, CouplingMatrices, Unknown, WeightedCondition};

/// The couplings of the last pass at one condition.
struct LastPass<'a> {
    /// `M(V)`, m x m.
    mixing: DMatrix<f64>,
    /// `K`, m x p.
    feedback: &'a DMatrix<f64>,
    /// The outputs of which `K` has a column.
    fed_back: &'a [usize],
}

/// Normal matrix and right side of one input column of one condition, in the unknowns `(a, j)`: number `a` of `t`, input `j`.
#[derive(Clone)]
struct ColumnBlocks {
    /// For each `a <= b` the m x m block, row by row.
    gram: Vec<f64>,
    /// For each `a` the m values.
    right: Vec<f64>,
}

/// What one condition adds to the normal equations.
pub(super) struct ConditionBlocks {
    inputs: usize,
    fed_back: usize,
    columns: Vec<ColumnBlocks>,
}

/// Room for what stands at one frequency.
struct Scratch {
    f: Vec<Complex<f64>>,
    coupled: Vec<Complex<f64>>,
    target: Vec<Complex<f64>>,
    squared: Vec<f64>,
    p_re: Vec<f64>,
    p_im: Vec<f64>,
    z: Vec<Complex<f64>>,
    t: Vec<Complex<f64>>,
}

impl ConditionBlocks {
    /// The blocks of a condition, where the last pass left these couplings; `fed_back` are the outputs of which `K` has a column.
    ///
    /// # Errors
    /// [`CouplingError::SingularLoop`] where `I - K H` has no inverse at a frequency that counts.
    pub(super) fn of(
        condition: &WeightedCondition<'_>,
        last: &CouplingMatrices,
        fed_back: &[usize],
    ) -> Result<Self, CouplingError> {
        let last = LastPass { mixing: last.mixing(condition.airspeed_kt), feedback: last.feedback(), fed_back };
        let (inputs, outputs) = last.feedback.shape();
        let mut blocks = Self::zeros(inputs, fed_back.len());
        let mut scratch = Scratch::new(inputs, outputs, fed_back.len() + 1);
        let mut closed_loop = ClosedLoop::new(last.feedback);
        for k in (0..condition.omega.len()).filter(|&k| condition.counts_at(k)) {
            scratch.f.copy_from_slice(condition.physics(k));
            if !closed_loop.close(&mut scratch.f) {
                return Err(CouplingError::SingularLoop { condition: condition.id, omega_rad_s: condition.omega[k] });
            }
            for input in 0..inputs {
                scratch.mix(&last, input, outputs);
                if condition.squared_weights((k, input), &scratch.coupled, &mut scratch.squared) {
                    scratch.weigh(condition.flight(k, input), &last, outputs);
                    blocks.columns[input].add(&scratch, inputs);
                }
            }
        }
        Ok(blocks)
    }

    fn zeros(inputs: usize, fed_back: usize) -> Self {
        let numbers = fed_back + 1;
        let column = ColumnBlocks {
            gram: vec![0.0; numbers * (numbers + 1) / 2 * inputs * inputs],
            right: vec![0.0; numbers * inputs],
        };
        Self { inputs, fed_back, columns: vec![column; inputs] }
    }
}

impl Scratch {
    fn new(inputs: usize, outputs: usize, numbers: usize) -> Self {
        let zeros = |count: usize| vec![Complex::new(0.0, 0.0); count];
        Self {
            f: zeros(inputs * outputs),
            coupled: zeros(outputs),
            target: zeros(outputs),
            squared: vec![0.0; outputs],
            p_re: vec![0.0; inputs * inputs],
            p_im: vec![0.0; inputs * inputs],
            z: zeros(inputs),
            t: zeros(numbers),
        }
    }

    /// The input column of `H_c = F M`.
    fn mix(&mut self, last: &LastPass<'_>, input: usize, outputs: usize) {
        self.coupled.fill(Complex::new(0.0, 0.0));
        for (of_input, factor) in self.f.chunks_exact(outputs).zip(last.mixing.column(input).iter()) {
            self.coupled.iter_mut().zip(of_input).for_each(|(sum, value)| *sum += value * *factor);
        }
    }

    /// `t`, `P` and `z` of an input column of `R'`. `S R' = R' + F K R'`, for `S = I + F K`.
    fn weigh(&mut self, flight: &[Complex<f64>], last: &LastPass<'_>, outputs: usize) {
        self.t[0] = Complex::new(1.0, 0.0);
        self.t[1..].iter_mut().zip(last.fed_back).for_each(|(number, &output)| *number = flight[output]);
        self.target.copy_from_slice(flight);
        for (row, of_input) in self.f.chunks_exact(outputs).enumerate() {
            let fed: Complex<f64> =
                last.fed_back.iter().map(|&output| flight[output] * last.feedback[(row, output)]).sum();
            self.target.iter_mut().zip(of_input).for_each(|(sum, value)| *sum += value * fed);
        }
        let inputs = self.z.len();
        for (j, left) in self.f.chunks_exact(outputs).enumerate() {
            let product = |right: &[Complex<f64>]| -> Complex<f64> {
                let terms = left.iter().zip(right).zip(&self.squared);
                terms.map(|((left, right), squared)| left.conj() * right * *squared).sum()
            };
            self.z[j] = product(&self.target);
            for (l, right) in self.f.chunks_exact(outputs).enumerate().skip(j) {
                let entry = product(right);
                (self.p_re[j * inputs + l], self.p_im[j * inputs + l]) = (entry.re, entry.im);
                (self.p_re[l * inputs + j], self.p_im[l * inputs + j]) = (entry.re, -entry.im);
            }
        }
    }
}

impl ColumnBlocks {
    /// Adds what stands at one frequency.
    fn add(&mut self, scratch: &Scratch, inputs: usize) {
        let mut blocks = self.gram.chunks_exact_mut(inputs * inputs);
        for (a, left) in scratch.t.iter().enumerate() {
            for (right, block) in scratch.t[a..].iter().zip(&mut blocks) {
                let Complex { re, im } = left.conj() * right;
                let entries = block.iter_mut().zip(&scratch.p_re).zip(&scratch.p_im);
                entries.for_each(|((sum, p_re), p_im)| *sum += re * p_re - im * p_im);
            }
        }
        for (sums, left) in self.right.chunks_exact_mut(inputs).zip(&scratch.t) {
            sums.iter_mut().zip(&scratch.z).for_each(|(sum, z)| *sum += left.re * z.re + left.im * z.im);
        }
    }

    /// `G[(a, j), (b, l)]`, `numbers` of `t` and as many `inputs`.
    fn entry(&self, (a, j): (usize, usize), (b, l): (usize, usize), numbers: usize, inputs: usize) -> f64 {
        let (upper, lower, row, column) = if a <= b { (a, b, j, l) } else { (b, a, l, j) };
        // Of each number before `upper` there are as many blocks as numbers from it on.
        let before = upper * numbers - upper * upper.saturating_sub(1) / 2;
        self.gram[(before + lower - upper) * inputs * inputs + row * inputs + column]
    }
}

/// `(G + rho diag G) theta = b + rho diag G theta_0` of one pass.
pub(super) struct NormalEquations {
    /// `G`.
    gram: DMatrix<f64>,
    /// `b`.
    right: DVector<f64>,
}

/// The optimum of one pass.
pub(super) struct PassOptimum {
    /// `theta`, one for each unknown.
    pub(super) coefficients: DVector<f64>,
    /// Largest residual of the normal equations over the largest right side, each divided by the root of its diagonal entry.
    pub(super) residual: f64,
    /// The unknowns (by place) of which the responses say nothing: they stay as without couplings.
    pub(super) undetermined: Vec<usize>,
}

impl NormalEquations {
    /// Nothing added yet.
    pub(super) fn zeros(unknowns: usize) -> Self {
        Self { gram: DMatrix::zeros(unknowns, unknowns), right: DVector::zeros(unknowns) }
    }

    /// Adds a condition of scaled airspeed `v`.
    pub(super) fn add(&mut self, unknowns: &[Unknown], blocks: &ConditionBlocks, fed_back: &[usize], v: f64) {
        let (inputs, numbers) = (blocks.inputs, blocks.fed_back + 1);
        for (input, column) in blocks.columns.iter().enumerate() {
            let local: Vec<(usize, (usize, usize), f64)> = unknowns
                .iter()
                .enumerate()
                .filter_map(|(place, unknown)| match *unknown {
                    Unknown::Mixing { to, from, power } => {
                        (from == input).then(|| (place, (0, to), v.powi(power as i32)))
                    }
                    Unknown::Feedback { input: to, output } => {
                        let number = fed_back.iter().position(|&of| of == output)?;
                        Some((place, (number + 1, to), 1.0))
                    }
                })
                .collect();
            for &(row, left, factor) in &local {
                self.right[row] += factor * column.right[left.0 * inputs + left.1];
                for &(other, right, by) in &local {
                    self.gram[(row, other)] += factor * by * column.entry(left, right, numbers, inputs);
                }
            }
        }
    }

    /// The optimum, drawn to no couplings by `ridge`.
    ///
    /// Rows and columns are divided by the root of the diagonal first: the entries of `K` differ in unit.
    ///
    /// # Errors
    /// [`CouplingError::SingularNormalMatrix`] where there are no Cholesky factors.
    pub(super) fn solve(&self, unknowns: &[Unknown], ridge: f64) -> Result<PassOptimum, CouplingError> {
        let singular = || CouplingError::SingularNormalMatrix { unknowns: unknowns.len() };
        let count = unknowns.len();
        let uncoupled = DVector::from_iterator(count, unknowns.iter().map(|unknown| unknown.uncoupled()));
        let is_determined = |place: usize| self.gram[(place, place)] > 0.0;
        let root = |place: usize| if is_determined(place) { self.gram[(place, place)].sqrt().recip() } else { 1.0 };
        let scale = DVector::from_fn(count, |place, _| root(place));
        let draw = |place: usize| if is_determined(place) { ridge } else { 1.0 };
        let mut matrix =
            DMatrix::from_fn(count, count, |row, column| scale[row] * self.gram[(row, column)] * scale[column]);
        (0..count).for_each(|place| matrix[(place, place)] += draw(place));
        let right =
            DVector::from_fn(count, |row, _| scale[row] * self.right[row] + draw(row) * uncoupled[row] / scale[row]);
        let scaled = matrix.clone().cholesky().ok_or_else(singular)?.solve(&right);
        let residual = (&matrix * &scaled - &right).amax() / right.amax();
        let coefficients = scaled.component_mul(&scale);
        if !residual.is_finite() || !coefficients.iter().all(|of| of.is_finite()) {
            return Err(singular());
        }
        let undetermined = (0..count).filter(|&place| !is_determined(place)).collect();
        Ok(PassOptimum { coefficients, residual, undetermined })
    }
}
