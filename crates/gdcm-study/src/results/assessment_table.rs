//! Changes in J due to a correction, by response and condition, for the chosen model and correction
//! (M12, Figures 8 to 19).
//!
//! J is the cost of a response's mismatch to the identified representative, smaller is better (M4).
//! The *representative* of the physics or identified models, its *bundle*, is the model closest to
//! the others, or the engineer's choice (M5).
//! The schedule gives the correction as a function of airspeed (M11). The figures are those of the
//! paper that the crate `gdcm-method` cites.

use gdcm_method::correction::ChannelCorrection;
use gdcm_method::fidelity::CostAverage;
use gdcm_method::schedule::assessment::corrected_cost;
use gdcm_method::schedule::{CostChange, ScheduleError};
use gdcm_model::dataset::{BundleKind, ConditionId, Pair, PairTable};
use gdcm_model::response::GainDelay;

use super::analysis::{Analysis, ConditionAnalysis, NotAssessed};
use super::caution::Undefined;
use super::comparison::ModelMismatch;
use crate::decisions::settings::Settings;

/// The physics model that is assessed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum AssessedModel {
    /// The model at the condition's own trim (the paper).
    #[default]
    Nominal,
    /// The model that represents its bundle.
    Representative,
}

/// The correction that is assessed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum AssessedCorrection {
    /// The schedule at the condition's airspeed (the paper).
    #[default]
    Scheduled,
    /// The schedule without its lead filters (M15): gains and positive delays only.
    ScheduledWithoutLeads,
    /// The schedule fitted without this condition, at its airspeed: a prediction for a flight not
    /// used in the fit.
    ScheduleOfOthers,
    /// The condition's own optimum.
    Own,
}

impl AssessedCorrection {
    /// Returns a condition's correction.
    ///
    /// # Errors
    /// [`ScheduleError`] where the requested schedule does not exist.
    pub fn correction(
        self,
        analysis: &Analysis,
        result: &ConditionAnalysis,
    ) -> Result<ChannelCorrection, ScheduleError> {
        let state = result.condition.flight_state();
        let schedule = match self {
            Self::Own => return Ok(result.correction.clone()),
            Self::ScheduleOfOthers => {
                let others = analysis.schedule_without(result.condition.id())?;
                return Ok(others.at_state(state));
            }
            Self::Scheduled | Self::ScheduledWithoutLeads => {
                analysis.schedule.as_ref().map_err(|error| *error)?
            }
        };
        let scheduled = schedule.at_state(state);
        if self == Self::ScheduledWithoutLeads {
            Ok(scheduled.without_leads())
        } else {
            Ok(scheduled)
        }
    }
}

/// An assessment's choices: model, correction and average.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct AssessmentChoice {
    pub model: AssessedModel,
    pub correction: AssessedCorrection,
    /// How J averages squared errors over frequency.
    pub average: CostAverage,
}

impl AssessmentChoice {
    /// Returns the paper's choices: the nominal model under the schedule.
    pub(crate) fn of_paper(settings: &Settings) -> Self {
        Self {
            model: AssessedModel::Nominal,
            correction: AssessedCorrection::Scheduled,
            average: settings.cost_average,
        }
    }
}

/// Assessed condition: J before and after the correction, response by response.
#[derive(Clone, Debug, PartialEq)]
pub struct AssessedCondition {
    pub condition: ConditionId,
    /// True airspeed \[kt\].
    pub airspeed_kt: f64,
    pub model: String,
    /// J against the identified representative before and after the correction, response by
    /// response.
    pub changes: PairTable<Option<CostChange>>,
    /// Responses without J, each with the reason.
    pub missing: Vec<(Pair, MissingCost)>,
}

/// Why a response has no J before and after the correction.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MissingCost {
    /// The correction's net gain in this response is not positive.
    NetGainNotPositive,
    /// The representatives cannot be compared in this response.
    Undefined(Undefined),
    /// The nominal model has no usable response for this pair.
    NominalUndefined,
}

impl MissingCost {
    /// Returns the stable code, for programs and tests.
    pub fn code(self) -> &'static str {
        match self {
            Self::NetGainNotPositive => "net-gain-not-positive",
            Self::Undefined(why) => why.code(),
            Self::NominalUndefined => "nominal-response-undefined",
        }
    }
}

/// A condition that an assessment leaves out, and why.
#[derive(Clone, Debug, PartialEq)]
pub struct LeftOut {
    pub condition: ConditionId,
    pub why: NotAssessed,
}

/// J before and after the correction, for every condition and response (M12).
#[derive(Clone, Debug, PartialEq)]
pub struct AssessmentTable {
    pub choice: AssessmentChoice,
    pub conditions: Vec<AssessedCondition>,
    pub left_out: Vec<LeftOut>,
}

/// Assessment summary over all conditions and the marked responses.
#[derive(Clone, Debug, PartialEq)]
pub struct AssessmentSummary {
    /// Number of responses with a lower J.
    pub better: usize,
    /// Number of compared responses, summed over the conditions.
    pub compared: usize,
    /// The response whose J rises most, or falls least if no J rises, and its change.
    pub worst: Option<(ConditionId, Pair, f64)>,
}

