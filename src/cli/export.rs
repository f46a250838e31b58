//! `gdcm export`: writes corrections in formats for other tools, to a file or to a folder.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use gdcm_io::export::export_set::{CHECKSUMS, ExistingNames, ExportPlan, ExportSet, PlannedNote};
use gdcm_io::export::{
    EXPORTERS, ExportFormat, ExportRequest, ExportSource, ExportedRole, check_export,
    export_contents, write_export,
};
use gdcm_method::correction::Pade;
use gdcm_model::message_text::{sanitized, sanitized_path};
use gdcm_model::progress::Unobserved;
use gdcm_study::decisions::export_choices::ExportChoices;
use gdcm_study::{Analysis, Study};
use gdcm_words::export::{export_note_detail, export_note_title, file_summary_text};

use super::dataset_lookup::condition_of;
use super::failure::Failure;
use super::result_arguments::ExportArguments;
use super::study_analysis::{ErrorBars, StudyAnalysis, analyze_study};
use super::study_options::CommandStudy;
use super::terminal::{note, print};

/// Analyses a study, writes the requested files, and prints their contents and cautions: with
/// `--folder` any formats under names that the program chooses, with `--out` a single format.
pub(super) fn export(arguments: &ExportArguments) -> Result<(), Failure> {
    let names = arguments.formats.iter().map(String::as_str);
    let (formats, has_checksums) = ExportSet::formats_named(names);
    match (&arguments.folder, &arguments.out) {
        (Some(folder), _) => export_set(arguments, formats, has_checksums, folder),
        (None, Some(path)) => match formats[..] {
            [format] if !has_checksums => export_file(arguments, format, path),
            _ => {
                let reason = "takes a single format, and no checksums; several files need --folder";
                Err(Failure::coded_option("--out", "several-formats", reason))
            }
        },
        // clap requires one of both.
        (None, None) => Ok(()),
    }
}

/// Writes a single file to a path.
fn export_file(
    arguments: &ExportArguments,
    format: ExportFormat,
    path: &PathBuf,
) -> Result<(), Failure> {
    let CommandStudy {
        study,
        loaded,
        outputs,
    } = CommandStudy::open(&arguments.study, arguments.force)?;
    check_options(arguments, &[format])?;
    let request = ExportRequest {
        format,
        ..export_request(&study, arguments)?
    };
    check_export(format, path)?;
    outputs.check(&[path])?;
    let StudyAnalysis { analysis, .. } =
        analyze_study(study, &arguments.study, ErrorBars::Computed)?;
    let source = ExportSource::new(arguments.study.file.as_deref(), &loaded.sha256);
    let mut lines = export_contents(&analysis, &request).lines(&analysis.study.dataset);
    lines.extend(write_export(&analysis, &source, &request, path, outputs)?);
    let mut text = format!("{}: {}\n", sanitized_path(path), format.words);
    for line in lines {
        text += &format!("{}\n", sanitized(&line));
    }
    print(&text)
}

/// Writes several files into a folder, under names that the program chooses.
fn export_set(
    arguments: &ExportArguments,
    formats: Vec<ExportFormat>,
    has_checksums: bool,
    folder: &Path,
) -> Result<(), Failure> {
    let CommandStudy {
        study,
        loaded,
        outputs,
    } = CommandStudy::open(&arguments.study, arguments.force)?;
    check_options(arguments, &formats)?;
    let set = ExportSet {
        request: export_request(&study, arguments)?,
        formats,
        has_checksums,
        has_report: false,
        folder: folder.to_owned(),
        prefix: arguments.prefix.clone().unwrap_or_default(),
        existing: if arguments.number {
            ExistingNames::Number
        } else {
            ExistingNames::Ignore
        },
    };
    set.check()?;
    if !arguments.number {
        outputs.check(&set.paths())?;
    }
    let StudyAnalysis { analysis, .. } =
        analyze_study(study, &arguments.study, ErrorBars::Computed)?;
    let source = ExportSource::new(arguments.study.file.as_deref(), &loaded.sha256);
    let plan = set.dry_run(&analysis, &source, &Unobserved)?;
    let paths = plan.write(folder, outputs)?;
    for planned in &plan.notes {
        let words = note_words(planned, &plan, &analysis);
        note(planned.note.code(), &sanitized(&words));
    }
    let mut text = String::new();
    for (file, path) in plan.files.iter().zip(&paths) {
        if let Ok(contents) = &file.contents {
            let words = file_summary_text(&contents.summary);
            text += &format!("{}: {words}\n", sanitized_path(path));
        }
    }
    print(&text)
}

/// Describes what files omit or approximate: "No error bars: still being computed, or stopped
/// (corrections.csv)".
fn note_words(planned: &PlannedNote, plan: &ExportPlan, analysis: &Analysis) -> String {
    let dataset = &analysis.study.dataset;
    let scheduling = analysis.study.settings.schedule_delays;
    let title = export_note_title(&planned.note, dataset);
    let detail = export_note_detail(&planned.note, dataset, scheduling);
    let names: Vec<&str> = planned
        .files
        .iter()
        .map(|&index| plan.files[index].name.as_str())
        .collect();
    format!("{title}: {detail} ({})", names.join(", "))
}

/// Builds the request from the command line, with the default format.
fn export_request(study: &Study, arguments: &ExportArguments) -> Result<ExportRequest, Failure> {
    let mut conditions = BTreeSet::new();
    for &id in &arguments.condition {
        conditions.insert(condition_of(&study.dataset, id)?);
    }
    Ok(ExportRequest {
        breakpoints_kt: arguments.breakpoints.clone(),
        conditions: if conditions.is_empty() {
            None
        } else {
            Some(conditions)
        },
        role: ExportedRole::from_name(arguments.model.as_deref().unwrap_or(ExportChoices::NOMINAL)),
        correction: arguments.correction.unwrap_or_default(),
        pade: arguments.pade.and_then(Pade::new).unwrap_or_default(),
        ..ExportRequest::default()
    })
}

/// Rejects options that apply to no requested format, and a request for checksums alone.
fn check_options(arguments: &ExportArguments, formats: &[ExportFormat]) -> Result<(), Failure> {
    if formats.is_empty() {
        let reason =
            format!("{CHECKSUMS} lists the checksums of the other files; add another format");
        return Err(Failure::coded_option("--as", "no-format", reason));
    }
    let options = [
        ("--breakpoints", arguments.breakpoints.is_some()),
        ("--condition", !arguments.condition.is_empty()),
        ("--model", arguments.model.is_some()),
        ("--correction", arguments.correction.is_some()),
        ("--pade", arguments.pade.is_some()),
    ];
    for (option, is_given) in options {
        if !is_given
            || formats
                .iter()
                .any(|format| format.options.contains(&option))
        {
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
