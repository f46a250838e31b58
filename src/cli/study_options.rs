//! The study that a command is about, with what the command line says on top of it.

use crate::executor::Pool;
use gdcm_core::dataset::{BundleKind, Channel, ConditionId, Dataset, ModelId, Pair};
use gdcm_core::message_text::sanitized;
use gdcm_core::study::{Analysis, Edit, Engine, Progress, Study};
use gdcm_files::{LoadedDataset, OutputSet, embedded_example};

use super::existing;
use super::open as open_file;
use super::{Failure, PairList, Rejection, StudyArguments, say_error};

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
    for (setting, words) in &arguments.settings.said {
        let option = setting.option;
        let words: Vec<&str> = words.iter().map(String::as_str).collect();
        let value = setting.read(&words).map_err(|reason| Failure::Option { option, reason: sanitized(&reason) })?;
        study.apply(&setting.to(value)).map_err(Failure::refused(option))?;
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
        study.apply(&Edit::Hold(pair, held.contains(&pair))).map_err(Failure::refused("--on"))?;
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
        study.apply(&Edit::reject_physics(condition, &models)).map_err(Failure::refused("--reject-suggested"))?;
    }
    Ok(*study != before)
}
