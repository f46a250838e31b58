//! A segment's spectral lines, whitened by the noise covariance.
//!
//! U and Y are the spectra of the inputs and the outputs, and W makes the noise at a line white,
//! with unit variance in real and imaginary part (`noise_covariance`). A *hat* describes missing
//! samples (`gap_hat`); tau, c0 and c1 are a segment's transient, step and drift (`cost`).

use nalgebra::{Complex, DMatrix};

use gdcm_model::dataset::channel::ChannelSide;

use super::noise_covariance::NoiseCovariance;
use crate::spectra::gap_hat::GapHat;
use crate::spectra::spectrum::Spectrum;

/// A segment's whitened spectral lines.
#[derive(Clone, Debug)]
pub(crate) struct SpectralLines {
    /// Record index, from 0.
    pub(crate) record: usize,
    /// Frequencies \[rad/s\].
    pub(crate) omega: Vec<f64>,
    /// `U`, inputs x lines.
    pub(crate) inputs: DMatrix<Complex<f64>>,
    /// `W Y`, outputs x lines.
    pub(crate) outputs: DMatrix<Complex<f64>>,
    /// `W` at each line, outputs x outputs, lower triangular.
    pub(crate) weights: Vec<DMatrix<Complex<f64>>>,
    /// Factor in `weights` and `outputs`, 1 by default: 1/sqrt(noise factor of this record). Read
    /// where records share noise or sums and the weights are needed without it:
    /// `normal_equations`, `nuisance_elimination`, `residual_noise` and `flight_information`.
    pub(crate) scale: f64,
    /// The hats that describe the segment's missing samples.
    pub(crate) hats: Vec<GapHat>,
}

impl SpectralLines {
    /// Whitens a spectrum in scaled units with the noise covariance.
    ///
    /// Returns `None` if the covariance is not positive definite at a line.
    pub(crate) fn new(spectrum: &Spectrum, noise: &NoiseCovariance) -> Option<Self> {
        let weights = spectrum
            .omega
            .iter()
            .map(|&omega| noise.weight(omega))
            .collect::<Option<Vec<_>>>()?;
        Some(Self::weighted(spectrum, weights))
    }

    /// Whitens a spectrum with given lower triangular weights.
    pub(crate) fn weighted(spectrum: &Spectrum, weights: Vec<DMatrix<Complex<f64>>>) -> Self {
        let mut whitened = DMatrix::zeros(spectrum.outputs.nrows(), spectrum.outputs.ncols());
        for (k, weight) in weights.iter().enumerate() {
            whiten(weight, spectrum.outputs.column(k).as_slice(), |o, value| {
                whitened[(o, k)] = value
            });
        }
        Self {
            record: spectrum.record,
            omega: spectrum.omega.clone(),
            inputs: spectrum.inputs.clone(),
            outputs: whitened,
            weights,
            scale: 1.0,
            hats: spectrum.hats.clone(),
        }
    }

    /// Returns the same lines with the noise power multiplied by `factor`.
    pub(crate) fn with_noise(&self, factor: f64) -> Self {
        let share = 1.0 / factor.sqrt();
        let weights = self.weights.iter().map(|weight| weight.scale(share));
        Self {
            outputs: self.outputs.scale(share),
            weights: weights.collect(),
            scale: self.scale * share,
            ..self.clone()
        }
    }

    /// Returns the degrees of freedom at this model order: the real values in the lines less the
    /// unknowns tau, c0 and c1.
    ///
    /// The hats are not subtracted: they are few, because the preparation cuts a record at its gaps
    /// before they reach a tenth of the real values.
    pub(crate) fn freedom(&self, order: usize) -> usize {
        let outputs = self.outputs.nrows();
        (2 * outputs * self.omega.len()).saturating_sub(order + 2 * outputs)
    }

    /// Returns `U` with the inputs' missing samples completed, inputs x lines.
    pub(crate) fn completed_inputs(&self, hat_values: &[f64]) -> DMatrix<Complex<f64>> {
        let mut inputs = self.inputs.clone();
        for (hat, value) in self.hats.iter().zip(hat_values) {
            if hat.side == ChannelSide::Input {
                let mut row = inputs.row_mut(hat.channel);
                for (input, line) in row.iter_mut().zip(&hat.lines) {
                    *input += line * *value;
                }
            }
        }
        inputs
    }
}

/// Computes `W x` for a lower triangular `W` and passes its entries to `take` in turn.
pub(crate) fn whiten(
    weight: &DMatrix<Complex<f64>>,
    x: &[Complex<f64>],
    mut take: impl FnMut(usize, Complex<f64>),
) {
    for o in 0..x.len() {
        let mut sum = Complex::default();
        for (column, value) in x.iter().enumerate().take(o + 1) {
            sum += value * weight[(o, column)];
        }
        take(o, sum);
    }
}
