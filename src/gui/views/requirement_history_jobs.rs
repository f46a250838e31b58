//! Responses over time for the requirements: the jobs that compute them, and their results.
//! `requirement_histories` draws the results.
//!
//! The *compared record* is the one in the details: simulated with each model, and checked against
//! the tolerances (M17.2: docs/requirements.md). The *test input* is a step or a doublet of the
//! input in focus, without flight data.

use std::sync::Arc;

use gdcm_plot::figure::FigureKind;
use gdcm_plot::figure::request::OverTime;
use gdcm_study::jobs::requirement_jobs::{RecordHistoryJob, TestAnswersJob, TimeHistoriesJob};
use gdcm_study::results::time_histories::HistoryRecord;
use gdcm_words::missing_results::{no_record_history_text, no_result_text};

use super::need::{Need, current_analysis};
use crate::gui::state::requirements_display::RequirementDetail;
use crate::gui::state::window_state::State;

/// Returns the index of the record in the requirement details: first the record chosen for the
/// condition, if it is still in use; else the first held-out record; else the first record in use;
/// `None` without records in use.
pub(super) fn compared_record(state: &State) -> Option<usize> {
    let condition = state.condition().id();
    let records = state.records.conditions.get(&condition)?;
    if let Some(choice) = state.display.judging.requirements.record
        && choice.condition == condition
        && records.used_rows().any(|(index, _)| index == choice.index)
    {
        return Some(choice.index);
    }
    let mut first = None;
    for (index, row) in records.used_rows() {
        if row.guess.held_out {
            return Some(index);
        }
        first = first.or(Some(index));
    }
    first
}

/// Returns the job for the record in the requirement details; `None` without an analysis or a
/// record in use, or if the test input is shown instead.
pub fn record_job(state: &State) -> Option<RecordHistoryJob> {
    let analysis = current_analysis(state)?;
    let condition = state.condition().id();
    if state.display.judging.shows_test {
        return None;
    }
    let records = state.records.conditions.get(&condition)?;
    let row = records.rows.get(compared_record(state)?)?;
    let record = HistoryRecord {
        flight: Arc::clone(row.used_flight()?).into(),
        held_out: row.guess.held_out,
    };
    let tolerances = state.study.requirements.tolerances.clone();
    Some(RecordHistoryJob {
        analysis: analysis.into(),
        condition,
        record,
        preparation: records.preparation(),
        tolerances,
    })
}

/// Returns the job for all models' responses to the held-out records; `None` without an analysis or
/// a held-out record.
pub fn time_histories_job(state: &State) -> Option<TimeHistoriesJob> {
    let analysis = current_analysis(state)?;
    let records = state.records.held_out_records();
    if records.is_empty() {
        return None;
    }
    Some(TimeHistoriesJob {
        analysis: analysis.into(),
        records,
        tolerances: state.study.requirements.tolerances.clone(),
    })
}

/// Returns the job for the responses to the test input; `None` without an analysis.
fn test_job(state: &State) -> Option<TestAnswersJob> {
    Some(TestAnswersJob {
        analysis: current_analysis(state)?.into(),
        condition: state.condition().id(),
        input: state.display.selection.pair.input,
        test: state.study.requirements.test,
    })
}

/// Returns the computation needed for the responses over time: to the record, else to the test
/// input.
pub fn over_time_need(state: &State) -> Option<Need> {
    match record_job(state) {
        Some(job) => Some(Need::RecordHistory(job)),
        None => test_job(state).map(Need::TestAnswers),
    }
}

/// Returns the models' responses over time, or the reason for their absence; `None` until computed.
pub fn over_time(state: &State) -> Option<Result<OverTime, String>> {
    match record_job(state) {
        Some(job) => {
            let found = match state.record_history(&job)? {
                Ok(history) => {
                    let focused = state.display.selection.pair.input;
                    let input = history.moved_input.unwrap_or(focused);
                    Ok(OverTime::Record(Arc::clone(history), input))
                }
                Err(why) => Err(no_record_history_text(why)),
            };
            Some(found)
        }
        None => Some(match state.test_answers()? {
            Ok(answers) => Ok(OverTime::Test(Arc::clone(answers))),
            Err(why) => Err(no_result_text(why)),
        }),
    }
}

/// Returns the models' responses over time for a figure; `None` if the figure does not show them,
/// or if they are not available.
pub fn shown_over_time(state: &State, kind: FigureKind) -> Option<OverTime> {
    let requirements = &state.display.judging.requirements;
    let is_shown =
        kind == FigureKind::Requirements && requirements.detail == RequirementDetail::Time;
    if is_shown {
        over_time(state)?.ok()
    } else {
        None
    }
}
