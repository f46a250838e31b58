//! Simulations of the models of every condition, compared with flight records within tolerances
//! (M17.2).
//!
//! ```text
//! 1  a record is prepared as for identification, but pieces of 2 s and more are used
//! 2  each model is simulated with the recorded inputs in windows of at most 10 s, each with
//!    estimated initial state and offsets (M14, section 6); all models of a condition have the same
//!    windows, so that the compared manoeuvres begin at the same samples
//! 3  each row of the tolerance table whose output and unit exist: share inside, largest excess,
//!    correlation
//! ```

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use serde::Serialize;

use gdcm_method::requirements::rms_cost::RmsCost;
use gdcm_method::requirements::{RecordCheck, Tolerance, ToleranceTable};
use gdcm_model::dataset::{ConditionId, StateSpace};
use gdcm_model::executor::Sequential;
use gdcm_model::progress::Cancelled;
use gdcm_model::simulation::{
    FlightRecord, Segment, ValidationSettings, ValidationWindow, validate,
};
use gdcm_sysid::identification::Preparation;
use gdcm_sysid::records::LaidOutRecord;
use gdcm_sysid::spectra::preparation::segments_of;

use super::analysis::{Analysis, ConditionAnalysis};
use super::missing_finding::{MissingFinding, MissingReason, NoRoleModel, NotCompared};
use super::record_comparison::{
    AppliedTolerance, RecordComparison, Trend, common_windows, comparison_preparation,
};
use super::requirement_role::{RequirementRole, RoleModelError};
use crate::execution::Execution;
use crate::shared::Shared;

/// Name of the missing item in [`MissingFinding`].
const WHAT: &str = "time histories";

/// A flight record with which models are compared.
#[derive(Clone, Debug, PartialEq)]
pub struct HistoryRecord {
    pub flight: Shared<FlightRecord>,
    /// Whether the record was excluded from the models' identification.
    pub held_out: bool,
}

/// A condition's flight records, and their preparation.
#[derive(Clone, Debug, PartialEq)]
pub struct HistoryRecords {
    pub condition: ConditionId,
    pub records: Vec<HistoryRecord>,
    pub preparation: Preparation,
}

impl HistoryRecords {
    /// Collects those `records` of a condition that are in use, with their preparation.
    pub fn from_used<'r>(
        condition: ConditionId,
        records: impl IntoIterator<Item = &'r LaidOutRecord>,
        preparation: Preparation,
    ) -> Self {
        let mut used = Vec::new();
        for record in records {
            if let Some(flight) = record.used_flight() {
                used.push(HistoryRecord {
                    flight: Arc::clone(flight).into(),
                    held_out: record.guess.held_out,
                });
            }
        }
        Self {
            condition,
            records: used,
            preparation,
        }
    }

    /// Returns the step count of [`time_histories_of`]: one step to prepare each record, and one
    /// for each simulation of a model with it.
    pub fn steps(records: &[Self]) -> usize {
        (1 + RequirementRole::ALL.len()) * records.iter().map(|of| of.records.len()).sum::<usize>()
    }
}

/// Result of a model for a record and a row of the tolerance table.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ToleranceFinding {
    /// Name of the compared quantity ("bank angle").
    pub quantity: String,
    /// Output from which the quantity is computed.
    pub output: String,
    /// Whether the output is integrated from the start of each window.
    pub integrated: bool,
    /// Unit of the compared quantity.
    pub unit: String,
    /// Share of time inside the tolerance, 0 to 1.
    pub share_inside: f64,
    /// Maximum distance beyond the corridor, in `unit`; negative where all samples are inside.
    pub largest_excess: f64,
    /// Time of the largest excess, on the time axis of the record \[s\].
    pub largest_excess_at_s: f64,
    /// Correlation of simulated and measured signal about their means; `None` where either is
    /// constant.
    pub correlation: Option<f64>,
    /// Whether the output is on-axis to the input with the largest variation; `None` where that
    /// input cannot be determined.
    pub on_axis: Option<bool>,
    /// Trend of an off-axis output, from the sign of the correlation.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub trend: Option<Trend>,
}

