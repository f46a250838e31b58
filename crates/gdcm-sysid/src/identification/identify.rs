//! Identifies a flight condition from its records (M14.5 to M14.7).

use std::sync::Arc;

use nalgebra::Complex;

use gdcm_model::dataset::model::{ModelBands, Origin, Provenance};
use gdcm_model::dataset::{Dynamics, Model, Pair};
use gdcm_model::executor::Executor;
use gdcm_model::progress::{Progress, Shares};
use gdcm_model::response::frequency_response::log_spaced;
use gdcm_model::response::pole_estimate::PoleEstimate;
use gdcm_model::simulation::{FlightRecord, Validation, ValidationSettings, validate};

use super::model_selection::{Refinement, propose, refine};
use super::order::fast_unstable_pole;
use super::prepared_data::PreparedData;
use crate::diagnostics::bands::BandModels;
use crate::diagnostics::cautions::IdentificationCaution;
use crate::diagnostics::feedback::{Feedback, FeedbackLevel, FeedbackRecords};
use crate::diagnostics::model_doubts::Diagnostics;
use crate::diagnostics::record_contrast::{RecordContrast, RecordContrasts};
use crate::diagnostics::record_fits::{RecordFit, RecordFits};
use crate::identification_error::IdentificationError;
use crate::likelihood::blocks::BlockModel;
use crate::likelihood::covariance::ParameterCovariance;
use crate::likelihood::models_without_record::{ModelWithoutRecord, without_each_record};
use crate::likelihood::normal_system::NormalSystem;
use crate::options::Options;
use crate::spectra::preparation::RecordUse;
use crate::spectra::response_estimate::ResponseEstimate;
use crate::subspace::stabilisation::StabilisationPoint;

/// Method name with refinement, in models and at the beginning of their names (M14).
const REFINED: &str = "CT-PBSID, refined";
/// The same without refinement.
const UNREFINED: &str = "CT-PBSID";
/// Frequencies in the bands.
const BAND_POINTS: usize = 60;
/// Upper end of the suggested narrower band over the present end, if the highest order is too low.
const NARROWER: f64 = 0.7;
/// Standard deviation above which a response is not identified \[dB\].
const NOT_IDENTIFIED_DB: f64 = 3.0;

/// A flight condition's identified models, in record units, and their quality.
#[derive(Clone, Debug, PartialEq)]
pub struct Identification {
    /// The recommended model: CT-PBSID, refined, with its response's standard deviations.
    pub refined: Model,
    /// CT-PBSID without refinement, with the same order.
    pub unrefined: Model,
    /// The bundle around the recommended model: the neighbouring orders, then without each record.
    pub bundle: Vec<Model>,
    /// The response measured without a model.
    pub measured: ResponseEstimate,
    /// The recommended model's poles.
    pub poles: Vec<PoleEstimate>,
    /// The unrefined models' poles for all orders at the best Laguerre pole and past window.
    pub stabilisation: Vec<StabilisationPoint>,
    /// Best Laguerre pole \[rad/s\].
    pub laguerre_pole: f64,
    /// Best past window.
    pub past: usize,
    /// BIC by refined order, ascending.
    pub criteria: Vec<(usize, f64)>,
    /// `J / (N - k)` over the fitted records; 1 is adequate.
    pub cost: f64,
    /// The same over the held-out records, if there are any.
    pub held_out_cost: Option<f64>,
    /// The same with the model free to move within its uncertainty: up to 1.3 good, above 2 not
    /// predicted (M14.17).
    pub held_out_normalised: Option<f64>,
    /// Noise and gusts fed back into the measured response (M14.14).
    pub feedback: Option<Feedback>,
    /// How far each fitted record contradicts the others; empty for a single record (M14.16).
    pub contrasts: Vec<RecordContrast>,
    /// Every used record's fit, in record order.
    pub record_fits: Vec<RecordFit>,
    /// Every output's cost per degree of freedom, over the fitted records.
    pub output_costs: Vec<f64>,
    /// The recommended model against the held-out records in time.
    pub validation: Option<Validation>,
    /// Used parts of every record.
    pub record_uses: Vec<RecordUse>,
    /// Output and input whose response has a standard deviation over 3 dB in the middle of the
    /// band.
    pub not_identified: Vec<(usize, usize)>,
    /// Doubts about records and models, each with a code.
    pub cautions: Vec<IdentificationCaution>,
}

