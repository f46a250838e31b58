//! Corrected models with their accuracy, ready to be written to files.

use gdcm_method::correction::corrected_model::CorrectedModel;
use gdcm_method::correction::{self, ChannelCorrection, LeadPrice};
use gdcm_model::dataset::{
    BundleKind, Channel, Condition, ConditionId, Dynamics, Model, StateSpace,
};
use gdcm_model::units::{number, telling};
use gdcm_study::{Analysis, AssessedCorrection, ConditionAnalysis, CouplingCorrection};
use gdcm_words::caution::failure_text;
use gdcm_words::lead_price::price_text;

use super::{ExportRequest, ExportedRole};
use crate::export_fault::ExportFault;
use crate::files::export_contents::{ExportContents, LeftOutPart, PartSource};

/// Returns the requested corrected models, in the order of the dataset.
pub(super) fn exported_models(
    analysis: &Analysis,
    request: &ExportRequest,
) -> Result<Vec<ExportedModel>, ExportFault> {
    let dataset = &analysis.study.dataset;
    analysis
        .asked_couplings()
        .map_err(|error| ExportFault::NoCouplings {
            why: error.words(&dataset.names_of_channels().0),
        })?;
    let Some(id) = request.condition else {
        return dataset
            .conditions()
            .iter()
            .map(|condition| exported_model(analysis, request, condition))
            .collect();
    };
    match dataset.condition(id) {
        Some(condition) => Ok(vec![exported_model(analysis, request, condition)?]),
        None => Err(ExportFault::NoCondition { condition: id }),
    }
}

/// Returns the correction parts in the requested models; none if the study lacks the requested
/// schedule.
pub(super) fn contents_of_models(analysis: &Analysis, request: &ExportRequest) -> ExportContents {
    let conditions: Vec<ConditionId> = match request.condition {
        Some(condition) => vec![condition],
        None => analysis.study.dataset.ids().collect(),
    };
    match ExportContents::of_models(analysis, request.correction, &conditions) {
        Ok(contents) => contents,
        Err(_) => ExportContents::of_scheduled(analysis),
    }
}

/// A corrected model, with the facts that describe it.
pub(super) struct ExportedModel {
    pub(super) condition: ConditionId,
    /// True airspeed \[kt\].
    pub(super) airspeed_kt: f64,
    /// Name of the physics model.
    pub(super) name: String,
    /// "scheduled" or "own".
    pub(super) correction: &'static str,
    pub(super) model: StateSpace,
    /// A name for each state.
    pub(super) states: Vec<String>,
    /// Number of states that represent delays.
    delay_states: usize,
    /// Number of states that represent lead filters.
    lead_states: usize,
    /// Order of the Padé approximants of delays; 0 in discrete time, where delays are exact.
    pub(super) pade_order: usize,
    /// Maximum phase error \[deg\] at the upper end of the band due to the Padé approximants.
    approximation_error_deg: f64,
    /// Phase lag \[deg\] at the upper end of the band due to delays in the condition's own
    /// correction that the schedule omits.
    pub(super) left_out_deg: f64,
    /// Parts of the correction that the model contains.
    pub(super) contents: ExportContents,
    /// Upper end of the band, the highest compared frequency \[rad/s\].
    pub(super) band_top_rad_s: f64,
    /// Cost of the lead filters; `None` without lead filters.
    price: Option<DescribedPrice>,
    /// Description of the couplings; empty without couplings.
    couplings: &'static str,
}

/// Cost of lead filters, with its description.
struct DescribedPrice {
    price: LeadPrice,
    words: String,
}

impl ExportedModel {
    /// Returns the maximum phase error \[deg\] at the upper end of the band due to the export, that
    /// is, to Padé approximants and omitted delays.
    pub(super) fn phase_error_deg(&self) -> f64 {
        self.approximation_error_deg + self.left_out_deg
    }

    /// Returns the frequency \[rad/s\] above which the lead filters make the model invalid;
    /// infinity without lead filters.
    pub(super) fn not_valid_above_rad_s(&self) -> f64 {
        match &self.price {
            Some(described) => described.price.limit_rad_s,
            None => f64::INFINITY,
        }
    }

