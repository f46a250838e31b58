//! A condition's normal equations, and how its own gains are eliminated (step 6 in `physics`,
//! M18.2).
//!
//! ```text
//! [ S   B ] [ x ]   [ g ]       x = (z, tau): parameters and delays, shared by all conditions
//! [ B'  W ] [ c ] = [ h ]       c = (a, b): ln gains of the channels in this condition
//!
//! 1  S, B, W, g, h <- sums of blocks
//! 2  U <- w W + I / sd_gain^2,   w = nu / (N s^2)
//! 3  S' <- w S - w^2 B U^-1 B',   g' <- w g - w^2 B U^-1 h
//! 4  c(x) = w U^-1 (h - B' x)
//! ```
//!
//! A *block* holds the weighted products of a response's design matrix `J` and target `y` in one
//! third of the frequencies (`pair_blocks`). Shared unknowns: the fitted parameters, the output
//! delays, the input delays. Own unknowns: the output ln gains, then the input ln gains; `sd_gain`
//! is their prior standard deviation. `nu` is how many independent frequencies a response counts
//! as, `N` the number of frequencies, `s^2` the mean square misfit (step 7 in `physics`).

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

/// A part of the data that can be left out.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Part {
    Output(usize),
    Input(usize),
    /// A third of the frequency grid, counted from 0.
    Third(usize),
}

impl Part {
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
    /// `B`.
    border: DMatrix<f64>,
    /// `W`.
    own: DMatrix<f64>,
    /// `g`.
    shared_right: DVector<f64>,
    /// `h`.
    own_right: DVector<f64>,
    /// `sum q^2 |y|^2`.
    target_square: f64,
}

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
        left_out: Option<Part>,
    ) -> Self {
        let shared = counts.shared();
        let own = counts.channels();
        let mut equations = Self {
            shared: DMatrix::zeros(shared, shared),
            border: DMatrix::zeros(shared, own),
            own: DMatrix::zeros(own, own),
            shared_right: DVector::zeros(shared),
            own_right: DVector::zeros(own),
            target_square: 0.0,
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

    /// Adds a block. Its design matrix row has the parameters' derivatives, -j omega for both
    /// channels' delays, and 1 for their gains.
    fn add(&mut self, block: &Block, counts: UnknownCounts, pair: Pair) {
        let channels = [pair.output, counts.outputs + pair.input];
        let mut columns: Vec<SharedColumn> = Vec::with_capacity(counts.parameters + 2);
        for parameter in 0..counts.parameters {
            columns.push(SharedColumn {
                unknown: parameter,
                entry: parameter,
            });
        }
        for channel in channels {
            columns.push(SharedColumn {
                unknown: counts.parameters + channel,
                entry: block.delay(),
            });
        }
        for row in &columns {
            for column in &columns {
                self.shared[(row.unknown, column.unknown)] +=
                    block.product(row.entry, column.entry);
            }
            for channel in channels {
                self.border[(row.unknown, channel)] += block.product(row.entry, block.gain());
            }
            self.shared_right[row.unknown] += block.product(row.entry, block.target());
        }
        for row in channels {
            for column in channels {
                self.own[(row, column)] += block.product(block.gain(), block.gain());
            }
            self.own_right[row] += block.product(block.gain(), block.target());
        }
        self.target_square += block.product(block.target(), block.target());
    }

    /// Eliminates the condition's gains (steps 2 and 3); `None` if they are not determined.
    pub(super) fn reduced(&self, scale: EquationScale) -> Option<ReducedEquations> {
        let w = scale.weight;
        if scale.gain_sd == 0.0 {
            return Some(ReducedEquations {
                matrix: &self.shared * w,
                right: &self.shared_right * w,
                own: None,
            });
        }
        // Step 2
        let mut own = &self.own * w;
        for channel in 0..own.nrows() {
            own[(channel, channel)] += scale.gain_sd.powi(-2);
        }
        let own = Cholesky::new(own)?;
        // Step 3: w U^-1 B' and w U^-1 h.
        let eliminated = own.solve(&(self.border.transpose() * w));
        let eliminated_right = own.solve(&(&self.own_right * w));
        let mut matrix = (&self.shared - &self.border * &eliminated) * w;
        symmetrise(&mut matrix);
        Some(ReducedEquations {
            matrix,
            right: (&self.shared_right - &self.border * eliminated_right) * w,
            own: Some(own),
        })
    }

    /// Returns the condition's ln gains for the shared unknowns `x` (step 4): outputs, then inputs.
    pub(super) fn ln_gains(
        &self,
        reduced: &ReducedEquations,
        scale: EquationScale,
        x: &DVector<f64>,
    ) -> DVector<f64> {
        match &reduced.own {
            Some(own) => own.solve(&((&self.own_right - self.border.tr_mul(x)) * scale.weight)),
            None => DVector::zeros(self.own_right.len()),
        }
    }

    /// Returns `sum q^2 |y - J x|^2` for shared unknowns `x` and the ln gains `gains`.
    pub(super) fn squared_error(&self, x: &DVector<f64>, gains: &DVector<f64>) -> f64 {
        let linear = self.shared_right.dot(x) + self.own_right.dot(gains);
        let quadratic = (&self.shared * x).dot(x)
            + 2.0 * (&self.border * gains).dot(x)
            + (&self.own * gains).dot(gains);
        (self.target_square - 2.0 * linear + quadratic).max(0.0)
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

/// A column in a block's design matrix.
struct SharedColumn {
    /// Index among the shared unknowns.
    unknown: usize,
    /// Index of the entry in the block's `v`.
    entry: usize,
}

/// A condition's scaled normal equations for the shared unknowns.
#[derive(Clone, Debug)]
pub(super) struct ReducedEquations {
    /// `S'`.
    pub(super) matrix: DMatrix<f64>,
    /// `g'`.
    pub(super) right: DVector<f64>,
    /// Cholesky factors of `U`; `None` without gains.
    own: Option<Cholesky<f64, Dyn>>,
}

/// Removes rounding errors that make a symmetric matrix slightly unsymmetric.
pub(super) fn symmetrise(matrix: &mut DMatrix<f64>) {
    let transposed = matrix.transpose();
    *matrix += transposed;
    *matrix *= 0.5;
}
