//! Differences between two sets of decisions about one dataset, and between two states of one
//! dataset, with the decisions carried over from one to the other.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt;
use std::sync::Arc;

use serde::{Deserialize, Serialize};

use gdcm_method::correction::Channel;
use gdcm_model::dataset::{BundleKind, Condition, ConditionId, Dataset, ModelId, PairTable};

use super::changed_models::{AdoptedModels, TurnedChannel};
use super::edit::Edit;
use super::setting::SETTINGS;
use super::settings::{ResponseNames, Settings};
use super::study::{BundleChoice, ConditionChoice, Study, Variant};
use crate::results::requirements::RequirementSettings;

/// One changed decision.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct DecisionDifference {
    /// Subject of the decision: "α of the gains", "LON → Q", "nominal (condition 10)".
    pub what: String,
    /// Decision before: "1", "held", "rejected".
    pub before: String,
    /// Decision after.
    pub after: String,
}

impl DecisionDifference {
    fn new(what: impl Into<String>, before: impl Into<String>, after: impl Into<String>) -> Self {
        Self {
            what: what.into(),
            before: before.into(),
            after: after.into(),
        }
    }
}

impl fmt::Display for DecisionDifference {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(formatter, "{}: {} → {}", self.what, self.before, self.after)
    }
}

/// Lists every decision in which `after` differs from `before`, a study of the same dataset:
/// settings, responses, then condition by condition. Variants are not compared.
pub fn decision_differences(before: &Study, after: &Study) -> Vec<DecisionDifference> {
    let a = &before.settings;
    let b = &after.settings;
    let changed = SETTINGS
        .iter()
        .filter(|setting| setting.value(a) != setting.value(b));
    let changed = changed
        .map(|setting| DecisionDifference::new(setting.name, setting.words(a), setting.words(b)));
    let mut differences: Vec<DecisionDifference> = changed.collect();
    differences.extend(pair_differences(
        before,
        (&a.constrained, &b.constrained),
        ["held", "free"],
    ));
    differences.extend(pair_differences(
        before,
        (&a.ignored, &b.ignored),
        ["ignored", "fitted"],
    ));
    for channel in Channel::all_of(&before.dataset)
        .filter(|channel| before.signs.get(channel) != after.signs.get(channel))
    {
        let sign = |of: &Study| {
            of.signs
                .get(&channel)
                .map_or("as in the file".to_owned(), |of| {
                    format!("{} turned", of.models())
                })
        };
        let what = format!("sign of {}", channel.name_in(&before.dataset));
        differences.push(DecisionDifference::new(what, sign(before), sign(after)));
    }
    for condition in before.dataset.conditions() {
        let id = condition.id();
        let a = before.choice(id);
        let b = after.choice(id);
        let mut compare = |before: bool, after: bool, [no, yes]: [&str; 2]| {
            let word = |is_so: bool| if is_so { yes } else { no };
            let difference =
                DecisionDifference::new(format!("condition {id}"), word(before), word(after));
            differences.extend((before != after).then_some(difference));
        };
        compare(
            a.scheduled,
            b.scheduled,
            ["left out of the schedule", "in the schedule"],
        );
        compare(a.held_out, b.held_out, ["not held out", "held out"]);
        for kind in BundleKind::BOTH {
            differences.extend(bundle_differences(id, kind, a.bundle(kind), b.bundle(kind)));
        }
    }
    differences
}

fn pair_differences(
    study: &Study,
    (before, after): (&PairTable<bool>, &PairTable<bool>),
    [yes, no]: [&str; 2],
) -> Vec<DecisionDifference> {
    let word = |marked: bool| if marked { yes } else { no };
    let changed = before
        .iter()
        .filter(|(pair, marked)| **marked != after[*pair]);
    changed
        .map(|(pair, &marked)| {
            DecisionDifference::new(study.dataset.pair_name(pair), word(marked), word(!marked))
        })
        .collect()
}

