//! The study of a command, with the options of the command line applied.

use std::sync::Arc;

use gdcm_io::files::requirements_file::{load_tolerances, read_levels};
use gdcm_io::output_set::OutputSet;
use gdcm_io::{LoadedDataset, embedded_example};
use gdcm_method::correction;
use gdcm_model::dataset::{BundleKind, Channel, ConditionId, Dataset, ModelId, Pair};
use gdcm_model::message_text::sanitized;
use gdcm_study::decisions::requirement_settings::RequirementSettings;
use gdcm_study::results::analysis::ConditionFailure;
use gdcm_study::{Analysis, Edit, Engine, Study};
use gdcm_words::caution::failure_text;

use super::arguments::{ChannelSign, OfChannel, Rejection, StudyArguments};
use super::identify_arguments::said_twice;
use super::terminal::{
    Failure, TerminalProgress, by_words, caution, coded_caution, listed_conditions, of_conditions,
};
use super::{existing, open};
use crate::executor::Pool;

/// Opens the study and its dataset, and prepares the output files, which never overwrite the
/// inputs. Reports the file's cautions on standard error.
pub(super) fn study_of(
    arguments: &StudyArguments,
    force: bool,
) -> Result<(Study, LoadedDataset, OutputSet), Failure> {
    let (mut study, loaded) = match &arguments.file {
        Some(file) => {
            let (study, loaded, _) = open(file, &arguments.opening)?.into_study();
            (study, loaded)
        }
        None => {
            let loaded = embedded_example()?;
            (Study::new(loaded.dataset.clone()), loaded)
        }
    };
    for words in &loaded.cautions {
        caution(&format!("{}: {words}", loaded.origin));
    }
    take_options(&mut study, arguments)?;
    let inputs = [&arguments.file, &arguments.levels, &arguments.tolerances]
        .into_iter()
        .flatten()
        .cloned()
        .chain(loaded.origin.file())
        .collect();
    Ok((study, loaded, OutputSet::new(existing(force), inputs)))
}

/// Analyses a study, after rejecting the suggested outliers if requested; returns the analysis and
/// its engine. `with_bars` requests error bars. Reports conditions without a result on standard
/// error.
///
/// # Errors
/// No condition has a result.
pub(super) fn analysis_of(
    mut study: Study,
    arguments: &StudyArguments,
    with_bars: bool,
) -> Result<(Analysis, Engine), Failure> {
    let mut engine = Engine::with_executor(Box::new(Pool));
    let progress = TerminalProgress::new("analysing");
    let mut analysis = engine.analyze(&study, &progress)?;
    if arguments.reject_suggested && reject_suggested(&mut study, &analysis)? {
        analysis = engine.analyze(&study, &progress)?;
    }
    if with_bars {
        analysis.uncertainty = Some(Arc::new(engine.uncertainty(&analysis, &progress)?));
        let assessed = engine.assess_couplings(&study, study.settings.couplings, &progress)?;
        analysis.coupling_assessment = assessed.and_then(Result::ok);
    }
    drop(progress);
    let failures = analysis
        .conditions
        .iter()
        .filter_map(|(id, outcome)| Some((*id, outcome.as_ref().err()?)));
    let failures: Vec<(ConditionId, &ConditionFailure)> = failures.collect();
    let told = by_words(
        failures
            .iter()
            .map(|(id, failure)| (*id, failure_text(failure, &analysis.study.dataset))),
    );
    if let Some((conditions, first)) = told
        .first()
        .filter(|_| failures.len() == analysis.conditions.len())
    {
        return Err(Failure::NoResult {
            reason: of_conditions(conditions, first),
        });
    }
    for (conditions, words) in &told {
        let of_words = failures.iter().find(|(id, _)| conditions.contains(id));
        coded_caution(
            of_words.map(|(_, failure)| failure.code()),
            conditions,
            words,
        );
    }
    Ok((analysis, engine))
}

