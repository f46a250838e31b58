//! The command line.

use std::path::PathBuf;

use clap::builder::{PossibleValuesParser, TypedValueParser};
use clap::parser::ValueSource;
use clap::{Arg, ArgAction, ArgMatches, Args, FromArgMatches, Parser, Subcommand};

use gdcm_model::assembly::FileScope;
use gdcm_plot::figure::{ColumnWidth, FigureKind, Role};
use gdcm_study::AcrossRole;
use gdcm_study::decisions::setting::SETTINGS;
use gdcm_study::decisions::setting_row::{Kind, Setting};
use gdcm_study::decisions::signs::SignRole;

use super::flight_records::HistoryArguments;
use super::identify_arguments::IdentifyArguments;
use super::results::ExportArguments;

/// Gain-Delay Correction Method: matches physics-based helicopter models to flight.
#[derive(Debug, Parser)]
#[command(name = "gdcm", version, args_conflicts_with_subcommands = true)]
pub(super) struct Arguments {
    #[command(subcommand)]
    pub(super) command: Option<Command>,
    /// Dataset or study to open the window on; without it, the embedded example (synthetic data). A folder, or a file of another
    /// program, is opened to put its models together. A file named like a command: ./analyze
    pub(super) file: Option<PathBuf>,
    /// Leave out what only informs (lines that begin with "note:").
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
    /// Make one of the figures that the window shows, or its numbers, as a file.
    #[command(
        after_help = "Examples:\n  gdcm figure example-dataset.json --view net-gain --bars --out net-gain.pdf\n  gdcm figure example-dataset.json --view bode --condition 3 --pair Q/LON --out bode.svg"
    )]
    Figure(Box<FigureArguments>),
    /// Write all that was done and found as one page to read and to print: settings, rejections with their reasons, gains, delays, what
    /// could not be matched and why, the schedule, the assessment, and every plot.
    #[command(
        after_help = "Examples:\n  gdcm report flight.gdcm-study.json --out report.html\n  gdcm report example-dataset.json --reject-suggested --out report.html --force"
    )]
    Report(Box<ReportArguments>),
    /// Ask the models of every condition what a qualification asks: bandwidth and phase delay, time histories within tolerances about
    /// flight records, summary costs, modes; write requirements.json and requirements.csv, and print a short table. This is no
    /// qualification.
    #[command(
        after_help = "Examples:\n  gdcm requirements example-dataset.json --reject-suggested --out requirements\n  gdcm requirements flight.gdcm-study.json --records sweeps --tolerances mine.json --out requirements --force"
    )]
    Requirements(Box<RequirementsArguments>),
    /// Write corrections for other tools: MATLAB, Python, C, lookup tables, corrected models as state-space.
    #[command(
        after_help = "Examples:\n  gdcm export flight.gdcm-study.json --as py --out corrections.py\n  gdcm export example-dataset.json --as state-space --condition 3 --out models.mat"
    )]
    Export(Box<ExportArguments>),
    /// Make a dataset of a folder of model files: MATLAB, NumPy, JSON, text. Without rules, proposes them and says what is missing.
    #[command(
        after_help = "Examples:\n  gdcm assemble models --out dataset.json.gz\n  gdcm assemble models --rules dataset.gdcm-rules.json --out dataset.json.gz --force"
    )]
    Assemble(AssembleArguments),
    /// Write every model and response in any file as JSON.
    #[command(
        after_help = "Examples:\n  gdcm convert model.mat --out models.json\n  gdcm convert folder other.npz --out models.json --force"
    )]
    Convert(ConvertArguments),
    /// Identify models from flight records of one condition, with their uncertainty, and write identified.json.
    #[command(
        after_help = "Examples:\n  gdcm identify sweeps --inputs LON,LAT --outputs P,Q=pitch_rate --band 0.5 12 --out identified\n  gdcm identify records --into dataset.json.gz --every-condition --hold-out validation.csv --out identified"
    )]
    Identify(Box<IdentifyArguments>),
    /// Say what a dataset or a study holds, or what is wrong with it and where.
    #[command(
        after_help = "Examples:\n  gdcm check example-dataset.json\n  gdcm check flight.gdcm-study.json --dataset moved/example-dataset.json --strict"
    )]
    Check {
        /// Dataset or study.
        file: PathBuf,
        /// How a study is opened.
        #[command(flatten)]
        opening: OpeningArguments,
        /// Turn the models of a channel first, as with `analyze`: CHANNEL=-1. May be repeated.
        #[arg(long, value_name = "CHANNEL=SIGN", value_parser = channel_sign, allow_hyphen_values = true)]
        sign: Vec<ChannelSign>,
    },
    /// Write the embedded example (synthetic data) as a file to learn the format from.
    #[command(after_help = "Examples:\n  gdcm example .\n  gdcm example learn --force")]
    Example {
        /// Directory to write it into; made where there is none.
        #[arg(value_name = "DIR")]
        directory: PathBuf,
        /// Overwrite a file that is there already.
        #[arg(long)]
        force: bool,
    },
}

