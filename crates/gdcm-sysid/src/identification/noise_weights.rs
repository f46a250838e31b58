//! Line weights: from noise measured without a model, then from a model's residuals, with a factor
//! for each record (M14.4, M14.20).
//!
//! A line's weight `W` whitens the noise covariance there (`noise_covariance`). A record's *noise
//! factor* multiplies its noise power; the factors' geometric mean is 1.

use super::prepared_data::PreparedData;
use super::search_records::search_segments;
use crate::diagnostics::record_fits::fits_of_records;
use crate::likelihood::cost::Likelihood;
use crate::likelihood::descent::Fit;
use crate::likelihood::noise_covariance::NoiseCovariance;
use crate::likelihood::residual_noise::residual_noise;
use crate::likelihood::spectral_lines::SpectralLines;

/// Records keep their weights up to this ratio between their largest and smallest cost per degree
/// of freedom.
const ALIKE: f64 = 1.5;

/// The cost with weights from a noise covariance.
#[derive(Clone)]
pub(crate) struct NoiseWeights<'a> {
    /// The cost over the fitted records, or over those from which the order is searched.
    pub(crate) likelihood: Likelihood<'a>,
    /// The same cost with equal factors for all records.
    pub(crate) without_factors: Likelihood<'a>,
    /// Ratio between the largest and the smallest factor; `None` if all records have the same.
    pub(crate) ratio: Option<f64>,
    /// Segments in `likelihood`, as indices into [`PreparedData::spectra`].
    segments: Vec<usize>,
    /// The noise in the model's residuals; `None` if the noise was measured without a model.
    noise: Option<NoiseCovariance>,
}

impl<'a> NoiseWeights<'a> {
    /// Uses the noise that was measured without a model, over the records from which the order is
    /// searched.
    pub(crate) fn measured(data: &PreparedData<'a>) -> Self {
        let segments = search_segments(&data.spectra);
        let likelihood = data.likelihood.of_segments(&segments);
        Self {
            without_factors: likelihood.clone(),
            likelihood,
            ratio: None,
            segments,
            noise: None,
        }
    }

    /// Returns the cost over all fitted records with the same noise, without factors; `None` if the
    /// noise is not positive definite at a line.
    pub(crate) fn over_all_records(&self, data: &PreparedData<'a>) -> Option<Self> {
        let segments: Vec<usize> = (0..data.spectra.len()).collect();
        let likelihood = match &self.noise {
            Some(noise) => weighed(data, &segments, noise)?,
            None => data.likelihood.clone(),
        };
        Some(Self {
            without_factors: likelihood.clone(),
            likelihood,
            ratio: None,
            segments,
            noise: self.noise.clone(),
        })
    }

    /// Computes the weights from a model's residuals; `None` if the noise cannot be computed.
    pub(crate) fn updated(&self, data: &PreparedData<'a>, fit: &Fit) -> Option<Self> {
        let noise = residual_noise(&self.likelihood, &fit.model, &fit.parts)?;
        let without_factors = weighed(data, &self.segments, &noise)?;
        let weights = Self {
            likelihood: without_factors.clone(),
            without_factors,
            ratio: None,
            segments: self.segments.clone(),
            noise: Some(noise),
        };
        weights.with_factors(fit)
    }

    /// Multiplies each record's noise power by its cost per degree of freedom over their geometric
    /// mean, if the largest cost exceeds 1.5 times the smallest.
    fn with_factors(self, fit: &Fit) -> Option<Self> {
        let parts = self.without_factors.parts(&fit.model)?;
        let fits = fits_of_records(&self.without_factors, &fit.model, &parts, false);
        let costs: Vec<f64> = fits.iter().map(|record| record.cost).collect();
        let least = costs.iter().copied().fold(f64::INFINITY, f64::min);
        let greatest = costs.iter().copied().fold(0.0, f64::max);
        let are_unlike = least > 0.0 && greatest > ALIKE * least;
        if !are_unlike {
            return Some(self);
        }
        let log_mean = costs.iter().map(|cost| cost.ln()).sum::<f64>() / costs.len() as f64;
        let mean = log_mean.exp();
        let mut segments = Vec::with_capacity(self.without_factors.segments.len());
        for segment in &self.without_factors.segments {
            let own = fits.iter().find(|record| record.record == segment.record);
            segments.push(match own {
                Some(record) => segment.with_noise(record.cost / mean),
                None => segment.clone(),
            });
        }
        Some(Self {
            likelihood: Likelihood::new(segments, self.without_factors.executor),
            ratio: Some(greatest / least),
            ..self
        })
    }
}

/// Whitens these segments' lines with a noise covariance; `None` if it is not positive definite at
/// a line.
fn weighed<'a>(
    data: &PreparedData<'a>,
    segments: &[usize],
    noise: &NoiseCovariance,
) -> Option<Likelihood<'a>> {
    let mut whitened = Vec::with_capacity(segments.len());
    for number in segments {
        whitened.push(SpectralLines::new(&data.spectra[*number], noise)?);
    }
    Some(Likelihood::new(whitened, data.likelihood.executor))
}
