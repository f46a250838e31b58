//! Options for `gdcm assemble` and `gdcm convert`.

use std::path::PathBuf;

use clap::Args;

use super::file_values::{FileValue, file_factor, file_sign, file_unit};
use super::option_values::real_number;

/// Model files of a new dataset, and declarations about them.
#[derive(Debug, Args)]
pub struct AssembleArguments {
    /// Folders, with their subfolders, or files.
    #[arg(value_name = "FOLDER", required = true)]
    pub folders: Vec<PathBuf>,
    /// Rules for the files; without them, rules are proposed and written beside the dataset.
    #[arg(long, value_name = "RULES.json")]
    pub rules: Option<PathBuf>,
    /// Column headings for tables without headings, separated by commas: `omega [rad/s],mag [dB],phase [deg]`.
    #[arg(long, value_name = "LIST", value_delimiter = ',')]
    pub headings: Vec<String>,
    /// Channel sign, if its name does not give it: CHANNEL=-1 (the identified models), CHANNEL=-1:physics, CHANNEL=-1:all, CHANNEL=-1:FILE (a model, or a pattern of folders such as flight_*); may be repeated.
    #[arg(long, value_name = "CHANNEL=SIGN[:OF]", value_parser = file_sign, allow_hyphen_values = true)]
    pub sign: Vec<FileValue<f64>>,
    /// Channel unit, which overrides the files, for the models selected as with --sign: LON=in, LON=in:physics; may be repeated.
    #[arg(long, value_name = "CHANNEL=UNIT[:OF]", value_parser = file_unit)]
    pub unit: Vec<FileValue<String>>,
    /// Factor from a channel's unit to the dataset's, negative for the opposite sign, for the models selected as with --sign: LON=8, NZ=-9.81:all; may be repeated.
    #[arg(long, value_name = "CHANNEL=X[:OF]", value_parser = file_factor, allow_hyphen_values = true)]
    pub factor: Vec<FileValue<f64>>,
    /// Sample time in seconds of models that state none; 0 for continuous time.
    #[arg(long, value_name = "SECONDS", value_parser = real_number)]
    pub sample_time: Option<f64>,
    /// Dataset to write, compressed if the name ends in .gz.
    #[arg(long, value_name = "DATASET.json.gz")]
    pub out: PathBuf,
    /// Overwrite existing files.
    #[arg(long)]
    pub force: bool,
}

/// Model files to convert.
#[derive(Debug, Args)]
pub struct ConvertArguments {
    /// Files, or folders with their subfolders.
    #[arg(value_name = "FILE", required = true)]
    pub files: Vec<PathBuf>,
    /// Column headings for tables without headings, separated by commas: `omega [rad/s],mag [dB],phase [deg]`.
    #[arg(long, value_name = "LIST", value_delimiter = ',')]
    pub headings: Vec<String>,
    /// File of models to write.
    #[arg(long, value_name = "MODELS.json")]
    pub out: PathBuf,
    /// Overwrite an existing file.
    #[arg(long)]
    pub force: bool,
}