/// Which files are to become a dataset, and how.
#[derive(Debug, Args)]
pub struct AssembleArguments {
    /// Folders, with all that is in them, or files.
    #[arg(value_name = "FOLDER", required = true)]
    pub folders: Vec<PathBuf>,
    /// What is said about the files; without it, it is proposed and written beside the dataset.
    #[arg(long, value_name = "RULES.json")]
    pub rules: Option<PathBuf>,
    /// Headings of the columns of tables that do not say them, separated by commas: `omega [rad/s],mag [dB],phase [deg]`.
    #[arg(long, value_name = "LIST", value_delimiter = ',')]
    pub headings: Vec<String>,
    /// The sign of a channel, where names do not say it: CHANNEL=-1 of the identified models, CHANNEL=-1:physics, CHANNEL=-1:all, CHANNEL=-1:FILE of one model or of the folders of a pattern (flight_*); may be repeated.
    #[arg(long, value_name = "CHANNEL=SIGN[:OF]", value_parser = file_sign, allow_hyphen_values = true)]
    pub sign: Vec<OfFiles<f64>>,
    /// The unit of a channel, whatever the files say, of the identified models or of others as with --sign: LON=in, LON=in:physics; may be repeated.
    #[arg(long, value_name = "CHANNEL=UNIT[:OF]", value_parser = file_unit)]
    pub unit: Vec<OfFiles<String>>,
    /// What a channel is multiplied by to be in the dataset's unit, negative where the sign is the other one, of the identified models or of others as with --sign: LON=8, NZ=-9.81:all; may be repeated.
    #[arg(long, value_name = "CHANNEL=X[:OF]", value_parser = file_factor, allow_hyphen_values = true)]
    pub factor: Vec<OfFiles<f64>>,
    /// Sample time of models that do not say it, in seconds; 0 where they are of continuous time.
    #[arg(long, value_name = "SECONDS", value_parser = real_number)]
    pub sample_time: Option<f64>,
    /// The dataset, packed where the name ends in .gz.
    #[arg(long, value_name = "DATASET.json.gz")]
    pub out: PathBuf,
    /// Overwrite files that are there already.
    #[arg(long)]
    pub force: bool,
}

/// Which files are to be read, and where their models go.
#[derive(Debug, Args)]
pub struct ConvertArguments {
    /// Files, or folders with all that is in them.
    #[arg(value_name = "FILE", required = true)]
    pub files: Vec<PathBuf>,
    /// Headings of the columns of tables that do not say them, separated by commas: `omega [rad/s],mag [dB],phase [deg]`.
    #[arg(long, value_name = "LIST", value_delimiter = ',')]
    pub headings: Vec<String>,
    /// The file of models.
    #[arg(long, value_name = "MODELS.json")]
    pub out: PathBuf,
    /// Overwrite a file that is there already.
    #[arg(long)]
    pub force: bool,
}

