//! Commands that work without the window.
//!
//! Exit status: 0 done; 1 no complete result; 2 the command line or a file is wrong. The reason is
//! reported on standard error.

mod analyze;
mod arguments;
mod assemble;
mod bandwidth_summary;
mod channel_values;
mod check;
mod condition_messages;
mod condition_summary;
mod convert;
mod destination;
mod export;
mod failure;
mod figure;
mod flight_records;
mod found_models;
mod held_out_records;
mod histories;
mod identification_task;
mod identify;
mod identify_arguments;
mod interruption;
mod misspelling;
mod model_arguments;
mod option_values;
mod progress;
mod record_parts;
mod record_remedies;
mod report;
mod requested_channels;
mod requirements;
mod result_arguments;
mod schedule_summary;
mod shared_cautions;
mod study_analysis;
mod study_arguments;
mod study_options;
mod summary;
mod terminal;
mod text;

use std::error::Error;
use std::ffi::{OsStr, OsString};
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::Parser;
use clap::error::{ContextKind, ContextValue};

use gdcm_io::files::dataset_file::write_example;
use gdcm_io::files::opened_file::holds_models;
use gdcm_io::files::study_file::open_study_of;
use gdcm_io::reading_budget::ReadingBudget;
use gdcm_io::{Existing, Opened, load_any};
use gdcm_model::message_text::sanitized_path;
use gdcm_study::decisions::setting::SETTINGS;
use gdcm_study::decisions::setting_row::Kind;
use gdcm_words::dataset_differences::dataset_difference_text;

use crate::executor::start_threads;
use arguments::{Arguments, Command};
use failure::{Failure, WRONG_INPUT};
use study_arguments::OpeningArguments;
use terminal::{OutputFormat, caution, coded_error, print};

/// Runs the command on the command line. Without a command, opens the window with a file or with
/// the embedded example. Help, version and errors of the command line are printed here.
pub fn run(
    arguments: impl IntoIterator<Item = OsString>,
    open_window: impl FnOnce(Option<PathBuf>) -> ExitCode,
) -> ExitCode {
    let mut arguments = with_values_joined(arguments);
    // Read the switches before parsing, so that an invalid command line is reported in the
    // requested format too.
    terminal::set_output(OutputFormat {
        quiet: has_argument(&arguments, "--quiet"),
        json: has_argument(&arguments, "--json"),
    });
    let leading = take_leading_switches(&mut arguments);
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
            terminal::set_output(OutputFormat {
                quiet: quiet || leading.quiet,
                json: json || leading.json,
            });
            finish(carry_out(&command))
        }
        Ok(Arguments {
            command: None,
            file,
            ..
        }) => open_window(file),
        Err(wrong) if wrong.use_stderr() => {
            coded_error(Some("wrong-command-line"), &usage_words(&wrong));
            ExitCode::from(terminal::end(WRONG_INPUT))
        }
        Err(help) => finish(print(&help.to_string())),
    }
}

fn has_argument(arguments: &[OsString], option: &str) -> bool {
    arguments.iter().any(|argument| argument == option)
}

/// Removes `--json` and `--quiet` before the command, and returns the output format that they
/// request. The parser itself cannot accept them there: it rejects a command after any other
/// argument, because it must reject one after the window's file. The first element of `arguments`
/// is the program.
fn take_leading_switches(arguments: &mut Vec<OsString>) -> OutputFormat {
    let mut output = OutputFormat::default();
    while let Some(argument) = arguments.get(1) {
        if argument == "--json" {
            output.json = true;
        } else if argument == "--quiet" {
            output.quiet = true;
        } else {
            break;
        }
        arguments.remove(1);
    }
    output
}

/// Joins an option and its value by "=" if the option takes a variable number of values. Otherwise
/// `--gain-bounds auto FILE` would take the file as its second number, and `--schedule-delays FILE`
/// as its value.
fn with_values_joined(arguments: impl IntoIterator<Item = OsString>) -> Vec<OsString> {
    let mut joined: Vec<OsString> = Vec::new();
    for argument in arguments {
        match joined.last_mut() {
            Some(option) if is_value_of(&argument, option) => {
                option.push("=");
                option.push(argument);
            }
            _ => joined.push(argument),
        }
    }
    joined
}

