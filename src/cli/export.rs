//! `gdcm export`: writes corrections in formats for other tools.

use gdcm_io::export::{
    EXPORTERS, ExportRequest, ExportSource, ExportedRole, check_export, export_contents,
    write_export,
};
use gdcm_method::correction::Pade;
use gdcm_model::message_text::{sanitized, sanitized_path};
use gdcm_study::Study;

use super::dataset_lookup::condition_of;
use super::failure::Failure;
use super::result_arguments::ExportArguments;
use super::study_analysis::{ErrorBars, StudyAnalysis, analyze_study};
use super::study_arguments::StudyArguments;
use super::study_options::CommandStudy;
use super::terminal::print;

/// Analyses a study, writes the requested export, and prints its notes and cautions.
pub(super) fn export(arguments: &ExportArguments) -> Result<(), Failure> {
    let CommandStudy {
        study,
        loaded,
        outputs,
    } = CommandStudy::open(&arguments.study, arguments.force)?;
    let request = export_request(&study, arguments)?;
    check_export(request.format, &arguments.out)?;
    outputs.check(&[&arguments.out])?;
    let StudyAnalysis { analysis, .. } =
        analyze_study(study, &arguments.study, ErrorBars::Computed)?;
    let source = ExportSource {
        name: source_name(&arguments.study),
        sha256: loaded.sha256.clone(),
    };
    let mut lines = export_contents(&analysis, &request).lines(&analysis.study.dataset);
    lines.extend(write_export(
        &analysis,
        &source,
        &request,
        &arguments.out,
        outputs,
    )?);
    let mut text = format!(
        "{}: {}\n",
        sanitized_path(&arguments.out),
        request.format.words
    );
    for line in lines {
        text += &format!("{}\n", sanitized(&line));
    }
    print(&text)
}

/// Returns the file name of the study or dataset, which the export states as its source.
fn source_name(arguments: &StudyArguments) -> String {
    let file = arguments.file.as_ref().and_then(|file| file.file_name());
    match file {
        Some(name) => name.to_string_lossy().into_owned(),
        None => "the embedded example".to_owned(),
    }
}

/// Builds the request from the command line; rejects options that do not apply to the format.
fn export_request(study: &Study, arguments: &ExportArguments) -> Result<ExportRequest, Failure> {
    check_options(arguments)?;
    let condition = match arguments.condition {
        Some(id) => Some(condition_of(&study.dataset, id)?),
        None => None,
    };
    let role = match arguments.model.as_deref() {
        None | Some("nominal") => ExportedRole::Nominal,
        Some("representative") => ExportedRole::Representative,
        Some(name) => ExportedRole::Named(name.to_owned()),
    };
    Ok(ExportRequest {
        breakpoints_kt: arguments.breakpoints.clone(),
        condition,
        role,
        correction: arguments.correction.unwrap_or_default(),
        pade: arguments.pade.and_then(Pade::new).unwrap_or_default(),
        format: arguments.format,
    })
}

/// Rejects options that do not apply to the format.
fn check_options(arguments: &ExportArguments) -> Result<(), Failure> {
    let options = [
        ("--breakpoints", arguments.breakpoints.is_some()),
        ("--condition", arguments.condition.is_some()),
        ("--model", arguments.model.is_some()),
        ("--correction", arguments.correction.is_some()),
        ("--pade", arguments.pade.is_some()),
    ];
    for (option, is_given) in options {
        if !is_given || arguments.format.options.contains(&option) {
            continue;
        }
        let names: Vec<&str> = EXPORTERS
            .iter()
            .filter(|exporter| exporter.options.contains(&option))
            .map(|exporter| exporter.name)
            .collect();
        let reason = format!("applies only to --as {}", names.join(" and "));
        return Err(Failure::coded_option(option, "misplaced-option", reason));
    }
    Ok(())
}
