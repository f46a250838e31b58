//! Finds the scope for each question about a channel: all models, the models with a role, or a
//! single file. The scope is part of the command-line option that answers the question ("--sign
//! NZ=-1:identified").
//!
//! A *question* is a fact about a channel that is missing in a file and that an option supplies:
//! its sign, its unit or the factor between two units.

use std::collections::{BTreeMap, BTreeSet};

use super::channel_match::ChannelUse;
use super::file_scope::FileScope;
use super::part::Part;
use super::problem::{Problem, Question};
use super::rules::Rules;
use crate::names::ChannelRule;

/// Sets the scope for each problem that a channel option can settle.
///
/// The scope is the widest one in which every model with the channel has the same problem
/// ([`wide_scopes_asking`]). If there is none, the scope is the model itself.
pub(super) fn set_scopes(problems: &mut [Problem], parts: &[Part], rules: &Rules) {
    // For each question, the indices of the models that raise it.
    let mut models_asking: BTreeMap<Question, BTreeSet<usize>> = BTreeMap::new();
    for problem in problems.iter() {
        if let (Some(part), Some(question)) = (problem.part, problem.kind.question()) {
            models_asking.entry(question).or_default().insert(part);
        }
    }
    let mut wide_scopes: BTreeMap<&Question, Vec<FileScope>> = BTreeMap::new();
    for (question, asking) in &models_asking {
        wide_scopes.insert(question, wide_scopes_asking(question, asking, parts, rules));
    }
    for problem in problems {
        let (Some(part), Some(question)) = (problem.part, problem.kind.question()) else {
            continue;
        };
        let role = role_scope(&parts[part]);
        let wide_scope = wide_scopes.get(&question).and_then(|scopes| {
            scopes
                .iter()
                .find(|scope| **scope == FileScope::All || Some(*scope) == role.as_ref())
        });
        problem.scope = Some(match wide_scope {
            Some(scope) => scope.clone(),
            None => FileScope::Files(parts[part].found.key()),
        });
    }
}

/// Returns the wide scopes in which every model that has the channel, and is not left out, raises
/// the question; `asking` has the indices of the models that raise it:
///
/// - all models, if models of both roles have the channel and every model with the channel asks,
///   including models without a role
/// - otherwise the physics models, or the identified models; empty if neither role qualifies
fn wide_scopes_asking(
    question: &Question,
    asking: &BTreeSet<usize>,
    parts: &[Part],
    rules: &Rules,
) -> Vec<FileScope> {
    let mut with_channel = Vec::new();
    for (index, part) in parts.iter().enumerate() {
        if !part.row.left_out && has_channel(part, &question.channel, rules) {
            with_channel.push(index);
        }
    }
    let mut scopes = Vec::new();
    for scope in [FileScope::Physics, FileScope::Identified] {
        let mut in_scope = with_channel
            .iter()
            .filter(|index| role_scope(&parts[**index]).as_ref() == Some(&scope))
            .peekable();
        if in_scope.peek().is_some() && in_scope.all(|index| asking.contains(index)) {
            scopes.push(scope);
        }
    }
    // `with_channel.iter()`: models without a role are in neither role scope and are checked here.
    if scopes.len() == 2 && with_channel.iter().all(|index| asking.contains(index)) {
        return vec![FileScope::All];
    }
    scopes
}

/// Returns the scope for a model's role; `None` without a role.
fn role_scope(part: &Part) -> Option<FileScope> {
    part.row.role.map(FileScope::of_role)
}

/// Returns whether a model has a dataset channel, among its inputs or outputs.
fn has_channel(part: &Part, channel: &str, rules: &Rules) -> bool {
    is_used(&rules.inputs, &part.inputs.uses, channel)
        || is_used(&rules.outputs, &part.outputs.uses, channel)
}

fn is_used(rules: &[ChannelRule], uses: &[Option<ChannelUse>], channel: &str) -> bool {
    rules
        .iter()
        .zip(uses)
        .any(|(rule, used)| rule.name == channel && used.is_some())
}