/// How a study is opened whose dataset has moved or changed.
#[derive(Debug, Args)]
pub struct OpeningArguments {
    /// The dataset of the study, where it is no longer where the study says.
    #[arg(long, value_name = "FILE")]
    pub dataset: Option<PathBuf>,
    /// End with status 2 where the dataset is not the one that the study was made with.
    #[arg(long)]
    pub strict: bool,
}

/// Options for the rows of the settings table.
#[derive(Clone, Debug)]
pub struct SettingOptions {
    /// The given settings, with their values, in the order of the table.
    pub said: Vec<(&'static Setting, Vec<String>)>,
}

impl FromArgMatches for SettingOptions {
    fn from_arg_matches(matches: &ArgMatches) -> Result<Self, clap::Error> {
        let said = SETTINGS.into_iter().filter_map(|setting| {
            let is_said = matches.value_source(setting.option) == Some(ValueSource::CommandLine);
            let words = matches.get_raw(setting.option).into_iter().flatten();
            is_said.then(|| {
                (
                    setting,
                    words
                        .map(|word| word.to_string_lossy().into_owned())
                        .collect(),
                )
            })
        });
        Ok(Self {
            said: said.collect(),
        })
    }

    fn update_from_arg_matches(&mut self, matches: &ArgMatches) -> Result<(), clap::Error> {
        *self = Self::from_arg_matches(matches)?;
        Ok(())
    }
}

impl Args for SettingOptions {
    fn augment_args(command: clap::Command) -> clap::Command {
        command.args(SETTINGS.map(|setting| {
            let name = setting.option;
            let unit = setting.unit.file;
            let unit = if unit.is_empty() {
                String::new()
            } else {
                format!(" [{unit}]")
            };
            let argument = Arg::new(name)
                .long(name.trim_start_matches('-'))
                .help(format!("{}{unit}", setting.help));
            let argument = match setting.kind {
                Kind::Flag { .. } => return argument.action(ArgAction::SetTrue),
                Kind::Range { nothing: None, .. } => argument.value_names(["LO", "HI"]).num_args(2),
                Kind::Range { .. } => argument.value_name("LO HI").num_args(1..=2),
                _ if let Some(word) = setting.bare => argument
                    .value_name(setting.syntax())
                    .num_args(0..=1)
                    .require_equals(true)
                    .default_missing_value(word),
                _ => argument.value_name(setting.syntax()),
            };
            argument.allow_negative_numbers(true)
        }))
    }

    fn augment_args_for_update(command: clap::Command) -> clap::Command {
        Self::augment_args(command)
    }
}

/// What is to be analysed, and how.
#[derive(Debug, Args)]
pub struct StudyArguments {
    /// Dataset or study; without it, the embedded example (synthetic data).
    pub file: Option<PathBuf>,
    /// The settings that it says.
    #[command(flatten)]
    pub settings: SettingOptions,
    /// Responses to hold, OUTPUT/INPUT, separated by commas (P/LAT,Q/LON); "none" holds none. Without it, the on-axis ones.
    #[arg(long, value_name = "PAIRS", value_parser = pair_list)]
    pub on: Option<PairList>,
    /// How a study is opened.
    #[command(flatten)]
    pub opening: OpeningArguments,
    /// Conditions, by their ids, separated by commas, to keep from the schedule and to judge it by.
    #[arg(
        long,
        value_name = "IDS",
        value_delimiter = ',',
        allow_negative_numbers = true
    )]
    pub hold_out: Vec<i64>,
    /// Turn the models of a channel whose sign is the other way round, CHANNEL=-1 (the identified models), CHANNEL=-1:physics or
    /// CHANNEL=-1:all; CHANNEL=1 puts them back. May be repeated.
    #[arg(long, value_name = "CHANNEL=SIGN", value_parser = channel_sign, allow_hyphen_values = true)]
    pub sign: Vec<ChannelSign>,
    /// Outputs whose attitude the stick commands, separated by commas: their bandwidth is that of the phase alone (ADS-33E-PRF).
    #[arg(long, value_name = "OUTPUTS", value_delimiter = ',')]
    pub attitude_command: Vec<String>,
    /// File of the levels that bandwidth and phase delay are drawn with (docs/requirements.md).
    #[arg(long, value_name = "FILE")]
    pub levels: Option<PathBuf>,
    /// File of the tolerances of time histories; without it, those of the study, which are at first those of 14 CFR part 60, appendix
    /// C, table C2A (docs/requirements.md).
    #[arg(long, value_name = "FILE")]
    pub tolerances: Option<PathBuf>,
    /// Reject every physics model that is suggested as an outlier.
    #[arg(long)]
    pub reject_suggested: bool,
    /// Reject a model of a condition; may be repeated.
    #[arg(long, value_name = "ID:NAME", value_parser = rejection, allow_hyphen_values = true)]
    pub reject: Vec<Rejection>,
}

