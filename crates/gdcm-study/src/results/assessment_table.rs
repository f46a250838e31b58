//! Benefit of a correction, response by response and condition by condition, for the chosen model
//! and correction (M12, Figures 8 to 19).

use std::sync::Arc;

use gdcm_method::correction::ChannelCorrection;
use gdcm_method::fidelity::CostAverage;
use gdcm_method::schedule::ScheduleError;
use gdcm_method::schedule::assessment::{CostChange, corrected_cost};
use gdcm_model::dataset::{BundleKind, ConditionId, Dataset, Pair, PairTable};
use gdcm_model::progress::{Cancelled, Progress};
use gdcm_model::response::GainDelay;
use gdcm_model::units::{number, signed};

use super::analysis::{Analysis, ConditionAnalysis};
use crate::decisions::settings::Settings;
use crate::jobs::job::{Job, Shared};
use crate::stages::comparison::ModelMismatch;
use crate::stages::execution::in_turn;

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
    /// The schedule without the lead filters of its signed delays (M15).
    ScheduledWithoutLeads,
    /// The schedule of the other conditions at the condition's airspeed: a prediction for a flight
    /// not used in the fit.
    ScheduleOfOthers,
    /// The condition's own optimum.
    Own,
}

impl AssessedCorrection {
    /// Returns the correction of a condition.
    ///
    /// # Errors
    /// [`ScheduleError`] where the requested schedule does not exist.
    pub fn of(
        self,
        analysis: &Analysis,
        result: &ConditionAnalysis,
    ) -> Result<ChannelCorrection, ScheduleError> {
        let id = result.condition.id();
        let state = result.condition.flight_state();
        let scheduled = || {
            analysis
                .schedule
                .as_ref()
                .map(|schedule| schedule.at_state(state))
                .map_err(|error| *error)
        };
        match self {
            Self::Own => Ok(result.correction.clone()),
            Self::Scheduled => scheduled(),
            Self::ScheduledWithoutLeads => Ok(scheduled()?.without_leads()),
            Self::ScheduleOfOthers => Ok(analysis.schedule_without(id)?.at_state(state)),
        }
    }

    /// Returns the origin of the correction in words.
    pub(crate) fn source(self, airspeed_kt: f64) -> String {
        let at = format!("at {} kt", number(airspeed_kt));
        match self {
            Self::Own => "the condition's own optimum".to_owned(),
            Self::Scheduled => format!("the schedule {at}"),
            Self::ScheduledWithoutLeads => format!("the schedule {at}, its leads left out"),
            Self::ScheduleOfOthers => format!("the schedule of the other conditions {at}"),
        }
    }
}

/// Choices of an assessment: model, correction and average.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct AssessmentChoice {
    pub model: AssessedModel,
    pub correction: AssessedCorrection,
    /// Average of squared errors over frequency in J.
    pub average: CostAverage,
}

impl AssessmentChoice {
    /// The paper's assessment: the nominal model under the schedule.
    pub(crate) fn of_paper(settings: &Settings) -> Self {
        let model = AssessedModel::Nominal;
        let correction = AssessedCorrection::Scheduled;
        Self {
            model,
            correction,
            average: settings.cost_average,
        }
    }
}

/// Assessment of one condition.
#[derive(Clone, Debug, PartialEq)]
pub struct AssessedCondition {
    pub condition: ConditionId,
    /// True airspeed \[kt\].
    pub airspeed_kt: f64,
    pub model: String,
    /// J of each response before and after, against the identified representative.
    pub changes: PairTable<Option<CostChange>>,
    /// Why a response has no J.
    pub missing: Vec<(Pair, String)>,
}

/// A condition left out of an assessment, and why.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LeftOut {
    pub condition: ConditionId,
    pub why: String,
}

/// J before and after of every response of every condition (M12).
#[derive(Clone, Debug, PartialEq)]
pub struct AssessmentTable {
    pub choice: AssessmentChoice,
    pub conditions: Vec<AssessedCondition>,
    pub left_out: Vec<LeftOut>,
}