/// Identifies a flight condition from its records (M14.7).
///
/// ```text
/// 1  record segments, scales, spectra, measured response, noise covariance                    10 %
/// 2  CT-PBSID for each Laguerre pole and past window; models of all orders from the best two  40 %
/// 3  order by BIC of refined models; the chosen order refined, records weighed by noise  80 %
/// 4  covariance, bands, bundle, validation                                                   100 %
/// ```
///
/// The result is the same to the last bit for any `executor`. `progress` receives a first model
/// after step 2.
///
/// # Errors
/// Records that cannot be prepared, a band that they do not show, invalid options, channels
/// that depend on each other, records too short for a model; or `progress` is cancelled.
pub fn identify(
    records: &[FlightRecord],
    options: &Options,
    executor: &dyn Executor,
    progress: &dyn Progress,
) -> Result<Identification, IdentificationError> {
    options.check()?;
    let progress = Shares::new(progress);
    progress.next(0.0, "records")?;
    let data = PreparedData::new(records, options, executor, &progress)?;
    let proposal = propose(&data, options, &progress)?;
    let refinement = refine(&data, &proposal, &progress)?;
    let unrefined = proposal
        .starts
        .get(&refinement.search.order)
        .ok_or_else(|| data.no_model())?;

    let assessment = Assessment {
        records,
        options,
        data: &data,
        refinement: &refinement,
    };
    progress.next(0.8, "uncertainty")?;
    let systems = refinement
        .fit
        .systems(&refinement.likelihood)
        .ok_or_else(|| data.no_model())?;
    let uncertainty = assessment.uncertainty(&systems)?;
    progress.next(0.88, "models without each record")?;
    let without = without_each_record(&refinement.likelihood, &refinement.fit, &systems);
    progress.next(0.93, "validation")?;
    let fits = RecordFits::new(
        &data.likelihood,
        &data.held_out,
        &refinement.fit.model,
        &uncertainty.covariance,
    )
    .ok_or_else(|| data.no_model())?;
    let contrasts = assessment.contrasts()?;
    let mut cautions = assessment.cautions(&uncertainty, &fits, contrasts.as_ref());
    let validation = assessment.validate(&mut cautions)?;
    progress.next(1.0, "done")?;

    let models = Models {
        records,
        options,
        data: &data,
    };
    let mut refined = models
        .of_order(REFINED, &refinement.fit.model)
        .ok_or_else(|| data.no_model())?;
    let bundle = models.bundle(&refinement, &without);
    let poles = uncertainty
        .as_logged()
        .poles(&refinement.fit.model, options.band[0]);
    refined.bands = Some(Arc::new(uncertainty.bands));
    Ok(Identification {
        refined,
        unrefined: models
            .of_order(UNREFINED, &unrefined.model)
            .ok_or_else(|| data.no_model())?,
        bundle,
        measured: data.measured.in_units(&data.scales),
        poles,
        criteria: refinement.search.criteria.clone().into_iter().collect(),
        stabilisation: proposal.stabilisation,
        laguerre_pole: proposal.laguerre_pole,
        past: proposal.past,
        cost: fits.cost,
        held_out_cost: fits.held_out.map(|held_out| held_out.raw),
        held_out_normalised: fits.held_out.map(|held_out| held_out.normalised),
        feedback: uncertainty.feedback,
        contrasts: contrasts.map_or_else(Vec::new, |contrasts| contrasts.contrasts),
        record_fits: fits.records,
        output_costs: fits.outputs,
        validation,
        record_uses: data.record_uses.clone(),
        not_identified: uncertainty.not_identified,
        cautions,
    })
}

/// The recommended model's uncertainty.
struct Uncertainty {
    covariance: ParameterCovariance,
    /// The covariance from the lines as logged, if the fit used a reference (M14.15).
    logged: Option<ParameterCovariance>,
    feedback: Option<Feedback>,
    bands: ModelBands,
    /// Output and input whose responses are not identified.
    not_identified: Vec<(usize, usize)>,
}

impl Uncertainty {
    /// Returns the covariance from the lines as logged: with a reference the cost says nothing
    /// about the uncertainty (M14.15).
    fn as_logged(&self) -> &ParameterCovariance {
        self.logged.as_ref().unwrap_or(&self.covariance)
    }
}

/// Assesses the recommended model.
struct Assessment<'a> {
    records: &'a [FlightRecord],
    options: &'a Options,
    data: &'a PreparedData<'a>,
    refinement: &'a Refinement<'a>,
}