/// A declaration about a channel in an option.
#[derive(Clone, Debug, PartialEq)]
pub struct OfChannel<T> {
    pub channel: String,
    /// The declared value.
    pub said: T,
}

/// Role whose models are inverted in a channel; `None` restores the file's sign.
pub type ChannelSign = OfChannel<Option<SignRole>>;

/// Splits "NZ=-1:physics" into the channel, its sign, and the scope, by default that of the
/// identified models.
fn sign_parts(text: &str) -> Option<(&str, f64, &str)> {
    let (channel, rest) = text.rsplit_once('=')?;
    let (sign, of) = rest
        .split_once(':')
        .unwrap_or((rest, SignRole::Identified.word()));
    Some((channel.trim(), sign_of(sign.trim())?, of.trim()))
}

fn sign_of(text: &str) -> Option<f64> {
    match text {
        "-1" | "-" => Some(-1.0),
        "1" | "+1" | "+" => Some(1.0),
        _ => None,
    }
}

/// Parses the sign of a channel: "NZ=-1", "NZ=-1:physics", "NZ=1".
fn channel_sign(text: &str) -> Result<ChannelSign, String> {
    let expected = || {
        format!(
            "expected CHANNEL=-1, with :identified, :physics or :all behind it, or CHANNEL=1; found {text}"
        )
    };
    let (channel, sign, of) = sign_parts(text).ok_or_else(expected)?;
    let of = SignRole::EACH
        .into_iter()
        .find(|role| role.word() == of)
        .ok_or_else(expected)?;
    Ok(OfChannel {
        channel: channel.to_owned(),
        said: (sign < 0.0).then_some(of),
    })
}

/// What is to be analysed, and where the results go.
#[derive(Debug, Args)]
pub struct AnalyzeArguments {
    /// What is to be analysed, and how.
    #[command(flatten)]
    pub study: StudyArguments,
    /// Directory for the results; made where there is none.
    #[arg(long, value_name = "DIR")]
    pub out: PathBuf,
    /// Judge the schedule by each condition in turn, made without it: print the change of J of each.
    #[arg(long)]
    pub leave_one_out: bool,
    /// Overwrite results that are there already.
    #[arg(long)]
    pub force: bool,
}

