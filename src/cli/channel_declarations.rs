//! Units, factors and signs that options for `gdcm assemble` declare for channels, added to the
//! rules. The *scope* of a declaration is the set of models to which it applies: all, the physics
//! or the identified models, or the models of some files. A model's *key* names its file, and the
//! model within it: "c03/roll+5.mat#sys".

use std::collections::BTreeSet;

use gdcm_model::assembly::declarations::ChannelDeclarations;
use gdcm_model::assembly::{FileScope, FoundModel, Rules};

use super::failure::Failure;
use super::file_values::FileValue;
use super::model_arguments::AssembleArguments;

/// Rejects a second sign for a channel in the same models, and a second unit or factor: a unit and
/// a factor exclude each other.
pub(super) fn check_declared_once(arguments: &AssembleArguments) -> Result<(), Failure> {
    let mut signs = BTreeSet::new();
    for FileValue { channel, scope, .. } in &arguments.sign {
        if !signs.insert((channel, scope)) {
            let subject = format!("{channel} of {scope}");
            return Err(Failure::given_twice("--sign", &subject));
        }
    }
    let mut conversions = BTreeSet::new();
    for FileValue { channel, scope, .. } in &arguments.unit {
        if !conversions.insert((channel, scope)) {
            return Err(converted_already("--unit", channel, scope));
        }
    }
    for FileValue { channel, scope, .. } in &arguments.factor {
        if !conversions.insert((channel, scope)) {
            return Err(converted_already("--factor", channel, scope));
        }
    }
    Ok(())
}

fn converted_already(option: &'static str, channel: &str, scope: &FileScope) -> Failure {
    let reason = format!("{channel} of {scope} already has a unit or a factor");
    Failure::coded_option(option, "given-twice", reason)
}

/// Adds the units, factors and signs given on the command line to the rules.
pub(super) fn declare(
    arguments: &AssembleArguments,
    models: &[FoundModel],
    rules: &mut Rules,
) -> Result<(), Failure> {
    for unit in &arguments.unit {
        let declared = ChannelDeclarations {
            units: [(unit.channel.clone(), unit.value.clone())].into(),
            ..ChannelDeclarations::default()
        };
        check_declared("--unit", unit, models, rules)?;
        declare_for_scope(&unit.scope, &declared, models, rules);
    }
    for factor in &arguments.factor {
        let declared = ChannelDeclarations {
            factors: [(factor.channel.clone(), factor.value)].into(),
            ..ChannelDeclarations::default()
        };
        check_declared("--factor", factor, models, rules)?;
        declare_for_scope(&factor.scope, &declared, models, rules);
    }
    for sign in &arguments.sign {
        let declared = ChannelDeclarations {
            signs: [(sign.channel.clone(), sign.value)].into(),
            ..ChannelDeclarations::default()
        };
        check_declared("--sign", sign, models, rules)?;
        declare_for_scope(&sign.scope, &declared, models, rules);
    }
    Ok(())
}

/// Adds a declaration to a single model's rules if `scope` is its key, otherwise to the rules for
/// the scope.
fn declare_for_scope(
    scope: &FileScope,
    declared: &ChannelDeclarations,
    models: &[FoundModel],
    rules: &mut Rules,
) {
    match scope {
        FileScope::Files(key) if models.iter().any(|model| model.key() == *key) => {
            rules.rows.entry(key.clone()).or_default().declare(declared);
        }
        _ => rules.declare(scope.clone(), declared),
    }
}

/// Rejects a declaration for a channel that the dataset lacks, or for files that were not read.
fn check_declared<T>(
    option: &'static str,
    declaration: &FileValue<T>,
    models: &[FoundModel],
    rules: &Rules,
) -> Result<(), Failure> {
    let channel = &declaration.channel;
    let names: Vec<&str> = rules
        .inputs
        .iter()
        .chain(&rules.outputs)
        .map(|rule| rule.name.as_str())
        .collect();
    if !names.contains(&channel.as_str()) {
        let reason = format!(
            "the dataset has no channel {channel}; it has {}",
            names.join(", ")
        );
        return Err(Failure::coded_option(option, "unknown-channel", reason));
    }
    let scope = &declaration.scope;
    if let FileScope::Files(pattern) = scope
        && !models.iter().any(|model| scope.holds(model, None))
    {
        let reason = format!(
            "{channel}: no model matches \"{pattern}\"; gdcm assemble without this option lists the \
            names (column \"file\")"
        );
        return Err(Failure::coded_option(option, "unknown-model", reason));
    }
    Ok(())
}
