//! The study analysed by a command, as modified by the options on the command line.

use std::path::Path;
use std::sync::Arc;

use gdcm_io::files::levels_and_tolerances::{load_tolerances, read_levels};
use gdcm_io::files::standard_levels::StandardLevels;
use gdcm_io::output_set::OutputSet;
use gdcm_io::{FileError, LoadedDataset, embedded_example};
use gdcm_method::correction;
use gdcm_method::requirements::LevelBoundaries;
use gdcm_model::dataset::{BundleKind, Channel, ConditionId, ModelId};
use gdcm_model::message_text::sanitized;
use gdcm_study::decisions::requirement_settings::{RequirementPart, RequirementSettings};
use gdcm_study::decisions::setting_table;
use gdcm_study::{Edit, Study};

use super::channel_values::{ChannelSign, ChannelValue, first_duplicate};
use super::condition_messages::listed_conditions;
use super::dataset_lookup::{condition_ids, model_names, pairs_of};
use super::failure::Failure;
use super::option_values::{PairName, Rejection};
use super::parameter_values::apply_parameters;
use super::study_arguments::{GivenSetting, StudyArguments};
use super::terminal::caution;
use super::{existing, open};

/// The study that a command analyses, with its files.
pub(super) struct CommandStudy {
    pub(super) study: Study,
    /// Dataset as loaded from the file, before options are applied.
    pub(super) loaded: LoadedDataset,
    /// Output files, which never overwrite the inputs.
    pub(super) outputs: OutputSet,
}

impl CommandStudy {
    /// Opens the study and its dataset, and applies the options. Cautions about the files are
    /// reported on standard error.
    pub(super) fn open(arguments: &StudyArguments, force: bool) -> Result<Self, Failure> {
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
        for found in &loaded.cautions {
            caution(found.code(), &format!("{}: {found}", loaded.origin));
        }
        apply_options(&mut study, arguments)?;
        let inputs = [&arguments.file, &arguments.tolerances]
            .into_iter()
            .flatten()
            .chain(&arguments.levels)
            .cloned()
            .chain(loaded.origin.file())
            .collect();
        Ok(Self {
            study,
            loaded,
            outputs: OutputSet::new(existing(force), inputs),
        })
    }
}

/// Applies an edit requested by an option.
pub(super) fn apply(study: &mut Study, option: &'static str, edit: &Edit) -> Result<(), Failure> {
    study
        .apply(edit)
        .map_err(|refusal| Failure::option(option, refusal))
}

/// Applies the options to the study; they override its decisions. Later options build on earlier
/// ones:
///
/// 1. settings (with `--physics`), then values of physics parameters, which may switch the
///    parameters on;
/// 2. signs; held-out conditions; requirements;
/// 3. a check of the second scheduling variable in the conditions that are left in the schedule;
/// 4. constrained responses; rejected models.
pub(super) fn apply_options(study: &mut Study, arguments: &StudyArguments) -> Result<(), Failure> {
    // Step 1.
    for GivenSetting { setting, words } in &arguments.settings.given {
        let option = setting.option;
        let words: Vec<&str> = words.iter().map(String::as_str).collect();
        let value = setting
            .read(&words)
            .map_err(|reason| Failure::option(option, sanitized(&reason)))?;
        apply(study, option, &setting.to(value))?;
    }
    let is_physics_given = arguments
        .settings
        .given
        .iter()
        .any(|given| *given.setting == setting_table::PHYSICS);
    apply_parameters(study, &arguments.parameter, is_physics_given)?;
    // Step 2.
    apply_signs(study, &arguments.sign)?;
    for &id in &arguments.hold_out {
        let edit = Edit::SetHeldOut {
            condition: ConditionId(id),
            held_out: true,
        };
        apply(study, "--hold-out", &edit)?;
    }
    apply_requirements(study, arguments)?;
    // Step 3.
    check_second_variable(study)?;
    // Step 4.
    if let Some(list) = &arguments.on {
        constrain(study, list)?;
    }
    for rejection in &arguments.reject {
        reject(study, rejection)?;
    }
    Ok(())
}

/// Applies the options about requirements; they override the study's settings. Levels for a channel
/// that the dataset lacks are a caution only.
fn apply_requirements(study: &mut Study, arguments: &StudyArguments) -> Result<(), Failure> {
    let mut settings = RequirementSettings::clone(&study.requirements);
    let (_, outputs) = study.dataset.input_and_output_names();
    for name in &arguments.attitude_command {
        if !outputs.contains(name) {
            let reason = sanitized(&format!(
                "expected one of {}, found {name}",
                outputs.join(", ")
            ));
            return Err(Failure::coded_option(
                "--attitude-command",
                "unknown-channel",
                reason,
            ));
        }
        settings.attitude_command.insert(name.clone());
    }
    for path in &arguments.levels {
        let levels = read_levels_or_standard(path, study.dataset.outputs())?;
        settings.levels = settings.levels.replaced_by(&levels);
    }
    let unknown = settings.levels.unknown_axes(&outputs);
    if !arguments.levels.is_empty() && !unknown.is_empty() {
        let text = format!(
            "levels for {} are not used: the dataset has no such output; outputs are {}",
            unknown.join(", "),
            outputs.join(", ")
        );
        caution("levels-of-unknown-channel", &sanitized(&text));
    }
    if let Some(path) = &arguments.tolerances {
        let (tolerances, cautions) = load_tolerances(path)?;
        for words in cautions {
            caution("tolerance-file", &format!("{}: {words}", path.display()));
        }
        settings.tolerances = tolerances;
    }
    if settings != *study.requirements {
        let edit = Edit::SetRequirements(RequirementPart::Options, Arc::new(settings));
        apply(study, "--levels", &edit)?;
    }
    Ok(())
}

