//! `gdcm check`: prints what a dataset or a study contains, or its faults.

use std::path::Path;

use gdcm_io::content_fault::ContentFault;
use gdcm_io::files::beginning_check::check_beginning;
use gdcm_io::files::dataset_file::dataset_faults;
use gdcm_io::files::opened_file::holds_models;
use gdcm_io::files::study_file::OpenedStudy;
use gdcm_io::{FileError, Opened};
use gdcm_model::dataset::BundleKind;
use gdcm_model::message_text::{sanitized, sanitized_path};
use gdcm_model::progress::Unobserved;
use gdcm_study::results::analysis::ConditionFailure;
use gdcm_study::stages::convention_check::doubts_of_models;
use gdcm_study::stages::model_cautions::cautions_of_models;
use gdcm_study::{Execution, Study};
use gdcm_words::caution::caution_text;

use super::analysis_summary::doubt_words;
use super::channel_values::ChannelSign;
use super::condition_messages::{ConditionMessage, shared_messages, with_conditions};
use super::dataset_contents::contents;
use super::failure::Failure;
use super::open;
use super::printed_lines::{caution_line, line};
use super::study_arguments::OpeningArguments;
use super::study_options::apply_signs;
use super::terminal::{error, keep_caution, print};

/// Prints what a dataset or study contains, with cautions about its models; or every fault in it.
pub(super) fn check(
    file: &Path,
    arguments: &OpeningArguments,
    signs: &[ChannelSign],
) -> Result<(), Failure> {
    if file.is_file() && !holds_models(file) {
        // Reports structural errors before a large file is read as a whole.
        check_beginning(file)?;
    }
    let opened = match open(file, arguments) {
        Err(Failure::File(error)) if has_several_faults(&error) => {
            return Err(report_faults(file, error));
        }
        opened => opened?,
    };
    let (decided, mut study, loaded) = match opened {
        Opened::Dataset(loaded) => (String::new(), Study::new(loaded.dataset.clone()), loaded),
        Opened::Study(OpenedStudy { study, loaded, .. }) => {
            (decisions(file, &study), study, loaded)
        }
    };
    apply_signs(&mut study, signs)?;
    print(&(decided + &contents(&loaded) + &model_cautions(&study)?))
}

/// Returns whether an error concerns a dataset's content, which may have further faults; after a
/// syntax error no others can be found.
fn has_several_faults(error: &FileError) -> bool {
    matches!(error, FileError::Content { fault, .. } if matches!(**fault, ContentFault::Dataset(_)))
}

/// Prints every fault in a dataset, and returns the failure with their number. A single fault is
/// not printed: it is the returned failure.
fn report_faults(file: &Path, first: FileError) -> Failure {
    match dataset_faults(file) {
        Ok(faults) if faults.len() > 1 => {
            for fault in &faults {
                error(fault.code(), &fault.to_string());
            }
            Failure::Faulty {
                path: sanitized_path(file),
                count: faults.len(),
            }
        }
        // If there is a single fault, or the file is a study, the first error is complete.
        _ => Failure::File(first),
    }
}

/// Returns those cautions from an analysis that concern only the models, and adds them to the JSON
/// object. Missing references come first, then signs and units, because other cautions may result
/// from them.
fn model_cautions(study: &Study) -> Result<String, Failure> {
    let execution = Execution::new(&crate::executor::Pool, &Unobserved, 0);
    let dataset = &study.dataset;
    let mut text = String::new();
    let without = dataset.without_reference();
    if !without.is_empty() {
        let failure = ConditionFailure::NoReference;
        let words = failure.to_string();
        keep_caution(failure.code(), &without, &words);
        text += &caution_line(&with_conditions(&without, &words));
    }
    for doubt in doubts_of_models(study, &execution)? {
        let words = doubt_words(&doubt, dataset);
        keep_caution("convention-doubt", &doubt.conditions, &words);
        text += &caution_line(&words);
    }
    let cautions = cautions_of_models(study, &execution)?;
    let messages = cautions.into_iter().map(|(id, caution)| {
        let words = caution_text(&caution, |pair| dataset.pair_name(pair));
        ConditionMessage::new(id, caution.code(), words)
    });
    for shared in shared_messages(messages) {
        keep_caution(
            shared.message.code,
            &shared.conditions,
            &shared.message.text,
        );
        text += &caution_line(&shared.words());
    }
    Ok(text)
}

/// Lists a study's rejected and pinned models, and its held-out and unscheduled conditions.
fn decisions(file: &Path, study: &Study) -> String {
    let mut text = line("Study", &sanitized_path(file));
    for condition in study.dataset.conditions() {
        let id = condition.id();
        let choice = study.choice(id);
        let rejected = study.rejected_names(id);
        let rejected: Vec<String> = rejected.into_iter().map(sanitized).collect();
        if !rejected.is_empty() {
            let words = format!("condition {id}: {}", rejected.join(", "));
            text += &line("Rejected", &words);
        }
        for kind in BundleKind::BOTH {
            if let Some(name) = &choice.bundle(kind).pinned {
                let words = format!(
                    "condition {id}: {} as {kind} representative",
                    sanitized(name)
                );
                text += &line("Chosen", &words);
            }
        }
        if choice.held_out {
            text += &line("Held out", &format!("condition {id}"));
        }
        if !choice.scheduled {
            text += &line("Unscheduled", &format!("condition {id}"));
        }
    }
    text
}
