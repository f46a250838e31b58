//! Simulates each condition's models with its flight records, and compares the results with the
//! tolerances (M17.2).
//!
//! ```text
//! 1  a record is prepared as for identification, but pieces of 2 s and more are used
//! 2  each model is simulated with the recorded inputs in windows of at most 10 s, each with
//!    estimated initial state and offsets (M14.6); all models of a condition have the same
//!    windows, so that the compared manoeuvres begin at the same samples
//! 3  each row of the tolerance table whose output and unit exist: share inside, largest excess,
//!    peak error, correlation; over all outputs J_rms and Theil's coefficients (M17.4)
//! ```
//!
//! A *role* is a version of the model: physics, corrected, scheduled or identified. J_rms is the
//! weighted rms error; Theil's coefficient of an output is its rms error over the sum of the rms
//! values of the measured and the simulated output.

use std::collections::BTreeMap;

use gdcm_method::requirements::rms_cost::RmsCost;
use gdcm_method::requirements::{RecordCheck, ToleranceTable};
use gdcm_model::dataset::{ConditionId, StateSpace};
use gdcm_model::executor::Sequential;
use gdcm_model::progress::Cancelled;
use gdcm_model::simulation::{Segment, ValidationSettings, ValidationWindow, validate};
use gdcm_sysid::spectra::preparation::segments_of;

use super::analysis::{Analysis, ConditionAnalysis};
use super::missing_finding::{
    MissingFinding, MissingPart, MissingReason, NoRoleModel, NotCompared,
};
use super::record_comparison::{
    AppliedTolerance, RecordComparison, Trend, common_windows, comparison_preparation,
};
use super::requirement_role::{RequirementRole, RoleModelError};
use super::time_histories::{
    HistoryFinding, HistoryRecord, HistoryRecords, TimeHistories, ToleranceFinding,
};
use crate::execution::Execution;

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

/// Simulates each condition's models with its `records`, and compares the results with `tolerances`
/// (M17.2). The step count is [`HistoryRecords::steps`].
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
    let outcomes = execution.each(simulations.len(), 1, |index| {
        finding(&comparison, &simulations[index])
    })?;
    let mut findings = Vec::new();
    for (simulation, outcome) in simulations.into_iter().zip(outcomes) {
        match outcome {
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
        what: MissingPart::TimeHistories,
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

/// Prepares the records for conditions with a result (step 1); adds the reason to `missing` where
/// that is impossible.
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

/// Builds the models for every condition with a record; adds to `missing` why a role has no model,
/// unless the schedule is missing.
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
                // `requirements_of` reports a missing schedule, once for all conditions.
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

/// Lists the simulations to run: each record with its condition's models, in common windows.
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

/// Simulates a model with a record (step 2) and compares the response with the tolerances (step 3),
/// or returns the reason why that is impossible.
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

/// Evaluates a tolerance row over all windows in a record.
fn tolerance_finding(
    comparison: &RecordComparison<'_>,
    row: &AppliedTolerance<'_>,
    windows: &[ValidationWindow],
    moved: Option<usize>,
) -> Result<ToleranceFinding, NotCompared> {
    let channel = &row.channel;
    let checks = RecordCheck::of_windows(windows, channel).map_err(NotCompared::NotChecked)?;
    // All windows are from one record, which has a single check.
    let check = checks.first().ok_or(NotCompared::NoSamples)?;
    let window_of_excess = check.worst().ok_or(NotCompared::NoSamples)?;
    let window_of_peak = check.peak().ok_or(NotCompared::NoSamples)?;
    let correlation = check.correlation();
    let on_axis = comparison.is_on_axis(channel.output, moved);
    Ok(ToleranceFinding {
        quantity: row.tolerance.quantity.clone(),
        output: row.tolerance.channel.clone(),
        integrated: channel.integrated,
        unit: channel.unit.clone(),
        share_inside: check.share_inside(),
        largest_excess: window_of_excess.largest_excess,
        largest_excess_at_s: window_of_excess.largest_excess_at_s,
        peak_error: window_of_peak.peak_error,
        peak_error_at_s: window_of_peak.peak_error_at_s,
        correlation,
        on_axis,
        trend: Trend::from_correlation(correlation, on_axis),
    })
}
