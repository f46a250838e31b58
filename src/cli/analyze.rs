//! `gdcm analyze` and `gdcm report`: the same analysis, written as files of results or as one page.

use gdcm_core::message_text::sanitized_path;
use gdcm_core::study::KnownPoles;
use gdcm_files::{
    ReportSource, ReportSubject, make_directory, report as report_of, result_paths, save_report, write_results,
};

use super::summary::summary;
use super::{
    AnalyzeArguments, Failure, ReportArguments, TerminalProgress, analysis_of, leave_one_out_section, say, study_of,
    time_histories,
};

/// Analyses, writes the results, and prints a summary.
pub(super) fn analyze(arguments: &AnalyzeArguments) -> Result<(), Failure> {
    let (study, loaded, outputs) = study_of(&arguments.study, arguments.force)?;
    outputs.check(&result_paths(&arguments.out))?;
    make_directory(&arguments.out)?;
    let (analysis, _) = analysis_of(study, &arguments.study, true)?;
    let all = analysis.conditions.keys().copied().collect();
    write_results(&analysis, &loaded.sha256, &all, &arguments.out, outputs)?;
    say(&summary(&analysis, &loaded, &arguments.out))?;
    if arguments.leave_one_out { say(&leave_one_out_section(&analysis)) } else { Ok(()) }
}

/// Analyses, and writes all that was found and done as one page.
pub(super) fn report(arguments: &ReportArguments) -> Result<(), Failure> {
    let (study, loaded, outputs) = study_of(&arguments.study, arguments.force)?;
    let outputs = outputs.also_reading(arguments.histories.records.iter().cloned());
    outputs.check(&[&arguments.out])?;
    let ending = arguments.out.extension().map(|ending| ending.to_string_lossy().to_lowercase());
    if !matches!(ending.as_deref(), Some("html" | "htm")) {
        let found = sanitized_path(&arguments.out);
        let reason = format!("expected a name that ends in .html, found {found}; a browser prints the report as PDF");
        return Err(Failure::Option { option: "--out", reason });
    }
    let records = arguments.histories.read(&study.dataset, study.settings.band)?;
    let (analysis, mut engine) = analysis_of(study, &arguments.study, false)?;
    let histories = match arguments.histories.records.as_slice() {
        [] => None,
        _ => Some(time_histories(&analysis, &records)?),
    };
    let study_file = arguments.study.file.as_deref().filter(|file| loaded.path() != Some(file));
    let source = ReportSource::of(&loaded, study_file);
    let progress = TerminalProgress::new("drawing");
    let known = KnownPoles::default();
    let subject = ReportSubject { analysis: &analysis, histories: histories.as_ref(), known: &known };
    let report = report_of(subject, &source, &mut engine, &progress)?;
    drop(progress);
    save_report(&report, &arguments.out, outputs)?;
    let solved = analysis.conditions.values().filter(|outcome| outcome.is_ok()).count();
    say(&format!("{}: a report on {solved} conditions\n", sanitized_path(&arguments.out)))?;
    records.ended()
}
