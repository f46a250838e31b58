//! Assesses the recommended model: its uncertainty, and doubts about it (M14.5, M14.6, M14.10).
//!
//! The *bands* are the standard deviations of the responses over frequency. A *reference* is a
//! recorded signal that drove the loop from outside (M14.15); the lines *as logged* are those not
//! measured through it, from which `PreparedData::direct` is computed. *Reweighing* weighs each
//! record by its own noise (`noise_weights`).

use nalgebra::Complex;

use gdcm_model::dataset::Pair;
use gdcm_model::dataset::model::ModelBands;
use gdcm_model::progress::Shares;
use gdcm_model::response::frequency_grid::log_spaced;
use gdcm_model::simulation::{FlightRecord, Validation, ValidationSettings, validate};

use super::model_selection::Refinement;
use super::order::fast_unstable_pole;
use super::prepared_data::PreparedData;
use crate::diagnostics::bands::BandModels;
use crate::diagnostics::cautions::IdentificationCaution;
use crate::diagnostics::feedback::{Feedback, FeedbackLevel, FeedbackRecords};
use crate::diagnostics::model_cautions::ModelCautions;
use crate::diagnostics::record_contrast::{RecordContrast, RecordContrasts};
use crate::diagnostics::record_fits::RecordFits;
use crate::identification_error::IdentificationError;
use crate::likelihood::covariance::ParameterCovariance;
use crate::likelihood::local_system::LocalSystems;
use crate::likelihood::models_without_record::{ModelWithoutRecord, without_each_record};
use crate::options::Options;

/// Number of frequencies at which the bands are computed.
const BAND_POINTS: usize = 60;
/// Suggested upper end of the band, relative to the present one; a narrower band is suggested if
/// even the highest order is too low.
const NARROWER: f64 = 0.7;
/// Standard deviation in mid-band above which a response is not identified \[dB\].
pub(super) const NOT_IDENTIFIED_DB: f64 = 3.0;

/// Covariance, bands and feedback for the recommended model.
pub(super) struct Uncertainty {
    covariance: ParameterCovariance,
    /// The covariance from the lines as logged, if the fit used a reference (M14.15).
    logged: Option<ParameterCovariance>,
    pub(super) feedback: Option<Feedback>,
    pub(super) bands: ModelBands,
    /// Output and input index for each response that is not identified.
    pub(super) not_identified: Vec<(usize, usize)>,
}

impl Uncertainty {
    /// Returns the covariance from the lines as logged: with a reference, the cost that was
    /// minimised does not measure the uncertainty (M14.15).
    pub(super) fn as_logged(&self) -> &ParameterCovariance {
        self.logged.as_ref().unwrap_or(&self.covariance)
    }
}

/// The recommended model, with the data for its assessment.
pub(super) struct Assessment<'a> {
    pub(super) records: &'a [FlightRecord],
    pub(super) options: &'a Options,
    pub(super) data: &'a PreparedData<'a>,
    pub(super) refinement: &'a Refinement<'a>,
}

/// The recommended model with its uncertainty, its fits and all doubts.
pub(super) struct AssessedModel {
    pub(super) uncertainty: Uncertainty,
    /// Models fitted without one record each.
    pub(super) without: Vec<ModelWithoutRecord>,
    pub(super) fits: RecordFits,
    /// Contradiction between each fitted record and the others (M14.16).
    pub(super) contrasts: Vec<RecordContrast>,
    pub(super) cautions: Vec<IdentificationCaution>,
    pub(super) validation: Option<Validation>,
}

