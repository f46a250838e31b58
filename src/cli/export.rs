//! `gdcm export`: what it takes, and what it does.

use std::path::PathBuf;
use std::str::FromStr;

use clap::Args;
use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};

use gdcm_core::correction::{HIGHEST_PADE_ORDER, Pade};
use gdcm_core::message_text::{sanitized, sanitized_path};
use gdcm_core::study::{AssessedCorrection, Study};
use gdcm_files::{EXPORTERS, ExportFormat, ExportRequest, ExportSource, ExportedRole, check_export, write_export};

use super::{Failure, StudyArguments, analysis_of, condition_of, real_number, say, study_of, whole_number};

/// What is to be exported, as what, and where it goes.
#[derive(Debug, Args)]
pub struct ExportArguments {
    /// What is to be analysed, and how.
    #[command(flatten)]
    pub study: StudyArguments,
    /// As what.
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
    let values = EXPORTERS.iter().map(|exporter| PossibleValue::new(exporter.name).help(exporter.words));
    PossibleValuesParser::new(values).try_map(|name| ExportFormat::named(&name).ok_or("there is no such format"))
}

fn corrections() -> impl TypedValueParser<Value = AssessedCorrection> {
    PossibleValuesParser::new(["scheduled", "own"]).map(|name| match name.as_str() {
        "own" => AssessedCorrection::Own,
        _ => AssessedCorrection::Scheduled,
    })
}

/// Analyses, writes what is asked for, and says what is to be known of it.
pub(super) fn export(arguments: &ExportArguments) -> Result<(), Failure> {
    let (study, loaded, outputs) = study_of(&arguments.study, arguments.force)?;
    let request = request(&study, arguments)?;
    check_export(request.format, &arguments.out)?;
    outputs.check(&[&arguments.out])?;
    let (analysis, _) = analysis_of(study, &arguments.study, true)?;
    let source = ExportSource { name: name(&arguments.study), sha256: loaded.sha256.clone() };
    let remarks = write_export(&analysis, &source, &request, &arguments.out, outputs)?;
    let remarks: String = remarks.iter().map(|remark| format!("{}\n", sanitized(remark))).collect();
    say(&format!("{}: {}\n{remarks}", sanitized_path(&arguments.out), request.format.words))
}

/// What an export is called: the file of the study or of the dataset.
fn name(arguments: &StudyArguments) -> String {
    let file = arguments.file.as_ref().and_then(|file| file.file_name());
    file.map_or_else(|| "the embedded example".to_owned(), |name| name.to_string_lossy().into_owned())
}

/// The request of a command line; an option that its format knows nothing of is refused.
fn request(study: &Study, arguments: &ExportArguments) -> Result<ExportRequest, Failure> {
    let format = arguments.format;
    let given = [
        ("--breakpoints", arguments.breakpoints.is_some()),
        ("--condition", arguments.condition.is_some()),
        ("--model", arguments.model.is_some()),
        ("--correction", arguments.correction.is_some()),
        ("--pade", arguments.pade.is_some()),
    ];
    let misplaced = |(option, is_given): &(&str, bool)| *is_given && !format.options.contains(option);
    if let Some((option, _)) = given.into_iter().find(misplaced) {
        let takes = EXPORTERS.iter().filter(|about| about.options.contains(&option));
        let names: Vec<&str> = takes.map(|about| about.name).collect();
        return Err(Failure::Option { option, reason: format!("is an option of --as {}", names.join(" and ")) });
    }
    let condition = arguments.condition.map(|id| condition_of(&study.dataset, id)).transpose()?;
    let role = match arguments.model.as_deref() {
        None | Some("nominal") => ExportedRole::Nominal,
        Some("representative") => ExportedRole::Representative,
        Some(name) => ExportedRole::Named(name.to_owned()),
    };
    Ok(ExportRequest {
        breakpoints_kt: arguments.breakpoints.as_ref().map(|breakpoints| breakpoints.airspeeds_kt.clone()),
        condition,
        role,
        correction: arguments.correction.unwrap_or_default(),
        pade: arguments.pade.and_then(Pade::new).unwrap_or_default(),
        format,
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
