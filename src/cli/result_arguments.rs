//! Options for commands that write the results of an analysis.

use std::path::PathBuf;

use clap::Args;
use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};

use gdcm_io::export::EXPORTERS;
use gdcm_io::export::export_set::CHECKSUMS;
use gdcm_method::correction::pade::HIGHEST_PADE_ORDER;
use gdcm_plot::figure::{ColumnWidth, FigureKind, Role};
use gdcm_study::{AcrossRole, AssessedCorrection};

use super::channel_values::{ChannelValue, channel_unit};
use super::option_values::{
    Breakpoints, PairChoice, PairList, breakpoints, one_of, pair_choice, pair_list, whole_number,
};
use super::study_arguments::StudyArguments;

/// `gdcm analyze`.
#[derive(Debug, Args)]
pub struct AnalyzeArguments {
    #[command(flatten)]
    pub study: StudyArguments,
    /// Directory for the results, created if missing.
    #[arg(long, value_name = "DIR")]
    pub out: PathBuf,
    /// Assess the schedule by leaving each condition in turn out of its fit: print the change of J in that condition.
    #[arg(long)]
    pub leave_one_out: bool,
    /// Print the verdict alone: one line per condition, the assessment, and the codes of the cautions.
    #[arg(long)]
    pub brief: bool,
    /// Overwrite existing results.
    #[arg(long)]
    pub force: bool,
}

/// `gdcm figure`.
#[derive(Debug, Args)]
pub struct FigureArguments {
    #[command(flatten)]
    pub study: StudyArguments,
    /// Figure to write.
    #[arg(long, value_name = "VIEW", value_parser = one_of(FigureKind::ALL, FigureKind::name))]
    pub view: FigureKind,
    /// Condition, by its id, for the figures bode, error, overview, poles, leads and physics-change; adds its poles to the figure couplings.
    #[arg(long, value_name = "ID", allow_negative_numbers = true)]
    pub condition: Option<i64>,
    /// Responses, OUTPUT/INPUT, separated by commas (P/LAT,Q/LON), or "on-axis", "off-axis", "all" [default: on-axis; for net-gain,
    /// the held responses].
    #[arg(long, value_name = "PAIRS", value_parser = pair_choice)]
    pub pair: Option<PairChoice>,
    /// Channels for the figure channels, separated by commas (LON,LAT), or "inputs", "outputs" [default: all].
    #[arg(long, value_name = "NAMES")]
    pub channel: Option<String>,
    /// Show the delays of channels instead of their gains.
    #[arg(long)]
    pub delays: bool,
    /// Show channels over conditions instead of airspeed.
    #[arg(long)]
    pub over_conditions: bool,
    /// Roles to omit from the figures bode, error and overview, separated by commas (perturbed,identified,rejected).
    #[arg(long, value_name = "ROLES", value_delimiter = ',', value_parser = one_of(Role::ALL, Role::word))]
    pub hide: Vec<Role>,
    /// Add error bars and the bands of the schedule to the figures net-gain and channels; the figure evidence always has them.
    #[arg(long)]
    pub bars: bool,
    /// Frequencies in Hz instead of rad/s.
    #[arg(long)]
    pub hertz: bool,
    /// Models of each condition in the figure airspeeds, separated by commas: identified, scheduled, corrected, representative or nominal.
    #[arg(long, value_name = "MODELS", value_delimiter = ',', default_value = "identified,scheduled", value_parser = one_of(AcrossRole::ALL, AcrossRole::name))]
    pub model: Vec<AcrossRole>,
    /// Response, OUTPUT/INPUT, whose zeros are added to the figure poles: zeros of the nominal model and of the representatives.
    #[arg(long, value_name = "PAIR", value_parser = pair_list)]
    pub zeros: Option<PairList>,
    /// Add the envelopes of maximum unnoticeable added dynamics (MUAD, MIL-STD-1797A) to the figures bode and error.
    #[arg(long)]
    pub muad: bool,
    /// Width on paper: a single journal column (84 mm) or both columns (174 mm).
    #[arg(long, value_name = "WIDTH", default_value = "double", value_parser = one_of(ColumnWidth::BOTH, ColumnWidth::name))]
    pub width: ColumnWidth,
    /// File to write; the ending selects the format: .svg, .png (300 dots per inch), .pdf, or .csv for the numbers.
    #[arg(long, value_name = "FILE")]
    pub out: PathBuf,
    /// Overwrite an existing file.
    #[arg(long)]
    pub force: bool,
}

