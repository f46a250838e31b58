//! The study that a command is about, with what the command line says on top of it.

use crate::executor::Pool;
use gdcm_core::correction::GainSource;
use gdcm_core::dataset::{Band, BundleKind, Channel, ConditionId, Dataset, ModelId, Pair};
use gdcm_core::schedule::{ScheduleKind, ScheduleSettings, SecondVariable};
use gdcm_core::study::{Analysis, Edit, Engine, Progress, Setting, Study};
use gdcm_core::uncertainty::UncertaintySettings;
use gdcm_files::{LoadedDataset, OutputSet, embedded_example};

use super::arguments::{CoherenceChoice, GainSourceChoice, PairList, Rejection, SecondVariableChoice, StudyArguments};
use super::existing;
use super::failure::Failure;
use super::open as open_file;
use super::terminal::say_error;

/// The study, and the dataset that it is about; cautions of the file are told on standard error.
pub(super) fn study_of(arguments: &StudyArguments) -> Result<(Study, LoadedDataset), Failure> {
    let (mut study, loaded) = match &arguments.file {
        Some(file) => {
            let (study, loaded, _) = open_file(file, &arguments.opening)?.into_study();
            (study, loaded)
        }
        None => {
            let loaded = embedded_example()?;
            (Study::new(loaded.dataset.clone()), loaded)
        }
    };
    for caution in &loaded.cautions {
        say_error(&format!("{}: {caution}", loaded.origin));
    }
    take_options(&mut study, arguments)?;
    Ok((study, loaded))
}

/// The files that a command about a study writes: none of those that it reads is overwritten.
pub(super) fn outputs_of(arguments: &StudyArguments, loaded: &LoadedDataset, force: bool) -> OutputSet {
    let inputs = arguments.file.iter().cloned().chain(loaded.origin.file());
    OutputSet::new(existing(force), inputs.collect())
}

/// An engine on all cores.
pub(super) fn engine() -> Engine {
    Engine::with_executor(Box::new(Pool))
}

/// The analysis of a study, after what it suggests has been rejected where that is asked for.
pub(super) fn analysis_of(
    study: &mut Study,
    arguments: &StudyArguments,
    engine: &mut Engine,
    progress: &dyn Progress,
) -> Result<Analysis, Failure> {
    let mut analysis = engine.analyze(study, progress)?;
    if arguments.reject_suggested && reject_suggested(study, &analysis)? {
        analysis = engine.analyze(study, progress)?;
    }
    Ok(analysis)
}

/// Puts the options into the study, over what it says itself.
fn take_options(study: &mut Study, arguments: &StudyArguments) -> Result<(), Failure> {
    let mut set = |option, setting| study.apply(&Edit::Set(setting)).map_err(Failure::refused(option));
    if let Some(alpha) = arguments.alpha {
        set("--alpha", Setting::AlphaGain(alpha))?;
    }
    if let Some(alpha) = arguments.alpha_delay {
        set("--alpha-delay", Setting::AlphaDelay(alpha))?;
    }
    if let Some([low, high]) = arguments.band.as_deref() {
        let band =
            Band::new(*low, *high).map_err(|error| Failure::Option { option: "--band", reason: error.to_string() })?;
        set("--band", Setting::Band(band))?;
    }
    if let Some(points) = arguments.points {
        set("--points", Setting::Points(points))?;
    }
    if let Some(phase) = arguments.phase {
        set("--phase", Setting::Phase(phase))?;
    }
    if let Some(from) = arguments.delay_from {
        set("--delay-from", Setting::DelayFrom(from))?;
    }
    if let Some(agreement_db) = arguments.agreement {
        set("--agreement", Setting::Agreement(agreement_db))?;
    }
    if let Some(CoherenceChoice { threshold }) = arguments.coherence {
        set("--coherence", Setting::Coherence(threshold))?;
    }
    if arguments.schedule_delays {
        let schedule = ScheduleSettings { delays: true, ..study.settings.schedule };
        study.apply(&Edit::Set(Setting::Schedule(schedule))).map_err(Failure::refused("--schedule-delays"))?;
    }
    if let Some(degree) = arguments.degree {
        let schedule = ScheduleSettings { kind: ScheduleKind::Polynomial { degree }, ..study.settings.schedule };
        study.apply(&Edit::Set(Setting::Schedule(schedule))).map_err(Failure::refused("--degree"))?;
    }
    if let Some(choice) = arguments.second_variable {
        let variable = match choice {
            SecondVariableChoice::Altitude => SecondVariable::Altitude,
            SecondVariableChoice::Mass => SecondVariable::Mass,
        };
        let schedule = ScheduleSettings { second: Some(variable), ..study.settings.schedule };
        study.apply(&Edit::Set(Setting::Schedule(schedule))).map_err(Failure::refused("--second-variable"))?;
    }
    if let Some(choice) = arguments.gain_from {
        let source = match choice {
            GainSourceChoice::Representatives => GainSource::Representatives,
            GainSourceChoice::Mean => GainSource::MeanOfPairs,
        };
        study.apply(&Edit::Set(Setting::GainSource(source))).map_err(Failure::refused("--gain-from"))?;
    }
    if let Some(level) = arguments.level {
        let uncertainty = UncertaintySettings { level, ..study.settings.uncertainty };
        study.apply(&Edit::Set(Setting::Uncertainty(uncertainty))).map_err(Failure::refused("--level"))?;
    }
    for &id in &arguments.hold_out {
        let edit = Edit::SetHeldOut { condition: ConditionId(id), held_out: true };
        study.apply(&edit).map_err(Failure::refused("--hold-out"))?;
    }
    if let Some(list) = &arguments.on {
        hold(study, list)?;
    }
    arguments.reject.iter().try_for_each(|rejection| reject(study, rejection))
}