fn bundle_differences(
    condition: ConditionId,
    kind: BundleKind,
    before: &BundleChoice,
    after: &BundleChoice,
) -> Vec<DecisionDifference> {
    let rejected = |choice: &BundleChoice, name: &String| match (
        choice.rejected.contains(name),
        choice.reasons.get(name),
    ) {
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
    let represents = |choice: &BundleChoice| {
        choice
            .pinned
            .clone()
            .unwrap_or_else(|| "the medoid".to_owned())
    };
    let pinned = DecisionDifference::new(
        format!("{kind} representative (condition {condition})"),
        represents(before),
        represents(after),
    );
    of_models
        .chain([pinned])
        .filter(|difference| difference.before != difference.after)
        .collect()
}

/// One difference between a dataset and the dataset that a study was made with, or a decision that
/// does not apply to it.
#[derive(Clone, Debug, PartialEq)]
pub enum Difference {
    /// The file has changed, and the study has no inventory of the file that it was saved with.
    AnotherFile {
        /// SHA-256 of the file when the study was saved.
        expected: String,
        /// SHA-256 of the present file.
        found: String,
    },
    ConditionAdded(ConditionId),
    ConditionRemoved(ConditionId),
    /// A condition has another airspeed.
    AirspeedChanged {
        condition: ConditionId,
        /// The airspeed before \[kt\].
        before_kt: f64,
        /// The airspeed now \[kt\].
        now_kt: f64,
    },
    /// A bundle has a new model.
    ModelAdded(ModelId),
    ModelRemoved(ModelId),
    /// A model has changed numbers, bands or trim.
    ModelChanged(ModelId),
    /// A decision no longer applies.
    NotApplied {
        /// Label of the decision: "reject nominal (condition 10)".
        decision: String,
        why: String,
    },
}

impl fmt::Display for Difference {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Difference::AnotherFile { expected, found } => write!(
                formatter,
                "the dataset has changed since the study was saved, and the study does not say what it held: expected \
                 SHA-256 {expected}, found {found}"
            ),
            Difference::ConditionAdded(id) => write!(formatter, "condition {id} was added"),
            Difference::ConditionRemoved(id) => write!(formatter, "condition {id} was removed"),
            Difference::AirspeedChanged {
                condition,
                before_kt,
                now_kt,
            } => {
                write!(
                    formatter,
                    "condition {condition} is flown at {now_kt} kt, was {before_kt} kt"
                )
            }
            Difference::ModelAdded(id) => write!(formatter, "{id} was added"),
            Difference::ModelRemoved(id) => write!(formatter, "{id} was removed"),
            Difference::ModelChanged(id) => write!(formatter, "{id} has changed"),
            Difference::NotApplied { decision, why } => {
                write!(formatter, "a decision no longer applies: {decision}: {why}")
            }
        }
    }
}

/// Every decision of a study by the names of channels, conditions and models, independent of the
/// dataset.
#[derive(Clone, Debug, PartialEq)]
pub struct Decisions {
    pub settings: Settings<ResponseNames>,
    pub choices: BTreeMap<ConditionId, ConditionChoice>,
    /// Models adopted instead of those of the file.
    pub taken: Vec<(ConditionId, Arc<AdoptedModels>)>,
    /// The channels with reversed sign.
    pub signs: Vec<TurnedChannel>,
    pub requirements: Arc<RequirementSettings>,
    /// The variants; a variant contains no variants of its own.
    pub variants: Vec<(String, Decisions)>,
}

impl Decisions {
    /// Collects the decisions of a study.
    pub fn of(study: &Study) -> Self {
        Self {
            settings: study.settings.named(&study.dataset),
            choices: study.choices.clone(),
            taken: study.taken.clone().into_iter().collect(),
            signs: study.turned_channels(),
            requirements: Arc::clone(&study.requirements),
            variants: study
                .variants
                .iter()
                .filter_map(|variant| {
                    Some((
                        variant.name.clone(),
                        Self::of(&study.of_variant(&variant.name)?),
                    ))
                })
                .collect(),
        }
    }

