//! `gdcm analyze`, `gdcm report`, `gdcm export` and `gdcm figure`: the same analysis, written as
//! result files, as a report, for other tools, or as a figure.

use std::path::PathBuf;
use std::sync::Arc;

use clap::Args;
use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};

use gdcm_io::export::figure_file::{figure_format, write_figure};
use gdcm_io::export::{
    EXPORTERS, ExportFormat, ExportRequest, ExportSource, ExportedRole, check_export,
    export_contents, write_export,
};
use gdcm_io::files::corrections_file::{result_paths, write_results};
use gdcm_io::output_set::make_directory;
use gdcm_io::report::{ReportSource, ReportSubject, report as report_of, save_report};
use gdcm_method::correction::pade::HIGHEST_PADE_ORDER;
use gdcm_method::correction::{Channel, Pade};
use gdcm_model::dataset::{ConditionId, Dataset, Pair};
use gdcm_model::message_text::{sanitized, sanitized_path};
use gdcm_model::progress::Unobserved;
use gdcm_plot::figure::axis::FrequencyUnit;
use gdcm_plot::figure::bode::BodeOptions;
use gdcm_plot::figure::gains::{Across, Measure};
use gdcm_plot::figure::{ConditionSource, Figure, FigureKind, FigureRequest, Role, all_channels};
use gdcm_study::results::couplings_assessment::CouplingsAssessment;
use gdcm_study::results::required_modes::KnownPoles;
use gdcm_study::stages::condition_curves::{CURVE_POINTS, curves_band};
use gdcm_study::{Analysis, AssessedCorrection, CouplingCorrection, Engine, Study};
use gdcm_words::caution::failure_text;

use super::arguments::{
    AnalyzeArguments, FigureArguments, PairChoice, ReportArguments, StudyArguments, real_number,
    whole_number,
};
use super::flight_records::time_histories;
use super::study_options::{analysis_of, condition_of, ids, names, pairs_of, study_of};
use super::summary::{leave_one_out_section, summary};
use super::terminal::{Failure, TerminalProgress, say};

/// Analyses, writes the results, and prints a summary.
pub(super) fn analyze(arguments: &AnalyzeArguments) -> Result<(), Failure> {
    let (study, loaded, outputs) = study_of(&arguments.study, arguments.force)?;
    outputs.check(&result_paths(&arguments.out))?;
    make_directory(&arguments.out)?;
    let (analysis, _) = analysis_of(study, &arguments.study, true)?;
    let all = analysis.conditions.keys().copied().collect();
    write_results(&analysis, &loaded.sha256, &all, &arguments.out, outputs)?;
    say(&summary(&analysis, &loaded, &arguments.out))?;
    if arguments.leave_one_out {
        say(&leave_one_out_section(&analysis))
    } else {
        Ok(())
    }
}

/// Analyses, and writes the full report.
pub(super) fn report(arguments: &ReportArguments) -> Result<(), Failure> {
    let (study, loaded, outputs) = study_of(&arguments.study, arguments.force)?;
    let outputs = outputs.also_reading(arguments.histories.records.iter().cloned());
    outputs.check(&[&arguments.out])?;
    let ending = arguments
        .out
        .extension()
        .map(|ending| ending.to_string_lossy().to_lowercase());
    if !matches!(ending.as_deref(), Some("html" | "htm")) {
        let found = sanitized_path(&arguments.out);
        let reason = format!(
            "expected a name that ends in .html, found {found}; a browser prints the report as PDF"
        );
        return Err(Failure::option("--out", reason));
    }
    let records = arguments
        .histories
        .read(&study.dataset, study.settings.band)?;
    let (analysis, mut engine) = analysis_of(study, &arguments.study, false)?;
    let histories = match arguments.histories.records.as_slice() {
        [] => None,
        _ => Some(time_histories(&analysis, &records)?),
    };
    let study_file = arguments
        .study
        .file
        .as_deref()
        .filter(|file| loaded.path() != Some(file));
    let source = ReportSource::of(&loaded, study_file);
    let progress = TerminalProgress::new("drawing");
    let known = KnownPoles::default();
    let subject = ReportSubject {
        analysis: &analysis,
        histories: histories.as_ref(),
        known: &known,
    };
    let report = report_of(subject, &source, &mut engine, &progress)?;
    drop(progress);
    save_report(&report, &arguments.out, outputs)?;
    let solved = analysis
        .conditions
        .values()
        .filter(|outcome| outcome.is_ok())
        .count();
    say(&format!(
        "{}: a report on {solved} conditions\n",
        sanitized_path(&arguments.out)
    ))?;
    records.ended()
}

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
    #[arg(long, value_name = "AIRSPEEDS", value_parser = breakpoints, allow_negative_numbers = true)]
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