/// The responses of a list, which an option gave.
pub(super) fn pairs_of(dataset: &Dataset, list: &PairList, option: &'static str) -> Result<Vec<Pair>, Failure> {
    let find = |(output, input): &(String, String)| {
        dataset.find_pair(output, input).ok_or_else(|| {
            let reason = format!(
                "the dataset has no response {output}/{input}; outputs are {}; inputs are {}",
                names(dataset.outputs()),
                names(dataset.inputs())
            );
            Failure::Option { option, reason }
        })
    };
    list.pairs.iter().map(find).collect()
}

/// The names of channels, with commas.
pub(super) fn names(channels: &[Channel]) -> String {
    channels.iter().map(|channel| channel.name.as_str()).collect::<Vec<_>>().join(", ")
}

fn hold(study: &mut Study, list: &PairList) -> Result<(), Failure> {
    let dataset = study.dataset.clone();
    let held = pairs_of(&dataset, list, "--on")?;
    for pair in dataset.on_axis().pairs() {
        let setting = Setting::Constrained(pair, held.contains(&pair));
        study.apply(&Edit::Set(setting)).map_err(Failure::refused("--on"))?;
    }
    Ok(())
}

fn reject(study: &mut Study, rejection: &Rejection) -> Result<(), Failure> {
    let Rejection { condition: id, model: name } = rejection;
    let wrong = |reason: String| Failure::Option { option: "--reject", reason };
    let id = ConditionId(*id);
    let condition = study.dataset.condition(id);
    let condition = condition.ok_or_else(|| wrong(format!("the dataset has no condition {id}")))?;
    let find = |bundle| condition.position(bundle, name).map(|_| ModelId::new(id, bundle, name));
    let model = match (find(BundleKind::Physics), find(BundleKind::Identified)) {
        (Some(model), None) | (None, Some(model)) => model,
        (None, None) => return Err(wrong(format!("condition {id} has no model \"{name}\""))),
        (Some(_), Some(_)) => {
            let reason = format!("\"{name}\" is both a physics and an identified model of condition {id}; use a study");
            return Err(wrong(reason));
        }
    };
    study.apply(&Edit::Reject(model)).map_err(Failure::refused("--reject"))
}

/// Rejects what the analysis suggests; says whether anything changed.
fn reject_suggested(study: &mut Study, analysis: &Analysis) -> Result<bool, Failure> {
    let before = study.clone();
    for (&condition, result) in &analysis.conditions {
        let models = result.as_ref().map(|result| result.suggested()).unwrap_or_default();
        study.apply(&Edit::RejectAll { condition, models }).map_err(Failure::refused("--reject-suggested"))?;
    }
    Ok(*study != before)
}