/// Which figure is to be made, of what, and where it goes.
#[derive(Debug, Args)]
pub struct FigureArguments {
    /// What is to be analysed, and how.
    #[command(flatten)]
    pub study: StudyArguments,
    /// Which figure.
    #[arg(long, value_name = "VIEW", value_parser = one_of(FigureKind::ALL, FigureKind::name))]
    pub view: FigureKind,
    /// The condition, by its id: of bode, error and overview.
    #[arg(long, value_name = "ID", allow_negative_numbers = true)]
    pub condition: Option<i64>,
    /// The responses, OUTPUT/INPUT, separated by commas (P/LAT,Q/LON), or "on-axis", "off-axis", "all". Without it, the on-axis
    /// ones; of net-gain, those held.
    #[arg(long, value_name = "PAIRS", value_parser = pair_choice)]
    pub pair: Option<PairChoice>,
    /// The channels, separated by commas (LON,LAT), or "inputs", "outputs"; of channels. Without it, all.
    #[arg(long, value_name = "NAMES")]
    pub channel: Option<String>,
    /// Show delays of the channels in place of their gains.
    #[arg(long)]
    pub delays: bool,
    /// Show channels over conditions in place of airspeed.
    #[arg(long)]
    pub over_conditions: bool,
    /// Roles to leave out of bode, error and overview, separated by commas (perturbed,identified,rejected).
    #[arg(long, value_name = "ROLES", value_delimiter = ',', value_parser = one_of(Role::ALL, Role::word))]
    pub hide: Vec<Role>,
    /// Error bars and the bands of the schedule, in net-gain and channels; evidence is made of them anyway.
    #[arg(long)]
    pub bars: bool,
    /// Frequencies in Hz in place of rad/s.
    #[arg(long)]
    pub hertz: bool,
    /// Which model of each condition airspeeds shows: nominal, representative, corrected or identified.
    #[arg(long, value_name = "MODEL", default_value = "nominal", value_parser = one_of(AcrossRole::ALL, AcrossRole::name))]
    pub model: AcrossRole,
    /// Among the poles, the zeros of this response, OUTPUT/INPUT, in the nominal model and in the representatives.
    #[arg(long, value_name = "PAIR", value_parser = pair_list)]
    pub zeros: Option<PairList>,
    /// About the identified response, and among the errors, the limits of what a pilot does not notice (MUAD, MIL-STD-1797A).
    #[arg(long)]
    pub muad: bool,
    /// Width on paper: one column of a journal (84 mm), or both (174 mm).
    #[arg(long, value_name = "WIDTH", default_value = "double", value_parser = one_of(ColumnWidth::BOTH, ColumnWidth::name))]
    pub width: ColumnWidth,
    /// The file; the end of its name says what it is: .svg, .png (300 dots to the inch), .pdf, or .csv for the numbers.
    #[arg(long, value_name = "FILE")]
    pub out: PathBuf,
    /// Overwrite a file that is there already.
    #[arg(long)]
    pub force: bool,
}

/// What is to be reported, and where the report goes.
#[derive(Debug, Args)]
pub struct ReportArguments {
    /// What is to be analysed, and how.
    #[command(flatten)]
    pub study: StudyArguments,
    /// What models are compared with in time.
    #[command(flatten)]
    pub histories: HistoryArguments,
    /// The file: HTML that needs no other file.
    #[arg(long, value_name = "FILE")]
    pub out: PathBuf,
    /// Overwrite a file that is there already.
    #[arg(long)]
    pub force: bool,
}

/// What is asked what a qualification asks, and where the answers go.
#[derive(Debug, Args)]
pub struct RequirementsArguments {
    /// What is to be analysed, and how.
    #[command(flatten)]
    pub study: StudyArguments,
    /// What models are compared with in time.
    #[command(flatten)]
    pub histories: HistoryArguments,
    /// Write the table of tolerances as a file to edit; without --out, nothing else is done.
    #[arg(long, value_name = "FILE")]
    pub write_tolerances: Option<PathBuf>,
    /// Directory for requirements.json and requirements.csv; made where there is none.
    #[arg(long, value_name = "DIR", required_unless_present = "write_tolerances")]
    pub out: Option<PathBuf>,
    /// Overwrite files that are there already.
    #[arg(long)]
    pub force: bool,
}