/// Summary of an assessment: how many responses come closer, and which moves farthest away.
#[derive(Clone, Debug, PartialEq)]
pub struct AssessmentSummary {
    /// Number of responses whose J decreases.
    pub better: usize,
    /// Number of responses compared, counted in each condition.
    pub compared: usize,
    /// The response with the greatest change of J, and the change.
    pub worst: Option<(ConditionId, Pair, f64)>,
}

impl AssessmentTable {
    /// Assesses an analysis from its stored mismatches: two averages over frequency for each
    /// response.
    pub fn of(analysis: &Analysis, choice: AssessmentChoice) -> Self {
        let mut table = Self {
            choice,
            conditions: Vec::new(),
            left_out: Vec::new(),
        };
        analysis
            .study
            .dataset
            .ids()
            .for_each(|id| table.add(analysis, id));
        table
    }

    fn add(&mut self, analysis: &Analysis, condition: ConditionId) {
        match assessed(analysis, condition, self.choice) {
            Ok(found) => self.conditions.push(found),
            Err(why) => self.left_out.push(LeftOut { condition, why }),
        }
    }

    /// Returns J before and after of one response in one condition.
    pub fn change(&self, condition: ConditionId, pair: Pair) -> Option<CostChange> {
        self.conditions
            .iter()
            .find(|assessed| assessed.condition == condition)?
            .changes[pair]
    }

    /// Summarises the assessment of the marked responses.
    pub fn summary(&self, marked: &PairTable<bool>) -> AssessmentSummary {
        let mut summary = AssessmentSummary {
            better: 0,
            compared: 0,
            worst: None,
        };
        for assessed in &self.conditions {
            for (pair, change) in marked
                .marked()
                .filter_map(|pair| Some((pair, assessed.changes[pair]?.total())))
            {
                summary.compared += 1;
                summary.better += usize::from(change < 0.0);
                if summary.worst.is_none_or(|(.., worst)| change > worst) {
                    summary.worst = Some((assessed.condition, pair, change));
                }
            }
        }
        summary
    }
}

impl AssessmentSummary {
    /// Writes the sentence: "better in 41 of 50, worst PED → NY in condition 5: +12.3".
    pub fn words(&self, dataset: &Dataset) -> String {
        let Some((condition, pair, change)) = self.worst else {
            return "nothing to assess".to_owned();
        };
        let pair = dataset.pair_name(pair);
        let change = signed(change, 1);
        format!(
            "better in {} of {}, worst {pair} in condition {condition}: {change}",
            self.better, self.compared
        )
    }
}

/// Compares the schedule on the held-out conditions with the conditions in its fit: "held out (3,
/// 8): better in 9 of 10 on-axis responses, mean ΔJ −12.3; the others: better in 40 of 45, mean ΔJ
/// −15.0". `None` where no condition is held out.
pub fn held_out_verdict(analysis: &Analysis, choice: AssessmentChoice) -> Option<String> {
    let is_held_out = |id: ConditionId| analysis.study.choice(id).held_out;
    let held_out = analysis.study.dataset.ids().filter(|id| is_held_out(*id));
    let held_out: Vec<String> = held_out.map(|id| id.to_string()).collect();
    if held_out.is_empty() {
        return None;
    }
    let table = AssessmentTable::of(analysis, choice);
    let measuring = analysis.study.dataset.measuring_pairs();
    let words = |wanted: bool| {
        let conditions = table
            .conditions
            .iter()
            .filter(|of| is_held_out(of.condition) == wanted);
        let changes = conditions.flat_map(|of| {
            measuring
                .marked()
                .filter_map(|pair| Some(of.changes[pair]?.total()))
        });
        let changes: Vec<f64> = changes.collect();
        if changes.is_empty() {
            return "nothing to assess".to_owned();
        }
        let better = changes.iter().filter(|change| **change < 0.0).count();
        let mean = changes.iter().sum::<f64>() / changes.len() as f64;
        format!(
            "better in {better} of {} responses, mean ΔJ {}",
            changes.len(),
            signed(mean, 1)
        )
    };
    Some(format!(
        "held out ({}): {}; the others: {}",
        held_out.join(", "),
        words(true),
        words(false)
    ))
}

