//! `gdcm assemble`: makes a dataset from model files.
//!
//! *Rules* say what each model found in a file is: condition, role, channels, units, signs. They
//! are proposed from the files, corrected by the engineer in a rules file, and overridden by
//! options. The rules have a row for each model, a *part* is a model with its row.

use std::path::{Path, PathBuf};

use gdcm_io::files::dataset_file::add_dataset;
use gdcm_io::files::rules_file::{add_rules, load_rules, rules_path};
use gdcm_io::formats::sources_folder;
use gdcm_io::output_set::OutputSet;
use gdcm_io::relative_folder::relative_folder;
use gdcm_model::assembly::{Assembly, Rules, proposed_rules};
use gdcm_model::dataset::Dataset;
use gdcm_model::message_text::{sanitized, sanitized_path};
use gdcm_model::number_format::counted;
use gdcm_model::units::number;
use gdcm_study::results::analysis::ConditionFailure;
use gdcm_words::Table;

use super::channel_declarations::{check_declared_once, declare};
use super::existing;
use super::failure::Failure;
use super::found_models::{found_models, given_headings};
use super::model_arguments::AssembleArguments;
use super::printed_lines::indented;
use super::terminal::{self, caution, caution_for, error, print};

/// Assembles a dataset from the models in files and folders.
///
/// 1. Checks declarations and output files: the dataset and, unless rules are given, a file for the
///    proposed rules.
/// 2. Reads the models, applies the rules, and prints a table of the models, and the cautions.
/// 3. Writes the proposed rules, and the dataset if the rules are complete.
///
/// # Errors
/// An option or a file is wrong. The rules are incomplete: the missing items are printed first.
pub(super) fn assemble(arguments: &AssembleArguments) -> Result<(), Failure> {
    // Step 1.
    check_declared_once(arguments)?;
    let given_rules = arguments.rules.as_deref();
    let proposed_path = match given_rules {
        Some(_) => None,
        None => Some(rules_path(&arguments.out)),
    };
    let inputs = given_rules.iter().map(|path| path.to_path_buf()).collect();
    let mut outputs = OutputSet::new(existing(arguments.force), inputs);
    let mut places: Vec<&Path> = vec![&arguments.out];
    places.extend(proposed_path.as_deref());
    outputs.check(&places)?;
    // Step 2.
    let assembly = assembled_models(arguments)?;
    print(&model_table(&assembly))?;
    for caution in assembly.cautions() {
        terminal::caution(caution.code(), &assembly.caution_words(&caution));
    }
    // Step 3.
    if let Some(path) = &proposed_path {
        add_rules(assembly.rules(), path, &mut outputs)?;
    }
    let folder = relative_folder(sources_folder(&arguments.folders), &arguments.out);
    let dataset = assembly.dataset(&folder);
    if let Some(dataset) = &dataset {
        report_missing_references(dataset);
        add_dataset(dataset, &arguments.out, &mut outputs)?;
    }
    outputs.persist()?;
    if let Some(path) = &proposed_path {
        print(&format!(
            "{}: the proposed rules; correct them and pass them with --rules\n",
            sanitized_path(path)
        ))?;
    }
    match dataset {
        Some(dataset) => {
            let conditions = counted(dataset.conditions().len(), "condition");
            let path = sanitized_path(&arguments.out);
            print(&format!("{path}: {conditions}\n"))
        }
        None => {
            let problems = assembly.problem_lines();
            for problem in &problems {
                error(problem.code, &problem.text);
            }
            let path = given_rules.or(proposed_path.as_deref());
            Err(Failure::Incomplete {
                count: problems.len(),
                rules: sanitized_path(path.unwrap_or(Path::new(""))),
            })
        }
    }
}

/// Reads the models, and applies the rules from a file (proposed rules if none is given) together
/// with the declarations on the command line, which override them: column headings, with which the
/// files are read, sample time, units, factors and signs.
pub(super) fn assembled_models(arguments: &AssembleArguments) -> Result<Assembly, Failure> {
    let given = match &arguments.rules {
        Some(path) => Some(rules_of_file(path)?),
        None => None,
    };
    let mut headings = match &given {
        Some(rules) => rules.headings.clone(),
        None => Default::default(),
    };
    headings.extend(given_headings(&arguments.headings));
    let found = found_models(&arguments.folders, &headings)?;
    let mut rules = match given {
        Some(rules) => rules,
        None => proposed_rules(&dataset_name(&arguments.folders), &found.models),
    };
    rules.headings = headings;
    if let Some(sample_time_s) = arguments.sample_time {
        rules.sample_time_s = Some(sample_time_s);
    }
    declare(arguments, &found.models, &mut rules)?;
    Ok(Assembly::new(found.models, rules))
}

/// Loads the rules from a file; prints the cautions about it on standard error.
fn rules_of_file(path: &Path) -> Result<Rules, Failure> {
    let (rules, cautions) = load_rules(path)?;
    for words in cautions {
        caution("rules-file", &format!("{}: {words}", path.display()));
    }
    Ok(rules)
}

/// Reports the conditions that have no identified model, which is needed as the reference.
pub(super) fn report_missing_references(dataset: &Dataset) {
    let without = dataset.without_reference();
    if !without.is_empty() {
        let failure = ConditionFailure::NoReference;
        caution_for(failure.code(), &without, &failure.to_string());
    }
}

/// Returns the default name for the dataset: that of the first folder; empty without a folder.
fn dataset_name(folders: &[PathBuf]) -> String {
    match folders.first().and_then(|folder| folder.file_name()) {
        Some(name) => name.to_string_lossy().into_owned(),
        None => String::new(),
    }
}

/// Returns a table with each model's condition, role, flight state and file.
fn model_table(assembly: &Assembly) -> String {
    let headings = [
        "condition",
        "role",
        "name",
        "airspeed",
        "altitude",
        "weight",
        "trim",
        "file",
    ];
    let mut table = Table::new("", headings);
    for part in assembly.parts() {
        let row = &part.row;
        let role = if row.left_out {
            "left out".to_owned()
        } else {
            or_unknown(row.role.map(|role| role.word().to_owned()))
        };
        let trim: Vec<String> = row
            .perturbation
            .iter()
            .map(|(coordinate, by)| format!("{coordinate} {}", number(*by)))
            .collect();
        table.row([
            or_unknown(row.condition.map(|condition| condition.to_string())),
            role,
            sanitized(&row.name),
            or_unknown(row.airspeed_words()),
            row.altitude_words(),
            row.weight_words(),
            trim.join(", "),
            sanitized(&part.found.key()),
        ]);
    }
    indented(&table, 0)
}

fn or_unknown(text: Option<String>) -> String {
    text.unwrap_or_else(|| "?".to_owned())
}
