//! Exports of all analysis results: `corrections.json`, `corrections.csv`, and a MATLAB struct with
//! the content of `corrections.json`.

use std::collections::BTreeSet;

use gdcm_model::dataset::ConditionId;
use gdcm_study::Analysis;

use super::corrections_struct::corrections_struct;
use super::{ExportFormat, Exported};
use crate::files::corrections_file::{corrections, write_corrections, write_corrections_csv};
use crate::files::export_contents::ExportContents;
use crate::formats::mat;
use crate::formats::variables::Variable;

/// Export as `corrections.json`.
pub(super) const JSON: ExportFormat = ExportFormat {
    name: "json",
    extension: "json",
    words: "corrections.json alone",
    options: &[],
    check_path: |_| Ok(()),
    contents: |analysis, _| ExportContents::of_results(analysis),
    export: |export| {
        let analysis = export.analysis;
        let sha256 = &export.source.sha256;
        let exported = Exported::new(move |file| {
            write_corrections(analysis, sha256, &all_conditions(analysis), file)
        });
        Ok(exported.with(export.price_remarks()))
    },
};

/// Export as `corrections.csv`.
pub(super) const CSV: ExportFormat = ExportFormat {
    name: "csv",
    extension: "csv",
    words: "corrections.csv alone",
    options: &[],
    check_path: |_| Ok(()),
    contents: |analysis, _| ExportContents::of_results(analysis),
    export: |export| {
        let analysis = export.analysis;
        let exported = Exported::new(move |file| {
            write_corrections_csv(analysis, &all_conditions(analysis), file)
        });
        Ok(exported.with(export.price_remarks()))
    },
};

/// Export as the MATLAB struct `corrections`.
pub(super) const MAT: ExportFormat = ExportFormat {
    name: "mat",
    extension: "mat",
    words: "MATLAB data: all corrections as one struct",
    options: &[],
    check_path: |_| Ok(()),
    contents: |analysis, _| ExportContents::of_results(analysis),
    export: |export| {
        let analysis = export.analysis;
        let corrections = corrections(analysis, &export.source.sha256, &all_conditions(analysis));
        let variable = Variable {
            name: "corrections".to_owned(),
            value: corrections_struct(corrections, &analysis.study.dataset),
        };
        Ok(Exported::bytes(mat::write(&[variable])?).with(export.price_remarks()))
    },
};

fn all_conditions(analysis: &Analysis) -> BTreeSet<ConditionId> {
    analysis.conditions.keys().copied().collect()
}