/// Airspeeds of a lookup table \[kt\], rising.
pub type Breakpoints = Vec<f64>;

fn breakpoints(text: &str) -> Result<Breakpoints, String> {
    let airspeeds_kt = text
        .split(',')
        .map(real_number)
        .collect::<Result<Breakpoints, _>>()?;
    let rising = airspeeds_kt.windows(2).all(|pair| pair[0] < pair[1]);
    if !rising || !airspeeds_kt.iter().all(|airspeed| airspeed.is_finite()) {
        return Err(format!(
            "expected airspeeds that rise, as 40,60,80, found {text}"
        ));
    }
    Ok(airspeeds_kt)
}

fn formats() -> impl TypedValueParser<Value = ExportFormat> {
    let values = EXPORTERS
        .iter()
        .map(|exporter| PossibleValue::new(exporter.name).help(exporter.words));
    PossibleValuesParser::new(values)
        .try_map(|name| ExportFormat::named(&name).ok_or("there is no such format"))
}

fn corrections() -> impl TypedValueParser<Value = AssessedCorrection> {
    PossibleValuesParser::new(["scheduled", "own"]).map(|name| match name.as_str() {
        "own" => AssessedCorrection::Own,
        _ => AssessedCorrection::Scheduled,
    })
}

/// Analyses, writes the requested export, and prints its notes and cautions.
pub(super) fn export(arguments: &ExportArguments) -> Result<(), Failure> {
    let (study, loaded, outputs) = study_of(&arguments.study, arguments.force)?;
    let request = export_request(&study, arguments)?;
    check_export(request.format, &arguments.out)?;
    outputs.check(&[&arguments.out])?;
    let (analysis, _) = analysis_of(study, &arguments.study, true)?;
    let source = ExportSource {
        name: name(&arguments.study),
        sha256: loaded.sha256.clone(),
    };
    let contents = export_contents(&analysis, &request).lines(&analysis.study.dataset);
    let remarks = write_export(&analysis, &source, &request, &arguments.out, outputs)?;
    let remarks: String = contents
        .iter()
        .chain(&remarks)
        .map(|remark| format!("{}\n", sanitized(remark)))
        .collect();
    say(&format!(
        "{}: {}\n{remarks}",
        sanitized_path(&arguments.out),
        request.format.words
    ))
}

/// Returns the name of an export: the file of the study or of the dataset.
fn name(arguments: &StudyArguments) -> String {
    let file = arguments.file.as_ref().and_then(|file| file.file_name());
    file.map_or_else(
        || "the embedded example".to_owned(),
        |name| name.to_string_lossy().into_owned(),
    )
}

/// Builds the request from the command line; rejects options that do not apply to the format.
fn export_request(study: &Study, arguments: &ExportArguments) -> Result<ExportRequest, Failure> {
    let format = arguments.format;
    let given = [
        ("--breakpoints", arguments.breakpoints.is_some()),
        ("--condition", arguments.condition.is_some()),
        ("--model", arguments.model.is_some()),
        ("--correction", arguments.correction.is_some()),
        ("--pade", arguments.pade.is_some()),
    ];
    let misplaced =
        |(option, is_given): &(&str, bool)| *is_given && !format.options.contains(option);
    if let Some((option, _)) = given.into_iter().find(misplaced) {
        let takes = EXPORTERS
            .iter()
            .filter(|about| about.options.contains(&option));
        let names: Vec<&str> = takes.map(|about| about.name).collect();
        return Err(Failure::option(
            option,
            format!("is an option of --as {}", names.join(" and ")),
        ));
    }
    let condition = arguments
        .condition
        .map(|id| condition_of(&study.dataset, id))
        .transpose()?;
    let role = match arguments.model.as_deref() {
        None | Some("nominal") => ExportedRole::Nominal,
        Some("representative") => ExportedRole::Representative,
        Some(name) => ExportedRole::Named(name.to_owned()),
    };
    Ok(ExportRequest {
        breakpoints_kt: arguments.breakpoints.clone(),
        condition,
        role,
        correction: arguments.correction.unwrap_or_default(),
        pade: arguments.pade.and_then(Pade::new).unwrap_or_default(),
        format,
    })
}