    /// Returns the study of `dataset` with every decision that applies to it, and a list of the
    /// other decisions.
    pub fn applied_to(&self, dataset: Arc<Dataset>) -> (Study, Vec<Difference>) {
        let mut study = Study::new(dataset);
        let mut differences = Vec::new();
        study.requirements = Arc::clone(&self.requirements);
        for decision in self.requirements.without_channel(&study.dataset) {
            let why = "it stays in the study for another dataset".to_owned();
            differences.push(Difference::NotApplied { decision, why });
        }
        study.settings = self
            .settings
            .with_responses(|verb, names| marked(verb, names, &study, &mut differences));
        for taken in &self.taken {
            carry_out(
                &Edit::TakeModels(vec![taken.clone()]),
                &mut study,
                &mut differences,
            );
        }
        for turned in &self.signs {
            match turned.find(&study.dataset) {
                Some(channel) => {
                    carry_out(
                        &Edit::SetSign {
                            channel,
                            of: Some(turned.of),
                        },
                        &mut study,
                        &mut differences,
                    );
                }
                None => differences.push(Difference::NotApplied {
                    decision: format!("turn {}", turned.channel),
                    why: "the dataset has no such channel".to_owned(),
                }),
            }
        }
        for (&condition, choice) in &self.choices {
            take_choice(&mut study, condition, choice, &mut differences);
        }
        for (name, decisions) in &self.variants {
            let (of_variant, mut not_applied) = decisions.applied_to(Arc::clone(&study.dataset));
            for difference in &mut not_applied {
                if let Difference::NotApplied { decision, .. } = difference {
                    decision.push_str(&format!(", of variant \"{name}\""));
                }
            }
            differences.extend(not_applied);
            let Study {
                settings, choices, ..
            } = of_variant;
            if study.variant(name).is_none() {
                study.variants.push(Arc::new(Variant {
                    name: name.clone(),
                    settings,
                    choices,
                }));
            }
        }
        (study, differences)
    }
}

/// Returns the listed responses as a table.
fn marked(
    verb: &str,
    listed: &ResponseNames,
    study: &Study,
    differences: &mut Vec<Difference>,
) -> PairTable<bool> {
    let mut table = study.settings.constrained.map(|_, _| false);
    for (output, input) in &listed.0 {
        match study.dataset.find_pair(output, input) {
            Some(pair) => table[pair] = true,
            None => differences.push(Difference::NotApplied {
                decision: format!("{verb} {input} → {output}"),
                why: "the dataset has no such response".to_owned(),
            }),
        }
    }
    table
}

/// Applies every choice as an edit, so that no choice comes in that an edit would refuse.
fn take_choice(
    study: &mut Study,
    condition: ConditionId,
    choice: &ConditionChoice,
    differences: &mut Vec<Difference>,
) {
    let mut edits = Vec::new();
    if !choice.scheduled {
        edits.push(Edit::SetScheduled {
            condition,
            scheduled: false,
        });
    }
    if choice.held_out {
        edits.push(Edit::SetHeldOut {
            condition,
            held_out: true,
        });
    }
    for kind in BundleKind::BOTH {
        let id = |name: &String| ModelId::new(condition, kind, name);
        let of_bundle = choice.bundle(kind);
        edits.extend(of_bundle.rejected.iter().map(|name| Edit::Reject(id(name))));
        let reasons = of_bundle
            .reasons
            .iter()
            .filter(|(name, _)| of_bundle.rejected.contains(*name));
        edits.extend(reasons.map(|(name, reason)| Edit::SetReason(id(name), reason.clone())));
        edits.extend(of_bundle.pinned.iter().map(|name| Edit::Pin(id(name))));
    }
    edits
        .iter()
        .for_each(|edit| carry_out(edit, study, differences));
}

fn carry_out(edit: &Edit, study: &mut Study, differences: &mut Vec<Difference>) {
    if let Err(refusal) = study.apply(edit) {
        differences.push(Difference::NotApplied {
            decision: edit.label(study),
            why: refusal.to_string(),
        });
    }
}

