//! Exports all analysis results: `corrections.json`, `corrections.csv`, `assessment.csv`,
//! `physics.csv`, and a MATLAB struct with the same content as `corrections.json`.
//!
//! The *chosen* conditions are those in the request, by default all. Remarks are lines of text
//! for the command line, notes are facts for the list of files. The *price* of leads, which the
//! remarks state, is the gain that they add above the band, and the frequency above which the
//! model is not valid (M15.6).

use std::sync::Arc;

use gdcm_study::results::export_note::{ExportNote, FileSummary};

use super::corrections_struct::corrections_struct;
use super::file_head::variables_head;
use super::{Export, ExportFormat, Exported, FormatGroup};
use crate::export_fault::ExportFault;
use crate::files::corrections_file::{
    corrections, write_assessment_csv, write_corrections, write_corrections_csv, write_physics_csv,
};
use crate::files::export_contents::ExportContents;
use crate::formats::mat;
use crate::formats::variables::Variable;

/// Options of `gdcm export` for files with results per condition.
const OPTIONS: &[&str] = &["--condition"];

pub(super) const JSON: ExportFormat = ExportFormat {
    name: "json",
    extension: "json",
    stem: "corrections",
    group: FormatGroup::PerCondition,
    title: "All values",
    words: "All values of each condition, and the schedule (JSON, the format of corrections.json)",
    options: OPTIONS,
    check_path: |_| Ok(()),
    correction_parts: |analysis, _| ExportContents::of_results(analysis),
    export: |export| {
        let Export {
            analysis, source, ..
        } = *export;
        let chosen = export.request.chosen_conditions(analysis);
        let exported = Exported::new(export.results_summary(), move |file| {
            write_corrections(analysis, &source.sha256, &chosen, file)
        });
        Ok(exported
            .with_remarks(export.price_remarks())
            .with_notes(export.result_notes()))
    },
};

pub(super) const CSV: ExportFormat = ExportFormat {
    name: "csv",
    extension: "csv",
    title: "One row per channel",
    words: "Gains and delays, one row per condition and channel (CSV, the format of corrections.csv)",
    export: |export| {
        let mut text = Vec::new();
        let chosen = export.request.chosen_conditions(export.analysis);
        write_corrections_csv(export.analysis, &chosen, &mut text)
            .map_err(|error| ExportFault::contents(&error))?;
        Ok(Exported::bytes(rows_summary(&text), text)
            .with_remarks(export.price_remarks())
            .with_notes(export.result_notes()))
    },
    ..JSON
};

pub(super) const ASSESSMENT: ExportFormat = ExportFormat {
    name: "assessment",
    extension: "csv",
    stem: "assessment",
    title: "One row per response",
    words: "J without and with correction, one row per condition and response (CSV, the format of assessment.csv)",
    export: |export| {
        let mut text = Vec::new();
        let chosen = export.request.chosen_conditions(export.analysis);
        write_assessment_csv(export.analysis, &chosen, &mut text)
            .map_err(|error| ExportFault::contents(&error))?;
        Ok(Exported::bytes(rows_summary(&text), text)
            .with_remarks(export.price_remarks())
            .with_notes(export.result_notes()))
    },
    ..JSON
};

/// Export as `physics.csv`; only the headings if the study applies no physics parameters.
pub(super) const PHYSICS: ExportFormat = ExportFormat {
    name: "physics",
    extension: "csv",
    stem: "physics",
    title: "One row per physics parameter",
    words: "Physics parameters, one row each (CSV, the format of physics.csv)",
    options: &[],
    correction_parts: |analysis, _| ExportContents::of_physics(analysis),
    export: |export| {
        let requested =
            export
                .analysis
                .requested_physics()
                .map_err(|failure| ExportFault::NoPhysics {
                    why: failure.to_string(),
                })?;
        let mut notes = Vec::new();
        if requested.is_none() {
            notes.push(ExportNote::NoPhysicsParameters);
        }
        let mut text = Vec::new();
        write_physics_csv(requested.map(Arc::as_ref), &mut text)
            .map_err(|error| ExportFault::contents(&error))?;
        Ok(Exported::bytes(rows_summary(&text), text).with_notes(notes))
    },
    ..JSON
};

pub(super) const MAT: ExportFormat = ExportFormat {
    name: "mat",
    extension: "mat",
    title: "One struct",
    words: "MATLAB data: all corrections as one struct",
    export: |export| {
        let analysis = export.analysis;
        let chosen = export.request.chosen_conditions(analysis);
        let corrections = corrections(analysis, &export.source.sha256, &chosen);
        let variables = [Variable {
            name: "corrections".to_owned(),
            value: corrections_struct(corrections, &analysis.study.dataset),
        }];
        let bytes = mat::write(&variables)?;
        Ok(Exported::bytes(export.results_summary(), bytes)
            .with_remarks(export.price_remarks())
            .with_notes(export.result_notes())
            .with_head(variables_head(&variables)))
    },
    ..JSON
};

impl Export<'_> {
    fn results_summary(&self) -> FileSummary {
        FileSummary::Results {
            has_error_bars: self.analysis.uncertainty.is_some(),
        }
    }
}

/// Counts the lines after the heading of a table; no cell contains a line break.
fn rows_summary(text: &[u8]) -> FileSummary {
    let lines = text.iter().filter(|byte| **byte == b'\n').count();
    FileSummary::Rows {
        rows: lines.saturating_sub(1),
    }
}
