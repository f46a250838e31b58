//! Responses over time for the requirements: their jobs and results.

use std::sync::Arc;

use gdcm_plot::figure::{FigureKind, OverTime};
use gdcm_study::Analysis;
use gdcm_study::jobs::requirement_jobs::{RecordHistoryJob, TestAnswersJob};
use gdcm_study::results::time_histories::HistoryRecord;

use super::need::Need;
use crate::gui::state::requirements_page::RequirementsPage;
use crate::gui::state::window_state::State;

/// Returns the job of the record shown over time; `None` without a record, or if a test is shown
/// instead.
pub fn record_job(state: &State) -> Option<RecordHistoryJob> {
    let analysis = current(state)?;
    let condition = state.condition().id();
    let records = state
        .records
        .conditions
        .get(&condition)
        .filter(|_| !state.display.judging.shows_test)?;
    let row = records.rows.get(records.chosen)?;
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

fn test_job(state: &State) -> Option<TestAnswersJob> {
    let condition = state.condition().id();
    let input = state.display.selection.pair.input;
    Some(TestAnswersJob {
        analysis: current(state)?.into(),
        condition,
        input,
        test: state.study.requirements.test,
    })
}

/// Returns the analysis of the present settings, if available.
pub fn current(state: &State) -> Option<Arc<Analysis>> {
    state
        .results
        .analysis
        .clone()
        .filter(|_| state.analysis().is_some())
}

/// Returns the computation needed over time.
pub fn over_time_need(state: &State) -> Option<Need> {
    record_job(state)
        .map(Need::RecordHistory)
        .or_else(|| test_job(state).map(Need::TestAnswers))
}

/// Returns the models' responses over time, or the reason for their absence; `None` until computed.
pub fn over_time(state: &State) -> Option<Result<OverTime, String>> {
    match record_job(state) {
        Some(job) => {
            let found = state.record_history(&job)?.clone();
            Some(found.map(|history| OverTime::Record(history, state.display.selection.pair.input)))
        }
        None => Some(state.test_answers()?.clone().map(OverTime::Test)),
    }
}

/// Returns the same for a figure, if it is shown.
pub fn shown_over_time(state: &State, kind: FigureKind) -> Option<OverTime> {
    let is_shown = kind == FigureKind::Requirements
        && state.display.judging.requirements_page == RequirementsPage::Histories;
    over_time(state).filter(|_| is_shown)?.ok()
}