/// Writes one figure to a file and reports it.
pub(super) fn figure(arguments: &FigureArguments) -> Result<(), Failure> {
    let (study, _, outputs) = study_of(&arguments.study, arguments.force)?;
    figure_format(&arguments.out)?;
    outputs.check(&[&arguments.out])?;
    let mut request = figure_request(&study, arguments)?;
    let condition = condition(&study, arguments)?;
    let with_bars = arguments.bars || arguments.view.needs_bars();
    let (analysis, mut engine) = analysis_of(study, &arguments.study, with_bars)?;
    if arguments.view == FigureKind::Requirements {
        request.requirements = Some(Arc::new(engine.requirements(
            &analysis,
            &KnownPoles::default(),
            &Unobserved,
        )?));
    }
    if arguments.view == FigureKind::Couplings {
        request.couplings = Some(assessed_couplings(&analysis.study, &mut engine)?);
    }
    let figure = match condition {
        None => request.figure(Some(&analysis), None),
        Some(condition) => figure_of_condition(&request, &analysis, condition, &mut engine)?,
    };
    let figure = figure.ok_or_else(|| Failure::NoResult {
        reason: "there is nothing to draw".to_owned(),
    })?;
    write_figure(&figure, arguments.width, &arguments.out, outputs)?;
    say(&format!(
        "{}: {}\n",
        sanitized_path(&arguments.out),
        sanitized(&figure.title)
    ))
}

/// Assesses the couplings requested by the study, or else mixing and feedback.
fn assessed_couplings(
    study: &Study,
    engine: &mut Engine,
) -> Result<Arc<CouplingsAssessment>, Failure> {
    let asked = study.settings.couplings;
    let asked = if asked == CouplingCorrection::None {
        CouplingCorrection::MixingAndFeedback
    } else {
        asked
    };
    let found = engine.assess_couplings(study, asked, &TerminalProgress::new("couplings"))?;
    let found = found.ok_or_else(|| Failure::NoResult {
        reason: "no couplings".to_owned(),
    })?;
    found.map_err(|why| Failure::NoResult {
        reason: why.words(&study.dataset.names_of_channels().0),
    })
}

/// Draws the figure of one condition from the curves that the window shows.
fn figure_of_condition(
    request: &FigureRequest,
    analysis: &Analysis,
    condition: ConditionId,
    engine: &mut Engine,
) -> Result<Option<Figure>, Failure> {
    let study = &analysis.study;
    let result = match analysis.conditions.get(&condition) {
        Some(Ok(result)) => result,
        Some(Err(failure)) => {
            return Err(Failure::NoResult {
                reason: format!(
                    "condition {condition}: {}",
                    failure_text(failure, &study.dataset)
                ),
            });
        }
        None => return Ok(None),
    };
    let grid = (curves_band(&study.settings), CURVE_POINTS);
    let Some(curves) = engine.curves(
        &study.dataset,
        condition,
        grid,
        &TerminalProgress::new("drawing"),
    )?
    else {
        return Ok(None);
    };
    let schedule = analysis.schedule.as_ref().ok();
    let source = ConditionSource {
        study,
        analysis: Some(result),
        schedule,
        curves: &curves,
        variant: None,
    };
    Ok(request.figure(Some(analysis), Some(&source)))
}

