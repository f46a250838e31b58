//! Arguments and commands on the command line.

use std::path::PathBuf;

use clap::{Parser, Subcommand};

use super::channel_values::{ChannelSign, channel_sign};
use super::identify_arguments::IdentifyArguments;
use super::model_arguments::{AssembleArguments, ConvertArguments};
use super::plan_arguments::PlanArguments;
use super::result_arguments::{
    AnalyzeArguments, ExportArguments, FigureArguments, ReportArguments, RequirementsArguments,
};
use super::study_arguments::OpeningArguments;

/// Gain-Delay Correction Method: matches physics-based helicopter models to flight.
#[derive(Debug, Parser)]
#[command(name = "gdcm", version = gdcm_io::software::version(), args_conflicts_with_subcommands = true)]
pub(super) struct Arguments {
    #[command(subcommand)]
    pub(super) command: Option<Command>,
    /// Dataset or study to open in the window [default: the embedded example (synthetic data)]. A folder, or a file of another
    /// program, opens the import of models. For a file named like a command: ./analyze
    pub(super) file: Option<PathBuf>,
    /// Omit notes (lines that begin with "note:").
    #[arg(long, global = true)]
    pub(super) quiet: bool,
    /// Write results, notes, cautions and errors as one JSON object to standard output.
    #[arg(long, global = true)]
    pub(super) json: bool,
}