/// Returns whether an argument is a word accepted by an option with a variable number of values.
fn is_value_of(argument: &OsStr, option: &OsStr) -> bool {
    let Some(setting) = SETTINGS.iter().find(|setting| option == setting.option) else {
        return false;
    };
    match setting.kind {
        Kind::Range {
            nothing: Some([word, _]),
            ..
        } => argument == word,
        Kind::Choice { words, .. } if setting.bare.is_some() => {
            words.iter().any(|[word, ..]| argument == *word)
        }
        _ => false,
    }
}

fn carry_out(command: &Command) -> Result<(), Failure> {
    start_threads().map_err(|reason| Failure::NoThreads { reason })?;
    match command {
        Command::Analyze(arguments) => analyze::analyze(arguments),
        Command::Figure(arguments) => figure::figure(arguments),
        Command::Report(arguments) => report::report(arguments),
        Command::Requirements(arguments) => requirements::requirements(arguments),
        Command::Export(arguments) => export::export(arguments),
        Command::Assemble(arguments) => assemble::assemble(arguments),
        Command::Convert(arguments) => convert::convert(arguments),
        Command::Identify(arguments) => identify::identify(arguments),
        Command::Check {
            file,
            opening,
            sign,
        } => check::check(file, opening, sign),
        Command::Example { directory, force } => example(directory, existing(*force)),
    }
}

/// Opens a dataset or a study; if the dataset of a study has changed, the differences are reported
/// on standard error, one per line.
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
    print(&format!(
        "{}: the example dataset (synthetic data)\nits flight records, example-records.zip, are \
        in the folder assets of the program's source code; the window finds them if they are \
        beside the dataset\n",
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

/// Prints the error if there is one; returns the exit status.
fn finish(result: Result<(), Failure>) -> ExitCode {
    let status = match result {
        Ok(()) => 0,
        Err(failure) => {
            coded_error(failure.code(), &failure.to_string());
            failure.status()
        }
    };
    ExitCode::from(terminal::end(status))
}

/// Returns clap's error message on one line, without the usage, which is printed separately. For an
/// invalid value, returns the option and the reason.
fn usage_words(error: &clap::Error) -> String {
    if let (Some(ContextValue::String(option)), Some(reason)) =
        (error.get(ContextKind::InvalidArg), error.source())
    {
        return format!("{}: {reason}", option.split(' ').next().unwrap_or(option));
    }
    let words = error.to_string();
    let complaint = words.split("\n\nUsage:").next().unwrap_or(&words);
    let paragraphs: Vec<String> = complaint
        .split("\n\n")
        .filter(|paragraph| !paragraph.starts_with("For more information"))
        .map(on_one_line)
        .collect();
    let line = paragraphs.join("; ");
    format!(
        "{} (see gdcm --help)",
        line.strip_prefix("error: ").unwrap_or(&line).trim_end()
    )
}

fn on_one_line(paragraph: &str) -> String {
    let lines: Vec<&str> = paragraph.lines().map(str::trim).collect();
    lines.join(" ")
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns the remaining arguments after the program, and the output that the removed switches
    /// request.
    fn leading(words: &str) -> (Vec<String>, OutputFormat) {
        let mut arguments: Vec<OsString> = words.split(' ').map(OsString::from).collect();
        let output = take_leading_switches(&mut arguments);
        let left = arguments.into_iter().skip(1);
        let left = left.map(|word| word.into_string().expect("text")).collect();
        (left, output)
    }

    #[test]
    fn switches_before_the_command_are_taken_and_others_stay() {
        let both = OutputFormat {
            quiet: true,
            json: true,
        };
        let none = OutputFormat::default();
        let words = ["check".to_owned(), "--json".to_owned()];
        assert_eq!(
            leading("gdcm --json --quiet check --json"),
            (words.to_vec(), both)
        );
        assert_eq!(leading("gdcm check --json"), (words.to_vec(), none));
        assert_eq!(leading("gdcm"), (Vec::new(), none));
    }
}
