//! The commands that need no window.
//!
//! Exit status: 0 done, 1 the analysis could not be done, 2 the command line or a file is wrong;
//! the reason on standard error.

mod arguments;
mod check;
pub mod flight_records;
mod identify;
mod identify_arguments;
mod misspelling;
mod models;
mod requirements;
mod results;
mod study_options;
mod summary;
mod terminal;

use std::error::Error;
use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::Parser;
use clap::error::{ContextKind, ContextValue};

use gdcm_io::files::dataset_file::write_example;
use gdcm_io::files::study_file::{holds_models, open_study_of};
use gdcm_io::reading_budget::ReadingBudget;
use gdcm_io::{Existing, Opened, load_any};
use gdcm_model::message_text::sanitized_path;
use gdcm_study::decisions::setting::SETTINGS;
use gdcm_study::decisions::setting_row::Kind;
use gdcm_words::decisions::dataset_difference_text;

use crate::executor::start_threads;
use arguments::{Arguments, Command, OpeningArguments};
use terminal::{Failure, Manner, WRONG_INPUT, caution, coded_error, error, say};

/// Carries out a command line. Without a command it opens a window, on a file or on the embedded
/// example; it prints help, version and errors itself.
pub fn run(
    arguments: impl IntoIterator<Item = OsString>,
    open_window: impl FnOnce(Option<PathBuf>) -> ExitCode,
) -> ExitCode {
    let arguments = joined(arguments);
    // A command line that cannot be parsed is still reported in the requested format.
    let asks = |option: &str| arguments.iter().any(|argument| argument == option);
    terminal::speak(Manner {
        quiet: asks("--quiet"),
        json: asks("--json"),
    });
    if let Some(misspelling) = misspelling::misspelt_command(&arguments) {
        return finish(Err(misspelling));
    }
    match Arguments::try_parse_from(arguments) {
        Ok(Arguments {
            command: Some(command),
            quiet,
            json,
            ..
        }) => {
            terminal::speak(Manner { quiet, json });
            finish(
                start_threads()
                    .map_err(|reason| Failure::NoThreads { reason })
                    .and_then(|()| carry_out(&command)),
            )
        }
        Ok(Arguments {
            command: None,
            file,
            ..
        }) => open_window(file),
        Err(wrong) if wrong.use_stderr() => {
            error(&usage_words(&wrong));
            ExitCode::from(terminal::end(WRONG_INPUT))
        }
        Err(help) => finish(say(&help.to_string())),
    }
}

/// Joins a value to its option if the option takes a variable number of values: `--gain-bounds auto
/// FILE` must not take the file for its second number, nor `--schedule-delays FILE` for its value.
fn joined(arguments: impl IntoIterator<Item = OsString>) -> Vec<OsString> {
    let mut joined: Vec<OsString> = Vec::new();
    for argument in arguments {
        let joins = SETTINGS.iter().any(|setting| {
            let is_word = match setting.kind {
                Kind::Range {
                    nothing: Some([word, _]),
                    ..
                } => argument == word,
                Kind::Choice { words, .. } if setting.bare.is_some() => {
                    words.iter().any(|[word, ..]| argument == *word)
                }
                _ => false,
            };
            is_word && joined.last().is_some_and(|last| last == setting.option)
        });
        match joined.last_mut().filter(|_| joins) {
            Some(option) => {
                option.push("=");
                option.push(argument);
            }
            None => joined.push(argument),
        }
    }
    joined
}

fn carry_out(command: &Command) -> Result<(), Failure> {
    match command {
        Command::Analyze(arguments) => results::analyze(arguments),
        Command::Figure(arguments) => results::figure(arguments),
        Command::Report(arguments) => results::report(arguments),
        Command::Requirements(arguments) => requirements::requirements(arguments),
        Command::Export(arguments) => results::export(arguments),
        Command::Assemble(arguments) => models::assemble(arguments),
        Command::Convert(arguments) => models::convert(arguments),
        Command::Identify(arguments) => identify::identify(arguments),
        Command::Check {
            file,
            opening,
            sign,
        } => check::check(file, opening, sign),
        Command::Example { directory, force } => example(directory, existing(*force)),
    }
}

/// Opens a dataset or a study; reports the differences in a study's dataset on standard error, one
/// per line.
fn open(file: &Path, arguments: &OpeningArguments) -> Result<Opened, Failure> {
    if file.is_file() && file.extension().is_some() && holds_models(file) {
        return Err(Failure::Models {
            path: sanitized_path(file),
        });
    }
    let opened = match &arguments.dataset {
        Some(dataset) => Opened::Study(open_study_of(file, dataset, &ReadingBudget::default())?),
        None => load_any(file, &ReadingBudget::default())?,
    };
    if let Opened::Study(study) = &opened {
        for difference in &study.differences {
            caution(&format!(
                "{}: {}",
                file.display(),
                dataset_difference_text(difference)
            ));
        }
        if arguments.strict && !study.differences.is_empty() {
            return Err(Failure::Different {
                path: sanitized_path(file),
                count: study.differences.len(),
            });
        }
    }
    Ok(opened)
}

/// Writes the embedded example into a directory and reports the path.
fn example(directory: &Path, existing: Existing) -> Result<(), Failure> {
    let path = write_example(directory, existing)?;
    say(&format!(
        "{}: the example dataset (synthetic data)\nthe flight records that it names, example-records.zip, are under assets in the \
         program's source; the window finds them beside the dataset\n",
        sanitized_path(&path)
    ))
}

fn existing(force: bool) -> Existing {
    if force {
        Existing::Replace
    } else {
        Existing::Keep
    }
}

fn finish(result: Result<(), Failure>) -> ExitCode {
    let status = result.err().map_or(0, |failure| {
        coded_error(failure.code(), &failure.to_string());
        failure.status()
    });
    ExitCode::from(terminal::end(status))
}

/// Returns clap's message on one line, without the usage, which is printed below; for a wrong
/// value, the option and the reason.
fn usage_words(error: &clap::Error) -> String {
    if let (Some(ContextValue::String(option)), Some(reason)) =
        (error.get(ContextKind::InvalidArg), error.source())
    {
        return format!("{}: {reason}", option.split(' ').next().unwrap_or(option));
    }
    let words = error.to_string();
    let complaint = words.split("\n\nUsage:").next().unwrap_or(&words);
    let paragraphs = complaint
        .split("\n\n")
        .filter(|paragraph| !paragraph.starts_with("For more information"));
    let line = |paragraph: &str| {
        paragraph
            .lines()
            .map(str::trim)
            .collect::<Vec<_>>()
            .join(" ")
    };
    let line = paragraphs.map(line).collect::<Vec<_>>().join("; ");
    format!(
        "{} (gdcm --help says more)",
        line.strip_prefix("error: ").unwrap_or(&line).trim_end()
    )
}
