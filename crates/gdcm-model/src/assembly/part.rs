//! A dataset part: a model with its place in the dataset and its channels matched.

use super::channel_match::{ChannelMatch, ChannelMatcher};
use super::found_model::{ChannelLabel, FoundModel};
use super::problem::ProblemKind;
use super::row::Row;
use super::row_rule::RowRule;
use super::rules::Rules;
use crate::dataset::channel::ChannelSide;
use crate::names::KnownChannels;

/// A model with its place in the dataset and its channels matched.
#[derive(Clone, Debug, PartialEq)]
pub struct Part {
    pub found: FoundModel,
    pub row: Row,
    /// Input and output labels, with names from the rules, the file, or the variable or file name.
    pub labels: [Vec<ChannelLabel>; 2],
    pub inputs: ChannelMatch,
    pub outputs: ChannelMatch,
    /// Sample time \[s\] from the rules, 0 for continuous time; `None` if the file gives one or the
    /// rules do not, and for a measured response.
    pub sample_time_s: Option<f64>,
}

impl Part {
    /// Places a model in the dataset and matches its channels.
    ///
    /// 1. Name the channels: from the rules, or else the file, or else the variable or file name.
    /// 2. Match them to the dataset's channels.
    /// 3. Add problems if the rules give a wrong count of names, or if the variable or file name is
    ///    ambiguous.
    pub(super) fn new(found: FoundModel, row: Row, rules: &Rules) -> Self {
        let rule = rules.rows.get(&found.key());
        // Step 1.
        let named = found.labels_with_name(KnownChannels::Dataset {
            inputs: &rules.inputs,
            outputs: &rules.outputs,
        });
        let input_names = rule.and_then(|rule| rule.inputs.as_deref());
        let output_names = rule.and_then(|rule| rule.outputs.as_deref());
        let [mut input_labels, mut output_labels] = named.labels;
        rename_labels(&mut input_labels, input_names);
        rename_labels(&mut output_labels, output_names);
        // Step 2.
        let declared = rules.declared(&found, row.role);
        let input_matcher = ChannelMatcher {
            side: ChannelSide::Input,
            labels: &input_labels,
            rules: &rules.inputs,
            declared: &declared,
            // `partial`: a measured response may have only some of the dataset's channels.
            partial: found.response().is_some(),
        };
        let output_matcher = ChannelMatcher {
            side: ChannelSide::Output,
            labels: &output_labels,
            rules: &rules.outputs,
            ..input_matcher
        };
        let mut inputs = input_matcher.run();
        let mut outputs = output_matcher.run();
        // Step 3.
        inputs
            .problems
            .extend(name_count_problem(&input_matcher, input_names));
        outputs
            .problems
            .extend(name_count_problem(&output_matcher, output_names));
        if let Some(ambiguous) = named.ambiguous
            && (input_names.is_none() || output_names.is_none())
        {
            // Replace "unmatched" problems by their cause, the ambiguous name.
            for problems in [&mut inputs.problems, &mut outputs.problems] {
                problems.retain(|kind| !matches!(kind, ProblemKind::ResponseUnmatched { .. }));
            }
            inputs.problems.push(ProblemKind::ResponseName {
                name: ambiguous.name,
                error: ambiguous.error,
            });
        }
        Self {
            sample_time_s: sample_time_from_rules(&found, rule, rules),
            labels: [input_labels, output_labels],
            found,
            row,
            inputs,
            outputs,
        }
    }

    /// Returns the sides (inputs, outputs) whose channels have no names and were matched by
    /// position.
    pub fn sides_by_position(&self) -> Vec<ChannelSide> {
        let mut sides = Vec::new();
        if self.inputs.by_position {
            sides.push(ChannelSide::Input);
        }
        if self.outputs.by_position {
            sides.push(ChannelSide::Output);
        }
        sides
    }
}

/// Replaces channel names by the names in the rules, if there are any.
fn rename_labels(labels: &mut [ChannelLabel], names: Option<&[String]>) {
    for (label, name) in labels.iter_mut().zip(names.unwrap_or_default()) {
        label.name = Some(name.clone());
    }
}

/// Returns the problem if the name count in the rules differs from the model's channel count.
fn name_count_problem(
    matcher: &ChannelMatcher<'_>,
    names: Option<&[String]>,
) -> Option<ProblemKind> {
    let names = names?;
    if names.len() == matcher.labels.len() {
        return None;
    }
    Some(ProblemKind::NameCount {
        side: matcher.side,
        given: names.len(),
        found: matcher.labels.len(),
    })
}

/// Returns the sample time \[s\] from the rules for a model with matrices whose file gives none;
/// otherwise `None`.
fn sample_time_from_rules(
    found: &FoundModel,
    rule: Option<&RowRule>,
    rules: &Rules,
) -> Option<f64> {
    if found.draft.timing.sample_time_s.is_some() || found.response().is_some() {
        return None;
    }
    rule.and_then(|rule| rule.sample_time_s)
        .or(rules.sample_time_s)
}
