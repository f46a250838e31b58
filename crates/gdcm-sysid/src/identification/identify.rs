//! Identifies a flight condition from its records (M14.5 to M14.7).
//!
//! CT-PBSID is a subspace method for continuous time ([`subspace`](crate::subspace)). Its models
//! are then *refined*: their cost J over the spectral lines is minimised
//! ([`likelihood`](crate::likelihood)).

use std::sync::Arc;

use gdcm_model::dataset::model::{ModelBands, Origin, Provenance};
use gdcm_model::dataset::{Dynamics, Model, Pair};
use gdcm_model::executor::Executor;
use gdcm_model::progress::{Progress, Shares};
use gdcm_model::response::pole_estimate::PoleEstimate;
use gdcm_model::simulation::{FlightRecord, Validation};

use super::assessment::{AssessedModel, Assessment, NOT_IDENTIFIED_DB};
use super::model_selection::{Proposal, Refinement, propose};
use super::order::OrderFit;
use super::prepared_data::PreparedData;
use super::second_start::refine;
use crate::diagnostics::bands::TWO_SIDED_95;
use crate::diagnostics::cautions::IdentificationCaution;
use crate::diagnostics::feedback::Feedback;
use crate::diagnostics::record_contrast::RecordContrast;
use crate::diagnostics::record_fits::RecordFit;
use crate::identification_error::IdentificationError;
use crate::likelihood::models_without_record::ModelWithoutRecord;
use crate::likelihood::schur_model::SchurModel;
use crate::options::Options;
use crate::planning::flight_information::{FittedModel, FlightInformation};
use crate::planning::flight_planner::FlightPlanner;
use crate::planning::sweep_advice::SweepAdvice;
use crate::spectra::record_use::RecordUse;
use crate::spectra::response_estimate::ResponseEstimate;
use crate::subspace::stabilisation::StabilisationPoint;

/// Method name with refinement, in models and at the beginning of their names (M14).
const REFINED: &str = "CT-PBSID, refined";
/// Method name without refinement.
const UNREFINED: &str = "CT-PBSID";

/// A flight condition's identified models, in record units, and their quality.
#[derive(Clone, Debug, PartialEq)]
pub struct Identification {
    /// The recommended model: CT-PBSID, refined, with standard deviations for its responses.
    pub refined: Model,
    /// CT-PBSID without refinement, with the same order or, if there is none, the next lower, else
    /// the lowest.
    pub unrefined: Model,
    /// The bundle around the recommended model: models of neighbouring orders, then models fitted
    /// without one record each.
    pub bundle: Vec<Model>,
    /// The response estimated from the records without a model.
    pub measured: ResponseEstimate,
    /// The recommended model's poles, with their standard deviations.
    pub poles: Vec<PoleEstimate>,
    /// Poles of the unrefined models at all orders, for the Laguerre pole and the past window with
    /// the lowest cost.
    pub stabilisation: Vec<StabilisationPoint>,
    /// Laguerre pole of the model with the lowest cost \[rad/s\].
    pub laguerre_pole: f64,
    /// Past window of the model with the lowest cost \[Laguerre projections\].
    pub past: usize,
    /// BIC at each refined order, ascending by order.
    pub criteria: Vec<(usize, f64)>,
    /// Fit at each order that was refined to its minimum, ascending by order.
    pub order_fits: Vec<OrderFit>,
    /// `J / (N - k)` over the fitted records, with N degrees of freedom and k parameters; 1 is
    /// adequate.
    pub cost: f64,
    /// `J` per degree of freedom over the held-out records; `None` if no record is held out.
    pub held_out_cost: Option<f64>,
    /// `J` per degree of freedom over the held-out records, with the model free to move within its
    /// uncertainty: up to 1.3 good, above 2 not predicted (M14.17).
    pub held_out_normalised: Option<f64>,
    /// Noise and gusts fed back into the measured response (M14.14); `None` if it was not measured.
    pub feedback: Option<Feedback>,
    /// Contradiction between each fitted record and the others (M14.16); empty for a single record,
    /// and with a reference.
    pub contrasts: Vec<RecordContrast>,
    /// Fit for each fitted or held-out record with degrees of freedom, in record order.
    pub record_fits: Vec<RecordFit>,
    /// `J` per degree of freedom for each output, over the fitted records, corrected for the
    /// model's parameters.
    pub output_costs: Vec<f64>,
    /// Comparison of the recommended model with the held-out records in time. `None` without
    /// held-out records, if the model has an unstable pole above the lines used, or if its
    /// simulation fails.
    pub validation: Option<Validation>,
    /// The parts used from every record.
    pub record_uses: Vec<RecordUse>,
    /// Indices (output, input) of the responses whose standard deviation exceeds 3 dB in mid-band.
    pub not_identified: Vec<(usize, usize)>,
    /// Doubts about records and models, each with a code.
    pub cautions: Vec<IdentificationCaution>,
    /// Fisher information from the records about the recommended model, to plan further flights;
    /// `None` if it cannot be computed.
    pub information: Option<Arc<FlightInformation>>,
    /// Advised further sweeps, to identify the responses in `not_identified`.
    pub advice: Vec<SweepAdvice>,
}