impl Assessment<'_> {
    /// Whether no reference was used. With a reference nothing is fed back, and every record is
    /// seen through the same reference.
    fn is_direct(&self) -> bool {
        self.options.references == 0
    }

    /// Computes covariance, feedback and bands.
    fn uncertainty(&self, systems: &[NormalSystem]) -> Result<Uncertainty, IdentificationError> {
        let Refinement {
            search,
            fit,
            likelihood,
            ..
        } = self.refinement;
        let executor = likelihood.executor;
        let covariance = ParameterCovariance::from_systems(likelihood, fit, systems, fit.cost)
            .ok_or_else(|| self.data.no_model())?;
        let logged = match &self.data.direct {
            Some(direct) => Some(
                ParameterCovariance::from_lines(direct, fit).ok_or_else(|| self.data.no_model())?,
            ),
            None => None,
        };
        let feedback = self.feedback();
        let omegas = log_spaced(self.options.band[0], self.options.band[1], BAND_POINTS);
        let models = BandModels {
            model: &fit.model,
            neighbours: &search.neighbours(),
            feedback: feedback.as_ref(),
        };
        let mut bands = models
            .bands(logged.as_ref().unwrap_or(&covariance), &omegas, executor)
            .ok_or_else(|| self.data.no_model())?;
        if !self.is_direct() {
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

    /// Measures the feedback; `None` with a reference, or if inputs were moved only together, which
    /// hides it.
    fn feedback(&self) -> Option<Feedback> {
        let mut cautions = self.data.cautions.iter();
        if !self.is_direct() || cautions.any(IdentificationCaution::is_of_collinear_inputs) {
            return None;
        }
        let records = FeedbackRecords {
            segments: &self.data.unfiltered,
            lines: self.data.lines,
            band: self.options.band,
        };
        Feedback::measure(
            &records,
            &self.refinement.fit.model,
            self.refinement.likelihood.executor,
        )
    }

    /// Compares the records with each other; `None` with a reference.
    ///
    /// The fit before reweighing counts, for weights hide which record is wrong.
    fn contrasts(&self) -> Result<Option<RecordContrasts<'_>>, IdentificationError> {
        if !self.is_direct() {
            return Ok(None);
        }
        let fit = self
            .refinement
            .before_reweighing
            .as_ref()
            .unwrap_or(&self.refinement.fit);
        let contrasts = RecordContrasts::new(&self.data.likelihood, &self.data.spectra, fit)
            .ok_or_else(|| self.data.no_model())?;
        Ok(Some(contrasts))
    }

    /// Collects all doubts about records and models.
    fn cautions(
        &self,
        uncertainty: &Uncertainty,
        fits: &RecordFits,
        contrasts: Option<&RecordContrasts<'_>>,
    ) -> Vec<IdentificationCaution> {
        let Refinement { search, fit, .. } = self.refinement;
        let diagnostics = Diagnostics {
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
        if let Some(contrasts) = contrasts {
            cautions.extend(diagnostics.adequacy(fits));
            if let Some(contradiction) = contrasts.caution(is_in_gusts, &diagnostics) {
                cautions.retain(|caution| !contradiction.explains(caution));
                cautions.push(contradiction);
            }
        }
        cautions.extend(diagnostics.departures());
        if search.still_falls {
            cautions.push(IdentificationCaution::OrderLimit {
                order: search.order,
                narrower: [self.options.band[0], NARROWER * self.options.band[1]],
            });
        }
        cautions.extend(diagnostics.unidentified_pairs(&uncertainty.not_identified));
        if let Some(pole) = self.unstable_pole() {
            cautions.push(IdentificationCaution::Unstable {
                pole,
                highest: self.options.highest(),
            });
        }
        cautions
    }

    /// Returns an unstable pole above the lines used.
    fn unstable_pole(&self) -> Option<Complex<f64>> {
        fast_unstable_pole(&self.refinement.fit.model, self.options.highest())
    }

    /// Compares the model with the held-out records in time; a failure becomes a caution.
    ///
    /// An unstable pole that no line shows would end the windows after a few samples.
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
        let executor = self.refinement.likelihood.executor;
        match validate(&model, segments, &settings, executor) {
            Ok(validation) => Ok(Some(validation)),
            Err(error) => {
                cautions.push(IdentificationCaution::NotValidated(error));
                Ok(None)
            }
        }
    }
}

/// Reports gusts and noise that went into the inputs.
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
    })
}

/// Returns output and input whose responses are known too badly in mid-band.
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

/// Converts block models to dataset models.
struct Models<'a> {
    records: &'a [FlightRecord],
    options: &'a Options,
    data: &'a PreparedData<'a>,
}

impl Models<'_> {
    /// Names a model after its method and order.
    fn of_order(&self, method: &str, model: &BlockModel) -> Option<Model> {
        let name = format!("{method}, order {}", model.order());
        self.model(name, method, model, None)
    }

    /// Returns the neighbouring orders, then the models without each record.
    fn bundle(&self, refinement: &Refinement, without: &[ModelWithoutRecord]) -> Vec<Model> {
        let mut bundle = Vec::new();
        for neighbour in refinement.search.neighbours() {
            bundle.extend(self.of_order(REFINED, neighbour));
        }
        for ModelWithoutRecord { record, model } in without {
            let record_name = self
                .records
                .get(*record)
                .map_or("", |record| record.name.as_str());
            let name = format!("{REFINED}, without {record_name}");
            bundle.extend(self.model(name, REFINED, model, Some(*record)));
        }
        bundle
    }

    /// Converts a model to record units; `None` if it is not finite.
    fn model(
        &self,
        name: String,
        method: &str,
        model: &BlockModel,
        without: Option<usize>,
    ) -> Option<Model> {
        let dynamics = Dynamics::StateSpace(self.data.in_units(model)?);
        let origin = Origin::Identified {
            method: Some(method.to_owned()),
            order: Some(model.order()),
        };
        let source = Provenance {
            records: self.options.fitted(self.records, without),
            ..Provenance::default()
        };
        Some(Model {
            source: Some(source),
            ..Model::new(name, origin, dynamics)
        })
    }
}