/// Returns the level boundaries with this name, or those in this file.
fn read_levels_or_standard(path: &Path, outputs: &[Channel]) -> Result<LevelBoundaries, FileError> {
    match path.to_str().and_then(StandardLevels::named) {
        Some(standard) => standard.boundaries(outputs),
        None => read_levels(path),
    }
}

/// Rejects a second variable for which a scheduled condition has no value. Checked in advance,
/// because the schedule could not be fitted after the analysis.
fn check_second_variable(study: &Study) -> Result<(), Failure> {
    let Some(variable) = study.settings.schedule.second else {
        return Ok(());
    };
    let mut lacking: Vec<ConditionId> = Vec::new();
    for condition in study.dataset.conditions() {
        let choice = study.choice(condition.id());
        let is_scheduled = choice.scheduled && !choice.held_out;
        if is_scheduled && variable.value(condition.flight_state()).is_none() {
            lacking.push(condition.id());
        }
    }
    if lacking.is_empty() {
        return Ok(());
    }
    let reason = format!(
        "a schedule of airspeed and {variable} needs the {variable} [{}] of every scheduled condition; the dataset lacks it for {}",
        variable.unit(),
        listed_conditions(&lacking)
    );
    Err(Failure::coded_option(
        "--second-variable",
        "missing-variable",
        reason,
    ))
}

/// Inverts the channels given by `--sign`, or restores their signs. An input and an output may have
/// the same name: such a name is refused.
pub(super) fn apply_signs(study: &mut Study, signs: &[ChannelSign]) -> Result<(), Failure> {
    const OPTION: &str = "--sign";
    if let Some(channel) = first_duplicate(signs) {
        return Err(Failure::given_twice(OPTION, &sanitized(channel)));
    }
    for ChannelValue {
        channel: name,
        value: role,
    } in signs
    {
        let (inputs, outputs) = study.dataset.input_and_output_names();
        let named: Vec<correction::Channel> =
            correction::Channel::inputs_then_outputs(inputs.len(), outputs.len())
                .filter(|channel| channel.name(&inputs, &outputs) == *name)
                .collect();
        let [channel] = named[..] else {
            let names = [inputs, outputs].concat().join(", ");
            let reason = if named.is_empty() {
                format!("the dataset has no channel {name}; channels are {names}")
            } else {
                format!(
                    "{} channels are called {name}, so the name does not tell which one is meant; \
                    reverse the sign in a study instead",
                    named.len()
                )
            };
            let reason = sanitized(&reason);
            return Err(Failure::coded_option(OPTION, "unknown-channel", reason));
        };
        apply(
            study,
            OPTION,
            &Edit::SetSign {
                channel,
                role: *role,
            },
        )?;
    }
    Ok(())
}

/// Constrains the listed responses and releases all others: `on_axis().pairs()` lists every
/// response, whether on-axis or not.
fn constrain(study: &mut Study, list: &[PairName]) -> Result<(), Failure> {
    let dataset = study.dataset.clone();
    let constrained = pairs_of(&dataset, list, "--on")?;
    for pair in dataset.on_axis().pairs() {
        let edit = Edit::Hold(pair, constrained.contains(&pair));
        apply(study, "--on", &edit)?;
    }
    Ok(())
}

/// Rejects a model by its name, which must be unique among both bundles of the condition.
fn reject(study: &mut Study, rejection: &Rejection) -> Result<(), Failure> {
    const OPTION: &str = "--reject";
    let id = ConditionId(rejection.condition);
    let name = rejection.model.as_str();
    let Some(condition) = study.dataset.condition(id) else {
        let ids = condition_ids(&study.dataset);
        let reason = format!("the dataset has no condition {id}; conditions are {ids}");
        return Err(Failure::coded_option(OPTION, "unknown-condition", reason));
    };
    let bundles: Vec<BundleKind> = BundleKind::BOTH
        .into_iter()
        .filter(|bundle| condition.position(*bundle, name).is_some())
        .collect();
    match bundles[..] {
        [bundle] => {
            let model = ModelId::new(id, bundle, name);
            apply(study, OPTION, &Edit::Reject(model))
        }
        [] => {
            let reason = sanitized(&format!(
                "condition {id} has no model \"{name}\"; physics models: {}; identified models: {}",
                model_names(condition, BundleKind::Physics),
                model_names(condition, BundleKind::Identified)
            ));
            Err(Failure::coded_option(OPTION, "unknown-model", reason))
        }
        _ => {
            let reason = format!(
                "\"{name}\" is both a physics and an identified model of condition {id}; reject \
                the model in a study instead"
            );
            Err(Failure::coded_option(OPTION, "ambiguous-model", reason))
        }
    }
}
