//! The command line that writes the same files as the export dialog.
//!
//! It names the saved study, or else the dataset, with options for the decisions that differ from
//! this file. If options cannot express a difference, the study must be saved first. A *held*
//! response is one that the correction must match exactly.

use std::path::{Path, PathBuf};

use gdcm_io::Example;
use gdcm_io::export::export_set::{CHECKSUMS, ExportSet};
use gdcm_model::dataset::{BundleKind, ModelId};
use gdcm_study::decisions::export_choices::ExportChoices;
use gdcm_study::decisions::setting_table::SETTINGS;
use gdcm_study::{Edit, Study};

use super::document_files::DocumentFiles;
use crate::gui::state::export_form::ExportForm;
use crate::message::Message;

/// File that a command reads, with the study that it contains.
pub(super) struct CommandSource {
    /// `None` for an embedded example.
    file: Option<PathBuf>,
    /// Study in the file, for a dataset with default decisions; `None` if a command cannot read it.
    study: Option<Study>,
}

impl CommandSource {
    /// Returns the saved study; if there is none, or if it counts as unsaved, the dataset.
    pub(super) fn from_files(files: &DocumentFiles) -> Self {
        if let (Some(path), Some(study)) = (&files.saved.path, &files.saved.study) {
            return Self {
                file: Some(path.clone()),
                study: Some(study.clone()),
            };
        }
        let is_readable = match files.loaded.origin.example() {
            Some(example) => example == Example::Simulated,
            None => true,
        };
        Self {
            file: files.loaded.path().map(Path::to_owned),
            study: if is_readable {
                Some(Study::new(files.loaded.dataset.clone()))
            } else {
                None
            },
        }
    }
}

/// Returns the command line: a line for the formats, if any, and a line for the report, if it is
/// among the files.
///
/// # Errors
/// A message if the form is incomplete, or if the study must be saved first.
pub(super) fn export_command_line(
    study: &Study,
    source: &CommandSource,
    form: &ExportForm,
) -> Result<String, Message> {
    let set = form.export_set()?;
    let Some(decisions) = study_words(study, source) else {
        let text = "the command line reads the decisions from the study: save it first";
        return Err(Message::new("study-not-saved", text));
    };
    let mut lines = Vec::new();
    if !set.formats.is_empty() {
        lines.push(shell_line(&export_words(form, &set, &decisions)));
    }
    if set.has_report {
        lines.push(shell_line(&report_words(form, &set, &decisions)));
    }
    Ok(lines.join("\n"))
}

/// Returns the words of `gdcm export`: the study, the formats, the folder, the options that the
/// formats accept, and what happens to existing files.
fn export_words(form: &ExportForm, set: &ExportSet, decisions: &[String]) -> Vec<String> {
    let mut words = vec!["gdcm".to_owned(), "export".to_owned()];
    words.extend(decisions.iter().cloned());
    let mut names: Vec<&str> = set.formats.iter().map(|format| format.name).collect();
    if set.has_checksums {
        names.push(CHECKSUMS);
    }
    words.extend(["--as".to_owned(), names.join(",")]);
    words.extend([
        "--folder".to_owned(),
        absolute(&set.folder).display().to_string(),
    ]);
    if !set.prefix.is_empty() {
        words.extend(["--prefix".to_owned(), set.prefix.clone()]);
    }
    for given in given_options(form, set.request.breakpoints_kt.as_deref()) {
        let is_accepted = set
            .formats
            .iter()
            .any(|format| format.options.contains(&given.option));
        if is_accepted {
            words.extend([given.option.to_owned(), given.argument]);
        }
    }
    let existing = if form.choices.replaces {
        "--force"
    } else {
        "--number"
    };
    words.push(existing.to_owned());
    words
}

/// Returns the words of `gdcm report`: the study, and the path.
fn report_words(form: &ExportForm, set: &ExportSet, decisions: &[String]) -> Vec<String> {
    let mut words = vec!["gdcm".to_owned(), "report".to_owned()];
    words.extend(decisions.iter().cloned());
    let path = absolute(&set.folder).join(format!("{}report.html", set.prefix));
    words.extend(["--out".to_owned(), path.display().to_string()]);
    if form.choices.replaces {
        words.push("--force".to_owned());
    }
    words
}

/// Returns the absolute path, so that the command may be run in any folder; the path itself if that
/// fails.
fn absolute(path: &Path) -> PathBuf {
    std::path::absolute(path).unwrap_or_else(|_| path.to_owned())
}

/// Command-line option with its argument.
struct GivenOption {
    option: &'static str,
    argument: String,
}

/// Returns the export options that differ from their defaults.
fn given_options(form: &ExportForm, breakpoints_kt: Option<&[f64]>) -> Vec<GivenOption> {
    let choices = &form.choices;
    let mut options = Vec::new();
    if let Some(conditions) = &choices.conditions {
        let ids: Vec<String> = conditions.iter().map(ToString::to_string).collect();
        options.push(GivenOption {
            option: "--condition",
            argument: ids.join(","),
        });
    }
    if choices.model != ExportChoices::NOMINAL {
        options.push(GivenOption {
            option: "--model",
            argument: choices.model.clone(),
        });
    }
    if choices.per_condition {
        options.push(GivenOption {
            option: "--correction",
            argument: "own".to_owned(),
        });
    }
    if choices.pade_order != ExportChoices::default().pade_order {
        options.push(GivenOption {
            option: "--pade",
            argument: choices.pade_order.to_string(),
        });
    }
    if let Some(airspeeds_kt) = breakpoints_kt {
        let airspeeds: Vec<String> = airspeeds_kt.iter().map(f64::to_string).collect();
        options.push(GivenOption {
            option: "--breakpoints",
            argument: airspeeds.join(","),
        });
    }
    options
}