impl ToleranceFinding {
    /// Returns the values with their names.
    pub fn quantities(&self) -> [(&'static str, Option<f64>); 4] {
        [
            ("share_inside", Some(self.share_inside)),
            ("largest_excess", Some(self.largest_excess)),
            ("largest_excess_at_s", Some(self.largest_excess_at_s)),
            ("correlation", self.correlation),
        ]
    }
}

/// Result of a model for a record.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct HistoryFinding {
    pub condition: ConditionId,
    /// True airspeed of the condition \[kt\].
    pub airspeed_kt: f64,
    pub record: String,
    /// Whether the record was excluded from the models' identification.
    pub held_out: bool,
    pub role: RequirementRole,
    pub model: String,
    /// Input with the largest variation; `None` where the inputs have different units.
    pub moved_input: Option<String>,
    /// Number of compared samples.
    pub samples: usize,
    /// Number of windows that contain these samples.
    pub windows: usize,
    /// Length of the longest window \[s\].
    pub window_s: f64,
    /// Weighted rms error (M17.4) \[deg, deg/s, ft/s, ft/s^2\]; `None` where no output has such a
    /// unit.
    pub j_rms: Option<f64>,
    /// Outputs excluded from `j_rms`, because they have no such unit.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub j_rms_left_out: Vec<String>,
    /// Theil's coefficient by output name, 0 to 1; constant outputs have none.
    pub theil: BTreeMap<String, f64>,
    /// Result for each applicable row of the tolerance table.
    pub tolerances: Vec<ToleranceFinding>,
}

/// Comparisons of simulations with all flight records, in the format of the export.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct TimeHistories {
    pub tolerance_table: ToleranceTable,
    /// One result for each record and simulated model.
    pub records: Vec<HistoryFinding>,
    pub missing: Vec<MissingFinding>,
}

impl TimeHistories {
    /// Returns the conditions with records, and the number of records of each.
    pub fn conditions(&self) -> Vec<(ConditionId, usize)> {
        let mut conditions = Vec::new();
        for findings in self.records.chunk_by(|a, b| a.condition == b.condition) {
            let id = findings[0].condition;
            // A model may be missing, and two records may have the same name; the maximum over the
            // roles counts correctly.
            let records = RequirementRole::ALL
                .map(|role| self.of_role(id, role).count())
                .into_iter()
                .max();
            conditions.push((id, records.unwrap_or_default()));
        }
        conditions
    }

    /// Returns a role's findings in a condition.
    pub fn of_role(
        &self,
        condition: ConditionId,
        role: RequirementRole,
    ) -> impl Iterator<Item = &HistoryFinding> {
        self.records
            .iter()
            .filter(move |finding| finding.condition == condition && finding.role == role)
    }

    /// Returns the share of time inside a tolerance over all records of a condition, 0 to 1.
    pub fn share_inside(
        &self,
        condition: ConditionId,
        role: RequirementRole,
        quantity: &str,
    ) -> Option<f64> {
        self.mean(condition, role, |finding| {
            let tolerance = finding
                .tolerances
                .iter()
                .find(|tolerance| tolerance.quantity == quantity)?;
            Some(tolerance.share_inside)
        })
    }

    /// Returns `J_rms` over all records of a condition: the root mean square over the samples.
    pub fn j_rms(&self, condition: ConditionId, role: RequirementRole) -> Option<f64> {
        self.mean(condition, role, |finding| Some(finding.j_rms?.powi(2)))
            .map(f64::sqrt)
    }

    /// Returns the Theil coefficient of an output over all records of a condition: the mean
    /// weighted by the number of samples.
    pub fn theil(
        &self,
        condition: ConditionId,
        role: RequirementRole,
        output: &str,
    ) -> Option<f64> {
        self.mean(condition, role, |finding| {
            finding.theil.get(output).copied()
        })
    }

    /// Averages a quantity over those records of a condition that have it, weighted by the number
    /// of samples.
    fn mean(
        &self,
        condition: ConditionId,
        role: RequirementRole,
        value: impl Fn(&HistoryFinding) -> Option<f64>,
    ) -> Option<f64> {
        let mut sum = 0.0;
        let mut samples = 0.0;
        for finding in self.of_role(condition, role) {
            if let Some(value) = value(finding) {
                sum += value * finding.samples as f64;
                samples += finding.samples as f64;
            }
        }
        if samples > 0.0 {
            Some(sum / samples)
        } else {
            None
        }
    }

    /// Returns the outputs with a Theil coefficient.
    pub fn moved_outputs(&self) -> BTreeSet<&str> {
        self.records
            .iter()
            .flat_map(|finding| finding.theil.keys())
            .map(String::as_str)
            .collect()
    }

    /// Returns the quantities of the applied tolerance rows, in the order of the table.
    pub fn quantities(&self) -> impl Iterator<Item = &str> {
        self.applied_rows().map(|row| row.quantity.as_str())
    }

    /// Returns the quantities of the applied tolerance rows without integrated outputs.
    pub fn measured_quantities(&self) -> impl Iterator<Item = &str> {
        self.quantities().filter(|quantity| {
            let rows = self.tolerance_table.rows();
            !rows
                .iter()
                .any(|row| row.integrated && row.quantity == *quantity)
        })
    }