    /// Returns the gain \[dB\] that the leads add to the most affected response at ten times the
    /// upper end of the band; 0 without leads.
    pub(super) fn gain_above_band_db(&self) -> f64 {
        match &self.price {
            Some(DescribedPrice { price, .. }) => {
                greatest(&price.gains_db.inputs) + greatest(&price.gains_db.outputs)
            }
            None => 0.0,
        }
    }

    /// Describes the model and its accuracy in a single line.
    pub(super) fn words(&self) -> String {
        let price = match &self.price {
            Some(described) => format!("; {}", described.words),
            None => String::new(),
        };
        format!(
            "condition {}, model {}, {} correction: {}{}{}{price}",
            self.condition,
            self.name,
            self.correction,
            self.delay_words(),
            self.left_out_words(),
            self.couplings
        )
    }

    /// Describes the omitted delays of the condition's own correction, and their phase lag at the
    /// upper end of the band; empty without omitted delays.
    fn left_out_words(&self) -> String {
        if self.left_out_deg == 0.0 {
            return String::new();
        }
        let left_out = telling(self.left_out_deg, 3);
        let top = number(self.band_top_rad_s);
        format!(
            "; the delays of the condition's own correction are left out, which causes a phase \
            error of up to {left_out} deg at {top} rad/s"
        )
    }

    /// Describes the parts in the model and their accuracy; omitted delays are not mentioned.
    ///
    /// A part is exact unless it is approximated: in discrete time (`pade_order` 0), lead filters by
    /// Tustin's rule; in continuous time, delays by Padé approximants.
    fn delay_words(&self) -> String {
        let has_delays = self.contents.delays != PartSource::None;
        let has_leads = self.lead_states > 0;
        if self.pade_order == 0 && has_leads {
            return format!(
                "gains and delays exact, lead filters by Tustin's rule, phase error up to {} deg at {} rad/s",
                bound_words(self.approximation_error_deg),
                number(self.band_top_rad_s)
            );
        }
        if has_leads && self.delay_states == 0 {
            return "gains and lead filters exact".to_owned();
        }
        if self.pade_order == 0 || self.delay_states == 0 {
            let words = match (has_delays, self.delay_states) {
                (true, _) => "gains and delays exact",
                (false, 0) => "gains exact, without delays",
                // In discrete time, the model's own delays are whole samples, and therefore exact.
                (false, _) => "gains and the model's own delays exact",
            };
            return words.to_owned();
        }
        let exact = if has_leads {
            "gains and lead filters"
        } else {
            "gains"
        };
        let approximated = if has_delays {
            "delays"
        } else {
            "the model's own delays"
        };
        format!(
            "{exact} exact, {approximated} by Pade approximants of order {}, phase error up to {} deg at {} rad/s",
            self.pade_order,
            bound_words(self.approximation_error_deg),
            number(self.band_top_rad_s)
        )
    }
}

fn greatest(gains_db: &[f64]) -> f64 {
    gains_db.iter().copied().fold(0.0, f64::max)
}

/// Formats an upper bound on a phase error \[deg\]; a nonzero bound below 0.001 is given as 0.001.
fn bound_words(error_deg: f64) -> String {
    /// Minimum reported bound.
    const LEAST_DEG: f64 = 1e-3;
    let bound_deg = if error_deg > 0.0 {
        error_deg.max(LEAST_DEG)
    } else {
        0.0
    };
    format!("{bound_deg:.3}")
}

fn exported_model(
    analysis: &Analysis,
    request: &ExportRequest,
    condition: &Condition,
) -> Result<ExportedModel, ExportFault> {
    let id = condition.id();
    let (inputs, outputs) = analysis.study.dataset.names_of_channels();
    let model = model_of(analysis, &request.role, condition)?;
    let correction = correction_of(analysis, request.correction, condition)?;
    let Dynamics::StateSpace(dynamics) = &model.dynamics else {
        return Err(ExportFault::NoMatrices {
            condition: id,
            model: model.name.clone(),
        });
    };
    let corrected = analysis
        .corrected_model(condition, dynamics, &correction, request.pade)
        .map_err(|error| ExportFault::Model {
            condition: id,
            model: model.name.clone(),
            words: error.words(&inputs, &outputs),
        })?;
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
        states: state_names(analysis, model, &corrected),
        delay_states: corrected
            .delay_states
            .iter()
            .map(|(_, states)| states)
            .sum(),
        lead_states: corrected.lead_states.iter().map(|(_, states)| states).sum(),
        pade_order: if is_sampled { 0 } else { request.pade.order() },
        approximation_error_deg: corrected.phase_error(band_top_rad_s).to_degrees(),
        left_out_deg: left_out_phase_deg(&contents, band_top_rad_s),
        contents,
        band_top_rad_s,
        price: price.map(|price| DescribedPrice {
            words: price_text(&price, &inputs, &outputs),
            price,
        }),
        couplings: couplings_words(analysis, dynamics),
        model: corrected.model,
    })
}

