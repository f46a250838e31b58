//! `gdcm analyze`: result files and a printed summary.

use gdcm_io::files::corrections_file::{result_paths, write_results};
use gdcm_io::output_set::make_directory;

use super::analysis_summary::Summary;
use super::failure::Failure;
use super::leave_one_out::leave_one_out_section;
use super::result_arguments::AnalyzeArguments;
use super::study_analysis::{ErrorBars, StudyAnalysis, analyze_study};
use super::study_options::CommandStudy;
use super::terminal::print;

/// Analyses a study, writes the result files, and prints a summary.
pub(super) fn analyze(arguments: &AnalyzeArguments) -> Result<(), Failure> {
    let CommandStudy {
        study,
        loaded,
        outputs,
    } = CommandStudy::open(&arguments.study, arguments.force)?;
    outputs.check(&result_paths(&arguments.out))?;
    make_directory(&arguments.out)?;
    let StudyAnalysis { analysis, .. } =
        analyze_study(study, &arguments.study, ErrorBars::Computed)?;
    let conditions = analysis.conditions.keys().copied().collect();
    write_results(
        &analysis,
        &loaded.sha256,
        &conditions,
        &arguments.out,
        outputs,
    )?;
    // The full summary is formed in any case: it adds the cautions to the JSON object.
    let summary = Summary::new(&analysis, &loaded, &arguments.out);
    print(&summary.verdict)?;
    if !arguments.brief {
        print(&summary.details)?;
    }
    print(&summary.written)?;
    if arguments.leave_one_out {
        print(&leave_one_out_section(&analysis))?;
    }
    Ok(())
}
