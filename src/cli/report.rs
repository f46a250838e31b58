//! `gdcm report`: writes a full report, ready to print.

use std::path::Path;

use gdcm_io::report::{ReportSource, ReportSubject, report as compose_report, save_report};
use gdcm_model::message_text::sanitized_path;
use gdcm_model::number_format::counted;
use gdcm_study::results::required_modes::IdentifiedPoles;

use super::failure::Failure;
use super::progress::TerminalProgress;
use super::result_arguments::ReportArguments;
use super::study_analysis::{ErrorBars, StudyAnalysis, analyze_study};
use super::study_options::CommandStudy;
use super::terminal::print;
use super::time_histories::{read_histories, simulated_histories};

/// Analyses a study and writes the full report.
///
/// 1. Open the study, and check the output path.
/// 2. Read the flight records for the comparison in time.
/// 3. Analyse without error bars (`compose_report` computes them), and simulate the responses to
///    the records.
/// 4. Compose and save the report.
///
/// # Errors
/// An option or a file is wrong, no condition has a result, or the work was stopped. Also returned,
/// after the report is written, if some records were not read.
pub(super) fn report(arguments: &ReportArguments) -> Result<(), Failure> {
    // Step 1.
    let CommandStudy {
        study,
        loaded,
        outputs,
    } = CommandStudy::open(&arguments.study, arguments.force)?;
    let outputs = outputs.also_reading(arguments.histories.records.iter().cloned());
    outputs.check(&[&arguments.out])?;
    check_ending(&arguments.out)?;
    // Step 2.
    let records = read_histories(&arguments.histories, &study.dataset, study.settings.band)?;
    // Step 3.
    let StudyAnalysis {
        analysis,
        mut engine,
    } = analyze_study(study, &arguments.study, ErrorBars::Omitted)?;
    let histories = if arguments.histories.records.is_empty() {
        None
    } else {
        Some(simulated_histories(&analysis, &records)?)
    };
    // Step 4. The file is either the study or, without one, the dataset, which `loaded` names
    // already.
    let mut study_file = arguments.study.file.as_deref();
    if study_file == loaded.path() {
        study_file = None;
    }
    let source = ReportSource::from_files(&loaded, study_file);
    let progress = TerminalProgress::new("drawing");
    let known = IdentifiedPoles::default();
    let subject = ReportSubject {
        analysis: &analysis,
        histories: histories.as_ref(),
        known: &known,
    };
    let report = compose_report(subject, &source, &mut engine, &progress)?;
    drop(progress);
    save_report(&report, &arguments.out, outputs)?;
    let outcomes = analysis.conditions.values();
    let solved = outcomes.filter(|outcome| outcome.is_ok()).count();
    print(&format!(
        "{}: a report on {}\n",
        sanitized_path(&arguments.out),
        counted(solved, "condition")
    ))?;
    records.into_outcome()
}

/// Rejects a file name that ends in neither .html nor .htm.
fn check_ending(path: &Path) -> Result<(), Failure> {
    let ending = path
        .extension()
        .map(|ending| ending.to_string_lossy().to_lowercase());
    match ending.as_deref() {
        Some("html" | "htm") => Ok(()),
        _ => Err(Failure::option(
            "--out",
            format!(
                "expected a name that ends in .html, found {}; for a PDF, print the report from a \
                browser",
                sanitized_path(path)
            ),
        )),
    }
}
