//! Connects a model in series with its channels' delays or lead filters, by state-space matrices
//! (M10). A delay has a finite order here: in continuous time its approximation (`pade`), in
//! discrete time a chain of samples (`channel_model`).
//!
//! ```text
//! first system (A1, B1, C1, D1), its outputs drive the second (A2, B2, C2, D2):
//! A = [ A1     0  ]    B = [ B1    ]    C = [ D2 C1  C2 ]    D = D2 D1
//!     [ B2 C1  A2 ]        [ B2 D1 ]
//! ```

use nalgebra::DMatrix;

use gdcm_model::dataset::StateSpace;

use super::channel_correction::ChannelCorrection;
use super::channel_model::ChannelModel;
use super::channels::Channels;

/// The matrices A, B, C and D, in continuous or discrete time.
pub(super) struct Matrices {
    pub(super) a: DMatrix<f64>,
    pub(super) b: DMatrix<f64>,
    pub(super) c: DMatrix<f64>,
    pub(super) d: DMatrix<f64>,
}

impl Matrices {
    /// Returns the model's matrices with the channel gains, without delays.
    pub(super) fn with_gains(model: &StateSpace, correction: &ChannelCorrection) -> Self {
        let mut matrices = Self {
            a: model.a().clone(),
            b: model.b().clone(),
            c: model.c().clone(),
            d: model.d().clone(),
        };
        for (input, &gain) in correction.input_gains.iter().enumerate() {
            matrices.b.column_mut(input).scale_mut(gain);
            matrices.d.column_mut(input).scale_mut(gain);
        }
        for (output, &gain) in correction.output_gains.iter().enumerate() {
            matrices.c.row_mut(output).scale_mut(gain);
            matrices.d.row_mut(output).scale_mut(gain);
        }
        matrices
    }

    /// Combines parallel channels into a block-diagonal system.
    fn block_diagonal(channels: &[ChannelModel]) -> Self {
        let states = channels.iter().map(ChannelModel::order).sum();
        let count = channels.len();
        let mut matrices = Self {
            a: DMatrix::zeros(states, states),
            b: DMatrix::zeros(states, count),
            c: DMatrix::zeros(count, states),
            d: DMatrix::zeros(count, count),
        };
        let mut first = 0;
        for (channel, model) in channels.iter().enumerate() {
            let order = model.order();
            matrices
                .a
                .view_mut((first, first), (order, order))
                .copy_from(&model.a);
            matrices
                .b
                .view_mut((first, channel), (order, 1))
                .copy_from(&model.b);
            matrices
                .c
                .view_mut((channel, first), (1, order))
                .copy_from(&model.c);
            matrices.d[(channel, channel)] = model.d;
            first += order;
        }
        matrices
    }

    /// Connects the input channels before this system, and the output channels after it.
    pub(super) fn between(&self, channels: &Channels<ChannelModel>) -> Self {
        Self::block_diagonal(&channels.inputs)
            .then(self)
            .then(&Self::block_diagonal(&channels.outputs))
    }

    /// Connects two systems in series: this system's outputs drive `next`. This system's states
    /// come first.
    fn then(&self, next: &Self) -> Self {
        let first = self.a.nrows();
        let second = next.a.nrows();
        let states = first + second;
        let mut a = DMatrix::zeros(states, states);
        a.view_mut((0, 0), (first, first)).copy_from(&self.a);
        a.view_mut((first, 0), (second, first))
            .copy_from(&(&next.b * &self.c));
        a.view_mut((first, first), (second, second))
            .copy_from(&next.a);
        let mut b = DMatrix::zeros(states, self.b.ncols());
        b.rows_mut(0, first).copy_from(&self.b);
        b.rows_mut(first, second).copy_from(&(&next.b * &self.d));
        let mut c = DMatrix::zeros(next.c.nrows(), states);
        c.columns_mut(0, first).copy_from(&(&next.d * &self.c));
        c.columns_mut(first, second).copy_from(&next.c);
        Self {
            a,
            b,
            c,
            d: &next.d * &self.d,
        }
    }
}