/// Assesses one condition, or returns why it is left out.
pub(crate) fn assessed(
    analysis: &Analysis,
    id: ConditionId,
    choice: AssessmentChoice,
) -> Result<AssessedCondition, String> {
    let result = analysis.result(id);
    let condition = analysis
        .study
        .dataset
        .condition(id)
        .ok_or("it was not analysed")?;
    let nominal = &condition.bundle(BundleKind::Physics)[condition.nominal()].name;
    let by_nominal = choice.model == AssessedModel::Nominal;
    if by_nominal && analysis.study.choice(id).physics.rejected.contains(nominal) {
        return Err("the nominal model is rejected".to_owned());
    }
    let result = result?;
    let airspeed_kt = condition.flight_state().airspeed_kt;
    let correction = choice
        .correction
        .of(analysis, result)
        .map_err(|error| error.to_string())?;
    let models = if by_nominal {
        &result.comparison.nominal
    } else {
        &result.comparison.representative
    };
    let changes = changes(analysis, models, &correction, choice.average);
    let model = if by_nominal {
        nominal.as_str()
    } else {
        result.representative_name(BundleKind::Physics)
    };
    let missing = missing(result, models, &changes);
    Ok(AssessedCondition {
        condition: id,
        airspeed_kt,
        model: model.to_owned(),
        changes,
        missing,
    })
}

fn changes(
    analysis: &Analysis,
    models: &ModelMismatch,
    correction: &ChannelCorrection,
    average: CostAverage,
) -> PairTable<Option<CostChange>> {
    let omega = &analysis.omega;
    let is_known = average == analysis.study.settings.cost_average;
    let corrected = corrected_cost(&models.mismatch, correction, omega, average);
    corrected.map(|pair, corrected| {
        let uncorrected = || {
            Some(
                models.mismatch[pair]
                    .as_ref()?
                    .cost(omega, GainDelay::NONE, average),
            )
        };
        let uncorrected = if is_known {
            models.cost[pair]?
        } else {
            uncorrected()?
        };
        Some(CostChange {
            uncorrected,
            corrected: (*corrected)?,
        })
    })
}

fn missing(
    result: &ConditionAnalysis,
    models: &ModelMismatch,
    changes: &PairTable<Option<CostChange>>,
) -> Vec<(Pair, String)> {
    let without = changes
        .iter()
        .filter(|(_, change)| change.is_none())
        .map(|(pair, _)| pair);
    let why = |pair: Pair| {
        match (&models.mismatch[pair], result.comparison.undefined[pair]) {
        (Some(_), _) => "the scheduled net gain is not positive".to_owned(),
        (None, Some(why)) => why.to_string(),
        (None, None) => {
            "the nominal model's response is zero, numerically nothing or not finite somewhere in the band".to_owned()
        }
    }
    };
    without.map(|pair| (pair, why(pair))).collect()
}

/// Job for an assessment of hundreds of conditions, which may take longer than a frame.
#[derive(Clone, Debug, PartialEq)]
pub struct AssessmentJob {
    pub analysis: Shared<Analysis>,
    pub choice: AssessmentChoice,
}

impl Job for AssessmentJob {
    type Tools = ();
    type Output = Arc<AssessmentTable>;

    fn run(&self, (): &mut (), progress: &dyn Progress) -> Result<Self::Output, Cancelled> {
        let mut table = AssessmentTable {
            choice: self.choice,
            conditions: Vec::new(),
            left_out: Vec::new(),
        };
        let conditions = self.analysis.study.dataset.conditions();
        in_turn(conditions, progress, |condition| {
            table.add(&self.analysis, condition.id())
        })?;
        Ok(Arc::new(table))
    }
}