/// A command that needs no window.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Analyse a dataset or a study, write corrections.json, corrections.csv and assessment.csv, and print a summary.
    #[command(
        after_help = "Examples:\n  gdcm analyze example-dataset.json --reject-suggested --out results\n  gdcm analyze flight.gdcm-study.json --band 0.5 12 --second-variable mass --json --out results --force",
        alias = "analyse"
    )]
    Analyze(Box<AnalyzeArguments>),
    /// Write a figure, as in the window, or its numbers to a file.
    #[command(
        after_help = "Examples:\n  gdcm figure example-dataset.json --view net-gain --bars --out net-gain.pdf\n  gdcm figure example-dataset.json --view bode --condition 3 --pair Q/LON --out bode.svg"
    )]
    Figure(Box<FigureArguments>),
    /// Write the full report, ready to print: settings, rejections, gains and delays, unmatched responses with reasons,
    /// the schedule, the assessment, and every plot.
    #[command(
        after_help = "Examples:\n  gdcm report flight.gdcm-study.json --out report.html\n  gdcm report example-dataset.json --reject-suggested --out report.html --force"
    )]
    Report(Box<ReportArguments>),
    /// Compute the quantities required for a qualification from the models of every condition: bandwidth and phase delay, time
    /// histories within tolerances about flight records, summary costs, modes; write requirements.json and requirements.csv, and
    /// print a short table. These values do not replace a qualification.
    #[command(
        after_help = "Examples:\n  gdcm requirements example-dataset.json --reject-suggested --out requirements\n  gdcm requirements flight.gdcm-study.json --records sweeps --tolerances mine.json --out requirements --force"
    )]
    Requirements(Box<RequirementsArguments>),
    /// Write corrections for other tools: MATLAB, Python, C, lookup tables, corrected models as state-space.
    #[command(
        after_help = "Examples:\n  gdcm export flight.gdcm-study.json --as py --out corrections.py\n  gdcm export example-dataset.json --as state-space --condition 3 --out models.mat"
    )]
    Export(Box<ExportArguments>),
    /// Make a dataset from a folder with model files: MATLAB, NumPy, JSON, text. Without --rules, propose rules and list the missing items.
    #[command(
        after_help = "Examples:\n  gdcm assemble models --out dataset.json.gz\n  gdcm assemble models --rules dataset.gdcm-rules.json --out dataset.json.gz --force"
    )]
    Assemble(AssembleArguments),
    /// Convert every model and response in files of any supported format to JSON.
    #[command(
        after_help = "Examples:\n  gdcm convert model.mat --out models.json\n  gdcm convert folder other.npz --out models.json --force"
    )]
    Convert(ConvertArguments),
    /// Identify models and their uncertainty from flight records at one condition, and write identified.json.
    #[command(
        after_help = "Examples:\n  gdcm identify sweeps --inputs LON,LAT --outputs P,Q=pitch_rate --band 0.5 12 --out identified\n  gdcm identify records --into dataset.json.gz --every-condition --hold-out validation.csv --out identified"
    )]
    Identify(Box<IdentifyArguments>),
    /// Plan the next flight: identify models from flight records, and print the 95 % intervals that further frequency sweeps of each
    /// input would bring, and the ways to reach a wanted interval.
    #[command(
        after_help = "Examples:\n  gdcm plan sweeps --inputs LON,LAT --outputs P,Q --band 0.5 12\n  gdcm plan records --into dataset.json.gz --condition 3 --target Q/LON@1=0.5 --length 90"
    )]
    Plan(Box<PlanArguments>),
    /// Print the contents of a dataset or a study, or every fault and its place in the file.
    #[command(
        after_help = "Examples:\n  gdcm check example-dataset.json\n  gdcm check flight.gdcm-study.json --dataset moved/example-dataset.json --strict"
    )]
    Check {
        /// Dataset or study.
        file: PathBuf,
        #[command(flatten)]
        opening: OpeningArguments,
        /// Reverse the sign of a channel in the models before the check, as with `analyze`: CHANNEL=-1. May be repeated.
        #[arg(long, value_name = "CHANNEL=SIGN", value_parser = channel_sign, allow_hyphen_values = true)]
        sign: Vec<ChannelSign>,
    },
    /// Compare results of the program with independent references, on this machine and within seconds: certified optima, an
    /// analysis by other code, closed forms, the identification of a known system. Needs no file and writes none.
    #[command(after_help = "Examples:\n  gdcm verify\n  gdcm verify --json")]
    Verify,
    /// Write the embedded example (synthetic data) as a file that shows the format; with --real, a real aircraft with its
    /// physics model and flight records.
    #[command(after_help = "Examples:\n  gdcm example .\n  gdcm example real --real --force")]
    Example {
        /// Directory for the files, created if missing.
        #[arg(value_name = "DIR")]
        directory: PathBuf,
        /// Write the example Real aircraft: physics models, flight records and licences of two quadrotors.
        #[arg(long)]
        real: bool,
        /// Overwrite existing files.
        #[arg(long)]
        force: bool,
    },
    /// Print the licences of this program and of the libraries in it.
    #[command(
        after_help = "Examples:\n  gdcm licences\n  gdcm licences --json",
        alias = "licenses"
    )]
    Licences,
    /// Write the manual pages, for packages.
    #[command(
        hide = true,
        after_help = "Examples:\n  gdcm man-pages man1\n  gdcm man-pages man1 --force"
    )]
    ManPages {
        /// Directory for the files, created if missing.
        #[arg(value_name = "DIR")]
        directory: PathBuf,
        /// Overwrite existing files.
        #[arg(long)]
        force: bool,
    },
}

#[cfg(test)]
mod tests {
    use clap::CommandFactory;

    use super::*;

    #[test]
    fn the_command_line_is_consistent() {
        Arguments::command().debug_assert();
    }

    #[test]
    fn every_command_ends_its_help_with_two_examples_that_are_understood() {
        for command in Arguments::command().get_subcommands() {
            let help = command
                .get_after_help()
                .unwrap_or_else(|| panic!("{} has no examples", command.get_name()));
            let help = help.to_string();
            let examples: Vec<&str> = help.lines().skip(1).map(str::trim).collect();
            assert_eq!(examples.len(), 2, "{help}");
            for example in examples {
                let words: Vec<&str> = example.split(' ').collect();
                assert_eq!(words[..2], ["gdcm", command.get_name()]);
                let parsed = Arguments::try_parse_from(words);
                assert!(parsed.is_ok(), "{example}: {}", parsed.unwrap_err());
            }
        }
    }
}