/// Builds the figure request from the command line.
fn figure_request(study: &Study, arguments: &FigureArguments) -> Result<FigureRequest, Failure> {
    let dataset = &study.dataset;
    let pairs = match &arguments.pair {
        Some(choice) => chosen_pairs(dataset, choice)?,
        None if arguments.view == FigureKind::NetGain => {
            study.settings.constrained.marked().collect()
        }
        None => dataset.measuring_pairs().marked().collect(),
    };
    let channels = chosen_channels(dataset, arguments.channel.as_deref())?;
    let measure = if arguments.delays {
        Measure::Delay
    } else {
        Measure::Gain
    };
    let across = if arguments.over_conditions {
        Across::Conditions
    } else {
        Across::Airspeed
    };
    let unit = if arguments.hertz {
        FrequencyUnit::Hertz
    } else {
        FrequencyUnit::RadPerSecond
    };
    // Showing couplings alone is an option of the window only.
    let hidden = arguments
        .hide
        .iter()
        .copied()
        .chain([Role::Coupled])
        .collect();
    let zeros = arguments
        .zeros
        .as_ref()
        .map(|list| pairs_of(dataset, list, "--zeros"))
        .transpose()?;
    let zeros_of = zeros.and_then(|pairs| pairs.first().copied());
    let bode = BodeOptions {
        unit,
        hidden,
        zeros_of,
        shows_muad: arguments.muad,
        ..BodeOptions::default()
    };
    let across_role = arguments.model;
    Ok(FigureRequest {
        measure,
        across,
        across_role,
        bode,
        ..FigureRequest::new(arguments.view, pairs, channels)
    })
}

fn chosen_pairs(dataset: &Dataset, choice: &PairChoice) -> Result<Vec<Pair>, Failure> {
    let measuring = dataset.measuring_pairs();
    Ok(match choice {
        PairChoice::OnAxis => measuring.marked().collect(),
        PairChoice::OffAxis => measuring.pairs().filter(|pair| !measuring[*pair]).collect(),
        PairChoice::All => measuring.pairs().collect(),
        PairChoice::These(list) => pairs_of(dataset, list, "--pair")?,
    })
}

fn chosen_channels(dataset: &Dataset, choice: Option<&str>) -> Result<Vec<Channel>, Failure> {
    let all = all_channels(dataset);
    let (inputs, outputs) = dataset.names_of_channels();
    let is_input = |channel: &Channel| matches!(channel, Channel::Input(_));
    let find = |name: &str| {
        all.iter().copied().find(|channel| channel.name(&inputs, &outputs) == name).ok_or_else(|| {
            let of_inputs = names(dataset.inputs());
            let of_outputs = names(dataset.outputs());
            let reason = format!("the dataset has no channel {name}; inputs are {of_inputs}; outputs are {of_outputs}");
            Failure::option("--channel", reason)
        })
    };
    match choice {
        None => Ok(all),
        Some("inputs") => Ok(all.into_iter().filter(is_input).collect()),
        Some("outputs") => Ok(all
            .into_iter()
            .filter(|channel| !is_input(channel))
            .collect()),
        Some(list) => list.split(',').map(|name| find(name.trim())).collect(),
    }
}

/// Returns the condition of a figure that shows a single one.
fn condition(study: &Study, arguments: &FigureArguments) -> Result<Option<ConditionId>, Failure> {
    // Couplings concern all conditions; the poles beside them belong to one.
    let is_asked_for = arguments.view == FigureKind::Couplings && arguments.condition.is_some();
    if !arguments.view.is_of_condition() && !is_asked_for {
        return Ok(None);
    }
    let Some(id) = arguments.condition else {
        let reason = format!(
            "{} is a figure of one condition; the dataset has {}",
            arguments.view.name(),
            ids(&study.dataset)
        );
        return Err(Failure::option("--condition", reason));
    };
    condition_of(&study.dataset, id).map(Some)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn breakpoints_rise() {
        assert_eq!(breakpoints("40, 60,80.5"), Ok(vec![40.0, 60.0, 80.5]));
        assert!(
            ["60,40", "40,40", "40,NaN", ""]
                .iter()
                .all(|wrong| breakpoints(wrong).is_err())
        );
    }
}