/// Returns the condition with the id given by an option.
pub(super) fn condition_of(dataset: &Dataset, id: i64) -> Result<ConditionId, Failure> {
    let found = dataset
        .condition(ConditionId(id))
        .map(|condition| condition.id());
    found.ok_or_else(|| {
        let reason = format!("the dataset has no condition {id}; it has {}", ids(dataset));
        Failure::option("--condition", reason)
    })
}

/// Joins the ids of the conditions with commas.
pub(super) fn ids(dataset: &Dataset) -> String {
    let ids: Vec<String> = dataset
        .conditions()
        .iter()
        .map(|condition| condition.id().to_string())
        .collect();
    ids.join(", ")
}

/// Applies a decision requested by an option.
fn apply(study: &mut Study, option: &'static str, edit: &Edit) -> Result<(), Failure> {
    study
        .apply(edit)
        .map_err(|refusal| Failure::option(option, refusal))
}

/// Applies the options to the study; they override the study's own settings.
fn take_options(study: &mut Study, arguments: &StudyArguments) -> Result<(), Failure> {
    for (setting, words) in &arguments.settings.said {
        let option = setting.option;
        let words: Vec<&str> = words.iter().map(String::as_str).collect();
        let value = setting
            .read(&words)
            .map_err(|reason| Failure::option(option, sanitized(&reason)))?;
        apply(study, option, &setting.to(value))?;
    }
    turn(study, &arguments.sign)?;
    for &id in &arguments.hold_out {
        apply(
            study,
            "--hold-out",
            &Edit::SetHeldOut {
                condition: ConditionId(id),
                held_out: true,
            },
        )?;
    }
    require(study, arguments)?;
    check_second_variable(study)?;
    if let Some(list) = &arguments.on {
        hold(study, list)?;
    }
    arguments
        .reject
        .iter()
        .try_for_each(|rejection| reject(study, rejection))
}

/// Applies the options about requirements, which override the study's own.
fn require(study: &mut Study, arguments: &StudyArguments) -> Result<(), Failure> {
    let mut settings = RequirementSettings::clone(&study.requirements);
    let (_, outputs) = study.dataset.names_of_channels();
    for name in &arguments.attitude_command {
        if !outputs.contains(name) {
            let reason = sanitized(&format!(
                "expected one of {}, found {name}",
                outputs.join(", ")
            ));
            return Err(Failure::option("--attitude-command", reason));
        }
        settings.attitude_command.insert(name.clone());
    }
    if let Some(path) = &arguments.levels {
        settings.levels = read_levels(path)?;
        let unknown = settings.levels.unknown_axes(&outputs);
        if !unknown.is_empty() {
            let unknown = unknown.join(", ");
            let outputs = outputs.join(", ");
            caution(&sanitized(&format!(
                "levels of {unknown} are drawn nowhere: outputs are {outputs}"
            )));
        }
    }
    if let Some(path) = &arguments.tolerances {
        let (tolerances, cautions) = load_tolerances(path)?;
        cautions
            .iter()
            .for_each(|words| caution(&format!("{}: {words}", path.display())));
        settings.tolerances = tolerances;
    }
    if settings != *study.requirements {
        apply(
            study,
            "--levels",
            &Edit::SetRequirements("options", Arc::new(settings)),
        )?;
    }
    Ok(())
}

/// Rejects a second variable that a scheduled condition lacks: the schedule would be missing after
/// all the work.
fn check_second_variable(study: &Study) -> Result<(), Failure> {
    let Some(variable) = study.settings.schedule.second else {
        return Ok(());
    };
    let is_scheduled = |id| study.choice(id).scheduled && !study.choice(id).held_out;
    let lacking = study
        .dataset
        .conditions()
        .iter()
        .filter(|of| variable.value(of.flight_state()).is_none());
    let lacking: Vec<ConditionId> = lacking
        .map(|of| of.id())
        .filter(|id| is_scheduled(*id))
        .collect();
    if lacking.is_empty() {
        return Ok(());
    }
    let unit = variable.unit();
    let of = listed_conditions(&lacking);
    let reason = format!(
        "a schedule of airspeed and {variable} needs the {variable} [{unit}] of every scheduled condition, and the dataset does not \
         say that of {of}"
    );
    Err(Failure::option("--second-variable", reason))
}

