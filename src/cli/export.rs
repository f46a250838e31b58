//! `gdcm export`.

use gdcm_core::message_text::{sanitized, sanitized_path};
use std::sync::Arc;

use gdcm_core::correction::Pade;
use gdcm_core::dataset::ConditionId;
use gdcm_core::study::{ExportFormat, ExportRequest, ExportedRole, Study};
use gdcm_files::{ExportSource, check_export, write_export};

use super::analyze::check_result;
use super::arguments::StudyArguments;
use super::export_arguments::ExportArguments;
use super::failure::Failure;
use super::study_options::{analysis_of, engine, outputs_of, study_of};
use super::terminal::TerminalProgress;
use super::terminal::say;

/// Analyses, writes what is asked for, and says what is to be known of it.
pub(super) fn export(arguments: &ExportArguments) -> Result<(), Failure> {
    let (mut study, loaded) = study_of(&arguments.study)?;
    let outputs = outputs_of(&arguments.study, &loaded, arguments.force);
    let request = request(&study, arguments)?;
    check_export(request.format, &arguments.out)?;
    outputs.check(&[&arguments.out])?;
    let mut engine = engine();
    let progress = TerminalProgress::new("analysing");
    let mut analysis = analysis_of(&mut study, &arguments.study, &mut engine, &progress)?;
    analysis.uncertainty = Some(Arc::new(engine.uncertainty(&analysis, &progress)?));
    drop(progress);
    check_result(&analysis)?;
    let source = ExportSource { name: name(&arguments.study), sha256: loaded.sha256.clone() };
    let remarks = write_export(&analysis, &source, &request, &arguments.out, outputs)?;
    let remarks: String = remarks.iter().map(|remark| format!("{}\n", sanitized(remark))).collect();
    say(&format!("{}: {}\n{remarks}", sanitized_path(&arguments.out), request.format.words()))
}

/// What an export is called: the file of the study or of the dataset.
fn name(arguments: &StudyArguments) -> String {
    let file = arguments.file.as_ref().and_then(|file| file.file_name());
    file.map_or_else(|| "the embedded example".to_owned(), |name| name.to_string_lossy().into_owned())
}

/// The request of a command line; an option that its format knows nothing of is refused.
fn request(study: &Study, arguments: &ExportArguments) -> Result<ExportRequest, Failure> {
    let format = arguments.format;
    let is_table = matches!(format, ExportFormat::TableCsv | ExportFormat::TableMat);
    let is_models = format == ExportFormat::StateSpace;
    let misplaced = [
        ("--breakpoints", arguments.breakpoints.is_some() && !is_table, "table-csv and table-mat"),
        ("--condition", arguments.condition.is_some() && !is_models, "state-space"),
        ("--model", arguments.model.is_some() && !is_models, "state-space"),
        ("--correction", arguments.correction.is_some() && !is_models, "state-space"),
        ("--pade", arguments.pade.is_some() && !is_models, "state-space"),
    ];
    if let Some((option, _, of)) = misplaced.into_iter().find(|(_, is_misplaced, _)| *is_misplaced) {
        return Err(Failure::Option { option, reason: format!("is an option of --as {of}") });
    }
    let condition = arguments.condition.map(ConditionId);
    if let Some(id) = condition.filter(|id| study.dataset.condition(*id).is_none()) {
        let ids: Vec<String> = study.dataset.conditions().iter().map(|condition| condition.id().to_string()).collect();
        let reason = format!("the dataset has no condition {id}; it has {}", ids.join(", "));
        return Err(Failure::Option { option: "--condition", reason });
    }
    let role = match arguments.model.as_deref() {
        None | Some("nominal") => ExportedRole::Nominal,
        Some("representative") => ExportedRole::Representative,
        Some(name) => ExportedRole::Named(name.to_owned()),
    };
    Ok(ExportRequest {
        breakpoints_kt: arguments.breakpoints.as_ref().map(|breakpoints| breakpoints.airspeeds_kt.clone()),
        condition,
        role,
        correction: arguments.correction.unwrap_or_default(),
        pade: arguments.pade.and_then(Pade::new).unwrap_or_default(),
        ..ExportRequest::new(format)
    })
}
