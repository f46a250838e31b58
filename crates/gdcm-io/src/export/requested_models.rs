//! Chooses the conditions, physics models and corrections that an export requests, and computes
//! the corrected models with their accuracy.
//!
//! ```text
//! 1  couplings and physics parameters: a fault if requested but unavailable   (check_available)
//!    for each chosen condition (exported_model):
//! 2  physics model: nominal, representative, or named                         (model_of)
//! 3  correction: own; scheduled, with or without leads; schedule of others    (correction_of)
//! 4  matrices of M_O H~ M_I: H~ is the model with its couplings (M16), M_I and M_O are the gains,
//!    delays and leads of its inputs and outputs (M10)
//! 5  facts: phase error at the band's upper end, omitted delays, price of leads (M15.6)
//! ```
//!
//! All models are those of the *moved* dataset: changed by the study's physics parameters (M18),
//! where there are any. Delays are *omitted* if the condition's own correction has them but the
//! schedule does not.

use nalgebra::Complex;

use gdcm_method::correction::{self, ChannelCorrection, LeadPrice};
use gdcm_model::dataset::{BundleKind, Condition, ConditionId, Dynamics, Model, PairTable};
use gdcm_model::response::{FrequencyGrid, FrequencyResponse, GainDelay};
use gdcm_study::{Analysis, AssessedCorrection, ConditionAnalysis};
use gdcm_words::caution::failure_text;
use gdcm_words::coupled_model_error::coupled_model_error_text;
use gdcm_words::coupling_error::coupling_error_text;
use gdcm_words::lead_price::price_text;

use super::exported_model::{DescribedPrice, ExportedModel, ModelCouplings};
use super::model_description::correction_words;
use super::state_names::state_names;
use super::{ExportRequest, ExportedRole};
use crate::export_fault::ExportFault;
use crate::files::export_contents::{ExportContents, LeftOutPart};

/// Returns the requested corrected models, in dataset order.
pub(super) fn exported_models(
    analysis: &Analysis,
    request: &ExportRequest,
) -> Result<Vec<ExportedModel>, ExportFault> {
    check_available(analysis)?;
    // The models as compared and corrected: moved by the physics parameters, where there are any.
    let dataset = analysis.moved_dataset();
    let chosen = request.chosen_conditions(analysis);
    for &id in &chosen {
        if dataset.condition(id).is_none() {
            return Err(ExportFault::NoCondition { condition: id });
        }
    }
    let mut models = Vec::with_capacity(chosen.len());
    for condition in dataset.conditions() {
        if chosen.contains(&condition.id()) {
            models.push(exported_model(analysis, request, condition)?);
        }
    }
    Ok(models)
}

/// Returns `M_O H~ M_I` at the frequencies `omega` \[rad/s\]: `H~` is a condition's requested
/// physics model with its couplings, and `M_I` and `M_O` correct its inputs and outputs as
/// requested. Delays are exact.
///
/// # Errors
/// The analysis lacks the condition, the model, or a requested correction part.
pub fn corrected_response(
    analysis: &Analysis,
    request: &ExportRequest,
    condition: ConditionId,
    omega: &[f64],
) -> Result<PairTable<Vec<Complex<f64>>>, ExportFault> {
    check_available(analysis)?;
    let condition = analysis
        .moved_dataset()
        .condition(condition)
        .ok_or(ExportFault::NoCondition { condition })?;
    let model = model_of(analysis, &request.role, condition)?;
    let correction = correction_of(analysis, request.correction, condition)?;
    let grid = FrequencyGrid::at(omega.to_vec());
    let mut response = FrequencyResponse::from_dynamics(&model.dynamics, &grid);
    if let Some(fitted) = analysis.fitted_couplings() {
        let airspeed_kt = condition.flight_state().airspeed_kt;
        response = fitted.matrices().response(&response, airspeed_kt);
    }
    Ok(response.curves().map(|pair, curve| {
        let leads = correction::Channel::of_pair(pair).map(|channel| correction.lead(channel));
        let gain = correction.net_gain(pair);
        let delay_s =
            correction.output_delays_s[pair.output] + correction.input_delays_s[pair.input];
        // A scheduled gain may be negative: only delays and leads enter this factor; the gain is
        // applied separately.
        let factor = GainDelay::new(1.0, delay_s).with_leads(leads);
        let corrected = curve.iter().zip(omega);
        corrected
            .map(|(value, omega)| value * factor.at(*omega) * gain)
            .collect()
    }))
}

/// Checks that couplings and physics parameters are available if the study requests them.
fn check_available(analysis: &Analysis) -> Result<(), ExportFault> {
    let dataset = &analysis.study.dataset;
    analysis
        .requested_couplings()
        .map_err(|error| ExportFault::NoCouplings {
            why: coupling_error_text(error, dataset),
        })?;
    analysis
        .requested_physics()
        .map_err(|failure| ExportFault::NoPhysics {
            why: failure.to_string(),
        })?;
    Ok(())
}

/// Returns the correction parts in the requested models. If the schedule that they require does not
/// exist, returns those in an exported schedule; the export itself then fails with the reason.
pub(super) fn contents_of_models(analysis: &Analysis, request: &ExportRequest) -> ExportContents {
    let conditions: Vec<ConditionId> = request.chosen_conditions(analysis).into_iter().collect();
    match ExportContents::of_models(analysis, request.correction, &conditions) {
        Ok(contents) => contents,
        Err(_) => ExportContents::of_scheduled(analysis),
    }
}