    fn applied_rows(&self) -> impl Iterator<Item = &Tolerance> {
        self.tolerance_table.rows().iter().filter(|row| {
            self.records
                .iter()
                .flat_map(|finding| &finding.tolerances)
                .any(|applied| applied.quantity == row.quantity)
        })
    }
}

/// A record prepared for simulation.
struct PreparedRecord<'a> {
    result: &'a ConditionAnalysis,
    record: &'a HistoryRecord,
    segments: Vec<Segment>,
}

/// A role's model, to be simulated with a record.
struct Simulation<'a> {
    prepared: &'a PreparedRecord<'a>,
    role: RequirementRole,
    model: &'a StateSpace,
    settings: ValidationSettings,
}

/// Simulates the models of every condition with its `records`, and compares the results within
/// `tolerances` (M17.2). The step count is [`HistoryRecords::steps`].
///
/// # Errors
/// [`Cancelled`] where `execution` is cancelled.
pub fn time_histories_of(
    analysis: &Analysis,
    records: &[HistoryRecords],
    tolerances: &ToleranceTable,
    execution: &Execution<'_>,
) -> Result<TimeHistories, Cancelled> {
    let mut missing = without_records(analysis, records);
    let comparison = RecordComparison::new(&analysis.study.dataset, tolerances);
    for why in &comparison.not_applied {
        let why = MissingReason::ToleranceNotApplied(why.clone());
        missing.push(missing_history(None, why));
    }
    let prepared = prepare_records(analysis, records, execution, &mut missing)?;
    let models = role_models(analysis, &prepared, &mut missing);
    let simulations = simulations(&prepared, &models);
    let found = execution.each(simulations.len(), 1, |index| {
        finding(&comparison, &simulations[index])
    })?;
    let mut findings = Vec::new();
    for (simulation, found) in simulations.into_iter().zip(found) {
        match found {
            Ok(finding) => findings.push(finding),
            Err(why) => {
                let id = simulation.prepared.result.condition.id();
                let why = MissingReason::NotCompared {
                    role: simulation.role,
                    record: simulation.prepared.record.flight.name.clone(),
                    why,
                };
                missing.push(missing_history(Some(id), why));
            }
        }
    }
    Ok(TimeHistories {
        tolerance_table: tolerances.clone(),
        records: findings,
        missing,
    })
}

fn missing_history(condition: Option<ConditionId>, why: MissingReason) -> MissingFinding {
    MissingFinding {
        condition,
        what: WHAT,
        why,
    }
}

/// Returns the analysed conditions without records, or a single entry for all if there are no
/// records.
fn without_records(analysis: &Analysis, records: &[HistoryRecords]) -> Vec<MissingFinding> {
    if records.iter().all(|condition| condition.records.is_empty()) {
        return vec![missing_history(None, MissingReason::NoRecord)];
    }
    let mut missing = Vec::new();
    for id in analysis.study.dataset.ids() {
        let has_records = records
            .iter()
            .any(|condition| condition.condition == id && !condition.records.is_empty());
        if analysis.condition(id).is_some() && !has_records {
            missing.push(missing_history(
                Some(id),
                MissingReason::NoRecordOfCondition,
            ));
        }
    }
    missing
}

/// Prepares the records of conditions with a result; adds the reason to `missing` where that is
/// impossible.
fn prepare_records<'a>(
    analysis: &'a Analysis,
    records: &'a [HistoryRecords],
    execution: &Execution<'_>,
    missing: &mut Vec<MissingFinding>,
) -> Result<Vec<PreparedRecord<'a>>, Cancelled> {
    let mut given = Vec::new();
    for condition in records {
        if let Some(result) = analysis.condition(condition.condition) {
            for record in &condition.records {
                given.push((result, condition, record));
            }
        }
    }
    let segments = execution.each(given.len(), 1, |index| {
        let (_, condition, record) = given[index];
        segments_of(
            &record.flight,
            &comparison_preparation(&condition.preparation),
        )
    })?;
    let mut prepared = Vec::new();
    for ((result, condition, record), segments) in given.into_iter().zip(segments) {
        match segments {
            Ok(segments) => prepared.push(PreparedRecord {
                result,
                record,
                segments,
            }),
            Err(why) => missing.push(missing_history(
                Some(condition.condition),
                MissingReason::RecordNotPrepared {
                    record: record.flight.name.clone(),
                    why,
                },
            )),
        }
    }
    Ok(prepared)
}

/// Each condition's models with their roles.
type RoleModels = BTreeMap<ConditionId, Vec<(RequirementRole, StateSpace)>>;

