//! What differs between two sets of decisions about one dataset, in plain words.

use std::collections::BTreeSet;
use std::fmt;

use crate::correction::Channel;
use crate::dataset::{BundleKind, ConditionId, PairTable};

use super::{BundleChoice, SETTINGS, Settings, Study};

/// One decision that was taken otherwise.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct DecisionDifference {
    /// What was decided: "α of the gains", "LON → Q", "nominal (condition 10)".
    pub what: String,
    /// The one decision: "1", "held", "rejected".
    pub before: String,
    /// The other.
    pub after: String,
}

impl DecisionDifference {
    fn new(what: impl Into<String>, before: impl Into<String>, after: impl Into<String>) -> Self {
        Self { what: what.into(), before: before.into(), after: after.into() }
    }
}

impl fmt::Display for DecisionDifference {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(formatter, "{}: {} → {}", self.what, self.before, self.after)
    }
}

/// Every decision in which `after` differs from `before`, a study of the same dataset: settings, responses, then condition by
/// condition. What was kept under names does not count.
pub fn decision_differences(before: &Study, after: &Study) -> Vec<DecisionDifference> {
    let (a, b) = (&before.settings, &after.settings);
    let mut differences: Vec<DecisionDifference> = setting_differences(a, b).collect();
    differences.extend(pair_differences(before, (&a.constrained, &b.constrained), ["held", "free"]));
    differences.extend(pair_differences(before, (&a.ignored, &b.ignored), ["ignored", "fitted"]));
    let (inputs, outputs) = before.dataset.names_of_channels();
    let channels = Channel::all(inputs.len(), outputs.len());
    for channel in channels.filter(|channel| before.signs.get(channel) != after.signs.get(channel)) {
        let sign = |of: &Study| {
            of.signs.get(&channel).map_or("as in the file".to_owned(), |of| format!("{} turned", of.models()))
        };
        let what = format!("sign of {}", channel.name(&inputs, &outputs));
        differences.push(DecisionDifference::new(what, sign(before), sign(after)));
    }
    for condition in before.dataset.conditions() {
        let id = condition.id();
        let (a, b) = (before.choice(id), after.choice(id));
        if a.scheduled != b.scheduled {
            let word = |scheduled| if scheduled { "in the schedule" } else { "left out of the schedule" };
            differences.push(DecisionDifference::new(format!("condition {id}"), word(a.scheduled), word(b.scheduled)));
        }
        if a.held_out != b.held_out {
            let word = |held_out| if held_out { "held out" } else { "not held out" };
            differences.push(DecisionDifference::new(format!("condition {id}"), word(a.held_out), word(b.held_out)));
        }
        for kind in BundleKind::BOTH {
            differences.extend(bundle_differences(id, kind, a.bundle(kind), b.bundle(kind)));
        }
    }
    differences
}

fn setting_differences(before: &Settings, after: &Settings) -> impl Iterator<Item = DecisionDifference> {
    let changed = SETTINGS.iter().filter(|setting| setting.value(before) != setting.value(after));
    changed.map(|setting| DecisionDifference::new(setting.name, setting.words(before), setting.words(after)))
}

fn pair_differences(
    study: &Study,
    (before, after): (&PairTable<bool>, &PairTable<bool>),
    [yes, no]: [&str; 2],
) -> Vec<DecisionDifference> {
    let word = |marked: bool| if marked { yes } else { no };
    let changed = before.iter().filter(|(pair, marked)| **marked != after[*pair]);
    changed
        .map(|(pair, &marked)| DecisionDifference::new(study.dataset.pair_name(pair), word(marked), word(!marked)))
        .collect()
}

fn bundle_differences(
    condition: ConditionId,
    kind: BundleKind,
    before: &BundleChoice,
    after: &BundleChoice,
) -> Vec<DecisionDifference> {
    let rejected =
        |choice: &BundleChoice, name: &String| match (choice.rejected.contains(name), choice.reasons.get(name)) {
            (true, Some(reason)) => format!("rejected ({reason})"),
            (true, None) => "rejected".to_owned(),
            (false, _) => "kept".to_owned(),
        };
    let names: BTreeSet<&String> = before.rejected.iter().chain(&after.rejected).collect();
    let of_models = names.into_iter().map(|name| {
        DecisionDifference::new(
            format!("{name} (condition {condition})"),
            rejected(before, name),
            rejected(after, name),
        )
    });
    let represents = |choice: &BundleChoice| choice.pinned.clone().unwrap_or_else(|| "the medoid".to_owned());
    let pinned = DecisionDifference::new(
        format!("{kind} representative (condition {condition})"),
        represents(before),
        represents(after),
    );
    of_models.chain([pinned]).filter(|difference| difference.before != difference.after).collect()
}
