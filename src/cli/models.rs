//! `gdcm assemble` and `gdcm convert`: models from files of any supported format.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use indicatif::{ProgressBar, ProgressStyle};

use gdcm_io::files::dataset_file::add_dataset;
use gdcm_io::files::model_collection::add_models;
use gdcm_io::files::rules_file::{add_rules, load_rules, rules_path};
use gdcm_io::files::study_file::relative_folder;
use gdcm_io::formats::sources_folder;
use gdcm_io::import::model_files::{EVERY_TABLE, FoundModels};
use gdcm_io::output_set::OutputSet;
use gdcm_io::{FolderProgress, read_models};
use gdcm_model::assembly::declarations::ChannelDeclarations;
use gdcm_model::assembly::{Assembly, FileScope, FoundModel, Headings, Rules, proposed_rules};
use gdcm_model::message_text::{sanitized, sanitized_path};
use gdcm_model::units::number;
use gdcm_study::results::analysis::ConditionFailure;
use gdcm_words::Table;

use super::arguments::{AssembleArguments, ConvertArguments, OfFiles};
use super::existing;
use super::terminal::{
    Failure, caution, coded_caution, error, indented, note, progress_target, say,
};

/// Progress of reading, shown on a terminal only.
pub(super) struct ReadingProgress {
    bar: ProgressBar,
}

impl ReadingProgress {
    pub(super) fn new() -> Self {
        let bar = ProgressBar::with_draw_target(None, progress_target());
        if let Ok(style) = ProgressStyle::with_template("reading {pos} of {len}: {msg}") {
            bar.set_style(style);
        }
        Self { bar }
    }
}

impl FolderProgress for ReadingProgress {
    fn reading(&self, number: usize, of: usize, name: &str) {
        self.bar.set_length(of as u64);
        self.bar.set_position(number as u64);
        self.bar.set_message(sanitized(name));
    }
}

impl Drop for ReadingProgress {
    fn drop(&mut self) {
        self.bar.finish_and_clear();
    }
}

/// Writes all models in the given files as JSON.
pub(super) fn convert(arguments: &ConvertArguments) -> Result<(), Failure> {
    let mut outputs = OutputSet::new(existing(arguments.force), arguments.files.clone());
    outputs.check(&[&arguments.out])?;
    let found = found_models(&arguments.files, &said_headings(&arguments.headings))?;
    if found.models.is_empty() {
        return Err(Failure::nothing_in(&arguments.files, "model"));
    }
    let models: Vec<FoundModel> = found
        .models
        .into_iter()
        .map(FoundModel::with_names_of_file)
        .collect();
    add_models(&models, &arguments.out, &mut outputs)?;
    outputs.persist()?;
    let lines = models
        .iter()
        .map(|model| format!("{}: {}\n", sanitized(&model.key()), model.words()));
    say(&format!(
        "{}{}: {}\n",
        lines.collect::<String>(),
        sanitized_path(&arguments.out),
        counted(models.len(), "model")
    ))
}

