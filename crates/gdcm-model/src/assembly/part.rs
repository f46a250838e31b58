//! A model with its place in the dataset and its channels matched.

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
    /// The model as read from its file.
    pub found: FoundModel,
    pub row: Row,
    /// Input and output names: from the rules, the file, or the file's name.
    pub labels: [Vec<ChannelLabel>; 2],
    /// Inputs in the dataset's order.
    pub inputs: ChannelMatch,
    /// Outputs in the dataset's order.
    pub outputs: ChannelMatch,
    /// Sample time \[s\] from the rules where the file has none; 0 for a continuous-time model.
    pub sample_time_s: Option<f64>,
}

impl Part {
    /// Applies the rules to a model.
    ///
    /// 1. Name the channels: rules before file before file name.
    /// 2. Match them to the dataset's channels.
    /// 3. Report names whose count differs from the channels', and an ambiguous file name.
    pub(super) fn new(found: FoundModel, row: Row, rules: &Rules) -> Self {
        let rule = rules.rows.get(&found.key());
        let named = found.labels_with_name(KnownChannels::Dataset {
            inputs: &rules.inputs,
            outputs: &rules.outputs,
        });
        let input_names = rule.and_then(|rule| rule.inputs.as_deref());
        let output_names = rule.and_then(|rule| rule.outputs.as_deref());
        let [mut input_labels, mut output_labels] = named.labels;
        rename_labels(&mut input_labels, input_names);
        rename_labels(&mut output_labels, output_names);
        let declared = rules.declared(&found, row.role);
        let input_matcher = ChannelMatcher {
            side: ChannelSide::Input,
            labels: &input_labels,
            rules: &rules.inputs,
            declared: &declared,
            // A measured response may have only some of the dataset's channels.
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
        inputs
            .problems
            .extend(name_count_problem(&input_matcher, input_names));
        outputs
            .problems
            .extend(name_count_problem(&output_matcher, output_names));
        if let Some(ambiguous) = named.ambiguous
            && (input_names.is_none() || output_names.is_none())
        {
            // The ambiguous name is the reason why the channels match nothing.
            for problems in [&mut inputs.problems, &mut outputs.problems] {
                problems.retain(|kind| !matches!(kind, ProblemKind::ResponseUnmatched { .. }));
            }
            inputs.problems.push(ProblemKind::ResponseName {
                name: ambiguous.name,
                error: ambiguous.error,
            });
        }
        Self {
            sample_time_s: missing_sample_time(&found, rule, rules),
            labels: [input_labels, output_labels],
            found,
            row,
            inputs,
            outputs,
        }
    }

    /// Returns the sides whose channels have no names and were matched by position.
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

/// Replaces channel names by those in the rules, if any.
fn rename_labels(labels: &mut [ChannelLabel], names: Option<&[String]>) {
    for (label, name) in labels.iter_mut().zip(names.unwrap_or_default()) {
        label.name = Some(name.clone());
    }
}

/// Reports names in the rules whose count differs from the model's channels.
fn name_count_problem(
    matcher: &ChannelMatcher<'_>,
    names: Option<&[String]>,
) -> Option<ProblemKind> {
    let names = names?;
    if names.len() == matcher.labels.len() {
        return None;
    }
    Some(ProblemKind::Names {
        side: matcher.side,
        said: names.len(),
        found: matcher.labels.len(),
    })
}

/// Returns the sample time in the rules if the model has matrices but no sample time.
fn missing_sample_time(found: &FoundModel, rule: Option<&RowRule>, rules: &Rules) -> Option<f64> {
    if found.draft.timing.sample_time_s.is_some() || found.response().is_some() {
        return None;
    }
    rule.and_then(|rule| rule.sample_time_s)
        .or(rules.sample_time_s)
}