/// Flight records that models are compared with in the time domain.
#[derive(Debug, Args)]
pub struct HistoryArguments {
    /// Flight records, each with its condition in its name: files, or folders with their subfolders. The models respond to the recorded
    /// inputs, and the share of time for which they are within the tolerances is reported; may be repeated.
    #[arg(long, value_name = "PATH")]
    pub records: Vec<PathBuf>,
    /// Unit of a channel's samples in records without units; may be repeated.
    #[arg(long, value_name = "CHANNEL=UNIT", value_parser = channel_unit, requires = "records")]
    pub unit: Vec<ChannelValue<String>>,
}

/// `gdcm report`.
#[derive(Debug, Args)]
pub struct ReportArguments {
    #[command(flatten)]
    pub study: StudyArguments,
    #[command(flatten)]
    pub histories: HistoryArguments,
    /// Self-contained HTML file to write.
    #[arg(long, value_name = "FILE")]
    pub out: PathBuf,
    /// Overwrite an existing file.
    #[arg(long)]
    pub force: bool,
}

/// `gdcm requirements`.
#[derive(Debug, Args)]
pub struct RequirementsArguments {
    #[command(flatten)]
    pub study: StudyArguments,
    #[command(flatten)]
    pub histories: HistoryArguments,
    /// Write the table of tolerances as a file to edit; without --out, nothing else is computed.
    #[arg(long, value_name = "FILE")]
    pub write_tolerances: Option<PathBuf>,
    /// Write the boundaries of levels as a file to edit; without --out, nothing else is computed.
    #[arg(long, value_name = "FILE", requires = "levels")]
    pub write_levels: Option<PathBuf>,
    /// Directory for requirements.json and requirements.csv, created if missing.
    #[arg(long, value_name = "DIR", required_unless_present_any = ["write_tolerances", "write_levels"])]
    pub out: Option<PathBuf>,
    /// Overwrite existing files.
    #[arg(long)]
    pub force: bool,
}

/// `gdcm export`.
#[derive(Debug, Args)]
pub struct ExportArguments {
    #[command(flatten)]
    pub study: StudyArguments,
    /// Formats to write, separated by commas; several need --folder.
    #[arg(long = "as", value_name = "FORMATS", required = true, value_delimiter = ',', value_parser = export_formats())]
    pub formats: Vec<String>,
    /// Airspeeds of the lookup table in kt, increasing, separated by commas (40,60,80) [default: the airspeeds of the scheduled conditions].
    #[arg(long, value_name = "AIRSPEEDS", value_parser = breakpoints, allow_negative_numbers = true)]
    pub breakpoints: Option<Breakpoints>,
    /// Conditions, by their ids, separated by commas, whose results and corrected models are written [default: all].
    #[arg(
        long,
        value_name = "IDS",
        value_delimiter = ',',
        allow_negative_numbers = true
    )]
    pub condition: Vec<i64>,
    /// Physics model: nominal, representative, or the name of a model [default: nominal].
    #[arg(long, value_name = "MODEL", allow_hyphen_values = true)]
    pub model: Option<String>,
    /// Correction of the models: scheduled, or each condition's own [default: scheduled].
    #[arg(long, value_name = "CORRECTION", value_parser = assessed_corrections())]
    pub correction: Option<AssessedCorrection>,
    /// Order of the Pade approximants of the models' delays, 1 to 8 [default: 2].
    #[arg(long, value_name = "N", value_parser = whole_number::<1, HIGHEST_PADE_ORDER>, allow_negative_numbers = true)]
    pub pade: Option<usize>,
    /// File to write; for corrected models the ending selects the format: .mat, .json or .npz.
    #[arg(
        long,
        value_name = "PATH",
        required_unless_present = "folder",
        conflicts_with = "folder"
    )]
    pub out: Option<PathBuf>,
    /// Folder for the files, created if missing; the program names them: corrections.json, correction.m, table.csv, models.mat.
    #[arg(long, value_name = "DIR")]
    pub folder: Option<PathBuf>,
    /// Beginning of the names of the files in --folder.
    #[arg(
        long,
        value_name = "TEXT",
        requires = "folder",
        allow_hyphen_values = true
    )]
    pub prefix: Option<String>,
    /// If a file exists in --folder, add the same number to all names: correction_2.m.
    #[arg(long, requires = "folder", conflicts_with = "force")]
    pub number: bool,
    /// Overwrite existing files.
    #[arg(long)]
    pub force: bool,
}

fn export_formats() -> PossibleValuesParser {
    let checksums = PossibleValue::new(CHECKSUMS).help("SHA-256 of the other files");
    let values = EXPORTERS
        .iter()
        .map(|exporter| PossibleValue::new(exporter.name).help(exporter.words));
    PossibleValuesParser::new(values.chain([checksums]))
}

fn assessed_corrections() -> impl TypedValueParser<Value = AssessedCorrection> {
    PossibleValuesParser::new(["scheduled", "own"]).map(|name| match name.as_str() {
        "own" => AssessedCorrection::Own,
        _ => AssessedCorrection::Scheduled,
    })
}
