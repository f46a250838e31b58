//! `gdcm figure`: a figure as in the window, or its data, as a file.

use std::sync::Arc;

use gdcm_io::export::figure_file::{figure_format, write_figure};
use gdcm_method::correction::Channel;
use gdcm_model::dataset::{ConditionId, Dataset, Pair};
use gdcm_model::message_text::{sanitized, sanitized_path};
use gdcm_model::progress::Unobserved;
use gdcm_plot::figure::axis::FrequencyUnit;
use gdcm_plot::figure::bode::BodeOptions;
use gdcm_plot::figure::gains::{Across, Measure};
use gdcm_plot::figure::{ConditionSource, Figure, FigureKind, FigureRequest, Role, all_channels};
use gdcm_study::decisions::physics_settings::PhysicsCorrection;
use gdcm_study::results::couplings_assessment::CouplingsAssessment;
use gdcm_study::results::physics_assessment::PhysicsAssessment;
use gdcm_study::results::required_modes::IdentifiedPoles;
use gdcm_study::stages::condition_curves::{CURVE_POINTS, curves_band};
use gdcm_study::{Analysis, CouplingCorrection, Engine, Study};
use gdcm_words::caution::failure_text;
use gdcm_words::coupling_error::coupling_error_text;

use super::dataset_lookup::{channel_names, condition_ids, condition_of, pairs_of};
use super::failure::Failure;
use super::option_values::PairChoice;
use super::progress::ProgressReceiver;
use super::result_arguments::FigureArguments;
use super::study_analysis::{ErrorBars, StudyAnalysis, analyze_study};
use super::study_options::CommandStudy;
use super::terminal::print;

/// Writes a figure to a file, and prints its path.
///
/// 1. The study; the format by the file's extension; whether the file may be written; the request.
///    All of these can fail before the analysis, which takes long.
/// 2. The analysis, with error bars if they are requested or the figure cannot do without them.
/// 3. The figure, and the file.
pub(super) fn figure(arguments: &FigureArguments) -> Result<(), Failure> {
    // Step 1.
    let CommandStudy { study, outputs, .. } =
        CommandStudy::open(&arguments.study, arguments.force)?;
    figure_format(&arguments.out)?;
    outputs.check(&[&arguments.out])?;
    let place = FigurePlace::requested(&study, arguments)?;
    // Step 2.
    let bars = if arguments.bars || arguments.view.needs_bars() {
        ErrorBars::Computed
    } else {
        ErrorBars::Omitted
    };
    let mut analysed = analyze_study(study, &arguments.study, bars)?;
    // Step 3.
    let figure = drawn_figure(
        place,
        &mut analysed,
        arguments.view,
        ProgressReceiver::Terminal,
    )?;
    write_figure(&figure, arguments.width, &arguments.out, outputs)?;
    print(&format!(
        "{}: {}\n",
        sanitized_path(&arguments.out),
        sanitized(&figure.title)
    ))
}

/// A requested figure, with its condition.
pub(super) struct FigurePlace {
    request: FigureRequest,
    /// `None` for a figure about all conditions.
    condition: Option<ConditionId>,
}

impl FigurePlace {
    /// Reads the request from the arguments; an error if the study lacks what they name.
    pub(super) fn requested(study: &Study, arguments: &FigureArguments) -> Result<Self, Failure> {
        Ok(Self {
            request: figure_request(study, arguments)?,
            condition: figure_condition(study, arguments)?,
        })
    }
}

