//! Options for every command that analyses a study.

use std::path::PathBuf;

use clap::parser::ValueSource;
use clap::{Arg, ArgAction, ArgMatches, Args, FromArgMatches};

use gdcm_study::decisions::setting::{Kind, Setting};
use gdcm_study::decisions::setting_table::SETTINGS;
use gdcm_words::setting_words::setting_words;

use super::channel_values::{ChannelSign, channel_sign};
use super::option_values::{PairList, Rejection, pair_list, rejection};
use super::parameter_values::{ParameterValue, parameter_value};

/// How a study is opened whose dataset has moved or changed.
#[derive(Debug, Args)]
pub struct OpeningArguments {
    /// The study's dataset, if it has moved.
    #[arg(long, value_name = "FILE")]
    pub dataset: Option<PathBuf>,
    /// End with status 2 if the dataset has changed since the study was saved.
    #[arg(long)]
    pub strict: bool,
}

/// A setting given on the command line.
#[derive(Clone, Debug)]
pub struct GivenSetting {
    pub setting: &'static Setting,
    pub words: Vec<String>,
}

/// Options for the settings table.
#[derive(Clone, Debug)]
pub struct SettingOptions {
    /// Given settings in the table's order.
    pub given: Vec<GivenSetting>,
}

impl FromArgMatches for SettingOptions {
    fn from_arg_matches(matches: &ArgMatches) -> Result<Self, clap::Error> {
        let mut given = Vec::new();
        for setting in SETTINGS {
            if matches.value_source(setting.option) != Some(ValueSource::CommandLine) {
                continue;
            }
            let words = matches.get_raw(setting.option).into_iter().flatten();
            given.push(GivenSetting {
                setting,
                words: words
                    .map(|word| word.to_string_lossy().into_owned())
                    .collect(),
            });
        }
        Ok(Self { given })
    }

    fn update_from_arg_matches(&mut self, matches: &ArgMatches) -> Result<(), clap::Error> {
        *self = Self::from_arg_matches(matches)?;
        Ok(())
    }
}

impl Args for SettingOptions {
    fn augment_args(command: clap::Command) -> clap::Command {
        command.args(SETTINGS.map(setting_option))
    }

    fn augment_args_for_update(command: clap::Command) -> clap::Command {
        Self::augment_args(command)
    }
}

/// Returns a setting's option, with its help and number of values.
fn setting_option(setting: &'static Setting) -> Arg {
    let name = setting.option;
    let unit = match setting.unit.file {
        "" => String::new(),
        unit => format!(" [{unit}]"),
    };
    let argument = Arg::new(name)
        .long(name.trim_start_matches('-'))
        .help(format!("{}{unit}", setting_words(setting).help));
    let argument = match setting.kind {
        Kind::Flag { .. } => return argument.action(ArgAction::SetTrue),
        Kind::Band { .. } => argument.value_names(["LO", "HI"]).num_args(2),
        Kind::Range { .. } => argument.value_name("LO HI").num_args(1..=2),
        _ => match setting.bare {
            Some(word) => argument
                .value_name(setting.syntax())
                .num_args(0..=1)
                .require_equals(true)
                .default_missing_value(word),
            None => argument.value_name(setting.syntax()),
        },
    };
    argument.allow_negative_numbers(true)
}

/// The analysed study, with the options that override its decisions.
#[derive(Debug, Args)]
pub struct StudyArguments {
    /// Dataset or study [default: the embedded example (synthetic data)].
    pub file: Option<PathBuf>,
    #[command(flatten)]
    pub settings: SettingOptions,
    /// Responses to hold, OUTPUT/INPUT, separated by commas (P/LAT,Q/LON), or "none" [default: those of the study, initially the on-axis responses].
    #[arg(long, value_name = "PAIRS", value_parser = pair_list)]
    pub on: Option<PairList>,
    #[command(flatten)]
    pub opening: OpeningArguments,
    /// Conditions held out of the schedule, which is then assessed with them: ids, separated by commas.
    #[arg(
        long,
        value_name = "IDS",
        value_delimiter = ',',
        allow_negative_numbers = true
    )]
    pub hold_out: Vec<i64>,
    /// Reverse the sign of a channel in the models: CHANNEL=-1 (the identified models), CHANNEL=-1:physics or
    /// CHANNEL=-1:all; CHANNEL=1 restores the sign. May be repeated.
    #[arg(long, value_name = "CHANNEL=SIGN", value_parser = channel_sign, allow_hyphen_values = true)]
    pub sign: Vec<ChannelSign>,
    /// Change of a physics parameter set by hand, in its unit: NAME=CHANGE[UNIT] (Ixx=+4%). Without --physics, only
    /// these changes are applied to the physics models. May be repeated.
    #[arg(long, value_name = "NAME=CHANGE", value_parser = parameter_value, allow_hyphen_values = true)]
    pub parameter: Vec<ParameterValue>,
    /// Outputs whose attitude the stick commands, separated by commas: only the phase determines their bandwidth (ADS-33E-PRF).
    #[arg(long, value_name = "OUTPUTS", value_delimiter = ',')]
    pub attitude_command: Vec<String>,
    /// Boundaries of levels in the plane of bandwidth and phase delay: a file (docs/requirements.md),
    /// ads-33e-prf-yaw-tracking or ads-33e-prf-yaw-other-tasks. They replace those of the same axis. May be repeated.
    #[arg(long, value_name = "FILE or NAME")]
    pub levels: Vec<PathBuf>,
    /// File with the tolerances of time histories [default: those of the study, initially 14 CFR part 60, appendix C, table C2A]
    /// (docs/requirements.md).
    #[arg(long, value_name = "FILE")]
    pub tolerances: Option<PathBuf>,
    /// Reject every physics model that the analysis suggests as an outlier.
    #[arg(long)]
    pub reject_suggested: bool,
    /// Reject a model of a condition; may be repeated.
    #[arg(long, value_name = "ID:NAME", value_parser = rejection, allow_hyphen_values = true)]
    pub reject: Vec<Rejection>,
}
