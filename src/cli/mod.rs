//! The commands that need no window.
//!
//! Exit status: 0 done, 1 the analysis could not be done, 2 the command line or a file is wrong; the reason on standard error.

mod analyze;
mod arguments;
mod check;
mod destination;
mod export;
mod failure;
mod figure;
mod history_records;
mod identify;
mod identify_arguments;
mod models;
mod read_record;
mod requirements;
mod study_options;
mod summary;
mod terminal;
mod text_table;

use std::error::Error;
use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::Parser;
use clap::error::{ContextKind, ContextValue};

use gdcm_core::message_text::sanitized_path;
use gdcm_core::study::{Kind, SETTINGS};
use gdcm_files::variables::ReadingBudget;
use gdcm_files::{Existing, Opened, holds_models, load_any, open_study_of, write_example};

use crate::executor::start_threads;
use arguments::{Arguments, real_number, whole_number};
use destination::{Destination, Group, said_conditions};
use failure::{Failure, listed_paths};
use history_records::{entry_of_dataset, time_histories};
use models::{ReadingProgress, counted};
use read_record::{ReadRecords, found_records, hold_out, is_called, laid_out, record_table};
use study_options::{analysis_of, condition_of, ids, names, pairs_of, study_of, turn};
use summary::{LABEL, doubt_words, leave_one_out_section};
use terminal::{Manner, TerminalProgress, caution, caution_of, error, keep_caution, note, progress_target, say};
use text_table::{by_words, indented, labelled, listed, listed_conditions};

pub use arguments::{
    AnalyzeArguments, AssembleArguments, Command, ConvertArguments, FigureArguments, OpeningArguments, PairChoice,
    PairList, Rejection, ReportArguments, RequirementsArguments, SaidSign, StudyArguments,
};
pub use export::{Breakpoints, ExportArguments};
pub use history_records::HistoryArguments;
pub use identify_arguments::{
    ChannelConversion, ChannelDelay, ChannelTopic, IdentifyArguments, OfferedChoice, RecordPart, of_one_record,
};
use identify_arguments::{said_unit, say_conversions};

/// What the command line asks for.
#[derive(Debug)]
pub enum Request {
    /// The window, on a file or on the embedded example.
    Window(Option<PathBuf>),
    /// A command without a window.
    Command(Box<Command>),
}

/// Reads a command line; help, version and errors are printed here, and leave only the exit status.
pub fn request(arguments: impl IntoIterator<Item = OsString>) -> Result<Request, ExitCode> {
    let arguments = joined(arguments);
    // A command line that is not understood is told of in the manner that it asks for.
    let asks = |option: &str| arguments.iter().any(|argument| argument == option);
    terminal::speak(Manner { quiet: asks("--quiet"), json: asks("--json") });
    match Arguments::try_parse_from(arguments) {
        Ok(Arguments { command: Some(command), quiet, json, .. }) => {
            terminal::speak(Manner { quiet, json });
            Ok(Request::Command(Box::new(command)))
        }
        Ok(Arguments { command: None, file, .. }) => Ok(Request::Window(file)),
        Err(wrong) if wrong.use_stderr() => {
            error(&usage_words(&wrong));
            Err(ExitCode::from(terminal::end(failure::WRONG_INPUT)))
        }
        Err(help) => Err(finish(say(&help.to_string()))),
    }
}

/// The arguments, a word that stands for no range joined to its option: `--gain-bounds auto FILE` does not take the file for its
/// second number.
fn joined(arguments: impl IntoIterator<Item = OsString>) -> Vec<OsString> {
    let mut joined: Vec<OsString> = Vec::new();
    for argument in arguments {
        let joins = SETTINGS.iter().any(|setting| {
            let is_word = matches!(setting.kind, Kind::Range { nothing: Some([word, _]), .. } if argument == word);
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

/// Carries out a command.
pub fn run(command: &Command) -> ExitCode {
    let carry_out = || match command {
        Command::Analyze(arguments) => analyze::analyze(arguments),
        Command::Figure(arguments) => figure::figure(arguments),
        Command::Report(arguments) => analyze::report(arguments),
        Command::Requirements(arguments) => requirements::requirements(arguments),
        Command::Export(arguments) => export::export(arguments),
        Command::Assemble(arguments) => models::assemble(arguments),
        Command::Convert(arguments) => models::convert(arguments),
        Command::Identify(arguments) => identify::identify(arguments),
        Command::Check { file, opening, sign } => check::check(file, opening, sign),
        Command::Example { directory, force } => example(directory, existing(*force)),
    };
    finish(start_threads().map_err(|reason| Failure::NoThreads { reason }).and_then(|()| carry_out()))
}

/// Opens a dataset or a study; what is different in a study's dataset is told on standard error, a line each.
fn open(file: &Path, arguments: &OpeningArguments) -> Result<Opened, Failure> {
    if file.is_file() && file.extension().is_some() && holds_models(file) {
        return Err(Failure::Models { path: sanitized_path(file) });
    }
    let opened = match &arguments.dataset {
        Some(dataset) => Opened::Study(open_study_of(file, dataset, &ReadingBudget::default())?),
        None => load_any(file, &ReadingBudget::default())?,
    };
    if let Opened::Study(study) = &opened {
        for difference in &study.differences {
            caution(&format!("{}: {difference}", file.display()));
        }
        if arguments.strict && !study.differences.is_empty() {
            return Err(Failure::Different { path: sanitized_path(file), count: study.differences.len() });
        }
    }
    Ok(opened)
}

/// Writes the embedded example into a directory and says where.
fn example(directory: &Path, existing: Existing) -> Result<(), Failure> {
    let path = write_example(directory, existing)?;
    say(&format!(
        "{}: the example dataset (synthetic data)\nthe flight records that it names, example-records.zip, are under assets in the \
         program's source; the window finds them beside the dataset\n",
        sanitized_path(&path)
    ))
}

fn existing(force: bool) -> Existing {
    if force { Existing::Replace } else { Existing::Keep }
}

fn finish(result: Result<(), Failure>) -> ExitCode {
    let status = result.err().map_or(0, |failure| {
        error(&failure.to_string());
        failure.status()
    });
    ExitCode::from(terminal::end(status))
}

/// clap's complaint on one line, without the usage that it repeats below; of a value, the option and what is wrong with it.
fn usage_words(error: &clap::Error) -> String {
    if let (Some(ContextValue::String(option)), Some(reason)) = (error.get(ContextKind::InvalidArg), error.source()) {
        return format!("{}: {reason}", option.split(' ').next().unwrap_or(option));
    }
    let words = error.to_string();
    let complaint = words.split("\n\nUsage:").next().unwrap_or(&words);
    let paragraphs = complaint.split("\n\n").filter(|paragraph| !paragraph.starts_with("For more information"));
    let line = |paragraph: &str| paragraph.lines().map(str::trim).collect::<Vec<_>>().join(" ");
    let line = paragraphs.map(line).collect::<Vec<_>>().join("; ");
    format!("{} (gdcm --help says more)", line.strip_prefix("error: ").unwrap_or(&line).trim_end())
}
