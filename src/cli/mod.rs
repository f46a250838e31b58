//! Commands that work without the window.
//!
//! Exit status: 0 done; 1 no complete result; 2 the command line or a file is wrong. The reason is
//! reported on standard error.

mod analysis_summary;
mod analyze;
mod arguments;
mod assemble;
mod bandwidth_summary;
pub mod calls;
mod channel_declarations;
mod channel_values;
mod check;
mod command_line;
mod condition_messages;
mod condition_summary;
mod convert;
mod dataset_contents;
mod dataset_lookup;
mod evidence_summary;
mod export;
mod failure;
mod figure;
mod file_values;
mod flight_records;
mod found_models;
mod held_out_records;
mod identification_task;
mod identifications;
mod identify;
mod identify_arguments;
mod interruption;
mod leave_one_out;
mod man_pages;
mod misspelling;
mod model_arguments;
mod option_values;
mod parameter_values;
mod physics_summary;
mod plan;
mod plan_arguments;
mod printed_lines;
mod progress;
mod receiving_dataset;
mod record_parts;
mod record_remedies;
mod record_table;
mod recurring_cautions;
mod report;
mod requested_channels;
mod requirements;
mod result_arguments;
mod schedule_summary;
mod shared_cautions;
mod study_analysis;
mod study_arguments;
mod study_options;
mod terminal;
mod time_histories;
mod verify;

use std::ffi::OsString;
use std::path::{Path, PathBuf};

use clap::Parser;

use gdcm_io::files::opened_file::holds_models;
use gdcm_io::files::study_file::open_study_of;
use gdcm_io::reading_budget::ReadingBudget;
use gdcm_io::{Example, Existing, Opened, load_any};
use gdcm_model::message_text::sanitized_path;
use gdcm_words::dataset_differences::dataset_difference_text;

use crate::executor::start_threads;
use arguments::{Arguments, Command};
use command_line::{has_argument, take_leading_switches, usage_words, with_values_joined};
use failure::{Failure, WRONG_INPUT};
use study_arguments::OpeningArguments;
use terminal::{OutputFormat, caution, print};

/// Runs the command on the command line. Without a command, opens the window with a file or with
/// the embedded example. Help, version and command-line errors are printed here. Returns the exit
/// status.
pub fn run(
    arguments: impl IntoIterator<Item = OsString>,
    open_window: impl FnOnce(Option<PathBuf>) -> u8,
) -> u8 {
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
            terminal::error("wrong-command-line", &usage_words(&wrong));
            terminal::end(WRONG_INPUT)
        }
        Err(help) => finish(print(&help.to_string())),
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
        Command::Plan(arguments) => plan::plan(arguments),
        Command::Check {
            file,
            opening,
            sign,
        } => check::check(file, opening, sign),
        Command::Verify => verify::verify(),
        Command::Example {
            directory,
            real,
            force,
        } => write_example(chosen_example(*real), directory, existing(*force)),
        Command::Licences => print(crate::licences::TEXT),
        Command::ManPages { directory, force } => {
            man_pages::write_man_pages(directory, existing(*force))
        }
    }
}

/// Opens a dataset or a study, whose dataset is at `--dataset` if it has moved. If the dataset has
/// changed since the study was saved, the differences are reported on standard error, one per line.
///
/// # Errors
/// The file holds models, which are to be assembled first; it cannot be read; with `--strict`, the
/// dataset has changed.
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
            let words = dataset_difference_text(difference);
            caution(difference.code(), &format!("{}: {words}", file.display()));
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

fn chosen_example(is_real: bool) -> Example {
    if is_real {
        Example::RealAircraft
    } else {
        Example::Simulated
    }
}

/// Writes an embedded example into a directory, and prints the paths and a description of the
/// files.
fn write_example(example: Example, directory: &Path, existing: Existing) -> Result<(), Failure> {
    let paths = example.write(directory, existing)?;
    let mut text = String::new();
    for path in &paths {
        text.push_str(&sanitized_path(path));
        text.push('\n');
    }
    text.push_str(match example {
        Example::Simulated => {
            "the example dataset (synthetic data)\nits flight records, example-records.zip, are in \
             the folder assets of the program's source code; the window finds them if they are \
             beside the dataset\n"
        }
        Example::RealAircraft => {
            "pelican: a published physics model of a quadrotor (physics.json), records of two \
             flights, and the dataset with the models identified from them (real-aircraft.json)\n\
             antx: a physics model and records of a second quadrotor\n\
             flight data of others: each LICENSE applies to the files beside it\n"
        }
    });
    print(&text)
}

fn existing(force: bool) -> Existing {
    if force {
        Existing::Replace
    } else {
        Existing::Keep
    }
}

/// Prints the error if there is one; returns the exit status.
fn finish(result: Result<(), Failure>) -> u8 {
    let status = match result {
        Ok(()) => 0,
        Err(failure) => {
            terminal::error(failure.code(), &failure.to_string());
            failure.status()
        }
    };
    terminal::end(status)
}