/// Returns a parser for the name of one of these values.
fn one_of<T, const N: usize>(
    all: [T; N],
    name: fn(T) -> &'static str,
) -> impl TypedValueParser<Value = T>
where
    T: Copy + Send + Sync + 'static,
{
    let find = move |word: String| {
        all.into_iter()
            .find(|of| name(*of) == word)
            .ok_or("there is no such value")
    };
    PossibleValuesParser::new(all.map(name)).try_map(find)
}

/// Choice of responses for a figure.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum PairChoice {
    OnAxis,
    OffAxis,
    All,
    These(PairList),
}

fn pair_choice(text: &str) -> Result<PairChoice, String> {
    Ok(match text {
        "on-axis" => PairChoice::OnAxis,
        "off-axis" => PairChoice::OffAxis,
        "all" => PairChoice::All,
        list => PairChoice::These(pair_list(list)?),
    })
}

pub(super) fn real_number(text: &str) -> Result<f64, String> {
    text.trim()
        .parse()
        .map_err(|_| format!("expected a number, found {text}"))
}

pub(super) fn whole_number<const LEAST: usize, const MOST: usize>(
    text: &str,
) -> Result<usize, String> {
    let number = text
        .trim()
        .parse()
        .ok()
        .filter(|number| (LEAST..=MOST).contains(number));
    number.ok_or_else(|| format!("expected a whole number from {LEAST} to {MOST}, found {text}"))
}

/// Responses by the names of their output and input channels.
pub type PairList = Vec<(String, String)>;

fn pair_list(text: &str) -> Result<PairList, String> {
    let pair = |words: &str| match words.trim().split_once('/') {
        Some((output, input)) if !output.is_empty() && !input.is_empty() => {
            Ok((output.to_owned(), input.to_owned()))
        }
        _ => Err(format!(
            "expected OUTPUT/INPUT, as P/LAT, found \"{words}\""
        )),
    };
    if text == "none" {
        Ok(Vec::new())
    } else {
        text.split(',').map(pair).collect()
    }
}

/// A rejected model.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Rejection {
    /// Id of its condition.
    pub condition: i64,
    pub model: String,
}

fn rejection(text: &str) -> Result<Rejection, String> {
    let expected = || format!("expected ID:NAME, as 10:nominal, found \"{text}\"");
    let (id, model) = text.split_once(':').ok_or_else(expected)?;
    Ok(Rejection {
        condition: id.trim().parse().map_err(|_| expected())?,
        model: model.to_owned(),
    })
}

/// A declaration about a channel in assembled files.
#[derive(Clone, Debug, PartialEq)]
pub struct OfFiles<T> {
    pub channel: String,
    /// The declared value.
    pub said: T,
    /// Scope; by default the files of the identified models.
    pub of: FileScope,
}

impl<T> OfFiles<T> {
    /// Parses `CHANNEL=VALUE` or `CHANNEL=VALUE:OF`; `None` if a part is empty or `value` rejects
    /// it.
    fn read(text: &str, value: impl FnOnce(&str) -> Option<T>) -> Option<Self> {
        let (channel, rest) = text.split_once('=')?;
        let (said, of) = rest.split_once(':').unwrap_or((rest, "identified"));
        let [channel, said, of] = [channel, said, of].map(str::trim);
        if channel.is_empty() || said.is_empty() || of.is_empty() {
            return None;
        }
        Some(Self {
            channel: channel.to_owned(),
            said: value(said)?,
            of: FileScope::from(of.to_owned()),
        })
    }
}

/// Hint about the scope of an option, for its error message.
const OF_FILES: &str = ":identified, :physics, :all or : and the file of a model or a pattern of folders may stand behind it";

fn file_sign(text: &str) -> Result<OfFiles<f64>, String> {
    OfFiles::read(text, sign_of).ok_or_else(|| {
        format!("expected a channel with 1 or -1, as NZ=-1; {OF_FILES}; found \"{text}\"")
    })
}

