//! A condition's normal equations, and how its own gains are eliminated (step 6 in `physics`,
//! M18.2).
//!
//! ```text
//! [ S   B ] [ x ]   [ g ]       x = (z, tau): parameters and delays, shared by all conditions
//! [ B^T D ] [ c ] = [ h ]       c = (a, b): ln gains of the channels in this condition
//!
//! 1  S, B, D, g, h <- sums of blocks                                  (ConditionEquations::new)
//! 2  U <- w D + I / sd_gain^2,   w = nu / (N s^2)                     (reduced)
//! 3  S' <- w S - w^2 B U^-1 B^T,   g' <- w g - w^2 B U^-1 h
//! 4  c(x) = w U^-1 (h - B^T x)                                        (ln_gains)
//! ```
//!
//! The response of a pair at a frequency has a residual `y - J x - (a_o + b_i)`: `y` is the
//! logarithm to match, and the row `J` has the parameters' derivatives and, for both channels'
//! delays, `-j omega`. A *block* holds the weighted products of `v = (derivatives, -j omega, 1,
//! y)`, summed over one third of the frequencies (`pair_blocks`).
//!
//! `sd_gain` is the prior standard deviation of the ln gains. `nu` is how many independent
//! frequencies a response counts as, `N` the number of frequencies, `s^2` the mean square misfit.

use nalgebra::{Cholesky, DMatrix, DVector, Dyn};

use gdcm_model::dataset::Pair;

use super::pair_blocks::{Block, ConditionBlocks};

/// Factors in the normal equations that are the same in all conditions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct EquationScale {
    /// `w = nu / (N s^2)`.
    pub(super) weight: f64,
    /// Prior standard deviation of the ln gains; 0: no gains.
    pub(super) gain_sd: f64,
}

/// A part of the data that can be left out, in all conditions.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum DataPart {
    Output(usize),
    Input(usize),
    /// A third of the frequency grid, counted from 0.
    Third(usize),
}

impl DataPart {
    /// Returns whether a block belongs to the part.
    pub(super) fn contains(self, pair: Pair, third: usize) -> bool {
        match self {
            Self::Output(output) => pair.output == output,
            Self::Input(input) => pair.input == input,
            Self::Third(index) => third == index,
        }
    }
}

/// Sums of blocks: a condition's normal equations, without scale and prior.
#[derive(Clone, Debug)]
pub(super) struct ConditionEquations {
    /// `S`.
    shared: DMatrix<f64>,
    /// `B`: rows by shared unknown, columns by channel.
    border: DMatrix<f64>,
    /// `D`.
    gain: DMatrix<f64>,
    /// `g`.
    shared_right: DVector<f64>,
    /// `h`.
    gain_right: DVector<f64>,
    /// `sum q^2 |y|^2`, with the weights `q`.
    y_square: f64,
}

/// Counts from which the numbers of unknowns follow. Their order: in `x` the fitted parameters,
/// output delays, input delays; in `c` the output ln gains, input ln gains.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct UnknownCounts {
    /// Count of fitted parameters.
    pub(super) parameters: usize,
    pub(super) outputs: usize,
    pub(super) inputs: usize,
}

impl UnknownCounts {
    /// Returns the channel count, outputs plus inputs.
    pub(super) fn channels(self) -> usize {
        self.outputs + self.inputs
    }

    /// Returns the count of shared unknowns: parameters plus a delay per channel.
    pub(super) fn shared(self) -> usize {
        self.parameters + self.channels()
    }
}

impl ConditionEquations {
    /// Sums a condition's blocks, without those in the part left out (step 1).
    pub(super) fn new(
        blocks: &ConditionBlocks,
        counts: UnknownCounts,
        left_out: Option<DataPart>,
    ) -> Self {
        let shared = counts.shared();
        let gains = counts.channels();
        let mut equations = Self {
            shared: DMatrix::zeros(shared, shared),
            border: DMatrix::zeros(shared, gains),
            gain: DMatrix::zeros(gains, gains),
            shared_right: DVector::zeros(shared),
            gain_right: DVector::zeros(gains),
            y_square: 0.0,
        };
        for (pair, thirds) in blocks.responses.iter() {
            for (third, block) in thirds.iter().enumerate() {
                let is_left_out = left_out.is_some_and(|part| part.contains(pair, third));
                if block.weight > 0.0 && !is_left_out {
                    equations.add(block, counts, pair);
                }
            }
        }
        equations
    }

