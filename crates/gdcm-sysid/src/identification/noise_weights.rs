//! The weights of the lines: noise measured without a model, then from a model's residuals, with a
//! factor for each record (M14.4, M14.20).

use super::prepared_data::PreparedData;
use crate::diagnostics::record_fits::fits_of_records;
use crate::likelihood::cost::{Likelihood, SpectralLines};
use crate::likelihood::descent::Fit;
use crate::likelihood::residual_noise::residual_noise;

/// Maximum ratio of the largest to the smallest cost per degree of freedom at which records keep
/// their weights.
const ALIKE: f64 = 1.5;

/// The cost with weights from a noise covariance.
#[derive(Clone)]
pub(crate) struct NoiseWeights<'a> {
    /// The cost over the fitted records.
    pub(crate) likelihood: Likelihood<'a>,
    /// The same with equal factors for all records.
    pub(crate) without_factors: Likelihood<'a>,
    /// Ratio of the largest to the smallest noise power of records, if their factors differ.
    pub(crate) ratio: Option<f64>,
}

impl<'a> NoiseWeights<'a> {
    /// Uses the noise that was measured without a model.
    pub(crate) fn measured(data: &PreparedData<'a>) -> Self {
        Self {
            likelihood: data.likelihood.clone(),
            without_factors: data.likelihood.clone(),
            ratio: None,
        }
    }

    /// Computes the weights from the residuals of a model; `None` if the noise cannot be computed.
    pub(crate) fn updated(&self, data: &PreparedData<'a>, fit: &Fit) -> Option<Self> {
        let noise = residual_noise(&self.likelihood, &fit.model, &fit.parts)?;
        let mut segments = Vec::with_capacity(data.spectra.len());
        for spectrum in &data.spectra {
            segments.push(SpectralLines::new(spectrum, &noise)?);
        }
        let without_factors = Likelihood::new(segments, self.likelihood.executor);
        Self::with_factors(without_factors, fit)
    }

    /// Multiplies the noise power of each record by its cost per degree of freedom over the
    /// geometric mean of all, if these differ by more than 1.5.
    fn with_factors(without_factors: Likelihood<'a>, fit: &Fit) -> Option<Self> {
        let parts = without_factors.parts(&fit.model)?;
        let fits = fits_of_records(&without_factors, &fit.model, &parts, false);
        let costs: Vec<f64> = fits.iter().map(|record| record.cost).collect();
        let least = costs.iter().copied().fold(f64::INFINITY, f64::min);
        let greatest = costs.iter().copied().fold(0.0, f64::max);
        let are_unlike = least > 0.0 && greatest > ALIKE * least;
        if !are_unlike {
            return Some(Self {
                likelihood: without_factors.clone(),
                without_factors,
                ratio: None,
            });
        }
        let log_mean = costs.iter().map(|cost| cost.ln()).sum::<f64>() / costs.len() as f64;
        let mean = log_mean.exp();
        let mut segments = Vec::with_capacity(without_factors.segments.len());
        for segment in &without_factors.segments {
            let own = fits.iter().find(|record| record.record == segment.record);
            segments.push(match own {
                Some(record) => segment.with_noise(record.cost / mean),
                None => segment.clone(),
            });
        }
        Some(Self {
            likelihood: Likelihood::new(segments, without_factors.executor),
            without_factors,
            ratio: Some(greatest / least),
        })
    }
}