fn file_unit(text: &str) -> Result<OfFiles<String>, String> {
    OfFiles::read(text, |unit| Some(unit.to_owned()))
        .ok_or_else(|| format!("expected CHANNEL=UNIT, as LON=in; {OF_FILES}; found \"{text}\""))
}

fn file_factor(text: &str) -> Result<OfFiles<f64>, String> {
    let factor = |text: &str| {
        text.parse()
            .ok()
            .filter(|factor: &f64| factor.is_finite() && *factor != 0.0)
    };
    OfFiles::read(text, factor).ok_or_else(|| {
        format!("expected CHANNEL=X with X a number other than 0, as LON=8 or NZ=-1; {OF_FILES}; found \"{text}\"")
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_command_line_is_consistent() {
        use clap::CommandFactory;
        Arguments::command().debug_assert();
    }

    #[test]
    fn every_command_ends_its_help_with_two_examples_that_are_understood() {
        use clap::CommandFactory;
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
                let read = Arguments::try_parse_from(words);
                assert!(read.is_ok(), "{example}: {}", read.unwrap_err());
            }
        }
    }

    #[test]
    fn a_model_name_may_hold_a_colon() {
        let found = rejection("10:V+5kt: again").unwrap();
        assert_eq!(
            (found.condition, found.model.as_str()),
            (10, "V+5kt: again")
        );
        assert!(rejection("nominal").is_err() && rejection("x:nominal").is_err());
    }

    #[test]
    fn a_sign_says_its_channel_and_whose_models_are_turned() {
        let said = |text: &str| channel_sign(text).map(|sign| (sign.channel, sign.said));
        assert_eq!(
            said("NZ=-1"),
            Ok(("NZ".to_owned(), Some(SignRole::Identified)))
        );
        assert_eq!(
            said("az (down)=-1:all"),
            Ok(("az (down)".to_owned(), Some(SignRole::All)))
        );
        assert_eq!(said("NZ=1"), Ok(("NZ".to_owned(), None)));
        assert!(said("NZ").is_err() && said("NZ=-2").is_err() && said("NZ=-1:none").is_err());
    }

    #[test]
    fn a_unit_or_a_factor_of_files_says_its_channel_and_whose_it_is() {
        let unit = |text: &str| file_unit(text).map(|of| (of.channel, of.said, of.of));
        let expected = |of: FileScope| Ok(("P".to_owned(), "rad/s".to_owned(), of));
        assert_eq!(unit("P=rad/s"), expected(FileScope::Identified));
        assert_eq!(unit("P=rad/s:physics"), expected(FileScope::Physics));
        assert_eq!(
            unit("P = rad/s : c1/x=2.mat"),
            expected(FileScope::Files("c1/x=2.mat".into()))
        );
        assert_eq!(
            file_factor("NZ=-9.81:all").map(|of| (of.said, of.of)),
            Ok((-9.81, FileScope::All))
        );
        assert_eq!(
            file_sign("NZ=-1:flight_*").map(|of| of.of),
            Ok(FileScope::Files("flight_*".into()))
        );
        assert!(
            ["P", "P=", "=in", "P=in:"]
                .iter()
                .all(|wrong| file_unit(wrong).is_err())
        );
        assert!(
            ["P=0", "P=x", "P=inf"]
                .iter()
                .all(|wrong| file_factor(wrong).is_err())
                && file_sign("P=2").is_err()
        );
    }

    #[test]
    fn pairs_are_written_output_first() {
        let list = pair_list("P/LAT, Q/LON").unwrap();
        assert_eq!(
            list,
            [
                ("P".to_owned(), "LAT".to_owned()),
                ("Q".to_owned(), "LON".to_owned())
            ]
        );
        assert!(pair_list("P-LAT").is_err() && pair_list("").is_err());
        assert!(pair_list("none").unwrap().is_empty());
    }
}