/// Makes a dataset from the models in a folder.
pub(super) fn assemble(arguments: &AssembleArguments) -> Result<(), Failure> {
    check_declared_once(arguments)?;
    let rules_path = arguments
        .rules
        .clone()
        .unwrap_or_else(|| rules_path(&arguments.out));
    let is_proposed = arguments.rules.is_none();
    let mut outputs = OutputSet::new(
        existing(arguments.force),
        arguments.rules.iter().cloned().collect(),
    );
    let mut places: Vec<&Path> = vec![&arguments.out];
    places.extend(is_proposed.then_some(rules_path.as_path()));
    outputs.check(&places)?;
    let said = arguments.rules.as_deref().map(said_rules).transpose()?;
    let mut headings = said
        .as_ref()
        .map(|rules| rules.headings.clone())
        .unwrap_or_default();
    headings.extend(said_headings(&arguments.headings));
    let found = found_models(&arguments.folders, &headings)?;
    let mut rules =
        said.unwrap_or_else(|| proposed_rules(&name_of(&arguments.folders), &found.models));
    rules.headings = headings;
    rules.sample_time_s = arguments.sample_time.or(rules.sample_time_s);
    declare(arguments, &found.models, &mut rules)?;
    let assembly = Assembly::new(found.models, rules);
    say(&table(&assembly))?;
    for caution in assembly.cautions() {
        coded_caution(Some(caution.code()), &[], &assembly.caution_words(&caution));
    }
    if is_proposed {
        add_rules(assembly.rules(), &rules_path, &mut outputs)?;
    }
    let folder = relative_folder(sources_folder(&arguments.folders), &arguments.out);
    let dataset = assembly.dataset(&folder);
    if let Some(dataset) = &dataset {
        let without = dataset.without_reference();
        if !without.is_empty() {
            let failure = ConditionFailure::NoReference;
            coded_caution(Some(failure.code()), &without, &failure.to_string());
        }
        add_dataset(dataset, &arguments.out, &mut outputs)?;
    }
    outputs.persist()?;
    if is_proposed {
        say(&format!(
            "{}: the rules proposed; correct them and give them with --rules\n",
            sanitized_path(&rules_path)
        ))?;
    }
    match dataset {
        Some(dataset) => {
            let conditions = counted(dataset.conditions().len(), "condition");
            say(&format!(
                "{}: {conditions}\n",
                sanitized_path(&arguments.out)
            ))
        }
        None => {
            let problems = assembly.problem_lines();
            for problem in &problems {
                error(&problem.text);
            }
            Err(Failure::Incomplete {
                count: problems.len(),
                rules: sanitized_path(&rules_path),
            })
        }
    }
}

/// Loads the rules from a file; prints their cautions on standard error.
fn said_rules(path: &Path) -> Result<Rules, Failure> {
    let (rules, cautions) = load_rules(path)?;
    cautions
        .iter()
        .for_each(|words| caution(&format!("{}: {words}", path.display())));
    Ok(rules)
}

/// Rejects duplicate declarations for a channel of the same models.
fn check_declared_once(arguments: &AssembleArguments) -> Result<(), Failure> {
    let mut signs = BTreeSet::new();
    for OfFiles { channel, of, .. } in &arguments.sign {
        if !signs.insert((channel, of)) {
            return Err(Failure::option(
                "--sign",
                format!("{channel} of {of} stands twice"),
            ));
        }
    }
    let mut conversions = BTreeSet::new();
    let of_units = arguments
        .unit
        .iter()
        .map(|unit| ("--unit", &unit.channel, &unit.of));
    let of_factors = arguments
        .factor
        .iter()
        .map(|factor| ("--factor", &factor.channel, &factor.of));
    for (option, channel, of) in of_units.chain(of_factors) {
        if !conversions.insert((channel, of)) {
            return Err(Failure::option(
                option,
                format!("{channel} of {of} has a unit or a factor already"),
            ));
        }
    }
    Ok(())
}

/// Adds the units, factors and signs of the command line to the rules.
fn declare(
    arguments: &AssembleArguments,
    models: &[FoundModel],
    rules: &mut Rules,
) -> Result<(), Failure> {
    for OfFiles { channel, said, of } in &arguments.unit {
        let units = [(channel.clone(), said.clone())].into();
        let declared = ChannelDeclarations {
            units,
            ..ChannelDeclarations::default()
        };
        check_declared("--unit", channel, of, models, rules)?;
        declare_of(of, &declared, models, rules);
    }
    for OfFiles { channel, said, of } in &arguments.factor {
        let factors = [(channel.clone(), *said)].into();
        let declared = ChannelDeclarations {
            factors,
            ..ChannelDeclarations::default()
        };
        check_declared("--factor", channel, of, models, rules)?;
        declare_of(of, &declared, models, rules);
    }
    for OfFiles { channel, said, of } in &arguments.sign {
        let signs = [(channel.clone(), *said)].into();
        let declared = ChannelDeclarations {
            signs,
            ..ChannelDeclarations::default()
        };
        check_declared("--sign", channel, of, models, rules)?;
        declare_of(of, &declared, models, rules);
    }
    Ok(())
}