/// Returns the file that a command reads, and options that turn its study into `study`; `None` if
/// options cannot express the difference:
///
/// 1. begin with a trial, the study that the command reads;
/// 2. for each difference in settings, held responses, rejected models and held-out conditions, add
///    an option, and apply it to the trial;
/// 3. the trial must then equal the study; anything else that differs cannot be expressed.
fn study_words(study: &Study, source: &CommandSource) -> Option<Vec<String>> {
    // Step 1.
    let mut trial = source.study.clone()?;
    let mut words = Vec::new();
    if let Some(file) = &source.file {
        words.push(absolute(file).display().to_string());
    }
    // Step 2.
    for setting in SETTINGS {
        let value = setting.value(&study.settings);
        if setting.value(&trial.settings) == value {
            continue;
        }
        words.extend(setting.option_words(value)?);
        trial.apply(&setting.to(value)).ok()?;
    }
    words.extend(held_words(study, &mut trial)?);
    words.extend(condition_words(study, &mut trial)?);
    // Step 3.
    let is_same = trial.settings == study.settings
        && trial.choices == study.choices
        && trial.signs == study.signs
        && trial.requirements == study.requirements
        && trial.dataset == study.dataset;
    if is_same { Some(words) } else { None }
}

/// Returns the option for the held responses, and applies it to `trial`; empty if the responses do
/// not differ, `None` if the study does not permit this.
fn held_words(study: &Study, trial: &mut Study) -> Option<Vec<String>> {
    if trial.settings.constrained == study.settings.constrained {
        return Some(Vec::new());
    }
    let (inputs, outputs) = study.dataset.input_and_output_names();
    let mut names = Vec::new();
    for pair in study.dataset.on_axis().pairs() {
        let is_held = study.settings.constrained[pair];
        if is_held {
            names.push(format!("{}/{}", outputs[pair.output], inputs[pair.input]));
        }
        trial.apply(&Edit::Hold(pair, is_held)).ok()?;
    }
    let names = if names.is_empty() {
        "none".to_owned()
    } else {
        names.join(",")
    };
    Some(vec!["--on".to_owned(), names])
}

/// Returns the options for the rejected models and held-out conditions that `trial` lacks, and
/// applies them to it; `None` if the study does not permit this.
fn condition_words(study: &Study, trial: &mut Study) -> Option<Vec<String>> {
    let mut words = Vec::new();
    let mut held_out = Vec::new();
    for (id, choice) in &study.choices {
        if choice.held_out && !trial.choice(*id).held_out {
            held_out.push(id.to_string());
            let edit = Edit::SetHeldOut {
                condition: *id,
                held_out: true,
            };
            trial.apply(&edit).ok()?;
        }
        for bundle in BundleKind::BOTH {
            for name in &choice.bundle(bundle).rejected {
                if trial.choice(*id).bundle(bundle).rejected.contains(name) {
                    continue;
                }
                words.extend(["--reject".to_owned(), format!("{id}:{name}")]);
                let model = ModelId::new(*id, bundle, name);
                trial.apply(&Edit::Reject(model)).ok()?;
            }
        }
    }
    if !held_out.is_empty() {
        words.extend(["--hold-out".to_owned(), held_out.join(",")]);
    }
    Some(words)
}

/// Joins words to a line for a shell; empty words, and words with special characters, are quoted.
fn shell_line(words: &[String]) -> String {
    let quoted: Vec<String> = words.iter().map(|word| shell_word(word)).collect();
    quoted.join(" ")
}

#[cfg(not(windows))]
fn shell_word(word: &str) -> String {
    if is_plain(word) {
        word.to_owned()
    } else {
        format!("'{}'", word.replace('\'', r"'\''"))
    }
}

/// Quotes a word so that both the Windows command prompt and PowerShell read it correctly.
#[cfg(windows)]
fn shell_word(word: &str) -> String {
    if is_plain(word)
        || word
            .chars()
            .all(|letter| is_plain_letter(letter) || letter == '\\')
    {
        word.to_owned()
    } else {
        format!("\"{word}\"")
    }
}

fn is_plain(word: &str) -> bool {
    !word.is_empty() && word.chars().all(is_plain_letter)
}

fn is_plain_letter(letter: char) -> bool {
    letter.is_ascii_alphanumeric() || "-_./:=,+".contains(letter)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[cfg(not(windows))]
    #[test]
    fn words_are_quoted_where_a_shell_would_change_them() {
        let words = ["gdcm", "a b", "it's", "1:V+5kt", ""].map(str::to_owned);
        assert_eq!(shell_line(&words), r"gdcm 'a b' 'it'\''s' 1:V+5kt ''");
    }
}
