//! `gdcm figure`.

use std::sync::Arc;

use gdcm_core::message_text::{sanitized, sanitized_path};

use gdcm_core::correction::Channel;
use gdcm_core::dataset::{ConditionId, Dataset, Pair};
use gdcm_core::study::{
    Analysis, CURVE_POINTS, CouplingCorrection, CouplingsAssessment, Engine, KnownPoles, Study, Unobserved, curves_band,
};
use gdcm_files::figure::{
    Across, BodeOptions, ConditionSource, Figure, FigureKind, FigureRequest, FrequencyUnit, Measure, Role, all_channels,
};
use gdcm_files::{figure_format, write_figure};

use super::{
    Failure, FigureArguments, PairChoice, TerminalProgress, analysis_of, condition_of, ids, names, pairs_of, say,
    study_of,
};

/// Makes one figure as a file, and says so.
pub(super) fn figure(arguments: &FigureArguments) -> Result<(), Failure> {
    let (study, _, outputs) = study_of(&arguments.study, arguments.force)?;
    figure_format(&arguments.out)?;
    outputs.check(&[&arguments.out])?;
    let mut request = request(&study, arguments)?;
    let condition = condition(&study, arguments)?;
    let with_bars = arguments.bars || arguments.view.needs_bars();
    let (analysis, mut engine) = analysis_of(study, &arguments.study, with_bars)?;
    if arguments.view == FigureKind::Requirements {
        request.requirements = Some(Arc::new(engine.requirements(&analysis, &KnownPoles::default(), &Unobserved)?));
    }
    if arguments.view == FigureKind::Couplings {
        request.couplings = Some(assessed_couplings(&analysis.study, &mut engine)?);
    }
    let figure = match condition {
        None => request.figure(Some(&analysis), None),
        Some(condition) => figure_of_condition(&request, &analysis, condition, &mut engine)?,
    };
    let figure = figure.ok_or_else(|| Failure::NoResult { reason: "there is nothing to draw".to_owned() })?;
    write_figure(&figure, arguments.width, &arguments.out, outputs)?;
    say(&format!("{}: {}\n", sanitized_path(&arguments.out), sanitized(&figure.title)))
}

/// What couplings do to a study: those that it asks for, or else mixing and feedback.
fn assessed_couplings(study: &Study, engine: &mut Engine) -> Result<Arc<CouplingsAssessment>, Failure> {
    let asked = study.settings.couplings;
    let asked = if asked == CouplingCorrection::None { CouplingCorrection::MixingAndFeedback } else { asked };
    let refused = |reason: String| Failure::NoResult { reason };
    let found = engine.assess_couplings(study, asked, &TerminalProgress::new("couplings"))?;
    found
        .ok_or_else(|| refused("no couplings".to_owned()))?
        .map_err(|why| refused(why.words(&study.dataset.names_of_channels().0)))
}

/// The figure of one condition, of the curves that the window draws.
fn figure_of_condition(
    request: &FigureRequest,
    analysis: &Analysis,
    condition: ConditionId,
    engine: &mut Engine,
) -> Result<Option<Figure>, Failure> {
    let study = &analysis.study;
    let result = match analysis.conditions.get(&condition) {
        Some(Ok(result)) => result,
        Some(Err(failure)) => return Err(Failure::NoResult { reason: format!("condition {condition}: {failure}") }),
        None => return Ok(None),
    };
    let grid = (curves_band(&study.settings), CURVE_POINTS);
    let Some(curves) = engine.curves(&study.dataset, condition, grid, &TerminalProgress::new("drawing"))? else {
        return Ok(None);
    };
    let schedule = analysis.schedule.as_ref().ok();
    let source = ConditionSource { study, analysis: Some(result), schedule, curves: &curves, variant: None };
    Ok(request.figure(Some(analysis), Some(&source)))
}

fn request(study: &Study, arguments: &FigureArguments) -> Result<FigureRequest, Failure> {
    let dataset = &study.dataset;
    let pairs = match &arguments.pair {
        Some(choice) => chosen_pairs(dataset, choice)?,
        None if arguments.view == FigureKind::NetGain => study.settings.constrained.marked().collect(),
        None => dataset.measuring_pairs().marked().collect(),
    };
    let channels = chosen_channels(dataset, arguments.channel.as_deref())?;
    let measure = if arguments.delays { Measure::Delay } else { Measure::Gain };
    let across = if arguments.over_conditions { Across::Conditions } else { Across::Airspeed };
    let unit = if arguments.hertz { FrequencyUnit::Hertz } else { FrequencyUnit::RadPerSecond };
    // Couplings alone are drawn on wish, which is the window's.
    let hidden = arguments.hide.iter().copied().chain([Role::Coupled]).collect();
    let zeros_of = match &arguments.zeros {
        Some(list) => pairs_of(dataset, list, "--zeros")?.first().copied(),
        None => None,
    };
    let bode = BodeOptions { unit, hidden, zeros_of, shows_muad: arguments.muad, ..BodeOptions::default() };
    let across_role = arguments.model;
    Ok(FigureRequest { measure, across, across_role, bode, ..FigureRequest::new(arguments.view, pairs, channels) })
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
            let (of_inputs, of_outputs) = (names(dataset.inputs()), names(dataset.outputs()));
            let reason = format!("the dataset has no channel {name}; inputs are {of_inputs}; outputs are {of_outputs}");
            Failure::Option { option: "--channel", reason }
        })
    };
    match choice {
        None => Ok(all),
        Some("inputs") => Ok(all.into_iter().filter(is_input).collect()),
        Some("outputs") => Ok(all.into_iter().filter(|channel| !is_input(channel)).collect()),
        Some(list) => list.split(',').map(|name| find(name.trim())).collect(),
    }
}

/// The condition that a figure of one is of.
fn condition(study: &Study, arguments: &FigureArguments) -> Result<Option<ConditionId>, Failure> {
    // Couplings are of all conditions; the poles beside them are of one.
    let is_asked_for = arguments.view == FigureKind::Couplings && arguments.condition.is_some();
    if !arguments.view.is_of_condition() && !is_asked_for {
        return Ok(None);
    }
    let Some(id) = arguments.condition else {
        let reason =
            format!("{} is a figure of one condition; the dataset has {}", arguments.view.name(), ids(&study.dataset));
        return Err(Failure::Option { option: "--condition", reason });
    };
    condition_of(&study.dataset, id).map(Some)
}
