//! What `gdcm export` takes.

use std::path::PathBuf;
use std::str::FromStr;

use clap::Args;
use clap::builder::{PossibleValuesParser, TypedValueParser};

use gdcm_core::correction::HIGHEST_PADE_ORDER;
use gdcm_core::study::{AssessedCorrection, ExportFormat};

use super::arguments::{StudyArguments, real_number, whole_number};

/// What is to be exported, as what, and where it goes.
#[derive(Debug, Args)]
pub struct ExportArguments {
    /// What is to be analysed, and how.
    #[command(flatten)]
    pub study: StudyArguments,
    /// As what: everything (mat, json), gains and delays (csv), the schedule as a function of airspeed (m, py, h) or as a lookup table
    /// (table-csv, table-mat), corrected models (state-space).
    #[arg(long = "as", value_name = "FORMAT", value_parser = formats())]
    pub format: ExportFormat,
    /// Airspeeds of a lookup table, in kt, rising, separated by commas (40,60,80). Without it, those of the scheduled conditions.
    #[arg(long, value_name = "AIRSPEEDS", allow_negative_numbers = true)]
    pub breakpoints: Option<Breakpoints>,
    /// The condition whose corrected model is written, by its id; without it, every one.
    #[arg(long, value_name = "ID", allow_negative_numbers = true)]
    pub condition: Option<i64>,
    /// Which of its physics models: nominal, representative, or one by its name [default: nominal].
    #[arg(long, value_name = "MODEL", allow_hyphen_values = true)]
    pub model: Option<String>,
    /// The correction of the models: scheduled, or each condition's own [default: scheduled].
    #[arg(long, value_name = "CORRECTION", value_parser = corrections())]
    pub correction: Option<AssessedCorrection>,
    /// Order of the Pade approximants that stand for delays of models, 1 to 8 [default: 2].
    #[arg(long, value_name = "N", value_parser = whole_number::<1, HIGHEST_PADE_ORDER>, allow_negative_numbers = true)]
    pub pade: Option<usize>,
    /// The file; of corrected models the end of its name says what it is: .mat, .json or .npz.
    #[arg(long, value_name = "PATH")]
    pub out: PathBuf,
    /// Overwrite a file that is there already.
    #[arg(long)]
    pub force: bool,
}

/// Airspeeds of a lookup table \[kt\].
#[derive(Clone, Debug, PartialEq)]
pub struct Breakpoints {
    /// The airspeeds, rising.
    pub airspeeds_kt: Vec<f64>,
}

impl FromStr for Breakpoints {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let airspeeds_kt = text.split(',').map(real_number).collect::<Result<Vec<f64>, _>>()?;
        let rising = airspeeds_kt.windows(2).all(|pair| pair[0] < pair[1]);
        if !rising || !airspeeds_kt.iter().all(|airspeed| airspeed.is_finite()) {
            return Err(format!("expected airspeeds that rise, as 40,60,80, found {text}"));
        }
        Ok(Self { airspeeds_kt })
    }
}

fn formats() -> impl TypedValueParser<Value = ExportFormat> {
    PossibleValuesParser::new(ExportFormat::ALL.map(ExportFormat::name)).try_map(|name| {
        ExportFormat::ALL.into_iter().find(|format| format.name() == name).ok_or("there is no such format")
    })
}

fn corrections() -> impl TypedValueParser<Value = AssessedCorrection> {
    PossibleValuesParser::new(["scheduled", "own"]).map(|name| match name.as_str() {
        "own" => AssessedCorrection::Own,
        _ => AssessedCorrection::Scheduled,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn breakpoints_rise() {
        let of = |text: &str| text.parse::<Breakpoints>().map(|found| found.airspeeds_kt);
        assert_eq!(of("40, 60,80.5"), Ok(vec![40.0, 60.0, 80.5]));
        assert!(of("60,40").is_err() && of("40,40").is_err() && of("40,NaN").is_err() && of("").is_err());
    }
}
