//! `gdcm analyze` and `gdcm report`: the same analysis, written as files of results or as one page.

use std::sync::Arc;

use gdcm_core::message_text::sanitized_path;
use gdcm_core::study::Analysis;
use gdcm_files::{ReportSource, make_directory, report as report_of, result_paths, save_report, write_results};

use super::summary::summary;
use super::{
    AnalyzeArguments, Failure, ReportArguments, TerminalProgress, analysis_of, engine, leave_one_out_section,
    outputs_of, say, say_error, study_of,
};

/// Analyses, writes the results, and prints a summary.
pub(super) fn analyze(arguments: &AnalyzeArguments) -> Result<(), Failure> {
    let (mut study, loaded) = study_of(&arguments.study)?;
    let outputs = outputs_of(&arguments.study, &loaded, arguments.force);
    outputs.check(&result_paths(&arguments.out))?;
    make_directory(&arguments.out)?;
    let mut engine = engine();
    let progress = TerminalProgress::new("analysing");
    let mut analysis = analysis_of(&mut study, &arguments.study, &mut engine, &progress)?;
    analysis.uncertainty = Some(Arc::new(engine.uncertainty(&analysis, &progress)?));
    drop(progress);
    check_result(&analysis)?;
    let all = analysis.conditions.keys().copied().collect();
    write_results(&analysis, &loaded.sha256, &all, &arguments.out, outputs)?;
    say(&summary(&analysis, &loaded, &arguments.out))?;
    if arguments.leave_one_out { say(&leave_one_out_section(&analysis)) } else { Ok(()) }
}

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

/// Refuses an analysis without any result; says which conditions of another have none.
pub(super) fn check_result(analysis: &Analysis) -> Result<(), Failure> {
    let failures = analysis.study.dataset.conditions().iter().filter_map(|condition| {
        let failure = analysis.conditions.get(&condition.id())?.as_ref().err()?;
        Some(format!("condition {}: {failure}", condition.id()))
    });
    let failures: Vec<String> = failures.collect();
    match failures.first() {
        Some(first) if failures.len() == analysis.conditions.len() => Err(Failure::NoResult { reason: first.clone() }),
        _ => {
            failures.iter().for_each(|failure| say_error(failure));
            Ok(())
        }
    }
}