impl AssessmentTable {
    /// Creates a table without conditions.
    pub(crate) fn new(choice: AssessmentChoice) -> Self {
        Self {
            choice,
            conditions: Vec::new(),
            left_out: Vec::new(),
        }
    }

    /// Assesses all conditions. The stored mismatches are used: each response costs at most two
    /// averages over frequency.
    pub fn assess(analysis: &Analysis, choice: AssessmentChoice) -> Self {
        let mut table = Self::new(choice);
        for id in analysis.study.dataset.ids() {
            table.add(analysis, id);
        }
        table
    }

    /// Assesses a condition, and appends the result or the reason for leaving it out.
    pub(crate) fn add(&mut self, analysis: &Analysis, condition: ConditionId) {
        match assessed(analysis, condition, self.choice) {
            Ok(assessed) => self.conditions.push(assessed),
            Err(why) => self.left_out.push(LeftOut { condition, why }),
        }
    }

    /// Returns a response's J in a condition before and after the correction.
    pub fn change(&self, condition: ConditionId, pair: Pair) -> Option<CostChange> {
        self.conditions
            .iter()
            .find(|assessed| assessed.condition == condition)?
            .changes[pair]
    }

    /// Summarises the assessment over the marked responses.
    pub fn summary(&self, marked: &PairTable<bool>) -> AssessmentSummary {
        let mut summary = AssessmentSummary {
            better: 0,
            compared: 0,
            worst: None,
        };
        for assessed in &self.conditions {
            for pair in marked.marked() {
                let Some(change) = assessed.changes[pair] else {
                    continue;
                };
                let change = change.total();
                summary.compared += 1;
                if change < 0.0 {
                    summary.better += 1;
                }
                if summary.worst.is_none_or(|(.., worst)| change > worst) {
                    summary.worst = Some((assessed.condition, pair, change));
                }
            }
        }
        summary
    }
}

/// Assesses a condition.
///
/// # Errors
/// [`NotAssessed`] where the condition is left out: the first that applies of not in the dataset,
/// nominal model rejected (if that is assessed), not analysed, no result, no schedule.
pub fn assessed(
    analysis: &Analysis,
    id: ConditionId,
    choice: AssessmentChoice,
) -> Result<AssessedCondition, NotAssessed> {
    let condition = analysis
        .study
        .dataset
        .condition(id)
        .ok_or(NotAssessed::NotAnalysed)?;
    let nominal = &condition.bundle(BundleKind::Physics)[condition.nominal()].name;
    let is_nominal = choice.model == AssessedModel::Nominal;
    if is_nominal && analysis.study.choice(id).physics.rejected.contains(nominal) {
        return Err(NotAssessed::NominalRejected);
    }
    let result = match analysis.conditions.get(&id) {
        None => return Err(NotAssessed::NotAnalysed),
        Some(Err(failure)) => return Err(NotAssessed::NoResult(failure.clone())),
        Some(Ok(result)) => result,
    };
    let correction = choice
        .correction
        .correction(analysis, result)
        .map_err(NotAssessed::NoSchedule)?;
    let (model, mismatches) = if is_nominal {
        (nominal.as_str(), &result.comparison.nominal)
    } else {
        (
            result.representative_name(BundleKind::Physics),
            &result.comparison.representative,
        )
    };
    let changes = changes(analysis, mismatches, &correction, choice.average);
    let missing = changes
        .iter()
        .filter(|(_, change)| change.is_none())
        .map(|(pair, _)| (pair, missing_cost(result, mismatches, pair)))
        .collect();
    Ok(AssessedCondition {
        condition: id,
        airspeed_kt: condition.flight_state().airspeed_kt,
        model: model.to_owned(),
        changes,
        missing,
    })
}

/// Computes a model's J before and after a correction, response by response.
fn changes(
    analysis: &Analysis,
    mismatches: &ModelMismatch,
    correction: &ChannelCorrection,
    average: CostAverage,
) -> PairTable<Option<CostChange>> {
    let omega = &analysis.omega;
    // J before the correction is stored only for the average chosen in the study.
    let is_stored = average == analysis.study.settings.cost_average;
    let corrected = corrected_cost(&mismatches.mismatch, correction, omega, average);
    corrected.map(|pair, corrected| {
        let uncorrected = if is_stored {
            mismatches.cost[pair]?
        } else {
            let mismatch = mismatches.mismatch[pair].as_ref()?;
            mismatch.cost(omega, GainDelay::NONE, average)
        };
        Some(CostChange {
            uncorrected,
            corrected: (*corrected)?,
        })
    })
}

/// Returns why a response has no J: with a mismatch, the correction's net gain; without one, why
/// the representatives cannot be compared; else the nominal model's response.
fn missing_cost(result: &ConditionAnalysis, mismatches: &ModelMismatch, pair: Pair) -> MissingCost {
    if mismatches.mismatch[pair].is_some() {
        return MissingCost::NetGainNotPositive;
    }
    match result.comparison.undefined[pair] {
        Some(why) => MissingCost::Undefined(why),
        None => MissingCost::NominalUndefined,
    }
}
