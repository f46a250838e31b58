//! `gdcm figure`.

use gdcm_core::message_text::sanitized_path;
use std::sync::Arc;

use gdcm_core::correction::Channel;
use gdcm_core::dataset::{ConditionId, Dataset, Pair};
use gdcm_core::study::{Analysis, CURVE_POINTS, Engine, Study, display_band};
use gdcm_files::figure::{
    Across, BodeOptions, ConditionSource, Figure, FigureKind, FigureRequest, FrequencyUnit, Measure, all_channels,
};
use gdcm_files::{figure_format, write_figure};

use super::{
    Failure, FigureArguments, PairChoice, TerminalProgress, analysis_of, engine, names, outputs_of, pairs_of, say,
    study_of,
};

/// Makes one figure as a file, and says so.
pub(super) fn figure(arguments: &FigureArguments) -> Result<(), Failure> {
    let (mut study, loaded) = study_of(&arguments.study)?;
    let outputs = outputs_of(&arguments.study, &loaded, arguments.force);
    figure_format(&arguments.out)?;
    outputs.check(&[&arguments.out])?;
    let request = request(&study, arguments)?;
    let condition = condition(&study, arguments)?;
    let mut engine = engine();
    let progress = TerminalProgress::new("analysing");
    let mut analysis = analysis_of(&mut study, &arguments.study, &mut engine, &progress)?;
    if arguments.bars || arguments.view.needs_bars() {
        analysis.uncertainty = Some(Arc::new(engine.uncertainty(&analysis, &progress)?));
    }
    let figure = match condition {
        None => request.figure(Some(&analysis), None),
        Some(condition) => figure_of_condition(&request, &analysis, condition, (&mut engine, &progress))?,
    };
    drop(progress);
    let figure = figure.ok_or_else(|| Failure::NoResult { reason: "there is nothing to draw".to_owned() })?;
    write_figure(&figure, arguments.width, &arguments.out, outputs)?;
    say(&format!("{}: {}\n", sanitized_path(&arguments.out), figure.title))
}

/// The figure of one condition, of the curves that the window draws.
fn figure_of_condition(
    request: &FigureRequest,
    analysis: &Analysis,
    condition: ConditionId,
    (engine, progress): (&mut Engine, &TerminalProgress),
) -> Result<Option<Figure>, Failure> {
    let study = &analysis.study;
    let result = match analysis.conditions.get(&condition) {
        Some(Ok(result)) => result,
        Some(Err(failure)) => return Err(Failure::NoResult { reason: format!("condition {condition}: {failure}") }),
        None => return Ok(None),
    };
    let grid = (display_band(study.settings.band), CURVE_POINTS);
    let Some(curves) = engine.curves(&study.dataset, condition, grid, progress)? else {
        return Ok(None);
    };
    let schedule = analysis.schedule.as_ref().ok();
    let source = ConditionSource { study, analysis: Some(result), schedule, curves: &curves };
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
    let hidden = arguments.hide.iter().copied().collect();
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
    if !arguments.view.is_of_condition() {
        return Ok(None);
    }
    let ids = || {
        let ids = study.dataset.conditions().iter().map(|condition| condition.id().to_string());
        ids.collect::<Vec<_>>().join(", ")
    };
    let wrong = |reason: String| Failure::Option { option: "--condition", reason };
    let id = arguments.condition.map(ConditionId).ok_or_else(|| {
        wrong(format!("{} is a figure of one condition; the dataset has {}", arguments.view.name(), ids()))
    })?;
    match study.dataset.condition(id) {
        Some(_) => Ok(Some(id)),
        None => Err(wrong(format!("the dataset has no condition {id}; it has {}", ids()))),
    }
}
