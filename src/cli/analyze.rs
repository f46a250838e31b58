//! `gdcm analyze`.

use crate::dataset::{Band, BundleKind, Channel, ConditionId, ModelId};
use crate::io::{LoadedDataset, OutputSet, embedded_example, make_directory, result_paths, write_results};
use crate::schedule::{ScheduleKind, ScheduleSettings};
use crate::study::{Analysis, Edit, Engine, Setting, Study};

use super::arguments::{AnalyzeArguments, PairList, Rejection};
use super::existing;
use super::failure::Failure;
use super::opening::open as open_file;
use super::progress::TerminalProgress;
use super::summary::summary;
use super::terminal::{say, say_error};

/// Analyses, writes the results, and prints a summary.
pub(super) fn analyze(arguments: &AnalyzeArguments) -> Result<(), Failure> {
    let (mut study, loaded) = open(arguments)?;
    for caution in &loaded.cautions {
        say_error(&format!("{}: {caution}", loaded.origin));
    }
    take_options(&mut study, arguments)?;
    let inputs = arguments.file.iter().cloned().chain(loaded.origin.file());
    let outputs = OutputSet::new(existing(arguments.force), inputs.collect());
    outputs.check(&result_paths(&arguments.out))?;
    make_directory(&arguments.out)?;
    let mut engine = Engine::with_executor(Box::new(crate::app::Pool));
    let progress = TerminalProgress::new();
    let mut analysis = engine.analyze(&study, &progress)?;
    if arguments.reject_suggested && reject_suggested(&mut study, &analysis)? {
        analysis = engine.analyze(&study, &progress)?;
    }
    drop(progress);
    check_result(&analysis)?;
    let all = analysis.conditions.keys().copied().collect();
    write_results(&analysis, &loaded.sha256, &all, &arguments.out, outputs)?;
    say(&summary(&analysis, &loaded, &arguments.out))
}

fn open(arguments: &AnalyzeArguments) -> Result<(Study, LoadedDataset), Failure> {
    match &arguments.file {
        Some(file) => {
            let (study, loaded, _) = open_file(file, &arguments.opening)?.into_study();
            Ok((study, loaded))
        }
        None => {
            let loaded = embedded_example()?;
            Ok((Study::new(loaded.dataset.clone()), loaded))
        }
    }
}

/// Puts the options into the study, over what it says itself.
fn take_options(study: &mut Study, arguments: &AnalyzeArguments) -> Result<(), Failure> {
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
    if let Some(agreement_db) = arguments.agreement {
        set("--agreement", Setting::Agreement(agreement_db))?;
    }
    if arguments.schedule_delays {
        let schedule = ScheduleSettings { delays: true, ..study.settings.schedule };
        study.apply(&Edit::Set(Setting::Schedule(schedule))).map_err(Failure::refused("--schedule-delays"))?;
    }
    if let Some(degree) = arguments.degree {
        let schedule = ScheduleSettings { kind: ScheduleKind::Polynomial { degree }, ..study.settings.schedule };
        study.apply(&Edit::Set(Setting::Schedule(schedule))).map_err(Failure::refused("--degree"))?;
    }
    if let Some(list) = &arguments.on {
        hold(study, list)?;
    }
    arguments.reject.iter().try_for_each(|rejection| reject(study, rejection))
}

fn hold(study: &mut Study, list: &PairList) -> Result<(), Failure> {
    let dataset = study.dataset.clone();
    let find = |(output, input): &(String, String)| {
        dataset.find_pair(output, input).ok_or_else(|| {
            let names = |channels: &[Channel]| {
                channels.iter().map(|channel| channel.name.as_str()).collect::<Vec<_>>().join(", ")
            };
            let reason = format!(
                "the dataset has no response {output}/{input}; outputs are {}; inputs are {}",
                names(dataset.outputs()),
                names(dataset.inputs())
            );
            Failure::Option { option: "--on", reason }
        })
    };
    let held = list.pairs.iter().map(find).collect::<Result<Vec<_>, _>>()?;
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

/// Refuses an analysis without any result; says which conditions of another have none.
fn check_result(analysis: &Analysis) -> Result<(), Failure> {
    let failures = analysis.study.dataset.conditions().iter().filter_map(|condition| {
        let failure = analysis.conditions.get(&condition.id())?.as_ref().err()?;
        Some(format!("condition {}: {failure}", condition.id()))
    });
    let failures: Vec<String> = failures.collect();
    match failures.first() {
        Some(first) if failures.len() == analysis.conditions.len() => Err(Failure::NoResult { reason: first.clone() }),
        _ => {
            failures.iter().for_each(|failure| say_error(failure));
            Ok(())
        }
    }
}