/// Draws a requested figure from an analysed study: first computes the results that only this
/// figure needs (requirements, couplings, physics parameters), then draws it for all conditions or
/// for its condition.
///
/// # Errors
/// There is nothing to draw, the condition has no result, the couplings or physics parameters
/// cannot be assessed, or the work was stopped.
pub(super) fn drawn_figure(
    place: FigurePlace,
    analysed: &mut StudyAnalysis,
    view: FigureKind,
    receiver: ProgressReceiver<'_>,
) -> Result<Figure, Failure> {
    let FigurePlace {
        mut request,
        condition,
    } = place;
    let StudyAnalysis { analysis, engine } = analysed;
    let analysis = &*analysis;
    if view == FigureKind::Requirements {
        request.requirements = Some(Arc::new(engine.requirements(
            analysis,
            &IdentifiedPoles::default(),
            &Unobserved,
        )?));
    }
    if view == FigureKind::Couplings {
        request.couplings = Some(assessed_couplings(&analysis.study, engine, receiver)?);
    }
    if matches!(view, FigureKind::Physics | FigureKind::PhysicsChange) {
        request.physics = Some(assessed_physics(&analysis.study, engine, receiver)?);
    }
    let figure = match condition {
        None => request.figure(Some(analysis), None),
        Some(condition) => figure_of_condition(&request, analysis, condition, engine, receiver)?,
    };
    figure.ok_or_else(|| Failure::NoResult {
        reason: format!(
            "the study has no data for the figure {}; choose another figure or condition",
            view.name()
        ),
    })
}

/// Assesses the couplings requested by the study; without a request, mixing and feedback.
fn assessed_couplings(
    study: &Study,
    engine: &mut Engine,
    receiver: ProgressReceiver<'_>,
) -> Result<Arc<CouplingsAssessment>, Failure> {
    let couplings = match study.settings.couplings {
        CouplingCorrection::None => CouplingCorrection::MixingAndFeedback,
        requested => requested,
    };
    let progress = receiver.begin("computing couplings");
    let assessed = engine.assess_couplings(study, couplings, &*progress)?;
    match assessed {
        Some(Ok(assessment)) => Ok(assessment),
        Some(Err(why)) => Err(Failure::NoResult {
            reason: coupling_error_text(&why, &study.dataset),
        }),
        None => Err(Failure::NoResult {
            reason: "there are no couplings to assess".to_owned(),
        }),
    }
}

/// Diagnoses the physics parameters, and assesses those that the study applies; if it applies none,
/// those that the diagnosis names.
fn assessed_physics(
    study: &Study,
    engine: &mut Engine,
    receiver: ProgressReceiver<'_>,
) -> Result<Arc<PhysicsAssessment>, Failure> {
    let physics = match study.settings.physics {
        PhysicsCorrection::Off => PhysicsCorrection::Named,
        requested => requested,
    };
    let progress = receiver.begin("fitting physics parameters");
    match engine.assess_physics(study, physics, &*progress)? {
        Some(Ok(assessment)) => Ok(assessment),
        Some(Err(why)) => Err(Failure::NoResult {
            reason: why.to_string(),
        }),
        None => Err(Failure::NoResult {
            reason: "there are no physics parameters to assess".to_owned(),
        }),
    }
}

/// Draws a condition's figure from the same curves as the window; `None` if the study does not have
/// the condition, its curves or the figure's data.
///
/// # Errors
/// The condition has no result, or the work was stopped.
fn figure_of_condition(
    request: &FigureRequest,
    analysis: &Analysis,
    condition: ConditionId,
    engine: &mut Engine,
    receiver: ProgressReceiver<'_>,
) -> Result<Option<Figure>, Failure> {
    let study = &analysis.study;
    let result = match analysis.conditions.get(&condition) {
        Some(Ok(result)) => result,
        Some(Err(failure)) => {
            return Err(Failure::NoResult {
                reason: format!(
                    "condition {condition} ({})",
                    failure_text(failure, &study.dataset)
                ),
            });
        }
        None => return Ok(None),
    };
    let grid = (curves_band(&study.settings), CURVE_POINTS);
    let progress = receiver.begin("drawing");
    let Some(curves) = engine.curves(&study.dataset, condition, grid, &*progress)? else {
        return Ok(None);
    };
    drop(progress);
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

/// Builds the figure request from the command line. Without `--pair`, the responses are the
/// constrained ones in the net-gain figure, else the on-axis ones (all if none is on-axis).
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
    let mut request = FigureRequest::new(arguments.view, pairs, channels);
    request.across_roles.clone_from(&arguments.model);
    request.bode = bode_options(dataset, arguments)?;
    request.measure = if arguments.delays {
        Measure::Delay
    } else {
        Measure::Gain
    };
    request.across = if arguments.over_conditions {
        Across::Conditions
    } else {
        Across::Airspeed
    };
    Ok(request)
}