impl Assessment<'_> {
    /// Computes the uncertainty, the fits, the doubts and the validation.
    ///
    /// ```text
    /// 1  covariance, feedback, bands; the responses that are not identified
    /// 2  a model without each record
    /// 3  the fit to each record and output; contradictions between records
    /// 4  cautions from all of these
    /// 5  comparison with the held-out records in time
    /// ```
    pub(super) fn assess(&self, progress: &Shares) -> Result<AssessedModel, IdentificationError> {
        let Refinement { fit, weights, .. } = self.refinement;
        let likelihood = &weights.likelihood;
        // Step 1.
        progress.next(0.8, "uncertainty")?;
        let systems = LocalSystems::new(likelihood, fit).ok_or_else(|| self.data.no_model())?;
        let uncertainty = self.uncertainty(&systems)?;
        // Step 2.
        progress.next(0.88, "models fitted without one record each")?;
        let without = without_each_record(likelihood, fit, &systems);
        // Step 3.
        progress.next(0.93, "validation")?;
        let covariance = &uncertainty.covariance;
        let fits = RecordFits::new(
            &self.data.likelihood,
            &self.data.held_out,
            &fit.model,
            covariance,
        )
        .ok_or_else(|| self.data.no_model())?;
        let contrasts = self.contrasts()?;
        // Steps 4 and 5.
        let mut cautions = self.cautions(&uncertainty, &fits, contrasts.as_ref());
        let validation = self.validate(&mut cautions)?;
        Ok(AssessedModel {
            uncertainty,
            without,
            fits,
            contrasts: contrasts.map_or_else(Vec::new, |contrasts| contrasts.contrasts),
            cautions,
            validation,
        })
    }

    /// Returns whether a reference was used. There is then no feedback to measure, and all records
    /// are measured through the same reference, so that they are not compared with each other.
    fn has_reference(&self) -> bool {
        self.options.references > 0
    }

    /// Computes covariance, feedback and bands.
    fn uncertainty(&self, systems: &LocalSystems) -> Result<Uncertainty, IdentificationError> {
        let Refinement { fit, weights, .. } = self.refinement;
        let likelihood = &weights.likelihood;
        let executor = likelihood.executor;
        let covariance = fit
            .dispersion(likelihood)
            .and_then(|dispersion| ParameterCovariance::new(systems, dispersion))
            .ok_or_else(|| self.data.no_model())?;
        let logged = match &self.data.direct {
            Some(direct) => Some(
                ParameterCovariance::from_lines(direct, &fit.model)
                    .ok_or_else(|| self.data.no_model())?,
            ),
            None => None,
        };
        let feedback = self.feedback();
        let omegas = log_spaced(self.options.band[0], self.options.band[1], BAND_POINTS);
        let models = BandModels {
            model: &fit.model,
            neighbours: &self.refinement.neighbours,
            feedback: feedback.as_ref(),
        };
        let mut bands = models
            .bands(logged.as_ref().unwrap_or(&covariance), &omegas, executor)
            .ok_or_else(|| self.data.no_model())?;
        if self.has_reference() {
            bands = self
                .data
                .measured
                .widened(&bands)
                .ok_or_else(|| self.data.no_model())?;
        }
        Ok(Uncertainty {
            covariance,
            logged,
            feedback,
            not_identified: not_identified(&bands),
            bands,
        })
    }

    /// Measures the feedback; `None` with a reference, if inputs were moved only together, which
    /// hides the feedback, or if it cannot be measured.
    fn feedback(&self) -> Option<Feedback> {
        let mut cautions = self.data.cautions.iter();
        if self.has_reference() || cautions.any(IdentificationCaution::is_of_collinear_inputs) {
            return None;
        }
        let records = FeedbackRecords {
            segments: &self.data.unfiltered,
            lines: self.data.measured_range,
            band: self.options.band,
            coherence: self.data.measured.excitation().greatest_coherence(),
        };
        Feedback::measure(
            &records,
            &self.refinement.fit.model,
            self.refinement.weights.likelihood.executor,
        )
    }

    /// Compares the records with each other; `None` with a reference.
    ///
    /// The fit before reweighting is used, because the weights hide which record is wrong.
    fn contrasts(&self) -> Result<Option<RecordContrasts<'_>>, IdentificationError> {
        if self.has_reference() {
            return Ok(None);
        }
        let fit = self
            .refinement
            .before_reweighing
            .as_ref()
            .unwrap_or(&self.refinement.fit);
        let contrasts = RecordContrasts::new(
            &self.refinement.weights.without_factors,
            &self.data.spectra,
            fit,
        )
        .ok_or_else(|| self.data.no_model())?;
        Ok(Some(contrasts))
    }

    /// Collects all doubts about records and models, without those that only follow from others.
    fn cautions(
        &self,
        uncertainty: &Uncertainty,
        fits: &RecordFits,
        contrasts: Option<&RecordContrasts<'_>>,
    ) -> Vec<IdentificationCaution> {
        let Refinement { search, fit, .. } = self.refinement;
        let model_cautions = ModelCautions {
            records: self.records,
            options: self.options,
            data: self.data.measured_data(),
            fit,
        };
        let mut cautions = self.data.cautions.clone();
        cautions.extend(self.refinement.caution.clone());
        let feedback = feedback_caution(uncertainty.feedback.as_ref());
        let is_in_gusts = feedback.is_some();
        cautions.extend(feedback);
        cautions.extend(model_cautions.departures());
        if let Some(contrasts) = contrasts {
            cautions.extend(model_cautions.adequacy(fits));
            cautions.extend(contrasts.caution(is_in_gusts, &model_cautions));
        }
        if search.still_falls {
            cautions.push(IdentificationCaution::OrderLimit {
                order: search.order,
                narrower: [self.options.band[0], NARROWER * self.options.band[1]],
            });
        }
        cautions.extend(model_cautions.unidentified_pairs(&uncertainty.not_identified));
        if let Some(pole) = self.unstable_pole() {
            cautions.push(IdentificationCaution::Unstable {
                pole,
                highest: self.options.highest(),
            });
        }
        IdentificationCaution::without_consequences(cautions)
    }

    /// Returns an unstable pole above the highest spectral line used, if there is one.
    fn unstable_pole(&self) -> Option<Complex<f64>> {
        fast_unstable_pole(self.refinement.fit.model.poles(), self.options.highest())
    }

    /// Compares the model with the held-out records in time; a failure becomes a caution.
    ///
    /// Skipped if the model has an unstable pole above the lines used: its simulation would diverge
    /// after a few samples.
    fn validate(
        &self,
        cautions: &mut Vec<IdentificationCaution>,
    ) -> Result<Option<Validation>, IdentificationError> {
        let segments = self.data.held_out_segments.as_slice();
        if segments.is_empty() || self.unstable_pole().is_some() {
            return Ok(None);
        }
        let settings = ValidationSettings::filtered(self.options.highest());
        let model = self
            .data
            .in_units(&self.refinement.fit.model)
            .ok_or_else(|| self.data.no_model())?;
        let executor = self.refinement.weights.likelihood.executor;
        match validate(&model, segments, &settings, executor) {
            Ok(validation) => Ok(Some(validation)),
            Err(error) => {
                cautions.push(IdentificationCaution::NotValidated(error));
                Ok(None)
            }
        }
    }
}

/// Returns a caution if the feedback carried gusts and noise visibly into the inputs.
fn feedback_caution(feedback: Option<&Feedback>) -> Option<IdentificationCaution> {
    let feedback = feedback?;
    let level = feedback.level();
    if level == FeedbackLevel::None {
        return None;
    }
    Some(IdentificationCaution::Feedback {
        level,
        share: feedback.share,
        significance: feedback.significance,
        coherence: feedback.coherence,
    })
}

/// Returns the (output, input) pairs whose standard deviation in mid-band exceeds 3 dB (M14.5).
fn not_identified(bands: &ModelBands) -> Vec<(usize, usize)> {
    let sd_db = bands.sd_db();
    let middle = bands.omega().len() / 2;
    let mut pairs = Vec::new();
    for input in 0..sd_db.inputs() {
        for output in 0..sd_db.outputs() {
            if sd_db[Pair { output, input }][middle] > NOT_IDENTIFIED_DB {
                pairs.push((output, input));
            }
        }
    }
    pairs
}
