//! `gdcm analyze`.

use std::sync::Arc;

use gdcm_core::study::Analysis;
use gdcm_files::{make_directory, result_paths, write_results};

use super::arguments::AnalyzeArguments;
use super::evidence_sections::leave_one_out_section;
use super::failure::Failure;
use super::study_options::{analysis_of, engine, outputs_of, study_of};
use super::summary::summary;
use super::terminal::TerminalProgress;
use super::terminal::{say, say_error};

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