/// Builds the models of every condition with a record.
fn role_models(
    analysis: &Analysis,
    prepared: &[PreparedRecord<'_>],
    missing: &mut Vec<MissingFinding>,
) -> RoleModels {
    let mut models = RoleModels::new();
    for record in prepared {
        let id = record.result.condition.id();
        if models.contains_key(&id) {
            continue;
        }
        let mut of_condition = Vec::new();
        for role in RequirementRole::ALL {
            match analysis.role_model(record.result, role) {
                Ok(model) => of_condition.push((role, model)),
                // The missing schedule is reported once, not for every condition.
                Err(RoleModelError::NoSchedule(_)) => {}
                Err(why) => missing.push(missing_history(
                    Some(id),
                    MissingReason::NoRoleModel(NoRoleModel { role, why }),
                )),
            }
        }
        models.insert(id, of_condition);
    }
    models
}

/// Lists the simulations of every record with the models of its condition, in common windows.
fn simulations<'a>(
    prepared: &'a [PreparedRecord<'a>],
    models: &'a RoleModels,
) -> Vec<Simulation<'a>> {
    let mut simulations = Vec::new();
    for record in prepared {
        let Some(models) = models.get(&record.result.condition.id()) else {
            continue;
        };
        let settings = common_windows(models.iter().map(|(_, model)| model), &record.segments);
        for (role, model) in models {
            simulations.push(Simulation {
                prepared: record,
                role: *role,
                model,
                settings,
            });
        }
    }
    simulations
}

/// Simulates a model with a record and compares the response with the tolerances, or returns the
/// reason why that is impossible.
fn finding(
    comparison: &RecordComparison<'_>,
    simulation: &Simulation<'_>,
) -> Result<HistoryFinding, NotCompared> {
    let PreparedRecord {
        result,
        record,
        segments,
    } = simulation.prepared;
    let validation = validate(
        simulation.model,
        segments,
        &simulation.settings,
        &Sequential,
    )
    .map_err(NotCompared::NotSimulated)?;
    let windows = &validation.windows;
    let moved = comparison.moved_input(segments);
    let mut tolerances = Vec::new();
    for row in &comparison.rows {
        tolerances.push(tolerance_finding(comparison, row, windows, moved)?);
    }
    let mut theil = BTreeMap::new();
    for (output, coefficient) in comparison.outputs.iter().zip(&validation.theil) {
        if let Some(coefficient) = coefficient {
            theil.insert(output.name.clone(), *coefficient);
        }
    }
    let (j_rms, excluded) = match RmsCost::compute(windows, comparison.outputs) {
        Some(cost) => (Some(cost.value), cost.left_out),
        None => (None, Vec::new()),
    };
    let longest_s = windows
        .iter()
        .map(|window| window.sample_time_s * window.measured.nrows() as f64)
        .fold(0.0, f64::max);
    Ok(HistoryFinding {
        condition: result.condition.id(),
        airspeed_kt: result.condition.flight_state().airspeed_kt,
        record: record.flight.name.clone(),
        held_out: record.held_out,
        role: simulation.role,
        model: result
            .representative_name(simulation.role.bundle())
            .to_owned(),
        moved_input: moved.map(|input| comparison.inputs[input].name.clone()),
        samples: windows.iter().map(|window| window.measured.nrows()).sum(),
        windows: windows.len(),
        window_s: longest_s,
        j_rms,
        j_rms_left_out: excluded
            .into_iter()
            .map(|output| comparison.outputs[output].name.clone())
            .collect(),
        theil,
        tolerances,
    })
}

/// Evaluates a row of the tolerance table over all windows of a record.
fn tolerance_finding(
    comparison: &RecordComparison<'_>,
    row: &AppliedTolerance<'_>,
    windows: &[ValidationWindow],
    moved: Option<usize>,
) -> Result<ToleranceFinding, NotCompared> {
    let channel = &row.channel;
    let checks = RecordCheck::of_windows(windows, channel).map_err(NotCompared::NotChecked)?;
    let check = checks.first().ok_or(NotCompared::NoSamples)?;
    let worst = check.worst().ok_or(NotCompared::NoSamples)?;
    let correlation = check.correlation();
    let on_axis = comparison.is_on_axis(channel.output, moved);
    Ok(ToleranceFinding {
        quantity: row.tolerance.quantity.clone(),
        output: row.tolerance.channel.clone(),
        integrated: channel.integrated,
        unit: channel.unit.clone(),
        share_inside: check.share_inside(),
        largest_excess: worst.largest_excess,
        largest_excess_at_s: worst.largest_excess_at_s,
        correlation,
        on_axis,
        trend: Trend::from_correlation(correlation, on_axis),
    })
}