fn bode_options(dataset: &Dataset, arguments: &FigureArguments) -> Result<BodeOptions, Failure> {
    let zeros_of = match &arguments.zeros {
        Some(list) => {
            let pairs = pairs_of(dataset, list, "--zeros")?;
            let [pair] = pairs[..] else {
                let reason = format!("expected one response, found {}", pairs.len());
                return Err(Failure::option("--zeros", reason));
            };
            Some(pair)
        }
        None => None,
    };
    // Hide the curves with couplings, which only the window can show.
    let mut hidden = vec![Role::Coupled];
    hidden.extend(arguments.hide.iter().copied());
    Ok(BodeOptions {
        unit: if arguments.hertz {
            FrequencyUnit::Hertz
        } else {
            FrequencyUnit::RadPerSecond
        },
        hidden: hidden.into_iter().collect(),
        zeros_of,
        shows_muad: arguments.muad,
        ..BodeOptions::default()
    })
}

fn chosen_pairs(dataset: &Dataset, choice: &PairChoice) -> Result<Vec<Pair>, Failure> {
    let measuring = dataset.measuring_pairs();
    Ok(match choice {
        PairChoice::OnAxis => measuring.marked().collect(),
        PairChoice::OffAxis => measuring.pairs().filter(|pair| !measuring[*pair]).collect(),
        PairChoice::All => measuring.pairs().collect(),
        PairChoice::Listed(list) => pairs_of(dataset, list, "--pair")?,
    })
}

/// Returns the channels given by `--channel`: all, the inputs, the outputs, or the named ones in
/// their order.
fn chosen_channels(dataset: &Dataset, choice: Option<&str>) -> Result<Vec<Channel>, Failure> {
    let mut channels = all_channels(dataset);
    match choice {
        None => {}
        Some("inputs") => channels.retain(is_input),
        Some("outputs") => channels.retain(|channel| !is_input(channel)),
        Some(list) => {
            return list
                .split(',')
                .map(|name| named_channel(dataset, name.trim()))
                .collect();
        }
    }
    Ok(channels)
}

fn is_input(channel: &Channel) -> bool {
    matches!(channel, Channel::Input(_))
}

fn named_channel(dataset: &Dataset, name: &str) -> Result<Channel, Failure> {
    let (inputs, outputs) = dataset.input_and_output_names();
    all_channels(dataset)
        .into_iter()
        .find(|channel| channel.name(&inputs, &outputs) == name)
        .ok_or_else(|| {
            let reason = format!(
                "the dataset has no channel {name}; inputs are {}; outputs are {}",
                channel_names(dataset.inputs()),
                channel_names(dataset.outputs())
            );
            Failure::coded_option("--channel", "unknown-channel", reason)
        })
}

/// Returns the figure's condition; `None` for a figure about all conditions.
///
/// # Errors
/// The figure is of one condition, and none or an unknown one is given.
fn figure_condition(
    study: &Study,
    arguments: &FigureArguments,
) -> Result<Option<ConditionId>, Failure> {
    // Couplings concern all conditions; the poles shown beside them belong to a single condition.
    let adds_poles = arguments.view == FigureKind::Couplings && arguments.condition.is_some();
    if !arguments.view.is_of_condition() && !adds_poles {
        return Ok(None);
    }
    let Some(id) = arguments.condition else {
        let reason = format!(
            "{} is a figure of one condition; give one of {}",
            arguments.view.name(),
            condition_ids(&study.dataset)
        );
        return Err(Failure::coded_option(
            "--condition",
            "missing-condition",
            reason,
        ));
    };
    Ok(Some(condition_of(&study.dataset, id)?))
}