impl Study {
    /// Returns this study for another state of its dataset, with every decision that still applies,
    /// and all differences.
    pub fn reconciled(&self, dataset: Arc<Dataset>) -> (Study, Vec<Difference>) {
        let mut differences = Inventory::of(self.file_dataset()).differences(&dataset);
        let (study, not_applied) = Decisions::of(self).applied_to(dataset);
        differences.extend(not_applied);
        (study, differences)
    }
}

impl Inventory {
    /// Lists the differences of `dataset` from the dataset of this inventory.
    pub fn differences(&self, dataset: &Dataset) -> Vec<Difference> {
        let now = Inventory::of(dataset);
        let mut differences = Vec::new();
        let [before, now] = [self, &now].map(|of| -> BTreeMap<ConditionId, &ConditionInventory> {
            of.0.iter()
                .map(|condition| (condition.id, condition))
                .collect()
        });
        let ids: BTreeSet<ConditionId> = before.keys().chain(now.keys()).copied().collect();
        for id in ids {
            match (before.get(&id), now.get(&id)) {
                (Some(_), None) => differences.push(Difference::ConditionRemoved(id)),
                (None, Some(_)) => differences.push(Difference::ConditionAdded(id)),
                (Some(before), Some(now)) => {
                    let before_kt = before.airspeed_kt;
                    let now_kt = now.airspeed_kt;
                    if before_kt != now_kt {
                        differences.push(Difference::AirspeedChanged {
                            condition: id,
                            before_kt,
                            now_kt,
                        });
                    }
                    for kind in BundleKind::BOTH {
                        compare_bundles(
                            (id, kind),
                            before.bundle(kind),
                            now.bundle(kind),
                            &mut differences,
                        );
                    }
                }
                (None, None) => {}
            }
        }
        differences
    }
}

fn compare_bundles(
    (condition, kind): (ConditionId, BundleKind),
    before: &BTreeMap<String, String>,
    now: &BTreeMap<String, String>,
    differences: &mut Vec<Difference>,
) {
    let names: BTreeSet<&String> = before.keys().chain(now.keys()).collect();
    for name in names {
        let id = ModelId::new(condition, kind, name);
        match (before.get(name), now.get(name)) {
            (Some(before), Some(now)) if before == now => {}
            (Some(_), Some(_)) => differences.push(Difference::ModelChanged(id)),
            (Some(_), None) => differences.push(Difference::ModelRemoved(id)),
            (None, _) => differences.push(Difference::ModelAdded(id)),
        }
    }
}

/// The models of one condition: name, and fingerprint of the numbers, the bands and the trim.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ConditionInventory {
    pub id: ConditionId,
    /// True airspeed \[kt\].
    pub airspeed_kt: f64,
    pub physics: BTreeMap<String, String>,
    pub identified: BTreeMap<String, String>,
}

impl ConditionInventory {
    fn of(condition: &Condition) -> Self {
        let models = |kind| {
            let models = condition.bundle(kind).iter();
            models
                .map(|model| (model.name.clone(), model.fingerprint()))
                .collect()
        };
        Self {
            id: condition.id(),
            airspeed_kt: condition.flight_state().airspeed_kt,
            physics: models(BundleKind::Physics),
            identified: models(BundleKind::Identified),
        }
    }

    /// Returns the models of one bundle.
    pub fn bundle(&self, kind: BundleKind) -> &BTreeMap<String, String> {
        kind.pick(&self.physics, &self.identified)
    }
}

/// Content of a dataset, small enough for a study file: a study compares it with the present
/// dataset to report changes.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Inventory(pub Vec<ConditionInventory>);

impl Inventory {
    /// Takes the inventory of a dataset.
    pub fn of(dataset: &Dataset) -> Self {
        Self(
            dataset
                .conditions()
                .iter()
                .map(|condition| ConditionInventory::of(condition))
                .collect(),
        )
    }
}
