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
mod identify;
mod identify_arguments;
mod models;
mod read_record;
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

use gdcm_core::message_text::{sanitized, sanitized_path};
use gdcm_files::{Existing, Opened, load_any, open_study_of, write_example};

use arguments::{Arguments, real_number, whole_number};
use destination::{Destination, Group, said_conditions};
use failure::Failure;
use models::{ReadingProgress, counted};
use read_record::{hold_out, laid_out, record_table, relative_entry};
use study_options::{analysis_of, condition_of, ids, names, pairs_of, study_of, turn};
use summary::{LABEL, leave_one_out_section};
use terminal::{TerminalProgress, say, say_error};
use text_table::{indented, labelled, listed};

pub use arguments::{
    AnalyzeArguments, AssembleArguments, Command, ConvertArguments, FigureArguments, OpeningArguments, PairChoice,
    PairList, Rejection, ReportArguments, SaidSign, StudyArguments,
};
pub use export::{Breakpoints, ExportArguments};
pub use identify_arguments::{ChannelConversion, ChannelDelay, ChannelList, IdentifyArguments, OfferedChoice};

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
    match Arguments::try_parse_from(arguments) {
        Ok(Arguments { command: Some(command), .. }) => Ok(Request::Command(Box::new(command))),
        Ok(Arguments { command: None, file }) => Ok(Request::Window(file)),
        Err(error) if error.use_stderr() => {
            say_error(&usage_words(&error));
            Err(ExitCode::from(failure::WRONG_INPUT))
        }
        Err(help) => Err(finish(say(&help.to_string()))),
    }
}

/// Carries out a command.
pub fn run(command: &Command) -> ExitCode {
    finish(match command {
        Command::Analyze(arguments) => analyze::analyze(arguments),
        Command::Figure(arguments) => figure::figure(arguments),
        Command::Report(arguments) => analyze::report(arguments),
        Command::Export(arguments) => export::export(arguments),
        Command::Assemble(arguments) => models::assemble(arguments),
        Command::Convert(arguments) => models::convert(arguments),
        Command::Identify(arguments) => identify::identify(arguments),
        Command::Check { file, opening, sign } => check::check(file, opening, sign),
        Command::Example { directory, force } => example(directory, existing(*force)),
    })
}

/// Opens a dataset or a study; what is different in a study's dataset is told on standard error, a line each.
fn open(file: &Path, arguments: &OpeningArguments) -> Result<Opened, Failure> {
    let opened = match &arguments.dataset {
        Some(dataset) => Opened::Study(open_study_of(file, dataset)?),
        None => load_any(file)?,
    };
    if let Opened::Study(study) = &opened {
        for difference in &study.differences {
            say_error(&format!("{}: {}", sanitized_path(file), sanitized(&difference.to_string())));
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
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            say_error(&failure.to_string());
            ExitCode::from(failure.status())
        }
    }
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
