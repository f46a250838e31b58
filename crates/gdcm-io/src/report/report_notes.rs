//! Omissions of a report, as the export dialog states them.

use gdcm_model::dataset::ConditionId;
use gdcm_study::results::export_note::ExportNote;

use super::ReportSubject;
use super::limits::CONDITIONS_DRAWN;

/// Returns the notes on a report: conditions without a result or without figures; a missing
/// schedule, missing flight records, and requested couplings that are unavailable.
pub(super) fn report_notes(subject: ReportSubject<'_>) -> Vec<ExportNote> {
    let analysis = subject.analysis;
    let dataset = &analysis.study.dataset;
    let mut notes = Vec::new();
    let failed: Vec<ConditionId> = dataset
        .ids()
        .filter(|condition| analysis.condition(*condition).is_none())
        .collect();
    if !failed.is_empty() {
        notes.push(ExportNote::ConditionsWithoutResult { conditions: failed });
    }
    let not_drawn: Vec<ConditionId> = dataset.ids().skip(CONDITIONS_DRAWN).collect();
    if !not_drawn.is_empty() {
        notes.push(ExportNote::ConditionsNotDrawn {
            conditions: not_drawn,
        });
    }
    if let Err(why) = analysis.requested_couplings() {
        notes.push(ExportNote::CouplingsLeftOut { why: why.clone() });
    }
    if let Err(why) = &analysis.schedule {
        notes.push(ExportNote::NoSchedule { why: *why });
    }
    if subject.histories.is_none() {
        notes.push(ExportNote::NoFlightRecords);
    }
    notes
}