/// Computes a condition's corrected model, with the facts that describe it.
///
/// # Errors
/// The analysis lacks the requested model or correction, the model is a measured response, or the
/// corrected model has no matrices.
fn exported_model(
    analysis: &Analysis,
    request: &ExportRequest,
    condition: &Condition,
) -> Result<ExportedModel, ExportFault> {
    let id = condition.id();
    let (inputs, outputs) = analysis.study.dataset.input_and_output_names();
    // Steps 2 and 3.
    let model = model_of(analysis, &request.role, condition)?;
    let correction = correction_of(analysis, request.correction, condition)?;
    let Dynamics::StateSpace(dynamics) = &model.dynamics else {
        return Err(ExportFault::NoMatrices {
            condition: id,
            model: model.name.clone(),
        });
    };
    // Step 4.
    let corrected = analysis
        .corrected_model(condition, dynamics, &correction, request.pade)
        .map_err(|error| ExportFault::Model {
            condition: id,
            model: model.name.clone(),
            words: coupled_model_error_text(&error, &analysis.study.dataset),
        })?;
    // Step 5.
    let price = correction.leads.as_ref().and_then(LeadPrice::new);
    let band_top_rad_s = analysis.study.settings.band.max();
    let is_sampled = dynamics.timing().sample_time_s.is_some();
    let contents = ExportContents::of_models(analysis, request.correction, &[id])
        .map_err(ExportFault::Schedule)?;
    Ok(ExportedModel {
        condition: id,
        airspeed_kt: condition.flight_state().airspeed_kt,
        name: model.name.clone(),
        correction: correction_words(request.correction),
        states: state_names(&analysis.study.dataset, model, &corrected),
        delay_states: corrected
            .delay_states
            .iter()
            .map(|(_, states)| states)
            .sum(),
        lead_states: corrected.lead_states.iter().map(|(_, states)| states).sum(),
        pade_order: if is_sampled { 0 } else { request.pade.order() },
        approximation_error_deg: corrected.phase_error(band_top_rad_s).to_degrees(),
        omitted_delay_deg: omitted_delay_deg(&contents, band_top_rad_s),
        contents,
        band_top_rad_s,
        price: price.map(|price| DescribedPrice {
            words: price_text(&price, &inputs, &outputs),
            price,
        }),
        couplings: ModelCouplings::new(analysis, dynamics),
        model: corrected.model,
    })
}

/// Returns the maximum phase lag \[deg\] at `omega` \[rad/s\] due to the omitted delays: that of a
/// response with the longest omitted input delay and the longest omitted output delay.
fn omitted_delay_deg(contents: &ExportContents, omega: f64) -> f64 {
    let mut input_s = 0.0_f64;
    let mut output_s = 0.0_f64;
    for part in &contents.left_out {
        let LeftOutPart::Delay(delayed) = part else {
            continue;
        };
        for own in &delayed.delays {
            match delayed.channel {
                correction::Channel::Input(_) => input_s = input_s.max(own.delay_s),
                correction::Channel::Output(_) => output_s = output_s.max(own.delay_s),
            }
        }
    }
    (omega * (input_s + output_s)).to_degrees()
}

/// Returns the physics model that `role` selects in a condition.
fn model_of<'c>(
    analysis: &Analysis,
    role: &ExportedRole,
    condition: &'c Condition,
) -> Result<&'c Model, ExportFault> {
    let name = match role {
        ExportedRole::Nominal => {
            return Ok(&condition.bundle(BundleKind::Physics)[condition.nominal()]);
        }
        ExportedRole::Representative => {
            result_of(analysis, condition)?.representative_name(BundleKind::Physics)
        }
        ExportedRole::Named(name) => name,
    };
    match condition.model(BundleKind::Physics, name) {
        Some(model) => Ok(model),
        None => Err(ExportFault::NoModel {
            condition: condition.id(),
            model: name.to_owned(),
        }),
    }
}

/// Returns a condition's requested correction: its own; the schedule's at its flight state, with or
/// without leads; or that of a schedule fitted to the other conditions.
fn correction_of(
    analysis: &Analysis,
    which: AssessedCorrection,
    condition: &Condition,
) -> Result<ChannelCorrection, ExportFault> {
    match which {
        AssessedCorrection::Own => Ok(result_of(analysis, condition)?.correction.clone()),
        AssessedCorrection::Scheduled | AssessedCorrection::ScheduledWithoutLeads => {
            let schedule = analysis
                .schedule
                .as_ref()
                .map_err(|error| ExportFault::Schedule(*error))?;
            let correction = schedule.at_state(condition.flight_state());
            if which == AssessedCorrection::Scheduled {
                Ok(correction)
            } else {
                Ok(correction.without_leads())
            }
        }
        AssessedCorrection::ScheduleOfOthers => {
            let schedule = analysis
                .schedule_without(condition.id())
                .map_err(ExportFault::Schedule)?;
            Ok(schedule.at_state(condition.flight_state()))
        }
    }
}

/// Returns a condition's analysis.
///
/// # Errors
/// [`ExportFault::NoResult`] with the reason.
fn result_of<'a>(
    analysis: &'a Analysis,
    condition: &Condition,
) -> Result<&'a ConditionAnalysis, ExportFault> {
    let why = match analysis.conditions.get(&condition.id()) {
        Some(Ok(result)) => return Ok(result),
        Some(Err(failure)) => failure_text(failure, &analysis.study.dataset),
        None => "it was not analysed".to_owned(),
    };
    Err(ExportFault::NoResult {
        condition: condition.id(),
        why,
    })
}
