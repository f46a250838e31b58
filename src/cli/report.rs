//! `gdcm report`.

use gdcm_core::message_text::sanitized_path;
use gdcm_files::{ReportSource, report as report_of, save_report};

use super::analyze::check_result;
use super::arguments::ReportArguments;
use super::failure::Failure;
use super::study_options::{analysis_of, engine, outputs_of, study_of};
use super::terminal::TerminalProgress;
use super::terminal::say;

/// Analyses, and writes all that was found and done as one page.
pub(super) fn report(arguments: &ReportArguments) -> Result<(), Failure> {
    let (mut study, loaded) = study_of(&arguments.study)?;
    let outputs = outputs_of(&arguments.study, &loaded, arguments.force);
    outputs.check(&[&arguments.out])?;
    let mut engine = engine();
    let progress = TerminalProgress::new("analysing");
    let analysis = analysis_of(&mut study, &arguments.study, &mut engine, &progress)?;
    drop(progress);
    check_result(&analysis)?;
    let study_file = arguments.study.file.as_ref().filter(|file| loaded.path() != Some(file.as_path()));
    let source = ReportSource::of(&loaded, study_file.map(|file| file.as_path()));
    let progress = TerminalProgress::new("drawing");
    let report = report_of(&analysis, &source, &mut engine, &progress)?;
    drop(progress);
    save_report(&report, &arguments.out, outputs)?;
    let solved = analysis.conditions.values().filter(|outcome| outcome.is_ok()).count();
    say(&format!("{}: a report on {solved} conditions\n", sanitized_path(&arguments.out)))
}