    /// Adds the block of a pair: to the unknowns of its two channels, and to the parameters.
    fn add(&mut self, block: &Block, counts: UnknownCounts, pair: Pair) {
        let channels = [pair.output, counts.outputs + pair.input];
        let mut columns: Vec<SharedColumn> = Vec::with_capacity(counts.parameters + 2);
        for parameter in 0..counts.parameters {
            columns.push(SharedColumn {
                unknown: parameter,
                v_index: parameter,
            });
        }
        for channel in channels {
            columns.push(SharedColumn {
                unknown: counts.parameters + channel,
                v_index: block.delay(),
            });
        }
        for row in &columns {
            for column in &columns {
                self.shared[(row.unknown, column.unknown)] +=
                    block.product(row.v_index, column.v_index);
            }
            for channel in channels {
                self.border[(row.unknown, channel)] += block.product(row.v_index, block.gain());
            }
            self.shared_right[row.unknown] += block.product(row.v_index, block.y());
        }
        for row in channels {
            for column in channels {
                self.gain[(row, column)] += block.product(block.gain(), block.gain());
            }
            self.gain_right[row] += block.product(block.gain(), block.y());
        }
        self.y_square += block.product(block.y(), block.y());
    }

    /// Eliminates the condition's gains (steps 2 and 3); `None` if they are not determined.
    pub(super) fn reduced(&self, scale: EquationScale) -> Option<ReducedEquations> {
        let w = scale.weight;
        if scale.gain_sd == 0.0 {
            return Some(ReducedEquations {
                matrix: &self.shared * w,
                right: &self.shared_right * w,
                gain_factors: None,
            });
        }
        // Step 2
        let mut u = &self.gain * w;
        for channel in 0..u.nrows() {
            u[(channel, channel)] += scale.gain_sd.powi(-2);
        }
        let gain_factors = Cholesky::new(u)?;
        // Step 3: w U^-1 B^T and w U^-1 h.
        let eliminated = gain_factors.solve(&(self.border.transpose() * w));
        let eliminated_right = gain_factors.solve(&(&self.gain_right * w));
        let mut matrix = (&self.shared - &self.border * &eliminated) * w;
        symmetrise(&mut matrix);
        Some(ReducedEquations {
            matrix,
            right: (&self.shared_right - &self.border * eliminated_right) * w,
            gain_factors: Some(gain_factors),
        })
    }

    /// Returns the condition's ln gains for the shared unknowns `x` (step 4): outputs, then inputs.
    pub(super) fn ln_gains(
        &self,
        reduced: &ReducedEquations,
        scale: EquationScale,
        x: &DVector<f64>,
    ) -> DVector<f64> {
        match &reduced.gain_factors {
            Some(u) => u.solve(&((&self.gain_right - self.border.tr_mul(x)) * scale.weight)),
            None => DVector::zeros(self.gain_right.len()),
        }
    }

    /// Returns the weighted sum of squared residuals for shared unknowns `x` and the ln gains `c`;
    /// not below 0, whatever the rounding.
    pub(super) fn squared_error(&self, x: &DVector<f64>, c: &DVector<f64>) -> f64 {
        let linear = self.shared_right.dot(x) + self.gain_right.dot(c);
        let quadratic =
            (&self.shared * x).dot(x) + 2.0 * (&self.border * c).dot(x) + (&self.gain * c).dot(c);
        (self.y_square - 2.0 * linear + quadratic).max(0.0)
    }

    /// Returns the fitted parameters' normal matrix with all channels known, times `w`.
    pub(super) fn parameter_information(
        &self,
        counts: UnknownCounts,
        scale: EquationScale,
    ) -> DMatrix<f64> {
        let size = counts.parameters;
        self.shared.view((0, 0), (size, size)) * scale.weight
    }
}

/// A shared unknown on which a response depends.
struct SharedColumn {
    /// Index among the shared unknowns.
    unknown: usize,
    /// Index of its derivative in the block's `v`.
    v_index: usize,
}

/// A condition's scaled normal equations for the shared unknowns.
#[derive(Clone, Debug)]
pub(super) struct ReducedEquations {
    /// `S'`.
    pub(super) matrix: DMatrix<f64>,
    /// `g'`.
    pub(super) right: DVector<f64>,
    /// Cholesky factors of `U`; `None` without gains.
    gain_factors: Option<Cholesky<f64, Dyn>>,
}

/// Removes rounding errors that make a symmetric matrix slightly unsymmetric.
pub(super) fn symmetrise(matrix: &mut DMatrix<f64>) {
    let transposed = matrix.transpose();
    *matrix += transposed;
    *matrix *= 0.5;
}