/// Identifies a flight condition from its records (M14.7).
///
/// ```text
///                                                                         progress after the step
/// 1  record segments, scales, spectra, measured response, noise covariance                    10 %
/// 2  CT-PBSID for each Laguerre pole and past window; models of all orders from the best two  40 %
/// 3  order by BIC of refined models; the chosen order refined, records weighted by noise      80 %
/// 4  covariance, bands, bundle, validation                                                   100 %
/// ```
///
/// The result is bit for bit the same with any `executor`. `progress` receives a first model after
/// step 2.
///
/// # Errors
/// Invalid options, records that cannot be prepared, that are too short or are sampled too slowly
/// for the band, channels that depend on each other, a response that cannot be measured, no record
/// left to fit, no model found; or `progress` is cancelled.
pub fn identify(
    records: &[FlightRecord],
    options: &Options,
    executor: &dyn Executor,
    progress: &dyn Progress,
) -> Result<Identification, IdentificationError> {
    options.check()?;
    let progress = Shares::new(progress);
    // Step 1.
    progress.next(0.0, "records")?;
    let data = PreparedData::new(records, options, executor, &progress)?;
    // Step 2.
    let proposal = propose(&data, options, &progress)?;
    // Step 3.
    let refinement = refine(&data, &proposal, &progress)?;
    // Step 4.
    let assessment = Assessment {
        records,
        options,
        data: &data,
        refinement: &refinement,
    };
    let assessed = assessment.assess(&progress)?;
    progress.next(1.0, "done")?;
    let models = Models {
        records,
        options,
        data: &data,
    };
    models
        .identification(proposal, &refinement, assessed)
        .ok_or_else(|| data.no_model())
}

/// Converts models from scaled units to dataset models in record units, and gathers the result.
struct Models<'a> {
    records: &'a [FlightRecord],
    options: &'a Options,
    data: &'a PreparedData<'a>,
}

impl Models<'_> {
    /// Gathers the result in record units; `None` if a model is not finite.
    fn identification(
        &self,
        proposal: Proposal,
        refinement: &Refinement,
        assessed: AssessedModel,
    ) -> Option<Identification> {
        let AssessedModel {
            uncertainty, fits, ..
        } = assessed;
        let model = &refinement.fit.model;
        let unrefined = proposal.unrefined(refinement.search.order)?;
        let poles = uncertainty.as_logged().poles(model, self.options.band);
        let bands = Arc::new(uncertainty.bands);
        let information = self.information(refinement, &bands, uncertainty.feedback.as_ref());
        let advice = self.advice(information.as_ref(), &uncertainty.not_identified);
        let mut refined = self.of_order(REFINED, model)?;
        refined.bands = Some(bands);
        Some(Identification {
            refined,
            unrefined: self.of_order(UNREFINED, &unrefined.model)?,
            bundle: self.bundle(refinement, &assessed.without),
            measured: self.data.measured.in_units(&self.data.scales),
            poles,
            criteria: refinement.search.criteria.clone().into_iter().collect(),
            order_fits: refinement.search.order_fits(self.data),
            stabilisation: proposal.stabilisation,
            laguerre_pole: proposal.laguerre_pole,
            past: proposal.past,
            cost: fits.cost,
            held_out_cost: fits.held_out.map(|held_out| held_out.raw),
            held_out_normalised: fits.held_out.map(|held_out| held_out.normalised),
            feedback: uncertainty.feedback,
            contrasts: assessed.contrasts,
            record_fits: fits.records,
            output_costs: fits.outputs,
            validation: assessed.validation,
            record_uses: self.data.record_uses.clone(),
            not_identified: uncertainty.not_identified,
            cautions: assessed.cautions,
            information: information.map(Arc::new),
            advice,
        })
    }

    /// Computes the records' Fisher information about the recommended model; with a reference, from
    /// the lines as logged.
    fn information(
        &self,
        refinement: &Refinement,
        bands: &Arc<ModelBands>,
        feedback: Option<&Feedback>,
    ) -> Option<FlightInformation> {
        let fitted = &refinement.weights.likelihood;
        FlightInformation::new(&FittedModel {
            model: &refinement.fit.model.state_space()?,
            likelihood: self.data.direct.as_ref().unwrap_or(fitted),
            scales: &self.data.scales,
            lines: [self.options.lowest(), self.options.highest()],
            bands,
            feedback,
            not_swept: self.data.measured.excitation().not_identified().collect(),
        })
    }

    /// Advises further sweeps to identify these responses (output, input); none if a prediction
    /// fails.
    fn advice(
        &self,
        information: Option<&FlightInformation>,
        not_identified: &[(usize, usize)],
    ) -> Vec<SweepAdvice> {
        if not_identified.is_empty() {
            return Vec::new();
        }
        let mut pairs = Vec::with_capacity(not_identified.len());
        for &(output, input) in not_identified {
            pairs.push(Pair { output, input });
        }
        information
            .and_then(|information| FlightPlanner::new(information, self.data.likelihood.executor))
            .and_then(|planner| planner.advice(&pairs, TWO_SIDED_95 * NOT_IDENTIFIED_DB))
            .unwrap_or_default()
    }

    /// Converts a model to record units, named after its method and order.
    fn of_order(&self, method: &str, model: &SchurModel) -> Option<Model> {
        let name = format!("{method}, order {}", model.order());
        self.model(name, method, model, None)
    }

    /// Returns the models of neighbouring orders, then those fitted without one record each.
    fn bundle(&self, refinement: &Refinement, without: &[ModelWithoutRecord]) -> Vec<Model> {
        let mut bundle = Vec::new();
        for neighbour in &refinement.neighbours {
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
        model: &SchurModel,
        without: Option<usize>,
    ) -> Option<Model> {
        let dynamics = Dynamics::StateSpace(self.data.in_units(model)?);
        let origin = Origin::Identified {
            method: Some(method.to_owned()),
            order: Some(model.order()),
        };
        let source = Provenance {
            records: self.options.fitted_records(self.records, without),
            ..Provenance::default()
        };
        Some(Model {
            source: Some(source),
            ..Model::new(name, origin, dynamics)
        })
    }
}