/// Returns the phase lag \[deg\] at `omega` \[rad/s\] of the omitted delays: the longest input
/// delay plus the longest output delay over all conditions.
fn left_out_phase_deg(contents: &ExportContents, omega: f64) -> f64 {
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

/// Names the correction in the description of an exported model.
fn correction_words(correction: AssessedCorrection) -> &'static str {
    match correction {
        AssessedCorrection::Scheduled => "scheduled",
        AssessedCorrection::ScheduledWithoutLeads => "scheduled, without leads,",
        AssessedCorrection::ScheduleOfOthers => "of the other conditions",
        AssessedCorrection::Own => "own",
    }
}

/// Describes the couplings in a model; empty if there are none.
fn couplings_words(analysis: &Analysis, dynamics: &StateSpace) -> &'static str {
    let has_delays =
        !StateSpace::timing(dynamics).is_plain() && dynamics.timing().sample_time_s.is_none();
    match (
        analysis.fitted_couplings(),
        analysis.study.settings.couplings,
    ) {
        (None, _) => "",
        (Some(_), CouplingCorrection::MixingAndFeedback) if has_delays => {
            "; with mixing and feedback; the model's own delays are inside the loop, as Pade \
            approximants"
        }
        (Some(_), CouplingCorrection::MixingAndFeedback) => "; with mixing and feedback, exact",
        (Some(_), _) => "; with mixing, exact",
    }
}

/// Returns the physics model of a condition that `role` selects.
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

/// Returns the requested correction of a condition.
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

/// Returns the analysis of a condition.
fn result_of<'a>(
    analysis: &'a Analysis,
    condition: &Condition,
) -> Result<&'a ConditionAnalysis, ExportFault> {
    let why = match analysis.conditions.get(&condition.id()) {
        Some(Ok(result)) => return Ok(result),
        Some(Err(failure)) => failure_text(failure, &analysis.study.dataset),
        None => "it has no result".to_owned(),
    };
    Err(ExportFault::NoResult {
        condition: condition.id(),
        why,
    })
}

/// Returns the state names, in this order: "LON lead 1" and "LON delay 1" for inputs, the names of
/// the model's states, "Q delay 1" and "Q lead 1" for outputs.
fn state_names(analysis: &Analysis, model: &Model, corrected: &CorrectedModel) -> Vec<String> {
    let CorrectedModel {
        lead_states,
        delay_states,
        ..
    } = corrected;
    let inputs = analysis.study.dataset.inputs();
    let outputs = analysis.study.dataset.outputs();
    let mut names = Vec::with_capacity(corrected.model.order());
    add_state_names(&mut names, inputs, "lead", &lead_states.inputs);
    add_state_names(&mut names, inputs, "delay", &delay_states.inputs);
    let mut last = Vec::new();
    add_state_names(&mut last, outputs, "delay", &delay_states.outputs);
    add_state_names(&mut last, outputs, "lead", &lead_states.outputs);
    let own_states = corrected.model.order() - names.len() - last.len();
    for state in 0..own_states {
        names.push(model.state_name(state));
    }
    names.extend(last);
    names
}

/// Adds names of the states of `part` ("lead", "delay"), counted from 1 within each channel.
fn add_state_names(names: &mut Vec<String>, channels: &[Channel], part: &str, counts: &[usize]) {
    for (channel, &count) in channels.iter().zip(counts) {
        for place in 1..=count {
            names.push(format!("{} {part} {place}", channel.name));
        }
    }
}