/// Adds a declaration to the rules of a single model, or to the rules of a scope.
fn declare_of(
    of: &FileScope,
    declared: &ChannelDeclarations,
    models: &[FoundModel],
    rules: &mut Rules,
) {
    match of {
        FileScope::Files(key) if models.iter().any(|model| model.key() == *key) => {
            rules.rows.entry(key.clone()).or_default().declare(declared);
        }
        _ => rules.declare(of.clone(), declared),
    }
}

/// Rejects an option for a channel missing from the dataset, or for files that were not read.
fn check_declared(
    option: &'static str,
    channel: &str,
    of: &FileScope,
    models: &[FoundModel],
    rules: &Rules,
) -> Result<(), Failure> {
    let mut channels = rules.inputs.iter().chain(&rules.outputs);
    if !channels.any(|rule| rule.name == channel) {
        let names: Vec<&str> = rules
            .inputs
            .iter()
            .chain(&rules.outputs)
            .map(|rule| rule.name.as_str())
            .collect();
        let reason = format!(
            "the dataset has no channel {channel}; it has {}",
            names.join(", ")
        );
        return Err(Failure::option(option, reason));
    }
    if let FileScope::Files(pattern) = of
        && !models.iter().any(|model| of.holds(model, None))
    {
        let reason = format!(
            "{channel}: no model is in \"{pattern}\"; models are named as in the last column, file"
        );
        return Err(Failure::option(option, reason));
    }
    Ok(())
}

/// Reads the models from files and folders; reports skipped content on standard error.
fn found_models(paths: &[PathBuf], headings: &Headings) -> Result<FoundModels, Failure> {
    let found = read_models(paths, headings, &ReadingProgress::new())?;
    found
        .faults
        .iter()
        .for_each(|fault| caution(&format!("not taken: {fault}")));
    found
        .ignored
        .iter()
        .for_each(|words| note(&format!("no model: {words}")));
    for words in found.unused_words() {
        note(&words);
    }
    Ok(found)
}

/// Applies the headings to every table with the same number of columns.
fn said_headings(headings: &[String]) -> Headings {
    let said: Vec<String> = headings
        .iter()
        .map(|heading| heading.trim().to_owned())
        .collect();
    if said.is_empty() {
        Headings::new()
    } else {
        Headings::from([(EVERY_TABLE.to_owned(), said)])
    }
}

fn name_of(folders: &[PathBuf]) -> String {
    let name = folders.first().and_then(|folder| folder.file_name());
    name.map_or_else(String::new, |name| name.to_string_lossy().into_owned())
}

/// Returns a table with one line for each model and its role in the dataset.
fn table(assembly: &Assembly) -> String {
    let mut table = Table::new(
        "",
        [
            "condition",
            "role",
            "name",
            "airspeed",
            "altitude",
            "weight",
            "trim",
            "file",
        ],
    );
    for part in assembly.parts() {
        let row = &part.row;
        let or_dash = |text: Option<String>| text.unwrap_or_else(|| "?".to_owned());
        let trim = row
            .perturbation
            .iter()
            .map(|(coordinate, by)| format!("{coordinate} {}", number(*by)));
        table.row([
            or_dash(row.condition.map(|condition| condition.to_string())),
            if row.left_out {
                "left out".to_owned()
            } else {
                or_dash(row.role.map(|role| role.word().to_owned()))
            },
            sanitized(&row.name),
            or_dash(row.airspeed_words()),
            row.altitude_words(),
            row.weight_words(),
            trim.collect::<Vec<_>>().join(", "),
            sanitized(&part.found.key()),
        ]);
    }
    indented(&table, 0)
}

pub(super) fn counted(count: usize, what: &str) -> String {
    if count == 1 {
        format!("1 {what}")
    } else {
        format!("{count} {what}s")
    }
}
