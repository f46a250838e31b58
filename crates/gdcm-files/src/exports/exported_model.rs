//! A corrected model of a condition, with the names of its states.

use gdcm_core::correction::{ChannelCorrection, CorrectedModel};
use gdcm_core::dataset::{BundleKind, Channel, Condition, ConditionId, Dynamics, Model, StateSpace};
use gdcm_core::study::{Analysis, AssessedCorrection, ConditionAnalysis, ExportRequest, ExportedRole};
use gdcm_core::units::{number, telling};

use super::export_fault::ExportFault;

/// A corrected model as it is written.
pub(super) struct ExportedModel {
    /// Its condition.
    pub(super) condition: ConditionId,
    /// True airspeed of the condition \[kt\].
    pub(super) airspeed_kt: f64,
    /// Name of the physics model.
    pub(super) name: String,
    /// "scheduled" or "own".
    pub(super) correction: &'static str,
    /// The matrices.
    pub(super) model: StateSpace,
    /// A name for each state.
    pub(super) states: Vec<String>,
    /// How many of them are of delays.
    delay_states: usize,
    /// How many of them are of lead filters.
    lead_states: usize,
    /// Order of the approximants of its delays; 0 in discrete time, where delays are exact.
    pub(super) pade_order: usize,
    /// Greatest phase error at the top of the band \[deg\].
    pub(super) phase_error_deg: f64,
    /// Top of the band of comparison \[rad/s\].
    pub(super) band_top_rad_s: f64,
}

/// The corrected models that a request asks for, in the dataset's order.
pub(super) fn exported_models(analysis: &Analysis, request: &ExportRequest) -> Result<Vec<ExportedModel>, ExportFault> {
    let dataset = &analysis.study.dataset;
    if let Some(condition) = request.condition.filter(|&condition| dataset.condition(condition).is_none()) {
        return Err(ExportFault::NoCondition { condition });
    }
    let asked = |condition: &&std::sync::Arc<Condition>| request.condition.is_none_or(|id| id == condition.id());
    let conditions = dataset.conditions().iter().filter(asked);
    conditions.map(|condition| exported_model(analysis, request, condition)).collect()
}

fn exported_model(
    analysis: &Analysis,
    request: &ExportRequest,
    condition: &Condition,
) -> Result<ExportedModel, ExportFault> {
    let id = condition.id();
    let model = model_of(analysis, &request.role, condition)?;
    let correction = correction_of(analysis, request.correction, condition)?;
    let Dynamics::StateSpace(dynamics) = &model.dynamics else {
        return Err(ExportFault::NoMatrices { condition: id, model: model.name.clone() });
    };
    let corrected = CorrectedModel::of(dynamics, &correction, request.pade).map_err(|error| {
        let (inputs, outputs) = analysis.study.dataset.names_of_channels();
        let words = error.words(&inputs, &outputs);
        ExportFault::Model { condition: id, model: model.name.clone(), words }
    })?;
    let band_top_rad_s = analysis.study.settings.band.max();
    let is_sampled = dynamics.timing().sample_time_s.is_some();
    Ok(ExportedModel {
        condition: id,
        airspeed_kt: condition.flight_state().airspeed_kt,
        name: model.name.clone(),
        correction: match request.correction {
            AssessedCorrection::Scheduled => "scheduled",
            AssessedCorrection::ScheduledWithoutLeads => "scheduled, without leads,",
            AssessedCorrection::ScheduleOfOthers => "of the other conditions",
            AssessedCorrection::Own => "own",
        },
        states: state_names(analysis, model, &corrected),
        delay_states: corrected.input_states.iter().chain(&corrected.output_states).sum(),
        lead_states: corrected.input_lead_states.iter().chain(&corrected.output_lead_states).sum(),
        pade_order: if is_sampled { 0 } else { request.pade.order() },
        phase_error_deg: corrected.phase_error(band_top_rad_s).to_degrees(),
        band_top_rad_s,
        model: corrected.model,
    })
}