/// Inverts the channels whose signs an option declares, or restores them.
pub(super) fn turn(study: &mut Study, signs: &[ChannelSign]) -> Result<(), Failure> {
    const OPTION: &str = "--sign";
    if let Some(channel) = said_twice(signs) {
        return Err(Failure::option(
            OPTION,
            sanitized(&format!("{channel} stands twice")),
        ));
    }
    for OfChannel {
        channel: name,
        said: of,
    } in signs
    {
        let (inputs, outputs) = study.dataset.names_of_channels();
        let all = correction::Channel::all(inputs.len(), outputs.len());
        let named: Vec<correction::Channel> = all
            .filter(|channel| channel.name(&inputs, &outputs) == *name)
            .collect();
        let [channel] = named[..] else {
            let found = named.len();
            let all = [inputs, outputs].concat().join(", ");
            let reason = sanitized(&format!(
                "expected one of {all}; {found} channels are called {name}"
            ));
            return Err(Failure::option(OPTION, reason));
        };
        apply(study, OPTION, &Edit::SetSign { channel, of: *of })?;
    }
    Ok(())
}

/// Returns the responses listed in an option.
pub(super) fn pairs_of(
    dataset: &Dataset,
    list: &[(String, String)],
    option: &'static str,
) -> Result<Vec<Pair>, Failure> {
    let find = |(output, input): &(String, String)| {
        dataset.find_pair(output, input).ok_or_else(|| {
            let reason = format!(
                "the dataset has no response {output}/{input}; outputs are {}; inputs are {}",
                names(dataset.outputs()),
                names(dataset.inputs())
            );
            Failure::option(option, reason)
        })
    };
    list.iter().map(find).collect()
}

/// Joins the names of channels with commas.
pub(super) fn names(channels: &[Channel]) -> String {
    channels
        .iter()
        .map(|channel| channel.name.as_str())
        .collect::<Vec<_>>()
        .join(", ")
}

fn hold(study: &mut Study, list: &[(String, String)]) -> Result<(), Failure> {
    let dataset = study.dataset.clone();
    let held = pairs_of(&dataset, list, "--on")?;
    for pair in dataset.on_axis().pairs() {
        apply(study, "--on", &Edit::Hold(pair, held.contains(&pair)))?;
    }
    Ok(())
}

fn reject(study: &mut Study, rejection: &Rejection) -> Result<(), Failure> {
    let Rejection {
        condition: id,
        model: name,
    } = rejection;
    let wrong = |reason: String| Failure::option("--reject", reason);
    let id = ConditionId(*id);
    let condition = study.dataset.condition(id);
    let condition = condition.ok_or_else(|| wrong(format!("the dataset has no condition {id}")))?;
    let find = |bundle| {
        condition
            .position(bundle, name)
            .map(|_| ModelId::new(id, bundle, name))
    };
    let model = match (find(BundleKind::Physics), find(BundleKind::Identified)) {
        (Some(model), None) | (None, Some(model)) => model,
        (None, None) => return Err(wrong(format!("condition {id} has no model \"{name}\""))),
        (Some(_), Some(_)) => {
            let reason = format!(
                "\"{name}\" is both a physics and an identified model of condition {id}; use a study"
            );
            return Err(wrong(reason));
        }
    };
    apply(study, "--reject", &Edit::Reject(model))
}

/// Rejects the suggested outliers; returns whether anything changed.
fn reject_suggested(study: &mut Study, analysis: &Analysis) -> Result<bool, Failure> {
    let before = study.clone();
    for (&condition, result) in &analysis.conditions {
        let models = result
            .as_ref()
            .map(|result| result.suggested())
            .unwrap_or_default();
        apply(
            study,
            "--reject-suggested",
            &Edit::reject_physics(condition, &models),
        )?;
    }
    Ok(*study != before)
}