fn model_of<'c>(analysis: &Analysis, role: &ExportedRole, condition: &'c Condition) -> Result<&'c Model, ExportFault> {
    let bundle = condition.bundle(BundleKind::Physics);
    let name = match role {
        ExportedRole::Nominal => return Ok(&bundle[condition.nominal()]),
        ExportedRole::Representative => result_of(analysis, condition)?.representative_name(BundleKind::Physics),
        ExportedRole::Named(name) => name,
    };
    let missing = || ExportFault::NoModel { condition: condition.id(), model: name.to_owned() };
    condition.model(BundleKind::Physics, name).ok_or_else(missing)
}

fn correction_of(
    analysis: &Analysis,
    which: AssessedCorrection,
    condition: &Condition,
) -> Result<ChannelCorrection, ExportFault> {
    match which {
        AssessedCorrection::Own => Ok(result_of(analysis, condition)?.correction.clone()),
        AssessedCorrection::Scheduled | AssessedCorrection::ScheduledWithoutLeads => {
            let schedule = analysis.schedule.as_ref().map_err(|error| ExportFault::Schedule(*error))?;
            let correction = schedule.at_state(condition.flight_state());
            Ok(if which == AssessedCorrection::Scheduled { correction } else { correction.without_leads() })
        }
        AssessedCorrection::ScheduleOfOthers => {
            let schedule = analysis.schedule_without(condition.id()).map_err(ExportFault::Schedule)?;
            Ok(schedule.at_state(condition.flight_state()))
        }
    }
}

fn result_of<'a>(analysis: &'a Analysis, condition: &Condition) -> Result<&'a ConditionAnalysis, ExportFault> {
    let without = |why: String| ExportFault::NoResult { condition: condition.id(), why };
    match analysis.conditions.get(&condition.id()) {
        Some(Ok(result)) => Ok(result),
        Some(Err(failure)) => Err(without(failure.to_string())),
        None => Err(without("it has no result".to_owned())),
    }
}

/// "LON lead 1" and "LON delay 1" of the inputs, the model's own names, "Q delay 1" and "Q lead 1" of the outputs.
fn state_names(analysis: &Analysis, model: &Model, corrected: &CorrectedModel) -> Vec<String> {
    let dataset = &analysis.study.dataset;
    let of_channels = |channels: &[Channel], what: &str, counts: &[usize]| -> Vec<String> {
        let of = |(channel, &count): (&Channel, &usize)| {
            let name = channel.name.clone();
            (1..=count).map(move |place| format!("{name} {what} {place}")).collect::<Vec<_>>()
        };
        channels.iter().zip(counts).flat_map(of).collect()
    };
    let mut names = of_channels(dataset.inputs(), "lead", &corrected.input_lead_states);
    names.extend(of_channels(dataset.inputs(), "delay", &corrected.input_states));
    let mut last = of_channels(dataset.outputs(), "delay", &corrected.output_states);
    last.extend(of_channels(dataset.outputs(), "lead", &corrected.output_lead_states));
    let own = corrected.model.order() - names.len() - last.len();
    names.extend((0..own).map(|state| model.state_name(state)));
    names.extend(last);
    names
}

impl ExportedModel {
    /// What it is and how exact, in one line.
    pub(super) fn words(&self) -> String {
        let Self { condition, name, correction, .. } = self;
        format!("condition {condition}, model {name}, {correction} correction: {}", self.delay_words())
    }

    /// How exact its delays are.
    pub(super) fn delay_words(&self) -> String {
        if self.pade_order == 0 && self.lead_states > 0 {
            return format!(
                "gains and delays exact, lead filters by Tustin's rule, phase error up to {} deg at {} rad/s",
                telling(self.phase_error_deg, 3),
                number(self.band_top_rad_s)
            );
        }
        if self.lead_states > 0 && self.delay_states == 0 {
            return "gains and lead filters exact".to_owned();
        }
        if self.pade_order == 0 || self.delay_states == 0 {
            return "gains and delays exact".to_owned();
        }
        format!(
            "{} exact, delays by Pade approximants of order {}, phase error up to {} deg at {} rad/s",
            if self.lead_states > 0 { "gains and lead filters" } else { "gains" },
            self.pade_order,
            telling(self.phase_error_deg, 3),
            number(self.band_top_rad_s)
        )
    }
}
